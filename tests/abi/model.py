#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""model.py MODEL LAYOUTS SYMBOLS...: what abi_model.py says beside the lists that the C compiler is held to.

Each struct's fields, laid out by C's rule for machines of 64 and of 32 bits, lie where LAYOUTS has them; each constant
has its value; the functions are those of SYMBOLS. It cannot judge the types of parameters, nor two fields of one size
that changed their types."""
import json
import re
import sys

BYTES = {"char": 1, "bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "f32": 4, "i64": 8, "u64": 8,
         "f64": 8}


def items_of(libraries, kind):
    return [item for library in libraries for header in library["headers"] for item in header[kind]]


class Layout:
    """Sizes and alignments where a pointer has that many bytes."""

    def __init__(self, libraries, pointer):
        self.pointer = pointer
        self.structs = {struct["name"]: struct["fields"] for struct in items_of(libraries, "structs")}
        self.numbers = {number["name"]: number["bytes"] for number in items_of(libraries, "numbers")}

    def of(self, field):
        """Bytes and alignment of a field."""
        name = field.get("type")
        if field["pointers"] or "callback" in field or name == "usize" or name not in {**BYTES, **self.numbers, **self.structs}:
            size = align = self.pointer
        elif name in self.structs:
            size, align = self.struct(name)[1:]
        else:
            size = align = BYTES.get(name) or self.numbers[name]
        for count in field.get("items", []):
            size *= count
        return size, align

    def struct(self, name):
        """Where its fields lie, its bytes and its alignment."""
        places, at, most = {}, 0, 1
        for field in self.structs[name]:
            size, align = self.of(field)
            at += -at % align
            places[field["name"]] = (at, size)
            at, most = at + size, max(most, align)
        return places, at + -at % most, most


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        libraries = json.load(file)["libraries"]
    with open(sys.argv[2], encoding="utf-8") as file:
        listed = file.read()
    wrong, seen = [], 0
    for column, pointer in ((0, 8), (1, 4)):
        layout = Layout(libraries, pointer)
        for name, field, *numbers in re.findall(r"^FIELD\((\w+), (\w+), +(\d+), +(\d+), +(\d+), +(\d+)\)", listed, re.M):
            seen += 1
            expected = tuple(map(int, numbers[2 * column:2 * column + 2]))
            got = layout.struct(name)[0].get(field)
            if got != expected:
                wrong.append(f"{name}.{field}: {got}, where layouts.txt has {expected}")
        for name, *sizes in re.findall(r"^SIZE\((\w+), (\d+), (\d+)\)", listed, re.M):
            if layout.struct(name)[1] != int(sizes[column]):
                wrong.append(f"{name}: {layout.struct(name)[1]} bytes, where layouts.txt has {sizes[column]}")
    values = {item["name"]: item["value"] for item in items_of(libraries, "constants")}
    for enum in items_of(libraries, "enums"):
        values.update((item["name"], item["value"]) for item in enum["values"])
    for name, value in re.findall(r"^VALUE\((\w+), (-?\w+)", listed, re.M):
        seen += 1
        if name in values and values[name] != int(value.rstrip("uU"), 0):
            wrong.append(f"{name} is {values[name]}, where layouts.txt has {value}")
    symbols = set()
    for name in sys.argv[3:]:
        with open(name, encoding="utf-8") as file:
            symbols.update(file.read().split())
    for name in sorted(symbols ^ {function["name"] for function in items_of(libraries, "functions")}):
        wrong.append(f"{name} is in one of the two alone")
    print("\n".join(f"  {line}" for line in wrong) or f"  {seen} places and values")
    return bool(wrong) or seen < 1000


sys.exit(main())
