// SPDX-License-Identifier: BSD-3-Clause
// Drawings of what is along the tool: contacts, the distance profile, margin and onset.
"use strict";
const { curve, extrude, cut, profileAlong, distanceOf, standing } = require("./section.js");
const { hills, panel, drawBody, drawTool, drawEnds, between, inMm, mm, COLOURS, INK, number, add } = require("./concept_parts.js");

const STEPS = 400; // of the axis, for curves
const DOTS = "2 4";

function drawContact(library) {
  const mesh = hills(library);
  const radius = 4;
  const margin = 2.5;
  const lying = { from: [-57, 11], to: [62, 6.8], length: 119, radius, margin: margin / 1000 };
  const { contacts, a, b } = standing(library, mesh, lying);
  const view = panel({
    height: 320,
    scale: 5,
    centre: [2.5, 8],
    title: "Contacts: the stretches of the axis where the tool meets the body",
    description:
      `A tool lies on two hills and spans the valley between them. On ${contacts.length} stretches of its axis the surface is within the ` +
      `margin: these are the contacts. Each has its deepest pair, p on the axis and q on the mesh.`,
  });
  const { drawing, place, scale } = view;
  drawBody(view, mesh, { label: "body", at: [-27, -8] });
  drawTool(view, { a, b }, radius, { axis: false });
  drawing.capsule(place(a), place(b), (radius + margin) * scale, { stroke: COLOURS.tool, width: 1.2, "stroke-dasharray": DOTS });
  drawing.path([place(a), place(b)], { stroke: COLOURS.tool, width: 1.4, "stroke-dasharray": "8 4" });
  drawEnds(view, { a, b }, { away: (radius + margin) * scale + 7 });
  contacts.forEach(({ s0, s1, s, p, q, gap }, k) => {
    const [first, last] = [s0, s1].map(part => place(between(a, b, part)));
    drawing.path([first, last], { stroke: COLOURS.contact, width: 9, "stroke-linecap": "butt" });
    for (const end of [first, last]) drawing.path([add(end, [0, -9]), add(end, [0, 9])], { width: 2 });
    drawing.path([place(p), place(q)], { width: 2 });
    drawing.dot(place(p), { radius: 4.5 });
    drawing.dot(place(q), { radius: 4.5 });
    const middle = between(first, last, 0.5);
    const above = [Math.min(middle[0], 575), 42];
    drawing.path([add(above, [0, 26]), add(middle, [0, -6])], { stroke: COLOURS.faint, width: 1 });
    drawing.label(`contact ${k + 1}: s = ${number(s0, 3)} to ${number(s1, 3)}`, above, { anchor: "middle", kind: "strong" });
    drawing.label(`deepest at s = ${number(s, 3)}, gap ${inMm(gap)}`, add(above, [0, 20]), { anchor: "middle" });
  });
  drawing.label(`margin ${number(margin, 1)} mm`, place(mm([10, -4.2])), { anchor: "middle", kind: "small" });
  mesh.close();
  return drawing;
}

// A plot below the scene whose places along the axis stand below those of the axis. y: the heights in pixels of 0 and of
// `most` (mm), the marks between at each `step`
function plot({ drawing, place }, { a, b }, { zero, top, most, step, label }) {
  const [left, right] = [place(a)[0], place(b)[0]];
  const at = (s, value) => [left + s * (right - left), zero - ((zero - top) * 1000 * value) / most];
  for (let mark = 0; mark <= most; mark += step) {
    const y = at(0, mark / 1000)[1];
    drawing.path([[left, y], [right, y]], { stroke: mark === 0 ? COLOURS.edge : "#ddd8cc", width: 1 });
    drawing.label(number(mark, 0), [left - 8, y + 4], { anchor: "end", kind: "small" });
  }
  drawing.label(label, [left - 8, top - 14], { kind: "small" });
  for (const s of [0, 0.5, 1]) drawing.label(number(s, 1), [at(s, 0)[0], zero + 24], { anchor: "middle", kind: "small" });
  drawing.label("s", [at(0.75, 0)[0], zero + 24], { anchor: "middle", kind: "small" });
  return at;
}

const CRAGS = [
  [-80, -12],
  [-47, 5],
  [-26, -12],
  [-6, 2],
  [16, -12],
  [43, 8],
  [80, -10],
];

// Runs of samples whose nearest point is on one triangle: from and to are s.
function runsOf(hits) {
  const runs = [];
  hits.forEach(({ triangle }, k) => {
    const last = runs[runs.length - 1];
    if (last?.triangle === triangle) last.to = k / STEPS;
    else runs.push({ triangle, from: last ? last.to : 0, to: k / STEPS });
  });
  return runs;
}

