// SPDX-License-Identifier: BSD-3-Clause
// When edges are smooth: where pictures come fast enough always, elsewhere when the picture has come to rest. Beside a
// running world a processor that draws is spared: there it is for rest alone.
"use strict";
const smoothing = (() => {
  const LEAST_RATE = 30; // pictures a second: below it smooth edges go first
  const COUNTED = 8; // pictures one after the other, before it is judged
  const REST = 250; // ms without a picture

  class Smoothing {
    constructor() {
      this.begin(false);
    }

    // Of a scene. isSpared: smooth at rest alone
    begin(isSpared) {
      Object.assign(this, { isSlow: isSpared, isStill: false, last: -Infinity, run: [] });
    }

    // With each picture of the browser. drew: whether the view drew; setSmooth(on): asks for the next one
    tick(now, drew, setSmooth) {
      if (drew && this.isStill) this.isStill = false;
      else if (drew) {
        if (now - this.last > REST) this.run = [];
        this.run.push(now - this.last);
        this.last = now;
        if (this.run.length > COUNTED) {
          const took = this.run.slice(1).reduce((sum, value) => sum + value, 0);
          if (took > (1000 / LEAST_RATE) * (this.run.length - 1)) this.isSlow = true;
          this.run = [0];
        }
        setSmooth(!this.isSlow);
        this.isRestDue = true;
      } else if (this.isRestDue && now - this.last > REST) {
        this.isRestDue = false;
        this.isStill = this.isSlow;
        if (this.isSlow) setSmooth(true);
      }
    }
  }

  return { Smoothing };
})();
