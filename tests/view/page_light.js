// SPDX-License-Identifier: BSD-3-Clause
// node page_light.js PAGE.html ROOM: light that tells depth: shade, shadows, shine, and edges that are smooth in time. First
// the parts alone, then what a headless Chromium draws.
"use strict";
const { launch, until } = require("./chromium.js");
const { check, near, finish, assert, scripts } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, pixel, view, on, top } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const known = fixture.recording();
const { rays, occlusion, smoothing } = scripts("rays", "occlusion", "smoothing");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);
const { middle, tube } = fixture.RING;
const light = rgb => rgb.reduce((sum, value) => sum + (value / 255) ** 2.2, 0);

function bake(meshes) {
  const parts = meshes.map(({ positions, corners }) => {
    const normals = new Float32Array(positions.length);
    rays.makeNormals(positions, corners, normals);
    return { places: positions, normals, corners, isClosed: true };
  });
  const work = new occlusion.Bake(parts);
  for (let i = 0; i < 1000 && !work.isDone; i++) work.advance();
  assert(work.isDone);
  return work.shades();
}

async function shade() {
  await check("a ball sees all of its sky; the inner side of a ring less of it than the outer one", () => {
    const [ring, ball] = known.meshes;
    const [open] = bake([ball]);
    assert(Math.min(...open) > 0.97, `the ball: ${Math.min(...open)}`);
    const [shades] = bake([ring]);
    const sides = { inner: [], outer: [] };
    shades.forEach((value, i) => {
      const [x, y, z] = ring.positions.subarray(3 * i, 3 * i + 3);
      const from = Math.hypot(x, y);
      if (Math.abs(z) < 0.2 * tube) sides[from < middle ? "inner" : "outer"].push(value);
    });
    const [inner, outer] = [Math.max(...sides.inner), Math.min(...sides.outer)];
    assert(outer > 0.95 && inner < 0.85 && inner > 0.3, `outer ${outer}, inner ${inner}`);
  });
  await check("what is below a wide roof is darker, what is beside it is not", () => {
    const [, ball] = known.meshes;
    const at = (by, z) => Float32Array.from(ball.positions, (value, i) => value + [by, 0, z][i % 3]);
    const roof = { positions: Float32Array.from(ball.positions, (value, i) => value * [3, 3, 0.2][i % 3] + [0, 0, 0.06][i % 3]), corners: ball.corners };
    const [below, beside] = bake([{ ...ball, positions: at(0, 0) }, { ...ball, positions: at(0.3, 0) }, roof]);
    const top = ball.positions.reduce((best, value, i) => (i % 3 === 2 && value > ball.positions[3 * best + 2] ? (i - 2) / 3 : best), 0);
    assert(below[top] < 0.6 && beside[top] > 0.9, `${below[top]}, ${beside[top]}`);
  });
}

async function edges() {
  // Pictures of so many ms, then rest; returns what was asked of the view at last, before and after the rest.
  const run = (took, pictures, isSpared) => {
    const one = new smoothing.Smoothing();
    one.begin(isSpared);
    let on = null;
    let now = 0;
    for (let i = 0; i < pictures; i++, now += took) one.tick(now, true, value => (on = value));
    const moving = on;
    let asked = 0;
    for (let i = 0, due = false; i < 60; i++, now += 16) {
      const drawn = due; // the picture that was asked for in the one before
      due = false;
      one.tick(now, drawn, value => ((on = value), asked++, (due = true)));
    }
    return [moving, on, asked];
  };
  await check("smooth edges go when pictures come slower than 30 a second, and come back at rest, once", () => {
    assert.deepStrictEqual(run(16, 40, false), [true, true, 0]);
    assert.deepStrictEqual(run(32, 40, false), [true, true, 0]);
    assert.deepStrictEqual(run(36, 40, false), [false, true, 1]);
    assert.deepStrictEqual(run(16, 40, true), [false, true, 1], "beside a running world");
  });
}

// How bright places beside the tool are, along the ring's top, in parts of what they are in frame 0, where it is far above.
async function beside(page, frame) {
  const places = Array.from({ length: 20 }, (_, i) => middle + 0.005 + 0.0004 * i).map(x => [
    x,
    -0.016,
    Math.sqrt(tube ** 2 - (Math.hypot(x, 0.016) - middle) ** 2),
  ]);
  const read = async () => {
    const all = [];
    for (const place of places) all.push(light(await pixel(page, place)));
    return all;
  };
  await seek(page, 0);
  const free = await read();
  await seek(page, frame);
  const parts = (await read()).map((value, i) => value / free[i]);
  const darkest = Math.min(...parts);
  return { darkest, at: 1e3 * (places[parts.indexOf(darkest)][0] - middle), brightest: Math.max(...parts) };
}

