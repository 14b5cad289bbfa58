#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The single files that `make amalgamation` writes, against the libraries of BUILD: `sh tests/amalgamation.sh BUILD`.
# They compile alone, with a compiler's plain flags; show the public names and no other; fuse nothing; answer the same
# bits; and refuse flags with which they could not. tests/cross.sh and tests/firmware/run.sh have other machines. CLANG
# names a clang.
set -u
. "$(dirname "$0")/lib/verdict.sh"
build=$1
scratch=$build/amalgamation-test
rm -rf "$scratch"
mkdir -p "$scratch"
log=$scratch/log
LC_ALL=C
export LC_ALL

command -v python3 >/dev/null 2>&1 || { skip "single files: no python3"; finish; }
cc=${CC:-cc}
clang=${CLANG:-clang}
strict="-std=c99 -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror"

# A library of nothing but names that collide, in files of their own and in one.
toy=$PWD/tests/amalgamation/toy
out=$PWD/$scratch/toy
mkdir -p "$out"
$cc $strict -DTOY_APART -I"$toy/include" -I"$toy/src" "$toy"/src/toy/*.c "$toy/../toy_main.c" -o "$out/apart" &&
    (cd "$toy" && python3 -B "$OLDPWD/tools/packaging/amalgamate.py" "$out" "dynpoint=$(ls src/toy/*.c | paste -sd, -)") &&
    $cc $strict -I"$out" "$out/dynpoint.c" "$toy/../toy_main.c" -o "$out/joined" &&
    "$out/apart" >"$out/apart.said" && "$out/joined" | cmp - "$out/apart.said" && [ -s "$out/apart.said" ]
verdict $? "names that collide are kept apart, and words in strings stay"
grep -qF 'words = "helper SQUARE LIMIT struct piece \" // helper";' "$out/dynpoint.c" &&
    grep -qF '/* helper, LIMIT, struct piece: words of a comment */' "$out/dynpoint.c"
verdict $? "and in comments"

make -s amalgamation B="$build" && mkdir "$scratch/alone" && cp "$build"/amalgamation/* "$scratch/alone"
verdict $? "make amalgamation"
cd "$scratch/alone" || exit 2
root=$(cd "$OLDPWD" && pwd)
case $build in /*) ;; *) build=$root/$build ;; esac
log=$root/$log
: >"$log"
for folder in $(sed -n 's/^FOLDERS := //p' "$root/Makefile"); do
    (cd "$root" && ls src/"$folder"/*.c 2>/dev/null)
done | sort >core
(cd "$root" && ls src/compile/*.c src/text/*.c) | sort >compile
sed -n 's|^/\* ==== \(src/[a-z0-9_/]*\.c\) ==== \*/$|\1|p' dynpoint.c | sort | cmp - core &&
    sed -n 's|^/\* ==== \(src/[a-z0-9_/]*\.c\) ==== \*/$|\1|p' dynpoint_compile.c | sort | cmp - compile
verdict $? "each source is in one of them, once"
parts=$(grep -c '^/\* ==== ' dynpoint.c) lines=$(grep -c 'SPDX-License-Identifier: BSD-3-Clause' dynpoint.c)
[ "$lines" -eq $((parts + 1)) ] && grep -q 'BSD 3-Clause' LICENSE &&
    ! grep -n '#include "' dynpoint.[ch] dynpoint_compile.[ch] | grep -v '#include "dynpoint\(_compile\)*\.h"$'
verdict $? "each part has its license's line, and nothing else of the tree is included"

$cc -std=gnu99 -O1 -ffp-contract=off -I"$root/include" -I"$root/tests" -c "$root/tests/bench/answers.c" -o answers.o &&
    $cc answers.o "$build/libdynpoint_compile.a" "$build/libdynpoint_drivers.a" "$build/libdynpoint.a" -lm -pthread -ldl \
        -o answers &&
    ./answers --worlds 10 2>met | cksum >answers.cksum && cat met
$cc -std=gnu99 -O1 -ffp-contract=off -Wall -Wextra -Werror -I. -c "$root/tests/amalgamation/answers_hash.c" -o hash.o &&
    $cc hash.o "$build/libdynpoint_compile.a" "$build/libdynpoint.a" -lm -pthread -o hash && ./hash 80 >hash.wanted &&
    awk '/^scene/ { c += $3; m += $5; t += $9; b += $13 } END { exit !(NR == 9 && c && m && t && b) }' hash.wanted
