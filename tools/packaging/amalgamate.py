# SPDX-License-Identifier: BSD-3-Clause
"""One C file and one header a library, of its sources and headers (docs/ffi.md, "Single files"):

    python3 amalgamate.py OUT NAME=SOURCE,SOURCE... [NAME=SOURCE,...]

To be run where include/ and src/ are. NAME.h has the public headers that declare what the sources define, NAME.c the
sources, each with what it includes before it. A later library uses the headers of those before it. Nothing but NAME's
public functions is seen from outside: all else becomes static. What two files name alike is renamed, by tokens; a
source's macros end with it. c_and_cxx.py lets C++ take the text too. It is otherwise as it was."""
import os
import re
import sys

from c_and_cxx import to_both
from tokens import Token, body_of, items_of, macro_of, text_of, tokens_of, words_of

ROOTS = ("include", "src")


class Source:
    """A file: its tokens, what it includes and its macros."""

    def __init__(self, path):
        self.path = path
        self.stem = os.path.splitext(os.path.basename(path))[0]
        with open(path, encoding="utf-8") as stream:
            self.tokens = tokens_of(stream.read())
        self.is_public = path.startswith("include/")
        self.guard = self.find_guard()
        self.includes = []  # paths, in order
        self.system = []  # headers outside of any condition
        self.macros = {}  # name: its directive
        for token, depth in self.directives():
            words = words_of(token)
            if words[1:2] == ["include"] and words[2] != "<":
                self.includes.append(found(words[2].strip('"'), path))
            elif words[1:2] == ["include"] and depth == 0:
                self.system.append("".join(words[3:-1]))
            elif macro_of(token) and macro_of(token) != self.guard:
                self.macros[macro_of(token)] = token

    def directives(self):
        """Those that are no guard, with the number of conditions around them."""
        depth = -1 if self.guard else 0
        for token in self.tokens:
            if token.kind == "directive":
                word = words_of(token)[1:2]
                if word == ["endif"]:
                    depth -= 1
                yield token, depth
                if word and word[0].startswith("if"):
                    depth += 1

    def find_guard(self):
        if not self.path.endswith(".h"):
            return None
        first = [words_of(token) for token in self.tokens if token.kind == "directive"][:2]
        if len(first) == 2 and first[0][1] == "ifndef" and first[1][1:] == ["define", first[0][2]]:
            return first[0][2]
        return None  # for including more than once

    def code(self):
        """Its text without its guard, so that it can stand in another file."""
        tokens = list(self.tokens)
        if self.guard:
            places = [i for i, token in enumerate(tokens) if token.kind == "directive"]
            for i in (places[0], places[1], places[-1]):
                tokens[i] = Token("space", "")
        return tokens


def found(name, user):
    for root in ROOTS:
        if os.path.exists(f"{root}/{name}"):
            return f"{root}/{name}"
    sys.exit(f"amalgamate: {user} includes {name}, which is in none of {', '.join(ROOTS)}")


class Tree:
    """All files that were read, by path."""

    def __init__(self):
        self.sources = {}
        self.parsed = {}

    def get(self, path):
        if path not in self.sources:
            self.sources[path] = Source(path)
        return self.sources[path]

    def seen(self, path):
        """The headers that a file sees, in the order in which they are read."""
        paths = []

        def visit(user):
            for name in self.get(user).includes:
                if name not in paths:
                    visit(name)
                    if name not in paths:
                        paths.append(name)

        visit(path)
        return paths

    def users(self, path):
        return [user for user in self.sources if user != path and path in self.seen(user)]

    def macros(self, path):
        """The macros that a file knows, or whoever includes it may have defined for it."""
        known = {}
        for other in self.seen(path) + self.users(path) + [path]:
            known.update(self.get(other).macros)
        return known

    def items(self, path):
        """The declarations of a file, and the macros that stand for some."""
        if path not in self.parsed:
            bodies = {name: [token.word for token in body_of(macro) if token.is_code()]
                      for name, macro in self.macros(path).items()}
            statements = {name for name, body in bodies.items() if not body or body[-1] in (";", "}")}
            try:
                items, used = items_of(self.get(path).tokens, statements)
                self.parsed[path] = items, {name for name in used if bodies[name]}
            except SyntaxError as error:
                sys.exit(f"amalgamate: {path}: {error}")
        return self.parsed[path]

    def statements(self, paths):
        """The macros that stand for declarations anywhere in these files."""
        return {name for path in paths for name in self.items(path)[1]}

    def system(self, paths):
        return sorted({name for path in paths for name in self.get(path).system})


# ---- public headers ----


def public_functions(source):
    """What a public header declares for a library to define."""
    code = [token.word for token in source.tokens if token.is_code()]
    return {code[i - 1] for i, word in enumerate(code) if word == "(" and re.match(r"dpt_[a-z]", code[i - 1])}


