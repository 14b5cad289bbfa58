/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Routes of triangles: the paper's Figure 6, laid out; lengths and the very routes against a breadth-first search
 * over all triangles, and that against a plainer one still; by the table of distances the same; what a strip, or a
 * search, that is too small does.
 *
 *     test_route           what make check runs: 10^5 pairs
 *     test_route FACTOR    so many times as many
 *
 * Real meshes from DPT_DATA.
 */
#include "dynpoint/strip.h"
#include "oracle/route.h"
#include "strip_subject.h"

static const char *data;
static uint64_t factor = 1;

static struct tally {
    size_t meshes, pairs, longest, dropped, unreachable;
} all;

/* A strip, and the oracle's room, for routes over a mesh. */
struct walk {
    const struct subject *subject;
    struct held_strip held;
    dpt_strip *strip;
    uint32_t *tau, *route, *back;
};

static void walk_open(struct walk *walk, const struct subject *subject)
{
    const uint32_t count = subject->info.source_triangles;
    walk->subject = subject;
    walk->strip =
        hold_strip(&walk->held, count < 1u << 20 ? count : 1u << 20, subject->info.vertices);
    walk->tau = malloc(count * sizeof *walk->tau);
    walk->route = malloc(count * sizeof *walk->route);
    walk->back = malloc(count * sizeof *walk->back);
}

static void walk_close(struct walk *walk)
{
    drop_strip(&walk->held);
    free(walk->tau);
    free(walk->route);
    free(walk->back);
}

static int is_there(const struct subject *subject, uint32_t triangle)
{
    return subject->surface.corner[triangle][0] != ORACLE_NONE;
}

/* The code that is due for a pair, with tau towards `to`. */
static dpt_result due(const struct walk *walk, uint32_t from, uint32_t to)
{
    if (!is_there(walk->subject, from) || !is_there(walk->subject, to))
        return DPT_E_DROPPED;
    return walk->tau[from] == ORACLE_NONE ? DPT_E_UNREACHABLE : DPT_OK;
}

/* A strip holds just these, in this order. */
static int holds(const dpt_strip *strip, const uint32_t *route, uint32_t length)
{
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_triangles(strip, &count, &flags);
    return count == length && flags == 0 &&
           (!length || memcmp(triangles, route, length * sizeof *route) == 0);
}

static const char *text_of(const dpt_strip *strip)
{
    static char text[256];
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_triangles(strip, &count, &flags);
    int length = snprintf(text, sizeof text, "flags %u, %u triangles:", flags, count);
    for (uint32_t i = 0; i < count && length < 240; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, " %u", triangles[i]);
    return text;
}

/* An answer of the library for a pair whose tau is in the walk; by whichever call. */
static void check_answer(const struct walk *walk, uint32_t from, uint32_t to, dpt_result result,
                         const char *by)
{
    const dpt_result wanted = due(walk, from, to);
    const uint32_t length = oracle_route(&walk->subject->surface, walk->tau, from, walk->route);
    CHECK(result == wanted, "%s, %s, %u to %u: %s, not %s", walk->subject->name, by, from, to,
          dpt_result_name(result), dpt_result_name(wanted));
    if (result == wanted)
        CHECK(holds(walk->strip, walk->route, result == DPT_OK ? length : 0),
              "%s, %s, %u to %u: %s; not %u: %u %u %u ...", walk->subject->name, by, from, to,
              text_of(walk->strip), length, walk->route[0], length > 1 ? walk->route[1] : 0,
              length > 2 ? walk->route[2] : 0);
}

static uint32_t length_of(const struct walk *walk, uint32_t from, uint32_t to)
{
    uint32_t count = 0;
    const dpt_result result = dpt_strip_route(walk->strip, walk->subject->mesh, from, to);
    dpt_strip_triangles(walk->strip, &count, NULL);
    return result == DPT_OK ? count : 0;
}

/* A triangle a few steps away. */
static uint32_t stray(const struct oracle_surface *surface, uint32_t from, uint64_t *seed)
{
    for (uint64_t steps = random_bits(seed) % 8;
         steps > 0 && surface->corner[from][0] != ORACLE_NONE; steps--) {
        const uint32_t v = surface->corner[from][random_bits(seed) % 3];
        from = surface->fan[surface->first[v] +
                            random_bits(seed) % (surface->first[v + 1] - surface->first[v])];
    }
    return from;
}

enum { FROM = 64 };

