#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The public ABI as JSON, from which declarations in other languages are made:

    abi_model.py dynpoint_cdef.h >abi.json

The header is the one that cdef.sh writes; pycparser reads it. Nothing is known here about any language.

    {"version": "0.1.0", "libraries": [{"name": "libdynpoint", "headers": [{"name": "base.h", ITEMS}]}]}

ITEMS of a header, each in the order of the header:

    constants  {"name", "type", "value"}                 "type": "u32" or "i32"; macros that are whole numbers
    numbers    {"name", "type", "bytes"}                 names of a number: dpt_body is a u32
    enums      {"name", "values": [{"name", "value"}]}   of four bytes; "name" is null where it has none
    structs    {"name", "fields": [{"name", TYPE}]}      "fields" is null where it is only known by a pointer
    callbacks  {"name", "is_pointer", "result": {TYPE}, "parameters": [{"name", TYPE}]}
               the name is that of the function, which fields then point to, or of the pointer
    functions  {"name", "result": {TYPE}, "parameters": [{"name", TYPE}]}

TYPE of a field, parameter or result:

    "type"      void, char, bool, i8, i16, i32, i64, u8, u16, u32, u64, usize, f32, f64, or a name of the ABI
    "pointers"  how many pointers lead to it; "const": for each of them, the outer one first, whether it may not be
                written through
    "items"     the sizes of an array, the outer one first; absent where it is none. A parameter is never an array: a
                pointer leads to its first item, and "items" tells how many the header names
    "callback"  in place of "type": {"result", "parameters"} of a pointer to a function that has no name
