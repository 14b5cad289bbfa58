// SPDX-License-Identifier: BSD-3-Clause
// node modules.js WASM BUILD ROOM: the modules and their layer under node: what they ask for and offer, files that they
// compile and refuse, answers along traces, all against the native program of BUILD; and the layer's own conduct.
"use strict";
const fs = require("fs");
const path = require("path");
const crypto = require("crypto");
const { execFileSync, spawnSync } = require("child_process");
const { check, assert, finish } = require("../view/verdicts.js");
const { rowsOf, answers } = require("./layer_answers.js");
const [wasm, build, room] = process.argv.slice(2).map(name => path.resolve(name));
const dynpoint = require(path.join(wasm, "dynpoint.js"));
const C = dynpoint.constants;
const program = path.join(build, "dynpoint");
const TRACE_TICKS = 1500;
const NEVER = 0xffffffff;

const inRoom = name => path.join(room, name);
const run = (...words) => execFileSync(program, words, { cwd: room, maxBuffer: 1 << 28, stdio: ["ignore", "pipe", "pipe"] });
const bytesOf = name => fs.readFileSync(path.join(wasm, name));
const same = (one, other) => Buffer.compare(Buffer.from(one), Buffer.from(other)) === 0;

function throwsCode(code, work) {
  assert.throws(work, error => error instanceof dynpoint.DynpointError && error.code === code);
}

async function modules() {
  await check("the modules ask their host for nothing", () => {
    for (const name of ["dynpoint.wasm", "dynpoint_compile.wasm"])
      assert.deepStrictEqual(WebAssembly.Module.imports(new WebAssembly.Module(bytesOf(name))), []);
  });
  await check("the core exports the C functions, all of them", () => {
    const wanted = fs.readFileSync(path.join(__dirname, "../abi/libdynpoint.symbols"), "utf8").trim().split("\n");
    const exports = WebAssembly.Module.exports(new WebAssembly.Module(bytesOf("dynpoint.wasm")));
    const got = exports.map(({ name }) => name).filter(name => name.startsWith("dpt_"));
    assert.deepStrictEqual(got.sort(), wanted.sort());
  });
}

// What the native program compiles of the same file, by these options of both.
const COMPILED = [
  { name: "torus.ply", make: ["torus", "5568"] },
  { name: "liver.obj", make: ["liver", "2000"], words: ["--scale", "0.7"], options: { scale: 0.7 } },
  { name: "open.stl", make: ["stomach", "2001"] },
  { name: "star.off", make: ["star", "2000"], words: ["--crease", "30"], options: { crease: Math.PI / 6 } },
  {
    name: "cloth.obj",
    make: ["cloth", "800"],
    words: ["--springs", "sheet", "--bending", "1000"],
    options: { springs: { kind: "sheet", bending: 1000 } },
  },
  {
    name: "soft.stl",
    make: ["liver", "2000"],
    words: ["--springs", "volume", "--spacing", "0.01", "--density", "900"],
    options: { springs: { kind: "volume", spacing: 0.01, density: 900 } },
  },
];

async function compiles(compiler) {
  for (const { name, make, words = [], options } of COMPILED)
    await check(`${name} compiles to the same bytes`, () => {
      run("make", ...make, "-o", name);
      run("compile", name, "-o", `${name}.dpa`, ...words);
      const file = compiler.compile(fs.readFileSync(inRoom(name)), options);
      assert(same(file, fs.readFileSync(inRoom(`${name}.dpa`))), "other bytes");
    });
  await check("arrays compile as their file does", () => {
    const [vertices, corners] = [[], []];
    for (const line of fs.readFileSync(inRoom("liver.obj"), "utf8").split("\n")) {
      const [word, ...rest] = line.split(" ");
      if (word === "v") vertices.push(...rest.map(Number));
      if (word === "f") corners.push(...rest.map(number => Number(number) - 1));
    }
    const file = compiler.compileArrays(Float64Array.from(vertices), Uint32Array.from(corners), { scale: 0.7 });
    const wanted = compiler.compile(fs.readFileSync(inRoom("liver.obj")), { scale: 0.7 });
    const [one, other] = [file, wanted].map(bytes => bytes.slice(4096));
    assert(file.length === wanted.length && same(one, other), "other bytes after the header");
  });
}

