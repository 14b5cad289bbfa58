/* SPDX-License-Identifier: BSD-3-Clause */
/* The words of --law. */
#ifndef DPT_TOOLS_LAW_NAME_H
#define DPT_TOOLS_LAW_NAME_H

#include "command_options.h"
#include "dynpoint/world.h"

#define LAW_HELP "point or proxy"

/* The law of this name, into *law; the exit status of a name that is none, else 0. */
static inline int law_by_name(const char *command, const char *name, uint32_t *law)
{
    static const char *const names[] = { "point", "proxy", NULL };
    static const uint32_t laws[] = { DPT_LAW_POINT, DPT_LAW_PROXY };
    const int index = word_index(name, names);
    if (index < 0)
        return complain(command, "--law takes " LAW_HELP);
    *law = laws[index];
    return 0;
}

#endif
