// SPDX-License-Identifier: BSD-3-Clause
// The parts of the page that need no browser: the readers, what is kept of frames and ticks, the player, the hand.
"use strict";
const { check, near, random, scripts, alone, damage, finish, assert } = require("./verdicts.js");
const fixture = require("./stream_fixture.js");
const { pack, snapshot, frameMessage } = fixture;
const {
  messageReader,
  snapshotReader,
  checkedReading,
  tickHistory,
  frameHistory,
  player,
  scale,
  rays,
  hand,
  readouts,
  channelView,
} = scripts(
  "checked_reading",
  "snapshot_reader",
  "message_reader",
  "tick_history",
  "frame_history",
  "player",
  "scale",
  "rays",
  "hand",
  "depths",
  "capsule_batch",
  "channel_view",
  "readouts",
);
const { readMessage, splitStream, decodeText, misfit } = messageReader;
const known = fixture.recording();
const scene = readMessage(alone(known.scene));
const frameAt = i => readMessage(alone(known.frame(i)));

// Frame 150, whose tool is in the body, with some of what tells how deep taken away.
function deepFrame({ known, contacts, ticks, distance = 0 }) {
  const frame = frameAt(150);
  const [segment] = frame.snapshot.segments;
  assert(segment.contact === 3 && frame.snapshot.contacts.length === 2 && frame.ticks.length > 0);
  if (!known) Object.assign(segment, { flags: 0, depth: NaN, gap: NaN, distance });
  if (!contacts) frame.snapshot.contacts = [];
  if (!ticks) frame.ticks = [];
  return frame;
}