static void try_pairs(const struct subject *subject, uint64_t pairs, uint64_t seed)
{
    struct walk walk;
    const uint32_t count = subject->info.source_triangles;
    size_t longest = 0;
    walk_open(&walk, subject);
    for (uint64_t i = 0; i < factor * ((pairs + FROM - 1) / FROM); i++) {
        const uint32_t to = (uint32_t)(random_bits(&seed) % count);
        oracle_route_tau(&subject->surface, to, walk.tau);
        for (uint32_t k = 0; k < FROM; k++) {
            const uint32_t from = k == 0  ? to
                                  : k % 2 ? stray(&subject->surface, to, &seed)
                                          : (uint32_t)(random_bits(&seed) % count);
            const dpt_result result = dpt_strip_route(walk.strip, subject->mesh, from, to);
            check_answer(&walk, from, to, result, "route");
            const dpt_result wanted = due(&walk, from, to);
            all.pairs++;
            all.dropped += wanted == DPT_E_DROPPED;
            all.unreachable += wanted == DPT_E_UNREACHABLE;
            if (wanted != DPT_OK)
                continue;
            longest = walk.tau[from] > longest ? walk.tau[from] : longest;
            if (k % 8 == 3)
                CHECK(length_of(&walk, to, from) == walk.tau[from] + 1,
                      "%s: %u to %u is not as far as back", subject->name, from, to);
            if (k % 8 == 4) {
                const uint32_t by = stray(&subject->surface, from, &seed);
                CHECK(length_of(&walk, from, by) + length_of(&walk, by, to) > walk.tau[from] + 1,
                      "%s: %u to %u is nearer by %u", subject->name, from, to, by);
            }
        }
    }
    printf("    %-30s %6u triangles, tau up to %zu\n", subject->name, subject->info.triangles,
           longest);
    all.longest = longest > all.longest ? longest : all.longest;
    all.meshes++;
    walk_close(&walk);
}

/*
 * A triangular lattice of points (x, y). A cell is the triangle (x, y), (x + 1, y), (x, y + 1), or the one `down` beside
 * it, (x + 1, y), (x + 1, y + 1), (x, y + 1).
 */

struct cell {
    int x, y, down;
};

static void lattice_point(int x, int y, double at[3])
{
    at[0] = 0.01 * (x + 0.5 * y);
    at[1] = 0.01 * 0.8660254 * y;
    at[2] = 0;
}

static int subject_from_cells(struct subject *subject, const char *name, const struct cell *cells,
                              uint32_t count)
{
    double vertices[9 * 64];
    uint32_t corners[3 * 64];
    for (uint32_t i = 0; i < count; i++) {
        const struct cell *c = &cells[i];
        lattice_point(c->x + c->down, c->y, vertices + 9 * i);
        lattice_point(c->x + 1, c->y + c->down, vertices + 9 * i + 3);
        lattice_point(c->x, c->y + 1, vertices + 9 * i + 6);
        for (uint32_t k = 0; k < 3; k++)
            corners[3 * i + k] = 3 * i + k;
    }
    return subject_from_arrays(subject, name, vertices, 3 * (size_t)count, corners, count);
}

/*
 * The paper's Figure 6, by its caption: letters are the order in the array, C is 3 from W, of its neighbours A and E are
 * nearest to W, and the route is C, A, V, W. Here C = (0, 0), (-1, 0), (-1, 1) and W = (2, 0), (3, 0), (2, 1) are such
 * that only the edges (0, 0) to (1, 0), between A and E, and (1, 0) to (2, 0), between V and X, lead from one to the
 * other in so few steps.
 */
static void the_papers_figure(void)
{
    static const struct cell cells[] = {
        ['A' - 'A'] = { 0, 0, 0 },   ['B' - 'A'] = { -2, 0, 0 },  ['C' - 'A'] = { -1, 0, 0 },
        ['D' - 'A'] = { -2, 0, 1 },  ['E' - 'A'] = { 0, -1, 1 },  ['F' - 'A'] = { -1, 0, 1 },
        ['G' - 'A'] = { 0, 0, 1 },   ['H' - 'A'] = { -2, -1, 0 }, ['I' - 'A'] = { -2, -1, 1 },
        ['J' - 'A'] = { -1, -1, 0 }, ['K' - 'A'] = { -1, -1, 1 }, ['L' - 'A'] = { 0, -1, 0 },
        ['M' - 'A'] = { 1, -1, 0 },  ['N' - 'A'] = { 2, -1, 0 },  ['O' - 'A'] = { 2, -1, 1 },
        ['P' - 'A'] = { 1, 0, 1 },   ['Q' - 'A'] = { 2, 0, 1 },   ['R' - 'A'] = { 3, -1, 0 },
        ['S' - 'A'] = { 3, -1, 1 },  ['T' - 'A'] = { 3, 0, 0 },   ['U' - 'A'] = { -3, 0, 1 },
        ['V' - 'A'] = { 1, 0, 0 },   ['W' - 'A'] = { 2, 0, 0 },   ['X' - 'A'] = { 1, -1, 1 },
    };
    enum { COUNT = sizeof cells / sizeof *cells };
    const uint32_t c = 'C' - 'A', w = 'W' - 'A', route[4] = { c, 'A' - 'A', 'V' - 'A', w };
    struct subject subject;
    struct walk walk;
    char near[32] = "";
    if (!subject_from_cells(&subject, "figure 6", cells, COUNT))
        return;
    CHECK(subject.info.triangles == COUNT && subject.info.components == 1, "%u triangles, %u parts",
          subject.info.triangles, subject.info.components);
    walk_open(&walk, &subject);
    oracle_route_tau(&subject.surface, w, walk.tau);
    CHECK(walk.tau[c] == 3, "C is %u from W", walk.tau[c]);
    for (uint32_t i = 0, n = 0; i < COUNT; i++)
        if (oracle_surface_common(&subject.surface, c, i) && walk.tau[i] == 2)
            near[n++] = (char)('A' + i);
    CHECK(strcmp(near, "AE") == 0, "nearest to W of C's neighbours: %s", near);
    CHECK(oracle_route(&subject.surface, walk.tau, c, walk.route) == 4 &&
              memcmp(walk.route, route, sizeof route) == 0,
          "%u %u %u %u", walk.route[0], walk.route[1], walk.route[2], walk.route[3]);
    const dpt_result result = dpt_strip_route(walk.strip, subject.mesh, c, w);
    CHECK(result == DPT_OK && holds(walk.strip, route, 4), "%s, %s", dpt_result_name(result),
          text_of(walk.strip));
    walk_close(&walk);
    subject_close(&subject);
}

