# SPDX-License-Identifier: BSD-3-Clause
"""C as tokens, and what a file declares: for amalgamate.py."""
import re

TOKEN = re.compile(r"""
    (?P<comment>/\*.*?\*/|//[^\n]*)
  | (?P<text>(?:L|u8|u|U)?"(?:\\.|[^"\\\n])*"|(?:L|u|U)?'(?:\\.|[^'\\\n])*')
  | (?P<name>[A-Za-z_]\w*)
  | (?P<number>\.?[0-9](?:[eEpP][-+]|[\w.])*)
  | (?P<space>(?:[ \t\f\v]|\\\n)+)
  | (?P<line>\n)
  | (?P<mark>\#\#|->|\.\.\.|.)
""", re.X | re.S)
DIRECTIVE = re.compile(r"(?m)^[ \t]*\#(?:\\\n|/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|[^\n\\/]|\\[^\n]|/(?![*/]))*", re.S)


class Token:
    """kind: comment, text, name, number, space, line, mark; or directive, whose own tokens are in `inner`."""

    __slots__ = ("kind", "word", "inner")

    def __init__(self, kind, word, inner=None):
        self.kind, self.word, self.inner = kind, word, inner

    def is_code(self):
        return self.kind in ("text", "name", "number", "mark")


def tokens_of(source, with_directives=True):
    tokens, at = [], 0
    while at < len(source):
        if with_directives and (at == 0 or source[at - 1] == "\n"):
            directive = DIRECTIVE.match(source, at)
            if directive:
                tokens.append(Token("directive", directive.group(), tokens_of(directive.group(), False)))
                at = directive.end()
                continue
        token = TOKEN.match(source, at)
        tokens.append(Token(token.lastgroup, token.group()))
        at = token.end()
    return tokens


def text_of(tokens):
    return "".join(text_of(token.inner) if token.inner is not None else token.word for token in tokens)


def words_of(directive):
    """The code of a directive: ["#", "define", ...]."""
    return [token.word for token in directive.inner if token.is_code()]


def macro_of(directive):
    """The name that a #define defines, or None."""
    words = words_of(directive)
    return words[2] if words[1:2] == ["define"] else None


def body_of(directive):
    """The tokens that a macro stands for."""
    code = [i for i, token in enumerate(directive.inner) if token.is_code()]
    first = code[2] + 1
    if first < len(directive.inner) and directive.inner[first].word == "(":
        while directive.inner[first].word != ")":
            first += 1
        first += 1
    return directive.inner[first:]


class Item:
    """A declaration at file scope: its code, without comments, spaces and directives."""

    def __init__(self, code):
        self.code = code
        self.words = [token.word for token in code]
        self.names = []  # ordinary identifiers that it declares, enumerators too
        self.tags = []
        self.is_function = False
        self.read()

    def read(self):
        words = self.words
        for i, word in enumerate(words[:-1]):
            if word in ("struct", "union", "enum"):
                body = i + 1
                if self.code[body].kind == "name":
                    body += 1
                    if words[body] in ("{", ";"):
                        self.tags.append(words[body - 1])
                if word == "enum" and words[body] == "{":
                    self.read_enumerators(body)
        if words[0] == "_Static_assert" or (self.is_type() and words[0] != "typedef"):
            return
        # A declared name is the last one before a parameter list, a bracket, an initialiser or the end.
        depth, declared, is_complete = 0, None, False
        for i, token in enumerate(self.code):
            word = token.word
            if depth == 0 and token.kind == "name" and not is_complete:
                declared = word
            if word in ("(", "[", "{"):
                if depth == 0 and not is_complete:
                    if word == "(" and words[i + 1] == "*":
                        declared, is_complete = words[i + 2], True
                    elif word == "{" or declared in ("__attribute__", "_Alignas"):
                        declared = None
                    else:
                        is_complete = declared is not None
                        self.is_function = word == "(" and is_complete and words[0] != "typedef"
                depth += 1
            elif word in (")", "]", "}"):
                depth -= 1
            if depth == 0 and (word in ("=", ",", ";") or (word == "}" and is_complete)):
                if declared:
                    self.names.append(declared)
                declared, is_complete = None, False
                if word in ("=", "}"):
                    break

    def read_enumerators(self, at):
        depth, expects = 0, False
        for token in self.code[at:]:
            if token.word in "{(":
                depth += 1
                expects = depth == 1
            elif token.word in "})":
                depth -= 1
                if depth == 0:
                    return
            elif token.word == "," and depth == 1:
                expects = True
            elif expects and token.kind == "name":
                self.names.append(token.word)
                expects = False

    def is_type(self):
        """A typedef, or a struct, union or enum that declares nothing else."""
        if self.words[0] not in ("struct", "union", "enum"):
            return self.words[0] == "typedef"
        end = 2 if self.code[1].kind == "name" else 1
        return self.words[end] == ";" or (self.words[end] == "{" and self.words[-2:] == ["}", ";"])


def items_of(tokens, statements):
    """The items at file scope, and those of the macros `statements` that are items by themselves."""
    items, macros, code, depth, i = [], set(), [], 0, 0
    tokens = [token for token in tokens if token.is_code()]
    while i < len(tokens):
        token = tokens[i]
        if not code and token.kind == "name" and token.word in statements:
            macros.add(token.word)
            i += 1
            if i < len(tokens) and tokens[i].word == "(":
                while tokens[i].word != ")":
                    i += 1
                i += 1
            continue
        code.append(token)
        if token.word in "{([":
            depth += 1
        elif token.word in "})]":
            depth -= 1
            if depth < 0:
                raise SyntaxError("a bracket that is not open")
        is_body = depth == 0 and token.word == "}" and is_function(code)
        if depth == 0 and (token.word == ";" or is_body):
            items.append(Item(code))
            code = []
        i += 1
    if code or depth:
        raise SyntaxError("ends within: " + " ".join(token.word for token in code[:12]))
    return items, macros


def is_function(code):
    """Whether what ends in a brace is a function: its body follows parentheses."""
    depth = 0
    for i in range(len(code) - 1, -1, -1):
        if code[i].word == "}":
            depth += 1
        elif code[i].word == "{":
            depth -= 1
            if depth == 0:
                return i > 0 and code[i - 1].word == ")"
    return False
