// SPDX-License-Identifier: BSD-3-Clause
// node page_one_file.js PAGE: what tools/page/make_touch_page.js wrote: a file that holds all that it needs, and allows
// itself nothing else.
"use strict";
const fs = require("fs");
const path = require("path");
const zlib = require("zlib");
const crypto = require("crypto");
const { check, finish, assert } = require("../view/verdicts.js");
const page = fs.readFileSync(process.argv[2], "utf8");
const root = path.join(__dirname, "../..");
const MOST = 1.6e6; // bytes

// The parts of the pack, by the words of boot.js alone.
function unpack() {
  const [, text] = /<script type="text\/plain" id="pack">([A-Za-z0-9+/=]*)<\/script>/.exec(page);
  const all = zlib.inflateRawSync(Buffer.from(text, "base64"));
  const from = 4 + all.readUInt32LE(0);
  const places = JSON.parse(all.subarray(4, from));
  return Object.fromEntries(
    Object.entries(places).map(([name, [at, size]]) => [name, all.subarray(from + at, from + at + size)]),
  );
}

const sum = text => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`;

(async () => {
  const parts = unpack();
  const [, policy] = /http-equiv="Content-Security-Policy" content="([^"]*)"/.exec(page);
  await check(`it has ${(page.length / 1e6).toFixed(2)} MB, at most ${MOST / 1e6}`, () => {
    assert(Buffer.byteLength(page) <= MOST);
  });
  await check(
    "its policy allows its own scripts by their hashes, WebAssembly, a worker of its own, and no connection",
    () => {
      const [, boot] = /<script>([^]*?)<\/script>/.exec(page);
      const [, style] = /<style>([^]*?)<\/style>/.exec(page);
      assert.strictEqual(page.match(/<script>/g).length, 1);
      assert.strictEqual(
        policy,
        `default-src 'none'; script-src ${[boot, parts["three.js"], parts["page.js"]].map(sum).join(" ")} 'wasm-unsafe-eval'; ` +
          `style-src ${sum(style)}; worker-src blob:; connect-src 'none'; img-src data:; base-uri 'none'; form-action 'none'`,
      );
    },
  );
  await check("it holds the modules as they were built, the layer, three.js and the meshes of its scenes", () => {
    for (const name of ["dynpoint.wasm", "dynpoint_compile.wasm"])
      assert(parts[name].equals(fs.readFileSync(path.join(root, "build/wasm", name))), name);
    assert(
      parts["worker.js"].toString().startsWith(fs.readFileSync(path.join(root, "build/wasm/dynpoint.js"), "utf8")),
    );
    const meshes = Object.entries(parts).filter(([name]) => name.endsWith(".ply"));
    assert.strictEqual(meshes.length, 5);
    for (const [name, bytes] of meshes) {
      const [, triangles] = /element face (\d+)/.exec(bytes.subarray(0, 300).toString());
      assert(Number(triangles) <= 10000 && name.includes(`-${triangles}.`), `${name}: ${triangles}`);
    }
  });
  await check("it links to nothing, and no slot is left open", () => {
    const markup = page.replace(/<script[^]*?<\/script>|<style[^]*?<\/style>/g, "");
    assert.deepStrictEqual(markup.match(/\b(src|href|action|srcset|data)="(?!data:)[^"]*"|@import|url\(/g), null);
    for (const text of [markup, parts["page.js"].toString()])
      assert(!/@(CSP|THREE|NOTICE|DATA|FILE|STAGE|PANEL)/.test(text));
  });
  await check("it carries the licences of what it is made of", () => {
    assert(page.includes("the dynpoint authors") && page.includes("three.js authors") && page.includes("Rich Felker"));
    assert(page.includes("The above copyright notice and this permission notice shall be included in"));
  });
  await check("it names no file of the machine that made it", () => {
    const texts = [page, ...Object.values(parts).map(String)];
    for (const text of texts) assert(!text.includes(root), "its folder");
  });
  finish();
})();
