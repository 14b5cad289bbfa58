/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The list of shapes, what they are built with, and the plain ones: torus, sheets, box and hub.
 */
#include "scene/shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sincos.h"

#define NO_HALF UINT32_MAX

void shape_free(struct shape *shape)
{
    free(shape->vertices);
    free(shape->corners);
    memset(shape, 0, sizeof *shape);
}

int shape_begin(struct shape *shape, size_t vertices, size_t triangles)
{
    memset(shape, 0, sizeof *shape);
    shape->vertices = malloc(vertices * 3 * sizeof *shape->vertices);
    shape->corners = malloc(triangles * 3 * sizeof *shape->corners);
    if (shape->vertices && shape->corners)
        return 0;
    shape_free(shape);
    return -1;
}

void shape_add_vertex(struct shape *shape, double x, double y, double z)
{
    double *v = shape->vertices + 3 * shape->vertex_count++;
    v[0] = x;
    v[1] = y;
    v[2] = z;
}

void shape_add_triangle(struct shape *shape, size_t a, size_t b, size_t c)
{
    uint32_t *t = shape->corners + 3 * shape->triangle_count++;
    t[0] = (uint32_t)a;
    t[1] = (uint32_t)b;
    t[2] = (uint32_t)c;
}

uint32_t square_root_below(uint64_t n)
{
    uint64_t k = (uint64_t)sqrt((double)n);
    while (k * k > n)
        k--;
    while ((k + 1) * (k + 1) <= n)
        k++;
    return (uint32_t)k;
}

double shape_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * (1.0 / 9007199254740992.0);
}

/*
 * Splitting. Half-edge h is the side of triangle h / 3 that starts at corners[h]; its twin is the
 * same edge seen from the neighbour.
 */
struct edge {
    double length2;
    uint32_t half;
};

struct splitter {
    struct shape *shape;
    const struct shape_surface *surface;
    uint32_t *twin;
    struct edge *heap; /* of inner edges, the longest first */
    size_t heap_count;
};

static uint32_t next_half(uint32_t half)
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

static double edge_length2(const struct shape *shape, uint32_t half)
{
    const double *a = shape->vertices + 3 * (size_t)shape->corners[half];
    const double *b = shape->vertices + 3 * (size_t)shape->corners[next_half(half)];
    double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return x * x + y * y + z * z;
}

/* A total order, so that equal lengths come out alike everywhere. */
static int edge_before(const struct edge *a, const struct edge *b)
{
    return a->length2 != b->length2 ? a->length2 > b->length2 : a->half < b->half;
}

