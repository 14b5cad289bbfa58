#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The crates of Rust, for tests/languages/check.sh: sh tests/languages/rust/run.sh BUILD ROOM ROUNDS [ONLY].
#
# rustc compiles them, over the libraries that make has built, so that no crate of others and no network is needed. With
# RELEASE=yes also: the packages by cargo, over the single files; a link for a Cortex-M4; misuse under sanitizers.
set -u
build=$1 room=$2 rounds=$3
here=tests/languages/rust
crates=$build/rust/crates
edition='--edition 2021'
. tests/languages/blocks.sh
with='--cfg feature="alloc" --cfg feature="std" --cfg feature="compile"'
status=0

said() { # STATUS WHAT
    if [ "$1" -eq 0 ]; then echo "ok $2"; else echo "FAIL $2" && status=1; fi
}
skip() {
    echo "skip $*"
    status=1
}

for tool in rustc python3; do
    command -v $tool >/dev/null 2>&1 || { skip "the crates: no $tool" && exit 1; }
done
case $(rustc --version) in
"rustc 1."[0-9].* | "rustc 1."[1-7][0-9].* | "rustc 1.80."*) skip "the crates: $(rustc --version), not 1.81" && exit 1 ;;
esac
python3 -c 'import pycparser' 2>/dev/null || { skip "the crates: no pycparser (make deps light)" && exit 1; }
flock "$build/wasm.lock" make -s crate-sources B="$build" >&2
said $? "declarations from the headers, held to the list of layouts"
version=$(sed -n 's/^version = "\(.*\)"/\1/p' $here/../../../src/bindings/rust/dynpoint/Cargo.toml)
[ "$version" = "$(sed -n 's/^#define DPT_VERSION_STRING "\(.*\)"/\1/p' include/dynpoint/base.h)" ] &&
    [ "$(grep -c "\"=*$version\"" src/bindings/rust/dynpoint*/Cargo.toml | awk -F: '{ n += $2 } END { print n }')" = 3 ]
said $? "the crates' version is the library's"

# tests SOURCE WHAT OPTION...: the tests in a source
tests() {
    source=$1 what=$2
    shift 2
    # shellcheck disable=SC2086
    DYNPOINT_VERSION=$version rustc $edition -D warnings --test "$@" $here/$source.rs -o "$room/$source" >&2 &&
        MALLOC_PERTURB_=165 LD_PRELOAD=${preload:-} LD_LIBRARY_PATH=$build "$room/$source" >"$room/$source.log" 2>&1
    tested=$?
    said $tested "$what: $(sed -n 's/^test result: //p' "$room/$source.log" 2>/dev/null | tail -n 1)"
    [ $tested -eq 0 ] || cat "$room/$source.log" >&2
}
# crate FOLDER NAME OPTION...: into a folder
crate() {
    folder=$1 name=$2
    shift 2
    # shellcheck disable=SC2086
    rustc $edition -D warnings -O -L "$folder" --out-dir "$folder" --crate-type rlib --crate-name "$name" "$@" \
        "$crates/$(echo "$name" | tr _ -)/src/lib.rs" >&2
}
# shellcheck disable=SC2086
crate "$room" dynpoint_sys $with -L native="$build" -l static=dynpoint_compile -l static=dynpoint &&
    crate "$room" dynpoint $with --extern dynpoint_sys="$room/libdynpoint_sys.rlib"
said $? "dynpoint-sys and dynpoint compile without a warning"

uses="-L $room --extern dynpoint=$room/libdynpoint.rlib"
# shellcheck disable=SC2086
rustc $edition -D warnings -O $uses $here/touch.rs -o "$room/touch" >&2 && touched=$("$room/touch" "$rounds") &&
    echo "touch Rust $touched"
said $? "the ten seconds"

# shellcheck disable=SC2086
tests misuse misuse $uses

# What must not compile: its first line says for which error, and there is no other.
count=0
for wrong in $here/refused/*.rs; do
    wanted=$(sed -n '1s,^// \(E[0-9]*\):.*,\1,p' "$wrong")
    # shellcheck disable=SC2086
    rustc $edition --emit=metadata $uses --out-dir "$room" "$wrong" 2>"$room/wrong.log"
    seen=$(sed -n 's/^error\[\(E[0-9]*\)\].*/\1/p' "$room/wrong.log" | sort -u | tr '\n' ' ')
    if [ "$seen" != "$wanted " ]; then
        said 1 "$(basename "$wrong"): '$seen' instead of $wanted"
        cat "$room/wrong.log" >&2
    fi
    count=$((count + 1))
done
[ $count -ge 15 ]
said $? "$count programs do not compile, each for its reason"

