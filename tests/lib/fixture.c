/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/fixture.h"

int fixture_from_arrays(struct fixture *fixture, const double *vertices, size_t vertex_count, const uint32_t *corners,
                        size_t triangle_count)
{
    dpt_diag diag = { .size = sizeof diag };
    fixture->mesh = NULL;
    dpt_result result =
        dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, NULL, &fixture->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", dpt_result_name(result), diag.text);
    if (result != DPT_OK)
        return 0;
    result = dpt_mesh_open(fixture->compiled.bytes, fixture->compiled.size, &fixture->mesh);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

int fixture_from_shape(struct fixture *fixture, const char *name, uint64_t count)
{
    struct shape shape;
    shape_reason reason;
    int made = shape_make(name, count, 0, &shape, reason);
    CHECK(made == 0, "%s: %s", name, reason);
    if (made != 0)
        return 0;
    int opened = fixture_from_arrays(fixture, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
    return opened;
}
