/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Coulomb friction of contacts that hold a point under linear constraints (half_spaces.h): docs/algorithms/force.md. A
 * contact's tangential pull is at most its coefficient times its multiplier, and opposes slip.
 */
#ifndef DPT_FRICTION_H
#define DPT_FRICTION_H

#include "force/half_spaces.h"

/* One contact; all lengths in m. */
struct friction_contact {
    double normal[HALF_SPACE_DIMENSIONS];    /* of its constraint */
    double across[2][HALF_SPACE_DIMENSIONS]; /* how the contact point moves along two tangents */
    double multiplier;                       /* of the constraint, >= 0 */
    double coefficient;                      /* of friction, >= 0 */
    double slip[2];  /* that is to be made good: how far it is off where it stuck */
    double pull[2];  /* in and out: what friction adds along the tangents */
    int is_slipping; /* out: the pull is at its limit */
};

/*
 * The pulls of all contacts, at given multipliers, by projected Gauss-Seidel: with
 *     y = goal + sum of multiplier * normal + sum of pull . across
 * each contact is to move by -slip, as far as its cone allows. Returns how far the sum of the pulls moved y, at most.
 */
double dpti_friction_pulls(struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                           const double *goal);

/* goal + sum of pull . across */
void dpti_friction_goal(const struct friction_contact *contacts, uint32_t count,
                        uint32_t dimensions, const double *goal, double *pulled);

#endif
