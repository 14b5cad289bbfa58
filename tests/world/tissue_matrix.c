/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_matrix.h"

#include <math.h>
#include <string.h>

#include "tissue/tissue_state.h"
#include "track/deform_state.h"

enum { ROWS_MAX = 160 };

/* What earlier columns have found of shafts is to be found again. */
static void forget_shafts(struct tissue_solve *solve)
{
    for (uint32_t i = 0; i < solve->shaft_count; i++)
        solve->products[i].is_known = solve->products[i].beside = 0;
    solve->beside_count = 0;
}

/* What touches along a shaft pushes by other rows than that of its touch. */
static int is_unused(const struct tissue_solve *solve, uint32_t row)
{
    return row < solve->touches.count && solve->touches.touch[row].shaft;
}

double tissue_matrix_asymmetry(const dpt_world *world, dpt_body body, uint32_t *touches, uint32_t *others)
{
    static double matrix[ROWS_MAX][COMPLEMENTARITY_MAX];
    const struct deform *deform = deform_of(world_find_body(world, body));
    struct tissue_solve *solve = deform ? deform->solve : NULL;
    double most = 0.0;
    *touches = *others = 0;
    if (!solve || solve->row_count > ROWS_MAX)
        return 0.0;
    *touches = solve->touches.count;
    *others = solve->row_count - solve->touches.count;
    for (uint32_t i = 0; i < solve->row_count; i++) {
        forget_shafts(solve);
        solve->problem.column(solve->problem.user, i, 0, matrix[i]);
    }
    for (uint32_t i = 0; i < solve->row_count; i++)
        for (uint32_t j = 0; j < i; j++)
            if (!is_unused(solve, i) && !is_unused(solve, j))
                most = fmax(most, fabs(matrix[i][j] - matrix[j][i]) / sqrt(matrix[i][i] * matrix[j][j]));
    return most;
}

uint32_t tissue_matrix_shares(const dpt_world *world, dpt_body body, double *off)
{
    const struct deform *deform = deform_of(world_find_body(world, body));
    const struct tissue_solve *solve = deform->solve;
    uint32_t others = 0;
    *off = 0.0;
    for (uint32_t i = 0; i < solve->touches.count; i++) {
        double sum = 0.0;
        for (uint32_t k = 0; k < solve->links[i].count; k++)
            sum += solve->links[i].weight[k];
        /* What a shaft touches along itself has no nodes of its own. */
        if (solve->links[i].count || !solve->touches.touch[i].shaft)
            *off = fmax(*off, fabs(sum - 1.0));
        others += !solve->touches.touch[i].shaft;
    }
    return others;
}

void tissue_matrix_forget(dpt_world *world, dpt_body body)
{
    memset(deform_of(world_find_body(world, body))->solve, 0, sizeof(struct tissue_solve));
}
