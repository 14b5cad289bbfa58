// SPDX-License-Identifier: BSD-3-Clause
// node misuse.js ROOM: what goes wrong in the hands of a program is an Error with a text; never a trap of WebAssembly, and
// memory and answers are as before. The package lies in ROOM/node_modules.
"use strict";
const path = require("path");
const { check, random, assert, finish } = require("../view/verdicts.js");
const dynpoint = require(path.join(path.resolve(process.argv[2]), "node_modules/dynpoint"));
const { constants: C, DynpointError, Loop, Pace } = dynpoint;

const CUBE = { corners: [], vertices: [] };
for (let k = 0; k < 8; k++) CUBE.vertices.push(...[1, 2, 4].map(bit => (k & bit ? 0.05 : -0.05)));
for (const face of [
  [0, 2, 3, 1],
  [4, 5, 7, 6],
  [0, 1, 5, 4],
  [2, 6, 7, 3],
  [0, 4, 6, 2],
  [1, 3, 7, 5],
])
  CUBE.corners.push(face[0], face[1], face[2], face[0], face[2], face[3]);
const vertices = Float64Array.from(CUBE.vertices);
const corners = Uint32Array.from(CUBE.corners);
const POSE = [0, 0, 0, 1, 0, 0, 0];
const MIXED = [Array(8).fill(0), Array(6).fill(0)]; // as many numbers as two segments have
const ROD = [[-0.02, 0, 0, 0.02, 0, 0, 0.002]];

// As the library refuses: its code, and a sentence that is not the code.
function refused(code, work) {
  assert.throws(work, error => {
    assert(error instanceof DynpointError, `${error.stack}`);
    assert.strictEqual(error.code, code, error.message);
    return error.message.length > 10 && !error.message.includes("undefined");
  });
}
const wrong = work => assert.throws(work, error => error instanceof TypeError || error instanceof RangeError);

