/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_brute.h"

/* Sweeps, pairs that are exchanged where they end, and pairs of which all choices are tried. */
enum { PASSES = 50000, CHANGES = 100, CHOSEN = 12 };

/* m: of gaps where sweeps do not end in an exact answer; less than what the library's may be off by. */
#define ENOUGH 3e-11

/* The pushes of `count` pairs for which these have no gap: by elimination, the largest diagonal first; what depends on the
 * others pushes by nothing. */
static void close_gaps(const struct brute *brute, const uint32_t *which, uint32_t count, double *push)
{
    static double a[BRUTE_PAIRS][BRUTE_PAIRS + 1];
    uint32_t order[BRUTE_PAIRS], rank = 0;
    double largest = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = 0; j < count; j++)
            a[i][j] = brute->matrix[which[i]][which[j]];
        a[i][count] = -brute->pair[which[i]].free_gap;
        order[i] = i;
        largest = fmax(largest, a[i][i]);
    }
    for (; rank < count; rank++) {
        uint32_t best = rank;
        for (uint32_t i = rank; i < count; i++)
            if (a[order[i]][order[i]] > a[order[best]][order[best]])
                best = i;
        const uint32_t row = order[best];
        if (!(a[row][row] > 1e-13 * largest))
            break;
        order[best] = order[rank];
        order[rank] = row;
        for (uint32_t i = rank + 1; i < count; i++) {
            const double share = a[order[i]][row] / a[row][row];
            for (uint32_t j = 0; j <= count; j++)
                a[order[i]][j] -= share * a[row][j];
        }
    }
    for (uint32_t i = rank; i-- > 0;) {
        double sum = a[order[i]][count];
        for (uint32_t j = i + 1; j < rank; j++)
            sum -= a[order[i]][order[j]] * push[which[order[j]]];
        push[which[order[i]]] = sum / a[order[i]][order[i]];
    }
}

/* The pair that misses its gap most; the count of pairs if none does. */
static uint32_t deepest(const struct brute *brute, const double *push)
{
    uint32_t which = brute->count;
    double least = -1e-12;
    for (uint32_t i = 0; i < brute->count; i++) {
        double gap = brute->pair[i].free_gap;
        for (uint32_t j = 0; j < brute->count; j++)
            gap += brute->matrix[i][j] * push[j];
        if (gap < least) {
            least = gap;
            which = i;
        }
    }
    return which;
}

static void take(struct brute *brute, const double *push)
{
    for (uint32_t i = 0; i < brute->count; i++)
        brute->pair[i].push = push[i];
}

/*
 * From the pairs that push: without those that would pull, and with those that miss their gaps, one by one. Returns 1, and
 * takes the pushes, if that ends where all conditions are met.
 */
static int settle(struct brute *brute)
{
    uint32_t which[BRUTE_PAIRS], count = 0;
    double push[BRUTE_PAIRS];
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].push > 0.0)
            which[count++] = i;
    for (int change = 0; change < CHANGES; change++) {
        uint32_t least = 0;
        memset(push, 0, sizeof push);
        close_gaps(brute, which, count, push);
        for (uint32_t i = 1; i < count; i++)
            if (push[which[i]] < push[which[least]])
                least = i;
        const uint32_t deep = deepest(brute, push);
        if (count && push[which[least]] < 0.0)
            which[least] = which[--count];
        else if (deep < brute->count && count < BRUTE_PAIRS)
            which[count++] = deep;
        else {
            take(brute, push);
            return 1;
        }
    }
    return 0;
}

/* The same, by trying all choices of the pairs that push, where these are few: some of them nearly depend on the others. */
static int settle_by_trial(struct brute *brute)
{
    uint32_t pushing[CHOSEN], which[CHOSEN], all = 0;
    double push[BRUTE_PAIRS];
    for (uint32_t i = 0; i < brute->count; i++)
        if (brute->pair[i].push > 0.0 && all++ < CHOSEN)
            pushing[all - 1] = i;
    for (uint32_t choice = 0; all <= CHOSEN && choice < 1u << all; choice++) {
        uint32_t count = 0;
        double least = 0.0;
        for (uint32_t i = 0; i < all; i++)
            if (choice >> i & 1)
                which[count++] = pushing[i];
        memset(push, 0, sizeof push);
        close_gaps(brute, which, count, push);
        for (uint32_t i = 0; i < count; i++)
            least = fmin(least, push[which[i]]);
        if (!(least < 0.0) && deepest(brute, push) == brute->count) {
            take(brute, push);
            return 1;
        }
    }
    return 0;
}

void brute_solve_pairs(struct brute *brute)
{
    double gap[BRUTE_PAIRS], left = 0.0;
    for (uint32_t i = 0; i < brute->count; i++) {
        gap[i] = brute->pair[i].free_gap;
        brute->pair[i].push = 0.0;
    }
    for (int pass = 0; pass < PASSES; pass++) {
        if (pass % 50 == 0 && settle(brute))
            return;
        for (uint32_t i = 0; i < brute->count; i++) {
            const double was = brute->pair[i].push, push = fmax(was - gap[i] / brute->matrix[i][i], 0.0);
            brute->pair[i].push = push;
            for (uint32_t j = 0; j < brute->count && push != was; j++)
                gap[j] += (push - was) * brute->matrix[j][i];
        }
    }
    if (settle_by_trial(brute))
        return;
    /* Where a face lies on a face, many pushes are as good: what is left of the gaps tells how good they are. */
    for (uint32_t i = 0; i < brute->count; i++)
        left = fmax(left, brute->pair[i].push > 0.0 ? fabs(gap[i]) : -gap[i]);
    CHECK(left <= ENOUGH, "the brute solve leaves %g m", left);
}
