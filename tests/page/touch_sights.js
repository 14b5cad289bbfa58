// SPDX-License-Identifier: BSD-3-Clause
// What tests of the page in a browser share: a page whose world runs, recordings of it, and what the native library
// answers to them.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { pathToFileURL } = require("url");
const { until } = require("../view/chromium.js");
const LAWS = ["point", "bed", "proxy"];

// Where no frames come, the failure has what the page says of itself.
const running = page =>
  until(
    "frames",
    () => page.ask("typeof dynpoint === 'object' && 'panel' in dynpoint && dynpoint.state().frames > 2"),
  ).catch(async error => {
    const told = "[document.visibilityState, typeof dynpoint === 'object' && dynpoint.state()]";
    throw new Error(`${error.message}: ${JSON.stringify([...(await page.ask(told)), page.said])}`);
  });

async function visitPage(browser, file, options) {
  const page = await browser.visit(pathToFileURL(path.resolve(file)).href, options);
  await running(page);
  return page;
}

// The last frame that the page shows, of its first tool and segment; it waits for the first of a scene.
const shown = page =>
  page.call(async () => {
    while (!viewer.own.frame) await new Promise(done => setTimeout(done, 20));
    const { snapshot } = viewer.own.frame;
    const { x, y, width, height } = document.getElementById("picture").getBoundingClientRect();
    return {
      steps: snapshot.steps,
      law: snapshot.tools[0].law,
      tip: snapshot.tools[0].pose.slice(0, 3),
      proxy: snapshot.tools[0].proxy.slice(0, 3),
      wrench: snapshot.tools[0].wrench,
      contact: snapshot.segments[0].contact,
      title: viewer.own.scene.title,
      picture: [x, y, width, height],
    };
  });

// The scene anew, and `ticks` of it, while the hand goes to `places`: m from the body's middle, one each 100 ms; none
// leave the hand to others. Also the snapshots of the frames that the page took.
function recordInPage(ticks, places) {
  const base64 = bytes => {
    let text = "";
    for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
    return btoa(text);
  };
  const done = dynpoint.record(ticks);
  const half = viewer.own.view.bounds();
  places.forEach((place, i) =>
    setTimeout(
      () =>
        viewer.theHand.want(
          place.map((part, k) => half.centre[k] + part),
          performance.now(),
        ),
      100 * i,
    ),
  );
  return done.then(told => {
    const all = new Uint8Array(told.snapshots.reduce((sum, one) => sum + one.length, 0));
    const sizes = [];
    told.snapshots.reduce((at, one) => (all.set(one, at), sizes.push(one.length), at + one.length), 0);
    const frames = [];
    for (let i = 0; i < viewer.history.size; i++) {
      const { bytes } = viewer.history.get(i);
      const size = new DataView(bytes.buffer).getUint32(4, true);
      frames.push(base64(bytes.subarray(80, 80 + size)));
    }
    return {
      poses: base64(new Uint8Array(told.poses.buffer)),
      snapshots: base64(all),
      sizes,
      frames,
      file: base64(told.file),
      head: base64(new Uint8Array(Float64Array.of(...told.pose, ...told.segment).buffer)), // JSON has no -0
      law: told.law,
      stiffness: told.stiffness,
      loadRadius: told.loadRadius,
    };
  });
}

async function record(page, ticks, places) {
  const told = await page.call(recordInPage, ticks, places);
  for (const name of ["poses", "snapshots", "file", "head"]) told[name] = Buffer.from(told[name], "base64");
  told.frames = told.frames.map(text => Buffer.from(text, "base64"));
  return told;
}

// The snapshots that the native library takes of the same motion, one behind the other.
function feelAgain(build, room, { file, head, poses, law, stiffness, loadRadius }) {
  const mesh = path.join(room, "felt.dpa");
  const motion = path.join(room, "felt.bin");
  fs.writeFileSync(mesh, file);
  fs.writeFileSync(motion, Buffer.concat([head, poses]));
  return execFileSync(
    path.resolve(build, "tests/page/feel_again"),
    [mesh, motion, String(law), String(stiffness), String(loadRadius)],
    { maxBuffer: 2 ** 30 },
  );
}

// To a list, one block for each tick.
const cut = (snapshots, sizes) => {
  let at = 0;
  return sizes.map(size => snapshots.subarray(at, (at += size)));
};

async function choose(page, name) {
  await page.call(name => {
    const list = document.getElementById("touch-scene");
    list.value = name;
    list.dispatchEvent(new Event("change"));
  }, name);
  await until(
    `the scene ${name}`,
    () => page.call(name => dynpoint.panel().scene === name && dynpoint.state().frames > 2, name),
  );
}

async function chooseLaw(page, law) {
  await page.call(law => document.querySelector(`input[value=${law}]`).click(), law);
  await until(`the law ${law}`, async () => LAWS[(await shown(page)).law] === law);
}

module.exports = { LAWS, choose, chooseLaw, cut, feelAgain, record, running, shown, visitPage };
