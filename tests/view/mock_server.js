// SPDX-License-Identifier: BSD-3-Clause
// A stand-in for the program's server: it sends the page, and speaks as much of the web socket as the page's tests
// need. It is a mock: that the real server keeps the rules is tested with the real one.
"use strict";
const http = require("http");
const crypto = require("crypto");
const fs = require("fs");
const path = require("path");
const KEY = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";

function framed(opcode, body) {
  const head = Buffer.alloc(body.length < 126 ? 2 : body.length < 65536 ? 4 : 10);
  head[0] = 0x80 | opcode;
  head[1] = body.length < 126 ? body.length : body.length < 65536 ? 126 : 127;
  if (head.length === 4) head.writeUInt16BE(body.length, 2);
  if (head.length === 10) head.writeBigUInt64BE(BigInt(body.length), 2);
  return Buffer.concat([head, body]);
}

// Texts of the client from its bytes: each message is short, masked, and in one frame.
function reader(onText, onClose) {
  let rest = Buffer.alloc(0);
  return data => {
    rest = Buffer.concat([rest, data]);
    for (;;) {
      const size = rest.length >= 2 ? rest[1] & 0x7f : 0;
      const from = size === 126 ? 8 : 6;
      const length = size === 126 && rest.length >= 4 ? rest.readUInt16BE(2) : size;
      if (rest.length < 6 || rest.length < from + length) return;
      const mask = rest.subarray(from - 4, from);
      const body = Buffer.from(rest.subarray(from, from + length)).map((byte, i) => byte ^ mask[i % 4]);
      if ((rest[0] & 15) === 1) onText(body.toString());
      if ((rest[0] & 15) === 8) onClose();
      rest = rest.subarray(from + length);
    }
  };
}

// on(text, send) hears what a client says after its token; send(message) answers.
function serve(folder, token, on, port = 0) {
  const page = fs.readFileSync(path.join(folder, "page.html"));
  const policy = fs.readFileSync(path.join(folder, "page.csp"), "utf8");
  const sockets = new Set();
  const server = http.createServer((request, answer) => {
    answer.writeHead(request.url === "/" ? 200 : 404, {
      "Content-Type": "text/html; charset=utf-8",
      "Content-Security-Policy": policy,
      Connection: "close",
    });
    answer.end(request.url === "/" ? page : "");
  });
  server.on("connection", socket => {
    sockets.add(socket.on("close", () => sockets.delete(socket)).on("error", () => 0));
  });
  server.on("upgrade", (request, socket) => {
    const accept = crypto
      .createHash("sha1")
      .update(request.headers["sec-websocket-key"] + KEY)
      .digest("base64");
    socket.write(
      `HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\nSec-WebSocket-Protocol: ${request.headers["sec-websocket-protocol"]}\r\n\r\n`,
    );
    const send = message => socket.write(framed(2, message));
    const close = code => socket.write(framed(8, Buffer.from([code >> 8, code & 255])));
    let known = false;
    socket.on(
      "data",
      reader(
        text => {
          if (known) return on(text, send);
          known = text === token;
          if (known) on("token", send);
          else close(1008);
        },
        () => socket.end(),
      ),
    );
  });
  const die = () =>
    new Promise(done => {
      server.close(done);
      for (const socket of sockets) socket.destroy();
    });
  return new Promise(done => {
    server.listen(port, "127.0.0.1", () => done({ port: server.address().port, die }));
  });
}

module.exports = { serve };
