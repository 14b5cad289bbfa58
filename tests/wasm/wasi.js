// SPDX-License-Identifier: BSD-3-Clause
// node wasi.js PROGRAM.wasm ARGUMENTS...: runs a program that was compiled for WASI.
"use strict";
const fs = require("fs");
const { WASI } = require("wasi");
const wasi = new WASI({ version: "preview1", args: process.argv.slice(2) });
const program = new WebAssembly.Module(fs.readFileSync(process.argv[2]));
process.exitCode = wasi.start(new WebAssembly.Instance(program, wasi.getImportObject()));
