// SPDX-License-Identifier: BSD-3-Clause
// node page_colours.js PAGE.html ROOM: colours that say something: those who do not tell red from green tell them apart, a contact
// leaves its mark on the body, and how far a surface has moved is shown on request.
"use strict";
const fs = require("fs");
const path = require("path");
const { launch, until } = require("./chromium.js");
const { check, near, finish, assert, scripts, tools } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, pixel, view } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const { scale, instruments } = scripts("scale", "rays", "instruments");
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);

// What an eye without one kind of cones sees, in linear red, green and blue: Machado, Oliveira and Fernandes (2009), whole loss.
const EYES = {
  usual: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};
const linear = part => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);

// CIE L*a*b* of [red, green, blue], linear.
function lab([r, g, b]) {
  const [x, y, z] = [
    (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505,
    0.2126 * r + 0.7152 * g + 0.0722 * b,
    (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089,
  ].map(value => (value > 0.008856 ? Math.cbrt(value) : 7.787 * value + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

function seenBy(eye, rgb) {
  const m = EYES[eye];
  return lab([0, 3, 6].map(row => Math.max(0, m[row] * rgb[0] + m[row + 1] * rgb[1] + m[row + 2] * rgb[2])));
}

// The page's colours of a theme, by name.
function palette(theme) {
  const css = fs.readFileSync(path.join(tools, "page.css"), "utf8");
  const block = css.split(theme === "light" ? ":root {" : ':root[data-theme="dark"] {')[1].split("}")[0];
  return Object.fromEntries(
    [...block.matchAll(/--([\w-]+): #([0-9a-f]{6})/g)].map(([, name, hex]) => [
      name,
      [0, 2, 4].map(at => linear(parseInt(hex.slice(at, at + 2), 16) / 255)),
    ]),
  );
}

async function eyes() {
  for (const theme of ["light", "dark"])
    await check(`${theme}: device, proxy, force, strip, picked and organ differ for every kind of eye`, () => {
      const colours = palette(theme);
      const names = ["device", "proxy", "force", "strip", "picked", "organ"];
      const close = [];
      for (const eye in EYES)
        names.forEach((one, i) =>
          names.slice(i + 1).forEach(other => {
            const [a, b] = [one, other].map(name => seenBy(eye, colours[name]));
            const apart = Math.hypot(...a.map((value, k) => value - b[k]));
            if (apart < 15) close.push(`${one} and ${other}: ${apart.toFixed(1)} (${eye})`);
          }),
        );
      assert.deepStrictEqual(close, []);
    });
  for (const theme of ["light", "dark"])
    await check(`${theme}: no part of an instrument has the colour of device or proxy`, () => {
      const colours = palette(theme);
      const parts = new Set(Object.values(instruments.LOOKS).flatMap(all => all.map(({ of }) => of)));
      assert(parts.size > 3);
      for (const part of parts)
        for (const other of ["device", "proxy"])
          for (const eye in EYES) {
            const [a, b] = [part, other].map(name => seenBy(eye, colours[name]));
            const apart = Math.hypot(...a.map((value, k) => value - b[k]));
            assert(apart >= 15, `${part} and ${other}: ${apart.toFixed(1)} (${eye})`);
          }
    });
  await check("colours of depth grow lighter for every kind of eye", () => {
    for (const eye in EYES) {
      const lights = [0, 0.25, 0.5, 0.75, 1].map(part => seenBy(eye, scale.colour(part).map(value => linear(value / 255)))[0]);
      assert(lights.every((value, i) => i === 0 || value > lights[i - 1] + 8), `${eye}: ${lights}`);
    }
  });
}

async function marks(page) {
  await check("round a contact the body has the colour of its depth, and beyond that its own", async () => {
    await view(page, "5");
    const { middle, tube } = fixture.RING;
    const { device } = fixture.placesAt(150);
    const y = device[0][1] + 0.4 * (device[1][1] - device[0][1]); // in the middle of the deeper contact
    const at = out => [middle + out, y, Math.sqrt(Math.max(0, tube ** 2 - (Math.hypot(middle + out, y) - middle) ** 2))];
    const read = async (frame, out) => {
      await seek(page, frame);
      return pixel(page, at(out));
    };
    const half = fixture.TOOL.radius + Math.sqrt(2 * fixture.TOOL.radius * fixture.DEEPEST);
    const { depth } = await page.ask("dynpoint.scales()");
    const near = await read(150, -0.0075); // beside the tool, which is 4 mm thick
    const wanted = scale.colour(fixture.DEEPEST / depth);
    const apart = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
    const free = await read(20, -0.0075);
    assert(apart(near, wanted) < 0.5 * apart(free, wanted), `${near} is not ${wanted}; free ${free}`);
    const far = [await read(150, -1.3 * half), await read(20, -1.3 * half)];
    assert(far[0][0] > far[0][2], `beyond it: ${far[0]}`);
  });
}

// At frame 150, in the middle of the deeper contact, beside the tool.
async function marksOf(page, change) {
  await seek(page, 150);
  await view(page, "5");
  const { middle, tube } = fixture.RING;
  const [[, from], [, to]] = fixture.placesAt(150).device;
  const y = from + 0.4 * (to - from);
  const x = middle - 0.0075;
  await page.ask(`${change}, viewer.own.view.draw(true), 0`);
  const seen = await pixel(page, [x, y, Math.sqrt(tube ** 2 - (Math.hypot(x, y) - middle) ** 2)]);
  await page.ask("delete viewer.own.view.patches, viewer.own.view.dirty = true, 0");
  return seen;
}

async function places(page) {
  const apart = (a, b) => Math.hypot(...a.map((value, k) => value - b[k]));
  const changed = change =>
    `viewer.own.view.patches = function () {
      return this.constructor.prototype.patches.call(this).map(patch => ({ ...patch, ${change} }));
    }`;
  await check("a contact marks the body that it touches, on the side that it touches, and nothing else", async () => {
    const marked = await marksOf(page, "0");
    const bare = await marksOf(page, "viewer.own.view.patches = () => []");
    assert(apart(marked, bare) > 40, `${marked}, without ${bare}`);
    const lower = end => `${end}: patch.${end}.map((value, k) => value - 0.02 * (k === 2))`; // 15 mm below the surface
    for (const change of ["number: 1", "normal: patch.normal.map(value => -value)", `${lower("a")}, ${lower("b")}`])
      assert(apart(await marksOf(page, changed(change)), bare) < 6, `${change}: marked`);
  });
  await check("a contact's gap that is no number, or endless, leaves scales and depths finite", async () => {
    const found = await page.ask(`[NaN, -Infinity].map(gap => {
      const { snapshot } = viewer.own.frame;
      return depths.ofContact(snapshot, { ...snapshot.contacts[0], gap });
    })`);
    assert(found.every(value => Number.isFinite(value)), found.join());
    const most = await page.ask(`(body => {
      const endless = body.mesh.positions.map((value, i) => (i === 4 ? Infinity : value));
      return body.mostMovedOf(endless);
    })(viewer.own.view.bodies.get(12))`);
    assert.strictEqual(most, 0);
  });
}

async function deformation(page) {
  await check("deformation has one scale for all frames, also before they are shown, and no marks", async () => {
    await seek(page, 4);
    await page.key("o");
    await page.settle();
    near((await page.ask("dynpoint.scales()")).moved, 0.02, 1e-9, "0.4 of 30 mm, rounded up:");
    const bare = await marksOf(page, "viewer.own.view.patches = () => []");
    near(await marksOf(page, "0"), bare, 1);
    await page.key("o");
  });
  await check("colours say how far a surface has moved, on request, and go again", async () => {
    await seek(page, 31);
    await view(page, "1");
    const swell = fixture.swellAt(31);
    const front = [fixture.BALL.centre[0], -fixture.BALL.radius * swell, 0]; // of the ball, towards the eye
    const before = await pixel(page, front);
    assert(await page.ask("document.getElementById('deformation').checkVisibility() && !document.getElementById('moved').checkVisibility()"));
    await page.key("o");
    await page.settle();
    const moved = fixture.BALL.radius * (swell - 1);
    const { moved: most } = await page.ask("dynpoint.scales()");
    assert(most >= moved && most <= 10 * moved, `scale ${most}, moved ${moved}`);
    const wanted = scale.colour(moved / most);
    const got = await pixel(page, front);
    near(got.map((value, k) => value - 0.25 * before[k]), wanted.map(value => 0.75 * value), 8);
    await until("its scale", async () => /moved by 0\d+(\.\d+)? mm/.test(await page.text("moved")));
    assert.strictEqual(await page.ask("document.getElementById('deformation').getAttribute('aria-pressed')"), "true");
    await page.ask("document.getElementById('deformation').click()");
    await page.settle();
    near(await pixel(page, front), before, 1);
  });
}

(async () => {
  await eyes();
  const browser = launch(room);
  const page = await visitRecording(browser, write("ring", fixture.stream()), fixture.FRAMES);
  await marks(page);
  await places(page);
  await deformation(page);
  assert.deepStrictEqual(page.said, []);
  await browser.close();
  finish();
})().catch(error => {
  console.log(`FAIL the colours' test itself: ${error.stack}`);
  process.exit(1);
});
