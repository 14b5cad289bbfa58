// SPDX-License-Identifier: BSD-3-Clause
// node pictures.js PROGRAM ROOM OUT: the pictures of README and docs, by a headless Chromium. Each is of a recording that is
// made here, on a simulated device with a time of its own, and so is the same each time but for the browser's own pixels.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { launch, until } = require("./chromium.js");
const [program, room, out] = process.argv.slice(2);

const run = (...words) => execFileSync(program, words, { cwd: room, stdio: ["ignore", "ignore", "inherit"] });
const record = (scene, device, seconds, ...options) => {
  run("run", scene, "--device", device, "--for", `${seconds}`, "--record", "felt.dpr", ...options);
};
const sights = [
  {
    name: "laparoscopy",
    make: () => {
      record("laparoscopy", "sim:?hand=press", 4);
      run("view", "felt.dpr", "-o", "page.html");
    },
    time: 1.9,
    turn: [-0.5, -0.1],
    zoom: 0.6,
  },
  {
    name: "soft-liver",
    make: () => {
      record("soft-liver", "sim:?hand=press&reach=0.025&cycle=4", 4);
      run("view", "felt.dpr", "-o", "page.html");
    },
    time: 2.0,
    turn: [-0.35, -0.1],
    zoom: 0.5,
    dark: true,
  },
  {
    name: "mesh",
    make: () => {
      run("make", "liver", "8000", "-o", "liver.stl");
      run("view", "liver.stl", "-o", "page.html");
    },
    pick: true,
  },
];

// In the page: turn, and come nearer to where the tool is held back.
function look(turn, zoom) {
  const { camera } = viewer.own.view;
  const segment = viewer.own.frame?.snapshot.segments[0];
  camera.rotate(...turn);
  if (!segment) return;
  const { target, distance } = camera.state;
  const aim = target.map((value, k) => value + (1 - zoom) * (segment.q[k] - value));
  camera.move({ target: aim, distance: zoom * distance });
}

async function picture(browser, sight) {
  sight.make();
  const features = { "prefers-color-scheme": sight.dark ? "dark" : "light", "prefers-reduced-motion": "reduce" };
  const page = await browser.visit(`file://${path.resolve(room, "page.html")}`, { width: 1200, height: 720, features });
  await until("the scene", async () => (await page.state()).mode);
  if (sight.time !== undefined) {
    await until("its end", async () => (await page.state()).ended);
    const { frames } = await page.state();
    await page.ask(`viewer.play.seek(Math.min(${frames - 1}, Math.round(60 * ${sight.time}))), 0`);
  }
  await page.call(look, sight.turn ?? [0, 0], sight.zoom ?? 1);
  if (sight.pick) await page.key("Enter");
  await page.settle();
  const file = path.join(out, `${sight.name}.png`);
  await page.shoot(file);
  await browser.leave(page);
  process.stdout.write(`${file}: ${Math.ceil(fs.statSync(file).size / 1024)} kB\n`);
}

(async () => {
  fs.mkdirSync(room, { recursive: true });
  fs.mkdirSync(out, { recursive: true });
  const browser = launch(room);
  try {
    for (const sight of sights) await picture(browser, sight);
  } finally {
    await browser.close();
  }
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
