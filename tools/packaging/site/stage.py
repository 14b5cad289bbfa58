#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""stage.py ABI.json MADE OUT [PAGE.html]: the tree as Sphinx reads it, in OUT: README and docs/ as they are, what they link
to, and a page for each public header, for each module of the package of Python, and for each other language that
languages.sh has put into MADE. PAGE.html: the page with the core.
"""
import json
import shutil
import sys
from pathlib import Path

import languages

ROOT = Path(__file__).resolve().parents[3]
PYTHON = {
    "dynpoint": "The package: meshes, worlds, devices, scenes.",
    "dynpoint.batch": "Many worlds in one call.",
    "dynpoint.bulk": "Lists of meshes and segments.",
    "dynpoint.exports": "Recordings for other tools.",
}
# In the order of docs/index.md.
PAGES = {
    "Begin": "install tutorial commands concepts output faq comparison abi",
    "Use": "host drivers back_ends faults writing_drivers safety motors scene view plan plot chart recipes urdf",
    "From languages": "ffi python batch physics exports bulk csharp go java javascript page rust",
    "Background": "design glossary format wire platforms stability performance measurements contributing changelog",
}


def title(text, sign="="):
    return f"{text}\n{sign * len(text)}\n"


def toctree(caption, names, depth=1):
    entries = "".join(f"   {name}\n" for name in names)
    return f".. toctree::\n   :maxdepth: {depth}\n   :caption: {caption}\n   :hidden:\n\n{entries}\n"


def write(path, text):
    """Only what has changed: Sphinx reads again what is newer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def link_all(source, out, names):
    out.mkdir(parents=True, exist_ok=True)
    for name in names:
        if not (out / name).is_symlink():
            (out / name).symlink_to(source / name)


def headers(abi, out):
    """A page for each header, by library; their names."""
    listed = []
    for library in abi["libraries"]:
        names = [header["name"] for header in library["headers"]]
        for name in names:
            text = f"``#include <dynpoint/{name}>``, of {library['name']}.\n\n.. doxygenfile:: {name}\n"
            write(out / f"api/{name.removesuffix('.h')}.rst", f"{title('dynpoint/' + name)}\n{text}")
        entries = "".join(f"   {name.removesuffix('.h')}\n" for name in names)
        listed.append(f"{title(library['name'], '-')}\n.. toctree::\n   :maxdepth: 1\n\n{entries}\n")
    what = "Of each library the headers, as they are. ``dynpoint.h`` has those of the core together."
    write(out / "api/index.rst", f"{title('The C API')}\n{what}\n\n" + "".join(listed))


def python(out):
    for module, what in PYTHON.items():
        members = "   :members:\n   :undoc-members:\n   :inherited-members: BaseException, int, tuple, Sequence\n"
        members += "   :show-inheritance:\n"
        if module == "dynpoint":
            members += "   :imported-members:\n"
        write(out / f"python/{module}.rst", f"{title(module)}\n{what}\n\n.. automodule:: {module}\n{members}")
    entries = "".join(f"   {module}\n" for module in PYTHON)
    write(out / "python/index.rst", f"{title('The Python API')}\nWhat it is for stands in :doc:`/docs/python`.\n\n"
          f".. toctree::\n   :maxdepth: 1\n\n{entries}")


def others(made, out):
    """A page for each language that is in `made`, and what its own tool has made of it beside the pages."""
    (out / "languages").mkdir(exist_ok=True)
    names = []
    for name, heading, what, text in languages.pages(made):
        write(out / f"languages/{name}.rst", f"{title(heading)}\n{what}\n\n{text}")
        names.append(name)
    for path in (out / "languages").glob("*.rst"):
        if path.stem not in names:
            path.unlink()
    for name in ("rust", "javascript"):
        shutil.rmtree(out / "extra" / name, ignore_errors=True)
        if name in names:
            shutil.copytree(made / name, out / "extra" / name)
    return names


def main():
    abi_file, made, out = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    with open(abi_file, encoding="utf-8") as file:
        abi = json.load(file)
    shutil.rmtree(out / "docs", ignore_errors=True)
    shutil.copytree(ROOT / "docs", out / "docs")
    for name in ("README.md", "LICENSE", "Makefile"):
        shutil.copy2(ROOT / name, out)
    link_all(ROOT, out, ["include", "src", "drivers", "tools"])  # what pages link to
    tests = {path.name for path in (ROOT / "tests").iterdir()}
    link_all(ROOT / "tests", out / "tests", sorted(tests - {"bench", "fuzz"}))
    for name in ("bench", "fuzz"):  # pages too: a link to one would lead out of here
        link_all(ROOT / "tests" / name, out / "tests" / name,
                 [path.name for path in (ROOT / "tests" / name).iterdir() if path.name != "README.md"])
        shutil.copy2(ROOT / "tests" / name / "README.md", out / "tests" / name)
    (out / "extra").mkdir(exist_ok=True)
    for page in sys.argv[4:]:
        shutil.copy2(page, out / "extra")
    headers(abi, out)
    python(out)
    more = others(made, out)
    algorithms = sorted(path.stem for path in (ROOT / "docs/algorithms").glob("*.md"))
    listed = [name for names in PAGES.values() for name in names.split()]
    left_out = {path.stem for path in (ROOT / "docs").glob("*.md")} - set(listed) - {"index"}
    if left_out:
        sys.exit(f"stage.py: PAGES does not have {' '.join(sorted(left_out))}")
    write(out / "index.rst", ".. include:: README.md\n   :parser: myst_parser.sphinx_\n\n"
          + toctree("Contents", ["docs/index"])
          + "".join(toctree(caption, [f"docs/{name}" for name in names.split()]) for caption, names in PAGES.items())
          + toctree("API", ["api/index", "python/index", *(f"languages/{name}" for name in more)])
          + toctree("Algorithms", [f"docs/algorithms/{name}" for name in algorithms])
          + toctree("Tests", ["tests/bench/README", "tests/fuzz/README"]))


main()