async function whatIsRead() {
  await check("while the tool is in there is a depth, whatever the snapshot leaves out; before it there is a gap", () => {
    const near = options => readouts.texts(deepFrame(options), 0, {}).near;
    assert.strictEqual(near({ known: true, contacts: true, ticks: true }), "8.000 mm");
    assert.strictEqual(near({ contacts: true, ticks: true }), "8.000 mm", "that of the deepest contact");
    const tick = frameAt(150).ticks.at(-1).depth;
    assert.strictEqual(near({ ticks: true }), `${(1e3 * tick).toFixed(3)} mm`, "that of the tick");
    assert.strictEqual(near({ distance: 0.001 }), "3.000 mm", "at least what its radius is inside");
    const free = frameAt(10);
    Object.assign(free.snapshot.segments[0], { flags: 0, contact: 1, distance: 0.0045 });
    const { near: gap, nearWord } = readouts.texts(free, 0, {});
    assert.deepStrictEqual([gap, nearWord], ["0.500 mm", "gap"]);
  });

  await check("a scene is read as it was written", () => {
    assert.deepStrictEqual(
      [scene.kind, scene.title, scene.mode, scene.up, scene.forceMax],
      ["scene", "A ring and a ball", "recording", "z", 10],
    );
    assert.deepStrictEqual(
      scene.bodies.map(({ id, name, mesh }) => [id, name, mesh]),
      [
        [11, "ring", 0],
        [12, "ball", 1],
      ],
    );
    assert.deepStrictEqual(scene.device, {
      name: "sim",
      simulated: true,
      rate: 1000,
      workspace: [-0.19, -0.12, -0.06, 0.12, 0.12, 0.09],
    });
    for (const [i, mesh] of known.meshes.entries())
      for (const part of ["positions", "corners", "sources"])
        assert.deepStrictEqual(scene.meshes[i][part], mesh[part], part);
  });
  await check("a frame is read as it was written", () => {
    const frame = frameAt(150);
    const { snapshot: got } = frame;
    const [tool] = got.tools;
    const [segment] = got.segments;
    const places = fixture.placesAt(150);
    assert.deepStrictEqual(
      [frame.number, frame.dropped, frame.ticksLost, frame.hapticRate, frame.physicsRate, frame.viewRate],
      [150, 3, 0, 1000, 500, 60],
    );
    near([frame.lateP99, frame.tickP99, got.time, got.steps], [4e-5, 9e-6, 2.5, 2500], 0);
    assert.deepStrictEqual(
      [got.bodies.map(({ id, flags, vertices }) => [id, flags, vertices]), tool.id, tool.law],
      [
        [
          [11, 0, 0],
          [12, 1, 1200],
        ],
        5,
        2,
      ],
    );
    near(tool.wrench, fixture.wrenchAt(2.5), 1e-15);
    near([tool.energy, tool.lag], [0.5 * fixture.STIFFNESS * 0.008 ** 2, 0.008], 1e-12);
    near(
      [segment.a, segment.b, segment.proxyA, segment.proxyB].flat(),
      [...places.device, ...places.proxy].flat(),
      1e-15,
    );
    near([segment.radius, segment.gap, segment.depth, segment.errorBound], [0.004, -0.008, 0.008, 1e-15], 1e-12);
    assert.deepStrictEqual(
      got.contacts.map(({ s0, s1, gap, body }) => [s0, s1, gap, body]),
      [
        [0.3, 0.5, -0.001, 11],
        [0.5, 0.7, -0.002, 11],
      ],
    );
    assert.deepStrictEqual(
      got.strips.map(({ triangle }) => triangle),
      known.strip.map(i => known.meshes[0].sources[i]),
    );
    near(got.vertices[3], known.meshes[1].positions[3] * fixture.swellAt(150), 1e-8);
    near(
      frame.ticks.map(({ time }) => time),
      Array.from({ length: frame.ticks.length }, (_, i) => 2.5 + i / 1000),
      1e-12,
    );
    near(
      [frame.ticks[0].force, frame.ticks[1].force],
      [fixture.PEAK.force, fixture.STIFFNESS * fixture.depthAt(2.501)],
      1e-5,
    );
  });
  await check("the numbers beside the picture are those of the frame", () => {
    const texts = readouts.texts(frameAt(150), 0, { drawnRate: 0 });
    assert.deepStrictEqual(
      "tick force near nearWord contact reason triangle dropped drawn".split(" ").map(name => texts[name]),
      [
        "2,500",
        "4.00 N",
        "8.000 mm",
        "depth",
        "pressed in",
        "",
        String(known.meshes[0].sources[known.strip[0]]),
        "3",
        "\u2013",
      ],
    );
    assert.match(readouts.texts(frameAt(10), 0, {}).reason, /^free/);
    const { near, nearWord } = readouts.texts(frameAt(10), 0, {});
    assert.deepStrictEqual([near, nearWord], ["33.333 mm", "gap"]); // 40 mm * (1 - 10 / 60)
    const wrong = frameAt(150);
    assert.strictEqual(readouts.texts(wrong, 0, {}).held, "");
    wrong.snapshot.bodies[1].flags |= 4;
    wrong.ticks[wrong.ticks.length - 1].reason = 6;
    assert.match(readouts.texts(wrong, 0, {}).held, /could not be moved: body 1\./);
    assert.match(readouts.texts(wrong, 0, {}).reason, /^failed/);
    const left = frameMessage(0, snapshot(1, 0, [], 5));
    assert.match(readouts.texts(readMessage(alone(left)), 0, {}).left, /contacts, vertices/);
  });
  await check("the last message is read, and a stream is split where its lengths say", () => {
    assert.deepStrictEqual(readMessage(alone(known.end)), { kind: "end", text: "The recording is whole." });
    const { bytes } = decodeText(fixture.streamOf([known.scene, known.frame(0), known.end]).toString("base64"));
    assert.deepStrictEqual(
      splitStream(bytes).messages.map(one => Buffer.from(one)),
      [known.scene, known.frame(0), known.end],
    );
  });
  await check("channels are read, and told of the tool that is in them", () => {
    const channel = (flags, tool, ruptures, layers, numbers) =>
      pack([
        ["u32", [3, 11, 5, flags, ruptures, layers, tool, 0]],
        ["f64", [0.1, 0.2, 0.3, 0, 0, -1, 0.0006, ...numbers, 1.5, 0.4]],
      ]);
    const channels = Buffer.concat([
      channel(1, 0, 2, 1, [0.03, 0.04, 0.02]),
      channel(1, 0, 1, 1, [0.01, 0.01, 0.01]),
      channel(0, 0, 1, 1, [0, 0.05, 0]),
    ]);
    const tools = tool => [7, 3, 128, Buffer.concat([channels.subarray(0, 24), pack([["u32", [tool]]]), channels.subarray(28)])];
    const of = tool => {
      const sections = fixture.toolSections(150, [...known.meshes[0].sources]);
      return readMessage(alone(frameMessage(0, snapshot(1, 0, [...sections, tools(tool)]))));
    };
    const { snapshot: got } = of(0);
    near(
      [got.channels[0].entry, got.channels[0].axis, got.channels[0].radius, got.channels[0].depth].flat(),
      [0.1, 0.2, 0.3, 0, 0, -1, 0.0006, 0.03],
      1e-15,
    );
    const { needleDepth, needleInside, needleThrough } = readouts.texts(of(0), 0, { drawnRate: 0 });
    assert.deepStrictEqual(
      [needleDepth, needleInside, needleThrough],
      ["30.00 mm", "30.00 mm", "3, 2"],
    );
    assert.strictEqual(channelView.texts(frameAt(150).snapshot, 0).needleDepth, "\u2013");
    const segment = { proxyA: [0, 0, 0], proxyB: [0, 0, 0.02] };
    assert.deepStrictEqual(
      got.channels.map(one => channelView.stretchesOf(one, segment)).map(({ shaft, empty }) => [shaft, empty]),
      [
        [
          [0.03 - 0.02, 0.03],
          [0.03, 0.04],
        ],
        [[0, 0.01], null],
        [null, [0, 0.05]],
      ],
    );
    assert.match(of(1).refused ?? "it was read", /channel belongs to a tool/);
  });
  await check("larger items and kinds that are not known are read over", () => {
    const vertices = pack([["f32", [1, 2, 3, 99, 4, 5, 6, 99]]]);
    const body = Buffer.concat([
      pack([
        ["u32", [12, 1, 0, 2]],
        ["u64", 0],
        ["f64", [0, 0, 0, 1, 0, 0, 0]],
      ]),
      Buffer.alloc(8, 0xee),
    ]);
    const got = checkedReading.attempt(() =>
      snapshotReader.read(
        alone(
          snapshot(1, 0, [
            [77, 0xffffffff, 0xffffffff, Buffer.alloc(8)],
            [6, 2, 16, vertices],
            [1, 1, 88, body],
          ]),
        ),
      ),
    );
    assert.deepStrictEqual([...got.vertices, got.bodies[0].id, got.bodies[0].pose[3]], [1, 2, 3, 4, 5, 6, 12, 1]);
  });
}

