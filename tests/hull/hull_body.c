/* SPDX-License-Identifier: BSD-3-Clause */
#include "hull/hull_body.h"

static int open_body(struct hull_body *body)
{
    uint32_t chosen;
    const size_t count = body->fixture.mesh->triangles;
    dpti_surface_of_mesh(body->fixture.mesh, &body->surface);
    body->corners = malloc(9 * (count + 1) * sizeof *body->corners);
    body->triangles.corners = body->corners;
    body->triangles.count = (uint32_t)count;
    body->diagonal = surface_diagonal(&body->surface);
    for (uint32_t t = 0; t < count; t++) {
        vec3 v[3];
        surface_corners(&body->surface, t, v);
        for (uint32_t k = 0; k < 3; k++)
            vec3_store(v[k], body->corners + 9 * (size_t)t + 3 * k);
    }
    return dpti_kernel_get(DPT_KERNEL_AUTO, &body->kernel, &chosen);
}

int body_from_shape(struct hull_body *body, const char *name, uint64_t count)
{
    memset(body, 0, sizeof *body);
    body->name = name;
    return fixture_from_shape(&body->fixture, name, count) && open_body(body);
}

int body_from_data(struct hull_body *body, const char *data, const char *name)
{
    char path[1024];
    dpt_diag diag = { .size = sizeof diag };
    memset(body, 0, sizeof *body);
    snprintf(path, sizeof path, "%s/meshes/organs/%s", data, name);
    body->name = name;
    const dpt_result result = dpt_compile_file(path, NULL, &body->fixture.compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    return result == DPT_OK &&
           dpt_mesh_open(body->fixture.compiled.bytes, body->fixture.compiled.size, &body->fixture.mesh) == DPT_OK &&
           open_body(body);
}

int body_from_sheet(struct hull_body *body, uint32_t rows, int is_wavy)
{
    const uint32_t across = rows + 1;
    double *vertices = malloc(3 * (size_t)across * across * sizeof *vertices);
    uint32_t *corners = malloc(6 * (size_t)rows * rows * sizeof *corners), *at = corners;
    memset(body, 0, sizeof *body);
    body->name = is_wavy ? "waves" : "sheet";
    for (uint32_t i = 0; i < across * across; i++) {
        double *x = vertices + 3 * (size_t)i;
        const double u = (double)(i / across) / rows, v = (double)(i % across) / rows;
        x[0] = u - 0.5;
        x[1] = v - 0.5;
        x[2] = is_wavy ? 0.02 * sin(9.0 * u) * cos(7.0 * v) : 0.0;
    }
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < rows; j++) {
            const uint32_t a = i * across + j, b = a + 1;
            const uint32_t cell[6] = { a, b, b + across, a, b + across, a + across };
            memcpy(at, cell, sizeof cell);
            at += 6;
        }
    const int opened =
        fixture_from_arrays(&body->fixture, vertices, (size_t)across * across, corners, 2 * (size_t)rows * rows);
    free(vertices);
    free(corners);
    return opened && open_body(body);
}

void body_close(struct hull_body *body)
{
    free(body->corners);
    fixture_free(&body->fixture);
}

vec3 body_place(const struct hull_body *body, uint64_t *random, vec3 *normal)
{
    const uint32_t t = whole_in(random, 0, body->triangles.count - 1);
    const double *c = body->corners + 9 * (size_t)t;
    const vec3 a = vec3_of(c), e = sub(vec3_of(c + 3), a), f = sub(vec3_of(c + 6), a);
    double u = random_in(random, 0.0, 1.0), v = random_in(random, 0.0, 1.0);
    if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    *normal = unit_of(cross(e, f));
    return along(along(a, u, e), v, f);
}