verdict $? "the libraries answer, and all kernels alike: meshes, contacts, sweeps, strips, budgets"

if [ -e "$build/scalar/libdynpoint.a" ]; then
    $cc hash.o "$build/scalar/libdynpoint_compile.a" "$build/scalar/libdynpoint.a" -lm -pthread -o hash && ./hash 80 | cmp - hash.wanted
    verdict $? "and so does a build without vectors (CONFIG=scalar)"
fi

# try NAME COMPILER AND FLAGS...: both files, what they show, and the same bits as the libraries'.
try() {
    name=$1
    shift
    begun=$(date +%s)
    "$@" -c dynpoint.c -o core.o >said 2>&1 && "$@" -c dynpoint_compile.c -o compile.o >>said 2>&1
    code=$?
    cat said >>"$log"
    [ $code -eq 0 ] && [ ! -s said ]
    verdict $? "$name: both compile without a word, $(($(date +%s) - begun)) s, see $log"
    [ $code -eq 0 ] || return
    nm -g --defined-only core.o | awk 'NF == 3 { print $3 }' | sort | diff "$root/tests/abi/libdynpoint.symbols" - &&
        nm -g --defined-only compile.o | awk 'NF == 3 { print $3 }' | sort | diff "$root/tests/abi/libdynpoint_compile.symbols" -
    verdict $? "$name: the public names are seen, and no other"
    # With plain flags, compilers for aarch64 call a helper of their own for an atomic exchange.
    nm -u core.o | awk '{ print $2 }' | grep -vxE \
        'sqrtf?|floor|mem(cpy|set|move|cmp)|bcmp|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail|__aarch64_swp4_acq_rel' >imports
    [ ! -s imports ]
    verdict $? "$name: the core imports sqrt, floor and mem* only $(tr '\n' ' ' <imports)"
    objdump -h core.o | awk '$2 ~ /^\.(t?data|t?bss|init_array|ctors)/ && $2 !~ /^\.data\.rel\.ro/ &&
        $3 != "00000000" { print $2 }' >data
    [ ! -s data ]
    verdict $? "$name: the core keeps no data $(tr '\n' ' ' <data)"
    [ "$(objdump -d core.o compile.o | grep -cE '[[:space:]](v?fn?m(add|sub|l[as])|vfn?m[as]\.)')" -eq 0 ]
    verdict $? "$name: no multiply is fused with an add"
    if [ "$(uname -m)" = x86_64 ]; then
        objdump -d --no-show-raw-insn core.o | awk '/^[0-9a-f]+ </ { in_it = /_kernel_avx(2|512)_/ } in_it && /sqrtps .*%[yz]mm/ { n++ }
            END { exit n < 8 }'
        verdict $? "$name: the kernels are made of vectors"
    fi
    $cc answers.o compile.o "$build/libdynpoint_drivers.a" core.o -lm -pthread -ldl -o other &&
        ./other --worlds 10 2>other.met | cksum | cmp - answers.cksum && cmp met other.met &&
        $cc hash.o compile.o core.o -lm -pthread -o other && ./other 80 | cmp - hash.wanted
    verdict $? "$name: the same bits as the libraries'"
}

# COMPILERS=two: the one of this build with plain flags, and the other one with what the machine has.
warnings="-Wall -Wextra -Wshadow -Wconversion"
compilers=${COMPILERS:-all}
try "$cc -O2" $cc -O2 $warnings
if [ "$compilers" = two ]; then
    cp compile.o native_compile.o
    cp core.o native_core.o
elif echo 'int x;' | $cc -march=native -x c -c - -o native.o 2>/dev/null; then
    try "$cc -O3 -march=native" $cc -O3 -march=native
    cp compile.o native_compile.o
    cp core.o native_core.o
else
    skip "single files with -march=native: $cc does not have it"
    cp compile.o native_compile.o
    cp core.o native_core.o
