/* SPDX-License-Identifier: BSD-3-Clause */
#include "dynpoint.h"
#include "toy/shared.h"

#define SQUARE(x) ((x) * (x)) /* helper, LIMIT, struct piece: words of a comment */

enum { LIMIT = 3, helper_count };

struct piece {
    int helper, step;
};

static const char *const words = "helper SQUARE LIMIT struct piece \" // helper";

static int helper(int x)
{
    struct piece piece = { .helper = x, .step = 'L' };
    struct piece *at = &piece;
    return SQUARE(at->helper) + piece.step + LIMIT + helper_count;
}

int dpt_one(int x)
{
    return helper(clamp(x));
}

const char *dpt_words(int source)
{
    return source ? dpti_large_name() : words;
}
