/* SPDX-License-Identifier: BSD-3-Clause */
#include "lab/lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/shape.h"
#include "shape/mesh_size.h"

const char *lab_method_name(int method)
{
    static const char *const names[LAB_METHODS] = { "point", "bed", "proxy", "ball" };
    return names[method];
}

/* Room for one more; 0 where memory ran out. */
static int grow(struct lab *lab, void **items, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return 1;
    const size_t wanted = *room ? 2 * *room : 64;
    void *grown = realloc(*items, wanted * size);
    if (!grown) {
        lab->is_out_of_memory = 1;
        return 0;
    }
    *items = grown;
    *room = wanted;
    return 1;
}

static void add_figure(struct lab *lab, struct lab_figure figure)
{
    void *figures = lab->figures;
    const int has_room = grow(lab, &figures, lab->figure_count, &lab->figure_room, sizeof *lab->figures);
    lab->figures = figures;
    if (has_room)
        lab->figures[lab->figure_count++] = figure;
}

void lab_at_most(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, limit, 0 });
}

void lab_at_least(struct lab *lab, const char *method, const char *what, double value, const char *unit, double limit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, limit, 1 });
}

void lab_note(struct lab *lab, const char *method, const char *what, double value, const char *unit)
{
    add_figure(lab, (struct lab_figure){ method, what, unit, value, HUGE_VAL, 0 });
}

void lab_point_at(struct lab *lab, const char *chart, const char *series, double x, double y)
{
    void *points = lab->points;
    const int has_room = grow(lab, &points, lab->point_count, &lab->point_room, sizeof *lab->points);
    lab->points = points;
    if (has_room)
        lab->points[lab->point_count++] = (struct lab_point){ chart, series, x, y };
}

void lab_add_row(struct lab *lab, const struct lab_cell *cells)
{
    void *rows = lab->rows;
    size_t columns = 0;
    const int has_room = grow(lab, &rows, lab->row_count, &lab->row_room, sizeof *lab->rows);
    lab->rows = rows;
    while (lab->columns[columns])
        columns++;
    if (has_room)
        memcpy(lab->rows[lab->row_count++], cells, columns * sizeof *cells);
}

int lab_figure_holds(const struct lab_figure *figure)
{
    return figure->is_at_least ? figure->value >= figure->limit : figure->value <= figure->limit;
}

uint64_t lab_share(const struct lab *lab, uint64_t whole)
{
    const double share = floor(lab->effort * (double)whole + 0.5);
    return share >= 1.0 ? (uint64_t)share : 1;
}

void lab_run(struct lab *lab, const struct lab_case *which, double effort)
{
    memset(lab, 0, sizeof *lab);
    lab->effort = effort;
    which->run(lab);
}

void lab_free(struct lab *lab)
{
    free(lab->figures);
    free(lab->points);
    free(lab->rows);
}

const struct lab_case *const lab_cases[] = {
#define CASE(name) &name##_case,
    LAB_CASES
#undef CASE
        NULL
};

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

int lab_mesh_net(struct lab *lab, struct lab_mesh *mesh, const struct lab_net *net)
{
    const uint32_t rows = net->rows, columns = net->columns, across = columns + 1;
    struct shape shape;
    *mesh = (struct lab_mesh){ .mesh = NULL };
    if (shape_begin(&shape, (size_t)(rows + 1) * across, 2 * (size_t)rows * columns))
        return refuse(lab, mesh);
    for (uint32_t i = 0; i <= rows; i++)
        for (uint32_t j = 0; j < across; j++) {
            double x[3];
            net->place(net->context, (double)i / rows, (double)j / columns, x);
            shape_add_vertex(&shape, x[0], x[1], x[2]);
        }
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < columns; j++) {
            const size_t a = (size_t)i * across + j;
            shape_add_triangle(&shape, a, a + 1, a + across + 1);
            shape_add_triangle(&shape, a, a + across + 1, a + across);
        }
    const int is_made =
        lab_mesh_arrays(lab, mesh, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
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
