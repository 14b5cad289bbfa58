// SPDX-License-Identifier: BSD-3-Clause
// Drawings of one pose: tool, nearest pair, gap, depth.
"use strict";
const { poseBetween, endsAt, standing } = require("./section.js");
const { hills, panel, drawBody, drawTool, drawEnds, between, inMm, mm, COLOURS, INK, number, add, toward } = require("./concept_parts.js");

function drawToolWords() {
  const view = panel({
    height: 230,
    scale: 6,
    centre: [0, -1],
    title: "A tool: axis, radius, segment",
    description:
      "A capsule, slightly aslant. A dashed line in its middle is the axis, from end A to end B. An arrow from the axis to " +
      "the capsule's surface is the radius, 5 mm. A point of the axis is marked s = 0.25. The tool's frame has its origin in " +
      "the middle of the axis, x along it.",
  });
  const { drawing, place, scale } = view;
  const ends = endsAt(poseBetween([-46, -5], [40, 5]), 86);
  drawTool(view, ends, 5);
  drawEnds(view, ends, { away: 5 * scale + 9 });
  const [from, to] = [place(ends.a), place(ends.b)];
  const way = toward(from, to);
  const up = [way[1], -way[0]];
  const radius = between(from, to, 0.8);
  drawing.arrow(radius, add(radius, up, 5 * scale), { width: 1.5, head: 8 });
  drawing.callout("radius 5 mm", add(radius, [0, -52]), add(radius, up, 5 * scale + 2));
  const point = between(from, to, 0.25);
  drawing.dot(point, { fill: "#ffffff", stroke: COLOURS.tool, width: 2 });
  drawing.callout("the point at s = 0.25", add(point, [-6, 64]), add(point, [0, 5]), { side: "above" });
  const axis = between(from, to, 0.68);
  drawing.callout("axis AB, 86 mm", add(axis, [0, 70]), add(axis, [0, 2]), { side: "above" });
  const middle = between(from, to, 0.5);
  drawing.arrow(middle, add(middle, way, 54), { width: 2 });
  drawing.arrow(middle, add(middle, up, 54), { width: 2 });
  drawing.label("x", add(add(middle, way, 58), [2, -4]), { kind: "small" });
  drawing.label("y", add(add(middle, up, 50), [-12, 0]), { kind: "small", anchor: "end" });
  drawing.label("the tool's frame", add(middle, up, 70), { anchor: "middle", kind: "small" });
  return drawing;
}

const LYING = { from: [-44, 21], to: [36, 28], length: 80, radius: 4 };

function drawPair(library) {
  const mesh = hills(library);
  const { hit, a, b } = standing(library, mesh, LYING);
  const view = panel({
    height: 290,
    centre: [0, 9],
    title: "The nearest pair of the axis and the mesh",
    description:
      `A tool floats over a body with two hills. From the point p of its axis, at s = ${number(hit.s, 3)}, a line of ` +
      `${inMm(hit.distance)} leads to the nearest point q of the mesh, on triangle ${hit.triangle}.`,
  });
  const { drawing, place, scale } = view;
  drawBody(view, mesh, { label: "body", at: [-27, -13] });
  drawTool(view, { a, b }, LYING.radius);
  drawEnds(view, { a, b }, { away: LYING.radius * scale + 9 });
  const [p, q] = [place(hit.p), place(hit.q)];
  drawing.path([p, q], { width: 2.2 });
  drawing.dot(p, { radius: 5 });
  drawing.dot(q, { radius: 5 });
  drawing.label(`p, at s = ${number(hit.s, 3)}`, add(p, [0, -30]), { anchor: "middle", kind: "strong" });
  drawing.label(`q, on triangle ${hit.triangle}`, add(q, [22, 50]), { anchor: "middle", kind: "strong" });
  drawing.label(`distance ${inMm(hit.distance)}`, add(between(p, q, 0.68), [12, 2]));
  mesh.close();
  return drawing;
}

