// SPDX-License-Identifier: BSD-3-Clause
// node page_world.js WASM PROGRAM ROOM: the parts of the page's workers without a browser: the simulated hand, the
// world, the loop by a clock of the test's own, its messages as the viewer reads them, and compiling.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { check, near, scripts, finish, assert } = require("../view/verdicts.js");
const [wasm, program, room] = process.argv.slice(2).map(name => path.resolve(name));
const dynpoint = (globalThis.dynpoint = require(path.join(wasm, "dynpoint.js")));
const { heldDevice, touchScenes, touchWorld, touchLoop, compileJob } = scripts(
  ...["held_device", "touch_scenes", "touch_world", "touch_messages", "touch_loop", "compile_job"],
);
const { messageReader } = scripts("checked_reading", "snapshot_reader", "message_reader");
const { HeldDevice, MASS, DAMPING, GRIP, PERIOD } = heldDevice;
const { SCENES } = touchScenes;
const WIDE = [-1, -1, -1, 1, 1, 1];
const modules = () => ({
  core: fs.readFileSync(path.join(wasm, "dynpoint.wasm")),
  compiler: fs.readFileSync(path.join(wasm, "dynpoint_compile.wasm")),
});
const { DPT_LAW_POINT, DPT_LAW_BED, DPT_LAW_PROXY } = dynpoint.constants;

function shape(name, triangles) {
  const file = path.join(room, `${name}.ply`);
  execFileSync(program, ["make", name, String(triangles), "-o", file]);
  return new Uint8Array(fs.readFileSync(file));
}

async function checkHand(core) {
  await check("the hand moves as its equation says: against 20,000 small steps of it", () => {
    const device = new HeldDevice([0, 0, 0], WIDE);
    device.v = [0.2, 0, 0];
    let [x, v] = [0, 0.2];
    const small = 200;
    for (let tick = 0; tick < 100; tick++) {
      const force = tick < 50 ? 1.5 : -0.5;
      device.step([force, 0, 0]);
      for (let i = 0; i < small; i++) {
        const dt = PERIOD / small;
        const half = v + (0.5 * dt * (force - GRIP * x - DAMPING * v)) / MASS;
        const middle = x + 0.5 * dt * v;
        v += (dt * (force - GRIP * middle - DAMPING * half)) / MASS;
        x += dt * half;
      }
    }
    near([device.x[0], device.v[0]], [x, v], 1e-7);
  });
  await check("it comes to rest where the finger's spring balances the force", () => {
    const device = new HeldDevice([0, 0, 0], WIDE);
    device.want([0.1, -0.02, 0]);
    for (let tick = 0; tick < 3000; tick++) device.step([0, 0, 0.3]);
    near(device.x, [0.1, -0.02, 0.3 / GRIP], 1e-9);
  });
  await check("neither finger nor device leaves the box, and what is no number is not followed", () => {
    const device = new HeldDevice([0, 0, 0], WIDE);
    device.want([5, 0, 0]);
    device.want([NaN, 0, 0]);
    for (let tick = 0; tick < 3000; tick++) device.step([1e3, -1e3, 0]);
    near(device.x, [1, -1, 0], 0);
    near(device.v, [0, 0, 0], 0);
  });
  await check("the finger goes at 0.5 m/s at most", () => {
    const device = new HeldDevice([0, 0, 0], WIDE);
    device.want([1, 1, 1]);
    for (let tick = 0; tick < 1000; tick++) {
      const before = device.finger;
      device.step([0, 0, 0]);
      assert(Math.hypot(...device.finger.map((value, k) => value - before[k])) <= 0.5 * PERIOD * (1 + 1e-9));
    }
  });
  const limit = core.stableStiffness(MASS, DAMPING, PERIOD, 0, 0);
  // Whether a push against a wall of this stiffness dies away.
  const settles = stiffness => {
    const device = new HeldDevice([0, 0, 0], WIDE);
    device.v = [1e-3, 0, 0];
    const least = [];
    for (let tick = 0; tick < 20000; tick++) {
      device.step([-stiffness * device.x[0], 0, 0]);
      if (tick < 200 || tick >= 19800) least.push(Math.abs(device.x[0]));
    }
    return Math.max(...least.slice(200)) < Math.max(...least.slice(0, 200));
  };
  await check(`a wall of 0.97 of the stated limit (${limit.toFixed(0)} N/m) settles, one of 1.03 does not`, () => {
    assert(settles(0.97 * limit), "it grows below");
    assert(!settles(1.03 * limit), "it settles above");
  });
  return limit;
}

