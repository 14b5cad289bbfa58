/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef TOY_SHARED_H
#define TOY_SHARED_H

#define WIDTH 7 /* three.c does not see it, and has names like these */
#define DECLARE(kind)                                                                                                  \
    number dpti_##kind##_least, dpti_##kind##_most;                                                                    \
    const char *dpti_##kind##_name(void);

typedef int number(int x);

struct state {
    int WIDTH_of, level;
};

static inline int clamp(int x)
{
    return x > WIDTH ? WIDTH : x;
}

int dpti_shared(const struct state *state);

DECLARE(small)
DECLARE(large)
#undef DECLARE

#endif