function drawGap(library) {
  const mesh = hills(library);
  const { hit, a, b } = standing(library, mesh, { ...LYING, from: [-58, 25], to: [30, 17], length: 88, radius: 5 });
  const view = panel({
    height: 300,
    scale: 9,
    centre: [-20, 11],
    title: "The gap: from the tool's surface to the mesh",
    description:
      `A nearer look at a tool over a hill. The distance from the axis to the mesh, ${inMm(hit.distance)}, is the radius of ` +
      `5.00 mm and the gap of ${inMm(hit.gap)} between the tool's surface and the hill.`,
  });
  const { drawing, place, scale } = view;
  drawBody(view, mesh, { label: "body", at: [-22, -2] });
  drawTool(view, { a, b }, 5);
  const [p, q] = [place(hit.p), place(hit.q)];
  const surface = add(p, toward(p, q), 5 * scale);
  drawing.path([p, q], { width: 2.2 });
  for (const [dot, name] of [
    [p, "p"],
    [q, "q"],
  ]) {
    drawing.dot(dot, { radius: 5 });
    drawing.label(name, add(dot, name === "p" ? [-6, -10] : [-4, 22]), { anchor: "end", kind: "strong" });
  }
  drawing.dimension(p, surface, { offset: -34 });
  drawing.dimension(surface, q, { offset: -34, stroke: COLOURS.force });
  drawing.dimension(p, q, { offset: 46 });
  const aside = (from, to, by) => add(between(from, to, 0.5), [-toward(p, q)[1], toward(p, q)[0]], by);
  drawing.label("radius 5.00 mm", add(aside(p, surface, 42), [-166, 5]), {});
  drawing.label(`gap ${inMm(hit.gap)}`, add(aside(surface, q, 42), [-140, 5]), { kind: "strong" });
  drawing.label(`distance ${inMm(hit.distance)}`, add(aside(p, q, -54), [8, 5]));
  mesh.close();
  return drawing;
}

function drawDepth(library) {
  const mesh = hills(library);
  const { hit, contacts, a, b } = standing(library, mesh, { from: [-62, 3], to: [6, 4], length: 68, radius: 4 });
  const [{ p, q, s, normal }] = contacts;
  const view = panel({
    height: 320,
    scale: 8,
    centre: [-27, 2],
    title: "The depth: how deep the deepest point of the tool is inside",
    description:
      `A tool goes through a hill. At s = ${number(s, 3)} its axis is deepest inside; the way out leads to the nearest point of ` +
      `the surface. Along it, the surface of the tool has to move ${inMm(hit.depth)} to be outside: that is the depth.`,
  });
  const { drawing, place, scale } = view;
  drawBody(view, mesh, { label: "body", at: [-18, -13] });
  drawTool(view, { a, b }, 4);
  const [from, to] = [place(p), place(q)];
  const out = [normal[0], -normal[1]];
  const far = add(from, out, -4 * scale);
  drawing.path([far, to], { width: 2.2 });
  drawing.dot(from, { radius: 5 });
  drawing.dot(to, { radius: 5 });
  drawing.label(`p, at s = ${number(s, 3)}`, add(from, [12, 22]), { kind: "strong" });
  drawing.label("q", add(to, [-9, -8]), { anchor: "end", kind: "strong" });
  drawing.arrow(to, add(to, out, 46), { stroke: COLOURS.proxy, width: 2.5, head: 11 });
  drawing.label("way out", add(add(to, out, 40), [12, 2]));
  drawing.dimension(to, far, { offset: -58, stroke: COLOURS.force });
  const below = add(far, [-62, 40]);
  drawing.callout(`depth ${inMm(hit.depth)}`, below, add(far, [-54, 6]), { side: "above", kind: "strong" });
  drawing.label(`gap ${inMm(hit.gap)}`, add(below, [0, 21]), { anchor: "middle" });
  mesh.close();
  return drawing;
}

module.exports = { tool: drawToolWords, pair: drawPair, gap: drawGap, depth: drawDepth };
