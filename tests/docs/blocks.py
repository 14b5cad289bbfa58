#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""blocks.py BUILD [release]: the blocks of code in README.md and docs/. blocks.txt decides of each whether it is run here, held
by another test, or only shown, and why. Of all of them: commands and options are those that the program has, targets those of
make, names those of the headers, JSON and Python can be read.

What is run is run on the simulated device, as many ticks as it needs to begin: that a command works, not what it answers."""
import ast
import json
import re
import shlex
import subprocess
import sys
import tempfile
from collections import namedtuple
from pathlib import Path

from verdicts import Verdicts

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(sys.argv[1]).resolve()
PROGRAM = BUILD / "dynpoint"
IS_RELEASE = sys.argv[2:] == ["release"]
Block = namedtuple("Block", "page line kind lines")
Rule = namedtuple("Rule", "decision page start reason")
SHELL = re.compile(r"^(?:build/)?dynpoint (?!\w+:)")
PATIENCE = 300  # s


def blocks_of(page, text):
    lines, at = text.split("\n"), 0
    while at < len(lines):
        end = at + 1
        if fence := re.match(r" *```(\w*)", lines[at]):
            while not re.match(r" *```$", lines[end]):
                end += 1
            yield Block(page, at + 1, fence.group(1) or "plain", lines[at + 1:end])
            end += 1
        elif lines[at].startswith("    ") and not (at and lines[at - 1].strip()):
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            yield Block(page, at + 1, "indented", [line[4:] for line in lines[at:end] if line.strip()])
        at = end


def rules():
    for line in (ROOT / "tests/docs/blocks.txt").read_text(encoding="utf-8").split("\n"):
        if line and not line.startswith("#"):
            cells = [cell.strip() for cell in line.split("|", 3)]
            yield Rule(*cells, *[""] * (4 - len(cells)))


def fits(rule, block):
    if not Path(block.page).match(rule.page):
        return False
    return rule.start == "*" or any(line.strip().startswith(rule.start) for line in block.lines[:1])


def commands_of(block):
    """Lines for a shell: continued ones joined, without what explains them."""
    if block.kind not in ("indented", "sh"):
        return []
    joined = []
    for line in "\n".join(block.lines).replace("\\\n", " ").split("\n"):
        if joined and joined[-1].count("'") % 2:
            joined[-1] += "\n" + line
        else:
            joined.append(line if "'" not in line else re.sub(r"\s+#.*$", "", line))
    return [line if "\n" in line else re.sub(r"\s{2,}(?=[^-'\s]).*$|\s+#.*$", "", line.strip()) for line in joined]


class Program:
    """What the program and make say of themselves."""

    def __init__(self):
        self.options = {}
        self.targets = set(re.findall(r"^([a-z][\w-]*):", "\n".join(
            path.read_text(encoding="utf-8") for path in [ROOT / "Makefile", *ROOT.glob("src/**/*.mk"), *ROOT.glob("tools/**/*.mk"),
                                                          ROOT / "tests/tests.mk"]), re.M))
        self.targets |= {"deps"}
        self.groups = {*re.findall(r"^(?:groups=')?(\w+)\|", (ROOT / "tests/deps.sh").read_text(encoding="utf-8"), re.M), "all"}
        headers = "\n".join(path.read_text(encoding="utf-8") for path in ROOT.glob("include/**/*.h"))
        self.names = set(re.findall(r"\b(?:dpt|DPT)_\w+", headers))

    def options_of(self, words):
        key = " ".join(words)
        if key not in self.options:
            said = subprocess.run([PROGRAM, "complete", *words, "-"], capture_output=True, text=True, check=False).stdout
            self.options[key] = set(said.split())
        return self.options[key]

    def wrong_in_command(self, line):
        try:
            words = shlex.split(line, comments=True)[1:]
        except ValueError as error:
            return str(error)
        first = words[:2] if words[:1] in (["device"], ["record"]) or words[:2] == ["make", "trace"] else words[:1]
        known = self.options_of(first + ["--plan", "plan.json"] if first == ["replay"] and "--plan" in words else first)
        if not known:
            return f"there is no command {' '.join(first)}"
        bad = [word for word in words if re.match(r"--?[a-z]", word) and word.split("=")[0] not in known]
        return f"{' '.join(first)} has no {' '.join(bad)}" if bad else ""

    def wrong_in_make(self, line):
        words = [word for word in shlex.split(line, comments=True)[1:] if not re.search(r"[=/]|^-", word)]
        if words[:1] == ["deps"]:
            words = [word for word in words[1:] if word not in self.groups]
        else:
            words = [word for word in words if word not in self.targets]
        return f"make has no {' '.join(words)}" if words else ""


def wrong_in(block, program):
    for line in commands_of(block):
        for part in re.split(r"&& | ; ", line):
            part = part.strip()
            if SHELL.match(part) and "..." not in part:
                if wrong := program.wrong_in_command(part):
                    return wrong
            elif re.match(r"make( |$)", part):
                if wrong := program.wrong_in_make(part):
                    return wrong
    text = "\n".join(block.lines)
    strange = sorted({name for name in re.findall(r"\b(?:dpt|DPT)_\w+", text) if name not in program.names
                      and not name.endswith("_")})
    if strange:
        return f"no header has {' '.join(strange)}"
    try:
        if block.kind == "python":
            indent = re.match(r" *", text).group()
            ast.parse("\n".join(line.removeprefix(indent) for line in block.lines))
        elif block.kind == "json":
            json.loads(text if text.lstrip().startswith("{") else "{" + text + "}")
    except (SyntaxError, ValueError) as error:
        return str(error)
    return ""


def simulated(line):
    """A command as it can be run anywhere: on the simulated device, without a page, for some ticks. None: not at all."""
    line = re.sub(r"^(?:build/)?dynpoint", str(PROGRAM), line.replace("docs/samples/", f"{ROOT}/docs/samples/"))
    if not line.startswith(str(PROGRAM)):
        return line if re.match(r"(awk|echo) ", line) else None
    line = re.sub(r"--device '?(?:openhaptics|NAME|can:)[^ ]*", "--device 'sim:?hand=press'", line)
    line = re.sub(r"&live=1|live=1&?| --(?:view|open|control)\b", "", line)
    command = line.split()[1]
    if command == "run":
        line = re.sub(r" --(?:for|ticks) \S+", "", line) + " --ticks 300"
    if command == "view":
        line = line + " --ticks 100" if " -o " in line and ".dpr" not in line else line if " -o " in line else None
    return line


def run(page, blocks, room):
    """The commands of a page's blocks, one after the other in one folder. What fails: a text."""
    ran = 0
    for block in blocks:
        for line in commands_of(block):
            for part in line.split("&& "):
                if not (command := simulated(part.strip())):
                    continue
                done = subprocess.run(["sh", "-c", command], cwd=room, capture_output=True, text=True, timeout=PATIENCE, check=False)
                ran += 1
                if done.returncode:
                    return ran, f"{page}:{block.line}: {part}: status {done.returncode}, {done.stderr.strip()[-200:]}"
    return ran, ""


