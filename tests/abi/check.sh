#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What the built libraries promise: `sh tests/abi/check.sh BUILD`. Exported symbols are those of the list in
# the tree, which only grows; the core imports nothing but sqrt and mem*, and keeps no data; no multiply
# is fused with an add; headers stand alone; structs and constants are what layouts.txt says, on machines
# that are not here too; the sources are C99; install and uninstall leave what they should; the sample runs.
set -u
build=$1
here=$(dirname "$0")
. "$here/../lib/verdict.sh"
scratch=$build/abi
rm -rf "$scratch"
mkdir -p "$scratch"

LC_ALL=C sort "$here"/*.symbols >"$scratch/all.symbols"
urdf=
[ ! -e "$build/libdynpoint_urdf.a" ] || urdf=libdynpoint_urdf
convex=
[ ! -e "$build/libdynpoint_convex.a" ] || convex=libdynpoint_convex
for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host $urdf $convex; do
    nm -D --with-symbol-versions --defined-only "$build/$lib.so.1" >"$scratch/$lib.versions"
    awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' "$scratch/$lib.versions" | LC_ALL=C sort >"$scratch/$lib.symbols"
    diff "$here/$lib.symbols" "$scratch/$lib.symbols"
    verdict $? "$lib exports what $here/$lib.symbols lists"
    ! grep -v ' A ' "$scratch/$lib.versions" | grep -qv '@@DYNPOINT_0_3$'
    verdict $? "each under the version DYNPOINT_0_3"
    nm -g --defined-only "$build/$lib.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$scratch/$lib.archive"
    diff "$here/$lib.symbols" "$scratch/$lib.archive"
    verdict $? "$lib.a shows no other name"
done

# A program that was linked to 0.1 or 0.2 is refused before it runs: its soname is another, and so are its symbols' versions,
# should someone give our library that name.
mkdir "$scratch/old" "$scratch/renamed"
ln -s "$(cd "$build" && pwd)/libdynpoint.so.1" "$scratch/renamed/libdynpoint.so.0"
echo 'const char *dpt_version(void); int main(void) { return dpt_version()[0] != 48; }' >"$scratch/linked.c"
echo 'const char *dpt_version(void) { return "0.2.0"; }' >"$scratch/old.c"
for version in DYNPOINT_0 DYNPOINT_0_2; do
    echo "$version { global: dpt_*; local: *; };" >"$scratch/old.map"
    ${CC:-cc} -shared -fPIC "$scratch/old.c" -Wl,--version-script="$scratch/old.map" -Wl,-soname,libdynpoint.so.0 \
        -o "$scratch/old/libdynpoint.so.0" &&
        ${CC:-cc} "$scratch/linked.c" "$scratch/old/libdynpoint.so.0" -o "$scratch/linked" &&
        LD_LIBRARY_PATH="$scratch/old" "$scratch/linked" &&
        ! LD_LIBRARY_PATH="$build" "$scratch/linked" 2>"$scratch/refused" && grep -q 'libdynpoint.so.0' "$scratch/refused" &&
        ! LD_LIBRARY_PATH="$scratch/renamed" "$scratch/linked" 2>"$scratch/refused" && grep -q "$version" "$scratch/refused"
    verdict $? "a program linked to a library of $version is refused when it is loaded"
done

# What the libraries of 0.3 had: functions, the types of their arguments, structs and enums. All of it is still there; more
# may be. Of a report of abidiff, lines on sizes and on what was inserted are no loss; anything else that changed is.
losses() {
    abidiff --harmless --leaf-changes-only --no-added-syms "$1" "$2" >"$scratch/abidiff.report"
    [ $(($? & 3)) -eq 0 ] || return 1
    grep -vE "summary:|size changed from|^'(struct|enum|union) .*' changed:\$|^ *[0-9]+ (data member|enumerator) (insertion|change)s?:?\$" "$scratch/abidiff.report" |
        grep -E 'emoved|[1-9][0-9]* .*deletion|changed|ELF SONAME|eleted'
    [ $? -eq 1 ]
}
if [ "${RELEASE:-yes}" = no ]; then
    : # before a release: it compiles all libraries once more
elif ! command -v abidiff >/dev/null 2>&1 || ! command -v abidw >/dev/null 2>&1; then
    skip "types of arguments as in 0.3: no abidiff (Debian: abigail-tools)"
elif [ "$(uname -m)" != x86_64 ]; then
    skip "types of arguments as in 0.3: the descriptions are of x86-64"
elif ! sh "$here/describe.sh" "$scratch/described" "$scratch/abi" libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host $urdf $convex; then
    verdict 1 "the libraries are described"
else
    for lib in libdynpoint libdynpoint_compile libdynpoint_drivers libdynpoint_host $urdf $convex; do
        losses "$here/$lib.abi" "$scratch/abi/$lib.abi"
        verdict $? "$lib has all functions and types that 0.3 had"
    done
    stored=$here/libdynpoint.abi
    sed "s/dpt_world_reset/dpt_world_forget/" "$stored" >"$scratch/removed.abi"
    ! losses "$scratch/removed.abi" "$scratch/abi/libdynpoint.abi" >/dev/null
    verdict $? "a function that is gone would be found"
    sed "s/<var-decl name='gap'/<var-decl name='clearance'/" "$stored" >"$scratch/renamed.abi"
    ! losses "$scratch/renamed.abi" "$scratch/abi/libdynpoint.abi" >/dev/null
    verdict $? "a field that has another name, too"
    torque=$(sed -n "/^<class-decl name='dpt_wrench'/,/^<.class-decl/p" "$stored" | sed -n "s/.*<var-decl name='torque' type-id='\([^']*\)'.*/\1/p")
    sed "/^<class-decl name='dpt_wrench'/,/^<.class-decl/s/name='torque' type-id='$torque'/name='torque' type-id='$(sed -n "s/^<type-decl name='double'.* id='\([^']*\)'.*/\1/p" "$stored")'/" \
        "$stored" >"$scratch/retyped.abi"
    ! cmp -s "$stored" "$scratch/retyped.abi" && ! losses "$scratch/retyped.abi" "$scratch/abi/libdynpoint.abi" >/dev/null
    verdict $? "and one of another type"
    # As if the last field of dpt_step, and its second flag of a snapshot, had been added since.
    awk '/^<class-decl name=.dpt_step. / { sub(/size-in-bits=.256./, "size-in-bits='\''224'\''"); inside = 1 }
        inside && /<data-member/ { held = $0; next }
        inside && held != "" && /<var-decl name=.flags./ { skipping = 1; held = ""; next }
        skipping && /<.data-member/ { skipping = 0; next }
        held != "" { print held; held = "" }
        /<.class-decl/ { inside = 0 }
        { print }' "$stored" >"$scratch/shorter.abi"
    ! cmp -s "$stored" "$scratch/shorter.abi" && losses "$scratch/shorter.abi" "$scratch/abi/libdynpoint.abi"
    verdict $? "a field at the end of a struct may be added"
