// SPDX-License-Identifier: BSD-3-Clause
// Streams whose every place is known: a tool that lies down on a ring and is pressed in, beside a ball that swells.
// The layout is written here a second time, by its numbers, from the description alone.
"use strict";

const RING = { middle: 0.06, tube: 0.025, triangles: 4800 };
const BALL = { radius: 0.03, centre: [-0.13, 0, 0] };
const TOOL = { radius: 0.004, from: [0.06, -0.06, 0.029], to: [0.06, 0.06, 0.029] };
const FRAMES = 240;
const RATE = 60;
const PRESSED = 60;
const DIRECTION = [0.6, 0, 0.8];
const STIFFNESS = 500;
const DEEPEST = 0.008;
const PEAK = { time: 2.5, force: 9 };
const NONE = 0xffffffff;
const FIRST_SOURCE = 1000;

// A closed surface of `along` by `around` vertices, wound outward.
function closedSurface(along, around, place) {
  const positions = [];
  const corners = [];
  for (let i = 0; i < along; i++) for (let j = 0; j < around; j++) positions.push(...place(i / along, j / around));
  for (let i = 0; i < along; i++) {
    for (let j = 0; j < around; j++) {
      const a = i * around + j;
      const b = ((i + 1) % along) * around + j;
      const c = ((i + 1) % along) * around + ((j + 1) % around);
      const d = i * around + ((j + 1) % around);
      corners.push(a, b, c, a, c, d);
    }
  }
  return { positions: Float32Array.from(positions), corners: Uint32Array.from(corners) };
}

function ring(triangles = RING.triangles) {
  const around = Math.round(Math.sqrt(triangles / 6));
  const along = Math.round(triangles / 2 / around);
  return closedSurface(along, around, (u, v) => {
    const a = 2 * Math.PI * u;
    const b = 2 * Math.PI * v;
    const out = RING.middle + RING.tube * Math.cos(b);
    return [out * Math.cos(a), out * Math.sin(a), RING.tube * Math.sin(b)];
  });
}

function ball() {
  const positions = [];
  const corners = [];
  const along = 48;
  const around = 25;
  for (let i = 0; i < along; i++) {
    for (let j = 0; j < around; j++) {
      const a = (2 * Math.PI * i) / along;
      const b = Math.PI * (j / (around - 1) - 0.5);
      const out = BALL.radius * Math.cos(b);
      positions.push(out * Math.cos(a), out * Math.sin(a), BALL.radius * Math.sin(b));
    }
  }
  for (let i = 0; i < along; i++) {
    for (let j = 0; j < around - 1; j++) {
      const a = i * around + j;
      const b = ((i + 1) % along) * around + j;
      corners.push(a, b, b + 1, a, b + 1, a + 1);
    }
  }
  return { positions: Float32Array.from(positions), corners: Uint32Array.from(corners) };
}

// A closed box about the origin, of 12 triangles; half: the half lengths of its edges.
function box(name, half) {
  const signs = [-1, 1].flatMap(x => [-1, 1].flatMap(y => [-1, 1].flatMap(z => [x, y, z])));
  const faces = ["0132", "4675", "0451", "2376", "0264", "1573"].map(face => [...face].map(Number));
  return {
    name,
    positions: Float32Array.from(signs, (sign, i) => sign * half[i % 3]),
    corners: Uint32Array.from(faces.flatMap(([a, b, c, d]) => [a, b, c, a, c, d])),
    sources: Uint32Array.from({ length: 12 }, (_, i) => i),
  };
}

// Sources run backwards, so that no test passes by the number in the mesh alone.
const sourcesOf = ({ corners }) =>
  Uint32Array.from({ length: corners.length / 3 }, (_, i) => FIRST_SOURCE + corners.length / 3 - 1 - i);

function pad(size) {
  return Buffer.alloc((8 - (size % 8)) % 8);
}

// parts: [[type, value or values]...]
function pack(parts) {
  return Buffer.concat(
    parts.flatMap(([type, values]) =>
      [values].flat().map(value => {
        const bytes = Buffer.alloc({ u32: 4, f32: 4, u64: 8, f64: 8 }[type]);
        if (type === "u32") bytes.writeUInt32LE(value);
        if (type === "f32") bytes.writeFloatLE(value);
        if (type === "u64") bytes.writeBigUInt64LE(BigInt(value));
        if (type === "f64") bytes.writeDoubleLE(value);
        return bytes;
      }),
    ),
  );
}

// sections: [[kind, count, stride, bytes]...]
function snapshot(steps, time, sections, flags = 0) {
  const table = [];
  const bodies = [];
  let at = 64 + 24 * sections.length;
  for (const [kind, count, stride, bytes] of sections) {
    table.push(
      pack([
        ["u32", [kind, count, stride, 0]],
        ["u64", at],
      ]),
    );
    bodies.push(bytes, pad(bytes.length));
    at += bytes.length + pad(bytes.length).length;
  }
  const head = pack([
    ["u32", [1, 64]],
    ["u64", [at, steps]],
    ["f64", time],
    ["u32", [flags, sections.length, 0, 0]],
    ["u64", 0],
  ]);
  return Buffer.concat([Buffer.from([0x89, 0x44, 0x50, 0x53, 0x0d, 0x0a, 0x1a, 0x0a]), head, ...table, ...bodies]);
}

