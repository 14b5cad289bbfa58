// SPDX-License-Identifier: BSD-3-Clause
// Drawings of what a tick looks for: the strip, the certificate, the sweep.
"use strict";
const { curve, extrude, cut, straight, poseBetween, endsAt, worldOf, stripOf, sweepOf, distanceOf } = require("./section.js");
const { HILLS, hills, panel, drawBody, drawTool, between, inMm, mm, COLOURS, number, add, lineOf } = require("./concept_parts.js");

const CELLS = [30, 20]; // of the field, each two triangles
const SIZE = [132, 88]; // mm

// Heights of a field at u and v in -1..1, in mm: a bump, a hollow, and a slope.
const heightAt = (u, v) => {
  const bump = (a, b, wide) => 1 / (1 + wide * ((u - a) * (u - a) + (v - b) * (v - b)));
  return 13 * bump(-0.25, 0.1, 5) - 9 * bump(0.55, -0.45, 7) + 3 * v;
};

function field({ core, compiler }) {
  const [columns, rows] = CELLS;
  const vertices = [];
  for (let j = 0; j <= rows; j++)
    for (let i = 0; i <= columns; i++) {
      const [u, v] = [(2 * i) / columns - 1, (2 * j) / rows - 1];
      vertices.push(...mm([(u * SIZE[0]) / 2, (v * SIZE[1]) / 2, heightAt(u, v)]));
    }
  const corners = [];
  for (let j = 0; j < rows; j++)
    for (let i = 0; i < columns; i++) {
      const k = j * (columns + 1) + i;
      const [right, up] = [k + 1, k + columns + 1];
      corners.push(...((i + j) % 2 ? [k, right, up, right, up + 1, up] : [k, right, up + 1, k, up + 1, up]));
    }
  return core.openMesh(compiler.compileArrays(Float64Array.from(vertices), Uint32Array.from(corners)));
}

// What lies under a tool: for each triangle of its strip its relation to the tool.
function stripUnder({ core, constants }, mesh, tool, def) {
  const world = core.createWorld({ law: constants.DPT_LAW_POINT, maxContacts: 32, strip: constants.DPT_STRIP_KIND_SHADOW, ...def });
  world.addBody(mesh);
  const one = world.addTool([tool]);
  world.step(0.001);
  const overlaps = stripOf({ core }, world, one);
  world.close();
  return overlaps;
}

function drawStrip(library) {
  const mesh = field(library);
  const radius = 3;
  const width = 2;
  const [a, b] = [
    [-46, -10, 14],
    [14, 16, 11.5],
  ];
  const tool = [...mm(a), ...mm(b), radius / 1000];
  const strip = stripUnder(library, mesh, tool, { stripWidth: width / 1000, stripDepth: 0.02 });
  const inStrip = new Map(strip.map(item => [item.triangle, item]));
  const pressed = strip.filter(({ overlap }) => overlap > 0);
  const view = panel({
    height: 440,
    title: "The strip: the triangles under a tool",
    description:
      `A tool lies over a surface of ${2 * CELLS[0] * CELLS[1]} triangles, seen from above at a slant. ${strip.length} of them are ` +
      `in its strip, and are coloured; ${pressed.length} of these touch the tool, and are hatched.`,
  });
  const { drawing } = view;
  // From above at a slant of 3 : 4.
  const place = ([x, y, z]) => [360 + 5000 * x, 246 - 5000 * (0.72 * y + 0.6 * z)];
  drawing.parts.push(
    `<pattern id="hatch" width="5" height="5" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">` +
      `<rect width="5" height="5" fill="${COLOURS.contact}"/><rect width="1.8" height="5" fill="${COLOURS.edge}"/></pattern>`,
  );
  const xyz = mesh.getVertices();
  const { corners, numbers } = mesh.getTriangles();
  const faces = Array.from(numbers, (triangle, k) => {
    const three = [0, 1, 2].map(i => Array.from(xyz.subarray(3 * corners[3 * k + i], 3 * corners[3 * k + i] + 3)));
    return { triangle, three, far: three.reduce((sum, [, y]) => sum + y, 0) };
  }).sort((one, other) => other.far - one.far || one.triangle - other.triangle);
  drawing.group({ stroke: "#a8a297", "stroke-width": 0.6, "stroke-linejoin": "round" }, () => {
    for (const { triangle, three } of faces) {
      const item = inStrip.get(triangle);
      const fill = !item ? shade(three) : item.overlap > 0 ? "url(#hatch)" : "#f3d28c";
      drawing.put("path", { d: lineOf(three.map(place)), fill });
    }
  });
  drawing.capsule(place(mm(a)), place(mm(b)), 5 * radius, { fill: "#0072b255", width: 2.2 });
  drawing.path([place(mm(a)), place(mm(b))], { stroke: COLOURS.tool, width: 1.4, "stroke-dasharray": "8 4" });
  drawing.label("tool", add(place(mm(a)), [-24, 0]), { anchor: "end", kind: "strong" });
  drawing.label(`strip: ${strip.length} of ${2 * CELLS[0] * CELLS[1]} triangles`, [24, 34], { kind: "strong" });
  drawing.label(`hatched: ${pressed.length} that the tool touches`, [24, 55]);
  const least = strip.reduce((one, other) => (other.overlap > one.overlap ? other : one));
  const target = place(least.q);
  drawing.dot(target, { radius: 4 });
  drawing.callout(`the most overlap: ${inMm(least.overlap)}`, [500, 52], target, { side: "left" });
  mesh.close();
  return drawing;
}

