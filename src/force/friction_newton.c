/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction_pass.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* As a share of its limit: by how much more Newton's method may let stick what pulls. */
#define EXCEEDING 1e-9

/* As a share of the limit: a larger torsion counts as being at it, as the shares of a place are rounded. */
#define TURNING (1.0 - 1e-9)

/* By how much multipliers of active constraints change, and pulls and torsion of each place. */
enum { UNKNOWNS_MAX = 4 * HALF_SPACE_DIMENSIONS };

/*
 * The equations of Newton's method (Alart and Curnier 1991): active constraints stay met, what sticks comes to rest, and
 * what slips keeps its pull W / |W| times its limit, W the pull that would bring it to rest. Each has a row, what it takes
 * of the change of y, and its right side. An unknown adds its own row to y.
 */
struct newton {
    uint32_t count;
    const double *row[UNKNOWNS_MAX];
    double a[UNKNOWNS_MAX][UNKNOWNS_MAX];
    double right[UNKNOWNS_MAX];
    /* What is solved for no more: it is its right side, and a share of what the multipliers of a place change by. */
    uint32_t is_known;                             /* a bit for each */
    const struct friction_place *of[UNKNOWNS_MAX]; /* NULL: no share */
    double share[UNKNOWNS_MAX];
};

static void add_unknown(struct newton *newton, const double *row, double missing)
{
    newton->row[newton->count] = row;
    newton->right[newton->count++] = missing;
}

static int is_turning(const struct friction_contact *whole)
{
    return !(fabs(whole->torsion) < TURNING * torsion_limit_of(whole));
}

static void add_place(struct newton *newton, const struct friction_pass *pass, struct friction_place *place)
{
    const struct friction_contact *whole = &place->whole;
    double missed[2];
    missed_by_place(pass, place, missed);
    place->unknown = newton->count;
    add_unknown(newton, whole->across[0], -missed[0]);
    add_unknown(newton, whole->across[1], -missed[1]);
    place->slips = 0;
    place->turns = is_turning(whole) || !(whole->per_square > 0.0);
    if (!place->turns)
        add_unknown(newton, whole->about, -whole->turned - whole_product_of(whole->about, pass->y));
}

/* What slips: dpull = d(W / |W|) limit + (W / |W|) dlimit, with dW = dpull - inverse dmissed. */
static void let_slip(struct newton *newton, const struct friction_place *place, const double wanted[2], double size)
{
    const struct friction_contact *whole = &place->whole;
    const double limit = limit_of(whole), per_size = 1.0 / size, part = limit * per_size;
    const double x = wanted[0] * per_size, y = wanted[1] * per_size;
    const double turns[2][2] = { { part * (1.0 - x * x), -part * x * y }, { -part * x * y, part * (1.0 - y * y) } };
    double *row[2] = { newton->a[place->unknown], newton->a[place->unknown + 1] };
    double by[2][2];
    for (int d = 0; d < 2; d++)
        for (int e = 0; e < 2; e++)
            by[d][e] = turns[d][0] * whole->inverse[0][e] + turns[d][1] * whole->inverse[1][e];
    for (uint32_t j = 0; j < newton->count; j++) {
        const double missed[2] = { row[0][j], row[1][j] };
        row[0][j] = by[0][0] * missed[0] + by[0][1] * missed[1];
        row[1][j] = by[1][0] * missed[0] + by[1][1] * missed[1];
    }
    for (uint32_t i = 0; i < place->count; i++) {
        row[0][place->member[i].active] -= whole->coefficient * x;
        row[1][place->member[i].active] -= whole->coefficient * y;
    }
    for (uint32_t d = 0; d < 2; d++) {
        row[d][place->unknown + d] += 1.0;
        row[d][place->unknown] -= turns[d][0];
        row[d][place->unknown + 1] -= turns[d][1];
        newton->right[place->unknown + d] = limit * wanted[d] * per_size - whole->pull[d];
    }
}

