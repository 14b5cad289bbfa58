// SPDX-License-Identifier: BSD-3-Clause
// Many rounded rods in one drawing: tools, contacts, lines and arrows. A rod goes from a to b with a radius at each end;
// `roundness` is the height of its caps in radii: 1 makes half balls, 0 flat ends. Radius 0 makes a tip. A rod may be flat:
// thinner across `side` and its axis.
"use strict";
const capsuleBatch = (() => {
  const AROUND = 20; // faces around the rod
  const CAP = 4; // rings of a cap
  const RINGS = 2 * (CAP + 1);
  const PER_ROD = RINGS * (AROUND + 1);

  // A direction across another one.
  function across([x, y, z]) {
    const other = Math.abs(x) < 0.6 ? [0, z, -y] : [-z, 0, x];
    const by = 1 / Math.hypot(...other);
    return other.map(value => value * by);
  }

  class CapsuleBatch {
    constructor(materials) {
      this.geometry = new THREE.BufferGeometry();
      this.meshes = materials.map((material, i) => {
        const mesh = new THREE.Mesh(this.geometry, material);
        mesh.frustumCulled = false;
        mesh.renderOrder = material.userData.order ?? i;
        return mesh;
      });
      this.allocate(4);
      this.begin();
    }

    allocate(rods) {
      this.rods = rods;
      this.geometry.dispose();
      for (const name of ["position", "normal", "color"]) {
        this[name] = new Float32Array(3 * PER_ROD * rods);
        this.geometry.setAttribute(name, new THREE.BufferAttribute(this[name], 3).setUsage(THREE.DynamicDrawUsage));
      }
      const index = [];
      for (let rod = 0; rod < rods; rod++) {
        for (let ring = 0; ring < RINGS - 1; ring++) {
          for (let i = 0; i < AROUND; i++) {
            const at = rod * PER_ROD + ring * (AROUND + 1) + i;
            const next = at + AROUND + 1;
            index.push(at, next + 1, next, at, at + 1, next + 1);
          }
        }
      }
      this.geometry.setIndex(index);
    }

    begin() {
      this.list = [];
    }

    // colour: [red, green, blue], 0..1 each, as the renderer counts (linear)
    // flat: how thick it is in parts of its width; side: a direction across it, in which it has its width
    add(a, b, radiusA, radiusB, roundness, colour, flat = 1, side = null) {
      if (![...a, ...b, radiusA, radiusB].every(Number.isFinite)) return;
      this.list.push({ a, b, radiusA, radiusB, roundness, colour, flat, side });
    }

    write({ a, b, radiusA, radiusB, roundness, colour, flat, side: along }, rod) {
      const length = rays.length(rays.sub(b, a));
      const w = length > 0 ? rays.sub(b, a).map(x => x / length) : [0, 0, 1];
      const u = along ?? across(w);
      const v = [w[1] * u[2] - w[2] * u[1], w[2] * u[0] - w[0] * u[2], w[0] * u[1] - w[1] * u[0]];
      let at = 3 * PER_ROD * rod;
      for (let ring = 0; ring < RINGS; ring++) {
        const isB = ring > CAP;
        const angle = ((Math.PI / 2) * (isB ? ring - CAP - 1 : ring - CAP)) / CAP;
        const end = isB ? b : a;
        const radius = isB ? radiusB : radiusA;
        const out = Math.cos(angle);
        const up = Math.sin(angle);
        for (let i = 0; i <= AROUND; i++) {
          const turn = (2 * Math.PI * i) / AROUND;
          const c = Math.cos(turn);
          const s = Math.sin(turn);
          for (let k = 0; k < 3; k++, at++) {
            const side = c * u[k] + flat * s * v[k];
            this.position[at] = end[k] + radius * (out * side + roundness * up * w[k]);
            this.normal[at] = out * (flat * c * u[k] + s * v[k]) + up * w[k];
            this.color[at] = colour ? colour[k] : 1;
          }
        }
      }
    }

    end() {
      if (this.list.length > this.rods) this.allocate(2 ** Math.ceil(Math.log2(this.list.length)));
      this.list.forEach((rod, i) => this.write(rod, i));
      this.geometry.setDrawRange(0, 6 * (RINGS - 1) * AROUND * this.list.length);
      for (const name of ["position", "normal", "color"]) this.geometry.attributes[name].needsUpdate = true;
      for (const mesh of this.meshes) mesh.visible = this.list.length > 0;
    }
  }

  return { CapsuleBatch };
})();
