#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# That tests/layers.sh can fail: `sh tests/layers_test.sh BUILD`. In a copy of the tree each rule is broken once, by files
# that are added; each time there is one failure more than before, and it says what is wrong.
set -u
build=$1
here=$(dirname "$0")
. "$here/lib/verdict.sh"
scratch=$build/layers_test
tree=$scratch/tree
rm -rf "$scratch"
mkdir -p "$tree/build"
LC_ALL=C
export LC_ALL

# put FILE LINE...: a file of that text; what is put is taken away after the next look.
put() {
    file=$1
    shift
    mkdir -p "$tree/${file%/*}"
    printf '%s\n' "$@" >"$tree/$file"
    echo "$tree/$file" >>"$scratch/put"
}
# put_object SOURCE TEXT: a source with its object.
put_object() {
    put "$1" "$2"
    mkdir -p "$tree/build/${1%/*}"
    ${CC:-cc} -c "$tree/$1" -o "$tree/build/${1%.c}.o" || bad "$1 compiles"
    echo "$tree/build/${1%.c}.o" >>"$scratch/put"
}
look() {
    sh "$here/layers.sh" "$tree/build" "$tree" >"$scratch/says"
    status=$?
    grep '^  FAIL' "$scratch/says" | sort >"$scratch/$1"
}
undo() {
    while read -r file; do rm -f "$file"; done <"$scratch/put"
    rmdir "$tree"/src/* 2>/dev/null
    : >"$scratch/put"
}
# says WHAT: that is the one failure more; `says ''`: there is none.
says() {
    look after
    diff "$scratch/before" "$scratch/after" | grep '^[<>]' >"$scratch/more"
    if [ -z "$1" ]; then : >"$scratch/expected"; else echo ">   FAIL $1" >"$scratch/expected"; fi
    if diff "$scratch/expected" "$scratch/more" && { [ -z "$1" ] || [ "$status" -eq 1 ]; }; then
        ok "${2:-$1}"
    else
        bad "${2:-$1}"
    fi
    undo
}
# includes FILE HEADER WHAT: FILE includes HEADER of src/, which is there and empty.
includes() {
    put "src/$2"
    put "$1" "#include \"$2\""
    says "$1 includes $2: $3"
}

: >"$scratch/put"
cp -r include src drivers tools tests Makefile "$tree" &&
    cp -r "$build/src" "$build/drivers" "$build/tools" "$tree/build"
verdict $? "a copy of the tree and its objects"
# By the objects of the copy: the check of the tree itself may run at the same time, and writes below its own build.
sh "$here/layers.sh" "$tree/build" . | sort >"$scratch/of_the_tree"
look before
sort "$scratch/says" | diff "$scratch/of_the_tree" -
verdict $? "untouched, it is judged as the tree is"
if [ -s "$scratch/before" ]; then [ "$status" -eq 1 ]; else [ "$status" -eq 0 ]; fi
verdict $? "and leaves status 1 if something fails, else 0"

includes src/mesh/made.h nearest/made_used.h "mesh may not use nearest"
includes src/contact/made.h strip/made_used.h "contact may not use strip"
includes src/strip/made.h contact/made_used.h "strip may not use contact"
includes src/strip/made.h sweep/made_used.h "strip may not use sweep"
includes src/contact/made.h sweep/made_used.h "contact may not use sweep"
includes src/force/made.h nearest/made_used.h "force may not use nearest"
includes src/exchange/made.h mesh/made_used.h "exchange may not use mesh"
includes src/arm/made.h world/made_used.h "arm may not use world"
includes src/mesh/made.h compile/made_used.h "mesh may not use compile"
includes src/mesh/made.h text/made_used.h "mesh may not use text"
includes src/text/made.h mesh/made_used.h "text may not use mesh"
includes src/urdf/made.h host/made_used.h "urdf may not use host"
includes src/urdf/made.h compile/made_used.h "urdf may use compile by public symbols only"
includes src/convex/made.h kernel/made_used.h "convex may use kernel by public symbols only"
includes src/convex/made.h compile/made_used.h "convex may not use compile"
includes src/compile/made.h kernel/made_used.h "compile may use kernel by public symbols only"
includes drivers/made.h mesh/made_used.h "drivers may not use mesh"
includes drivers/sim/made.h compile/made_used.h "drivers may not use compile"
includes tools/made.h world/made_used.h "tools may use world by public symbols only"
put drivers/made.h '#include "dynpoint/mesh.h"'
says "drivers/made.h includes dynpoint/mesh.h: drivers may not use mesh"
put src/nearest/made_used.h
put src/mesh/made.h '#  include <nearest/made_used.h> // why'
says "src/mesh/made.h includes nearest/made_used.h: mesh may not use nearest"
put src/base/made_used.h '/* int no(void); */' '#define NO \' '  int no(void);' 'typedef void made_call(int);' \
    'struct made { int (*call)(int); } __attribute__((aligned(16)));' 'static inline int made(void)' '{' "    return '{';" '}' \
    'int made_apart(int (*call)(void));'
put drivers/made.h '#include "base/made_used.h"'
says "drivers/made.h includes base/made_used.h, which declares made_apart: drivers may include inline headers only"
put src/base/made_used.h 'extern const int made_table[3];'
put tools/made.h '#include "base/made_used.h"'
says "tools/made.h includes base/made_used.h, which declares made_table: tools may include inline headers only"
put src/base/made_used.h 'static inline int made(void) { return 1; }'
put src/mesh/made_used_too.h 'enum { MADE = 1 };' 'static const float made_table[2] = { 1, 2 };'
put src/compile/made.h '#include "base/made_used.h"' '#include "mesh/made_used_too.h"' '#include "text/parse_number.h"'
put src/query/made_7.h '#include "contact/made_used_3.h"' '#include "base/made_used.h"'
put src/contact/made_used_3.h
put tools/made_4.h '#include "compile/made.h"' '#include "made_5.h"' '#include "sim/made_6.h"'
put drivers/made_5.h '#include "base/made_used.h"'
put drivers/sim/made_6.h '#include "made_5.h"' '#include "dynpoint/types.h"'
says '' "what may be used may be included"

put src/mesh/made_used.h
put src/mesh/made.h '#include "../mesh/made_used.h"'
says "src/mesh/made.h includes ../mesh/made_used.h: a path begins at a root, without ./ or ../"
put src/mesh/made_used.h
put src/mesh/made.h '#include "made_used.h"'
says "src/mesh/made.h includes made_used.h: write mesh/made_used.h"
put drivers/sim/made_used.h
put drivers/sim/made.h '#include "made_used.h"'
says "drivers/sim/made.h includes made_used.h: write sim/made_used.h"
put src/mesh/made.h '#include "dynpoint.h"'
says "src/mesh/made.h includes dynpoint.h: src includes what it needs, dynpoint/..."
put src/mesh/made.h '#include "mesh/nowhere.h"'
says "src/mesh/made.h includes mesh/nowhere.h: there is no such file"
put tools/made_used.h
put drivers/made.h '#include "made_used.h"'
says "drivers/made.h includes made_used.h: there is no such file" "drivers do not find what is in tools"
put include/dynpoint/made.h '#include "base/vec3.h"'
says "include/dynpoint/made.h includes base/vec3.h: there is no such file" "nor public headers what is in src"
put src/mesh/made.h '#include MADE'
says "src/mesh/made.h includes MADE: a name that only the compiler knows"

put src/mesh/made.h
put tools/simulate/made.h
says "src/mesh/made.h and tools/simulate/made.h: a file name occurs once"
put src/made/made.h
says "src/made is neither in FOLDERS nor among those around the core"
put src/made.h
says "src/made.h lies in no folder"
put src/mesh/made.h "$(awk 'BEGIN { for (i = 1; i <= 601; i++) print "//" i }')"
says "src/mesh/made.h has 601 lines: 600 at most"
put src/mesh/made.h "$(awk 'BEGIN { for (i = 1; i <= 600; i++) print "//" i }')"
says '' "600 lines are not too many"
for i in $(seq 45); do put src/text/made_$i.h; done
says "src/text holds $((45 + $(ls src/text | wc -l))) files: 44 at most"
for i in 1 2 3 4; do put tools/made_$i.h; done
says "tools holds 5 files: 4 at most"
for i in $(seq 60); do put src/bindings/made_$((i % 2))/made_$i.c; done
says "half of the $((60 + $(find src drivers tools -name '*.c' -o -name '*.cc' | wc -l))) sources have at most 250 lines: they are crumbs"
put src/mesh/made.c 'int dpti_made;'
says "src/mesh/made.c has no object: nothing says what it calls"

used='int dpti_made(void); int dpti_made(void) { return 1; }'
user='int dpti_made(void); int dpti_made_user(void); int dpti_made_user(void) { return dpti_made(); }'
hidden='__attribute__((visibility("hidden")))'
put_object src/nearest/made_used.c "$hidden $used"
put_object src/mesh/made.c "$user"
says "src/mesh/made.o calls dpti_made of src/nearest/made_used.o: mesh may not use nearest"
put_object src/contact/made_used.c 'extern const int dpti_made; const int dpti_made = 1;'
put_object src/strip/made.c 'extern const int dpti_made; int dpti_made_user(void); int dpti_made_user(void) { return dpti_made; }'
says "src/strip/made.o calls dpti_made of src/contact/made_used.o: strip may not use contact"
put_object src/base/made_used.c "$used"
put_object drivers/made.c "$user"
says "drivers/made.o calls dpti_made of src/base/made_used.o: drivers may use base by public symbols only"
put_object src/world/made_used.c 'int made(void); int made(void) { return 1; }'
put_object tools/simulate/made.c 'int made(void); int dpti_made_user(void); int dpti_made_user(void) { return made(); }'
says "tools/simulate/made.o calls made of src/world/made_used.o: tools may use world by public symbols only"
put_object tools/simulate/made.c 'int dpt_world_create(void); int dpti_made_user(void); int dpti_made_user(void) { return dpt_world_create(); }'
says "tools/simulate/made.o calls dpt_world_create of src/world/world.o: tools leave that to src/scene and src/host"
put_object src/base/made_used.c 'int dpt_made(void); int dpt_made(void) { return 1; }'
put_object drivers/made.c 'int dpt_made(void); int dpti_made_user(void); int dpti_made_user(void) { return dpt_made(); }'
put_object src/contact/made_above.c "$used"
put_object src/world/made_below.c 'int dpti_made(void); int dpti_made_other(void); int dpti_made_other(void) { return dpti_made(); }'
says '' "what may be used may be called"
put_object src/nearest/made_used.c "$used"
put_object src/mesh/made.c "$user"
rm "$tree/src/mesh/made.c"
says '' "an object whose source is gone says nothing"
put_object src/query/made_1.c 'int dpti_made_1(void); int dpti_made_2(void); int dpti_made_1(void) { return dpti_made_2(); }'
put_object src/query/made_2.c 'int dpti_made_2(void); int dpti_made_3(void); int dpti_made_2(void) { return dpti_made_3(); }'
put_object src/query/made_3.c 'int dpti_made_3(void); int dpti_made_1(void); int dpti_made_3(void) { return dpti_made_1(); }'
put_object src/query/made_4.c 'int dpti_made_4(void); int dpti_made_1(void); int dpti_made_4(void) { return dpti_made_1(); }'
says "a circle in src/query: made_1.o calls dpti_made_2 of made_2.o, made_2.o calls dpti_made_3 of made_3.o, made_3.o calls dpti_made_1 of made_1.o"

put docs/made.md 'See [made](../src/mesh/made.c), src/mesh/NAME.c and include/dynpoint.h.'
says 'docs/made.md:1 names src/mesh/made.c, which is not there'
look after
diff "$scratch/before" "$scratch/after"
verdict $? "with nothing added it is as before"
finish