/* Places that stick yield by what they pull beyond their share of all pulls. */
static void let_yield(struct newton *newton, const struct friction_pass *pass, const struct friction_place *place)
{
    for (uint32_t d = 0; d < 2; d++) {
        double *row = newton->a[place->unknown + d];
        row[place->unknown + d] += YIELDING;
        for (uint32_t i = 0; i < pass->count; i++)
            for (uint32_t e = 0; e < 2 && limit_of(&pass->place[i].whole) > 0.0; e++)
                row[pass->place[i].unknown + e] -=
                    YIELDING * place->share *
                    dot(vec3_of(pass->place[i].whole.across[e]), vec3_of(place->whole.across[d]));
    }
}

/*
 * A multiplier that grows moves the middle of its place to its contact, and so what is missed there and where the pull
 * acts; and its torsion, if that is at its limit.
 */
static void move_middle(struct newton *newton, const struct friction_pass *pass, const struct friction_place *place)
{
    const struct friction_contact *whole = &place->whole;
    const int turns = is_turning(whole) && whole->torsion != 0.0;
    const double per_multiplier = 1.0 / whole->multiplier;
    for (uint32_t i = 0; i < place->count && (turns || place->count > 1); i++) {
        const struct friction_contact *contact = place->member[i].contact;
        const uint32_t active = place->member[i].active;
        double adds[HALF_SPACE_DIMENSIONS] = { 0.0 };
        for (uint32_t d = 0; d < 2 && place->count > 1; d++) {
            whole_add(adds, whole->pull[d] * per_multiplier, contact->across[d]);
            whole_add(adds, -whole->pull[d] * per_multiplier, whole->across[d]);
            newton->a[place->unknown + d][active] += (whole_product_of(contact->across[d], pass->y) + contact->slip[d] -
                                                      whole_product_of(whole->across[d], pass->y) - whole->slip[d]) *
                                                     per_multiplier;
        }
        if (turns)
            whole_add(adds, whole->torsion * per_multiplier, whole->about);
        for (uint32_t j = 0; j < newton->count; j++)
            newton->a[j][active] += whole_product_of(newton->row[j], adds);
    }
}

static void set_equations(struct newton *newton, struct friction_pass *pass)
{
    const struct friction_problem *problem = pass->problem;
    newton->count = newton->is_known = 0;
    for (uint32_t k = 0; k < problem->solved->active_count; k++) {
        const struct half_space *space = &problem->spaces[problem->solved->active[k]];
        add_unknown(newton, space->normal, space->bound - whole_product_of(space->normal, pass->y));
    }
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            add_place(newton, pass, &pass->place[i]);
    for (uint32_t i = 0; i < newton->count; i++)
        for (uint32_t j = 0; j <= i; j++)
            newton->a[i][j] = newton->a[j][i] = whole_product_of(newton->row[i], newton->row[j]);
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            move_middle(newton, pass, &pass->place[i]);
    for (uint32_t i = 0; i < pass->count; i++) {
        double wanted[2];
        struct friction_place *place = &pass->place[i];
        if (!(limit_of(&place->whole) > 0.0))
            continue;
        if (pass->count > 1)
            let_yield(newton, pass, place);
        const double size = pull_to_rest(pass, place, wanted);
        place->slips = size > limit_of(&place->whole);
        if (place->slips)
            let_slip(newton, place, wanted, size);
    }
}

/* An unknown becomes `share` of what its place holds. */
static void bind(struct newton *newton, const struct friction_place *place, uint32_t unknown, double now, double share)
{
    newton->is_known |= 1u << unknown;
    newton->of[unknown] = place;
    newton->share[unknown] = share;
    newton->right[unknown] = share * place->whole.multiplier - now;
}

/* How many times what a place may pull, or turn with, its pull and its torsion are after a step; 0: at its limit anyhow. */
static void excess_of(const struct friction_place *place, const double *x, double excess[2])
{
    const struct friction_contact *whole = &place->whole;
    const double pull[2] = { whole->pull[0] + x[place->unknown], whole->pull[1] + x[place->unknown + 1] };
    double multiplier = whole->multiplier;
    for (uint32_t i = 0; i < place->count; i++)
        multiplier += x[place->member[i].active];
    const double limit = max_of(whole->coefficient * multiplier, DBL_MIN);
    excess[0] = place->slips ? 0.0 : sqrt(pull[0] * pull[0] + pull[1] * pull[1]) / limit;
    excess[1] = place->turns ? 0.0 : fabs(whole->torsion + x[place->unknown + 2]) / (limit * whole->torsion_arm);
}