/* Where one neighbour shares an edge and one of lower number but a vertex, the edge goes first. */
static void two_vertices_go_before_one(void)
{
    /* About (0, 0): from 0 to 3, both 1 and 2 touch both; 2 shares an edge with 0. */
    static const struct cell cells[] = { { -1, 0, 0 }, { 0, -1, 1 }, { -1, 0, 1 }, { 0, 0, 0 } };
    /* 1 touches 0 at (0, 1) alone and 2 along an edge, and both lead to 3, which 0 does not touch. */
    static const struct cell apart[] = { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 0 } };
    const uint32_t near[2] = { 0, 3 }, far[3] = { 0, 2, 3 };
    struct subject subject;
    struct walk walk;
    if (!subject_from_cells(&subject, "fan", cells, 4))
        return;
    walk_open(&walk, &subject);
    CHECK(dpt_strip_route(walk.strip, subject.mesh, 0, 3) == DPT_OK && holds(walk.strip, near, 2),
          "%s", text_of(walk.strip));
    walk_close(&walk);
    subject_close(&subject);
    if (!subject_from_cells(&subject, "edge", apart, 4))
        return;
    walk_open(&walk, &subject);
    oracle_route_tau(&subject.surface, 3, walk.tau);
    CHECK(oracle_surface_common(&subject.surface, 0, 1) == 1 &&
              oracle_surface_common(&subject.surface, 0, 2) == 2,
          "laid out otherwise");
    CHECK(walk.tau[0] == 2 && walk.tau[1] == 1 && walk.tau[2] == 1, "%u %u %u", walk.tau[0],
          walk.tau[1], walk.tau[2]);
    CHECK(dpt_strip_route(walk.strip, subject.mesh, 0, 3) == DPT_OK && holds(walk.strip, far, 3),
          "%s", text_of(walk.strip));
    walk_close(&walk);
    subject_close(&subject);
}

/* The oracle against a plainer one: every pair of corners compared, distances by relaxing until none falls. */

static int touch(const double *a, const double *b)
{
    int common = 0;
    for (int i = 0; i < 9; i += 3)
        for (int j = 0; j < 9; j += 3)
            common += a[i] == b[j] && a[i + 1] == b[j + 1] && a[i + 2] == b[j + 2];
    return common;
}

static void plain_tau(const unsigned char *common, uint32_t count, uint32_t to, uint32_t *tau)
{
    int falls = 1;
    for (uint32_t i = 0; i < count; i++)
        tau[i] = i == to ? 0 : ORACLE_NONE;
    while (falls) {
        falls = 0;
        for (uint32_t i = 0; i < count; i++)
            for (uint32_t j = 0; j < count; j++)
                if (common[i * count + j] && tau[j] != ORACLE_NONE && tau[j] + 1 < tau[i]) {
                    tau[i] = tau[j] + 1;
                    falls = 1;
                }
    }
}

/* By the words of SPEC 8. */
static uint32_t plain_next(const unsigned char *common, uint32_t count, const uint32_t *tau,
                           uint32_t c)
{
    for (int least = 2; least >= 1; least--)
        for (uint32_t n = 0; n < count; n++)
            if (common[c * count + n] >= least && tau[n] == tau[c] - 1)
                return n;
    return ORACLE_NONE;
}

static void compare_oracles(const struct subject *subject)
{
    const uint32_t count = subject->info.source_triangles;
    unsigned char *common = calloc((size_t)count * count, 1);
    double *corners = calloc(9 * (size_t)count, sizeof *corners);
    uint32_t *tau = malloc(count * sizeof *tau), *plain = malloc(count * sizeof *plain);
    for (uint32_t i = 0; i < count; i++)
        dpt_mesh_triangle(subject->mesh, i, corners + 9 * (size_t)i);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < count; j++)
            if (is_there(subject, i) && is_there(subject, j))
                common[i * count + j] =
                    (unsigned char)touch(corners + 9 * (size_t)i, corners + 9 * (size_t)j);
    for (uint32_t to = 0; to < count; to++) {
        if (!is_there(subject, to))
            continue;
        oracle_route_tau(&subject->surface, to, tau);
        plain_tau(common, count, to, plain);
        CHECK(memcmp(tau, plain, count * sizeof *tau) == 0, "%s, to %u", subject->name, to);
        for (uint32_t c = 0; c < count; c++) {
            if (tau[c] == 0 || tau[c] == ORACLE_NONE)
                continue;
            const uint32_t next = oracle_route_next(&subject->surface, tau, c);
            CHECK(next == plain_next(common, count, plain, c), "%s, %u to %u: %u", subject->name, c,
                  to, next);
        }
    }
    free(common);
    free(corners);
    free(tau);
    free(plain);
}