static void heap_push(struct splitter *s, uint32_t half)
{
    if (s->twin[half] == NO_HALF)
        return;
    struct edge edge = { edge_length2(s->shape, half), half };
    size_t i = s->heap_count++;
    for (; i > 0 && edge_before(&edge, &s->heap[(i - 1) / 2]); i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = edge;
}

static struct edge heap_pop(struct splitter *s)
{
    struct edge top = s->heap[0], last = s->heap[--s->heap_count];
    size_t i = 0;
    for (size_t child = 1; child < s->heap_count; child = 2 * i + 1) {
        if (child + 1 < s->heap_count && edge_before(&s->heap[child + 1], &s->heap[child]))
            child++;
        if (!edge_before(&s->heap[child], &last))
            break;
        s->heap[i] = s->heap[child];
        i = child;
    }
    s->heap[i] = last;
    return top;
}

/* Pair the half-edges, by lists at the lower vertex. They are short, because no shape that is split has a hub. */
static int pair_twins(struct splitter *s)
{
    size_t halves = 3 * s->shape->triangle_count, vertices = s->shape->vertex_count;
    const uint32_t *corners = s->shape->corners;
    uint32_t *first = malloc(vertices * sizeof *first), *later = malloc(halves * sizeof *later);
    int failed = !first || !later;
    for (size_t v = 0; !failed && v < vertices; v++)
        first[v] = NO_HALF;
    for (uint32_t h = 0; !failed && h < halves; h++) {
        uint32_t a = corners[h], b = corners[next_half(h)];
        uint32_t *list = &first[a < b ? a : b];
        while (*list != NO_HALF && (corners[*list] != b || corners[next_half(*list)] != a))
            list = &later[*list];
        s->twin[h] = *list;
        if (*list != NO_HALF) {
            s->twin[*list] = h;
            *list = later[*list];
        } else {
            later[h] = NO_HALF;
            *list = h;
        }
    }
    free(first);
    free(later);
    return failed ? -1 : 0;
}

static void pair(struct splitter *s, uint32_t a, uint32_t b)
{
    s->twin[a] = b;
    if (b != NO_HALF)
        s->twin[b] = a;
}

/*
 * Cut the triangle of `half` from the vertex `middle` of that side to the opposite corner. Returns
 * the second piece of the side; the first keeps its number.
 */
static uint32_t cut_triangle(struct splitter *s, uint32_t half, uint32_t middle)
{
    struct shape *shape = s->shape;
    uint32_t next = next_half(half), fresh = (uint32_t)(3 * shape->triangle_count);
    shape_add_triangle(shape, middle, shape->corners[next], shape->corners[next_half(next)]);
    shape->corners[next] = middle;
    pair(s, fresh + 1, s->twin[next]);
    pair(s, fresh + 2, next);
    return fresh;
}

static void split_edge(struct splitter *s, uint32_t half)
{
    struct shape *shape = s->shape;
    uint32_t other = s->twin[half], middle = (uint32_t)shape->vertex_count;
    const double *a = shape->vertices + 3 * (size_t)shape->corners[half];
    const double *b = shape->vertices + 3 * (size_t)shape->corners[next_half(half)];
    shape_add_vertex(shape, 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]));
    s->surface->project(s->surface->context, shape->vertices + 3 * (size_t)middle);

    uint32_t rest = cut_triangle(s, half, middle), other_rest = NO_HALF;
    if (other != NO_HALF)
        other_rest = cut_triangle(s, other, middle);
    pair(s, half, other_rest);
    pair(s, rest, other);

    const uint32_t changed[] = { half, rest, next_half(half), rest + 1 };
    for (size_t i = 0; i < sizeof changed / sizeof *changed; i++)
        heap_push(s, changed[i]);
    if (other != NO_HALF) {
        heap_push(s, next_half(other));
        heap_push(s, other_rest + 1);
    }
}

static uint32_t longest_border(const struct splitter *s)
{
    struct edge longest = { -1.0, NO_HALF };
    for (uint32_t h = 0; h < 3 * s->shape->triangle_count; h++) {
        struct edge edge = { 0.0, h };
        if (s->twin[h] != NO_HALF)
            continue;
        edge.length2 = edge_length2(s->shape, h);
        if (edge_before(&edge, &longest))
            longest = edge;
    }
    return longest.half;
}

static void split_longest(struct splitter *s, size_t count)
{
    if ((count - s->shape->triangle_count) % 2 == 1)
        split_edge(s, longest_border(s));
    for (uint32_t h = 0; h < 3 * s->shape->triangle_count; h++)
        if (h < s->twin[h])
            heap_push(s, h);
    while (s->shape->triangle_count < count) {
        struct edge edge = heap_pop(s);
        /* An entry is out of date when its half-edge has got another length since. */
        if (edge.length2 == edge_length2(s->shape, edge.half))
            split_edge(s, edge.half);
    }
}

int shape_split_to(struct shape *shape, size_t count, const struct shape_surface *surface)
{
    if (shape->triangle_count == count)
        return 0;
    struct splitter s = { shape, surface, NULL, NULL, 0 };
    s.twin = malloc(3 * count * sizeof *s.twin);
    s.heap = malloc((2 * shape->triangle_count + 6 * count) * sizeof *s.heap);
    int failed = !s.twin || !s.heap || pair_twins(&s);
    if (!failed)
        split_longest(&s, count);
    free(s.twin);
    free(s.heap);
    return failed ? -1 : 0;
}

/* Torus about the z axis. */
static const double torus_ring = 0.1, torus_tube = 0.04;

static void project_on_torus(const void *context, double p[3])
{
    double across = sqrt(p[0] * p[0] + p[1] * p[1]);
    double x = torus_ring * p[0] / across, y = torus_ring * p[1] / across;
    double dx = p[0] - x, dy = p[1] - y, scale = torus_tube / sqrt(dx * dx + dy * dy + p[2] * p[2]);
    (void)context;
    p[0] = x + scale * dx;
    p[1] = y + scale * dy;
    p[2] *= scale;
}

