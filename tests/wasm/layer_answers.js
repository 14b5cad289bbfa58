// SPDX-License-Identifier: BSD-3-Clause
// What the WebAssembly module answers along a trace, as the bytes of its structs: what native_answers.c writes of the
// native library. Under node and in a browser.
"use strict";
const SNAPSHOT_EVERY = 64;
const BYTES = { hit: 128, wrench: 48, report: 104, count: 4, contact: 296 };

// rows of a CSV: numbers
const rowsOf = text =>
  text
    .trim()
    .split("\n")
    .slice(1)
    .map(line => line.split(",").map(Number));

// A body of this mesh in a new world, and a tool; steps is what a tick does to springs.
function sceneOf(core, mesh, law, kernel) {
  const world = core.createWorld({ law, kernel, maxContacts: 32 });
  const isSoft = mesh.info.springNodes > 0;
  const body = isSoft ? world.addDeform(mesh) : world.addBody(mesh);
  if (isSoft) world.addSprings(body);
  const tool = world.addTool([[0, 0, 0, 0, 0, 0.1, 0.002]]);
  const steps = isSoft ? () => world.stepSprings(body, 0.001) : () => {};
  return { world, tool, steps };
}

// take: is handed each piece of bytes, good until the next one
function answers(core, mesh, rows, law, kernel, take) {
  const { world, tool, steps } = sceneOf(core, mesh, law, kernel);
  const { memory } = core;
  const last = bytes => take(memory.look().bytes.subarray(core.place(0), core.place(0) + bytes));
  rows.forEach(([, ax, ay, az, bx, by, bz], row) => {
    world.setToolSegments(tool, [[ax, ay, az, bx, by, bz, 0.002]]);
    world.step(0.001);
    steps();
    world.getHit(tool);
    last(BYTES.hit);
    world.getWrench(tool);
    last(BYTES.wrench);
    world.getForceInfo(tool);
    last(BYTES.report);
    const { length } = world.getContacts(tool);
    last(BYTES.count);
    take(memory.bytes.subarray(world.room.at, world.room.at + length * BYTES.contact));
    if (row % SNAPSHOT_EVERY === 0) take(world.getSnapshot());
  });
  const { kernel: name } = world;
  world.close();
  return name;
}

// us a tick, of the same calls; the fastest of some passes, after one that lets the engine compile
function time(core, mesh, rows, law, kernel, passes) {
  let least = Infinity;
  for (let pass = 0; pass <= passes; pass++) {
    const { world, tool, steps } = sceneOf(core, mesh, law, kernel);
    const begin = performance.now();
    for (const [, ax, ay, az, bx, by, bz] of rows) {
      world.setToolSegments(tool, [[ax, ay, az, bx, by, bz, 0.002]]);
      world.step(0.001);
      steps();
      world.getHit(tool);
      world.getWrench(tool);
      world.getForceInfo(tool);
      world.getContacts(tool);
    }
    if (pass > 0) least = Math.min(least, (1e3 * (performance.now() - begin)) / rows.length);
    world.close();
  }
  return least;
}

if (typeof module === "object") module.exports = { rowsOf, answers, time };
