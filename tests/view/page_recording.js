// SPDX-License-Identifier: BSD-3-Clause
// node page_recording.js PAGE.html ROOM: the page that plays by itself, from its file in a headless Chromium. What is
// drawn is asked at places of the scene whose colour is known.
"use strict";
const fs = require("fs"), path = require("path");
const { launch, until, sleep } = require("./chromium.js"), { check, near, random, alone, damage, finish, assert, scripts } = require("./verdicts.js");
const fixture = require("./stream_fixture.js"), known = fixture.recording();
const [, , template, room] = process.argv, { scale } = scripts("scale");
const [before, after] = fs.readFileSync(template, "utf8").split("@DATA@");

function write(name, stream) {
  const file = path.join(room, `${name}.html`);
  fs.writeFileSync(file, before + stream.toString("base64") + after);
  return `file://${file}`;
}

const seek = async (page, index) => {
  await page.call(index => {
    const slider = document.getElementById("slider");
    slider.value = String(index);
    slider.dispatchEvent(new Event("input"));
  }, index);
  await until(`frame ${index}`, async () => (await page.state()).index === index && (await page.state()).number === index);
  await sleep(50);
};
const colour = (page, name) => page.call(name => {
  const { r, g, b } = new THREE.Color(getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return [r, g, b].map(part => Math.round(255 * (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055)));
}, name);
const pixel = (page, place) => page.call(place => dynpoint.pixel(place), place);
// How well the hue of a shaded surface is that of a colour: 1 if they are the same.
const likeness = (a, b) => {
  const [u, v] = [a, b].map(rgb => rgb.map(value => (value / 255) ** 2.2 + 1e-3)), by = w => Math.hypot(...w);
  return (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / (by(u) * by(v));
};
const on = (ends, s) => ends[0].map((value, k) => value + s * (ends[1][k] - value));
// Where a ray from above first meets the proxy.
const top = ([x, y, z]) => [x, y, z + fixture.TOOL.radius];
const camera = page => page.ask("dynpoint.camera()");

async function view(page, key) {
  await page.key(key);
  await page.key("f");
  await sleep(60);
}

async function drawing(page) {
  const { device, proxy } = fixture.placesAt(150), background = await colour(page, "background"), organ = await colour(page, "organ");
  await seek(page, 150);
  await view(page, "5");
  await check("the background is the background, and the organ looks like its colour", async () => {
    near(await pixel(page, [0, 0, 0]), background, 2, "in the ring's hole:");
    for (const place of [[-0.06, 0, 0.025], [0, 0.06, 0.025], [0, -0.06, 0.025]]) {
      const got = await pixel(page, place);
      assert(likeness(got, organ) > 0.985, `${got} at ${place}`);
    }
  });
  await check("the proxy lies over the organ in its colour, and the device's tool shines through", async () => {
    const solid = await colour(page, "proxy"), got = await pixel(page, top(on(proxy, 0.85)));
    assert(likeness(got, solid) > 0.97 && likeness(got, organ) < 0.97, `${got}, not like ${solid}`);
    await view(page, "4"); // from the right, where the device's tool is below the proxy and partly inside of the ring
    const side = ([x, y, z]) => [x + fixture.TOOL.radius, y, z], blue = await pixel(page, side(on(device, 0.98)));
    const plain = await pixel(page, side([0.06, 0.075, 0.021])), wanted = await colour(page, "device");
    near(plain, background, 2, "beside it:");
    assert(blue.every((value, k) => wanted[k] > background[k] + 8 ? value > plain[k] : wanted[k] < background[k] - 8 ? value < plain[k] : true) &&
      blue[0] < plain[0] - 30, `${blue} on ${plain}`);
    await view(page, "5");
  });
  await check("a contact is a band on the proxy, in the colour of its depth, as long as its stretch", async () => {
    const solid = await pixel(page, top(on(proxy, 0.25))), { depth } = await page.ask("dynpoint.scales()");
    near(depth, 0.01, 1e-9, "the scale of depth:");
    for (const [s, part] of [[0.35, 1], [0.42, 1], [0.65, 0.25]])
      near(await pixel(page, top(on(proxy, s))), scale.colour(part * fixture.DEEPEST / depth), 3, `at ${s}:`);
    near(await pixel(page, top(on(proxy, 0.75))), solid, 12, "beyond its end:");
  });
  await check("the strip's triangles are marked, their neighbours are not", async () => {
    const { positions, corners } = known.meshes[0], strip = await colour(page, "strip");
    const middle = i => [0, 1, 2].map(k => [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[3 * i + c] + k] / 3, 0));
    const mirrored = ([x, y, z]) => [-x, y, z];
    const places = known.strip.map(middle).filter(([x, y]) => x > 0.071 && Math.abs(y) > 0.004).slice(0, 5);
    for (const place of places) {
      const marked = await pixel(page, place), plain = await pixel(page, mirrored(place));
      assert(likeness(marked, strip) > likeness(plain, strip) + 0.05, `${marked}, ${plain}`);
    }
    assert(places.length >= 3);
  });
  await check("the force's arrow begins at the proxy, points where the force does, and is as long as it is strong", async () => {
    await view(page, "1");
    const force = await colour(page, "force"), from = on(proxy, 0.5), { radius } = await page.ask("dynpoint.scales()");
    const full = fixture.STIFFNESS * fixture.DEEPEST / 10, length = 0.55 * radius * full, at = part => from.map((value, k) => value + part * length * fixture.DIRECTION[k]);
    for (const part of [0.1, 0.4, 0.6]) near(await pixel(page, at(part)), force, 2, `at ${part}:`);
    for (const part of [-0.5, 1.1]) assert(likeness(await pixel(page, at(part)), force) < 0.97, `at ${part}`);
    await seek(page, 80);
    const weaker = fixture.wrenchAt(80 / 60), [arrow] = await page.ask("dynpoint.arrows()");
    near(Math.hypot(...arrow.to.map((value, k) => value - arrow.from[k])), 0.55 * radius * Math.hypot(...weaker.slice(0, 3)) / 10, 1e-9);
    await seek(page, 20);
    assert.deepStrictEqual(await page.ask("dynpoint.arrows()"), [], "a tool that is free has no arrow");
  });
  await check("the nearest pair is a line from the axis to the mesh", async () => {
    await seek(page, 20);
    const { device: free } = fixture.placesAt(20), p = on(free, 0.5), q = [0.06, 0, 0.025];
    for (const part of [0, 0.3, 0.7, 1]) near(await pixel(page, p.map((value, k) => value + part * (q[k] - value))), await colour(page, "pair"), 2, `at ${part}:`);
  });
  await check("the workspace is a wire box", async () => {
    await view(page, "5");
    const at = await page.ask("dynpoint.project([-0.19, 0, 0.09])"), seen = [];
    for (let by = -2; by <= 2; by++) seen.push(await page.call(at => dynpoint.pixelAt(at), [at[0] + by, at[1]]));
    assert(seen.some(rgb => Math.abs(rgb[0] - background[0]) > 30), JSON.stringify(seen));
  });
}

async function deforming(page) {
  await check("a body that deforms has the vertices of its frame, also where the frame before sent them", async () => {
    await view(page, "1");
    const background = await colour(page, "background"), organ = await colour(page, "organ");
    const edge = by => [fixture.BALL.centre[0] - fixture.BALL.radius * by, 0, 0];
    for (const i of [31, 30, 0, 1, 95, 94]) {
      await seek(page, i);
      assert(likeness(await pixel(page, edge(fixture.swellAt(i) - 0.06)), organ) > 0.95, `frame ${i}, inside`);
      near(await pixel(page, edge(fixture.swellAt(i) + 0.06)), background, 3, `frame ${i}, outside:`);
    }
  });
}

async function playing(page) {
  await check("keys step, jump and play; the readouts are those of the frame", async () => {
    await seek(page, 150);
    assert.deepStrictEqual([await page.readout("tick"), await page.readout("force"), await page.readout("gap"), await page.readout("contact")], ["2,500", "4.00 N", "-8.000 mm", "penetrating"]);
    const index = async () => { await sleep(60); return (await page.state()).index; };
    await page.ask("document.activeElement.blur()");
    const seen = [];
    for (const key of ["ArrowRight", "ArrowLeft", "ArrowLeft", "Home", "End"]) {
      await page.key(key);
      seen.push(await index());
    }
    assert.deepStrictEqual(seen, [151, 150, 149, 0, 239]);
    await page.key("Home");
    await page.key(" ");
    await sleep(700);
    await page.key(" ");
    const { time, playing } = await page.state();
    assert(!playing && time > 0.4 && time < 1.2, `${time} s after 0.7 s`);
    await page.key("[");
    await page.key("[");
    assert.strictEqual((await page.state()).speed, 0.25);
    await page.key("]");
    await page.key("]");
  });
  await check("a reason of no force is said; a frame at rest costs no drawing", async () => {
    await seek(page, 20);
    assert.match(await page.readout("reason"), /^free/);
    const { drawn } = await page.state();
    await sleep(400);
    assert.strictEqual((await page.state()).drawn, drawn);
  });
  await check("the plot shows the peak of one tick where it was, and its neighbours below it", async () => {
    await seek(page, 0);
    const { from, to, high } = await page.ask("dynpoint.plotScale('force')");
    near([from, to, high], [0, 3.999, 10], 1e-9);
    const [x, y] = await page.ask(`dynpoint.plotPlace("force", ${fixture.PEAK.time}, 7)`);
    const opaque = async (dx, dy = 0) => {
      const [r, , b, alpha] = await page.call(at => dynpoint.plotPixel(at), [x + dx, y + dy]);
      return alpha > 60 && r > b + 30;
    };
    assert((await opaque(0)) || (await opaque(-1)) || (await opaque(1)), "the peak is not drawn");
    assert(!(await opaque(-5)) && !(await opaque(5)), "beside the peak something is drawn");
  });
  await check("a drag in the plots moves the frame", async () => {
    const box = await page.ask("(({ left, top }) => [left, top])(document.getElementById('plots').getBoundingClientRect())");
    const at = await page.ask("dynpoint.plotPlace('force', 2.0, 5)");
    await page.click(at.map((value, k) => value + box[k]));
    await sleep(80);
    near((await page.state()).time, 2, 0.03);
  });
}

async function moving(page) {
  const middle = [400, 420];
  const changes = async (what, act, test) => {
    const was = await camera(page);
    await act();
    await sleep(80);
    assert(test(was, await camera(page)), `${what}: ${JSON.stringify([was, await camera(page)])}`);
  };
  const turned = (a, b) => a.azimuth !== b.azimuth && a.distance === b.distance;
  const panned = (a, b) => a.azimuth === b.azimuth && Math.hypot(...a.target.map((value, k) => value - b.target[k])) > 0.001;
  await check("the mouse rotates, pans and zooms", async () => {
    await changes("drag", () => page.drag(middle, [460, 440]), turned);
    await changes("right drag", () => page.drag(middle, [460, 440], { button: "right" }), panned);
    await changes("shift drag", () => page.drag(middle, [460, 440], { modifiers: 8 }), panned);
    await changes("wheel", () => page.mouse("mouseWheel", middle, { deltaX: 0, deltaY: -200 }), (a, b) => b.distance < 0.9 * a.distance);
  });
  await check("one finger rotates, two pan and pinch", async () => {
    await changes("a finger", () => page.touch([[middle], [[430, 420]], [[460, 430]]]), turned);
    await changes("two fingers", () => page.touch([[[350, 400], [450, 400]], [[370, 420], [470, 420]]]), panned);
    await changes("a pinch", () => page.touch([[[350, 400], [450, 400]], [[300, 400], [500, 400]]]), (a, b) => b.distance < 0.7 * a.distance);
  });
  await check("keys rotate, pan, zoom, and view along the axes", async () => {
    await changes("d", () => page.key("d"), turned);
    await changes("i", () => page.key("i"), panned);
    await changes("+", () => page.key("+"), (a, b) => b.distance < a.distance);
    await changes("-", () => page.key("-"), (a, b) => b.distance > a.distance);
    for (const [key, azimuth, elevation] of [["1", 0, 0], ["2", Math.PI, 0], ["3", -Math.PI / 2, 0], ["4", Math.PI / 2, 0], ["5", 0, Math.PI / 2], ["6", 0, -Math.PI / 2]]) {
      await page.key(key);
      await sleep(50);
      const { azimuth: a, elevation: e } = await camera(page);
      near([Math.sin(a), Math.cos(a), e], [Math.sin(azimuth), Math.cos(azimuth), elevation], 1e-3, key);
    }
    await page.key("f");
  });
}

async function picking(page) {
  const { positions, corners, sources } = known.meshes[0], triangle = 1234;
  const corner = k => [0, 1, 2].map(axis => positions[3 * corners[3 * triangle + k] + axis]), middle = [0, 1, 2].map(k => (corner(0)[k] + corner(1)[k] + corner(2)[k]) / 3);
  await check("a click picks a triangle, and says its body, its source's number and its corners", async () => {
    await seek(page, 0);
    await view(page, middle[2] > 0 ? "5" : "6");
    const box = await page.ask("(({ left, top }) => [left, top])(document.getElementById('picture').getBoundingClientRect())");
    const at = await page.call(place => dynpoint.project(place), middle);
    await page.click(at.map((value, k) => value + box[k]));
    await sleep(80);
    assert.deepStrictEqual([await page.text("found-body"), await page.text("found-triangle")], ["ring (11)", String(sources[triangle])]);
    assert.strictEqual(await page.text("found-corners"), [0, 1, 2].map(k => corner(k).map(value => (1000 * value).toFixed(2).padStart(9)).join("")).join("\n"));
    const marked = await pixel(page, middle);
    assert(likeness(marked, await colour(page, "picked")) > 0.97, `${marked}`);
    await page.key("Escape");
    assert.strictEqual(await page.ask("document.getElementById('found').hidden"), true);
  });
  await check("Enter picks at the picture's centre", async () => {
    await page.key("Escape");
    const size = await page.ask("[document.getElementById('picture').clientWidth, document.getElementById('picture').clientHeight]");
    const { target } = await camera(page), at = await page.call(place => dynpoint.project(place), target);
    near(at, size.map(value => value / 2), 1);
    await page.ask("document.getElementById('picture').focus(), document.activeElement.id");
    const wanted = middle[2] > 0 ? 1 : -1, aside = await page.call(place => dynpoint.project(place), [-0.06, 0, 0.025 * wanted]);
    await page.drag([500, 400], [500 + size[0] / 2 - aside[0], 400 + size[1] / 2 - aside[1]], { button: "right" });
    await page.key("Enter");
    await sleep(80);
    const { picked } = await page.state();
    assert(picked && picked.id === 11, JSON.stringify(picked));
    const there = [0, 1, 2].map(k => [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[3 * picked.triangle + c] + k] / 3, 0));
    near(there, [-0.06, 0, 0.025 * wanted], 0.006);
    await page.key("Escape");
    await page.key("f");
  });
}

