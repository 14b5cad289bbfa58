// SPDX-License-Identifier: BSD-3-Clause
// node page_choices.js PAGE ROOM: the page in a headless Chromium: mouse, wheel, fingers and keys; meshes of a
// visitor's own, malformed ones too; small and large windows; scripts that were changed. Pictures go into ROOM.
"use strict";
const fs = require("fs");
const path = require("path");
const zlib = require("zlib");
const { check, near, finish, assert } = require("../view/verdicts.js");
const { launch, until, sleep } = require("../view/chromium.js");
const sights = require("../view/page_sights.js");
const touch = require("./touch_sights.js");
const [, , file, room] = process.argv;
const CUBE = [0, 1, 2, 3, 4, 5, 6, 7]
  .map(i => `v ${(i & 1) * 120} ${((i >> 1) & 1) * 100} ${((i >> 2) & 1) * 80}\n`)
  .concat(["f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"])
  .join("");

const axes = page => page.ask("viewer.own.view.camera.axes()");
const along = (a, b, axis) => axis.reduce((sum, value, k) => sum + value * (b[k] - a[k]), 0);

// The tool's tip when it has not moved for 400 ticks, and what was asked of the hand is on its way.
async function rest(page) {
  await page.settle();
  for (let last = await touch.shown(page), still = 0; ;) {
    await until("ticks", async () => (await touch.shown(page)).steps >= last.steps + 100);
    const now = await touch.shown(page);
    still = Math.hypot(...now.tip.map((value, k) => value - last.tip[k])) < 2e-5 ? still + 1 : 0;
    if (still === 4) return now.tip;
    last = now;
  }
}

// How the tool's tip moves by what is done, along the picture's axes: right, above, back. It waits until it rests.
async function moves(page, act) {
  const before = (await touch.shown(page)).tip;
  const { right, above, back } = await axes(page);
  await act();
  const after = await rest(page);
  return [right, above, back].map(axis => along(before, after, axis));
}

async function checkGestures(page) {
  const [x, y, width, height] = (await touch.shown(page)).picture;
  const middle = [x + width / 2, y + height / 2];
  const by = await page.call(() =>
    viewer.own.view.camera.pixelSize(viewer.own.frame.snapshot.tools[0].pose.slice(0, 3)),
  );
  await check("a drag moves the tool in the picture's plane, by as much as the pointer", async () => {
    const [right, above, back] = await moves(page, () => page.drag(middle, [middle[0] + 40, middle[1] - 30]));
    near([right, above], [40 * by, 30 * by], 4 * by, "moved");
    near(back, 0, 2 * by);
  });
  await check("the wheel moves it towards the viewer and away", async () => {
    const wheel = deltaY => page.mouse("mouseWheel", middle, { deltaX: 0, deltaY });
    const [right, above, back] = await moves(page, () => wheel(100));
    assert(back > 2e-3, `${back} m`);
    near([right, above], [0, 0], 5e-4);
    near((await moves(page, () => wheel(-100)))[2], -back, 1e-3);
  });
  await check("with Ctrl the wheel zooms, and the right button turns the picture; the tool stays", async () => {
    const before = await sights.camera(page);
    const moved = await moves(page, async () => {
      await page.mouse("mouseWheel", middle, { deltaX: 0, deltaY: -120, modifiers: 2 });
      await page.drag(middle, [middle[0] + 60, middle[1]], { button: "right" });
    });
    const after = await sights.camera(page);
    assert(after.distance < 0.95 * before.distance && Math.abs(after.azimuth - before.azimuth) > 0.1);
    near(moved, [0, 0, 0], 2e-4);
    await page.ask("viewer.actions.fit(), 0");
  });
  await check(
    "arrows move it in the picture's plane, PgUp and PgDn in depth; Shift with an arrow a frame back",
    async () => {
      const times = async (key, count) => {
        for (let i = 0; i < count; i++) await page.key(key);
      };
      const radius = await page.ask("viewer.actions.radius()");
      const step = 0.05 * radius;
      near(await moves(page, () => times("ArrowRight", 5)), [step, 0, 0], 0.1 * step + 2e-4);
      near(await moves(page, () => times("ArrowUp", 5)), [0, step, 0], 0.1 * step + 2e-4);
      near(await moves(page, () => times("PageUp", 5)), [0, 0, -step], 0.1 * step + 2e-4);
      assert((await page.state()).playing);
      await page.key("ArrowLeft", 8);
      assert(!(await page.state()).playing, "Shift with an arrow moved no frame");
      await page.key("End");
      await until("live again", async () => (await page.state()).playing);
    },
  );
  await check("one finger moves it, two turn the picture and zoom", async () => {
    const path = [0, 1, 2, 3, 4].map(i => [[middle[0] - 10 * i, middle[1] + 5 * i]]);
    const [right, above] = await moves(page, () => page.touch(path));
    near([right, above], [-40 * by, -20 * by], 0.3 * 40 * by, "moved");
    const before = await sights.camera(page);
    const two = [0, 1, 2, 3].map(i => [
      [middle[0] - 40 - 10 * i, middle[1] + 15 * i],
      [middle[0] + 40 + 10 * i, middle[1] + 15 * i],
    ]);
    near(await moves(page, () => page.touch(two)), [0, 0, 0], 3e-3);
    const after = await sights.camera(page);
    assert(after.distance < 0.9 * before.distance && after.elevation > before.elevation + 0.1);
  });
  await check("the buttons for fingers move it in depth while they are held", async () => {
    await page.ask("document.getElementById('touch-depth').style.display = 'flex', 0");
    const at = await page.call(() => {
      const { x, y, width, height } = document.querySelector("#touch-depth [data-way='1']").getBoundingClientRect();
      return [x + width / 2, y + height / 2];
    });
    const [, , back] = await moves(page, async () => {
      const { tip } = await touch.shown(page);
      const by = async () => Math.hypot(...(await touch.shown(page)).tip.map((value, k) => value - tip[k]));
      await page.mouse("mousePressed", at, { button: "left", buttons: 1, clickCount: 1 });
      await until("more than 3 mm", async () => (await by()) > 3e-3);
      await page.mouse("mouseReleased", at, { button: "left", clickCount: 1 });
    });
    assert(back > 3e-3, `${back} m`);
    await page.ask("document.getElementById('touch-depth').removeAttribute('style'), 0");
  });
}

