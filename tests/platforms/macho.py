# SPDX-License-Identifier: BSD-3-Clause
"""Reads a library of macOS: macho.py LIBRARY SYMBOLS. Status 1, and a line for each finding, unless its name and those of
the libraries of ours that it needs begin with @rpath/, @loader_path is a run path, all others are the system's, and it
exports the symbols that the file lists and no others."""
import os
import struct
import sys

LOAD, ID, RPATH, SYMTAB, BUILD_VERSION = 0xC, 0xD, 0x8000001C, 0x2, 0x32
# What zig's linker puts into each library.
OF_LINKER = {"__dso_handle", "_mh_dylib_header"}
EXTERNAL, KIND, UNDEFINED, PRIVATE = 0x01, 0x0E, 0x00, 0x10


def read(data):
    """The names in its load commands, by their kind, and the symbols that it exports."""
    magic, _, _, _, count = struct.unpack_from("<5I", data)
    assert magic == 0xFEEDFACF, "not a Mach-O file of 64 bits"
    at, names, exported = 32, {LOAD: [], ID: [], RPATH: []}, set()
    for _ in range(count):
        command, size = struct.unpack_from("<2I", data, at)
        if command in names:
            begin = at + struct.unpack_from("<I", data, at + 8)[0]
            names[command].append(data[begin:at + size].split(b"\0")[0].decode())
        if command == SYMTAB:
            table, entries, strings, _ = struct.unpack_from("<4I", data, at + 8)
            for i in range(entries):
                name, kind = struct.unpack_from("<IB", data, table + 16 * i)
                if kind & EXTERNAL and not kind & PRIVATE and kind & KIND != UNDEFINED:
                    begin = strings + name
                    exported.add(data[begin:data.index(b"\0", begin)].decode()[1:])
        at += size
    return names, exported - OF_LINKER


def machine(data):
    """The processor, and the oldest macOS that it runs on: (11, 0)."""
    _, processor, _, _, count = struct.unpack_from("<5I", data)
    at, oldest = 32, None
    for _ in range(count):
        command, size = struct.unpack_from("<2I", data, at)
        if command == BUILD_VERSION:
            version = struct.unpack_from("<2I", data, at + 8)[1]
            oldest = (version >> 16, version >> 8 & 255)
        at += size
    return {0x0100000C: "aarch64", 0x01000007: "x86_64"}[processor], oldest


def main(path, list_path):
    with open(path, "rb") as file:
        names, exported = read(file.read())
    findings = []
    if names[ID] != ["@rpath/" + os.path.basename(path)]:
        findings.append("its name is %s" % names[ID])
    if "@loader_path" not in names[RPATH]:
        findings.append("its run paths are %s" % names[RPATH])
    for needed in names[LOAD]:
        if "dynpoint" in needed and not needed.startswith("@rpath/libdynpoint"):
            findings.append("it needs %s" % needed)
        if "dynpoint" not in needed and not needed.startswith(("/usr/lib/", "/System/")):
            findings.append("it needs %s" % needed)
    wanted = set(open(list_path).read().split())
    findings += ["it lacks %s" % name for name in sorted(wanted - exported)]
    findings += ["it shows %s" % name for name in sorted(exported - wanted)]
    for finding in findings:
        print("  %s: %s" % (os.path.basename(path), finding))
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
