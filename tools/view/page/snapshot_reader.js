// SPDX-License-Identifier: BSD-3-Clause
// Reads a snapshot of a world. The layout is that of include/dynpoint/snapshot.h. What it returns holds together: each
// range of items lies in its section. Numbers may still not be finite, and words may be newer than this page.
"use strict";
const snapshotReader = (() => {
  const { demand, open, typed } = checkedReading;
  const MAGIC = [0x89, 0x44, 0x50, 0x53, 0x0d, 0x0a, 0x1a, 0x0a];
  const HEADER = 64;
  const ENTRY = 24;
  const NONE = 0xffffffff;

  const fieldsOf = text =>
    text.split(",").map(field => {
      const [name, type, place, times] = field.trim().split(" ");
      return { name, type, place: Number(place), times: Number(times ?? 0) };
    });

  // A section: its kind, the least bytes of an item, and its fields: name, type, place, and how many where not one.
  const SECTIONS = {
    bodies: {
      kind: 1,
      least: 80,
      fields: fieldsOf("id u32 0, flags u32 4, firstVertex u32 8, vertices u32 12, pose f64 24 7"),
    },
    tools: {
      kind: 2,
      least: 248,
      fields: fieldsOf(`id u32 0, law u32 4, reason u32 8, flags u32 12, firstSegment u32 16, segments u32 20,
        firstContact u32 24, contacts u32 28, firstStrip u32 32, strips u32 36, nearestSegment u32 40, isFree u32 44,
        folds u64 56, pose f64 64 7, proxy f64 120 7, wrench f64 176 6, energy f64 224, lag f64 232, bodyWork f64 240`),
    },
    segments: {
      kind: 3,
      least: 224,
      fields:
        fieldsOf(`status u32 0, contact u32 4, flags u32 8, triangle u32 12, body u32 16, work u32 20, tool u32 24,
        a f64 32 3, b f64 56 3, radius f64 80, proxyA f64 88 3, proxyB f64 112 3, p f64 136 3, q f64 160 3,
        distance f64 184, gap f64 192, depth f64 200, errorBound f64 208, lowerBound f64 216`),
    },
    contacts: {
      kind: 4,
      least: 144,
      fields:
        fieldsOf(`id u32 0, body u32 4, segment u32 8, triangle u32 12, contact u32 16, flags u32 20, tool u32 24,
        s0 f64 32, s1 f64 40, s f64 48, gap f64 56, p f64 64 3, q f64 88 3, normal f64 112 3, overlap f64 136`),
    },
    strips: {
      kind: 5,
      least: 32,
      fields: fieldsOf("triangle u32 0, body u32 4, segment u32 8, flags u32 12, gap f64 16, overlap f64 24"),
    },
    channels: {
      kind: 7,
      least: 128,
      fields: fieldsOf(`id u32 0, body u32 4, triangle u32 8, flags u32 12, ruptures u32 16, layers u32 20, tool u32 24,
        entry f64 32 3, axis f64 56 3, radius f64 80, depth f64 88, deepest f64 96, inside f64 104, friction f64 112,
        tip f64 120`),
    },
  };
  const VERTICES = { kind: 6, least: 12 };

  function readItems(block, section, fields) {
    const items = [];
    for (let i = 0; section && i < section.count; i++) {
      const at = section.offset + i * section.stride;
      const item = {};
      for (const { name, type, place, times } of fields) {
        const read = k => block[type](at + place + 8 * k);
        item[name] = times ? Array.from({ length: times }, (_, k) => read(k)) : read(0);
      }
      items.push(item);
    }
    return items;
  }

  function readVertices(block, section) {
    if (!section) return new Float32Array(0);
    if (section.stride === VERTICES.least) return typed(Float32Array, block.bytes, section.offset, 3 * section.count);
    const all = new Float32Array(3 * section.count);
    for (let i = 0; i < section.count; i++)
      for (let k = 0; k < 3; k++) all[3 * i + k] = block.f32(section.offset + i * section.stride + 4 * k);
    return all;
  }

  // Kind of section: where it lies. Kinds that are not known here are left out.
  function readTable(block, header, sections) {
    const known = new Map(
      [...Object.entries(SECTIONS), ["vertices", VERTICES]].map(([name, one]) => [one.kind, [name, one]]),
    );
    const found = {};
    for (let i = 0; i < sections; i++) {
      const at = header + ENTRY * i;
      const [name, section] = known.get(block.u32(at)) ?? [];
      if (!name) continue;
      const count = block.u32(at + 4);
      const stride = block.u32(at + 8);
      const offset = block.u64(at + 16);
      demand(!found[name], `The snapshot has two sections of ${name}.`);
      demand(stride >= section.least, `The snapshot's ${name} have ${stride} bytes each, and need ${section.least}.`);
      demand(stride % 4 === 0 && offset % 8 === 0, `The snapshot's ${name} lie at an odd place.`);
      demand(offset + count * stride <= block.size, `The snapshot's ${name} end behind its end.`);
      found[name] = { count, stride, offset };
    }
    return found;
  }

  const inside = (first, count, all) => count === 0 || first + count <= all;

  function checkRanges({ bodies, tools, segments, contacts, strips, channels, vertices }) {
    for (const body of bodies) {
      demand(
        body.firstVertex === NONE || inside(body.firstVertex, body.vertices, vertices.length / 3),
        "A body's vertices end behind the snapshot's.",
      );
    }
    for (const tool of tools) {
      demand(
        inside(tool.firstSegment, tool.segments, segments.length),
        "A tool's segments end behind the snapshot's.",
      );
      demand(
        inside(tool.firstContact, tool.contacts, contacts.length),
        "A tool's contacts end behind the snapshot's.",
      );
      demand(inside(tool.firstStrip, tool.strips, strips.length), "A tool's strip ends behind the snapshot's.");
    }
    for (const { tool } of segments) demand(tool < tools.length, "A segment belongs to a tool that is not there.");
    for (const { tool } of channels) demand(tool < tools.length, "A channel belongs to a tool that is not there.");
    for (const { tool, segment } of contacts)
      demand(
        tool < tools.length && segment < tools[tool].segments,
        "A contact belongs to a segment that is not there.",
      );
  }

  // Throws a refusal; call it inside checkedReading.attempt.
  function read(bytes) {
    demand(bytes.byteLength >= HEADER, "The snapshot is shorter than its header.");
    const block = open(bytes);
    const header = block.u32(12);
    const sections = block.u32(44);
    demand(
      MAGIC.every((byte, i) => bytes[i] === byte),
      "The snapshot does not begin like one.",
    );
    demand(block.u32(8) === 1, `The snapshot is of version ${block.u32(8)}; this page reads version 1.`);
    demand(
      block.u64(16) === block.size && block.size % 8 === 0,
      "The snapshot's length is not the one that it states.",
    );
    demand(
      header >= HEADER && header % 8 === 0 && header + ENTRY * sections <= block.size,
      "The snapshot's table of sections ends behind its end.",
    );
    const time = block.f64(32);
    demand(Number.isFinite(time), "The snapshot's time is no number.");
    const found = readTable(block, header, sections);
    const snapshot = { steps: block.u64(24), time, flags: block.u32(40), work: block.u32(48) };
    for (const [name, section] of Object.entries(SECTIONS))
      snapshot[name] = readItems(block, found[name], section.fields);
    snapshot.vertices = readVertices(block, found.vertices);
    checkRanges(snapshot);
    return snapshot;
  }

  return { read, NONE };
})();
