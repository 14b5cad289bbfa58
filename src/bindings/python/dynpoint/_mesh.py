# SPDX-License-Identifier: BSD-3-Clause
"""Meshes: compiled, loaded, asked."""
from __future__ import annotations

import os
import warnings
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from pathlib import Path
from typing import Any, Iterable, Mapping, Optional, Type, TypeVar, Union

import numpy as np
import numpy.typing as npt

from . import _dynpoint
from ._structs import HIT, MESH_INFO, SPRING_REGION, Floats, Numbers, Records, room

PathLike = Union[str, "os.PathLike[str]"]
M = TypeVar("M", bound="Mesh")

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
_OWN = {".obj", ".stl", ".ply", ".off"}


def scale_of(unit: Union[str, float]) -> float:
    """Metres in a unit.

    >>> scale_of("mm")
    0.001
    """
    if isinstance(unit, str):
        if unit not in UNITS:
            raise ValueError(f"unit: {unit!r} is none of {', '.join(UNITS)}; a number of metres is taken too")
        return UNITS[unit]
    return float(unit)


def _corners(triangles: Any) -> npt.NDArray[np.uint32]:
    """Three vertex numbers a triangle, as the library has them; without a copy if they are uint32."""
    array = np.asarray(triangles)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise TypeError(f"triangles: wanted whole numbers of shape (n, 3), not {array.dtype} of shape {array.shape}")
    if array.size and (array.min() < 0 or array.max() > 0xFFFFFFFF):
        raise ValueError("triangles: a number is below 0 or does not fit into 32 bits")
    return np.ascontiguousarray(array, np.uint32)


def _points(points: Any, what: str) -> Floats:
    array = np.asarray(points)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise TypeError(f"{what}: wanted numbers of shape (n, 3), not {array.dtype} of shape {array.shape}")
    return np.ascontiguousarray(array, np.float64)


def _regions(places: Iterable[Mapping[str, Any]]) -> Records:
    """Regions as dpt_spring_region: a `box` of lowest and highest x, y, z, or a `sphere` of x, y, z and radius, in m."""
    regions = np.zeros(0, SPRING_REGION)
    for number, place in enumerate(places):
        rest, region = dict(place), np.zeros(1, SPRING_REGION)
        shapes = [name for name in ("box", "sphere") if name in rest]
        if len(shapes) != 1 or set(rest) - set(shapes) not in ({"fixed"}, {"young", "density", "drag"}):
            raise ValueError(f"springs['regions'][{number}]: wanted a box or a sphere, and either fixed, or young, density "
                             f"and drag; not {', '.join(sorted(rest))}")
        extent = np.asarray(rest.pop(shapes[0]), np.float64).ravel()
        if len(extent) != {"box": 6, "sphere": 4}[shapes[0]]:
            raise ValueError(f"springs['regions'][{number}]: a box has 6 numbers, a sphere 4, not {len(extent)}")
        region["kind"], region["box"][0, :len(extent)] = 1 + (shapes[0] == "sphere"), extent
        for name, value in rest.items():
            region[name] = value
        regions = np.concatenate((regions, region))
    return regions


