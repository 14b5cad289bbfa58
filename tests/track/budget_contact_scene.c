/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/budget_contact_scene.h"

#if defined(__SANITIZE_ADDRESS__)
enum { RESTS = 60, POSES = 40, TICKS = 800 };
#else
enum { RESTS = 300, POSES = 200, TICKS = 2000 };
#endif

uint32_t rest_count(void)
{
    return (uint32_t)part_of(RESTS);
}

uint32_t pose_count(void)
{
    return (uint32_t)part_of(POSES);
}

uint32_t tick_count(void)
{
    return (uint32_t)part_of(TICKS);
}

double contact_margin;

struct contact_world ample_world, small_world;

void contact_world_open(struct contact_world *one, const dpt_mesh *mesh, const dpt_segment *axis, uint32_t budget)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.budget = budget;
    def.max_contacts = 16;
    def.margin = contact_margin;
    rig_open(&one->rig, &def, mesh, axis, 1);
}

void contact_world_step(struct contact_world *one)
{
    rig_tick(&one->rig);
    one->count = rig_contacts(&one->rig, one->contacts);
    one->coarse = 0;
    for (uint32_t i = 0; i < one->count; i++)
        one->coarse |= one->contacts[i].flags & DPT_CONTACT_FLAG_COARSE;
}

int is_known(const struct contact_world *one)
{
    return one->rig.hit.contact != DPT_CONTACT_UNKNOWN;
}

dpt_segment random_axis(const struct subject *subject, uint64_t *seed, double most)
{
    const double size = random_in(seed, 0.1, most) * subject->diagonal;
    dpt_segment axis = { .radius = 0.005 * subject->diagonal };
    double way[3];
    random_unit(seed, way);
    for (int k = 0; k < 3; k++) {
        double x = random_in(seed, subject->info.box_min[k], subject->info.box_max[k]);
        axis.a[k] = x - 0.5 * size * way[k];
        axis.b[k] = x + 0.5 * size * way[k];
    }
    return axis;
}