static void oracles_agree(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "torus", 64 }, { "membrane", 72 }, { "hub", 20 }, { "box", 12 } };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            compare_oracles(&subject);
        subject_close(&subject);
    }
    for (uint64_t seed = 0; seed < 12; seed++) {
        if (subject_from_lattice(&subject, 3 + (uint32_t)seed % 4, 40 + 10 * (uint32_t)seed, seed))
            compare_oracles(&subject);
        subject_close(&subject);
    }
}

/* Against the oracle. */

static void generated_shapes(void)
{
    static const struct {
        const char *name;
        uint64_t count, pairs;
    } shapes[] = {
        { "torus", 32, 256 },      { "torus", 5568, 4096 },  { "liver", 50332, 2048 },
        { "membrane", 512, 4096 }, { "cloth", 20000, 2048 }, { "star", 20480, 2048 },
        { "sphere", 20, 256 },     { "box", 1200, 2048 },    { "stomach", 20001, 1024 }
    };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            try_pairs(&subject, shapes[i].pairs, i);
        subject_close(&subject);
    }
}

static void random_lattices(void)
{
    struct subject subject;
    for (uint64_t seed = 0; seed < 24; seed++) {
        /* From mostly apart, with many parts, to mostly together. */
        const uint32_t size = 3 + (uint32_t)seed % 6, points = size * size * size;
        if (subject_from_lattice(&subject, size, points / 4 + (uint32_t)(seed / 6) * points / 4,
                                 seed))
            try_pairs(&subject, 1024, seed);
        subject_close(&subject);
    }
    CHECK(all.dropped > 100 && all.unreachable > 1000, "%zu dropped, %zu unreachable", all.dropped,
          all.unreachable);
}

/*
 * A fan about one vertex, and a straight strip of `tail` squares at two opposite edges of its rim: every way from one
 * to the other leads through the fan.
 */
static int subject_with_hub(struct subject *subject, uint32_t fan, uint32_t tail)
{
    const uint32_t points = 1 + fan + 4 * tail, triangles = fan + 4 * tail;
    double *vertices = calloc(3 * (size_t)points, sizeof *vertices);
    uint32_t *corners = malloc(3 * (size_t)triangles * sizeof *corners), *c = corners;
    for (uint32_t i = 0; i < fan; i++) {
        vertices[3 * (i + 1)] = 0.1 * cos(6.283185307179586 * i / fan);
        vertices[3 * (i + 1) + 1] = 0.1 * sin(6.283185307179586 * i / fan);
        const uint32_t triangle[3] = { 0, 1 + i, 1 + (i + 1) % fan };
        memcpy(c, triangle, sizeof triangle);
        c += 3;
    }
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t first = 1 + fan + 2 * tail * side;
        uint32_t a = 1 + side * (fan / 2), b = a + 1;
        for (uint32_t i = 0; i < tail; i++) {
            for (uint32_t k = 0; k < 2; k++) {
                double *v = vertices + 3 * (first + 2 * i + k);
                v[0] = (side ? -1 : 1) * (0.11 + 0.01 * i);
                v[1] = 0.01 * k;
            }
            const uint32_t square[6] = { a, b, first + 2 * i, b, first + 2 * i, first + 2 * i + 1 };
            memcpy(c, square, sizeof square);
            c += 6;
            a = first + 2 * i;
            b = a + 1;
        }
    }
    const int opened =
        subject_from_arrays(subject, "hub with tails", vertices, points, corners, triangles);
    free(vertices);
    free(corners);
    return opened;
}

static void hubs(void)
{
    struct subject subject;
    if (subject_with_hub(&subject, 50000, 500))
        try_pairs(&subject, 1024, 1);
    subject_close(&subject);
    if (subject_with_hub(&subject, 50, 500))
        try_pairs(&subject, 2048, 2);
    subject_close(&subject);
    if (subject_from_shape(&subject, "hub", 50000))
        try_pairs(&subject, 512, 3);
    subject_close(&subject);
}

/* A book: `pages` nets that share one line of vertices, its spine. */
static void books(void)
{
    enum { PAGES = 7, SIDE = 12, ROW = SIDE + 1 };
    static double vertices[3 * PAGES * ROW * ROW];
    static uint32_t corners[6 * PAGES * SIDE * SIDE];
    uint32_t *c = corners;
    for (uint32_t p = 0; p < PAGES; p++)
        for (uint32_t i = 0; i < ROW; i++)
            for (uint32_t j = 0; j < ROW; j++) {
                double *v = vertices + 3 * ((p * ROW + i) * ROW + j);
                v[0] = j ? 0.01 * j * cos(0.5 * p) : 0;
                v[1] = j ? 0.01 * j * sin(0.5 * p) : 0;
                v[2] = 0.01 * i;
            }
    for (uint32_t p = 0; p < PAGES; p++)
        for (uint32_t i = 0; i < SIDE; i++)
            for (uint32_t j = 0; j < SIDE; j++) {
                const uint32_t a = (p * ROW + i) * ROW + j;
                const uint32_t square[6] = { a, a + 1, a + ROW, a + 1, a + ROW + 1, a + ROW };
                memcpy(c, square, sizeof square);
                c += 6;
            }
    struct subject subject;
    if (subject_from_arrays(&subject, "book", vertices, PAGES * ROW * ROW, corners,
                            2 * PAGES * SIDE * SIDE)) {
        CHECK(subject.info.nonmanifold_edges == SIDE, "%u", subject.info.nonmanifold_edges);
        try_pairs(&subject, 4096, 7);
    }
    subject_close(&subject);
}

