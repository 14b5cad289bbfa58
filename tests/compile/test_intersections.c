/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Triangles that cut each other: their count against brute force in integers, where the search ends, and which side of
 * a closed part that cuts itself a point is on, against solid angles and brute distances.
 */
#include <math.h>

#include "dynpoint/query.h"
#include "lib/mesh_builder.h"
#include "oracle/depth.h"

/* Of coordinates below 2^24: products of three of them, and of two crossed with one, fit. */
__extension__ typedef __int128 wide;

struct whole {
    wide x, y, z;
};

static struct whole less(struct whole a, struct whole b)
{
    return (struct whole){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static struct whole crossed(struct whole a, struct whole b)
{
    return (struct whole){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static wide along_of(struct whole axis, struct whole x)
{
    return axis.x * x.x + axis.y * x.y + axis.z * x.z;
}

/* A plane across `axis` has the triangles on either side, and not both in it. */
static int is_parted(struct whole axis, const struct whole a[3], const struct whole b[3])
{
    wide low[2], high[2];
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            const wide at = along_of(axis, (i ? b : a)[k]);
            low[i] = k == 0 || at < low[i] ? at : low[i];
            high[i] = k == 0 || at > high[i] ? at : high[i];
        }
    return (high[0] <= low[1] && low[0] < high[1]) || (high[1] <= low[0] && low[1] < high[0]);
}

/*
 * The interiors of convex sets have no point in common if and only if some plane parts them (Rockafellar 1970, theorem
 * 11.3); of two triangles, one across one of these 17 axes. It shares nothing with the compiler's way.
 */
static int oracle_cuts(const struct whole a[3], const struct whole b[3])
{
    const struct whole normals[2] = { crossed(less(a[1], a[0]), less(a[2], a[0])),
                                      crossed(less(b[1], b[0]), less(b[2], b[0])) };
    for (int i = 0; i < 2; i++) {
        const struct whole n = normals[i];
        if ((n.x == 0 && n.y == 0 && n.z == 0) || is_parted(n, a, b))
            return 0;
        for (int k = 0; k < 3; k++)
            if (is_parted(crossed(n, less((i ? b : a)[(k + 1) % 3], (i ? b : a)[k])), a, b))
                return 0;
    }
    for (int k = 0; k < 9; k++)
        if (is_parted(crossed(less(a[(k / 3 + 1) % 3], a[k / 3]), less(b[(k + 1) % 3], b[k % 3])), a, b))
            return 0;
    return 1;
}

static int boxes_are_apart(const struct whole a[3], const struct whole b[3])
{
    static const struct whole axes[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    for (int i = 0; i < 3; i++) {
        wide low[2], high[2];
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 3; k++) {
                const wide at = along_of(axes[i], (j ? b : a)[k]);
                low[j] = k == 0 || at < low[j] ? at : low[j];
                high[j] = k == 0 || at > high[j] ? at : high[j];
            }
        if (high[0] < low[1] || high[1] < low[0])
            return 1;
    }
    return 0;
}

/* All pairs of an open scene whose coordinates are whole numbers of `step`; those that were dropped are none. */
static uint32_t brute_count(const struct mesh_builder *builder, double step)
{
    const uint32_t count = builder->info.source_triangles;
    struct whole *corners = malloc(3 * count * sizeof *corners);
    uint32_t kept = 0, pairs = 0;
    for (uint32_t t = 0; t < count; t++) {
        double at[9];
        if (dpt_mesh_get_triangle(builder->mesh, t, at) != DPT_OK)
            continue;
        for (int k = 0; k < 3; k++)
            corners[3 * kept + (uint32_t)k] =
                (struct whole){ (wide)(at[3 * k] / step), (wide)(at[3 * k + 1] / step), (wide)(at[3 * k + 2] / step) };
        kept++;
    }
    for (uint32_t a = 0; a < kept; a++)
        for (uint32_t b = a + 1; b < kept; b++)
            pairs +=
                !boxes_are_apart(corners + 3 * a, corners + 3 * b) && oracle_cuts(corners + 3 * a, corners + 3 * b);
    free(corners);
    return pairs;
}

static void expect_brute_count(struct mesh_builder *builder, double step, const char *what, int which)
{
    if (builder_compile(builder)) {
        const uint32_t wanted = brute_count(builder, step);
        const uint32_t first = builder->info.self_intersection[0], second = builder->info.self_intersection[1];
        CHECK(builder->info.self_intersections == wanted && !builder->info.self_intersections_more,
              "%s %d: %u pairs, not %u", what, which, builder->info.self_intersections, wanted);
        double a[9], b[9];
        if (wanted) {
            struct whole one[3], two[3];
            CHECK(dpt_mesh_get_triangle(builder->mesh, first, a) == DPT_OK &&
                      dpt_mesh_get_triangle(builder->mesh, second, b) == DPT_OK && first != second,
                  "%s %d: %u and %u", what, which, first, second);
            for (int k = 0; k < 3; k++) {
                one[k] =
                    (struct whole){ (wide)(a[3 * k] / step), (wide)(a[3 * k + 1] / step), (wide)(a[3 * k + 2] / step) };
                two[k] =
                    (struct whole){ (wide)(b[3 * k] / step), (wide)(b[3 * k + 1] / step), (wide)(b[3 * k + 2] / step) };
            }
            CHECK(oracle_cuts(one, two), "%s %d: %u and %u do not", what, which, first, second);
        } else {
            CHECK(first == DPT_NONE && second == DPT_NONE, "%s %d: %u and %u", what, which, first, second);
        }
    }
    builder_free(builder);
}

/*
 * Triangles between points of a small grid touch, lie in one plane and end in each other all the time. The grid lies
 * along the axes, or aslant, as a plane or in space; at the origin or far from it.
 */
static void soups_on_a_grid_agree_with_brute_force(void)
{
    uint64_t random = 61;
    for (int run = 0; run < (int)part_of(600); run++) {
        const uint64_t points = 2 + random_bits(&random) % 6, kind = (uint64_t)run % 3;
        const double step = run % 2 ? 0x1p-4 : 0x1p-90, far = run % 5 ? 0.0 : 0x1p21 * step;
        struct mesh_builder builder = { .vertices = NULL };
        builder_reserve(&builder, 150, 50);
        for (size_t v = 0; v < 150; v++) {
            double x[3];
            for (int k = 0; k < 3; k++)
                x[k] = (double)(random_bits(&random) % points);
            const double a = x[0], b = x[1], c = kind == 1 ? 0.0 : x[2];
            if (kind > 0) {
                x[0] = 30011.0 * a + 90001.0 * b + 7.0 * c;
                x[1] = 50021.0 * a - 20011.0 * b + 110017.0 * c;
                x[2] = 70001.0 * a + 10007.0 * b - 13.0 * c;
            }
            builder_add_vertex(&builder, far + step * x[0], step * x[1], step * x[2] - far);
        }
        for (size_t t = 0; t < 50; t++)
            builder_add_triangle(&builder, 3 * t, 3 * t + 1, 3 * t + 2, 0);
        expect_brute_count(&builder, step, "soup", run);
    }
}

/* Corners in planes and on edges of others that no coordinate shows: sums of its corners. */
static void nearly_touching_triangles_agree_with_brute_force(void)
{
    uint64_t random = 67;
    for (int run = 0; run < (int)part_of(300); run++) {
        struct mesh_builder builder = { .vertices = NULL };
        double v[90][3];
        builder_reserve(&builder, 90, 30);
        for (int i = 0; i < 90; i++) {
            const int a = i ? (int)(random_bits(&random) % (uint64_t)i) : 0,
                      b = i ? (int)(random_bits(&random) % (uint64_t)i) : 0,
                      c = i ? (int)(random_bits(&random) % (uint64_t)i) : 0;
            const int fresh = i < 6 || random_bits(&random) % 4 == 0, off = i % 7 == 0;
            for (int k = 0; k < 3; k++) {
                const double sum = fresh ? 0.0 : v[a][k] + v[b][k] - v[c][k];
                v[i][k] =
                    fresh || fabs(sum) > 0x1p22 ? floor(random_in(&random, -0x1p22, 0x1p22)) : sum + (off && k == 2);
            }
            builder_add_vertex(&builder, v[i][0], v[i][1], v[i][2]);
        }
        for (size_t t = 0; t < 30; t++)
            builder_add_triangle(&builder, random_bits(&random) % 90, random_bits(&random) % 90,
                                 random_bits(&random) % 90, 0);
        for (size_t i = 0; i < 3 * builder.vertex_count; i++)
            builder.vertices[i] *= 0x1p-4;
        expect_brute_count(&builder, 0x1p-4, "sums", run);
    }
}

/* Closed meshes whose vertices are moved at random, on a grid: from none to thousands of pairs, many at a vertex. */
static void crumpled_meshes_agree_with_brute_force(void)
{
    static const char *const names[] = { "sphere", "torus", "box", "cloth" };
    static const uint64_t counts[] = { 1000, 1500, 1200, 1250 };
    uint64_t random = 71;
    uint32_t least = UINT32_MAX, most = 0;
    for (int run = 0; run < 24; run++) {
        const double noise = 0.004 * (run / 4);
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_shape(&builder, names[run % 4], counts[run % 4], (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
        for (size_t i = 0; i < 3 * builder.vertex_count; i++)
            builder.vertices[i] = 0x1p-16 * floor(0x1p16 * (builder.vertices[i] + random_in(&random, -noise, noise)));
        if (builder_compile(&builder)) {
            least = builder.info.self_intersections < least ? builder.info.self_intersections : least;
            most = builder.info.self_intersections > most ? builder.info.self_intersections : most;
        }
        dpt_compiled_free(&builder.compiled);
        expect_brute_count(&builder, 0x1p-16, names[run % 4], run);
    }
    CHECK(least == 0 && most > 1000, "from %u to %u pairs", least, most);
}

/* Triangles round a vertex, flat or not, open or closed, up to twice round it: those past the first round overlap. */
static void fans_agree_with_brute_force(void)
{
    static const int degrees[] = { 5, 80, 100, 175, 180, 185, 265, 275, 355, 361, 370, 500, 715 };
    for (int run = 0; run < 60; run++) {
        const int closed = run >= 52, steps = 12 + run % 7, ring = closed ? steps : steps + 1;
        const double turn = closed ? 2.0 * (1 + run % 2) : degrees[run % 13] / 180.0;
        struct mesh_builder builder = { .vertices = NULL };
        builder_reserve(&builder, 21, 20);
        builder_add_vertex(&builder, 3.0, -2.0, 1.0);
        for (int i = 0; i < ring; i++) {
            const double at = 0.3 * run + turn * PI * i / steps, high = run % 3 * 0.1 * (i % 4);
            builder_add_vertex(&builder, 3.0 + cos(at), sin(at) - 2.0, 1.0 + high + run % 2 * 0.4 * cos(at));
        }
        for (size_t i = 1; i <= (size_t)steps; i++)
            builder_add_triangle(&builder, 0, i, i % (size_t)ring + 1, run % 5 == 0);
        for (size_t i = 0; i < 3 * builder.vertex_count; i++)
            builder.vertices[i] = 0x1p-12 * floor(0x1p12 * builder.vertices[i]);
        expect_brute_count(&builder, 0x1p-12, "fan", run);
    }
}

/* Balls that cut, touch in a point of both, and stand beside each other. */
static void parts_count_too(void)
{
    for (int run = 0; run < 6; run++) {
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_ball(&builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
        builder_add_ball(&builder, (vec3){ 0.4 * run, 0.0, 0.0 }, 1.0, 0.0, 0);
        for (size_t i = 0; i < 3 * builder.vertex_count; i++)
            builder.vertices[i] = 0x1p-16 * floor(0x1p16 * builder.vertices[i]);
        expect_brute_count(&builder, 0x1p-16, "balls", run);
    }
}

static void shapes_do_not_cut_themselves(void)
{
    for (size_t i = 0; i < shape_kind_count; i++)
        for (int large = 0; large < 2; large++) {
            struct mesh_builder builder = { .vertices = NULL };
            const uint64_t count = large ? 20 * 20 * 12 : shape_kinds[i].default_count ? 0 : shape_kinds[i].count_min;
            if (large && (shape_kinds[i].counts == SHAPE_TWO_SQUARES))
                continue;
            builder_add_shape(&builder, shape_kinds[i].name, count, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
            if (builder_compile(&builder))
                CHECK(builder.info.self_intersections == 0 && !builder.info.self_intersections_more,
                      "%s of %u triangles: %u%s", shape_kinds[i].name, builder.info.triangles,
                      builder.info.self_intersections, builder.info.self_intersections_more ? " or more" : "");
            builder_free(&builder);
        }
}

/* A closed tube along an eight whose strands lie so close that they overlap where they pass each other. */
static void add_eight(struct mesh_builder *builder)
{
    enum { LONG = 120, ROUND = 12 };
    builder_reserve(builder, LONG * ROUND, 2 * LONG * ROUND);
    for (int i = 0; i < LONG; i++) {
        const double t = 2.0 * PI * i / LONG;
        const vec3 at = { cos(t), 0.5 * sin(2.0 * t), 0.06 * sin(t) };
        const vec3 ahead = unit_of((vec3){ -sin(t), cos(2.0 * t), 0.06 * cos(t) });
        const vec3 side = unit_of(cross(ahead, (vec3){ 0.0, 0.0, 1.0 }));
        const vec3 up = cross(side, ahead);
        for (int k = 0; k < ROUND; k++) {
            const double turn = 2.0 * PI * k / ROUND;
            const vec3 x = along(along(at, 0.14 * cos(turn), side), 0.14 * sin(turn), up);
            builder_add_vertex(builder, x.x, x.y, x.z);
        }
    }
    for (size_t i = 0; i < LONG; i++)
        for (size_t k = 0; k < ROUND; k++) {
            const size_t a = ROUND * i + k, b = ROUND * i + (k + 1) % ROUND;
            const size_t c = (a + ROUND) % (LONG * ROUND), d = (b + ROUND) % (LONG * ROUND);
            builder_add_triangle(builder, a, b, c, 0);
            builder_add_triangle(builder, b, d, c, 0);
        }
}

/* Two balls that overlap, of which a tube between two of their triangles makes one part. */
static void add_joined_balls(struct mesh_builder *builder)
{
    builder_add_ball(builder, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0.0, 0);
    const size_t half = builder->triangle_count, one = half / 3, two = half + half / 3;
    uint32_t from[3], to[3];
    builder_add_ball(builder, (vec3){ 1.1, 0.2, 0.1 }, 0.8, 0.0, 0);
    memcpy(from, builder->corners + 3 * one, sizeof from);
    memcpy(to, builder->corners + 3 * two, sizeof to);
    builder_reserve(builder, 0, 6);
    for (int k = 0; k < 3; k++) {
        /* The far ring is run through the other way round. */
        const uint32_t a = from[k], b = from[(k + 1) % 3];
        const uint32_t c = to[(3 - k) % 3], d = to[(5 - k) % 3];
        builder_add_triangle(builder, a, b, c, 0);
        builder_add_triangle(builder, b, d, c, 0);
    }
    const size_t last = builder->triangle_count - 1;
    memcpy(builder->corners + 3 * two, builder->corners + 3 * last, 3 * sizeof *builder->corners);
    memcpy(builder->corners + 3 * one, builder->corners + 3 * (last - 1), 3 * sizeof *builder->corners);
    builder->triangle_count -= 2;
}

/* How often the scene's triangles go round x, by definition. */
static long double turns_at(const struct mesh_builder *builder, const double *corners, vec3 x)
{
    long double sum = 0.0L;
    for (uint32_t t = 0; t < builder->info.triangles; t++) {
        long double v[3][3], far[3], along[3];
        for (int k = 0; k < 9; k++)
            v[k / 3][k % 3] = (long double)corners[9 * (size_t)t + (size_t)k] - (k % 3 == 0   ? x.x
                                                                                 : k % 3 == 1 ? x.y
                                                                                              : x.z);
        for (int i = 0; i < 3; i++) {
            const long double *a = v[i], *b = v[(i + 1) % 3];
            far[i] = sqrtl(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
            along[i] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        }
        const long double volume = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
                                   v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
                                   v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        sum += atan2l(volume, far[0] * far[1] * far[2] + along[0] * far[2] + along[1] * far[0] + along[2] * far[1]);
    }
    return sum / (2.0L * 3.14159265358979323846L);
}

/* What a scene is judged by: its corners, and brute distances. */
struct judge {
    const struct mesh_builder *scene;
    double *corners;
    float *points;
    oracle_mesh *mesh;
};

static struct judge judge_of(const struct mesh_builder *builder)
{
    const uint32_t count = builder->info.triangles;
    struct judge judge = { .scene = builder };
    float *points = judge.points = malloc(9 * (size_t)count * sizeof *points);
    judge.corners = malloc(9 * (size_t)count * sizeof *judge.corners);
    uint32_t *numbers = malloc(3 * (size_t)count * sizeof *numbers);
    for (uint32_t t = 0; t < count; t++)
        CHECK(dpt_mesh_get_triangle(builder->mesh, t, judge.corners + 9 * (size_t)t) == DPT_OK, "%u", t);
    for (size_t i = 0; i < 9 * (size_t)count; i++)
        points[i] = (float)judge.corners[i];
    for (uint32_t i = 0; i < 3 * count; i++)
        numbers[i] = i;
    judge.mesh = oracle_brute_open(points, 3 * count, numbers, count);
    free(numbers);
    return judge;
}

static void judge_free(struct judge *judge)
{
    oracle_brute_close(judge->mesh);
    free(judge->points);
    free(judge->corners);
}

static double signed_distance(const struct judge *judge, vec3 x)
{
    const double at[6] = { x.x, x.y, x.z, x.x, x.y, x.z };
    const double distance = oracle_brute(judge->mesh, at, NULL);
    return turns_at(judge->scene, judge->corners, x) > 0.5L ? -distance : distance;
}

/* Points anywhere in the box, and a little off the middle of any triangle. */
static void expect_signs(const struct judge *judge, const char *what)
{
    const struct mesh_builder *builder = judge->scene;
    const double *low = builder->info.box_min, *high = builder->info.box_max;
    const double diagonal = length(sub(vec3_of(high), vec3_of(low)));
    uint64_t random = 73;
    uint32_t wrong = 0, inside = 0, judged = 0;
    double worst = 0.0;
    for (int i = 0; i < (int)part_of(1500); i++) {
        const uint32_t place = (uint32_t)(random_bits(&random) % builder->info.triangles);
        const vec3 x =
            i % 2 ? point_in_box(builder, &random) : point_off(builder, place, random_in(&random, -0.02, 0.02));
        const double wanted = signed_distance(judge, x);
        const double ends[6] = { x.x, x.y, x.z, x.x, x.y, x.z };
        dpt_hit hit = DPT_HIT_INIT;
        if (fabs(wanted) < 1e-6 * diagonal)
            continue;
        dpt_query_segments(builder->mesh, NULL, ends, NULL, 1, &hit, NULL);
        judged++;
        inside += wanted < 0.0;
        wrong += (hit.gap < 0.0) != (wanted < 0.0);
        worst = max_of(worst, fabs(hit.gap - wanted));
    }
    CHECK(wrong == 0, "%s: %u of %u signs are wrong", what, wrong, judged);
    CHECK(worst <= 1e-12 * diagonal, "%s: off by %g of the diagonal", what, worst / diagonal);
    CHECK(inside > part_of(300) && judged > inside + part_of(300), "%s: %u of %u inside", what, inside, judged);
}

/* The depth of segments, which cross outer and inner sheets. */
static void expect_depths(const struct judge *judge, const char *what)
{
    const struct mesh_builder *builder = judge->scene;
    const double *low = builder->info.box_min, *high = builder->info.box_max;
    const double diagonal = length(sub(vec3_of(high), vec3_of(low))), tolerance = 1e-5 * diagonal;
    const struct oracle_solid solid = { judge->mesh, judge->points, builder->info.triangles,
                                        max_of(extent_of(vec3_of(low)), extent_of(vec3_of(high))) };
    uint64_t random = 79;
    int deep = 0;
    for (int i = 0; i < (int)part_of(100); i++) {
        const vec3 a = point_in_box(builder, &random), b = point_in_box(builder, &random);
        const double ends[6] = { a.x, a.y, a.z, b.x, b.y, b.z };
        dpt_hit hit = DPT_HIT_INIT;
        dpt_query_segments(builder->mesh, NULL, ends, NULL, 1, &hit, NULL);
        const struct oracle_least least = oracle_least(&solid, ends, 0.1 * tolerance);
        const double depth = max_of(0.0, -hit.gap);
        CHECK(depth >= max_of(0.0, -least.high) - tolerance && depth <= max_of(0.0, -least.low) + tolerance,
              "%s %d: %g deep, not %g to %g", what, i, depth, -least.high, -least.low);
        deep += least.high < -100.0 * tolerance;
    }
    CHECK(deep > (int)part_of(30), "%s: %d segments inside", what, deep);
}

static void closed_parts_that_cut_themselves_have_an_inside(void)
{
    for (int i = 0; i < 2; i++) {
        const char *what = i ? "balls" : "eight";
        struct mesh_builder builder = { .vertices = NULL };
        (i ? add_joined_balls : add_eight)(&builder);
        if (builder_compile(&builder)) {
            struct judge judge = judge_of(&builder);
            CHECK(builder.info.components == 1 && builder.info.closed_components == 1 &&
                      builder.info.winding_components == 1 && builder.info.self_intersections > 50,
                  "%s: %u parts, %u closed, %u by winding number, %u pairs", what, builder.info.components,
                  builder.info.closed_components, builder.info.winding_components, builder.info.self_intersections);
            expect_signs(&judge, what);
            expect_depths(&judge, what);
            judge_free(&judge);
        }
        builder_free(&builder);
    }
}

/* A ball whose vertices lie at any distance from the middle: its triangles reach across it and cut nothing. */
static void add_urchin(struct mesh_builder *builder, uint64_t count, uint64_t *random)
{
    const size_t first = builder->vertex_count;
    builder_add_shape(builder, "sphere", count, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (size_t v = first; v < builder->vertex_count; v++) {
        const double size = random_in(random, 0.01, 1.0);
        for (int k = 0; k < 3; k++)
            builder->vertices[3 * v + (size_t)k] *= size;
    }
}

/* So many pairs of boxes meet that the search stops: it says so, and the inside is right all the same. */
static void a_search_that_stops_says_so(void)
{
    uint64_t random = 83;
    for (int large = 0; large < 2; large++) {
        struct mesh_builder builder = { .vertices = NULL };
        add_urchin(&builder, large ? 40000 : 2000, &random);
        if (builder_compile(&builder)) {
            CHECK(builder.info.self_intersections == 0 && builder.info.closed_components == 1 &&
                      builder.info.self_intersections_more == (uint32_t)large &&
                      builder.info.winding_components == (uint32_t)large,
                  "%d: %u pairs, more %u, %u by winding number", large, builder.info.self_intersections,
                  builder.info.self_intersections_more, builder.info.winding_components);
            CHECK(builder.info.self_intersection[0] == DPT_NONE, "an example of none");
            for (int i = 0; i < (int)part_of(200); i++) {
                const vec3 x = point_in_box(&builder, &random);
                const double ends[6] = { x.x, x.y, x.z, x.x, x.y, x.z };
                dpt_hit hit = DPT_HIT_INIT;
                dpt_query_segments(builder.mesh, NULL, ends, NULL, 1, &hit, NULL);
                CHECK((hit.gap < 0.0) == (brute_winding_at(&builder, x) > 0.5) || hit.distance < 1e-7, "%d: gap %g",
                      large, hit.gap);
            }
        }
        builder_free(&builder);
    }
}

static void pairs_are_counted_up_to_ten_thousand(void)
{
    uint64_t random = 89;
    struct mesh_builder builder = { .vertices = NULL };
    builder_add_shape(&builder, "torus", 40000, (vec3){ 0.0, 0.0, 0.0 }, 1.0, 0, 0);
    for (size_t i = 0; i < 3 * builder.vertex_count; i++)
        builder.vertices[i] += random_in(&random, -3e-3, 3e-3);
    builder_add_ball(&builder, (vec3){ 1.0, 0.0, 0.0 }, 0.1, 0.0, 0);
    if (builder_compile(&builder))
        CHECK(builder.info.self_intersections == 10000 && builder.info.self_intersections_more == 1 &&
                  builder.info.winding_components == 1,
              "%u pairs, more %u, %u by winding number", builder.info.self_intersections,
              builder.info.self_intersections_more, builder.info.winding_components);
    dpt_compiled first = builder.compiled;
    for (uint32_t threads = 2; threads < 12; threads += 3) {
        const dpt_compile_def def = { .size = sizeof def, .threads = threads };
        dpt_compiled again;
        CHECK(dpt_compile_arrays(builder.vertices, builder.vertex_count, builder.corners, builder.triangle_count, &def,
                                 &again, NULL) == DPT_OK,
              "%u threads", threads);
        dpt_mesh_convert(again.bytes, again.size, NULL);
        CHECK(again.size == first.size && !memcmp(again.bytes, first.bytes, first.size), "other bytes of %u threads",
              threads);
        dpt_compiled_free(&again);
    }
    builder_free(&builder);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(soups_on_a_grid_agree_with_brute_force);
    TEST(nearly_touching_triangles_agree_with_brute_force);
    TEST(crumpled_meshes_agree_with_brute_force);
    TEST(fans_agree_with_brute_force);
    TEST(parts_count_too);
    TEST(shapes_do_not_cut_themselves);
    TEST(closed_parts_that_cut_themselves_have_an_inside);
    TEST(a_search_that_stops_says_so);
    TEST(pairs_are_counted_up_to_ten_thousand);
    return check_report();
}