async function checkWorld(core, meshes, limit) {
  for (const [name, scene] of Object.entries(SCENES))
    for (const law of [DPT_LAW_PROXY, DPT_LAW_BED, DPT_LAW_POINT])
      await check(`${name}, law ${law}: the tool touches, is pushed, and comes free`, () => {
        const touch = new touchWorld.TouchWorld(core, meshes[name], scene, { law, stiffness: 500 });
        const { sag = 0 } = scene;
        let [most, early] = [0, 0]; // early: felt by what is so light before the next step tells that it touches
        assert(touch.step().contact === dynpoint.constants.DPT_CONTACT_SEPARATED, "it begins in contact");
        for (let tick = 0; tick < 700; tick++) {
          touch.device.want([0, -0.01 - sag, 0]);
          const { force, depth, contact } = touch.step();
          most = Math.max(most, force);
          if (contact === 1) assert((sag ? early : force) < 1e-3, `${force} N without contact`);
          if (contact === 1 && !sag) assert(depth < 1e-5, `${depth} m without contact`);
          early = contact === 1 ? force : 0;
          if (law === DPT_LAW_PROXY) near(depth, force / 500, 1e-12);
        }
        assert(most > 0.1 && most < 40, `${most} N`);
        let last;
        touch.device.want([0, touch.half[1] + 0.05, 0]);
        for (let tick = 0; tick < 1500; tick++) last = touch.step();
        assert(last.force === 0 && last.contact === 1, `${last.force} N, contact ${last.contact}`);
        touch.close();
      });
  await check("the force against a torus settles at the slider's end, and is the spring's", () => {
    const stiffness = limit / 1.5;
    const touch = new touchWorld.TouchWorld(core, meshes.torus, SCENES.torus, { law: DPT_LAW_PROXY, stiffness });
    const finger = [0, touch.half[1] - 0.03, 0];
    const forces = [];
    touch.device.want(finger);
    for (let tick = 0; tick < 3000; tick++) forces.push(touch.step().force);
    const late = forces.slice(-500);
    near(Math.max(...late) - Math.min(...late), 0, 1e-3, "a buzz of");
    near(Math.hypot(...touch.device.finger.map((value, k) => GRIP * (value - touch.device.x[k]))), forces[2999], 0.01);
    touch.close();
  });
  for (const [name, scene] of Object.entries(SCENES).filter(([, { springs }]) => springs)) {
    const stiffness = Math.min(scene.stiffest.proxy ?? Infinity, limit / 1.5);
    const { sag = 0 } = scene;
    const [deepest, least] = [-0.05 - sag, sag ? 0.25 : 1];
    await check(`${name} stays calm at its slider's end, ${stiffness} N/m: slowly pressed and led along`, () => {
      const choices = { law: DPT_LAW_PROXY, stiffness };
      const touch = new touchWorld.TouchWorld(core, meshes[name], scene, choices);
      let [turned, turnedAt, jump, most] = [0, -Infinity, 0, 0]; // turned: again within 20 ms; once is slipping off an edge
      let last = [0, 0, 0];
      for (let tick = 0; tick < 6000; tick++) {
        const down = Math.max(deepest, 0.01 - 5e-5 * tick);
        touch.device.want([0.04 * Math.sin(1e-3 * tick), touch.half[1] + down, 0.01]);
        const { force } = touch.step();
        const cosine = touch.force.reduce((sum, value, k) => sum + value * last[k], 0) / (force * Math.hypot(...last));
        if (cosine < Math.cos(Math.PI / 6)) {
          if (tick - turnedAt < 20) turned++;
          turnedAt = tick;
        }
        jump = Math.max(jump, Math.hypot(...touch.force.map((value, k) => value - last[k])));
        most = Math.max(most, force);
        last = touch.force;
      }
      assert(most > least && turned === 0 && jump < 1, `${most} N, ${turned} ticks turned it, largest step ${jump} N`);
      touch.close();
    });
  }
  await check("a world that cannot be leaves nothing behind: a mesh that is none", () => {
    const used = core.heap.used.size;
    assert.throws(
      () => new touchWorld.TouchWorld(core, meshes.torus.slice(0, 5000), SCENES.torus, { law: 2, stiffness: 500 }),
      /DPT_|byte/,
    );
    assert.throws(
      () => new touchWorld.TouchWorld(core, meshes.torus, SCENES.torus, { law: 9, stiffness: 500 }),
      dynpoint.DynpointError,
    );
    assert.strictEqual(core.heap.used.size, used);
  });
}

