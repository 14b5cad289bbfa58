// SPDX-License-Identifier: BSD-3-Clause
// Round numbers for axes, and colours for depths.
"use strict";
const scale = (() => {
  // The least of 1, 2 or 5 times a power of ten that is not below the value; 0 gives 0.
  function roundUp(value) {
    if (!(value > 0) || !Number.isFinite(value)) return 0;
    const power = 10 ** Math.floor(Math.log10(value));
    const times = value / power;
    return (times <= 1.0000001 ? 1 : times <= 2.0000001 ? 2 : times <= 5.0000001 ? 5 : 10) * power;
  }

  // The largest of them that is not above the value; 0 gives 0.
  function roundDown(value) {
    const above = roundUp(value);
    if (above <= value * 1.0000001) return above;
    const power = 10 ** Math.floor(Math.log10(above) + 1e-9);
    const times = Math.round(above / power);
    return times === 1 ? power / 2 : times === 2 ? power : 2 * power;
  }

  // Round values between two others, about `count` of them, and how many decimals tell them apart.
  function ticks(from, to, count) {
    const step = roundUp((to - from) / count);
    if (!(step > 0)) return { values: [], decimals: 0 };
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const values = [];
    for (let i = Math.ceil(from / step - 1e-9) || 0; i * step <= to + 1e-9 * step && values.length < 50; i++)
      values.push(i * step);
    return { values, decimals: Math.min(12, decimals) };
  }

  // viridis (Smith and van der Walt, CC0), every eighth of its length: its lightness grows evenly, and it can be read
  // by those who do not tell red from green.
  const VIRIDIS = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
  ];

  // 0..1 to [red, green, blue], 0..255 each
  function colour(part) {
    const place = Math.min(1, Math.max(0, part || 0)) * (VIRIDIS.length - 1);
    const i = Math.min(VIRIDIS.length - 2, Math.floor(place));
    return VIRIDIS[i].map((from, k) => Math.round(from + (place - i) * (VIRIDIS[i + 1][k] - from)));
  }

  const gradient = () => `linear-gradient(to right, ${VIRIDIS.map(rgb => `rgb(${rgb.join(" ")})`).join(", ")})`;

  return { roundUp, roundDown, ticks, colour, gradient };
})();
