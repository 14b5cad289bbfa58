// SPDX-License-Identifier: BSD-3-Clause
// Drawings of what is felt: device and proxy, coupling and wrench.
"use strict";
const { curve, extrude, straight, poseBetween, endsAt, worldOf } = require("./section.js");
const { hills, panel, drawBody, drawTool, between, inMm, mm, COLOURS, number, add, toward } = require("./concept_parts.js");

// Leads a tool with a proxy from one place to another (mm, both ends each) in so many ticks, along straight lines.
function led(library, mesh, { length, radius, from, to, ticks }) {
  const { world, tool } = worldOf(library, mesh, straight(length, radius));
  const path = [];
  for (let k = 0; k <= ticks; k++) {
    const [a, b] = [0, 1].map(i => between(from[i], to[i], k / ticks));
    world.setToolPose(tool, poseBetween(a, b));
    world.step(0.001);
    path.push({ device: world.getToolPose(tool), proxy: world.getToolProxy(tool) });
  }
  const { device, proxy } = path[ticks];
  const answer = { path, device, proxy, wrench: world.getWrench(tool), stiffness: world.getToolSettings(tool).stiffness };
  world.close();
  return answer;
}

const shiftOf = ({ device, proxy }) => [0, 1].map(k => proxy[k] - device[k]);
const lengthOf = vector => Math.sqrt(vector.reduce((sum, value) => sum + value * value, 0));

const RIDGE = [
  [-80, -18],
  [-40, -18],
  [-22, -16],
  [-11, -3],
  [0, 9],
  [11, -3],
  [22, -16],
  [40, -18],
  [80, -18],
];

function drawProxy(library) {
  const mesh = extrude(library, curve(RIDGE, 4), { floor: -45 });
  const [length, radius] = [54, 3];
  const answer = led(library, mesh, {
    length,
    radius,
    from: [[-56, 38], [-38, -12.9]],
    to: [[-13, 38], [5, -12.9]],
    ticks: 200,
  });
  const shift = lengthOf(shiftOf(answer));
  const view = panel({
    height: 400,
    scale: 5.5,
    centre: [-14, 15],
    title: "The device's pose, and the proxy that has gone through nothing",
    description:
      `A hand moves a tool to the right, into a narrow ridge and through it: that is the device's pose. The proxy stays on the ` +
      `left side of the ridge, which it has not gone through, and turns along its flank. Their centres are ${inMm(shift, 1)} apart.`,
  });
  const { drawing, place } = view;
  drawBody(view, mesh, { label: "body", at: [-3, -14.5] });
  const [device, proxy] = [answer.device, answer.proxy].map(pose => endsAt(pose, length));
  const start = endsAt(answer.path[0].device, length);
  drawTool(view, start, radius, { stroke: COLOURS.faint, dash: "3 4", axis: false, fill: "none", width: 1.4 });
  drawTool(view, device, radius, { stroke: COLOURS.tool, dash: "7 4", axis: false });
  drawTool(view, proxy, radius, { stroke: COLOURS.proxy, fill: "#009e7355", width: 2.6 });
  const centre = pose => place(pose);
  drawing.path(answer.path.map(({ proxy: pose }) => centre(pose)), { stroke: COLOURS.proxy, width: 2 });
  const y = place(mm([0, 43]))[1];
  drawing.arrow([place(start.a)[0] + 30, y], [place(device.a)[0] - 30, y], { stroke: COLOURS.tool });
  drawing.label("the hand's motion", [(place(start.a)[0] + place(device.a)[0]) / 2, y - 10], { anchor: "middle", kind: "small" });
  drawing.label("start", add(place(start.a), [-26, 6]), { anchor: "end", kind: "small" });
  const inside = place(between(device.a, device.b, 0.86));
  drawing.callout("device (dashed)", add(inside, [92, -40]), add(inside, [12, -6]), { side: "left", kind: "strong" });
  const free = place(between(proxy.a, proxy.b, 0.12));
  drawing.callout("proxy (solid)", add(free, [64, 24]), add(free, [15, 4]), { side: "left", kind: "strong" });
  mesh.close();
  return drawing;
}

function drawCoupling(library) {
  const mesh = hills(library);
  const [length, radius] = [84, 4];
  const answer = led(library, mesh, {
    length,
    radius,
    from: [[-62, 30], [20, 34]],
    to: [[-62, -2], [20, 2]],
    ticks: 100,
  });
  const shift = shiftOf(answer);
  const { force, torque } = answer.wrench;
  const view = panel({
    height: 350,
    scale: 6,
    centre: [-15, 9],
    title: "The coupling: a spring from the device to the proxy, and the wrench that is felt",
    description:
      `The device is inside a hill, the proxy lies on it and has turned. A spring of ${number(answer.stiffness, 0)} N/m between ` +
      `their centres, ${inMm(lengthOf(shift))} apart, pulls the hand with ${number(lengthOf(force), 2)} N, and with ` +
      `${number(1000 * torque[2], 1)} mN m against the turn.`,
  });
  const { drawing, place } = view;
  drawBody(view, mesh, { label: "body", at: [-27, -14] });
  const [device, proxy] = [answer.device, answer.proxy].map(pose => endsAt(pose, length));
  drawTool(view, device, radius, { dash: "7 4", axis: false });
  drawTool(view, proxy, radius, { stroke: COLOURS.proxy, fill: "#009e7355", width: 2.6, axis: false });
  const [d, p] = [place(answer.device), place(answer.proxy)];
  drawing.spring(d, p, { turns: 5, amplitude: 9 });
  drawing.dot(d, { radius: 5, fill: COLOURS.tool });
  drawing.dot(p, { radius: 5, fill: COLOURS.proxy });
  const coil = `spring of ${number(answer.stiffness, 0)} N/m, ${inMm(lengthOf(shift))} long`;
  drawing.callout(coil, add(p, [58, -66]), add(between(d, p, 0.66), [10, 0]), { side: "left" });
  const foot = add(d, [-70, 0]);
  const up = toward([0, 0], [force[0], -force[1]]);
  drawing.arrow(foot, add(foot, up, 18 * lengthOf(force)), { stroke: COLOURS.force, width: 4, head: 15 });
  drawing.label(`force ${number(lengthOf(force), 2)} N`, add(add(foot, up, 18 * lengthOf(force)), [0, -12]), { anchor: "middle", kind: "strong" });
  const turn = (ends, far, t) => add(d, toward(d, add(d, between(toward(place(ends.b), place(ends.a)), toward(place(proxy.b), place(proxy.a)), t))), far);
  const arc = Array.from({ length: 9 }, (_, k) => turn(device, 190, (2.2 * k) / 8));
  drawing.path(arc.slice(0, 8), { stroke: COLOURS.force, width: 3 });
  drawing.arrow(arc[7], arc[8], { stroke: COLOURS.force, width: 3, head: 13 });
  drawing.callout(`torque ${number(1000 * torque[2], 1)} mN m`, add(arc[8], [-40, -98]), add(arc[8], [-2, -4]), { kind: "strong" });
  drawing.label("device", add(place(device.b), [34, 5]), { kind: "strong" });
  drawing.label("proxy", add(place(proxy.b), [34, 5]), { kind: "strong" });
  mesh.close();
  return drawing;
}

module.exports = { proxy: drawProxy, coupling: drawCoupling };
