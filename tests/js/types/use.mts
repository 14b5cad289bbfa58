// SPDX-License-Identifier: BSD-3-Clause
// What `tsc --strict` takes and refuses: each line behind @ts-expect-error is an error, or tsc fails.
import dynpoint, { constants, DynpointError, Loop, openCompiler, openCore } from "dynpoint";
import type { Contact, Core, Hit, LoopInfo, Pose, Settings, Step, Vector, WorldDef } from "dynpoint";

const core: Core = await openCore();
const compiler = await openCompiler(new Uint8Array(8));
const file: Uint8Array = compiler.compile(new ArrayBuffer(8), {
  scale: 0.001,
  springs: {
    kind: "sheet",
    bending: 2,
    fixed: new Set([1]),
    regions: [{ kind: constants.DPT_REGION_BOX, young: 1e4 }],
  },
});
const def: Settings<WorldDef> = { stiffness: 500, maxTools: 2 };
const world = core.createWorld(def);
const mesh = core.openMesh(file);
const body = world.addBody(mesh, [0, 0, 0, 1, 0, 0, 0]);
const tool = world.addTool([[0, 0, 0, 0, 0.15, 0, 0.002], new Float64Array(7)]);
const pose: Pose = world.getToolPose(tool);
world.setToolPose(tool, pose);
world.setToolPose(tool, new Float64Array(7));
world.setToolSettings(tool, { law: constants.DPT_LAW_PROXY });
const step: Step = world.step(0.001);
const nothing: void = world.step(0.001, false);
const hit: Hit = world.getHit(tool);
const place: Vector = hit.p;
const contacts: Contact[] = world.getContacts(tool);
const hash: bigint = mesh.info.sourceHash;
const ok: 0 = constants.DPT_OK;
const bytes: number = core.exports.dpt_world_bytes(0);
const info: LoopInfo = await new Loop(number => console.log(number + 1), { wait: "sleep" }).run();
try {
  dynpoint.constants.DPT_NONE;
} catch (error) {
  if (error instanceof DynpointError && error.code === "DPT_E_HANDLE") console.log(error.line ?? 0);
}
console.log(body, step.contact, nothing, place[2], contacts.length, hash, ok, bytes, info.late.p99);

// @ts-expect-error: no such field
core.createWorld({ maxTool: 2 });
// @ts-expect-error: a list for a number
core.createWorld({ maxTools: [2] });
// @ts-expect-error: an address
world.addDeform(mesh, { compliances: 7 });
// @ts-expect-error: three numbers are no pose
world.setToolPose(tool, [0, 0, 0]);
// @ts-expect-error: floats of 32 bits are no pose
world.setToolPose(tool, new Float32Array(7));
// @ts-expect-error: what is told is not there
world.step(0.001, false).contact;
// @ts-expect-error: no such field of a hit
hit.depths;
// @ts-expect-error: a hit has no size
hit.size;
// @ts-expect-error: hashes are BigInts
const sum: number = mesh.info.sourceHash;
// @ts-expect-error: vertices are floats
world.setVertices(body, new Float64Array(9));
// @ts-expect-error: no such format
compiler.compile(file, { format: "step" });
// @ts-expect-error: springs have a kind
compiler.compile(file, { springs: { young: 1 } });
// @ts-expect-error: no such constant
constants.DPT_LAW_SPRING;
// @ts-expect-error: constants stay
constants.DPT_OK = 1;
// @ts-expect-error: another number
const law: 1 = constants.DPT_LAW_PROXY;
// @ts-expect-error: a mesh is no world
core.createWorld().addBody(world);
// @ts-expect-error: inner parts have no type
core.heap;
// @ts-expect-error: no such way
new Loop(() => {}, { wait: "rest" });
// @ts-expect-error: no such result
if (new DynpointError("DPT_E_HANDLE", "").code === "DPT_E_HANDEL") console.log(sum, law);
