/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Polygons of more than three corners: concave ones are cut by their ears. The oracle knows nothing of ears: a point of
 * the plane lies in as many triangles as the polygon winds about it, and the areas add up.
 *
 *     test_polygons [PERCENT]      of the random polygons; 100
 *
 * With DPT_DATA in the environment the files of reports/polygons are read as well, from there.
 */
#include <math.h>

#include "base/vec3.h"
#include "compile/ear_cut.h"
#include "compile/heard.h"
#include "compile/reading.h"

/* A polygon in its own plane. */
struct loop {
    double (*at)[2];
    uint32_t n, capacity;
};

static void loop_add(struct loop *loop, double x, double y)
{
    if (loop->n == loop->capacity) {
        loop->capacity = 2 * loop->capacity + 64;
        loop->at = realloc(loop->at, loop->capacity * sizeof *loop->at);
    }
    loop->at[loop->n][0] = x;
    loop->at[loop->n++][1] = y;
}

static void loop_free(struct loop *loop)
{
    free(loop->at);
    memset(loop, 0, sizeof *loop);
}

static void loop_reverse(struct loop *loop)
{
    for (uint32_t i = 0; i < loop->n / 2; i++)
        for (int k = 0; k < 2; k++) {
            const double kept = loop->at[i][k];
            loop->at[i][k] = loop->at[loop->n - 1 - i][k];
            loop->at[loop->n - 1 - i][k] = kept;
        }
}

/* ---- shapes ---- */

static uint64_t seed = 20;

static void add_star(struct loop *loop, uint32_t n, double low, double high, double x, double y, int is_backward)
{
    for (uint32_t i = 0; i < n; i++) {
        const double angle = 2.0 * M_PI * (double)(is_backward ? n - i : i) / (double)n;
        const double radius = i == 0 ? high : random_in(&seed, low, high);
        loop_add(loop, x + radius * cos(angle), y + radius * sin(angle));
    }
}

static void make_star(struct loop *loop, uint32_t n)
{
    add_star(loop, n, 0.1, 1.0, 0.0, 0.0, 0);
}

/* A star with a hole, joined to it by a bridge. */
static void make_keyhole(struct loop *loop, uint32_t n)
{
    add_star(loop, n, 0.6, 1.0, 0.0, 0.0, 0);
    loop_add(loop, 1.0, 0.0);
    add_star(loop, n, 0.2, 0.5, 0.0, 0.0, 1);
    loop_add(loop, 0.5, 0.0);
}

/* Holes in a row, each joined to the next one. */
static void make_sieve(struct loop *loop, uint32_t n)
{
    const uint32_t holes = 2 + n / 40, half = 4;
    loop_add(loop, -1.0, 0.0);
    loop_add(loop, -1.0, -1.0);
    loop_add(loop, 2.0 * holes, -1.0);
    loop_add(loop, 2.0 * holes, 1.0);
    loop_add(loop, -1.0, 1.0);
    loop_add(loop, -1.0, 0.0);
    for (uint32_t h = 0; h < holes; h++)
        for (uint32_t i = 0; i <= half; i++)
            loop_add(loop, 2.0 * h - 0.5 * cos(M_PI * i / half), 0.5 * sin(M_PI * i / half));
    for (uint32_t h = holes; h-- > 0;)
        for (uint32_t i = h + 1 == holes ? 1 : 0; i <= half; i++)
            loop_add(loop, 2.0 * h + 0.5 * cos(M_PI * i / half), i == half ? 0.0 : -0.5 * sin(M_PI * i / half));
}

static void make_comb(struct loop *loop, uint32_t n)
{
    for (uint32_t i = 0; i + 2 < n; i++)
        loop_add(loop, 1.0 - (double)i / n, i % 2 ? 0.1 : random_in(&seed, 0.5, 1.0));
    loop_add(loop, 0.0, 0.0);
    loop_add(loop, 1.0, 0.0);
}

