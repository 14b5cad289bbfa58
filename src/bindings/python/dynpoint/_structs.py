# SPDX-License-Identifier: BSD-3-Clause
"""The library's structs as dtypes of NumPy, made from its own list of layouts, and its constants as enums."""
from __future__ import annotations

from enum import IntEnum, IntFlag
from typing import Any, Sequence, Union, cast

import numpy as np
import numpy.typing as npt

from . import _dynpoint

Floats = npt.NDArray[np.float64]
Records = npt.NDArray[np.void]
Numbers = Union[Floats, Sequence[float]]


def _field(name: str) -> Any:
    """A field whose name NumPy has for something else."""
    def get(self: Any) -> Any:
        return self[name] if name in (self.dtype.names or ()) else getattr(super(Struct, self), name)

    return property(get)


class Struct(np.record):  # type: ignore[misc]  # NumPy's stubs call its base final
    """A struct of the library's: its fields are attributes, but for `size`, which is NumPy's own."""

    flags = _field("flags")
    put = _field("put")
    device = _field("device")


_KINDS = {"I": "u4", "i": "i4", "Q": "u8", "q": "i8", "f": "f4", "d": "f8"}


def _dtype(name: str) -> np.dtype[Struct]:
    size, fields = _dynpoint.fields(name)
    names, formats, offsets = [], [], []
    for field, kind, offset, count in fields:
        if not kind:  # a pointer
            continue
        names.append(field)
        offsets.append(offset)
        formats.append(f"S{count}" if kind == "s" else (_KINDS[kind], (count,)) if count > 1 else _KINDS[kind])
    whole = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})
    return cast("np.dtype[Struct]", np.dtype((Struct, whole)))


SEGMENT = _dtype("dpt_segment")
HIT = _dtype("dpt_hit")
CONTACT = _dtype("dpt_contact")
CHANNEL = _dtype("dpt_channel")
REGION = _dtype("dpt_body_region")
SWEEP = _dtype("dpt_sweep")
STEP = _dtype("dpt_step")
FORCE = _dtype("dpt_force_info")
TOOL_LOAD = _dtype("dpt_tool_load")
LOAD = _dtype("dpt_load")
SPRING_REGION = _dtype("dpt_spring_region")
SPRINGS_INFO = _dtype("dpt_springs_info")
MESH_INFO = _dtype("dpt_mesh_info")
WORLD_INFO = _dtype("dpt_world_info")
ARM_INFO = _dtype("dpt_arm_info")
ARM_JOINT = _dtype("dpt_arm_joint")
ARM_LINK = _dtype("dpt_arm_link")
DEVICE_INFO = _dtype("dpt_device_info")
DEVICE_STATE = _dtype("dpt_device_state")
DEVICE_COUNTS = _dtype("dpt_device_counts")
GUARD_INFO = _dtype("dpt_guard_info")
LOOP_STATS = _dtype("dpt_loop_stats")
HOST_INFO = _dtype("dpt_host_info")
RECORD = _dtype("dpt_record")


def room(dtype: np.dtype[Struct]) -> Any:
    """One struct, whose fields are attributes; to be filled by the library."""
    return np.zeros(1, dtype)


class Status(IntEnum):
    """How far a hit can be trusted."""

    STALE = 0
    LOCAL = 1
    BOUNDED = 2
    EXACT = 3


class Contact(IntEnum):
    """Whether the tool's surface touches the mesh."""

    UNKNOWN = 0
    SEPARATED = 1
    TOUCHING = 2
    PENETRATING = 3


class Hit(IntFlag):
    """Bits of a hit's `flags`."""

    GAP = 1
    CROSSING = 2
    BUDGET = 4
    NO_SIDE = 8
    CROSSINGS_FULL = 16


class Force(IntEnum):
    """Why a tool feels a force, or none: `reason`."""

    ACTS = 0
    FREE = 1
    STALE = 2
    UNDECIDED = 3
    OFF = 4
    INSIDE = 5


class ForceFlag(IntFlag):
    """Bits of a force's `flags`."""

    FADING = 1
    PARTIAL = 2
    FOLD = 4
    SQUEEZED = 8
    REPLACED = 16
    SHAPED = 32
    BEHIND = 64
    APART = 128
    CROWDED = 256
    RUPTURE = 512
    INSERTED = 1024
    CHANNELS_FULL = 2048


class DeviceStatus(IntEnum):
    """A device's `status`."""

    LOST = 0
    FAULT = 1
    UNREADY = 2
    READY = 3


class Reason(IntFlag):
    """Why a device is not ready: bits of `reasons`."""

    UNPLUGGED = 1
    SILENT = 2
    WATCHDOG = 4
    OVERHEATED = 8
    OVERLOADED = 16
    UNCALIBRATED = 32
    ESTOP = 64
    LINK = 128
    VERSION = 256
    DEVICE = 512
    DOCKED = 1024


class GuardState(IntEnum):
    """A guard's `state`."""

    OFF = 0
    STARTING = 1
    RUNNING = 2
    STOPPING = 3


# How the library calls the members of each: a test compares them.
PREFIXES = {
    Status: "DPT_STATUS_", Contact: "DPT_CONTACT_", Hit: "DPT_HIT_FLAG_", Force: "DPT_FORCE_",
    ForceFlag: "DPT_FORCE_FLAG_", DeviceStatus: "DPT_DEVICE_STATUS_", Reason: "DPT_REASON_", GuardState: "DPT_GUARD_",
}