// A loop whose clock is a number, and whose ticks take `cost` ms of it.
function simulated(core, mesh, scene, cost = 0) {
  const touch = new touchWorld.TouchWorld(core, mesh, scene, { law: DPT_LAW_PROXY, stiffness: 500 });
  const clock = { now: 0 };
  const heard = { frames: [], reports: [], sends: [] };
  const step = touch.step.bind(touch);
  touch.step = () => {
    clock.now += cost;
    return step();
  };
  const loop = new touchLoop.TouchLoop(touch, {
    now: () => clock.now,
    send: bytes => {
      heard.frames.push(messageReader.readMessage(bytes));
      heard.sends.push(clock.now);
    },
    tell: report => heard.reports.push(report),
  });
  // drawn: whether the page answers each frame
  const run = (ms, drawn = true) => {
    for (const end = clock.now + ms; clock.now < end; clock.now += 4) {
      const before = heard.frames.length;
      loop.beat();
      if (drawn && heard.frames.length > before) loop.hear("drawn");
    }
  };
  loop.hear("ready");
  return { touch, loop, clock, heard, run };
}

async function checkLoop(core, meshes) {
  const begin = (cost, name = "torus") => simulated(core, meshes[name], SCENES[name], cost);
  await check("1,000 ticks a second of the clock, all of them in frames, once each and in order", () => {
    const { touch, loop, heard, run } = begin();
    run(5000);
    near(touch.ticks, 5000, 5);
    near(heard.reports.at(-1).rate, 1000, 10);
    const times = heard.frames.flatMap(({ ticks }) => ticks.map(({ time }) => Math.round(1000 * time)));
    assert(times.length > 4900 && times.every((time, i) => time === i + 1), "ticks are missing, or twice there");
    near(heard.frames.length, 300, 15);
    assert.strictEqual(loop.lost, 0);
    touch.close();
  });
  await check("after a stall of 500 ms it catches up 30 ms, and counts the rest as lost", () => {
    const { touch, loop, clock, run } = begin();
    run(1000);
    const before = touch.ticks;
    clock.now += 500;
    loop.beat();
    near(touch.ticks - before, 30, 5);
    near(loop.lost, 470, 6);
    run(1000);
    near(loop.lost, 470, 6);
    touch.close();
  });
  await check("ticks that take 2 ms are 500 a second: it says so, and goes on answering", () => {
    const { touch, heard, run } = begin(2);
    run(6000);
    near(heard.reports.at(-1).rate, 470, 40);
    near(heard.reports.at(-1).micros, 2000, 1);
    near(heard.frames.at(-1).tickP99, 0.002, 1e-4);
    assert(heard.frames.length > 100, `${heard.frames.length} frames`);
    touch.close();
  });
  await check(
    "two frames at most are on their way, at most 60 a second are sent, and none before the scene was read",
    () => {
      const { touch, loop, heard, run } = begin();
      run(1000, false);
      assert.strictEqual(heard.frames.length, 2);
      loop.hear("drawn");
      run(100, false);
      assert.strictEqual(heard.frames.length, 3);
      assert(heard.frames[2].ticks.length > 900 && heard.frames[2].dropped > 40, "ticks were not kept");
      run(3000);
      heard.sends.forEach((at, i) => assert(i < 60 || at - heard.sends[i - 60] > 930, "too many frames"));
      const other = simulated(core, meshes.torus, SCENES.torus);
      other.loop.away = 2;
      other.run(500);
      assert.strictEqual(other.heard.frames.length, 0);
      touch.close();
      other.touch.close();
    },
  );
  await check("after a pause it goes on as if no time had passed", () => {
    const { touch, loop, clock, run } = begin();
    run(1000);
    const before = touch.ticks;
    clock.now += 60000;
    loop.resume();
    loop.beat();
    assert(touch.ticks - before <= 4 && loop.lost === 0, `${touch.ticks - before} ticks, ${loop.lost} lost`);
    touch.close();
  });
  await check("a finger of its own presses until somebody comes, and then never more", () => {
    const { touch, loop, heard, run } = begin(0, "liver");
    loop.idle = touchLoop.idleOver(touch.half);
    run(7000);
    const felt = heard.frames.flatMap(({ ticks }) => ticks.map(({ force }) => force));
    assert(felt.some(force => force > 0.5) && felt.some(force => force === 0), "it does not press and lift");
    loop.hear("hand 0.01 0.2 0");
    run(3000);
    near(touch.device.x, [0.01, Math.min(0.2, touch.device.box[4]), 0], 1e-4);
    touch.close();
  });
  await check("turns and steps of the force are those of the last 1,000 ticks", () => {
    const { touch, heard, run } = begin();
    let tick = 0;
    touch.step = () => {
      tick++;
      touch.ticks = tick;
      touch.force = tick >= 3000 ? [0, 2, 0] : tick % 100 === 0 ? [3, 0, 0] : [0, 2, 0];
      return { time: tick / 1000, force: 2, depth: 0, energy: 0, contact: 3, reason: 0 };
    };
    run(2000);
    near(heard.reports.at(-1).turned, 20, 0);
    near(heard.reports.at(-1).jump, Math.hypot(3, 2), 1e-6);
    run(3000);
    near([heard.reports.at(-1).turned, heard.reports.at(-1).jump], [0, 0], 0);
    touch.world.close();
    touch.mesh.close();
  });
  await check("vertices of what gives way are in frames while they move, and not long after", () => {
    const { touch, loop, heard, run } = begin(0, "membrane");
    const has = frame => frame.snapshot.vertices.length > 0;
    loop.hear(`hand 0 ${-0.03} 0`);
    run(1500);
    assert(heard.frames.slice(-30).every(has), "they are missing while they move");
    loop.hear("hand 0 0.07 0");
    run(12000);
    const late = heard.frames.slice(-120).filter(has).length;
    assert(late >= 1 && late <= 3, `${late} of 120 frames at rest`);
    touch.close();
  });
}