/* The grid with the most cells, at most `cells`, whose cells are square within a tenth in the mean. */
static void torus_grid(uint32_t cells, uint32_t *around_ring, uint32_t *around_tube)
{
    double square = sqrt((double)cells * torus_tube / torus_ring);
    uint32_t low = (uint32_t)(0.9 * square), high = (uint32_t)(1.1 * square) + 1, best = 0;
    for (uint32_t v = low < 3 ? 3 : low; v <= (high < 4 ? 4 : high); v++) {
        uint32_t covered = cells / v * v;
        double difference = fabs(v - square);
        if (cells / v < 3 || covered < best || (covered == best && difference > fabs(*around_tube - square)))
            continue;
        best = covered;
        *around_tube = v;
        *around_ring = cells / v;
    }
}

static int make_torus(uint32_t count, uint64_t seed, struct shape *shape)
{
    const struct shape_surface surface = { project_on_torus, NULL };
    uint32_t us = 0, vs = 0;
    (void)seed;
    torus_grid(count / 2, &us, &vs);
    if (shape_begin(shape, count / 2, count))
        return -1;
    for (uint32_t u = 0; u < us; u++) {
        double sin_u, cos_u, sin_v, cos_v;
        turn_sincos((double)u / us, &sin_u, &cos_u);
        for (uint32_t v = 0; v < vs; v++) {
            turn_sincos((double)v / vs, &sin_v, &cos_v);
            double across = torus_ring + torus_tube * cos_v;
            shape_add_vertex(shape, across * cos_u, across * sin_u, torus_tube * sin_v);
        }
    }
    for (size_t u = 0; u < us; u++) {
        for (size_t v = 0; v < vs; v++) {
            size_t here = u * vs, there = (u + 1) % us * vs, up = (v + 1) % vs;
            shape_add_triangle(shape, here + v, there + v, there + up);
            shape_add_triangle(shape, here + v, there + up, here + up);
        }
    }
    return shape_split_to(shape, count, &surface);
}

/* A square sheet about the origin, seen from +z, with waves in z. */
struct wave {
    double height, along_x, along_y, phase; /* metres; turns over the side; turns */
};

static double wave_height(const struct wave *waves, size_t count, double u, double v)
{
    double z = 0.0, sine, cosine;
    for (const struct wave *w = waves; w < waves + count; w++) {
        turn_sincos(w->along_x * u + w->along_y * v + w->phase, &sine, &cosine);
        z += w->height * sine;
    }
    return z;
}

static int make_sheet(uint32_t count, double side, const struct wave *waves, size_t wave_count, struct shape *shape)
{
    uint32_t k = square_root_below(count / 2);
    if (shape_begin(shape, ((size_t)k + 1) * (k + 1), count))
        return -1;
    for (uint32_t j = 0; j <= k; j++) {
        for (uint32_t i = 0; i <= k; i++) {
            double u = (double)i / k, v = (double)j / k;
            shape_add_vertex(shape, side * (u - 0.5), side * (v - 0.5), wave_height(waves, wave_count, u, v));
        }
    }
    for (size_t j = 0; j < k; j++) {
        for (size_t i = 0; i < k; i++) {
            size_t a = j * (k + 1) + i, b = a + 1, c = b + k + 1, d = a + k + 1;
            int falling = (i + j) % 2 == 1;
            shape_add_triangle(shape, a, b, falling ? d : c);
            shape_add_triangle(shape, falling ? b : a, c, d);
        }
    }
    return 0;
}

static int make_membrane(uint32_t count, uint64_t seed, struct shape *shape)
{
    const struct wave none = { 0.0, 0.0, 0.0, 0.0 };
    (void)seed;
    return make_sheet(count, 0.2, &none, 0, shape);
}