if command -v rustdoc >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    rustdoc $edition --test --crate-name dynpoint $with $uses --extern dynpoint_sys="$room/libdynpoint_sys.rlib" \
        "$crates/dynpoint/src/lib.rs" >"$room/doc.log" 2>&1 && ! grep -q '^test result: ok. [0-3] passed' "$room/doc.log"
    said $? "examples of the documentation: $(sed -n 's/^test result: //p' "$room/doc.log" | tail -n 1)"
    [ $status -eq 0 ] || cat "$room/doc.log" >&2
else
    skip "examples of the documentation: no rustdoc"
fi
if command -v clippy-driver >/dev/null 2>&1; then
    # shellcheck disable=SC2086
    clippy-driver $edition -D warnings $with --emit=metadata --out-dir "$room/clippy" -L "$room" --crate-type rlib \
        --crate-name dynpoint --extern dynpoint_sys="$room/libdynpoint_sys.rlib" "$crates/dynpoint/src/lib.rs" >&2
    said $? "clippy"
else
    skip "clippy: no clippy-driver"
fi
if command -v rustfmt >/dev/null 2>&1; then
    # lib.rs names the file that is made.
    sources=$(ls src/bindings/rust/dynpoint-sys/build.rs src/bindings/rust/dynpoint/src/*.rs | grep -v /lib.rs)
    # shellcheck disable=SC2086
    rustfmt --check --config-path src/bindings/rust $sources $here/*.rs $here/refused/*.rs >&2
    said $? "rustfmt"
else
    skip "rustfmt: there is none"
fi

# Scenes and devices, which installed libraries have: those that make has built.
mkdir "$room/installed"
host="$with --cfg feature=\"installed\" --cfg feature=\"host\""
# shellcheck disable=SC2086
crate "$room/installed" dynpoint_sys $host -L native="$build" -l dylib=dynpoint_host -l dylib=dynpoint_drivers \
    -l dylib=dynpoint_compile -l dylib=dynpoint &&
    crate "$room/installed" dynpoint $host --extern dynpoint_sys="$room/installed/libdynpoint_sys.rlib"
said $? "with the host library they compile too"
tests host "scenes and devices" -L "$room/installed" -L native="$build" \
    --extern dynpoint="$room/installed/libdynpoint.rlib"

{
    echo 'use dynpoint::{Compiler, Felt, HostOptions, Pose, Segment, World, WorldDef, Wrench};'
    echo 'type End = Result<(), Box<dyn std::error::Error>>;'
    echo 'pub fn touch(pose: impl Fn() -> Pose, send: impl Fn(Wrench)) -> End {'
    block docs/rust.md rust 1 && echo '} pub fn scene() -> End {' && block docs/rust.md rust 2 &&
        echo 'drop(stats); Ok(()) }'
} >"$room/shown.rs"
# shellcheck disable=SC2086
rustc $edition --emit=metadata --crate-type rlib --out-dir "$room/installed" -L "$room/installed" \
    --extern dynpoint="$room/installed/libdynpoint.rlib" "$room/shown.rs" >&2
said $? "the page's blocks compile"

# Without std and alloc, on a bare target: Rust's linker names what is not there. Rust itself brings mem*.
target=thumbv7em-none-eabihf
linker=$(find "$(rustc --print sysroot)/lib/rustlib" -name rust-lld -type f 2>/dev/null | head -n 1)
if [ -d "$(rustc --print sysroot)/lib/rustlib/$target" ] && [ -n "$linker" ]; then
    mkdir "$room/bare" && (
        edition="$edition --target $target -C panic=abort"
        crate "$room/bare" dynpoint_sys &&
            crate "$room/bare" dynpoint --extern dynpoint_sys="$room/bare/libdynpoint_sys.rlib" &&
            rustc $edition -O -L "$room/bare" --extern dynpoint="$room/bare/libdynpoint.rlib" --crate-type staticlib \
                --out-dir "$room/bare" $here/bare.rs >&2
    ) && "$linker" -flavor gnu --gc-sections -e press_from_c --warn-unresolved-symbols "$room/bare/libbare.a" \
        -o "$room/bare/bare.elf" >"$room/bare/log" 2>&1 &&
        wanted=$(sed -n 's/.*undefined symbol: //p' "$room/bare/log" | sort -u) &&
        [ "$(echo "$wanted" | grep -c '^dpt_')" -ge 9 ] && ! echo "$wanted" | grep -v '^dpt_' >&2
    said $? "without std: a Cortex-M4 wants nothing but the library"
else
    skip "without std: no rustup target add $target"
fi
[ "${RELEASE:-no}" = no ] || . $here/release.sh
exit $status
