#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Where the instructions of a proxy's tick go: a table in Markdown, thousand instructions a tick, by callgrind.

proxy_stages.py PROGRAM [MESH [TICKS]]   PROGRAM is build/tests/bench/proxy_ticks of a build; MESH as it has them (liver);
                                         TICKS (2000). valgrind is needed; standard library only

A function counts for the stage that it works for: what is called by several stages is shared out as callgrind counted
their calls. So the rows add up to the first.
"""
import collections
import os
import re
import subprocess
import sys
import tempfile

SETTLED = 100  # ticks before those that are told; callgrind counts them too
MOTIONS = ("open", "rest", "wipe", "fast")
CASES = [(tool, motion, 0) for tool in ("ball", "line") for motion in MOTIONS] + [("line", "fast", 0.3)]

# A stage, and the functions that begin it. What begins within another stage leaves it.
STAGES = (
    ("what is near, in the patch", ("dpti_patch_look",)),
    ("constraints of what is near", ("dpti_patch_hold", "dpti_proxy_gather", "dpti_proxy_gather_triangle")),
    ("solve, friction", ("dpti_proxy_solve_rubbing",)),
    ("turns: corrections, how far", ("dpti_solved_correct", "dpti_solved_best_share")),
    ("proof in the patch", ("dpti_patch_prove",)),
    ("sweeps past the tree", ("dpti_proxy_move",)),
    ("nearest pairs by the tree", ("dpti_proxy_find_nearest", "dpti_track_segment", "dpti_tips_track")),
    ("hits at the device's pose", ("dpti_proxy_write_hits", "dpti_tool_find_hits")),
    ("contacts", ("contact_at_proxy", "dpti_contacts_find")),
    ("force, loads", ("dpti_proxy_respond", "dpti_loads_note_proxy", "dpti_loads_settle")),
)
STAGE_OF = {function: name for name, functions in STAGES for function in functions}
OTHER = "the rest of the tick"


def read_callgrind(path):
    """Instructions of each function by itself, and of its calls: {function: n}, {(caller, callee): n}."""
    own, calls, names = collections.Counter(), collections.Counter(), {}

    def name_of(text):
        found = re.match(r"\((\d+)\)(?: (.*))?", text)
        if found.group(2):
            names[found.group(1)] = re.sub(r"(\.(isra|constprop|part|cold)\.?\d*)+$|'\d+$", "", found.group(2))
        return names[found.group(1)]

    function = callee = None
    is_call = False
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("fn="):
                function = name_of(line[3:].rstrip())
            elif line.startswith("cfn="):
                callee = name_of(line[4:].rstrip())
            elif line.startswith("calls="):
                is_call = True
            elif function and re.match(r"[0-9+*-]", line):
                cost = int(line.split()[-1]) if len(line.split()) > 1 else 0
                if is_call:
                    calls[function, callee] += cost
                else:
                    own[function] += cost
                is_call = False
    return own, calls


def shares_of_stages(calls, functions):
    """For each function, which part of its instructions is which stage's."""
    callers = collections.defaultdict(list)
    for (caller, callee), cost in calls.items():
        if caller != callee and cost:
            callers[callee].append((caller, cost))
    shares, open_now = {}, set()

    def share(function):
        if function in STAGE_OF:
            return {STAGE_OF[function]: 1.0}
        if function in shares:
            return shares[function]
        if function in open_now:
            return {}
        open_now.add(function)
        sums = collections.Counter()
        for caller, cost in callers[function]:
            for stage, part in share(caller).items():
                sums[stage] += part * cost
        open_now.discard(function)
        whole = sum(sums.values())
        shares[function] = {stage: part / whole for stage, part in sums.items()} if whole else {OTHER: 1.0}
        return shares[function]

    return {function: share(function) for function in functions}


def measure(program, mesh, ticks, tool, motion, friction):
    """Thousand instructions a tick, by stage."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind")
        subprocess.run(["valgrind", "--tool=callgrind", "--toggle-collect=dpt_world_step", "--callgrind-out-file=" + out,
                        program, mesh, tool, motion, str(ticks), str(friction), "1"], check=True, capture_output=True)
        own, calls = read_callgrind(out)
    shares, stages = shares_of_stages(calls, own), collections.Counter()
    for function, cost in own.items():
        for stage, part in shares[function].items():
            stages[stage] += part * cost / (ticks + SETTLED) / 1000
    return stages


def main(program, mesh="liver", ticks="2000"):
    told = [measure(program, mesh, int(ticks), *case) for case in CASES]
    titles = [f"{tool} {motion}" + (f", friction {friction}" if friction else "") for tool, motion, friction in CASES]
    print("| k instructions a tick, " + mesh + " | " + " | ".join(titles) + " |")
    print("|---|" + "---|" * len(CASES))
    print("| all | " + " | ".join(f"{sum(stages.values()):.1f}" for stages in told) + " |")
    for name in [name for name, _ in STAGES] + [OTHER]:
        if any(stages[name] >= 0.05 for stages in told):
            print(f"| {name} | " + " | ".join(f"{stages[name]:.1f}" for stages in told) + " |")


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
