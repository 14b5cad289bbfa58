// SPDX-License-Identifier: BSD-3-Clause
// dynpoint for node: the layer, with the modules that lie beside it where no other is given.
"use strict";
const { readFileSync } = require("fs");
const path = require("path");
const layer = require("./dynpoint.js");

const own = name => readFileSync(path.join(__dirname, name));

module.exports = {
  ...layer,
  openCore: async source => layer.openCore(source ?? own("dynpoint.wasm")),
  openCompiler: async source => layer.openCompiler(source ?? own("dynpoint_compile.wasm")),
};
