/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Which parts have an inside, and how often they go round a point: against sums over all triangles by the
 * arctangent of the C library, against spheres that nest, cut and touch, against closed forms.
 *
 * With DPT_DATA in the environment also on public meshes.
 */
#include "winding.h"

#include <time.h>

#include "angle.h"
#include "check.h"
#include "compile/moment.h"
#include "dynpoint/compile.h"
#include "dynpoint/query.h"
#include "shape.h"

#define PI 3.14159265358979323846

/* A mesh that is put together from shapes. */
struct scene {
    double *vertices;
    uint32_t *corners;
    size_t vertex_count, triangle_count;
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    dpt_mesh_info info;
    struct tree tree;
    struct kernel kernel;
};

static void scene_room(struct scene *scene, size_t vertices, size_t triangles)
{
    scene->vertices =
        realloc(scene->vertices, (scene->vertex_count + vertices) * 3 * sizeof *scene->vertices);
    scene->corners =
        realloc(scene->corners, (scene->triangle_count + triangles) * 3 * sizeof *scene->corners);
}

static void add_vertex(struct scene *scene, double x, double y, double z)
{
    double *v = scene->vertices + 3 * scene->vertex_count++;
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

static void add_triangle(struct scene *scene, size_t a, size_t b, size_t c, int inward)
{
    uint32_t *corner = scene->corners + 3 * scene->triangle_count++;
    corner[0] = (uint32_t)a;
    corner[1] = (uint32_t)(inward ? c : b);
    corner[2] = (uint32_t)(inward ? b : c);
}

/* A shape of `dynpoint make` at a place, its last triangles missing. */
static void add_shape(struct scene *scene, const char *name, uint64_t count, vec3 at, double size,
                      int inward, size_t missing)
{
    struct shape shape;
    shape_reason reason;
    if (shape_make(name, count, 0, &shape, reason)) {
        CHECK(0, "%s", reason);
        return;
    }
    scene_room(scene, shape.vertex_count, shape.triangle_count);
    size_t base = scene->vertex_count;
    for (size_t v = 0; v < shape.vertex_count; v++)
        add_vertex(scene, at.x + size * shape.vertices[3 * v],
                   at.y + size * shape.vertices[3 * v + 1],
                   at.z + size * shape.vertices[3 * v + 2]);
    for (size_t t = 0; t + missing < shape.triangle_count; t++)
        add_triangle(scene, base + shape.corners[3 * t], base + shape.corners[3 * t + 1],
                     base + shape.corners[3 * t + 2], inward);
    shape_free(&shape);
}

/* A ball of rings, without what lies above `open` of its area, 0 for a closed one. */
static void add_ball(struct scene *scene, vec3 at, double radius, double open, int inward)
{
    enum { ROUND = 32, RINGS = 24 };
    const double first = acos(1.0 - 2.0 * open);
    scene_room(scene, ROUND * RINGS + 2, 2 * ROUND * RINGS);
    size_t base = scene->vertex_count;
    for (int ring = 0; ring < RINGS; ring++)
        for (int k = 0; k < ROUND; k++) {
            double down =
                open > 0.0 ? first + (PI - first) * ring / RINGS : PI * (ring + 1) / (RINGS + 1);
            double turn = 2.0 * PI * k / ROUND;
            add_vertex(scene, at.x + radius * sin(down) * cos(turn),
                       at.y + radius * sin(down) * sin(turn), at.z + radius * cos(down));
        }
    add_vertex(scene, at.x, at.y, at.z - radius);
    add_vertex(scene, at.x, at.y, at.z + radius);
    for (size_t ring = 0; ring < RINGS; ring++)
        for (size_t k = 0; k < ROUND; k++) {
            size_t a = base + ROUND * ring + k, b = base + ROUND * ring + (k + 1) % ROUND;
            if (ring + 1 < RINGS) {
                add_triangle(scene, a, a + ROUND, b, inward);
                add_triangle(scene, b, a + ROUND, b + ROUND, inward);
            } else {
                add_triangle(scene, a, base + ROUND * RINGS, b, inward);
            }
            if (ring == 0 && !(open > 0.0))
                add_triangle(scene, a, b, base + ROUND * RINGS + 1, inward);
        }
}

/* Far away, small and with a hole: makes the compiler write moments, and adds nothing near the origin. */
static void add_beacon(struct scene *scene)
{
    add_shape(scene, "sphere", 40, (vec3){ 100.0, 0.0, 0.0 }, 0.1, 0, 1);
}

static int scene_open(struct scene *scene)
{
    uint32_t chosen;
    dpt_diag diag = { .size = sizeof diag };
    scene->info.size = sizeof scene->info;
    dpt_result result = dpt_compile_arrays(scene->vertices, scene->vertex_count, scene->corners,
                                           scene->triangle_count, NULL, &scene->compiled, &diag);
    if (result == DPT_OK)
        result = dpt_mesh_convert(scene->compiled.bytes, scene->compiled.size, NULL);
    if (result == DPT_OK)
        result = dpt_mesh_open(scene->compiled.bytes, scene->compiled.size, &scene->mesh);
    CHECK(result == DPT_OK, "%s %s", dpt_result_name(result), diag.text);
    if (result != DPT_OK)
        return 0;
    dpt_mesh_get_info(scene->mesh, &scene->info);
    tree_of_mesh(scene->mesh, &scene->tree);
    kernel_get(DPT_KERNEL_AUTO, &scene->kernel, &chosen);
    return 1;
}

static void scene_close(struct scene *scene)
{
    dpt_compiled_free(&scene->compiled);
    free(scene->vertices);
    free(scene->corners);
}

static double winding_at(const struct scene *scene, double x, double y, double z)
{
    uint32_t work = 0;
    return winding_number(&scene->tree, &scene->kernel, (vec3){ x, y, z }, UINT32_MAX, &work);
}

/* The flags of the part of a source triangle. */
static uint32_t flags_of(const struct scene *scene, uint32_t source)
{
    uint32_t place = mesh_words(scene->mesh, MESH_PLACES)[source];
    return mesh_part_flags(scene->mesh, mesh_words(scene->mesh, MESH_PARTS)[place]);
}

/* The definition: all triangles of solid parts, as the file has them wound. */
static double brute_at(const struct scene *scene, vec3 x)
{
    double sum = 0.0, at[3] = { x.x, x.y, x.z };
    for (uint32_t t = 0; t < scene->info.source_triangles; t++) {
        double c[9], r[3], product[3];
        if (dpt_mesh_triangle(scene->mesh, t, c) != DPT_OK ||
            !(flags_of(scene, t) & MESH_PART_SOLID))
            continue;
        for (int k = 0; k < 9; k++)
            c[k] -= at[k % 3];
        for (int i = 0; i < 3; i++) {
            const double *a = c + 3 * i, *b = c + (3 * i + 3) % 9;
            r[i] = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
            product[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        double volume = c[0] * (c[4] * c[8] - c[5] * c[7]) + c[1] * (c[5] * c[6] - c[3] * c[8]) +
                        c[2] * (c[3] * c[7] - c[4] * c[6]);
        sum += 2.0 * atan2(volume, r[0] * r[1] * r[2] + product[0] * r[2] + product[1] * r[0] +
                                       product[2] * r[1]);
    }
    return sum / (4.0 * PI);
}

static vec3 point_in_box(const struct scene *scene, uint64_t *random)
{
    const double *low = scene->info.box_min, *high = scene->info.box_max;
    return (vec3){ random_in(random, low[0], high[0]), random_in(random, low[1], high[1]),
                   random_in(random, low[2], high[2]) };
}

/* Off the middle of a triangle by a share of the diagonal, along its normal. */
static vec3 point_off(const struct scene *scene, uint32_t place, double share)
{
    const struct tree *tree = &scene->tree;
    const double *low = scene->info.box_min, *high = scene->info.box_max;
    vec3 c[3];
    for (uint32_t k = 0; k < 3; k++)
        c[k] = vec3_of_float(tree->positions + 3 * (size_t)tree->corners[3 * (size_t)place + k]);
    vec3 middle = scaled(add(add(c[0], c[1]), c[2]), 1.0 / 3.0);
    vec3 normal = cross(sub(c[1], c[0]), sub(c[2], c[0]));
    return along(middle, share * length(sub(vec3_of(high), vec3_of(low))) / length(normal), normal);
}

/* `points` within the box and as many near the surface, on all kernels; returns the largest error. */
static double check_against_brute(const char *name, const struct scene *scene, int points)
{
    static const double shares[] = { 1e-2, -1e-3, 1e-4, -1e-6, 1e-9 };
    uint64_t random = 41;
    uint32_t chosen, most_work = 0;
    double worst = 0.0;
    for (int i = 0; i < 2 * points; i++) {
        uint32_t place = (uint32_t)(random_bits(&random) % scene->info.triangles), work = 0;
        vec3 x = i % 2 ? point_in_box(scene, &random) : point_off(scene, place, shares[i / 2 % 5]);
        double winding = winding_number(&scene->tree, &scene->kernel, x, UINT32_MAX, &work);
        double error = fabs(winding - brute_at(scene, x));
        CHECK(error <= WINDING_ERROR, "%s: off by %g at %g %g %g", name, error, x.x, x.y, x.z);
        worst = larger(worst, error);
        most_work = work > most_work ? work : most_work;
        for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++) {
            struct kernel other;
            uint32_t again = 0;
            if (!kernel_get(id, &other, &chosen))
                continue;
            double same = winding_number(&scene->tree, &other, x, UINT32_MAX, &again);
            CHECK(!memcmp(&same, &winding, sizeof same) && again == work, "%s: %s says %g, not %g",
                  name, dpt_kernel_name(id), same, winding);
        }
    }
    printf("    %-12s %7u triangles: off by at most %.1e, work at most %u\n", name,
           scene->info.triangles, worst, most_work);
    CHECK(most_work < 2 * (scene->info.triangles / LANES) + 40, "%s: work %u", name, most_work);
    return worst;
}

static void windings_agree_with_brute_force(void)
{
    static const struct {
        const char *name;
        uint32_t count;
    } shapes[] = { { "sphere", 300 }, { "torus", 5568 },   { "liver", 20000 },
                   { "star", 8000 },  { "stomach", 4000 }, { "sphere", 100000 } };
    double worst = 0.0;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct scene scene = { .vertices = NULL };
        add_shape(&scene, shapes[i].name, shapes[i].count, (vec3){ 0.3, -0.2, 0.1 }, 1.0, 0, 1);
        if (scene_open(&scene)) {
            CHECK(scene.info.winding_components == 1, "%s has no moments", shapes[i].name);
            worst = larger(worst, check_against_brute(shapes[i].name, &scene, 200));
        }
        scene_close(&scene);
    }
    CHECK(worst < 1e-3, "the bound is proven, but this is a tenth of what it was: %g", worst);
}

/* Four sets of four triangles, joined twice, about `middle`; their true sum as seen from x. */
static struct moment make_set(uint64_t *random, vec3 middle, double size, vec3 x, double *truth)
{
    struct moment sets[4], triangles[4];
    vec3 c[3];
    *truth = 0.0;
    for (int s = 0; s < 4; s++) {
        const vec3 part = { random_in(random, -size, size), random_in(random, -size, size),
                            random_in(random, -size, size) };
        for (int t = 0; t < 4; t++) {
            for (int k = 0; k < 3; k++)
                c[k] = add(add(middle, part),
                           (vec3){ random_in(random, -size, size), random_in(random, -size, size),
                                   random_in(random, -size, size) });
            triangles[t] = moment_of_triangle(c[0], c[1], c[2]);
            *truth += solid_turns(sub(c[0], x), sub(c[1], x), sub(c[2], x));
        }
        sets[s] = moment_of_sets(triangles, 4);
    }
    return moment_of_sets(sets, 4);
}

/* What is left of a series is within its bound, in double and in float, from near the set to far away. */
static void series_keep_their_bound(void)
{
    uint64_t random = 61;
    struct kernel kernel;
    uint32_t chosen;
    double worst = 0.0;
    kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < 2000; i++) {
        float block[KERNEL_MOMENT_ROWS * LANES], sums[LANES] = { 0.0f }, doubts[LANES] = { 0.0f };
        double truth[LANES], errors[LANES];
        const float at[3] = { (float)random_in(&random, -1, 1), (float)random_in(&random, -1, 1),
                              (float)random_in(&random, -1, 1) };
        const vec3 x = { at[0], at[1], at[2] };
        const double size = pow(10.0, random_in(&random, -2.5, -0.5));
        for (int lane = 0; lane < LANES; lane++) {
            const vec3 middle = { random_in(&random, -1, 1), random_in(&random, -1, 1),
                                  random_in(&random, -1, 1) };
            struct moment set = make_set(&random, middle, size, x, &truth[lane]);
            double series = moment_winding(&set, x, &errors[lane]);
            moment_put(&set, block + lane);
            if (errors[lane] < HUGE_VAL) {
                CHECK(fabs(series - truth[lane]) <= errors[lane] + 1e-15, "off by %g, bound %g",
                      series - truth[lane], errors[lane]);
                worst = larger(worst, fabs(series - truth[lane]) / errors[lane]);
            }
        }
        const uint32_t open = kernel.moments(block, at, 1e-2f, sums, doubts);
        for (int lane = 0; lane < LANES; lane++) {
            const int closed = !(open >> lane & 1);
            CHECK(closed ? fabs(errors[lane] - (double)doubts[lane]) <= 1e-4 * errors[lane]
                         : sums[lane] == 0.0f && !(errors[lane] < 0.999e-2),
                  "lane %d: bound %g, %g in float", lane, errors[lane], (double)doubts[lane]);
            CHECK(!closed || fabs((double)sums[lane] - truth[lane]) <= errors[lane] + 1e-6,
                  "lane %d: %g, not %g", lane, (double)sums[lane], truth[lane]);
        }
    }
    printf("    off by at most %.2f of the bound\n", worst);
}

