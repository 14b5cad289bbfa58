/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world in which a snapshot finds everything: a liver, a cloth that is displaced, tools of each kind that wander through
 * both; and a reader of snapshots by docs/format.md alone.
 */
#ifndef DPT_TESTS_SNAPSHOT_SCENE_H
#define DPT_TESTS_SNAPSHOT_SCENE_H

#include "lib/fixture.h"
#include "lib/rig.h"

enum { BODIES = 1, TOOLS, SEGMENTS, CONTACTS, STRIPS, VERTICES, KINDS_END };
enum { TOOL_COUNT = 4, SEGMENT_COUNT = 6, ROOM = 1 << 20 };

struct scene {
    struct fixture liver, cloth;
    struct rig rig;
    dpt_body body[2];
    dpt_tool tool[TOOL_COUNT];
    dpt_pose pose[TOOL_COUNT];
};

/* The second tool is free, and its segment is only about this one. */
extern const dpt_segment segments_of[TOOL_COUNT][3];
extern const uint32_t segment_counts[TOOL_COUNT];

extern uint64_t seed;

void scene_open(struct scene *scene);
void scene_close(struct scene *scene);

/* Move all tools and take a step. */
void step(struct scene *scene, uint64_t tick);

/* With contacts and strips: after 900 steps. */
void scene_in_contact(struct scene *scene);

/* The last snapshot that was taken, and how long it is. */
extern unsigned char block[ROOM];
extern size_t bytes;

dpt_snapshot_def all_of_it(void);
void take(const struct scene *scene, const dpt_snapshot_def *def);

/* What stands at a byte of it. */
uint32_t word(size_t at);
uint64_t wide(size_t at);
double number(size_t at);

/* Where item i of a kind begins, and how many there are. */
size_t item(uint32_t kind, uint32_t i, uint32_t *count);

#endif
