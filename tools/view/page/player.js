// SPDX-License-Identifier: BSD-3-Clause
// Which frame is shown: of a recording the one that is due, of a running world the last. A pause of a running world
// acts on the picture only: the frames that come meanwhile are not kept, and the world goes on.
"use strict";
const player = (() => {
  class Player {
    constructor(history, changed) {
      this.history = history;
      this.changed = changed;
      this.speed = 1;
      this.reset(false);
    }

    reset(live) {
      this.live = live;
      this.index = 0;
      this.playing = live;
      this.clock = null;
      this.whole = false; // set when no frame will come any more
    }

    // In a running world playing means to follow it.
    get following() {
      return this.live && this.playing;
    }

    get last() {
      return Math.max(0, this.history.size - 1);
    }

    play() {
      if (!this.live && this.index >= this.last) this.index = 0;
      this.playing = true;
      this.clock = null;
      this.changed();
    }

    pause() {
      this.playing = false;
      this.changed();
    }

    toggle() {
      if (this.playing) this.pause();
      else this.play();
    }

    seek(index) {
      this.index = Math.min(this.last, Math.max(0, Math.round(index)));
      this.playing = false;
      this.changed();
    }

    seekTime(time) {
      this.seek(this.history.find(time));
    }

    step(by) {
      this.seek(this.index + by);
    }

    setSpeed(speed) {
      this.speed = Math.min(4, Math.max(0.1, speed));
      this.clock = null;
      this.changed();
    }

    // Called once for each picture, with the browser's time in ms.
    advance(now) {
      if (this.history.size === 0 || !this.playing) return;
      if (this.live) {
        this.index = this.last;
        return;
      }
      this.clock ??= { begun: now, time: this.history.get(this.index).time };
      this.index = this.history.find(this.clock.time + ((now - this.clock.begun) / 1000) * this.speed);
      if (this.index === this.last && this.whole) this.pause();
    }
  }

  return { Player };
})();
