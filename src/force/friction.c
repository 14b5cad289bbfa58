/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

/* Newton's method needs to know from them what slips, and about where to: more of them find little more. */
enum { SWEEPS_MAX = 6 };

/* Sweeps end when no pull changes by more than this share of the largest pull. */
#define SETTLED 1e-7

/* A pull slips if it exceeds its limit by more than this share of it: rounding alone is no slip. */
#define SLIPPING 1e-5

/*
 * How far a place that sticks yields, per pull beyond its share of what all places pull. Two that stick hold the distance
 * between them, which no motion of a tool changes: without this, what each of them is off would wind up a tension between
 * them.
 */
#define YIELDING 1e-3

/* As a share of the limit: a larger torsion counts as being at it, as the shares of a place are rounded. */
#define TURNING (1.0 - 1e-9)

/* The contacts of a place as one. */
struct friction_place {
    struct friction_contact whole;
    uint32_t first;   /* its first contact */
    double share;     /* of the limits of all places */
    uint32_t active;  /* a bit for each active constraint that is a contact of it */
    uint32_t unknown; /* of Newton's: its first pull */
};

struct friction_pass {
    const struct friction_problem *problem;
    struct friction_place place[HALF_SPACE_DIMENSIONS];
    uint32_t count;
    double y[HALF_SPACE_DIMENSIONS]; /* the motion, with all multipliers and pulls */
    vec3 pull;                       /* of all places together */
};

static double limit_of(const struct friction_contact *contact)
{
    return contact->coefficient * contact->multiplier;
}

static double torsion_limit_of(const struct friction_contact *contact)
{
    return limit_of(contact) * contact->torsion_arm;
}

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

/* The mean of a place's contacts by what they hold, and all that they hold. */
static void merge_place(const struct friction_problem *problem, uint32_t first, struct friction_place *place)
{
    const struct half_spaces_result *solved = problem->solved;
    struct friction_contact *whole = &place->whole;
    double limit = 0.0;
    *place = (struct friction_place){ .first = first, .whole.torsion_arm = problem->contacts[first].torsion_arm };
    for (uint32_t i = first; i < problem->count; i++) {
        const struct friction_contact *contact = &problem->contacts[i];
        if (contact->place != first)
            continue;
        limit += limit_of(contact);
        add_to_place(whole, contact);
        for (uint32_t k = 0; k < solved->active_count; k++)
            if (solved->active[k] == problem->contact_spaces[i])
                place->active |= 1u << k;
    }
    whole->coefficient = whole->multiplier > 0.0 ? limit / whole->multiplier : 0.0;
}

