# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a loop (.dpr)."""
from __future__ import annotations

import warnings
from importlib import import_module
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

from . import _dynpoint
from ._mesh import PathLike
from ._structs import RECORD, Records


def read_ticks(content: bytes, at: int) -> Tuple[Records, int, str]:
    """Structs of RECORD from byte `at` on; where they end, and "" or what is wrong there."""
    parts: List[Records] = []
    while True:
        part: Records = np.zeros(4096, RECORD)
        count, at, fault = _dynpoint.read_records(content, at, part)
        if count == 0:
            return np.concatenate(parts) if parts else part[:0], at, fault
        parts.append(part[:count])


class Recording:
    """A recording that `dynpoint run` or a Scene wrote. `records` are structs of RECORD, a tick each; `scene` is what the
    writer tells of the scene."""

    __slots__ = ("path", "text", "rate", "began_ns", "records")

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)
        content = self.path.read_bytes()
        self.text, self.rate, self.began_ns, _, at = _dynpoint.read_header(content)
        self.records, at, fault = read_ticks(content, at)
        if fault:
            warnings.warn(f"{self.path}: byte {at}: {fault}; {len(self.records)} records before it are read", stacklevel=2)

    @property
    def scene(self) -> Dict[str, str]:
        return dict(line.split("=", 1) for line in self.text.splitlines() if "=" in line)

    @property
    def time(self) -> Any:
        """s from the first sample."""
        times = self.records["time_ns"]
        return (times - times[0]) * 1e-9 if len(times) else np.zeros(0)

    def plot(self, axes: Any = None) -> Any:
        """Position, force and gap over time, by matplotlib; its figure. `axes`: three of your own."""
        if axes is None:
            _, axes = import_module("matplotlib.pyplot").subplots(3, 1, sharex=True)
        time = self.time
        position = self.records["pose"][:, :3] * 1e3
        force = self.records["asked"][:, :3]
        gap = np.where(self.records["hit_flags"] & 1, self.records["gap"], np.nan) * 1e3
        for axis, name in enumerate("xyz"):
            axes[0].plot(time, position[:, axis], label=name)
            axes[1].plot(time, force[:, axis], label=name)
        axes[2].plot(time, gap)
        for plot, label in zip(axes, ("device, mm", "force, N", "gap, mm")):
            plot.set_ylabel(label)
        axes[0].legend()
        axes[2].set_xlabel("s")
        return axes[0].figure

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        return f"<dynpoint.Recording {self.path.name}: {len(self)} ticks at {self.rate:g} Hz>"
