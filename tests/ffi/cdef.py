# SPDX-License-Identifier: BSD-3-Clause
"""Holds dynpoint_cdef.h, as cffi reads it, against tests/abi, the headers and the libraries, and calls through it
(docs/ffi.md): python3 tests/ffi/cdef.py BUILD."""
import os
import re
import subprocess
import sys
from glob import glob

build, abi = sys.argv[1], sys.path[0] + "/../abi/"
try:
    from cffi import FFI
except ImportError:
    print("  skip the declarations for other languages: no cffi (python3-cffi)")
    print("0 passed, 0 failed, 1 skipped")
    sys.exit(0)

verdicts = []


def check(what, is_so):
    print("  ok  " if is_so else "  FAIL", what)
    verdicts.append(bool(is_so))


def check_none(what, wrong):
    for line in wrong[:10]:
        print("      ", line)
    check(what, not wrong)


def is_near(number, wanted):
    return abs(number - wanted) < 1e-12


def names_in(lib):
    return {name for name in dir(lib) if name.startswith("dpt_")}


text = open(build + "/include/dynpoint_cdef.h").read()
code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
check_none("nothing of a preprocessor, no attribute, no body of a function",
           [line for line in code.split("\n") if re.search(r"^\s*#|\\$|__|DPT_[A-Z]+ [a-z]|\binline\b|\)\s*{", line)
            and not line.startswith("static const")])

# A library's section, and those before it: the functions are those that it exports.
sections = re.findall(r"^/\* ==== (\w+) ==== \*/\n(.*?)(?=^/\* ====|\Z)", text, flags=re.S | re.M)
taken, before, opened = "", set(), []  # a library that is closed would be missed by the next one
for library, declarations in sections:
    taken += declarations
    part = FFI()
    part.cdef(taken)
    declared = names_in(part.dlopen(None)) - before
    before |= declared
    exported = set(open(abi + library + ".symbols").read().split())
    check_none(f"{library}: what {library}.symbols lists is declared, and nothing else",
               [f"{name} is {'not declared' if name in exported else 'declared'}" for name in sorted(declared ^ exported)])
    if os.path.exists(f"{build}/{library}.so"):
        there = part.dlopen(f"{build}/{library}.so")
        opened.append(there)
        check_none(f"{library}: each is found there", [name for name in sorted(declared) if not hasattr(there, name)])
listed = {os.path.basename(path)[: -len(".symbols")] for path in glob(abi + "*.symbols")}
check("each library has a section", {library for library, _ in sections} == listed and len(sections) == len(listed))

ffi = FFI()
ffi.cdef(text)
core = ffi.dlopen(build + "/libdynpoint.so")
compiler = ffi.dlopen(build + "/libdynpoint_compile.so")

# tests/abi/layouts.txt, of this machine.
column = 0 if ffi.sizeof("void *") == 8 else 1
layouts = re.sub(r"/\*.*?\*/", "", open(abi + "layouts.txt").read(), flags=re.S)
wrong, counted = [], {"TYPE": 0, "STRUCT": 0, "FIELD": 0, "SIZE": 0, "VALUE": 0}
structs = {}
for kind, name, rest in re.findall(r"^(\w+)\((\w+)(?:, *)?(.*)\)$", layouts, flags=re.M):
    words = [word.strip() for word in rest.split(",")]
    counted[kind] += 1
    if kind == "TYPE":
        found, wanted = ffi.sizeof(name), int(words[0])
    elif kind == "STRUCT":
        structs[name] = []
        continue
    elif kind == "SIZE":
        found, wanted = ffi.sizeof("struct " + name), int(words[column])
        found, wanted = (found, [field for field, _ in ffi.typeof("struct " + name).fields]), (wanted, structs[name])
    elif kind == "FIELD":
        structs[name].append(words[0])
        fields = dict(ffi.typeof("struct " + name).fields)
        field = fields.get(words[0])
        found = field and (field.offset, ffi.sizeof(field.type))
        wanted = (int(words[1 + 2 * column]), int(words[2 + 2 * column]))
    else:
        found, wanted = getattr(core, name, None), int(words[0], 0)
    if found != wanted:
        wrong.append(f"{kind} {name} {words[0]}: {found}, in layouts.txt {wanted}")
check_none(f"layouts.txt: {counted['SIZE']} structs, {counted['FIELD']} fields, {counted['VALUE']} constants", wrong)
check("and there are some of each", all(counted.values()) and counted["STRUCT"] == counted["SIZE"])

# Macros are not in layouts.txt: the C compiler says which are integers, and how large. A number that is none, or a string,
# is in a comment; what else a macro stands for (attributes, initialisers) no other language could use.
macros = set()
for path in glob("include/dynpoint/*.h"):
    header = re.sub(r"/\*.*?\*/", "", open(path).read(), flags=re.S)
    macros.update(re.findall(r"^#[ \t]*define[ \t]+(DPT_\w+)[ \t]+[-+(.\"A-Z0-9]", header, flags=re.M))
