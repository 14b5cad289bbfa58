/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One mesh and one tool in two worlds, one with a small budget and one with an ample one, and how much is asked of
 * them.
 */
#ifndef DPT_TESTS_BUDGET_CONTACT_SCENE_H
#define DPT_TESTS_BUDGET_CONTACT_SCENE_H

#include "lib/rig.h"
#include "lib/solid.h"
#include "lib/strip_subject.h"

/* SMALL: units of work, enough for a crossing's triangles and the largest single search of these meshes. */
enum { SMALL = 200, TICKS_MAX = 400 };

/* How many are asked, of one mesh; the share of the command line. */
uint32_t rest_count(void);
uint32_t pose_count(void);
uint32_t tick_count(void);

/* Of all worlds that contact_world_open makes. */
extern double contact_margin;

/* A world of one body and one tool of one segment, and what its last step said. */
extern struct contact_world {
    struct rig rig;
    dpt_contact contacts[RIG_CONTACTS];
    uint32_t count, coarse;
} ample_world, small_world;

void contact_world_open(struct contact_world *one, const dpt_mesh *mesh, const dpt_segment *axis, uint32_t budget);

/* Step, and read all. `coarse`: the flag of any contact. */
void contact_world_step(struct contact_world *one);

/* Whether it is known if the tool touches. */
int is_known(const struct contact_world *one);

/* An axis through the middle region of a mesh, at most `most` of its diagonal long. */
dpt_segment random_axis(const struct subject *subject, uint64_t *seed, double most);

#endif
