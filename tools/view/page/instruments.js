// SPDX-License-Identifier: BSD-3-Clause
// What a tool looks like beyond what is felt: shaft, tip, jaws and handle, for the eye alone. An instrument is a list of
// rods on the line of the tool's first segment, which begins at its tip. Lengths are in radii of the segment.
"use strict";
const instruments = (() => {
  const THINNEST = 0.0005; // m: radius of a segment that has less

  // A part: from and to [along, aside, opens], in radii: jaws that are half open are `aside`, and `opens` less or more where
  // they are closed or wide open; along beyond the tip's end (below 0) or beyond the other end ("past" it);
  // radii at both ends; what it is made of; flat: how thick it is across, in parts of its width.
  const past = (along, aside = 0) => ({ past: true, along, aside });
  const tip = (along, aside = 0, opens = 0) => ({ past: false, along, aside, opens });
  const part = (from, to, radii, of, { flat = 1, round = 1 } = {}) => ({ from, to, radii, of, flat, round });

  const LOOKS = {
    none: [],
    stylus: [
      part(past(0), past(12), [0.8, 0.8], "steel"),
      part(past(10), past(13), [1.0, 2.2], "grip", { round: 0 }),
      part(past(13), past(34), [2.2, 1.7], "grip"),
    ],
    needle: [
      part(tip(-5), tip(0), [0, 0.95], "steel", { round: 0 }),
      part(past(0), past(4), [0.8, 0.8], "steel"),
      part(past(3), past(7), [1.6, 3], "trim", { round: 0 }), // hub
      part(past(7), past(27), [4, 4], "glass", { round: 0.3 }), // barrel
      part(past(27), past(28), [6.5, 6.5], "glass", { flat: 0.5, round: 0.3 }),
      part(past(28), past(36), [1.5, 1.5], "glass"),
      part(past(36), past(37), [4, 4], "grip", { round: 0.3 }), // plunger
    ],
    scalpel: [
      part(tip(-9), tip(-2), [0, 3], "steel", { flat: 0.12, round: 0 }), // blade
      part(tip(-2), tip(4), [3, 2], "steel", { flat: 0.16, round: 0 }),
      part(past(0), past(6), [1.4, 2.4], "grip", { flat: 0.45 }),
      part(past(6), past(38), [2.4, 3], "grip", { flat: 0.4 }),
    ],
    forceps: [
      part(tip(0, 2, 1.5), tip(8, 0.3), [0.5, 0.8], "steel", { flat: 0.8 }), // jaws
      part(tip(0, -2, -1.5), tip(8, -0.3), [0.5, 0.8], "steel", { flat: 0.8 }),
      part(past(0), past(22), [1, 1], "steel"),
      part(past(20), past(23), [2.4, 2.4], "trim", { round: 0.4 }), // wheel that turns the shaft
      part(past(23), past(34), [1.8, 2.6], "grip"),
      part(past(30, 1), past(36, 12), [1.5, 1.4], "grip"), // the two grips
      part(past(33, 0), past(46, 5), [2, 1.5], "grip"),
    ],
    laparoscope: [
      part(tip(-0.4), tip(0.6), [0.7, 0.7], "grip", { round: 0.2 }), // its lens
      part(past(0), past(14), [1, 1], "steel"),
      part(past(13), past(17), [2.2, 2.6], "steel", { round: 0.2 }),
      part(past(16, 0), past(18, 8), [0.9, 0.9], "steel"), // where its light comes in
      part(past(17), past(21), [3.4, 3.4], "trim", { round: 0.3 }),
      part(past(21), past(33), [3.8, 3.4], "grip", { round: 0.4 }), // camera
      part(past(33), past(41), [1, 1], "grip"),
    ],
  };

  const JAWS = { forceps: 7 }; // radii from end a: there what is felt is seen through, as jaws move within it

  const norm = v => {
    const by = 1 / Math.max(1e-12, rays.length(v));
    return v.map(value => value * by);
  };

  // Which way a tool is turned about its axis: its frame's x axis, across the axis; without a pose any such direction.
  function sideOf(pose, axis) {
    const turned = pose && rays.rotation(pose);
    const x = turned ? rays.turn(turned, [1, 0, 0]) : [0, 0, 0];
    const across = rays.sub(x, axis.map(value => value * rays.dot(x, axis)));
    return rays.length(across) > 0.1 ? norm(across) : null;
  }

  // Where a tool is and how it is turned: from its end a, unit vectors along its axis, to its side and across both; null
  // where it is nowhere.
  function frameOf(a, b, pose) {
    if (!(rays.isPlace(a) && rays.isPlace(b))) return null;
    const turned = pose && rays.rotation(pose);
    const isLong = rays.length(rays.sub(b, a)) > 0;
    const axis = isLong ? norm(rays.sub(b, a)) : turned ? rays.turn(turned, [0, 0, 1]) : null;
    if (!axis) return null;
    const [x, y, z] = axis;
    const side = sideOf(pose, axis) ?? norm(Math.abs(x) < 0.6 ? [0, z, -y] : [-z, 0, x]);
    const across = [y * side[2] - z * side[1], z * side[0] - x * side[2], x * side[1] - y * side[0]];
    return { from: a, axis, side, across };
  }

  /*
   * The rods of an instrument: [{ a, b, radiusA, radiusB, of, flat, round, side }...], in m of the scene.
   *   look     a name of LOOKS
   *   a, b, radius  of the segment
   *   pose     of the tool's frame, or null
   *   opening  of jaws, 0 to 1
   */
  function rodsOf(look, a, b, radius, pose, opening = 0.5) {
    const frame = frameOf(a, b, pose);
    if (!frame) return [];
    const { axis, side } = frame;
    const unit = Math.max(THINNEST, radius || 0);
    const place = ({ past, along, aside, opens = 0 }) => {
      const across = aside + 2 * (opening - 0.5) * opens;
      return (past ? b : a).map((value, k) => value + unit * (along * axis[k] + across * side[k]));
    };
    return LOOKS[look].map(({ from, to, radii, of, flat, round }) => ({
      a: place(from),
      b: place(to),
      radiusA: unit * radii[0],
      radiusB: unit * radii[1],
      of,
      flat,
      round,
      side,
    }));
  }

  // How far the shaft goes on beyond the segment, in radii: it throws the same shadow.
  const shaftOf = look => LOOKS[look].find(({ of, from }) => of === "steel" && from.past)?.to.along ?? 0;

  const clearOf = look => JAWS[look] ?? 0;

  return { LOOKS, clearOf, frameOf, rodsOf, shaftOf };
})();
