// SPDX-License-Identifier: BSD-3-Clause
// node browser.js ROOM: the package in a headless Chromium, served from ROOM/node_modules: the module for browsers, and the
// loop of samples/loop_worker.mjs in a worker, in a page that is isolated (its workers may sleep) and in one that is not.
"use strict";
const fs = require("fs");
const path = require("path");
const { check, near, assert, finish } = require("../view/verdicts.js");
const { launch } = require("../view/chromium.js");
const { serve } = require("./server.js");
const room = path.resolve(process.argv[2]);
const place = path.join(room, "node_modules/dynpoint");
const BOX = fs
  .readFileSync(path.join(place, "samples/touch.mjs"), "utf8")
  .match(/`(v [^`]*)`/)[1]
  .replace(/\\n/g, "\n");

// In the page: force of a tool that is `depth` m in the box.
async function touch(box, depth) {
  const { openCore, openCompiler } = await import("/browser.mjs");
  const [core, compiler] = await Promise.all([openCore(), openCompiler()]);
  const world = core.createWorld({ stiffness: 500 });
  world.addBody(core.openMesh(compiler.compile(new TextEncoder().encode(box))));
  const tool = world.addTool([[-0.02, 0, 0, 0.02, 0, 0, 0.002]]);
  for (const height of [0.1, 0.052 - depth]) {
    world.setToolPose(tool, [0, height, 0, 1, 0, 0, 0]);
    world.step(0.001);
  }
  return [core.version, world.kernel, ...world.getWrench(tool).force];
}

// In the page: what a worker tells until it ends, after it felt the box from afar and then within.
function feel(box, wait) {
  return new Promise((resolve, reject) => {
    const worker = new Worker("/samples/loop_worker.mjs", { type: "module" });
    const heard = { far: 0, near: 0 };
    worker.onerror = ({ message }) => reject(new Error(`the worker: ${message}`));
    worker.onmessage = ({ data: { ready, force, info, error } }) => {
      if (ready)
        worker.postMessage({ file: new TextEncoder().encode(box), pose: [0, 0.1, 0, 1, 0, 0, 0], options: { wait } });
      if (error) reject(new Error(error));
      if (info) resolve({ ...heard, info });
      if (!force) return;
      if (Math.hypot(...force) === 0) heard.far++;
      else heard.near = force[1];
      if (heard.far === 2) worker.postMessage({ pose: [0, 0.049, 0, 1, 0, 0, 0] });
      if (heard.near > 1.4) worker.postMessage({ stop: true });
    };
  });
}

(async () => {
  const browser = launch(room);
  for (const isolated of [true, false]) {
    const server = await serve(place, isolated);
    fs.writeFileSync(
      path.join(place, "index.html"),
      "<!doctype html><title>dynpoint</title><link rel='icon' href='data:,'>",
    );
    const view = await browser.visit(`${server.url}/index.html`);
    const kind = isolated ? "isolated" : "plain";
    await check(`a page that is ${kind}: the module opens its own files, and feels 3 mm of 500 N/m`, async () => {
      const [version, kernel, ...force] = await view.call(touch, BOX, 0.003);
      assert.strictEqual(version, JSON.parse(fs.readFileSync(path.join(place, "package.json"), "utf8")).version);
      assert.strictEqual(kernel, "wasm128");
      near(force, [0, 1.5, 0], 1e-3);
    });
    for (const wait of [undefined, "turn", "timer"])
      await check(`a page that is ${kind}: a loop in a worker, wait: ${wait ?? "its own choice"}`, async () => {
        const { far, info } = await view.call(feel, BOX, wait);
        assert.strictEqual(info.wait, wait ?? (isolated ? "sleep" : "turn"));
        assert(far >= 2 && info.ticks > 32 && info.late.most >= 0, JSON.stringify(info));
      });
    await check(`a page that is ${kind}: the page's own thread may not sleep, and says so`, async () => {
      const said = await view.ask(`import("/browser.mjs").then(({ Loop }) => {
        try { new Loop(() => {}, { wait: "sleep" }); return ""; } catch (error) { return error.message; } })`);
      assert.match(said, /cannot sleep/);
    });
    await check(`a page that is ${kind}: where the modules are missing, an Error names them`, async () => {
      for (const name of ["dynpoint", "dynpoint_compile"])
        fs.renameSync(path.join(place, `${name}.wasm`), path.join(place, `${name}.away`));
      const said = await view.ask(`import("/browser.mjs").then(({ openCore, openCompiler }) =>
        Promise.allSettled([openCore(), openCompiler()])).then(all => all.map(({ reason }) => reason?.message).join("; "))`);
      for (const name of ["dynpoint", "dynpoint_compile"])
        fs.renameSync(path.join(place, `${name}.away`), path.join(place, `${name}.wasm`));
      const told = name => `${server.url}/${name}.wasm: 404 Not Found`;
      assert.strictEqual(said, `${told("dynpoint")}; ${told("dynpoint_compile")}`);
    });
    await check(`a page that is ${kind} complains of nothing else, and asks nobody else`, () => {
      assert.deepStrictEqual(
        view.said.filter(text => !text.includes("404")),
        [],
      );
      assert.deepStrictEqual(
        view.asked.filter(url => !url.startsWith(server.url)),
        [],
      );
    });
    await browser.leave(view);
    server.close();
  }
  await browser.close();
  finish();
})();
