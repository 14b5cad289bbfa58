// SPDX-License-Identifier: BSD-3-Clause
// node page_inset.js PAGE.html ROOM: the second, small view: where it stands, what it shows, and what it leaves alone.
"use strict";
const { launch } = require("./chromium.js");
const { check, near, finish, assert } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, colour, pixel, likeness, on, top, textsOf, view } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const known = fixture.recording();
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);
const ABOVE = [0, -0.02, 0.7, 0, 0, 0, 0, 0, 1];

// The colour at a place of the scene as the second view has it.
const inInset = (page, place) =>
  page.call(place => {
    const { inset, canvas, height } = viewer.own.view;
    const p = new THREE.Vector3(...place).project(inset.camera.object);
    const box = inset.box(canvas);
    return dynpoint.pixelAt([box.x + ((p.x + 1) / 2) * box.width, height - box.y - ((p.y + 1) / 2) * box.height]);
  }, place);

async function shown(browser) {
  const page = await visitRecording(browser, write("inset", fixture.stream({ inset: ABOVE })), fixture.FRAMES);
  await seek(page, 150);
  await check("the second view shows the scene from its own place: organ, tool, and what is behind", async () => {
    const organ = await colour(page, "organ");
    const proxy = await colour(page, "proxy");
    const background = await colour(page, "background");
    near(await inInset(page, [0, 0, 0]), background, 2, "in the ring's hole:");
    for (const place of [[-0.06, 0, 0.025], [0, 0.06, 0.025]]) {
      const got = await inInset(page, place);
      assert(likeness(got, organ) > 0.985, `${got} at ${place}`);
    }
    const got = await inInset(page, top(on(fixture.placesAt(150).proxy, 0.93)));
    assert(likeness(got, proxy) > 0.95 && likeness(got, organ) < 0.97, `${got}, not like ${proxy}`);
  });
  await check("it does not turn with the large one", async () => {
    const before = await inInset(page, [-0.06, 0, 0.025]);
    await view(page, "2");
    near(await inInset(page, [-0.06, 0, 0.025]), before, 8);
    near(await inInset(page, [0, 0, 0]), await colour(page, "background"), 2);
  });
  await check("the tool in it is that of the frame", async () => {
    const place = top(on(fixture.placesAt(150).proxy, 0.93));
    const now = await inInset(page, place);
    await seek(page, 0);
    assert(likeness(await inInset(page, place), now) < 0.999, `${now}`);
    await seek(page, 150);
  });
  await check("the arrow's value stands in the large view alone, and the large view is whole", async () => {
    await view(page, "5");
    const labels = await page.ask("document.getElementById('labels').children.length");
    const arrows = await page.ask("dynpoint.arrows().length");
    assert.deepStrictEqual([labels, arrows], [1, 1]);
    const organ = await colour(page, "organ");
    const got = await pixel(page, [-0.06, 0, 0.025]);
    assert(likeness(got, organ) > 0.985, `${got}`);
  });
  assert.deepStrictEqual(page.said, []);
  await browser.leave(page);
}