static void try_public(const struct subject *subject)
{
    uint64_t seed = 5381;
    for (const char *c = subject->name; *c; c++)
        seed = 33 * seed + (unsigned char)*c;
    try_pairs(subject, 1024, seed);
}

static void public_meshes(void)
{
    const size_t before = all.meshes;
    for_public_meshes(data, try_public);
    CHECK(all.meshes - before >= 60, "%zu meshes", all.meshes - before);
}

static void many_pairs(void)
{
    printf("    %zu meshes, %zu pairs: %zu dropped, %zu unreachable, tau up to %zu\n", all.meshes,
           all.pairs, all.dropped, all.unreachable, all.longest);
    CHECK(all.pairs >= (data ? 100000 : 40000) && all.longest >= 100, "%zu pairs, %zu", all.pairs,
          all.longest);
}

/* The table. */

static void try_table(const struct subject *subject, uint64_t pairs, uint64_t seed)
{
    const uint32_t count = subject->info.source_triangles;
    uint32_t there = 0;
    const size_t bytes = dpt_route_table_bytes(subject->mesh);
    unsigned char *block = malloc(bytes + 8);
    const dpt_route_table *table = NULL;
    struct walk walk;
    walk_open(&walk, subject);
    drop_strip(&walk.held);
    walk.strip = hold_strip(&walk.held, count, 0);
    memset(block + bytes, 0x5a, 8);
    const dpt_result made = dpt_route_table_create(block, bytes, subject->mesh, &table);
    CHECK(bytes > 0 && made == DPT_OK && table, "%s: %zu bytes, %s", subject->name, bytes,
          dpt_result_name(made));
    for (uint64_t i = 0; i < pairs / FROM && made == DPT_OK; i++) {
        const uint32_t to = (uint32_t)(random_bits(&seed) % count);
        oracle_route_tau(&subject->surface, to, walk.tau);
        for (uint32_t k = 0; k < FROM; k++) {
            const uint32_t from = k == 0  ? to
                                  : k % 2 ? stray(&subject->surface, to, &seed)
                                          : (uint32_t)(random_bits(&seed) % count);
            check_answer(&walk, from, to, dpt_strip_route_by_table(walk.strip, table, from, to),
                         "table");
        }
    }
    while (!is_there(subject, there))
        there++;
    for (size_t i = bytes; i < bytes + 8; i++)
        CHECK(block[i] == 0x5a, "%s: wrote beyond the table", subject->name);
    CHECK(dpt_route_table_create(block, bytes - 1, subject->mesh, &table) == DPT_E_MEMORY, "small");
    CHECK(dpt_route_table_create(block + 4, bytes, subject->mesh, &table) == DPT_E_ALIGN, "odd");
    CHECK(dpt_route_table_create(NULL, bytes, subject->mesh, &table) == DPT_E_ARGUMENT, "no block");
    CHECK(dpt_route_table_create(block, bytes, NULL, &table) == DPT_E_ARGUMENT, "no mesh");
    CHECK(dpt_route_table_create(block, bytes, subject->mesh, NULL) == DPT_E_ARGUMENT, "nowhere");
    CHECK(dpt_route_table_create(block, bytes, subject->mesh, &table) == DPT_OK, "again");
    CHECK(dpt_strip_route_by_table(NULL, table, there, there) == DPT_E_ARGUMENT, "no strip");
    CHECK(dpt_strip_route_by_table(walk.strip, NULL, there, there) == DPT_E_ARGUMENT, "no table");
    CHECK(dpt_strip_route_by_table(walk.strip, table, count, there) == DPT_E_ARGUMENT, "from");
    CHECK(dpt_strip_route_by_table(walk.strip, table, there, DPT_NONE) == DPT_E_ARGUMENT, "to");
    walk_close(&walk);
    free(block);
}

static void by_table(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "torus", 1600 }, { "membrane", 800 }, { "star", 2000 }, { "hub", 2000 } };
    struct subject subject;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            try_table(&subject, 2048, i);
        subject_close(&subject);
    }
    for (uint64_t seed = 0; seed < 8; seed++) {
        if (subject_from_lattice(&subject, 5, 40 + 30 * (uint32_t)seed, seed))
            try_table(&subject, 1024, seed);
        subject_close(&subject);
    }
    if (subject_from_shape(&subject, "torus", 10000))
        CHECK(dpt_route_table_bytes(subject.mesh) > 0, "none for 10,000");
    subject_close(&subject);
    if (subject_from_shape(&subject, "torus", 10002)) {
        static uint64_t block[1024];
        const dpt_route_table *table = NULL;
        CHECK(dpt_route_table_bytes(subject.mesh) == 0, "one for 10,002");
        CHECK(dpt_route_table_create(block, sizeof block, subject.mesh, &table) != DPT_OK && !table,
              "made for 10,002");
    }
    subject_close(&subject);
    CHECK(dpt_route_table_bytes(NULL) == 0, "for no mesh");
}

