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
  // source: the bytes of a module, or a WebAssembly.Module, which several threads may share
  async function instantiate(source) {
    const isModule = source instanceof WebAssembly.Module;
    const module = isModule ? source : await WebAssembly.compile(bytesOf(source, "a module"));
    return (await WebAssembly.instantiate(module, {})).exports;
  }

/*@FILE wasm_core.js@*/
/*@FILE wasm_world.js@*/
/*@FILE wasm_compiler.js@*/
/*@FILE paced_loop.js@*/
  const dynpoint = {
    DynpointError,
    constants: CONSTANTS,
    layouts,
    Pace,
    Loop,
    openCore: async source => new Core(await instantiate(source)),
    async openCompiler(source) {
      const exports = await instantiate(source);
      exports._initialize();
      return new Compiler(exports);
    },
  };
  if (typeof module === "object") module.exports = dynpoint;
  else root.dynpoint = dynpoint;
})(globalThis);
