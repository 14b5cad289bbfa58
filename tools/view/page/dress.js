// SPDX-License-Identifier: BSD-3-Clause
// What a tool looks like by meshes of the user's own, for the eye alone. Their frame begins at end a of the tool's first
// segment; z leads towards end b, and x is as near to the tool's as that allows. Jaws turn about their hinges.
"use strict";
const dress = (() => {
  const SHINE = { shininess: 60, specular: 0x999999 };

  // A matrix that turns by an angle about an axis through a place.
  function turnAbout([x, y, z, ...axis], angle) {
    const turn = new THREE.Matrix4().makeRotationAxis(new THREE.Vector3(...axis.slice(0, 3)).normalize(), angle);
    const to = new THREE.Matrix4().makeTranslation(x, y, z);
    return to.multiply(turn).multiply(new THREE.Matrix4().makeTranslation(-x, -y, -z));
  }

  function geometryOf({ positions, corners, vertices }) {
    const geometry = new THREE.BufferGeometry();
    const normals = new Float32Array(3 * vertices);
    rays.makeNormals(positions, corners, normals);
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setIndex(new THREE.BufferAttribute(corners, 1));
    return geometry;
  }

  class Dress {
    // parts: as the scene has them; meshes: all of the scene's
    constructor(parts, meshes) {
      this.parts = parts.map(part => {
        const mesh = meshes[part.mesh];
        const side = rays.isClosed(mesh.corners) ? THREE.FrontSide : THREE.DoubleSide;
        // Transparent, so that it is drawn with the tool's other parts.
        const material = new THREE.MeshPhongMaterial({ ...SHINE, side, transparent: true });
        const object = new THREE.Mesh(geometryOf(mesh), material);
        Object.assign(object, { frustumCulled: false, matrixAutoUpdate: false, renderOrder: 1 });
        const [x, y, z, w, i, j, k] = part.pose;
        const pose = new THREE.Matrix4().compose(
          new THREE.Vector3(x, y, z),
          new THREE.Quaternion(i, j, k, w),
          new THREE.Vector3(1, 1, 1),
        );
        return { ...part, object, pose };
      });
    }

    get objects() {
      return this.parts.map(({ object }) => object);
    }

    // steel: the colour of parts that have none
    readColours(steel) {
      for (const { object, colour } of this.parts)
        if (colour) object.material.color.setRGB(...colour, THREE.SRGBColorSpace);
        else object.material.color.copy(steel);
    }

    // frame: of instruments.frameOf, or null: the tool is nowhere; opening: of the jaws, 0 to 1
    place(frame, opening) {
      for (const { object, pose, hinge } of this.parts) {
        object.visible = frame !== null;
        if (!frame) continue;
        const { from, side, across, axis } = frame;
        object.matrix.makeBasis(...[side, across, axis].map(way => new THREE.Vector3(...way))).setPosition(...from);
        if (hinge) object.matrix.multiply(turnAbout(hinge, opening * hinge[6]));
        object.matrix.multiply(pose);
        object.matrixWorldNeedsUpdate = true;
      }
    }

    dispose() {
      for (const { object } of this.parts) {
        object.geometry.dispose();
        object.material.dispose();
      }
    }
  }

  return { Dress };
})();
