// SPDX-License-Identifier: BSD-3-Clause
// Ticks at a steady rate, as well as a worker's clock and sleep allow.
"use strict";

// Which ticks are due by a clock in ms. Who is late catches up a while; what is later is left out.
class Pace {
  // period, catchUp: s
  constructor({ period = 0.001, catchUp = 0.03 } = {}) {
    if (!(period > 0 && period < Infinity && catchUp >= 0))
      throw new RangeError("a period is above 0 s, and catchUp not below");
    this.period = 1000 * period;
    this.catchUp = 1000 * catchUp;
  }

  begin(now) {
    this.begun = now;
    this.done = 0;
  }

  // ms by which the next tick is behind its time; below 0: how long it still has
  late(now) {
    return now - this.begun - (this.done + 1) * this.period;
  }

  // Leaves out what cannot be caught up; how many ticks that is.
  skip(now) {
    const left = Math.floor((this.late(now) + this.period - this.catchUp) / this.period);
    if (left <= 0) return 0;
    this.begun += left * this.period;
    return left;
  }

  due(now) {
    return Math.floor((now - this.begun) / this.period) - this.done;
  }
}

const KEPT = 4096; // ticks that a loop tells of
const SPIN = 0.1; // ms: a sleep ends that much earlier, as it may last longer
const TIMER = 4; // ms: browsers have no shorter timer

// Median, 99 % and most of what the first numbers of a ring are.
function spread(ring, count) {
  const sorted = ring.slice(0, Math.min(count, ring.length)).sort();
  const at = part => (sorted.length > 0 ? sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))] : 0);
  return { median: at(0.5), p99: at(0.99), most: at(1) };
}

// How a loop waits: a thread that may sleep does. Others turn round without pause, or have a timer.
function waits() {
  try {
    const cell = new Int32Array(new SharedArrayBuffer(4));
    Atomics.wait(cell, 0, 0, 0);
    return { sleep: ms => Atomics.wait(cell, 0, 0, ms) };
  } catch {
    return {};
  }
}

// A next turn of this thread: messages are heard before it.
function turns() {
  if (typeof setImmediate === "function") return { turn: work => setImmediate(work), end: () => {} };
  const { port1, port2 } = new MessageChannel();
  let next = null;
  port1.onmessage = () => next();
  return {
    turn: work => {
      next = work;
      port2.postMessage(0);
    },
    end: () => port1.close(),
  };
}

/*
 * Calls tick(number) each period, in a worker. Options: period, catchUp (s); wait: "sleep", "turn" or "timer", by default
 * "sleep" where this thread may sleep, else "turn".
 */
class Loop {
  constructor(tick, { wait, ...options } = {}) {
    if (typeof tick !== "function") throw new TypeError("a loop has a function to call");
    const { sleep } = waits();
    this.wait = wait ?? (sleep ? "sleep" : "turn");
    if (!["sleep", "turn", "timer"].includes(this.wait))
      throw new TypeError('a loop waits by "sleep", "turn" or "timer"');
    if (this.wait === "sleep" && !sleep)
      throw new TypeError("this thread cannot sleep: a page's own never can, a worker's where the page is isolated");
    this.tick = tick;
    this.pace = new Pace(options);
    this.sleep = sleep;
    this.ticks = 0;
    this.lost = 0;
    this.late = new Float32Array(KEPT);
    this.took = new Float32Array(KEPT);
    this.isRunning = false;
    this.hasEnded = true;
  }

  // Until stop(), or until a tick throws: what getInfo tells.
  run() {
    if (!this.hasEnded) throw new Error("this loop runs");
    this.hasEnded = false;
    this.isRunning = true;
    this.pace.begin(performance.now());
    const { turn, end } = turns();
    return new Promise((resolve, reject) => {
      const leave = (how, what) => {
        this.isRunning = false;
        this.hasEnded = true;
        end();
        how(what);
      };
      const round = () => {
        try {
          this.round();
        } catch (error) {
          leave(reject, error);
          return;
        }
        if (!this.isRunning) leave(resolve, this.getInfo());
        else if (this.wait === "timer") setTimeout(round, Math.max(TIMER, -this.pace.late(performance.now())));
        else turn(round);
      };
      turn(round);
    });
  }

  stop() {
    this.isRunning = false;
  }

  // The ticks that are due; where this thread sleeps, it does so until the next one.
  round() {
    const { pace } = this;
    let now = performance.now();
    if (this.wait === "sleep") {
      const left = -pace.late(now) - SPIN;
      if (left > 0) this.sleep(left);
      while (pace.late((now = performance.now())) < 0);
    }
    this.lost += pace.skip(now);
    for (let due = pace.due(now); due > 0 && this.isRunning; due--) {
      const place = this.ticks % KEPT;
      this.late[place] = Math.max(0, pace.late(now)) / 1000;
      this.tick(this.ticks);
      const after = performance.now();
      this.took[place] = (after - now) / 1000;
      now = after;
      pace.done++;
      this.ticks++;
    }
  }

  // ticks, and those that were left out; of the last ticks, in s: how late they began, and what they took
  getInfo() {
    const { ticks, lost, wait } = this;
    return { ticks, lost, wait, late: spread(this.late, ticks), took: spread(this.took, ticks) };
  }
}