/* That which would have to pull most beyond its limit to stick slips that way instead. Returns 0 if nothing has to. */
static int bind_excess(struct newton *newton, struct friction_pass *pass, const double *x)
{
    struct friction_place *worst = NULL;
    double most = 1.0 + EXCEEDING;
    int is_torsion = 0;
    for (uint32_t i = 0; i < pass->count; i++) {
        double excess[2];
        if (!(limit_of(&pass->place[i].whole) > 0.0))
            continue;
        excess_of(&pass->place[i], x, excess);
        for (int k = 0; k < 2; k++)
            if (excess[k] > most) {
                most = excess[k];
                worst = &pass->place[i];
                is_torsion = k;
            }
    }
    if (!worst)
        return 0;
    const struct friction_contact *whole = &worst->whole;
    if (is_torsion) {
        const double arm = whole->torsion + x[worst->unknown + 2] < 0.0 ? -whole->torsion_arm : whole->torsion_arm;
        bind(newton, worst, worst->unknown + 2, whole->torsion, whole->coefficient * arm);
        worst->turns = 1;
        return 1;
    }
    const double pull[2] = { whole->pull[0] + x[worst->unknown], whole->pull[1] + x[worst->unknown + 1] };
    const double size = sqrt(pull[0] * pull[0] + pull[1] * pull[1]);
    for (uint32_t d = 0; d < 2; d++)
        bind(newton, worst, worst->unknown + d, whole->pull[d], whole->coefficient * pull[d] / size);
    worst->slips = 1;
    return 1;
}

/* As a share of the largest coefficient: with a smaller pivot an unknown depends on others, and stays as it is. */
#define PIVOT_MIN 1e-9

/* Gauss's elimination of rows with their right sides behind them, for pivots above pivot_min. It leaves nothing of them. */
static void eliminate(double *row[], uint32_t m, double pivot_min, double *x)
{
    uint32_t pivots[UNKNOWNS_MAX], rank = 0;
    double per_pivot[UNKNOWNS_MAX];
    for (uint32_t column = 0; column < m; column++) {
        uint32_t best = rank;
        double most = pivot_min;
        x[column] = 0.0;
        for (uint32_t i = rank; i < m; i++) {
            const double size = fabs(row[i][column]);
            best = size > most ? i : best;
            most = max_of(most, size);
        }
        if (!(most > pivot_min))
            continue;
        const double *const pivot = row[best];
        row[best] = row[rank];
        row[rank] = (double *)pivot;
        per_pivot[rank] = 1.0 / pivot[column];
        for (uint32_t i = rank + 1; i < m; i++) {
            double *const other = row[i];
            const double part = other[column] * per_pivot[rank];
            if (part == 0.0)
                continue;
            for (uint32_t j = column + 1; j <= m; j++)
                other[j] -= part * pivot[j];
        }
        pivots[rank++] = column;
    }
    while (rank-- > 0) {
        const double *const pivot = row[rank];
        double left = pivot[m];
        for (uint32_t j = pivots[rank] + 1; j < m; j++)
            left -= pivot[j] * x[j];
        x[pivots[rank]] = left * per_pivot[rank];
    }
}

/* How much of an unknown's change is its place's: the changes of its multipliers, summed. */
static double shared(const struct newton *newton, uint32_t unknown, const double *x)
{
    const struct friction_place *place = newton->of[unknown];
    double sum = 0.0;
    for (uint32_t i = 0; place && i < place->count; i++)
        sum += x[place->member[i].active];
    return place ? newton->share[unknown] * sum : 0.0;
}