static void make_spiral(struct loop *loop, uint32_t n)
{
    const double turns = fmin(4.0, n / 24.0);
    for (uint32_t i = 0; i < n / 2; i++) {
        const double t = (double)i / (double)(n / 2);
        loop_add(loop, (0.1 + t) * cos(2.0 * M_PI * turns * t), (0.1 + t) * sin(2.0 * M_PI * turns * t));
    }
    for (uint32_t i = n / 2; i-- > 0;) {
        const double t = (double)i / (double)(n / 2);
        loop_add(loop, (0.02 + t) * cos(2.0 * M_PI * turns * t), (0.02 + t) * sin(2.0 * M_PI * turns * t));
    }
}

/* Corners in line, corners twice, and a corner that is touched from the other side. */
static void make_awkward(struct loop *loop, uint32_t n)
{
    const uint32_t side = n / 8 + 1;
    for (uint32_t i = 0; i < side; i++)
        loop_add(loop, (double)i / side, 0.0);
    loop_add(loop, 1.0, 0.0);
    loop_add(loop, 1.0, 0.0);
    for (uint32_t i = 0; i < side; i++)
        loop_add(loop, 1.0 - 0.5 * i / side, 0.5);
    loop_add(loop, 0.5, 0.0); /* it touches the first side here */
    for (uint32_t i = 0; i < side; i++)
        loop_add(loop, 0.25, 1.0 - 0.5 * i / side);
    loop_add(loop, 0.0, 0.25);
}

enum { GRID = 16 };

/* Fill what the outside does not reach. */
static void fill_holes(uint8_t cell[GRID][GRID])
{
    uint8_t outside[GRID][GRID] = { { 1 } };
    for (int pass = 0; pass < GRID * GRID; pass++)
        for (int i = 0; i < GRID; i++)
            for (int k = 0; k < GRID; k++)
                if (!cell[i][k] && ((i > 0 && outside[i - 1][k]) || (k > 0 && outside[i][k - 1]) ||
                                    (i + 1 < GRID && outside[i + 1][k]) || (k + 1 < GRID && outside[i][k + 1])))
                    outside[i][k] = 1;
    for (int i = 0; i < GRID; i++)
        for (int k = 0; k < GRID; k++)
            cell[i][k] = !outside[i][k];
}

/* Round squares that grew together: corners in line, and corners where the outline meets itself. */
static void make_squares(struct loop *loop, uint32_t n)
{
    static const int dx[] = { 1, 0, -1, 0 }, dy[] = { 0, 1, 0, -1 };
    uint8_t cell[GRID][GRID] = { { 0 } };
    cell[GRID / 2][GRID / 2] = 1;
    for (uint32_t count = 0, tries = 0; count < n && tries < 100000; tries++) {
        const int i = 1 + (int)(random_bits(&seed) % (GRID - 2)), k = 1 + (int)(random_bits(&seed) % (GRID - 2));
        if (!cell[i][k] && (cell[i - 1][k] || cell[i + 1][k] || cell[i][k - 1] || cell[i][k + 1])) {
            cell[i][k] = 1;
            count++;
        }
    }
    fill_holes(cell);
    int x = 0, y = 0, way = 0;
    while (!cell[y][x])
        if (++x == GRID) {
            x = 0;
            y++;
        }
    const int x0 = x, y0 = y;
    do { /* the square on the left of the edge is one of them */
        loop_add(loop, x / 8.0 - 1.0, y / 8.0 - 1.0);
        x += dx[way];
        y += dy[way];
        const int ahead_left = way == 0   ? cell[y][x]
                               : way == 1 ? cell[y][x - 1]
                               : way == 2 ? cell[y - 1][x - 1]
                                          : cell[y - 1][x];
        const int ahead_right = way == 0   ? cell[y - 1][x]
                                : way == 1 ? cell[y][x]
                                : way == 2 ? cell[y][x - 1]
                                           : cell[y - 1][x - 1];
        way = !ahead_left ? (way + 1) % 4 : ahead_right ? (way + 3) % 4 : way;
    } while (x != x0 || y != y0);
}

