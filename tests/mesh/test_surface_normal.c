/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a file stores so that a tick need not walk the triangles at a vertex: normals, borders, creases. The oracle goes
 * over all triangles, in long double; it takes from the library only where triangles lie.
 */
#include <math.h>

#include "lib/dpa.h"
#include "nearest/nearest_pair.h"

static const double degree = 3.14159265358979323846 / 180.0;

struct scene {
    struct file file;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    struct surface surface;
    double (*corner)[9]; /* of each triangle by its source number */
};

static void open_scene(struct scene *scene, dpt_compiled *compiled)
{
    *scene = (struct scene){ .info.size = sizeof scene->info };
    scene->file = file_of(compiled->bytes, compiled->size);
    dpt_compiled_free(compiled);
    dpt_mesh_convert(scene->file.bytes, scene->file.size, NULL);
    CHECK(dpt_mesh_open(scene->file.bytes, scene->file.size, &scene->mesh) == DPT_OK, "no mesh");
    dpt_mesh_get_info(scene->mesh, &scene->info);
    dpti_surface_of_mesh(scene->mesh, &scene->surface);
    scene->corner = calloc(scene->info.source_triangles, sizeof *scene->corner);
    for (uint32_t t = 0; t < scene->info.source_triangles; t++)
        dpt_mesh_get_triangle(scene->mesh, t, scene->corner[t]);
}

static void close_scene(struct scene *scene)
{
    free(scene->file.bytes);
    free(scene->corner);
}

static void scene_of_arrays(struct scene *scene, const double *vertices, size_t vertex_count, const uint32_t *corners,
                            size_t triangle_count, double crease)
{
    dpt_compile_def def = { .size = sizeof def, .crease = crease };
    dpt_compiled compiled = { NULL, 0 };
    dpt_result result = dpt_compile_arrays(vertices, vertex_count, corners, triangle_count, &def, &compiled, NULL);
    CHECK(result == DPT_OK, "%s", dpt_result_name(result));
    open_scene(scene, &compiled);
}

static void scene_of_shape(struct scene *scene, const char *name, uint64_t count, double crease)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, 0, &shape, reason))
        CHECK(0, "%s", reason);
    scene_of_arrays(scene, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, crease);
    shape_free(&shape);
}

typedef long double real;