"""
import json
import re
import sys

from pycparser import c_ast, c_parser

NUMBERS = {
    "void": "void", "char": "char", "_Bool": "bool", "bool": "bool", "int": "i32", "unsigned int": "u32",
    "float": "f32", "double": "f64", "size_t": "usize",
    **{f"int{bits}_t": f"i{bits}" for bits in (8, 16, 32, 64)},
    **{f"uint{bits}_t": f"u{bits}" for bits in (8, 16, 32, 64)},
}
BYTES = {"bool": 1, "i8": 1, "u8": 1, "i16": 2, "u16": 2, "i32": 4, "u32": 4, "f32": 4, "i64": 8, "u64": 8, "f64": 8}
KINDS = ("constants", "numbers", "enums", "structs", "callbacks", "functions")


class Abi:
    def __init__(self, text):
        self.values = {}
        self.version = re.search(r"dynpoint (\S+):", text).group(1)
        self.libraries = []
        places = self.places(text)
        known = "".join(f"typedef int {name};" for name in NUMBERS if name.endswith("_t"))
        plain = re.sub(r"/\*.*?\*/", lambda comment: re.sub(r"[^\n]", "", comment.group()), text, flags=re.S)
        for item in c_parser.CParser().parse(f"{known}\n#line 1\n{plain}").ext:
            if getattr(item, "name", None) not in NUMBERS:
                self.keep(item, places[item.coord.line])

    def places(self, text):
        """The header that each line belongs to, and the list of libraries with their headers."""
        places = {}
        for number, line in enumerate(text.split("\n"), 1):
            if library := re.match(r"/\* ==== (\S+) ==== \*/", line):
                self.libraries.append({"name": library.group(1), "headers": []})
            elif header := re.match(r"/\* (\S+\.h) \*/", line):
                self.libraries[-1]["headers"].append({"name": header.group(1), **{kind: [] for kind in KINDS}})
            if self.libraries and self.libraries[-1]["headers"]:
                places[number] = self.libraries[-1]["headers"][-1]
        return places

    def keep(self, item, header):
        kind = item.type
        if isinstance(kind, (c_ast.Struct, c_ast.Enum)):
            self.keep_tagged(kind, kind.name, header)
        elif isinstance(item, c_ast.Typedef):
            self.keep_typedef(item, header)
        elif isinstance(kind, c_ast.FuncDecl):
            header["functions"].append({"name": item.name, **self.call(kind)})
        else:
            self.values[item.name] = self.value(item.init)
            header["constants"].append(
                {"name": item.name, "type": self.type_of(kind)["type"], "value": self.values[item.name]})

    def keep_typedef(self, item, header):
        kind = item.type
        if isinstance(kind, c_ast.PtrDecl) and isinstance(kind.type, c_ast.FuncDecl):
            header["callbacks"].append({"name": item.name, "is_pointer": True, **self.call(kind.type)})
        elif isinstance(kind, c_ast.FuncDecl):
            header["callbacks"].append({"name": item.name, "is_pointer": False, **self.call(kind)})
        elif isinstance(kind.type, (c_ast.Struct, c_ast.Enum)):
            self.keep_tagged(kind.type, item.name, header)
        else:
            base = self.type_of(kind)["type"]
            header["numbers"].append({"name": item.name, "type": base, "bytes": BYTES[base]})

    def keep_tagged(self, kind, name, header):
        if isinstance(kind, c_ast.Enum):
            header["enums"].append({"name": name, "values": self.enum_values(kind)})
            return
        fields = kind.decls and [{"name": field.name, **self.type_of(field.type)} for field in kind.decls]
        same = [struct for library in self.libraries for other in library["headers"] for struct in other["structs"]
                if struct["name"] == name]
        if same and fields:
            same[0]["fields"] = fields
        elif not same:
            header["structs"].append({"name": name, "fields": fields})

    def enum_values(self, kind):
        values = []
        for item in kind.values.enumerators:
            value = self.value(item.value) if item.value else values[-1]["value"] + 1 if values else 0
            self.values[item.name] = value
            values.append({"name": item.name, "value": value})
        return values

    def value(self, node):
        if isinstance(node, c_ast.Constant):
            return int(node.value.rstrip("uUlL"), 0)
        if isinstance(node, c_ast.ID):
            return self.values[node.name]
        if isinstance(node, c_ast.UnaryOp):
            return {"-": -1, "+": 1}[node.op] * self.value(node.expr)
        left, right = self.value(node.left), self.value(node.right)
        return {"|": left | right, "<<": left << right, "+": left + right, "-": left - right, "*": left * right}[node.op]

    def call(self, kind):
        listed = kind.args.params if kind.args else []
        parameters = [] if self.is_void(listed) else [
            {"name": one.name, **self.type_of(one.type, is_parameter=True)} for one in listed]
        return {"result": self.type_of(kind.type), "parameters": parameters}

    @staticmethod
    def is_void(listed):
        return len(listed) == 1 and isinstance(listed[0].type, c_ast.TypeDecl) \
            and getattr(listed[0].type.type, "names", None) == ["void"]

    def type_of(self, kind, is_parameter=False):
        items, const = [], []
        while not isinstance(kind, c_ast.TypeDecl):
            if isinstance(kind, c_ast.FuncDecl):
                return {"callback": self.call(kind), "pointers": 0}
            if isinstance(kind, c_ast.ArrayDecl):
                items.append(self.value(kind.dim) if kind.dim else None)
            elif not isinstance(kind.type, c_ast.FuncDecl):
                const.append("const" in kind.type.quals)
            kind = kind.type
        if is_parameter and items:
            const.append("const" in kind.quals)
        name = kind.type.name if isinstance(kind.type, (c_ast.Struct, c_ast.Enum)) else " ".join(kind.type.names)
        found = {"type": NUMBERS.get(name, name), "pointers": len(const)}
        if const:
            found["const"] = const
        if items:
            found["items"] = items
        return found


def main():
    with open(sys.argv[1], encoding="utf-8") as header:
        abi = Abi(header.read())
    json.dump({"version": abi.version, "libraries": abi.libraries}, sys.stdout, indent=1)
    print()


main()
