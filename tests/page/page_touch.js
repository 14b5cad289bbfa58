// SPDX-License-Identifier: BSD-3-Clause
// node page_touch.js PAGE BUILD ROOM: the page in a headless Chromium, opened from its file: what a hand feels there is
// what the native library says, tick by tick and byte by byte, and what is drawn is that.
"use strict";
const os = require("os");
const path = require("path");
const { check, near, scripts, finish, assert } = require("../view/verdicts.js");
const { launch, until, sleep } = require("../view/chromium.js");
const sights = require("../view/page_sights.js");
const touch = require("./touch_sights.js");
const { snapshotReader } = scripts("checked_reading", "snapshot_reader");
const [, , file, build, room] = process.argv;

// Down into the body, along it, and out: m from the body's middle.
const SLIDE = [
  [0, 0.1, 0.01],
  [0, 0.02, 0.01],
  [-0.02, 0.0, 0.01],
  [-0.05, 0.0, 0.015],
  [-0.07, 0.01, 0.02],
  [-0.02, -0.01, 0.02],
  [0.03, -0.02, 0.01],
  [0.03, 0.05, 0.01],
  [0.03, 0.12, 0.01],
];

// Compares all ticks of a recording; returns what the native library said of each, read.
function same(recorded) {
  const native = touch.feelAgain(build, room, recorded);
  assert(
    native.length === recorded.snapshots.length && recorded.sizes.length * 56 === recorded.poses.length,
    "other lengths",
  );
  const mine = touch.cut(recorded.snapshots, recorded.sizes);
  const theirs = touch.cut(native, recorded.sizes);
  mine.forEach((block, i) => assert(block.equals(theirs[i]), `other bytes in tick ${i + 1}`));
  return theirs.map(block => snapshotReader.read(Uint8Array.from(block)));
}

const forceOf = ({ tools }) => Math.hypot(...tools[0].wrench.slice(0, 3));

async function checkOpening(browser) {
  const begun = Date.now();
  const page = await touch.visitPage(browser, file);
  const load = `${os.loadavg()[0].toFixed(1)} busy of ${os.cpus().length} processors`;
  console.log(`note from its file to moving pictures: ${Date.now() - begun} ms, on ${load}`);
  await check("opened from its file it runs, asks the network for nothing, and complains of nothing", async () => {
    assert.deepStrictEqual(
      page.asked.filter(url => !/^(file:\/\/[^?]*dynpoint\.html|blob:null\/)/.test(url)),
      [],
    );
    assert.strictEqual(page.asked.filter(url => url.startsWith("file:")).length, 1);
    assert.deepStrictEqual(page.said, []);
    assert.strictEqual((await page.state()).refused, 0);
  });
  await check("connections are refused by its policy", async () => {
    const got = await page.call(() =>
      fetch("data:,x").then(
        () => "connected",
        () => "refused",
      ),
    );
    assert.strictEqual(got, "refused");
    page.said.length = 0; // the browser tells the console of that
  });
  await check("where motion is reduced it is still until touched; the hint says what to do", async () => {
    const before = await touch.shown(page);
    await until("ticks", async () => (await touch.shown(page)).steps > before.steps + 300);
    near((await touch.shown(page)).tip, before.tip, 1e-12);
    assert(await page.ask("document.getElementById('touch-hint').checkVisibility()"));
  });
  return page;
}

// Presses the tool down by the mouse while a scene is recorded from its beginning.
async function drag(page) {
  const [x, y, width] = (await touch.shown(page)).picture;
  const from = [x + 0.5 * width, y + 150];
  await page.ask("globalThis.sceneBefore = viewer.own.scene, 0");
  const recording = touch.record(page, 4000, []);
  const begun = "viewer.own.scene !== sceneBefore && viewer.own.frame !== null";
  await until("a frame of the scene anew: before it a drag turns the picture", () => page.ask(begun));
  await page.mouse("mousePressed", from, { button: "left", buttons: 1, clickCount: 1 });
  for (let i = 1; i <= 7; i++) {
    await page.mouse("mouseMoved", [from[0] - 8 * i, from[1] + 36 * Math.min(i, 5)], { button: "left", buttons: 1 });
    await sleep(40);
  }
  const recorded = await recording;
  await page.mouse("mouseReleased", from, { button: "left", clickCount: 1 });
  return recorded;
}

