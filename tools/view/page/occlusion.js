// SPDX-License-Identifier: BSD-3-Clause
// How much of the sky each vertex sees: all bodies are looked at from directions spread evenly over the ball, each time as a
// map of heights, and what lies below the map is in the shade of that direction. Baked at the first poses, once; a
// body that deforms keeps it.
"use strict";
const occlusion = (() => {
  const DIRECTIONS = 48;
  const GRID = 128; // cells of a map along each side
  const BIAS = 1.5; // cells: what is lower by less is not in the shade
  const DARKEST = 0.3; // of a vertex that sees nothing
  const GOLDEN = Math.PI * (3 - Math.sqrt(5));

  // Evenly over the ball.
  function direction(i) {
    const z = 1 - (2 * i + 1) / DIRECTIONS;
    const flat = Math.sqrt(1 - z * z);
    return [flat * Math.cos(GOLDEN * i), flat * Math.sin(GOLDEN * i), z];
  }

  // Two axes across a direction.
  function axesAcross(w) {
    const other = Math.abs(w[0]) < 0.6 ? [0, w[2], -w[1]] : [-w[2], 0, w[0]];
    const by = 1 / rays.length(other);
    const u = other.map(value => value * by);
    return [u, [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]]];
  }

  class Bake {
    // parts: [{ places, normals, corners, isClosed }...], the first two in the scene's frame, x, y, z one behind the other
    constructor(parts) {
      this.parts = parts.map(part => ({
        ...part,
        flat: new Float32Array(part.places.length), // in the map: across, along, height, in cells
        seen: new Float32Array(part.places.length / 3),
        all: new Float32Array(part.places.length / 3),
      }));
      const least = [Infinity, Infinity, Infinity];
      const most = least.map(() => -Infinity);
      for (const { places } of parts)
        for (let i = 0; i < places.length; i++) {
          if (places[i] < least[i % 3]) least[i % 3] = places[i];
          if (places[i] > most[i % 3]) most[i % 3] = places[i];
        }
      this.centre = least.map((value, k) => (value + most[k]) / 2);
      this.cell = (rays.length(rays.sub(most, least)) * 1.02) / GRID;
      this.map = new Float32Array(GRID * GRID);
      this.next = this.cell > 0 && Number.isFinite(this.cell) ? 0 : DIRECTIONS;
    }

    get isDone() {
      return this.next >= DIRECTIONS;
    }

    // Looks from one direction more.
    advance() {
      if (this.isDone) return;
      const w = direction(this.next++);
      const [u, v] = axesAcross(w);
      this.map.fill(-Infinity);
      for (const part of this.parts) this.flatten(part, u, v, w);
      for (const part of this.parts) this.cover(part);
      for (const part of this.parts) this.look(part, w);
    }

    flatten({ places, flat }, u, v, w) {
      const [cx, cy, cz] = this.centre;
      const by = 1 / this.cell;
      for (let i = 0; i < places.length; i += 3) {
        const x = (places[i] - cx) * by;
        const y = (places[i + 1] - cy) * by;
        const z = (places[i + 2] - cz) * by;
        flat[i] = GRID / 2 + x * u[0] + y * u[1] + z * u[2];
        flat[i + 1] = GRID / 2 + x * v[0] + y * v[1] + z * v[2];
        flat[i + 2] = x * w[0] + y * w[1] + z * w[2];
        const at = Math.floor(flat[i + 1]) * GRID + Math.floor(flat[i]);
        if (flat[i + 2] > this.map[at]) this.map[at] = flat[i + 2];
      }
    }

    // Raises the map to the triangles, at the middles of the cells that they are over.
    cover({ flat, corners }) {
      const { map } = this;
      for (let i = 0; i < corners.length; i += 3) {
        const a = 3 * corners[i];
        const b = 3 * corners[i + 1];
        const c = 3 * corners[i + 2];
        const ax = flat[a];
        const ay = flat[a + 1];
        const ux = flat[b] - ax;
        const uy = flat[b + 1] - ay;
        const vx = flat[c] - ax;
        const vy = flat[c + 1] - ay;
        const area = ux * vy - uy * vx;
        if (area === 0) continue;
        const fromX = Math.ceil(Math.min(ax, flat[b], flat[c]) - 0.5);
        const toX = Math.floor(Math.max(ax, flat[b], flat[c]) - 0.5);
        const fromY = Math.ceil(Math.min(ay, flat[b + 1], flat[c + 1]) - 0.5);
        const toY = Math.floor(Math.max(ay, flat[b + 1], flat[c + 1]) - 0.5);
        for (let y = fromY; y <= toY; y++)
          for (let x = fromX; x <= toX; x++) {
            const px = x + 0.5 - ax;
            const py = y + 0.5 - ay;
            const s = (px * vy - py * vx) / area;
            const t = (ux * py - uy * px) / area;
            if (s < 0 || t < 0 || s + t > 1) continue;
            const high = flat[a + 2] + s * (flat[b + 2] - flat[a + 2]) + t * (flat[c + 2] - flat[a + 2]);
            const at = y * GRID + x;
            if (high > map[at]) map[at] = high;
          }
      }
    }

    look({ flat, normals, isClosed, seen, all }, w) {
      for (let i = 0, k = 0; i < flat.length; i += 3, k++) {
        const facing = normals[i] * w[0] + normals[i + 1] * w[1] + normals[i + 2] * w[2];
        const weight = isClosed ? facing : Math.abs(facing); // an open sheet is seen from both sides
        if (!(weight > 0.05)) continue;
        const below = this.map[Math.floor(flat[i + 1]) * GRID + Math.floor(flat[i])] - flat[i + 2];
        const slope = BIAS / weight; // heights within a cell differ by as much where it is looked at from the side
        all[k] += weight;
        seen[k] += weight * Math.max(0, Math.min(1, 2 - below / slope));
      }
    }

    // Of each part: 0 to 1 a vertex, 1 where it sees the whole sky.
    shades() {
      return this.parts.map(({ seen, all }) =>
        seen.map((value, k) => (all[k] > 0 ? DARKEST + (1 - DARKEST) * (value / all[k]) : 1)),
      );
    }
  }

  return { Bake };
})();