def main():
    verdict = Verdicts()
    pages = ["README.md", *sorted(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/**/*.md"))]
    blocks = [block for page in pages for block in blocks_of(page, (ROOT / page).read_text(encoding="utf-8"))]
    table, program, used, to_run, counts = list(rules()), Program(), set(), {}, {}
    undecided = []
    for block in blocks:
        rule = next((rule for rule in table if fits(rule, block)), None)
        if not rule:
            undecided.append(f"{block.page}:{block.line} {block.lines[0].strip()[:60]}")
            continue
        used.add(rule)
        counts[rule.decision.split("/")[0]] = counts.get(rule.decision.split("/")[0], 0) + 1
        if rule.decision in ("run", "long"):
            if rule.decision == "run" or IS_RELEASE:
                to_run.setdefault(block.page, []).append(block)
        elif rule.decision == "shown":
            if not rule.reason:
                undecided.append(f"{block.page}:{block.line}: shown without a reason")
        elif not (ROOT / rule.decision).exists():
            undecided.append(f"{block.page}:{block.line}: there is no {rule.decision}")
    verdict(not undecided, f"{len(blocks)} blocks, each decided: {counts} {'; '.join(undecided)}")
    idle = [f"{rule.page} {rule.start}" for rule in table if rule not in used]
    verdict(not idle, f"each line of blocks.txt fits a block {'; '.join(idle)}")
    wrong = [f"{block.page}:{block.line}: {text}" for block in blocks
             if block.page != "docs/changelog.md" and (text := wrong_in(block, program))]
    verdict(not wrong, f"commands, options, targets, names, JSON and Python of all {'; '.join(wrong)}")
    for page, chosen in to_run.items():
        with tempfile.TemporaryDirectory() as room:
            ran, fault = run(page, chosen, room)
            verdict(ran > 0 and not fault, f"{page}: {ran} commands run {fault}")
    return verdict.finish()


sys.exit(main())
