// SPDX-License-Identifier: BSD-3-Clause
// How a body looks: one light, shade baked a vertex, the tools' shadows on it, and the shine of what it is. A shader of our
// own: where a processor draws, it is cheaper than the general ones of three.js, and these know no soft shadow of a rod.
"use strict";
const surfaceLight = (() => {
  const RODS = 6; // that cast shadows
  const PATCHES = 2; // of contact that are marked
  const REACH = 10; // radii of a rod: beyond, its shadow is too faint to be seen
  const FINE = 1.3; // radii of a rod: edges that are shorter show its shadow
  const BLUR = 0.03; // radii of the scene: the edge of a shadow is no narrower
  const VEIL = 0.45; // opacity of what hides the tool
  const VEIL_ORDER = 5; // after the tool, before the marks
  // wet: how strong the sun's reflection is; dull: likewise, spread wide; rim: how bright what is seen from the side gets
  const LOOKS = {
    organ: { wet: 0.26, dull: 0.05, rim: 0.16 },
    cloth: { wet: 0, dull: 0, rim: 0.3 },
    bone: { wet: 0.05, dull: 0.16, rim: 0.06 },
  };

  // How much of sun and sky the rods leave: the sun along its ray, the sky by how near they are.
  const BESIDE_RODS = `
    #if RODS > 0
    uniform float blur; // m: the least width of a shadow's edge
    uniform vec4 rodFrom[RODS]; // an end, and the radius
    uniform vec4 rodAxis[RODS]; // from it to the other end, and the square of how far the shadow reaches from its middle
    uniform vec3 rodParts[RODS]; // axis along the sun; 1 / square of the axis across the sun; 1 / square of the axis

    vec2 besideRod(vec3 from, vec3 axis, vec3 parts, float radius, vec3 normal) {
      float f = dot(from, sun);
      float g = dot(from, axis);
      float s = clamp((g - parts.x * f) * parts.y, 0.0, 1.0);
      float t = max(s * parts.x - f, 0.0);
      float gap = length(from + t * sun - s * axis) - radius;
      float soft = 0.3 * radius + 0.2 * t; // a sun that is not a point: the farther the rod, the softer
      float apart = min(1.0, 0.4 * t / radius);
      soft = max(blur, soft + 1.1 * radius * (1.0 - apart)); // a hard edge where they touch, or a thin line, looks like a cut
      float cover = clamp(0.5 - gap / soft, 0.0, 1.0) * min(1.0, 2.0 * radius / soft);
      vec3 to = clamp(g * parts.z, 0.0, 1.0) * axis - from;
      float near = dot(to, to);
      float square = radius * radius;
      float sky = max(dot(to, normal), 0.0) * square * inversesqrt(max(near, 1e-12)) / max(near, square);
      return vec2(1.0 - (0.42 + 0.43 * apart) * cover, 1.0 - 0.8 * clamp(sky, 0.0, 1.0));
    }
    #endif

    vec2 besideRods(vec3 at, vec3 normal) {
      vec2 left = vec2(1.0);
      #if RODS > 0
      #pragma unroll_loop_start
      for (int i = 0; i < RODS; i++) {
        {
          vec3 from = at - rodFrom[ i ].xyz;
          vec3 beside = from - 0.5 * rodAxis[ i ].xyz;
          float along = dot(beside, sun);
          if (dot(beside, beside) - along * along < rodAxis[ i ].w)
            left *= besideRod(from, rodAxis[ i ].xyz, rodParts[ i ], rodFrom[ i ].w, normal);
        }
      }
      #pragma unroll_loop_end
      #endif
      return left;
    }`;

  const VERTEX = `
    attribute float shade;
    varying vec3 across;
    varying float open;
    varying vec3 place;
    #ifdef DEFORMATION
    attribute float moved;
    uniform float movedScale;
    varying float movedPart;
    #endif
    #ifdef FINE
    uniform vec3 sun;
    varying vec2 beside;
    ${BESIDE_RODS}
    #endif
    void main() {
      vec3 at = (modelMatrix * vec4(position, 1.0)).xyz;
      across = mat3(modelMatrix) * normal;
      open = shade;
      #ifdef FINE
      beside = besideRods(at, across);
      #endif
      #ifdef DEFORMATION
      movedPart = moved / movedScale;
      #endif
      place = at;
      gl_Position = projectionMatrix * (modelViewMatrix * vec4(position, 1.0));
    }`;

  const FRAGMENT = `
    uniform vec3 colour;
    uniform vec3 sun;
    uniform vec3 above;
    uniform vec3 toEye; // as if the eye were far away: one direction for all places
    uniform vec3 between; // sun and eye
    uniform vec3 shine;
    uniform float opacity;
    uniform sampler2D ramp;
    uniform vec4 patchFrom[${PATCHES}]; // an end of a contact, and the square of how far its mark reaches from it
    uniform vec4 patchAxis[${PATCHES}]; // from it to the other end, and half the mark's width
    uniform vec4 patchNormal[${PATCHES}]; // and the depth, in parts of the scale
    uniform float patchBody[${PATCHES}]; // the number of the body that is touched
    uniform float number; // of this one
    varying vec3 across;
    varying float open;
    varying vec3 place;
    #ifdef DEFORMATION
    varying float movedPart;
    #endif
    #ifdef FINE
    varying vec2 beside;
    #else
    ${BESIDE_RODS}
    #endif

    // Colour of a contact's depth, and how much of it is seen: as pressure lies under a roller, most in the middle.
    vec4 patchColour(vec3 from, vec4 axis, vec4 normal, vec3 surface) {
      float s = clamp(dot(from, axis.xyz) / max(dot(axis.xyz, axis.xyz), 1e-12), 0.0, 1.0);
      vec3 beside = from - s * axis.xyz;
      float off = dot(beside, normal.xyz);
      if (abs(off) > axis.w) return vec4(0.0); // another side of the body
      beside -= off * normal.xyz;
      float pressure = sqrt(max(0.0, 1.0 - dot(beside, beside) / (axis.w * axis.w)));
      float isTouched = clamp(4.0 * dot(surface, normal.xyz), 0.0, 1.0); // a sheet's other side is not
      return vec4(texture2D(ramp, vec2(normal.w, 0.5)).rgb, 0.9 * pressure * isTouched);
    }

    void main() {
      #ifdef FACETED
      vec3 normal = normalize(cross(dFdx(place), dFdy(place))); // of the triangle, towards the eye
      #else
      vec3 normal = normalize(across);
      #ifdef BOTH_SIDES
        if (!gl_FrontFacing) normal = -normal;
      #endif
      #endif
      #ifdef FINE
      vec2 left = beside;
      #else
      vec2 left = besideRods(place, normal);
      #endif
      float facing = max(dot(normal, sun), 0.0);
      float sky = (0.36 + 0.2 * dot(normal, above)) * open * left.y;
      float side = 1.0 - max(dot(normal, toEye), 0.0);
      side *= side;
      vec3 light = vec3(sky) + vec3(0.86, 0.84, 0.8) * (facing * left.x * (0.45 + 0.55 * open));
      float mirrored = max(dot(normal, between), 0.0);
      mirrored *= mirrored;
      mirrored *= mirrored;
      mirrored *= mirrored;
      float tight = mirrored * mirrored;
      tight *= tight;
      tight *= tight;
      float gleam = (shine.x * tight + shine.y * mirrored) * left.x * open;
      vec3 linear = min(colour * (light + 2.0 * shine.z * side * sky) + vec3(gleam), vec3(1.0));
      vec3 shown = 1.13 * sqrt(linear) - 0.13 * linear; // sRGB within 0.012
      #ifdef DEFORMATION
      shown = mix(shown, texture2D(ramp, vec2(movedPart, 0.5)).rgb, 0.75 * min(1.0, 20.0 * movedPart));
      #endif
      #pragma unroll_loop_start
      for (int i = 0; i < ${PATCHES}; i++) {
        {
          vec3 from = place - patchFrom[ i ].xyz;
          if (patchBody[ i ] == number && dot(from, from) < patchFrom[ i ].w) {
            vec4 mark = patchColour(from, patchAxis[ i ], patchNormal[ i ], normal);
            shown = mix(shown, mark.rgb, mark.a);
          }
        }
      }
      #pragma unroll_loop_end
      gl_FragColor = vec4(shown, opacity);
    }`;

  const vectors = count => Array.from({ length: count }, () => new THREE.Vector4());

  function rampTexture() {
    const WIDE = 64;
    const bytes = Uint8Array.from({ length: 4 * WIDE }, (_, i) =>
      i % 4 === 3 ? 255 : scale.colour((i >> 2) / (WIDE - 1))[i % 4],
    );
    const texture = new THREE.DataTexture(bytes, WIDE, 1);
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
  }

  // What all bodies of a scene share: the light, and the rods in it.
  const sharedUniforms = () => ({
    sun: { value: new THREE.Vector3(0, 0, 1) },
    above: { value: new THREE.Vector3(0, 0, 1) },
    toEye: { value: new THREE.Vector3(0, 0, 1) },
    between: { value: new THREE.Vector3(0, 0, 1) },
    blur: { value: 0 },
    rodFrom: { value: [] },
    rodAxis: { value: [] },
    rodParts: { value: [] },
    ramp: { value: rampTexture() },
    movedScale: { value: 1 },
    patchFrom: { value: vectors(PATCHES) },
    patchAxis: { value: vectors(PATCHES) },
    patchNormal: { value: vectors(PATCHES) },
    patchBody: { value: new Float32Array(PATCHES) },
  });

  // m: the length of the edge of an equilateral triangle as large as the mesh's are on average.
  function usualEdge({ positions, corners }) {
    let area = 0;
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map(k => positions.subarray(3 * corners[i + k], 3 * corners[i + k] + 3));
      const [ux, uy, uz, vx, vy, vz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2], c[0] - a[0], c[1] - a[1], c[2] - a[2]];
      area += 0.5 * Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
    }
    return Math.sqrt((4 / Math.sqrt(3)) * (area / Math.max(1, corners.length / 3)));
  }

  /*
   *   look       a name of LOOKS
   *   bothSides  the body is an open sheet
   *   edge       m, of its triangles: shadows of rods that are thicker are found at the vertices, which costs far less
   *   isFaceted  its faces meet at edges: each triangle has a normal of its own
   *   number     of the body, among all
   */
  function materialOf(shared, { look, bothSides, edge, isFaceted, number }) {
    const { wet, dull, rim } = LOOKS[look];
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      side: bothSides ? THREE.DoubleSide : THREE.FrontSide,
      defines: { RODS: 0, ...(bothSides ? { BOTH_SIDES: "" } : {}), ...(isFaceted ? { FACETED: "" } : {}) },
      uniforms: {
        ...shared,
        colour: { value: new THREE.Color() },
        opacity: { value: 1 },
        number: { value: number },
        shine: { value: new THREE.Vector3(wet, dull, rim) },
      },
    });
    Object.assign(material.userData, { edge, isFaceted });
    return material;
  }

  /*
   *   sun, above, toEye  directions
   *   rods               [{ a, b, radius }...]; those beyond RODS cast no shadow
   *   size               m: radius of the scene
   */
  function setLight(shared, sun, above, toEye, rods, size) {
    shared.blur.value = BLUR * size;
    shared.sun.value.set(...sun).normalize();
    shared.above.value.set(...above);
    shared.toEye.value.set(...toEye);
    shared.between.value.copy(shared.sun.value).add(shared.toEye.value).normalize();
    const few = rods.slice(0, RODS);
    const { x, y, z } = shared.sun.value;
    shared.rodFrom.value = few.map(({ a, radius }) => new THREE.Vector4(...a, radius));
    shared.rodAxis.value = few.map(({ a, b, radius }) => {
      const axis = rays.sub(b, a);
      return new THREE.Vector4(...axis, (rays.length(axis) / 2 + REACH * radius) ** 2);
    });
    shared.rodParts.value = few.map(({ a, b }) => {
      const axis = rays.sub(b, a);
      const square = Math.max(1e-12, rays.dot(axis, axis));
      const along = rays.dot(axis, [x, y, z]);
      return new THREE.Vector3(along, 1 / Math.max(1e-6 * square, square - along * along), 1 / square);
    });
  }

  // patches: [{ a, b, normal, radius, depth, part, number }...] of contacts; the deepest are marked
  function setPatches(shared, patches) {
    const deepest = [...patches].sort((one, other) => other.depth - one.depth);
    for (let i = 0; i < PATCHES; i++) {
      const patch = deepest[i];
      shared.patchFrom.value[i].w = 0;
      if (!patch) continue;
      const { a, b, normal, radius, depth, part, number } = patch;
      const axis = rays.sub(b, a);
      const half = radius + Math.sqrt(2 * radius * depth); // what a roller that is pressed in so deep touches, and its own width
      shared.patchFrom.value[i].set(...a, (rays.length(axis) + 2 * half) ** 2);
      shared.patchAxis.value[i].set(...axis, half);
      shared.patchNormal.value[i].set(...normal, Math.min(1, part));
      shared.patchBody.value[i] = number;
    }
  }

  function setDeformation(material, on) {
    if ("DEFORMATION" in material.defines === on) return;
    if (on) material.defines.DEFORMATION = "";
    else delete material.defines.DEFORMATION;
    material.needsUpdate = true;
  }

  // Whether what is behind a body is seen through it.
  function setVeil(object, on) {
    const { material } = object;
    if (material.transparent === on) return;
    material.transparent = on;
    material.depthWrite = !on;
    material.uniforms.opacity.value = on ? VEIL : 1;
    object.renderOrder = on ? VEIL_ORDER : 0;
  }

  // Another number of rods needs another program, and so do rods that have become thin for the mesh.
  function fitTo(shared, material) {
    const { defines, userData } = material;
    const { length } = shared.rodFrom.value;
    const isFine = shared.rodFrom.value.every(({ w }) => userData.edge < FINE * w);
    if (defines.RODS === length && "FINE" in defines === isFine) return;
    defines.RODS = length;
    if (isFine) defines.FINE = "";
    else delete defines.FINE;
    material.needsUpdate = true;
  }

  return { LOOKS, sharedUniforms, materialOf, usualEdge, setLight, setPatches, setDeformation, setVeil, fitTo };
})();