/* At the middle a ball goes round once, less its hole's share of the area. */
static void balls_with_holes(void)
{
    static const double open[] = { 0.01, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7 };
    for (size_t i = 0; i < 2 * (sizeof open / sizeof *open); i++) {
        const double hole = open[i / 2];
        const int inward = i % 2;
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, hole, inward);
        if (scene_open(&scene)) {
            const uint32_t flags = flags_of(&scene, 0), wanted = hole < 0.12 ? 24u : 0u;
            CHECK((flags & ~7u) == wanted, "hole of %g: flags %u", hole, flags);
            CHECK(scene.info.solid_components == (wanted != 0) && !scene.info.cavities &&
                      !scene.info.closed_components && !scene.info.inward_components,
                  "hole of %g: %u solid", hole, scene.info.solid_components);
            CHECK(scene.info.turned_triangles == (wanted && inward ? scene.info.triangles : 0),
                  "hole of %g: %u turned", hole, scene.info.turned_triangles);
            double middle = winding_at(&scene, 0.0, 0.0, 0.0);
            CHECK(fabs(middle - (wanted ? 1.0 - hole : 0.0)) < 0.01, "hole of %g: %g", hole,
                  middle);
            CHECK(fabs(winding_at(&scene, 0.0, 0.0, -1.5)) < 0.1, "outside");
        }
        scene_close(&scene);
    }
}