async function shadows(browser) {
  const page = await visitRecording(browser, write("ring", fixture.stream()), fixture.FRAMES, { width: 1280, height: 800 });
  await view(page, "5");
  await page.ask("viewer.own.view.tools.objects.forEach(({ layers }) => layers.disableAll()), 0"); // its shadow alone is seen
  await check("the tool throws a shadow on the ring, which is farther from it the higher it is", async () => {
    const low = await beside(page, 48); // 8 mm above the ring
    const high = await beside(page, 39); // 14 mm
    const said = JSON.stringify([low, high]);
    assert(low.darkest < 0.75 && high.darkest < 0.88 && high.darkest > low.darkest + 0.05, said);
    assert(low.brightest > low.darkest + 0.1 && high.brightest > high.darkest + 0.1 && high.brightest <= 1.02, said);
    // The sun stands 0.7 to the left and 1.1 towards the eye: a shadow moves by 7/11 of the height.
    near(high.at - low.at, (7 / 11) * 6, 1.5, "mm to the right:");
  });
  assert.deepStrictEqual(page.said, []);
  await browser.leave(page);
}

async function looks(browser) {
  const bright = {};
  for (const look of ["organ", "cloth", "bone"]) {
    const bodies = [{ id: 11, mesh: 0, pose: [0, 0, 0, 1, 0, 0, 0], name: "ring", colour: [0.5, 0.1, 0.1], look }];
    const scene = fixture.sceneMessage(known.meshes.slice(0, 1), { mode: "mesh", device: null, bodies });
    const page = await browser.visit(write(look, fixture.streamOf([scene])));
    await until("its shade", () => page.ask("viewer.own.view?.bake.isDone ?? false"));
    await view(page, "5");
    // Half way between eye and sun, the ring's outer upper left.
    const seen = [];
    for (let i = 0; i < 24; i++)
      for (const up of [0.7, 0.9, 1.2]) {
        const turn = (2 * Math.PI * i) / 24;
        const out = middle + 0.98 * tube * Math.cos(up);
        seen.push((await pixel(page, [out * Math.cos(turn), out * Math.sin(turn), tube * Math.sin(up)]))[2]);
      }
    bright[look] = Math.max(...seen);
    await browser.leave(page);
  }
  await check("organs shine, bone a little, cloth not", () => {
    assert(bright.organ > bright.bone + 15 && bright.bone > bright.cloth + 5, JSON.stringify(bright));
  });
}

// A box of 12 triangles beside the ring: what is faceted, and what is drawn of it.
async function faces(browser) {
  const box = fixture.box("box", [0.03, 0.03, 0.03]);
  await check("a box is faceted, a ring and a ball are not", () =>
    assert.deepStrictEqual([box, ...known.meshes].map(rays.isFaceted), [true, false, false]));
  const body = (id, mesh, place, colour) => ({ id, mesh, pose: [...place, 1, 0, 0, 0], name: "body", colour });
  const bodies = [body(11, 0, [0, 0, 0], [0.5, 0.5, 0.5]), body(12, 1, [0.2, 0, 0], [0.5, 0.5, 0.5])];
  const scene = fixture.sceneMessage([box, known.meshes[0]], { mode: "mesh", device: null, bodies });
  const page = await browser.visit(write("faces", fixture.streamOf([scene])));
  await until("its shade", () => page.ask("viewer.own.view?.bake.isDone ?? false"));
  await page.key("f");
  await page.settle();
  const seen = {};
  for (const [face, place] of [["top", (u, v) => [u, v, 0.03]], ["front", (u, v) => [u, -0.03, v]]]) {
    seen[face] = [];
    for (const u of [-0.025, 0, 0.025]) for (const v of [-0.025, 0.004, 0.025]) seen[face].push(await pixel(page, place(u, v)));
  }
  await check("each face of a box has one colour, and the next one another", () => {
    for (const all of Object.values(seen)) for (const rgb of all) near(rgb, all[0], 3, JSON.stringify(seen));
    assert(Math.abs(light(seen.top[0]) - light(seen.front[0])) > 0.1, JSON.stringify(seen));
  });
  assert.deepStrictEqual(page.said, []);
  await browser.leave(page);
}