def headers_of(tree, sources, taken):
    """The headers that declare what the sources define, but for those that are taken."""
    defined = set()
    for path in sources:
        for item in tree.items(path)[0]:
            if item.words[-1] == "}":
                defined.update(item.names)
    own = []
    for name in sorted(os.listdir("include/dynpoint")):
        path = f"include/dynpoint/{name}"
        if path not in taken and public_functions(tree.get(path)) & defined:
            own.append(path)
    return own


def joined_header(tree, paths, taken, uses):
    """The text of headers, each with those that it includes in their place, once."""

    def text(path):
        taken.append(path)
        parts = []
        for token in tree.get(path).tokens:
            words = words_of(token) if token.kind == "directive" else []
            if words[1:2] == ["include"] and words[2] != "<":
                included = found(words[2].strip('"'), path)
                if included not in taken:
                    parts.append(banner(included) + text(included).strip())
                continue
            parts.append(text_of([token]))
        return "".join(parts)

    return "".join(f'#include "{name}.h"\n' for name in uses) + "\n".join(
        banner(path) + text(path) for path in paths if path not in taken
    )


# ---- what is named alike ----


class Names:
    """What each private file declares, and the new names of what would collide."""

    def __init__(self, tree, sources):
        self.tree = tree
        self.private = []
        for path in sources:
            for name in tree.seen(path) + [path]:
                if name not in self.private and not tree.get(name).is_public:
                    self.private.append(name)
        self.words = {path: {token.word for token in all_tokens(tree.get(path).tokens) if token.kind == "name"}
                      for path in self.private}
        sees = {path: set(tree.seen(path)) for path in self.private}
        for path in self.private:
            if path.endswith(".h") and not tree.get(path).guard:  # what includes it may have read for it
                sees[path] = sees[path].union(*(tree.seen(user) for user in tree.users(path)))
        self.viewers = {path: [user for user in self.private if user == path or path in sees[user]]
                        for path in self.private}
        self.renamed = {path: {} for path in self.private}  # (word or tag, name): new name
        self.find(sees)

    def find(self, sees):
        words, tags, lasting = {}, {}, {}
        for path in self.private:
            known = set(self.tree.macros(path))
            for header in sees[path]:
                known.update(name for item in self.tree.items(header)[0] for name in item.names)
            for item in self.tree.items(path)[0]:
                for name in item.names:
                    if name not in known:
                        words.setdefault(name, set()).add(path)
                        if not (item.is_function or item.is_type()):
                            lasting.setdefault(name, set()).add(path)
                for name in item.tags:
                    tags.setdefault(name, set()).add(path)
            if self.tree.get(path).guard:
                for name in self.tree.get(path).macros:
                    lasting.setdefault(name, set()).add(path)
        for kind, all_names in (("word", words), ("tag", tags)):
            for name, owners in sorted(all_names.items()):
                headers = sorted(path for path in owners if path.endswith(".h"))
                if len(owners) > 1:
                    for path in sorted(owners - set(headers[:1])):
                        self.rename(path, kind, name)
        # What goes on behind its file: a header's macro would change whatever has its name in a file that does not see
        # it; a variable would be shadowed there, which compilers warn of.
        for name, owners in sorted(lasting.items()):
            for path in sorted(owners):
                if ("word", name) not in self.renamed[path] and any(
                        name in self.words[user] for user in self.private if user not in self.viewers[path]):
                    self.rename(path, "word", name)

    def rename(self, path, kind, name):
        stem = os.path.splitext(os.path.basename(path))[0]
        new = f"{stem.upper()}_{name}" if name.isupper() else f"{stem}_{name}"
        while any(new in words for words in self.words.values()):
            new += "_"
        for user in self.viewers[path]:
            if (kind, name) in self.renamed[user]:
                sys.exit(f"amalgamate: {user} sees two meanings of {name}")
            self.renamed[user][kind, name] = new


def all_tokens(tokens):
    for token in tokens:
        yield token
        if token.inner is not None:
            yield from all_tokens(token.inner)


def rename(tokens, names, path):
    """
    Words and tags of one file. Members keep their names: behind a dot or an arrow, and where a struct declares them.
    """
    code = [token for token in tokens if token.is_code()]
    opened = []  # of each open brace, whether it is a struct's
    for i, token in enumerate(code):
        last = [other.word for other in code[max(i - 2, 0) : i]]
        if token.word == "{":
            opened.append(bool({"struct", "union"} & set(last)))
        elif token.word == "}":
            opened.pop()
        following = code[i + 1].word if i + 1 < len(code) else ""
        if not (any(opened) and following in (";", ",", "[", ":")):
            rename_token(token, last[-1:], following, names, path)
    for directive in tokens:
        if directive.kind == "directive" and words_of(directive)[1:2] != ["include"]:
            code = [token for token in directive.inner if token.is_code()]
            for i, token in enumerate(code):
                following = code[i + 1].word if i + 1 < len(code) else ""
                rename_token(token, [other.word for other in code[max(i - 1, 0) : i]], following, names, path)


