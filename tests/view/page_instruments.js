// SPDX-License-Identifier: BSD-3-Clause
// node page_instruments.js PAGE.html ROOM: what tools look like beyond what is felt: the rods alone, then in a headless Chromium.
"use strict";
const { launch } = require("./chromium.js");
const { check, near, finish, assert, scripts } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, colour, pixel, likeness, view } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const { instruments } = scripts("rays", "instruments");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);
const A = [0.1, 0.2, 0.3];
const B = [0.1, 0.2, 0.4];
const RADIUS = 0.002;
const UPRIGHT = [...A, 1, 0, 0, 0];

async function rods() {
  await check("each instrument has parts beyond the segment's ends, and none along what is felt", () => {
    const names = Object.keys(instruments.LOOKS);
    assert.deepStrictEqual(names, ["none", "stylus", "needle", "scalpel", "forceps", "laparoscope"]);
    for (const look of names) {
      const all = instruments.rodsOf(look, A, B, RADIUS, UPRIGHT);
      assert.strictEqual(all.length > 0, look !== "none", look);
      for (const { a, b } of all) {
        const [from, to] = [a[2], b[2]].sort((x, y) => x - y);
        assert(from > B[2] - 1e-9 || to < A[2] + 5 * RADIUS, `${look}: ${from} to ${to}`);
        assert(to < B[2] + 50 * RADIUS && from > A[2] - 10 * RADIUS, `${look}: ${from} to ${to}`);
      }
    }
  });
  await check("it turns about its axis with the tool's frame, and grows with its radius", () => {
    const quarter = [...A, Math.SQRT1_2, 0, 0, Math.SQRT1_2]; // x goes to y
    const jaws = pose => instruments.rodsOf("forceps", A, B, RADIUS, pose).slice(0, 2).map(({ a }) => a.map((value, k) => value - A[k]));
    const [[x, y, z]] = jaws(UPRIGHT);
    assert(Math.abs(x) > 2 * RADIUS - 1e-9 && Math.abs(y) < 1e-12);
    near(jaws(quarter)[0], [0, x, z], 1e-12);
    const wide = radius => instruments.rodsOf("needle", A, B, radius, null).flatMap(({ radiusA, radiusB }) => [radiusA, radiusB]);
    const once = wide(RADIUS);
    near(wide(3 * RADIUS), once.map(value => 3 * value), 1e-12);
    assert(Math.max(...once) > RADIUS);
  });
  await check("a tool that is nowhere, or a point without a pose, has none", () => {
    assert.deepStrictEqual(instruments.rodsOf("needle", [NaN, 0, 0], B, RADIUS, null), []);
    assert.deepStrictEqual(instruments.rodsOf("needle", A, A, RADIUS, null), []);
    assert(instruments.rodsOf("needle", A, A, 0, UPRIGHT).every(({ a, radiusB }) => a.every(Number.isFinite) && radiusB >= 0));
  });
}

async function drawn(browser) {
  const far = fixture.TOOL.to.map((value, k) => value + [0, 25 * fixture.TOOL.radius, fixture.TOOL.radius][k]); // past its end
  const [seen, ends, words] = [{}, {}, {}];
  let grip = null;
  for (const look of [null, "stylus"]) {
    const page = await visitRecording(browser, write(`look-${look}`, fixture.stream({ look })), fixture.FRAMES);
    await seek(page, 150);
    await view(page, "5");
    ends[look] = await page.ask(`(view => {
      const { snapshot, width, height } = view;
      const { centre, radius } = view.bounds();
      const all = toolView.dressOf(snapshot, snapshot.tools[0], view.scales.look).flatMap(({ a, b }) => [a, b]);
      const near = all.filter(place => rays.length(rays.sub(place, centre)) < 1.5 * radius);
      const isOut = ([x, y]) => x < 0 || y < 0 || x > width || y > height;
      return [all.length, near.length, near.map(place => view.project(place)).filter(isOut).length];
    })(viewer.own.view)`);
    words[look] = await page.ask("document.getElementById('dressed').checkVisibility()");
    for (let i = 0; i < 5; i++) await page.key("-");
    grip = await colour(page, "grip");
    seen[look] = await pixel(page, far);
    assert.deepStrictEqual(page.said, []);
    await browser.leave(page);
  }
  await check("a stylus has a handle behind what is felt; without a look there is none", () => {
    assert(likeness(seen.stylus, grip) > 0.96 && seen.stylus[0] < 160, `${seen.stylus}`);
    assert(seen.null[0] > 200, `${seen.null}`);
    assert.deepStrictEqual(words, { null: false, stylus: true }, "and the legend says that it is for the eye alone");
  });
  await check("the camera takes in what is near of it", () => {
    assert(ends.null[0] === 0 && ends.stylus[0] === 6 && ends.stylus[1] > 2, JSON.stringify(ends));
    assert.strictEqual(ends.stylus[2], 0, JSON.stringify(ends));
  });
}

(async () => {
  await rods();
  const browser = launch(room);
  await drawn(browser);
  await browser.close();
  finish();
})().catch(error => {
  console.log(`FAIL the instruments' test itself: ${error.stack}`);
  process.exit(1);
});