function sceneMessage(meshes, options = {}) {
  const parts = [];
  const list = [];
  let at = 0;
  const put = array => {
    const bytes = Buffer.from(array.buffer, array.byteOffset, array.byteLength);
    const from = at;
    parts.push(bytes, pad(bytes.length));
    at += bytes.length + pad(bytes.length).length;
    return from;
  };
  for (const { name, positions, corners, sources } of meshes)
    list.push({
      name,
      vertices: positions.length / 3,
      triangles: corners.length / 3,
      positions: put(positions),
      corners: put(corners),
      sources: put(sources),
    });
  const json = Buffer.from(
    JSON.stringify({
      title: "A ring and a ball",
      program: "dynpoint 0.2.0",
      mode: "recording",
      control: false,
      device: { name: "sim", simulated: true, rate: 1000, workspace: [-0.19, -0.12, -0.06, 0.12, 0.12, 0.09] },
      up: "z",
      frame_rate: RATE,
      force_max: 10,
      meshes: list,
      bodies: [
        { id: 11, mesh: 0, pose: [0, 0, 0, 1, 0, 0, 0], name: "ring" },
        { id: 12, mesh: 1, pose: [...BALL.centre, 1, 0, 0, 0], name: "ball" },
      ].slice(0, meshes.length),
      ...options,
    }),
  );
  return Buffer.concat([pack([["u32", [1, json.length]]]), json, pad(8 + json.length), ...parts]);
}

const depthAt = time =>
  time < PRESSED / RATE ? 0 : DEEPEST * Math.sin((Math.PI * (time - PRESSED / RATE)) / 3) ** 2;
const swellAt = frame => (frame % 2 === 0 ? 1 + 0.4 * Math.sin(frame / 20) ** 2 : swellAt(frame - 1));
const isPressed = frame => frame >= PRESSED;

function wrenchAt(time) {
  const force = STIFFNESS * depthAt(time);
  return [...DIRECTION.map(part => part * force), 0.01 * force, 0, 0];
}

// Where the tool is in a frame: its ends at the device's pose and at the proxy's.
function placesAt(frame) {
  const lift = Math.max(0, 0.04 * (1 - frame / PRESSED));
  const down = depthAt(frame / RATE);
  const moved = by => [TOOL.from, TOOL.to].map(([x, y, z]) => [x, y, z + by]);
  return { device: moved(lift - down), proxy: moved(lift) };
}

function toolSections(frame, stripSources) {
  const time = frame / RATE;
  const { device, proxy } = placesAt(frame);
  const pressed = isPressed(frame);
  const depth = depthAt(time);
  const contacts = pressed
    ? [
        [0.3, 0.5, 0.125, [0, 0, 1]],
        [0.5, 0.7, 0.25, [1, 0, 0]],
      ]
    : []; // stretches, how deep of the deepest, normals: along the first the device is behind by `depth`
  const reason = pressed ? 0 : 1;
  const strip = pressed ? stripSources : [];
  const middle = ends => ends[0].map((value, k) => (value + ends[1][k]) / 2);
  const q = [0.06, 0, 0.025];
  const tool = pack([
    ["u32", [5, 2, reason, 0, 0, 1, 0, contacts.length, 0, strip.length, 0, 0]],
    ["u64", [0, 0]],
    ["f64", [...middle(device), 1, 0, 0, 0]],
    ["f64", [...middle(proxy), 1, 0, 0, 0]],
    ["f64", wrenchAt(time)],
    ["f64", [0.5 * STIFFNESS * depth ** 2, depth, 0]],
  ]);
  const gap = device[0][2] - TOOL.radius - 0.025;
  const segment = pack([
    ["u32", [3, pressed ? 3 : 1, 1, stripSources[0], 11, 40, 0, 0]],
    [
      "f64",
      [
        ...device[0],
        ...device[1],
        TOOL.radius,
        ...proxy[0],
        ...proxy[1],
        ...middle(device),
        ...q,
        Math.abs(gap + TOOL.radius),
        gap,
        Math.max(0, -gap),
        1e-15,
        0,
      ],
    ],
  ]);
  const touching = contacts.map(([s0, s1, part, normal], i) =>
    pack([
      ["u32", [i, 11, 0, stripSources[0], 3, 0, 0, 0]],
      ["f64", [s0, s1, (s0 + s1) / 2, -part * DEEPEST, ...middle(proxy), ...q, ...normal, 1e-6]],
    ]),
  );
  const shadow = strip.map(source =>
    pack([
      ["u32", [source, 11, 0, 0]],
      ["f64", [-depth, 1e-6]],
    ]),
  );
  return [
    [2, 1, 248, tool],
    [3, 1, 224, segment],
    [4, touching.length, 144, Buffer.concat(touching)],
    [5, shadow.length, 32, Buffer.concat(shadow)],
  ];
}

