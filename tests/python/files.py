# SPDX-License-Identifier: BSD-3-Clause
"""Meshes of others: objects of trimesh, meshio and pyvista, files that they read (glTF, 3MF, VTK, Gmsh), and pictures by
matplotlib. A mesh that came through them has the bytes of the one that did not."""

import importlib.util
import io
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

import numpy as np

import dynpoint as dp
from verdicts import main

NEEDS = {
    name: unittest.skipUnless(importlib.util.find_spec(name), f"no {name}")
    for name in ("trimesh", "meshio", "pyvista", "matplotlib", "lxml")
}
# A house: five corners a side, a roof, closed; no symmetry hides a turn or a mirror.
CORNERS = np.array(
    [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0], [0, 0, 2], [4, 0, 2], [4, 3, 2], [0, 3, 2], [1, 1, 5]], float
)
QUADS = np.array([[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
ROOF = np.array([[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]])
FACES = np.vstack((QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]], ROOF))
UNIT = "cm"


def shape(mesh):
    """What does not depend on the order of vertices and triangles: all triangles as points, each from its least corner
    on."""
    corners = mesh.vertices[mesh.triangles].astype(float).round(6) + 0.0
    turned = [min(np.roll(three, -k, axis=0).tolist() for k in range(3)) for three in corners]
    return sorted(turned)


def glb():
    """The house as binary glTF, written by hand from its specification: in metres, as that says."""
    points, faces = CORNERS.astype("<f4").tobytes(), FACES.astype("<u2").tobytes()
    faces += bytes(-len(faces) % 4)
    text = (
        '{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[1,2,3]}],'
        '"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":['
        '{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3","min":[0,0,0],"max":[4,3,5]},'
        '{"bufferView":1,"componentType":5123,"count":%d,"type":"SCALAR"}],"bufferViews":['
        '{"buffer":0,"byteLength":%d},{"buffer":0,"byteOffset":%d,"byteLength":%d}],"buffers":[{"byteLength":%d}]}'
        % (len(CORNERS), FACES.size, len(points), len(points), FACES.size * 2, len(points) + len(faces))
    ).encode()
    text += b" " * (-len(text) % 4)
    content = points + faces
    return (
        struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(content))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(content), b"BIN\0")
        + content
    )


def three_mf():
    """The house as 3MF: a zip with one model."""
    model = [
        '<?xml version="1.0"?><model unit="millimeter" '
        'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
        '<object id="1" type="model"><mesh><vertices>'
    ]
    model += [f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CORNERS]
    model += ["</vertices><triangles>"] + [f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in FACES]
    model += ['</triangles></mesh></object></resources><build><item objectid="1"/></build></model>']
    room = io.BytesIO()
    with zipfile.ZipFile(room, "w") as packed:
        packed.writestr("3D/3dmodel.model", "".join(model))
        packed.writestr(
            "[Content_Types].xml",
            '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
            '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
            '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/></Types>',
        )
        packed.writestr(
            "_rels/.rels",
            '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
            '<Relationship Target="/3D/3dmodel.model" Id="r" '
            'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
        )
    return room.getvalue()


def vtk():
    """The house as VTK's legacy text, with its quadrangles."""
    cells = [*QUADS.tolist(), *ROOF.tolist()]
    lines = [
        "# vtk DataFile Version 3.0",
        "house",
        "ASCII",
        "DATASET UNSTRUCTURED_GRID",
        f"POINTS {len(CORNERS)} double",
        *(" ".join(map(str, corner)) for corner in CORNERS),
        f"CELLS {len(cells)} {sum(map(len, cells)) + len(cells)}",
        *(" ".join(map(str, [len(cell), *cell])) for cell in cells),
        f"CELL_TYPES {len(cells)}",
        *("9" if len(cell) == 4 else "5" for cell in cells),
    ]
    return ("\n".join(lines) + "\n").encode()


