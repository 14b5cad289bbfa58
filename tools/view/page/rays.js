// SPDX-License-Identifier: BSD-3-Clause
// Geometry on plain arrays: poses, the first triangle that a ray meets, normals of a mesh that deforms.
"use strict";
const rays = (() => {
  const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const length = a => Math.hypot(a[0], a[1], a[2]);
  const along = (a, b, s) => [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])];
  const isPlace = a => a.every(Number.isFinite);

  // The part 0..1 of the stretch ab that is nearest to p.
  function nearestPart(a, b, p) {
    const ab = sub(b, a);
    const square = dot(ab, ab);
    return square > 0 ? Math.min(1, Math.max(0, dot(sub(p, a), ab) / square)) : 0;
  }

  // The rotation matrix, by rows, of a pose [x y z, w x y z]; null if the pose cannot be used.
  function rotation(pose) {
    const [w, x, y, z] = pose.slice(3);
    const square = w * w + x * x + y * y + z * z;
    if (!isPlace(pose) || !(square > 1e-12)) return null;
    const s = 2 / square;
    return [
      1 - s * (y * y + z * z),
      s * (x * y - w * z),
      s * (x * z + w * y),
      s * (x * y + w * z),
      1 - s * (x * x + z * z),
      s * (y * z - w * x),
      s * (x * z - w * y),
      s * (y * z + w * x),
      1 - s * (x * x + y * y),
    ];
  }

  const turn = (m, v) => [0, 3, 6].map(row => m[row] * v[0] + m[row + 1] * v[1] + m[row + 2] * v[2]);
  const turnBack = (m, v) => [0, 1, 2].map(column => m[column] * v[0] + m[column + 3] * v[1] + m[column + 6] * v[2]);

  // { triangle, t } of the nearest triangle on origin + t direction, t > 0, seen from either side; null if none is.
  function firstTriangle(positions, corners, origin, direction) {
    const [ox, oy, oz] = origin;
    const [dx, dy, dz] = direction;
    let nearest = Infinity;
    let triangle = -1;
    for (let i = 0; i < corners.length; i += 3) {
      const a = 3 * corners[i];
      const b = 3 * corners[i + 1];
      const c = 3 * corners[i + 2];
      const ax = positions[a];
      const ay = positions[a + 1];
      const az = positions[a + 2];
      const ux = positions[b] - ax;
      const uy = positions[b + 1] - ay;
      const uz = positions[b + 2] - az;
      const vx = positions[c] - ax;
      const vy = positions[c + 1] - ay;
      const vz = positions[c + 2] - az;
      const px = dy * vz - dz * vy;
      const py = dz * vx - dx * vz;
      const pz = dx * vy - dy * vx;
      const volume = ux * px + uy * py + uz * pz;
      const tx = ox - ax;
      const ty = oy - ay;
      const tz = oz - az;
      const first = (tx * px + ty * py + tz * pz) / volume;
      if (!(first >= 0 && first <= 1)) continue;
      const qx = ty * uz - tz * uy;
      const qy = tz * ux - tx * uz;
      const qz = tx * uy - ty * ux;
      const second = (dx * qx + dy * qy + dz * qz) / volume;
      const t = (vx * qx + vy * qy + vz * qz) / volume;
      if (second >= 0 && first + second <= 1 && t > 0 && t < nearest) {
        nearest = t;
        triangle = i / 3;
      }
    }
    return triangle >= 0 ? { triangle, t: nearest } : null;
  }

  // Each vertex' normal: the sum of its triangles' normals, which weighs them by area, of length 1.
  function makeNormals(positions, corners, normals) {
    normals.fill(0);
    for (let i = 0; i < corners.length; i += 3) {
      const a = 3 * corners[i];
      const b = 3 * corners[i + 1];
      const c = 3 * corners[i + 2];
      const ux = positions[b] - positions[a];
      const uy = positions[b + 1] - positions[a + 1];
      const uz = positions[b + 2] - positions[a + 2];
      const vx = positions[c] - positions[a];
      const vy = positions[c + 1] - positions[a + 1];
      const vz = positions[c + 2] - positions[a + 2];
      const x = uy * vz - uz * vy;
      const y = uz * vx - ux * vz;
      const z = ux * vy - uy * vx;
      normals[a] += x;
      normals[a + 1] += y;
      normals[a + 2] += z;
      normals[b] += x;
      normals[b + 1] += y;
      normals[b + 2] += z;
      normals[c] += x;
      normals[c + 1] += y;
      normals[c + 2] += z;
    }
    for (let i = 0; i < normals.length; i += 3) {
      const x = normals[i];
      const y = normals[i + 1];
      const z = normals[i + 2];
      const by = 1 / (Math.sqrt(x * x + y * y + z * z) || 1);
      normals[i] = x * by;
      normals[i + 1] = y * by;
      normals[i + 2] = z * by;
    }
  }

  // The lengths of the box that holds all places.
  function extent(positions) {
    const least = [Infinity, Infinity, Infinity];
    const most = least.map(() => -Infinity);
    positions.forEach((value, i) => {
      least[i % 3] = Math.min(least[i % 3], value);
      most[i % 3] = Math.max(most[i % 3], value);
    });
    return positions.length > 0 ? sub(most, least) : [0, 0, 0];
  }

  // Whether each edge has one triangle on either side, wound alike: then no back of a triangle is seen from outside.
  function isClosed(corners) {
    const edges = new Set();
    const key = (a, b) => a * 4294967296 + b;
    for (let i = 0; i < corners.length; i++) {
      const edge = key(corners[i], corners[i % 3 === 2 ? i - 2 : i + 1]);
      if (edges.has(edge)) return false;
      edges.add(edge);
    }
    for (let i = 0; i < corners.length; i++)
      if (!edges.has(key(corners[i % 3 === 2 ? i - 2 : i + 1], corners[i]))) return false;
    return true;
  }

  // Whether most corners lie at edges: their triangles are turned more than 25 degrees from the vertices' normals.
  function isFaceted({ positions, corners }) {
    const STEEP = 0.9; // cosine
    const normals = new Float32Array(positions.length);
    makeNormals(positions, corners, normals);
    let steep = 0;
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map(k => positions.subarray(3 * corners[i + k], 3 * corners[i + k] + 3));
      const [u, v] = [sub(b, a), sub(c, a)];
      const face = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const least = STEEP * length(face);
      for (let k = 0; k < 3; k++) {
        const at = 3 * corners[i + k];
        if (dot(face, normals.subarray(at, at + 3)) < least) steep++;
      }
    }
    return 2 * steep > corners.length;
  }

  return {
    sub,
    dot,
    length,
    along,
    isPlace,
    nearestPart,
    rotation,
    turn,
    turnBack,
    firstTriangle,
    makeNormals,
    isClosed,
    isFaceted,
    extent,
  };
})();
