#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The packages of C#, from the top of the tree: csharp_package.py VERSION FOLDER

FOLDER has nuget/Dynpoint.dll and .xml, generated/*.cs, and native/RID/ with a native library for each platform that there
is. It gets

    com.dynpoint.dynpoint/               the sources in the layout of a package of Unity, with a .meta beside each file
    com.dynpoint.dynpoint-VERSION.tgz    the same, for Unity's package manager
    Dynpoint.VERSION.nupkg               the assembly for NuGet, and the native libraries under runtimes/RID/native

Both say that they were not run in Unity or .NET. The same files give the same bytes.
"""
import glob
import gzip
import hashlib
import io
import os
import shutil
import sys
import tarfile
import zipfile

SOURCES, NAME = "src/bindings/csharp", "com.dynpoint.dynpoint"
NOT_RUN = "Not run in Unity or .NET: compiled and tested by Mono."
# Where Unity looks for a native library, and what its importer is told: platform, processor, and the editor's system.
PLUGINS = {
    "linux-x64": ("Linux/x86_64", "Linux64", "x86_64", "Linux"),
    "linux-arm64": ("Linux/ARM64", "LinuxArm64", "ARM64", None),
    "win-x64": ("Windows/x86_64", "Win64", "x86_64", "Windows"),
    "osx-x64": ("macOS/x86_64", "OSXUniversal", "x86_64", "OSX"),
    "osx-arm64": ("macOS/ARM64", "OSXUniversal", "ARM64", "OSX"),
}
PLUGIN = """PluginImporter:
  serializedVersion: 2
  isPreloaded: 0
  isOverridable: 1
  platformData:
  - first:
      Any: 
    second:
      enabled: 0
      settings: {{}}
  - first:
      Editor: Editor
    second:
      enabled: {editor}
      settings:
        CPU: {cpu}
        OS: {system}
  - first:
      Standalone: {platform}
    second:
      enabled: 1
      settings:
        CPU: {cpu}
"""
IMPORTERS = {".cs": "MonoImporter:\n  serializedVersion: 2\n", ".asmdef": "AssemblyDefinitionImporter:\n",
             ".md": "TextScriptImporter:\n", ".json": "PackageManifestImporter:\n"}


def meta(path, is_folder=False, plugin=None):
    """What Unity would write beside a file. The number stands for the file in scenes, so it goes by the path alone."""
    number = hashlib.md5(f"{NAME}/{path}".encode(), usedforsecurity=False).hexdigest()
    if plugin:
        _, platform, cpu, system = plugin
        importer = PLUGIN.format(editor=int(bool(system)), cpu=cpu, system=system or "AnyOS", platform=platform)
    else:
        importer = IMPORTERS.get(os.path.splitext(path)[1], "DefaultImporter:\n")
        importer = ("folderAsset: yes\n" if is_folder else "") + importer
    return f"fileFormatVersion: 2\nguid: {number}\n{importer}  userData: \n".encode()


def read(path):
    with open(path, "rb") as file:
        return file.read()


def natives(folder):
    for rid in sorted(os.listdir(f"{folder}/native")):
        for name in sorted(os.listdir(f"{folder}/native/{rid}")):
            yield rid, name, read(f"{folder}/native/{rid}/{name}")


def unity_files(version, folder):
    files = {"package.json": read(f"{SOURCES}/package.json").replace(b"VERSION", version.encode()),
             "README.md": read(f"{SOURCES}/README.md"), "LICENSE.md": read("LICENSE")}
    for name in os.listdir(f"{SOURCES}/Runtime"):
        files[f"Runtime/{name}"] = read(f"{SOURCES}/Runtime/{name}")
    for name in ("Enums.cs", "Native.cs", "Structs.cs"):
        files[f"Runtime/Generated/{name}"] = read(f"{folder}/generated/{name}")
    plugins = {}
    for rid, name, content in natives(folder):
        if rid in PLUGINS:
            path = f"Plugins/{PLUGINS[rid][0]}/{name}"
            files[path], plugins[path] = content, PLUGINS[rid]
    metas = {}
    for path in files:
        metas[f"{path}.meta"] = meta(path, plugin=plugins.get(path))
        while path := os.path.dirname(path):
            metas[f"{path}.meta"] = meta(path, is_folder=True)
    # Unity leaves a folder alone whose name ends so.
    for path in glob.glob(f"{SOURCES}/Samples~/*/*"):
        files[os.path.relpath(path, SOURCES)] = read(path)
    return files | metas