fi

# An archive of -flto has its names local only when a program is linked: what crosses files within the core says whose it is.
lto=$scratch/lto
if [ "${RELEASE:-yes}" = no ]; then
    : # likewise
elif command -v gcc-nm >/dev/null 2>&1 && ${CC:-cc} --version | grep -qi 'gcc\|Free Software Foundation'; then
    make -s B="$lto" CFLAGS='-O1 -flto' "$lto/libdynpoint.a" &&
        gcc-nm -g --defined-only "$lto/libdynpoint.a" | awk 'NF == 3 { print $3 }' | LC_ALL=C sort >"$scratch/lto.symbols" &&
        grep '^dpt_' "$scratch/lto.symbols" | diff "$here/libdynpoint.symbols" - &&
        grep -q '^dpti_' "$scratch/lto.symbols" && ! grep -v '^dpti\{0,1\}_' "$scratch/lto.symbols"
    verdict $? "libdynpoint.a of -flto shows dpt_ and dpti_ alone"
else
    skip "libdynpoint.a of -flto: no gcc-nm, or another compiler"
fi

nm -u "$build/libdynpoint.o" | awk '{ print $2 }' | grep -vxE 'sqrt|mem(cpy|set|move|cmp)|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail' >"$scratch/imports"
[ ! -s "$scratch/imports" ]
verdict $? "the core imports sqrt and mem* only $(tr '\n' ' ' <"$scratch/imports")"

# Threads are started in one place of the compiler; what it starts it joins.
nm -u "$build/libdynpoint_compile.o" | awk '$2 ~ /^(pthread|thrd|mtx|sem)_/ { print $2 }' | LC_ALL=C sort >"$scratch/threads"
[ "$(tr '\n' ' ' <"$scratch/threads")" = "pthread_create pthread_join " ]
verdict $? "the compiler makes and joins threads, and locks nothing $(tr '\n' ' ' <"$scratch/threads")"

# C++ stays behind its wall, and prints nothing.
if [ -n "$urdf" ]; then
    nm -uC "$build/libdynpoint_urdf.o" | grep -E 'std::(cout|cerr|clog)|[ _](printf|fprintf|puts|fputs|fwrite|putchar|perror|abort|exit)(_chk)?$' >"$scratch/prints"
    [ ! -s "$scratch/prints" ]
    verdict $? "the reader of robots' descriptions prints nothing $(tr '\n' ' ' <"$scratch/prints")"
fi

# Also a pointer that is set at the start, a thread's own variable, and code that runs before main.
objdump -h "$build/libdynpoint.o" | awk '$2 ~ /^\.(t?data|t?bss|init_array|ctors)/ && $2 !~ /^\.data\.rel\.ro/ &&
    $3 != "00000000" { print $2 }' >"$scratch/data"
