// SPDX-License-Identifier: BSD-3-Clause
// node page_picture.js PAGE.html ROOM: what the page draws, moves and picks, from its file in a headless Chromium. What
// is drawn is asked at places of the scene whose colour is known.
"use strict";
const { launch, until, sleep } = require("./chromium.js");
const { check, near, finish, assert, scripts } = require("./verdicts.js");
const {
  pageWriter,
  visitRecording,
  seek,
  colour,
  pixel,
  likeness,
  on,
  top,
  camera,
  view,
} = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const known = fixture.recording();
const { scale } = scripts("scale");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);

async function drawing(page) {
  const { device, proxy } = fixture.placesAt(150);
  const background = await colour(page, "background");
  const organ = await colour(page, "organ");
  await seek(page, 150);
  await view(page, "5");
  await check("the background is the background, and the organ looks like its colour", async () => {
    near(await pixel(page, [0, 0, 0]), background, 2, "in the ring's hole:");
    for (const place of [
      [-0.06, 0, 0.025],
      [0, 0.06, 0.025],
      [0, -0.06, 0.025],
    ]) {
      const got = await pixel(page, place);
      assert(likeness(got, organ) > 0.985, `${got} at ${place}`);
    }
  });
  await check("the proxy lies over the organ in its colour, and the device's tool shines through", async () => {
    const solid = await colour(page, "proxy");
    const got = await pixel(page, top(on(proxy, 0.85)));
    assert(likeness(got, solid) > 0.97 && likeness(got, organ) < 0.97, `${got}, not like ${solid}`);
    // From the right. At frame 62 the device's tool is still where the proxy is, and not yet at these places.
    await view(page, "4");
    const side = ([x, y, z]) => [x + fixture.TOOL.radius, y, z];
    const places = { bare: side(on(device, 0.98)), hidden: side(on(device, 0.65)) };
    const wanted = await colour(page, "device");
    const seen = {};
    for (const frame of [62, 150]) {
      await seek(page, frame);
      for (const name in places) (seen[name] ??= []).push(await pixel(page, places[name]));
    }
    for (const [name, least] of [
      ["bare", 0.1],
      ["hidden", 0.005],
    ]) {
      const [without, through] = seen[name];
      assert(likeness(through, wanted) > likeness(without, wanted) + least, `${name}: ${through} over ${without}`);
    }
    await view(page, "5");
  });
  await check("a contact is a band on the proxy, in the colour of its depth, as long as its stretch", async () => {
    const solid = await pixel(page, top(on(proxy, 0.25)));
    const { depth } = await page.ask("dynpoint.scales()");
    near(depth, 0.01, 1e-9, "the scale of depth:");
    for (const [s, part] of [
      [0.35, 1],
      [0.42, 1],
      [0.65, 0.25],
    ])
      near(await pixel(page, top(on(proxy, s))), scale.colour((part * fixture.DEEPEST) / depth), 3, `at ${s}:`);
    near(await pixel(page, top(on(proxy, 0.75))), solid, 12, "beyond its end:");
  });
  await check("the strip's triangles are marked, their neighbours are not", async () => {
    const { positions, corners } = known.meshes[0];
    const strip = await colour(page, "strip");
    const middle = i =>
      [0, 1, 2].map(k => [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[3 * i + c] + k] / 3, 0));
    const mirrored = ([x, y, z]) => [-x, y, z];
    const places = known.strip
      .map(middle)
      .filter(([x, y]) => x > 0.071 && Math.abs(y) > 0.004)
      .slice(0, 5);
    for (const place of places) {
      const marked = await pixel(page, place);
      const plain = await pixel(page, mirrored(place));
      assert(likeness(marked, strip) > likeness(plain, strip) + 0.05, `${marked}, ${plain}`);
    }
    assert(places.length >= 3);
  });
  await check(
    "the force's arrow begins at the proxy, points where the force does, and is as long as it is strong",
    async () => {
      await view(page, "1");
      const force = await colour(page, "force");
      const from = on(proxy, 0.5);
      const { radius } = await page.ask("dynpoint.scales()");
      const full = (fixture.STIFFNESS * fixture.DEEPEST) / 10;
      const length = 0.3 * radius * full;
      const at = part => from.map((value, k) => value + part * length * fixture.DIRECTION[k]);
      for (const part of [0.1, 0.4, 0.6]) near(await pixel(page, at(part)), force, 2, `at ${part}:`);
      for (const part of [-0.5, 1.1]) assert(likeness(await pixel(page, at(part)), force) < 0.97, `at ${part}`);
      await seek(page, 80);
      const weaker = fixture.wrenchAt(80 / 60);
      const [arrow] = await page.ask("dynpoint.arrows()");
      near(
        Math.hypot(...arrow.to.map((value, k) => value - arrow.from[k])),
        (0.3 * radius * Math.hypot(...weaker.slice(0, 3))) / 10,
        1e-9,
      );
      await seek(page, 20);
      assert.deepStrictEqual(await page.ask("dynpoint.arrows()"), [], "a tool that is free has no arrow");
    },
  );
  await check("the force's value stands at the arrow's end, and the legend's bar has the arrow's scale", async () => {
    await view(page, "1");
    await seek(page, 150);
    const { text, label, bar, force } = await page.call(() => {
      const middle = ({ left, right, top, bottom }) => [(left + right) / 2, (top + bottom) / 2];
      const box = document.getElementById("picture").getBoundingClientRect();
      const spans = [...document.querySelectorAll("#labels span")];
      return {
        text: spans.map(({ textContent }) => textContent).join(),
        label: middle(spans[0].getBoundingClientRect()).map((value, k) => value - [box.left, box.top][k]),
        bar: document.getElementById("force-bar").getBoundingClientRect().width,
        force: Number.parseFloat(document.getElementById("force-scale").textContent),
      };
    });
    const [{ from, to }] = await page.ask("dynpoint.arrows()");
    const [begin, end] = [await page.call(place => dynpoint.project(place), from), await page.call(place => dynpoint.project(place), to)];
    assert.strictEqual(text, "4.00 N");
    const apart = Math.hypot(label[0] - end[0], label[1] - end[1]);
    assert(apart < 60 && apart < Math.hypot(label[0] - begin[0], label[1] - begin[1]), `${label}, the arrow ends at ${end}`);
    // In the plane of the camera's target, as if the arrow lay across.
    const { radius } = await page.ask("dynpoint.scales()");
    const pixel = await page.ask("viewer.own.view.camera.pixelSize(viewer.own.view.camera.state.target)");
    near(bar, (0.3 * radius * force) / 10 / pixel, 0.2, "pixels:");
    assert(bar > 20 && bar <= 70.1, `${bar} pixels`);
    await seek(page, 20);
    assert.strictEqual(await page.ask("document.querySelectorAll('#labels span').length"), 0, "a tool that is free has no value");
    const labels = await page.ask(`(root => {
      const arrows = [0.0049, 0.0051].map(newtons => ({ ...${JSON.stringify({ from, to })}, newtons }));
      const { view } = viewer.own;
      new arrowLabels.ArrowLabels(root).show({ tools: { arrows }, edges: view.edges, project: at => view.project(at) });
      return [...root.children].map(({ textContent }) => textContent);
    })(document.createElement("div"))`);
    assert.deepStrictEqual(labels, ["0.01 N"], "no value that reads as nothing");
    await seek(page, 150);
  });
  await check("the nearest pair is a line from the axis to the mesh", async () => {
    await seek(page, 20);
    const { device: free } = fixture.placesAt(20);
    const p = on(free, 0.5);
    const q = [0.06, 0, 0.025];
    for (const part of [0, 0.3, 0.7, 1])
      near(
        await pixel(
          page,
          p.map((value, k) => value + part * (q[k] - value)),
        ),
        await colour(page, "pair"),
        2,
        `at ${part}:`,
      );
  });
  await check("the workspace is a wire box", async () => {
    await view(page, "5");
    const at = await page.ask("dynpoint.project([-0.19, 0, 0.09])");
    const seen = [];
    for (let by = -2; by <= 2; by++) seen.push(await page.call(at => dynpoint.pixelAt(at), [at[0] + by, at[1]]));
    assert(
      seen.some(rgb => Math.abs(rgb[0] - background[0]) > 30),
      JSON.stringify(seen),
    );
  });
}

