/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction_pass.h"

#include <math.h>
#include <string.h>

/* Newton's method needs to know from them what slips, and about where to: more of them find little more. */
enum { SWEEPS_MAX = 6, LATER_SWEEPS_MAX = 2 };

/* So many further steps are made in a pass, while the same constraints hold the motion. */
enum { STEPS_MAX = 2 };

/* Sweeps end when no pull changes by more than this share of the largest pull. */
#define SETTLED 1e-7

/* A pull slips if it exceeds its limit by more than this share of it: rounding alone is no slip. */
#define SLIPPING 1e-5

void dpti_friction_add(const struct friction_contact *contact, double share, double sum[HALF_SPACE_DIMENSIONS])
{
    whole_add(sum, share * contact->pull[0], contact->across[0]);
    whole_add(sum, share * contact->pull[1], contact->across[1]);
    whole_add(sum, share * contact->torsion, contact->about);
}

/* What lies beyond the dimensions of the goal is 0. */
static void begin_at_goal(const struct friction_problem *problem, double *sum)
{
    memset(sum, 0, HALF_SPACE_DIMENSIONS * sizeof *sum);
    memcpy(sum, problem->goal, problem->dimensions * sizeof *sum);
}

/* ---- places ---- */

/* How far a place moves per pull, inverted. The tangents are unit vectors: the matrix is never singular. */
static void invert(struct friction_place *place)
{
    struct friction_contact *contact = &place->whole;
    const double yielding = YIELDING * (1.0 - place->share);
    const double a = yielding + whole_product_of(contact->across[0], contact->across[0]);
    const double b = whole_product_of(contact->across[0], contact->across[1]);
    const double c = yielding + whole_product_of(contact->across[1], contact->across[1]);
    const double about = whole_product_of(contact->about, contact->about);
    const double per_determinant = 1.0 / (a * c - b * b);
    contact->inverse[0][0] = c * per_determinant;
    contact->inverse[1][1] = a * per_determinant;
    contact->inverse[0][1] = contact->inverse[1][0] = -b * per_determinant;
    contact->per_square = about > 0.0 ? 1.0 / about : 0.0;
}

static void add_to_place(struct friction_contact *whole, const struct friction_contact *contact)
{
    const double share = contact->share;
    whole->multiplier += contact->multiplier;
    whole_add(whole->across[0], share, contact->across[0]);
    whole_add(whole->across[1], share, contact->across[1]);
    whole_add(whole->about, share, contact->about);
    for (int d = 0; d < 2; d++) {
        whole->slip[d] += share * contact->slip[d];
        whole->pull[d] += contact->pull[d];
    }
    whole->turned += share * contact->turned;
    whole->torsion += contact->torsion;
}

static void list_members(const struct friction_problem *problem, uint32_t first, struct friction_place *place)
{
    const struct half_spaces_result *solved = problem->solved;
    place->count = 0;
    for (uint32_t i = first; i < problem->count; i++) {
        uint32_t active = 0;
        if (problem->contacts[i].place != first)
            continue;
        while (solved->active[active] != problem->contact_spaces[i])
            active++;
        place->member[place->count++] = (struct friction_member){ &problem->contacts[i], active };
    }
}

/* The mean of a place's contacts by what they hold, and all that they hold. */
static void merge_place(const struct friction_problem *problem, uint32_t first, struct friction_place *place)
{
    struct friction_contact *whole = &place->whole;
    double limit = 0.0;
    list_members(problem, first, place);
    if (place->count == 1) {
        *whole = problem->contacts[first];
        return;
    }
    *whole = (struct friction_contact){ .torsion_arm = problem->contacts[first].torsion_arm };
    for (uint32_t i = 0; i < place->count; i++) {
        limit += limit_of(place->member[i].contact);
        add_to_place(whole, place->member[i].contact);
    }
    whole->coefficient = whole->multiplier > 0.0 ? limit / whole->multiplier : 0.0;
}

