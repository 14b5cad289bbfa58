/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction.h"

#include "base/vec3.h"

#include <math.h>
#include <string.h>

enum { SWEEPS_MAX = 24 };

/* Of the largest pull: sweeps end where nothing changes by more. */
#define SETTLED 1e-7

/* Of its limit: a pull that rests at the limit does not slip by what rounding adds. */
#define SLIPPING 1e-5

static double limit_of(const struct friction_contact *contact)
{
    return contact->coefficient * contact->multiplier;
}

/* The pull that brings a contact to rest, with all others as they are; returns its size. */
static double pull_to_rest(const struct friction_contact *contact, uint32_t n, const double *y,
                           double wanted[2])
{
    const double moves[2] = { product_of(contact->across[0], y, n) + contact->slip[0],
                              product_of(contact->across[1], y, n) + contact->slip[1] };
    for (int d = 0; d < 2; d++)
        wanted[d] = contact->pull[d] - contact->inverse[d][0] * moves[0] -
                    contact->inverse[d][1] * moves[1];
    return sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
}

/* One contact's pull, with all others as they are; y follows. Returns how much it changed. */
static double relax(struct friction_contact *contact, uint32_t n, double *y)
{
    const double limit = limit_of(contact);
    double wanted[2], changed = 0.0;
    const double size = pull_to_rest(contact, n, y, wanted);
    contact->is_slipping = size > (1.0 + SLIPPING) * limit;
    for (int d = 0; d < 2; d++) {
        const double pull = size > limit ? wanted[d] * (limit / size) : wanted[d];
        const double more = pull - contact->pull[d];
        for (uint32_t k = 0; k < n; k++)
            y[k] += more * contact->across[d][k];
        contact->pull[d] = pull;
        changed = max_of(changed, fabs(more));
    }
    return changed;
}

void dpti_friction_add(const struct friction_contact *contact, double share, uint32_t dimensions,
                       double *sum)
{
    for (uint32_t k = 0; k < dimensions; k++)
        sum[k] += share *
                  (contact->pull[0] * contact->across[0][k] +
                   contact->pull[1] * contact->across[1][k] + contact->torsion * contact->about[k]);
}

/*
 * To begin with, contacts share what is to be held as their limits are. One alone would take all that it can, and slip
 * where all together hold.
 */
static void share_out(struct friction_contact *contacts, uint32_t count, uint32_t n, double *y)
{
    double limits = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        limits += limit_of(&contacts[i]);
        contacts[i].pull[0] = contacts[i].pull[1] = contacts[i].torsion = 0.0;
    }
    for (uint32_t i = 0; i < count && limits > 0.0; i++) {
        double wanted[2];
        const double limit = limit_of(&contacts[i]), share = limit / limits;
        const double size = share * pull_to_rest(&contacts[i], n, y, wanted);
        const double part = size > limit ? share * limit / size : share;
        contacts[i].pull[0] = part * wanted[0];
        contacts[i].pull[1] = part * wanted[1];
    }
    for (uint32_t i = 0; i < count; i++)
        dpti_friction_add(&contacts[i], 1.0, n, y);
}

/* The same of its torsion. */
static double relax_torsion(struct friction_contact *contact, uint32_t n, double *y)
{
    const double limit = limit_of(contact) * contact->torsion_arm;
    if (!(limit > 0.0 && contact->per_square > 0.0)) {
        contact->torsion = 0.0;
        return 0.0;
    }
    const double wanted = contact->torsion - (product_of(contact->about, y, n) + contact->turned) *
                                                 contact->per_square;
    const double torsion = min_of(max_of(wanted, -limit), limit);
    const double more = torsion - contact->torsion;
    for (uint32_t k = 0; k < n; k++)
        y[k] += more * contact->about[k];
    contact->torsion = torsion;
    return fabs(more) / contact->torsion_arm;
}

/* How far a contact moves per pull, inverted. The tangents are unit vectors: the matrix is never singular. */
static void invert(struct friction_contact *contact, uint32_t n)
{
    const double a = product_of(contact->across[0], contact->across[0], n);
    const double b = product_of(contact->across[0], contact->across[1], n);
    const double c = product_of(contact->across[1], contact->across[1], n);
    const double about = product_of(contact->about, contact->about, n);
    const double per_determinant = 1.0 / (a * c - b * b);
    contact->inverse[0][0] = c * per_determinant;
    contact->inverse[1][1] = a * per_determinant;
    contact->inverse[0][1] = contact->inverse[1][0] = -b * per_determinant;
    contact->per_square = about > 0.0 ? 1.0 / about : 0.0;
}

void dpti_friction_pulls(struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                         const double *goal, int is_first)
{
    const uint32_t n = dimensions;
    double y[HALF_SPACE_DIMENSIONS], largest = 0.0;
    memcpy(y, goal, n * sizeof *y);
    for (uint32_t i = 0; i < count; i++) {
        struct friction_contact *contact = &contacts[i];
        for (uint32_t k = 0; k < n; k++)
            y[k] += contact->multiplier * contact->normal[k];
        invert(contact, n);
        largest = max_of(largest, limit_of(contact));
    }
    if (is_first)
        share_out(contacts, count, n, y);
    else
        for (uint32_t i = 0; i < count; i++)
            dpti_friction_add(&contacts[i], 1.0, n, y);
    for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
        double changed = 0.0;
        for (uint32_t i = 0; i < count; i++) {
            changed = max_of(changed, relax(&contacts[i], n, y));
            changed = max_of(changed, relax_torsion(&contacts[i], n, y));
        }
        if (changed <= SETTLED * largest)
            break;
    }
}

void dpti_friction_goal(const struct friction_contact *contacts, uint32_t count,
                        uint32_t dimensions, const double *goal, double *pulled)
{
    memcpy(pulled, goal, dimensions * sizeof *goal);
    for (uint32_t i = 0; i < count; i++)
        dpti_friction_add(&contacts[i], 1.0, dimensions, pulled);
}
