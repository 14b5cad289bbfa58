// SPDX-License-Identifier: BSD-3-Clause
// The loop of the worker: as many ticks as are due, at 1 kHz of the browser's clock; frames for the page as it draws
// them; and what rate was reached. It has neither clock nor channel of its own: tests give it others.
"use strict";
const touchLoop = (() => {
  const TICK = 0.001; // s
  const CATCH_UP = 0.03; // s: what is later is left out
  const LONGEST = 25; // ms that one call may take
  const FRAME = 1000 / 60; // ms
  const ON_THE_WAY = 2; // frames that the page has not drawn yet
  const MOST_TICKS = 8192; // of a frame
  const TOLD = 250; // ms between reports
  const STRETCHES = 4; // of that length that a report is about
  const SPAN = 1000; // ticks that it is about
  const TURN = Math.cos(Math.PI / 6); // of the force, from a tick to the next
  const LEAST = 1e-3; // N: a force below it has no direction

  const p99 = values => Float32Array.from(values).sort()[Math.floor(0.99 * values.length)] ?? 0;

  // How the force changed in the last ticks.
  class Changes {
    constructor() {
      this.turned = new Uint8Array(SPAN);
      this.jump = new Float32Array(SPAN);
      this.last = [0, 0, 0];
      this.count = 0;
    }

    add(force) {
      const { last } = this;
      const lengths = Math.hypot(...force) * Math.hypot(...last);
      const along = force[0] * last[0] + force[1] * last[1] + force[2] * last[2];
      const place = this.count++ % SPAN;
      this.turned[place] = lengths > LEAST * LEAST && along < TURN * lengths ? 1 : 0;
      this.jump[place] = Math.hypot(force[0] - last[0], force[1] - last[1], force[2] - last[2]);
      this.last = force;
    }

    report() {
      return { turned: this.turned.reduce((sum, one) => sum + one, 0), jump: Math.max(...this.jump) };
    }
  }

  class TouchLoop {
    // on: { now() in ms, send(message bytes), tell(report) }
    constructor(touch, on) {
      this.touch = touch;
      this.on = on;
      this.changes = new Changes();
      this.idle = null; // what moves the finger while nobody does: a function of the time
      this.lost = 0;
      this.dropped = 0;
      this.number = 0;
      this.away = ON_THE_WAY; // until the page has read the scene
      this.unsent = [];
      this.late = [];
      this.took = [];
      this.frameAt = -Infinity;
      this.pace = new dynpoint.Pace({ period: TICK, catchUp: CATCH_UP });
      this.resume();
    }

    // From now on, as if no time had passed.
    resume() {
      const now = this.on.now();
      this.pace.begin(now);
      this.stretches = [{ at: now, ticks: 0, busy: 0, frames: 0 }];
    }

    get stretch() {
      return this.stretches[this.stretches.length - 1];
    }

    // Called every few ms.
    beat() {
      const now = this.on.now();
      this.run(now);
      if (now - this.frameAt >= FRAME) this.frame(now);
      if (now - this.stretch.at >= TOLD) this.report(now);
    }

    run(now) {
      const { pace } = this;
      this.lost += pace.skip(now);
      const from = pace.done;
      while (pace.due(now) > 0 && this.on.now() - now < LONGEST) this.tick(now);
      const count = pace.done - from;
      if (count === 0) return;
      const busy = this.on.now() - now;
      this.stretch.ticks += count;
      this.stretch.busy += busy;
      for (let i = 0; i < count; i++) this.took.push(busy / count / 1000);
      for (const tick of this.unsent.slice(-count)) tick.took = busy / count / 1000;
    }

    tick(now) {
      const { touch } = this;
      if (this.idle) touch.device.want(this.idle(touch.time));
      const tick = touch.step();
      this.changes.add(touch.force);
      tick.late = Math.max(0, this.pace.late(now)) / 1000;
      this.pace.done++;
      this.late.push(tick.late);
      this.unsent.push(tick);
      this.onTick?.(touch);
    }

    frame(now) {
      this.frameAt = Math.max(this.frameAt + FRAME, now - FRAME);
      if (this.unsent.length > MOST_TICKS) this.lost += this.unsent.splice(0, this.unsent.length - MOST_TICKS).length;
      if (this.unsent.length === 0) return;
      this.number++;
      if (this.away >= ON_THE_WAY) {
        this.dropped++;
        return;
      }
      this.away++;
      this.stretch.frames++;
      this.on.send(touchMessages.frame(this.touch.snapshot(), this.unsent, this.counts()));
      this.unsent = [];
    }

    counts() {
      return {
        number: this.number,
        dropped: this.dropped,
        lost: this.lost,
        hapticRate: this.rate ?? 0,
        physicsRate: this.touch.isSoft ? (this.rate ?? 0) : 0,
        viewRate: this.viewRate ?? 0,
        lateP99: this.lateP99 ?? 0,
        tookP99: this.tookP99 ?? 0,
      };
    }

    report(now) {
      const sum = name => this.stretches.reduce((all, stretch) => all + stretch[name], 0);
      const seconds = (now - this.stretches[0].at) / 1000;
      const ticks = sum("ticks");
      this.rate = ticks / seconds;
      this.viewRate = sum("frames") / seconds;
      this.lateP99 = p99((this.late = this.late.slice(-SPAN)));
      this.tookP99 = p99((this.took = this.took.slice(-SPAN)));
      const micros = ticks > 0 ? (1000 * sum("busy")) / ticks : 0;
      this.on.tell({ rate: this.rate, micros, ticks: this.touch.ticks, lost: this.lost, ...this.changes.report() });
      this.stretches = [...this.stretches.slice(1 - STRETCHES), { at: now, ticks: 0, busy: 0, frames: 0 }];
    }

    // The page's words: docs/view.md, "Messages".
    hear(text) {
      if (text === "ready") this.away = 0;
      else if (text === "drawn") this.away = Math.max(0, this.away - 1);
      else if (text.startsWith("hand ")) {
        this.idle = null;
        this.touch.device.want(text.slice(5).split(" ").map(Number));
      }
    }
  }

  // A finger that presses along a body whose half extents are given, and how far it hangs, m, until somebody comes.
  const idleOver = (half, sag = 0) => time => {
    const part = 0.5 - 0.5 * Math.cos((2 * Math.PI * time) / 6); // of the way down
    const depth = sag + Math.min(0.03, 0.02 + 0.3 * half[1]);
    return [
      0.45 * half[0] * Math.sin((2 * Math.PI * time) / 13),
      half[1] + 0.02 - part * (0.02 + half[1] * 0.35 + depth),
      0.2 * half[2] * Math.sin((2 * Math.PI * time) / 7),
    ];
  };

  return { TouchLoop, idleOver };
})();
