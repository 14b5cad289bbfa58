#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Structs, enums, constants and P/Invoke declarations in C#, from the model of abi_model.py:

    abi_csharp.py abi.json FOLDER

writes Structs.cs, Enums.cs and Native.cs into the folder, and Layouts.cs, which tests compile: what C# thinks of sizes
and offsets, a line each. The text keeps to C# 7.0, as Unity, .NET and Mono's mcs know it.

dpt_body_settings.static_friction is BodySettings.StaticFriction; functions keep their names. Arrays in structs are
structs too: three doubles are a Double3, four a Rotation (W, X, Y, Z), characters a Text.
"""
import json
import sys
from os.path import basename, join

NUMBERS = {"void": "void", "char": "byte", "bool": "byte", "i8": "sbyte", "i16": "short", "i32": "int", "i64": "long",
           "u8": "byte", "u16": "ushort", "u32": "uint", "u64": "ulong", "usize": "UIntPtr", "f32": "float",
           "f64": "double"}
KEYWORDS = {"in", "out", "ref", "params", "object", "base", "event", "lock", "fixed", "string", "is", "as", "new",
            "operator"}
# Enums whose prefix alone would be no good name, and fields of other names than their enum.
ENUM_NAMES = {"DPT": "Result", "DPT_FORCE": "ForceReason", "DPT_COUPLING": "CouplingLimit",
              "DPT_IDENTIFIED": "IdentifiedPart"}
FIELD_ENUMS = {"dpt_hit.status": "DPT_STATUS", "dpt_step.status": "DPT_STATUS", "dpt_hit.contact": "DPT_CONTACT",
               "dpt_step.contact": "DPT_CONTACT", "dpt_contact.contact": "DPT_CONTACT", "dpt_sweep.status": "DPT_SWEEP",
               "dpt_force_info.reason": "DPT_FORCE", "dpt_world_def.strip": "DPT_STRIP_KIND",
               "dpt_device_state.status": "DPT_DEVICE_STATUS", "dpt_device_state.reasons": "DPT_REASON",
               "dpt_host_info.reasons": "DPT_REASON", "dpt_host_info.limit": "DPT_COUPLING",
               "dpt_spring_net_def.kind": "DPT_NET", "dpt_spring_region.kind": "DPT_REGION"}
SAME_NAME = {"method", "kernel", "until", "law", "piercing", "integrator", "response", "format"}
BITS = ("Flag", "Reason", "Edge", "Corner", "Identified")


def pascal(name):
    return "".join(part[:1].upper() + part[1:] for part in name.lower().removeprefix("dpt_").split("_"))


class Writer:
    def __init__(self, abi):
        self.headers = [header for library in abi["libraries"] for header in library["headers"]]
        self.structs = {s["name"]: s for h in self.headers for s in h["structs"] if s["fields"]}
        self.opaque = {s["name"] for h in self.headers for s in h["structs"] if not s["fields"]}
        self.numbers = {n["name"]: NUMBERS[n["type"]] for h in self.headers for n in h["numbers"]}
        self.numbers["dpt_result"] = "Result"
        self.callbacks = {c["name"]: c for h in self.headers for c in h["callbacks"]}
        self.version = abi["version"]
        self.arrays, self.enums, self.constants = {}, {}, []
        for header in self.headers:
            self.constants += [(c["name"], NUMBERS[c["type"]], c["value"]) for c in header["constants"]]
            for enum in header["enums"]:
                self.keep_enum([(v["name"], v["value"]) for v in enum["values"] if v["name"] != "DPT_RESULT_END"])

    def keep_enum(self, values):
        split = [name.split("_") for name, _ in values]
        shared = 0
        while all(len(parts) > shared + 1 for parts in split) and len({parts[shared] for parts in split}) == 1:
            shared += 1
        if len(values) == 1 and "FLAG" not in split[0]:
            self.constants += [(name, "uint", value) for name, value in values]
            return
        shared -= split[0][shared - 1] == "NO"
        prefix = "_".join(split[0][:shared])
        short = [pascal("_".join(parts[shared:])) for parts in split]
        self.enums[prefix] = [(last, name, value) for last, (name, value) in zip(short, values)]

    def enum_name(self, prefix):
        name = ENUM_NAMES.get(prefix, pascal(prefix))
        return name + "State" if name in {pascal(struct) for struct in self.structs} else name

    def type_of(self, item):
        """As a parameter, a result, or a field without an array."""
        if "callback" in item:
            return "IntPtr"
        name, pointers = item["type"], item["pointers"]
        if name in self.callbacks:
            return "IntPtr"
        if name in self.opaque:
            return "IntPtr" + "*" * (pointers - 1)
        base = NUMBERS.get(name) or self.numbers.get(name) or pascal(name)
        return base + "*" * pointers

    def field_type(self, struct, field):
        base = self.type_of(field)
        if base.endswith("*"):
            base = "IntPtr"
        if "items" in field:
            count = 1
            for items in field["items"]:
                count *= items
            kind = {("double", 3): "Double3", ("double", 4): "Rotation"}.get((base, count))
            if field["type"] == "char":
                kind = f"Text{count}"
            kind = kind or {"IntPtr": "Pointer", "uint": "UInt", "ulong": "ULong"}.get(base, pascal(base)) + str(count)
            self.arrays[kind] = (base, count)
            return kind
        place = f"{struct}.{field['name']}"
        own = f"DPT_{struct.removeprefix('dpt_').upper()}_FLAG" if field["name"] == "flags" else None
        prefix = FIELD_ENUMS.get(place) or own or f"DPT_{field['name'].upper()}" * (field["name"] in SAME_NAME)
        if base in ("uint", "int") and prefix in self.enums:
            return self.enum_name(prefix)
        return base

    @staticmethod
    def field_name(struct, field):
        name = pascal(field)
        return name + "Value" if name == pascal(struct) else name

    def top(self, what):
        return (f"// SPDX-License-Identifier: BSD-3-Clause\n// {what} of dynpoint {self.version}. "
                f"Made by {basename(__file__)} from the C headers, which say what it means: change nothing here.\n"
                "using System;\nusing System.Runtime.InteropServices;\n\nnamespace Dynpoint\n{\n")

    def enum_text(self):
        text = "    /// <summary>Numbers of the C headers.</summary>\n    public static class Constants\n    {\n"
        for name, kind, value in self.constants:
            text += f"        /// <summary>{name}.</summary>\n        public const {kind} {pascal(name)} = {value};\n"
        text += "    }\n"
        for prefix, values in self.enums.items():
            name = self.enum_name(prefix)
            text += f"\n    /// <summary>{prefix}_...</summary>\n" + "    [Flags]\n" * any(bits in name for bits in BITS)
            text += f"    public enum {name} : {'int' if name == 'Result' else 'uint'}\n    {{\n"
            for short, full, value in values:
                text += f"        /// <summary>{full}.</summary>\n        {short} = {value},\n"
            text += "    }\n"
        return self.top("Constants and enums") + text + "}\n"

    def struct_text(self):
        text = ""
        for header in self.headers:
            for struct in header["structs"]:
                if not struct["fields"]:
                    continue
                name = pascal(struct["name"])
                text += f"    /// <summary>{struct['name']} of {header['name']}.</summary>\n"
                text += f"    [StructLayout(LayoutKind.Sequential)]\n    public partial struct {name}\n    {{\n"
                for field in struct["fields"]:
                    text += f"        /// <summary>{struct['name']}.{field['name']}.</summary>\n"
                    kind, called = self.field_type(struct["name"], field), self.field_name(struct["name"], field["name"])
                    text += f"        public {kind} {called};\n"
                if struct["fields"][0]["name"] == "size":
                    text += (f"\n        /// <summary>One with its size set, and all else 0.</summary>\n"
                             f"        public static unsafe {name} Sized()\n        {{\n"
                             f"            return new {name} {{ Size = (uint)sizeof({name}) }};\n        }}\n")
                text += "    }\n\n"
        for callback in self.callbacks.values():
            text += f"    /// <summary>{callback['name']}.</summary>\n"
            text += "    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]\n"
            text += f"    public unsafe delegate {self.type_of(callback['result'])} {pascal(callback['name'])}("
            text += f"{self.parameters(callback)});\n\n"
        for kind, (base, count) in sorted(self.arrays.items()):
            text += self.array_text(kind, base, count)
        return self.top("Structs") + text.rstrip("\n") + "\n}\n"

    @staticmethod
    def array_text(kind, base, count):
        named = {"Double3": "XYZ", "Rotation": "WXYZ"}.get(kind)
        names = named or [f"item{i}" for i in range(count)] if named or base == "IntPtr" else None
        text = f"    /// <summary>{count} of {base} in a row.</summary>\n    [StructLayout(LayoutKind.Sequential)]\n"
        text += f"    public unsafe partial struct {kind}\n    {{\n"
        if names:
            text += f"        {'public' if named else 'private'} {base} {', '.join(names)};\n"
        else:
            text += f"        private fixed {base} items[{count}];\n"
        if named:
            arguments = ", ".join(f"{base} {name.lower()}" for name in names)
            text += f"\n        public {kind}({arguments})\n        {{\n"
            text += "".join(f"            {name} = {name.lower()};\n" for name in names) + "        }\n"
        pinned = f"fixed ({base}* at = {'&' + names[0] if names else 'items'})"
        text += f"""
        /// <summary>Item i, from 0 to {count - 1}.</summary>
        public {base} this[int i]
        {{
            get {{ Check(i); {pinned} return at[i]; }}
            set {{ Check(i); {pinned} at[i] = value; }}
        }}

        private static void Check(int i)
        {{
            if ((uint)i >= {count}) throw new IndexOutOfRangeException();
        }}
