// SPDX-License-Identifier: BSD-3-Clause
// How deep a tool is, in the words of docs/concepts.md, from a snapshot.
"use strict";
const depths = (() => {
  const KNOWN = 1; // flag of a segment: its gap and depth are known
  const IN = 2; // contact from here on: touching, penetrating

  const segmentOf = (snapshot, contact) =>
    snapshot.segments[snapshot.tools[contact.tool].firstSegment + contact.segment];

  // Of a contact at the proxy, which is outside: how far the device is behind it, along the normal.
  function ofContact(snapshot, contact) {
    const { a, b, proxyA, proxyB } = segmentOf(snapshot, contact);
    const held = rays.sub(rays.along(proxyA, proxyB, contact.s), rays.along(a, b, contact.s));
    return Math.max(0, ...[-contact.gap, rays.dot(held, contact.normal)].filter(Number.isFinite));
  }

  /*
   * Of a tool that is in a body: its own depth where the snapshot has it, else that of its deepest contact, else the
   * tick's, which is how far the proxy holds the device back. null: it is free, or nothing is known.
   *   segment  the tool's nearest one; tick: the frame's last one, or undefined
   */
  function ofTool(snapshot, index, segment, tick) {
    if (!segment || !(segment.contact >= IN)) return null;
    if (segment.flags & KNOWN && Number.isFinite(segment.depth)) return segment.depth;
    const own = snapshot.contacts.filter(({ tool }) => tool === index);
    const deepest = Math.max(...own.map(contact => ofContact(snapshot, contact)), -Infinity);
    if (Number.isFinite(deepest)) return deepest;
    if (Number.isFinite(tick?.depth)) return tick.depth;
    const inside = segment.radius - segment.distance; // at least: the axis may be inside as well
    return Number.isFinite(inside) ? Math.max(0, inside) : null;
  }

  // The signed distance of a free tool's surface; null where it is not known.
  function gapOf(segment) {
    if (!segment) return null;
    if (segment.flags & KNOWN && Number.isFinite(segment.gap)) return segment.gap;
    const outside = segment.distance - Math.max(0, segment.radius);
    return segment.contact === 1 && Number.isFinite(outside) ? outside : null;
  }

  return { segmentOf, ofContact, ofTool, gapOf, KNOWN };
})();
