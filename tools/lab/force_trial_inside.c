/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "base/vec3.h"
#include "lab/force_lead.h"

struct force_trial_def force_trial_through_def(const struct force_trial_def *def)
{
    dpt_mesh_info info = { .size = sizeof info };
    struct force_trial_def through = *def;
    double size[3];
    dpt_mesh_get_info(def->mesh, &info);
    for (int k = 0; k < 3; k++)
        size[k] = info.box_max[k] - info.box_min[k];
    through.length = def->length > 0.0 ? fmax(def->length, 1.2 * vec3_length(size)) : 0.0;
    through.depth = def->through;
    return through;
}

/* It is held where it began, with a tremor, until it is outside. */
static int begin_at(struct force_lead *lead, double tilt, struct inside_result *result)
{
    const double height = lead->def->radius - lead->def->depth;
    struct place place;
    if (!force_lead_place(lead, &place))
        return 0;
    lead->tremor[0] = lead->tremor[1] = lead->tremor[2] = 0.0;
    force_lead_hold(lead, &place, tilt, height, 0.0);
    if (force_lead_gap(lead, &lead->device) > -lead->def->radius)
        return 1; /* it does not cross here */
    force_lead_start(lead);
    result->places++;
    for (int t = 0; t < 200; t++) {
        force_lead_tremor(lead);
        force_lead_hold(lead, &place, tilt, height, 0.0);
        force_lead_step(lead);
        if (lead->force.reason == DPT_FORCE_FREE && force_lead_gap(lead, &lead->device) > 0.0)
            break;
        result->felt += vec3_length(lead->force.wrench.force) > 0.0 || lead->force.reason != DPT_FORCE_INSIDE;
    }
    return 1;
}

static int begin_inside(const struct force_trial_def *def, double tilt, struct inside_result *result)
{
    struct force_lead lead;
    int is_done = force_lead_open(&lead, def);
    for (uint64_t i = 0; i < def->places && is_done; i++)
        is_done = begin_at(&lead, i % 2 ? tilt : 0.0, result);
    force_lead_close(&lead);
    return is_done;
}

int force_trial_inside(const struct force_trial_def *def, struct inside_result *result)
{
    const struct force_trial_def through = force_trial_through_def(def);
    *result = (struct inside_result){ .places = 0 };
    return begin_inside(def, 0.0, result) && begin_inside(&through, 1.4, result);
}