static int make_cloth(uint32_t count, uint64_t seed, struct shape *shape)
{
    struct wave folds[] = { { 0.006, 1.6, 0.4, 0.0 }, { 0.003, -0.7, 2.1, 0.0 }, { 0.001, 3.1, 2.3, 0.0 } };
    size_t fold_count = sizeof folds / sizeof *folds;
    for (size_t i = 0; i < fold_count; i++)
        folds[i].phase = shape_random(&seed);
    return make_sheet(count, 0.3, folds, fold_count, shape);
}

/* The index of a lattice point on the surface of a k x k x k box, counted along x, then y, then z. */
static size_t box_vertex(size_t k, const size_t at[3])
{
    size_t x = at[0], y = at[1], z = at[2], row = k + 1;
    size_t below = z == 0 ? 0 : row * row + (z - 1) * 4 * k;
    if (z == 0 || z == k)
        return below + y * row + x;
    if (y == 0 || y == k)
        return below + (y == 0 ? 0 : row + 2 * (k - 1)) + x;
    return below + row + 2 * (y - 1) + (x == 0 ? 0 : 1);
}

static void add_box_vertices(struct shape *shape, size_t k)
{
    for (size_t z = 0; z <= k; z++)
        for (size_t y = 0; y <= k; y++) {
            int whole_row = z == 0 || z == k || y == 0 || y == k;
            for (size_t x = 0; x <= k; x += whole_row ? 1 : k)
                shape_add_vertex(shape, 0.12 * ((double)x / (double)k - 0.5), 0.10 * ((double)y / (double)k - 0.5),
                                 0.08 * ((double)z / (double)k - 0.5));
        }
}

/* The side where the coordinate `axis` is 0 or k. */
static void add_box_side(struct shape *shape, size_t k, size_t axis, size_t level)
{
    size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (size_t j = 0; j < k; j++) {
        for (size_t i = 0; i < k; i++) {
            size_t corner[4];
            for (size_t n = 0; n < 4; n++) {
                size_t at[3];
                at[axis] = level;
                at[u] = i + (n == 1 || n == 2);
                at[v] = j + (n >= 2);
                corner[level ? n : 3 - n] = box_vertex(k, at);
            }
            shape_add_triangle(shape, corner[0], corner[1], corner[2]);
            shape_add_triangle(shape, corner[0], corner[2], corner[3]);
        }
    }
}

static int make_box(uint32_t count, uint64_t seed, struct shape *shape)
{
    size_t k = square_root_below(count / 12);
    (void)seed;
    if (shape_begin(shape, 6 * k * k + 2, count))
        return -1;
    add_box_vertices(shape, k);
    for (size_t axis = 0; axis < 3; axis++) {
        add_box_side(shape, k, axis, 0);
        add_box_side(shape, k, axis, k);
    }
    return 0;
}

static int make_hub(uint32_t count, uint64_t seed, struct shape *shape)
{
    (void)seed;
    if (shape_begin(shape, (size_t)count + 1, count))
        return -1;
    shape_add_vertex(shape, 0.0, 0.0, 0.02);
    for (uint32_t i = 0; i < count; i++) {
        double sine, cosine;
        turn_sincos((double)i / count, &sine, &cosine);
        shape_add_vertex(shape, 0.1 * cosine, 0.1 * sine, 0.0);
    }
    for (size_t i = 0; i < count; i++)
        shape_add_triangle(shape, 0, 1 + i, 1 + (i + 1) % count);
    return 0;
}

#define WALL_HOLE   0.008 /* m */
#define WALL_RADIUS 0.12
#define WALL_TOP    0.085
enum { WALL_SECTORS = 32 };

/* The wall of a belly that is blown up, over the organs, with a hole for an instrument: z = top - r^2 / 1 m. */
static int make_wall(uint32_t count, uint64_t seed, struct shape *shape)
{
    const size_t rings = count / (2 * WALL_SECTORS);
    (void)seed;
    if (shape_begin(shape, (rings + 1) * WALL_SECTORS, count))
        return -1;
    for (size_t ring = 0; ring <= rings; ring++) {
        const double r = WALL_HOLE + (WALL_RADIUS - WALL_HOLE) * ((double)ring / (double)rings);
        for (size_t i = 0; i < WALL_SECTORS; i++) {
            double sine, cosine;
            turn_sincos((double)i / WALL_SECTORS, &sine, &cosine);
            shape_add_vertex(shape, r * cosine, r * sine, WALL_TOP - r * r);
        }
    }
    for (size_t ring = 0; ring < rings; ring++)
        for (size_t i = 0; i < WALL_SECTORS; i++) {
            const size_t a = ring * WALL_SECTORS + i;
            const size_t b = ring * WALL_SECTORS + (i + 1) % WALL_SECTORS;
            shape_add_triangle(shape, a, a + WALL_SECTORS, b + WALL_SECTORS);
            shape_add_triangle(shape, a, b + WALL_SECTORS, b);
        }
    return 0;
}