def gmsh():
    """The house as Gmsh's text of version 2.2."""
    lines = [
        "$MeshFormat",
        "2.2 0 8",
        "$EndMeshFormat",
        "$Nodes",
        str(len(CORNERS)),
        *(f"{i + 1} {x} {y} {z}" for i, (x, y, z) in enumerate(CORNERS)),
        "$EndNodes",
        "$Elements",
        str(len(FACES)),
        *(f"{i + 1} 2 2 1 1 {a + 1} {b + 1} {c + 1}" for i, (a, b, c) in enumerate(FACES)),
        "$EndElements",
    ]
    return ("\n".join(lines) + "\n").encode()


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.house = dp.Mesh.compile(CORNERS, FACES, unit=UNIT)

    def loaded(self, name, content, **settings):
        with tempfile.TemporaryDirectory() as room:
            path = Path(room) / name
            path.write_bytes(content)
            return dp.Mesh.load(path, **settings)

    def same(self, mesh, bytes_too=True):
        self.assertEqual(shape(mesh), shape(self.house))
        self.assertEqual(int(mesh.info.open_edges), 0)
        if bytes_too:
            self.assertEqual(mesh, self.house)

    def as_far(self, mesh):
        """Planes may be cut into triangles in any way: then every point is as far, and on the same side."""
        self.assertEqual((len(mesh), int(mesh.info.open_edges)), (len(self.house), 0))
        points = np.random.default_rng(7).uniform(-0.02, 0.06, (2000, 3))
        wanted = self.house.distance(points, signed=True)
        self.assertGreater(np.count_nonzero(wanted < 0), 20)
        self.assertTrue(np.allclose(mesh.distance(points, signed=True), wanted, rtol=0, atol=1e-9))

    @NEEDS["trimesh"]
    def test_an_object_of_trimesh(self):
        import trimesh

        house = trimesh.Trimesh(CORNERS, FACES, process=False)
        self.same(dp.Mesh.from_object(house, unit=UNIT))
        moved = trimesh.Scene()
        moved.add_geometry(
            trimesh.Trimesh(CORNERS - (1, 2, 3), FACES, process=False),
            transform=trimesh.transformations.translation_matrix((1, 2, 3)),
        )
        self.same(dp.Mesh.from_object(moved, unit=UNIT))

    @NEEDS["trimesh"]
    def test_glTF(self):
        there = dp.Mesh.compile(CORNERS + (1, 2, 3), FACES, unit="m")  # a node moves it
        self.assertEqual(shape(self.loaded("Haus ü.glb", glb(), unit="m")), shape(there))

    @NEEDS["trimesh"]
    @NEEDS["lxml"]
    def test_3MF(self):
        self.same(self.loaded("house.3mf", three_mf(), unit=UNIT), False)

    @NEEDS["meshio"]
    def test_an_object_of_meshio(self):
        import meshio

        self.same(dp.Mesh.from_object(meshio.Mesh(CORNERS, {"triangle": FACES}), unit=UNIT))
        self.same(
            dp.Mesh.from_object(
                meshio.Mesh(CORNERS, [("quad", QUADS[:2]), ("triangle", ROOF), ("quad", QUADS[2:])]), unit=UNIT
            ),
            False,
        )
        with self.assertRaisesRegex(ValueError, "not triangles and quadrangles alone, but triangle, triangle6"):
            dp.Mesh.from_object(
                meshio.Mesh(CORNERS, [("triangle", ROOF), ("triangle6", [[0, 1, 2, 3, 4, 5]])]), unit=UNIT
            )
        with self.assertRaisesRegex(ValueError, "no triangles in it, but line"):
            dp.Mesh.from_object(meshio.Mesh(CORNERS, {"line": [[0, 1]]}), unit=UNIT)

    @NEEDS["meshio"]
    def test_VTK_and_Gmsh(self):
        self.same(self.loaded("house.vtk", vtk(), unit=UNIT), False)
        self.same(self.loaded("house.msh", gmsh(), unit=UNIT))

    @NEEDS["pyvista"]
    def test_an_object_of_pyvista(self):
        import pyvista

        house = pyvista.PolyData.from_regular_faces(CORNERS, FACES)
        self.same(dp.Mesh.from_object(house, unit=UNIT))
        cells = [word for cell in [*QUADS.tolist(), *ROOF.tolist()] for word in (len(cell), *cell)]
        self.as_far(dp.Mesh.from_object(pyvista.PolyData(CORNERS, faces=cells), unit=UNIT))
        grid = pyvista.UnstructuredGrid(cells, [9] * len(QUADS) + [5] * len(ROOF), CORNERS)
        self.as_far(dp.Mesh.from_object(grid, unit=UNIT))

    @NEEDS["trimesh"]
    @NEEDS["meshio"]
    def test_a_unit_is_asked_for_and_what_nobody_reads_is_named(self):
        with self.assertRaisesRegex(TypeError, r"house.glb: wanted unit="):
            self.loaded("house.glb", glb())
        with self.assertRaisesRegex(ValueError, "house.xyzzy: not OBJ, STL, PLY or OFF; tried trimesh"):
            self.loaded("house.xyzzy", b"?", unit=UNIT)
        with self.assertRaisesRegex(ValueError, "house.glb: not OBJ"):
            self.loaded("house.glb", glb()[:200], unit=UNIT)
        with self.assertRaisesRegex(ValueError, "house.vtk: not OBJ.*tried meshio"):
            self.loaded("house.vtk", b"nothing", unit=UNIT)
        with self.assertRaisesRegex(TypeError, "wanted a mesh of trimesh, meshio or pyvista, not int"):
            dp.Mesh.from_object(7, unit=UNIT)

    def test_without_trimesh_and_meshio_they_are_named(self):
        said = subprocess.run(
            [
                sys.executable,
                "-c",
                "import sys; sys.modules['trimesh'] = sys.modules['meshio'] = None\n"
                "import dynpoint as dp; dp.Mesh.load('house.glb', unit='m')",
            ],
            capture_output=True,
            text=True,
        )
        self.assertIn(
            "not OBJ, STL, PLY or OFF; tried meshio, which is not installed and trimesh, which is not installed",
            said.stderr,
        )

    @NEEDS["matplotlib"]
    def test_a_recording_is_drawn(self):
        import matplotlib

        matplotlib.use("svg")
        with tempfile.TemporaryDirectory() as room:
            with dp.Scene("liver", "sim:?hand=press", ticks=1200, record=Path(room) / "r.dpr") as scene:
                scene.run()
            recording = dp.Recording(Path(room) / "r.dpr")
            figure = recording.plot()
            lines = [[line.get_ydata() for line in axes.get_lines()] for axes in figure.axes]
            self.assertEqual([len(each) for each in lines], [3, 3, 1])
            self.assertTrue(np.array_equal(lines[1], recording.records["asked"][:, :3].T))
            self.assertTrue(np.array_equal(lines[0][1], recording.records["pose"][:, 1] * 1e3))
            picture = Path(room) / "r.svg"
            figure.savefig(picture)
            paths = xml.parse(picture).getroot().findall(".//{http://www.w3.org/2000/svg}path")
            drawn = [path for path in paths if len(re.findall("[ML]", path.get("d") or "")) > 50]
            self.assertGreaterEqual(len(drawn), 2)
            self.assertIs(recording.plot(figure.axes), figure)


main()
