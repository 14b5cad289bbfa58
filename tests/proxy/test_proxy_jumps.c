/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a hand must not feel of a proxy as set by default: changes of the wrench beyond K (3 |device's motion|_M + 1 m/s dt),
 * also where it is put because the device has turned by more than 1 rad; proxies that are put before; and the other side. And
 * what holds nothing shall not hold it: a thin ball hangs nowhere where a path in steps of 1 um goes on.
 *
 *     test_proxy_jumps [ROUNDS [SEED]]
 */
#include "lib/rig.h"
#include "proxy/hang_run.h"
#include "proxy/jump_run.h"

/* Of the first seed, proxies are known to be put. */
enum { RUN_TICKS = 1200, FIRST_SEED = 3 };

#define DEPTH   3e-3
#define THIN    1e-6
#define AS_FAR  0.05 /* a mean force is off by no more */
#define FARTHER 0.02 /* of the ticks */

static unsigned long rounds = 1;
static uint64_t first_seed = FIRST_SEED;

static const dpt_segment tools[] = { { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 },
                                     { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 },
                                     { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } };
enum { TOOLS = sizeof tools / sizeof *tools };

static void wipe_and_poke(const char *shape, uint64_t triangles, uint64_t seed, struct jump_counts *counts)
{
    struct solid solid;
    struct soak_oracle oracle;
    if (solid_from_shape(&solid, shape, triangles) && soak_oracle_open(&oracle, &solid)) {
        for (int i = 0; i < TOOLS * HAND_MOTIONS * HAND_HOLDINGS; i++) {
            const struct jump_run_def def = { .oracle = &oracle,
                                              .segment = tools[i % TOOLS],
                                              .motion = i / TOOLS % HAND_MOTIONS,
                                              .holding = i / TOOLS / HAND_MOTIONS,
                                              .depth = DEPTH,
                                              .friction = i % 4 ? 0 : 0.3,
                                              .seed = 1000 * seed + (uint64_t)i,
                                              .ticks = RUN_TICKS };
            jump_run(&def, counts);
        }
        soak_oracle_close(&oracle);
    }
    solid_close(&solid);
}

static void nothing_jumps_or_passes(void)
{
    struct jump_counts counts = { 0 };
    for (uint64_t i = 0; i < rounds; i++)
        wipe_and_poke("star", 2000, first_seed + i, &counts);
    printf("    %llu ticks, %llu with a force, %llu folds, %llu put; largest change %.3f of the bound\n",
           (unsigned long long)counts.ticks, (unsigned long long)counts.acts, (unsigned long long)counts.folds,
           (unsigned long long)counts.puts, counts.largest);
    CHECK(counts.jumps == 0, "%llu jumps, the largest %g of the bound", (unsigned long long)counts.jumps,
          counts.largest);
    CHECK(counts.early == 0, "%llu put early", (unsigned long long)counts.early);
    CHECK(counts.passed == 0 && counts.overlaps == 0, "%llu passed, %llu overlaps", (unsigned long long)counts.passed,
          (unsigned long long)counts.overlaps);
    CHECK(counts.acts > counts.ticks / 2, "%llu of %llu ticks with a force", (unsigned long long)counts.acts,
          (unsigned long long)counts.ticks);
    CHECK(first_seed != FIRST_SEED || (counts.puts > 0 && counts.largest > 0.99), "%llu put, largest change %g",
          (unsigned long long)counts.puts, counts.largest);
}

static void a_thin_ball_does_not_hang(void)
{
    struct solid solid;
    struct hang_sums sums = { 0 };
    if (solid_from_shape(&solid, "star", 2000))
        for (uint64_t i = 0; i < rounds; i++)
            hang_run(&solid, THIN, 1 + first_seed + i, RUN_TICKS, &sums);
    solid_close(&solid);
    const double ratio = sums.force / sums.oracle, ticks = (double)sums.ticks;
    printf("    %.3f N in the mean, by small steps %.3f N; %.2f %% of the ticks farther, %.2f %% nearer\n",
           sums.force / ticks, sums.oracle / ticks, 100 * (double)sums.farther / ticks,
           100 * (double)sums.nearer / ticks);
    CHECK(fabs(ratio - 1) <= AS_FAR, "%g of the force by small steps", ratio);
    CHECK((double)sums.farther <= FARTHER * ticks, "%llu of %llu ticks farther from the device",
          (unsigned long long)sums.farther, (unsigned long long)sums.ticks);
    CHECK(sums.oracle > ticks, "by small steps only %g N", sums.oracle / ticks);
}

int main(int argc, char **argv)
{
    take_count(argc, argv, &rounds, &first_seed);
    TEST(nothing_jumps_or_passes);
    TEST(a_thin_ball_does_not_hang);
    return check_report();
}