static real dot_of(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross_of(const real a[3], const real b[3], real out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* From corner k to the next one and to the last one. */
static void edges_at(const double c[9], int k, real next[3], real last[3])
{
    for (int i = 0; i < 3; i++) {
        next[i] = (real)c[3 * ((k + 1) % 3) + i] - (real)c[3 * k + i];
        last[i] = (real)c[3 * ((k + 2) % 3) + i] - (real)c[3 * k + i];
    }
}

/* The unit normal of a triangle, and its angle at corner k. */
static real plane_of(const double c[9], int k, real n[3])
{
    real next[3], last[3];
    edges_at(c, k, next, last);
    cross_of(next, last, n);
    real area = sqrtl(dot_of(n, n));
    for (int i = 0; i < 3; i++)
        n[i] /= area;
    return atan2l(area, dot_of(next, last));
}

static int same_point(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Over all triangles of a mesh of one part. */
static void normal_by_all(const struct scene *scene, const double *x, real n[3])
{
    real sum[3] = { 0, 0, 0 };
    for (uint32_t t = 0; t < scene->info.source_triangles; t++)
        for (int k = 0; k < 3; k++)
            if (same_point(scene->corner[t] + 3 * k, x)) {
                real plane[3], angle = plane_of(scene->corner[t], k, plane);
                for (int i = 0; i < 3; i++)
                    sum[i] += angle * plane[i];
            }
    real size = sqrtl(dot_of(sum, sum));
    for (int i = 0; i < 3; i++)
        n[i] = sum[i] / size;
}

static const struct {
    const char *name;
    uint64_t count;
} shapes[] = { { "torus", 200 }, { "liver", 500 },   { "star", 2000 }, { "box", 12 },
               { "box", 300 },   { "stomach", 301 }, { "cloth", 200 }, { "hub", 77 },
               { "sphere", 20 }, { "membrane", 32 }, { "spleen", 400 } };

static void normals_are_angle_weighted(void)
{
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct scene scene;
        double worst = 0.0;
        scene_of_shape(&scene, shapes[s].name, shapes[s].count, 0.0);
        CHECK(scene.info.normalless_vertices == 0, "%s", shapes[s].name);
        CHECK(mesh_normals(scene.mesh) != NULL, "%s stores none", shapes[s].name);
        for (uint32_t t = 0; t < scene.info.source_triangles; t++) {
            double normals[9];
            CHECK(dpt_mesh_get_vertex_normals(scene.mesh, t, normals) == DPT_OK, "triangle %u", t);
            for (int k = 0; k < 3; k++) {
                real n[3];
                normal_by_all(&scene, scene.corner[t] + 3 * k, n);
                for (int i = 0; i < 3; i++)
                    worst = fmax(worst, fabs((double)(n[i] - (real)normals[3 * k + i])));
            }
        }
        CHECK(worst <= 0x1p-24, "%s: off by %g", shapes[s].name, worst);
        CHECK(scene.info.bytes <= 4096 + (uint64_t)160 * scene.info.triangles, "%s: %llu bytes", shapes[s].name,
              (unsigned long long)scene.info.bytes);
        close_scene(&scene);
    }
}

/* A triangle's edge k as another one has it: +1 the same way, -1 the other way, 0 not. */
static int has_edge(const double *c, int k, const double *other)
{
    const double *a = c + 3 * k, *b = c + 3 * ((k + 1) % 3);
    for (int i = 0; i < 3; i++) {
        const double *x = other + 3 * i, *y = other + 3 * ((i + 1) % 3);
        if (same_point(a, x) && same_point(b, y))
            return 1;
        if (same_point(a, y) && same_point(b, x))
            return -1;
    }
    return 0;
}

/* DPT_EDGE_... of edge k, shifted to k = 0; all of them where the angle is too near to the limit to tell. */
static uint32_t edge_by_all(const struct scene *scene, uint32_t t, int k)
{
    int count = 0, way = 0;
    uint32_t other = 0;
    for (uint32_t u = 0; u < scene->info.source_triangles; u++) {
        int found = u == t ? 0 : has_edge(scene->corner[t], k, scene->corner[u]);
        if (found) {
            count++;
            way = found;
            other = u;
        }
    }
    if (count != 1)
        return count ? DPT_EDGE_NONMANIFOLD : DPT_EDGE_BORDER;
    real a[3], b[3], c[3];
    plane_of(scene->corner[t], 0, a);
    plane_of(scene->corner[other], 0, b);
    cross_of(a, b, c);
    real angle = atan2l(sqrtl(dot_of(c, c)), -way * dot_of(a, b));
    if (fabsl(angle - (real)scene->info.crease) < 1e-8L)
        return UINT32_MAX;
    return angle > (real)scene->info.crease ? DPT_EDGE_CREASE : 0;
}

static void check_flags(const struct scene *scene, const char *name)
{
    const uint32_t count = scene->info.source_triangles;
    uint32_t(*edge)[3] = calloc(count, sizeof *edge), creases = 0;
    for (uint32_t t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) {
            edge[t][k] = edge_by_all(scene, t, k);
            CHECK(edge[t][k] != UINT32_MAX, "%s: choose another limit", name);
            creases += edge[t][k] == DPT_EDGE_CREASE;
        }
    CHECK(scene->info.crease_edges == creases / 2, "%s: %u creases, not %u", name, scene->info.crease_edges,
          creases / 2);
    for (uint32_t t = 0; t < count; t++) {
        uint32_t flags = 0, wanted = 0;
        CHECK(dpt_mesh_get_triangle_flags(scene->mesh, t, &flags) == DPT_OK, "%s: %u", name, t);
        for (int k = 0; k < 3; k++) {
            wanted |= edge[t][k] << k;
            for (uint32_t u = 0; u < count; u++)
                for (int i = 0; i < 3; i++)
                    if (same_point(scene->corner[t] + 3 * k, scene->corner[u] + 3 * i)) {
                        uint32_t two = edge[u][i] | edge[u][(i + 2) % 3];
                        wanted |= (two & DPT_EDGE_BORDER ? (uint32_t)DPT_CORNER_BORDER : 0) << k;
                        wanted |= (two & DPT_EDGE_CREASE ? (uint32_t)DPT_CORNER_CREASE : 0) << k;
                        wanted |= (two & DPT_EDGE_NONMANIFOLD ? (uint32_t)DPT_CORNER_NONMANIFOLD : 0) << k;
                    }
        }
        CHECK(flags == wanted, "%s: triangle %u has %05x, not %05x", name, t, flags, wanted);
    }
    free(edge);
}

static void edges_and_corners_are_flagged(void)
{
    const double limits[] = { 0.0, 3.3, 44.7, 91.0, 180.0 };
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++)
        for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
            struct scene scene;
            if (shapes[s].count > 500)
                continue;
            scene_of_shape(&scene, shapes[s].name, shapes[s].count, limits[i] * degree);
            CHECK(scene.info.crease == (i ? limits[i] * degree : 1.0471975511965976), "%.17g", scene.info.crease);
            check_flags(&scene, shapes[s].name);
            close_scene(&scene);
        }
    /* Triangles over a few points, every kind of edge among them, and wound as it comes. */
    uint64_t random = 3;
    for (int round = 0; round < 40; round++) {
        double vertices[3 * 14];
        uint32_t corners[3 * 24];
        struct scene scene;
        for (int i = 0; i < 3 * 14; i++)
            vertices[i] = random_in(&random, -1.0, 1.0);
        for (int t = 0; t < 24; t++) {
            uint32_t a = (uint32_t)(random_bits(&random) % 14);
            corners[3 * t] = a;
            corners[3 * t + 1] = (a + 1 + (uint32_t)(random_bits(&random) % 6)) % 14;
            corners[3 * t + 2] = (a + 7 + (uint32_t)(random_bits(&random) % 6)) % 14;
        }
        scene_of_arrays(&scene, vertices, 14, corners, 24, 70.0 * degree);
        if (!scene.info.dropped_duplicate)
            check_flags(&scene, "soup");
        close_scene(&scene);
    }
}