// Each file that the native program refuses is refused in the same words; each that it takes is taken.
async function refusals(compiler) {
  const folder = path.join(__dirname, "../golden-bad");
  const names = fs.readdirSync(folder).filter(name => /\.(obj|stl|ply|off)$/.test(name));
  let refused = 0;
  await check("malformed meshes are refused in the words of the native program", () => {
    for (const name of names) {
      const file = path.join(folder, name);
      const native = spawnSync(program, ["compile", file, "-o", inRoom("bad.dpa")], { encoding: "utf8" });
      const wanted = native.status === 0 ? "" : native.stderr.trim().split("\n").pop();
      let said = "";
      try {
        compiler.compile(fs.readFileSync(file), { format: name.split(".").pop() });
      } catch (error) {
        assert(error instanceof dynpoint.DynpointError, `${name}: ${error.message}`);
        said = `dynpoint compile: ${file}${error.message.replace(/^line (\d+)/, ":$1").replace(/^(?!:)/, ": ")}`;
      }
      assert(said === wanted, `"${said}", not "${wanted}"`);
      refused += said !== "";
    }
    assert(refused > 40, `${refused} of ${names.length} files were refused`);
  });
}

const SCENES = [
  { file: "torus.ply.dpa", laws: ["POINT", "BED", "PROXY"] },
  { file: "liver.obj.dpa", laws: ["POINT", "BED", "PROXY"] },
  { file: "open.stl.dpa", laws: ["PROXY"] },
  { file: "star.off.dpa", laws: ["BED", "PROXY"] },
  { file: "cloth.obj.dpa", laws: ["PROXY"] },
  { file: "soft.stl.dpa", laws: ["BED", "PROXY"] },
];

// Writes traces, and what the native library answers, for this page and for the browser.
async function answersAlike(core) {
  const wanted = {};
  for (const { file, laws } of SCENES) {
    const trace = `${file}.csv`;
    run("make", "trace", "--mesh", file, "--ticks", `${TRACE_TICKS}`, "--seed", "5", "-o", trace);
    const mesh = core.openMesh(fs.readFileSync(inRoom(file)));
    const rows = rowsOf(fs.readFileSync(inRoom(trace), "utf8"));
    for (const law of laws) {
      const number = C[`DPT_LAW_${law}`];
      const program = path.join(build, "tests/wasm/native_answers");
      const native = spawnSync(program, [inRoom(file), inRoom(trace), `${number}`, "1"], { maxBuffer: 1 << 28 });
      const hash = crypto.createHash("sha256").update(native.stdout).digest("hex");
      wanted[`${file} ${number}`] = hash;
      for (const kernel of [C.DPT_KERNEL_SCALAR, C.DPT_KERNEL_WASM128])
        await check(`${file}, ${law}: kernel ${kernel} gives the native library's bytes`, () => {
          assert(native.status === 0 && native.stdout.length > 300 * TRACE_TICKS, `native: ${native.stderr}`);
          const made = crypto.createHash("sha256");
          const name = answers(core, mesh, rows, number, kernel, bytes => made.update(bytes));
          assert(name === core.kernelName(kernel), name);
          assert(made.digest("hex") === hash, "other bytes");
        });
    }
    mesh.close();
  }
  fs.writeFileSync(inRoom("wanted.json"), JSON.stringify(wanted));
}

