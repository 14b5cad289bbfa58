#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The declarations of the crates (src/bindings/rust), from the ABI's model and the headers' comments:

    abi_rust.py abi.json INCLUDE LAYOUTS SYS PLAIN

SYS is dynpoint-sys's abi.rs: all that the libraries export, a module for each library. While it is compiled, the
compiler holds sizes, offsets and constants to LAYOUTS (tests/abi/layouts.txt).

PLAIN is dynpoint's plain.rs: the same structs for safe code. What safe code must not touch is private there: `size`,
what is reserved, pointers with their counts, and characters, which are read as text. Each has its layout, by the same
way of checking.
"""
import json
import os
import re
import sys

NUMBERS = {"char": "c_char", "i32": "i32", "u32": "u32", "u64": "u64", "i64": "i64", "usize": "usize", "f32": "f32",
           "f64": "f64", "void": "c_void", "u8": "u8", "u16": "u16", "i8": "i8", "i16": "i16", "bool": "bool"}
KEYWORDS = {"type", "loop", "move", "fn", "in", "ref", "use", "where", "match", "mod", "box", "self"}
FEATURES = {"libdynpoint_compile": "compile", "libdynpoint_drivers": "host", "libdynpoint_host": "host",
            "libdynpoint_urdf": "urdf", "libdynpoint_convex": "convex"}
# What safe code sees, by the feature of dynpoint that it needs.
PLAIN = {
    None: "pose segment wrench hit contact sweep step world_def world_info body_settings deformable_def load"
          " tool_settings force_info tool_load channel mesh_info mesh_fault springs_def springs_info guard_def guard_info"
          " hull_info query_def",
    "compile": "spring_region spring_net_def compile_def",
    "host": "host_def host_body host_info device_info device_state loop_stats",
}
HEAD = "// SPDX-License-Identifier: BSD-3-Clause\n// Made by tools/packaging/abi_rust.py from the headers.\n"


class Comments:
    """What the headers say: of structs and functions by name, of fields by (struct, field)."""

    def __init__(self, include):
        self.text = {}
        for folder, _, names in sorted(os.walk(include)):
            for name in sorted(names):
                if name.endswith(".h"):
                    with open(os.path.join(folder, name), encoding="utf-8") as header:
                        self.read(header.read())

    def read(self, text):
        struct, comment, open_comment = None, None, None
        for line in text.split("\n"):
            bare = line.strip()
            if open_comment is not None:
                open_comment.append(re.sub(r"^\* ?", "", re.sub(r" ?\*/$", "", bare)))
                if bare.endswith("*/"):
                    comment, open_comment = [one for one in open_comment if one], None
            elif bare.startswith("/*") and not bare.endswith("*/"):
                open_comment = [bare[2:].strip()]
            elif bare.startswith("/*"):
                comment = [bare[2:-2].strip()]
            elif found := re.match(r"typedef struct (dpt_\w+) \{", bare):
                struct = found.group(1)
                self.keep(struct, comment)
                comment = None
            elif bare.startswith("}"):
                struct = comment = None
            elif found := re.match(r"DPT_API .*?\b(dpt_\w+)\(", bare):
                self.keep(found.group(1), comment)
            elif struct and (found := re.match(r"[^/]*?\b(\w+)(?:\[\w+\])*;\s*(?:/\* (.*?)(?: \*/)?)?$", bare)):
                self.keep((struct, found.group(1)), comment or (found.group(2) and [found.group(2)]))
                comment = None
            elif not bare:
                comment = None

    def keep(self, name, comment):
        if not comment:
            return
        self.text[name] = comment
        fields = []
        for line in comment if isinstance(name, str) else []:
            if found := re.match(r" {2,3}(\w+(?:, \w+)*) {2,}(\S.*)", line):
                fields = found.group(1).split(", ")
                for field in fields:
                    self.text[name, field] = [found.group(2)]
            elif not re.match(r" {5,}\S", line):
                fields = []
            for field in fields if not found else []:
                self.text[name, field].append(line.strip())

    def block(self, name, indent=""):
        """A comment as it stands, for a struct or a function."""
        lines = self.text.get(name)
        if not lines:
            return f"{indent}/// `{name}`, as the header of its noun has it.\n"
        return "".join(f"{indent}/// {line}".rstrip() + "\n" for line in [f"`{name}`:", "```text", *lines, "```"])

    def line(self, struct, field, indent):
        lines = self.text.get((struct, field), [f"As the comment on `{struct}` says."])
        plain = [re.sub(r"([][<>*|])", r"\\\1", line) for line in lines]
        return "".join(f"{indent}/// {line}".rstrip() + "\n" for line in plain)


def safe_name(name):
    return f"r#{name}" if name in KEYWORDS else name


def camel(name):
    return "".join(part.capitalize() for part in name.removeprefix("dpt_").split("_"))


class Abi:
    def __init__(self, model):
        self.libraries = model["libraries"]
        headers = [header for library in self.libraries for header in library["headers"]]
        self.callbacks = {one["name"]: one for header in headers for one in header["callbacks"]}
        self.structs = {one["name"]: one for header in headers for one in header["structs"]}
        self.functions = {one["name"]: one for header in headers for one in header["functions"]}

    def call_of(self, call):
        parameters = ", ".join(f"{safe_name(one['name'] or '_')}: {self.type_of(one)}" for one in call["parameters"])
        result = call["result"]
        is_void = result.get("type") == "void" and not result["pointers"]
        return f"({parameters})" + ("" if is_void else f" -> {self.type_of(result)}")

    def type_of(self, one):
        """A type as Rust writes it; an array that is a parameter is a pointer already."""
        if "callback" in one:
            return f"Option<unsafe extern \"C\" fn{self.call_of(one['callback'])}>"
        callback = self.callbacks.get(one["type"])
        pointers, const = one["pointers"], list(one.get("const", []))
        if callback and pointers == (0 if callback["is_pointer"] else 1):
            return one["type"]
        text = NUMBERS.get(one["type"], one["type"])
        for is_const in reversed(const):
            text = ("*const " if is_const else "*mut ") + text
        if not const or self.is_field_array(one):
            for count in reversed(one.get("items", [])):
                text = f"[{text}; {count}]"
        return text

    @staticmethod
    def is_field_array(one):
        return one.get("is_field", False)

    def fields(self, name):
        return [{**field, "is_field": True} for field in self.structs[name]["fields"]]

    def has_callback(self, name):
        return any("callback" in field or field["type"] in self.callbacks for field in self.fields(name))


def common_prefix(names):
    parts = [name.split("_") for name in names]
    shared = os.path.commonprefix(parts)
    return "_".join(shared[:min(len(shared), min(len(part) for part in parts) - 1)])


def sys_enum(enum):
    signed = any(one["value"] < 0 for one in enum["values"])
    return "".join(f"pub const {one['name']}: {'i32' if signed else 'u32'} = {one['value']};\n"
                   for one in enum["values"] if one["name"] != "DPT_RESULT_END")


def sys_struct(abi, struct, comments):
    name = struct["name"]
    text = comments.block(name)
    if struct["fields"] is None:
        return (f"{text}#[repr(C)]\npub struct {name} {{\n    _opaque: [u8; 0],\n"
                "    _neither_sent_nor_shared: core::marker::PhantomData<(*mut u8, core::marker::PhantomPinned)>,\n}\n")
    text += f"#[repr(C)]\n#[derive(Clone, Copy, Debug)]\npub struct {name} {{\n"
    for field in abi.fields(name):
        text += comments.line(name, field["name"], "    ")
        text += f"    pub {safe_name(field['name'])}: {abi.type_of(field)},\n"
    return text + "}\n"


def sys_header(abi, header, comments):
    text = f"\n// ---- {header['name']}\n\n"
    text += "".join(f"pub const {one['name']}: {one['type']} = {one['value']};\n" for one in header["constants"])
    text += "".join(f"pub type {one['name']} = {NUMBERS[one['type']]};\n" for one in header["numbers"])
    text += "".join(sys_enum(one) for one in header["enums"])
    for one in header["callbacks"]:
        text += f"pub type {one['name']} = Option<unsafe extern \"C\" fn{abi.call_of(one)}>;\n"
    text += "".join(sys_struct(abi, one, comments) for one in header["structs"])
    if header["functions"]:
        text += 'extern "C" {\n'
        for one in header["functions"]:
            text += comments.block(one["name"], "    ") + f"    pub fn {one['name']}{abi.call_of(one)};\n"
        text += "}\n"
    return text


def library_of(abi, name):
    """The feature that a struct or a constant needs."""
    for library in abi.libraries:
        for header in library["headers"]:
            listed = [one["name"] for one in header["structs"] + header["constants"] + header["numbers"]]
            listed += [one["name"] for enum in header["enums"] for one in enum["values"]]
            if name in listed:
                return FEATURES.get(library["name"])
    return "nowhere"


def layout_checks(abi, layouts):
    """Constant assertions of the list of layouts, by the feature and the width of pointers."""
    checks = {}
    for kind, rest in re.findall(r"^(FIELD|SIZE|VALUE|TYPE)\((.*)\)$", layouts, flags=re.M):
        part = [one.strip() for one in rest.split(",")]
        feature = library_of(abi, part[0])
        if feature == "nowhere" or part[0] == "DPT_RESULT_END":
            continue
        for bits, column in (("64", 0), ("32", 1)):
            if kind == "FIELD":
                check = f"offset_of!({part[0]}, {safe_name(part[1])}) == {part[2 + 2 * column]}"
            elif kind == "SIZE":
                check = f"size_of::<{part[0]}>() == {part[1 + column]}"
            elif kind == "TYPE":
                check = f"size_of::<{part[0]}>() == {part[1]}"
            else:
                check = f"{part[0]} as i64 == {part[1]}"
            checks.setdefault((feature, bits), []).append(f"    assert!({check});\n")
    text = ""
    for (feature, bits), listed in checks.items():
        wanted = f'target_pointer_width = "{bits}"' + (f', feature = "{feature}"' if feature else "")
        text += f"\n#[cfg(all({wanted}))]\nconst _: () = {{\n    use core::mem::{{offset_of, size_of}};\n"
        text += "".join(listed) + "};\n"
    return text


def write_sys(abi, comments, layouts):
    text = HEAD + "\nuse core::ffi::{c_char, c_void};\n\n"
    for library in abi.libraries:
        feature = FEATURES.get(library["name"])
        body = "".join(sys_header(abi, header, comments) for header in library["headers"])
        if feature is None:
            text += body
            continue
        module = library["name"].removeprefix("libdynpoint_")
        gate = f'#[cfg(feature = "{feature}")]\n'
        text += f"\n{gate}pub use {module}_functions::*;\n{gate}mod {module}_functions {{\n"
        text += f"#[allow(unused_imports)]\nuse super::*;\n{body}}}\n"
    return text + layout_checks(abi, layouts)


def is_private(field, has_pointers):
    name = field["name"]
    return (name == "size" or name.startswith("reserved") or field["pointers"] > 0 or "callback" in field
            or field.get("type", "").endswith("_fn") or field.get("type") == "char"
            or (has_pointers and name.endswith("_count")))


def plain_type(abi, field, safe):
    if field.get("type") == "char" and not field["pointers"]:
        return f"[u8; {field['items'][0]}]"
    text = abi.type_of(field)
    for name in re.findall(r"dpt_\w+", text):
        is_held = name in safe and not field["pointers"]
        text = text.replace(name, camel(name) if is_held else f"sys::{name}")
    return text


def is_setting(name):
    return name.endswith(("_def", "_settings", "_region", "dpt_load"))


def plain_struct(abi, name, feature, comments, safe):
    fields = abi.fields(name)
    has_pointers = any(field["pointers"] or "callback" in field for field in fields)
    gate = f'#[cfg(feature = "{feature}")]\n' if feature else ""
    short = camel(name)
    derive = "Clone, Copy, Debug" + ("" if abi.has_callback(name) else ", PartialEq")
    text = f"\n{comments.block(name)}{gate}#[repr(C)]\n#[derive({derive})]\npub struct {short} {{\n"
    for field in fields:
        hidden = is_private(field, has_pointers)
        text += "" if hidden else comments.line(name, field["name"], "    ")
        text += f"    {'pub(crate)' if hidden else 'pub'} {safe_name(field['name'])}: {plain_type(abi, field, safe)},\n"
    text += "}\n"
    names = " ".join(safe_name(field["name"]) for field in fields)
    size = " size: size," if fields[0]["name"] == "size" else ""
    text += f"{gate}mirror! {{ {short} of {name},{size} fields: {names} }}\n"
    if has_pointers:
        text += f"{gate}has_null_pointers! {{ {short} }}\n"
    defaults = f"{name}_defaults"
    if defaults in abi.functions:
        text += f"{gate}has_defaults! {{ {short} by {defaults} }}\n"
    elif not name.endswith("_settings") and name != "dpt_pose":
        text += f"{gate}is_empty_by_default! {{ {short} }}\n"
    setters = ""
    for field in fields:
        one, comment = safe_name(field["name"]), comments.line(name, field["name"], "    ")
        if field.get("type") == "char" and not field["pointers"]:
            text += f"{gate}has_text! {{ {short},\n{comment}    {one} }}\n"
        elif is_setting(name) and not is_private(field, has_pointers):
            setters += f",\n{comment}    {one}: {plain_type(abi, field, safe)}"
    return text + (f"{gate}has_setters! {{ {short}{setters}\n}}\n" if setters else "")


def constant_modules(abi):
    """Constants by their groups: DPT_LAW_PROXY is law::PROXY; and one that stands alone by its own name."""
    modules, alone, errors = {}, [], []
    for library in abi.libraries:
        feature = FEATURES.get(library["name"])
        if feature not in PLAIN:
            continue
        gate = f'#[cfg(feature = "{feature}")]\n' if feature else ""
        for header in library["headers"]:
            for enum in header["enums"]:
                names = [one["name"] for one in enum["values"]]
                if names[0] == "DPT_OK":
                    errors = [one for one in enum["values"] if one["name"].startswith("DPT_E_")]
                elif len(names) == 1:
                    alone.append((gate, enum["values"][0]))
                else:
                    prefix = common_prefix(names)
                    modules.setdefault((gate, prefix), []).extend(enum["values"])
            alone += [(gate, one) for one in header["constants"] if not one["name"].startswith("DPT_VERSION")]
    text = ""
    for (gate, prefix), values in modules.items():
        text += f"\n/// `{prefix}_...` of the headers.\n{gate}pub mod {prefix.removeprefix('DPT_').lower()} {{\n"
        for one in values:
            short = one["name"].removeprefix(prefix + "_")
            text += f"    /// `{one['name']}`\n    pub const {short}: u32 = {one['value']};\n"
        text += "}\n"
    for gate, one in alone:
        text += f"\n/// `{one['name']}`\n{gate}pub const {one['name'].removeprefix('DPT_')}: u32 = {one['value']};\n"
    text += "\nimpl crate::Error {\n"
    for one in errors:
        short = one["name"].removeprefix("DPT_E_")
        text += f"    /// `{one['name']}`\n    pub const {short}: Self = Self({one['value']});\n"
    return text + "}\n"


def write_plain(abi, comments):
    safe = {f"dpt_{name}" for names in PLAIN.values() for name in names.split()}
    text = HEAD + "\n#[allow(unused_imports)]\nuse core::ffi::{c_char, c_void};\nuse dynpoint_sys as sys;\n"
    for feature, names in PLAIN.items():
        for name in names.split():
            text += plain_struct(abi, f"dpt_{name}", feature, comments, safe)
    return text + constant_modules(abi)


def main():
    model, include, layouts, sys_file, plain_file = sys.argv[1:]
    with open(model, encoding="utf-8") as file:
        abi = Abi(json.load(file))
    with open(layouts, encoding="utf-8") as file:
        layouts = file.read()
    comments = Comments(include)
    for path, text in ((sys_file, write_sys(abi, comments, layouts)), (plain_file, write_plain(abi, comments))):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


main()
