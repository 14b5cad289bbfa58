/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Coulomb friction of contacts that hold a point under linear constraints (half_spaces.h): docs/algorithms/force.md. A
 * contact's tangential pull is at most its coefficient times its multiplier, and opposes slip. A contact that is no
 * point also opposes a turn about its normal.
 */
#ifndef DPT_FRICTION_H
#define DPT_FRICTION_H

#include "force/half_spaces.h"

/* One contact; all lengths in m. */
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

/*
 * Contacts at one place, such as a tip on two coplanar triangles, act as one contact: at their mean position, with the
 * sum of their limits, of which each has its share. Their tangents have the same directions.
 *
 * The pulls of all contacts, at given multipliers, by projected Gauss-Seidel: with
 *     y = goal + sum of multiplier * normal + sum of pull . across + torsion about
 * each contact is to move by -slip and turn by -turned, as far as its limits allow. It begins with the contacts' pulls;
 * if `is_first`, with the load divided in proportion to the limits.
 */
void dpti_friction_pulls(struct friction_contact *contacts, uint32_t count, uint32_t dimensions, const double *goal,
                         int is_first);

/*
 * Where all contacts are at one place, and stick there: the planes on which they hold the motion, and in `pulled` the
 * goal with what they pull with beside. Returns how many planes there are; 0 otherwise.
 */
enum { FRICTION_PLANES_MAX = 3 };
uint32_t dpti_friction_planes(const struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                              const double *goal, struct half_space planes[FRICTION_PLANES_MAX], double *pulled);

/* sum += share * (pull . across + torsion about) */
void dpti_friction_add(const struct friction_contact *contact, double share, uint32_t dimensions, double *sum);

/* goal + sum of pull . across + torsion about */
void dpti_friction_goal(const struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                        const double *goal, double *pulled);

/* ---- compliant surfaces: springs in series with the coupling ---- */

/*
 * half_spaces.h finds y = goal + sum of m normal for hard constraints. Where constraint i may be violated by v at the
 * cost of v^2 / (2 c), c its compliance, the multipliers are those m' >= 0 with
 *     (N + diag(c)) m' = N m      N_ij = normal_i . normal_j
 * for those that are not 0.
 *
 * Adds sum of (m - m') normal to `yielded`, and sets each share = m' / m, of the active constraints in their order.
 * Compliances are >= 0. Returns what the constraints store, sum of c m'^2 / 2.
 */
double dpti_yield(const struct half_space *spaces, const struct half_spaces_result *hard, uint32_t dimensions,
                  const double *compliance, double *share, double *yielded);

#endif
