// SPDX-License-Identifier: BSD-3-Clause
// The scenes of the pictures that move, and what their files have to be.
"use strict";
const PERIOD = 4; // s of one round of the hand
const STEP = 0.02; // s between two rows of the hand's motion

// The hand's motion, as a CSV of the simulated device: t, x, y, z, in s and m. place: of a part of a round, 0 to 1
function handOf(place, rounds) {
  const rows = ["t,x,y,z"];
  for (let k = 0; k * STEP <= PERIOD * rounds; k++)
    rows.push([k * STEP, ...place((k * STEP) / PERIOD)].map(value => value.toFixed(6)).join(","));
  return `${rows.join("\n")}\n`;
}

const wave = part => 0.5 - 0.5 * Math.cos(2 * Math.PI * part); // 0, 1, 0 in a round
const LIVER = { shape: "liver", triangles: 20000, colour: [0.55, 0.15, 0.12] };

// scene: a name, or what a scene file has; rounds: the last one is shown, when the tissue has come to a round of its own
const MOTIONS = [
  {
    name: "press",
    scene: { bodies: [LIVER], tool: { length: 0.08, radius: 0.003, look: "stylus" } },
    place: part => [0, 0.001 - 0.019 * wave(part), 0],
    rounds: 1,
    turn: [-0.05, 0.2],
    zoom: 0.6,
  },
  {
    name: "wipe",
    scene: "soft-liver",
    // Round an ellipse that begins above. From 20 mm on it would turn cells of the tissue inside out, which stay so where
    // Poisson's ratio is that of springs alone: the first round would jump by 0.1 N, and the next ones feel less than half.
    place: part => [0.03 * Math.sin(2 * Math.PI * part), 0.003 - 0.016 * wave(part), 0],
    rounds: 2,
    turn: [-0.2, -0.05],
    zoom: 0.55,
  },
  {
    name: "tip",
    scene: {
      bodies: [LIVER],
      tool: {
        length: 0.06,
        radius: 0.0015,
        look: "scalpel",
        tips: [{ shape: "wedge", extent: [0.02, 0.001, 0.006], radius: 0.0002, at: [0, 0, -0.003] }],
      },
    },
    place: part => [0.02 * Math.sin(2 * Math.PI * part), 0.002 - 0.017 * wave(part), 0],
    rounds: 1,
    turn: [0.05, 0.2],
    zoom: 0.48,
  },
  {
    name: "hold",
    scene: "cloth",
    place: part => [0, 0.07 * wave(Math.min(1, Math.max(0, 1.5 * part - 0.25))) ** 0.5, 0], // it lifts the cloth, and lets it down
    rounds: 2,
    turn: [-0.25, 0.1],
    zoom: 0.88,
  },
].map(motion => ({
  ...motion,
  hand: () => handOf(time => motion.place(time % 1), motion.rounds),
  // Damped as by a finger: else the device's mass rings at 15 Hz on the spring.
  device: "sim:?hand=hand.csv&hand_damping=4",
  seconds: PERIOD * motion.rounds,
  start: PERIOD * (motion.rounds - 1),
  // A recording's page has new vertices ten times a second, so the picture has as many frames.
  frameSeconds: 0.1,
  frames: PERIOD / 0.1,
  width: 800,
  height: 420,
  quality: 76,
  bytesMost: 300000,
}));

module.exports = { MOTIONS };