[ ! -s "$scratch/data" ]
verdict $? "the core keeps no data $(tr '\n' ' ' <"$scratch/data")"

objdump -d "$build/libdynpoint.o" "$build/libdynpoint_drivers.o" | grep -cE '[[:space:]](v?fn?m(add|sub|l[as])|vfn?m[as]\.)' >"$scratch/fused"
[ "$(cat "$scratch/fused")" -eq 0 ]
verdict $? "no multiply is fused with an add, nor in the drivers"

# The exchange between two threads is one instruction, in two functions.
objdump -d "$build/libdynpoint.o" | awk '/^[0-9a-f]+ <.*>:$/ { exchanges = $2 ~ /^<dpt_latest_(publish|take)>:$/ } !exchanges' |
    grep -cE '[[:space:]](lock|[lsm]fence|pause|rdtscp?|syscall|sysenter|int)([[:space:]]|$)|xchg.*\(|[[:space:]](ld(a?xr|a?xp|add|set|clr|eor)|stl?x[rp]|cas|swp|svc|wfe)' >"$scratch/locks"
[ "$(cat "$scratch/locks")" -eq 0 ]
verdict $? "no lock, no fence, no clock and no system call in the core's code, but for dpt_latest's exchange"

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
lacking=$(grep -Li 'thread' include/dynpoint/[!t]*.h)
[ -z "$lacking" ] || printf '  %s\n' $lacking
[ -z "$lacking" ]
verdict $? "each header says which threads may call it (types.h has no functions)"
# The initialisers as well, where a missing field is a warning.
initialisers='#include <dynpoint.h>
int main(void) { dpt_hit hit = DPT_HIT_INIT; dpt_pose pose = DPT_POSE_IDENTITY;
    return !(hit.size == sizeof hit && hit.work == 0 && hit.lower_bound == 0 && pose.orientation[0] == 1); }'