"""
        if kind.startswith("Text"):
            text += f"""
        /// <summary>The characters before the first zero, read as UTF-8.</summary>
        public override string ToString()
        {{
            {pinned} return Utf8.Read(at, {count});
        }}
"""
        if named:
            shown = " + \", \" + ".join(f"{name}.ToString(culture)" for name in names)
            text += f"""
        public override string ToString()
        {{
            IFormatProvider culture = System.Globalization.CultureInfo.InvariantCulture;
            return "(" + {shown} + ")";
        }}
"""
        return text + "    }\n\n"

    def parameters(self, call):
        return ", ".join(self.type_of(one) + " " + "@" * (one["name"] in KEYWORDS) + one["name"]
                         for one in call["parameters"])

    def native_text(self):
        text = """    /// <summary>The functions of the C headers, as they are. Pointers are not looked at: Mesh, World,
    /// Body, Tool, Springs and Scene stand on these, and keep what they point to.</summary>
    public static unsafe class Native
    {
#if (UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR
        public const string Name = "__Internal";
#else
        public const string Name = "dynpoint_all";
#endif
"""
        text += f"        /// <summary>The version of the headers that this was made from.</summary>\n"
        text += f"        public const string Version = \"{self.version}\";\n"
        for header in self.headers:
            for function in header["functions"]:
                text += f"\n        /// <summary>{header['name']}.</summary>\n"
                text += "        [DllImport(Name, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]\n"
                text += f"        public static extern {self.type_of(function['result'])} {function['name']}("
                text += f"{self.parameters(function)});\n"
        return self.top("Functions") + text + "    }\n}\n"

    def layout_text(self):
        text = "    public static unsafe class Layouts\n    {\n"
        text += "        public static void Tell(Action<string> say)\n        {\n"
        for name, struct in self.structs.items():
            kind = pascal(name)
            for field in struct["fields"]:
                called, type_ = self.field_name(name, field["name"]), self.field_type(name, field)
                text += (f"            say(\"FIELD {name} {field['name']} \" + Marshal.OffsetOf(typeof({kind}), "
                         f"\"{called}\") + \" \" + sizeof({type_}));\n")
            text += f"            say(\"SIZE {name} \" + sizeof({kind}));\n"
        for name, _, _ in self.constants:
            text += f"            say(\"VALUE {name} \" + (long)Constants.{pascal(name)});\n"
        for prefix, values in self.enums.items():
            for short, full, _ in values:
                text += f"            say(\"VALUE {full} \" + (long){self.enum_name(prefix)}.{short});\n"
        return self.top("Layouts") + text + "        }\n    }\n}\n"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        writer = Writer(json.load(file))
    for name, text in (("Enums", writer.enum_text()), ("Structs", writer.struct_text()), ("Native", writer.native_text()),
                       ("Layouts", writer.layout_text())):
        with open(join(sys.argv[2], f"{name}.cs"), "w", encoding="utf-8") as file:
            file.write(text)


main()
