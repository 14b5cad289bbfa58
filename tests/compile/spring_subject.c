/* SPDX-License-Identifier: BSD-3-Clause */
#include "compile/spring_subject.h"

#include <math.h>

#include "lib/check.h"

int open_subject(struct subject *subject, dpt_compiled *compiled)
{
    subject->file = file_of(compiled->bytes, compiled->size);
    dpt_compiled_free(compiled);
    subject->info = (dpt_mesh_info){ .size = sizeof subject->info };
    subject->net = (dpt_mesh_springs){ .size = sizeof subject->net };
    dpt_mesh_convert(subject->file.bytes, subject->file.size, NULL);
    const int good = dpt_mesh_open(subject->file.bytes, subject->file.size, &subject->mesh) == DPT_OK &&
                     dpt_mesh_get_info(subject->mesh, &subject->info) == DPT_OK &&
                     dpt_mesh_get_springs(subject->mesh, &subject->net) == DPT_OK && subject->net.nodes;
    CHECK(good, "does not open, or has no springs");
    return good;
}

static dpt_result compile_shape(const char *name, uint64_t count, const dpt_spring_net_def *springs,
                                dpt_compiled *compiled, dpt_diag *diag)
{
    struct shape shape;
    shape_reason reason;
    dpt_result result = DPT_E_ARGUMENT;
    const dpt_compile_def def = { .size = sizeof def, .springs = springs };
    diag->size = sizeof *diag;
    if (shape_make(name, count, 0, &shape, reason) == 0)
        result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                                    compiled, diag);
    shape_free(&shape);
    return result;
}

int make_subject(struct subject *subject, const char *name, uint64_t count, const dpt_spring_net_def *springs)
{
    dpt_compiled compiled;
    dpt_diag diag;
    const dpt_result result = compile_shape(name, count, springs, &compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    return result == DPT_OK && open_subject(subject, &compiled);
}

dpt_spring_net_def def_of(uint32_t kind)
{
    dpt_spring_net_def def;
    dpt_spring_net_def_init(&def);
    def.kind = kind;
    return def;
}

static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

void measure(const dpt_mesh *mesh, double *volume, double *area)
{
    const float *xyz;
    const uint32_t *corners;
    uint32_t count;
    *volume = *area = 0.0;
    dpt_mesh_get_vertices(mesh, &xyz, &count);
    dpt_mesh_get_triangles(mesh, &corners, NULL, &count);
    for (uint32_t t = 0; t < count; t++) {
        double x[3][3], n2 = 0.0;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                x[c][k] = xyz[3 * (size_t)corners[3 * (size_t)t + (size_t)c] + (size_t)k];
        *volume += determinant(x[0], x[1], x[2]) / 6.0;
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const double n = (x[1][i] - x[0][i]) * (x[2][j] - x[0][j]) - (x[1][j] - x[0][j]) * (x[2][i] - x[0][i]);
            n2 += n * n;
        }
        *area += 0.5 * sqrt(n2);
    }
}

double sum_of_masses(const dpt_mesh_springs *net)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < net->nodes; i++)
        sum += net->mass[i];
    return sum;
}

void expect_rows(const struct subject *subject)
{
    const dpt_mesh_springs *net = &subject->net;
    uint32_t ends = 0, fixed = 0;
    for (uint32_t i = 0; i < net->nodes; i++) {
        uint32_t before = DPT_NONE, own = 0;
        fixed += net->mass[i] == 0.0f;
        for (size_t w = words_begin(net, i); w < words_end(net, i); w += 16) {
            const uint32_t j = net->neighbours[w];
            double length2 = 0.0;
            if (j == i) {
                CHECK(net->stiffness[w] == 0.0f && net->length[w] == 1.0f, "padding of %u", i);
                continue;
            }
            uint32_t found = 0;
            for (size_t u = words_begin(net, j); u < words_end(net, j); u += 16)
                found += net->neighbours[u] == i && net->stiffness[u] == net->stiffness[w] &&
                         net->length[u] == net->length[w];
            CHECK(found == 1, "the spring from %u to %u stands %u times in the row of %u", i, j, found, j);
            CHECK(before == DPT_NONE || j > before, "%u after %u in the row of %u", j, before, i);
            for (size_t k = 0; k < 3; k++) {
                const double apart = (double)net->rest[3 * (size_t)j + k] - (double)net->rest[3 * (size_t)i + k];
                length2 += apart * apart;
            }
            CHECK(fabs((double)net->length[w] - sqrt(length2)) <= 1e-7 * sqrt(length2), "a spring of %g m is %g m",
                  (double)net->length[w], sqrt(length2));
            before = j;
            own++;
        }
        CHECK(own > 0, "node %u has no springs", i);
        ends += own;
    }
    CHECK(ends == 2 * subject->info.springs && net->springs == subject->info.springs &&
              fixed == subject->info.fixed_nodes && net->slices == (net->nodes + 15) / 16 &&
              net->first[net->slices] == subject->info.spring_entries,
          "%u ends of %u springs, %u fixed", ends, subject->info.springs, fixed);
}
