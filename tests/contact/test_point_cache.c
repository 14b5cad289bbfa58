/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a budget's searches found at points: which of them are kept (src/contact/profile_samples.h). Used in worlds:
 * test_budget_contact.
 */
#include "contact/profile_samples.h"

#include "lib/check.h"

/* Of one set: a new point takes the place of the one that was asked for longest ago, but not in this tick. */
static void a_tick_keeps_its_points(void)
{
    struct cached_point entries[POINT_CACHE_WAYS] = { { .body = 0 } };
    struct point_cache cache = { .entries = entries, .sets = 1, .tick = 1 };
    const vec3 point = { 0.5, -0.0, 1.0 }, beside = { 0.5, 0.0, 1.0 + 0x1p-52 };
    for (uint32_t i = 0; i < POINT_CACHE_WAYS; i++) {
        struct cached_point *entry = dpti_point_cache_put(&cache, i, point);
        CHECK(entry && entry->triangle == DPT_NONE && !entry->has_winding, "%u", i);
        entry->triangle = 10 + i;
    }
    CHECK(!dpti_point_cache_put(&cache, POINT_CACHE_WAYS, point), "it makes room for a fifth in one tick");
    CHECK(!dpti_point_cache_find(&cache, 0, beside), "another point");
    cache.tick = 2;
    CHECK(dpti_point_cache_find(&cache, 0, point)->triangle == 10, "the first");
    CHECK(dpti_point_cache_put(&cache, POINT_CACHE_WAYS, point) && !dpti_point_cache_find(&cache, 1, point) &&
              dpti_point_cache_find(&cache, 0, point) && dpti_point_cache_find(&cache, 2, point),
          "not the oldest was given up");
    dpti_point_cache_forget(&cache, 0);
    CHECK(!dpti_point_cache_find(&cache, 0, point) && dpti_point_cache_find(&cache, 2, point), "of one body");
    dpti_point_cache_forget(&cache, DPT_NONE);
    CHECK(!dpti_point_cache_find(&cache, 2, point), "of all");
}

int main(void)
{
    TEST(a_tick_keeps_its_points);
    return check_report();
}