echo "$initialisers" | ${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -Iinclude -x c - -o "$scratch/initial" && "$scratch/initial"
verdict $? "initialisers in C99"
if command -v g++ >/dev/null 2>&1; then
    echo "$initialisers" | g++ -std=c++11 -pedantic -Wall -Wextra -Wconversion -Wold-style-cast -Werror -Iinclude -x c++ - -o "$scratch/initial" && "$scratch/initial"
    verdict $? "and in C++11"
fi

c99="-std=c99 -pedantic -Wall -Wextra -Werror"
${CC:-cc} $c99 -Iinclude "$here/layout.c" -o "$scratch/layout" && "$scratch/layout"
verdict $? "structs and constants are what $here/layouts.txt says, on this machine"
# The declarations for other languages: those that a library exports, without a preprocessor's help (tests/ffi/cdef.py has
# more, where cffi is).
cdef=$build/include/dynpoint_cdef.h
{ echo '#include <stddef.h>'; echo '#include <stdint.h>'; cat "$cdef"; } >"$scratch/cdef.c"
${CC:-cc} $c99 -fsyntax-only "$scratch/cdef.c" && ! grep -nE '^ *#|__attribute__|DPT_API|inline' "$cdef" &&
    ${CC:-cc} $c99 -DDPT_CDEF -I"$build/include" "$here/layout.c" -o "$scratch/layout_cdef" && "$scratch/layout_cdef"
verdict $? "$cdef is plain C99, with the structs and constants of $here/layouts.txt"
sed -n 's/^[^ ].*[ *]\(dpt_[a-z0-9_]*\)(.*;$/\1/p' "$cdef" | grep -v '_fn$' | LC_ALL=C sort | diff - "$scratch/all.symbols"
verdict $? "it declares what the lists of symbols have, and nothing else"
# The declarations of other languages are made from this model.
if python3 -c 'import pycparser' 2>/dev/null; then
    python3 -B tools/packaging/abi_model.py "$cdef" >"$scratch/abi.json" &&
        python3 -B "$here/model.py" "$scratch/abi.json" "$here/layouts.txt" "$here"/*.symbols
    verdict $? "its model for other languages has these functions, and the structs and constants of $here/layouts.txt"
else
    skip "the model for other languages: no pycparser (Debian: python3-pycparser)"
fi
# What the list does not name: a field shows as a gap in its struct, the rest in the preprocessed headers.
for header in include/dynpoint/*.h; do
    echo "#include <dynpoint/$(basename "$header")>"
done | ${CC:-cc} -E -P -Iinclude - >"$scratch/public.h"
grep -oE 'DPT_[A-Z0-9_]+|struct dpt_[a-z0-9_]+ \{' "$scratch/public.h" | sed 's/^struct //; s/ {$//' |
    LC_ALL=C sort -u >"$scratch/public"
sed -n 's/^VALUE(\([^,]*\),.*/\1/p; s/^STRUCT(\(.*\))/\1/p' "$here/layouts.txt" | LC_ALL=C sort -u >"$scratch/listed"
diff "$scratch/listed" "$scratch/public"
verdict $? "it names every public struct and constant"
# Those that begin with their size are in a table of tests/lib/size_checks.h; but for what the library hands to callbacks.
awk '/^typedef struct dpt_[a-z_]+ {$|^struct dpt_[a-z_]+ {$/ { sub(/ {$/, ""); sub(/.* /, ""); name = $0; next }
    name != "" && /^ *uint32_t size;/ { print name } { name = "" }' "$scratch/public.h" >"$scratch/sized"
for name in $(grep -vxE 'dpt_loop_sample|dpt_selftest_line|dpt_identify_progress|dpt_driver' "$scratch/sized"); do
    grep -rqE "\"(its )?$name[ \"]" tests/arm tests/base tests/compile tests/convex tests/deform tests/drivers tests/host tests/hull tests/insertion tests/proxy tests/urdf tests/world || echo "  $name"
done >"$scratch/unasked"
cat "$scratch/unasked"
[ "$(wc -l <"$scratch/sized")" -gt 30 ] && [ ! -s "$scratch/unasked" ]
verdict $? "each struct that begins with its size is asked for older and newer callers"
# An enum's names begin alike, and no name of another enum so, but for bits of flags, DPT_..._FLAG_.
tr '\n' ' ' <"$scratch/public.h" | grep -oE 'enum \{[^}]*\}' | grep -v DPT_OK | awk '
    function common(a, b,   i) { for (i = 1; i <= length(a) && substr(a, i, 1) == substr(b, i, 1); i++) {} return substr(a, 1, i - 1) }
    { rest = $0; count = 0
      while (match(rest, /DPT_[A-Z0-9_]+/)) {
          name = substr(rest, RSTART, RLENGTH); rest = substr(rest, RSTART + RLENGTH)
          owner[name] = NR; all = count++ ? common(all, name) : name }
      if (count == 1) sub(/[^_]*$/, "", all)
      sub(/[^_]*$/, "", all); prefix[NR] = all }
    END { for (e in prefix) for (name in owner)
              if (owner[name] != e && index(name, prefix[e]) == 1 && substr(name, length(prefix[e]) + 1) !~ /^FLAG_/) {
                  print "  " name " begins as the names of another enum, " prefix[e]; bad = 1 }
          exit bad }'
verdict $? "enums share no prefix"
for machine in aarch64-linux-gnu arm-linux-gnueabihf s390x-linux-gnu; do
    if command -v "$machine-gcc" >/dev/null 2>&1; then
        "$machine-gcc" $c99 -Iinclude -ffreestanding -fsyntax-only "$here/layout.c"
        verdict $? "and for $machine"
    else
        skip "layouts for $machine: no $machine-gcc"
    fi
done

# The build allows gnu99; the sources do not need it. Attributes are the compiler's own in either. What only optimizers
# see, the build has been warned of. What only WebAssembly has is clang's, and in no library.
exact=$(sed -n 's/^EXACT := //p' Makefile)
strict=0
[ -n "$convex" ] && optional= || optional="! -path src/convex/*"
grep -q DPT_HAS_JANSSON "$build/built_with.h" || optional="$optional ! -path src/scene/json_value.c"
for source in $(set -f; find src drivers -name '*.c' ! -path 'src/bindings/*' ! -path 'drivers/platform/windows/*' ! -path 'drivers/platform/macos/*' $optional); do
    ${CC:-cc} $c99 -Iinclude -Isrc -Idrivers -I"$build" -O1 $exact -fPIC -fsyntax-only "$source" || strict=1
done
verdict $strict "every source is pedantic C99"

# Firmware takes four files and nothing else (docs/wire.md).
mkdir -p "$scratch/copied"
cp drivers/serial/wire.[ch] drivers/serial/wire_device.[ch] "$scratch/copied"
(cd "$scratch/copied" && ${CC:-cc} $c99 -c wire.c wire_device.c) &&
    ! nm -u "$scratch/copied/wire.o" "$scratch/copied/wire_device.o" |
    grep ' U ' | grep -vE ' U (wire_[a-z_]*|mem(cpy|set|move|cmp)|strlen|sqrt|_GLOBAL_OFFSET_TABLE_|__stack_chk_fail)$'
verdict $? "wire.[ch] and wire_device.[ch] compile alone, and call only mem*, strlen and sqrt"

# Any choice of back ends builds, and is what the library then has. The core is this build's.
few=$scratch/few
mkdir "$few" && cp -pR "$build/src" "$few"
make -s B="$few" CFLAGS=-O0 DRIVERS=replay "$few/libdynpoint_drivers.so.1" &&
    printf '%s\n' '#include <dynpoint/driver.h>' 'int main(void) { dpt_device *d; return !dpt_driver_find("replay") ||' \
        'dpt_driver_find("sim") || !dpt_driver_get(0) || dpt_driver_get(1) ||' \
        'dpt_device_open("can:can0", &d, NULL) != DPT_E_ABSENT || dpt_device_open("sim", &d, NULL) != DPT_E_ABSENT ||' \
        'dpt_device_open("cans", &d, NULL) != DPT_E_UNSUPPORTED; }' |
    ${CC:-cc} $c99 -Iinclude -x c - -o "$scratch/one" -L"$few" -ldynpoint_drivers -ldynpoint &&
    LD_LIBRARY_PATH="$few" "$scratch/one"
verdict $? "DRIVERS=replay builds a library with that one back end, which says of the others that it was made without them"
${OBJCOPY:-objcopy} -O binary -j .note.dlopen "$build/libdynpoint_drivers.so.1" "$scratch/note" &&
    tail -c +17 "$scratch/note" | tr -d '\000' | grep -qx '\[{"feature":"openhaptics",.*"soname":\["libHD.so.3.4","libHD.so.3.0","libHD.so"\]}\]' &&
    ! readelf -SW "$few/libdynpoint_drivers.so.1" | grep -q dlopen && ! readelf -d "$build/libdynpoint_drivers.so.1" | grep -q libHD
verdict $? "a note tells packagers of libHD, which nothing is linked to; not where its back end is left out"
make -s B="$few" CFLAGS=-O0 DRIVERS= "$few/libdynpoint_drivers.so.1" &&
    printf '%s\n' '#include <dynpoint/driver.h>' 'int main(void) { return dpt_driver_get(0) != NULL; }' |
    ${CC:-cc} $c99 -Iinclude -x c - -o "$scratch/none" -L"$few" -ldynpoint_drivers -ldynpoint &&
    LD_LIBRARY_PATH="$few" "$scratch/none"
verdict $? "DRIVERS= builds one without any"
make -s B="$few" CFLAGS=-O0 DRIVERS=nonesuch "$few/libdynpoint_drivers.so.1" >/dev/null 2>&1
[ $? -eq 2 ]
verdict $? "and an unknown one is an error"

# A back end that is left out is needed by nothing: neither its headers, nor the kernel's, nor its code.
back_ends=$(sed -n 's/^BACK_ENDS := //p' Makefile)
foreign=0 choices=1
for name in $back_ends; do
    choices=$((choices * 2))
    grep -rl "^#include \"$name/" drivers tools | grep -v -e "^drivers/$name/" -e "^tools/simulate/simulate_$name[._]" && foreign=1
done
verdict $foreign "a back end's headers are included by itself and by its end in tools/simulate only"
mkdir -p "$scratch/hidden/linux"
echo '#error "not outside of drivers/can and tools/simulate/simulate_can*.c"' >"$scratch/hidden/linux/can.h"
hidden=0
for source in $(set -f; find src drivers tools -name '*.c' ! -path 'src/bindings/*' ! -path 'drivers/platform/windows/*' ! -path 'drivers/platform/macos/*' $optional ! -path 'drivers/can/*' ! -path "tools/simulate/simulate_can*.c" ! -path src/scene/json_value.c); do
    ${CC:-cc} -std=gnu99 -I"$scratch/hidden" -Iinclude -Isrc -Idrivers -Itools -I"$build" -E "$source" >"$scratch/preprocessed" || hidden=1
done
verdict $hidden "no source but those of CAN needs linux/can.h"
# simulates NAME: 0 as well when it fails for another reason than that the back end is left out.
simulates() {
    timeout 10 "$few/dynpoint" device simulate "$1" --for 0.001 >"$scratch/said" 2>"$scratch/says"
    [ $? -ne 2 ] || ! grep -q "this build has no back end" "$scratch/says" || [ "$(wc -l <"$scratch/says")" -ne 1 ]
}
# All choices before a release. Else those of one, which need no other, those without one, which no other needs, all and
# none.
count=$(echo $back_ends | wc -w) wrong=0 number=-1 built=0
while [ $((number += 1)) -lt $choices ]; do
    chosen= left=$number is=0 members=0
    for name in $back_ends; do
        [ $((left % 2)) -eq 0 ] || chosen="$chosen$name " members=$((members + 1))
        left=$((left / 2))
    done
    [ "${RELEASE:-yes}" != no ] || [ $members -le 1 ] || [ $members -ge $((count - 1)) ] || continue
    built=$((built + 1))
    make -s -j2 B="$few" CFLAGS=-O0 URDF=no DRIVERS="$chosen" LDFLAGS=-Wl,--no-undefined "$few/libdynpoint_drivers.so.1" "$few/dynpoint" &&
        [ "$("$few/dynpoint" device list | sed -n 's/^\([a-z][a-z]*\) .*/\1/p' | tr '\n' ' ')" = "$chosen" ] || is=1
    case $chosen in *serial*) simulates serial ;; *) ! simulates serial ;; esac || is=1
    case $chosen in *can*) simulates can: ;; *) ! simulates can: ;; esac || is=1
    [ $is -eq 0 ] || echo "  DRIVERS=\"$chosen\""
    wrong=$((wrong + is))