// A file falls on the page; `lie`: the size that it states
const drop = (page, name, text, lie) =>
  page.call(
    (name, text, lie) => {
      const data = new DataTransfer();
      const file = new File([text], name);
      if (lie) Object.defineProperty(file, "size", { value: lie });
      if (!lie) data.items.add(file);
      const event = new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: data });
      if (lie) Object.defineProperty(event, "dataTransfer", { value: { files: [file] } });
      document.body.dispatchEvent(event);
      return event.defaultPrevented;
    },
    name,
    text,
    lie,
  );

async function checkFiles(page) {
  const goesOn = async () => {
    const before = await touch.shown(page);
    await until("ticks", async () => (await touch.shown(page)).steps > before.steps + 100);
  };
  await check("a mesh that is dropped is compiled, scaled to 200 mm, named as text, and touched", async () => {
    assert(await drop(page, "<b>cube</b>.obj", CUBE));
    await until("the cube", async () => (await touch.shown(page)).title === "<b>cube</b>.obj");
    assert.match(await page.text("touch-size"), /^120 × 100 × 80 units, shown as 200 × 167 × 133 mm/);
    assert.strictEqual(await page.ask("document.querySelectorAll('#title b, #touch-scene b').length"), 0);
    const recorded = await touch.record(page, 600, [
      [0, 0.1, 0],
      [0, 0.05, 0],
      [0, 0.05, 0],
      [0, 0.05, 0],
      [0, 0.05, 0],
    ]);
    assert(recorded.sizes.length === 600);
    await until("contact", async () => (await touch.shown(page)).contact === 3);
  });
  await check("a malformed one says which line is wrong, and the scene goes on", async () => {
    await drop(page, "bad.obj", CUBE.replace("v 120 0 0", "v 120 zero 0"));
    await until("the notice", async () => /^bad\.obj: line 2: /.test((await page.state()).notice));
    await goesOn();
    assert.strictEqual((await touch.shown(page)).title, "<b>cube</b>.obj");
  });
  await check("one that is cut off says at which byte, one that is none says so", async () => {
    const coordinates = ["x", "y", "z"].map(axis => `property float ${axis}\n`).join("");
    await drop(
      page,
      "cut.ply",
      `ply\nformat binary_little_endian 1.0\nelement vertex 3\n${coordinates}end_header\n\0\0\0`,
    );
    await until("the notice", async () => /^cut\.ply: byte \d+: /.test((await page.state()).notice));
    await drop(page, "page.txt", "To be or not to be\n");
    await until("the notice", async () => /^page\.txt: .+ The scene goes on/.test((await page.state()).notice));
    await goesOn();
  });
  await check("one of more than 200 MB is refused with a sentence, unread", async () => {
    await drop(page, "huge.stl", "", 2.5e8);
    await until("the notice", async () => (await page.state()).notice === "huge.stl has 250 MB; this page reads up to 200 MB.");
    await goesOn();
  });
  await check("one can be chosen by the button too; the newest choice counts", async () => {
    const name = path.resolve(room, "box.obj");
    fs.writeFileSync(name, CUBE);
    const { root } = await page.send("DOM.getDocument");
    const { nodeId } = await page.send("DOM.querySelector", { nodeId: root.nodeId, selector: "#touch-file" });
    await page.send("DOM.setFileInputFiles", { nodeId, files: [name] });
    await until("the box", async () => (await touch.shown(page)).title === "box.obj");
    assert.strictEqual((await page.state()).notice, "");
    await page.call(() => {
      for (const name of ["soft", "torus"]) {
        const list = document.getElementById("touch-scene");
        list.value = name;
        list.dispatchEvent(new Event("change"));
      }
    });
    await until("the torus", async () => (await touch.shown(page)).title === "Torus");
    await sleep(1500);
    assert.strictEqual((await touch.shown(page)).title, "Torus");
  });
}

