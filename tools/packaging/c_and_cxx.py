# SPDX-License-Identifier: BSD-3-Clause
"""C that C++ takes too: for amalgamate.py. Of what C++ wants otherwise, what can be found by tokens is rewritten here;
c_and_cxx.h says what the words stand for in each language. In C the rewritten text means what it meant.

Pointers to void become others without a cast in C. Here they pass through any_pointer(): casts to void *, functions
that return one, and parameters of that type where they are assigned, initialise or are returned."""
from tokens import Token, is_function

KEYWORDS = frozenset(
    "and and_eq bitand bitor catch class compl concept const_cast constexpr consteval constinit co_await co_return "
    "co_yield decltype delete dynamic_cast explicit export friend mutable namespace new noexcept not not_eq nullptr "
    "operator or or_eq private protected public reinterpret_cast requires static_cast template this thread_local throw "
    "try typeid typename using virtual xor xor_eq".split()
)
# What makes a cast of "(void *)", where it follows: else it is a parameter list.
OPERANDS = ("name", "number", "text")


def to_both(tokens):
    """Rewrite a file's tokens, in place."""
    code = [token for token in tokens if token.is_code()]
    rewrite(code)
    for directive in tokens:
        if directive.kind == "directive":
            rewrite_expressions([token for token in directive.inner if token.is_code()])


def rewrite(code):
    rewrite_expressions(code)
    for at in void_functions(code):
        returns_any(code, at)
    for begin, end in functions_of(code):
        body = next(i for i in range(begin, end) if code[i].word == "{")
        parameters = void_parameters(code[begin:body])
        for i in range(body, end):
            if code[i].word in parameters and is_whole(code, i):
                code[i].word = f"any_pointer({code[i].word})"


def rewrite_expressions(code):
    for i, token in enumerate(code):
        if token.kind == "name" and token.word in KEYWORDS:
            token.word += "_"
        words = [other.word for other in code[i : i + 5]]
        const = 1 if words[1:2] == ["const"] else 0
        if words[0] == "(" and words[1 + const : 4 + const] == ["void", "*", ")"] and not is_sizeof(code, i):
            after = code[i + 4 + const] if i + 4 + const < len(code) else Token("mark", ";")
            if after.kind in OPERANDS or after.word in ("(", "&", "*"):
                code[i + 1].word = "any_type(" + code[i + 1].word
                code[i + 2 + const].word = "*)"


def is_sizeof(code, i):
    return i > 0 and code[i - 1].word == "sizeof"


def functions_of(code):
    """The first and last token of each function at file scope."""
    depth, begin = 0, 0
    for i, token in enumerate(code):
        if token.word in ("{", "(", "["):
            depth += 1
        elif token.word in ("}", ")", "]"):
            depth -= 1
            if depth == 0 and token.word == "}" and is_function(code[begin : i + 1]):
                yield begin, i
                begin = i + 1
        elif token.word == ";" and depth == 0:
            begin = i + 1


def void_parameters(head):
    """The names of a function's parameters that point to void."""
    words = [token.word for token in head]
    return {words[i + 2] for i in range(len(words) - 3) if words[i : i + 2] == ["void", "*"] and words[i + 3] in ",)"}


def void_functions(code):
    """Where static functions that return a pointer to void are declared; not those of threads, which POSIX calls."""
    depth, begin = 0, 0
    for i, token in enumerate(code[:-3]):
        words = [other.word for other in code[i : i + 4]]
        if depth == 0 and words[:2] == ["void", "*"] and words[3] == "(":
            takes = [other.word for other in code[i + 4 : i + 8]]
            is_thread = takes[:2] == ["void", "*"] and takes[3] == ")"
            if not is_thread and any(other.word.startswith("static") for other in code[begin:i]):
                yield i
        depth += (token.word in ("{", "(", "[")) - (token.word in ("}", ")", "]"))
        if depth == 0 and token.word in (";", "}"):
            begin = i + 1


def returns_any(code, at):
    code[at + 1].word = "*)"
    first = at - 1 if code[at - 1].word == "const" else at
    code[first].word = "any_type(" + code[first].word


def is_whole(code, i):
    """Whether a name is all that is assigned or returned there."""
    return code[i - 1].word in ("=", "return") and code[i + 1].word in (";", ",")