program = """#include <stdio.h>
#define SAY(name, value) \\
    printf("%s %d %lld\\n", name, _Generic((value), char *: 0, double: 0, default: 1), \\
           (long long)_Generic((value), char *: 0, double: 0, default: (value)));
"""
program += "".join(f"#include <dynpoint/{os.path.basename(path)}>\n" for path in glob("include/dynpoint/*.h"))
program += "int main(void) {" + "".join(f'SAY("{name}", {name})\n' for name in macros) + "return 0; }\n"
subprocess.run(os.environ.get("CC", "cc").split() + ["-std=c11", "-Iinclude", "-x", "c", "-", "-o", build + "/cdef_macros"],
               input=program, text=True, check=True)
said = subprocess.run([build + "/cdef_macros"], capture_output=True, text=True, check=True).stdout
said = [line.split() for line in said.splitlines()]
integers = {name: int(value) for name, is_integer, value in said if is_integer == "1"}
others = [name for name, is_integer, _ in said if is_integer == "0"]
check_none(f"{len(integers)} integer macros have their values",
           [name for name, value in integers.items() if getattr(core, name, None) != value])
check_none(f"{len(others)} others are in comments", [name for name in others if f"/* {name} is " not in text])
check("and there are some of each", integers and others)

# From arrays to a force. A box of 2 x 2 x 1 m with its top at z = 1: corner i at the bits of i.
sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
vertices = [x for i in range(8) for x in (2 * (i & 1) - 1, (i & 2) - 1, i >> 2)]
corners = [i for a, b, c, d in sides for i in (a, b, c, a, c, d)]
file, mesh = ffi.new("dpt_compiled *"), ffi.new("const dpt_mesh **")
diag = ffi.new("dpt_diag *", {"size": ffi.sizeof("dpt_diag")})
check("compile", compiler.dpt_compile_arrays(vertices, 8, corners, 12, ffi.NULL, file, diag) == core.DPT_OK)
check("open", core.dpt_mesh_open(file.bytes, file.size, mesh) == core.DPT_OK)
definition = ffi.new("dpt_world_def *")
core.dpt_world_def_defaults(definition, ffi.sizeof(definition[0]))
definition.law = core.DPT_LAW_POINT
need = core.dpt_world_bytes(definition)
block = ffi.new("double[]", need // 8 + 1)  # doubles, so that the block is aligned to 8
world, body, tool = ffi.new("dpt_world **"), ffi.new("dpt_body *"), ffi.new("dpt_tool *")
check("create", core.dpt_world_create(block, need, definition, world) == core.DPT_OK)
check("add a body", core.dpt_body_add(world[0], mesh[0], ffi.NULL, body) == core.DPT_OK)
stylus = ffi.new("dpt_segment *", {"b": (0, 0, 1), "radius": 0.1})
check("add a tool", core.dpt_tool_add(world[0], stylus, 1, tool) == core.DPT_OK)
pose = ffi.new("dpt_pose *", {"position": (0.3, 0.2, 1.05), "orientation": (1, 0, 0, 0)})
step = ffi.new("dpt_step *", {"size": ffi.sizeof("dpt_step")})
wrench = ffi.new("dpt_wrench *")
check("move", core.dpt_tool_set_pose(world[0], tool[0], pose) == core.DPT_OK)
check("step", core.dpt_world_step(world[0], 0.001, step) == core.DPT_OK)
check("wrench", core.dpt_tool_get_wrench(world[0], tool[0], wrench) == core.DPT_OK)
check("exact, pressed in", (step.status, step.contact) == (core.DPT_STATUS_EXACT, core.DPT_CONTACT_PENETRATING))
check("500 N/m times 0.05 m, upward", is_near(wrench.force[2], 25) and is_near(wrench.force[0], 0))
settings = ffi.new("dpt_tool_settings *", {"size": ffi.sizeof("dpt_tool_settings"), "law": core.DPT_LAW_PROXY,
                                           "stiffness": 500})
check("a proxy", core.dpt_tool_set_settings(world[0], tool[0], settings) == core.DPT_OK)
for height in (1.2, 1.2, 1.05):
    pose.position[2] = height
    core.dpt_tool_set_pose(world[0], tool[0], pose)
    core.dpt_world_step(world[0], 0.001, ffi.NULL)
report, proxy = ffi.new("dpt_force_info *", {"size": ffi.sizeof("dpt_force_info")}), ffi.new("dpt_pose *")
check("its report", core.dpt_tool_get_force_info(world[0], tool[0], report) == core.DPT_OK)
check("its proxy", core.dpt_tool_get_proxy(world[0], tool[0], proxy) == core.DPT_OK)
check("held on the top", (report.reason, report.law) == (core.DPT_FORCE_ACTS, core.DPT_LAW_PROXY)
      and abs(proxy.position[2] - 1.1) < 1e-4)
code = core.dpt_tool_set_pose(world[0], tool[0], ffi.NULL)
check("no pose: an error with a sentence", code == core.DPT_E_ARGUMENT and b"NULL" in ffi.string(core.dpt_result_text(code)))
compiler.dpt_compiled_free(file)

print(f"{sum(verdicts)} passed, {len(verdicts) - sum(verdicts)} failed, 0 skipped")
sys.exit(not all(verdicts))
