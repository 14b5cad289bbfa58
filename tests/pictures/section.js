// SPDX-License-Identifier: BSD-3-Clause
// The scenes of the drawings: a profile in the plane z = 0, extruded to a mesh, and a tool in that plane. What is nearest
// to the tool lies in the plane too, so a drawing of the plane shows the answer whole. Lengths are in m; what a drawing
// says is in mm. Curves go through stated points by + - * / alone, so they are the same on every machine.
"use strict";
const fs = require("fs");
const path = require("path");

// Opens the core and the compiler that `make wasm` has made in a folder.
async function openLibrary(folder) {
  const dynpoint = require(path.resolve(folder, "dynpoint.js"));
  const bytes = name => fs.readFileSync(path.join(folder, name));
  const core = await dynpoint.openCore(bytes("dynpoint.wasm"));
  const compiler = await dynpoint.openCompiler(bytes("dynpoint_compile.wasm"));
  return { core, compiler, constants: dynpoint.constants };
}

// A curve of Catmull and Rom through points in mm, each span cut into so many pieces.
function curve(points, pieces) {
  const places = [];
  const last = points.length - 1;
  for (let k = 0; k < last; k++) {
    const [a, b, c, d] = [points[Math.max(0, k - 1)], points[k], points[k + 1], points[Math.min(last, k + 2)]];
    for (let i = 0; i < pieces; i++) {
      const t = i / pieces;
      places.push([0, 1].map(j => b[j] + 0.5 * t * (c[j] - a[j] + t * (2 * a[j] - 5 * b[j] + 4 * c[j] - d[j] + t * (3 * (b[j] - c[j]) + d[j] - a[j])))));
    }
  }
  return [...places, points[last]];
}

// A mesh of an open profile in mm: a strip of quads to both sides of the plane. With a floor, the height of a flat bottom
// in mm, it is a solid with caps. The profile goes from left to right, and its upper side is the outside.
function extrude({ core, compiler }, profile, { floor, half = 80 } = {}) {
  const isSolid = floor !== undefined;
  const ring = isSolid ? [...profile, ...profile.map(([x]) => [x, floor]).reverse()] : profile;
  const count = ring.length;
  const vertices = [half, -half].flatMap(z => ring.flatMap(([x, y]) => [x, y, z].map(value => value / 1000)));
  const corners = [];
  for (let k = 0; k < (isSolid ? count : count - 1); k++) {
    const next = (k + 1) % count;
    corners.push(k, next, count + next, k, count + next, count + k);
  }
  for (let k = 0; isSolid && k + 1 < profile.length; k++) {
    const [below, besideBelow] = [count - 1 - k, count - 2 - k];
    for (const [a, b, c] of [
      [k, below, k + 1],
      [k + 1, below, besideBelow],
    ])
      corners.push(a, b, c, count + a, count + c, count + b);
  }
  const file = compiler.compileArrays(Float64Array.from(vertices), Uint32Array.from(corners));
  return core.openMesh(file);
}

// Where the mesh's triangles cut the plane z = 0: a pair of places in m, and the triangle's number in its source.
function cut(mesh) {
  const xyz = mesh.getVertices();
  const { corners, numbers } = mesh.getTriangles();
  const place = k => Array.from(xyz.subarray(3 * k, 3 * k + 3));
  const pieces = [];
  numbers.forEach((triangle, k) => {
    const three = [0, 1, 2].map(i => place(corners[3 * k + i]));
    const ends = [];
    for (let i = 0; i < 3; i++) {
      const [a, b] = [three[i], three[(i + 1) % 3]];
      if (a[2] < 0 === b[2] < 0) continue;
      const t = a[2] / (a[2] - b[2]);
      ends.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
    }
    if (ends.length === 2) pieces.push({ triangle, ends, corners: three.flat() });
  });
  return pieces;
}

const flat = ([x, y]) => [x, y];
const mm = values => values.map(value => value / 1000);
const segment = (a, b, radius) => [...mm(a), 0, ...mm(b), 0, radius / 1000];

// A straight tool of a length and radius in mm, in its own frame along x, its origin in the middle.
const straight = (length, radius) => segment([-length / 2, 0], [length / 2, 0], radius);

// The pose of such a tool that lies between two places in mm: half the turn by square roots alone.
function poseBetween(a, b) {
  const [x, y] = [b[0] - a[0], b[1] - a[1]];
  const cosine = x / Math.sqrt(x * x + y * y);
  const w = Math.sqrt((1 + cosine) / 2);
  const z = Math.sqrt((1 - cosine) / 2) * (y < 0 ? -1 : 1);
  return [...mm([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]), 0, w, 0, 0, z];
}

