// SPDX-License-Identifier: BSD-3-Clause
// node npm_package.js BUILD ABI.json OUT: the folder OUT, which `npm pack` makes a package of. BUILD has what `make wasm`
// makes; the rest are the files of src/bindings/js. Structs, constants and functions get their types here: structs as the
// layer lays them out, the others from the model of the ABI.
"use strict";
const fs = require("fs");
const path = require("path");
const [wasm, abiFile, out] = process.argv.slice(2).map(name => path.resolve(name));
const root = path.join(__dirname, "../..");
const from = path.join(root, "src/bindings/js");
const { layouts, constants } = require(path.join(wasm, "dynpoint.js"));
const abi = JSON.parse(fs.readFileSync(abiFile, "utf8"));
const [core] = abi.libraries;
const headers = abi.libraries.flatMap(library => library.headers);

const read = name => fs.readFileSync(path.join(from, name), "utf8");
const pascal = name => name.replace(/(?:^|_)(\w)/g, (_, letter) => letter.toUpperCase());
const typeName = struct => pascal(struct.replace(/^dpt_/, ""));
const LISTS = { 3: "Vector", 7: "Pose" };
const TUPLE = 12; // numbers: a longer list has no length in its type

function typeOf({ name, type, count }) {
  if (type === "text") return "string";
  const item = type === "bits" ? "bigint" : "number";
  if (count === 1) return item;
  if (count > TUPLE) return `${item}[]`;
  if (name !== "place" && item === "number" && LISTS[count]) return LISTS[count];
  return `[${new Array(count).fill(item).join(", ")}]`;
}

// Structs whose addresses the layer gives itself have none in their types.
function structs() {
  const parts = [];
  for (const { name: header, structs: list } of headers)
    for (const { name } of list) {
      const layout = layouts[name];
      if (!layout || name === "dpt_pose" || name === "dpt_compiled") continue;
      const shown = layout.fields.filter(
        field => !field.isOwnSize && field.type !== "p" && !/^reserved/.test(field.name),
      );
      const lines = shown.map(field => `  ${field.name}: ${typeOf(field)};`);
      parts.push(`/** ${name}: dynpoint/${header} */\nexport interface ${typeName(name)} {\n${lines.join("\n")}\n}`);
    }
  return parts.join("\n");
}

function constantsText() {
  const lines = Object.entries(constants).map(
    ([name, value]) => `  readonly ${name}: ${Number.isFinite(value) ? value : "number"};`,
  );
  const results = headers.find(({ name }) => name === "result.h").enums.flatMap(({ values }) => values);
  const names = results.map(({ name }) => `"${name}"`).filter(name => name !== '"DPT_OK"');
  return `export type Result =\n  | ${names.join("\n  | ")};\nexport declare const constants: {\n${lines.join("\n")}\n};`;
}

const wide = new Set(["i64", "u64"]);
const passed = ({ type, pointers }) => (!pointers && wide.has(type) ? "bigint" : "number");

function exportsText() {
  const functions = core.headers.flatMap(header => header.functions);
  const lines = functions.map(({ name, result, parameters }) => {
    const list = parameters.map((one, k) => `${one.name ?? `a${k}`}: ${passed(one)}`);
    return `  ${name}(${list.join(", ")}): ${result.type === "void" && !result.pointers ? "void" : passed(result)};`;
  });
  const memory = "  readonly memory: WebAssembly.Memory;\n  readonly __heap_base: WebAssembly.Global;";
  return `export interface CoreExports {\n${memory}\n${lines.join("\n")}\n}`;
}

function types() {
  const made = { STRUCTS: structs(), CONSTANTS: constantsText(), EXPORTS: exportsText() };
  const text = read("index.d.ts").replace(/\/\*@(STRUCTS|CONSTANTS|EXPORTS)@\*\//g, (_, name) => made[name]);
  const [all, esm] = text.split("/*@MODULE@*/\n");
  return { "index.d.ts": all, "index.d.mts": all + esm };
}

const version = { version: abi.version };
const { name, ...rest } = JSON.parse(read("package.json"));
const layer = fs.readFileSync(path.join(wasm, "dynpoint.js"), "utf8");
const files = {
  ...types(),
  "package.json": `${JSON.stringify({ name, ...version, ...rest }, null, 2)}\n`,
  "browser.mjs": read("browser.mjs").replace("/*@LAYER@*/", () => layer),
  "dynpoint.js": layer,
};
fs.rmSync(out, { recursive: true, force: true });
fs.mkdirSync(out, { recursive: true });
for (const [file, text] of Object.entries(files)) fs.writeFileSync(path.join(out, file), text);
for (const file of ["node.js", "node.mjs", "README.md", "NOTICE"])
  fs.copyFileSync(path.join(from, file), path.join(out, file));
for (const file of ["dynpoint.wasm", "dynpoint_compile.wasm"])
  fs.copyFileSync(path.join(wasm, file), path.join(out, file));
fs.copyFileSync(path.join(root, "LICENSE"), path.join(out, "LICENSE"));
fs.cpSync(path.join(from, "samples"), path.join(out, "samples"), { recursive: true });
