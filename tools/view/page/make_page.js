// SPDX-License-Identifier: BSD-3-Clause
// node tools/view/page/make_page.js [FOLDER=build/view]: writes FOLDER/page.html, one file that asks the network for
// nothing, and FOLDER/page.csp, the value of the header Content-Security-Policy with which a server sends it.
// FOLDER/node_modules has three.js, by `npm ci` with the package-lock.json that lies here.
//
// One slot stays in the written page, once: @DATA@. A page that plays by itself has the stream there, in base64;
// elsewhere it may stay.
"use strict";
const fs = require("fs");
const path = require("path");
const { MARKER, assemble, escaped, fail, policyOf, textsOf, threeAsScript } = require("./page_parts.js");
const folder = process.argv[2] ?? path.join(__dirname, "../../../build/view");

const { script, notice } = threeAsScript(folder);
const assembled = assemble({
  texts: {
    CSP: "@CSP@",
    DATA: MARKER,
    THREE: script,
    NOTICE: escaped(notice),
    LICENCES: "Licence of three.js, which is in this page",
    STAGE: "",
    PANEL: "",
  },
});
if (assembled.split(MARKER).length !== 2) fail(`${MARKER} must occur once in the page`);
const policy = policyOf({
  scripts: textsOf(assembled, "script"),
  styles: textsOf(assembled, "style"),
  rest: "connect-src 'self'",
});
const page = assembled.replace("@CSP@", () => policy);
fs.mkdirSync(folder, { recursive: true });
fs.writeFileSync(path.join(folder, "page.html"), page);
fs.writeFileSync(path.join(folder, "page.csp"), `${policy}; frame-ancestors 'none'`);
console.log(`${path.join(folder, "page.html")}: ${Buffer.byteLength(page)} bytes`);