/* A hundredth of the triangles is gone, others are wound the wrong way: still solid, and wound one way. */
static void torn_balls_are_solid(void)
{
    uint64_t random = 43;
    for (int inward = 0; inward < 2; inward++) {
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, inward);
        size_t kept = 0;
        for (size_t t = 0; t < scene.triangle_count; t++) {
            if (random_bits(&random) % 100 == 0)
                continue;
            uint32_t *to = scene.corners + 3 * kept++;
            const uint32_t *from = scene.corners + 3 * t;
            const int swap = random_bits(&random) % 10 == 0;
            const uint32_t a = from[0], b = from[swap ? 2 : 1], c = from[swap ? 1 : 2];
            to[0] = a;
            to[1] = b;
            to[2] = c;
        }
        scene.triangle_count = kept;
        if (scene_open(&scene)) {
            CHECK(flags_of(&scene, 0) ==
                      (MESH_PART_MANIFOLD | MESH_PART_WOUND | MESH_PART_SOLID | MESH_PART_WINDING),
                  "flags %u", flags_of(&scene, 0));
            CHECK(winding_at(&scene, 0.0, 0.0, 0.0) > 0.9, "%g", winding_at(&scene, 0, 0, 0));
            CHECK(winding_at(&scene, 0.3, 0.2, 0.4) > 0.9, "%g", winding_at(&scene, 0.3, 0.2, 0.4));
            CHECK(fabs(winding_at(&scene, 0.0, 1.1, 0.0)) < 0.1, "outside");
            CHECK(inward == (scene.info.turned_triangles > scene.info.triangles / 2), "%u turned",
                  scene.info.turned_triangles);
        }
        scene_close(&scene);
    }
}

