// SPDX-License-Identifier: BSD-3-Clause
// A loop of 1 kHz, in a worker of a browser or of node. It hears where the tool is, { pose }, and tells what is felt,
// { force }, 60 times a second; it ends at { stop }.
import { Loop, openCompiler, openCore } from "dynpoint";

const port = globalThis.postMessage ? globalThis : (await import("node:worker_threads")).parentPort;
const [core, compiler] = await Promise.all([openCore(), openCompiler()]);
let [loop, world, tool, pose] = [];

port.onmessage = ({ data }) => {
  if (data.file) begin(data);
  else if (data.pose) pose = data.pose;
  else if (data.stop) loop?.stop();
};
port.postMessage({ ready: true });

// file: the bytes of an OBJ, STL, PLY or OFF; options: of the loop
async function begin({ file, options, ...data }) {
  try {
    world = core.createWorld({ stiffness: 500 });
    world.addBody(core.openMesh(compiler.compile(file)));
    tool = world.addTool([[-0.02, 0, 0, 0.02, 0, 0, 0.002]]);
    pose = data.pose;
    loop = new Loop(tick, options);
    port.postMessage({ info: await loop.run() });
  } catch (error) {
    port.postMessage({ error: error.message });
  }
  port.close();
}

function tick(number) {
  world.setToolPose(tool, pose);
  world.step(0.001, false);
  if (number % 16 === 0) port.postMessage({ number, force: world.getWrench(tool).force });
}
