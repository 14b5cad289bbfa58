// SPDX-License-Identifier: BSD-3-Clause
// node package.js ROOM: the package as it is installed in ROOM/node_modules: what is in it, how node loads it, its samples.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync } = require("child_process");
const { Worker } = require("worker_threads");
const { check, near, assert, finish } = require("../view/verdicts.js");
const room = path.resolve(process.argv[2]);
const place = path.join(room, "node_modules/dynpoint");
const FILES =
  `LICENSE NOTICE README.md browser.mjs dynpoint.js dynpoint.wasm dynpoint_compile.wasm index.d.mts index.d.ts node.js
  node.mjs package.json samples/loop_worker.mjs samples/touch.mjs`.split(/\s+/);
const PATIENCE = 60000; // ms

const run = (name, text) => {
  const file = path.join(room, name);
  fs.writeFileSync(file, text);
  return execFileSync(process.execPath, [file], { encoding: "utf8", timeout: PATIENCE });
};
const filesIn = (folder, under = "") =>
  fs.readdirSync(folder, { withFileTypes: true }).flatMap(entry => {
    const name = under + entry.name;
    return entry.isDirectory() ? filesIn(path.join(folder, entry.name), `${name}/`) : name;
  });
const BOX = fs
  .readFileSync(path.join(place, "samples/touch.mjs"), "utf8")
  .match(/`(v [^`]*)`/)[1]
  .replace(/\\n/g, "\n");

// What a worker of the sample tells until it ends; `at` is asked at each of its messages for what to tell it.
function talk(file, at) {
  return new Promise((resolve, reject) => {
    const heard = [];
    const worker = new Worker(file);
    const timer = setTimeout(() => reject(new Error("it does not end")), PATIENCE);
    worker.on("message", message => {
      heard.push(message);
      const answer = at(message);
      if (answer) worker.postMessage(answer);
    });
    worker.on("error", reject);
    worker.on("exit", () => {
      clearTimeout(timer);
      worker.terminate();
      resolve(heard);
    });
  });
}

(async () => {
  await check("the package has these files", () => assert.deepStrictEqual(filesIn(place).sort(), FILES));
  await check("its version is the library's", () => {
    const header = fs.readFileSync(path.join(__dirname, "../../include/dynpoint/base.h"), "utf8");
    const wanted = header.match(/DPT_VERSION_STRING "(.*)"/)[1];
    assert.strictEqual(JSON.parse(fs.readFileSync(path.join(place, "package.json"), "utf8")).version, wanted);
  });
  await check("ES modules and CommonJS load it, and share their objects", () => {
    const names = "Loop,Pace,DynpointError,constants,layouts,openCompiler,openCore".split(",").sort().join();
    const both = `import all, * as named from "dynpoint"; import { createRequire } from "module";
      const required = createRequire(import.meta.url)("dynpoint");
      const core = await named.openCore();
      const names = object => Object.keys(object).filter(name => name !== "default").sort().join();
      let code = ""; try { core.createWorld({ maxTools: 0 }); } catch (error) {
        code = error instanceof required.DynpointError && error instanceof named.DynpointError && error.code; }
      console.log([names(named), names(all), names(required), core.version, code].join(" "));`;
    const version = JSON.parse(fs.readFileSync(path.join(place, "package.json"), "utf8")).version;
    assert.strictEqual(run("both.mjs", both).trim(), `${names} ${names} ${names} ${version} DPT_E_ARGUMENT`);
    const required = `const { openCore, openCompiler } = require("dynpoint");
      Promise.all([openCore(), openCompiler()]).then(([core, compiler]) => console.log(core.version, compiler.version));`;
    assert.strictEqual(run("required.cjs", required).trim(), `${version} ${version}`);
  });
  await check("what exports does not name is not there", () => {
    const asked = 'import("dynpoint/node.js").catch(error => console.log(error.code));';
    assert.strictEqual(run("asked.mjs", asked).trim(), "ERR_PACKAGE_PATH_NOT_EXPORTED");
  });
  await check("a module may be compiled once, and opened in each thread", async () => {
    const { openCore } = require(place);
    const module = new WebAssembly.Module(fs.readFileSync(path.join(place, "dynpoint.wasm")));
    const [one, other] = await Promise.all([openCore(module), openCore(module)]);
    assert(one.exports.memory !== other.exports.memory && one.version === other.version, "not two cores");
  });
  await check("samples/touch.mjs: free above the box, then a spring of 500 N/m", () => {
    const lines = run("touch.mjs", fs.readFileSync(path.join(place, "samples/touch.mjs"), "utf8"))
      .trim()
      .split("\n");
    assert.strictEqual(lines.length, 21);
    lines.forEach((line, tick) => {
      const [height, gap, force] = line.match(/-?\d+\.\d+/g).map(Number);
      near([height, gap], [0.06 - 0.0005 * tick, Math.max(0, 8 - 0.5 * tick)], 1e-6, line);
      near(force, tick <= 16 ? 0 : 0.25 * (tick - 16), 0.005, line);
      if (tick !== 16) assert(line.includes(tick < 16 ? "is free" : "touches"), line);
    });
  });
  await check("the README's block, above a box of 0.1 m in mm", () => {
    const [, block] = fs.readFileSync(path.join(place, "README.md"), "utf8").match(/```js\n([^]*?)```/);
    const box = JSON.stringify(BOX.replace(/\.05/g, "50"));
    const frame = `const [x, y, z, bytesOfStl] = [0, 0.06, 0, new TextEncoder().encode(${box})];\n`;
    near(run("readme.mjs", frame + block).match(/-?\d+\.?\d*/g).map(Number), [0.01, 0, 0, 0], 1e-6);
  });
  const sample = path.join(room, "loop_worker.mjs");
  fs.copyFileSync(path.join(place, "samples/loop_worker.mjs"), sample);
  const file = new TextEncoder().encode(BOX);
  const POSE = [0, 0.049, 0, 1, 0, 0, 0]; // 3 mm in
  for (const wait of ["sleep", "turn", "timer"])
    await check(
      `samples/loop_worker.mjs in a worker that waits by ${wait}: it feels what it is told, and ends`,
      async () => {
        let forces = 0;
        const heard = await talk(sample, message => {
          if (message.ready) return { file, pose: [0, 0.1, 0, 1, 0, 0, 0], options: { wait } };
          if (message.force && ++forces === 2) return { pose: POSE };
          return message.force && message.force[1] > 1.4 ? { stop: true } : null;
        });
        const { info } = heard.at(-1);
        assert(info, JSON.stringify(heard.at(-1)));
        assert(info.wait === wait && info.ticks > 32, `${info.ticks} ticks`);
        assert(
          heard.some(({ force }) => force && Math.hypot(...force) === 0),
          "it felt the box from afar",
        );
        const numbers = heard.filter(({ force }) => force).map(({ number }) => number);
        assert(
          numbers.every((number, k) => number === 16 * k),
          `told ${numbers}`,
        );
      },
    );
  await check("what is wrong in a tick ends the loop, and is told", async () => {
    const heard = await talk(sample, ({ ready, force }) => {
      if (ready) return { file, pose: POSE };
      return force ? { pose: [0, NaN, 0, 1, 0, 0, 0] } : null;
    });
    assert.match(heard.at(-1).error, /pose|finite|number/);
    const told = await talk(sample, ({ ready }) => (ready ? { file: file.subarray(0, 40), pose: POSE } : null));
    assert.match(told.at(-1).error, /line \d+: /);
  });
  finish();
})();