static void sheets_have_no_inside(void)
{
    static const char *const names[] = { "cloth", "membrane" };
    struct scene scene;
    for (int i = 0; i < 2; i++) {
        scene = (struct scene){ .vertices = NULL };
        add_shape(&scene, names[i], 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        if (scene_open(&scene))
            CHECK(scene.info.solid_components == 0 && !(flags_of(&scene, 0) & ~7u), "%s: %u solid",
                  names[i], scene.info.solid_components);
        scene_close(&scene);
    }
    /* Beside a part that has moments a sheet adds nothing. */
    scene = (struct scene){ .vertices = NULL };
    add_shape(&scene, "membrane", 512, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    const size_t count = scene.triangle_count;
    add_beacon(&scene);
    if (scene_open(&scene)) {
        double worst = 0.0;
        for (uint32_t t = 0; t < count; t++) {
            const uint32_t place = mesh_words(scene.mesh, MESH_PLACES)[t];
            const vec3 x = point_off(&scene, place, 1e-5);
            worst = larger(worst, fabs(winding_at(&scene, x.x, x.y, x.z)));
        }
        CHECK(scene.info.winding_components == 1 && worst < 1e-3, "%u, %g",
              scene.info.winding_components, worst);
    }
    scene_close(&scene);
    /* Twelve loose triangles, and a flat square that is there twice, as a bag without a volume. */
    scene = (struct scene){ .vertices = NULL };
    scene_room(&scene, 41, 16);
    uint64_t random = 47;
    for (int v = 0; v < 36; v++)
        add_vertex(&scene, random_in(&random, -1, 1), random_in(&random, -1, 1),
                   random_in(&random, -1, 1));
    for (size_t t = 0; t < 12; t++)
        add_triangle(&scene, 3 * t, 3 * t + 1, 3 * t + 2, 0);
    for (int v = 0; v < 4; v++)
        add_vertex(&scene, 5.0 + (v & 1), 5.0 + v / 2, 5.0);
    add_vertex(&scene, 5.25, 5.5, 5.0);
    for (size_t k = 0; k < 4; k++) {
        static const size_t round[] = { 36, 37, 39, 38 };
        add_triangle(&scene, round[k], round[(k + 1) % 4], 40, 0);
    }
    if (scene_open(&scene))
        CHECK(scene.info.solid_components == 0, "%u solid", scene.info.solid_components);
    scene_close(&scene);
}

/* What has no part that needs it carries nothing for it. */
static void closed_meshes_carry_no_moments(void)
{
    struct scene scene = { .vertices = NULL };
    dpt_mesh_section section = { .size = sizeof section };
    uint32_t work = 0;
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    add_ball(&scene, (vec3){ 0.0, 0.0, 3.0 }, 1.0, 0.0, 1);
    if (scene_open(&scene)) {
        CHECK(dpt_mesh_get_section(scene.mesh, 11, &section) == DPT_OK && section.bytes == 0 &&
                  !strcmp(section.name, "moments"),
              "%s of %u bytes", section.name, (unsigned)section.bytes);
        CHECK(scene.info.solid_components == 2 && scene.info.inward_components == 1, "%u solid",
              scene.info.solid_components);
        CHECK(winding_number(&scene.tree, &scene.kernel, (vec3){ 0.0, 0.0, 0.0 }, UINT32_MAX,
                             &work) == 0.0 &&
                  work == 0,
              "work %u", work);
    }
    scene_close(&scene);
}

/* One ball in another, each wound either way: what is a void in the source stays one. */
static void nested_balls_keep_their_voids(void)
{
    for (int ways = 0; ways < 4; ways++) {
        const int outer = ways & 1, inner = ways >> 1, hollow = outer != inner;
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.5, 0.0, inner);
        const uint32_t second = (uint32_t)scene.triangle_count;
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, outer);
        add_beacon(&scene);
        if (scene_open(&scene)) {
            CHECK(fabs(winding_at(&scene, 0.1, 0.0, 0.0) - (hollow ? 0.0 : 2.0)) < 0.01,
                  "ways %d: %g", ways, winding_at(&scene, 0.1, 0.0, 0.0));
            CHECK(fabs(winding_at(&scene, 0.8, 0.0, 0.0) - 1.0) < 0.01, "ways %d, wall: %g", ways,
                  winding_at(&scene, 0.8, 0.0, 0.0));
            CHECK(fabs(winding_at(&scene, 1.2, 0.0, 0.0)) < 0.01, "ways %d, outside", ways);
            CHECK(scene.info.cavities == (uint32_t)hollow &&
                      scene.info.buried_components == (uint32_t)!hollow &&
                      scene.info.winding_components == 1 && scene.info.solid_components == 3,
                  "ways %d: %u cavities, %u buried", ways, scene.info.cavities,
                  scene.info.buried_components);
            CHECK(scene.info.inward_components == (uint32_t)(outer + (outer && inner)),
                  "ways %d: %u inward", ways, scene.info.inward_components);
            CHECK(flags_of(&scene, 0) == (hollow ? 15u : 47u) && flags_of(&scene, second) == 15u,
                  "ways %d: flags %u, %u", ways, flags_of(&scene, 0), flags_of(&scene, second));
        }
        scene_close(&scene);
    }
}

