// SPDX-License-Identifier: BSD-3-Clause
// A tool comes down on a box and feels it: node touch.mjs
import { constants, openCompiler, openCore } from "dynpoint";

const BOX = `v -.05 -.05 -.05\nv .05 -.05 -.05\nv -.05 .05 -.05\nv .05 .05 -.05
v -.05 -.05 .05\nv .05 -.05 .05\nv -.05 .05 .05\nv .05 .05 .05
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n`;

const [core, compiler] = await Promise.all([openCore(), openCompiler()]);
const mesh = core.openMesh(compiler.compile(new TextEncoder().encode(BOX))); // an OBJ, STL, PLY or OFF; m
const world = core.createWorld({ stiffness: 500 }); // N/m
world.addBody(mesh);
const tool = world.addTool([[-0.02, 0, 0, 0.02, 0, 0, 0.002]]); // a, b, radius, m

for (let tick = 0; tick <= 20; tick++) {
  const height = 0.06 - 0.0005 * tick;
  world.setToolPose(tool, [0, height, 0, 1, 0, 0, 0]); // position, unit quaternion
  world.step(0.001);
  const { contact, gap } = world.getHit(tool);
  const { force } = world.getWrench(tool);
  const touches = contact >= constants.DPT_CONTACT_TOUCHING ? "touches" : "is free";
  console.log(`${height.toFixed(4)} m: ${touches}, gap ${(1000 * gap).toFixed(3)} mm, force ${force[1].toFixed(3)} N`);
}
