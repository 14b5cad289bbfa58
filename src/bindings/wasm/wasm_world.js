// SPDX-License-Identifier: BSD-3-Clause
// Worlds.
"use strict";

// A world and what it stands on. Bodies, tools: the numbers that addBody and addTool gave.
class World {
  constructor(core, def) {
    this.core = core;
    this.memory = core.memory;
    this.call = core.exports;
    this.meshes = new Map(); // of each body
    this.blocks = new Map(); // of each body that deforms: places in the heap
    this.springs = new Map();
    this.room = { bytes: 0, at: 0 };
    this.snapshot = { at: 0, bytes: 0 };
    const from = core.def("dpt_world_def", def, 1);
    const bytes = this.call.dpt_world_bytes(from);
    this.block = core.heap.allocate(bytes);
    const result = this.call.dpt_world_create(this.block, bytes, from, core.place(0));
    if (result !== CONSTANTS.DPT_OK) core.heap.release(this.block);
    core.check(result);
    this.world = this.memory.look().view.getUint32(core.place(0), true);
    this.kernel = core.kernelName(this.getInfo().kernel);
  }

  // A call that gives a number, as of a body.
  made(call) {
    this.core.check(call(this.core.place(0)));
    return this.memory.look().view.getUint32(this.core.place(0), true);
  }

  numbers(count, call) {
    this.core.check(call(this.core.place(0)));
    return this.memory.doublesAt(this.core.place(0), count);
  }

  pose(pose) {
    return this.core.plain("dpt_pose", pose, 1);
  }

  addBody(mesh, pose) {
    const from = this.placeOf(mesh);
    const body = this.made(at => this.call.dpt_body_add(this.world, from, this.pose(pose), at));
    this.hold(body, mesh);
    return body;
  }

  placeOf(mesh) {
    if (!(mesh instanceof Mesh)) throw new TypeError("a body is of a mesh that openMesh gave");
    return mesh.in(this.core);
  }

  hold(body, mesh) {
    mesh.users++;
    this.meshes.set(body, mesh);
  }

  // def: the fields of dpt_deformable_def but mesh and pose
  addDeform(mesh, def = {}, pose) {
    const { heap } = this.core;
    const own = { mesh: this.placeOf(mesh), pose: this.pose(pose) };
    const from = this.core.def("dpt_deformable_def", def, 2, own);
    const bytes = this.call.dpt_deformable_bytes(from);
    const block = heap.allocate(bytes);
    try {
      const body = this.made(at => this.call.dpt_body_add_deformable(this.world, block, bytes, from, at));
      this.hold(body, mesh);
      this.blocks.set(body, [block]);
      return body;
    } catch (error) {
      heap.release(block);
      throw error;
    }
  }

  // Springs of a mesh that was compiled with them; def: the fields of dpt_springs_def but mesh
  addSprings(body, def = {}) {
    const { heap } = this.core;
    if (this.springs.has(body)) throw new DynpointError("DPT_E_ARGUMENT", "this body has springs");
    if (!this.blocks.has(body)) throw new DynpointError("DPT_E_HANDLE", "no body that deforms has this id");
    const from = this.core.def("dpt_springs_def", def, 1, { mesh: this.meshes.get(body).in(this.core) });
    const bytes = this.call.dpt_springs_bytes(from);
    const block = heap.allocate(bytes);
    try {
      this.springs.set(
        body,
        this.made(at => this.call.dpt_springs_create(block, bytes, from, at)),
      );
      this.blocks.get(body).push(block);
    } catch (error) {
      heap.release(block);
      throw error;
    }
  }

  springsOf(body) {
    if (!this.springs.has(body)) throw new DynpointError("DPT_E_HANDLE", "this body has no springs");
    return this.springs.get(body);
  }

  // After a step of the world; what dpt_springs_info has
  stepSprings(body, dt) {
    const springs = this.springsOf(body);
    return this.core.get("dpt_springs_info", at => this.call.dpt_body_step_springs(this.world, body, springs, dt, at));
  }

