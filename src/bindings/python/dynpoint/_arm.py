# SPDX-License-Identifier: BSD-3-Clause
"""Arms: links that joints move."""
from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Iterator, Tuple, Type, TypeVar

import numpy as np

from . import _dynpoint
from ._files import PROGRAM
from ._mesh import Mesh, PathLike
from ._structs import ARM_INFO, ARM_JOINT, ARM_LINK, SEGMENT, Floats, Numbers, Records, room

A = TypeVar("A", bound="Arm")
_MAGIC = b"\211DPK\r\n\032\n"  # ARM_MAGIC of arm/arm_format.h


class Arm(_dynpoint.Arm):
    """A robot's arm, of a URDF or compiled (a .dpa of `dynpoint compile`). Joints are rad or m; frames are the root's."""

    __slots__ = ("__weakref__",)

    @classmethod
    def load(cls: Type[A], path: PathLike, *options: str) -> A:
        """A compiled arm, or a URDF where the system has urdfdom; options are those of `dynpoint compile`, as "--tool"."""
        path = Path(path)
        content = path.read_bytes()
        if path.suffix.lower() == ".dpa" or content.startswith(_MAGIC):
            if options:
                raise TypeError(f"{path}: it is compiled already: there are no options to choose")
            return cls(content)
        with TemporaryDirectory() as room:
            made = Path(room, "arm.dpa")
            ran = subprocess.run([PROGRAM, "compile", path, "-o", made, *options], encoding="utf-8", errors="replace",
                                 capture_output=True)
            if ran.returncode:
                raise _dynpoint.Error(ran.stderr.strip().removeprefix("dynpoint compile: "))
            return cls(made.read_bytes())

    @property
    def info(self) -> Any:
        """What it holds (dpt_arm_info)."""
        info = room(ARM_INFO)
        self.get("info", 0, info)
        return info[0]

    def _all(self, name: str, dtype: Any, count: int) -> Records:
        items = np.zeros(count, dtype)
        for i in range(count):
            self.get(name, i, items[i:i + 1])
        return items

    @property
    def joints(self) -> Records:
        return self._all("joint", ARM_JOINT, int(self.info.joints))

    @property
    def links(self) -> Records:
        return self._all("link", ARM_LINK, int(self.info.links))

    @property
    def segments(self) -> Records:
        """The tool's, in its frame: as World.add_tool takes them."""
        return self._all("segment", SEGMENT, int(self.info.segments))

    @property
    def bodies(self) -> Iterator[Tuple[str, Floats, Mesh]]:
        """Name, pose and mesh of each body of the scene."""
        content = memoryview(self)
        for i in range(int(self.info.bodies)):
            name, pose, at, size = self.get_body(i)
            yield name, np.array(pose), Mesh(content[at:at + size])

    def forward(self, joints: Numbers) -> Floats:
        """The pose of the tool's frame."""
        return np.array(self.get_forward(joints))

    def velocity(self, joints: Numbers, rates: Numbers) -> Floats:
        """Velocity and spin of the tool's frame."""
        return np.array(self.get_velocity(joints, rates))

    def jacobian(self, joints: Numbers) -> Floats:
        """(6, joints)"""
        return np.array(self.get_jacobian(joints)).reshape(6, -1)

    def efforts(self, joints: Numbers, wrench: Numbers) -> Floats:
        """Of the motors, with which the tool exerts `wrench` on the hand."""
        return np.array(self.get_efforts(joints, wrench))

    def weight(self, joints: Numbers, gravity: Numbers = (0.0, 0.0, -9.81)) -> Floats:
        """Efforts that hold up the arm's own weight."""
        return np.array(self.get_weight(joints, gravity))

    def __reduce__(self) -> Any:
        return type(self), (bytes(memoryview(self)),)

    def __repr__(self) -> str:
        info = self.info
        return f"<dynpoint.Arm {info.name.decode()}: {info.joints} joints, {info.segments} segments, {info.bodies} bodies>"