/* Too small. */

/* A strip of less capacity holds the beginning, and says that there is more. */
static void check_cut(const struct walk *walk, uint32_t from, uint32_t to, uint32_t length)
{
    const uint32_t tries[] = { 1, 2, 3, length / 2, length - 1, length, length + 1 };
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++) {
        const uint32_t capacity = tries[i] ? tries[i] : 1;
        const uint32_t held_count = capacity < length ? capacity : length;
        struct held_strip held;
        uint32_t count = 0, flags = 0;
        dpt_strip *strip = hold_strip(&held, capacity, walk->subject->info.vertices);
        const dpt_result result = dpt_strip_route(strip, walk->subject->mesh, from, to);
        const uint32_t *triangles = dpt_strip_triangles(strip, &count, &flags);
        CHECK(result == DPT_OK && count == held_count &&
                  flags == (capacity < length ? DPT_STRIP_FULL : 0u),
              "%s, %u to %u, of %u in room for %u: %s, %u, flags %u", walk->subject->name, from, to,
              length, capacity, dpt_result_name(result), count, flags);
        CHECK(count <= length && memcmp(triangles, walk->route, count * sizeof *triangles) == 0,
              "%s, %u to %u, room for %u: %s", walk->subject->name, from, to, capacity,
              text_of(strip));
        drop_strip(&held);
    }
}

/* A search of less room finds the route or says that it cannot. */
static void check_search(const struct walk *walk, uint32_t from, uint32_t to, uint32_t length,
                         size_t *full, size_t *found)
{
    const uint32_t vertices = walk->subject->info.vertices;
    for (uint32_t search = 0; search <= vertices;
         search = search < 8 ? search + 1 : search + search / 4) {
        struct held_strip held;
        dpt_strip *strip = hold_strip(&held, length, search);
        const dpt_result result = dpt_strip_route(strip, walk->subject->mesh, from, to);
        CHECK(result == DPT_OK ? holds(strip, walk->route, length)
                               : result == DPT_E_FULL && holds(strip, NULL, 0),
              "%s, %u to %u, search %u: %s, %s", walk->subject->name, from, to, search,
              dpt_result_name(result), text_of(strip));
        if (length > 3 && search == 0)
            CHECK(result == DPT_E_FULL, "%s, %u to %u without a search", walk->subject->name, from,
                  to);
        *full += result == DPT_E_FULL;
        *found += result == DPT_OK;
        drop_strip(&held);
    }
}

static void too_small(void)
{
    size_t full = 0, found = 0;
    for (uint64_t kind = 0; kind < 3; kind++) {
        struct subject subject;
        struct walk walk;
        uint64_t seed = kind;
        if (!(kind == 0   ? subject_from_shape(&subject, "torus", 2000)
              : kind == 1 ? subject_from_shape(&subject, "cloth", 1152)
                          : subject_with_hub(&subject, 200, 100)))
            continue;
        walk_open(&walk, &subject);
        for (int i = 0; i < 100; i++) {
            const uint32_t from = (uint32_t)(random_bits(&seed) % subject.info.triangles);
            const uint32_t to =
                i % 8 ? (uint32_t)(random_bits(&seed) % subject.info.triangles) : from;
            oracle_route_tau(&subject.surface, to, walk.tau);
            const uint32_t length = oracle_route(&subject.surface, walk.tau, from, walk.route);
            check_cut(&walk, from, to, length);
            check_search(&walk, from, to, length, &full, &found);
        }
        walk_close(&walk);
        subject_close(&subject);
    }
    printf("    searches: %zu full, %zu found\n", full, found);
    CHECK(full > 300 && found > 300, "%zu full, %zu found", full, found);
}

/* The union of two routes, each triangle once. */

