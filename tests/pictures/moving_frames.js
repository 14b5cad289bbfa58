// SPDX-License-Identifier: BSD-3-Clause
// Frames of a picture that moves, each as a WebP of what has changed. img2webp compares each frame with the one before,
// so what changes slowly is never sent, and blocks of old frames stay. Here a block is compared with what was sent of it,
// and with what is seen of that: an edge bleeds into the blocks beside it, and stays there when it has gone.
"use strict";
const fs = require("fs");

// In the page: takes the next frame, a PNG in base64. Returns where what has changed stands in the picture, and two WebP
// of it in base64: its colours, and its mask. Blocks beside changed ones keep their colours, as edges bleed.
async function changedPart(png, quality) {
  const BLOCK = 16; // pixels along each side, as of the format's own blocks
  const SAME = 1; // of 255: a channel that differs by no more has not changed
  const LOSS = 32; // likewise of what is seen: the rest is the format's
  const image = new Image();
  image.src = `data:image/png;base64,${png}`;
  await image.decode();
  const { width, height } = image;
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const frame = context.getImageData(0, 0, width, height);
  const mask = new ImageData(width, height);
  const isFirst = !window.sent;
  window.sent ??= new Uint8ClampedArray(frame.data);
  window.seen ??= new Uint8ClampedArray(frame.data);
  const box = { left: width, top: height, right: 0, bottom: 0 };
  const rows = (x, y, use) => {
    const wide = 4 * Math.min(BLOCK, width - x);
    for (let line = y; line < Math.min(height, y + BLOCK); line++) use(4 * (line * width + x), wide);
  };
  const blocks = [];
  for (let y = 0; y < height; y += BLOCK)
    for (let x = 0; x < width; x += BLOCK) {
      let [most, lost] = isFirst ? [255, 0] : [0, 0];
      rows(x, y, (at, wide) => {
        for (let i = at; i < at + wide; i++) {
          most = Math.max(most, Math.abs(frame.data[i] - window.sent[i]));
          lost = Math.max(lost, Math.abs(frame.data[i] - window.seen[i]));
        }
      });
      blocks.push({ x, y, most, lost });
    }
  const near = (list, { x, y }) => list.some(one => Math.max(Math.abs(one.x - x), Math.abs(one.y - y)) <= BLOCK);
  const others = blocks.filter(({ most }) => most > SAME);
  const changed = blocks.filter(block => block.most > SAME || (block.lost > LOSS && near(others, block)));
  for (const { x, y } of changed) {
    rows(x, y, (at, wide) => {
      window.sent.set(frame.data.subarray(at, at + wide), at);
      mask.data.fill(255, at, at + wide);
    });
    Object.assign(box, { left: Math.min(box.left, x), top: Math.min(box.top, y) });
    Object.assign(box, { right: Math.max(box.right, x + BLOCK), bottom: Math.max(box.bottom, y + BLOCK) });
  }
  for (const block of blocks)
    if (!near(changed, block)) rows(block.x, block.y, (at, wide) => frame.data.fill(255, at, at + wide)); // costs nothing
  if (box.right === 0) Object.assign(box, { left: 0, top: 0, right: BLOCK, bottom: BLOCK }); // nothing: a clear corner
  const size = [Math.min(width, box.right) - box.left, Math.min(height, box.bottom) - box.top];
  const see = shown => {
    context.drawImage(shown, box.left, box.top);
    const { data } = context.getImageData(0, 0, width, height);
    for (const { x, y } of changed) rows(x, y, (at, wide) => window.seen.set(data.subarray(at, at + wide), at));
  };
  const encode = async image => {
    const part = new OffscreenCanvas(...size);
    part.getContext("2d").putImageData(image, -box.left, -box.top);
    const blob = await part.convertToBlob({ type: "image/webp", quality });
    if (image === frame) see(await createImageBitmap(blob));
    const url = await new Promise(done => {
      const reader = new FileReader();
      reader.onload = () => done(reader.result);
      reader.readAsDataURL(blob);
    });
    return url.split(",")[1];
  };
  return { colours: await encode(frame), mask: await encode(mask), ...box, size };
}

// The chunks of a RIFF: four letters, a length, the content. whole: of each, whether its content is there
function chunks(bytes) {
  const list = [];
  for (let at = 12; at + 8 <= bytes.length; ) {
    const [name, length] = [bytes.toString("latin1", at, at + 4), bytes.readUInt32LE(at + 4)];
    list.push({ name, content: bytes.subarray(at + 8, at + 8 + length), whole: at + 8 + length <= bytes.length });
    at += 8 + length + (length % 2);
  }
  return list;
}

function chunk(name, ...contents) {
  const content = Buffer.concat(contents);
  const head = Buffer.alloc(8, name, "latin1");
  head.writeUInt32LE(content.length, 4);
  return Buffer.concat([head, content, Buffer.alloc(content.length % 2)]);
}

// Colours and mask as one WebP; where all has changed there is no mask.
function masked({ colours, mask, size: [width, height] }) {
  const [bytes, alpha] = [colours, mask].map(text => Buffer.from(text, "base64"));
  const covers = chunks(alpha).find(({ name }) => name === "ALPH");
  if (!covers) return bytes;
  const head = Buffer.alloc(10);
  head[0] = 16; // it has a mask
  head.writeUIntLE(width - 1, 4, 3);
  head.writeUIntLE(height - 1, 7, 3);
  const { content } = chunks(bytes).find(({ name }) => name === "VP8 ");
  return chunk("RIFF", Buffer.from("WEBP"), chunk("VP8X", head), chunk("ALPH", covers.content), chunk("VP8 ", content));
}

// files: PNG; quality: 0 to 100. Each gets a file .webp beside it. Returns the words of webpmux for them, each for ms.
async function muxWords(browser, files, quality, ms) {
  const page = await browser.visit("about:blank");
  const words = [];
  for (const file of files) {
    const part = await page.call(changedPart, fs.readFileSync(file, "base64"), quality / 100);
    fs.writeFileSync(`${file}.webp`, masked(part));
    words.push("-frame", `${file}.webp`, `+${ms}+${part.left}+${part.top}+0+b`);
  }
  await browser.leave(page);
  return words;
}

module.exports = { muxWords, chunks };
