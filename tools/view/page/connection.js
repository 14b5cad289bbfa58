// SPDX-License-Identifier: BSD-3-Clause
// The web socket to the server that sent this page. It is opened again after it has closed, but not where the server
// refuses the token, and not after a run has ended.
"use strict";
const connection = (() => {
  const REFUSED = 1008;
  const FIRST_WAIT = 250; // ms
  const LONGEST_WAIT = 2000; // ms
  const PROTOCOL = "dynpoint";
  const handFirst = false; // gestures and keys are the camera's, and the hand has a handle

  // Why there can be no connection: a sentence, or null.
  const lack = () =>
    location.protocol.startsWith("http")
      ? null
      : "This page has no data and no server. Open one that dynpoint view wrote.";

  class Connection {
    // on: { message(bytes), away(sentence), refused(sentence) }
    constructor(on) {
      this.on = on;
      this.wait = FIRST_WAIT;
      this.done = false;
      this.opened = 0;
      this.join();
    }

    join() {
      const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/`;
      const socket = (this.socket = new WebSocket(address, PROTOCOL));
      socket.binaryType = "arraybuffer";
      socket.onopen = () => {
        this.opened++;
        socket.send(location.hash.slice(1));
      };
      socket.onmessage = ({ data }) => {
        if (!(data instanceof ArrayBuffer) || this.done) return;
        this.wait = FIRST_WAIT;
        this.on.message(new Uint8Array(data));
      };
      socket.onclose = ({ code }) => this.closed(code);
    }

    closed(code) {
      if (this.done) return;
      if (code === REFUSED) {
        this.done = true;
        this.on.refused("The server refuses this page's token. Open the address that the program prints.");
        return;
      }
      this.on.away("The server is away. The page tries again.");
      setTimeout(() => this.join(), this.wait);
      this.wait = Math.min(LONGEST_WAIT, 1.6 * this.wait);
    }

    send(text) {
      if (this.socket.readyState === WebSocket.OPEN) this.socket.send(text);
    }

    // There is no more to come.
    end() {
      this.done = true;
      this.socket.close();
    }
  }

  return { Connection, lack, handFirst };
})();
