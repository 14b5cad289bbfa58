// SPDX-License-Identifier: BSD-3-Clause
// node page_saved.js PAGE.html ROOM: a picture that is saved has the values of the force, the colours' names and the scales.
"use strict";
const { launch } = require("./chromium.js");
const { check, near, finish, assert } = require("./verdicts.js");
const { pageWriter, visitRecording, seek } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);

// In the page: the saved picture as ImageData, by the button's own way; and where elements stand in it.
const SAVED = `(async () => {
  let blob = null;
  const { createObjectURL } = URL;
  const { click } = HTMLAnchorElement.prototype;
  URL.createObjectURL = given => ((blob = given), createObjectURL.call(URL, given));
  HTMLAnchorElement.prototype.click = () => {};
  await viewer.actions.save();
  URL.createObjectURL = createObjectURL;
  HTMLAnchorElement.prototype.click = click;
  const bitmap = await createImageBitmap(blob);
  const { width, height } = bitmap;
  const context = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  const from = document.getElementById("picture").getBoundingClientRect();
  const ratio = width / from.width;
  // How many pixels within an element are near to a colour of its style.
  const count = (element, name) => {
    const box = element.getBoundingClientRect();
    const wanted = getComputedStyle(element)[name].match(/[\\d.]+/g).slice(0, 3).map(Number);
    const [x, y] = [box.left - from.left, box.top - from.top].map(value => Math.round(value * ratio));
    const { data } = context.getImageData(x, y, Math.round(box.width * ratio), Math.round(box.height * ratio));
    let near = 0;
    for (let i = 0; i < data.length; i += 4) near += wanted.every((part, k) => Math.abs(part - data[i + k]) < 40);
    return near / (data.length / 4);
  };
  const label = document.querySelector("#labels span");
  const words = document.getElementById("force-scale");
  const ramp = document.querySelector("#legend .ramp").getBoundingClientRect();
  const at = part => {
    const [x, y] = [ramp.left + part * ramp.width - from.left, ramp.top + ramp.height / 2 - from.top];
    return [...context.getImageData(x * ratio, y * ratio, 1, 1).data.subarray(0, 3)];
  };
  return {
    size: [width, height],
    wanted: [from.width, from.height].map(value => value * viewer.own.view.smoothRatio),
    label: [label.textContent, count(label, "color"), count(label, "backgroundColor")],
    bar: count(document.getElementById("force-bar"), "backgroundColor"),
    words: count(words, "color"),
    ramp: [at(0.03), at(0.97), scale.colour(0.03), scale.colour(0.97)],
  };
})()`;

(async () => {
  const browser = launch(room);
  try {
    const page = await visitRecording(browser, write("saved", fixture.stream({ look: "stylus" })), fixture.FRAMES);
    await seek(page, 150);
    await check("a saved picture has the force's value, its scale, and the colours of depth", async () => {
      const saved = await page.ask(SAVED);
      const said = JSON.stringify(saved);
      near(saved.size, saved.wanted, 1.01);
      const [text, ink, paper] = saved.label;
      assert(/^\d\.\d\d N$/.test(text) && ink > 0.03 && ink < 0.5 && paper > 0.4, said);
      assert(saved.bar > 0.8 && saved.words > 0.02 && saved.words < 0.6, said);
      near(saved.ramp[0], saved.ramp[2], 12);
      near(saved.ramp[1], saved.ramp[3], 12);
    });
    await check("a tool that feels nothing has no value there either", async () => {
      await seek(page, 20);
      await page.settle();
      assert.strictEqual(await page.ask("document.getElementById('labels').children.length"), 0);
    });
    assert.deepStrictEqual(page.said, []);
    await browser.leave(page);
  } finally {
    await browser.close();
  }
  finish();
})().catch(error => {
  console.log(`FAIL the saved picture's test itself: ${error.stack}`);
  process.exit(1);
});
