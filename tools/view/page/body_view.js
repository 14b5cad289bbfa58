// SPDX-License-Identifier: BSD-3-Clause
// A body as it is drawn: its mesh at its pose, with its own vertices where it deforms, and highlighted triangles.
"use strict";
const bodyView = (() => {
  const UNUSABLE = 2; // flag of a body whose pose cannot be used

  class BodyView {
    // isSheet: it has an open border, and two sides that are seen
    constructor(body, mesh, material, isSheet) {
      this.isFaceted = material.userData.isFaceted;
      this.isSheet = isSheet;
      this.body = body;
      this.mesh = mesh;
      this.own = null;
      this.positions = mesh.positions;
      this.normals = new Float32Array(3 * mesh.vertices);
      rays.makeNormals(mesh.positions, mesh.corners, this.normals);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute(
        "position",
        new THREE.BufferAttribute(mesh.positions.slice(), 3).setUsage(THREE.DynamicDrawUsage),
      );
      geometry.setAttribute("normal", new THREE.BufferAttribute(this.normals, 3).setUsage(THREE.DynamicDrawUsage));
      geometry.setAttribute("shade", new THREE.BufferAttribute(new Float32Array(mesh.vertices).fill(1), 1));
      geometry.setIndex(new THREE.BufferAttribute(mesh.corners, 1));
      this.object = new THREE.Mesh(geometry, material);
      this.object.frustumCulled = false;
      this.object.matrixAutoUpdate = false;
      this.setPose(body.pose, 0);
    }

    setPose(pose, flags) {
      this.rotation = flags & UNUSABLE ? null : rays.rotation(pose);
      this.object.visible = this.rotation !== null;
      if (!this.rotation) return;
      const m = this.rotation;
      const [x, y, z] = (this.place = pose.slice(0, 3));
      this.object.matrix.set(m[0], m[1], m[2], x, m[3], m[4], m[5], y, m[6], m[7], m[8], z, 0, 0, 0, 1);
      this.object.matrixWorldNeedsUpdate = true;
    }

    // own: the body's vertices in its frame; undefined for the mesh's. As many as the mesh has, or nothing changes.
    setVertices(own) {
      const from = own ?? this.mesh.positions;
      if (from === this.positions || from.length !== this.mesh.positions.length) return;
      this.positions = from;
      const { position, normal } = this.object.geometry.attributes;
      position.array.set(from);
      rays.makeNormals(from, this.mesh.corners, this.normals);
      position.needsUpdate = normal.needsUpdate = true;
    }

    // How far each vertex is from where the mesh has it, for the shader.
    measureMoved() {
      const { geometry } = this.object;
      if (!geometry.attributes.moved) {
        const moved = new THREE.BufferAttribute(new Float32Array(this.mesh.vertices), 1);
        geometry.setAttribute("moved", moved.setUsage(THREE.DynamicDrawUsage));
      }
      const { moved } = geometry.attributes;
      const [now, rest] = [this.positions, this.mesh.positions];
      for (let i = 0, k = 0; i < now.length; i += 3, k++) {
        const by = Math.hypot(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
        moved.array[k] = by < Infinity ? by : 0;
      }
      moved.needsUpdate = true;
    }

    // The most of it for vertices of this body, m.
    mostMovedOf(own) {
      const rest = this.mesh.positions;
      if (own.length !== rest.length) return 0;
      let most = 0;
      for (let i = 0; i < own.length; i += 3) {
        const square = (own[i] - rest[i]) ** 2 + (own[i + 1] - rest[i + 1]) ** 2 + (own[i + 2] - rest[i + 2]) ** 2;
        if (square > most && square < Infinity) most = square;
      }
      return Math.sqrt(most);
    }

    toScene(place) {
      return rays.turn(this.rotation, place).map((value, k) => value + this.place[k]);
    }

    // The three corners in the scene's frame.
    cornersOf(triangle) {
      return [0, 1, 2].map(k => {
        const at = 3 * this.mesh.corners[3 * triangle + k];
        return this.toScene([this.positions[at], this.positions[at + 1], this.positions[at + 2]]);
      });
    }

    // The triangle of this mesh that has this number in its source; undefined if there is none.
    triangleOf(source) {
      this.bySource ??= new Map(Array.from(this.mesh.sources, (number, triangle) => [number, triangle]));
      return this.bySource.get(source);
    }

    pick(origin, direction) {
      if (!this.rotation) return null;
      return rays.firstTriangle(
        this.positions,
        this.mesh.corners,
        rays.turnBack(this.rotation, rays.sub(origin, this.place)),
        rays.turnBack(this.rotation, direction),
      );
    }

    // Its vertices in the scene's frame: x, y, z one behind the other.
    places() {
      if (!this.rotation) return new Float32Array(0);
      const [m, at, from] = [this.rotation, this.place, this.positions];
      const to = new Float32Array(from.length);
      for (let i = 0; i < from.length; i += 3)
        for (let k = 0; k < 3; k++)
          to[i + k] = m[3 * k] * from[i] + m[3 * k + 1] * from[i + 1] + m[3 * k + 2] * from[i + 2] + at[k];
      return to;
    }

    // The vertices' normals in the scene's frame, as they are now.
    normalsInScene() {
      const [m, from] = [this.rotation, this.normals];
      const to = new Float32Array(from.length);
      for (let i = 0; i < from.length; i += 3)
        for (let k = 0; k < 3; k++)
          to[i + k] = m[3 * k] * from[i] + m[3 * k + 1] * from[i + 1] + m[3 * k + 2] * from[i + 2];
      return to;
    }

    // shades: of occlusion.Bake, one a vertex. Large faces that meet at edges would only have stripes of it.
    setShades(shades) {
      if (this.isFaceted) return;
      const { shade } = this.object.geometry.attributes;
      shade.array.set(shades);
      shade.needsUpdate = true;
    }

    dispose() {
      this.object.geometry.dispose();
      this.object.material.dispose();
    }
  }

  // Triangles that are drawn over the bodies that they belong to.
  class Highlight {
    constructor(material) {
      this.geometry = new THREE.BufferGeometry();
      this.object = new THREE.Mesh(this.geometry, material);
      this.object.frustumCulled = false;
      this.object.renderOrder = material.userData.order;
      this.room = 0;
    }

    // list: [[body view, triangle]...]
    show(list) {
      if (list.length > this.room) {
        this.room = 2 ** Math.ceil(Math.log2(list.length));
        this.geometry.dispose();
        this.array = new Float32Array(9 * this.room);
        this.geometry.setAttribute(
          "position",
          new THREE.BufferAttribute(this.array, 3).setUsage(THREE.DynamicDrawUsage),
        );
      }
      list.forEach(([body, triangle], i) => this.array.set(body.cornersOf(triangle).flat(), 9 * i));
      this.object.visible = list.length > 0;
      if (list.length === 0) return;
      this.geometry.setDrawRange(0, 3 * list.length);
      this.geometry.attributes.position.needsUpdate = true;
    }
  }

  return { BodyView, Highlight };
})();
