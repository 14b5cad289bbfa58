/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/lab_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "shape/mesh_size.h"
#include "shape/shape.h"

static int refuse(struct lab *lab, struct lab_mesh *mesh)
{
    lab_mesh_close(mesh);
    lab->is_out_of_memory = 1;
    return 0;
}

int lab_mesh_arrays(struct lab *lab, struct lab_mesh *mesh, const double *vertices, size_t vertex_count,
                    const uint32_t *corners, size_t triangle_count)
{
    dpt_mesh_info info = { .size = sizeof info };
    *mesh = (struct lab_mesh){ .mesh = NULL };
    if (dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, NULL, &mesh->compiled, NULL) != DPT_OK ||
        dpt_mesh_convert(mesh->compiled.bytes, mesh->compiled.size, NULL) != DPT_OK ||
        dpt_mesh_open(mesh->compiled.bytes, mesh->compiled.size, &mesh->mesh) != DPT_OK)
        return refuse(lab, mesh);
    dpt_mesh_get_info(mesh->mesh, &info);
    mesh->diagonal = box_diagonal(&info);
    return 1;
}

int lab_mesh_shape(struct lab *lab, struct lab_mesh *mesh, const char *name, uint64_t count)
{
    struct shape shape;
    shape_reason reason;
    *mesh = (struct lab_mesh){ .mesh = NULL };
    if (shape_make(name, count, 0, &shape, reason))
        return refuse(lab, mesh);
    const int is_made =
        lab_mesh_arrays(lab, mesh, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
    return is_made;
}

int lab_mesh_net(struct lab *lab, struct lab_mesh *mesh, uint32_t rows, uint32_t columns,
                 void (*place)(const void *context, double u, double v, double x[3]), const void *context)
{
    const uint32_t across = columns + 1;
    struct shape net;
    *mesh = (struct lab_mesh){ .mesh = NULL };
    if (shape_begin(&net, (size_t)(rows + 1) * across, 2 * (size_t)rows * columns))
        return refuse(lab, mesh);
    for (uint32_t i = 0; i <= rows; i++)
        for (uint32_t j = 0; j < across; j++) {
            double x[3];
            place(context, (double)i / rows, (double)j / columns, x);
            shape_add_vertex(&net, x[0], x[1], x[2]);
        }
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < columns; j++) {
            const size_t a = (size_t)i * across + j;
            shape_add_triangle(&net, a, a + 1, a + across + 1);
            shape_add_triangle(&net, a, a + across + 1, a + across);
        }
    const int is_made = lab_mesh_arrays(lab, mesh, net.vertices, net.vertex_count, net.corners, net.triangle_count);
    shape_free(&net);
    return is_made;
}

int lab_mesh_prism(struct lab *lab, struct lab_mesh *mesh, const double (*corners)[2], uint32_t count, double half)
{
    double vertices[3 * (2 * LAB_CORNERS_MAX + 2)], middle[2] = { 0.0, 0.0 };
    uint32_t triangles[3 * 4 * LAB_CORNERS_MAX], *at = triangles;
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++)
            middle[k] += corners[i][k] / count;
    for (uint32_t i = 0; i <= count; i++) {
        const double *corner = i < count ? corners[i] : middle;
        for (uint32_t side = 0; side < 2; side++) {
            const double x[3] = { corner[0], side ? half : -half, corner[1] };
            memcpy(vertices + 3 * (size_t)(2 * i + side), x, sizeof x);
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t a = 2 * i, b = 2 * ((i + 1) % count), hub = 2 * count;
        const uint32_t four[12] = { a, b, b + 1, a, b + 1, a + 1, hub, b, a, hub + 1, a + 1, b + 1 };
        memcpy(at, four, sizeof four);
        at += 12;
    }
    return lab_mesh_arrays(lab, mesh, vertices, 2 * (size_t)count + 2, triangles, 4 * (size_t)count);
}

int lab_mesh_slab(struct lab *lab, struct lab_mesh *mesh, double low, double high, double bottom, double top,
                  double half)
{
    const double corners[4][2] = { { low, bottom }, { high, bottom }, { high, top }, { low, top } };
    return lab_mesh_prism(lab, mesh, corners, 4, half);
}

void lab_mesh_close(struct lab_mesh *mesh)
{
    dpt_compiled_free(&mesh->compiled);
    mesh->mesh = NULL;
}
