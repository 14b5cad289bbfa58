// SPDX-License-Identifier: BSD-3-Clause
// node picture_files.js: the pictures of README and docs are there, none is left over, and the pictures that move are what
// motions.js states. The WebP is read by its container's description alone.
"use strict";
const fs = require("fs");
const path = require("path");
const { check, finish, assert } = require("../view/verdicts.js");
const { MOTIONS } = require("./motions.js");
const { chunks } = require("./moving_frames.js");
const root = path.join(__dirname, "../..");

const pagesIn = folder =>
  fs.readdirSync(path.join(root, folder), { withFileTypes: true }).flatMap(entry => {
    const name = path.join(folder, entry.name);
    if (entry.isDirectory()) return pagesIn(name);
    return name.endsWith(".md") ? [name] : [];
  });

// Pictures by their paths from the root, and the page that names each.
function named() {
  const list = [];
  for (const page of ["README.md", ...pagesIn("docs")]) {
    const text = fs.readFileSync(path.join(root, page), "utf8");
    for (const [, alt, target] of text.matchAll(/!\[([^\]]*)\]\(([^)]+)\)/g))
      list.push({ page, alt, file: path.join(path.dirname(page), target) });
  }
  return list;
}

(async () => {
  const pictures = named();
  await check("every picture that README and docs name is there, with words for those who do not see it", () => {
    assert(pictures.length > 10, `only ${pictures.length}`);
    for (const { page, alt, file } of pictures) {
      assert(fs.existsSync(path.join(root, file)), `${page} names ${file}`);
      assert(alt.length > 10, `${page}: ${file} has the words '${alt}'`);
    }
  });
  await check("every file of docs/pictures is named", () => {
    const names = new Set(pictures.map(({ file }) => file));
    const left = fs.readdirSync(path.join(root, "docs/pictures")).filter(name => !names.has(path.join("docs/pictures", name)));
    assert.deepStrictEqual(left, []);
  });
  for (const motion of MOTIONS)
    await check(`${motion.name}: the picture that moves has the frames, times and size that are stated, and goes on for ever`, () => {
      const bytes = fs.readFileSync(path.join(root, `docs/pictures/${motion.name}.webp`));
      assert(bytes.length <= motion.bytesMost, `${bytes.length} bytes`);
      assert.strictEqual(bytes.toString("latin1", 0, 4) + bytes.toString("latin1", 8, 12), "RIFFWEBP");
      assert.strictEqual(bytes.readUInt32LE(4) + 8, bytes.length);
      const parts = chunks(bytes);
      assert(parts.every(({ whole }) => whole), "a chunk is cut");
      const [extended, animation] = ["VP8X", "ANIM"].map(name => parts.find(part => part.name === name)?.content);
      assert(extended && (extended[0] & 2) !== 0 && animation, "it is not animated");
      assert.deepStrictEqual([4, 7].map(at => 1 + extended.readUIntLE(at, 3)), [motion.width, motion.height]);
      assert.strictEqual(animation.readUInt16LE(4), 0, "its loops are counted");
      const times = parts.filter(({ name }) => name === "ANMF").map(({ content }) => content.readUIntLE(12, 3));
      assert.strictEqual(times.length, motion.frames);
      assert(times.every(time => time === 1000 * motion.frameSeconds), `${times} ms`);
      const seconds = motion.frames * motion.frameSeconds;
      assert(seconds >= 2 && seconds <= 5, `${seconds} s`);
    });
  finish();
})();
