# SPDX-License-Identifier: BSD-3-Clause
# What takes long of run.sh, which reads this in: misuse over sanitized libraries, a whole program for a Cortex-M4, and
# the packages as users get them.

make -s CONFIG=sanitize build/sanitize/libdynpoint.a build/sanitize/libdynpoint_compile.a >&2
mkdir "$room/sanitized"
# shellcheck disable=SC2086
crate "$room/sanitized" dynpoint_sys $with -L native=build/sanitize -l static=dynpoint_compile -l static=dynpoint &&
    crate "$room/sanitized" dynpoint $with --extern dynpoint_sys="$room/sanitized/libdynpoint_sys.rlib"
said $? "the crates over sanitized libraries"
# The run-time library of ASan must be the first.
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 ASAN_OPTIONS=allocator_may_return_null=1
# Words of a compiler behind ccache.
# shellcheck disable=SC2086
preload=$(${CC:-cc} -print-file-name=libasan.so)
tests misuse "misuse, with ASan and UBSan in C" -L "$room/sanitized" \
    --extern dynpoint="$room/sanitized/libdynpoint.rlib" -C linker=cc -C link-arg=-lasan -C link-arg=-lubsan
preload=

if [ -d "$room/bare" ] && command -v arm-none-eabi-gcc >/dev/null 2>&1; then
    arm-none-eabi-gcc -mcpu=cortex-m4 -mfpu=fpv4-sp-d16 -mfloat-abi=hard -mthumb -O1 -c "$build/amalgamation/dynpoint.c" \
        -o "$room/bare/dynpoint.o" >&2 &&
        "$linker" -flavor gnu --gc-sections -e press_from_c "$room/bare/dynpoint.o" "$room/bare/libbare.a" \
            -o "$room/bare/whole.elf" >&2
    said $? "without std: with the single file a Cortex-M4 wants nothing at all"
else
    skip "a whole program for a Cortex-M4: no arm-none-eabi-gcc (make deps firmware)"
fi

# cargo takes `cc` from where it was fetched once: no network is needed.
export CARGO_TARGET_DIR="$room/target"
if command -v cargo >/dev/null 2>&1 && (cd "$crates" && cargo fetch --quiet --offline) >&2; then
    make -s crate B="$build" RUST_TARGET="$room/target" CARGO_FLAGS=--offline >&2
    said $? "cargo package: both crates are packed, and compile from what is packed"
    mkdir "$room/packed" "$room/user" "$room/user/src"
    for packed in "$room"/target/package/*.crate; do tar -xzf "$packed" -C "$room/packed" || said 1 "$packed"; done
    for file in "sys-$version/c/dynpoint.c" "sys-$version/c/dynpoint_compile.h" "sys-$version/src/abi.rs" \
        "$version/src/plain.rs" "$version/LICENSE" "sys-$version/LICENSE" "$version/README.md"; do
        [ -s "$room/packed/dynpoint-$file" ] || said 1 "a package has no $file"
    done
    ! grep -rlF -e "$PWD" -e "${HOME:-$PWD}/" "$room/packed" >&2
    said $? "packages know no path of this machine"
    cp $here/touch.rs "$room/user/src/main.rs"
    cat >"$room/user/Cargo.toml" <<END
[package]
name = "user"
version = "0.1.0"
edition = "2021"
[dependencies]
dynpoint = { path = "../packed/dynpoint-$version" }
[patch.crates-io]
dynpoint-sys = { path = "../packed/dynpoint-sys-$version" }
[workspace]
END
    user=$(cd "$room/user" && cargo run --quiet --release --offline 2>"$room/user.log")
    [ "$(echo "$user" | cut -d' ' -f 1,2)" = "$(echo "$touched" | cut -d' ' -f 1,2)" ] || cat "$room/user.log" >&2
    said $? "a user's project over the packages has the same wrenches: ${user-}"
    libraries=$(cd "$build" && pwd)
    user=$(cd "$room/user" && DYNPOINT_LIB_DIR=$libraries LD_LIBRARY_PATH=$libraries cargo run --quiet --release \
        --offline --features dynpoint/host 2>"$room/user.log")
    [ "$(echo "$user" | cut -d' ' -f 1,2)" = "$(echo "$touched" | cut -d' ' -f 1,2)" ] || cat "$room/user.log" >&2
    said $? "likewise over installed libraries: ${user-}"
    (cd "$crates" && RUSTDOCFLAGS='-D warnings' cargo doc --quiet --no-deps --offline) >&2
    said $? "cargo doc has no warning"
    (cd "$crates" && cargo clippy --quiet --workspace --offline -- -D warnings) >&2
    said $? "cargo clippy of both crates"
else
    skip "packages of cargo: no cargo, or it has not fetched cc (cargo fetch in build/rust/crates)"
fi
