/* SPDX-License-Identifier: BSD-3-Clause */
#include "toy/shared.h"

#include "dynpoint.h"

int dpti_shared(const struct state *state)
{
    return state->WIDTH_of + clamp(state->level);
}

int dpt_shared(int x)
{
    const struct state state = { x, 2 * x };
    return dpti_shared(&state) + dpti_small_least(x) + dpti_large_most(x);
}