async function veiled(browser) {
  const sheet = {
    name: "sheet",
    positions: Float32Array.from([-0.2, -0.1, 0.07, 0.1, -0.1, 0.07, 0.1, 0.1, 0.07, -0.2, 0.1, 0.07]),
    corners: Uint32Array.from([0, 1, 2, 0, 2, 3]),
    sources: Uint32Array.from([0, 1]),
  };
  const { centre } = fixture.BALL;
  const body = (id, mesh, place, colour) => ({ id, mesh, pose: [...place, 1, 0, 0, 0], name: "body", colour });
  const bodies = [body(11, 0, [0, 0, 0], null), body(12, 1, centre, null), body(13, 2, [0, 0, 0], [0.1, 0.1, 0.9])];
  const scene = fixture.sceneMessage([...known.meshes, sheet], { bodies, inset: ABOVE });
  const frames = Array.from({ length: fixture.FRAMES }, (_, i) => known.frame(i));
  const stream = fixture.streamOf([scene, ...frames, known.end]);
  const page = await visitRecording(browser, write("inset-veil", stream), fixture.FRAMES);
  await seek(page, 150);
  await view(page, "6"); // from below
  await page.ask("viewer.own.view.veilSheets(), 0");
  await check("a sheet that hides the tool from outside alone is seen through there alone", async () => {
    const [main, inset] = await page.ask("[...Object.values(viewer.own.view.veiled)].map(set => [...set])");
    assert.deepStrictEqual([main, inset], [[], [13]]);
    const through = await inInset(page, [-0.06, 0, 0.025]);
    await page.ask("(viewer.own.view.veiled.inset = new Set()), 0");
    const hidden = await inInset(page, [-0.06, 0, 0.025]);
    assert(hidden[2] > 3 * hidden[0], `the sheet hides it without: ${hidden}`);
    assert(through[0] > 1.2 * hidden[0], `${through}, hidden it is ${hidden}`);
  });
  await browser.leave(page);
}

async function placed(browser) {
  const address = write("inset-placed", fixture.stream({ inset: ABOVE, look: "forceps" }));
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    const page = await browser.visit(address, { width, height });
    await seek(page, 150);
    await check(`at ${width} x ${height} it lies within the picture, clear of legend, buttons and texts`, async () => {
      const boxes = await page.ask(`["inset", "picture", "legend", "views", "deformation"].map(id => {
        const { left, right, top, bottom } = document.getElementById(id).getBoundingClientRect();
        return [left, right, top, bottom];
      })`);
      const [[left, right, top, bottom], [from, to, upper, lower], ...others] = boxes;
      const said = JSON.stringify(boxes);
      assert(left >= from && right <= to && top >= upper && bottom <= lower && right - left >= 100, said);
      for (const [a, b, c, d] of others) assert(right <= a || left >= b || bottom <= c || top >= d, said);
      const { cut, crossed, texts } = await page.call(textsOf);
      assert(texts > 20);
      assert.deepStrictEqual([cut, crossed], [[], []]);
    });
    await check(`at ${width} x ${height} clicks, drags, fingers and the wheel do not go through it`, async () => {
      const read = () => page.ask("[viewer.own.picked, viewer.own.view.camera.state]");
      const { left, top, width: wide, height: high } = await page.ask(
        "document.getElementById('inset').getBoundingClientRect().toJSON()",
      );
      const at = (x, y) => [left + x * wide, top + y * high];
      const before = await read();
      await page.click(at(0.5, 0.5));
      await page.drag(at(0.3, 0.5), at(0.7, 0.6));
      await page.touch([[at(0.5, 0.5)]]);
      await page.touch([[at(0.3, 0.5)], [at(0.5, 0.5)], [at(0.7, 0.5)]]);
      await page.mouse("mouseWheel", at(0.5, 0.5), { deltaX: 0, deltaY: -50 });
      await page.settle();
      assert.deepStrictEqual(await read(), before);
      await page.drag(at(-0.3, 0.5), at(-0.1, 0.5));
      await page.settle();
      assert.notDeepStrictEqual(await read(), before, "beside it the picture turns");
    });
    await browser.leave(page);
  }
  const page = await visitRecording(browser, write("no-inset", fixture.stream()), fixture.FRAMES);
  await check("a scene without one has none", async () => {
    assert.strictEqual(await page.ask("document.getElementById('inset').checkVisibility()"), false);
  });
  await browser.leave(page);
}

(async () => {
  const browser = launch(room);
  try {
    await shown(browser);
    await veiled(browser);
    await placed(browser);
  } finally {
    await browser.close();
  }
  finish();
})().catch(error => {
  console.log(`FAIL the second view's test itself: ${error.stack}`);
  process.exit(1);
});