function bodySections(frame, swelling) {
  const first = frame % 2 === 0 ? 0 : NONE;
  const body = (id, flags, from, vertices, place) =>
    pack([
      ["u32", [id, flags, from, vertices]],
      ["u64", 0],
      ["f64", [...place, 1, 0, 0, 0]],
    ]);
  const own = Float32Array.from(swelling.positions, value => value * swellAt(frame));
  const vertices = own.length / 3;
  const bodies = [
    1,
    2,
    80,
    Buffer.concat([body(11, 0, NONE, 0, [0, 0, 0]), body(12, 1, first, vertices, BALL.centre)]),
  ];
  return first === 0 ? [bodies, [6, vertices, 12, Buffer.from(own.buffer)]] : [bodies];
}

function ticksOf(frame) {
  const from = Math.ceil((frame * 1000) / RATE - 1e-9);
  const to = Math.ceil(((frame + 1) * 1000) / RATE - 1e-9);
  const ticks = [];
  for (let i = from; i < to; i++) {
    const time = i / 1000;
    const depth = depthAt(time);
    const force = i === PEAK.time * 1000 ? PEAK.force : STIFFNESS * depth;
    ticks.push(
      pack([
        ["f64", time],
        ["f32", [force, depth, 0.5 * STIFFNESS * depth ** 2, 2e-5 + 1e-5 * Math.sin(i), 6e-6]],
        ["u32", [depth > 0 ? 3 : 1, depth > 0 ? 0 : 1, 0]],
      ]),
    );
  }
  return ticks;
}

function frameMessage(number, snap, ticks = []) {
  return Buffer.concat([
    pack([
      ["u32", [2, snap.length, ticks.length, 0]],
      ["u64", [number, 3, 0]],
      ["f64", [1000, 500, 60, 4e-5, 9e-6]],
    ]),
    snap,
    ...ticks,
  ]);
}

const endMessage = (text, bytes = Buffer.from(text)) => Buffer.concat([pack([["u32", [3, bytes.length]]]), bytes]);
const streamOf = messages =>
  Buffer.concat(messages.flatMap(message => [pack([["u64", message.length]]), message, pad(message.length)]));

// The triangles of the ring that lie outside of the tool's middle: their numbers in the mesh.
function stripOf({ positions, corners }) {
  const strip = [];
  for (let i = 0; i < corners.length; i += 3) {
    const [x, y, z] = [0, 1, 2].map(k =>
      [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[i + c] + k] / 3, 0),
    );
    if (x > 0.068 && Math.abs(y) < 0.012 && z > 0.012) strip.push(i / 3);
  }
  return strip;
}

// options: of the scene; more: sections that each snapshot has beside its own
function recording({ more = [], ...options } = {}) {
  const meshes = [
    { name: "ring", ...ring() },
    { name: "ball", ...ball() },
  ].map(mesh => ({ ...mesh, sources: sourcesOf(mesh) }));
  const strip = stripOf(meshes[0]);
  const sources = strip.map(i => meshes[0].sources[i]);
  const frame = i =>
    frameMessage(
      i,
      snapshot(Math.ceil((1000 * i) / RATE), i / RATE, [
        ...bodySections(i, meshes[1]),
        ...toolSections(i, sources),
        ...more,
      ]),
      ticksOf(i),
    );
  return { meshes, strip, scene: sceneMessage(meshes, options), frame, end: endMessage("The recording is whole.") };
}

// One mesh of many triangles at rest, and nothing else.
function large(triangles) {
  const mesh = { name: "large ring", ...ring(triangles) };
  const still = snapshot(1, 0.001, [
    [
      1,
      1,
      80,
      pack([
        ["u32", [11, 0, NONE, 0]],
        ["u64", 0],
        ["f64", [0, 0, 0, 1, 0, 0, 0]],
      ]),
    ],
  ]);
  return {
    triangles: mesh.corners.length / 3,
    stream: streamOf([
      sceneMessage([{ ...mesh, sources: sourcesOf(mesh) }], { device: null }),
      frameMessage(0, still),
    ]),
  };
}

function stream(options) {
  const { scene, frame, end } = recording(options);
  return streamOf([scene, ...Array.from({ length: FRAMES }, (_, i) => frame(i)), end]);
}

// A section of one channel, of the first tool in the first body: numbers are depth, deepest, inside.
const channelSection = (flags, entry, axis, radius, numbers) => [
  7,
  1,
  128,
  pack([
    ["u32", [1, 11, 0, flags, 1, 1, 0, 0]],
    ["f64", [...entry, ...axis, radius, ...numbers, 0, 0]],
  ]),
];

module.exports = {
  box,
  channelSection,
  toolSections,
  RING,
  BALL,
  TOOL,
  FRAMES,
  RATE,
  PRESSED,
  DIRECTION,
  STIFFNESS,
  DEEPEST,
  PEAK,
  NONE,
  recording,
  stream,
  large,
  streamOf,
  placesAt,
  wrenchAt,
  depthAt,
  swellAt,
  snapshot,
  pack,
  sceneMessage,
  frameMessage,
  endMessage,
};