async function deforming(page) {
  await check(
    "a body that deforms has the vertices of its frame, also where the frame before sent them",
    async () => {
      await view(page, "1");
      for (let i = 0; i < 6; i++) await page.key("-"); // from afar the ball's edge is its equator
      const background = await colour(page, "background");
      const organ = await colour(page, "organ");
      const edge = by => [fixture.BALL.centre[0] - fixture.BALL.radius * by, 0, 0];
      for (const i of [31, 30, 0, 1, 95, 94]) {
        await seek(page, i);
        const inside = await pixel(page, edge(fixture.swellAt(i) - 0.06));
        assert(likeness(inside, organ) > 0.95 && inside[2] < background[2] - 40, `frame ${i}, inside: ${inside}`);
        near(await pixel(page, edge(fixture.swellAt(i) + 0.06)), background, 3, `frame ${i}, outside:`);
      }
    },
  );
}

async function moving(page) {
  const middle = [400, 420];
  const changes = async (what, act, test) => {
    const was = await camera(page);
    await act();
    await page.settle();
    assert(test(was, await camera(page)), `${what}: ${JSON.stringify([was, await camera(page)])}`);
  };
  const turned = (a, b) => a.azimuth !== b.azimuth && a.distance === b.distance;
  const panned = (a, b) =>
    a.azimuth === b.azimuth && Math.hypot(...a.target.map((value, k) => value - b.target[k])) > 0.001;
  await check("the mouse rotates, pans and zooms", async () => {
    await changes("drag", () => page.drag(middle, [460, 440]), turned);
    await changes("right drag", () => page.drag(middle, [460, 440], { button: "right" }), panned);
    await changes("shift drag", () => page.drag(middle, [460, 440], { modifiers: 8 }), panned);
    await changes(
      "wheel",
      () => page.mouse("mouseWheel", middle, { deltaX: 0, deltaY: -200 }),
      (a, b) => b.distance < 0.9 * a.distance,
    );
  });
  await check("one finger rotates, two pan and pinch", async () => {
    await changes("a finger", () => page.touch([[middle], [[430, 420]], [[460, 430]]]), turned);
    await changes(
      "two fingers",
      () =>
        page.touch([
          [
            [350, 400],
            [450, 400],
          ],
          [
            [370, 420],
            [470, 420],
          ],
        ]),
      panned,
    );
    await changes(
      "a pinch",
      () =>
        page.touch([
          [
            [350, 400],
            [450, 400],
          ],
          [
            [300, 400],
            [500, 400],
          ],
        ]),
      (a, b) => b.distance < 0.7 * a.distance,
    );
  });
  await check("keys rotate, pan, zoom, and view along the axes", async () => {
    await changes("d", () => page.key("d"), turned);
    await changes("i", () => page.key("i"), panned);
    await changes(
      "+",
      () => page.key("+"),
      (a, b) => b.distance < a.distance,
    );
    await changes(
      "-",
      () => page.key("-"),
      (a, b) => b.distance > a.distance,
    );
    for (const [key, azimuth, elevation] of [
      ["1", 0, 0],
      ["2", Math.PI, 0],
      ["3", -Math.PI / 2, 0],
      ["4", Math.PI / 2, 0],
      ["5", 0, Math.PI / 2],
      ["6", 0, -Math.PI / 2],
    ]) {
      await page.key(key);
      await page.settle();
      const { azimuth: a, elevation: e } = await camera(page);
      near([Math.sin(a), Math.cos(a), e], [Math.sin(azimuth), Math.cos(azimuth), elevation], 1e-3, key);
    }
    await page.key("f");
  });
}

