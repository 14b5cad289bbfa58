#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""site.py BUILD: looks at the site of `make docs`, for site.sh. How it looks it cannot say."""
import ast
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

from verdicts import Verdicts

ROOT = Path(__file__).resolve().parents[2]
SITE = Path(sys.argv[1]) / "docs/site"
VERSION = re.search(r'DPT_VERSION_STRING "(.*)"', (ROOT / "include/dynpoint/base.h").read_text(encoding="utf-8")).group(1)


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.ids.add(found.get("id"))
        self.links += [found[name] for name in ("href", "src") if found.get(name)]


def names_of(pattern, sources):
    return {name for path in sorted(ROOT.glob(sources)) for name in re.findall(pattern, path.read_text(encoding="utf-8"), re.M)}


def languages(verdict, top):
    """Public classes of C# and Java, types of the crate and of the package of npm, functions of Go: each is named on its page."""
    rust = (ROOT / "src/bindings/rust/dynpoint/src/lib.rs").read_text(encoding="utf-8")
    wanted = {
        "csharp": names_of(r"^    public (?:(?:sealed|static|unsafe|abstract) )*(?:class|struct) (\w+)", "src/bindings/csharp/Runtime/*.cs"),
        "java": names_of(r"^ {0,4}public (?:(?:final|static) )*class (\w+)", "src/bindings/java/dynpoint/*.java"),
        "rust": set(re.findall(r"\b[A-Z]\w+", " ".join(re.findall(r"^pub use [a-z_]+::(.*?);", rust, re.M | re.S)))),
        "javascript": names_of(r"^export declare (?:class|function) (\w+)", "src/bindings/js/index.d.ts"),
        "go": names_of(r"^func (?:\([^)]*\) )?([A-Z]\w*)", "src/bindings/go/*.go"),
    }
    for name, found in wanted.items():
        page = top / f"languages/{name}.html"
        if not page.exists():
            verdict.skip(f"{name}: its tool is not here")
            continue
        text = re.sub(r"<[^>]*>", "", page.read_text(encoding="utf-8"))
        lost = sorted(one for one in found if not re.search(rf"\b{one}\b", text))
        verdict(len(found) > 4 and not lost, f"{len(found)} names of {name} {lost}")


def versions(verdict):
    """What stands beside the folders of versions."""
    found = sorted(path.name for path in SITE.iterdir() if re.fullmatch(r"[\d.]+", path.name))
    told = re.findall(r'href="([\d.]+)/index.html"', (SITE / "versions.html").read_text(encoding="utf-8"))
    verdict(VERSION in found and sorted(told) == found, f"the list of versions has {told}")
    newest = told[0]
    pages = [path.relative_to(SITE / newest) for path in (SITE / newest).rglob("*.html") if path.parent.name in ("docs", "api", "python")]
    lost = [str(path) for path in pages if not (SITE / "latest" / path).exists()
            or f"../{newest}/{path}" not in (SITE / "latest" / path).read_text(encoding="utf-8")]
    verdict(len(pages) > 80 and not lost, f"{len(pages)} pages of latest/ lead to {newest} {lost[:3]}")


def main():
    verdict = Verdicts()
    top = SITE / VERSION
    pages = {path: Page(path) for path in sorted(top.rglob("*.html")) if path.relative_to(top).parts[0] not in ("rust", "javascript")}
    wanted = {top / path.relative_to(ROOT).with_suffix(".html") for path in ROOT.glob("docs/**/*.md")}
    verdict(wanted <= set(pages) and len(pages) > 100, f"{len(pages)} pages, {len(wanted)} of docs/")
    verdict(f'url={VERSION}/index.html"' in (SITE / "index.html").read_text(encoding="utf-8"), "its first page leads to the version")
    versions(verdict)
    languages(verdict, top)
    symbols = {name for path in ROOT.glob("tests/abi/libdynpoint*.symbols") for name in path.read_text("utf-8").split()}
    shown = {name.removeprefix("c.") for page in pages.values() for name in page.ids if name and name.startswith("c.")}
    verdict(len(symbols) > 200 and symbols <= shown, f"{len(symbols)} functions of C {sorted(symbols - shown)}")
    tree = ast.parse((ROOT / "src/bindings/python/dynpoint/__init__.py").read_text(encoding="utf-8"))
    names = {alias.name for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names if alias.name[0].isupper()}
    classes = {name for name in names if not name.isupper()}
    shown = pages[top / "python/dynpoint.html"].ids
    lost = sorted(name for name in classes if f"dynpoint.{name}" not in shown)
    verdict(len(classes) > 20 and not lost, f"{len(classes)} classes of Python {lost}")
    words = (top / "searchindex.js").read_text(encoding="utf-8")
    verdict("dpt_tool_set_pose" in words and "viscos" in words, "the search knows names and words")
    broken, count = [], 0
    for path, page in pages.items():
        for link in page.links:
            target, _, anchor = link.partition("#")
            if re.match(r"[a-z]+:", link) or link.startswith("data:"):
                continue
            count += 1
            place = (path.parent / unquote(target.split("?")[0])).resolve() if target else path.resolve()
            other = pages.get(top / place.relative_to(top.resolve())) if place.is_relative_to(top.resolve()) else None
            if not place.exists() or (anchor and other and unquote(anchor) not in other.ids):
                broken.append(f"{path.relative_to(top)}: {link}")
    verdict(count > 5000 and not broken, f"{count} links {len(broken)} {broken[:5]}")
    return verdict.finish()


sys.exit(main())