/* What the contacts of a place pull with. */
static void divide_place(const struct friction_place *place)
{
    const struct friction_contact *whole = &place->whole;
    for (uint32_t i = 0; i < place->count; i++) {
        struct friction_contact *contact = place->member[i].contact;
        contact->pull[0] = contact->share * whole->pull[0];
        contact->pull[1] = contact->share * whole->pull[1];
        contact->torsion = contact->share * whole->torsion;
        contact->is_slipping = whole->is_slipping;
    }
}

/* ---- sweeps ---- */

static void change_pull(struct friction_pass *pass, struct friction_contact *whole, int d, double more)
{
    whole->pull[d] += more;
    whole_add(pass->y, more, whole->across[d]);
    pass->pull = along(pass->pull, more, vec3_of(whole->across[d]));
}

/* The pull of one place, with all others as they are. Returns how much it changed. */
static double relax(struct friction_pass *pass, struct friction_place *place)
{
    struct friction_contact *whole = &place->whole;
    const double limit = limit_of(whole);
    double wanted[2], changed = 0.0;
    const double size = pull_to_rest(pass, place, wanted);
    whole->is_slipping = size > (1.0 + SLIPPING) * limit;
    for (int d = 0; d < 2; d++) {
        const double more = (size > limit ? wanted[d] * (limit / size) : wanted[d]) - whole->pull[d];
        change_pull(pass, whole, d, more);
        changed = max_of(changed, fabs(more));
    }
    return changed;
}

/* The same of its torsion. */
static double relax_torsion(struct friction_contact *contact, double *y)
{
    const double limit = torsion_limit_of(contact);
    if (!(limit > 0.0 && contact->per_square > 0.0)) {
        contact->torsion = 0.0;
        return 0.0;
    }
    const double wanted =
        contact->torsion - (whole_product_of(contact->about, y) + contact->turned) * contact->per_square;
    const double torsion = min_of(max_of(wanted, -limit), limit);
    const double more = torsion - contact->torsion;
    whole_add(y, more, contact->about);
    contact->torsion = torsion;
    return fabs(more) / contact->torsion_arm;
}

/*
 * To begin with, places share what is to be held as their limits are. One alone would take all that it can, and slip
 * where all together hold.
 */
static void share_out(struct friction_pass *pass)
{
    double pulls[HALF_SPACE_DIMENSIONS][2];
    for (uint32_t i = 0; i < pass->count; i++) {
        const struct friction_place *place = &pass->place[i];
        const double limit = limit_of(&place->whole), size = place->share * pull_to_rest(pass, place, pulls[i]);
        const double part = size > limit ? place->share * limit / size : place->share;
        pulls[i][0] *= part;
        pulls[i][1] *= part;
    }
    for (uint32_t i = 0; i < pass->count; i++)
        for (int d = 0; d < 2; d++)
            change_pull(pass, &pass->place[i].whole, d, pulls[i][d]);
}

static void begin_pass(const struct friction_problem *problem, int is_first, struct friction_pass *pass)
{
    double limits = 0.0;
    pass->problem = problem;
    pass->count = 0;
    pass->pull = (vec3){ 0.0, 0.0, 0.0 };
    begin_at_goal(problem, pass->y);
    for (uint32_t k = 0; k < problem->solved->active_count; k++)
        whole_add(pass->y, problem->solved->multiplier[k], problem->spaces[problem->solved->active[k]].normal);
    for (uint32_t i = 0; i < problem->count; i++)
        if (problem->contacts[i].place == i)
            merge_place(problem, i, &pass->place[pass->count++]);
    for (uint32_t i = 0; i < pass->count; i++)
        limits += limit_of(&pass->place[i].whole);
    for (uint32_t i = 0; i < pass->count; i++) {
        struct friction_place *place = &pass->place[i];
        struct friction_contact *whole = &place->whole;
        place->share = limits > 0.0 ? limit_of(whole) / limits : 0.0;
        invert(place);
        if (is_first)
            whole->pull[0] = whole->pull[1] = whole->torsion = 0.0;
        dpti_friction_add(whole, 1.0, pass->y);
        for (int d = 0; d < 2; d++)
            pass->pull = along(pass->pull, whole->pull[d], vec3_of(whole->across[d]));
    }
    if (is_first)
        share_out(pass);
}

