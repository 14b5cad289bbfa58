/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/world_def.h"

#include "base/return_if_error.h"
#include "base/sized.h"
#include "world/tool_strips.h"

void dpt_world_def_defaults(dpt_world_def *def, size_t size)
{
    const dpt_world_def defaults = {
        .max_bodies = 16,
        .max_tools = 4,
        .max_segments = 16,
        .stiffness = 500.0,
        .certificate_bytes = 1 << 20,
        .margin = 0.001,
        .fade = 0.002,
        .strip_capacity = 1024,
        .strip_search = 16384,
        .law = DPT_LAW_PROXY,
        .onset = -1.0,
        .sweep_budget = 4000,
        .max_tips = 4,
    };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

void dpt_baseline_def_defaults(dpt_baseline_def *def, size_t size)
{
    const dpt_baseline_def defaults = { .parts = 1 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

/* Up to this size the number of the cache's blocks fits into 32 bits. */
static const uint64_t CERTIFICATE_BYTES_MAX = (uint64_t)1 << 40;

int dpti_stiffness_is_valid(double stiffness)
{
    return stiffness >= 0.0 && within(stiffness, 1e9);
}

int dpti_law_is_valid(uint32_t law)
{
    return law <= DPT_LAW_PROXY;
}

/* Above it nothing that is touched slips. */
#define FRICTION_MAX 10.0

int dpti_friction_is_valid(double static_friction, double kinetic_friction)
{
    return kinetic_friction >= 0.0 && kinetic_friction <= static_friction && static_friction <= FRICTION_MAX;
}

int dpti_side_limit_is_valid(double limit)
{
    return limit >= 0.0 && within(limit, DPT_COORDINATE_MAX);
}

static int count_is_valid(uint32_t count)
{
    return count >= 1 && count <= 0xffff;
}

dpt_result dpti_world_def_read(const dpt_world_def *given, dpt_world_def *def, dpt_baseline_def *baseline)
{
    if (!given)
        return DPT_E_ARGUMENT;
    dpt_world_def_init(def);
    dpt_baseline_def_init(baseline);
    DPT_TRY(sized_read(given, SIZED_FIRST(dpt_world_def, max_channels), def, sizeof *def));
    if (def->baseline)
        DPT_TRY(sized_read(def->baseline, sizeof *baseline, baseline, sizeof *baseline));
    def->baseline = baseline;
    return DPT_OK;
}

static int baseline_is_valid(const dpt_world_def *def)
{
    const dpt_baseline_def *baseline = def->baseline;
    return baseline->parts >= 1 && baseline->parts <= (def->method == DPT_METHOD_PAPER ? 64u : 1u) &&
           baseline->one_step <= 1 && !baseline->reserved;
}

static int strips_are_valid(const dpt_world_def *def)
{
    const dpt_strip_def strip = dpti_strips_def(def);
    if (def->strip > DPT_STRIP_KIND_ROUTES)
        return 0;
    return !def->strip ||
           (dpt_strip_bytes(&strip) && def->strip_width >= 0.0 && def->strip_depth >= 0.0 &&
            within(def->strip_width, DPT_COORDINATE_MAX) && within(def->strip_depth, DPT_COORDINATE_MAX));
}

int dpti_world_def_is_valid(const dpt_world_def *def)
{
    return count_is_valid(def->max_bodies) && count_is_valid(def->max_tools) && count_is_valid(def->max_segments) &&
           def->method <= DPT_METHOD_PAPER && def->until <= DPT_UNTIL_CONTACT && baseline_is_valid(def) &&
           !def->reserved_pointer && (def->budget == 0 || def->method == DPT_METHOD_EXACT) &&
           dpti_stiffness_is_valid(def->stiffness) && dpti_side_limit_is_valid(def->side_limit) &&
           dpti_law_is_valid(def->law) && def->fade >= 0.0 && def->fade <= 1.0 &&
           def->certificate_bytes <= CERTIFICATE_BYTES_MAX && def->margin >= 0.0 &&
           within(def->margin, DPT_COORDINATE_MAX) && def->onset <= def->margin &&
           within(def->onset, DPT_COORDINATE_MAX) && def->max_contacts <= 0xffff && def->smooth_normals <= 1 &&
           def->max_tips <= 0xffff && def->max_channels <= 0xffff && !def->reserved && strips_are_valid(def);
}
