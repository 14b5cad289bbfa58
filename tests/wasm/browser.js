// SPDX-License-Identifier: BSD-3-Clause
// node browser.js WASM ROOM: the core in a headless Chromium, in a page that is opened from its file: the same answers as
// the native library gave (wanted.json of modules.js in ROOM).
"use strict";
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { check, assert, finish } = require("../view/verdicts.js");
const { launch } = require("../view/chromium.js");
const [wasm, room] = process.argv.slice(2).map(name => path.resolve(name));

const text = name => fs.readFileSync(name, "utf8");
const base64 = name => fs.readFileSync(name).toString("base64");

// In the page: hashes of all answers of one scene.
async function hashOf(file, trace, law) {
  const bytes = name => Uint8Array.from(atob(document.getElementById(name).textContent), letter => letter.charCodeAt(0));
  globalThis.opened ??= await dynpoint.openCore(bytes("core"));
  const mesh = opened.openMesh(bytes(file));
  const pieces = [];
  const kernel = answers(opened, mesh, rowsOf(document.getElementById(trace).textContent), law, 0, piece => {
    pieces.push(piece.slice());
  });
  mesh.close();
  const hash = await crypto.subtle.digest("SHA-256", await new Blob(pieces).arrayBuffer());
  return [kernel, Array.from(new Uint8Array(hash), byte => byte.toString(16).padStart(2, "0")).join("")];
}

(async () => {
  const wanted = JSON.parse(text(path.join(room, "wanted.json")));
  const files = [...new Set(Object.keys(wanted).map(key => key.split(" ")[0]))];
  const data = (id, content) => `<script type="text/plain" id="${id}">${content}</script>`;
  const page = path.join(room, "core.html");
  fs.writeFileSync(
    page,
    `<!doctype html><meta charset="utf-8"><title>core</title>
${data("core", base64(path.join(wasm, "dynpoint.wasm")))}
${files.map(file => data(file, base64(path.join(room, file))) + data(`${file}.csv`, text(path.join(room, `${file}.csv`)))).join("\n")}
<script>${text(path.join(wasm, "dynpoint.js"))}</script>
<script>${text(path.join(__dirname, "layer_answers.js"))}</script>`,
  );
  const browser = launch(room);
  const view = await browser.visit(pathToFileURL(page).href);
  for (const [key, hash] of Object.entries(wanted)) {
    const [file, law] = key.split(" ");
    await check(`${file}, law ${law}: Chromium gives the native library's bytes`, async () => {
      const [kernel, got] = await view.call(hashOf, file, `${file}.csv`, Number(law));
      assert(kernel === "wasm128" && got === hash, `${kernel}: other bytes`);
    });
  }
  await check("the page asks the network for nothing, and complains of nothing", () => {
    assert.deepStrictEqual(view.said, []);
    assert.deepStrictEqual(view.asked.filter(url => !url.startsWith("file:")), []);
  });
  await browser.close();
  finish();
})();