static void sweep(struct friction_pass *pass, int most)
{
    double largest = 0.0, changed = HUGE_VAL;
    for (uint32_t i = 0; i < pass->count; i++)
        largest = max_of(largest, limit_of(&pass->place[i].whole));
    for (int k = 0; k < most && changed > SETTLED * largest; k++) {
        changed = 0.0;
        for (uint32_t i = 0; i < pass->count; i++) {
            changed = max_of(changed, relax(pass, &pass->place[i]));
            changed = max_of(changed, relax_torsion(&pass->place[i].whole, pass->y));
        }
    }
}

/* ---- a pass ---- */

/* Divide the pulls of the places, and add them to the goal. */
static void end_pass(const struct friction_pass *pass, double *pulled)
{
    const struct friction_problem *problem = pass->problem;
    begin_at_goal(problem, pulled);
    for (uint32_t i = 0; i < pass->count; i++)
        divide_place(&pass->place[i]);
    for (uint32_t i = 0; i < problem->count; i++)
        dpti_friction_add(&problem->contacts[i], 1.0, pulled);
}

/*
 * Whether the active constraints hold the motion with these pulls as well, with the multipliers that a step has found, and
 * nothing else does: then it is the answer of the half spaces.
 */
static int is_answer(const struct friction_pass *pass, const double *pulled, double *y)
{
    const struct friction_problem *problem = pass->problem;
    const struct half_spaces_result *solved = problem->solved;
    for (uint32_t i = 0; i < pass->count; i++)
        if (pass->place[i].count > 1 && !problem->is_fixed)
            return 0;
    memcpy(y, pulled, HALF_SPACE_DIMENSIONS * sizeof *y);
    for (uint32_t k = 0; k < solved->active_count; k++) {
        if (!(pass->multiplier[k] > 0.0))
            return 0;
        whole_add(y, pass->multiplier[k], problem->spaces[solved->active[k]].normal);
    }
    for (uint32_t i = 0; i < problem->space_count; i++) {
        const struct half_space *space = &problem->spaces[i];
        if ((whole_product_of(space->normal, y) - space->bound) * space->per_length < -problem->tolerance)
            return 0;
    }
    for (uint32_t k = 0; k < solved->active_count; k++) {
        const struct half_space *space = &problem->spaces[solved->active[k]];
        if ((whole_product_of(space->normal, y) - space->bound) * space->per_length > problem->tolerance)
            return 0;
    }
    return 1;
}

int dpti_friction_pass(const struct friction_problem *problem, int is_first, double settled, double *pulled)
{
    struct friction_pass pass;
    for (int step = 0;; step++) {
        double next[HALF_SPACE_DIMENSIONS], changed = 0.0;
        const int begins = is_first && step == 0;
        begin_pass(problem, begins, &pass);
        sweep(&pass, begins && pass.count > 1 ? SWEEPS_MAX : LATER_SWEEPS_MAX);
        end_pass(&pass, next);
        for (uint32_t k = 0; k < problem->dimensions; k++)
            changed = max_of(changed, fabs(next[k] - pulled[k]));
        if (changed <= settled)
            return 1;
        dpti_friction_step(&pass);
        end_pass(&pass, pulled);
        if (step == STEPS_MAX || !is_answer(&pass, pulled, next))
            return 0;
        memcpy(problem->solved->y, next, sizeof next);
        memcpy(problem->solved->multiplier, pass.multiplier, problem->solved->active_count * sizeof *pass.multiplier);
    }
}