/* A stone within the void of a shell is outward whatever its source says; so is what lies beside. */
static void what_lies_in_a_void_is_in_the_open(void)
{
    for (int stone = 0; stone < 2; stone++) {
        struct scene scene = { .vertices = NULL };
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
        add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 0.8, 0.0, 1);
        const uint32_t first = (uint32_t)scene.triangle_count;
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.4, 0.0, stone);
        add_ball(&scene, (vec3){ 0.1, 0.0, 0.0 }, 0.1, 0.0, stone);
        add_beacon(&scene);
        if (scene_open(&scene)) {
            CHECK(scene.info.cavities == 1 && scene.info.buried_components == 1 &&
                      scene.info.inward_components == 2u * (uint32_t)stone,
                  "stone %d: %u cavities, %u inward", stone, scene.info.cavities,
                  scene.info.inward_components);
            CHECK(flags_of(&scene, first) == 15u, "flags %u", flags_of(&scene, first));
            CHECK(fabs(winding_at(&scene, 0.4, 0.0, 0.0) - 1.0) < 0.01, "in the stone");
            CHECK(fabs(winding_at(&scene, 0.1, 0.0, 0.0) - 2.0) < 0.01, "in its core");
            CHECK(fabs(winding_at(&scene, 0.7, 0.0, 0.0)) < 0.01, "in the void");
            CHECK(fabs(winding_at(&scene, 0.9, 0.0, 0.0) - 1.0) < 0.01, "in the shell");
        }
        scene_close(&scene);
    }
}

/* Loose triangles and a sheet: in material, in a void, through a wall, beside; and in a ball with a hole. */
static void sheets_within_solids_are_buried(void)
{
    static const struct {
        vec3 at;
        double size;
        int buried;
    } sheets[] = { { { 0.0, 0.0, 0.85 }, 0.1, 1 }, { { 0.0, 0.0, 0.0 }, 0.1, 0 },
                   { { 0.0, 0.0, 1.0 }, 0.1, 0 },  { { 0.0, 0.0, 0.7 }, 0.1, 0 },
                   { { 0.8, 0.8, 0.8 }, 0.1, 0 },  { { 0.0, -0.85, 0.0 }, 0.02, 1 },
                   { { 5.0, 0.0, 0.0 }, 0.3, 1 },  { { 5.0, 0.0, 0.9 }, 0.3, 0 } };
    const size_t count = sizeof sheets / sizeof *sheets;
    struct scene scene = { .vertices = NULL };
    for (size_t i = 0; i < count; i++) {
        const vec3 at = sheets[i].at;
        const double size = sheets[i].size;
        const size_t first = scene.vertex_count;
        scene_room(&scene, 3, 1);
        add_vertex(&scene, at.x - size, at.y, at.z - 0.5 * size);
        add_vertex(&scene, at.x + size, at.y, at.z - 0.5 * size);
        add_vertex(&scene, at.x, at.y + 0.2 * size, at.z + 0.5 * size);
        add_triangle(&scene, first, first + 1, first + 2, 0);
    }
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 0.7, 0.0, 1);
    add_ball(&scene, (vec3){ 5.0, 0.0, 0.0 }, 1.0, 0.02, 0);
    if (scene_open(&scene)) {
        for (size_t i = 0; i < count; i++)
            CHECK((flags_of(&scene, (uint32_t)i) & ~7u) ==
                      (sheets[i].buried ? (uint32_t)MESH_PART_BURIED : 0u),
                  "%zu: flags %u", i, flags_of(&scene, (uint32_t)i));
        CHECK(scene.info.solid_components == 3 && scene.info.buried_components == 0, "%u, %u",
              scene.info.solid_components, scene.info.buried_components);
        /* Both sides of the first one are inside. */
        for (int side = -1; side < 2; side += 2) {
            const double y = side * 0.02;
            const double ends[6] = { 0.0, y, 0.85, 0.01, y, 0.85 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(scene.mesh, NULL, ends, NULL, 1, &hit, NULL);
            CHECK(hit.triangle == 0 && hit.contact == DPT_CONTACT_PENETRATING &&
                      fabs(hit.gap + hit.distance) < 1e-4,
                  "%d: triangle %u, contact %u, gap %g, distance %g", side, hit.triangle,
                  hit.contact, hit.gap, hit.distance);
        }
    }
    scene_close(&scene);
}

