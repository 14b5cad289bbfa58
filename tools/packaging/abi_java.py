#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Structs, constants and functions for Java's foreign functions (JDK 22 and later), from the model of abi_model.py:

    abi_java.py abi.json >dynpoint/Abi.java

A struct is a class with its layout and, for each field, a getter and a setter on a segment of memory. A function is a
static method of its name. Offsets are those of machines with pointers of 64 bits, as all are that Java's linker knows.
"""
import json
import sys
from os.path import basename

# Java's type, its layout, bytes.
NUMBERS = {"char": ("byte", "JAVA_BYTE", 1), "bool": ("byte", "JAVA_BYTE", 1), "i8": ("byte", "JAVA_BYTE", 1),
           "u8": ("byte", "JAVA_BYTE", 1), "i16": ("short", "JAVA_SHORT", 2), "u16": ("short", "JAVA_SHORT", 2),
           "i32": ("int", "JAVA_INT", 4), "u32": ("int", "JAVA_INT", 4), "i64": ("long", "JAVA_LONG", 8),
           "u64": ("long", "JAVA_LONG", 8), "usize": ("long", "JAVA_LONG", 8), "f32": ("float", "JAVA_FLOAT", 4),
           "f64": ("double", "JAVA_DOUBLE", 8)}
POINTER = ("MemorySegment", "ADDRESS", 8)
KEYWORDS = {"abstract", "boolean", "break", "byte", "case", "catch", "char", "class", "continue", "default", "double",
            "final", "float", "for", "if", "import", "int", "interface", "long", "native", "new", "null", "package",
            "private", "public", "return", "short", "static", "super", "switch", "synchronized", "this", "throw", "try",
            "void", "while"}


class Writer:
    def __init__(self, abi):
        self.headers = [header for library in abi["libraries"] for header in library["headers"]]
        self.structs = {s["name"]: s["fields"] for h in self.headers for s in h["structs"] if s["fields"]}
        self.numbers = {n["name"]: NUMBERS[n["type"]] for h in self.headers for n in h["numbers"]}
        self.callbacks = {c["name"] for h in self.headers for c in h["callbacks"]}
        self.version, self.sizes = abi["version"], {}

    def kind(self, item):
        """Java's type, its layout, bytes and alignment of one item of a field."""
        name = item.get("type")
        if item["pointers"] or "callback" in item or name in self.callbacks:
            return (*POINTER, 8)
        if name in self.structs:
            size, align = self.layout(name)
            return "MemorySegment", f"{name}.LAYOUT", size, align
        java, layout, size = NUMBERS.get(name) or self.numbers[name]
        return java, layout, size, size

    def layout(self, name):
        if name not in self.sizes:
            at, most = 0, 1
            for field in self.structs[name]:
                _, _, size, align = self.kind(field)
                at += -at % align + size * self.count(field)
                most = max(most, align)
            self.sizes[name] = at + -at % most, most
        return self.sizes[name]

    @staticmethod
    def count(field):
        count = 1
        for items in field.get("items", []):
            count *= items
        return count

    def struct(self, header, name, fields):
        parts, methods, at = [], "", 0
        for field in fields:
            java, layout, size, align = self.kind(field)
            assert at % align == 0, f"{name}.{field['name']}: a gap before it"
            called, count = field["name"] + "_" * (field["name"] in KEYWORDS), self.count(field)
            item = f"MemoryLayout.sequenceLayout({count}, {layout})" if count > 1 else layout
            parts.append(f"                {item}.withName(\"{field['name']}\")")
            index, place = (", int i", f"{at} + {size}L * Objects.checkIndex(i, {count})") if count > 1 else ("", str(at))
            taken, get = f"{called}(MemorySegment s{index}", f"return s.asSlice({place}, {size});"
            if "LAYOUT" not in layout:
                get = f"return s.get({layout}, {place});"
                methods += f"        static void {taken}, {java} v) {{ s.set({layout}, {place}, v); }}\n"
            methods += f"        static {java} {taken}) {{ {get} }}\n"
            if field.get("type") == "char" and count > 1:
                get = f"return utf8(s.asSlice({at}, {count}));"
                methods += f"        static String {called}(MemorySegment s) {{ {get} }}\n"
            at += size * count
        # A struct whose fields end short of its alignment is padded at its end.
        if self.layout(name)[0] > at:
            parts.append(f"                MemoryLayout.paddingLayout({self.layout(name)[0] - at})")
        joined = ",\n".join(parts)
        sized = ""
        if fields[0]["name"] == "size":
            sized = ("\n        /** One with its size set, and all else 0. */\n"
                     "        static MemorySegment sized(Arena arena) {\n"
                     "            MemorySegment s = arena.allocate(LAYOUT);\n"
                     "            size(s, (int) LAYOUT.byteSize());\n"
                     "            return s;\n        }\n")
        layout = f"MemoryLayout.structLayout(\n{joined}).withName(\"{name}\")"
        return (f"\n    /** {header}. */\n    static final class {name} {{\n"
                f"        static final StructLayout LAYOUT = {layout};\n\n{methods}{sized}    }}\n")

    def function(self, header, function):
        name, result = function["name"], function["result"]
        java, layout = "void", None
        if result.get("type") != "void" or result["pointers"]:
            java, layout = self.kind(result)[:2]
        arguments = [(one["name"] + "_" * (one["name"] in KEYWORDS), *self.kind(one)[:2])
                     for one in function["parameters"]]
        described = ", ".join(([layout] if layout else []) + [kind for _, _, kind in arguments])
        taken = ", ".join(f"{kind} {called}" for called, kind, _ in arguments)
        passed = ", ".join(called for called, _, _ in arguments)
        got = f"return ({java}) " if layout else ""
        descriptor = f"FunctionDescriptor.of{'' if layout else 'Void'}({described})"
        return f"""
    /** {header}. */
    static {java} {name}({taken}) {{
        try {{
            {got}call_{name}.HANDLE.invokeExact({passed});
        }} catch (Throwable e) {{
            throw thrown(e);
        }}
    }}

    private static final class call_{name} {{
        static final MethodHandle HANDLE = link("{name}", {descriptor});
    }}
"""

    def text(self):
        text = f"""// SPDX-License-Identifier: BSD-3-Clause
// The ABI of dynpoint {self.version}. Made by {basename(__file__)} from the C headers, which say what it means.
package dynpoint;

import static java.lang.foreign.ValueLayout.*;

import java.lang.foreign.*;
import java.lang.invoke.MethodHandle;
import java.nio.charset.StandardCharsets;
import java.util.Objects;

/** Constants, structs and functions of the C headers, as they are. The library is Library.LOOKUP's. */
final class Abi {{
    private Abi() {{}}

    private static MethodHandle link(String name, FunctionDescriptor descriptor) {{
        return Linker.nativeLinker().downcallHandle(Library.find(name), descriptor);
    }}

    private static RuntimeException thrown(Throwable error) {{
        if (error instanceof Error e) throw e;
        return error instanceof RuntimeException e ? e : new IllegalStateException(error);
    }}

    private static String utf8(MemorySegment s) {{
        byte[] bytes = s.toArray(JAVA_BYTE);
        int count = 0;
        while (count < bytes.length && bytes[count] != 0) count++;
        return new String(bytes, 0, count, StandardCharsets.UTF_8);
    }}

"""
        for header in self.headers:
            for one in header["constants"] + [value for enum in header["enums"] for value in enum["values"]]:
                value = one["value"] - (1 << 32) * (one["value"] >= 1 << 31)
                text += f"    static final int {one['name']} = {value};\n"
        for header in self.headers:
            for struct in header["structs"]:
                if struct["fields"]:
                    text += self.struct(header["name"], struct["name"], struct["fields"])
            for function in header["functions"]:
                text += self.function(header["name"], function)
        listed = ",\n        ".join(f"{name}.LAYOUT" for name in self.structs)
        return text + f"\n    static final StructLayout[] LAYOUTS = {{\n        {listed},\n    }};\n}}\n"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        sys.stdout.write(Writer(json.load(file)).text())


main()
