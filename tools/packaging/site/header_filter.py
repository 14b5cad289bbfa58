#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""header_filter.py HEADER: a public header as Doxygen reads it. A comment belongs to the declarations behind it, up to a
blank line; what is indented in it keeps its columns."""
import re
import sys
from pathlib import Path

ESCAPED = re.compile(r"([\\@<>&#%$])")


def prose(text):
    """Text for Doxygen: signs that it would take for its own are escaped, and backticks are code."""
    return re.sub(r"`([^`]+)`", r"<tt>\1</tt>", ESCAPED.sub(r"\\\1", text))


def body_of(comment):
    """The text of a comment, with indented lines marked as they are."""
    lines = [re.sub(r"^ ?\*(?: |$)", "", line).rstrip() for line in comment.strip()[2:-2].split("\n")]
    lines[0] = lines[0].lstrip("*").strip()
    out, columns = [], []

    def flush():
        while columns and not columns[-1]:
            columns.pop()
        if columns:
            least = min(len(line) - len(line.lstrip()) for line in columns if line)
            out.extend(["@verbatim", *(line[least:] for line in columns), "@endverbatim"])
            columns.clear()

    for line in lines:
        if re.match(r" {2,}", line) or (columns and not line):
            columns.append(line)
        else:
            was_in_columns = bool(columns)
            flush()
            out.extend([""] if was_in_columns and line else [])
            out.append(prose(line))
    flush()
    return "\n".join(out).strip()


def documented(comment, declarations, text):
    """What stands in place of a comment and the declarations behind it."""
    inner = re.sub(r"/\* (.*?) \*/", lambda one: f"/**< {prose(one.group(1))} */", declarations, flags=re.S)
    statements = len(re.findall(r"^(?:DPT_API|static inline|typedef|struct|enum)\b", declarations, re.M))
    if not comment:
        return inner
    if statements > 1:
        title = ", ".join(dict.fromkeys(re.findall(r"\b(dpt_\w+)\(", declarations))) or "Declarations"
        return f"/** @name {title}\n{text}\n@{{ */\n{inner}\n/** @}} */"
    return f"/**\n{text}\n*/\n{inner}"


def main():
    path = Path(sys.argv[1])
    source = re.sub(r"^/\* SPDX[^\n]*\n", "", path.read_text(encoding="utf-8"))
    parts = re.split(r"(^/\*.*?\*/\n?)", source, flags=re.S | re.M)
    out, first = [parts[0]], True
    for comment, rest in zip(parts[1::2], parts[2::2]):
        text = body_of(comment)
        if first:
            out.append(f"/** @file {path.name}\n{text}\n*/\n{rest}")
            first = False
            continue
        declarations, _, after = rest.partition("\n\n") if not rest.startswith("\n") else ("", "", rest)
        if not declarations.strip() or declarations.startswith("#"):
            out.append(f"/**\n{text}\n*/\n{rest}" if declarations.startswith("#define") else rest)
        else:
            out.append(documented(comment, declarations, text) + "\n\n" + after)
    sys.stdout.write("".join(out))


main()
