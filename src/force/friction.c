/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

enum { SWEEPS_MAX = 24 };

/* Of the largest pull: sweeps end where nothing changes by more. */
#define SETTLED 1e-7

static double product(const double *a, const double *b, uint32_t n)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* One contact's pull, with all others as they are; y follows. Returns how much it changed. */
static double relax(struct friction_contact *contact, uint32_t n, double *y)
{
    const double limit = contact->coefficient * contact->multiplier;
    double wanted[2], changed = 0.0;
    for (int d = 0; d < 2; d++) {
        const double *across = contact->across[d];
        wanted[d] = contact->pull[d] -
                    (product(across, y, n) + contact->slip[d]) / product(across, across, n);
    }
    const double size = sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
    contact->is_slipping = size > limit;
    for (int d = 0; d < 2; d++) {
        const double pull = contact->is_slipping ? wanted[d] * (limit / size) : wanted[d];
        const double more = pull - contact->pull[d];
        for (uint32_t k = 0; k < n; k++)
            y[k] += more * contact->across[d][k];
        contact->pull[d] = pull;
        changed = max_of(changed, fabs(more));
    }
    return changed;
}

double dpti_friction_pulls(struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                           const double *goal)
{
    const uint32_t n = dimensions;
    double y[HALF_SPACE_DIMENSIONS], first[HALF_SPACE_DIMENSIONS], moved = 0.0, largest = 0.0;
    dpti_friction_goal(contacts, count, n, goal, y);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = 0; k < n; k++)
            y[k] += contacts[i].multiplier * contacts[i].normal[k];
        largest = max_of(largest, contacts[i].coefficient * contacts[i].multiplier);
    }
    memcpy(first, y, n * sizeof *y);
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        double changed = 0.0;
        for (uint32_t i = 0; i < count; i++)
            changed = max_of(changed, relax(&contacts[i], n, y));
        if (changed <= SETTLED * largest)
            break;
    }
    for (uint32_t k = 0; k < n; k++)
        moved = max_of(moved, fabs(y[k] - first[k]));
    return moved;
}

void dpti_friction_goal(const struct friction_contact *contacts, uint32_t count,
                        uint32_t dimensions, const double *goal, double *pulled)
{
    memcpy(pulled, goal, dimensions * sizeof *goal);
    for (uint32_t i = 0; i < count; i++)
        for (int d = 0; d < 2; d++)
            for (uint32_t k = 0; k < dimensions; k++)
                pulled[k] += contacts[i].pull[d] * contacts[i].across[d][k];
}
