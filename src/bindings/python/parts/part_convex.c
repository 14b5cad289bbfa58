/* SPDX-License-Identifier: BSD-3-Clause */
/* What of convex.h a scene uses, where the system has libccd. */
#include "dynpoint/convex.h"

#include <string.h>

#include "bindings/python/parts/part.h"
#include "scene/tip_shape.h"

static dpy_part convex = { .file = "libdynpoint_convex.so", .needs = "libccd", .packages = "libccd2" };

/* Of functions that are not called unless they were found: the scene asks convex_library_fault first. */
static void find(const char *symbol, void *function, size_t size)
{
    void *const found = dpy_part_find(&convex, symbol);
    memcpy(function, &found, size);
}

const char *convex_library_fault(void)
{
    return dpy_part_find(&convex, "dpt_convex_corners") ? NULL : convex.fault;
}

dpt_result dpt_convex_corners(const dpt_convex_shape *shape, uint32_t sides, double *corners, uint32_t capacity,
                              uint32_t *count, double *error)
{
    dpt_result (*call)(const dpt_convex_shape *, uint32_t, double *, uint32_t, uint32_t *, double *);
    find("dpt_convex_corners", &call, sizeof call);
    return call ? call(shape, sides, corners, capacity, count, error) : DPT_E_ABSENT;
}

void dpt_convex_shape_wrench(void *user, const dpt_force_info *info, double dt, dpt_wrench *wrench)
{
    static void (*call)(void *, const dpt_force_info *, double, dpt_wrench *);
    if (!__atomic_load_n(&call, __ATOMIC_ACQUIRE)) {
        void (*found)(void *, const dpt_force_info *, double, dpt_wrench *);
        find("dpt_convex_shape_wrench", &found, sizeof found);
        __atomic_store_n(&call, found, __ATOMIC_RELEASE);
    }
    call(user, info, dt, wrench);
}
