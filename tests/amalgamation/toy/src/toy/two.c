/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint.h"

#define SQUARE(x) helper(x) /* another meaning, of another type of argument */

enum { LIMIT = 5 };

struct piece {
    double x[LIMIT];
};

static int helper(double x)
{
    struct piece piece = { { x, x + LIMIT } };
    return (int)(piece.x[0] * piece.x[1]);
}

int dpt_two(int x)
{
    int (*call)(double) = helper;
    return SQUARE(x) + call(x) + (int)sizeof(struct piece);
}