/* What the contacts of a place pull with. */
static void divide_place(const struct friction_problem *problem, const struct friction_place *place)
{
    const struct friction_contact *whole = &place->whole;
    for (uint32_t i = place->first; i < problem->count; i++) {
        struct friction_contact *contact = &problem->contacts[i];
        if (contact->place != place->first)
            continue;
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

/* How far a place is from where it is to be. */
static void missed_by(const struct friction_pass *pass, const struct friction_place *place, double missed[2])
{
    const struct friction_contact *whole = &place->whole;
    for (int d = 0; d < 2; d++) {
        const double due = place->share * dot(pass->pull, vec3_of(whole->across[d]));
        missed[d] = whole_product_of(whole->across[d], pass->y) + whole->slip[d] + YIELDING * (whole->pull[d] - due);
    }
}

/* The pull that brings a place to rest, with all others as they are; returns its size. */
static double pull_to_rest(const struct friction_pass *pass, const struct friction_place *place, double wanted[2])
{
    const struct friction_contact *whole = &place->whole;
    double missed[2];
    missed_by(pass, place, missed);
    for (int d = 0; d < 2; d++)
        wanted[d] = whole->pull[d] - whole->inverse[d][0] * missed[0] - whole->inverse[d][1] * missed[1];
    return sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1]);
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

static void sweep(struct friction_pass *pass)
{
    double largest = 0.0, changed = HUGE_VAL;
    for (uint32_t i = 0; i < pass->count; i++)
        largest = max_of(largest, limit_of(&pass->place[i].whole));
    for (int k = 0; k < SWEEPS_MAX && changed > SETTLED * largest; k++) {
        changed = 0.0;
        for (uint32_t i = 0; i < pass->count; i++) {
            changed = max_of(changed, relax(pass, &pass->place[i]));
            changed = max_of(changed, relax_torsion(&pass->place[i].whole, pass->y));
        }
    }
}

/* ---- Newton's method ---- */

/* By how much multipliers of active constraints change, and pulls and torsion of each place. */
enum { UNKNOWNS_MAX = 4 * HALF_SPACE_DIMENSIONS };

/*
 * The equations of Newton's method (Alart and Curnier 1991): active constraints stay met, what sticks comes to rest, and
 * what slips keeps its pull W / |W| times its limit, W the pull that would bring it to rest.
 */
struct newton {
    uint32_t count;
    const double *row[UNKNOWNS_MAX];                  /* what an equation takes of the change of y */
    double adds[UNKNOWNS_MAX][HALF_SPACE_DIMENSIONS]; /* what an unknown adds to y */
    double a[UNKNOWNS_MAX][UNKNOWNS_MAX], right[UNKNOWNS_MAX];
};

static void add_unknown(struct newton *newton, const double *row, double missing)
{
    newton->row[newton->count] = row;
    memcpy(newton->adds[newton->count], row, sizeof newton->adds[newton->count]);
    newton->right[newton->count++] = missing;
}

static int is_turning(const struct friction_contact *whole)
{
    return !(fabs(whole->torsion) < TURNING * torsion_limit_of(whole));
}

/* A multiplier that grows moves the middle of its place to its contact, and its torsion if that is at its limit. */
static void move_middle(struct newton *newton, const struct friction_place *place,
                        const struct friction_contact *contact, uint32_t multiplier)
{
    const struct friction_contact *whole = &place->whole;
    double *adds = newton->adds[multiplier];
    for (int d = 0; d < 2; d++) {
        whole_add(adds, whole->pull[d] / whole->multiplier, contact->across[d]);
        whole_add(adds, -whole->pull[d] / whole->multiplier, whole->across[d]);
    }
    if (is_turning(whole))
        whole_add(adds, whole->torsion / whole->multiplier, whole->about);
}

static void add_place(struct newton *newton, struct friction_pass *pass, struct friction_place *place)
{
    const struct friction_problem *problem = pass->problem;
    const struct friction_contact *whole = &place->whole;
    double missed[2];
    for (uint32_t i = place->first; i < problem->count; i++)
        for (uint32_t k = 0; k < problem->solved->active_count; k++)
            if (problem->contacts[i].place == place->first && problem->solved->active[k] == problem->contact_spaces[i])
                move_middle(newton, place, &problem->contacts[i], k);
    missed_by(pass, place, missed);
    place->unknown = newton->count;
    add_unknown(newton, whole->across[0], -missed[0]);
    add_unknown(newton, whole->across[1], -missed[1]);
    if (!is_turning(whole) && whole->per_square > 0.0)
        add_unknown(newton, whole->about, -whole->turned - whole_product_of(whole->about, pass->y));
}

/* What slips: dpull = d(W / |W|) limit + (W / |W|) dlimit, with dW = dpull - inverse dmissed. */
static void let_slip(struct newton *newton, const struct friction_place *place, const double wanted[2], double size)
{
    const struct friction_contact *whole = &place->whole;
    const double limit = limit_of(whole);
    double missed[2][UNKNOWNS_MAX];
    memcpy(missed, newton->a[place->unknown], sizeof missed);
    for (uint32_t d = 0; d < 2; d++) {
        const uint32_t number = place->unknown + d;
        double *row = newton->a[number], turns[2];
        for (uint32_t e = 0; e < 2; e++)
            turns[e] = limit / size * ((d == e) - wanted[d] * wanted[e] / (size * size));
        for (uint32_t j = 0; j < newton->count; j++) {
            row[j] = 0.0;
            for (uint32_t e = 0; e < 2; e++)
                row[j] += turns[e] * (whole->inverse[e][0] * missed[0][j] + whole->inverse[e][1] * missed[1][j]);
            if (place->active >> j & 1)
                row[j] -= whole->coefficient * wanted[d] / size;
        }
        row[number] += 1.0;
        row[place->unknown] -= turns[0];
        row[place->unknown + 1] -= turns[1];
        newton->right[number] = limit * wanted[d] / size - whole->pull[d];
    }
}

static void set_place(struct newton *newton, const struct friction_pass *pass, const struct friction_place *place)
{
    const struct friction_problem *problem = pass->problem;
    const struct friction_contact *whole = &place->whole;
    double wanted[2];
    for (uint32_t d = 0; d < 2; d++) {
        double *row = newton->a[place->unknown + d];
        const double of_whole = whole_product_of(whole->across[d], pass->y) + whole->slip[d];
        row[place->unknown + d] += YIELDING;
        for (uint32_t i = 0; i < pass->count; i++)
            for (uint32_t e = 0; e < 2 && limit_of(&pass->place[i].whole) > 0.0; e++)
                row[pass->place[i].unknown + e] -=
                    YIELDING * place->share * dot(vec3_of(pass->place[i].whole.across[e]), vec3_of(whole->across[d]));
        for (uint32_t i = place->first; i < problem->count; i++) {
            const struct friction_contact *contact = &problem->contacts[i];
            for (uint32_t k = 0; k < problem->solved->active_count; k++)
                if (contact->place == place->first && problem->solved->active[k] == problem->contact_spaces[i])
                    row[k] += (whole_product_of(contact->across[d], pass->y) + contact->slip[d] - of_whole) /
                              whole->multiplier;
        }
    }
    const double size = pull_to_rest(pass, place, wanted);
    if (size > limit_of(whole))
        let_slip(newton, place, wanted, size);
}

static void set_equations(struct newton *newton, struct friction_pass *pass)
{
    const struct friction_problem *problem = pass->problem;
    newton->count = 0;
    for (uint32_t k = 0; k < problem->solved->active_count; k++) {
        const struct half_space *space = &problem->spaces[problem->solved->active[k]];
        add_unknown(newton, space->normal, space->bound - whole_product_of(space->normal, pass->y));
    }
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            add_place(newton, pass, &pass->place[i]);
    for (uint32_t i = 0; i < newton->count; i++)
        for (uint32_t j = 0; j < newton->count; j++)
            newton->a[i][j] = whole_product_of(newton->row[i], newton->adds[j]);
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            set_place(newton, pass, &pass->place[i]);
}

/* As a share of the largest coefficient: with a smaller pivot an unknown depends on others, and stays as it is. */
#define PIVOT_MIN 1e-9

static void swap_rows(double *one, double *other, uint32_t count)
{
    for (uint32_t j = 0; j < count; j++) {
        const double kept = one[j];
        one[j] = other[j];
        other[j] = kept;
    }
}

/* Eliminate one column below its pivot. Returns 0 if it has none. */
static int eliminate(struct newton *newton, uint32_t rank, uint32_t column, double pivot_min)
{
    const uint32_t m = newton->count;
    uint32_t best = rank;
    for (uint32_t i = rank + 1; i < m; i++)
        if (fabs(newton->a[i][column]) > fabs(newton->a[best][column]))
            best = i;
    if (!(fabs(newton->a[best][column]) > pivot_min))
        return 0;
    if (best != rank) {
        swap_rows(newton->a[best], newton->a[rank], m);
        swap_rows(&newton->right[best], &newton->right[rank], 1);
    }
    for (uint32_t i = rank + 1; i < m; i++) {
        const double part = newton->a[i][column] / newton->a[rank][column];
        for (uint32_t j = column; j < m; j++)
            newton->a[i][j] -= part * newton->a[rank][j];
        newton->right[i] -= part * newton->right[rank];
    }
    return 1;
}

/* Gauss's elimination. It leaves nothing of the equations. */
static void solve_newton(struct newton *newton, double *x)
{
    const uint32_t m = newton->count;
    uint32_t pivots[UNKNOWNS_MAX], rank = 0;
    double largest = 0.0;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < m; j++)
            largest = max_of(largest, fabs(newton->a[i][j]));
    for (uint32_t column = 0; column < m; column++) {
        x[column] = 0.0;
        if (eliminate(newton, rank, column, PIVOT_MIN * largest))
            pivots[rank++] = column;
    }
    while (rank-- > 0) {
        double left = newton->right[rank];
        for (uint32_t j = pivots[rank] + 1; j < m; j++)
            left -= newton->a[rank][j] * x[j];
        x[pivots[rank]] = left / newton->a[rank][pivots[rank]];
    }
}