async function checkMessages(core, meshes) {
  const { touchMessages } = scripts("touch_messages");
  await check("the viewer reads the scene that it writes: mesh, body, title of any letters", () => {
    const scene = { ...SCENES.liver, title: '\u00dc "<b>" \u{1fac0}' };
    const touch = new touchWorld.TouchWorld(core, meshes.liver, scene, { law: 2, stiffness: 500 });
    const read = messageReader.readMessage(touchMessages.scene(touch, { program: "p", device: null }));
    assert.strictEqual(read.title, scene.title);
    assert.deepStrictEqual([read.mode, read.control, read.up, read.program], ["live", true, "y", "p"]);
    const [mesh] = read.meshes;
    const { corners, numbers } = touch.mesh.getTriangles();
    assert.deepStrictEqual([mesh.triangles, mesh.vertices], [10000, 5002]);
    assert(Buffer.from(touch.mesh.getVertices().buffer).equals(Buffer.from(mesh.positions.slice().buffer)));
    assert(Buffer.from(corners.buffer).equals(Buffer.from(mesh.corners.slice().buffer)));
    assert(Buffer.from(numbers.buffer).equals(Buffer.from(mesh.sources.slice().buffer)));
    const middle = [0, 1, 2].map(k => {
      const all = mesh.positions.filter((_, i) => i % 3 === k);
      return read.bodies[0].pose[k] + 0.5 * (Math.min(...all) + Math.max(...all));
    });
    near(middle, [0, 0, 0], 1e-7, "the middle is at");
    touch.close();
  });
  await check("and its frames: every field of the header and of a tick", () => {
    const touch = new touchWorld.TouchWorld(core, meshes.torus, SCENES.torus, { law: 2, stiffness: 500 });
    touch.step();
    const counts = {
      number: 7,
      dropped: 8,
      lost: 2 ** 40,
      hapticRate: 1,
      physicsRate: 2,
      viewRate: 3,
      lateP99: 4,
      tookP99: 5,
    };
    const tick = { time: 0.125, force: 1.5, depth: 0.25, energy: 0.5, late: 0.75, took: 2, contact: 3, reason: 4 };
    const read = messageReader.readMessage(touchMessages.frame(touch.snapshot(), [tick, { ...tick, time: 1 }], counts));
    // Nothing here has jaws.
    const shut = { ...tick, opening: 0 };
    assert.deepStrictEqual(read.ticks, [shut, { ...shut, time: 1 }]);
    const { number, dropped, ticksLost, hapticRate, physicsRate, viewRate, lateP99, tickP99 } = read;
    assert.deepStrictEqual(
      [number, dropped, ticksLost, hapticRate, physicsRate, viewRate, lateP99, tickP99],
      [7, 8, 2 ** 40, 1, 2, 3, 4, 5],
    );
    assert.deepStrictEqual([read.snapshot.steps, read.snapshot.tools.length], [1, 1]);
    touch.close();
  });
}