  getSpringsEnergy(body) {
    const springs = this.springsOf(body);
    const [elastic, kinetic] = this.numbers(2, at => this.call.dpt_springs_get_energy(springs, at, at + 8));
    return { elastic, kinetic };
  }

  // positions: Float32Array, 3 a vertex, in the body's frame, from vertex `first` on. They move from where they were.
  setVertices(body, positions, first = 0) {
    checkArray(positions, Float32Array, 3, "a list of vertices");
    const count = positions.length / 3;
    this.withArray(positions, at =>
      this.core.check(this.call.dpt_body_set_vertices(this.world, body, first, count, at, -1)),
    );
  }

  getVertices(body) {
    const at = this.core.place(0);
    this.core.check(this.call.dpt_body_get_vertices(this.world, body, at, at + 4));
    const [xyz, count] = new Uint32Array(this.memory.look().buffer, at, 2);
    return new Float32Array(this.memory.buffer, xyz, 3 * count).slice();
  }

  removeBody(body) {
    this.core.check(this.call.dpt_body_remove(this.world, body));
    this.meshes.get(body).users--;
    this.meshes.delete(body);
    for (const block of this.blocks.get(body) ?? []) this.core.heap.release(block);
    this.blocks.delete(body);
    this.springs.delete(body);
  }

  setBodyPose(body, pose) {
    this.core.check(this.call.dpt_body_set_pose(this.world, body, this.pose(pose)));
  }

  teleportBody(body, pose) {
    this.core.check(this.call.dpt_body_teleport(this.world, body, this.pose(pose)));
  }

  getBodyPose(body) {
    return this.numbers(7, at => this.call.dpt_body_get_pose(this.world, body, at));
  }

  getBodySettings(body) {
    return this.core.get("dpt_body_settings", at => this.call.dpt_body_get_settings(this.world, body, at));
  }

  // Those fields that are given; the others stay.
  setBodySettings(body, settings) {
    this.getBodySettings(body);
    this.memory.write("dpt_body_settings", this.core.place(0), settings);
    this.core.check(this.call.dpt_body_set_settings(this.world, body, this.core.place(0)));
  }

  // segments: [ax, ay, az, bx, by, bz, radius] each, in the tool's frame, m
  addTool(segments) {
    return this.withSegments(segments, (from, count) =>
      this.made(at => this.call.dpt_tool_add(this.world, from, count, at)),
    );
  }

  setToolSegments(tool, segments) {
    this.withSegments(segments, (from, count) =>
      this.core.check(this.call.dpt_tool_set_segments(this.world, tool, from, count)),
    );
  }

  withSegments(segments, call) {
    const list = Array.from(segments, segment => Array.from(segment));
    if (list.length !== segments.length || list.some(segment => segment.length !== 7 || !segment.every(isNumber)))
      throw new TypeError("a segment is 7 numbers");
    return this.withArray(Float64Array.from(list.flat()), at => call(at, list.length));
  }

  // call(place of a copy of the array)
  withArray(array, call) {
    const at = this.core.heap.allocate(array.byteLength);
    try {
      this.memory.put(at, array);
      return call(at);
    } finally {
      this.core.heap.release(at);
    }
  }

  removeTool(tool) {
    this.core.check(this.call.dpt_tool_remove(this.world, tool));
  }

  // pose: [x, y, z, qw, qx, qy, qz], m and a unit quaternion
  setToolPose(tool, pose) {
    this.core.check(this.call.dpt_tool_set_pose(this.world, tool, this.pose(pose)));
  }

  teleportTool(tool, pose) {
    this.core.check(this.call.dpt_tool_teleport(this.world, tool, this.pose(pose)));
  }

  getToolPose(tool) {
    return this.numbers(7, at => this.call.dpt_tool_get_pose(this.world, tool, at));
  }

  getToolProxy(tool) {
    return this.numbers(7, at => this.call.dpt_tool_get_proxy(this.world, tool, at));
  }

  getToolEnd(tool) {
    return this.numbers(7, at => this.call.dpt_tool_get_end(this.world, tool, at));
  }

  getToolSettings(tool) {
    return this.core.get("dpt_tool_settings", at => this.call.dpt_tool_get_settings(this.world, tool, at));
  }