// The objects' fields against the columns of `dynpoint replay`, which another program writes.
async function objects(core) {
  await check("objects have the numbers of `dynpoint replay`", () => {
    run("replay", "liver.obj.dpa", "liver.obj.dpa.csv", "-o", "out.csv", "--law", "proxy", "--radius", "0.002");
    const [head, ...lines] = fs.readFileSync(inRoom("out.csv"), "utf8").trim().split("\n");
    const columns = head.split(",");
    const mesh = core.openMesh(fs.readFileSync(inRoom("liver.obj.dpa")));
    const world = core.createWorld({ maxContacts: 32 });
    const body = world.addBody(mesh);
    const tool = world.addTool([[0, 0, 0, 0, 0, 0.1, 0.002]]);
    let compared = 0;
    rowsOf(fs.readFileSync(inRoom("liver.obj.dpa.csv"), "utf8")).forEach(([, ...ends], row) => {
      world.setToolSegments(tool, [[...ends, 0.002]]);
      world.step(0.001);
      const hit = world.getHit(tool);
      const { force, torque } = world.getWrench(tool);
      const { energy } = world.getForceInfo(tool);
      const loads = world.getLoads(tool);
      const onBody = world.getBodyWrench(body);
      [0, 1, 2].forEach(k => {
        const sum = loads.reduce((all, load) => all + load.force[k], 0);
        assert(Math.abs(sum - force[k]) < 1e-9 && Math.abs(onBody.force[k] + force[k]) < 1e-9, `row ${row}: ${sum} N`);
      });
      const named = { ...hit, errorBound: undefined, error_bound: hit.errorBound, lower_bound: hit.lowerBound, energy };
      ["x", "y", "z"].forEach((axis, k) => {
        Object.assign(named, { [`p${axis}`]: hit.p[k], [`q${axis}`]: hit.q[k] });
        Object.assign(named, { [`f${axis}`]: force[k], [`t${axis}`]: torque[k] });
      });
      lines[row].split(",").forEach((cell, k) => {
        if (cell === "" || !Number.isFinite(Number(cell)) || !(columns[k] in named) || columns[k] === "contact") return;
        assert(Number(cell) === named[columns[k]], `row ${row}, ${columns[k]}: ${named[columns[k]]}, not ${cell}`);
        compared++;
      });
    });
    assert(compared > 15 * TRACE_TICKS, `${compared} numbers were compared`);
    world.close();
    mesh.close();
  });
}

