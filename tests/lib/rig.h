/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world on the heap with its bodies and tools, and what its last step gave. What fails is a failed check at the line
 * that called. Everything else is asked of rig->world.
 *
 *     struct rig rig;
 *     rig_open(&rig, NULL, mesh, &segment, 1);
 *     rig.device.position[2] = 0.01;
 *     rig_step(&rig);
 *     CHECK(rig.force.reason == DPT_FORCE_ACTS, "no force");
 *     rig_close(&rig);
 */
#ifndef DPT_TESTS_RIG_H
#define DPT_TESTS_RIG_H

#include "dynpoint.h"
#include "lib/check.h"
#include "lib/pose.h"

enum { RIG_SEGMENTS = 32, RIG_BLOCKS = 8, RIG_CONTACTS = 64 };

struct rig {
    dpt_world *world;
    dpt_body body;                      /* the first */
    dpt_tool tool;                      /* the first; the rest is of it */
    dpt_segment segments[RIG_SEGMENTS]; /* in its frame */
    uint32_t count;
    dpt_pose device; /* where rig_step sets it */
    double dt;       /* RIG_DT, if you set no other */

    /* What the last step gave. */
    dpt_step step;
    dpt_hit hit;
    dpt_pose proxy;
    dpt_force_info force;

    void *blocks[RIG_BLOCKS]; /* freed with it; the world's first */
    uint32_t block_count;
    size_t world_bytes;
};

#define RIG_STIFFNESS 500.0
#define RIG_DT        1e-3

/* A line of no length or radius, at the origin. */
extern const dpt_segment rig_point;

/* The defaults, with room for 32 contacts, and a law. */
dpt_world_def rig_def(uint32_t law);

/* Whether this machine has a kernel. */
int rig_has_kernel(uint32_t kernel);

void rig_close(struct rig *rig);

/* |force| */
double rig_force(const struct rig *rig);

/* A segment of the proxy in the world, as two ends. */
void rig_proxy_ends(const struct rig *rig, uint32_t segment, double ends[6]);

/* The channels of a tool, as many as there is room for. Returns how many it has. */
uint32_t rig_channels(const struct rig *rig, dpt_tool tool, dpt_channel *channels, uint32_t capacity);
/* The only one. */
dpt_channel rig_channel(const struct rig *rig, dpt_tool tool);

/* These are called by the macros below, which say where: rig_open(&rig, ...). */
struct rig_line {
    const char *file;
    int line;
};

/*
 * A world with a body, unless `mesh` is NULL, and a tool, unless `count` is 0. `def` NULL: rig_def(DPT_LAW_PROXY). Returns
 * 0 after a failed check; close it in any case.
 */
int rig_open_at(struct rig_line at, struct rig *rig, const dpt_world_def *def, const dpt_mesh *mesh,
                const dpt_segment *segments, uint32_t count);

/* More of them: their ids, or 0. What a deformable body and springs live in is freed with the rig. */
dpt_body rig_add_body_at(struct rig_line at, struct rig *rig, const dpt_mesh *mesh, const dpt_pose *pose);
dpt_body rig_add_deformable_at(struct rig_line at, struct rig *rig, const dpt_deformable_def *def);
dpt_springs *rig_add_springs_at(struct rig_line at, struct rig *rig, const dpt_springs_def *def);
dpt_tool rig_add_tool_at(struct rig_line at, struct rig *rig, const dpt_segment *segments, uint32_t count);

/* A law of a tool's own; all settings of the first body, whose size is filled in. */
void rig_set_law_at(struct rig_line at, const struct rig *rig, dpt_tool tool, uint32_t law, double stiffness);
void rig_set_body_at(struct rig_line at, const struct rig *rig, dpt_body_settings settings);

/* A step, and what it gave. Before it the tool goes to rig->device, to a pose, or free with one segment. */
void rig_tick_at(struct rig_line at, struct rig *rig);
void rig_step_at(struct rig_line at, struct rig *rig);
void rig_step_to_at(struct rig_line at, struct rig *rig, const dpt_pose *pose);
dpt_hit rig_step_ends_at(struct rig_line at, struct rig *rig, const double ends[6], double radius);

/* The tool jumps to rig->device, and the world takes two steps: what begins in the open is outside then. */
void rig_place_at(struct rig_line at, struct rig *rig);

/* The tool's contacts, at most RIG_CONTACTS: how many. */
uint32_t rig_contacts_at(struct rig_line at, const struct rig *rig, dpt_contact *contacts);

/* Draw another stiffness, and in a third of all cases each friction on its body and a stiffness against turns. */
void rig_vary_at(struct rig_line at, const struct rig *rig, uint64_t *seed);

#define RIG_HERE                ((struct rig_line){ __FILE__, __LINE__ })
#define rig_open(...)           rig_open_at(RIG_HERE, __VA_ARGS__)
#define rig_add_body(...)       rig_add_body_at(RIG_HERE, __VA_ARGS__)
#define rig_add_deformable(...) rig_add_deformable_at(RIG_HERE, __VA_ARGS__)
#define rig_add_springs(...)    rig_add_springs_at(RIG_HERE, __VA_ARGS__)
#define rig_add_tool(...)       rig_add_tool_at(RIG_HERE, __VA_ARGS__)
#define rig_set_law(...)        rig_set_law_at(RIG_HERE, __VA_ARGS__)
#define rig_set_body(...)       rig_set_body_at(RIG_HERE, __VA_ARGS__)
#define rig_tick(...)           rig_tick_at(RIG_HERE, __VA_ARGS__)
#define rig_step(...)           rig_step_at(RIG_HERE, __VA_ARGS__)
#define rig_step_to(...)        rig_step_to_at(RIG_HERE, __VA_ARGS__)
#define rig_step_ends(...)      rig_step_ends_at(RIG_HERE, __VA_ARGS__)
#define rig_place(...)          rig_place_at(RIG_HERE, __VA_ARGS__)
#define rig_contacts(...)       rig_contacts_at(RIG_HERE, __VA_ARGS__)
#define rig_vary(...)           rig_vary_at(RIG_HERE, __VA_ARGS__)

#endif