async function looks(page) {
  await check("the PNG has the picture's size, and is saved under the scene's name", async () => {
    const { width, height, wanted } = await page.ask("dynpoint.picture()");
    assert.deepStrictEqual([[width, height], width > 500 && height > 500], [wanted, true]);
    await page.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: room, eventsEnabled: false });
    await page.key("p");
    const file = await until("a file", () => fs.readdirSync(room).find(name => /^A-ring-and-a-ball-\d+\.png$/.test(name)));
    const bytes = await until("its bytes", () => { const all = fs.readFileSync(path.join(room, file)); return all.length > 100 && all; });
    assert.deepStrictEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], wanted);
  });
  await check("dark and light: as the system has it, and by the switch", async () => {
    const dark = async () => [(await page.state()).theme, (await page.ask("dynpoint.pixelAt([3, 300])"))[0] < 60];
    assert.deepStrictEqual(await dark(), ["light", false]);
    await page.media({ "prefers-color-scheme": "dark", "prefers-reduced-motion": "reduce" });
    await until("dark", async () => (await dark())[0] === "dark");
    assert.deepStrictEqual(await dark(), ["dark", true]);
    await page.key("t");
    await page.key("t");
    assert.deepStrictEqual(await dark(), ["light", false]);
    await page.key("t");
    await page.media({ "prefers-color-scheme": "light", "prefers-reduced-motion": "reduce" });
    await until("light", async () => (await dark())[0] === "light");
  });
  await check("a view glides, unless less motion is wanted", async () => {
    await page.key("1");
    await page.key("4");
    assert.strictEqual((await camera(page)).gliding, false);
    await page.media({ "prefers-color-scheme": "light", "prefers-reduced-motion": "no-preference" });
    await page.key("1");
    assert.strictEqual((await camera(page)).gliding, true);
    await until("its end", async () => !(await camera(page)).gliding);
    near((await camera(page)).elevation, 0, 1e-9);
    await page.media({ "prefers-color-scheme": "light", "prefers-reduced-motion": "reduce" });
  });
  await check("text stands out from what it is on, in both themes", async () => {
    const contrasts = () => page.ask(`(() => {
      const style = getComputedStyle(document.documentElement), light = name => {
        const { r, g, b } = new THREE.Color(style.getPropertyValue("--" + name).trim());
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const ratio = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
      return [["text", "card"], ["faint", "card"], ["faint", "background"], ["accent", "card"], ["plot-force", "card"], ["warn", "warn-back"],
        ["text", "button"], ["faint", "button"]].map(([a, b]) => ratio(a, b));
    })()`);
    assert((await contrasts()).every(ratio => ratio >= 4.5), `light: ${await contrasts()}`);
    await page.key("t");
    assert((await contrasts()).every(ratio => ratio >= 4.5), `dark: ${await contrasts()}`);
    await page.key("t");
    await page.key("t");
  });
  await check("the help panel opens and closes by keys, and holds three's licence", async () => {
    await page.key("?");
    assert.strictEqual(await page.ask("document.getElementById('panel').open"), true);
    assert.match(await page.text("panel"), /three\.js authors[^]*WITHOUT WARRANTY OF ANY KIND/);
    await page.ask("document.getElementById('panel').close()");
  });
  await check("all that can be pressed has a name, and a focus that is seen; the live region speaks of few things", async () => {
    const nameless = await page.ask(`[...document.querySelectorAll("button, select, input, canvas")].filter(one =>
      !(one.getAttribute("aria-label") || one.textContent.trim() || one.closest("label"))).map(one => one.outerHTML)`);
    assert.deepStrictEqual(nameless, []);
    await page.ask("document.getElementById('help').focus({ focusVisible: true })");
    assert.match(await page.ask("getComputedStyle(document.activeElement).outlineStyle + getComputedStyle(document.activeElement).outlineWidth"), /^solid2px/);
    await page.ask("window.said = 0, new MutationObserver(all => { said += all.length; }).observe(document.getElementById('status'), { childList: true }), 0");
    await page.ask("document.activeElement.blur()");
    await page.key("Home");
    await page.key(" ");
    await sleep(800);
    await page.key(" ");
    assert(await page.ask("said") <= 2);
  });
  await check("on a narrow screen all is there, one below the other, and nothing is wider than it", async () => {
    await page.size(390, 844, true);
    await until("narrow", async () => (await page.ask("document.getElementById('picture').clientWidth")) <= 390);
    await sleep(100);
    const [wide, picture, plots] = await page.ask("[document.documentElement.scrollWidth, document.getElementById('picture').clientHeight, document.getElementById('plots').clientWidth]");
    assert(wide <= 390 && picture >= 260 && plots > 300, [wide, picture, plots].join());
    await page.size(1280, 800);
    await sleep(100);
  });
}

