// SPDX-License-Identifier: BSD-3-Clause
/*
 * dynpoint in JavaScript: typed arrays in, objects out. docs/javascript.md is its manual.
 *
 *     const core = await dynpoint.openCore(bytes of dynpoint.wasm);
 *     const compiler = await dynpoint.openCompiler(bytes of dynpoint_compile.wasm);
 *     const mesh = core.openMesh(compiler.compile(bytes of an OBJ, STL, PLY or OFF));
 *     const world = core.createWorld();
 *     world.addBody(mesh);
 *     const tool = world.addTool([[0, 0, 0, 0, 0, 0.15, 0.002]]);
 *     world.setToolPose(tool, [x, y, z, 1, 0, 0, 0]);
 *     world.step(0.001);
 *     world.getHit(tool).distance, world.getWrench(tool).force
 *
 * Fields have the names of the C headers in camel case, and mean what these say. A classic script sets `dynpoint`; node
 * requires it.
 */
"use strict";
(root => {
  // Each public struct: its bytes, and its fields: name, type, offset, items. Each public constant. Made by the build.
  const STRUCTS = {/*@STRUCTS@*/};
  const CONSTANTS = {/*@CONSTANTS@*/};

/*@FILE wasm_memory.js@*/
  async function instantiate(bytes) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return instance.exports;
  }

/*@FILE wasm_core.js@*/
/*@FILE wasm_world.js@*/
/*@FILE wasm_compiler.js@*/
  const dynpoint = {
    DynpointError,
    constants: CONSTANTS,
    openCore: async bytes => new Core(await instantiate(bytes)),
    async openCompiler(bytes) {
      const exports = await instantiate(bytes);
      exports._initialize();
      return new Compiler(exports);
    },
  };
  if (typeof module === "object") module.exports = dynpoint;
  else root.dynpoint = dynpoint;
})(globalThis);
