/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Coulomb friction of contacts that hold a point under linear constraints (half_spaces.h): docs/algorithms/force.md. A
 * contact's tangential pull is at most its coefficient times its multiplier, and opposes slip. A contact that is no
 * point also opposes a turn about its normal.
 */
#ifndef DPT_FRICTION_H
#define DPT_FRICTION_H

#include "force/half_spaces.h"

/* One contact; all lengths in m. Vectors are 0 beyond the dimensions in use. */
struct friction_contact {
    uint32_t place; /* the number of the first contact at the same place: its own where it is alone, or the first */
    double share;   /* of all that its place holds, 0..1: 1 where it is alone */
    double normal[HALF_SPACE_DIMENSIONS];    /* of its constraint */
    double across[2][HALF_SPACE_DIMENSIONS]; /* how the contact point moves along two tangents */
    double multiplier;                       /* of the constraint, >= 0 */
    double coefficient;                      /* of friction, >= 0 */
    double slip[2];                          /* to be undone: its distance from where it stuck */
    double pull[2];                          /* in and out: what friction adds along the tangents */
    int is_slipping;                         /* out: the pull is at its limit */
    /* Torsion, about the normal: how the tool turns about it, in 1/m; the limit's arm; the turn that is to be made good;
       in and out: what friction adds, in m^2. */
    double about[HALF_SPACE_DIMENSIONS];
    double torsion_arm; /* m: the limit is coefficient * multiplier * this; 0: none */
    double turned;      /* rad */
    double torsion;
    double inverse[2][2], per_square; /* the solver's own */
};

/* Pulls that hold a motion together with the constraints that hold it. */
struct friction_problem {
    struct friction_contact *contacts;
    const uint32_t *contact_spaces; /* the constraint of each contact, an active one */
    uint32_t count;
    const struct half_space *spaces;
    struct half_spaces_result *solved; /* in and out: found with other pulls */
    const double *goal;                /* without pulls */
    uint32_t dimensions, space_count;
    double tolerance; /* a constraint that is missed by at most that counts as met */
    int is_fixed;     /* mean normals of places are not to follow the multipliers any more */
};

/*
 * Contacts at one place, such as a tip on two coplanar triangles, act as one contact: at their mean position, with the
 * sum of their limits, of which each has its share. Their tangents have the same directions.
 *
 * One pass between motion and pulls. With
 *     y = goal + sum of multiplier * normal + sum of pull . across + torsion about
 * each contact is to move by -slip and turn by -turned, as far as its limits allow; one that sticks yields by a
 * thousandth of its pull. The pulls begin as the contacts have them; if `is_first`, with the load divided in proportion to
 * the limits.
 *
 * `pulled` is the goal with the pulls with which `solved` was found. If it differs from the one with the pulls at these
 * multipliers by at most `settled`, returns 1. Otherwise it becomes the one to solve for next, where Newton's method on
 * multipliers and pulls together leads, and 0 is returned. Contacts have its pulls then. Where the constraints that hold the
 * motion still do so there, and are the only ones, it is solved for with that: `solved` follows, and all is done again.
 */
int dpti_friction_pass(const struct friction_problem *problem, int is_first, double settled, double *pulled);

/* sum += share * (pull . across + torsion about) */
void dpti_friction_add(const struct friction_contact *contact, double share, double sum[HALF_SPACE_DIMENSIONS]);

#endif
