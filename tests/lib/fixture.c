/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/fixture.h"

static int compile_arrays(struct fixture *fixture, const double *vertices, size_t vertex_count, const uint32_t *corners,
                          size_t triangle_count, const dpt_compile_def *def)
{
    dpt_diag diag = { .size = sizeof diag };
    fixture->mesh = NULL;
    dpt_result result =
        dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, def, &fixture->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", dpt_result_name(result), diag.text);
    if (result != DPT_OK)
        return 0;
    result = dpt_mesh_open(fixture->compiled.bytes, fixture->compiled.size, &fixture->mesh);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    return result == DPT_OK;
}

int fixture_from_arrays(struct fixture *fixture, const double *vertices, size_t vertex_count, const uint32_t *corners,
                        size_t triangle_count)
{
    return compile_arrays(fixture, vertices, vertex_count, corners, triangle_count, NULL);
}

int fixture_from_arrays_with_springs(struct fixture *fixture, const double *vertices, size_t vertex_count,
                                     const uint32_t *corners, size_t triangle_count, const dpt_spring_net_def *net)
{
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.springs = net;
    return compile_arrays(fixture, vertices, vertex_count, corners, triangle_count, &def);
}

int fixture_with_springs(struct fixture *fixture, const char *name, uint64_t count, const dpt_spring_net_def *net)
{
    struct shape shape;
    shape_reason reason;
    int made = shape_make(name, count, 0, &shape, reason);
    CHECK(made == 0, "%s: %s", name, reason);
    if (made != 0)
        return 0;
    int opened = fixture_from_arrays_with_springs(fixture, shape.vertices, shape.vertex_count, shape.corners,
                                                  shape.triangle_count, net);
    shape_free(&shape);
    return opened;
}

int fixture_from_shape(struct fixture *fixture, const char *name, uint64_t count)
{
    return fixture_with_springs(fixture, name, count, NULL);
}
