// SPDX-License-Identifier: BSD-3-Clause
// What pictures of the viewer share: recordings that are made here, on a simulated device with a time of its own, so that
// they are the same each time but for the browser's own pixels; and a page that plays one, in a headless Chromium.
"use strict";
const path = require("path");
const { execFileSync } = require("child_process");
const { until } = require("../view/chromium.js");
const RATE = 60; // frames a second of a page that plays by itself

// Runs the program in a folder.
const runner = (program, room) => (...words) =>
  execFileSync(program, words, { cwd: room, stdio: ["ignore", "ignore", "inherit"] });

// A page of a scene under a device for some seconds.
function record(run, scene, device, seconds, ...options) {
  run("run", scene, "--device", device, "--for", `${seconds}`, "--record", "felt.dpr", ...options);
  run("view", "felt.dpr", "-o", "page.html");
}

async function visitPage(browser, room, { width, height, dark }) {
  const features = { "prefers-color-scheme": dark ? "dark" : "light", "prefers-reduced-motion": "reduce" };
  const page = await browser.visit(`file://${path.resolve(room, "page.html")}`, { width, height, features });
  await until("the scene", async () => (await page.state()).mode);
  return page;
}

async function seek(page, time) {
  await until("its end", async () => (await page.state()).ended);
  const { frames } = await page.state();
  await page.ask(`viewer.play.seek(Math.min(${frames - 1}, Math.round(${RATE} * ${time}))), 0`);
}

// Until the bodies' shade is whole, and edges are smooth.
async function rest(page) {
  await until("the shade", () => page.ask("viewer.own.view.bake.isDone"));
  await page.ask("viewer.own.view.setSmooth(true), (viewer.own.view.dirty = true)");
  await page.settle();
}

// Turns the view, and comes nearer to the nearest point of the mesh.
function look(page, turn, zoom) {
  return page.call(
    (turn, zoom) => {
      const { camera } = viewer.own.view;
      const aim = viewer.own.frame?.snapshot.segments[0].q;
      camera.rotate(...turn);
      if (!aim) return;
      const { target, distance } = camera.state;
      camera.move({ target: target.map((value, k) => value + (1 - zoom) * (aim[k] - value)), distance: zoom * distance });
    },
    turn,
    zoom,
  );
}

module.exports = { runner, record, visitPage, seek, look, rest, RATE };
