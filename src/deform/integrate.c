/* SPDX-License-Identifier: BSD-3-Clause */
#include "deform/integrate.h"

#include <math.h>

/*
 * One mode, x'' = -w2 (x + t x') - c x'. The step's matrix has the trace 1 + (1 - h t w2 - s h2 w2) / (1 + h c) and the
 * determinant (1 - h t w2 + e h2 w2) / (1 + h c), where s is 1 for SYMPLECTIC and e is 1 for EULER. Its eigenvalues
 * are at most 1 while the determinant is, and while 1 + trace + determinant is not negative.
 */
double dpti_springs_limit(uint32_t integrator, double square, double viscosity, double drag)
{
    double limit = DPT_SPRINGS_STEP_MAX;
    if (!(square > 0.0))
        return limit;
    const double lead = viscosity - drag / square, root = lead * lead - 4.0 / square;
    if (integrator == DPT_INTEGRATOR_SYMPLECTIC)
        limit = sqrt(lead * lead + 4.0 / square) - lead;
    else {
        limit = viscosity + drag / square;
        if (lead > 0.0 && root >= 0.0 && lead - sqrt(root) < limit)
            limit = lead - sqrt(root);
    }
    return limit < DPT_SPRINGS_STEP_MAX ? limit : DPT_SPRINGS_STEP_MAX;
}

/* One substep of all slices that are awake. */
static uint32_t substep(struct dpt_springs *springs, const struct spring_motion *motion,
                        const struct spring_slice *from, struct spring_slice *to)
{
    const struct active_region *region = &springs->region;
    const float *load = springs->loads[springs->loaded].force;
    const float *points = springs->points[springs->at];
    float *next = springs->points[1 - springs->at], force[SPRING_ROWS];
    uint32_t bad = 0;
    for (uint32_t i = 0; i < region->count; i++) {
        const size_t slice = region->slices[i];
        springs->kernel.spring_forces(&springs->rows, (uint32_t)slice, points, force);
        bad |=
            springs->kernel.spring_move(motion, springs->nodes + slice, force, load + SPRING_ROWS * slice, from + slice,
                                        to + slice, next + SPRING_POINTS * slice, region->square + slice);
    }
    springs->at = 1 - springs->at;
    return bad;
}

int dpti_springs_substeps(struct dpt_springs *springs, double h, uint32_t count)
{
    const struct spring_slice *last = springs->state[springs->now];
    struct spring_slice *next = springs->state[1 - springs->now];
    struct spring_motion motion = { .step = (float)h,
                                    .scale = (float)springs->def.stiffness,
                                    .lead = (float)springs->lead,
                                    .far = (float)DPT_COORDINATE_MAX,
                                    .fast = (float)SPRING_FAST,
                                    .is_euler = springs->def.integrator == DPT_INTEGRATOR_EULER };
    uint32_t bad = 0;
    for (int k = 0; k < 3; k++)
        motion.gravity[k] = (float)springs->def.gravity[k];
    for (uint32_t i = 0; i < count && !bad; i++)
        bad = substep(springs, &motion, i ? next : last, next);
    if (!bad) {
        springs->now = 1 - springs->now;
        return 1;
    }
    for (uint32_t i = 0; i < springs->region.count; i++) {
        const size_t slice = springs->region.slices[i];
        springs->kernel.spring_points(last + slice, motion.lead, springs->points[springs->at] + SPRING_POINTS * slice);
    }
    return 0;
}