async function picking(page) {
  const { positions, corners, sources } = known.meshes[0];
  const triangle = 1234;
  const corner = k => [0, 1, 2].map(axis => positions[3 * corners[3 * triangle + k] + axis]);
  const middle = [0, 1, 2].map(k => (corner(0)[k] + corner(1)[k] + corner(2)[k]) / 3);
  await check("a click picks a triangle, and says its body, its source's number and its corners", async () => {
    await seek(page, 0);
    await view(page, middle[2] > 0 ? "5" : "6");
    const box = await page.ask(
      "(({ left, top }) => [left, top])(document.getElementById('picture').getBoundingClientRect())",
    );
    const at = await page.call(place => dynpoint.project(place), middle);
    await page.click(at.map((value, k) => value + box[k]));
    await page.settle();
    assert.deepStrictEqual(
      [await page.text("found-body"), await page.text("found-triangle")],
      ["ring (11)", String(sources[triangle])],
    );
    assert.strictEqual(
      await page.text("found-corners"),
      [0, 1, 2]
        .map(k =>
          corner(k)
            .map(value => (1000 * value).toFixed(2).padStart(9))
            .join(""),
        )
        .join("\n"),
    );
    const marked = await pixel(page, middle);
    assert(likeness(marked, await colour(page, "picked")) > 0.97, `${marked}`);
    await page.key("Escape");
    assert.strictEqual(await page.ask("document.getElementById('found').hidden"), true);
  });
  await check("Enter picks at the picture's centre", async () => {
    await page.key("Escape");
    const size = await page.ask(
      "[document.getElementById('picture').clientWidth, document.getElementById('picture').clientHeight]",
    );
    const { target } = await camera(page);
    const at = await page.call(place => dynpoint.project(place), target);
    near(
      at,
      size.map(value => value / 2),
      1,
    );
    await page.ask("document.getElementById('picture').focus(), document.activeElement.id");
    const wanted = middle[2] > 0 ? 1 : -1;
    const aside = await page.call(place => dynpoint.project(place), [-0.06, 0, 0.025 * wanted]);
    await page.drag([500, 400], [500 + size[0] / 2 - aside[0], 400 + size[1] / 2 - aside[1]], { button: "right" });
    await page.key("Enter");
    await page.settle();
    const { picked } = await page.state();
    assert(picked && picked.id === 11, JSON.stringify(picked));
    const there = [0, 1, 2].map(k =>
      [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[3 * picked.triangle + c] + k] / 3, 0),
    );
    near(there, [-0.06, 0, 0.025 * wanted], 0.006);
    await page.key("Escape");
    await page.key("f");
  });
}

async function speed(browser) {
  const { triangles, stream } = fixture.large(50332);
  const page = await browser.visit(write("large", stream));
  await until("the scene", async () => (await page.state()).number === 0);
  const rate = async moving => 1000 / (await page.ask(`dynpoint.timeDrawing(${moving ? 6 : 12}, ${moving})`));
  const size = await page.ask("(({ clientWidth, clientHeight }) => `${clientWidth} x ${clientHeight}`)(document.getElementById('picture'))");
  console.log(
    `note ${triangles} triangles at ${size}: ${(await rate(false)).toFixed(0)} pictures a second at rest, ${(await rate(true)).toFixed(0)} with all vertices moving`,
  );
  await browser.leave(page);
}

async function main() {
  const browser = launch(room);
  const page = await visitRecording(browser, write("ring", fixture.stream()), fixture.FRAMES);
  await drawing(page);
  await deforming(page);
  await moving(page);
  await picking(page);
  await check("the console is empty", () => assert.deepStrictEqual(page.said, []));
  await browser.leave(page);
  await speed(browser);
  await browser.close();
  finish();
}

main().catch(error => {
  console.log(`FAIL the page's test itself: ${error.stack}`);
  process.exit(1);
});