async function otherPages(browser) {
  await check("names with markup stay text", async () => {
    const evil = "<img src=x onerror=document.title='gone'><script>document.title='gone'</script>&amp;";
    const bodies = [11, 12].map((id, mesh) => ({ id, mesh, pose: [0, 0, 0, 1, 0, 0, 0], name: evil }));
    const meshes = known.meshes.map(mesh => ({ ...mesh, name: evil }));
    const page = await browser.visit(write("markup", fixture.streamOf([fixture.sceneMessage(meshes, { title: evil, program: evil, mode: "mesh", bodies,
      device: { name: evil, simulated: true, rate: 1, workspace: null } })])));
    await until("the scene", async () => (await page.state()).mode === "mesh");
    await sleep(200);
    await page.key("Enter");
    assert.deepStrictEqual([await page.text("title"), await page.ask("document.querySelectorAll('img').length"), await page.text("device")], [evil, 0, `${evil}, simulated`]);
    assert.match(await page.text("facts"), /onerror.*4,816 triangles/);
    assert((await page.ask("document.title")).startsWith(evil));
    assert.deepStrictEqual(page.said, []);
    await browser.leave(page);
  });
  await check("a mesh without frames has neither plots nor numbers; with y up, the top is there", async () => {
    const page = await browser.visit(write("upright", fixture.streamOf([fixture.sceneMessage(known.meshes, { mode: "mesh", up: "y", device: null })])));
    await until("the scene", async () => (await page.state()).mode === "mesh");
    const shown = await page.ask("[...document.querySelectorAll('.of-frames')].filter(one => one.getClientRects().length > 0).map(one => one.id)");
    assert.deepStrictEqual(shown, []);
    await page.key("5");
    await sleep(80);
    const { target: [x, y, z], distance } = await camera(page), [eye, below, right] = await page.call(places => places.map(dynpoint.project), [[x, y + distance / 2, z], [x, y, z + 0.01], [x + 0.01, y, z]]);
    const centre = await page.call(place => dynpoint.project(place), [x, y, z]);
    near(eye, centre, 0.5, "a place above the target:");
    assert(below[1] > centre[1] + 5 && Math.abs(below[0] - centre[0]) < 1 && right[0] > centre[0] + 5, JSON.stringify([centre, below, right]));
    await browser.leave(page);
  });
  await check("where ticks are missing, the plots have a gap", async () => {
    const frames = Array.from({ length: fixture.FRAMES }, (_, i) => {
      const frame = known.frame(i);
      if (i >= 30 && i < 60) frame.writeUInt32LE(0, 8);
      return frame;
    });
    const page = await browser.visit(write("gap", fixture.streamOf([known.scene, ...frames, known.end])));
    await until("frames", async () => (await page.state()).ended);
    await until("the plots", async () => (await page.ask("dynpoint.plotScale('late')")).high > 0);
    await page.key("End");
    await sleep(100);
    const drawn = await page.call(times => times.map(time => dynpoint.plotPixel(dynpoint.plotPlace("late", time, 1.6e-5))[3] > 60), [0.25, 0.75, 1.25]);
    assert.deepStrictEqual(drawn, [true, false, true]);
    await browser.leave(page);
  });
  await check("damaged frames are shown or refused, and never stop the page", async () => {
    const dice = random(21), frames = Array.from({ length: 400 }, (_, i) => Buffer.from(damage(alone(known.frame(60 + i % 120)), dice)));
    const page = await browser.visit(write("damaged", fixture.streamOf([known.scene, ...frames, known.end])));
    const { frames: kept, refused } = await until("frames", async () => { const state = await page.state(); return state.ended && state; });
    assert(refused > 50 && kept >= 1, `${kept} kept, ${refused} refused`);
    for (let i = 0; i < kept; i += 3) {
      await page.call(i => { const slider = document.getElementById("slider"); slider.value = String(i); slider.dispatchEvent(new Event("input")); }, i);
      await sleep(20);
    }
    await sleep(100);
    const { index, notice } = await page.state();
    assert.match(notice, /^A message was refused\. [A-Z]/);
    assert.deepStrictEqual([index, page.said], [3 * Math.floor((kept - 1) / 3), []]);
    await browser.leave(page);
  });
  await check("data that are cut off, and a page without data, are said in a sentence", async () => {
    const cut = fixture.streamOf([known.scene, known.end]);
    for (const [name, bytes, words] of [["cut", cut.subarray(0, cut.length - 20), /^The page's data were refused\. .*behind/],
      ["other", fixture.streamOf([Buffer.alloc(8, 1)]), /^The scene was refused/], ["none", Buffer.alloc(0), /no data and no server/]]) {
      const page = await browser.visit(write(name, bytes));
      assert.match((await page.state()).notice, words);
      assert.deepStrictEqual(page.said, []);
      await browser.leave(page);
    }
  });
}

async function withoutWebGL() {
  const blind = launch(room, "--disable-3d-apis");
  await check("without WebGL a sentence says so, and numbers, plots and keys work", async () => {
    const page = await blind.visit(write("ring", fixture.stream()));
    await until("frames", async () => (await page.state()).frames === fixture.FRAMES);
    assert.strictEqual(await page.ask("document.getElementById('blind').hidden"), false);
    assert.match(await page.text("blind"), /no WebGL/);
    await page.key("End");
    await page.key("ArrowLeft");
    await until("its numbers", async () => (await page.readout("tick")) === "3,967");
    const { high } = await page.ask("dynpoint.plotScale('force')");
    assert.strictEqual(high, 10);
    for (const key of ["d", "f", "p", "1", "Enter", "Escape", "t"]) await page.key(key);
    assert(page.said.every(text => /WebGL/.test(text)), page.said.join());
  });
  await blind.close();
}

async function speed(browser) {
  const { triangles, stream } = fixture.large(50332), page = await browser.visit(write("large", stream));
  await until("the scene", async () => (await page.state()).number === 0);
  const rate = async moving => 1000 / (await page.ask(`dynpoint.timeDrawing(${moving ? 30 : 60}, ${moving})`));
  const size = await page.ask("dynpoint.picture().then(({ width, height }) => `${width} x ${height}`)");
  await rate(true);
  console.log(`note ${triangles} triangles at ${size}: ${(await rate(false)).toFixed(0)} pictures a second at rest, ${(await rate(true)).toFixed(0)} with all vertices moving`);
  await browser.leave(page);
}

async function main() {
  const browser = launch(room);
  const page = await browser.visit(write("ring", fixture.stream()));
  await until("frames", async () => (await page.state()).frames === fixture.FRAMES);
  await drawing(page);
  await deforming(page);
  await playing(page);
  await moving(page);
  await picking(page);
  await looks(page);
  await check("the page asked the network for nothing, and the console is empty", () => {
    assert.deepStrictEqual(page.asked.filter(url => !url.startsWith("data:image/svg") && !url.startsWith("blob:null")).length, 1, page.asked.join());
    assert.deepStrictEqual(page.said, []);
  });
  await browser.leave(page);
  await otherPages(browser);
  await speed(browser);
  await browser.close();
  await withoutWebGL();
  finish();
}

main().catch(error => {
  console.log(`FAIL the page's test itself: ${error.stack}`);
  process.exit(1);
});
