/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Routes of triangles: the paper's Figure 6 as a mesh; lengths and the very routes against a breadth-first search over
 * all triangles, and that search against a plainer one.
 *
 *     test_route [PER CENT]   of 10^5 pairs; real meshes from DPT_DATA
 */
#include "strip/route_scene.h"

static const char *data;

static struct tally {
    size_t meshes, pairs, longest, dropped, unreachable;
} all;

enum { FROM = 64 };

static void try_pairs(const struct subject *subject, uint64_t pairs, uint64_t seed)
{
    struct route_scene scene;
    const uint32_t count = subject->info.source_triangles;
    size_t longest = 0;
    route_scene_open(&scene, subject);
    for (uint64_t i = 0; i < part_of((pairs + FROM - 1) / FROM); i++) {
        const uint32_t to = (uint32_t)(random_bits(&seed) % count);
        oracle_route_tau(&subject->surface, to, scene.tau);
        for (uint32_t k = 0; k < FROM; k++) {
            const uint32_t from = k == 0  ? to
                                  : k % 2 ? triangle_nearby(&subject->surface, to, &seed)
                                          : (uint32_t)(random_bits(&seed) % count);
            const dpt_result result = dpt_strip_route(scene.strip, subject->mesh, from, to);
            check_answer(&scene, from, to, result, "route");
            const dpt_result wanted = expected_result(&scene, from, to);
            all.pairs++;
            all.dropped += wanted == DPT_E_DROPPED;
            all.unreachable += wanted == DPT_E_UNREACHABLE;
            if (wanted != DPT_OK)
                continue;
            longest = scene.tau[from] > longest ? scene.tau[from] : longest;
            if (k % 8 == 3)
                CHECK(length_of(&scene, to, from) == scene.tau[from] + 1, "%s: %u to %u is not as far as back",
                      subject->name, from, to);
            if (k % 8 == 4) {
                const uint32_t by = triangle_nearby(&subject->surface, from, &seed);
                CHECK(length_of(&scene, from, by) + length_of(&scene, by, to) > scene.tau[from] + 1,
                      "%s: %u to %u is nearer by %u", subject->name, from, to, by);
            }
        }
    }
    printf("    %-30s %6u triangles, tau up to %zu\n", subject->name, subject->info.triangles, longest);
    all.longest = longest > all.longest ? longest : all.longest;
    all.meshes++;
    route_scene_close(&scene);
}

/*
 * A triangular lattice of points (x, y). A cell is the triangle (x, y), (x + 1, y), (x, y + 1), or the one `down`
 * beside it, (x + 1, y), (x + 1, y + 1), (x, y + 1).
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

static int subject_from_cells(struct subject *subject, const char *name, const struct cell *cells, uint32_t count)
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
 * The paper's Figure 6, by its caption: letters are the order in the array, C is 3 from W, of its neighbours A and E
 * are nearest to W, and the route is C, A, V, W. Here C = (0, 0), (-1, 0), (-1, 1) and W = (2, 0), (3, 0), (2, 1) are
 * such that only the edges (0, 0) to (1, 0), between A and E, and (1, 0) to (2, 0), between V and X, lead from one to
 * the other in so few steps.
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
    struct route_scene scene;
    char near[32] = "";
    if (!subject_from_cells(&subject, "figure 6", cells, COUNT))
        return;
    CHECK(subject.info.triangles == COUNT && subject.info.components == 1, "%u triangles, %u parts",
          subject.info.triangles, subject.info.components);
    route_scene_open(&scene, &subject);
    oracle_route_tau(&subject.surface, w, scene.tau);
    CHECK(scene.tau[c] == 3, "C is %u from W", scene.tau[c]);
    for (uint32_t i = 0, n = 0; i < COUNT; i++)
        if (oracle_surface_common(&subject.surface, c, i) && scene.tau[i] == 2)
            near[n++] = (char)('A' + i);
    CHECK(strcmp(near, "AE") == 0, "nearest to W of C's neighbours: %s", near);
    CHECK(oracle_route(&subject.surface, scene.tau, c, scene.route) == 4 &&
              memcmp(scene.route, route, sizeof route) == 0,
          "%u %u %u %u", scene.route[0], scene.route[1], scene.route[2], scene.route[3]);
    const dpt_result result = dpt_strip_route(scene.strip, subject.mesh, c, w);
    CHECK(result == DPT_OK && strip_is(scene.strip, route, 4), "%s, %s", dpt_result_name(result),
          strip_text(scene.strip));
    route_scene_close(&scene);
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
    struct route_scene scene;
    if (!subject_from_cells(&subject, "fan", cells, 4))
        return;
    route_scene_open(&scene, &subject);
    CHECK(dpt_strip_route(scene.strip, subject.mesh, 0, 3) == DPT_OK && strip_is(scene.strip, near, 2), "%s",
          strip_text(scene.strip));
    route_scene_close(&scene);
    subject_close(&subject);
    if (!subject_from_cells(&subject, "edge", apart, 4))
        return;
    route_scene_open(&scene, &subject);
    oracle_route_tau(&subject.surface, 3, scene.tau);
    CHECK(oracle_surface_common(&subject.surface, 0, 1) == 1 && oracle_surface_common(&subject.surface, 0, 2) == 2,
          "laid out otherwise");
    CHECK(scene.tau[0] == 2 && scene.tau[1] == 1 && scene.tau[2] == 1, "%u %u %u", scene.tau[0], scene.tau[1],
          scene.tau[2]);
    CHECK(dpt_strip_route(scene.strip, subject.mesh, 0, 3) == DPT_OK && strip_is(scene.strip, far, 3), "%s",
          strip_text(scene.strip));
    route_scene_close(&scene);
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
static uint32_t plain_next(const unsigned char *common, uint32_t count, const uint32_t *tau, uint32_t c)
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
        dpt_mesh_get_triangle(subject->mesh, i, corners + 9 * (size_t)i);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < count; j++)
            if (is_there(subject, i) && is_there(subject, j))
                common[i * count + j] = (unsigned char)touch(corners + 9 * (size_t)i, corners + 9 * (size_t)j);
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
            CHECK(next == plain_next(common, count, plain, c), "%s, %u to %u: %u", subject->name, c, to, next);
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
    } shapes[] = { { "torus", 32, 256 },      { "torus", 5568, 4096 },  { "liver", 50332, 2048 },
                   { "membrane", 512, 4096 }, { "cloth", 20000, 2048 }, { "star", 20480, 2048 },
                   { "sphere", 20, 256 },     { "box", 1200, 2048 },    { "stomach", 20001, 1024 } };
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
        if (subject_from_lattice(&subject, size, points / 4 + (uint32_t)(seed / 6) * points / 4, seed))
            try_pairs(&subject, 1024, seed);
        subject_close(&subject);
    }
    CHECK(all.dropped > least_seen(100) && all.unreachable > least_seen(1000), "%zu dropped, %zu unreachable",
          all.dropped, all.unreachable);
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
    if (subject_from_arrays(&subject, "book", vertices, PAGES * ROW * ROW, corners, 2 * PAGES * SIDE * SIDE)) {
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
    printf("    %zu meshes, %zu pairs: %zu dropped, %zu unreachable, tau up to %zu\n", all.meshes, all.pairs,
           all.dropped, all.unreachable, all.longest);
    CHECK(all.pairs >= part_of(data ? 100000 : 40000) && all.longest >= 100, "%zu pairs, %zu", all.pairs, all.longest);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    take_percent(argc, argv);
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
    return check_report();
}
