# SPDX-License-Identifier: BSD-3-Clause
"""A safe device from Python, by ctypes alone (docs/ffi.md): python3 tests/ffi/host.py BUILD. The program must feel the same."""
import json
import subprocess
import sys
import tempfile
from ctypes import (CDLL, RTLD_GLOBAL, POINTER, Structure, byref, c_char, c_char_p, c_double, c_int32, c_uint32, c_uint64,
                    c_void_p, sizeof)
from os import remove
from os.path import exists

build = sys.argv[1]
for name in ("", "_compile", "_drivers", "_convex"):
    if exists(f"{build}/libdynpoint{name}.so"):
        CDLL(f"{build}/libdynpoint{name}.so", RTLD_GLOBAL)
host = CDLL(f"{build}/libdynpoint_host.so")


def struct(name, *fields):
    return type(name, (Structure,), {"_fields_": [(field, kind) for kind, names in fields for field in names.split()]})


HostDef = struct("dpt_host_def", (c_uint32, "size flags"), (c_char_p, "scene device tool identified"),
                 (c_void_p, "info"), (c_char_p, "record"), (c_void_p, "felt user"), (c_uint32, "law clutch budget cpu"), (c_uint64, "ticks"),
                 (c_double * 3, "origin"), (c_double, "stiffness gain_margin friction damping zoom force_scale length radius"
                                                      " physics rate force_max"))
HostError = struct("dpt_host_error", (c_uint32, "size"), (c_int32, "code"), (c_char * 1000, "text"))
HostInfo = struct("dpt_host_info", (c_uint32, "size limit budget reasons"),
                  (c_double, "stiffness rotational_stiffness stable rate"),
                  (c_uint64, "ticks failed held clutched contacts penetrating unknown put inside limited"),
                  (c_double, "taken account_min depth_max force_max"), (c_char * 640, "trouble"))


EMBED = 32  # DPT_HOST_FLAG_EMBED


def run(scene, device, ticks, record=None, flags=0):
    definition, error, info = HostDef(), HostError(size=sizeof(HostError)), HostInfo(size=sizeof(HostInfo))
    opened = c_void_p()
    host.dpt_host_def_defaults(byref(definition), c_uint64(sizeof(definition)))
    definition.scene, definition.device, definition.ticks = scene.encode(), device.encode(), ticks
    definition.record, definition.flags = record and record.encode(), flags
    if host.dpt_host_open(byref(definition), byref(opened), byref(error)) != 0:
        raise RuntimeError(error.text.decode())
    host.dpt_host_run(opened, None, byref(error))
    host.dpt_host_get_info(opened, byref(info))
    host.dpt_host_close(opened, None)
    return info


def program(*arguments):
    return subprocess.run([f"{build}/dynpoint", *arguments], stdout=subprocess.PIPE, check=True).stdout


def as_the_program(scene, device, ticks):
    with tempfile.TemporaryDirectory() as folder:
        ours, its = f"{folder}/ours.dpr", f"{folder}/its.dpr"
        info = run(scene, device, ticks, ours)
        said = json.loads(program("run", scene, "--device", device, "--ticks", str(ticks), "--record", its, "--json"))
        with open(ours, "rb") as one, open(its, "rb") as other:
            recorded = one.read() == other.read()
        recorded = recorded and b"same" in program("replay", ours)
    same = {"contacts": info.contacts, "penetrating": info.penetrating, "unknown": info.unknown, "clutched": info.clutched,
            "inside": info.inside, "budget": info.budget, "deepest": info.depth_max, "strongest": info.force_max,
            "stiffness": info.stiffness, "rotational_stiffness": info.rotational_stiffness, "stable": info.stable}
    wrong = [name for name, value in same.items() if said[name] != value] + ([] if recorded else ["the recording"])
    wrong += [] if said["fresh"] == info.ticks == ticks and said["passivity"]["acted"] == info.limited else ["ticks"]
    wrong += [] if info.contacts > ticks / 10 and info.force_max > 0.1 else ["no contact"]
    print(f"  {'FAIL' if wrong else 'ok  '} {scene}: {info.contacts} contacts, {info.force_max:.3g} N {wrong or ''}")
    return not wrong


def refused(scene, *texts, record=None, device="sim"):
    try:
        run(scene, device, 1, record)
    except RuntimeError as error:
        right = any(text in str(error) for text in texts)
        print(f"  {'ok  ' if right else 'FAIL'} {error}")
        return right
    return False


def what_the_device_reads_is_kept():
    with tempfile.TemporaryDirectory() as folder:
        trace, rows = f"{folder}/hand.csv", "tick,ax,ay,az,bx,by,bz\n" + "".join(f"{i},0,0.01,0,0,0.01,0.1\n" for i in range(9))
        with open(trace, "w", encoding="ascii") as file:
            file.write(rows)
        is_refused = refused("membrane", "it is read here", record=trace, device=f"replay:{trace}")
        with open(trace, encoding="ascii") as file:
            return is_refused and file.read() == rows


def a_recording_carries_its_mesh():
    with tempfile.TemporaryDirectory() as folder:
        shape, mesh, ours = f"{folder}/ball.stl", f"{folder}/ball.dpa", f"{folder}/ours.dpr"
        program("make", "sphere", "500", "-o", shape)
        program("compile", shape, "-o", mesh)
        run(mesh, "sim:?hand=press", 500, ours, EMBED)
        remove(mesh)
        is_same = b"all the same bits" in program("replay", ours)
        print(f"  {'ok  ' if is_same else 'FAIL'} a recording carries its mesh")
        return is_same


results = [as_the_program(scene, "sim:?hand=press", 3000) for scene in ("liver", "membrane", "laparoscopy")]
results += [refused("nothing.dpa", "nothing.dpa: cannot be opened"), 
            refused("docs/samples/scene.json", "it is read here", "this build reads no scene files", record="docs/samples/scene.json")]
results += [what_the_device_reads_is_kept(), a_recording_carries_its_mesh()]
print(f"{sum(results)} passed, {len(results) - sum(results)} failed, 0 skipped")
sys.exit(not all(results))