/* Solve; a constraint that would have to pull leaves. */
static void solve_pushing(const struct newton *newton, const struct half_spaces_result *solved, double *x)
{
    uint32_t leaving = 0;
    for (;;) {
        struct newton left = *newton;
        uint32_t worst = solved->active_count;
        double lowest = 0.0;
        for (uint32_t k = 0; k < solved->active_count; k++)
            if (leaving >> k & 1) {
                memset(left.a[k], 0, sizeof left.a[k]);
                left.a[k][k] = 1.0;
                left.right[k] = -solved->multiplier[k];
            }
        solve_newton(&left, x);
        for (uint32_t k = 0; k < solved->active_count; k++)
            if (!(leaving >> k & 1) && solved->multiplier[k] + x[k] < lowest) {
                lowest = solved->multiplier[k] + x[k];
                worst = k;
            }
        if (worst == solved->active_count)
            return;
        leaving |= 1u << worst;
    }
}

/* Change the multipliers of a place, and so its shares, its pulls and its torsion. */
static void take_step(const struct friction_problem *problem, struct friction_place *place, const double *x)
{
    const int turns = is_turning(&place->whole);
    double multiplier = 0.0;
    for (uint32_t i = place->first; i < problem->count; i++) {
        struct friction_contact *contact = &problem->contacts[i];
        for (uint32_t k = 0; k < problem->solved->active_count; k++)
            if (contact->place == place->first && problem->solved->active[k] == problem->contact_spaces[i]) {
                contact->multiplier = max_of(0.0, contact->multiplier + x[k]);
                multiplier += contact->multiplier;
            }
    }
    for (uint32_t i = place->first; i < problem->count && multiplier > 0.0; i++)
        if (problem->contacts[i].place == place->first)
            problem->contacts[i].share = problem->contacts[i].multiplier / multiplier;
    place->whole.pull[0] += x[place->unknown];
    place->whole.pull[1] += x[place->unknown + 1];
    if (turns)
        place->whole.torsion *= multiplier / place->whole.multiplier;
    else if (place->whole.per_square > 0.0)
        place->whole.torsion += x[place->unknown + 2];
}