def write_unity(version, folder):
    files, target = unity_files(version, folder), f"{folder}/{NAME}"
    shutil.rmtree(target, ignore_errors=True)
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as tar:
        for path in sorted(files):
            os.makedirs(os.path.dirname(f"{target}/{path}"), exist_ok=True)
            with open(f"{target}/{path}", "wb") as file:
                file.write(files[path])
            entry = tarfile.TarInfo(f"package/{path}")
            entry.size, entry.mode = len(files[path]), 0o644
            tar.addfile(entry, io.BytesIO(files[path]))
    with open(f"{target}-{version}.tgz", "wb") as file:
        file.write(gzip.compress(packed.getvalue(), mtime=0))


def write_nuget(version, folder):
    about = f"What a line-shaped tool touches and feels of triangle meshes, for haptic loops of 1 kHz. {NOT_RUN}"
    files = {
        "_rels/.rels": '<?xml version="1.0" encoding="utf-8"?>\n<Relationships '
                       'xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
                       'Type="http://schemas.microsoft.com/packaging/2010/07/manifest" Target="/Dynpoint.nuspec" '
                       'Id="R1" /></Relationships>\n',
        "Dynpoint.nuspec": f"""<?xml version="1.0" encoding="utf-8"?>
<package xmlns="http://schemas.microsoft.com/packaging/2013/05/nuspec.xsd">
  <metadata>
    <id>Dynpoint</id>
    <version>{version}</version>
    <authors>dynpoint</authors>
    <description>{about}</description>
    <license type="expression">BSD-3-Clause</license>
    <readme>README.md</readme>
    <tags>haptics collision native</tags>
    <dependencies>
      <group targetFramework=".NETFramework4.5" />
      <group targetFramework=".NETStandard2.0" />
    </dependencies>
  </metadata>
</package>
""",
        "README.md": read(f"{SOURCES}/README.md"), "LICENSE": read("LICENSE"),
    }
    for framework in ("net45", "netstandard2.0"):
        for name in ("Dynpoint.dll", "Dynpoint.xml"):
            files[f"lib/{framework}/{name}"] = read(f"{folder}/nuget/{name}")
    for rid, name, content in natives(folder):
        files[f"runtimes/{rid}/native/{name}"] = content
    kinds = sorted({os.path.splitext(path)[1][1:] for path in files if "." in os.path.basename(path)} - {"rels"})
    types = "".join(f'<Default Extension="{kind}" ContentType="application/octet" />' for kind in kinds)
    files["[Content_Types].xml"] = ('<?xml version="1.0" encoding="utf-8"?>\n<Types '
                                    'xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default '
                                    'Extension="rels" ContentType='
                                    '"application/vnd.openxmlformats-package.relationships+xml" />'
                                    f'{types}<Override PartName="/LICENSE" ContentType="application/octet" /></Types>\n')
    with zipfile.ZipFile(f"{folder}/Dynpoint.{version}.nupkg", "w", zipfile.ZIP_DEFLATED) as nupkg:
        for path in sorted(files):
            nupkg.writestr(zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0)), files[path], zipfile.ZIP_DEFLATED)


def main():
    version, folder = sys.argv[1:]
    for old in glob.glob(f"{folder}/{NAME}-*.tgz") + glob.glob(f"{folder}/Dynpoint.*.nupkg"):
        os.remove(old)
    write_unity(version, folder)
    write_nuget(version, folder)
    print(f"{folder}/{NAME}-{version}.tgz, {folder}/Dynpoint.{version}.nupkg: not run in Unity or .NET")


main()