static void wrong_limits_are_refused(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, wrong[] = { -1.0, 3.15, NAN, INFINITY };
    const uint32_t corners[] = { 0, 1, 2 };
    dpt_compiled compiled;
    for (int i = 0; i < 4; i++) {
        dpt_compile_def def = { .size = sizeof def, .crease = wrong[i] };
        CHECK(dpt_compile_arrays(vertices, 3, corners, 1, &def, &compiled, NULL) == DPT_E_ARGUMENT, "%g", wrong[i]);
        /* A def that ends before it has none. */
        def.size = offsetof(dpt_compile_def, crease);
        CHECK(dpt_compile_arrays(vertices, 3, corners, 1, &def, &compiled, NULL) == DPT_OK, "%g", wrong[i]);
        dpt_compiled_free(&compiled);
    }
}

/* Limits a hair below and above the angle of an edge. */
static void limits_are_met_to_the_hair(void)
{
    struct scene scene;
    uint32_t tried = 0;
    scene_of_shape(&scene, "liver", 500, 0.0);
    for (uint32_t t = 0; t < 500; t += 83) {
        real a[3], b[3], c[3];
        uint32_t other = 0, flags[2] = { 0, 0 };
        while (other == t || !has_edge(scene.corner[t], 0, scene.corner[other]))
            other++;
        plane_of(scene.corner[t], 0, a);
        plane_of(scene.corner[other], 0, b);
        cross_of(a, b, c);
        double angle = (double)atan2l(sqrtl(dot_of(c, c)), dot_of(a, b));
        if (angle < 0.05)
            continue;
        for (int i = 0; i < 2; i++) {
            struct scene at;
            scene_of_shape(&at, "liver", 500, angle + (i ? 1e-12 : -1e-12));
            dpt_mesh_get_triangle_flags(at.mesh, t, &flags[i]);
            close_scene(&at);
        }
        CHECK((flags[0] & DPT_EDGE_CREASE) && !(flags[1] & DPT_EDGE_CREASE), "triangle %u at %g", t, angle);
        tried++;
    }
    CHECK(tried > 2, "only %u edges", tried);
    close_scene(&scene);
}

