// SPDX-License-Identifier: BSD-3-Clause
// node types.js ROOM TYPESCRIPT: types and objects of the package, both ways: what a type names is there and is of that
// kind, by TypeScript's own reading of the types; and what is there has a type, or is one of the inner parts below.
"use strict";
const path = require("path");
const { check, assert, finish } = require("../view/verdicts.js");
const [room, typescript] = process.argv.slice(2).map(name => path.resolve(name));
const place = path.join(room, "node_modules/dynpoint");
const ts = require(typescript);
const dynpoint = require(place);

// What the layer's classes have for themselves.
const INNER = {
  Core: "memory heap scratch kernelName check wrench place get def plain",
  Compiler: "exports memory withBlocks run fault springs",
  Mesh: "core bytes pointer users array words in",
  World: `core memory call meshes blocks springs room snapshot block world made numbers pose placeOf hold springsOf withSegments
    withArray larger list`,
  Loop: "tick pace sleep late took round hasEnded",
  Pace: "begun",
  Layout: "",
};
const TYPED = { Float32Array, Float64Array, Uint8Array, Uint32Array };

const file = path.join(place, "index.d.mts");
const program = ts.createProgram([file], {
  strict: true,
  target: ts.ScriptTarget.ES2022,
  module: ts.ModuleKind.NodeNext,
});
const checker = program.getTypeChecker();
const module_ = checker.getSymbolAtLocation(program.getSourceFile(file));
const exported = new Map(checker.getExportsOfModule(module_).map(symbol => [symbol.name, symbol]));
const typeOf = name => checker.getDeclaredTypeOfSymbol(exported.get(name));
const node = program.getSourceFile(file);
const ofSymbol = symbol => checker.getTypeOfSymbolAtLocation(symbol, node);
let compared = 0;

// Throws where the value is not of the type; names says where.
function hold(value, type, name) {
  compared++;
  const { flags } = type;
  const text = checker.typeToString(type);
  const is = what => assert(what, `${name} is no ${text}: ${String(value)}`);
  if (flags & ts.TypeFlags.NumberLiteral) return is(value === type.value);
  if (flags & ts.TypeFlags.StringLiteral) return is(value === type.value);
  if (flags & ts.TypeFlags.Number) return is(typeof value === "number");
  if (flags & ts.TypeFlags.String) return is(typeof value === "string");
  if (flags & ts.TypeFlags.BigInt) return is(typeof value === "bigint");
  if (flags & (ts.TypeFlags.Boolean | ts.TypeFlags.BooleanLiteral)) return is(typeof value === "boolean");
  if (flags & (ts.TypeFlags.Undefined | ts.TypeFlags.Void)) return is(value === undefined);
  if (type.isUnion()) return is(type.types.some(one => passes(value, one, name)));
  if (text in TYPED || type.symbol?.name in TYPED) return is(value instanceof TYPED[type.symbol.name]);
  if (type.getCallSignatures().length > 0) return is(typeof value === "function");
  if (checker.isTupleType(type)) {
    const items = checker.getTypeArguments(type);
    is(Array.isArray(value) && value.length === items.length);
    return items.forEach((item, k) => hold(value[k], item, `${name}[${k}]`));
  }
  if (checker.isArrayType(type)) {
    is(Array.isArray(value));
    return value.forEach((item, k) => hold(item, checker.getTypeArguments(type)[0], `${name}[${k}]`));
  }
  return holdObject(value, type, name);
}

function passes(value, type, name) {
  try {
    hold(value, type, name);
    return true;
  } catch {
    return false;
  }
}

const namesOf = value => {
  const names = new Set(Object.keys(value));
  for (
    let at = Object.getPrototypeOf(value);
    at && at !== Object.prototype && at !== Error.prototype;
    at = Object.getPrototypeOf(at)
  )
    Object.getOwnPropertyNames(at).forEach(name => names.add(name));
  names.delete("constructor");
  return names;
};

