// SPDX-License-Identifier: BSD-3-Clause
// node moving.js PROGRAM ROOM OUT [NAME...]: pictures that move, NAME.webp: all of motions.js, or those that are named. A
// recording's page is stepped frame by frame; webpmux of Debian's package webp puts the frames together. What motions.js
// states is what the files have to be.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { launch } = require("../view/chromium.js");
const { runner, record, visitPage, seek, look, rest } = require("./viewer_page.js");
const { MOTIONS } = require("./motions.js");
const { muxWords } = require("./moving_frames.js");
const [program, room, out, ...names] = process.argv.slice(2);

// What one would click on, the smaller numbers, and a line that comes and goes.
const HIDDEN = ["header", "footer", "#views", "#deformation", "#numbers dl", "#numbers > .quiet"];

async function framesOf(browser, motion) {
  const page = await visitPage(browser, room, motion);
  await page.call(names => names.forEach(name => document.querySelectorAll(name).forEach(part => (part.style.display = "none"))), HIDDEN);
  await page.ask("(document.querySelector('aside').style.width = '336px'), viewer.plot.choose(['force', 'depth']), 0");
  await seek(page, motion.start + motion.frameSeconds * (motion.frames / 2)); // when it is felt most
  await page.settle();
  await look(page, motion.turn, motion.zoom);
  const files = [];
  for (let k = 0; k < motion.frames; k++) {
    await seek(page, motion.start + k * motion.frameSeconds);
    await rest(page);
    files.push(path.join(room, `frame-${String(k).padStart(3, "0")}.png`));
    await page.shoot(files[k]);
  }
  await browser.leave(page);
  return files;
}

async function make(browser, motion) {
  const run = runner(program, room);
  fs.writeFileSync(path.join(room, "hand.csv"), motion.hand());
  let scene = motion.scene;
  if (typeof scene !== "string") {
    fs.writeFileSync(path.join(room, "scene.json"), JSON.stringify(scene));
    scene = "scene.json";
  }
  record(run, scene, motion.device, motion.seconds);
  const files = await framesOf(browser, motion);
  const file = path.join(out, `${motion.name}.webp`);
  const words = await muxWords(browser, files, motion.quality, 1000 * motion.frameSeconds);
  execFileSync("webpmux", [...words, "-loop", "0", "-o", `${file}.new`], { stdio: ["ignore", "ignore", "ignore"] });
  fs.renameSync(`${file}.new`, file);
  process.stdout.write(`${file}: ${Math.ceil(fs.statSync(file).size / 1024)} kB, ${files.length} frames\n`);
}

(async () => {
  fs.mkdirSync(room, { recursive: true });
  fs.mkdirSync(out, { recursive: true });
  const browser = launch(room);
  try {
    for (const motion of MOTIONS) if (names.length === 0 || names.includes(motion.name)) await make(browser, motion);
  } finally {
    await browser.close();
  }
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
