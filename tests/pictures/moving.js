// SPDX-License-Identifier: BSD-3-Clause
// node moving.js PROGRAM ROOM OUT: wiping.webp, a picture that moves: a tool comes down on the soft liver, wipes over it and
// lifts off, again and again. The recording's page is stepped frame by frame; img2webp of Debian's package webp puts the
// frames together. What wiping.js states is what the file has to be.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { launch } = require("../view/chromium.js");
const { runner, record, visitPage, seek, look } = require("./viewer_page.js");
const wiping = require("./wiping.js");
const [program, room, out] = process.argv.slice(2);

// What one would click on, the smaller numbers, and a line that comes and goes.
const HIDDEN = ["header", "footer", "#views", "#numbers dl", "#numbers > .quiet"];

async function frames(browser) {
  const page = await visitPage(browser, room, wiping);
  await page.call(names => names.forEach(name => document.querySelectorAll(name).forEach(part => (part.style.display = "none"))), HIDDEN);
  await seek(page, wiping.start);
  await look(page, wiping.turn, wiping.zoom);
  const files = [];
  for (let k = 0; k < wiping.frames; k++) {
    await seek(page, wiping.start + k * wiping.frameSeconds);
    await page.settle();
    files.push(path.join(room, `frame-${String(k).padStart(3, "0")}.png`));
    await page.shoot(files[k]);
  }
  await browser.leave(page);
  return files;
}

(async () => {
  fs.mkdirSync(room, { recursive: true });
  fs.mkdirSync(out, { recursive: true });
  fs.writeFileSync(path.join(room, "hand.csv"), wiping.hand());
  record(runner(program, room), wiping.scene, wiping.device, wiping.seconds);
  const browser = launch(room);
  let files;
  try {
    files = await frames(browser);
  } finally {
    await browser.close();
  }
  const file = path.join(out, "wiping.webp");
  const options = ["-loop", "0", "-lossy", "-q", `${wiping.quality}`, "-m", "6", "-d", `${1000 * wiping.frameSeconds}`];
  execFileSync("img2webp", [...options, ...files, "-o", `${file}.new`], { stdio: ["ignore", "ignore", "ignore"] });
  fs.renameSync(`${file}.new`, file);
  process.stdout.write(`${file}: ${Math.ceil(fs.statSync(file).size / 1024)} kB, ${files.length} frames\n`);
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
