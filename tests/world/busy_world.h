/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Worlds of every method in which much happens: three bodies and three tools that move, bodies and tools that come and
 * go, teleports, resets, input that is refused, and questions without a world. From tick to tick they call nothing of
 * the C library but what computes.
 */
#ifndef DPT_TESTS_BUSY_WORLD_H
#define DPT_TESTS_BUSY_WORLD_H

#include "dynpoint.h"

enum { BUSY_BODIES = 3, BUSY_TOOLS = 3, BUSY_SCENES = 7 };

/* The worlds, one a method and until; `ticks` is how many make a whole run. */
extern const struct busy_scene {
    uint32_t method, until, parts, one_step;
    uint64_t certificate_bytes;
    uint32_t ticks, strip;
} busy_scenes[BUSY_SCENES];

/* What came out: how often each kind of answer was given, and a hash of all answers. */
struct busy_tally {
    uint64_t ticks, unmade, refused, stale, local, exact, crossing, forces, strips, answers;
    uint64_t allocations;
};

struct busy_world {
    const struct busy_scene *scene;
    dpt_world *world;
    dpt_body body[BUSY_BODIES];
    dpt_tool tool[BUSY_TOOLS];
    uint64_t random;
    double centre[3], way[3], turn[4];
    struct busy_tally tally;
    uint64_t interrupt_at;                             /* before this tick of the tally, */
    void (*interrupt)(const struct busy_tally *tally); /* unless it is NULL */
};

/* The meshes and the block of all worlds, as an application would make them before its first tick; 0 on failure. */
int busy_worlds_prepare(void);
void busy_worlds_free(void);

/* In that block: one world at a time. Returns 0 where the machine does not have the kernel. */
int busy_world_open(struct busy_world *busy, const struct busy_scene *scene, uint32_t kernel);

/* Ticks begin .. end - 1, with all answers read and added to the tally. */
void busy_world_run(struct busy_world *busy, uint32_t begin, uint32_t end);

#endif
