// SPDX-License-Identifier: BSD-3-Clause
// What the drawings of docs/concepts.md share: a panel with a scale, the body, the tool, and the scene of hills.
"use strict";
const { Drawing, COLOURS, INK, number, add, toward, lineOf } = require("./svg.js");
const { curve, extrude, cut, mm } = require("./section.js");

const WIDTH = 720;

// In mm: two hills and a valley, cut into 40 pieces; with a floor 324 triangles.
const HILLS = [
  [-80, -15],
  [-62, -11],
  [-44, 2],
  [-27, 8],
  [-11, 0],
  [4, -11],
  [18, -9],
  [32, 2],
  [44, 5],
  [60, -5],
  [80, -13],
];
const hills = library => extrude(library, curve(HILLS, 4), { floor: -45 });

// A drawing, and where in it a place of the scene (m) lies: the place `centre` (mm) is in its middle.
function panel({ height, scale = 5, centre = [0, 0], ...words }) {
  const drawing = new Drawing({ width: WIDTH, height, ...words });
  const place = ([x, y]) => [WIDTH / 2 + scale * (1000 * x - centre[0]), height / 2 - scale * (1000 * y - centre[1])];
  return { drawing, place, scale };
}

// The places in turn that a mesh's triangles have in the plane.
function outline(mesh) {
  const key = ([x, y]) => `${x} ${y}`;
  const beside = new Map();
  for (const { ends } of cut(mesh))
    ends.forEach((end, k) => beside.set(key(end), [...(beside.get(key(end)) ?? []), ends[1 - k]]));
  const isEnd = ([, list]) => list.length === 1;
  const [first] = [...beside].find(isEnd) ?? [...beside][0];
  const line = [first.split(" ").map(Number)];
  for (let last; line.length <= beside.size; ) {
    const here = line[line.length - 1];
    const next = beside.get(key(here)).find(end => !last || key(end) !== key(last));
    if (!next || key(next) === key(line[0])) break;
    last = here;
    line.push(next);
  }
  return line;
}

function drawBody({ drawing, place }, mesh, { label, at: where } = {}) {
  drawing.path(outline(mesh).map(place), { closed: true, fill: COLOURS.body, stroke: COLOURS.edge, width: 2 });
  if (label) drawing.label(label, place(mm(where)), { anchor: "middle", kind: "small" });
}

// The tool as a capsule with its axis. ends: in m, radius in mm
function drawTool({ drawing, place, scale }, { a, b }, radius, { stroke = COLOURS.tool, fill, dash, axis = true, width = 2 } = {}) {
  drawing.capsule(place(a), place(b), radius * scale, { stroke, fill: fill ?? `${stroke}22`, width, "stroke-dasharray": dash });
  if (axis) drawing.path([place(a), place(b)], { stroke, width: 1.4, "stroke-dasharray": "8 4" });
}

// The axis' ends, with their names `away` pixels beyond them.
function drawEnds({ drawing, place }, { a, b }, { stroke = COLOURS.tool, away = 12 } = {}) {
  for (const [name, end, other] of [
    ["A", a, b],
    ["B", b, a],
  ]) {
    const here = place(end);
    const out = toward(place(other), here);
    drawing.dot(here, { fill: stroke });
    drawing.label(name, add(add(here, out, away), [0, 5]), { anchor: out[0] < 0 ? "end" : "start", kind: "strong" });
  }
}

const between = (a, b, t) => a.map((value, k) => value + t * (b[k] - value));
const inMm = (value, decimals = 2) => `${number(1000 * value, decimals)} mm`;

module.exports = { WIDTH, HILLS, hills, panel, outline, drawBody, drawTool, drawEnds, between, inMm, mm, COLOURS, INK, number, add, toward, lineOf };
