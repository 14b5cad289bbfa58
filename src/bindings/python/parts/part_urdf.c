/* SPDX-License-Identifier: BSD-3-Clause */
/* urdf.h, where the system has urdfdom. */
#include "dynpoint/urdf.h"

#include <stdio.h>
#include <string.h>

#include "bindings/python/parts/part.h"

static dpy_part urdf = { .file = "libdynpoint_urdf.so",
                         .needs = "urdfdom",
                         .packages = "liburdfdom-model3.0 libexpat1" };

dpt_result dpt_urdf_compile_file(const char *path, const dpt_urdf_def *def, dpt_compiled *out, dpt_diag *diag)
{
    dpt_result (*compile)(const char *, const dpt_urdf_def *, dpt_compiled *, dpt_diag *);
    void *const found = dpy_part_find(&urdf, "dpt_urdf_compile_file");
    memcpy(&compile, &found, sizeof compile);
    if (found)
        return compile(path, def, out, diag);
    *out = (dpt_compiled){ NULL, 0 };
    if (diag) {
        diag->code = DPT_E_ABSENT;
        diag->line = 0;
        snprintf(diag->text, sizeof diag->text, "%s", urdf.fault);
    }
    return DPT_E_ABSENT;
}