/* Tetrahedra below and above a point that both have; each has its own normal there. */
static void parts_that_share_a_vertex_have_two_normals(void)
{
    const double vertices[] = { 0, 0, 0, 1, 0, 1, -1, 1, 1, -1, -1, 1, 1, 0, -1, -1, 1, -1, -1, -1, -1 };
    const uint32_t corners[] = { 0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3, 0, 4, 5, 0, 5, 6, 0, 6, 4, 4, 6, 5 };
    struct scene scene;
    double normals[9];
    scene_of_arrays(&scene, vertices, 7, corners, 8, 0.0);
    CHECK(scene.info.components == 2 && scene.info.closed_components == 2, "not two");
    CHECK(scene.info.normalless_vertices == 1, "%u without", scene.info.normalless_vertices);
    for (uint32_t t = 0; t < 8; t++)
        for (int k = 0; k < 3; k++) {
            if (!same_point(scene.corner[t] + 3 * k, vertices))
                continue;
            dpt_mesh_get_vertex_normals(scene.mesh, t, normals);
            const double *n = normals + 3 * k;
            CHECK(fabs(n[2] - (t < 4 ? -1.0 : 1.0)) < 0.2, "triangle %u: %g %g %g", t, n[0], n[1], n[2]);
        }
    close_scene(&scene);
}

/* A square about its middle, tilted, two of four triangles wound the other way: what is left of the sum is rounding. */
static void normals_that_cancel_are_none(void)
{
    const double vertices[] = { 0, 0, 1e-7, 1, 0, 0.3, 0, 1, 0.7, -1, 0, -0.3, 0, -1, -0.7 };
    const uint32_t corners[] = { 0, 1, 2, 0, 2, 3, 0, 4, 3, 0, 1, 4 };
    struct scene scene;
    scene_of_arrays(&scene, vertices, 5, corners, 4, 0.0);
    CHECK(scene.info.normalless_vertices == 1, "%u without", scene.info.normalless_vertices);
    close_scene(&scene);
}

/* Each with its own corners: no normals in the file, and it stays below 170 bytes a triangle. */
static void loose_triangles_store_none(void)
{
    enum { COUNT = 4000 };
    double *vertices = calloc(9 * COUNT, sizeof *vertices);
    uint32_t *corners = calloc(3 * COUNT, sizeof *corners);
    uint64_t random = 1;
    struct scene scene;
    for (int i = 0; i < 9 * COUNT; i++)
        vertices[i] = random_in(&random, -1.0, 1.0);
    for (uint32_t i = 0; i < 3 * COUNT; i++)
        corners[i] = i;
    scene_of_arrays(&scene, vertices, 3 * COUNT, corners, COUNT, 0.0);
    CHECK(mesh_normals(scene.mesh) == NULL, "normals are stored");
    CHECK(scene.info.bytes <= (uint64_t)COUNT * 170, "%llu bytes", (unsigned long long)scene.info.bytes);
    for (uint32_t t = 0; t < COUNT; t += 97) {
        double normals[9];
        real plane[3];
        plane_of(scene.corner[t], 0, plane);
        dpt_mesh_get_vertex_normals(scene.mesh, t, normals);
        for (int i = 0; i < 9; i++)
            CHECK(fabs(normals[i] - (double)plane[i % 3]) < 1e-12, "triangle %u", t);
    }
    free(vertices);
    free(corners);
    close_scene(&scene);
}

/*
 * The side at a vertex, of directions as near to the plane of its normal as doubles go: a float's rounding must not
 * turn it. `place` is not the source's number.
 */