fi
# As C++ too, in a project that knows no other language. Two numbers whose type the headers of C++ change are looked at
# by the bits of all answers.
cxx=${CXX:-g++}
if command -v "$cxx" >/dev/null 2>&1; then
    optimize=-O2
    [ "$compilers" != two ] || optimize=-O1 # compiled sooner, and as good a witness of what C++ makes of the types
    try "$cxx -x c++ $optimize" "$cxx" -x c++ -std=c++17 $optimize -Wall
    for dialect in gnu++11 c++20; do
        "$cxx" -x c++ -std=$dialect -Wall -Wextra -Werror -fsyntax-only dynpoint.c &&
            "$cxx" -x c++ -std=$dialect -Wall -Wextra -Werror -fsyntax-only dynpoint_compile.c
        verdict $? "both are $dialect"
    done
else
    skip "single files as C++: no C++ compiler"
fi
if ! command -v "$clang++" >/dev/null 2>&1; then
    skip "single files as C++ with clang: no $clang++"
elif [ "$compilers" = two ]; then
    "$clang++" -x c++ -std=c++17 -Wall -Werror -fsyntax-only dynpoint.c &&
        "$clang++" -x c++ -std=c++17 -Wall -Werror -fsyntax-only dynpoint_compile.c
    verdict $? "clang++ takes both without a word"
else
    try "$clang++ -x c++ -O2" "$clang++" -x c++ -std=c++17 -O2 -Wall
fi
$cc $strict -fsyntax-only dynpoint.c && $cc $strict -fsyntax-only dynpoint_compile.c
verdict $? "both are pedantic C99"
if command -v "$clang" >/dev/null 2>&1; then
    [ "$compilers" = two ] || try "clang -O2" "$clang" -O2 $warnings
    try "clang -O3 -march=native" "$clang" -O3 -march=native
else
    skip "single files with clang: no $clang"
fi

# The compiler's bytes, of every reader.
cat >file.c <<'END'
#include <stdio.h>
#include "dynpoint_compile.h"
int main(int argc, char **argv)
{
    dpt_compiled file;
    const dpt_compile_def def = { .size = sizeof def, .threads = 2 };
    FILE *out = argc == 3 ? fopen(argv[2], "wb") : NULL;
    return !out || dpt_compile_file(argv[1], &def, &file, NULL) ||
           fwrite(file.bytes, 1, file.size, out) != file.size || fclose(out);
}
END
$cc -I. file.c native_compile.o native_core.o -lm -pthread -o file || bad "a program with both files"
wrong=0 count=0
for shape in "torus 5568 ply" "liver 2000 obj" "stomach 2001 stl" "cloth 2048 off" "hub 300 ply"; do
    set -- $shape
    "$build/dynpoint" make "$1" "$2" -o "mesh.$3" >/dev/null &&
        "$build/dynpoint" compile "mesh.$3" -o wanted.dpa >/dev/null &&
        ./file "mesh.$3" made.dpa && cmp made.dpa wanted.dpa && count=$((count + 1)) || wrong=1
done
[ $wrong -eq 0 ] && [ $count -eq 5 ]
verdict $? "the compiler writes the same bytes: $count meshes, from ply, obj, stl and off"

# refused COMPILER AND FLAGS...: both files, in our words.
refused() {
    for file in dynpoint dynpoint_compile; do
        ! "$@" -E $file.c -o refused.i 2>said && grep -q 'error: .*"dynpoint needs ' said || return 1
    done
}
for flags in -ffast-math -Ofast -ffinite-math-only; do
    refused $cc -O2 $flags
    verdict $? "$flags is refused"
    ! command -v "$clang" >/dev/null 2>&1 || { refused "$clang" -O2 $flags; verdict $? "$flags is refused by clang"; }
done
if $cc --version | grep -qi 'gcc\|Free Software Foundation'; then
    for flags in -funsafe-math-optimizations -fno-signed-zeros -freciprocal-math \
        "-fassociative-math -fno-signed-zeros -fno-trapping-math"; do
        refused $cc -O2 $flags
        verdict $? "$flags is refused"
    done
    sed 's/"fp-contract=off"/"nonesuch-option"/' dynpoint.c >unknown.c
    cmp -s dynpoint.c unknown.c || ! $cc -O2 -fsyntax-only unknown.c 2>said
    verdict $? "a compiler that does not know the option stops"
fi
if [ "$(uname -m)" = x86_64 ]; then
    refused $cc -O2 -mfpmath=387
    verdict $? "excess precision (-mfpmath=387) is refused"
fi
wc -lc dynpoint.c dynpoint.h dynpoint_compile.c dynpoint_compile.h | sed 's/^/  /'
finish