async function whatIsRefused() {
  const refused = (bytes, words) => assert.match(readMessage(alone(bytes)).refused ?? "it was read", words);
  const changed = (bytes, at, value) => {
    const copy = Buffer.from(bytes);
    copy.writeUInt32LE(value >>> 0, at);
    return copy;
  };
  const frame = known.frame(150);
  const section = kind => 80 + 64 + 24 * [1, 6, 2, 3, 4, 5].indexOf(kind);
  const itemsOf = kind => 80 + Number(frame.readBigUInt64LE(section(kind) + 16));
  await check("what does not hold together is refused, with its reason", () => {
    refused(Buffer.alloc(3), /shorter than its kind/);
    refused(changed(frame, 0, 9), /kind 9/);
    refused(frame.subarray(0, 79), /cut off/);
    refused(changed(frame, 8, 1e6), /end behind/);
    refused(changed(frame, 80, 0), /does not begin/);
    refused(changed(frame, 88, 2), /version 2/);
    refused(changed(frame, 96, 8), /length/);
    refused(changed(frame, 80 + 44, 1e6), /table/);
    refused(changed(frame, section(3), 2), /two sections of tools/);
    refused(changed(frame, section(3) + 4, 1e6), /segments end behind/);
    refused(changed(frame, section(3) + 8, 216), /216 bytes/);
    refused(changed(frame, section(3) + 20, 1), /end behind/);
    refused(changed(frame, itemsOf(2) + 20, 2), /tool's segments/);
    refused(changed(frame, itemsOf(2) + 28, 3), /tool's contacts/);
    refused(changed(frame, itemsOf(2) + 36, 0xffffffff), /tool's strip/);
    refused(changed(frame, itemsOf(3) + 24, 1), /belongs to a tool/);
    refused(changed(frame, itemsOf(4) + 8, 1), /belongs to a segment/);
    refused(changed(frame, itemsOf(1) + 80 + 8, 1), /vertices end behind/);
    assert.match(misfit({ snapshot: { bodies: [{ id: 12, vertices: 7 }] } }, scene), /7 vertices/);
    assert.strictEqual(misfit(frameAt(150), scene), null);
  });
  await check("a scene that does not hold together is refused, with its reason", () => {
    const asScene = (options, words) => refused(fixture.sceneMessage(known.meshes, options), words);
    asScene({ mode: "film" }, /mode/);
    asScene({ title: 5 }, /title/);
    asScene({ bodies: [{ id: 1, mesh: 2, pose: [0, 0, 0, 1, 0, 0, 0], name: "" }] }, /mesh is not in/);
    asScene({ bodies: [{ id: 1, mesh: 0, pose: [0, 0, 0, 1], name: "" }] }, /no pose/);
    asScene({ device: { name: "x", rate: 1, workspace: [1, 0, 0, 0, 0, 0] } }, /no box/);
    asScene({ force_max: -1 }, /force/);
    asScene({ camera: [0, 0, 0] }, /camera/);
    asScene(
      { meshes: [{ name: "far", vertices: 4e9, triangles: 0, positions: 0, corners: 0, sources: 0 }], bodies: [] },
      /ends behind/,
    );
    asScene(
      { meshes: [{ name: "odd", vertices: 1, triangles: 0, positions: 2, corners: 0, sources: 0 }], bodies: [] },
      /ends behind/,
    );
    const [mesh] = known.meshes;
    const corners = mesh.corners.slice();
    const positions = mesh.positions.slice();
    corners[5] = positions.length / 3;
    positions[5] = NaN;
    refused(fixture.sceneMessage([{ ...mesh, corners }]), /corner that is not there/);
    refused(fixture.sceneMessage([{ ...mesh, positions }]), /coordinate/);
    assert.match(decodeText("AAA").refused, /cut off/);
    assert.match(decodeText("AA<A").refused, /base64/);
    assert.match(splitStream(Buffer.concat([pack([["u64", 9]]), Buffer.alloc(8)])).refused, /ends behind/);
  });
  await check("20,000 damaged messages and streams are read or refused with a sentence", () => {
    const dice = random(7);
    const small = { ...known.meshes[1], sources: known.meshes[1].sources };
    const begun = Date.now();
    const good = [fixture.sceneMessage([small]), known.frame(150), known.frame(151), known.end].map(alone);
    const stream = alone(fixture.streamOf([known.frame(150), known.end]));
    const counts = { read: 0, refused: 0 };
    for (let i = 0; i < 20000; i++) {
      const which = dice.below(good.length + 1);
      const bytes = damage(good[which] ?? stream, dice);
      const answer = which < good.length ? readMessage(bytes) : splitStream(bytes);
      if (answer.refused !== undefined) assert.match(answer.refused, /^[A-Z].*\.$/);
      counts[answer.refused === undefined ? "read" : "refused"]++;
      if (answer.kind === "frame") readouts.texts(answer, dice.below(3), { drawnRate: NaN });
    }
    assert(counts.read > 1000 && counts.refused > 1000, JSON.stringify(counts));
    assert(Date.now() - begun < 60000, `${Date.now() - begun} ms`);
  });
}

async function whatIsKept() {
  const { TickHistory } = tickHistory;
  const { FrameHistory } = frameHistory;
  const tick = (time, force) => ({ time, force, depth: 0, energy: 0, late: 0, took: 0 });
  await check("a peak of one tick survives in its column, whatever the width", () => {
    const ticks = new TickHistory(1 << 17);
    for (let i = 0; i < 60000; i++) ticks.add(tick(i / 1000, i === 41234 ? 9 : i === 51234 ? -3 : 1));
    for (const count of [1, 7, 300, 1000]) {
      const { most, least } = ticks.summary("force", 0, 60, count);
      assert.strictEqual(most[Math.floor((41.234 / 60) * count)], 9);
      assert.strictEqual(least[Math.floor((51.234 / 60) * count)], -3);
    }
  });
  await check("the ring of ticks keeps the last ones, in order, and takes none that are not later", () => {
    const ticks = new TickHistory(10000);
    for (let i = 0; i < 25000; i++) ticks.add(tick(i, i));
    for (const time of [3, 24999, NaN]) ticks.add(tick(time, 1e6));
    assert.deepStrictEqual(
      [ticks.size, ticks.from, ticks.to, ticks.find(20000), ticks.find(1e9)],
      [10000, 15000, 24999, 5000, 10000],
    );
    const { first, last, begins } = ticks.summary("force", 15000, 25000, 10);
    assert.deepStrictEqual([[...first][3], [...last][3], begins[3]], [18000, 18999, 18000]);
  });
  const kept = new FrameHistory({ mostBytes: 1e9, mostSeconds: 1 });
  for (let i = 0; i < 200; i++) kept.add(frameAt(i), alone(known.frame(i)));
  await check("of a running world the last frames are kept, and each has its bodies' vertices", () => {
    assert.deepStrictEqual([kept.size, readMessage(kept.get(0).bytes).number], [61, 139]);
    for (const i of [0, 1, 30, 60])
      near(kept.get(i).own.get(12)[3], known.meshes[1].positions[3] * fixture.swellAt(139 + i), 1e-8);
    assert.strictEqual(kept.get(0).own.has(11), false);
    const narrow = new FrameHistory({ mostBytes: 100000, mostSeconds: Infinity });
    for (let i = 0; i < 100; i++) narrow.add(frameAt(i), alone(known.frame(i)));
    assert(narrow.bytes <= 100000 && narrow.size > 1 && narrow.last.time === 99 / 60);
  });
  await check("time finds its frame; time that runs backwards begins anew", () => {
    assert.deepStrictEqual(
      [2.5, 2.51, 2.5166, 2.51667, 0, 99].map(time => readMessage(kept.get(kept.find(time)).bytes).number),
      [150, 150, 150, 151, 139, 199],
    );
    const again = new FrameHistory({ mostBytes: 1e9, mostSeconds: 9 });
    for (const i of [5, 6, 2]) again.add(frameAt(i), alone(known.frame(i)));
    assert.strictEqual(again.size, 1);
  });
  await check("the player keeps the recording's time at every speed, and stops at its end", () => {
    const play = new player.Player(kept, () => 0);
    const start = kept.get(0).time;
    for (const speed of [0.1, 0.5, 1, 4]) {
      play.reset(false);
      play.whole = true;
      play.setSpeed(speed);
      play.play();
      for (let now = 0; now <= 160; now += 16) play.advance(now);
      near(kept.get(play.index).time - start, 0.16 * speed, 1 / 60, `speed ${speed}:`);
      for (let now = 176; now <= 20000; now += 16) play.advance(now);
      assert.deepStrictEqual([play.index, play.playing], [60, false]);
    }
    play.toggle();
    assert.deepStrictEqual([play.index, play.playing], [0, true]);
    play.step(5);
    play.step(-2);
    assert.deepStrictEqual([play.index, play.playing], [3, false]);
  });
}

async function theRest() {
  await check("a simulated hand sends at most 60 places a second, and the last one always", () => {
    const sent = [];
    const one = new hand.Hand(
      () => [0, 0, 0],
      text => sent.push(text),
    );
    for (let now = 0; now < 1000; now++) one.want([now * 1e-6, 0, -0.5], now);
    one.flush(1020);
    one.flush(1040);
    assert(sent.length > 50 && sent.length <= 61, String(sent.length));
    assert.strictEqual(sent[sent.length - 1], "hand 0.0009990 0.0000000 -0.5000000");
    one.want([NaN, 0, 0], 2000);
    one.moveBy([0.1, 0, 0], 3000);
    assert.strictEqual(sent[sent.length - 1], "hand 0.1000000 0.0000000 0.0000000");
  });
  await check("a ray meets the nearest triangle, from either side", () => {
    const { positions, corners } = known.meshes[0];
    const shots = [
      [[0.06, 0.001, 1], [0, 0, -1], 0.025],
      [[0.06, 0.001, -1], [0, 0, 2], -0.025],
      [[0.06, 0.001, 0], [0, 0, 1], 0.025],
    ];
    for (const [origin, direction, wanted] of shots) {
      const { triangle, t } = rays.firstTriangle(positions, corners, origin, direction);
      const z = origin[2] + t * direction[2];
      const middle = [0, 1, 2].map(k =>
        [0, 1, 2].reduce((sum, c) => sum + positions[3 * corners[3 * triangle + c] + k] / 3, 0),
      );
      near([0.06, 0.001, z], middle, 0.004);
      near(z, wanted, 0.0005);
    }
    assert.strictEqual(rays.firstTriangle(positions, corners, [0, 0, 1], [0, 0, -1]), null);
  });
  await check("a mesh is closed where each edge has two triangles wound alike", () => {
    const [{ corners }] = known.meshes;
    const turned = corners.slice();
    const [a, b] = corners;
    turned.set([b, a]);
    assert.deepStrictEqual([corners, corners.subarray(3), turned].map(rays.isClosed), [true, false, false]);
  });
  await check("a bar's force is 1, 2 or 5 times a power of ten, and not above what fits", () => {
    assert.deepStrictEqual(
      [0, 0.1, 0.19, 0.2, 0.49, 0.5, 0.99, 1, 7, 50].map(scale.roundDown),
      [0, 0.1, 0.1, 0.2, 0.2, 0.5, 0.5, 1, 5, 50],
    );
  });
  await check("axes have round numbers; colours of depth grow lighter", () => {
    assert.deepStrictEqual(
      [0.3, 1, 1.1, 4.9, 70, 0, NaN, Infinity].map(scale.roundUp).map(x => Number(x.toPrecision(3))),
      [0.5, 1, 2, 5, 100, 0, 0, 0],
    );
    assert.deepStrictEqual(scale.ticks(0, 10, 4).values, [0, 5, 10]);
    const light = Array.from({ length: 20 }, (_, i) => scale.colour(i / 19)).map(
      ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b,
    );
    assert(light.every((value, i) => i === 0 || value > light[i - 1]));
    assert.deepStrictEqual(scale.colour(NaN), scale.colour(0));
  });
}

whatIsRead().then(whatIsRefused).then(whatIsKept).then(theRest).then(finish);
