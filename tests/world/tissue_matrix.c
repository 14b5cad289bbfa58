/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/tissue_matrix.h"

#include <math.h>

#include "tissue/tissue_state.h"
#include "track/deform_state.h"

enum { ROWS_MAX = 64 };

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
    for (uint32_t i = 0; i < solve->row_count; i++)
        solve->problem.column(solve->problem.user, i, 0, matrix[i]);
    for (uint32_t i = 0; i < solve->row_count; i++)
        for (uint32_t j = 0; j < i; j++)
            most = fmax(most, fabs(matrix[i][j] - matrix[j][i]) / sqrt(matrix[i][i] * matrix[j][j]));
    return most;
}
