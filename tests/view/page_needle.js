// SPDX-License-Identifier: BSD-3-Clause
// node page_needle.js PAGE.html ROOM: a needle's channel in a headless Chromium: what is beyond the entry shows through the
// body, the hole stays when the needle is out, and its numbers stand beside.
"use strict";
const { launch } = require("./chromium.js");
const { check, finish, assert } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, colour, pixel, likeness, view } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);

// Down into the ring, beside the fixture's tool.
const AT = [-0.07, 0, 0.025];
const DOWN = [0, 0, -1];
const RADIUS = 0.002;
const below = depth => [AT[0], AT[1], AT[2] - depth];
const CASES = {
  none: [],
  in: [fixture.channelSection(1, AT, DOWN, RADIUS, [0.02, 0.04, 0.02])],
  out: [fixture.channelSection(0, AT, DOWN, RADIUS, [0, 0.04, 0])],
};

async function drawn(browser) {
  const seen = {};
  const texts = {};
  const colours = {};
  for (const [name, more] of Object.entries(CASES)) {
    const page = await visitRecording(browser, write(`needle-${name}`, fixture.stream({ more })), fixture.FRAMES);
    await seek(page, 10);
    await view(page, "1");
    for (const part of ["proxy", "pair"]) colours[part] = await colour(page, part);
    seen[name] = { rim: await pixel(page, AT), shaft: await pixel(page, below(0.01)), beyond: await pixel(page, below(0.03)) };
    texts[name] = await page.ask(
      "[...document.querySelectorAll('dd')].filter(dd => /^needle/.test(dd.dataset.readout) && dd.checkVisibility()).map(dd => dd.textContent)",
    );
    assert.deepStrictEqual(page.said, []);
    await browser.leave(page);
  }
  const nearer = (place, part) => likeness(place.to, colours[part]) > likeness(place.from, colours[part]);
  const change = (name, where) => ({ from: seen.none[where], to: seen[name][where] });
  const apart = ({ from, to }) => Math.max(...from.map((value, k) => Math.abs(value - to[k])));
  await check("the shaft beyond the entry shows through the body", () => {
    const shaft = change("in", "shaft");
    assert(nearer(shaft, "proxy") && apart(shaft) > 30, JSON.stringify(seen));
    assert(apart({ from: seen.in.shaft, to: seen.out.shaft }) > 15, "an empty channel looks otherwise");
  });
  await check("so do the hole's rim and what is empty of the channel, also when the needle is out", () => {
    for (const name of ["in", "out"])
      for (const where of ["rim", "beyond"]) {
        const here = change(name, where);
        assert(nearer(here, "pair") && apart(here) > 15, `${name} ${where}: ${JSON.stringify(seen)}`);
      }
  });
  await check("its numbers stand beside, where there is a needle in", () => {
    assert.deepStrictEqual(texts.in, ["20.00 mm", "20.00 mm", "1, 1"]);
    assert.deepStrictEqual([texts.none, texts.out], [[], []]);
  });
}

(async () => {
  const browser = launch(room);
  await drawn(browser);
  await browser.close();
  finish();
})().catch(error => {
  console.log(`FAIL the needle's test itself: ${error.stack}`);
  process.exit(1);
});
