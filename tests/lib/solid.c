/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/solid.h"

/* What is compiled already; 0 when it cannot be opened. */
static int solid_open(struct solid *solid)
{
    solid->info.size = sizeof solid->info;
    const dpt_result result = dpt_mesh_open(solid->compiled.bytes, solid->compiled.size, &solid->mesh);
    CHECK(result == DPT_OK, "%s: %s", solid->name, dpt_result_name(result));
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(solid->mesh, &solid->info);
    const size_t count = solid->info.triangles;
    uint32_t *numbers = malloc(3 * (count + 1) * sizeof *numbers), kept = 0;
    solid->corners = malloc(9 * (count + 1) * sizeof *solid->corners);
    for (uint32_t i = 0; i < solid->info.source_triangles && kept < count; i++) {
        double corners[9];
        if (dpt_mesh_get_triangle(solid->mesh, i, corners) != DPT_OK)
            continue;
        for (int k = 0; k < 9; k++)
            solid->corners[9 * (size_t)kept + (size_t)k] = (float)corners[k];
        for (uint32_t k = 0; k < 3; k++)
            numbers[3 * (size_t)kept + k] = 3 * kept + k;
        kept++;
    }
    solid->brute = oracle_brute_open(solid->corners, 3 * kept, numbers, kept);
    free(numbers);
    memcpy(solid->place.low, solid->info.box_min, sizeof solid->place.low);
    memcpy(solid->place.high, solid->info.box_max, sizeof solid->place.high);
    solid->place.corners = solid->corners;
    solid->place.triangles = kept;
    solid->place.tool = MOTION_TOOL;
    solid->diagonal = motion_diagonal(&solid->place);
    solid->oracle = (struct oracle_solid){ solid->brute, solid->corners, kept, 0 };
    for (int k = 0; k < 3; k++)
        solid->oracle.extent = fmax(solid->oracle.extent, fmax(fabs(solid->place.low[k]), fabs(solid->place.high[k])));
    return solid->brute != NULL;
}

int solid_from_arrays(struct solid *solid, const char *name, const double *vertices, size_t vertex_count,
                      const uint32_t *corners, size_t triangle_count)
{
    dpt_diag diag = { .size = sizeof diag };
    *solid = (struct solid){ .name = name };
    const dpt_result result =
        dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, NULL, &solid->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    return result == DPT_OK && solid_open(solid);
}

int solid_from_shape(struct solid *solid, const char *name, uint64_t count)
{
    struct shape shape;
    shape_reason reason;
    *solid = (struct solid){ .name = name };
    const int failed = shape_make(name, count, 0, &shape, reason);
    CHECK(!failed, "%s: %s", name, reason);
    if (failed)
        return 0;
    const int opened =
        solid_from_arrays(solid, name, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
    return opened;
}

int solid_from_file(struct solid *solid, const char *name, const char *path, double scale)
{
    const dpt_compile_def def = { .size = sizeof def, .scale = scale };
    dpt_diag diag = { .size = sizeof diag };
    *solid = (struct solid){ .name = name };
    const dpt_result result = dpt_compile_file(path, scale == 1 ? NULL : &def, &solid->compiled, &diag);
    CHECK(result == DPT_OK, "%s: %s", name, diag.text);
    return result == DPT_OK && solid_open(solid);
}

int solid_from_net(struct solid *solid, const char *name, uint32_t rows, uint32_t columns, int wrap,
                   void (*place)(double u, double v, double x[3]))
{
    const uint32_t across = wrap ? columns : columns + 1;
    double *vertices = malloc(3 * (size_t)(rows + 1) * across * sizeof *vertices);
    uint32_t *corners = malloc(6 * (size_t)rows * columns * sizeof *corners), *at = corners;
    for (uint32_t i = 0; i <= rows; i++)
        for (uint32_t j = 0; j < across; j++)
            place((double)i / rows, (double)j / columns, vertices + 3 * ((size_t)i * across + j));
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < columns; j++) {
            const uint32_t a = i * across + j, b = i * across + (j + 1) % across;
            const uint32_t cell[6] = { a, b, b + across, a, b + across, a + across };
            memcpy(at, cell, sizeof cell);
            at += 6;
        }
    const int opened =
        solid_from_arrays(solid, name, vertices, (size_t)(rows + 1) * across, corners, 2 * (size_t)rows * columns);
    free(vertices);
    free(corners);
    return opened;
}

void solid_balls(const struct solid *solid, double *inner, double *outer, double *tilt)
{
    *inner = INFINITY;
    *outer = *tilt = 0;
    for (uint32_t t = 0; t < solid->place.triangles; t++) {
        double c[9], n[3];
        for (int k = 0; k < 9; k++)
            c[k] = (double)solid->corners[9 * (size_t)t + (size_t)k];
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            n[k] = (c[3 + i] - c[i]) * (c[6 + j] - c[j]) - (c[3 + j] - c[j]) * (c[6 + i] - c[i]);
        }
        unit3(n);
        *inner = fmin(*inner, dot3(n, c));
        for (int i = 0; i < 9; i += 3) {
            const double far = sqrt(dot3(c + i, c + i));
            *outer = fmax(*outer, far);
            *tilt = fmax(*tilt, acos(dot3(n, c + i) / far));
        }
    }
}