def rename_token(token, last, following, names, path):
    kind = "tag" if last and last[0] in ("struct", "union", "enum") else "word"
    if token.kind == "name" and (kind, token.word) in names and last not in (["."], ["->"]):
        if "##" in (*last, following):
            sys.exit(f"amalgamate: {path}: {token.word} collides and is part of a name that is pasted")
        token.word = names[kind, token.word]


# ---- sources ----


def make_static(tokens, public, statements):
    """Put `static` before what is seen from other files and is not public."""
    for item in items_of(tokens, statements)[0]:
        if item.is_type() or {"static", "_Static_assert"} & set(item.words) or set(item.names) & public:
            continue
        if "extern" in item.words:
            sys.exit("amalgamate: extern: " + " ".join(item.words[:12]))
        if item.words != [";"]:
            item.code[0].word = "static " + item.code[0].word


def banner(path, user=None):
    return f"/* ==== {path}{f', for {user}' if user else ''} ==== */\n"


class Writer:
    """The text of one library's sources."""

    def __init__(self, tree, names, public):
        self.tree, self.names, self.public = tree, names, public
        self.statements = tree.statements(names.private)
        self.done = set()
        self.parts = []

    def add(self, path):
        for header in self.tree.seen(path):
            source = self.tree.get(header)
            if source.guard and not source.is_public and header not in self.done:
                self.done.add(header)
                self.put(header)
        self.put(path)

    def put(self, path):
        macros = []
        text = banner(path) + self.expanded(path, macros).strip() + "\n"
        if path.endswith(".c"):
            text += "".join(f"#undef {name}\n" for name in macros)
        self.parts.append(re.sub(r"\n{3,}", "\n\n", text))

    def expanded(self, path, macros):
        """A file's own text, with the headers that are for including more than once in their place."""
        source = self.tree.get(path)
        tokens = tokens_of(text_of(source.code()))
        rename(tokens, self.names.renamed[path], path)
        make_static(tokens, self.public, self.statements)
        for token in tokens:
            if token.kind == "directive" and macro_of(token) in self.statements:
                make_static(body_of(token), self.public, self.statements)
        depth, parts = 0, []
        for token in tokens:
            words = words_of(token) if token.kind == "directive" else []
            if words[1:2] == ["include"]:
                if words[2] != "<":
                    included = self.tree.get(found(words[2].strip('"'), path))
                    if not included.guard and not included.is_public:
                        part = self.expanded(included.path, macros).strip()
                        parts.append(banner(included.path, path) + part)
                    continue
                if depth == 0:
                    continue
            elif words[1:2] == ["endif"]:
                depth -= 1
            elif words[1:] and words[1].startswith("if"):
                depth += 1
            elif words[1:2] == ["define"] and words[2] not in macros:
                macros.append(words[2])
            elif words[1:2] == ["undef"] and words[2] in macros:
                macros.remove(words[2])
            parts.append(text_of([token]))
        return "".join(parts)

    def text(self):
        tokens = tokens_of("\n".join(self.parts))
        to_both(tokens)
        return text_of(tokens)


# ---- files ----

COMMENT = """/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dynpoint {version}: {what}
 *
 * Made of dynpoint's sources, to which the headings lead, by `make amalgamation`: change those, not this.
 */
"""
BODY = """all of lib{name} in one file. Compile it by gcc or clang, in C99 or C++17 and later, and link with -lm{more}:
 *
 *     cc -O2 -c {name}.c
 *
 * No other flag is needed; what would change answers stops here. The license is in the file LICENSE."""


def read(path):
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def write(out, name, text):
    with open(f"{out}/{name}", "w", encoding="utf-8") as stream:
        stream.write(text)


def main(out, libraries):
    version = re.search(r'DPT_VERSION_STRING "(.*)"', read("include/dynpoint/base.h")).group(1)
    here = os.path.dirname(os.path.abspath(__file__))
    exact, languages = (read(f"{here}/{name}.h") for name in ("exact_arithmetic", "c_and_cxx"))
    taken, uses = [], []
    for library in libraries:
        name, sources = library.split("=", 1)
        sources = sources.split(",")
        tree = Tree()
        names = Names(tree, sources)
        headers = headers_of(tree, sources, taken)
        if os.path.exists(f"include/{name}.h"):
            headers.insert(0, f"include/{name}.h")
        what = f"the header of {name}.c."
        header = COMMENT.format(version=version, what=what) + joined_header(tree, headers, taken, uses)
        write(out, name + ".h", re.sub(r"\n{3,}", "\n\n", header))
        public = set().union(*(public_functions(tree.get(path)) for path in taken))
        writer = Writer(tree, names, public)
        for path in sources:
            writer.add(path)
        system = tree.system(names.private)
        what = BODY.format(name=name, more=" -pthread" if "pthread.h" in system else "")
        text = COMMENT.format(version=version, what=what) + exact.split("\n", 1)[1]
        text += "".join(f"#include <{header}>\n" for header in system if header != "math.h")
        text += f'\n#include "{name}.h"\n\n{languages.split(chr(10), 1)[1]}\n' + writer.text()
        write(out, name + ".c", text)
        uses.append(name)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