// Greys by how a face lies to a light from the upper left.
function shade([a, b, c]) {
  const [u, v] = [b, c].map(p => p.map((value, k) => value - a[k]));
  const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.sqrt(normal.reduce((sum, value) => sum + value * value, 0));
  const light = (-0.5 * normal[0] + 0.3 * normal[1] + 0.8 * normal[2]) / length;
  const grey = Math.round(150 + 95 * Math.max(0, Math.min(1, light)));
  return `rgb(${grey},${grey - 2},${grey - 7})`;
}

const FLIGHT = { length: 44, radius: 0, ticks: 20, from: [[-6, 22], [38, 19]], to: [[-8, 17], [35, 20]] };

// The hits of a tool that moves from place to place, a tick each, with what earlier ticks have proven.
function flight(library, mesh, { length, radius, ticks, from, to }) {
  const { world, tool } = worldOf(library, mesh, straight(length, radius), { until: library.constants.DPT_UNTIL_TRACK });
  const hits = [];
  for (let k = 0; k <= ticks; k++) {
    const pose = poseBetween(...[0, 1].map(i => between(from[i], to[i], k / ticks)));
    world.setToolPose(tool, pose);
    world.step(0.001);
    hits.push({ ...world.getHit(tool), ...endsAt(pose, length) });
  }
  world.close();
  return hits;
}

// The plane across the nearest pair of an axis and a triangle: n and h, with n.x >= h on the triangle.
function planeOf(library, { a, b }, corners) {
  const { distance, p, q } = distanceOf(library, a, b, corners);
  const n = q.map((value, k) => (value - p[k]) / distance);
  const support = [0, 3, 6].map(k => n[0] * corners[k] + n[1] * corners[k + 1] + n[2] * corners[k + 2]);
  return { n, h: Math.min(...support), q };
}

function drawCertificate(library) {
  const mesh = hills(library);
  const hits = flight(library, mesh, FLIGHT);
  const [first, last] = [hits[0], hits[FLIGHT.ticks]];
  const piece = cut(mesh).find(({ ends }) => ends.every(([x, y]) => x > -0.0335 && x < -0.026 && y > 0));
  const { n, h, q } = planeOf(library, first, piece.corners);
  const reach = ({ a, b }) => [a, b].map(end => n[0] * end[0] + n[1] * end[1]);
  const bound = h - Math.max(...reach(last));
  const true_ = distanceOf(library, last.a, last.b, piece.corners).distance;
  if (!(bound > last.distance && bound <= true_)) throw new Error("the certificate's drawing: the plane closes nothing");
  const view = panel({
    height: 360,
    scale: 7,
    centre: [2, 8],
    title: "A certificate: a triangle that need not be looked at again",
    description:
      `Between a tool and a triangle that is far away lies a plane that was found when the tool was at its first place. ` +
      `${FLIGHT.ticks} ticks later the tool has moved, and is still ${inMm(bound)} in front of the plane, farther than the nearest pair, ` +
      `${inMm(last.distance)}. So the triangle cannot be the nearest one, and it is not looked at.`,
  });
  const { drawing, place } = view;
  drawBody(view, mesh, { label: "body", at: [-27, -10] });
  const foot = [0, 1].map(k => q[k]);
  const along = [-n[1], n[0]];
  const line = [-0.026, 0.026].map(t => place([foot[0] + t * along[0], foot[1] + t * along[1]]));
  drawing.path(line, { stroke: COLOURS.other, width: 2.4, "stroke-dasharray": "10 3 2 3" });
  drawing.label("separating plane", add(line[n[0] < 0 ? 0 : 1], [10, 4]), { kind: "strong" });
  drawing.path(piece.ends.map(place), { stroke: COLOURS.contact, width: 7 });
  drawing.callout(`triangle ${piece.triangle}`, add(between(...piece.ends.map(place), 0.5), [-70, 70]), between(...piece.ends.map(place), 0.5), { side: "above", kind: "strong" });
  drawing.path([place(first.a), place(first.b)], { stroke: COLOURS.tool, width: 1.6, "stroke-dasharray": "3 5" });
  drawing.path([place(last.a), place(last.b)], { stroke: COLOURS.tool, width: 3 });
  const near = reach(last)[0] > reach(last)[1] ? last.a : last.b;
  drawing.dimension(place(near), place([near[0] + bound * n[0], near[1] + bound * n[1]]), { stroke: COLOURS.force });
  drawing.label(`at least ${inMm(bound)}`, add(place(near), [-44, -18]), { anchor: "middle", kind: "strong" });
  drawing.path([place(last.p), place(last.q)], { width: 2.2 });
  for (const dot of [last.p, last.q]) drawing.dot(place(dot), { radius: 4.5 });
  drawing.label(`nearest pair: ${inMm(last.distance)}`, add(between(place(last.p), place(last.q), 0.5), [-12, 5]), { anchor: "end", kind: "strong" });
  drawing.label("the axis when the plane was found", add(place(first.a), [30, -14]), { kind: "small" });
  drawing.label(`${FLIGHT.ticks} ticks later`, add(place(between(last.a, last.b, 0.5)), [0, 26]), { anchor: "middle", kind: "small" });
  mesh.close();
  return drawing;
}

