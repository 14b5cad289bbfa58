/* SPDX-License-Identifier: BSD-3-Clause */
/* The words of --law, in the order of DPT_LAW_... */
#ifndef DPT_TOOLS_LAW_NAME_H
#define DPT_TOOLS_LAW_NAME_H

#include "cli/command_options.h"
#include "dynpoint/world.h"
#include "scene/setting_words.h"

static inline const char *law_name(uint32_t law)
{
    return law_names[law];
}

/* The law of this name, into *law; the exit status of a name that is none, else 0. */
static inline int law_by_name(const char *command, const char *name, uint32_t *law)
{
    const int index = word_index(name, law_names);
    if (index < 0)
        return complain_of_word(command, "--law", name, law_names);
    *law = (uint32_t)index;
    return 0;
}

#endif