done
[ $built -gt $((2 * count)) ] && [ $wrong -eq 0 ]
verdict $? "each of $built choices of back ends builds a library and a program that have these and need no other"

# Without urdfdom the program says so.
make -s B="$few" CFLAGS=-O0 URDF=no "$few/dynpoint" &&
    ! "$few/dynpoint" compile docs/samples/arm.urdf -o "$scratch/arm.dpa" 2>"$scratch/no_urdf.says" &&
    [ "$(wc -l <"$scratch/no_urdf.says")" -eq 1 ] && grep -q "this build reads no URDF: install" "$scratch/no_urdf.says" &&
    [ ! -e "$scratch/arm.dpa" ]
verdict $? "URDF=no builds a program that says what is missing"
# Without jansson too; scenes by name are none of its business.
make -s B="$few" CFLAGS=-O0 URDF=no JANSSON=no "$few/dynpoint" &&
    ! "$few/dynpoint" run docs/samples/scene.json --ticks 5 2>"$scratch/no_jansson.says" &&
    [ "$(wc -l <"$scratch/no_jansson.says")" -eq 1 ] &&
    grep -q "this build reads no scene files: install" "$scratch/no_jansson.says" &&
    "$few/dynpoint" run membrane --device sim --ticks 5 >"$scratch/no_jansson.runs"
