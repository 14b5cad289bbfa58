// SPDX-License-Identifier: BSD-3-Clause
// The frames that can be shown: their bytes, oldest first. A frame that does not hold the vertices of a body points to
// those of the frame before it, so any frame can be shown alone, also when the older ones have gone.
"use strict";
const frameHistory = (() => {
  const { NONE } = snapshotReader;

  class FrameHistory {
    // mostBytes: of all frames together. mostSeconds: from the first to the last.
    constructor({ mostBytes, mostSeconds }) {
      this.mostBytes = mostBytes;
      this.mostSeconds = mostSeconds;
      this.clear();
    }

    clear() {
      this.list = [];
      this.gone = 0;
      this.bytes = 0;
    }

    get size() {
      return this.list.length - this.gone;
    }

    get(i) {
      return this.list[this.gone + i];
    }

    get last() {
      return this.list[this.list.length - 1];
    }

    // `bytes` are kept as they are: nobody may write to them later. Time that runs backwards begins anew.
    add(frame, bytes) {
      const { snapshot } = frame;
      if (this.size > 0 && snapshot.time < this.last.time) this.clear();
      const own = new Map(this.size > 0 ? this.last.own : []);
      let changed = this.size === 0;
      for (const body of snapshot.bodies) {
        if (body.vertices === 0 || body.firstVertex === NONE) continue;
        own.set(body.id, snapshot.vertices.subarray(3 * body.firstVertex, 3 * (body.firstVertex + body.vertices)));
        changed = true;
      }
      this.list.push({ bytes, time: snapshot.time, own: changed ? own : this.last.own });
      this.bytes += bytes.byteLength;
      while (this.size > 1 && (this.bytes > this.mostBytes || this.last.time - this.get(0).time > this.mostSeconds))
        this.drop();
    }

    drop() {
      this.bytes -= this.get(0).bytes.byteLength;
      this.list[this.gone++] = undefined;
      if (this.gone > 1024 && 2 * this.gone > this.list.length) {
        this.list = this.list.slice(this.gone);
        this.gone = 0;
      }
    }

    // The last frame that is not later than this time; 0 if all are.
    find(time) {
      let low = 0;
      let high = this.size;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.get(middle).time <= time) low = middle + 1;
        else high = middle;
      }
      return Math.max(0, low - 1);
    }
  }

  return { FrameHistory };
})();