async function checkMouse(page) {
  await check(
    "a drag presses the tool into the liver: every tick's snapshot has the native library's bytes",
    async () => {
      let felt = [];
      // On a busy machine the recording may be over before the drag is.
      for (let tries = 0; tries < 5 && felt.length <= 300; tries++) {
        const recorded = await drag(page);
        felt = same(recorded).filter(
          tick => forceOf(tick) > 0.3 && tick.segments[0].contact === 3 && tick.contacts.length > 0,
        );
        checkFrames(recorded);
      }
      assert(felt.length > 300, `it was felt in ${felt.length} ticks`);
    },
  );
  await check("the hint goes away with the first touch", async () =>
    assert(!(await page.ask("document.getElementById('touch-hint').checkVisibility()"))),
  );
}

// What the page took for drawing is of those bytes.
function checkFrames({ frames, snapshots, sizes }) {
  const blocks = touch.cut(snapshots, sizes);
  const drawn = frames
    .map(block => ({ block, steps: Number(block.readBigUInt64LE(24)) }))
    .filter(({ steps }) => steps <= blocks.length);
  assert(drawn.length > 0, "no frame");
  for (const { block, steps } of drawn)
    assert(block.equals(blocks[steps - 1]), `the frame of tick ${steps} is another`);
}

async function checkPicture(page) {
  await check(
    "the picture has proxy and device where the snapshot has them, and the arrow points as the force does",
    async () => {
      await page.key(" "); // hold the picture
      await until("a held picture", async () => !(await page.state()).playing);
      await page.settle();
      const { segment, wrench, arrow } = await page.call(() => ({
        segment: viewer.own.frame.snapshot.segments[0],
        wrench: viewer.own.frame.snapshot.tools[0].wrench,
        arrow: dynpoint.arrows()[0],
      }));
      const force = wrench.slice(0, 3);
      const by = Math.hypot(...force);
      assert(by > 0.3, `${by} N`);
      near(arrow.newtons, by, 1e-12);
      const way = arrow.to.map((value, k) => value - arrow.from[k]);
      near(
        way.map(value => value / Math.hypot(...way)),
        force.map(value => value / by),
        1e-9,
      );
      const colour = await sights.colour(page, "proxy");
      const seen = [];
      for (const s of [0.7, 0.8, 0.9]) {
        const place = sights.on([segment.proxyA, segment.proxyB], s);
        const got = await sights.pixel(page, place);
        seen.push(sights.likeness(got, colour));
      }
      assert(Math.max(...seen) > 0.97, `likeness ${seen}`);
    },
  );
  await page.key(" ");
}

async function checkLaws(page) {
  for (const law of touch.LAWS)
    await check(`the law ${law}: chosen in the panel, the native library's bytes`, async () => {
      await touch.chooseLaw(page, law);
      const recorded = await touch.record(page, 1200, SLIDE);
      assert.strictEqual(touch.LAWS[recorded.law], law);
      const ticks = same(recorded);
      assert(ticks.filter(tick => forceOf(tick) > 0.3).length > 200, "it was not felt");
      checkFrames(recorded);
    });
  await check("the stiffness of the slider is the tool's: twice of it, and the same bytes", async () => {
    await touch.chooseLaw(page, "proxy");
    await page.call(() => {
      const slider = document.getElementById("touch-stiffness");
      slider.value = "1000";
      slider.dispatchEvent(new Event("input"));
    });
    const recorded = await touch.record(page, 600, SLIDE);
    assert.strictEqual(recorded.stiffness, 1000);
    same(recorded);
  });
}

