/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Routes in strips: by the table of distances; what a strip, or a search, that is too small does; two routes in one;
 * and arguments that are none.
 */
#include "strip/route_scene.h"

enum { FROM = 64 };

static void try_table(const struct subject *subject, uint64_t pairs, uint64_t seed)
{
    const uint32_t count = subject->info.source_triangles;
    uint32_t there = 0;
    const size_t bytes = dpt_route_table_bytes(subject->mesh);
    unsigned char *block = malloc(bytes + 8);
    const dpt_route_table *table = NULL;
    struct route_scene scene;
    route_scene_open(&scene, subject);
    guarded_strip_close(&scene.block);
    scene.strip = guarded_strip_open(&scene.block, count, 0);
    memset(block + bytes, 0x5a, 8);
    const dpt_result made = dpt_route_table_create(block, bytes, subject->mesh, &table);
    CHECK(bytes > 0 && made == DPT_OK && table, "%s: %zu bytes, %s", subject->name, bytes, dpt_result_name(made));
    for (uint64_t i = 0; i < pairs / FROM && made == DPT_OK; i++) {
        const uint32_t to = (uint32_t)(random_bits(&seed) % count);
        oracle_route_tau(&subject->surface, to, scene.tau);
        for (uint32_t k = 0; k < FROM; k++) {
            const uint32_t from = k == 0  ? to
                                  : k % 2 ? triangle_nearby(&subject->surface, to, &seed)
                                          : (uint32_t)(random_bits(&seed) % count);
            check_answer(&scene, from, to, dpt_strip_route_by_table(scene.strip, table, from, to), "table");
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
    CHECK(dpt_strip_route_by_table(scene.strip, NULL, there, there) == DPT_E_ARGUMENT, "no table");
    CHECK(dpt_strip_route_by_table(scene.strip, table, count, there) == DPT_E_ARGUMENT, "from");
    CHECK(dpt_strip_route_by_table(scene.strip, table, there, DPT_NONE) == DPT_E_ARGUMENT, "to");
    route_scene_close(&scene);
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
        CHECK(dpt_route_table_create(block, sizeof block, subject.mesh, &table) != DPT_OK && !table, "made for 10,002");
    }
    subject_close(&subject);
    CHECK(dpt_route_table_bytes(NULL) == 0, "for no mesh");
}

/* Too small. */

/* A strip of less capacity holds the beginning, and says that there is more. */
static void check_cut(const struct route_scene *scene, uint32_t from, uint32_t to, uint32_t length)
{
    const uint32_t tries[] = { 1, 2, 3, length / 2, length - 1, length, length + 1 };
    for (size_t i = 0; i < sizeof tries / sizeof *tries; i++) {
        const uint32_t capacity = tries[i] ? tries[i] : 1;
        const uint32_t held_count = capacity < length ? capacity : length;
        struct guarded_strip guarded;
        uint32_t count = 0, flags = 0;
        dpt_strip *strip = guarded_strip_open(&guarded, capacity, scene->subject->info.vertices);
        const dpt_result result = dpt_strip_route(strip, scene->subject->mesh, from, to);
        const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
        CHECK(result == DPT_OK && count == held_count && flags == (capacity < length ? DPT_STRIP_FLAG_FULL : 0u),
              "%s, %u to %u, of %u in room for %u: %s, %u, flags %u", scene->subject->name, from, to, length, capacity,
              dpt_result_name(result), count, flags);
        CHECK(count <= length && memcmp(triangles, scene->route, count * sizeof *triangles) == 0,
              "%s, %u to %u, room for %u: %s", scene->subject->name, from, to, capacity, strip_text(strip));
        guarded_strip_close(&guarded);
    }
}

/* A search of less room finds the route or says that it cannot. */
static void check_search(const struct route_scene *scene, uint32_t from, uint32_t to, uint32_t length, size_t *full,
                         size_t *found)
{
    const uint32_t vertices = scene->subject->info.vertices;
    for (uint32_t search = 0; search <= vertices; search = search < 8 ? search + 1 : search + search / 4) {
        struct guarded_strip guarded;
        dpt_strip *strip = guarded_strip_open(&guarded, length, search);
        const dpt_result result = dpt_strip_route(strip, scene->subject->mesh, from, to);
        CHECK(result == DPT_OK ? strip_is(strip, scene->route, length)
                               : result == DPT_E_FULL && strip_is(strip, NULL, 0),
              "%s, %u to %u, search %u: %s, %s", scene->subject->name, from, to, search, dpt_result_name(result),
              strip_text(strip));
        if (length > 3 && search == 0)
            CHECK(result == DPT_E_FULL, "%s, %u to %u without a search", scene->subject->name, from, to);
        *full += result == DPT_E_FULL;
        *found += result == DPT_OK;
        guarded_strip_close(&guarded);
    }
}

static void too_small(void)
{
    size_t full = 0, found = 0;
    for (uint64_t kind = 0; kind < 3; kind++) {
        struct subject subject;
        struct route_scene scene;
        uint64_t seed = kind;
        if (!(kind == 0   ? subject_from_shape(&subject, "torus", 2000)
              : kind == 1 ? subject_from_shape(&subject, "cloth", 1152)
                          : subject_with_hub(&subject, 200, 100)))
            continue;
        route_scene_open(&scene, &subject);
        for (int i = 0; i < 100; i++) {
            const uint32_t from = (uint32_t)(random_bits(&seed) % subject.info.triangles);
            const uint32_t to = i % 8 ? (uint32_t)(random_bits(&seed) % subject.info.triangles) : from;
            oracle_route_tau(&subject.surface, to, scene.tau);
            const uint32_t length = oracle_route(&subject.surface, scene.tau, from, scene.route);
            check_cut(&scene, from, to, length);
            check_search(&scene, from, to, length, &full, &found);
        }
        route_scene_close(&scene);
        subject_close(&subject);
    }
    printf("    searches: %zu full, %zu found\n", full, found);
    CHECK(full > 300 && found > 300, "%zu full, %zu found", full, found);
}

/*
 * The routes from a and b to p in one strip: each of their triangles once; in `few`, which has room for 5, five of
 * them. `wanted` is 0 for every triangle before and after.
 */
static void check_two_routes(struct route_scene *scene, dpt_strip *few, unsigned char *wanted, const uint32_t ends[3],
                             size_t *shared, size_t *cut)
{
    const struct subject *subject = scene->subject;
    const uint32_t a = ends[0], b = ends[1], p = ends[2];
    uint32_t both = 0, count = 0, flags = 0;
    oracle_route_tau(&subject->surface, p, scene->tau);
    const uint32_t m = oracle_route(&subject->surface, scene->tau, a, scene->route);
    const uint32_t n = oracle_route(&subject->surface, scene->tau, b, scene->back);
    for (uint32_t k = 0; k < m + n; k++) {
        unsigned char *once = &wanted[k < m ? scene->route[k] : scene->back[k - m]];
        both += !*once;
        *once = 1;
    }
    const dpt_result result = dpt_strip_routes(scene->strip, subject->mesh, a, b, p);
    const uint32_t *got = dpt_strip_get_triangles(scene->strip, &count, &flags);
    CHECK(result == DPT_OK && count == both && flags == 0, "%s, %u and %u to %u: %s, %u triangles, not %u, flags %u",
          subject->name, a, b, p, dpt_result_name(result), count, both, flags);
    for (uint32_t k = 0; k < count; k++) {
        CHECK(wanted[got[k]] == 1, "%s, %u and %u to %u: %u is twice, or not on them", subject->name, a, b, p, got[k]);
        wanted[got[k]] = 2;
    }
    const dpt_result cut_result = dpt_strip_routes(few, subject->mesh, a, b, p);
    got = dpt_strip_get_triangles(few, &count, &flags);
    CHECK(cut_result == DPT_OK && count == (both < 5 ? both : 5) && flags == (both > 5 ? DPT_STRIP_FLAG_FULL : 0u),
          "%s, %u and %u to %u, of %u: %s, %u triangles, flags %u", subject->name, a, b, p, both,
          dpt_result_name(cut_result), count, flags);
    for (uint32_t k = 0; k < count; k++) {
        CHECK(wanted[got[k]] == 2, "%s, %u and %u to %u: %u is twice, or not on them", subject->name, a, b, p, got[k]);
        wanted[got[k]] = 3;
    }
    for (uint32_t k = 0; k < m + n; k++)
        wanted[k < m ? scene->route[k] : scene->back[k - m]] = 0;
    *shared += both + 1 < m + n;
    *cut += both > 5;
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
        struct route_scene scene;
        struct guarded_strip small;
        uint64_t seed = s;
        if (!subject_from_shape(&subject, shapes[s].name, shapes[s].count))
            continue;
        route_scene_open(&scene, &subject);
        dpt_strip *few = guarded_strip_open(&small, 5, subject.info.vertices);
        unsigned char *wanted = calloc(subject.info.source_triangles, 1);
        for (int i = 0; i < 300; i++) {
            const uint32_t p = (uint32_t)(random_bits(&seed) % subject.info.triangles);
            const uint32_t a = triangle_nearby(&subject.surface, p, &seed);
            const uint32_t b = i % 4   ? triangle_nearby(&subject.surface, p, &seed)
                               : i % 8 ? a
                                       : (uint32_t)(random_bits(&seed) % subject.info.triangles);
            check_two_routes(&scene, few, wanted, (const uint32_t[3]){ a, b, p }, &shared, &cut);
        }
        free(wanted);
        guarded_strip_close(&small);
        route_scene_close(&scene);
        subject_close(&subject);
    }
    CHECK(shared > 100 && cut > 100, "%zu share more than the end, %zu cut", shared, cut);
}

