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
  await check("each instrument has parts beyond the segment's ends, and none along what is felt but jaws", () => {
    const names = Object.keys(instruments.LOOKS);
    assert.deepStrictEqual(names, ["none", "stylus", "needle", "scalpel", "forceps", "laparoscope"]);
    for (const look of names) {
      const all = instruments.rodsOf(look, A, B, RADIUS, UPRIGHT);
      assert.strictEqual(all.length > 0, look !== "none", look);
      for (const { a, b } of all) {
        const [from, to] = [a[2], b[2]].sort((x, y) => x - y);
        assert(from > B[2] - 1e-9 || to < A[2] + (5 + instruments.clearOf(look)) * RADIUS, `${look}: ${from} to ${to}`);
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

async function jaws(browser) {
  await check("jaws open and close with the tool's setting, within what is felt when they are closed", () => {
    const jawsOf = opening => instruments.rodsOf("forceps", A, B, RADIUS, UPRIGHT, opening).slice(0, 2);
    const asideOf = opening => jawsOf(opening).map(({ a }) => a[0] - A[0]);
    near(asideOf(0), [0.5 * RADIUS, -0.5 * RADIUS], 1e-12);
    near(asideOf(1), [3.5 * RADIUS, -3.5 * RADIUS], 1e-12);
    near(asideOf(0.5), [2 * RADIUS, -2 * RADIUS], 1e-12);
  });
  // A block beside the tool's end b, which turns away about a hinge there; ticks say how far.
  const { to, radius } = fixture.TOOL;
  const long = Math.hypot(...to.map((value, k) => value - fixture.TOOL.from[k]));
  const block = fixture.box("block", [2 * radius, 2 * radius, 4 * radius]);
  const known = fixture.recording();
  const hinge = [0, 0, long, 1, 0, 0, Math.PI / 2];
  const dress = [{ mesh: 2, pose: [0, 0, long + 8 * radius, 1, 0, 0, 0], hinge, colour: [0, 1, 0] }];
  const body = (id, mesh, place) => ({ id, mesh, pose: [...place, 1, 0, 0, 0], name: "body" });
  const bodies = [body(11, 0, [0, 0, 0]), body(12, 1, fixture.BALL.centre)];
  const scene = fixture.sceneMessage([...known.meshes, block], { dress, jaws: true, bodies });
  const frames = Array.from({ length: fixture.FRAMES }, (_, i) => {
    const frame = Buffer.from(known.frame(i));
    const ticks = frame.readUInt32LE(8);
    for (let k = 0; k < ticks; k++) frame.writeFloatLE(i < 150 ? 0 : 1, 80 + frame.readUInt32LE(4) + 40 * k + 36);
    return frame;
  });
  const stream = fixture.streamOf([scene, ...frames, known.end]);
  const page = await visitRecording(browser, write("dress", stream), fixture.FRAMES);
  const isGreen = ([r, g, b]) => g > 60 && g > 2 * r && g > 2 * b;
  const placeOfBlock = () => page.ask(`(view => {
    const { parts: [part] } = view.dress;
    view.draw(true);
    return new THREE.Vector3().setFromMatrixPosition(part.object.matrix).toArray();
  })(viewer.own.view)`);
  await check("a mesh of the user's own stands where the tool is, turns with its jaws, and is in the legend", async () => {
    const seen = [];
    for (const frame of [149, 150]) {
      await seek(page, frame);
      await view(page, "5");
      const { proxy } = fixture.placesAt(frame);
      const axis = proxy[1].map((value, k) => (value - proxy[0][k]) / long);
      const closed = proxy[1].map((value, k) => value + 8 * radius * axis[k]);
      const at = await placeOfBlock();
      const off = Math.hypot(...at.map((value, k) => value - closed[k]));
      seen.push([off, isGreen(await pixel(page, closed)), isGreen(await pixel(page, at))]);
    }
    const [shut, open] = seen;
    assert(shut[0] < 1e-6 && shut[1] && shut[2], JSON.stringify(seen));
    near(open[0], 8 * radius * Math.SQRT2, 1e-6, "a quarter turn about end b:");
    assert(open[2] || !open[1], JSON.stringify(seen));
    assert.strictEqual(await page.ask("document.getElementById('dressed').checkVisibility()"), true);
  });
  await check("what is felt is seen through where meshes stand for it", async () => {
    const [tube, box] = await page.ask(`(view => {
      const [{ object }] = view.dress.parts;
      const mesh = { positions: new Float32Array(9), corners: Uint32Array.of(0, 1, 2), vertices: 3 };
      const open = new dress.Dress([{ mesh: 0, pose: [0, 0, 0, 1, 0, 0, 0], hinge: null, colour: null }], [mesh]);
      return [open.objects[0], object].map(({ material }) => material.side === THREE.DoubleSide);
    })(viewer.own.view)`);
    assert.deepStrictEqual([tube, box], [true, false], "an open mesh is seen from both sides");
    const lists = "({ proxy, clearProxy }) => [proxy.list.length, clearProxy.list.length]";
    const [solid, clear] = await page.ask(`(${lists})(viewer.own.view.tools)`);
    assert.deepStrictEqual([solid, clear], [0, 1]);
  });
  await check("a dress that goes leaves nothing behind", async () => {
    const [before, after] = await page.ask(`(view => {
      const count = () => view.renderer.info.memory.geometries;
      const { snapshot } = view;
      view.draw(true);
      const before = count();
      for (let i = 0; i < 3; i++) {
        view.setScene(viewer.own.scene);
        view.show(snapshot, new Map());
        view.draw(true);
      }
      return [before, count()];
    })(viewer.own.view)`);
    assert(after <= before, `${before} geometries, then ${after}`);
  });
  assert.deepStrictEqual(page.said, []);
  await browser.leave(page);
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
      const near = all.filter(place => rays.length(rays.sub(place, centre)) < 2 * radius);
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

// A needle as long as the scene is wide: its syringe is farther from the middle than all bodies are.
async function syringes(browser) {
  const long = 0.15;
  const stream = fixture.stream({ look: "needle" });
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    const page = await browser.visit(write("syringe", stream), { width, height });
    await seek(page, 1);
    const out = await page.call(long => {
      const { view } = viewer.own;
      const { snapshot } = view;
      const { centre, radius } = view.bounds();
      const [segment] = snapshot.segments;
      const from = [centre[0], centre[1], centre[2] + 0.5 * radius];
      const to = [from[0], from[1], from[2] + long];
      Object.assign(segment, { a: from, b: to, proxyA: from, proxyB: to, radius: 0.0012 });
      view.show(snapshot, new Map());
      view.fit(false);
      view.draw(true);
      const rods = toolView.dressOf(snapshot, snapshot.tools[0], "needle").flatMap(({ a, b }) => [a, b]);
      const farthest = Math.max(...rods.map(place => rays.length(rays.sub(place, centre)))) / radius;
      const isOut = ([x, y]) => x < 0 || y < 0 || x > view.width || y > view.height;
      return [farthest, rods.map(place => view.project(place)).filter(isOut).length];
    }, long);
    await check(`at ${width} x ${height} a needle's syringe is in the picture, out to two radii of the scene`, () => {
      assert(out[0] > 1.55 && out[0] < 2, `${out[0]} radii`);
      assert.strictEqual(out[1], 0);
    });
    await browser.leave(page);
  }
}

(async () => {
  await rods();
  const browser = launch(room);
  await drawn(browser);
  await syringes(browser);
  await jaws(browser);
  await browser.close();
  finish();
})().catch(error => {
  console.log(`FAIL the instruments' test itself: ${error.stack}`);
  process.exit(1);
});
