/* SPDX-License-Identifier: BSD-3-Clause */
/* The options of replay, plan and run that say how a force is felt: --law, --stiffness, --friction, --damping. */
#ifndef DPT_TOOLS_FORCE_CHECK_H
#define DPT_TOOLS_FORCE_CHECK_H

#include "cli/law_name.h"
#include "scene/force_options.h"

/* The exit status after a message, or 0. */
static inline int force_options_check(const char *command, const struct force_options *options)
{
    if (!(options->stiffness >= 0.0 && options->stiffness <= 1e9))
        return complain(command, "--stiffness must be 0 to 1e9");
    if (options->friction < 0.0 || options->friction > 10.0)
        return complain(command, "--friction must be 0 to 10");
    if (!(options->damping >= 0.0 && options->damping <= 1e9))
        return complain(command, "--damping must be 0 to 1e9");
    if ((options->friction > 0.0 || options->damping > 0.0) && options->law != DPT_LAW_PROXY)
        return complain(command, "--friction and --damping are for --law proxy");
    return 0;
}

#endif