  setToolSettings(tool, settings) {
    this.getToolSettings(tool);
    this.memory.write("dpt_tool_settings", this.core.place(0), settings);
    this.core.check(this.call.dpt_tool_set_settings(this.world, tool, this.core.place(0)));
  }

  // One tick of dt seconds; what dpt_step has. isTold false: nothing, and a proxy's hits are found when they are read.
  step(dt, isTold = true) {
    if (!isTold) return this.core.check(this.call.dpt_world_step(this.world, dt, 0));
    return this.core.get("dpt_step", at => this.call.dpt_world_step(this.world, dt, at));
  }

  reset() {
    this.core.check(this.call.dpt_world_reset(this.world));
  }

  getInfo() {
    return this.core.get("dpt_world_info", at => this.call.dpt_world_get_info(this.world, at));
  }

  getHit(tool) {
    return this.core.get("dpt_hit", at => this.call.dpt_tool_get_hit(this.world, tool, at));
  }

  getSegmentHit(tool, segment) {
    return this.core.get("dpt_hit", at => this.call.dpt_tool_get_segment_hit(this.world, tool, segment, at));
  }

  // N and N m, at the origin of the tool's frame, along the world's axes
  getWrench(tool) {
    return this.core.wrench(at => this.call.dpt_tool_get_wrench(this.world, tool, at));
  }

  getForceInfo(tool) {
    return this.core.get("dpt_force_info", at => this.call.dpt_tool_get_force_info(this.world, tool, at));
  }

  // A block in place of another; where there is no room for it, that one has none.
  larger(block, bytes) {
    this.core.heap.release(block.at);
    Object.assign(block, { at: 0, bytes: 0 });
    return { at: this.core.heap.allocate(bytes), bytes };
  }

  // All structs that a call lists: call(array, capacity, place of the count).
  list(name, call) {
    const { bytes } = layouts[name];
    const count = this.made(at => call(0, 0, at));
    if (count * bytes > this.room.bytes) {
      this.room = this.larger(this.room, 2 * count * bytes);
    }
    if (count === 0) return [];
    this.memory.begin(name, this.room.at);
    const there = this.made(at => call(this.room.at, count, at));
    return Array.from({ length: there }, (_, k) => this.memory.read(name, this.room.at + k * bytes));
  }

  getContacts(tool) {
    return this.list("dpt_contact", (to, room, at) => this.call.dpt_tool_get_contacts(this.world, tool, to, room, at));
  }

  // The points at which the tool is pushed
  getLoads(tool) {
    return this.list("dpt_tool_load", (to, room, at) => this.call.dpt_tool_get_loads(this.world, tool, to, room, at));
  }

  // What all tools do to a body: N and N m, at the origin of its frame, along the world's axes
  getBodyWrench(body) {
    return this.core.wrench(at => this.call.dpt_body_get_wrench(this.world, body, at));
  }

  // A Uint8Array in the core's memory, good until the next call: the block of snapshot.h, the same bytes everywhere
  getSnapshot(def = {}) {
    const from = this.core.def("dpt_snapshot_def", def, 1);
    const bytes = this.call.dpt_snapshot_bytes(this.world, from);
    if (bytes > this.snapshot.bytes) {
      this.snapshot = this.larger(this.snapshot, bytes);
    }
    const taken = this.made(at =>
      this.call.dpt_world_take_snapshot(this.world, from, this.snapshot.at, this.snapshot.bytes, at),
    );
    return this.memory.look().bytes.subarray(this.snapshot.at, this.snapshot.at + taken);
  }

  // The world is gone after it; its meshes stay open. Once more does nothing.
  close() {
    if (this.world === 0) return;
    for (const mesh of this.meshes.values()) mesh.users--;
    for (const at of [this.block, this.room.at, this.snapshot.at, ...[...this.blocks.values()].flat()])
      this.core.heap.release(at);
    this.meshes.clear();
    this.blocks.clear();
    this.springs.clear();
    this.world = 0;
    this.call = closed("world");
  }
}
