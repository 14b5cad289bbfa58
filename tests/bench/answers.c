/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * All that the library answers, for compare.sh: `answers [--worlds N] [--only FIRST LAST] [MESH.dpa ...]` writes every
 * answer of random scenes, bit by bit (answers.h), and on standard error what there was. `answers --number BITS ...` is
 * for the reader of a difference: it turns 16 hexadecimal digits back into a number.
 *
 * It uses public headers alone and is compiled against those of either commit. All is drawn from seeds; a world's seed is
 * its number, so that --only shows some of them as they are among all.
 */
#include "bench/answers_device.h"
#include "bench/answers_world.h"

static int numbers_show(int argc, char **argv)
{
    for (int i = 2; i < argc; i++) {
        double value;
        const uint64_t pattern = strtoull(argv[i], NULL, 16);
        memcpy(&value, &pattern, sizeof value);
        printf("%.17g%c", value, i + 1 < argc ? ' ' : '\n');
    }
    return 0;
}

int main(int argc, char **argv)
{
    uint32_t worlds = 300, first = 0, last = UINT32_MAX;
    int at = 1;
    if (argc > 1 && strcmp(argv[1], "--number") == 0)
        return numbers_show(argc, argv);
    if (at + 1 < argc && strcmp(argv[at], "--worlds") == 0) {
        worlds = (uint32_t)strtoul(argv[at + 1], NULL, 10);
        at += 2;
    }
    const int only = at + 2 < argc && strcmp(argv[at], "--only") == 0;
    if (only) {
        first = (uint32_t)strtoul(argv[at + 1], NULL, 10);
        last = (uint32_t)strtoul(argv[at + 2], NULL, 10);
        at += 3;
    }
    subjects_make();
    for (; at < argc; at++)
        subject_read(argv[at]);
    kernels_find();
    if (!only) {
        pairs_alone(20000);
        meshes_alone();
        arms_run(60);
        guards_run(40);
        loops_run();
    }
    for (uint32_t i = first; i < worlds && i <= last; i++)
        world_run(i, 150);
    out_flush();
    fprintf(stderr,
            "%" PRIu64 " worlds, %" PRIu64 " ticks, %" PRIu64 " with an axis through a surface; %" PRIu64
            " regions, %" PRIu64 " sweeps that met, %" PRIu64 " strips, %" PRIu64 " stale, %" PRIu64
            " ended by a budget; %" PRIu64 " lines, %" PRIu64 " values\n",
            met.worlds, met.ticks, met.crossing, met.contacts, met.swept, met.strips, met.stale, met.bounded, out_lines,
            out_values);
    return 0;
}
