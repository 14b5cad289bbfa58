# SPDX-License-Identifier: BSD-3-Clause
# C#: the package is made, and its sources, its tests and the scene are compiled by mcs and run by Mono (check.sh beside
# this folder calls it). RELEASE=yes runs them once more on a library with UBSan.
build=$1 room=$2 rounds=$3 here=tests/languages/csharp
. tests/languages/blocks.sh
for tool in mcs mono python3; do
    if ! command -v $tool >/dev/null; then
        echo "skip no $tool (make deps languages)"
        exit 0
    fi
done
case $(mcs --version) in
*" version "[0-5].*)
    echo "skip $(mcs --version), not 6 or later (make deps languages)"
    exit 0
    ;;
esac
if ! python3 -c 'import pycparser' 2>/dev/null; then
    echo "skip no pycparser, by which declarations are made (make deps languages)"
    exit 0
fi

program=$(cd "$build" && pwd)/dynpoint
said() { if [ "$1" -eq 0 ]; then echo "ok $2"; else echo "FAIL $2"; fi; }

# compile OUT ARGUMENTS...: without a warning
compile() {
    out=$1
    shift
    mcs -nologo -warnaserror -unsafe -out:"$out" "$@" >"$room/mcs" 2>&1
    said $? "mcs compiles $(basename "$out"): $(head -n 1 "$room/mcs")"
}

# mono_of NAME ARGUMENTS...: what a program says, and that it ended well
mono_of() {
    name=$1
    shift
    mono "$room/$name.exe" "$@" >"$room/$name" 2>"$room/$name.errors"
    status=$?
    grep '^ok \|^FAIL ' "$room/$name"
    [ $status -eq 0 ] || [ $status -eq 2 ] || echo "FAIL $name: status $status, $(head -n 1 "$room/$name.errors")"
}

flock "$build/wasm.lock" make -s csharp nupkg B="$build" >"$room/make" 2>&1
said $? "make csharp nupkg: $(tail -n 1 "$room/make")"
cp "$build/csharp/Dynpoint.dll" "$build/csharp/libdynpoint_all.so" "$room"
cat tests/abi/libdynpoint.symbols tests/abi/libdynpoint_compile.symbols tests/abi/libdynpoint_drivers.symbols \
    tests/abi/libdynpoint_host.symbols | sort >"$room/symbols"
nm -D --defined-only "$room/libdynpoint_all.so" | sed -n 's/.* T \(dpt_[a-z0-9_]*\).*/\1/p' | sort >"$room/exported"
[ -s "$room/symbols" ] && ! comm -23 "$room/symbols" "$room/exported" | grep -q . && ! nm -D --defined-only \
    "$room/libdynpoint_all.so" | grep ' T ' | grep -vq ' dpt_'
said $? "the native library has the functions of core, compiler, drivers and host, and no other names"
compile "$room/Touch.exe" -r:"$room/Dynpoint.dll" $here/Touch.cs
compile "$room/Tests.exe" -r:"$room/Dynpoint.dll" $here/Check.cs $here/Feel.cs $here/Misuse.cs $here/UnityFrames.cs \
    "$build/csharp/generated/Layouts.cs"
echo "touch C# $(mono "$room/Touch.exe" "$rounds")"
mono_of Tests tests/abi/layouts.txt

# The host library beside the program, on the same scene and device.
"$program" run liver --device 'sim:?hand=press' --ticks 3000 --json |
    sed 's/.*"contacts":\([0-9]*\),"penetrating":\([0-9]*\).*"strongest":\([0-9.e-]*\).*/scene \1 \2 \3/' >"$room/program"
sed -n '/^scene /p' "$room/Tests" | cat - "$room/program" | awk '
    { for (i = 2; i <= 4; i++) value[NR, i] = $i + 0 }
    END { for (i = 2; i <= 4; i++) same += value[1, i] > 0 && value[1, i] == value[2, i]
          exit !(NR == 2 && same == 3) }'
said $? "the scene is what the program feels: $(cat "$room/program")"

