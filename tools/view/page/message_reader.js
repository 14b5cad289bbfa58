// SPDX-License-Identifier: BSD-3-Clause
// Reads the messages from the server, and the stream of them in a page that plays by itself. Both readers answer
// { refused: sentence } for what does not hold together, and throw for nothing that bytes can do.
"use strict";
const messageReader = (() => {
  const { demand, attempt, open, typed } = checkedReading;
  const SCENE = 1;
  const FRAME = 2;
  const END = 3;
  const FRAME_HEADER = 80;
  const TICK = 40;
  const POSE = 7;
  const LOOKS = ["organ", "cloth", "bone"];
  const TOOL_LOOKS = ["none", "stylus", "needle", "scalpel", "forceps", "laparoscope"];
  const isCount = value => Number.isInteger(value) && value >= 0 && value < 2 ** 32;
  const isText = value => typeof value === "string" && value.length <= 4096;
  const areNumbers = (value, count) => Array.isArray(value) && value.length === count && value.every(Number.isFinite);
  const isObject = value => typeof value === "object" && value !== null && !Array.isArray(value);
  const eight = size => Math.ceil(size / 8) * 8;

  function decode(bytes, what) {
    try {
      return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    } catch {
      return demand(false, `${what} is not UTF-8.`);
    }
  }

  function parse(text) {
    try {
      return JSON.parse(text);
    } catch {
      return demand(false, "The scene's JSON cannot be read.");
    }
  }

  function readMesh(mesh, blob, index) {
    const what = `Mesh ${index} of the scene`;
    demand(isObject(mesh) && isText(mesh.name), `${what} has no name.`);
    const { name, vertices, triangles } = mesh;
    demand(
      [vertices, triangles, mesh.positions, mesh.corners, mesh.sources].every(isCount),
      `${what} lacks a number.`,
    );
    const place = (at, count) =>
      demand(at % 4 === 0 && at + 4 * count <= blob.byteLength, `${what} ends behind its message.`);
    place(mesh.positions, 3 * vertices);
    place(mesh.corners, 3 * triangles);
    place(mesh.sources, triangles);
    const positions = typed(Float32Array, blob, mesh.positions, 3 * vertices);
    const corners = typed(Uint32Array, blob, mesh.corners, 3 * triangles);
    demand(
      corners.every(corner => corner < vertices),
      `${what} has a triangle with a corner that is not there.`,
    );
    demand(positions.every(Number.isFinite), `${what} has a coordinate that is no number.`);
    return {
      name,
      vertices,
      triangles,
      positions,
      corners,
      sources: typed(Uint32Array, blob, mesh.sources, triangles),
    };
  }

  function readDevice(device) {
    if (device === null || device === undefined) return null;
    demand(
      isObject(device) && isText(device.name) && Number.isFinite(device.rate),
      "The scene's device cannot be read.",
    );
    const box = device.workspace ?? null;
    demand(
      box === null || (areNumbers(box, 6) && [0, 1, 2].every(k => box[k] <= box[k + 3])),
      "The device's workspace is no box.",
    );
    return { name: device.name, simulated: device.simulated === true, rate: device.rate, workspace: box };
  }

  function readDressPart(part, meshes) {
    demand(isObject(part) && isCount(part.mesh) && part.mesh < meshes.length, "A part of the tool has no mesh.");
    demand(areNumbers(part.pose, POSE), "A part of the tool has no pose.");
    const { mesh, pose, hinge = null, colour = null } = part;
    demand(hinge === null || areNumbers(hinge, 7), "A hinge of the tool is not seven numbers.");
    demand(colour === null || areNumbers(colour, 3), "The colour of a part of the tool is not three numbers.");
    return { mesh, pose, hinge, colour };
  }

  function readScene(bytes, message) {
    demand(message.size >= 8, "The scene is cut off.");
    const end = 8 + message.u32(4);
    const blobFrom = eight(end);
    demand(blobFrom <= message.size, "The scene's JSON ends behind its message.");
    const json = parse(decode(bytes.subarray(8, end), "The scene's JSON"));
    demand(isObject(json), "The scene's JSON is no object.");
    const blob = bytes.subarray(blobFrom);
    const { title, program, mode } = json;
    demand(isText(title) && isText(program), "The scene has no title or no program.");
    demand(["live", "recording", "mesh"].includes(mode), "The scene's mode is not known.");
    demand(Array.isArray(json.meshes) && Array.isArray(json.bodies), "The scene has no list of meshes or bodies.");
    const forceMax = json.force_max ?? null;
    demand(
      forceMax === null || (Number.isFinite(forceMax) && forceMax > 0),
      "The scene's largest force is no number above 0.",
    );
    const camera = json.camera ?? null;
    demand(camera === null || areNumbers(camera, 9), "The scene's camera is not nine numbers.");
    const inset = json.inset ?? null;
    demand(inset === null || areNumbers(inset, 9), "The scene's inset is not nine numbers.");
    const look = json.look ?? null;
    demand(look === null || TOOL_LOOKS.includes(look), "The tool's look is not known.");
    const meshes = json.meshes.map((mesh, i) => readMesh(mesh, blob, i));
    demand(Array.isArray(json.dress ?? []), "The scene's list of the tool's parts is none.");
    const dress = (json.dress ?? []).map(part => readDressPart(part, meshes));
    const ids = new Set();
    const bodies = json.bodies.map(body => {
      demand(
        isObject(body) && isCount(body.id) && !ids.has(body.id),
        "A body of the scene has no number of its own.",
      );
      demand(isCount(body.mesh) && body.mesh < meshes.length, "A body's mesh is not in the scene.");
      demand(areNumbers(body.pose, POSE) && isText(body.name), "A body of the scene has no pose or no name.");
      const colour = body.colour ?? null;
      demand(
        colour === null || (areNumbers(colour, 3) && colour.every(part => part >= 0 && part <= 1)),
        "A body's colour is not three numbers from 0 to 1.",
      );
      const look = body.look ?? LOOKS[0];
      demand(LOOKS.includes(look), "A body's look is not known.");
      ids.add(body.id);
      return { id: body.id, mesh: body.mesh, pose: body.pose, name: body.name, colour, look };
    });
    return {
      kind: "scene",
      title,
      program,
      mode,
      control: json.control === true,
      device: readDevice(json.device),
      up: json.up === "y" ? "y" : "z",
      forceMax,
      camera,
      inset,
      look,
      hasJaws: json.jaws === true,
      dress,
      meshes,
      bodies,
    };
  }

  function readTicks(message, from, count) {
    return Array.from({ length: count }, (_, i) => {
      const at = from + TICK * i;
      return {
        time: message.f64(at),
        force: message.f32(at + 8),
        depth: message.f32(at + 12),
        energy: message.f32(at + 16),
        late: message.f32(at + 20),
        took: message.f32(at + 24),
        contact: message.u32(at + 28),
        reason: message.u32(at + 32),
        opening: message.f32(at + 36),
      };
    });
  }

  function readFrame(bytes, message) {
    demand(message.size >= FRAME_HEADER, "A frame is cut off.");
    const size = message.u32(4);
    const ticks = message.u32(8);
    const ticksFrom = FRAME_HEADER + size;
    demand(ticksFrom + TICK * ticks <= message.size, "A frame's snapshot or ticks end behind its message.");
    return {
      kind: "frame",
      number: message.u64(16),
      dropped: message.u64(24),
      ticksLost: message.u64(32),
      hapticRate: message.f64(40),
      physicsRate: message.f64(48),
      viewRate: message.f64(56),
      lateP99: message.f64(64),
      tickP99: message.f64(72),
      snapshot: snapshotReader.read(bytes.subarray(FRAME_HEADER, ticksFrom)),
      ticks: readTicks(message, ticksFrom, ticks),
    };
  }

  function readEnd(bytes, message) {
    demand(message.size >= 8 && 8 + message.u32(4) <= message.size, "The last message is cut off.");
    return { kind: "end", text: decode(bytes.subarray(8, 8 + message.u32(4)), "The last message") };
  }

  const readMessage = bytes =>
    attempt(() => {
      demand(bytes.byteLength >= 4, "A message is shorter than its kind.");
      const message = open(bytes);
      const kind = message.u32(0);
      const read = { [SCENE]: readScene, [FRAME]: readFrame, [END]: readEnd }[kind];
      demand(read, `A message is of kind ${kind}, which this page does not know.`);
      return read(bytes, message);
    });

  // { messages: [bytes...] }
  const splitStream = bytes =>
    attempt(() => {
      const stream = open(bytes);
      const messages = [];
      for (let at = 0; at < stream.size;) {
        demand(at + 8 <= stream.size, "The page's data are cut off.");
        const size = stream.u64(at);
        const end = at + 8 + size;
        demand(end <= stream.size, "A message of the page's data ends behind them.");
        messages.push(bytes.subarray(at + 8, end));
        at += 8 + eight(size);
      }
      return { messages };
    });

  const baseSixtyFour = /^[A-Za-z0-9+/]*={0,2}$/;
  // Base64 without line breaks, in parts: one string of all bytes would be as large again.
  const decodeText = text =>
    attempt(() => {
      const PART = 4 << 16;
      const padding = text.endsWith("==") ? 2 : text.endsWith("=") ? 1 : 0;
      demand(text.length % 4 === 0, "The page's data are cut off.");
      const bytes = new Uint8Array((text.length / 4) * 3 - padding);
      for (let at = 0, to = 0; at < text.length; at += PART) {
        const part = text.slice(at, at + PART);
        demand(
          baseSixtyFour.test(part) && (at + PART >= text.length || !part.endsWith("=")),
          "The page's data are not base64.",
        );
        const raw = atob(part);
        for (let i = 0; i < raw.length; i++) bytes[to++] = raw.charCodeAt(i);
      }
      return { bytes };
    });

  // Why a frame does not belong to a scene: a sentence, or null.
  function misfit(frame, scene) {
    for (const body of frame.snapshot.bodies) {
      const known = scene.bodies.find(({ id }) => id === body.id);
      if (known && body.vertices !== 0 && body.vertices !== scene.meshes[known.mesh].vertices)
        return `Body ${body.id} has ${body.vertices} vertices in a frame, and ${scene.meshes[known.mesh].vertices} in the scene.`;
    }
    return null;
  }

  return { readMessage, splitStream, decodeText, misfit };
})();