(async () => {
  const [core, other, compiler] = await Promise.all([
    dynpoint.openCore(),
    dynpoint.openCore(),
    dynpoint.openCompiler(),
  ]);
  const file = compiler.compileArrays(vertices, corners);
  const cloth = compiler.compileArrays(vertices, corners, { springs: { kind: "sheet" } });
  const held = () => [core.heap.used.size, core.heap.end, JSON.stringify(core.heap.free)].join();
  const scene = (bytes = file) => {
    const mesh = core.openMesh(bytes);
    const world = core.createWorld();
    return { mesh, world, body: world.addBody(mesh), tool: world.addTool(ROD) };
  };
  const before = held();

  await check("a mesh that is closed: refused, and closing once more frees nobody else's memory", () => {
    const mesh = core.openMesh(file);
    mesh.close();
    const { world, mesh: next } = scene();
    mesh.close();
    refused("DPT_E_HANDLE", () => world.addBody(mesh));
    refused("DPT_E_HANDLE", () => world.addDeform(mesh));
    refused("DPT_E_HANDLE", () => mesh.getVertices());
    refused("DPT_E_HANDLE", () => mesh.getTriangles());
    const [rest, large] = [
      next.getVertices(),
      core.openMesh(
        compiler.compileArrays(
          vertices.map(value => 2 * value),
          corners,
        ),
      ),
    ];
    assert.deepStrictEqual(next.getVertices(), rest);
    large.close();
    refused("DPT_E_ARGUMENT", () => next.close());
    world.close();
    next.close();
    assert.strictEqual(held(), before);
  });
  await check("a mesh of another core, and what is no mesh", () => {
    const { world, mesh } = scene();
    const strange = other.openMesh(file);
    refused("DPT_E_HANDLE", () => world.addBody(strange));
    for (const no of [null, undefined, 7, {}, { pointer: 1e9 }, file]) wrong(() => world.addBody(no));
    world.close();
    mesh.close();
    assert.strictEqual(held(), before);
  });
  await check("each method of a world that is closed", () => {
    const { world, mesh, body, tool } = scene(cloth);
    const soft = world.addDeform(mesh);
    world.addSprings(soft);
    world.close();
    world.close();
    const next = scene();
    const given = {
      addBody: [next.mesh],
      addDeform: [next.mesh],
      setVertices: [soft, new Float32Array(24)],
      stepSprings: [soft, 0.001],
      setBodyPose: [body, POSE],
      teleportBody: [body, POSE],
      setToolPose: [tool, POSE],
      teleportTool: [tool, POSE],
      addTool: [ROD],
      setToolSegments: [tool, ROD],
      setToolSettings: [tool, {}],
      setBodySettings: [body, {}],
      getSegmentHit: [tool, 0],
      step: [0.001],
    };
    const names = Object.getOwnPropertyNames(Object.getPrototypeOf(world)).filter(name =>
      /^(add|remove|set|teleport|get|step|reset)/.test(name),
    );
    assert(names.length >= 34, names.join());
    for (const name of names) refused("DPT_E_HANDLE", () => world[name](...(given[name] ?? [1])));
    assert.strictEqual(next.world.step(0.001).contact, C.DPT_CONTACT_PENETRATING);
    next.world.close();
    next.mesh.close();
    mesh.close();
    assert.strictEqual(held(), before);
  });
  await check("wrong sizes and wrong kinds of what goes in", () => {
    const { world, mesh, tool, body } = scene();
    const soft = world.addDeform(mesh);
    for (const no of [[], [0, 0, 0], [...POSE, 1], "0001000", new Float32Array(3), {}, 7, ["0", 0, 0, 1, 0, 0, 0]]) {
      wrong(() => world.setToolPose(tool, no));
      wrong(() => world.setBodyPose(body, no));
    }
    for (const no of [[[0, 0, 0]], [7], 7, undefined, [[...ROD[0], 1]], [null], MIXED, [["0", 0, 0, 0.02, 0, 0, 0.002]]])
      wrong(() => world.addTool(no));
    for (const no of [new Float64Array(24), new Float32Array(4), Array(24).fill(0), undefined, new ArrayBuffer(96)])
      wrong(() => world.setVertices(soft, no));
    refused("DPT_E_ARGUMENT", () => world.setVertices(soft, new Float32Array(27)));
    for (const no of [undefined, null, 7, "dpa", [1, 2, 3], {}]) {
      wrong(() => core.openMesh(no));
      wrong(() => compiler.compile(no));
    }
    wrong(() => compiler.compileArrays(vertices.subarray(1), corners));
    wrong(() => compiler.compileArrays(vertices, corners.subarray(1)));
    wrong(() => compiler.compileArrays(Float32Array.from(vertices), corners));
    wrong(() => compiler.compileArrays(vertices, CUBE.corners));
    assert.throws(() => compiler.compileArrays(vertices, Uint32Array.of(0, 1, 8)), DynpointError);
    wrong(() => core.createWorld({ maxTools: -1 }));
    wrong(() => core.createWorld({ maxTools: 1.5 }));
    wrong(() => core.createWorld({ maxTools: NaN }));
    wrong(() => core.createWorld({ maxTools: 2 ** 32 }));
    wrong(() => core.createWorld({ maxTools: "2" }));
    wrong(() => core.createWorld(null));
    refused("DPT_E_ARGUMENT", () => core.createWorld({ maxTools: 0 }));
    assert.throws(() => core.createWorld({ maxBodies: 2 ** 32 - 1 }), DynpointError);
    refused("DPT_E_FULL", () => world.getContacts(tool));
    world.close();
    mesh.close();
  });
  await check("addresses do not come from outside", () => {
    const { world, mesh } = scene(cloth);
    for (const name of ["mesh", "pose", "compliances"]) wrong(() => world.addDeform(mesh, { [name]: 2 ** 31 }));
    for (const name of ["progress", "user", "springs"])
      assert.throws(() => compiler.compileArrays(vertices, corners, { [name]: 99 }), TypeError);
    for (const no of [-1, 1.5, NaN, 2 ** 32, "1"])
      wrong(() => compiler.compileArrays(vertices, corners, { springs: { kind: "sheet", fixed: [no] } }));
    const [list, set] = [[0, 5], new Set([0, 5])].map(fixed =>
      compiler.compileArrays(vertices, corners, { springs: { kind: "sheet", fixed } }),
    );
    assert.deepStrictEqual(set, list);
    assert.notDeepStrictEqual(list, cloth);
    for (const name of ["fixedCount", "regionCount"])
      assert.strictEqual(
        compiler.compileArrays(vertices, corners, { springs: { kind: "sheet", [name]: 1e9 } }).length,
        cloth.length,
      );
    world.close();
    mesh.close();
  });
  await check("numbers that are none, infinite or huge: refused, and the next tick is as it would have been", () => {
    const { world, mesh, tool, body } = scene();
    const twin = scene();
    const soft = world.addDeform(mesh, {}, [1, 0, 0, 1, 0, 0, 0]);
    for (const no of [NaN, Infinity, -Infinity, 1e300]) {
      for (let k = 0; k < 7; k++) {
        const pose = POSE.map((value, i) => (i === k ? no : value));
        for (const set of ["setToolPose", "teleportTool"]) assert.throws(() => world[set](tool, pose), DynpointError);
        assert.throws(() => world.teleportBody(body, pose), DynpointError);
        const rod = [ROD[0].map((value, i) => (i === k ? no : value))];
        assert.throws(() => world.setToolSegments(tool, rod), DynpointError);
      }
      assert.throws(() => world.setVertices(soft, new Float32Array(24).fill(no)), DynpointError);
      for (const key of ["stiffness", "damping"])
        assert.throws(() => world.setToolSettings(tool, { [key]: no === 1e300 ? NaN : no }), DynpointError);
      if (no !== 1e300) assert.throws(() => world.step(no), DynpointError);
      assert.throws(
        () =>
          compiler.compileArrays(
            vertices.map(value => value * no),
            corners,
          ),
        DynpointError,
      );
    }
    for (const no of [-0.001, "soon", undefined, {}]) assert.throws(() => world.step(no), DynpointError);
    world.removeBody(soft);
    for (const it of [{ world, tool }, twin]) it.world.setToolPose(it.tool, [0, 0.051, 0, 1, 0, 0, 0]);
    world.step(0.001);
    twin.world.step(0.001);
    assert.deepStrictEqual(world.getWrench(tool), twin.world.getWrench(twin.tool));
    world.close();
    twin.world.close();
    mesh.close();
    twin.mesh.close();
  });
  await check("stale numbers of bodies and tools, and those of the other kind", () => {
    const { world, mesh, tool, body } = scene();
    for (const no of [0, body, 99, -1, NaN, "x", undefined, null, {}]) {
      refused("DPT_E_HANDLE", () => world.getHit(no));
      refused("DPT_E_HANDLE", () => world.setToolPose(no, POSE));
    }
    world.removeTool(tool);
    refused("DPT_E_HANDLE", () => world.getWrench(tool));
    world.removeBody(body);
    refused("DPT_E_HANDLE", () => world.removeBody(body));
    refused("DPT_E_HANDLE", () => world.addSprings(body));
    mesh.close();
    world.close();
  });
  await check("a core is for one thread: what is sent to another is refused", () => {
    const { world, mesh } = scene();
    for (const thing of [core, world, mesh, compiler])
      assert.throws(
        () => structuredClone(thing),
        error => error.name === "DataCloneError",
      );
    world.close();
    mesh.close();
  });
  await check("ten thousand files that are damaged: opened, or refused with a code", () => {
    const { next, below } = random(7);
    let refusals = 0;
    for (let run = 0; run < 10000; run++) {
      let copy = Uint8Array.from(run % 2 ? file : cloth);
      for (let times = 1 + below(3); times > 0; times--) copy[below(below(2) ? 512 : copy.length)] = next() & 255;
      if (below(8) === 0) copy = copy.subarray(0, below(copy.length));
      try {
        core.openMesh(copy).close();
      } catch (error) {
        assert(
          error instanceof DynpointError && error.code.startsWith("DPT_E_") && /^byte \d+/.test(error.message),
          error.stack,
        );
        refusals++;
      }
    }
    assert(refusals > 8000, `${refusals} were refused`);
  });
  await check("all memory is given back", () => assert.strictEqual(held(), before));
  await check("modules that are none", async () => {
    for (const no of [7, {}, "dynpoint.wasm"]) await assert.rejects(dynpoint.openCore(no), TypeError);
    await assert.rejects(dynpoint.openCore(new Uint8Array(8)), WebAssembly.CompileError);
    await assert.rejects(dynpoint.openCompiler(new Uint8Array(0)), WebAssembly.CompileError);
  });
  await check("loops: what they do not take, and that one does not run twice", async () => {
    for (const no of [undefined, {}, "tick"]) wrong(() => new Loop(no));
    for (const no of [
      { period: 0 },
      { period: NaN },
      { period: -1 },
      { period: Infinity },
      { catchUp: -1 },
      { wait: "rest" },
    ])
      wrong(() => new Loop(() => {}, no));
    wrong(() => new Pace({ period: NaN }));
    const loop = new Loop(() => loop.stop(), { period: 0.0005 });
    const end = loop.run();
    assert.throws(() => loop.run(), /runs/);
    assert.strictEqual((await end).ticks, 1);
    await assert.rejects(
      new Loop(() => {
        throw new RangeError("of a tick");
      }).run(),
      /of a tick/,
    );
    assert.strictEqual((await loop.run()).ticks, 2);
    const stopped = loop.run();
    loop.stop();
    assert.throws(() => loop.run(), /runs/);
    assert.strictEqual((await stopped).ticks, 2);
  });
  finish();
})();