static void two_routes(void)
{
    static const struct {
        const char *name;
        uint64_t count;
    } shapes[] = { { "torus", 5568 }, { "cloth", 2048 }, { "hub", 2000 }, { "star", 2000 } };
    size_t shared = 0, cut = 0;
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        struct subject subject;
        struct walk walk;
        struct held_strip small;
        uint64_t seed = s;
        if (!subject_from_shape(&subject, shapes[s].name, shapes[s].count))
            continue;
        walk_open(&walk, &subject);
        dpt_strip *few = hold_strip(&small, 5, subject.info.vertices);
        unsigned char *wanted = calloc(subject.info.source_triangles, 1);
        for (int i = 0; i < 300; i++) {
            const uint32_t p = (uint32_t)(random_bits(&seed) % subject.info.triangles);
            const uint32_t a = stray(&subject.surface, p, &seed);
            const uint32_t b = i % 4   ? stray(&subject.surface, p, &seed)
                               : i % 8 ? a
                                       : (uint32_t)(random_bits(&seed) % subject.info.triangles);
            uint32_t both = 0, count = 0, flags = 0;
            oracle_route_tau(&subject.surface, p, walk.tau);
            const uint32_t m = oracle_route(&subject.surface, walk.tau, a, walk.route);
            const uint32_t n = oracle_route(&subject.surface, walk.tau, b, walk.back);
            for (uint32_t k = 0; k < m + n; k++) {
                unsigned char *once = &wanted[k < m ? walk.route[k] : walk.back[k - m]];
                both += !*once;
                *once = 1;
            }
            const dpt_result result = dpt_strip_routes(walk.strip, subject.mesh, a, b, p);
            const uint32_t *got = dpt_strip_triangles(walk.strip, &count, &flags);
            CHECK(result == DPT_OK && count == both && flags == 0,
                  "%s, %u and %u to %u: %s, %u triangles, not %u, flags %u", subject.name, a, b, p,
                  dpt_result_name(result), count, both, flags);
            for (uint32_t k = 0; k < count; k++) {
                CHECK(wanted[got[k]] == 1, "%s, %u and %u to %u: %u is twice, or not on them",
                      subject.name, a, b, p, got[k]);
                wanted[got[k]] = 2;
            }
            const dpt_result cut_result = dpt_strip_routes(few, subject.mesh, a, b, p);
            got = dpt_strip_triangles(few, &count, &flags);
            CHECK(cut_result == DPT_OK && count == (both < 5 ? both : 5) &&
                      flags == (both > 5 ? DPT_STRIP_FULL : 0u),
                  "%s, %u and %u to %u, of %u: %s, %u triangles, flags %u", subject.name, a, b, p,
                  both, dpt_result_name(cut_result), count, flags);
            for (uint32_t k = 0; k < count; k++) {
                CHECK(wanted[got[k]] == 2, "%s, %u and %u to %u: %u is twice, or not on them",
                      subject.name, a, b, p, got[k]);
                wanted[got[k]] = 3;
            }
            for (uint32_t k = 0; k < m + n; k++)
                wanted[k < m ? walk.route[k] : walk.back[k - m]] = 0;
            shared += both + 1 < m + n;
            cut += both > 5;
        }
        free(wanted);
        drop_strip(&small);
        walk_close(&walk);
        subject_close(&subject);
    }
    CHECK(shared > 100 && cut > 100, "%zu share more than the end, %zu cut", shared, cut);
}

/* Arguments. */

static void check_def(dpt_strip_def def, int valid, const char *what)
{
    CHECK((dpt_strip_bytes(&def) > 0) == valid, "%s: %zu bytes", what, dpt_strip_bytes(&def));
    if (valid)
        CHECK(dpt_strip_bytes(&def) <= 1024 + 96 * (size_t)def.capacity + 36 * (size_t)def.search,
              "%s: %zu bytes", what, dpt_strip_bytes(&def));
}

static void bad_defs(void)
{
    static uint64_t block[8192];
    const dpt_strip_def good = { .size = sizeof good, .capacity = 16, .search = 64 };
    const uint32_t size = sizeof good;
    dpt_strip *strip = NULL;
    check_def(good, 1, "good");
    check_def((dpt_strip_def){ .size = size, .capacity = 1 }, 1, "least");
    check_def((dpt_strip_def){ .size = size, .capacity = 1u << 20 }, 1, "most triangles");
    check_def((dpt_strip_def){ .size = size, .capacity = 1, .search = 1u << 28 }, 1, "most search");
    check_def((dpt_strip_def){ .size = size, .capacity = 1, .search = 1 }, 1, "a search of one");
    check_def((dpt_strip_def){ .size = 0, .capacity = 16 }, 0, "no size");
    check_def((dpt_strip_def){ .size = size - 4, .capacity = 16 }, 0, "size");
    check_def((dpt_strip_def){ .size = size }, 0, "no room");
    check_def((dpt_strip_def){ .size = size, .capacity = (1u << 20) + 1 }, 0, "too much room");
    check_def((dpt_strip_def){ .size = size, .capacity = 1, .search = (1u << 28) + 1 }, 0,
              "too much search");
    check_def((dpt_strip_def){ .size = size, .capacity = 1, .reserved = 1 }, 0, "reserved");
    CHECK(dpt_strip_bytes(NULL) == 0, "no def");
    const size_t bytes = dpt_strip_bytes(&good);
    CHECK(bytes <= sizeof block - 8, "%zu", bytes);
    const dpt_strip_def empty = { .size = size }, short_size = { .size = 4, .capacity = 1 };
    CHECK(dpt_strip_create(block, bytes - 1, &good, &strip) == DPT_E_MEMORY, "too small");
    CHECK(dpt_strip_create((char *)block + 4, bytes, &good, &strip) == DPT_E_ALIGN, "odd");
    CHECK(dpt_strip_create(NULL, bytes, &good, &strip) == DPT_E_ARGUMENT, "no block");
    CHECK(dpt_strip_create(block, bytes, NULL, &strip) == DPT_E_ARGUMENT, "no def");
    CHECK(dpt_strip_create(block, bytes, &good, NULL) == DPT_E_ARGUMENT, "nowhere");
    CHECK(dpt_strip_create(block, sizeof block, &empty, &strip) == DPT_E_ARGUMENT, "no room");
    CHECK(dpt_strip_create(block, sizeof block, &short_size, &strip) == DPT_E_SIZE, "size");
    CHECK(!strip, "written on error");
    CHECK(dpt_strip_create(block, bytes, &good, &strip) == DPT_OK && holds(strip, NULL, 0),
          "not empty");
    CHECK(dpt_strip_create((char *)block + 8, bytes, &good, &strip) == DPT_OK, "aligned to 8");
}