/* Arguments. */

static void check_def(dpt_strip_def def, int valid, const char *what)
{
    CHECK((dpt_strip_bytes(&def) > 0) == valid, "%s: %zu bytes", what, dpt_strip_bytes(&def));
    if (valid)
        CHECK(dpt_strip_bytes(&def) <= 1024 + 96 * (size_t)def.capacity + 36 * (size_t)def.search, "%s: %zu bytes",
              what, dpt_strip_bytes(&def));
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
    check_def((dpt_strip_def){ .size = size, .capacity = 1, .search = (1u << 28) + 1 }, 0, "too much search");
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
    CHECK(dpt_strip_create(block, bytes, &good, &strip) == DPT_OK && strip_is(strip, NULL, 0), "not empty");
    CHECK(dpt_strip_create((char *)block + 8, bytes, &good, &strip) == DPT_OK, "aligned to 8");
}

static void bad_arguments(void)
{
    struct subject subject;
    struct guarded_strip guarded;
    uint32_t count = 77, flags = 77;
    if (!subject_from_shape(&subject, "torus", 200))
        return;
    dpt_strip *strip = guarded_strip_open(&guarded, 200, 200);
    CHECK(dpt_strip_get_triangles(NULL, &count, &flags) == NULL && count == 0, "%u of none", count);
    CHECK(dpt_strip_get_triangles(NULL, NULL, NULL) == NULL, "nothing of none");
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
        CHECK(one == DPT_E_ARGUMENT && (!bad[i].strip || strip_is(strip, NULL, 0)), "%zu: %s, %s", i,
              dpt_result_name(one), strip_text(strip));
        for (int k = 0; k < 2; k++) {
            CHECK(dpt_strip_route(strip, subject.mesh, 0, 100) == DPT_OK, "%zu", i);
            const dpt_result two = k ? dpt_strip_routes(bad[i].strip, bad[i].mesh, 5, bad[i].from, bad[i].to)
                                     : dpt_strip_routes(bad[i].strip, bad[i].mesh, bad[i].from, 5, bad[i].to);
            CHECK(two == DPT_E_ARGUMENT && (!bad[i].strip || strip_is(strip, NULL, 0)), "%zu, two routes: %s, %s", i,
                  dpt_result_name(two), strip_text(strip));
        }
    }
    guarded_strip_close(&guarded);
    subject_close(&subject);
}

/* 0 and 1 are joined, 2 is apart, 3 has no area, 4 is 0 again. */
static void errors_of_two_routes(void)
{
    static const double vertices[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0 };
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
    struct guarded_strip guarded;
    if (!subject_from_arrays(&subject, "apart", vertices, 7, corners, 5))
        return;
    dpt_strip *strip = guarded_strip_open(&guarded, 8, 7);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK(dpt_strip_route(strip, subject.mesh, 0, 1) == DPT_OK, "0 to 1");
        const dpt_result result = dpt_strip_routes(strip, subject.mesh, cases[i].a, cases[i].b, cases[i].p);
        CHECK(result == cases[i].result && (result == DPT_OK || strip_is(strip, NULL, 0)), "%u and %u to %u: %s, %s",
              cases[i].a, cases[i].b, cases[i].p, dpt_result_name(result), strip_text(strip));
    }
    guarded_strip_close(&guarded);
    subject_close(&subject);
}

int main(void)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    TEST(by_table);
    TEST(too_small);
    TEST(two_routes);
    TEST(bad_defs);
    TEST(bad_arguments);
    TEST(errors_of_two_routes);
    return check_report();
}
