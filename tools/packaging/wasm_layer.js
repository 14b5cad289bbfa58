// SPDX-License-Identifier: BSD-3-Clause
// node wasm_layer.js LAYOUTS.wasm IN.js: writes the JavaScript layer to standard output: IN.js, with the files that it
// names in place of /*@FILE name@*/, and with the public structs and constants as the compiler has them
// (src/bindings/wasm/wasm_layouts.c): those structs alone that the layer names.
"use strict";
const fs = require("fs");
const path = require("path");
const [layouts, source] = process.argv.slice(2);
const SIZE = { u32: 4, i32: 4, f32: 4, u64: 8, i64: 8, f64: 8 };
const ROW = 32;

function rowsOf({ exports }) {
  const view = new DataView(exports.memory.buffer);
  const text = from => {
    let word = "";
    for (let at = view.getUint32(from, true); view.getUint8(at) !== 0; at++)
      word += String.fromCharCode(view.getUint8(at));
    return word;
  };
  const rows = [];
  for (let at = exports.get_layout_rows(); view.getUint32(at, true) !== 0; at += ROW)
    rows.push({
      type: text(at),
      field: view.getUint32(at + 4, true) === 0 ? null : text(at + 4),
      offset: view.getUint32(at + 8, true),
      bytes: view.getUint32(at + 12, true),
      item: text(at + 16),
      value: view.getFloat64(at + 24, true),
    });
  return rows;
}

// As the layer reads it: name, type, offset, items; bits: 64 that are no count. A single number of four bytes that is none of these is a pointer.
function fieldOf({ field, item, offset, bytes }) {
  if (item === "text" && bytes > 4) return `${field} text ${offset} ${bytes}`;
  if (item === "u64" && /hash$|^user$/.test(field)) return `${field} bits ${offset} 1`;
  if (item in SIZE && bytes % SIZE[item] === 0 && bytes >= SIZE[item]) return `${field} ${item} ${offset} ${bytes / SIZE[item]}`;
  if (bytes === 4) return `${field} p ${offset} 1`;
  throw new Error(`wasm_layer: what is ${field}, of ${bytes} bytes?`);
}

function tables(rows, layer) {
  const named = new Set(layer.match(/\bdpt_[a-z_0-9]+\b/g));
  const structs = [];
  const constants = [];
  for (const { type, field, bytes, value } of rows) {
    if (type.startsWith("DPT_")) constants.push(`${type}: ${value}`);
    else if (field === null && named.has(type)) {
      const fields = rows.filter(row => row.type === type && row.field !== null).map(fieldOf);
      structs.push(`${type}: [${bytes}, "${fields.join(",")}"]`);
    }
  }
  return { STRUCTS: structs, CONSTANTS: constants };
}

// The part of one file, less its licence and "use strict", indented as the function that it goes into.
function partOf(name) {
  const text = fs.readFileSync(path.join(path.dirname(source), name), "utf8");
  const lines = text.replace(/^[^\n]*SPDX[^\n]*\n/, "").replace(/^"use strict";\n/m, "").split("\n");
  return lines.map(line => (line ? `  ${line}` : "")).join("\n");
}

const layer = fs
  .readFileSync(source, "utf8")
  .replace(/\/\*@FILE ([\w.]+)@\*\//g, (_, name) => partOf(name));
const instance = new WebAssembly.Instance(new WebAssembly.Module(fs.readFileSync(layouts)));
const made = tables(rowsOf(instance), layer);
process.stdout.write(layer.replace(/\/\*@([A-Z]+)@\*\//g, (_, name) => `\n    ${made[name].join(",\n    ")},\n  `));
