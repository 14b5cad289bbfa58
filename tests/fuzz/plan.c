/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Plans: refused with a line or a place and a reason, or numbers that a world takes. What is read is written, and read
 * again, and written to the same bytes.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "fuzz/fault_check.h"
#include "plan/plan_file.h"

static void check_setting(const struct measure_setting *setting)
{
    dpt_world_def def = setting->world;
    MUST(dpt_world_bytes(&def) > 0);
    MUST(def.stiffness >= 0.0 && def.stiffness <= 1e9);
    MUST(setting->dt > 0.0 && setting->dt <= 1.0 && setting->damping >= 0.0);
    MUST(isnan(setting->friction) || (setting->friction >= 0.0 && setting->friction <= 10.0));
    MUST(setting->integrator >= -1 && setting->integrator <= DPT_INTEGRATOR_IMPLICIT);
    MUST(setting->iterations <= 1024);
}

/* The caller frees it. */
static char *write_text(const struct plan *plan, size_t *size)
{
    char *text = NULL;
    FILE *file = open_memstream(&text, size);
    MUST(file != NULL);
    plan_file_write(file, plan);
    MUST(!fclose(file));
    return text;
}

static void check_again(const struct plan *plan)
{
    struct plan again;
    struct json_fault fault;
    size_t size[2];
    char *text[2] = { write_text(plan, &size[0]), NULL };
    MUST(plan_file_parse(&again, text[0], size[0], &fault));
    text[1] = write_text(&again, &size[1]);
    MUST(size[0] == size[1] && !memcmp(text[0], text[1], size[0]));
    free(text[0]);
    free(text[1]);
    plan_free(&again);
}

FUZZ_TARGET(plan)
{
    struct plan plan;
    struct json_fault fault;
    if (!plan_file_parse(&plan, (const char *)bytes, size, &fault)) {
        check_fault(&fault, bytes, size);
    } else {
        fuzz_accepted++;
        MUST(plan.scene && plan.mesh_count >= 1 && plan.mesh_count <= PLAN_MESHES_MAX);
        MUST(plan.asked.rate >= 1.0 && plan.asked.rate <= 1e5);
        check_setting(&plan.setting);
        if (plan.cheaper.knob[0])
            check_setting(&plan.cheaper.setting);
        check_again(&plan);
    }
    plan_free(&plan);
    return 0;
}
