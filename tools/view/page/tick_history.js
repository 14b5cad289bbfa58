// SPDX-License-Identifier: BSD-3-Clause
// The ticks that the plots show: columns of numbers by time. It grows up to `most` ticks, then the oldest go.
"use strict";
const tickHistory = (() => {
  const NAMES = ["force", "depth", "energy", "late", "took"];

  class TickHistory {
    constructor(most) {
      this.most = most;
      this.clear();
    }

    clear() {
      this.size = 0;
      this.first = 0;
      this.allocate(Math.min(this.most, 4096));
    }

    allocate(room) {
      const before = this.columns;
      const size = this.size;
      const columns = { time: new Float64Array(room) };
      for (const name of NAMES) columns[name] = new Float32Array(room);
      if (before && size > 0) for (const name in columns) columns[name].set(before[name].subarray(0, size));
      this.columns = columns;
      this.room = room;
    }

    at(i) {
      return (this.first + i) % this.room;
    }

    time(i) {
      return this.columns.time[this.at(i)];
    }

    get from() {
      return this.size > 0 ? this.time(0) : 0;
    }

    get to() {
      return this.size > 0 ? this.time(this.size - 1) : 0;
    }

    // A tick that is not later than the last one has no place on the axis, and is left out.
    add(tick) {
      if (!Number.isFinite(tick.time) || (this.size > 0 && tick.time <= this.to)) return;
      if (this.size === this.room && this.room < this.most) this.allocate(Math.min(2 * this.room, this.most));
      if (this.size === this.room) this.first = this.at(1);
      else this.size++;
      const place = this.at(this.size - 1);
      this.columns.time[place] = tick.time;
      for (const name of NAMES) this.columns[name][place] = tick[name];
    }

    // The first tick at this time or later; `size` if there is none.
    find(time) {
      let low = 0;
      let high = this.size;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.time(middle) < time) low = middle + 1;
        else high = middle;
      }
      return low;
    }

    // For each of `count` equal stretches from `from` to `to`: first, least, most and last value, and the times of the
    // first and last; NaN where no tick has a number. The extremes of a column survive, however long it is.
    summary(name, from, to, count) {
      const first = new Float32Array(count).fill(NaN);
      const least = first.slice();
      const most = first.slice();
      const last = first.slice();
      const begins = new Float64Array(count).fill(NaN);
      const ends = begins.slice();
      const values = this.columns[name];
      const scale = count / (to - from);
      if (!(scale > 0)) return { first, least, most, last, begins, ends };
      for (let i = this.find(from); i < this.size; i++) {
        const place = this.at(i);
        const time = this.columns.time[place];
        const value = values[place];
        if (time > to) break;
        if (!Number.isFinite(value)) continue;
        const column = Math.min(count - 1, Math.floor((time - from) * scale));
        if (Number.isNaN(first[column])) {
          first[column] = least[column] = most[column] = value;
          begins[column] = time;
        }
        if (value < least[column]) least[column] = value;
        if (value > most[column]) most[column] = value;
        last[column] = value;
        ends[column] = time;
      }
      return { first, least, most, last, begins, ends };
    }
  }

  return { TickHistory };
})();