static void step_on(struct friction_pass *pass)
{
    struct newton newton;
    double x[UNKNOWNS_MAX];
    set_equations(&newton, pass);
    solve_pushing(&newton, pass->problem->solved, x);
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            take_step(pass->problem, &pass->place[i], x);
}

/* ---- a pass ---- */

/* Divide the pulls of the places, and add them to the goal. */
static void end_pass(const struct friction_pass *pass, double *pulled)
{
    const struct friction_problem *problem = pass->problem;
    begin_at_goal(problem, pulled);
    for (uint32_t i = 0; i < pass->count; i++)
        divide_place(problem, &pass->place[i]);
    for (uint32_t i = 0; i < problem->count; i++)
        dpti_friction_add(&problem->contacts[i], 1.0, pulled);
}

int dpti_friction_pass(const struct friction_problem *problem, int is_first, double settled, double *pulled)
{
    struct friction_pass pass;
    double next[HALF_SPACE_DIMENSIONS], changed = 0.0;
    begin_pass(problem, is_first, &pass);
    sweep(&pass);
    end_pass(&pass, next);
    for (uint32_t k = 0; k < problem->dimensions; k++)
        changed = max_of(changed, fabs(next[k] - pulled[k]));
    if (changed <= settled)
        return 1;
    step_on(&pass);
    end_pass(&pass, pulled);
    return 0;
}
