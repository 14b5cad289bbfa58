// SPDX-License-Identifier: BSD-3-Clause
// In place of the web socket to a server: a worker that runs the world and makes the same messages (touch_worker.js).
"use strict";
const connection = (() => {
  const handFirst = true; // a drag, the wheel and the arrows move the hand
  const lack = () => null; // boot.js has seen to it

  class Connection {
    // on: { message(bytes), away(sentence) }
    constructor(on) {
      this.on = on;
      this.opened = 1;
      this.touched = false;
      this.waiting = new Map(); // kind of a message: who is told
      const text = pack.text("worker.js");
      this.address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
      this.worker = this.start(data => {
        if (data instanceof Uint8Array) on.message(data);
        else this.waiting.get(data.kind)?.(data);
      });
      this.post({ kind: "core", bytes: pack.bytes("dynpoint.wasm") });
    }

    start(heard) {
      const worker = new Worker(this.address);
      worker.onmessage = ({ data }) => heard(data);
      worker.onerror = ({ message }) => this.on.away(`The page's worker has failed: ${message}`);
      return worker;
    }

    // Who is told of messages of a kind.
    hear(kind, told) {
      this.waiting.set(kind, told);
    }

    post(message) {
      this.worker.postMessage(message);
    }

    // In a worker of its own; what compileJob.run answers.
    compile(job) {
      return new Promise(done => {
        const worker = this.start(answer => {
          worker.terminate();
          done(answer);
        });
        const modules = { core: pack.bytes("dynpoint.wasm"), compiler: pack.bytes("dynpoint_compile.wasm") };
        worker.postMessage({ kind: "compile", ...modules, ...job }, [job.source.buffer]);
      });
    }

    // The viewer's words.
    send(text) {
      if (text.startsWith("hand ") && !this.touched) {
        this.touched = true;
        this.waiting.get("touched")?.();
      }
      this.post({ kind: "text", text });
    }

    end() {
      this.worker.terminate();
    }
  }

  return { Connection, lack, handFirst };
})();
