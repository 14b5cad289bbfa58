# SPDX-License-Identifier: BSD-3-Clause
"""What a line-shaped tool touches and feels of triangle meshes, rigid and deformable. SI units: m, N, s, rad; poses are
position and quaternion (w, x, y, z)."""
from ._arm import Arm
from ._device import Device, Guard, Loop, Scene
from ._dynpoint import Error, constants, scene_names, version
from ._mesh import UNITS, Mesh
from ._recording import Recording
from ._structs import (ARM_INFO, ARM_JOINT, ARM_LINK, CHANNEL, CONTACT, DEVICE_COUNTS, DEVICE_INFO, DEVICE_STATE, FORCE,
                       GUARD_INFO, HIT, HOST_INFO, LOAD, LOOP_STATS, MESH_INFO, RECORD, SEGMENT, SPRING_REGION,
                       SPRINGS_INFO, STEP, SWEEP, TOOL_LOAD, WORLD_INFO, Contact, DeviceStatus, Force, ForceFlag,
                       GuardState, Hit, Reason, Status)
from ._view import View
from ._world import Body, DeformableBody, Springs, Tool, World, make_segments

__version__ = version
__all__ = [
    "ARM_INFO", "ARM_JOINT", "ARM_LINK", "Arm", "Body", "CHANNEL", "CONTACT", "Contact", "DEVICE_COUNTS", "DEVICE_INFO",
    "DEVICE_STATE",
    "DeformableBody", "Device", "DeviceStatus", "Error", "FORCE", "Force", "ForceFlag", "GUARD_INFO", "Guard", "GuardState",
    "HIT", "HOST_INFO", "Hit", "LOAD", "LOOP_STATS", "Loop", "MESH_INFO", "Mesh", "RECORD", "Reason", "Recording", "SEGMENT",
    "SPRINGS_INFO", "SPRING_REGION", "STEP", "SWEEP", "Scene", "Springs", "Status", "TOOL_LOAD", "Tool", "UNITS",
    "View", "WORLD_INFO", "World", "constants", "make_segments", "scene_names",
]