# The pages' blocks, and what the package's own feels of the liver that it is written for.
{
    echo 'using System; using Dynpoint; public static class Shown { public static Wrench last; static void Ten() {'
    block docs/csharp.md csharp 1 && echo '} static void Safe() {' && block docs/csharp.md csharp 2 &&
        echo '} static void Soft(World world) {' && block docs/csharp.md csharp 3 && echo '} static void Main() {' &&
        block src/bindings/csharp/README.md csharp 1 | sed '/^using Dynpoint;$/d' && echo '} }'
} >"$room/Shown.cs"
{
    echo 'using Dynpoint; using UnityEngine;'
    echo 'static class Shown { static void InUnity(Tool tool, Transform transform, MeshFilter meshFilter) {'
    block docs/csharp.md csharp 4 && echo '} }'
} >"$room/ShownInUnity.cs"
compile "$room/Shown.exe" -r:"$room/Dynpoint.dll" "$room/Shown.cs"
(cd "$room" && "$program" make liver -o liver.obj && mono Shown.exe) >"$room/shown" 2>&1
awk '/ N .* Nm, drawn at / { gsub(/[(),]/, ""); force = $2; ticks++; free += $1 == 0 && $2 == 0 && $3 == 0 }
     END { exit !(ticks == 1000 && free > 500 && force > 0.5) }' "$room/shown"
said $? "the package's own block feels a liver: $(tail -n 1 "$room/shown")"

# The packages: Unity's sources as they lie in it, and what is listed.
unity=$build/csharp/com.dynpoint.dynpoint
compile "$room/InUnity.exe" -d:UNITY_5_3_OR_NEWER -d:ENABLE_IL2CPP -nowarn:219,649 $here/UnityEngine.cs $here/InUnity.cs \
    "$room/ShownInUnity.cs" $(find "$unity" -name '*.cs')
mono_of InUnity
for file in $(find "$unity" -mindepth 1 ! -name '*.meta' ! -path '*~*'); do
    [ -s "$file.meta" ] || echo "$file"
done >"$room/bare"
[ ! -s "$room/bare" ] && [ -z "$(find "$unity" -name '*.meta' -exec sed -n 's/^guid: //p' {} + | sort | uniq -d)" ]
said $? "each file of Unity's package has a .meta, with a number of its own $(head -n 1 "$room/bare")"
python3 - "$build"/csharp/Dynpoint.*.nupkg "$build/csharp/libdynpoint_all.so" <<'END'
import sys, zipfile
from xml.etree import ElementTree
nupkg, library = zipfile.ZipFile(sys.argv[1]), open(sys.argv[2], "rb").read()
text = ElementTree.fromstring(nupkg.read("Dynpoint.nuspec")).findtext(".//{*}description")
natives = [name for name in nupkg.namelist() if name.startswith("runtimes/linux-")]
assert nupkg.testzip() is None and "Not run in Unity or .NET" in text and "lib/net45/Dynpoint.dll" in nupkg.namelist()
assert any(nupkg.read(name) == library for name in natives)
assembly = nupkg.read("lib/netstandard2.0/Dynpoint.dll")
assert b"AddDeformable" in assembly and b"ReadOnlySpan" not in assembly
END
said $? "the .nupkg has the assembly, without spans, the native library, and says what was not run"

# Away from its library.
mkdir "$room/alone"
cp "$room/Dynpoint.dll" "$room/Touch.exe" "$room/alone"
env -u LD_LIBRARY_PATH mono "$room/alone/Touch.exe" >"$room/alone/said" 2>&1
where="libdynpoint_all.so cannot be loaded. It is looked for beside this assembly, in $room/alone"
grep -q "DllNotFoundException: $where" "$room/alone/said"
said $? "without its library: $(grep -o 'DllNotFoundException.*' "$room/alone/said" | head -n 1)"

if [ "${RELEASE:-no}" = yes ]; then
    # Whatever is undefined ends the program.
    sh tests/languages/ubsan.sh >"$room/make" 2>&1
    said $? "a library with UBSan: $(tail -n 1 "$room/make")"
    rm "$room/libdynpoint_all.so"
    cp build/ubsan/csharp/native/*/libdynpoint_all.so "$room"
    echo "touch C#-on-UBSan $(mono "$room/Touch.exe")"
    mono_of Tests tests/abi/layouts.txt
    mono_of InUnity
fi