/* ---- the oracle ---- */

/* A polygon placed in space, as floats, and the plane to look at it in. */
struct subject {
    reading r;
    uint32_t n;
    vec3 origin, x, y;
};

static void place(struct subject *s, const struct loop *loop, int is_flat, double size)
{
    const vec3 normal = unit_of((vec3){ random_in(&seed, -1, 1), random_in(&seed, -1, 1), random_in(&seed, -1, 1) });
    vec3 across[2] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } };
    if (!is_flat)
        unit_across(normal, across);
    s->n = loop->n;
    s->origin = is_flat ? (vec3){ 0.0, 0.0, 0.0 } : scaled(normal, 0.3 * size);
    s->x = across[0];
    s->y = across[1];
    begin_reading(&s->r, NULL);
    uint32_t *corners = malloc(loop->n * sizeof *corners);
    for (uint32_t i = 0; i < loop->n; i++) {
        const vec3 at = along(along(s->origin, size * loop->at[i][0], s->x), size * loop->at[i][1], s->y);
        soup_add_vertex(&s->r.soup, at.x, at.y, at.z, (source_location){ i + 1, 0 });
        corners[i] = i;
    }
    s->r.result = soup_add_polygon(&s->r.soup, corners, loop->n, (source_location){ 77, 0 });
    if (s->r.result == DPT_OK)
        s->r.result = soup_cut_polygons(&s->r.soup);
    free(corners);
}

static void flat_corner(const struct subject *s, uint32_t corner, double flat[2])
{
    const vec3 at = sub(vec3_of_float(s->r.soup.positions + 3 * (size_t)corner), s->origin);
    flat[0] = dot(at, s->x);
    flat[1] = dot(at, s->y);
}

static double area_of(const double p[2], const double q[2], const double r[2])
{
    return 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
}

/* How far x is from the segment p q. */
static double distance_of(const double p[2], const double q[2], const double x[2])
{
    const vec3 a = { p[0], p[1], 0.0 }, u = { q[0] - p[0], q[1] - p[1], 0.0 }, at = { x[0], x[1], 0.0 };
    return length(sub(at, along(a, nearest_on(a, u, at), u)));
}

/* How often the polygon winds about x; *distance is how far x is from it. */
static int winding_of(const struct subject *s, const double x[2], double *distance)
{
    int winding = 0;
    double p[2], q[2];
    flat_corner(s, s->n - 1, p);
    *distance = HUGE_VAL;
    for (uint32_t i = 0; i < s->n; i++, memcpy(p, q, sizeof p)) {
        flat_corner(s, i, q);
        *distance = fmin(*distance, distance_of(p, q, x));
        if ((p[1] <= x[1]) != (q[1] <= x[1]) && (area_of(p, q, x) > 0.0) == (q[1] > p[1]))
            winding += q[1] > p[1] ? 1 : -1;
    }
    return winding;
}

/* In how many triangles x is; *distance becomes that to their edges where it is less. */
static int cover_of(const struct subject *s, const double x[2], double *distance)
{
    int cover = 0;
    for (size_t t = 0; t < s->r.soup.triangle_count; t++) {
        double c[3][2];
        int inside = 0;
        for (int k = 0; k < 3; k++)
            flat_corner(s, s->r.soup.corners[3 * t + (size_t)k], c[k]);
        for (int k = 0; k < 3; k++) {
            *distance = fmin(*distance, distance_of(c[k], c[(k + 1) % 3], x));
            inside += area_of(c[k], c[(k + 1) % 3], x) > 0.0 ? 1 : -1;
        }
        cover += inside == 3 ? 1 : inside == -3 ? -1 : 0;
    }
    return cover;
}

/* Of random points, how many lie in another number of triangles than the polygon winds about them. */
static uint32_t wrong_points(const struct subject *s, double reach, double size, uint32_t points)
{
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < points; i++) {
        const double x[2] = { random_in(&seed, -reach * size, reach * size),
                              random_in(&seed, -reach * size, reach * size) };
        double distance;
        const int winding = winding_of(s, x, &distance), cover = cover_of(s, x, &distance);
        if (distance > 1e-6 * reach * size && winding != cover)
            wrong++;
    }
    return wrong;
}

