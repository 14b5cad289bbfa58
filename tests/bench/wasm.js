// SPDX-License-Identifier: BSD-3-Clause
// node wasm.js BUILD ROOM: a tick native and in WebAssembly under node, in turns, on the same traces. A CSV: mesh, triangles,
// law, kernel, us a tick, and the ratio to the native scalar kernel. The least of the turns counts, each of some passes.
"use strict";
const fs = require("fs");
const path = require("path");
const { execFileSync, spawnSync } = require("child_process");
const { rowsOf, time } = require("../wasm/layer_answers.js");
const [build, room] = process.argv.slice(2).map(name => path.resolve(name));
const dynpoint = require(path.resolve("build/wasm/dynpoint.js"));
const C = dynpoint.constants;
const TURNS = 3;
const PASSES = 3;
const TICKS = 8000;
const SCENES = [
  { name: "liver-8000", make: ["liver", "8000"] },
  { name: "liver-50332", make: ["liver", "50332"] },
  { name: "torus-61358", make: ["torus", "61358"] },
  { name: "soft-liver-8000", make: ["liver", "8000"], words: ["--springs", "volume", "--spacing", "0.008"] },
];
const LAWS = ["POINT", "BED", "PROXY"];
const NATIVE = ["SCALAR", "SSE2", "AVX2", "AVX512", "NEON"];

const run = (...words) => execFileSync(path.join(build, "dynpoint"), words, { cwd: room, stdio: "ignore" });

// us, or Infinity where this machine does not have the kernel
function native(scene, law, kernel) {
  const files = [`${scene.name}.dpa`, `${scene.name}.csv`].map(name => path.join(room, name));
  const program = path.join(build, "tests/wasm/native_answers");
  const { status, stderr } = spawnSync(program, [...files, `${law}`, `${kernel}`, `${PASSES}`], { encoding: "utf8" });
  return status === 0 ? Number(stderr.trim().split(" ").pop()) : Infinity;
}

(async () => {
  const core = await dynpoint.openCore(fs.readFileSync("build/wasm/dynpoint.wasm"));
  console.log("mesh,triangles,law,kernel,us_a_tick,to_native_scalar");
  for (const scene of SCENES) {
    run("make", ...scene.make, "-o", `${scene.name}.stl`);
    run("compile", `${scene.name}.stl`, "-o", `${scene.name}.dpa`, ...(scene.words ?? []));
    run("make", "trace", "--mesh", `${scene.name}.dpa`, "--ticks", `${TICKS}`, "--seed", "1", "-o", `${scene.name}.csv`);
    const mesh = core.openMesh(fs.readFileSync(path.join(room, `${scene.name}.dpa`)));
    const rows = rowsOf(fs.readFileSync(path.join(room, `${scene.name}.csv`), "utf8"));
    for (const name of LAWS) {
      const law = C[`DPT_LAW_${name}`];
      const least = {};
      const note = (kernel, us) => (least[kernel] = Math.min(least[kernel] ?? Infinity, us));
      for (let turn = 0; turn < TURNS; turn++) {
        for (const kernel of NATIVE) note(`native ${kernel.toLowerCase()}`, native(scene, law, C[`DPT_KERNEL_${kernel}`]));
        for (const kernel of ["SCALAR", "WASM128"])
          note(`wasm ${kernel.toLowerCase()}`, time(core, mesh, rows, law, C[`DPT_KERNEL_${kernel}`], PASSES));
      }
      for (const [kernel, us] of Object.entries(least))
        if (us < Infinity)
          console.log([scene.name, mesh.info.triangles, name.toLowerCase(), kernel, us.toFixed(2), (us / least["native scalar"]).toFixed(2)].join());
    }
    mesh.close();
  }
})();
