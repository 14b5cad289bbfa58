#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""versions.py SITE: what stands beside the folders of versions in SITE: versions.html, a list of them; index.html, which leads
to the newest; and latest/, with a page for each of its pages that leads there, so that a link to latest/ stays good."""
import os
import re
import shutil
import sys
from pathlib import Path

HEAD = """<!doctype html>
<!-- SPDX-License-Identifier: BSD-3-Clause -->
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
"""
STYLE = """<style>
:root { color-scheme: light dark; }
body { background: #fff; color: #111; font: 1.1rem/1.6 system-ui, sans-serif; max-width: 40rem; margin: 3rem auto; padding: 0 1rem; }
a { color: #0a4bff; }
@media (prefers-color-scheme: dark) { body { background: #131416; color: #cfd0d0; } a { color: #3d94ff; } }
</style>
"""


def leads_to(target):
    """A page that leads elsewhere, and takes the anchor along."""
    return (f'{HEAD}<meta http-equiv="refresh" content="1; url={target}">\n<link rel="canonical" href="{target}">\n<title>dynpoint</title>\n'
            f'<script>location.replace("{target}" + location.search + location.hash);</script>\n<a href="{target}">{target}</a>\n')


def main():
    site = Path(sys.argv[1])
    versions = sorted((path.name for path in site.iterdir() if re.fullmatch(r"\d+(\.\d+)+", path.name)),
                      key=lambda name: [int(part) for part in name.split(".")], reverse=True)
    newest = versions[0]
    shutil.rmtree(site / "latest", ignore_errors=True)
    for page in sorted((site / newest).rglob("*.html")):
        path = page.relative_to(site / newest)
        if path.parts[0] not in ("rust", "javascript", "_static"):
            place = site / "latest" / path
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(leads_to(os.path.relpath(page, place.parent)), encoding="utf-8")
    (site / "index.html").write_text(leads_to(f"{newest}/index.html"), encoding="utf-8")
    rows = "".join(f'<li><a href="{name}/index.html">{name}</a>{" (newest)" if name == newest else ""}</li>\n' for name in versions)
    (site / "versions.html").write_text(
        f'{HEAD}<title>dynpoint: versions</title>\n{STYLE}<h1>dynpoint: versions</h1>\n<ul>\n{rows}</ul>\n'
        '<p><a href="latest/index.html">latest/</a> always leads to the newest, page by page.</p>\n', encoding="utf-8")


main()