static double polygon_area(const struct subject *s)
{
    double sum = 0.0, o[2], p[2], q[2];
    flat_corner(s, 0, o);
    memcpy(p, o, sizeof p);
    for (uint32_t i = 1; i < s->n; i++, memcpy(p, q, sizeof p)) {
        flat_corner(s, i, q);
        sum += area_of(o, p, q);
    }
    return sum;
}

/* The triangles' areas, each without its sign. */
static double triangle_area(const struct subject *s)
{
    double sum = 0.0;
    for (size_t t = 0; t < s->r.soup.triangle_count; t++) {
        double c[3][2];
        for (int k = 0; k < 3; k++)
            flat_corner(s, s->r.soup.corners[3 * t + (size_t)k], c[k]);
        sum += fabs(area_of(c[0], c[1], c[2]));
    }
    return sum;
}

typedef void make_loop(struct loop *loop, uint32_t n);

static const struct {
    const char *name;
    make_loop *make;
    double reach; /* of the shape, from the origin */
} shapes[] = { { "star", make_star, 1.1 },      { "keyhole", make_keyhole, 1.1 }, { "sieve", make_sieve, 6.0 },
               { "comb", make_comb, 1.1 },      { "spiral", make_spiral, 1.2 },   { "awkward", make_awkward, 1.1 },
               { "squares", make_squares, 1.1 } };

enum { SHAPES = sizeof shapes / sizeof *shapes };

static void check_shape(size_t i, uint32_t n, int is_flat, int is_backward, double size)
{
    struct loop loop = { .at = NULL };
    struct subject s;
    shapes[i].make(&loop, n);
    if (is_backward)
        loop_reverse(&loop);
    place(&s, &loop, is_flat, size);
    const double area = polygon_area(&s), cut = triangle_area(&s);
    const uint32_t wrong = wrong_points(&s, shapes[i].reach, size, 60);
    CHECK(s.r.result == DPT_OK && s.r.soup.triangle_count == loop.n - 2, "%s of %u: %zu triangles", shapes[i].name,
          loop.n, s.r.soup.triangle_count);
    if (n > 16 && shapes[i].make != make_squares) /* a small one may be convex */
        CHECK(s.r.soup.concave_polygons == 1, "%s of %u: not concave", shapes[i].name, loop.n);
    CHECK((area > 0.0) != is_backward && fabs(cut - fabs(area)) < 1e-5 * cut, "%s of %u: %g of %g", shapes[i].name,
          loop.n, cut, area);
    CHECK(wrong == 0, "%s of %u: %u points wrong", shapes[i].name, loop.n, wrong);
    soup_free(&s.r.soup);
    loop_free(&loop);
}

static void each_point_is_covered_as_the_polygon_winds(void)
{
    const uint32_t sizes[] = { 9, 16, 33, 120 };
    for (uint64_t round = 0; round < part_of(25); round++)
        for (size_t i = 0; i < SHAPES; i++)
            for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
                check_shape(i, sizes[k], round % 3 == 0, round % 2 ? 1 : 0, round % 5 == 0 ? 1e-3 : 0.2);
}

/* ---- what stays as it was ---- */

static int is_fan(const soup *source, uint32_t n)
{
    int same = source->triangle_count == n - 2;
    for (uint32_t t = 0; same && t < n - 2; t++)
        same =
            source->corners[3 * t] == 0 && source->corners[3 * t + 1] == t + 1 && source->corners[3 * t + 2] == t + 2;
    return same;
}

/* Read a text and cut. */
static void cut_text(reading *r, uint32_t format, const char *text, struct heard *heard)
{
    dpt_compile_def def;
    dpt_compile_def_init(&def);
    def.note = hear;
    def.note_user = heard;
    memset(heard, 0, sizeof *heard);
    read_bytes(r, format, text, strlen(text), &def);
    if (r->result == DPT_OK)
        r->result = soup_cut_polygons(&r->soup);
    CHECK(r->result == DPT_OK, "%s", r->diag.text);
}

