// SPDX-License-Identifier: BSD-3-Clause
// A simulated device in a hand: a mass with damping, which a finger pulls by a spring, and a force that stands still
// for a period, as a sampled device has it. Between two samples its motion is solved exactly, so that its limit of
// stability is a real device's (dpt_stable_stiffness).
"use strict";
const heldDevice = (() => {
  const MASS = 0.1; // kg
  const DAMPING = 4; // Ns/m
  const GRIP = 150; // N/m: the finger's spring
  const PERIOD = 1e-3; // s
  const FINGER_SPEED = 0.5; // m/s
  const FINGER_LAG = 0.02; // s: a finger comes to rest within this time, not at once

  // x and v after a period, of an axis whose spring's centre is at 0, from x and v before it
  const transition = (() => {
    const decay = DAMPING / (2 * MASS);
    const square = GRIP / MASS;
    const turn = Math.sqrt(square - decay * decay);
    const by = Math.exp(-decay * PERIOD);
    const c = by * Math.cos(turn * PERIOD);
    const s = (by * Math.sin(turn * PERIOD)) / turn;
    return { xx: c + decay * s, xv: s, vx: -square * s, vv: c - decay * s };
  })();

  class HeldDevice {
    // place: three numbers; box: six, which neither the finger nor the device leaves
    constructor(place, box) {
      this.box = box;
      this.x = this.inside(place);
      this.v = [0, 0, 0];
      this.finger = this.x.slice();
      this.wanted = this.x.slice();
    }

    inside(place) {
      return place.map((value, k) => Math.min(this.box[k + 3], Math.max(this.box[k], value)));
    }

    // Where the finger is to go.
    want(place) {
      if (place.every(Number.isFinite)) this.wanted = this.inside(place);
    }

    moveFinger() {
      const way = this.wanted.map((value, k) => value - this.finger[k]);
      const length = Math.hypot(...way);
      const step = Math.min(length * (PERIOD / FINGER_LAG), FINGER_SPEED * PERIOD);
      if (length > 0) this.finger = this.finger.map((value, k) => value + (step / length) * way[k]);
    }

    // One period under a force, N.
    step(force) {
      const { xx, xv, vx, vv } = transition;
      this.moveFinger();
      for (let k = 0; k < 3; k++) {
        const rest = this.finger[k] + force[k] / GRIP;
        const x = this.x[k] - rest;
        const v = this.v[k];
        this.x[k] = rest + xx * x + xv * v;
        this.v[k] = vx * x + vv * v;
        const held = Math.min(this.box[k + 3], Math.max(this.box[k], this.x[k]));
        if (held !== this.x[k]) [this.x[k], this.v[k]] = [held, 0];
      }
    }
  }

  return { HeldDevice, MASS, DAMPING, GRIP, PERIOD };
})();
