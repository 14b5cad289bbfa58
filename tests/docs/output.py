#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""output.py BUILD: docs/output.md has a row for each reason, flag, status and error of the headers, with its number, and
names each column that the program writes; docs/abi.md has each format's version. Whether the rows tell the truth it cannot
say."""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from verdicts import Verdicts

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/output.md").read_text(encoding="utf-8")
ABI_PAGE = (ROOT / "docs/abi.md").read_text(encoding="utf-8")
# Of each format on that page the source with its version.
VERSIONS = {
    "compiled mesh, `.dpa`": ("src/mesh/mesh_format.h", r"MESH_VERSION +(\d+)u"),
    "compiled arm, `.dpa`": ("src/arm/arm_format.h", r"ARM_VERSION (\d+)u"),
    "recording, `.dpr`": ("src/exchange/record.c", r"\bVERSION = (\d+)"),
    "snapshot": ("src/exchange/snapshot_format.h", r"SNAPSHOT_VERSION = (\d+)"),
    "serial protocol": ("drivers/serial/wire.h", r"WIRE_VERSION +(\d+)"),
    "driver (`DPT_DRIVER_VERSION`)": ("include/dynpoint/driver.h", r"DPT_DRIVER_VERSION (\d+)"),
}
WANTED = r"(DPT_(?:FORCE|STATUS|HIT_FLAG|STEP_FLAG|E)_[A-Z_]+|DPT_OK)"


def names():
    """Of each name in the headers that a user meets: its number."""
    found = {}
    for header in sorted((ROOT / "include/dynpoint").glob("*.h")):
        text = header.read_text(encoding="utf-8")
        found.update(re.findall(rf"^ *{WANTED} = (\d+)", text, re.M))
        found.update(re.findall(rf"^enum {{ {WANTED} = (\d+)", text, re.M))
        found.update(re.findall(rf"X\({WANTED}, +(-?\d+),", text))
    return found


def kept_versions():
    return {row: int(re.search(pattern, (ROOT / source).read_text(encoding="utf-8")).group(1))
            for row, (source, pattern) in VERSIONS.items()}


def columns(program, room):
    """What `replay -o` and `record csv` write in their first lines."""
    def run(*words):
        subprocess.run([program, *words], cwd=room, check=True, stdout=subprocess.DEVNULL)
    run("make", "membrane", "-o", "m.stl")
    run("compile", "m.stl", "-o", "m.dpa")
    run("make", "trace", "--mesh", "m.dpa", "--ticks", "20", "-o", "t.csv")
    run("replay", "m.dpa", "t.csv", "-o", "answers.csv")
    run("run", "m.dpa", "--device", "sim:?hand=hold", "--ticks", "10", "--record", "r.dpr")
    run("record", "csv", "r.dpr", "-o", "r.csv")
    for file, section in (("answers.csv", "replay -o answers.csv"), ("r.csv", "record csv")):
        with open(Path(room) / file, encoding="utf-8") as lines:
            yield section, lines.readline().strip().split(",")


def named(section):
    """The columns in the table of a section; `joint0` to `joint7` are all between them."""
    text = PAGE.split(f"## `{section}`", 1)[1].split("\n## ")[0]
    cells = [line.split("|")[1] for line in text.split("\n") if line.startswith("| `")]
    found = set(re.findall(r"`(\w+)`", "".join(cells)))
    for first, last in re.findall(r"`(\w+)` to `(\w+)`", "".join(cells)):
        if first[:-1] == last[:-1]:
            found.update(first[:-1] + str(n) for n in range(int(first[-1]), int(last[-1]) + 1))
        else:
            found.update(f"{first[:-2]}{kind}{axis}" for kind in "ft" for axis in "xyz")
    return found


def main():
    verdict = Verdicts()
    numbers = names()
    verdict(len(numbers) > 60, f"{len(numbers)} names in the headers")
    missing = [name for name, value in numbers.items()
               if not re.search(rf"(^\| |, | is ){value} +`{name}`|^\| {value} `{name}`", PAGE, re.M)]
    verdict(not missing, f"each has its row and number {' '.join(missing)}")
    strange = set(re.findall(WANTED, PAGE)) - set(numbers)
    verdict(not strange, f"and the page names no other {' '.join(sorted(strange))}")
    told, kept = {row: int(version) for row, version in re.findall(r"^\| ([^|]+?) \| (\d+) \|", ABI_PAGE, re.M)}, kept_versions()
    verdict(len(kept) == 6 and told == kept, f"docs/abi.md has the versions of the sources {told} {kept}")
    with tempfile.TemporaryDirectory() as room:
        for section, written in columns(Path(sys.argv[1]).resolve() / "dynpoint", room):
            lost, extra = set(written) - named(section), named(section) - set(written)
            verdict(len(written) > 25 and not lost and not extra,
                    f"{section}: {len(written)} columns; not named {sorted(lost)}, not written {sorted(extra)}")
    return verdict.finish()


sys.exit(main())