/* A row in which what is known is put in: coefficients of those that are left, and the right side. */
static void put_in(const struct newton *newton, uint32_t number, const uint32_t *left, uint32_t count, double *row)
{
    double whole[UNKNOWNS_MAX], right = newton->right[number];
    memcpy(whole, newton->a[number], newton->count * sizeof *whole);
    for (uint32_t j = newton->is_known ? newton->count : 0; j-- > 0;) {
        if (!(newton->is_known >> j & 1))
            continue;
        const struct friction_place *place = newton->of[j];
        right -= whole[j] * newton->right[j];
        for (uint32_t i = 0; place && i < place->count; i++)
            whole[place->member[i].active] += whole[j] * newton->share[j];
    }
    for (uint32_t k = 0; k < count; k++)
        row[k] = whole[left[k]];
    row[count] = right;
}

/* Solve for what is left, and find what is known. Multipliers come first, so that others may be a share of them. */
static void solve_left(const struct newton *newton, double *x)
{
    double a[UNKNOWNS_MAX][UNKNOWNS_MAX + 1], *row[UNKNOWNS_MAX], found[UNKNOWNS_MAX], largest = 0.0;
    uint32_t left[UNKNOWNS_MAX], count = 0;
    for (uint32_t i = 0; i < newton->count; i++)
        if (!(newton->is_known >> i & 1))
            left[count++] = i;
    for (uint32_t i = 0; i < count; i++) {
        row[i] = a[i];
        put_in(newton, left[i], left, count, a[i]);
        for (uint32_t j = 0; j < count; j++)
            largest = max_of(largest, fabs(a[i][j]));
    }
    eliminate(row, count, PIVOT_MIN * largest, found);
    for (uint32_t i = 0; i < count; i++)
        x[left[i]] = found[i];
    for (uint32_t i = 0; i < newton->count; i++)
        if (newton->is_known >> i & 1)
            x[i] = newton->right[i] + shared(newton, i, x);
}

/* The active constraint that would have to pull most; active_count: none. */
static uint32_t most_pulling(const struct newton *newton, const struct half_spaces_result *solved, const double *x)
{
    uint32_t worst = solved->active_count;
    double lowest = 0.0;
    for (uint32_t k = 0; k < solved->active_count; k++)
        if (!(newton->is_known >> k & 1) && solved->multiplier[k] + x[k] < lowest) {
            lowest = solved->multiplier[k] + x[k];
            worst = k;
        }
    return worst;
}

/* Solve; what would have to pull more than it can slips, and a constraint that would have to pull leaves. */
static void solve_pushing(struct newton *newton, struct friction_pass *pass, double *x)
{
    const struct half_spaces_result *solved = pass->problem->solved;
    for (;;) {
        solve_left(newton, x);
        if (bind_excess(newton, pass, x))
            continue;
        const uint32_t leaves = most_pulling(newton, solved, x);
        if (leaves == solved->active_count)
            return;
        newton->is_known |= 1u << leaves;
        newton->of[leaves] = NULL;
        newton->right[leaves] = -solved->multiplier[leaves];
    }
}

/* Change the multipliers of a place, and so its shares, its pulls and its torsion. */
static void take_step(struct friction_place *place, const double *x)
{
    const int turns = is_turning(&place->whole);
    double multiplier = 0.0;
    for (uint32_t i = 0; i < place->count; i++) {
        struct friction_contact *contact = place->member[i].contact;
        contact->multiplier = max_of(0.0, contact->multiplier + x[place->member[i].active]);
        multiplier += contact->multiplier;
    }
    for (uint32_t i = 0; i < place->count && multiplier > 0.0; i++)
        place->member[i].contact->share = place->member[i].contact->multiplier / multiplier;
    place->whole.pull[0] += x[place->unknown];
    place->whole.pull[1] += x[place->unknown + 1];
    if (turns)
        place->whole.torsion *= multiplier / place->whole.multiplier;
    else if (place->whole.per_square > 0.0)
        place->whole.torsion += x[place->unknown + 2];
}

void dpti_friction_step(struct friction_pass *pass)
{
    struct newton newton;
    double x[UNKNOWNS_MAX];
    set_equations(&newton, pass);
    solve_pushing(&newton, pass, x);
    for (uint32_t k = 0; k < pass->problem->solved->active_count; k++)
        pass->multiplier[k] = pass->problem->solved->multiplier[k] + x[k];
    for (uint32_t i = 0; i < pass->count; i++)
        if (limit_of(&pass->place[i].whole) > 0.0)
            take_step(&pass->place[i], x);
}