// The worker itself, with a clock that does not run, and a core that comes when `openCore` lets it.
function workerOf(openCore) {
  const folder = path.join(__dirname, "../../tools/page");
  const names = ["held_device", "touch_world", "touch_messages", "touch_loop", "compile_job", "touch_worker"];
  const text = names.map(name => fs.readFileSync(path.join(folder, `${name}.js`), "utf8")).join("\n");
  const [sent, timers] = [[], new Set()];
  const begin = new Function(
    "dynpoint",
    "postMessage",
    "setInterval",
    "clearInterval",
    `let onmessage; ${text}\nreturn data => onmessage({ data });`,
  );
  const set = work => (timers.add(work), work);
  const post = begin({ ...dynpoint, openCore }, message => sent.push(message), set, work => timers.delete(work));
  return { post, sent, timers };
}

async function checkWorker(meshes) {
  const early = async (...messages) => {
    let open;
    const worker = workerOf(bytes => new Promise(done => (open = () => done(dynpoint.openCore(bytes)))));
    worker.post({ kind: "core", bytes: modules().core });
    for (const message of messages) worker.post(message);
    open();
    for (let i = 0; i < 1000 && !worker.sent.some(({ kind }) => kind === "ready"); i++)
      await new Promise(done => setTimeout(done, 10));
    return { ...worker, kinds: worker.sent.map(one => one.kind ?? messageReader.readMessage(one).kind) };
  };
  const scene = {
    kind: "scene",
    file: meshes.torus,
    scene: SCENES.torus,
    choices: { law: "proxy", stiffness: 500 },
    idles: true,
  };
  await check("a scene that is compiled before the core is there is shown when it is", async () => {
    const { kinds, timers } = await early(scene);
    assert.deepStrictEqual([kinds, timers.size], [["ready", "scene"], 1]);
  });
  await check("a page that is hidden before the core is there takes no tick until it is seen", async () => {
    const { kinds, timers, post } = await early({ kind: "pause", paused: true }, scene);
    assert.deepStrictEqual([kinds, timers.size], [["ready", "scene"], 0]);
    post({ kind: "pause", paused: false });
    assert.strictEqual(timers.size, 1);
  });
}

async function checkCompile(meshes) {
  await check("a mesh of any size is scaled to 200 mm, whatever its unit", async () => {
    const source = new TextEncoder().encode(
      "v 0 0 0\nv 4000 0 0\nv 0 1000 0\nv 0 0 2000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    );
    const { file, sides, scale } = await compileJob.run(dynpoint, { ...modules(), source, fits: true });
    assert.deepStrictEqual(sides, [4000, 1000, 2000]);
    near(scale, 0.2 / 4000, 1e-12);
    const { info } = (await dynpoint.openCore(modules().core)).openMesh(file);
    near(info.boxMax, [0.2, 0.05, 0.1], 1e-7);
  });
  const refused = async (source, words) => {
    const got = await compileJob.run(dynpoint, { ...modules(), source, fits: true });
    assert.match(got.refused ?? "it was compiled", words);
  };
  await check("what is malformed is refused with its line, its byte or its reason", async () => {
    const text = words => new TextEncoder().encode(words);
    await refused(text("v 0 0 0\nv 1 0 0\nv 0 one 0\nf 1 2 3\n"), /^line 3: /);
    await refused(shape("torus", 32).slice(0, 300), /^byte \d+: /);
    await refused(text("hello"), /./);
    await refused(new Uint8Array(0), /./);
    await refused(text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n"), /no triangle/);
  });
  await check("what needs more memory than there is says so, as no trap of WebAssembly does", async () => {
    const got = await compileJob.run(
      {
        openCompiler: async () => ({
          compile() {
            throw new WebAssembly.RuntimeError("unreachable");
          },
        }),
      },
      { ...modules(), source: new Uint8Array(8) },
    );
    assert.match(got.refused, /more memory/);
  });
  await check("the page's compiler makes the bytes that the program makes", () => {
    const file = path.join(room, "torus.dpa");
    shape("torus", SCENES.torus.triangles);
    execFileSync(program, ["compile", path.join(room, "torus.ply"), "-o", file]);
    assert(fs.readFileSync(file).equals(Buffer.from(meshes.torus)), "other bytes");
  });
}

(async () => {
  const core = await dynpoint.openCore(modules().core);
  const meshes = {};
  for (const [name, { shape: kind, triangles, springs }] of Object.entries(SCENES)) {
    const job = { ...modules(), source: shape(kind, triangles), options: springs ? { springs } : {} };
    const { file, refused } = await compileJob.run(dynpoint, job);
    if (refused) throw new Error(`${name}: ${refused}`);
    meshes[name] = file;
  }
  const limit = await checkHand(core);
  await checkWorld(core, meshes, limit);
  await checkLoop(core, meshes);
  await checkMessages(core, meshes);
  await checkWorker(meshes);
  await checkCompile(meshes);
  finish();
})();
