/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What one pass of friction (friction.h) works with: the places, the motion, and the step of Newton's method on all of them
 * together. docs/algorithms/force.md.
 */
#ifndef DPT_FRICTION_PASS_H
#define DPT_FRICTION_PASS_H

#include <math.h>

#include "base/vec3.h"
#include "force/friction.h"

/*
 * How far a place that sticks yields, per pull beyond its share of what all places pull. Two that stick hold the distance
 * between them, which no motion of a tool changes: without this, what each of them is off would wind up a tension between
 * them.
 */
#define YIELDING 1e-3

/* A contact of a place, and which of the active constraints is its own. */
struct friction_member {
    struct friction_contact *contact;
    uint32_t active;
};

/* The contacts of a place as one. */
struct friction_place {
    struct friction_contact whole;
    struct friction_member member[HALF_SPACE_DIMENSIONS];
    uint32_t count;   /* of them */
    uint32_t unknown; /* of Newton's: its first pull */
    int slips, turns; /* in Newton's equations the pull, and the torsion, is at its limit */
    double share;     /* of the limits of all places */
};

struct friction_pass {
    const struct friction_problem *problem;
    uint32_t count;
    double y[HALF_SPACE_DIMENSIONS];          /* the motion, with all multipliers and pulls */
    vec3 pull;                                /* of all places together */
    double multiplier[HALF_SPACE_DIMENSIONS]; /* of the active constraints, after a step */
    struct friction_place place[HALF_SPACE_DIMENSIONS];
};

/* m: the most that a place can pull with; m^2: that its torsion can. */
static inline double limit_of(const struct friction_contact *contact)
{
    return contact->coefficient * contact->multiplier;
}

static inline double torsion_limit_of(const struct friction_contact *contact)
{
    return limit_of(contact) * contact->torsion_arm;
}

/* How far a place is from where it is to be. */
static inline void missed_by_place(const struct friction_pass *pass, const struct friction_place *place,
                                   double missed[2])
{
    const struct friction_contact *whole = &place->whole;
    for (int d = 0; d < 2; d++) {
        missed[d] = whole_product_of(whole->across[d], pass->y) + whole->slip[d];
        if (pass->count > 1)
            missed[d] += YIELDING * (whole->pull[d] - place->share * dot(pass->pull, vec3_of(whole->across[d])));
    }
}

/* The pull that brings a place to rest, with all others as they are; returns its size. */
static inline double pull_to_rest(const struct friction_pass *pass, const struct friction_place *place,
                                  double wanted[2])
{
    const struct friction_contact *whole = &place->whole;
    double missed[2];
    missed_by_place(pass, place, missed);
    for (int d = 0; d < 2; d++)
        wanted[d] = whole->pull[d] - whole->inverse[d][0] * missed[0] - whole->inverse[d][1] * missed[1];
    return sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
}

/*
 * A step of Newton's method on multipliers, pulls and torsions (Alart and Curnier 1991): active constraints stay met, what
 * sticks comes to rest, what slips keeps the way that it would be pulled back. What would have to pull beyond its limit to
 * stick slips; then a constraint that would have to pull leaves. Contacts have the new multipliers and shares, places the
 * new pulls.
 */
void dpti_friction_step(struct friction_pass *pass);

#endif