function holdObject(value, type, name) {
  const { name: kind } = type.symbol;
  if (["Memory", "Global", "ReadonlyMap", "Map"].includes(kind)) return;
  assert(value !== null && typeof value === "object", `${name} is no ${kind}`);
  const there = namesOf(value);
  for (const symbol of type.getProperties()) {
    const isOptional = symbol.flags & ts.SymbolFlags.Optional;
    assert(
      isOptional || there.has(symbol.name) || symbol.name in value,
      `${name} has no ${symbol.name}, as its type ${kind} says`,
    );
    if (!isOptional) hold(value[symbol.name], ofSymbol(symbol), `${name}.${symbol.name}`);
    there.delete(symbol.name);
  }
  if (type.getStringIndexType()) return;
  const inner = new Set((INNER[kind] ?? "").split(/\s+/));
  const untyped = [...there].filter(one => !inner.has(one));
  assert(untyped.length === 0, `${name}: its type ${kind} has no ${untyped}`);
}

// What a method gives is of the type that it says: of its overload number k.
function gives(object, typeName, method, values, k = 0) {
  const symbol = typeOf(typeName).getProperty(method);
  const result = ofSymbol(symbol).getCallSignatures()[k].getReturnType();
  const value = object[method](...values);
  hold(value, result, `${typeName}.${method}()`);
  return value;
}

const OBJ = `v 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n`;
const POSE = [0, 0, 0, 1, 0, 0, 0];

