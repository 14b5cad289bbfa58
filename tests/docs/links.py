#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""links.py [ROOT]: in README.md, docs/ and other pages each link of the tree leads to a file that is there, each anchor to a
heading of its page, and each picture to a file. It does not ask the network."""
import re
import sys
from pathlib import Path

from verdicts import Verdicts

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2]).resolve()
PAGES = ["README.md", "docs/**/*.md", "tests/**/README.md", "src/**/README.md"]
FENCED = re.compile(r"^(`{3,}).*?^\1", re.S | re.M)
LINK = re.compile(r"\[(?:[^\]\[]|\[[^\]]*\])*\]\(([^()\s]+(?:\([^()]*\))?)\)")


def anchors_of(text):
    """As the web shows them: lower case, no punctuation, blanks as hyphens, a number where a heading comes again."""
    seen, found = {}, set()
    for heading in re.findall(r"^#{1,6} +(.+?) *#*$", FENCED.sub("", text), re.M):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        slug = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        found.add(f"{slug}-{seen[slug]}" if slug in seen else slug)
        seen[slug] = seen.get(slug, 0) + 1
    return found | set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))


def main():
    texts = {path: path.read_text(encoding="utf-8") for pattern in PAGES for path in sorted(ROOT.glob(pattern))}
    anchors = {path: anchors_of(text) for path, text in texts.items()}
    wrong, count = [], 0
    for page, text in texts.items():
        plain = FENCED.sub(lambda block: re.sub(r"[^\n]", "", block.group()), text)
        plain = re.sub(r"`[^`\n]*`", "", plain)
        for found in LINK.finditer(plain):
            target = found.group(1)
            if re.match(r"[a-z]+:", target):
                continue
            count += 1
            name, _, anchor = target.partition("#")
            place = (page.parent / name).resolve() if name else page
            where = f"{page.relative_to(ROOT)}:{plain.count(chr(10), 0, found.start()) + 1}: {target}"
            if not place.exists():
                wrong.append(f"{where}: it is not there")
            elif anchor and place.suffix == ".md" and anchor not in anchors.get(place, ()):
                wrong.append(f"{where}: no such heading")
    verdict = Verdicts()
    for line in wrong:
        verdict(False, line)
    verdict(not wrong and count > 700, f"{len(texts)} pages, {count} links: each leads to a file and a heading that are there")
    return verdict.finish()


sys.exit(main())
