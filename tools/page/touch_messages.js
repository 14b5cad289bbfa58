// SPDX-License-Identifier: BSD-3-Clause
// Writes the messages that the viewer reads (docs/view.md, "Messages"): the scene and frames.
"use strict";
const touchMessages = (() => {
  const SCENE = 1;
  const FRAME = 2;
  const HEADER = 80;
  const TICK = 40;
  const eight = size => Math.ceil(size / 8) * 8;

  // details: what the JSON has besides the mesh and the body
  function scene(touch, details) {
    const { mesh, body, pose } = touch;
    const positions = mesh.getVertices();
    const { corners, numbers } = mesh.getTriangles();
    const parts = [positions, corners, numbers];
    const places = parts.map((_, i) => parts.slice(0, i).reduce((sum, part) => sum + part.byteLength, 0));
    const { colour = null, look = "organ", title } = touch.scene;
    const json = {
      title,
      mode: "live",
      control: true,
      up: "y",
      frame_rate: 60,
      force_max: null,
      camera: null,
      look: "stylus",
      meshes: [
        {
          name: "",
          vertices: positions.length / 3,
          triangles: numbers.length,
          positions: places[0],
          corners: places[1],
          sources: places[2],
        },
      ],
      bodies: [{ id: body, name: title, mesh: 0, pose, colour, look }],
      ...details,
    };
    const text = new TextEncoder().encode(JSON.stringify(json));
    const blob = eight(8 + text.length);
    const message = new Uint8Array(blob + parts.reduce((sum, part) => sum + part.byteLength, 0));
    new Uint32Array(message.buffer, 0, 2).set([SCENE, text.length]);
    message.set(text, 8);
    parts.forEach((part, i) => message.set(new Uint8Array(part.buffer), blob + places[i]));
    return message;
  }

  // counts: { number, dropped, lost, hapticRate, physicsRate, viewRate, lateP99, tookP99 }
  function frame(snapshot, ticks, counts) {
    const message = new Uint8Array(HEADER + snapshot.length + TICK * ticks.length);
    const view = new DataView(message.buffer);
    const { number, dropped, lost, hapticRate, physicsRate, viewRate, lateP99, tookP99 } = counts;
    [FRAME, snapshot.length, ticks.length, 0].forEach((value, i) => view.setUint32(4 * i, value, true));
    [number, dropped, lost].forEach((value, i) => view.setBigUint64(16 + 8 * i, BigInt(value), true));
    [hapticRate, physicsRate, viewRate, lateP99, tookP99].forEach((value, i) =>
      view.setFloat64(40 + 8 * i, value, true),
    );
    message.set(snapshot, HEADER);
    ticks.forEach((tick, i) => {
      const at = HEADER + snapshot.length + TICK * i;
      view.setFloat64(at, tick.time, true);
      [tick.force, tick.depth, tick.energy, tick.late, tick.took].forEach((value, k) =>
        view.setFloat32(at + 8 + 4 * k, value, true),
      );
      [tick.contact, tick.reason].forEach((value, k) => view.setUint32(at + 28 + 4 * k, value, true));
    });
    return message;
  }

  return { scene, frame };
})();