static void bad_arguments(void)
{
    struct subject subject;
    struct held_strip held;
    uint32_t count = 77, flags = 77;
    if (!subject_from_shape(&subject, "torus", 200))
        return;
    dpt_strip *strip = hold_strip(&held, 200, 200);
    CHECK(dpt_strip_triangles(NULL, &count, &flags) == NULL && count == 0, "%u of none", count);
    CHECK(dpt_strip_triangles(NULL, NULL, NULL) == NULL, "nothing of none");
    const struct {
        dpt_strip *strip;
        const dpt_mesh *mesh;
        uint32_t from, to;
    } bad[] = { { NULL, subject.mesh, 0, 1 },         { strip, NULL, 0, 1 },
                { strip, subject.mesh, 200, 1 },      { strip, subject.mesh, 0, 200 },
                { strip, subject.mesh, DPT_NONE, 1 }, { strip, subject.mesh, 0, DPT_NONE } };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(dpt_strip_route(strip, subject.mesh, 0, 100) == DPT_OK, "%zu", i);
        const dpt_result one = dpt_strip_route(bad[i].strip, bad[i].mesh, bad[i].from, bad[i].to);
        CHECK(one == DPT_E_ARGUMENT && (!bad[i].strip || holds(strip, NULL, 0)), "%zu: %s, %s", i,
              dpt_result_name(one), text_of(strip));
        for (int k = 0; k < 2; k++) {
            CHECK(dpt_strip_route(strip, subject.mesh, 0, 100) == DPT_OK, "%zu", i);
            const dpt_result two =
                k ? dpt_strip_routes(bad[i].strip, bad[i].mesh, 5, bad[i].from, bad[i].to)
                  : dpt_strip_routes(bad[i].strip, bad[i].mesh, bad[i].from, 5, bad[i].to);
            CHECK(two == DPT_E_ARGUMENT && (!bad[i].strip || holds(strip, NULL, 0)),
                  "%zu, two routes: %s, %s", i, dpt_result_name(two), text_of(strip));
        }
    }
    drop_strip(&held);
    subject_close(&subject);
}

/* 0 and 1 are joined, 2 is apart, 3 has no area, 4 is 0 again. */
static void errors_of_two_routes(void)
{
    static const double vertices[] = {
        0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0
    };
    static const uint32_t corners[] = { 0, 1, 2, 1, 3, 2, 4, 5, 6, 0, 0, 1, 2, 0, 1 };
    static const struct {
        uint32_t a, b, p;
        dpt_result result;
    } cases[] = { { 0, 1, 0, DPT_OK },
                  { 2, 1, 0, DPT_E_UNREACHABLE },
                  { 1, 2, 0, DPT_E_UNREACHABLE },
                  { 0, 1, 2, DPT_E_UNREACHABLE },
                  { 2, 2, 2, DPT_OK },
                  { 3, 1, 0, DPT_E_DROPPED },
                  { 0, 4, 0, DPT_E_DROPPED },
                  { 0, 1, 3, DPT_E_DROPPED },
                  { 4, 4, 4, DPT_E_DROPPED } };
    struct subject subject;
    struct held_strip held;
    if (!subject_from_arrays(&subject, "apart", vertices, 7, corners, 5))
        return;
    dpt_strip *strip = hold_strip(&held, 8, 7);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK(dpt_strip_route(strip, subject.mesh, 0, 1) == DPT_OK, "0 to 1");
        const dpt_result result =
            dpt_strip_routes(strip, subject.mesh, cases[i].a, cases[i].b, cases[i].p);
        CHECK(result == cases[i].result && (result == DPT_OK || holds(strip, NULL, 0)),
              "%u and %u to %u: %s, %s", cases[i].a, cases[i].b, cases[i].p,
              dpt_result_name(result), text_of(strip));
    }
    drop_strip(&held);
    subject_close(&subject);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    if (argc > 1)
        factor = strtoull(argv[1], NULL, 10);
    if (factor < 1 || factor > 10000) {
        printf("test_route: from 1 to 10000 times as many pairs\n");
        return 2;
    }
    TEST(oracles_agree);
    TEST(the_papers_figure);
    TEST(two_vertices_go_before_one);
    TEST(generated_shapes);
    TEST(random_lattices);
    TEST(hubs);
    TEST(books);
    if (data)
        TEST(public_meshes);
    else
        SKIP("routes on public meshes", "DPT_DATA does not name the data folder");
    TEST(many_pairs);
    TEST(by_table);
    TEST(too_small);
    TEST(two_routes);
    TEST(bad_defs);
    TEST(bad_arguments);
    TEST(errors_of_two_routes);
    return check_report();
}
