// SPDX-License-Identifier: BSD-3-Clause
// What tests of the picture share: pages with data of their own, and colours at places of the scene.
"use strict";
const fs = require("fs");
const path = require("path");
const { until, sleep } = require("./chromium.js");
const { TOOL } = require("./stream_fixture.js");

// Makes pages from a template, each with a stream inside, in a folder; returns their address.
function pageWriter(template, room) {
  const [before, after] = fs.readFileSync(template, "utf8").split("@DATA@");
  return (name, stream) => {
    const file = path.resolve(room, `${name}.html`);
    fs.writeFileSync(file, before + stream.toString("base64") + after);
    return `file://${file}`;
  };
}

const seek = async (page, index) => {
  await page.call(index => {
    const slider = document.getElementById("slider");
    slider.value = String(index);
    slider.dispatchEvent(new Event("input"));
  }, index);
  await until(
    `frame ${index}`,
    async () => (await page.state()).index === index && (await page.state()).number === index,
  );
  await page.settle();
};
const colour = (page, name) =>
  page.call(name => {
    const { r, g, b } = new THREE.Color(
      getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim(),
    );
    return [r, g, b].map(part =>
      Math.round(255 * (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055)),
    );
  }, name);
const pixel = (page, place) => page.call(place => dynpoint.pixel(place), place);
// How well the hue of a shaded surface is that of a colour: 1 if they are the same.
const likeness = (a, b) => {
  const [u, v] = [a, b].map(rgb => rgb.map(value => (value / 255) ** 2.2 + 1e-3));
  const by = w => Math.hypot(...w);
  return (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / (by(u) * by(v));
};
const on = (ends, s) => ends[0].map((value, k) => value + s * (ends[1][k] - value));
// Where a ray from above first meets the proxy.
const top = ([x, y, z]) => [x, y, z + TOOL.radius];
const camera = page => page.ask("dynpoint.camera()");

/*
 * To be called in the page: texts that are seen, how many; those whose letters reach beyond the box that cuts them off, and
 * pairs of them that lie on one another. long: texts to put into readouts first, by name.
 */
function textsOf(long = {}) {
  const kept = Object.entries(long).map(([name, text]) => {
    const field = document.querySelector(`[data-readout="${name}"]`);
    const old = field.textContent;
    field.textContent = text;
    return () => (field.textContent = old);
  });
  const all = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const range = document.createRange();
  while (walker.nextNode()) {
    const { parentElement: parent, textContent } = walker.currentNode;
    if (!textContent.trim() || !parent.checkVisibility({ visibilityProperty: true }) || parent.closest("script, style, dialog, option, .unseen"))
      continue;
    range.selectNodeContents(walker.currentNode);
    const { left, right, top, bottom } = range.getBoundingClientRect();
    if (right - left < 1) continue;
    all.push({ text: textContent.trim().slice(0, 30), left, right, top, bottom, parent });
  }
  const cuts = ({ parent, left, right }) => {
    if (left < -0.5 || right > innerWidth + 0.5) return true;
    for (let box = parent; box && box !== document.body; box = box.parentElement) {
      const { overflowX } = getComputedStyle(box);
      const { left: from, right: to } = box.getBoundingClientRect();
      if (overflowX !== "visible" && (left < from - 0.5 || right > to + 0.5)) return true;
    }
    return false;
  };
  const cut = all.filter(cuts).map(({ text }) => text);
  const crossed = [];
  all.forEach((a, i) =>
    all.slice(i + 1).forEach(b => {
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && high > 3) crossed.push([a.text, b.text]);
    }),
  );
  for (const undo of kept) undo();
  return { texts: all.length, cut, crossed };
}

async function view(page, key) {
  await page.key(key);
  await page.key("f");
  await page.settle();
}

// The page of a whole recording, when it has been read.
async function visitRecording(browser, address, frames, options) {
  const page = await browser.visit(address, options);
  await until("frames", async () => (await page.state()).frames === frames);
  return page;
}

module.exports = { pageWriter, visitRecording, seek, colour, pixel, likeness, on, top, camera, view, textsOf };
