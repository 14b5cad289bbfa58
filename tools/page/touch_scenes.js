// SPDX-License-Identifier: BSD-3-Clause
// The scenes of the page: shapes of `dynpoint make`, and of what they are. y is up.
"use strict";
const touchScenes = (() => {
  const LYING = [Math.SQRT1_2, -Math.SQRT1_2, 0, 0]; // what lies in the plane z = 0 lies in y = 0
  const LIVER_RED = [0.55, 0.15, 0.12];
  const fixedBox = (...box) => ({ kind: 1, fixed: 1, box });

  // look: as of a body of a scene file. shape, triangles: for `dynpoint make`; springs: options of the compiler; net: of
  // dpt_springs_def; sag: m, by which it hangs. Materials are those of the program's scenes (src/scene/scene_list.c). By the
  // laws bed and point, springs are stepped after the tool. spread: m, over which a load is spread then. stiffest: N/m,
  // by law, above which what gives way shakes under the tool.
  const SCENES = {
    liver: { title: "Liver, rigid", shape: "liver", triangles: 10000, colour: LIVER_RED },
    soft: {
      title: "Liver, soft",
      shape: "liver",
      triangles: 2692,
      colour: LIVER_RED,
      springs: {
        kind: "volume",
        young: 5000,
        density: 1000,
        drag: 5,
        viscosity: 1e-3,
        spacing: 0.015,
        regions: [fixedBox(-0.2, -0.2, -0.1, 0.2, 0.2, -0.035)],
      },
      spread: 0.03,
      stiffest: { proxy: 2000, bed: 700, point: 700 },
    },
    membrane: {
      title: "Membrane",
      shape: "membrane",
      triangles: 512,
      orientation: LYING,
      springs: {
        kind: "sheet",
        young: 1e5,
        thickness: 1e-3,
        density: 1000,
        drag: 10,
        viscosity: 1e-3,
        regions: [
          fixedBox(-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01),
          fixedBox(0.0999, -0.11, -0.01, 0.11, 0.11, 0.01),
          fixedBox(-0.11, -0.11, -0.01, 0.11, -0.0999, 0.01),
          fixedBox(-0.11, 0.0999, -0.01, 0.11, 0.11, 0.01),
        ],
      },
      spread: 0.0375,
      stiffest: { bed: 300, point: 300 },
    },
    cloth: {
      title: "Cloth",
      look: "cloth",
      shape: "cloth",
      triangles: 2048,
      orientation: LYING,
      springs: {
        kind: "sheet",
        young: 1e5,
        thickness: 1e-3,
        density: 400,
        drag: 10,
        viscosity: 1e-4,
        regions: [
          fixedBox(-0.16, -0.16, -0.1, -0.14, -0.14, 0.1),
          fixedBox(0.14, -0.16, -0.1, 0.16, -0.14, 0.1),
          fixedBox(-0.16, 0.14, -0.1, -0.14, 0.16, 0.1),
          fixedBox(0.14, 0.14, -0.1, 0.16, 0.16, 0.1),
        ],
      },
      net: { gravity: [0, 0, -9.81], sleepSpeed: 0.01 },
      sag: 0.04,
      spread: 0.03,
      stiffest: { bed: 300, point: 300 },
    },
    torus: { title: "Torus", shape: "torus", triangles: 5568, colour: null },
  };
  const shapeOf = ({ shape, triangles }) => `${shape}-${triangles}.ply`; // its name in the page

  return { SCENES, shapeOf };
})();