function drawSweep(library) {
  const mesh = extrude(library, curve(HILLS.map(([x, y]) => [x, 0.6 * y]), 4));
  const [length, radius] = [60, 3];
  const [from, to] = [
    [[-58, 18], [-2, 26]],
    [[-44, -22], [12, -14]],
  ];
  const { constants } = library;
  const { world, tool } = worldOf(library, mesh, straight(length, radius), { law: constants.DPT_LAW_POINT });
  const poses = [from, to].map(ends => poseBetween(...ends));
  for (const pose of poses) {
    world.setToolPose(tool, pose);
    world.step(0.001);
    if (!(world.getHit(tool).distance > radius / 1000)) throw new Error("the sweep's drawing: the tool touches at a tick");
  }
  const sweep = sweepOf(library, world, tool);
  world.close();
  const places = poses.map(pose => endsAt(pose, length));
  const touch = { a: between(places[0].a, places[1].a, sweep.time), b: between(places[0].b, places[1].b, sweep.time) };
  const way = add(poses[1], poses[0], -1);
  const speed = 1000 * Math.sqrt(way[0] * way[0] + way[1] * way[1]);
  const view = panel({
    height: 400,
    title: "The sweep: what the tool met between two ticks",
    description:
      `Within one tick of 1 ms a tool moves through a thin sheet, at ${number(speed, 1)} m/s. It does not touch the sheet where it was and ` +
      `not where it is. The sweep finds the first touch at ${number(100 * sweep.time, 1)} % of the motion, at the point q of triangle ${sweep.triangle}.`,
    centre: [2, 4],
  });
  const { drawing, place } = view;
  for (const { ends } of cut(mesh)) drawing.path(ends.map(place), { stroke: COLOURS.edge, width: 3 });
  drawing.label("an open sheet", place(mm([60, 1])), { anchor: "middle", kind: "small" });
  drawTool(view, places[0], radius, { axis: false });
  drawTool(view, places[1], radius, { dash: "7 4", axis: false });
  drawTool(view, touch, radius, { stroke: COLOURS.contact, axis: false, fill: "#e69f0055", width: 2.6 });
  for (const end of ["a", "b"]) drawing.path([place(places[0][end]), place(places[1][end])], { stroke: COLOURS.faint, width: 1, "stroke-dasharray": "2 4" });
  drawing.arrow(place(between(places[0].a, places[1].a, 0.7)), place(between(places[0].a, places[1].a, 0.86)), { stroke: COLOURS.faint, width: 1.4 });
  drawing.label("last tick", add(place(places[0].b), [26, 0]), { kind: "strong" });
  drawing.label(`this tick, at ${number(speed, 1)} m/s`, add(place(places[1].b), [26, 12]), { kind: "strong" });
  drawing.label(`first touch: ${number(100 * sweep.time, 1)} % of the motion`, add(place(touch.b), [26, 2]), { kind: "strong" });
  const q = place(sweep.q);
  drawing.dot(q, { radius: 5 });
  const out = [sweep.normal[0], -sweep.normal[1]];
  drawing.arrow(q, add(q, out, 52), { stroke: COLOURS.proxy, width: 2.5, head: 11 });
  drawing.callout(`q, on triangle ${sweep.triangle}`, add(q, [44, 62]), q, { side: "above", kind: "strong" });
  drawing.label("normal", add(add(q, out, 46), [-10, 0]), { anchor: "end" });
  mesh.close();
  return drawing;
}

module.exports = { strip: drawStrip, certificate: drawCertificate, sweep: drawSweep };