// The ends of such a tool at a pose, in m.
function endsAt(pose, length) {
  const [x, y, , w, , , z] = pose;
  const half = length / 2000;
  const [c, s] = [w * w - z * z, 2 * w * z];
  return { a: [x - half * c, y - half * s], b: [x + half * c, y + half * s] };
}

// A world with one body and one tool at the place of its first step.
function worldOf({ core }, mesh, tool, def = {}) {
  const world = core.createWorld({ maxContacts: 32, ...def });
  world.addBody(mesh);
  return { world, tool: world.addTool([tool]) };
}

// What the library says of a tool that stands still between two places in mm. Its contacts are at the same pose.
function standing(library, mesh, { from, to, length, radius, ...def }) {
  const pose = poseBetween(from, to);
  const { world, tool } = worldOf(library, mesh, straight(length, radius), { law: library.constants.DPT_LAW_POINT, ...def });
  world.setToolPose(tool, pose);
  world.step(0.001);
  const answer = { hit: world.getHit(tool), contacts: world.getContacts(tool), ...endsAt(pose, length) };
  world.close();
  return answer;
}

// Points of an axis as the library sees them, from a to b in so many steps: height (the gap of a point) and triangle.
function profileAlong({ core }, mesh, a, b, steps) {
  const count = steps + 1;
  const ends = new Float64Array(6 * count);
  for (let k = 0; k < count; k++) {
    const t = k / steps;
    const place = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0];
    ends.set([...place, ...place], 6 * k);
  }
  const call = hits => {
    const from = core.heap.allocate(ends.byteLength);
    core.memory.put(from, ends);
    core.check(core.exports.dpt_query_segments(mesh.pointer, 0, from, 0, count, hits, 0));
    core.heap.release(from);
    return count;
  };
  return readArray(core, 128, count, call, at => core.memory.read("dpt_hit", at));
}

// An array of structs that a call fills: it is given the place, and returns how many there are.
function readArray(core, bytes, capacity, call, read) {
  const array = core.heap.allocate(bytes * capacity);
  core.memory.look().bytes.fill(0, array, array + bytes * capacity);
  core.memory.view.setUint32(array, bytes, true);
  const count = call(array);
  core.memory.look();
  const list = Array.from({ length: count }, (_, k) => read(array + k * bytes));
  core.heap.release(array);
  return list;
}

// What lies under a tool's segment: of each triangle of its strip the relation to the tool (dpt_overlap of strip.h, which
// the JavaScript layer does not read).
function stripOf({ core }, world, tool) {
  const capacity = 1024;
  const call = at => world.made(count => core.exports.dpt_tool_get_strip(world.world, tool, 0, at, capacity, count, 0));
  return readArray(core, 96, capacity, call, at => {
    const { view } = core.memory;
    const [q, overlap] = [[32, 40, 48].map(k => view.getFloat64(at + k, true)), view.getFloat64(at + 88, true)];
    return { triangle: view.getUint32(at + 4, true), q, overlap };
  });
}

// The first touch of a tool's segment between the last two steps (dpt_sweep of contact.h).
function sweepOf({ core, constants }, world, tool) {
  const call = at => (core.check(core.exports.dpt_tool_get_sweep(world.world, tool, 0, at)), 1);
  const [sweep] = readArray(core, 88, 1, call, at => {
    const { view } = core.memory;
    const three = k => [0, 8, 16].map(i => view.getFloat64(at + k + i, true));
    const [status, triangle] = [4, 16].map(k => view.getUint32(at + k, true));
    return { status, triangle, time: view.getFloat64(at + 24, true), q: three(40), normal: three(64) };
  });
  if (sweep.status !== constants.DPT_SWEEP_HIT) throw new Error(`the sweep met nothing: its status is ${sweep.status}`);
  return sweep;
}

// The distance of a segment and a triangle, each in m.
function distanceOf({ core }, a, b, corners) {
  const at = core.place(0);
  core.memory.look();
  new Float64Array(core.memory.buffer, at, 15).set([...a, 0, ...b, 0, ...corners]);
  const more = core.place(1);
  const distance = core.exports.dpt_segment_triangle(at, at + 48, more, more + 8, more + 32);
  const [, px, py, pz, qx, qy, qz] = new Float64Array(core.memory.look().buffer, more, 7);
  return { distance, p: [px, py, pz], q: [qx, qy, qz] };
}

module.exports = {
  openLibrary, curve, extrude, cut, flat, mm, segment, straight, poseBetween, endsAt, worldOf, standing, profileAlong, stripOf, sweepOf, distanceOf,
};
