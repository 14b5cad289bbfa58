// SPDX-License-Identifier: BSD-3-Clause
// node stills.js PROGRAM ROOM OUT [NAME...]: the viewer's pictures in README and docs, by a headless Chromium: all, or those
// that are named.
"use strict";
const fs = require("fs");
const path = require("path");
const { launch } = require("../view/chromium.js");
const { runner, record, visitPage, seek, look, rest } = require("./viewer_page.js");
const [program, room, out, ...names] = process.argv.slice(2);
const run = runner(program, room);

const FINGER = "hand_damping=4"; // Ns/m

const sights = [
  {
    name: "laparoscopy",
    make: () => record(run, "laparoscopy", `sim:?hand=press&${FINGER}`, 4),
    time: 1.9,
  },
  {
    name: "soft-liver",
    make: () => record(run, "soft-liver", `sim:?hand=press&reach=0.018&${FINGER}`, 4), // deeper, cells turn inside out
    time: 2.0,
    turn: [-0.2, 0],
    zoom: 0.85,
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

async function picture(browser, sight) {
  sight.make();
  const page = await visitPage(browser, room, { width: 1000, height: 620, dark: sight.dark });
  if (sight.time !== undefined) await seek(page, sight.time);
  await look(page, sight.turn ?? [0, 0], sight.zoom ?? 1);
  if (sight.pick) await page.key("Enter");
  await rest(page);
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
    for (const sight of sights) if (names.length === 0 || names.includes(sight.name)) await picture(browser, sight);
  } finally {
    await browser.close();
  }
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
