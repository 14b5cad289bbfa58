#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The APIs of other languages as pages for Sphinx: C# and Java as Doxygen reads their sources, Go as `go doc` prints it,
Rust and JavaScript as lists of names that lead to what rustdoc and TypeDoc made."""
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

SHOWN = {"class": "class", "struct": "struct", "interface": "interface", "enum": "enum"}


def text_of(node):
    """Words of a description; what is code in it stays code, and nothing else is markup."""
    if node is None:
        return ""
    words = "".join(node.itertext())
    return re.sub(r"([*|`\\]|_\b)", r"\\\1", " ".join(words.split()))


def described(node):
    return " ".join(filter(None, (text_of(node.find("briefdescription")), text_of(node.find("detaileddescription")))))


def directive(language, signature, text, indent=""):
    lines = [f"{indent}.. {language}:: {signature}", ""]
    if text:
        lines += [f"{indent}   {text}", ""]
    return "\n".join(lines) + "\n"


def member(language, owner, node):
    """A method, a property or a field: its type, then its name within its class."""
    kind = " ".join("".join(node.find("type").itertext()).split())
    kind = re.sub(r"^(?:(?:readonly|override|unsafe|final|volatile) )+", "", kind)
    name = f"{owner}.{node.findtext('name')}"
    arguments = " ".join((node.findtext("argsstring") or "").split())
    static = "static " if node.get("static") == "yes" and kind else ""
    return directive(language, f"{static}{kind} {name}{arguments}".strip(), described(node), "   ")


def enum(language, node):
    values = ", ".join(value.findtext("name") for value in node.findall("enumvalue"))
    return directive(language, f"enum {node.findtext('name')}", " ".join(filter(None, (described(node), values))))


def classes(language, xml):
    """Each public class with its public members: text by kind and name."""
    found = {"Classes": {}, "Structs": {}, "Enums": {}}
    for path in sorted(Path(xml).glob("*.xml")):
        node = ElementTree.parse(path).getroot().find("compounddef")
        if node is None:
            continue
        name = (node.findtext("compoundname") or "").partition("::")[2].replace("::", ".")
        if node.get("kind") == "namespace":
            for one in node.iter("memberdef"):
                if one.get("kind") == "enum" and one.get("prot") == "public":
                    found["Enums"][one.findtext("name")] = enum(language, one)
        if node.get("kind") not in SHOWN or node.get("prot") != "public" or not name:
            continue
        body = directive(language, f"{SHOWN[node.get('kind')]} {name}", described(node))
        for one in node.iter("memberdef"):
            if one.get("prot") == "public" and one.get("kind") in ("function", "property", "variable", "event"):
                body += member(language, name, one)
        found["Structs" if node.get("kind") == "struct" else "Classes"][name] = body
    return "".join(f"{heading}\n{'-' * len(heading)}\n\n" + "".join(texts[name] for name in sorted(texts))
                   for heading, texts in found.items() if texts)


def names_below(folder, pattern):
    """The pages that another tool made, by their kind: (kind, name, path)."""
    for path in sorted(folder.rglob("*.html")):
        if match := re.search(pattern, path.relative_to(folder).as_posix()):
            yield match.group("kind"), match.group("name"), path.relative_to(folder).as_posix()


def listed(folder, place, pattern, many):
    """A line for each kind of name, with links."""
    kinds = {}
    for kind, name, path in names_below(folder, pattern):
        kinds.setdefault(kind, []).append(f"`{name} <../{place}/{path}>`__")
    return "".join(f"**{many.get(kind, kind)}:** {', '.join(names)}\n\n" for kind, names in kinds.items())


RUST = r"^dynpoint/(?P<kind>struct|enum|fn|trait|type|mod)\.?(?P<name>\w+)\.html$"
SCRIPT = r"^(?P<kind>classes|functions|interfaces|types|variables)/(?P<name>\w+)\.html$"


def pages(made):
    """Name, title and text of each page; `made` has what the tools wrote. A language without its tool has no page."""
    for language, title, guide in (("csharp", "C#", "csharp"), ("java", "Java", "java")):
        text = classes(language, made / language)
        if text:
            yield language, f"The {title} API", f"The classes as Doxygen reads them; how they are used: :doc:`/docs/{guide}`.", text
    if (made / "rust/dynpoint/index.html").exists():
        yield ("rust", "The Rust API", "`The crate dynpoint <../rust/dynpoint/index.html>`__, by rustdoc, with a search of its own; "
               "how it is used: :doc:`/docs/rust`.",
               listed(made / "rust", "rust", RUST, {"struct": "Structs", "enum": "Enums", "fn": "Functions", "trait": "Traits", "type": "Types"}))
    if (made / "javascript/index.html").exists():
        yield ("javascript", "The JavaScript API", "`The package dynpoint <../javascript/index.html>`__, by TypeDoc, with a search of "
               "its own; how it is used: :doc:`/docs/javascript`.",
               listed(made / "javascript", "javascript", SCRIPT, {kind: kind.capitalize() for kind in
                      ("classes", "functions", "interfaces", "types", "variables")}))
    if (made / "go.txt").exists():
        go = (made / "go.txt").read_text(encoding="utf-8")
        yield ("go", "The Go sample", "What ``world.go`` has, as ``go doc`` prints it; how it is used: :doc:`/docs/go`.",
               "::\n\n" + "".join(f"    {line}\n" if line.strip() else "\n" for line in go.split("\n")))
