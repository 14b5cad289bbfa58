// SPDX-License-Identifier: BSD-3-Clause
// node page_recording.js PAGE.html ROOM: the page that plays by itself, from its file in a headless Chromium: its time, plots and
// looks, and data that are not as they should be.
"use strict";
const fs = require("fs");
const path = require("path");
const { launch, until, sleep } = require("./chromium.js");
const { check, near, random, alone, damage, finish, assert } = require("./verdicts.js");
const { pageWriter, visitRecording, seek, camera, textsOf } = require("./page_sights.js");
const fixture = require("./stream_fixture.js");
const known = fixture.recording();
const [template, room] = process.argv.slice(2);
const write = pageWriter(template, room);

async function playing(page) {
  await check("keys step, jump and play; the readouts are those of the frame", async () => {
    await seek(page, 150);
    assert.deepStrictEqual(
      [
        await page.readout("tick"),
        await page.readout("force"),
        await page.readout("near"),
        await page.readout("nearWord"),
        await page.readout("contact"),
      ],
      ["2,500", "4.00 N", "8.000 mm", "depth", "pressed in"],
    );
    const index = async () => {
      await page.settle();
      return (await page.state()).index;
    };
    await page.ask("document.activeElement.blur()");
    const seen = [];
    for (const key of ["ArrowRight", "ArrowLeft", "ArrowLeft", "Home", "End"]) {
      await page.key(key);
      seen.push(await index());
    }
    assert.deepStrictEqual(seen, [151, 150, 149, 0, 239]);
  });
  await check("a recording plays by the browser's clock, at the speed that is chosen", async () => {
    const speed = async () => (await page.state()).speed;
    for (const [keys, wanted] of [["", 1], ["[[", 0.25]]) {
      for (const key of keys) await page.key(key);
      await page.key("Home");
      await page.settle();
      // Of each picture: the browser's time, and that of the frame.
      await page.call(() => {
        const { play, history } = viewer;
        window.seen = [];
        play.advance = now => {
          const was = play.playing;
          Object.getPrototypeOf(play).advance.call(play, now);
          if (was) seen.push([now / 1000, history.get(play.index).time]);
        };
      });
      await page.key(" ");
      await until("0.3 s of it", async () => (await page.state()).time > 0.3);
      await page.call(() => {
        viewer.play.pause();
        delete viewer.play.advance;
      });
      assert.strictEqual(await speed(), wanted);
      const [[begun, from], ...later] = await page.ask("seen");
      const end = await page.ask("viewer.history.last.time");
      for (const [now, time] of later) {
        const due = Math.min(end, from + wanted * (now - begun));
        assert(time <= due + 1e-9 && time > due - 0.02, `${time} s where ${due} s were due`);
      }
    }
    await page.key("]");
    await page.key("]");
    assert.strictEqual(await speed(), 1);
  });
  await check("a pause holds the frame that is shown", async () => {
    for (const key of "[[[") await page.key(key); // the whole of it takes 40 s
    await page.key("Home");
    await page.key(" ");
    await until("another frame", async () => (await page.state()).index > 0);
    await page.key(" ");
    const { index, playing } = await page.state();
    assert(!playing && index < 239, `${index}`);
    await page.settle();
    assert.strictEqual((await page.state()).index, index);
    for (const key of "]]]") await page.key(key);
  });
  await check("what the plots call depth is the coupling where a proxy holds the tool", async () => {
    assert.strictEqual(await page.ask("viewer.plot.layout()[1].label"), "Coupling");
    assert.strictEqual(
      await page.ask("document.getElementById('plots').getAttribute('aria-label')"),
      "Force, coupling, energy and lateness over time",
    );
    const words = await page.ask("[0, 1, 2].map(law => readouts.depthWord({ law }))");
    assert.deepStrictEqual(words, ["Depth", "Depth", "Coupling"]);
  });
  await check("a reason of no force is said; a frame at rest costs no drawing", async () => {
    await seek(page, 20);
    assert.strictEqual(await page.readout("reason"), "free: it touches nothing");
    assert.strictEqual(await page.readout("nearWord"), "gap");
    let drawn = -1; // until its edges are smooth
    await until("rest", async () => {
      const before = drawn;
      await sleep(600);
      return (drawn = (await page.state()).drawn) === before;
    });
    await sleep(600);
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
    const box = await page.ask(
      "(({ left, top }) => [left, top])(document.getElementById('plots').getBoundingClientRect())",
    );
    const at = await page.ask("dynpoint.plotPlace('force', 2.0, 5)");
    await page.click(at.map((value, k) => value + box[k]));
    await page.settle();
    near((await page.state()).time, 2, 0.03);
  });
}