static void sides_at_vertices_do_not_turn(void)
{
    uint64_t random = 7, near = 0;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct scene scene;
        scene_of_shape(&scene, shapes[s].name, shapes[s].count, 0.0);
        for (uint32_t place = 0; place < scene.info.triangles; place += 7) {
            uint32_t t = scene.surface.sources[place];
            for (int k = 0; k < 3; k++) {
                real n[3], r[3], side[3];
                double weight[3] = { 0.0, 0.0, 0.0 };
                weight[k] = 1.0;
                normal_by_all(&scene, scene.corner[t] + 3 * k, n);
                for (int i = 0; i < 3; i++)
                    r[i] = (real)random_in(&random, -1.0, 1.0);
                cross_of(n, r, side);
                for (int e = 1; e < 14; e++) {
                    real lean = powl(10.0L, -e) * (e % 2 ? 1 : -1);
                    pair found = { .weight = { weight[0], weight[1], weight[2] } };
                    double size = pow(10.0, random_in(&random, -6.0, 0.0));
                    found.gap = (vec3){ size * (double)(side[0] + lean * n[0]), size * (double)(side[1] + lean * n[1]),
                                        size * (double)(side[2] + lean * n[2]) };
                    const real gap[3] = { found.gap.x, found.gap.y, found.gap.z };
                    real rise = dot_of(n, gap);
                    if (fabsl(rise) < 1e-13L * size)
                        continue;
                    near += fabsl(rise) < 0x1p-25L * size;
                    CHECK(dpti_side_of_pair(&scene.surface, place, &found) == (rise < 0 ? -1 : 1),
                          "%s, triangle %u, lean %Lg", shapes[s].name, t, lean);
                }
            }
        }
        close_scene(&scene);
    }
    CHECK(near > 1000, "only %llu near", (unsigned long long)near);
}

/* A cylinder of 24 sides and height 2, closed; the axis z. */
static void scene_of_cylinder(struct scene *scene, double crease)
{
    enum { SIDES = 24 };
    double vertices[3 * (2 * SIDES + 2)] = { 0, 0, -1, 0, 0, 1 };
    uint32_t corners[3 * 4 * SIDES], *c = corners;
    for (uint32_t i = 0; i < SIDES; i++) {
        for (uint32_t k = 0; k < 2; k++) {
            double *v = vertices + 3 * (2 + 2 * i + k);
            v[0] = cos(i * 360.0 / SIDES * degree);
            v[1] = sin(i * 360.0 / SIDES * degree);
            v[2] = k ? 1.0 : -1.0;
        }
        uint32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % SIDES);
        const uint32_t four[12] = { 0, b, a, 1, a + 1, b + 1, a, b, b + 1, a, b + 1, a + 1 };
        memcpy(c, four, sizeof four);
        c += 12;
    }
    scene_of_arrays(scene, vertices, 2 * SIDES + 2, corners, 4 * SIDES, crease);
}

static vec3 smooth_at(const struct scene *scene, uint32_t source, double a, double b)
{
    const double weight[3] = { a, b, 1.0 - a - b };
    return dpti_surface_smooth_normal(&scene->surface, mesh_words(scene->mesh, MESH_PLACES)[source], weight);
}

/* Round along the side, flat on the lids, sharp between them; all round where no edge is a crease. */
static void creases_are_not_smoothed(void)
{
    struct scene sharp, round;
    scene_of_cylinder(&sharp, 0.0);
    scene_of_cylinder(&round, 180.0 * degree);
    CHECK(sharp.info.crease_edges == 48 && round.info.crease_edges == 0, "%u, %u", sharp.info.crease_edges,
          round.info.crease_edges);
    double across = 0.0;
    for (uint32_t t = 0; t < 96; t++)
        for (int i = 0; i <= 4; i++)
            for (int k = 0; i + k <= 4; k++) {
                vec3 n = smooth_at(&sharp, t, i / 4.0, k / 4.0);
                if (t % 4 < 2) {
                    CHECK(fabs(n.z - (t % 4 ? 1.0 : -1.0)) < 1e-12, "lid: %g", n.z);
                    continue;
                }
                const double *c = sharp.corner[t];
                double x = (i * c[0] + k * c[3] + (4 - i - k) * c[6]) / 4.0;
                double y = (i * c[1] + k * c[4] + (4 - i - k) * c[7]) / 4.0;
                double off = fabs(n.x * y - n.y * x) / sqrt(x * x + y * y);
                CHECK(fabs(n.z) < 1e-12 && off < 0.01, "side: %g %g %g", n.x, n.y, n.z);
                across = fmax(across, fabs(smooth_at(&round, t, i / 4.0, k / 4.0).z));
            }
    CHECK(across > 0.5, "without creases it is not round: %g", across);
    close_scene(&sharp);
    close_scene(&round);
}

/*
 * A tick does not look at the fan of a hub: with one that tells nonsense, checksums made good, the answers about it
 * stay what they were.
 */
