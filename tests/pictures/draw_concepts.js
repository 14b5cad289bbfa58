// SPDX-License-Identifier: BSD-3-Clause
// node draw_concepts.js WASM OUT: the drawings of docs/concepts.md, concepts-NAME.svg each. WASM has what `make wasm` makes:
// every length and number in them is the library's own answer.
"use strict";
const fs = require("fs");
const path = require("path");
const { openLibrary } = require("./section.js");
const drawings = {
  ...require("./concepts_touch.js"),
  ...require("./concepts_contact.js"),
  ...require("./concepts_force.js"),
  ...require("./concepts_search.js"),
};
const [wasm, out] = process.argv.slice(2);

(async () => {
  const library = await openLibrary(wasm);
  fs.mkdirSync(out, { recursive: true });
  for (const [name, draw] of Object.entries(drawings)) {
    const file = path.join(out, `concepts-${name}.svg`);
    fs.writeFileSync(`${file}.new`, draw(library).toString());
    fs.renameSync(`${file}.new`, file);
    process.stdout.write(`${file}: ${Math.ceil(fs.statSync(file).size / 1024)} kB\n`);
  }
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
