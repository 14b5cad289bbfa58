// SPDX-License-Identifier: BSD-3-Clause
// Steers a simulated hand: the last place that is wanted goes to the server, at most 60 times a second.
"use strict";
const hand = (() => {
  const INTERVAL = 1000 / 60; // ms
  const FORGET = 1000; // ms

  class Hand {
    // place: () the tool's place now, or null; send(text)
    constructor(place, send) {
      this.place = place;
      this.send = send;
      this.wanted = null;
      this.unsent = false;
      this.sentAt = this.wantedAt = -Infinity;
    }

    // Where a movement begins: at the last place that was wanted, while that is recent.
    start(now) {
      return now - this.wantedAt < FORGET ? this.wanted : this.place();
    }

    want(place, now) {
      if (!place.every(Number.isFinite)) return;
      this.wanted = place;
      this.wantedAt = now;
      this.unsent = true;
      this.flush(now);
    }

    moveBy(change, now) {
      const from = this.start(now);
      if (from)
        this.want(
          from.map((value, k) => value + change[k]),
          now,
        );
    }

    // Called with each picture too: the last place is never left unsent.
    flush(now) {
      if (!this.unsent || now - this.sentAt < INTERVAL) return;
      this.unsent = false;
      this.sentAt = now;
      this.send(`hand ${this.wanted.map(value => value.toFixed(7)).join(" ")}`);
    }
  }

  return { Hand };
})();