// A sheet above the tool, of the page's own colour and blue.
async function veil(browser) {
  const sheet = {
    name: "sheet",
    positions: Float32Array.from([-0.2, -0.1, 0.07, 0.1, -0.1, 0.07, 0.1, 0.1, 0.07, -0.2, 0.1, 0.07]),
    corners: Uint32Array.from([0, 1, 2, 0, 2, 3]),
    sources: Uint32Array.from([0, 1]),
  };
  const bodies = [0, 1, 2].map(mesh => ({ id: 11 + mesh, mesh, pose: [...(mesh === 1 ? fixture.BALL.centre : [0, 0, 0]), 1, 0, 0, 0], name: "body", colour: mesh === 2 ? [0.1, 0.1, 0.9] : null }));
  const scene = fixture.sceneMessage([...known.meshes, sheet], { bodies });
  const frames = Array.from({ length: fixture.FRAMES }, (_, i) => known.frame(i));
  const page = await visitRecording(browser, write("veil", fixture.streamOf([scene, ...frames, known.end])), fixture.FRAMES);
  await seek(page, 150);
  await view(page, "5");
  const { proxy } = fixture.placesAt(150);
  const tool = await pixel(page, top(on(proxy, 0.12)));
  await page.ask("viewer.own.view.veilSheets = () => {}, viewer.own.view.veiled.main.clear(), 0");
  const hidden = await pixel(page, top(on(proxy, 0.12)));
  await check("a sheet between the eye and the tool is seen through", () => {
    assert(hidden[2] > 3 * hidden[0], `the sheet hides it without: ${hidden}`);
    assert(tool[2] < 0.75 * hidden[2] && tool[0] > 1.2 * hidden[0], `${tool}, hidden it is ${hidden}`);
  });
  await page.ask("delete viewer.own.view.veilSheets, viewer.own.view.isVeilDue = true, viewer.own.view.draw(true), 0");
  await check("sheets are asked for with a frame and when the camera rests, not with each picture", async () => {
    const asked = await page.ask(`(async () => {
      const { view } = viewer.own;
      let count = 0;
      view.veilSheets = () => (count++, view.constructor.prototype.veilSheets.call(view));
      for (let i = 0; i < 3; i++) (view.dirty = true), view.draw(false);
      const drawn = count;
      view.camera.rotate(0.01, 0);
      for (let i = 0; i < 400 && count === 0; i++) await new Promise(done => setTimeout(done, 50));
      await new Promise(done => setTimeout(done, 500));
      delete view.veilSheets;
      return [drawn, count];
    })()`);
    assert.deepStrictEqual(asked, [0, 1]);
  });
  await browser.leave(page);
}

// What a scene leaves behind, a picture without a size, and labels of a picture that is saved.
async function scenes(browser) {
  const page = await visitRecording(browser, write("scenes", fixture.stream()), fixture.FRAMES);
  await until("its shade", () => page.ask("viewer.own.view.bake.isDone"));
  await check("when the shade is whole, edges are judged anew", async () => {
    const begun = await page.ask(`(async () => {
      const { begin } = smoothing.Smoothing.prototype;
      let count = 0;
      smoothing.Smoothing.prototype.begin = function (...given) { count++; begin.apply(this, given); };
      const { view } = viewer.own;
      const parts = [...view.bodies.values()].map(body => ({
        view: body,
        places: body.places(),
        normals: body.normalsInScene(),
        corners: body.mesh.corners,
        isClosed: true,
      }));
      view.bake = new occlusion.Bake(parts);
      while (!view.bake.isDone) await new Promise(requestAnimationFrame);
      await new Promise(requestAnimationFrame);
      smoothing.Smoothing.prototype.begin = begin;
      return count;
    })()`);
    assert.strictEqual(begun, 1);
  });
  await check("a scene that goes leaves nothing behind", async () => {
    const [gone, before, after] = await page.ask(`(() => {
      const { view } = viewer.own;
      let gone = 0;
      for (const { object } of view.bodies.values()) object.material.addEventListener("dispose", () => gone++);
      view.box.material.addEventListener("dispose", () => gone++);
      view.draw(true);
      const count = () => view.renderer.info.memory.geometries;
      const before = count();
      for (let i = 0; i < 3; i++) view.setScene(viewer.own.scene), view.draw(true);
      return [gone, before, count()];
    })()`);
    assert.strictEqual(gone, 3);
    assert(after <= before, `${before} geometries, then ${after}`);
  });
  await check("a picture without a size has a camera all the same, and is fitted once it has one", async () => {
    const [hidden, shown, wanted] = await page.ask(`(() => {
      const { view, scene } = viewer.own;
      view.fit(false);
      const wanted = view.camera.state.distance;
      Object.defineProperty(view.canvas, "clientWidth", { value: 0, configurable: true });
      view.width = view.height = undefined;
      view.setScene({ ...scene, title: "another" });
      const hidden = { ...view.camera.state };
      delete view.canvas.clientWidth;
      view.draw(true);
      return [hidden, { ...view.camera.state }, wanted];
    })()`);
    for (const { target, distance } of [hidden, shown])
      assert([...target, distance].every(value => Number.isFinite(value)), JSON.stringify([hidden, shown]));
    near(shown.distance, wanted, 0.3 * wanted);
  });
  await check("a pan before the first frame stays", async () => {
    const moved = await page.ask(`(() => {
      const { view, scene, frame } = viewer.own;
      view.setScene({ ...scene, title: "a third" });
      view.camera.pan(50, 0);
      const before = [...view.camera.state.target];
      view.show(frame.snapshot, new Map());
      return view.camera.state.target.map((value, k) => value - before[k]);
    })()`);
    near(moved, [0, 0, 0], 1e-12);
  });
  await check("a picture that is saved is followed by one for the labels", async () => {
    const isDirty = "(view => (view.draw(true), view.picture(), view.dirty))(viewer.own.view)";
    assert.strictEqual(await page.ask(isDirty), true);
  });
  assert.deepStrictEqual(page.said, []);
  await browser.leave(page);
}

(async () => {
  await shade();
  await edges();
  const browser = launch(room);
  await shadows(browser);
  await looks(browser);
  await faces(browser);
  await veil(browser);
  await scenes(browser);
  await browser.close();
  finish();
})().catch(error => {
  console.log(`FAIL the light's test itself: ${error.stack}`);
  process.exit(1);
});
