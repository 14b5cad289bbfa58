/* SPDX-License-Identifier: BSD-3-Clause */
#include "force/friction.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

enum { SWEEPS_MAX = 24 };

/* Sweeps end when no pull changes by more than this share of the largest pull. */
#define SETTLED 1e-7

/* A pull slips if it exceeds its limit by more than this share of it: rounding alone is no slip. */
#define SLIPPING 1e-5

static double limit_of(const struct friction_contact *contact)
{
    return contact->coefficient * contact->multiplier;
}

/* The pull that brings a contact to rest, with all others as they are; returns its size. */
static double pull_to_rest(const struct friction_contact *contact, uint32_t n, const double *y, double wanted[2])
{
    const double moves[2] = { product_of(contact->across[0], y, n) + contact->slip[0],
                              product_of(contact->across[1], y, n) + contact->slip[1] };
    for (int d = 0; d < 2; d++)
        wanted[d] = contact->pull[d] - contact->inverse[d][0] * moves[0] - contact->inverse[d][1] * moves[1];
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

void dpti_friction_add(const struct friction_contact *contact, double share, uint32_t dimensions, double *sum)
{
    for (uint32_t k = 0; k < dimensions; k++)
        sum[k] += share * (contact->pull[0] * contact->across[0][k] + contact->pull[1] * contact->across[1][k] +
                           contact->torsion * contact->about[k]);
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
    const double wanted = contact->torsion - (product_of(contact->about, y, n) + contact->turned) * contact->per_square;
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

/* sum += share * more */
static void add_share(double *sum, double share, const double *more, uint32_t n)
{
    for (uint32_t k = 0; k < n; k++)
        sum[k] += share * more[k];
}

/* The contacts of a place as one: their mean by what they hold, and all of that. */
static void merge_place(const struct friction_contact *contacts, uint32_t count, uint32_t place, uint32_t n,
                        struct friction_contact *merged)
{
    double limit = 0.0;
    *merged = (struct friction_contact){ .torsion_arm = contacts[place].torsion_arm };
    for (uint32_t i = place; i < count; i++) {
        const struct friction_contact *contact = &contacts[i];
        const double share = contact->share;
        if (contact->place != place)
            continue;
        limit += limit_of(contact);
        merged->multiplier += contact->multiplier;
        add_share(merged->normal, share, contact->normal, n);
        add_share(merged->across[0], share, contact->across[0], n);
        add_share(merged->across[1], share, contact->across[1], n);
        add_share(merged->about, share, contact->about, n);
        add_share(merged->slip, share, contact->slip, 2);
        add_share(merged->pull, 1.0, contact->pull, 2);
        merged->turned += share * contact->turned;
        merged->torsion += contact->torsion;
    }
    merged->coefficient = merged->multiplier > 0.0 ? limit / merged->multiplier : 0.0;
}

/* What the contacts of a place pull with. */
static void divide_place(const struct friction_contact *merged, struct friction_contact *contacts, uint32_t count,
                         uint32_t place)
{
    for (uint32_t i = place; i < count; i++) {
        struct friction_contact *contact = &contacts[i];
        if (contact->place != place)
            continue;
        contact->pull[0] = contact->share * merged->pull[0];
        contact->pull[1] = contact->share * merged->pull[1];
        contact->torsion = contact->share * merged->torsion;
        contact->is_slipping = merged->is_slipping;
    }
}

static void pulls_of_places(struct friction_contact *contacts, uint32_t count, uint32_t n, const double *goal,
                            int is_first)
{
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

void dpti_friction_pulls(struct friction_contact *contacts, uint32_t count, uint32_t dimensions, const double *goal,
                         int is_first)
{
    struct friction_contact merged[HALF_SPACE_DIMENSIONS];
    uint32_t places[HALF_SPACE_DIMENSIONS], place_count = 0;
    for (uint32_t i = 0; i < count; i++)
        if (contacts[i].place == i)
            places[place_count++] = i;
    if (place_count == count) {
        pulls_of_places(contacts, count, dimensions, goal, is_first);
        return;
    }
    for (uint32_t p = 0; p < place_count; p++)
        merge_place(contacts, count, places[p], dimensions, &merged[p]);
    pulls_of_places(merged, place_count, dimensions, goal, is_first);
    for (uint32_t p = 0; p < place_count; p++)
        divide_place(&merged[p], contacts, count, places[p]);
}

uint32_t dpti_friction_planes(const struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                              const double *goal, struct half_space planes[FRICTION_PLANES_MAX], double *pulled)
{
    struct friction_contact merged;
    uint32_t plane_count = 2;
    for (uint32_t i = 0; i < count; i++)
        if (contacts[i].place != 0 || contacts[i].is_slipping)
            return 0;
    if (!count)
        return 0;
    merge_place(contacts, count, 0, dimensions, &merged);
    memset(planes, 0, FRICTION_PLANES_MAX * sizeof *planes);
    memcpy(pulled, goal, dimensions * sizeof *goal);
    for (int d = 0; d < 2; d++) {
        memcpy(planes[d].normal, merged.across[d], sizeof merged.across[d]);
        planes[d].bound = -merged.slip[d];
    }
    const double limit = limit_of(&merged) * merged.torsion_arm;
    if (fabs(merged.torsion) < limit && product_of(merged.about, merged.about, dimensions) > 0.0) {
        memcpy(planes[2].normal, merged.about, sizeof merged.about);
        planes[plane_count++].bound = -merged.turned;
    } else {
        add_share(pulled, merged.torsion, merged.about, dimensions);
    }
    return plane_count;
}

void dpti_friction_goal(const struct friction_contact *contacts, uint32_t count, uint32_t dimensions,
                        const double *goal, double *pulled)
{
    memcpy(pulled, goal, dimensions * sizeof *goal);
    for (uint32_t i = 0; i < count; i++)
        dpti_friction_add(&contacts[i], 1.0, dimensions, pulled);
}

/* ---- surfaces that yield ---- */

/* Murty's method flips one constraint at a time, and visits no set twice. */
enum { FLIPS_MAX = 1 << HALF_SPACE_DIMENSIONS };

struct system {
    uint32_t count;
    double matrix[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS]; /* N + diag(c) */
    double right[HALF_SPACE_DIMENSIONS];                         /* N m */
};

/* Solve for the constraints in `held`, the others being 0, by Cholesky. 0: rounding leaves no solution. */
static int solve_held(const struct system *system, const int *held, double *m)
{
    double l[HALF_SPACE_DIMENSIONS][HALF_SPACE_DIMENSIONS];
    uint32_t index[HALF_SPACE_DIMENSIONS], n = 0;
    for (uint32_t i = 0; i < system->count; i++) {
        m[i] = 0.0;
        if (held[i])
            index[n++] = i;
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j <= i; j++) {
            double sum = system->matrix[index[i]][index[j]];
            for (uint32_t k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 0.0))
                return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    for (uint32_t i = 0; i < n; i++) {
        double sum = system->right[index[i]];
        for (uint32_t k = 0; k < i; k++)
            sum -= l[i][k] * m[index[k]];
        m[index[i]] = sum / l[i][i];
    }
    for (uint32_t i = n; i-- > 0;) {
        double sum = m[index[i]];
        for (uint32_t k = i + 1; k < n; k++)
            sum -= l[k][i] * m[index[k]];
        m[index[i]] = sum / l[i][i];
    }
    return 1;
}

/* The first constraint that does not fit: one that is held and pulls, or one that is not held and is violated. */
static uint32_t first_misfit(const struct system *system, const int *held, const double *m)
{
    for (uint32_t i = 0; i < system->count; i++) {
        double short_of = system->right[i];
        for (uint32_t j = 0; j < system->count; j++)
            short_of -= system->matrix[i][j] * m[j];
        if (held[i] ? m[i] < 0.0 : short_of > 0.0)
            return i;
    }
    return system->count;
}

/* The multipliers m' of the header: a linear complementarity problem (Murty 1974: least index). */
static int solve(const struct system *system, double *m)
{
    int held[HALF_SPACE_DIMENSIONS];
    for (uint32_t i = 0; i < system->count; i++)
        held[i] = 1;
    for (int flip = 0; flip < FLIPS_MAX; flip++) {
        if (!solve_held(system, held, m))
            return 0;
        const uint32_t misfit = first_misfit(system, held, m);
        if (misfit == system->count)
            return 1;
        held[misfit] = !held[misfit];
    }
    return 0;
}

double dpti_yield(const struct half_space *spaces, const struct half_spaces_result *hard, uint32_t dimensions,
                  const double *compliance, double *share, double *yielded)
{
    struct system system = { .count = hard->active_count };
    double m[HALF_SPACE_DIMENSIONS], stored = 0.0;
    for (uint32_t i = 0; i < system.count; i++)
        for (uint32_t j = 0; j < system.count; j++) {
            const double *a = spaces[hard->active[i]].normal, *b = spaces[hard->active[j]].normal;
            system.matrix[i][j] = product_of(a, b, dimensions);
            system.right[i] += system.matrix[i][j] * hard->multiplier[j];
        }
    for (uint32_t i = 0; i < system.count; i++)
        system.matrix[i][i] += compliance[i];
    if (!solve(&system, m))
        memcpy(m, hard->multiplier, system.count * sizeof *m);
    for (uint32_t i = 0; i < system.count; i++) {
        share[i] = hard->multiplier[i] > 0.0 ? m[i] / hard->multiplier[i] : 1.0;
        stored += 0.5 * compliance[i] * m[i] * m[i];
        for (uint32_t k = 0; k < dimensions; k++)
            yielded[k] += (hard->multiplier[i] - m[i]) * spaces[hard->active[i]].normal[k];
    }
    return stored;
}
