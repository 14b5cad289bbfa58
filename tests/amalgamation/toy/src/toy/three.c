/* SPDX-License-Identifier: BSD-3-Clause */
/* Sees none of the others, and goes by what is not defined. */
#include "dynpoint/extra.h"

struct state {
    int WIDTH;
};

static int clamp(struct state *state, int helper)
{
#if defined(WIDTH) || defined(SQUARE) || defined(KIND)
    return -1;
#else
    int words = state->WIDTH, LIMIT = helper;
    return words + LIMIT;
#endif
}

int dpt_three(int x)
{
    struct state state = { .WIDTH = x };
    return clamp(&state, 1);
}

int dpt_extra(int x)
{
    return -x;
}
