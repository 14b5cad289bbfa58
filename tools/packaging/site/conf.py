# SPDX-License-Identifier: BSD-3-Clause
"""The site of `make docs`, as Sphinx reads it. VERSION, DOXYGEN_XML and TREE come from site.mk."""
import os
import re
from pathlib import Path

from docutils import nodes
from sphinx import addnodes

project = "dynpoint"
author = "the dynpoint authors"
copyright = author
version = release = os.environ["VERSION"]
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
breathe_projects = {"dynpoint": os.environ["DOXYGEN_XML"]}
breathe_default_project = "dynpoint"
breathe_domain_by_extension = {"h": "c"}
myst_heading_anchors = 5
exclude_patterns = ["README.md", "extra", "include", "src", "drivers", "tools", "Makefile", "docs/samples",
                    "tests/[!bf]*", "tests/b[!e]*", "tests/f[!u]*"]
highlight_language = "none"
default_role = "code"
html_theme = "furo"
html_title = f"dynpoint {version}"
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["site.css"]
templates_path = [str(Path(__file__).parent / "templates")]
html_sidebars = {"**": ["sidebar/brand.html", "versions.html", "sidebar/search.html", "sidebar/scroll-start.html",
                        "sidebar/navigation.html", "sidebar/scroll-end.html"]}
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
pygments_style = "default"
pygments_dark_style = "monokai"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
TREE = Path(os.environ["TREE"])


def link(app, target, label, anchor=""):
    refuri = app.builder.get_relative_uri(app.env.docname, target) + anchor
    return nodes.reference("", "", label, internal=True, refuri=refuri)


def sources(app, tree):
    """A link to a header leads to its page, one to README to the first; one to a folder of the tree is its name alone."""
    for node in list(tree.findall(addnodes.download_reference)):
        target = (Path(app.env.doc2path(app.env.docname)).parent / node["reftarget"]).resolve()
        if target.parent == TREE / "include/dynpoint":
            node.replace_self(link(app, f"api/{target.stem}", node[0]))
        elif target == TREE / "include/dynpoint.h":
            node.replace_self(link(app, "api/index", node[0]))
    for node in list(tree.findall(addnodes.pending_xref)):
        if node.get("refdomain") == "doc" and node["reftarget"] == "README":
            anchor = node.get("reftargetid")
            node.replace_self(link(app, "index", node[0], f"#{anchor}" if anchor else ""))
            continue
        if node.get("refdomain") == "doc" and str(TREE) in node["reftarget"]:  # a README beside sources
            node.replace_self(node.children[0])
            continue
        if node.get("refdomain") or node.get("reftype") != "myst":
            continue
        target = (Path(app.env.doc2path(app.env.docname)).parent / node["reftarget"]).resolve()
        if target == TREE / "include/dynpoint":
            node.replace_self(link(app, "api/index", node[0]))
        elif target.is_dir():
            node.replace_self(node.children[0])


def plain(app, what, name, obj, options, lines):
    """A docstring is plain text, with code in single backticks, columns and examples behind >>>."""
    paragraphs = "\n".join(lines).split("\n\n")
    for k, text in enumerate(paragraphs):
        if text.startswith(">>>"):
            continue
        if "\n " in text.strip():
            paragraphs[k] = "::\n\n" + "\n".join(f"    {line}" for line in text.split("\n"))
            continue
        parts = re.split(r"(`[^`]+`)", text)
        parts = [f"`{part}`" if part.startswith("`") else re.sub(r"([*|]|_\b)", r"\\\1", part) for part in parts]
        paragraphs[k] = "".join(parts)
    lines[:] = "\n\n".join(paragraphs).split("\n")


def live(app, name, source):
    """The page with the core in it, where it was built, on the pages about it."""
    if name in ("docs/page", "docs/tutorial") and (Path(app.srcdir) / "extra/dynpoint.html").exists():
        title = "Touch an organ: it is computed here"
        organ = f'<iframe class="organ" src="../dynpoint.html" title="{title}" loading="lazy"></iframe>'
        source[0] = source[0].replace("\n## ", f"\n{organ}\n\n## ", 1)


def named(app, env):
    """Enums without a name have no place in the index: their values have."""
    for entries in env.domaindata["index"]["entries"].values():
        entries[:] = [entry for entry in entries if "[anonymous]" not in entry[1]]


def extra(app, config):
    config.html_extra_path = [str(Path(app.srcdir) / "extra")]


def setup(app):
    for name, language in (("csharp", "C#"), ("java", "Java")):
        app.add_object_type(name, name, indextemplate=f"pair: %s; {language}")
    app.connect("config-inited", extra)
    app.connect("source-read", live)
    app.connect("doctree-read", sources)
    app.connect("env-updated", named)
    app.connect("autodoc-process-docstring", plain)
