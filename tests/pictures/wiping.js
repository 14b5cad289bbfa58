// SPDX-License-Identifier: BSD-3-Clause
// The scene of the picture that moves, and what its file has to be.
"use strict";
const PERIOD = 4; // s of one round of the hand: down, along, up, back
const ROUNDS = 3; // the last one is shown; the tissue has come to a round of its own by then
const STEP = 0.02; // s between two rows of the hand's motion

// The hand's motion, as a CSV of the simulated device: t, x, y, z, in s and m, round an ellipse that begins above.
function hand() {
  const rows = ["t,x,y,z"];
  for (let k = 0; k * STEP <= PERIOD * ROUNDS; k++) {
    const turn = (2 * Math.PI * k * STEP) / PERIOD;
    const place = [0.03 * Math.sin(turn), -0.0105 + 0.0135 * Math.cos(turn), 0];
    rows.push([k * STEP, ...place].map(value => value.toFixed(6)).join(","));
  }
  return `${rows.join("\n")}\n`;
}

module.exports = {
  hand,
  scene: "soft-liver",
  device: "sim:?hand=hand.csv&seed=1",
  seconds: PERIOD * ROUNDS,
  start: PERIOD * (ROUNDS - 1),
  // A recording's page has new vertices ten times a second, so the picture has as many frames.
  frameSeconds: 0.1,
  frames: PERIOD / 0.1,
  width: 900,
  height: 480,
  turn: [-0.35, -0.1],
  zoom: 0.48,
  quality: 75,
  bytesMost: 1500000,
};
