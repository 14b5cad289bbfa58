#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the built libraries promise: `sh tests/abi/check.sh BUILD`. Exported symbols are those of the list in
# the tree, which only grows; the core imports nothing but sqrt and mem*, and keeps no data; no multiply
# is fused with an add; headers stand alone; install and uninstall leave what they should.
set -u
build=$1
here=$(dirname "$0")
passed=0 failed=0 skipped=0
scratch=$build/abi
rm -rf "$scratch"
mkdir -p "$scratch"

ok() {
    echo "  ok   $1"
    passed=$((passed + 1))
}
bad() {
    echo "  FAIL $1"
    failed=$((failed + 1))
}
verdict() { if [ "$1" -eq 0 ]; then ok "$2"; else bad "$2"; fi; }

for lib in libdynpoint libdynpoint_compile; do
    nm -D --defined-only "$build/$lib.so.0" | awk '{ print $3 }' | LC_ALL=C sort >"$scratch/$lib.symbols"
    diff "$here/$lib.symbols" "$scratch/$lib.symbols"
    verdict $? "$lib exports what $here/$lib.symbols lists"
    nm -g --defined-only "$build/$lib.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$scratch/$lib.archive"
    diff "$here/$lib.symbols" "$scratch/$lib.archive"
    verdict $? "$lib.a shows no other name"
done

nm -u "$build/libdynpoint.o" | awk '{ print $2 }' | grep -vxE 'sqrt|mem(cpy|set|move|cmp)|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail' >"$scratch/imports"
[ ! -s "$scratch/imports" ]
verdict $? "the core imports sqrt and mem* only $(tr '\n' ' ' <"$scratch/imports")"

objdump -h "$build/libdynpoint.o" | awk '$2 ~ /^\.(data|bss)$/ && $3 != "00000000" { print $2 }' >"$scratch/data"
[ ! -s "$scratch/data" ]
verdict $? "the core keeps no data $(tr '\n' ' ' <"$scratch/data")"

objdump -d "$build/libdynpoint.o" | grep -cE '[[:space:]]v?(fn?m(add|sub)|fmadd|fmla)' >"$scratch/fused"
[ "$(cat "$scratch/fused")" -eq 0 ]
verdict $? "no multiply is fused with an add"

for header in include/dynpoint.h include/dynpoint/*.h; do
    name=${header#include/}
    echo "#include \"$name\"" >"$scratch/alone.c"
    ${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.c" || bad "$name alone in C99"
    if command -v g++ >/dev/null 2>&1; then
        cp "$scratch/alone.c" "$scratch/alone.cpp"
        g++ -std=c++11 -pedantic -Wall -Wextra -Werror -Iinclude -fsyntax-only "$scratch/alone.cpp" || bad "$name alone in C++11"
    fi
done
ok "headers compile alone"

root=$PWD/$scratch/root
make -s install DESTDIR="$root" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null
find "$root" -type f -o -type l | sed "s|^$root||" | LC_ALL=C sort >"$scratch/installed"
diff "$here/installed" "$scratch/installed"
verdict $? "install puts what $here/installed lists"
cat >"$scratch/user.c" <<'END'
#include <dynpoint.h>
#include <dynpoint/compile.h>
int main(void)
{
    const double vertices[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, ends[6] = { 0.2, 0.2, 1, 0.3, 0.3, 2 };
    const uint32_t corners[3] = { 0, 1, 2 };
    dpt_compiled file;
    const dpt_mesh *mesh;
    dpt_hit hit = DPT_HIT_INIT;
    if (dpt_compile_arrays(vertices, 3, corners, 1, NULL, &file, NULL) != DPT_OK ||
        dpt_mesh_open(file.bytes, file.size, &mesh) != DPT_OK ||
        dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL) != DPT_OK)
        return 1;
    return hit.distance - 1.0 <= hit.error_bound && 1.0 - hit.distance <= hit.error_bound ? 0 : 1;
}
END
if command -v pkg-config >/dev/null 2>&1; then
    export PKG_CONFIG_PATH="$root/opt/dp/lib64/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$root"
    flags=$(pkg-config --cflags --libs libdynpoint_compile libdynpoint)
    ${CC:-cc} -std=c99 "$scratch/user.c" $flags -o "$scratch/user" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/user"
    verdict $? "a program builds with the installed .pc and shared libraries"
    ${CC:-cc} -std=c99 "$scratch/user.c" -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_compile.a" \
        "$root/opt/dp/lib64/libdynpoint.a" -lm -o "$scratch/user" && "$scratch/user"
    verdict $? "and with the static ones"
else
    echo "  skip installed .pc: no pkg-config"
    skipped=$((skipped + 2))
fi
make -s uninstall DESTDIR="$root" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null 2>&1
[ -z "$(find "$root" -type f -o -type l)" ]
verdict $? "uninstall leaves nothing"

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
