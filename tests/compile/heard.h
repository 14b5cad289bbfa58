/* SPDX-License-Identifier: BSD-3-Clause */
/* What a compilation notes: dpt_compile_def.note is hear, note_user a struct heard. Begin with zeros. */
#ifndef DPT_TESTS_COMPILE_HEARD_H
#define DPT_TESTS_COMPILE_HEARD_H

#include "dynpoint/compile.h"

struct heard {
    int count;
    dpt_diag last;
};

static inline void hear(void *user, const dpt_diag *note)
{
    struct heard *heard = user;
    heard->count++;
    heard->last = *note;
}

#endif
