# SPDX-License-Identifier: BSD-3-Clause
"""What a wheel for another system says and holds: look.py WHEEL.whl WHEEL_FOR [urdf]. The machine, the system and its oldest
version, the libraries that the extension and the program ask for, and that the extension shows its entrance alone, are
read out of the binaries themselves; abi3audit reads the symbols of Python's. A line for each check, as verdicts.py.
zig's linker for macOS leaves the library's public names to be seen as well: there they do not meet others' names."""

import io
import re
import struct
import sys
import zipfile
from pathlib import Path

import pefile
from elftools.elf.dynamic import DynamicSection
from elftools.elf.elffile import ELFFile

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "platforms"))
import macho  # noqa: E402

ENTRANCE = {"PyInit__dynpoint"}
ABI = Path(__file__).resolve().parent.parent / "abi"
PUBLIC = {name for path in ABI.glob("*.symbols") for name in path.read_text(encoding="utf-8").split()}
URDF = ("console-bridge", "expat", "libcxx", "tinyxml", "urdfdom", "urdfdom-headers")
WINDOWS = r"(kernel32|advapi32|bcrypt|ws2_32|shell32|api-ms-win-crt-[a-z0-9-]+)\.dll"


def look_elf(content):
    """(system and machine, libraries, symbols that are shown)"""
    elf = ELFFile(io.BytesIO(content))
    needed, shown = set(), set()
    for section in elf.iter_sections():
        if isinstance(section, DynamicSection):
            needed = {tag.needed for tag in section.iter_tags("DT_NEEDED")}
    table = elf.get_section_by_name(".dynsym")
    for symbol in table.iter_symbols() if table else ():
        if symbol["st_shndx"] != "SHN_UNDEF" and symbol["st_info"]["bind"] == "STB_GLOBAL":
            shown.add(symbol.name)
    return ("elf", {"EM_X86_64": "x86_64", "EM_AARCH64": "aarch64"}[elf["e_machine"]]), needed, shown


def look_pe(content):
    pe = pefile.PE(data=content)
    needed = {entry.dll.decode().lower() for entry in pe.DIRECTORY_ENTRY_IMPORT}
    shown = {item.name.decode() for item in pe.DIRECTORY_ENTRY_EXPORT.symbols} if hasattr(pe, "DIRECTORY_ENTRY_EXPORT") else set()
    return ("windows", {0x8664: "x86_64"}[pe.FILE_HEADER.Machine]), needed, shown


def look_macho(content):
    names, shown = macho.read(content)
    machine, oldest = macho.machine(content)
    return (f"macos {oldest[0]}.{oldest[1]}", machine), set(names[macho.LOAD]), shown


# By the name of a release's wheel: its tag, the extension's and the program's names, how they are read, of which system
# and with which libraries they are.
SYSTEMS = {
    "musl": ("musllinux_1_2_{}", "_dynpoint.abi3.so", "program", look_elf, "elf", r"libc\.so"),
    "windows": ("win_amd64", "_dynpoint.pyd", "program.exe", look_pe, "windows", WINDOWS),
    "macos": ("macosx_11_0_{}", "_dynpoint.abi3.so", "program", look_macho, "macos 11.0", r"/usr/lib/libSystem\.B\.dylib"),
}


def main(path, made_for, urdf=""):
    machine, system = made_for.split("-")
    tag, extension, program, look, kind, libraries = SYSTEMS[system]
    tag = tag.format("arm64" if (system, machine) == ("macos", "aarch64") else machine)
    failed = False

    def verdict(good, what):
        nonlocal failed
        failed = failed or not good
        print("ok" if good else "FAIL", f"{made_for}: {what}")

    with zipfile.ZipFile(path) as wheel:
        names = wheel.namelist()
        about = next(name for name in names if name.endswith(".dist-info/WHEEL"))
        tags = re.findall(r"^Tag: (.*)$", wheel.read(about).decode(), re.M)
        verdict(tags == [f"cp311-abi3-{tag}"] and Path(path).name.endswith(f"-cp311-abi3-{tag}.whl"), f"its tag is {tags}")
        binaries = sorted(name for name in names if re.search(r"\.(so|pyd|dll|exe|dylib)$|/program$", name))
        verdict(binaries == sorted(f"dynpoint/{name}" for name in (extension, program)), f"its binaries: {binaries}")
        terms = {name.rsplit("/LICENSE.", 1)[1] for name in names if "/LICENSE." in name}
        verdict(terms == {"jansson", *(URDF if urdf else ())}, f"the terms of what is in it are in it: {sorted(terms)}")
        mode = wheel.getinfo(f"dynpoint/{program}").external_attr >> 16
        verdict(system == "windows" or mode & 0o111 == 0o111, "its program may be executed")
        for name in (extension, program):
            found, needed, shown = look(wheel.read(f"dynpoint/{name}"))
            strange = {one for one in needed if not re.fullmatch(libraries, one)}
            if name == extension and system == "windows":
                verdict("python3.dll" in strange, f"{name} asks for the DLL of the limited API")
                strange -= {"python3.dll"}
            verdict(found == (kind, machine) and not strange, f"{name} is for {' '.join(found)} and asks for the system's "
                    f"{len(needed)} libraries alone{', and ' + str(sorted(strange)) if strange else ''}")
            if name == extension:
                strange = shown - ENTRANCE - (PUBLIC if system == "macos" else set())
                verdict(ENTRANCE <= shown and not strange, f"{name} shows {', '.join(sorted(ENTRANCE | strange))}"
                        f"{', and what is public of the library' if shown > ENTRANCE and not strange else ''}")
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