class Mesh(_dynpoint.Mesh):
    """A compiled mesh: `Mesh.compile` makes one of arrays, `Mesh.load` of a file. It does not change, and threads may share
    it. `bytes(mesh)` is the content of a .dpa file.

    >>> mesh = Mesh.compile([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], unit="m")
    >>> len(mesh), int(mesh.info.open_edges)
    (1, 3)
    >>> float(mesh.distance([[0.25, 0.25, 2]])[0])
    2.0
    """

    __slots__ = ("__weakref__",)

    @classmethod
    def _compile(cls: Type[M], what: str, source: Any, triangles: Any, settings: Mapping[str, Any]) -> M:
        rest = dict(settings)
        springs, nodes, cells = rest.pop("springs", None), rest.pop("nodes", None), rest.pop("cells", None)
        if springs is not None:
            springs = dict(springs)
            if "fixed" in springs:
                springs["fixed"] = np.ascontiguousarray(springs["fixed"], np.uint32)
            if "regions" in springs and not isinstance(springs["regions"], np.ndarray):
                springs["regions"] = _regions(springs["regions"])
        if nodes is not None:
            nodes, cells = _points(nodes, "nodes"), np.ascontiguousarray(cells, np.uint32)
        notes: list[str] = []
        mesh = cls.compile_source(what, source, triangles, notes, springs, nodes, cells, **rest)
        for note in notes:
            warnings.warn(f"{what}: {note}", stacklevel=3)
        return mesh

    @classmethod
    def compile(cls: Type[M], vertices: Any, triangles: Any, *, unit: Union[str, float], **settings: Any) -> M:
        """A mesh of arrays: vertices (n, 3), triangles (m, 3) of vertex numbers from 0. `unit` is that of the vertices: one of
        UNITS, or a number of metres. Float64 and uint32 are taken as they are, others are converted.

        Settings are those of dpt_compile_def: crease, threads, recentre; `springs`, a dict of dpt_spring_net_def's with
        `kind` "sheet" or "volume", `fixed` vertices of the source, and `regions`, a list of dicts with a `box` or a
        `sphere`, and `fixed`, or `young`, `density` and `drag` there; `nodes` and `cells`, tetrahedra that the vertices follow.
        What one should know of the source comes as warnings."""
        return cls._compile("Mesh.compile", _points(vertices, "vertices"), _corners(triangles),
                            {"scale": scale_of(unit), **settings})

    @classmethod
    def load(cls: Type[M], path: PathLike, *, unit: Union[str, float, None] = None, **settings: Any) -> M:
        """A mesh of a file. A compiled one (.dpa) needs no unit. OBJ, STL, PLY and OFF are read here, others by trimesh or
        meshio, where they are installed."""
        path = Path(path)
        if path.suffix == ".dpa":
            if unit is not None or settings:
                raise TypeError(f"{path}: it is compiled already: there is no unit and there are no settings to choose")
            return cls(path.read_bytes())
        if unit is None:
            raise TypeError(f"{path}: wanted unit=, as 'mm': no file of this kind says what it is in")
        if path.suffix.lower() in _OWN:
            shown = str(path).encode("utf-8", "replace").decode()  # names may have any bytes
            return cls._compile(shown, path.read_bytes(), None, {"scale": scale_of(unit), **settings})
        return cls.from_object(_read_foreign(path), unit=unit, **settings)

    @classmethod
    def from_object(cls: Type[M], other: Any, *, unit: Union[str, float], **settings: Any) -> M:
        """A mesh of one of trimesh, meshio or pyvista."""
        if hasattr(other, "geometry") and hasattr(other, "to_geometry"):  # trimesh.Scene
            other = other.to_geometry()
        if hasattr(type(other), "triangulate"):  # pyvista: a surface, or cells that have one
            surface = (other if hasattr(type(other), "is_all_triangles") else other.extract_geometry()).triangulate()
            return cls.compile(surface.points, surface.faces.reshape(-1, 4)[:, 1:], unit=unit, **settings)
        if hasattr(other, "vertices") and hasattr(other, "faces"):  # trimesh
            return cls.compile(other.vertices, other.faces, unit=unit, **settings)
        if hasattr(other, "cells_dict"):  # meshio
            others = [kind for kind in other.cells_dict if kind.startswith(("triangle", "quad", "polygon"))]
            if set(others) - {"triangle", "quad"}:
                raise ValueError(f"its faces are not triangles and quadrangles alone, but {', '.join(others)}")
            faces = [cells for kind, cells in other.cells_dict.items() if kind == "triangle"]
            faces += [np.vstack((q[:, [0, 1, 2]], q[:, [0, 2, 3]])) for kind, q in other.cells_dict.items() if kind == "quad"]
            if not faces:
                raise ValueError(f"no triangles in it, but {', '.join(other.cells_dict) or 'nothing'}")
            return cls.compile(np.asarray(other.points)[:, :3], np.vstack(faces), unit=unit, **settings)
        raise TypeError(f"wanted a mesh of trimesh, meshio or pyvista, not {type(other).__name__}")

    def save(self, path: PathLike) -> None:
        """Write a .dpa file."""
        Path(path).write_bytes(bytes(self))

    @property
    def info(self) -> Any:
        """What the compiler found and repaired, and what the mesh holds (dpt_mesh_info)."""
        info = room(MESH_INFO)
        self.get_info(info)
        return info[0]

    def _view(self, name: str, dtype: Any) -> npt.NDArray[Any]:
        at, count = self.place(name)
        array: npt.NDArray[Any] = np.frombuffer(memoryview(self), dtype, count, at)
        return array

    @property
    def vertices(self) -> npt.NDArray[np.float32]:
        """(n, 3), m: a view of the mesh's own bytes."""
        return self._view("vertices", np.float32).reshape(-1, 3)

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """(n, 3), vertex numbers: a view. `numbers` has the source's number of each."""
        return self._view("triangles", np.uint32).reshape(-1, 3)

    @property
    def numbers(self) -> npt.NDArray[np.uint32]:
        return self._view("numbers", np.uint32)

    @property
    def vertex_sources(self) -> npt.NDArray[np.uint32]:
        """The source's number of each vertex: mesh.vertices[v] is source[mesh.vertex_sources[v]]."""
        return self._view("sources", np.uint32)

    def query(self, a: Any, b: Any = None, radius: Union[float, Floats, None] = None, *, pose: Optional[Numbers] = None,
              threads: int = 1, out: Optional[Records] = None, **settings: Any) -> Records:
        """The nearest pairs of segments and the mesh: structs of HIT. `a` and `b` are (n, 3); or `a` alone is (n, 6), which
        saves a copy. Arrays must be float64 and in C order. `method`, and `pair=1` for the pair without gap and depth, are
        those of dpt_query_def. Python goes on meanwhile; `threads` share the segments."""
        if not isinstance(a, np.ndarray):
            a = np.array(a, np.float64)
        if b is None:
            ends = a
        else:
            b = b if isinstance(b, np.ndarray) else np.array(b, np.float64)
            if a.shape != b.shape or a.ndim != 2 or a.shape[1] != 3 or a.dtype != np.float64 or b.dtype != np.float64:
                raise TypeError(f"a, b: wanted float64 of shape (n, 3), not {a.dtype} {a.shape} and {b.dtype} {b.shape}")
            ends = np.concatenate((a, b), axis=1)
        if ends.ndim != 2 or ends.shape[1] != 6:
            raise ValueError(f"a: wanted an array of shape (n, 6), or of (n, 3) beside b, not {ends.shape}")
        count = len(ends)
        if radius is not None and not isinstance(radius, np.ndarray):
            radius = np.full(count, radius, np.float64)
        hits = np.zeros(count, HIT) if out is None else out
        threads = max(1, min(int(threads), count))
        if threads == 1:
            self.query_rows(ends, radius, hits, pose, 0, count, **settings)
            return hits
        edges = [count * i // threads for i in range(threads + 1)]
        with ThreadPoolExecutor(threads) as pool:
            parts = [pool.submit(self.query_rows, ends, radius, hits, pose, first, last - first, **settings)
                     for first, last in zip(edges, edges[1:])]
        for part in parts:
            part.result()
        return hits

    def distance(self, points: Any, *, signed: bool = False, threads: int = 1) -> Floats:
        """The distance of points (n, 3) to the surface, m. Signed, it is negative inside, and NaN where no inside is
        known."""
        places = _points(points, "points")
        hits = self.query(np.concatenate((places, places), axis=1), pair=0 if signed else 1, threads=threads)
        if not signed:
            return np.array(hits["distance"])
        return np.where(hits["flags"] & 1, hits["gap"], np.nan)

    def __len__(self) -> int:
        return int(self.info.triangles)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mesh) and bytes(self) == bytes(other)

    def __hash__(self) -> int:
        return hash(bytes(self))

    def __reduce__(self) -> Any:
        return type(self), (bytes(self),)

    def __repr__(self) -> str:
        info = self.info
        closed = "closed" if info.open_edges == 0 else f"{info.open_edges} open edges"
        springs = f", {info.springs} springs" if info.springs else ""
        extent = " x ".join(f"{x:.4g}" for x in info.box_max - info.box_min)
        return f"<dynpoint.Mesh: {info.triangles} triangles, {closed}, {extent} m{springs}>"


def _read_foreign(path: Path) -> Any:
    """Formats that meshio knows are read by it: trimesh hands them on to it, and leaves out what is not a triangle."""
    tried = []
    for module, read in (("meshio", "read"), ("trimesh", "load")):
        try:
            library = import_module(module)
        except ImportError:
            tried.append(f"{module}, which is not installed")
            continue
        is_known = module == "meshio" and path.suffix.lower() in library.extension_to_filetypes
        if module == "meshio" and not is_known:
            continue
        try:
            return getattr(library, read)(path)
        except (Exception, SystemExit) as error:  # a reader of somebody else's; meshio's leaves the program
            tried.append(f"{module} ({error})")
        if is_known:
            break
    raise ValueError(f"{path}: not OBJ, STL, PLY or OFF; tried {' and '.join(tried)}")
