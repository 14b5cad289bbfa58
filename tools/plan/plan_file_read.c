/* SPDX-License-Identifier: BSD-3-Clause */
#include <stdlib.h>
#include <string.h>

#include "built_with.h"
#include "cli/command_options.h"
#include "plan/plan_file.h"

#ifdef DPT_HAS_JANSSON

#include "scene/json_value.h"

enum { PLAN_BYTES_MAX = 1 << 20 };

int plan_file_read(struct plan *plan, const char *command, const char *path)
{
    struct json_fault fault;
    size_t size;
    memset(plan, 0, sizeof *plan);
    char *bytes = load_file(command, path, &size);
    if (!bytes)
        return 2;
    int status = size > PLAN_BYTES_MAX ? complain(command, "%s: a plan has at most %d bytes", path, PLAN_BYTES_MAX) : 0;
    if (status == 0 && !plan_file_parse(plan, bytes, size, &fault))
        status = json_fault_complain(command, path, &fault);
    free(bytes);
    return status;
}

#else

int plan_file_read(struct plan *plan, const char *command, const char *path)
{
    memset(plan, 0, sizeof *plan);
    return complain(command, "%s: this build reads no plans: install libjansson-dev and pkg-config, and build it again",
                    path);
}

#endif