verdict $? "JANSSON=no builds a program that says what is missing, and knows scenes by name"

# Nor does a program without the viewer's server and page ask for their libraries.
make -s B="$few" CFLAGS=-O0 URDF=no JANSSON=no LWS=no VIEW_PAGE=no "$few/dynpoint" &&
    ! grep -qE 'LWS|VIEW_PAGE' "$few/built_with.h" &&
    ! readelf -d "$few/dynpoint" | grep -E 'NEEDED.*(websockets|jansson|urdf)'
verdict $? "LWS=no VIEW_PAGE=no builds a program without libwebsockets"

# Pages show parts of scripts that run; a line of them that these have no more is a lie.
for page in docs/ffi.md docs/recipes.md; do
    sed -n '/^```python/,/^```/p' $page | grep -v '^```' |
        grep -vxF -f tests/ffi/touch.py -f tests/ffi/cdef.py -f tests/ffi/host.py -f docs/samples/own_physics.py
    [ $? -eq 1 ]
    verdict $? "$page shows lines of tests/ffi and docs/samples"
done
if command -v python3 >/dev/null 2>&1; then
    python3 -B docs/samples/own_physics.py "$build" >"$scratch/felt" && [ "$(wc -l <"$scratch/felt")" -eq 31 ]
    verdict $? "docs/samples/own_physics.py: its needle feels a heart beat, and loads and force cancel out"
    ! python3 -B docs/samples/own_physics.py 2>"$scratch/says" && [ "$(wc -l <"$scratch/says")" -eq 1 ] && grep -q '^usage: ' "$scratch/says"
    verdict $? "docs/samples/own_physics.py: without its argument it says what that is"
else
    skip "physics of its own in Python: no python3"
fi

root=$PWD/$scratch/root
make -s install DESTDIR="$root" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null
find "$root" -type f -o -type l | sed "s|^$root||" | LC_ALL=C sort >"$scratch/whole"
grep -v '/doc/dynpoint/docs/' "$scratch/whole" >"$scratch/installed"
[ "$(grep -c '/doc/dynpoint/docs/.*\.md$' "$scratch/whole")" -eq "$(find docs -name '*.md' | wc -l)" ]
verdict $? "install puts all pages"
for lib in libdynpoint_urdf libdynpoint_convex; do
    [ -e "$build/$lib.a" ] || echo "$lib\."
