// SPDX-License-Identifier: BSD-3-Clause
// What the tests of the page share: checks that print a line each, random numbers that repeat, and the page's scripts
// for use without a browser.
"use strict";
const fs = require("fs");
const path = require("path");
const assert = require("assert");
const tools = path.join(__dirname, "../../tools/view/page");
const folders = [tools, path.join(__dirname, "../../tools/page")];
let failed = 0;

// Runs a check; prints "ok" or "FAIL" and what is checked. Tests go on after one has failed.
async function check(what, work) {
  try {
    await work();
    console.log(`ok ${what}`);
  } catch (error) {
    failed++;
    console.log(`FAIL ${what}: ${error.message.replace(/\s+/g, " ").slice(0, 400)}`);
  }
}

const near = (got, wanted, within, what = "") =>
  assert(
    [got].flat().every((value, i) => Math.abs(value - [wanted].flat()[i]) <= within),
    `${what} ${got}, not ${wanted}`,
  );

function random(seed) {
  let state = seed >>> 0;
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let x = Math.imul(state ^ (state >>> 15), state | 1);
    x ^= x + Math.imul(x ^ (x >>> 7), x | 61);
    return (x ^ (x >>> 14)) >>> 0;
  };
  return { next, below: count => next() % count };
}

// The named scripts of the pages, each of which declares one name of its own.
function scripts(...names) {
  const declared = names.map(name => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase()));
  const place = name => folders.map(folder => path.join(folder, `${name}.js`)).find(file => fs.existsSync(file));
  const text = names.map(name => fs.readFileSync(place(name), "utf8")).join("\n");
  return new Function(`${text}\nreturn { ${declared.join(", ")} };`)();
}

// Bytes as a message from a web socket has them: alone in their buffer.
const alone = bytes => Uint8Array.from(bytes);

// Damages a copy: flips bits, writes large or odd numbers, cuts or lengthens.
function damage(bytes, { below, next }) {
  let copy = alone(bytes);
  for (let times = 1 + below(4); times > 0 && copy.length > 0; times--) {
    const at = below(Math.min(copy.length, below(2) ? 400 : copy.length));
    const way = below(6);
    if (way < 2) copy[at] ^= 1 << below(8);
    else if (way === 2) copy[at] = below(256);
    else if (way === 3 && copy.length >= 4) {
      const odd = [0xffffffff, 0x7fffffff, 0x80000000, 0, 1, copy.length, (copy.length / 4) | 0, next()][below(8)];
      new DataView(copy.buffer).setUint32(Math.min(at & ~3, copy.length - 4), odd, true);
    } else if (way === 4 && below(3) === 0) copy = copy.slice(0, below(copy.length + 1));
    else if (copy.length >= 8)
      new DataView(copy.buffer).setFloat64(
        Math.min(at & ~7, copy.length - 8),
        [NaN, Infinity, -1e300, 1e-310, -0][below(5)],
        true,
      );
  }
  return copy;
}

// Ends a test program: status 1 if a check failed.
function finish() {
  process.exitCode = failed > 0 ? 1 : 0;
}

module.exports = { check, near, random, scripts, alone, damage, finish, assert, tools };