function drawEnvelope(library) {
  const mesh = extrude(library, CRAGS, { floor: -45 });
  const [a, b] = [mm([-60, 17]), mm([60, 17])];
  const hits = profileAlong(library, mesh, a, b, STEPS);
  const runs = runsOf(hits);
  const view = panel({
    height: 430,
    scale: 5,
    centre: [0, -19],
    title: "The distance along the axis is a lower envelope",
    description:
      `Above, an axis over a body with three crags. Below, the distance to the mesh at each point of the axis: the lowest of ` +
      `the curves of all triangles, in ${runs.length} pieces that belong to one triangle each.`,
  });
  const { drawing, place } = view;
  drawBody(view, mesh, { label: "body", at: [-47, -11] });
  drawing.path([[0, 222], [720, 222], [720, 430], [0, 430]], { closed: true, stroke: "none", fill: "#fbfaf6" });
  drawing.path([place(a), place(b)], { stroke: COLOURS.tool, width: 2.2, "stroke-dasharray": "8 4" });
  drawEnds(view, { a, b });
  const at = plot(view, { a, b }, { zero: 396, top: 262, most: 30, step: 10, label: "distance, mm" });
  const named = new Set(runs.map(({ triangle }) => triangle));
  for (const { triangle, corners } of cut(mesh).filter(piece => named.has(piece.triangle))) {
    const curve = hits.map((_, k) => {
      const here = between(a, b, k / STEPS);
      return at(k / STEPS, distanceOf(library, here, here, corners).distance);
    });
    const low = curve.filter(([, y]) => y >= 262);
    drawing.path(low, { stroke: COLOURS.faint, width: 1, "stroke-dasharray": DOTS, "data-triangle": triangle });
  }
  runs.forEach(({ triangle, from, to }, k) => {
    const part = hits.map((hit, i) => [i / STEPS, hit]).filter(([s]) => s >= from && s <= to);
    drawing.path(part.map(([s, hit]) => at(s, hit.distance)), { stroke: k % 2 ? COLOURS.contact : COLOURS.tool, width: 3.6, "stroke-linecap": "butt" });
    const middle = part[Math.floor(part.length / 2)];
    drawing.path([place(between(a, b, middle[0])), place(middle[1].q)], { stroke: COLOURS.faint, width: 1 });
    drawing.dot(place(middle[1].q), { radius: 3.5, fill: k % 2 ? COLOURS.contact : COLOURS.tool });
    if (to - from > 0.05) drawing.label(`triangle ${triangle}`, add(at((from + to) / 2, 0), [0, -10]), { anchor: "middle", kind: "small" });
    if (k === 0) return;
    const joint = at(from, part[0][1].distance);
    drawing.path([joint, at(from, 0)], { stroke: COLOURS.faint, width: 1, "stroke-dasharray": DOTS });
    drawing.dot(joint, { radius: 3.5 });
  });
  mesh.close();
  return drawing;
}

function drawMargin(library) {
  const mesh = hills(library);
  const radius = 4;
  const margin = 3;
  const lying = { from: [-68, 9.5], to: [10, 9.5], length: 78, radius, margin: margin / 1000 };
  const [wide, narrow] = [-1, 0].map(onset => standing(library, mesh, { ...lying, onset }));
  const { a, b } = wide;
  const [contact] = wide.contacts;
  const hits = profileAlong(library, mesh, a, b, STEPS);
  const view = panel({
    height: 430,
    scale: 7,
    centre: [-29, -9],
    title: "Margin and onset",
    description:
      `A tool presses on a hill. Its contact begins where the surface is within the margin of ${margin} mm. Below, the overlap ` +
      `w along the axis: counted from the margin on its integral is ${number(1e6 * contact.overlap, 1)} mm², counted from the ` +
      `tool's surface on ${number(1e6 * narrow.contacts[0].overlap, 1)} mm².`,
  });
  const { drawing, place, scale } = view;
  drawBody(view, mesh, { label: "body", at: [-27, -3] });
  drawing.path([[0, 234], [720, 234], [720, 430], [0, 430]], { closed: true, stroke: "none", fill: "#fbfaf6" });
  drawTool(view, { a, b }, radius, { axis: false });
  drawing.capsule(place(a), place(b), (radius + margin) * scale, { width: 1.4, "stroke-dasharray": DOTS });
  drawing.path([place(a), place(b)], { stroke: COLOURS.tool, width: 1.4, "stroke-dasharray": "8 4" });
  const [first, last] = [contact.s0, contact.s1].map(s => place(between(a, b, s)));
  drawing.path([first, last], { stroke: COLOURS.contact, width: 9, "stroke-linecap": "butt" });
  drawing.label("contact", add(between(first, last, 0.5), [0, -9]), { anchor: "middle", kind: "strong" });
  const side = add(place(a), [40, -radius * scale]);
  drawing.dimension(side, add(side, [0, -margin * scale]), {});
  drawing.label(`margin ${number(margin, 0)} mm`, add(side, [8, -margin * scale - 8]));
  const at = plot(view, { a, b }, { zero: 396, top: 276, most: 6, step: 2, label: "w, mm (its integral is the overlap)" });
  const area = (onset, fill, more) => {
    const places = hits.map(({ gap }, k) => at(k / STEPS, Math.max(0, onset - (gap - radius / 1000))));
    const inside = places.filter(([, y]) => y < 395.99);
    drawing.path([[inside[0][0], 396], ...inside, [inside[inside.length - 1][0], 396]], { closed: true, fill, width: 2.2, ...more });
  };
  area(margin / 1000, "#e69f0044", { stroke: COLOURS.contact });
  area(0, "#0072b255", { stroke: COLOURS.tool, "stroke-dasharray": "6 3" });
  for (const s of [contact.s0, contact.s1])
    drawing.path([place(between(a, b, s)), at(s, 0)], { stroke: COLOURS.faint, width: 1, "stroke-dasharray": DOTS });
  const peak = at(narrow.contacts[0].s, 0);
  drawing.callout(`onset 0: ${number(1e6 * narrow.contacts[0].overlap, 1)} mm²`, [492, 366], [peak[0] + 40, 384], { side: "left" });
  drawing.callout(`onset = margin: ${number(1e6 * contact.overlap, 1)} mm²`, [466, 312], [peak[0] + 58, 336], { side: "left" });
  mesh.close();
  return drawing;
}

module.exports = { contact: drawContact, envelope: drawEnvelope, margin: drawMargin };