async function checkNames(page) {
  await check("every control has a name for those who hear the page, and the keyboard reaches it", async () => {
    const nameless = await page.call(() =>
      [...document.querySelectorAll("button, select, input, summary, canvas")]
        .filter(
          one =>
            one.checkVisibility() &&
            !(
              one.labels?.length ||
              one.ariaLabel ||
              one.title ||
              one.textContent.trim() ||
              one.ariaLabelledByElements?.length
            ),
        )
        .map(one => one.outerHTML.slice(0, 80)),
    );
    assert.deepStrictEqual(nameless, []);
    const focused = new Set();
    await page.ask("document.body.focus(), 0");
    for (let i = 0; i < 40; i++) {
      await page.send("Input.dispatchKeyEvent", { type: "keyDown", key: "Tab", code: "Tab", windowsVirtualKeyCode: 9 });
      await page.send("Input.dispatchKeyEvent", { type: "keyUp", key: "Tab", code: "Tab", windowsVirtualKeyCode: 9 });
      focused.add(await page.ask("document.activeElement.id || document.activeElement.name"));
    }
    for (const id of ["picture", "touch-scene", "touch-choose", "law", "touch-stiffness", "help"])
      assert(focused.has(id), `Tab does not come to ${id}: ${[...focused]}`);
  });
}

async function checkWindows(browser) {
  for (const [width, height, scheme] of [
    [360, 640, "light"],
    [1280, 800, "dark"],
    [1920, 1080, "light"],
  ])
    await check(
      `${width} x ${height}, ${scheme}: nothing is wider than the window; the picture and the choices are seen`,
      async () => {
        const features = { "prefers-color-scheme": scheme, "prefers-reduced-motion": "no-preference" };
        const page = await touch.visitPage(browser, file, { width, height, features });
        await until("contact", async () => (await touch.shown(page)).contact === 3);
        const { wide, boxes } = await page.call(() => ({
          wide: document.documentElement.scrollWidth,
          boxes: ["picture", "touch", "touch-scene", "touch-choose", "touch-stiffness", "plots"].map(id => {
            const { left, right, width, height } = document.getElementById(id).getBoundingClientRect();
            return [id, left, right, width, height];
          }),
        }));
        assert(wide <= width, `it is ${wide} wide`);
        for (const [id, left, right, across, high] of boxes)
          assert(
            left >= 0 && right <= width && across >= 60 && high >= 12,
            `${id}: ${left} to ${right}, ${across} x ${high}`,
          );
        assert.strictEqual(await page.ask("document.documentElement.dataset.theme"), scheme);
        assert(await page.ask("document.getElementById('touch-hint').checkVisibility()"));
        await page.shoot(path.join(room, `page-${width}.png`));
        assert.deepStrictEqual(page.said, []);
        await browser.leave(page);
      },
    );
}

async function checkScripts(browser) {
  await check("a script that was changed in the file does not run", async () => {
    const page = fs.readFileSync(file, "utf8");
    const [, pack] = /id="pack">([^<]*)</.exec(page);
    const bytes = zlib.inflateRawSync(Buffer.from(pack, "base64"));
    const at = bytes.indexOf("const touchPanel");
    assert(at > 0);
    bytes.write("const touchpanel", at);
    const changed = path.join(room, "changed.html");
    fs.writeFileSync(changed, page.replace(pack, zlib.deflateRawSync(bytes).toString("base64")));
    const view = await browser.visit(`file://${path.resolve(changed)}`);
    await until("the refusal", () => view.said.some(said => /Content Security Policy/.test(said)));
    assert.strictEqual(await view.ask("typeof viewer"), "undefined");
    await browser.leave(view);
  });
}

(async () => {
  const browser = launch(path.resolve(room));
  try {
    const page = await touch.visitPage(browser, file);
    await checkGestures(page);
    await checkFiles(page);
    await checkNames(page);
    await check("the console is empty", () => assert.deepStrictEqual(page.said, []));
    await browser.leave(page);
    await checkWindows(browser);
    await checkScripts(browser);
  } finally {
    await browser.close();
  }
  finish();
})();