static void hubs_cost_no_fan(void)
{
    enum { COUNT = 50000 };
    struct scene scene, forged;
    scene_of_shape(&scene, "hub", COUNT, 0.0);
    struct dpt_mesh header = header_of(&scene.file);
    const uint32_t *first = mesh_words(scene.mesh, MESH_FAN_FIRST);
    uint32_t hub = 0;
    while (first[hub + 1] - first[hub] < COUNT)
        hub++;
    struct file file = copy_of(&scene.file);
    memset(file.bytes + header.section[MESH_FANS].offset + 4 * (size_t)first[hub], 0, 4 * COUNT);
    seal(&file);
    forged = scene;
    forged.file = file;
    CHECK(dpt_mesh_open(file.bytes, file.size, &forged.mesh) == DPT_OK, "does not open");
    dpti_surface_of_mesh(forged.mesh, &forged.surface);
    uint64_t random = 2;
    for (uint32_t place = 0; place < COUNT; place += 331) {
        double weight[3] = { 0.0, 0.0, 0.0 };
        int k = 0;
        while (k < 2 && scene.surface.corners[3 * place + (uint32_t)k] != hub)
            k++;
        weight[k] = 1.0;
        pair found = { .weight = { weight[0], weight[1], weight[2] } };
        found.gap =
            (vec3){ random_in(&random, -1.0, 1.0), random_in(&random, -1.0, 1.0), random_in(&random, 0.1, 1.0) };
        vec3 n = dpti_surface_feature_normal(&scene.surface, place, weight);
        vec3 m = dpti_surface_feature_normal(&forged.surface, place, weight);
        CHECK(!memcmp(&n, &m, sizeof n), "another normal");
        n = dpti_surface_smooth_normal(&scene.surface, place, weight);
        m = dpti_surface_smooth_normal(&forged.surface, place, weight);
        CHECK(!memcmp(&n, &m, sizeof n), "another smooth normal");
        CHECK(dpti_side_of_pair(&scene.surface, place, &found) == dpti_side_of_pair(&forged.surface, place, &found),
              "another side");
        CHECK(!dpti_side_is_border(&forged.surface, place, weight), "the hub is no border");
        weight[k] = 0.0;
        weight[(k + 1) % 3] = 1.0;
        CHECK(dpti_side_is_border(&forged.surface, place, weight), "its rim is one");
    }
    free(file.bytes);
    close_scene(&scene);
}

/* Borders too, all fans of a cloth being nonsense. */
static void borders_cost_no_fan(void)
{
    struct scene scene;
    uint32_t alone = 0;
    scene_of_shape(&scene, "cloth", 200, 0.0);
    struct dpt_mesh header = header_of(&scene.file);
    memset(scene.file.bytes + header.section[MESH_FANS].offset, 0, (size_t)header.section[MESH_FANS].bytes);
    for (uint32_t place = 0; place < scene.info.triangles; place++)
        for (int k = 0; k < 3; k++) {
            double weight[3] = { 0.0, 0.0, 0.0 };
            uint32_t t = scene.surface.sources[place], flags, wanted = 0;
            dpt_mesh_get_triangle_flags(scene.mesh, t, &flags);
            weight[k] = 1.0;
            for (uint32_t u = 0; u < scene.info.triangles && !wanted; u++)
                for (int i = 0; i < 3; i++)
                    if (same_point(scene.corner[t] + 3 * k, scene.corner[u] + 3 * i))
                        wanted |= (edge_by_all(&scene, u, i) | edge_by_all(&scene, u, (i + 2) % 3)) & DPT_EDGE_BORDER;
            alone += wanted && !(flags & 7u);
            CHECK(dpti_side_is_border(&scene.surface, place, weight) == (int)wanted, "triangle %u", t);
        }
    CHECK(alone > 10, "only %u touch the border in a point", alone);
    close_scene(&scene);
}

int main(void)
{
    TEST(normals_are_angle_weighted);
    TEST(edges_and_corners_are_flagged);
    TEST(limits_are_met_to_the_hair);
    TEST(wrong_limits_are_refused);
    TEST(parts_that_share_a_vertex_have_two_normals);
    TEST(normals_that_cancel_are_none);
    TEST(loose_triangles_store_none);
    TEST(sides_at_vertices_do_not_turn);
    TEST(creases_are_not_smoothed);
    TEST(hubs_cost_no_fan);
    TEST(borders_cost_no_fan);
    return check_report();
}