(async () => {
  const [core, compiler] = await Promise.all([dynpoint.openCore(), dynpoint.openCompiler()]);
  await check("what the module exports has a type, and the other way round", () => {
    const values = [...exported.values()].filter(
      ({ flags }) => flags & ts.SymbolFlags.Value && !(flags & ts.SymbolFlags.Alias),
    );
    const names = values.map(({ name }) => name).filter(name => name !== "default");
    assert.deepStrictEqual(names.sort(), Object.keys(dynpoint).sort());
  });
  await check("constants: all, each of the value of its type", () => {
    hold(dynpoint.constants, ofSymbol(exported.get("constants")), "constants");
    assert(Object.keys(dynpoint.constants).length > 200, "too few");
  });
  await check("layouts", () => hold(dynpoint.layouts, ofSymbol(exported.get("layouts")), "layouts"));
  await check("the core's exports: each function, of as many arguments", () => {
    const { exports } = core;
    const type = typeOf("CoreExports");
    hold({ ...exports }, type, "exports");
    for (const name of Object.keys(exports).filter(one => one.startsWith("dpt_"))) {
      const [signature] = ofSymbol(type.getProperty(name)).getCallSignatures();
      assert.strictEqual(signature.parameters.length, exports[name].length, name);
    }
    // What has 64 bits is a BigInt: another kind of number would throw, here and in a program.
    assert.strictEqual(typeof exports.dpt_world_bytes(0), "number");
  });
  const said = [];
  const call = (object, type, method, values = [], k = 0) => {
    said.push(`${type}.${method}`);
    return gives(object, type, method, values, k);
  };
  await check("each object, and what each of its methods gives", () => {
    const file = call(compiler, "Compiler", "compile", [new TextEncoder().encode(OBJ)]);
    const sheet = compiler.compile(new TextEncoder().encode(OBJ), { springs: { kind: "sheet" } });
    call(compiler, "Compiler", "compileArrays", [Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), Uint32Array.of(0, 1, 2)]);
    const mesh = call(core, "Core", "openMesh", [file]);
    const soft = core.openMesh(sheet);
    const world = call(core, "Core", "createWorld", [{ maxContacts: 8 }]);
    call(core, "Core", "couplingForDevice", [{ mass: 0.1, damping: 1 }]);
    call(core, "Core", "stableStiffness", [0.1, 1, 0.001, 0, 0]);
    for (const [object, name] of [
      [core, "Core"],
      [compiler, "Compiler"],
      [mesh, "Mesh"],
      [world, "World"],
    ])
      hold(object, typeOf(name), name);
    const of = (method, values, k) => call(world, "World", method, values, k);
    call(mesh, "Mesh", "getVertices");
    call(mesh, "Mesh", "getTriangles");
    const body = of("addBody", [mesh]);
    const cloth = of("addDeform", [soft, {}, [1, 0, 0, 1, 0, 0, 0]]);
    const tool = of("addTool", [[[0.02, 0.02, -0.05, 0.02, 0.02, 0.05, 0.001]]]);
    of("addSprings", [cloth]);
    for (const method of ["setBodyPose", "teleportBody"]) of(method, [body, POSE]);
    for (const method of ["setToolPose", "teleportTool"]) of(method, [tool, POSE]);
    of("setToolSegments", [tool, [[0.02, 0.02, -0.05, 0.02, 0.02, 0.05, 0.002]]]);
    of("setBodySettings", [body, { stiffness: 100 }]);
    of("setToolSettings", [tool, { law: dynpoint.constants.DPT_LAW_BED }]);
    of("step", [0.001], 0);
    of("step", [0.001, false], 1);
    of("stepSprings", [cloth, 0.001]);
    for (const method of ["getSpringsEnergy", "getVertices"]) of(method, [cloth]);
    of("setVertices", [cloth, world.getVertices(cloth)]);
    for (const method of ["getBodyPose", "getBodySettings", "getBodyWrench"]) of(method, [body]);
    for (const method of ["getToolPose", "getToolSettings", "getHit", "getWrench", "getForceInfo", "getToolEnd"])
      of(method, [tool]);
    assert(of("getContacts", [tool]).length > 0, "no contact");
    of("getSegmentHit", [tool, 0]);
    world.setToolSettings(tool, { law: dynpoint.constants.DPT_LAW_PROXY });
    world.teleportTool(tool, [0, 0, 0.5, 1, 0, 0, 0]);
    for (let tick = 1; tick <= 41; tick++) {
      world.setToolPose(tool, [0, 0, 0.5 - 0.01 * tick, 1, 0, 0, 0]);
      world.step(0.001);
    }
    of("getToolProxy", [tool]);
    assert(of("getLoads", [tool]).length > 0, "no load");
    of("getInfo", []);
    of("getSnapshot", []);
    of("reset", []);
    of("removeTool", [tool]);
    of("removeBody", [cloth]);
    of("close", []);
    call(mesh, "Mesh", "close");
  });
  await check("a loop, a pace and an error", async () => {
    const loop = new dynpoint.Loop(() => loop.stop());
    hold(loop, typeOf("Loop"), "Loop");
    hold(await loop.run(), typeOf("LoopInfo"), "LoopInfo");
    call(loop, "Loop", "getInfo");
    call(loop, "Loop", "stop");
    said.push("Loop.run");
    const pace = new dynpoint.Pace();
    for (const [method, values] of Object.entries({ begin: [0], late: [3], skip: [50], due: [60] }))
      call(pace, "Pace", method, values);
    hold(pace, typeOf("Pace"), "Pace");
    try {
      compiler.compile(new Uint8Array(3));
      assert(false, "nothing was thrown");
    } catch (error) {
      hold(error, typeOf("DynpointError"), "DynpointError");
      assert.strictEqual(typeof error.byte, "number");
    }
  });
  await check("each method of each type was called", () => {
    for (const name of ["Core", "Compiler", "Mesh", "World", "Loop", "Pace"])
      for (const symbol of typeOf(name).getProperties())
        if (ofSymbol(symbol).getCallSignatures().length > 0)
          assert(said.includes(`${name}.${symbol.name}`), `${name}.${symbol.name}`);
    assert(compared > 900, `${compared} values were compared`);
  });
  await check("each struct that has a type is one that the layer has", () => {
    const struct = name => name.slice(4).replace(/(?:^|_)(\w)/g, (_, letter) => letter.toUpperCase());
    const typed = Object.keys(dynpoint.layouts).filter(name => exported.has(struct(name)));
    assert(typed.length >= 20, typed.join());
    for (const name of typed) {
      const { fields } = dynpoint.layouts[name];
      const wanted = fields
        .filter(one => !one.isOwnSize && one.type !== "p" && !one.name.startsWith("reserved"))
        .map(one => one.name);
      if (name === "dpt_pose") continue;
      assert.deepStrictEqual(
        typeOf(struct(name))
          .getProperties()
          .map(one => one.name)
          .sort(),
        wanted.sort(),
        name,
      );
    }
  });
  finish();
})();