const struct shape_kind shape_kinds[] = {
    { "torus", 0, 32, SHAPE_EVEN, make_torus, "ring 0.1 m, tube 0.04 m, axis z" },
    { "liver", 50332, 200, SHAPE_EVEN, shape_liver, "two lobes, 0.28 x 0.18 x 0.12 m" },
    { "stomach", 20000, 200, SHAPE_ANY, shape_stomach, "beside the liver; odd N: inlet open" },
    { "spleen", 10000, 200, SHAPE_EVEN, shape_spleen, "behind the stomach" },
    { "membrane", 512, 2, SHAPE_TWO_SQUARES, make_membrane, "flat square of 0.2 m, z = 0" },
    { "cloth", 2048, 2, SHAPE_TWO_SQUARES, make_cloth, "square of 0.3 m with folds" },
    { "star", 20480, 2000, SHAPE_EVEN, shape_star, "sphere 0.06 m, 48 spikes to 0.15 m" },
    { "sphere", 0, 20, SHAPE_EVEN, shape_sphere, "radius 0.1 m" },
    { "box", 12, 12, SHAPE_TWELVE_SQUARES, make_box, "0.12 x 0.10 x 0.08 m" },
    { "hub", 0, 3, SHAPE_ANY, make_hub, "cone of triangles about one vertex, open" },
    { "wall", 1024, 64, SHAPE_RINGS, make_wall, "dome over the organs, with a hole of 16 mm" }
};
const size_t shape_kind_count = sizeof shape_kinds / sizeof *shape_kinds;

/* What is wrong with the number, or NULL. */
static const char *wrong_count(const struct shape_kind *kind, uint64_t count)
{
    uint64_t two = square_root_below(count / 2), twelve = square_root_below(count / 12);
    if (count == 0)
        return "needs the number of triangles";
    if (kind->counts == SHAPE_EVEN && count % 2)
        return "is closed, and a closed mesh has an even number of triangles";
    if (kind->counts == SHAPE_TWO_SQUARES && 2 * two * two != count)
        return "can only have 2 k^2 triangles, as 512";
    if (kind->counts == SHAPE_TWELVE_SQUARES && 12 * twelve * twelve != count)
        return "can only have 12 k^2 triangles, as 12 or 48";
    if (kind->counts == SHAPE_RINGS && count % (2 * WALL_SECTORS))
        return "can only have 64 k triangles, as 64 or 1024";
    return NULL;
}

int shape_make(const char *name, uint64_t count, uint64_t seed, struct shape *shape, shape_reason reason)
{
    const struct shape_kind *kind = shape_kinds, *end = shape_kinds + shape_kind_count;
    memset(shape, 0, sizeof *shape);
    while (kind < end && strcmp(kind->name, name) != 0)
        kind++;
    if (kind == end) {
        snprintf(reason, SHAPE_REASON_BYTES, "no shape '%.40s': see --help", name);
        return -1;
    }
    if (count == 0)
        count = kind->default_count;
    const char *wrong = wrong_count(kind, count);
    if (count != 0 && (count < kind->count_min || count > SHAPE_TRIANGLES_MAX))
        snprintf(reason, SHAPE_REASON_BYTES, "%s has from %u to %u triangles", kind->name, (unsigned)kind->count_min,
                 SHAPE_TRIANGLES_MAX);
    else if (wrong)
        snprintf(reason, SHAPE_REASON_BYTES, "%s %s", kind->name, wrong);
    else if (kind->make((uint32_t)count, seed, shape))
        snprintf(reason, SHAPE_REASON_BYTES, "memory ran out");
    else
        return 0;
    shape_free(shape);
    return -1;
}