done >"$scratch/left_out"
grep -vf "$scratch/left_out" "$here/installed" | diff - "$scratch/installed"
verdict $? "install puts what $here/installed lists"
if command -v pkg-config >/dev/null 2>&1; then
    export PKG_CONFIG_PATH="$root/opt/dp/lib64/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$root"
    flags=$(pkg-config --cflags --libs libdynpoint_compile libdynpoint)
    ${CC:-cc} -std=c99 "$here/user.c" $flags -o "$scratch/user" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/user"
    verdict $? "a program builds with the installed .pc and shared libraries"
    ${CC:-cc} -std=c99 "$here/user.c" -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_compile.a" \
        "$root/opt/dp/lib64/libdynpoint.a" -lm -pthread -o "$scratch/user" && "$scratch/user"
    verdict $? "and with the static ones"
    if [ -n "$urdf" ]; then
        flags=$(PKG_CONFIG_SYSROOT_DIR= pkg-config --cflags --libs libdynpoint_urdf)
        ${CC:-cc} $c99 "$here/arm_of_urdf.c" $flags -ldynpoint_compile -ldynpoint -o "$scratch/arm_of_urdf" &&
            LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/arm_of_urdf" docs/samples/arm.urdf
        verdict $? "a program with a robot's description, too"
        flags=$(PKG_CONFIG_SYSROOT_DIR= pkg-config --static --libs libdynpoint_urdf | sed "s|-ldynpoint[a-z_]*||g")
        ${CC:-cc} $c99 "$here/arm_of_urdf.c" -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_urdf.a" \
            "$root/opt/dp/lib64/libdynpoint_compile.a" "$root/opt/dp/lib64/libdynpoint.a" $flags -o "$scratch/arm_of_urdf" &&
            "$scratch/arm_of_urdf" docs/samples/arm.urdf
        verdict $? "and with the static ones"
    else
        skip "a program with a robot's description: this build has none"
    fi
    if [ -n "$convex" ]; then
        ${CC:-cc} $c99 "$here/curved_tip.c" $(pkg-config --cflags --libs libdynpoint_convex libdynpoint_compile libdynpoint) \
            -o "$scratch/curved_tip" && LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/curved_tip"
        verdict $? "a program with a curved tip, too"
        flags=$(PKG_CONFIG_SYSROOT_DIR= pkg-config --static --libs libdynpoint_convex | sed "s|-ldynpoint[a-z_]*||g")
        ${CC:-cc} $c99 "$here/curved_tip.c" -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_convex.a" \
            "$root/opt/dp/lib64/libdynpoint_compile.a" "$root/opt/dp/lib64/libdynpoint.a" $flags -pthread -o "$scratch/curved_tip" &&
            "$scratch/curved_tip"
        verdict $? "and with the static ones"
    else
        skip "a program with a curved tip: this build has none"
    fi
    pkg-config --static --libs libdynpoint_compile | grep -q -- -pthread &&
        ! pkg-config --static --libs libdynpoint | grep -q -- -pthread
    verdict $? "the compiler's .pc asks for threads, the core's does not"

    echo '#include <dynpoint/loop.h>
