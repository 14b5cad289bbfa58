// SPDX-License-Identifier: BSD-3-Clause
// Files of a folder on a free port of this machine, for a browser. The package's name becomes its entry, as a bundler does.
"use strict";
const fs = require("fs");
const http = require("http");
const path = require("path");

const TYPES = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".wasm": "application/wasm",
  ".css": "text/css",
  ".svg": "image/svg+xml",
};
const ISOLATED = { "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Embedder-Policy": "require-corp" };

// isolated: whether threads of the page may sleep
function serve(folder, isolated) {
  const server = http.createServer((request, response) => {
    const file = path.join(folder, path.normalize(request.url.split("?")[0]));
    if (!fs.existsSync(file)) {
      response.writeHead(404).end();
      return;
    }
    response.writeHead(200, { "Content-Type": TYPES[path.extname(file)] ?? "application/octet-stream", ...(isolated ? ISOLATED : {}) });
    const bytes = fs.readFileSync(file);
    response.end(file.endsWith(".mjs") ? bytes.toString().replace('from "dynpoint"', 'from "/browser.mjs"') : bytes);
  });
  return new Promise(done => {
    server.listen(0, "127.0.0.1", () =>
      done({ url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() }),
    );
  });
}

module.exports = { serve };
