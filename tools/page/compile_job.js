// SPDX-License-Identifier: BSD-3-Clause
// From a mesh as a tool exported it to a .dpa, in a worker of its own, which ends after it: ticks do not wait for it,
// and what memory it took is given back.
"use strict";
const compileJob = (() => {
  const EXTENT = 0.2; // m: the longest side of a visitor's mesh, so that it fits the hand

  const sidesOf = ({ boxMin, boxMax }) => boxMin.map((low, k) => boxMax[k] - low);

  // A reason for a person. What traps has run out of memory or of its stack, as far as can be told.
  const reasonOf = error =>
    error instanceof WebAssembly.RuntimeError || error instanceof RangeError
      ? "it needs more memory than this browser gives a page"
      : error.message;

  // job: { core, compiler, source, options, fits }; fits: it is scaled. To { file, sides, scale }, or { refused }
  async function run(dynpoint, { core, compiler, source, options = {}, fits = false }) {
    try {
      const made = await dynpoint.openCompiler(compiler);
      const file = made.compile(source, options);
      if (!fits) return { file, scale: 1 };
      const sides = sidesOf((await dynpoint.openCore(core)).openMesh(file).info);
      const scale = EXTENT / Math.max(...sides);
      return { file: made.compile(source, { ...options, scale }), sides, scale };
    } catch (error) {
      return { refused: reasonOf(error) };
    }
  }

  return { run, EXTENT };
})();