async function looks(page) {
  await check("the PNG has the picture's size, and is saved under the scene's name", async () => {
    const { width, height, wanted } = await page.ask("dynpoint.picture()");
    assert.deepStrictEqual([[width, height], width > 500 && height > 500], [wanted, true]);
    await page.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: room, eventsEnabled: false });
    await page.key("p");
    const file = await until("a file", () =>
      fs.readdirSync(room).find(name => /^A-ring-and-a-ball-\d+\.png$/.test(name)),
    );
    const bytes = await until("its bytes", () => {
      const all = fs.readFileSync(path.join(room, file));
      return all.length > 100 && all;
    });
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
    const contrasts = () =>
      page.ask(`(() => {
      const style = getComputedStyle(document.documentElement), light = name => {
        const { r, g, b } = new THREE.Color(style.getPropertyValue("--" + name).trim());
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
      };
      const ratio = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
      return [["text", "card"], ["faint", "card"], ["faint", "background"], ["accent", "card"], ["plot-force", "card"], ["warn", "warn-back"],
        ["text", "button"], ["faint", "button"]].map(([a, b]) => ratio(a, b));
    })()`);
    assert(
      (await contrasts()).every(ratio => ratio >= 4.5),
      `light: ${await contrasts()}`,
    );
    await page.key("t");
    assert(
      (await contrasts()).every(ratio => ratio >= 4.5),
      `dark: ${await contrasts()}`,
    );
    await page.key("t");
    await page.key("t");
  });
  await check("the help panel opens and closes by keys, and holds three's licence", async () => {
    await page.key("?");
    assert.strictEqual(await page.ask("document.getElementById('panel').open"), true);
    assert.match(await page.text("panel"), /three\.js authors[^]*WITHOUT WARRANTY OF ANY KIND/);
    await page.ask("document.getElementById('panel').close()");
  });
  await check(
    "all that can be pressed has a name, and a focus that is seen; the live region speaks of few things",
    async () => {
      const nameless = await page.ask(`[...document.querySelectorAll("button, select, input, canvas")].filter(one =>
      !(one.getAttribute("aria-label") || one.textContent.trim() || one.closest("label"))).map(one => one.outerHTML)`);
      assert.deepStrictEqual(nameless, []);
      await page.ask("document.getElementById('help').focus({ focusVisible: true })");
      assert.match(
        await page.ask(
          "getComputedStyle(document.activeElement).outlineStyle + getComputedStyle(document.activeElement).outlineWidth",
        ),
        /^solid2px/,
      );
      await page.ask(
        "window.said = 0, new MutationObserver(all => { said += all.length; }).observe(document.getElementById('status'), { childList: true }), 0",
      );
      await page.ask("document.activeElement.blur()");
      await page.key("Home");
      await page.key(" ");
      await sleep(800);
      await page.key(" ");
      assert((await page.ask("said")) <= 2);
    },
  );
  for (const [width, height, frame] of [
    [1280, 800, 150],
    [390, 844, 150],
    [1280, 800, 20],
    [390, 844, 20],
  ])
    await check(`${width} x ${height}, frame ${frame}: no text is cut off, and none lies on another`, async () => {
      await page.size(width, height, width < 500);
      await seek(page, frame);
      const { cut, crossed, texts } = await page.call(textsOf);
      assert(texts > 25, `${texts} texts`);
      assert.deepStrictEqual([cut, crossed], [[], []]);
      // Numbers as long as they get.
      const { cut: longCut } = await page.call(textsOf, { near: "-1234.567 mm", torque: "12345.6 mN m", dropped: "123,456,789" });
      assert.deepStrictEqual(longCut, []);
    });
  await check("buttons as high as fingers need them leave one another, and the scene's places, clear", async () => {
    await page.size(390, 844, true);
    await seek(page, 150);
    const { apart, bottom, low } = await page.call(() => {
      const [views, deformation] = ["views", "deformation"].map(id => document.getElementById(id));
      for (const button of views.children) button.style.minHeight = "60px";
      const stage = document.getElementById("stage").getBoundingClientRect();
      const top = deformation.getBoundingClientRect().top;
      viewer.own.view.fit(false);
      viewer.own.view.draw(true);
      const { view } = viewer.own;
      const heights = [...view.bodies.values()].flatMap(body =>
        Array.from({ length: body.mesh.vertices }, (_, i) => {
          const at = body.positions.subarray(3 * i, 3 * i + 3);
          return view.project(body.toScene([...at]))[1];
        }),
      );
      const found = {
        apart: views.getBoundingClientRect().top - deformation.getBoundingClientRect().bottom,
        bottom: top - stage.top,
        low: Math.max(...heights),
      };
      for (const button of views.children) button.style.minHeight = "";
      return found;
    });
    assert(apart >= 4 && low <= bottom, `${apart} apart; the scene reaches to ${low}, the buttons begin at ${bottom}`);
  });
  for (const [width, height] of [
    [1280, 800],
    [390, 844],
  ])
    await check(`${width} x ${height}: Tab and fingers come to all that can be pressed, and nothing lies over it`, async () => {
      await page.size(width, height, width < 500);
      await page.settle();
      const CONTROLS = `[...document.querySelectorAll("button, select, input, canvas[tabindex]")]
        .filter(one => one.checkVisibility() && !one.disabled)`;
      const nameOf = "one => one.id || one.dataset.view || one.tagName";
      const names = await page.ask(`${CONTROLS}.map(${nameOf})`);
      assert(names.length > 15, names.join());
      await page.ask("document.activeElement.blur()");
      const reached = new Set();
      for (let i = 0; i < names.length + 5; i++) {
        for (const type of ["keyDown", "keyUp"])
          await page.send("Input.dispatchKeyEvent", { type, key: "Tab", code: "Tab", windowsVirtualKeyCode: 9 });
        reached.add(await page.ask(`(${nameOf})(document.activeElement)`));
      }
      assert.deepStrictEqual(names.filter(name => !reached.has(name)), []);
      const [low, covered] = await page.ask(`[
        ${CONTROLS}.filter(one => Math.min(one.offsetWidth, one.offsetHeight) < 24),
        ${CONTROLS}.filter(one => {
          if (one.id === "picture") return false; // labels and legend stand over it
          one.scrollIntoView({ block: "center" });
          const { left, top, width, height } = one.getBoundingClientRect();
          return !one.contains(document.elementFromPoint(left + width / 2, top + height / 2));
        }),
      ].map(list => list.map(${nameOf}))`);
      assert.deepStrictEqual([low, covered], [[], []]);
      await page.ask("document.activeElement.blur(), scrollTo(0, 0)");
    });
  await page.size(1280, 800);
  await check("on a narrow screen all is there, one below the other, and nothing is wider than it", async () => {
    await page.size(390, 844, true);
    await until("narrow", async () => (await page.ask("document.getElementById('picture').clientWidth")) <= 390);
    await page.settle();
    const [wide, picture, plots] = await page.ask(
      "[document.documentElement.scrollWidth, document.getElementById('picture').clientHeight, document.getElementById('plots').clientWidth]",
    );
    assert(wide <= 390 && picture >= 260 && plots > 300, [wide, picture, plots].join());
    await page.size(1280, 800);
    await page.settle();
  });
}

