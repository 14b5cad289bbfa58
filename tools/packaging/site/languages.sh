#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The APIs of other languages by their own tools, for the site: sh languages.sh BUILD MADE VERSION. C# and Java by Doxygen as
# XML, Rust by rustdoc, JavaScript by TypeDoc, Go by go doc, each below MADE. A tool that is not here leaves its language out,
# and says so; a warning is an error.
set -eu
build=$1 made=$2 version=$3
from=tools/packaging/site
unset MAKEFLAGS # of the make that runs this: rustc would look for its jobserver
rm -rf "$made"
mkdir -p "$made"

doxygen_xml() { # LANGUAGE PATTERN SOURCES
    { sed 's/^FILE_PATTERNS.*//; s/^OPTIMIZE_OUTPUT_FOR_C.*//; s/^TYPEDEF_HIDES_STRUCT.*//; s/^PREDEFINED.*//' "$from/Doxyfile"
        echo "INPUT = $3"
        echo "FILE_PATTERNS = $2"
        echo "OPTIMIZE_OUTPUT_JAVA = YES"
        echo "PREDEFINED = UNITY_5_3_OR_NEWER"
        echo "OUTPUT_DIRECTORY = $made/$1"; } | doxygen -
}
doxygen_xml csharp '*.cs' "src/bindings/csharp/Runtime $build/csharp/generated/Enums.cs $build/csharp/generated/Structs.cs"
doxygen_xml java '*.java' src/bindings/java/dynpoint

rust=
if command -v rustdoc >/dev/null 2>&1 && command -v rustc >/dev/null 2>&1; then
    case $(rustc --version) in
    "rustc 1."[0-9].* | "rustc 1."[1-7][0-9].* | "rustc 1.80."*) ;;
    *) rust=yes ;;
    esac
fi
if [ -n "$rust" ]; then
    crates=$build/rust/crates
    set -- --edition 2021 -D warnings --cfg 'feature="alloc"' --cfg 'feature="std"' --cfg 'feature="compile"' --cfg 'feature="host"'
    rustc "$@" --crate-type lib --emit metadata --crate-name dynpoint_sys --out-dir "$made" "$crates/dynpoint-sys/src/lib.rs"
    DYNPOINT_VERSION=$version rustdoc "$@" --crate-name dynpoint --crate-version "$version" \
        --extern dynpoint_sys="$made/libdynpoint_sys.rmeta" --out-dir "$made/rust" "$crates/dynpoint/src/lib.rs"
else
    echo "docs: no Rust: no rustdoc of Rust 1.81 or later"
fi

typedoc=build/typedoc/node_modules/typedoc/bin/typedoc
types=$build/npm/package/index.d.mts
if [ -e "$typedoc" ] && [ -e "$types" ]; then
    printf '{ "files": ["%s"], "compilerOptions": { "module": "nodenext", "target": "es2022", "types": [], "noEmit": true } }\n' \
        "$(cd "$(dirname "$types")" && pwd)/index.d.mts" >"$made/tsconfig.json"
    node "$typedoc" --tsconfig "$made/tsconfig.json" --entryPoints "$types" --out "$made/javascript" --name "dynpoint $version, JavaScript" \
        --readme none --disableGit --disableSources --hideGenerator --logLevel Warn --treatWarningsAsErrors
else
    echo "docs: no JavaScript: no TypeDoc (make deps docs) or no WebAssembly (make deps wasm)"
fi

if command -v go >/dev/null 2>&1; then
    (cd src/bindings/go && go doc -all .) >"$made/go.txt"
else
    echo "docs: no Go: no go"
fi