/* Balls that cut each other, and one that only looks so to its box. */
static void cut_parts_need_a_winding_number(void)
{
    struct scene scene = { .vertices = NULL };
    uint64_t random = 53;
    const vec3 b = { 1.2, 0.1, 0.0 }, c = { -1.5, -1.5, 0.0 };
    add_ball(&scene, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 1);
    const uint32_t second = (uint32_t)scene.triangle_count;
    add_ball(&scene, b, 0.7, 0.0, 0);
    const uint32_t third = (uint32_t)scene.triangle_count;
    add_ball(&scene, c, 1.0, 0.0, 0);
    if (scene_open(&scene)) {
        CHECK(flags_of(&scene, 0) == 31u && flags_of(&scene, second) == 31u &&
                  flags_of(&scene, third) == 15u,
              "flags %u, %u, %u", flags_of(&scene, 0), flags_of(&scene, second),
              flags_of(&scene, third));
        int inside = 0;
        for (int i = 0; i < 4000; i++) {
            vec3 x = point_in_box(&scene, &random);
            const double off[] = { length(x) - 1.0, length(sub(x, b)) - 0.7,
                                   length(sub(x, c)) - 1.0 };
            int in = 0, near = 0;
            for (int k = 0; k < 3; k++) {
                in += off[k] < 0.0;
                near |= fabs(off[k]) < 0.03; /* balls have faces */
            }
            double winding = winding_at(&scene, x.x, x.y, x.z);
            CHECK(near || fabs(winding - in) < 0.01, "%g, in %d balls", winding, in);
            inside += in > 0;
        }
        CHECK(inside > 1000, "%d inside", inside);
    }
    scene_close(&scene);
}