int main(void) { dpt_device *d; dpt_guard g = { .size = sizeof g };
    return dpt_guard_init(&g, NULL) || dpt_device_open("sim", &d, NULL) || (dpt_device_close(d), 0); }' >"$scratch/host.c"
    ${CC:-cc} -std=c99 "$scratch/host.c" $(pkg-config --cflags --libs libdynpoint_drivers) -o "$scratch/host" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/host" &&
        ${CC:-cc} -std=c99 "$scratch/host.c" -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_drivers.a" \
            "$root/opt/dp/lib64/libdynpoint.a" -lm -lpthread -o "$scratch/host" && "$scratch/host"
    verdict $? "and a host of a device, with either"

    ${CC:-cc} $c99 docs/samples/own_driver.c $(pkg-config --cflags --libs libdynpoint_drivers) -o "$scratch/own_driver" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/own_driver" >"$scratch/felt" &&
        printf 'ticks 200 commands 200 clamped 200\nstrongest 2 N\n' | cmp - "$scratch/felt" &&
        ! LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/own_driver" elsewhere 2>/dev/null
    verdict $? "docs/samples/own_driver.c builds and is served"

    sample=docs/samples/safe_device.c
    ${CC:-cc} $c99 $sample $(pkg-config --cflags --libs libdynpoint_host) -Wl,-rpath-link,"$root/opt/dp/lib64" -o "$scratch/safe_device" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/safe_device" membrane 'sim:?hand=press' 3000 >"$scratch/felt" &&
        grep -qx '3000 ticks, in contact on [1-9][0-9]*, at most 0\.[1-9][0-9]* N, coupled by 667\.2 N/m' "$scratch/felt" &&
        ! LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/safe_device" nothing sim 2>"$scratch/says" && grep -q '^nothing: there is no scene of this name' "$scratch/says"
    verdict $? "$sample builds, feels a membrane, and says what it cannot open"
    flags=$(pkg-config --static --libs libdynpoint_host | sed "s|-ldynpoint[a-z_]*||g")
    ${CC:-cc} $c99 $sample -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint_host.a" ${convex:+"$root/opt/dp/lib64/libdynpoint_convex.a"} \
        "$root/opt/dp/lib64/libdynpoint_drivers.a" "$root/opt/dp/lib64/libdynpoint_compile.a" "$root/opt/dp/lib64/libdynpoint.a" $flags -o "$scratch/safe_static" &&
        "$scratch/safe_static" membrane 'sim:?hand=press' 3000 | cmp - "$scratch/felt"
    verdict $? "and with the static libraries it feels the same"
    "$build/dynpoint" device simulate serial --for 100 >"$scratch/line" 2>/dev/null &
    simulator=$!
    while [ ! -s "$scratch/line" ] && kill -0 $simulator; do sleep 0.02; done
    line="$(cat "$scratch/line")?silent=10"
    # A machine that is busy misses the line's watchdog: then once more.
    tries=0
    until "$scratch/safe_static" tori "$line" 500 >"$scratch/felt" 2>"$scratch/says" && grep -q '^[1-9][0-9]* ticks' "$scratch/felt"; do
        [ $((tries += 1)) -lt 20 ] || break
    done
    [ $tries -lt 20 ]
    verdict $? "over a serial line too $(cat "$scratch/felt" "$scratch/says")"
    "$scratch/safe_static" tori "$line" >"$scratch/felt" 2>"$scratch/says" &
    safe=$!
    sleep 1
    kill -KILL $simulator
    wait $simulator 2>/dev/null
    wait $safe
    [ $? -eq 2 ] && grep -q '^the device is gone' "$scratch/says" && grep -q '^[1-9][0-9]* ticks' "$scratch/felt"
    verdict $? "and where the line is cut, it ends and says so $(cat "$scratch/felt" "$scratch/says")"

    sample=docs/samples/first_touch.c
    ${CC:-cc} $c99 $sample $(pkg-config --cflags --libs libdynpoint) -o "$scratch/sample_shared" &&
        ${CC:-cc} $c99 $sample -I"$root/opt/dp/include" "$root/opt/dp/lib64/libdynpoint.a" -lm \
            -o "$scratch/sample_static"
    verdict $? "$sample builds with either"
    for shape in "liver 2000" "box 12"; do
        "$root/opt/dp/bin/dynpoint" make $shape -o "$scratch/mesh.stl" >/dev/null &&
            "$root/opt/dp/bin/dynpoint" compile "$scratch/mesh.stl" -o "$scratch/mesh.dpa" >/dev/null &&
            LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/sample_shared" "$scratch/mesh.dpa" >"$scratch/felt" &&
            "$scratch/sample_static" "$scratch/mesh.dpa" | cmp - "$scratch/felt" &&
            awk 'NF != 11 || $1 != "tick" { bad++ }
                $6 == "separated" { apart++; bad += $8 != 0 || $9 != 0 || $10 != 0; next }
                $6 == "penetrating" { pressed++; bad += $10 <= 0; next }
                { bad++ }
                END { exit bad || !apart || !pressed || NR != 11 }' "$scratch/felt"
        verdict $? "it feels nothing above a $shape, and a push upward on it"
    done

    sample=docs/samples/own_physics.c
    "$root/opt/dp/bin/dynpoint" make liver 5000 -o "$scratch/mesh.stl" >/dev/null &&
        ${CC:-cc} $c99 $sample $(pkg-config --cflags --libs libdynpoint_compile libdynpoint) -lm -pthread -o "$scratch/own_physics" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/own_physics" "$scratch/mesh.stl" --one-thread >"$scratch/felt" &&
        LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/own_physics" "$scratch/mesh.stl" --one-thread | cmp - "$scratch/felt" &&
        awk 'NR > 1 && NF != 4 { bad++ } NR > 11 && $4 > 0.2 { held++ } NR > 11 && $4 == 0 { free++ }
            END { exit bad || NR != 51 || held < 10 || free < 5 }' "$scratch/felt"
    verdict $? "$sample builds; its needle feels the organ come and go, twice in the same way"
    LD_LIBRARY_PATH="$root/opt/dp/lib64" "$scratch/own_physics" "$scratch/mesh.stl" >"$scratch/felt" &&
        [ "$(awk '$4 > 0' "$scratch/felt" | wc -l)" -gt 10 ]
    verdict $? "and in two threads"
else
    for what in "a program" "a static program" "threads" "a host" "a driver of its own" "a safe device" "that with static libraries" "that over a serial line" "that where it is cut" "the sample" "the sample on a liver" "the sample on a box" "physics of its own" "that in two threads"; do
        skip "$what with the installed .pc: no pkg-config"
    done
fi
make -s uninstall DESTDIR="$root" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null 2>&1
[ -z "$(find "$root" -type f -o -type l)" ]
verdict $? "uninstall leaves nothing"
spaced="$PWD/$scratch/a place"
make -s install DESTDIR="$spaced" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null
(cd "$spaced" && find . -type f -o -type l) 2>/dev/null | sed 's/^.//' | LC_ALL=C sort | diff "$scratch/whole" - &&
    make -s uninstall DESTDIR="$spaced" PREFIX=/opt/dp LIBDIR=/opt/dp/lib64 >/dev/null 2>&1
    [ -d "$spaced" ] && [ -z "$(find "$spaced" -type f -o -type l)" ]
verdict $? "both go where a space is in the name"

finish
