// SPDX-License-Identifier: BSD-3-Clause
// node drawings_again.js WASM ROOM: the drawings in docs/pictures are those that the library draws today, byte by byte. So
// each number in them is what the core answers.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { check, finish, assert } = require("../view/verdicts.js");
const [wasm, room] = process.argv.slice(2);
const kept = path.join(__dirname, "../../docs/pictures");
const again = path.join(room, "drawn");
const drawingsIn = folder => fs.readdirSync(folder).filter(name => /^concepts-.*\.svg$/.test(name));

(async () => {
  execFileSync("node", [path.join(__dirname, "draw_concepts.js"), wasm, again], { stdio: ["ignore", "ignore", "inherit"] });
  await check("docs/pictures has the drawings that are drawn, and no other", () =>
    assert.deepStrictEqual(drawingsIn(kept), drawingsIn(again)),
  );
  for (const name of drawingsIn(again))
    await check(`${name} is what the library draws today (make pictures)`, () => {
      const [old, now] = [kept, again].map(folder => fs.readFileSync(path.join(folder, name), "utf8").split("\n"));
      const line = now.findIndex((text, k) => text !== old[k]);
      assert(old.length === now.length && line < 0, `line ${line + 1}: ${old[line]}, now ${now[line]}`);
    });
  finish();
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
