// SPDX-License-Identifier: BSD-3-Clause
// The channels of needles: a rim round each hole, seen through the body; the part of a shaft that is beyond the entry,
// and what of a channel is empty. And the numbers of those that a tool is in.
"use strict";
const channelView = (() => {
  const { CapsuleBatch } = capsuleBatch;
  const OCCUPIED = 1; // bit of a channel's flags
  const RIM = 2.5; // of a hole, in radii of the needle
  const millimetres = value => (Number.isFinite(value) ? `${(1e3 * value).toFixed(2)} mm` : "\u2013");

  const isIn = channel => (channel.flags & OCCUPIED) !== 0;
  const at = ({ entry, axis }, depth) => entry.map((value, k) => value + depth * axis[k]);

  // The stretches of a channel that are drawn, by depth: where the shaft is, and where none is.
  function stretchesOf(channel, segment) {
    const { depth, deepest } = channel;
    if (!isIn(channel)) return { shaft: null, empty: deepest > 0 ? [0, deepest] : null };
    const long = segment ? rays.length(rays.sub(segment.proxyB, segment.proxyA)) : depth;
    return {
      shaft: depth > 0 ? [Math.max(0, depth - long), depth] : null,
      empty: deepest > depth ? [Math.max(0, depth), deepest] : null,
    };
  }

  // Of the channels that a tool is in: how deep, how much of it is inside, and what it has gone through.
  function texts(snapshot, index) {
    const own = (snapshot.channels ?? []).filter(channel => channel.tool === index && isIn(channel));
    if (own.length === 0) return { needleDepth: "\u2013", needleInside: "\u2013", needleThrough: "\u2013" };
    const sum = name => own.reduce((all, channel) => all + channel[name], 0);
    return {
      needleDepth: millimetres(Math.max(...own.map(({ depth }) => depth))),
      needleInside: millimetres(sum("inside")),
      needleThrough: `${sum("ruptures")}, ${sum("layers")}`,
    };
  }

  class ChannelView {
    constructor() {
      const through = (order, opacity) =>
        Object.assign(
          new THREE.MeshBasicMaterial({
            vertexColors: true,
            transparent: true,
            depthTest: false,
            depthWrite: false,
            opacity,
          }),
          { userData: { order } },
        );
      this.shafts = new CapsuleBatch([through(5, 0.75)]);
      this.holes = new CapsuleBatch([through(5, 0.35)]);
      this.batches = [this.shafts, this.holes];
    }

    // snapshot: with channels or without; the rest as ToolView.draw
    add(snapshot, colours, camera) {
      for (const channel of snapshot.channels ?? []) {
        const { entry, axis, radius, tool } = channel;
        if (!rays.isPlace(entry) || !rays.isPlace(axis)) continue;
        const pixel = camera.pixelSize(entry);
        const thick = Math.max(radius || 0, pixel);
        const { shaft, empty } = stretchesOf(channel, snapshot.segments[snapshot.tools[tool]?.firstSegment]);
        const rod = (batch, [from, to], width, colour) =>
          batch.add(at(channel, from), at(channel, to), width, width, 0, colour);
        if (shaft) rod(this.shafts, shaft, thick, colours.proxy);
        if (empty) rod(this.holes, empty, 0.6 * thick, colours.pair);
        const rim = Math.max(RIM * thick, 3 * pixel);
        rod(this.holes, [-0.1 * rim, 0.1 * rim], rim, colours.pair);
      }
    }
  }

  return { ChannelView, stretchesOf, texts };
})();