static void convex_polygons_stay_fans(void)
{
    struct loop loop = { .at = NULL };
    for (uint32_t n = 4; n < 60; n++) {
        struct subject s;
        loop.n = 0;
        add_star(&loop, n, 1.0, 1.0, 0.0, 0.0, 0);
        place(&s, &loop, 0, 0.2);
        CHECK(is_fan(&s.r.soup, n) && s.r.soup.concave_polygons == 0, "%u corners", n);
        soup_free(&s.r.soup);
    }
    loop_free(&loop);
}

/* An arrow seen from its notch is star-shaped about its first corner: the fan is right. */
static void a_fan_that_is_right_stays(void)
{
    reading r;
    struct heard heard;
    cut_text(&r, DPT_FORMAT_OBJ, "v 2 1 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nv 4 4 0\nf 1 2 3 4 5\n", &heard);
    CHECK(is_fan(&r.soup, 5) && r.soup.concave_polygons == 1 && heard.count == 0, "%u", r.soup.concave_polygons);
    soup_free(&r.soup);
}

static void what_cannot_be_cut_is_noted(void)
{
    static const struct {
        const char *what, *text, *note;
        uint64_t line;
        uint32_t n;
    } cases[] = {
        { "a bow tie", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\n", "of 4 corners crosses itself", 5, 4 },
        { "an even bow tie", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", "crosses itself", 5, 4 },
        { "a star of five lines", "v 1 0 0\nv -.81 .59 0\nv .31 -.95 0\nv .31 .95 0\nv -.81 -.59 0\n\nf 1 2 3 4 5\n",
          "crosses itself", 7, 5 },
        { "a cross of two loops", "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 1 -1 0\nv 0 -1 0\nf 1 2 3 4 5\n", "crosses itself", 6,
          5 },
        { "not planar", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 2\nv 0 4 0\nf 1 2 3 4 5\n", "is not planar", 6, 5 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        reading r;
        struct heard heard;
        cut_text(&r, DPT_FORMAT_OBJ, cases[i].text, &heard);
        CHECK(is_fan(&r.soup, cases[i].n), "%s: no fan", cases[i].what);
        CHECK(heard.count == 1 && heard.last.code == DPT_OK && heard.last.line == cases[i].line &&
                  strstr(heard.last.text, cases[i].note),
              "%s: %d, line %d: %s", cases[i].what, heard.count, (int)heard.last.line, heard.last.text);
        soup_free(&r.soup);
    }
    reading r;
    struct heard heard;
    cut_text(&r, DPT_FORMAT_OBJ,
             "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 4 3 2 1\nf 1 2 3\nf 1 2 3 4\nf 2 3 4 1\nf 1 1 1 1\n", &heard);
    CHECK(heard.count == 1 && heard.last.line == 5 && strstr(heard.last.text, "and 2 more like it"), "%d: %s",
          heard.count, heard.last.text);
    soup_free(&r.soup);
}

/* ---- files ---- */

static void every_format_is_cut(void)
{
    static const struct {
        uint32_t format;
        const char *text;
    } files[] = {
        { DPT_FORMAT_OBJ, "f 1 2 3 4 5 6\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n" },
        { DPT_FORMAT_OFF, "OFF\n6 1 0\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n6 0 1 2 3 4 5\n" },
        { DPT_FORMAT_PLY,
          "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 6\nproperty "
          "float x\nproperty float y\nproperty float z\nend_header\n6 0 1 2 3 4 5\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 "
          "0\n0 2 0\n" },
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct subject s = { .n = 6, .x = { 1.0, 0.0, 0.0 }, .y = { 0.0, 1.0, 0.0 } };
        struct heard heard;
        /* An OBJ may name vertices that follow. */
        cut_text(&s.r, files[i].format, files[i].text, &heard);
        CHECK(s.r.soup.triangle_count == 4 && fabs(triangle_area(&s) - 3.0) < 1e-6 && heard.count == 0,
              "format %u: %zu triangles of %g", files[i].format, s.r.soup.triangle_count, triangle_area(&s));
        CHECK(wrong_points(&s, 2.1, 1.0, 500) == 0, "format %u", files[i].format);
        soup_free(&s.r.soup);
    }
}

/* The report's own file: an L of 0.2 m, 0.05 m thick, of two concave faces. Its area is known. */
static void a_reported_file(void)
{
    char path[1024];
    dpt_compiled out;
    dpt_diag diag = { .size = sizeof diag };
    const dpt_mesh *mesh;
    dpt_mesh_info info = { .size = sizeof info };
    double area = 0.0, corners[9];
    snprintf(path, sizeof path, "%s/reports/polygons/concave_L.obj", getenv("DPT_DATA"));
    CHECK(dpt_compile_file(path, NULL, &out, &diag) == DPT_OK && dpt_mesh_open(out.bytes, out.size, &mesh) == DPT_OK,
          "%s", diag.text);
    if (diag.code)
        return;
    dpt_mesh_get_info(mesh, &info);
    for (uint32_t t = 0; t < info.source_triangles; t++) {
        dpt_mesh_get_triangle(mesh, t, corners);
        const vec3 a = vec3_of(corners);
        area += 0.5 * length(cross(sub(vec3_of(corners + 3), a), sub(vec3_of(corners + 6), a)));
    }
    CHECK(info.source_triangles == 20 && info.concave_polygons == 2 && info.self_intersections == 0 &&
              info.closed_components == 1,
          "%u triangles, %u pairs cut each other", info.source_triangles, info.self_intersections);
    CHECK(fabs(area - (2.0 * 0.03 + 0.8 * 0.05)) < 1e-7, "%g m2", area);
    dpt_compiled_free(&out);
}

/* ---- cost ---- */

#define ROUNDING (4.0 * 0x1p-24 * 10.0) /* of coordinates up to 10 */

/* Units of work a corner, of a shape that is turned so that no box fits it. */
static double work_of(size_t shape, uint32_t n)
{
    struct loop loop = { .at = NULL };
    struct ear_cutter cutter = { .work = 0 };
    shapes[shape].make(&loop, n);
    for (uint32_t i = 0; i < loop.n; i++) {
        const double x = loop.at[i][0], y = loop.at[i][1];
        loop.at[i][0] = (double)(float)(0.8 * x - 0.6 * y);
        loop.at[i][1] = (double)(float)(0.6 * x + 0.8 * y);
    }
    uint32_t *triangles = malloc(3 * sizeof *triangles * loop.n);
    const enum ear_result result = ear_cut(&cutter, (const double(*)[2])loop.at, loop.n, ROUNDING, triangles);
    const double work = (double)cutter.work / loop.n;
    CHECK(result == EAR_DONE, "%s of %u: %d", shapes[shape].name, n, (int)result);
    free(triangles);
    ear_cutter_free(&cutter);
    loop_free(&loop);
    return work;
}

static void a_large_polygon_takes_bounded_work(void)
{
    for (size_t i = 0; i < SHAPES && shapes[i].make != make_squares; i++) {
        const uint32_t n = (uint32_t)part_of(100000);
        const double work = work_of(i, n);
        printf("    %s of %u: %.0f units a corner\n", shapes[i].name, n, work);
        CHECK(work < 1000.0, "%s: %.0f units a corner", shapes[i].name, work);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(each_point_is_covered_as_the_polygon_winds);
    TEST(convex_polygons_stay_fans);
    TEST(a_fan_that_is_right_stays);
    TEST(what_cannot_be_cut_is_noted);
    TEST(every_format_is_cut);
    TEST(a_large_polygon_takes_bounded_work);
    if (getenv("DPT_DATA"))
        TEST(a_reported_file);
    else
        SKIP("a reported file", "DPT_DATA is not set");
    return check_report();
}