/* A ball comes out of a large face, off its edges; a box stands on that face; another hovers above it. */
static void contact_is_found_within_faces(void)
{
    static const double heights[] = { 0.0, 1.05, 0.05 };
    static const int cuts[] = { 1, 1, 0 };
    for (int i = 0; i < 3; i++) {
        struct scene scene = { .vertices = NULL };
        add_shape(&scene, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        scene_open(&scene);
        const double *low = scene.info.box_min, *high = scene.info.box_max;
        const double top = high[2], size = 0.1 * (high[0] - low[0]);
        const vec3 above = { 0.5 * (low[0] + high[0]) + size, 0.85 * low[1] + 0.15 * high[1],
                             top + (i == 2   ? 1.0 + heights[i]
                                    : i == 0 ? heights[i]
                                             : 0.0) *
                                       size };
        dpt_compiled_free(&scene.compiled);
        if (i == 1) { /* stands on it */
            scene_room(&scene, 8, 12);
            size_t base = scene.vertex_count;
            static const uint8_t faces[12][3] = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 },
                                                  { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
                                                  { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 },
                                                  { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
            for (int k = 0; k < 8; k++)
                add_vertex(&scene, above.x + (k & 1 ? size : 0.0), above.y + (k & 2 ? size : 0.0),
                           top + (k & 4 ? size : 0.0));
            for (int t = 0; t < 12; t++)
                add_triangle(&scene, base + faces[t][0], base + faces[t][1], base + faces[t][2], 0);
        } else {
            add_ball(&scene, above, size, 0.0, 0);
        }
        if (scene_open(&scene))
            CHECK(scene.info.winding_components == 2u * (uint32_t)cuts[i] &&
                      scene.info.components == 2 && scene.info.buried_components == 0,
                  "%d: %u by winding of %u", i, scene.info.winding_components,
                  scene.info.components);
        scene_close(&scene);
    }
}

/* Beside a surface, nearer than float tells, it is still known which side is which. */
static void check_sides(uint64_t triangles)
{
    static const double shares[] = { 1e-3, 1e-5, 1e-7, 1e-9, 1e-11 };
    struct scene scene = { .vertices = NULL };
    uint64_t random = 59;
    int bad = 0, asked = 0;
    add_shape(&scene, "sphere", triangles, (vec3){ 0.2, 0.3, -0.1 }, 1.0, 0, 1);
    if (scene_open(&scene)) {
        const uint32_t gone = mesh_words(scene.mesh, MESH_PLACES)[0]; /* beside the hole */
        for (int i = 0; i < 1000; i++) {
            const double share = shares[i % 5];
            uint32_t place = (uint32_t)(random_bits(&random) % scene.info.triangles);
            if (place / 64 == gone / 64)
                continue;
            vec3 in = point_off(&scene, place, -share), out = point_off(&scene, place, share);
            double step =
                winding_at(&scene, in.x, in.y, in.z) - winding_at(&scene, out.x, out.y, out.z);
            asked++;
            bad += !(fabs(step - 1.0) < 0.1);
            /* By a vertex, and by an edge. */
            const uint32_t *corner = scene.tree.corners + 3 * (size_t)place;
            const float *p = scene.tree.positions + 3 * (size_t)corner[0];
            const float *q = scene.tree.positions + 3 * (size_t)corner[i % 2];
            const vec3 on = scaled(add(vec3_of_float(p), vec3_of_float(q)), 0.5);
            const vec3 way = { random_in(&random, -1, 1), random_in(&random, -1, 1),
                               random_in(&random, -1, 1) };
            in = along(on, -share, way);
            out = along(on, share, way);
            asked++;
            bad += !(fabs(winding_at(&scene, in.x, in.y, in.z) - brute_at(&scene, in)) < 0.001 &&
                     fabs(winding_at(&scene, out.x, out.y, out.z) - brute_at(&scene, out)) < 0.001);
        }
        CHECK(bad == 0 && asked > 1000, "%d of %d", bad, asked);
        const float *v = scene.tree.positions;
        double on = winding_at(&scene, v[0], v[1], v[2]);
        CHECK(on > -0.1 && on < 1.1, "at a vertex %g", on);
        vec3 face = point_off(&scene, 77, 0.0);
        on = winding_at(&scene, face.x, face.y, face.z);
        CHECK(on > -0.1 && on < 1.1, "in a face %g", on);
        const double odd[] = { NAN, INFINITY, -INFINITY, 1e300, -1e30, 1e9 };
        for (size_t k = 0; k < 6; k++)
            for (int axis = 0; axis < 3; axis++) {
                double x[3] = { 0.0, 0.0, 0.0 };
                x[axis] = odd[k];
                CHECK(winding_at(&scene, x[0], x[1], x[2]) == 0.0, "%g on axis %d", odd[k], axis);
            }
    }
    scene_close(&scene);
}

static void sides_are_known_near_the_surface(void)
{
    check_sides(2000);
    check_sides(20000);
}

/* Small tetrahedra in a grid, all within a ball: seconds of processor time for each way to compile it. */
static double seconds_for_many(int across, uint32_t *buried)
{
    struct scene scene = { .vertices = NULL };
    add_ball(&scene, (vec3){ 0.5, 0.5, 0.5 }, 2.0, 0.0, 0);
    scene_room(&scene, (size_t)(4 * across * across * across),
               (size_t)(4 * across * across * across));
    for (int i = 0; i < across * across * across; i++) {
        const double at[3] = { (double)(i % across) / across,
                               (double)(i / across % across) / across,
                               (double)(i / across / across) / across };
        const double size = 0.6 / across;
        size_t base = scene.vertex_count;
        add_vertex(&scene, at[0], at[1], at[2]);
        add_vertex(&scene, at[0] + size, at[1], at[2]);
        add_vertex(&scene, at[0], at[1] + size, at[2]);
        add_vertex(&scene, at[0], at[1], at[2] + size);
        add_triangle(&scene, base, base + 2, base + 1, 0);
        add_triangle(&scene, base, base + 1, base + 3, 0);
        add_triangle(&scene, base, base + 3, base + 2, 0);
        add_triangle(&scene, base + 1, base + 2, base + 3, 0);
    }
    double least = HUGE_VAL;
    for (int pass = 0; pass < 3; pass++) {
        clock_t begin = clock();
        if (scene_open(&scene))
            *buried = scene.info.buried_components;
        least = fmin(least, (double)(clock() - begin) / CLOCKS_PER_SEC);
        dpt_compiled_free(&scene.compiled);
    }
    scene_close(&scene);
    return least;
}

static void many_parts_take_time_in_proportion(void)
{
    uint32_t few = 0, many = 0;
    double ratio = HUGE_VAL;
    for (int attempt = 0; attempt < 3 && ratio > 20.0; attempt++)
        ratio = seconds_for_many(20, &many) / seconds_for_many(10, &few);
    CHECK(few == 1000 && many == 8000, "%u and %u buried", few, many);
    CHECK(ratio <= 20.0, "8 times the parts take %.1f times as long", ratio);
    printf("    8 times the parts take %.1f times as long\n", ratio);
}

/*
 * A box in a box in a box, so many that their pairs are not all looked at: what is left is decided by winding numbers,
 * and told right all the same.
 */
static void endless_pairs_are_cut_short(void)
{
    enum { BOXES = 2000 };
    struct scene scene = { .vertices = NULL };
    for (int i = 0; i < BOXES; i++)
        add_shape(&scene, "box", 12, (vec3){ 0.0, 0.0, 0.0 }, 1.0 + 1e-3 * i, 0, 0);
    if (scene_open(&scene)) {
        CHECK(scene.info.solid_components == BOXES && scene.info.winding_components > BOXES / 10 &&
                  scene.info.winding_components < BOXES,
              "%u solid, %u by winding", scene.info.solid_components,
              scene.info.winding_components);
        const double depths[] = { 0.0599, 0.0900, 0.1799 };
        for (int i = 0; i < 3; i++) {
            const double inside[6] = { depths[i], 0.0, 0.0, depths[i], 1e-4, 0.0 };
            dpt_hit hit = DPT_HIT_INIT;
            dpt_query_segments(scene.mesh, NULL, inside, NULL, 1, &hit, NULL);
            CHECK(hit.gap < 0.0, "at %g: gap %g", depths[i], hit.gap);
        }
        const double outside[6] = { 0.19, 0.0, 0.0, 0.2, 0.0, 0.0 };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_query_segments(scene.mesh, NULL, outside, NULL, 1, &hit, NULL);
        CHECK(hit.gap > 0.0, "outside: gap %g", hit.gap);
    }
    scene_close(&scene);
}

struct expected {
    const char *path;
    uint32_t solid, cavities, winding, buried;
};

/* As looked at one by one; docs/algorithms/winding.md. */
static void public_meshes_are_what_they_seem(void)
{
    static const struct expected meshes[] = {
        { "organs/openhelp_liver.stl", 1, 0, 0, 0 },
        { "organs/liver_metres.stl", 1, 0, 1, 0 },
        { "organs/vessel_open_ends.stl", 1, 0, 1, 0 },
        { "organs/liver_intraop_patch.stl", 0, 0, 0, 0 },
        { "organs/skin_wound_oss.ply", 0, 0, 0, 0 },
        { "organs/tooth_chai3d.obj", 2, 0, 0, 1 },
        { "organs/liver_dirty_fine.stl", 2, 0, 1, 1 },
        { "organs/skull_and_teeth_sofa.obj", 34, 0, 34, 0 },
        { "sheets_tori/square_cloth_2594.obj", 0, 0, 0, 0 },
        { "sheets_tori/gauze.obj", 1, 0, 0, 0 },
        { "tools/dissection_electrode.stl", 2, 0, 2, 0 },
        { "hard/bunny_dirty.ply", 1, 0, 1, 0 },
        { "hard/sphere_with_hole_ascii.stl", 1, 0, 1, 0 },
        { "hard/cray_left.obj", 2, 1, 0, 0 },
        { "hard/soup.stl", 0, 0, 0, 0 },
    };
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        char path[1024];
        const struct expected *wanted = &meshes[i];
        struct scene scene = { .info = { .size = sizeof scene.info } };
        uint32_t chosen;
        snprintf(path, sizeof path, "%s/meshes/%s", getenv("DPT_DATA"), wanted->path);
        dpt_result result = dpt_compile_file(path, NULL, &scene.compiled, NULL);
        if (result == DPT_OK)
            result = dpt_mesh_convert(scene.compiled.bytes, scene.compiled.size, NULL);
        if (result == DPT_OK)
            result = dpt_mesh_open(scene.compiled.bytes, scene.compiled.size, &scene.mesh);
        CHECK(result == DPT_OK, "%s: %s", wanted->path, dpt_result_name(result));
        if (result != DPT_OK)
            continue;
        const dpt_mesh_info *info = &scene.info;
        dpt_mesh_get_info(scene.mesh, &scene.info);
        CHECK(info->solid_components == wanted->solid && info->cavities == wanted->cavities &&
                  info->winding_components == wanted->winding &&
                  info->buried_components == wanted->buried,
              "%s: %u solid, %u cavities, %u by winding, %u buried", wanted->path,
              info->solid_components, info->cavities, info->winding_components,
              info->buried_components);
        tree_of_mesh(scene.mesh, &scene.tree);
        kernel_get(DPT_KERNEL_AUTO, &scene.kernel, &chosen);
        if (info->winding_components)
            check_against_brute(strrchr(wanted->path, '/') + 1, &scene, 60);
        scene_close(&scene);
    }
}

int main(void)
{
    TEST(windings_agree_with_brute_force);
    TEST(series_keep_their_bound);
    TEST(balls_with_holes);
    TEST(torn_balls_are_solid);
    TEST(sheets_have_no_inside);
    TEST(closed_meshes_carry_no_moments);
    TEST(nested_balls_keep_their_voids);
    TEST(what_lies_in_a_void_is_in_the_open);
    TEST(sheets_within_solids_are_buried);
    TEST(cut_parts_need_a_winding_number);
    TEST(contact_is_found_within_faces);
    TEST(sides_are_known_near_the_surface);
    TEST(many_parts_take_time_in_proportion);
    TEST(endless_pairs_are_cut_short);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_are_what_they_seem);
    else
        SKIP("what public meshes seem", "DPT_DATA is not set");
    return check_report();
}
