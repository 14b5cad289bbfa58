/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A linear complementarity problem: multipliers >= 0 with
 *     gap = free_gap + A multiplier >= 0,   gap . multiplier = 0
 * Some rows may be equalities, whose gap is 0 and whose multiplier has any sign, and some may only be watched: they have
 * a gap and no multiplier.
 * A is symmetric and positive semidefinite, and is known by its columns. It is the dual of a nearest point under linear
 * constraints (half_spaces.h) where the point has many dimensions, so that the products of constraints are all that is
 * needed. The dual active set method of Goldfarb and Idnani (1983) on a Cholesky factor of the active part; it ends, as
 * the dual objective grows with each constraint that is added.
 */
#ifndef DPT_COMPLEMENTARITY_H
#define DPT_COMPLEMENTARITY_H

#include "base/work.h"

enum { COMPLEMENTARITY_MAX = 512, COMPLEMENTARITY_ACTIVE_MAX = 160 };

enum { COMPLEMENTARITY_CONSTRAINT, COMPLEMENTARITY_EQUAL, COMPLEMENTARITY_WATCHED };

enum {
    COMPLEMENTARITY_SOLVED,
    COMPLEMENTARITY_FULL, /* more constraints would be active than there is room or work for: the answer lacks some */
    COMPLEMENTARITY_IMPOSSIBLE /* some constraint can be met by no multipliers: the answer lacks it */
};

struct complementarity {
    /* To be set before. */
    uint32_t count;         /* 0..COMPLEMENTARITY_MAX */
    const uint8_t *kind;    /* of each row, COMPLEMENTARITY_... ; NULL: all are constraints */
    double tolerance;       /* a gap of no less than minus that counts as met */
    const double *free_gap; /* `count` numbers */
    /* A column of A into `column`, from row `first` on. */
    void (*column)(void *user, uint32_t index, uint32_t first, double *column);
    void *user;
    /* Calls with the same number, other than 0, are of one matrix, to which rows may be added at its end. */
    uint32_t matrix;
    /*
     * Passes are counted: 16 products of rows of the factor or of columns are a unit. When it is spent, no more than one
     * constraint is added. NULL: there is no limit.
     */
    struct work *work;
    /*
     * In: where to begin, the last answer's active constraints, or none. Out: those of this answer and the equalities,
     * ascending. An equality that depends on others is left out.
     */
    uint32_t active_count;
    uint32_t active[COMPLEMENTARITY_ACTIVE_MAX];
    /* Out. */
    double multiplier[COMPLEMENTARITY_ACTIVE_MAX]; /* of the active constraints */
    double gap[COMPLEMENTARITY_MAX];
    uint32_t passes; /* constraints that were added or dropped */
    /*
     * The solver's own. Columns of A lie in places, of which active rows own the first; others may still hold columns that
     * were asked for. The factor is that of the rows `factored`.
     */
    uint32_t known_matrix;
    uint32_t places; /* that may hold columns: those before */
    uint32_t place[COMPLEMENTARITY_ACTIVE_MAX];
    uint32_t owner[COMPLEMENTARITY_ACTIVE_MAX]; /* of each place: the row whose column it holds, or DPT_NONE */
    uint32_t filled[COMPLEMENTARITY_ACTIVE_MAX];
    uint32_t factored_count;
    uint32_t factored[COMPLEMENTARITY_ACTIVE_MAX];
    double columns[COMPLEMENTARITY_ACTIVE_MAX][COMPLEMENTARITY_MAX];
    double factor[COMPLEMENTARITY_ACTIVE_MAX]
                 [COMPLEMENTARITY_ACTIVE_MAX]; /* its transpose: row by row of the upper one */
};

/* Returns COMPLEMENTARITY_... */
int dpti_complementarity_solve(struct complementarity *problem);

#endif
