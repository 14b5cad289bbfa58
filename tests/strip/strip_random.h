/* SPDX-License-Identifier: BSD-3-Clause */
/* Tools and shadows of all kinds, and strips of them. */
#ifndef DPT_TESTS_STRIP_RANDOM_H
#define DPT_TESTS_STRIP_RANDOM_H

#include "dynpoint/strip.h"
#include "strip/strip_scene.h"

/* What it takes to see it again. */
const char *shadow_text(const struct scene *scene, const dpt_shadow *s);

static inline uint32_t room_for(const struct subject *subject)
{
    return subject->info.triangles < 1u << 20 ? subject->info.triangles : 1u << 20;
}

static inline void fill_strip(const struct scene *scene, const dpt_shadow *shadow, dpt_strip *strip)
{
    const dpt_result result = dpt_strip_shadow(strip, scene->subject->mesh, scene->pose, shadow);
    CHECK(result == DPT_OK, "%s: %s", dpt_result_name(result), shadow_text(scene, shadow));
}

/* One of a list. */
static inline double one_of(uint64_t *seed, const double *list, size_t count)
{
    return list[random_bits(seed) % count];
}
#define ONE_OF(seed, ...)                                                                                              \
    one_of(seed, (const double[]){ __VA_ARGS__ }, sizeof(double[]){ __VA_ARGS__ } / sizeof(double))

void random_pose(const struct scene *scene, uint64_t *seed, dpt_pose *pose);

/* All kinds of tools and shadows. */
void random_shadow(const struct scene *scene, uint64_t *seed, dpt_shadow *shadow);

#endif
