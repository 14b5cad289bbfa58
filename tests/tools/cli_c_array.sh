#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# compile --c-array: the file as an array in C, by each compiler that is here.
# `sh tests/tools/cli_c_array.sh BUILD`.
. "$(dirname "$0")/cli.sh"

c_array()
{
    cat >opens.c <<'C'
#include <dynpoint.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
extern const uint64_t torus_mesh[];
extern const size_t torus_mesh_size;
static uint64_t file[1 << 20];
int main(void)
{
    const dpt_mesh *mesh[2];
    dpt_hit hit[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
    FILE *stream = fopen("torus_mesh.dpa", "rb");
    size_t size = stream ? fread(file, 1, sizeof file, stream) : 0;
    if (size != torus_mesh_size || memcmp(file, torus_mesh, size) || (uintptr_t)torus_mesh % 64)
        return 1;
    if (dpt_mesh_open(torus_mesh, torus_mesh_size, &mesh[0]) || dpt_mesh_open(file, size, &mesh[1]))
        return 2;
    for (int i = 0; i < 1000; i++) {
        double ends[6];
        for (int k = 0; k < 6; k++)
            ends[k] = 0.001 * ((i * 37 + k * 101) % 331 - 165);
        for (int m = 0; m < 2; m++)
            if (dpt_query_segments(mesh[m], NULL, ends, NULL, 1, &hit[m], NULL) != DPT_OK)
                return 3;
        if (memcmp(&hit[0], &hit[1], sizeof hit[0]) || hit[0].status != DPT_STATUS_EXACT)
            return 4;
    }
    return 0;
}
C
    succeeds '--c-array' compile torus.obj -o torus_mesh.c --c-array torus_mesh
    succeeds '--c-array: the file' compile torus.obj -o torus_mesh.dpa
    # At most 3 bytes of text for one of the file.
    check "--c-array: $(wc -c <torus_mesh.c) bytes" \
        test "$(wc -c <torus_mesh.c)" -le $((3 * $(wc -c <torus_mesh.dpa)))
    if ! command -v "${CC:-cc}" >/dev/null; then
        skip '--c-array: no C compiler'
        return
    fi
    for compiler in "${CC:-cc} -std=c99" 'clang -std=c99' 'g++ -x c++ -std=c++11' 'clang++ -x c++ -std=c++11'; do
        if ! command -v "${compiler%% *}" >/dev/null; then
            skip "--c-array: no ${compiler%% *}"
            continue
        fi
        # A library that was built with a sanitizer or for coverage wants its runtime.
        rm -f opens torus_mesh.o
        # shellcheck disable=SC2086
        $compiler -pedantic -Wall -Wextra -Wshadow -Wconversion -Werror -c torus_mesh.c -o torus_mesh.o \
            2>cc.log
        check "--c-array, $compiler: $(tail -n 1 cc.log)" test $? -eq 0
        for runtime in '' -fsanitize=address,undefined --coverage; do
            # shellcheck disable=SC2086
            ${CC:-cc} -std=c99 -Wall -Wextra -Werror $runtime -I"$tests/../include" opens.c \
                torus_mesh.o "$build/libdynpoint.a" -lm -o opens 2>cc.log && break
        done
        check "--c-array, $compiler: $(tail -n 1 cc.log)" test -x opens
        ./opens
        code=$?
        check "--c-array, $compiler: not the file's answers: $code" test $code -eq 0
        # No writable data: it may lie in flash.
        check "--c-array, $compiler: not constant" \
            test -z "$(objdump -h torus_mesh.o | awk '$2 ~ /^\.s?(data|bss)$/ && $3 !~ /^0+$/')"
    done
}

prepare
c_array
finish