void turn_about(double ends[6], double s, const double axis[3], double angle)
{
    double pivot[3];
    point_at(ends, s, pivot);
    for (int e = 0; e < 2; e++) {
        double r[3], side[3];
        for (int k = 0; k < 3; k++)
            r[k] = ends[3 * e + k] - pivot[k];
        for (int k = 0; k < 3; k++)
            side[k] = axis[(k + 1) % 3] * r[(k + 2) % 3] - axis[(k + 2) % 3] * r[(k + 1) % 3];
        const double on = dot3(axis, r);
        for (int k = 0; k < 3; k++)
            ends[3 * e + k] = pivot[k] + cos(angle) * r[k] + sin(angle) * side[k] + (1 - cos(angle)) * on * axis[k];
    }
}

void slide_begin(struct slide *slide, const struct solid *solid, uint64_t seed, double length, double radius)
{
    *slide = (struct slide){ .mesh = solid->mesh, .radius = radius, .seed = seed };
    const float *c = solid->corners + 9 * (random_bits(&slide->seed) % (uint64_t)solid->place.triangles);
    double u[3], v[3], n[3], lie[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)c[3 + k] - (double)c[k];
        v[k] = (double)c[6 + k] - (double)c[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    unit3(n);
    random_unit(&slide->seed, lie);
    random_unit(&slide->seed, slide->axis);
    random_unit(&slide->seed, slide->course);
    const double up = dot3(lie, n);
    for (int k = 0; k < 3; k++)
        lie[k] -= 0.9 * up * n[k];
    unit3(lie);
    /* Free of the mesh it begins: raised until it is. */
    const double rise = fmax(0.1 * radius, 1e-4 * solid->diagonal);
    for (double height = radius + rise; height < solid->diagonal; height += rise) {
        dpt_hit hit = DPT_HIT_INIT;
        for (int k = 0; k < 3; k++) {
            const double middle = ((double)c[k] + (double)c[3 + k] + (double)c[6 + k]) / 3;
            slide->ends[k] = middle + height * n[k] - 0.5 * length * lie[k];
            slide->ends[3 + k] = middle + height * n[k] + 0.5 * length * lie[k];
        }
        dpt_query_segments(slide->mesh, NULL, slide->ends, &radius, 1, &hit, NULL);
        if (hit.distance > 0 && hit.gap > 0)
            break;
    }
}

void slide_step(struct slide *slide)
{
    double way[3], bend[3];
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(slide->mesh, NULL, slide->ends, NULL, 1, &hit, NULL);
    for (int k = 0; k < 3; k++)
        way[k] = hit.p[k] - hit.q[k];
    const double distance = unit3(way);
    const double rise = fmax(-slide->step, fmin(slide->step, slide->gap + slide->radius - distance));
    random_unit(&slide->seed, bend);
    for (int k = 0; k < 3; k++)
        slide->course[k] += 0.03 * bend[k];
    unit3(slide->course);
    const double up = dot3(slide->course, way);
    for (int k = 0; k < 3; k++) {
        const double by = slide->step * (slide->course[k] - up * way[k]) + rise * way[k];
        slide->ends[k] += by;
        slide->ends[3 + k] += by;
    }
    turn_about(slide->ends, hit.s, slide->axis, slide->spin);
}

void check_ids(struct id_history *ids, uint64_t tick, const dpt_contact *contacts, uint32_t count, const char *text)
{
    for (uint32_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < ids->count && ids->id[k] != contacts[i].id)
            k++;
        CHECK(contacts[i].id != 0, "id 0: %s", text);
        for (uint32_t j = 0; j < i; j++)
            CHECK(contacts[j].id != contacts[i].id, "two are %u: %s", contacts[i].id, text);
        CHECK(k == ids->count || ids->tick[k] + 1 >= tick, "%u is back: %s", contacts[i].id, text);
        if (k == ids->count && k < 4096)
            ids->id[ids->count++] = contacts[i].id;
        if (k < 4096)
            ids->tick[k] = tick;
    }
}

void solid_random_place(const struct solid *solid, uint64_t *seed, double at[3], double out[3])
{
    const float *v = solid->corners + 9 * (random_bits(seed) % (uint64_t)solid->place.triangles);
    double e[3], f[3];
    for (int k = 0; k < 3; k++) {
        at[k] = ((double)v[k] + (double)v[3 + k] + (double)v[6 + k]) / 3.0;
        e[k] = (double)v[3 + k] - (double)v[k];
        f[k] = (double)v[6 + k] - (double)v[k];
    }
    cross3(e, f, out);
    unit3(out);
}