async function conduct(core, compiler) {
  const file = fs.readFileSync(inRoom("soft.stl.dpa"));
  const idle = () => core.heap.used.size;
  const before = idle();
  await check("what fails throws its code, and takes no memory", () => {
    throwsCode("DPT_E_TRUNCATED", () => core.openMesh(file.subarray(0, 9000)));
    throwsCode("DPT_E_ARGUMENT", () => core.createWorld({ maxTools: 0 }));
    assert.throws(() => core.createWorld({ maxTool: 1 }), /dpt_world_def has no field maxTool/);
    assert.throws(() => core.createWorld({ maxTools: [1, 2] }), TypeError);
    const world = core.createWorld();
    throwsCode("DPT_E_HANDLE", () => world.getHit(1));
    throwsCode("DPT_E_HANDLE", () => world.addSprings(7));
    throwsCode("DPT_E_HANDLE", () => world.setBodyPose(0, [0, 0, 0, 1, 0, 0, 0]));
    const mesh = core.openMesh(file);
    throwsCode("DPT_E_POSE", () => world.addBody(mesh, [0, 0, 0, 2, 0, 0, 0]));
    throwsCode("DPT_E_POSE", () => world.addDeform(mesh, {}, [0, 0, 0, 2, 0, 0, 0]));
    assert.throws(() => world.addDeform(mesh, { maxPoint: 1 }), TypeError);
    assert.throws(() => world.addBody(mesh, [0, 0, 0]), /a pose is 7 numbers/);
    assert.throws(() => world.addTool([[0, 0, 0]]), /a segment is 7 numbers/);
    world.close();
    mesh.close();
    assert(idle() === before, `${idle()} blocks, not ${before}`);
    assert.throws(() => compiler.compile(file, { format: "step" }), /no format step/);
    assert.throws(() => compiler.compile(file, { springs: { kind: "bar" } }), /sheet/);
    throwsCode("DPT_E_FORMAT", () => compiler.compile(Buffer.from("hello")));
  });
  await check("a mesh stays open while a world uses it, and a removed body lets it go", () => {
    const mesh = core.openMesh(file);
    const world = core.createWorld();
    const body = world.addDeform(mesh);
    world.addSprings(body);
    throwsCode("DPT_E_ARGUMENT", () => mesh.close());
    throwsCode("DPT_E_ARGUMENT", () => world.addSprings(body));
    world.removeBody(body);
    throwsCode("DPT_E_HANDLE", () => world.stepSprings(body, 0.001));
    mesh.close();
    world.close();
    assert(idle() === before, `${idle()} blocks, not ${before}`);
  });
  await check("a thousand worlds take no more memory than one", () => {
    const mesh = core.openMesh(file);
    let size = 0;
    for (let k = 0; k < 1000; k++) {
      const world = core.createWorld({ certificateBytes: 65536 * (1 + (k % 7)) });
      world.addBody(mesh);
      if (k === 20) size = core.memory.memory.buffer.byteLength;
      world.close();
    }
    mesh.close();
    assert(core.memory.memory.buffer.byteLength === size, "the memory has grown");
    assert.deepStrictEqual(core.heap.free, []);
  });
  await check("settings change one field and leave the others", () => {
    const mesh = core.openMesh(file);
    const world = core.createWorld({ stiffness: 321 });
    const [body, tool] = [world.addBody(mesh), world.addTool([[0, 0, 0, 0, 0, 0.1, 0.002]])];
    world.setToolSettings(tool, { law: C.DPT_LAW_BED, damping: 2 });
    const { law, damping, stiffness } = world.getToolSettings(tool);
    assert.deepStrictEqual([law, damping, stiffness], [C.DPT_LAW_BED, 2, 321]);
    world.setBodySettings(body, { staticFriction: 0.5, kineticFriction: 0.4 });
    world.setBodySettings(body, { kineticFriction: 0.3 });
    const { staticFriction, kineticFriction } = world.getBodySettings(body);
    assert.deepStrictEqual([staticFriction, kineticFriction], [0.5, 0.3]);
    throwsCode("DPT_E_ARGUMENT", () => world.setToolSettings(tool, { law: 9 }));
    assert(world.getToolSettings(tool).law === C.DPT_LAW_BED, "a refused setting took effect");
    world.setBodyPose(body, [1, 2, 3, 1, 0, 0, 0]);
    assert.deepStrictEqual(world.getBodyPose(body), [1, 2, 3, 1, 0, 0, 0]);
    assert.throws(() => world.setToolPose(tool, [0, 0, NaN, 1, 0, 0, 0]), dynpoint.DynpointError);
    world.close();
    mesh.close();
  });
  await check("vertices that are set are there after the next step", () => {
    const mesh = core.openMesh(file);
    const world = core.createWorld();
    const body = world.addDeform(mesh);
    const rest = mesh.getVertices();
    assert(rest.length === 3 * mesh.info.vertices && mesh.getTriangles().corners.length === 3 * mesh.info.triangles, "lengths");
    world.setVertices(body, rest.map((value, k) => (k % 3 === 2 ? value + 0.001 : value)));
    world.step(0.001);
    assert.deepStrictEqual(Array.from(world.getVertices(body)), Array.from(rest.map((value, k) => (k % 3 === 2 ? value + 0.001 : value))));
    throwsCode("DPT_E_ARGUMENT", () => world.setVertices(body, rest, 1));
    throwsCode("DPT_E_ARGUMENT", () => world.setVertices(body, rest.subarray(0, 3), NEVER));
    assert.throws(() => world.setVertices(body, rest.subarray(0, 4)), /a list of vertices is a Float32Array of 3 numbers each/);
    world.close();
    mesh.close();
    assert(idle() === before, `${idle()} blocks, not ${before}`);
  });
  await check("more memory than there can be is refused, and the core goes on", () => {
    const { heap } = core;
    const held = [];
    throwsCode("DPT_E_MEMORY", () => {
      for (;;) held.push(heap.allocate(1 << 30));
    });
    held.forEach(at => heap.release(at));
    core.openMesh(file).close();
    assert(idle() === before && heap.free.length === 0, "blocks are left");
  });
}

(async () => {
  await modules();
  const core = await dynpoint.openCore(bytesOf("dynpoint.wasm"));
  const compiler = await dynpoint.openCompiler(bytesOf("dynpoint_compile.wasm"));
  await check("the kernels are there, and the version", () => {
    assert.deepStrictEqual(core.kernels, ["scalar", "wasm128"]);
    const version = run("--version").toString().trim().split(" ").pop();
    assert(core.version === version && compiler.version === version, `${core.version}, not ${version}`);
  });
  await compiles(compiler);
  await refusals(compiler);
  await answersAlike(core);
  await objects(core);
  await conduct(core, compiler);
  finish();
})();