async function otherPages(browser) {
  await check("a body has the colour, and the camera the place, that the scene gives", async () => {
    const green = [0.1, 0.6, 0.2];
    const bodies = [{ id: 11, mesh: 0, pose: [0, 0, 0, 1, 0, 0, 0], name: "ring", colour: green }];
    for (const [up, position, azimuth, elevation, wide] of [
      ["z", [0, -0.3, 0.4], 0, Math.atan2(0.4, 0.3), 1280],
      ["y", [0.3, 0.4, 0], Math.PI / 2, Math.atan2(0.4, 0.3), 1280],
      ["y", [0.3, 0.4, 0], Math.PI / 2, Math.atan2(0.4, 0.3), 390],
    ]) {
      const page = await browser.visit(
        write(
          `coloured-${up}`,
          fixture.streamOf([
            fixture.sceneMessage(known.meshes.slice(0, 1), {
              mode: "mesh",
              device: null,
              up,
              bodies,
              camera: [...position, 0, 0, 0, ...(up === "z" ? [0, 0, 1] : [0, 1, 0])],
            }),
          ]),
        ),
        { width: wide, height: 800 },
      );
      await until("the scene", async () => (await page.state()).mode === "mesh");
      const seen = await camera(page);
      const { width, height } = await page.ask("(({ width, height }) => ({ width, height }))(viewer.own.view)");
      const away = 0.5 * Math.max(1, (1.2 * height) / width);
      assert.strictEqual(away > 0.55, wide < 500, `${width} x ${height}`);
      assert(Math.abs(seen.distance - away) < 1e-9 && Math.abs(seen.azimuth - azimuth) < 1e-9, JSON.stringify(seen));
      assert(Math.abs(seen.elevation - elevation) < 1e-9, JSON.stringify(seen));
      await page.settle();
      const got = await page.call(place => dynpoint.pixel(place), up === "z" ? [0.06, 0, 0.025] : [0.085, 0, 0]);
      assert(got[1] > 1.5 * got[0] && got[1] > 1.5 * got[2], `${got} is not green`);
      await browser.leave(page);
    }
  });
  await check("names with markup stay text", async () => {
    const evil = "<img src=x onerror=document.title='gone'><script>document.title='gone'</script>&amp;";
    const bodies = [11, 12].map((id, mesh) => ({ id, mesh, pose: [0, 0, 0, 1, 0, 0, 0], name: evil }));
    const meshes = known.meshes.map(mesh => ({ ...mesh, name: evil }));
    const page = await browser.visit(
      write(
        "markup",
        fixture.streamOf([
          fixture.sceneMessage(meshes, {
            title: evil,
            program: evil,
            mode: "mesh",
            bodies,
            device: { name: evil, simulated: true, rate: 1, workspace: null },
          }),
        ]),
      ),
    );
    await until("the scene", async () => (await page.state()).mode === "mesh");
    await sleep(200);
    await page.key("Enter");
    assert.deepStrictEqual(
      [
        await page.text("title"),
        await page.ask("document.querySelectorAll('img').length"),
        await page.text("device"),
      ],
      [evil, 0, `${evil}, simulated`],
    );
    assert.match(
      await page.text("facts"),
      /onerror.*4,816 triangles, 2,408 vertices170\.0 \u00d7 169\.9 \u00d7 50\.0 mm/,
    );
    assert((await page.ask("document.title")).startsWith(evil));
    assert.deepStrictEqual(page.said, []);
    await browser.leave(page);
  });
  await check("a mesh without frames has neither plots nor numbers; with y up, the top is there", async () => {
    const page = await browser.visit(
      write(
        "upright",
        fixture.streamOf([fixture.sceneMessage(known.meshes, { mode: "mesh", up: "y", device: null })]),
      ),
    );
    await until("the scene", async () => (await page.state()).mode === "mesh");
    const shown = await page.ask(
      "[...document.querySelectorAll('.of-frames')].filter(one => one.getClientRects().length > 0).map(one => one.id)",
    );
    assert.deepStrictEqual(shown, []);
    await page.key("5");
    await page.settle();
    const {
      target: [x, y, z],
      distance,
    } = await camera(page);
    const [eye, below, right] = await page.call(
      places => places.map(dynpoint.project),
      [
        [x, y + distance / 2, z],
        [x, y, z + 0.01],
        [x + 0.01, y, z],
      ],
    );
    const centre = await page.call(place => dynpoint.project(place), [x, y, z]);
    near(eye, centre, 0.5, "a place above the target:");
    assert(
      below[1] > centre[1] + 5 && Math.abs(below[0] - centre[0]) < 1 && right[0] > centre[0] + 5,
      JSON.stringify([centre, below, right]),
    );
    await browser.leave(page);
  });
  await check("of several tools one can choose whose numbers are shown", async () => {
    const tools = [1, 2].map(newtons =>
      fixture.pack([
        ["u32", [newtons, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]],
        ["u64", [0, 0]],
        ["f64", [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, newtons, 0, 0, 0, 0, 0, 0, 0, 0]],
      ]),
    );
    const frame = fixture.frameMessage(0, fixture.snapshot(1, 0, [[2, 2, 248, Buffer.concat(tools)]]));
    const page = await browser.visit(write("tools", fixture.streamOf([known.scene, frame])));
    await until("the first tool's", async () => (await page.readout("force")) === "1.00 N");
    await page.call(() => {
      const choice = document.getElementById("tool");
      choice.value = "2";
      choice.dispatchEvent(new Event("change"));
    });
    await until("the second one's", async () => (await page.readout("force")) === "2.00 N");
    assert.strictEqual(await page.ask("document.getElementById('which').hidden"), false);
    await browser.leave(page);
  });
  await check("a recording begins to play by itself, unless less motion is wanted", async () => {
    for (const [motion, wanted] of [
      ["no-preference", true],
      ["reduce", false],
    ]) {
      const page = await browser.visit(write("ring", fixture.stream()), {
        features: { "prefers-reduced-motion": motion },
      });
      await until("frames", async () => (await page.state()).frames === fixture.FRAMES);
      if (wanted) await until("the next frame", async () => (await page.state()).index > 0);
      else await sleep(1000);
      assert.strictEqual((await page.state()).index > 0, wanted, motion);
      await browser.leave(page);
    }
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
    await page.settle();
    const drawn = await page.call(
      times => times.map(time => dynpoint.plotPixel(dynpoint.plotPlace("late", time, 1.6e-5))[3] > 60),
      [0.25, 0.75, 1.25],
    );
    assert.deepStrictEqual(drawn, [true, false, true]);
    await browser.leave(page);
  });
  await check("damaged frames are shown or refused, and never stop the page", async () => {
    const dice = random(21);
    const frames = Array.from({ length: 400 }, (_, i) =>
      Buffer.from(damage(alone(known.frame(60 + (i % 120))), dice)),
    );
    const page = await browser.visit(write("damaged", fixture.streamOf([known.scene, ...frames, known.end])));
    const { frames: kept, refused } = await until("frames", async () => {
      const state = await page.state();
      return state.ended && state;
    });
    assert(refused > 50 && kept >= 1, `${kept} kept, ${refused} refused`);
    for (let i = 0; i < kept; i += 3) {
      await page.call(i => {
        const slider = document.getElementById("slider");
        slider.value = String(i);
        slider.dispatchEvent(new Event("input"));
      }, i);
      await sleep(20);
    }
    await page.settle();
    const { index, notice } = await page.state();
    assert.match(notice, /^A message was refused\. [A-Z]/);
    assert.deepStrictEqual([index, page.said], [3 * Math.floor((kept - 1) / 3), []]);
    await browser.leave(page);
  });
  await check("data that are cut off, and a page without data, are said in a sentence", async () => {
    const cut = fixture.streamOf([known.scene, known.end]);
    for (const [name, bytes, words] of [
      ["cut", cut.subarray(0, cut.length - 20), /^The page's data were refused\. .*behind/],
      ["other", fixture.streamOf([Buffer.alloc(8, 1)]), /^The scene was refused/],
      ["none", Buffer.alloc(0), /no data and no server/],
    ]) {
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
    assert(
      page.said.every(text => /WebGL/.test(text)),
      page.said.join(),
    );
  });
  await blind.close();
}

async function main() {
  const browser = launch(room);
  const page = await visitRecording(browser, write("ring", fixture.stream()), fixture.FRAMES, { width: 1280, height: 800 });
  await playing(page);
  await looks(page);
  await check("the page asked the network for nothing, and the console is empty", () => {
    const asked = page.asked.filter(url => !url.startsWith("data:image/svg") && !url.startsWith("blob:null"));
    assert.strictEqual(asked.length, 1, page.asked.join());
    assert.deepStrictEqual(page.said, []);
  });
  await browser.leave(page);
  await otherPages(browser);
  await browser.close();
  await withoutWebGL();
  finish();
}

main().catch(error => {
  console.log(`FAIL the page's test itself: ${error.stack}`);
  process.exit(1);
});