async function checkSoft(page, scene) {
  await check(
    `${scene}: it gives way, springs stepped in each tick, and the native library's bytes with all vertices`,
    async () => {
      await touch.choose(page, scene);
      const down = scene === "membrane" ? 0.02 : 0;
      const slide = SLIDE.slice(0, -2).map(([x, y, z]) => [x, y - down, z]); // it ends in contact
      const recorded = await touch.record(page, 700, slide);
      const last = same(recorded).at(-1);
      assert(last.vertices.length > 0, "no vertices");
      const moved = () => page.call(() => {
        const [body] = viewer.own.view.bodies.values();
        return body.positions.reduce((most, value, i) => Math.max(most, Math.abs(value - body.mesh.positions[i])), 0);
      });
      await until("a drawn surface that has moved by more than a millimetre", async () => (await moved()) > 1e-3);
    },
  );
}

async function checkReport(page) {
  await check("ticks a second and their time are those of the world, and what is not held is said", async () => {
    await touch.choose(page, "liver");
    const told = page.ask(`new Promise(done => {
      const all = [];
      new MutationObserver(() => {
        all.push({ ...dynpoint.panel().report, at: performance.now() });
        if (all.length === 24) done(all);
      }).observe(document.getElementById("touch-rate"), { childList: true, subtree: true, characterData: true });
    })`);
    const all = (await told).slice(4);
    const [from, to] = [all[0], all.at(-1)];
    const counted = (1000 * (to.ticks - from.ticks)) / (to.at - from.at);
    const { report, text } = await page.ask(
      "({ report: dynpoint.panel().report, text: document.getElementById('touch-rate').textContent })",
    );
    near(all.reduce((sum, { rate }) => sum + rate, 0) / all.length / counted, 1, 0.15, "rate reported and counted:");
    assert(report.micros > 0.5 && report.micros < 1e4, `${report.micros} us`);
    assert.strictEqual(/does not hold/.test(text), report.rate < 990, text);
    console.log(
      `note the liver in the page: ${report.rate.toFixed(0)} ticks a second, ${report.micros.toFixed(1)} us each`,
    );
  });
}

async function checkHidden(page) {
  await check("while the page is hidden no tick is taken, and after it no time is made up for", async () => {
    const hide = hidden =>
      page.call(hidden => {
        Object.defineProperty(document, "hidden", { value: hidden, configurable: true });
        document.dispatchEvent(new Event("visibilitychange"));
      }, hidden);
    const steps = async () => (await touch.shown(page)).steps;
    // The worker takes messages in turn: when it has refused a scene that is none, it has heard the one before, too.
    const isHeard = () =>
      page.call(() => {
        const link = viewer.own.connection;
        const refused = new Promise(done => link.hear("refused", () => done(true)));
        link.post({ kind: "scene" });
        return refused;
      });
    await hide(true);
    assert(await isHeard());
    await page.settle();
    const before = await steps();
    await sleep(700);
    assert.strictEqual(await steps(), before);
    const { lost } = await page.ask("dynpoint.panel().report");
    await hide(false);
    await until("ticks again", async () => (await steps()) > before + 20);
    const after = await page.ask("dynpoint.panel().report");
    assert(after.lost - lost < 700, `${after.lost - lost} ticks were counted as lost`);
  });
}

(async () => {
  const browser = launch(path.resolve(room));
  try {
    const page = await checkOpening(browser);
    await checkMouse(page);
    await checkPicture(page);
    await checkLaws(page);
    await checkSoft(page, "soft");
    await checkSoft(page, "membrane");
    await checkReport(page);
    await checkHidden(page);
    await check("the console is empty", () => assert.deepStrictEqual(page.said, []));
  } finally {
    await browser.close();
  }
  finish();
})();
