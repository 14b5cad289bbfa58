/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The compiler on several threads: the same bytes for every number of them, also where the system refuses some or
 * all, or memory ends in one; none too many, none left. The calls that make and join threads and take memory go
 * through this file (--wrap of the linker).
 */
#include <pthread.h>

#include "compile/compile_context.h"
#include "compile/lattice.h"
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "scene/shape.h"

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attr, void *(*start)(void *), void *argument);
int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attr, void *(*start)(void *), void *argument);
int __wrap_pthread_join(pthread_t thread, void **result);
int __real_pthread_join(pthread_t thread, void **result);
void *__wrap_malloc(size_t size);
void *__real_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__real_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__real_realloc(void *old, size_t size);
void __wrap_free(void *block);
void __real_free(void *block);

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static long asked, made, alive, most_alive, blocks, allocations_left = -1;
static uint64_t granted = UINT64_MAX; /* bit k: the system grants thread k, and k + 64 */

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attr, void *(*start)(void *), void *argument)
{
    pthread_mutex_lock(&lock);
    int code = granted >> asked++ % 64 & 1 ? 0 : 11; /* EAGAIN */
    if (code == 0)
        code = __real_pthread_create(thread, attr, start, argument);
    made += code == 0;
    alive += code == 0;
    most_alive = alive > most_alive ? alive : most_alive;
    pthread_mutex_unlock(&lock);
    return code;
}

int __wrap_pthread_join(pthread_t thread, void **result)
{
    int code = __real_pthread_join(thread, result);
    pthread_mutex_lock(&lock);
    alive -= code == 0;
    pthread_mutex_unlock(&lock);
    return code;
}

static int may_allocate(void)
{
    if (allocations_left > 0)
        allocations_left--;
    return allocations_left != 0;
}

void *__wrap_malloc(size_t size)
{
    pthread_mutex_lock(&lock);
    void *block = may_allocate() ? __real_malloc(size) : NULL;
    blocks += block != NULL;
    pthread_mutex_unlock(&lock);
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    pthread_mutex_lock(&lock);
    void *block = may_allocate() ? __real_calloc(count, size) : NULL;
    blocks += block != NULL;
    pthread_mutex_unlock(&lock);
    return block;
}

void *__wrap_realloc(void *old, size_t size)
{
    pthread_mutex_lock(&lock);
    void *block = may_allocate() ? __real_realloc(old, size) : NULL;
    blocks += block != NULL && old == NULL;
    pthread_mutex_unlock(&lock);
    return block;
}

void __wrap_free(void *block)
{
    pthread_mutex_lock(&lock);
    blocks -= block != NULL;
    pthread_mutex_unlock(&lock);
    __real_free(block);
}

static void forget_threads(void)
{
    asked = made = alive = most_alive = 0;
}

/* How often a loop came to each item; the pieces, by their first item. */
#define ITEMS 1000u
struct visits {
    uint32_t count[ITEMS], ends[ITEMS];
    int of_caller[ITEMS];
    pthread_t caller;
};

static void visit(void *context, size_t first, size_t end)
{
    struct visits *visits = context;
    for (size_t i = first; i < end; i++)
        visits->count[i]++;
    if (first < end) {
        visits->ends[first] = (uint32_t)end;
        visits->of_caller[first] = pthread_equal(pthread_self(), visits->caller) != 0;
    }
}

static void a_loop_does_each_item_once(void)
{
    const uint32_t threads[] = { 0, 1, 2, 3, 7, 64, 65, UINT32_MAX };
    const uint64_t grants[] = { UINT64_MAX, 0, 0xaaaaaaaaaaaaaaaau, 1 };
    for (size_t n = 0; n < sizeof threads / sizeof *threads; n++)
        for (uint32_t count = 0; count <= ITEMS; count += 1 + count / 3)
            for (uint32_t least = 1; least <= 300; least = 3 * least + 1)
                for (size_t g = 0; g < sizeof grants / sizeof *grants; g++) {
                    struct visits visits = { .caller = pthread_self() };
                    uint32_t pieces = 0, wrong = 0, small = 0, most = threads[n] ? threads[n] : 1;
                    most = most < 64 ? most : 64;
                    forget_threads();
                    granted = grants[g];
                    parallel_for(threads[n], count, least, visit, &visits);
                    granted = UINT64_MAX;
                    for (uint32_t i = 0; i < count; i++)
                        wrong += visits.count[i] != 1;
                    for (uint32_t i = 0; i < count && visits.ends[i]; i = visits.ends[i]) {
                        pieces++;
                        small += visits.ends[i] - i < least;
                    }
                    CHECK(wrong == 0, "%u of %u items not once", wrong, count);
                    CHECK(count == 0 || visits.of_caller[0], "the first piece is the caller's");
                    CHECK(pieces <= most && (pieces <= 1 || small == 0), "%u pieces, %u small", pieces, small);
                    CHECK(count / least < 2 || pieces == (count / least < most ? count / least : most),
                          "%u pieces of %u by %u", pieces, count, least);
                    CHECK(asked == (pieces ? pieces : 1) - 1 && alive == 0, "%ld threads, %ld left", asked, alive);
                }
}

/*
 * Boxes in a row of rows: some with a hole, some with a side or two left, some inside others or cutting their
 * neighbours.
 */
static int make_boxes(uint32_t side, struct shape *shape)
{
    static const uint32_t corners[12][3] = { { 0, 2, 1 }, { 0, 3, 2 }, { 4, 5, 6 }, { 4, 6, 7 },
                                             { 0, 1, 5 }, { 0, 5, 4 }, { 1, 2, 6 }, { 1, 6, 5 },
                                             { 2, 3, 7 }, { 2, 7, 6 }, { 3, 0, 4 }, { 3, 4, 7 } };
    const size_t boxes = (size_t)2 * side * side * side;
    if (shape_begin(shape, 8 * boxes, 12 * boxes))
        return -1;
    for (uint32_t i = 0; i < boxes; i++) {
        const uint32_t at = i / 2, inner = i % 2;
        const double size = inner    ? 0.25
                            : at % 7 ? 0.45
                                     : 0.55,
                     x = at % side, y = at / side % side, z = at / side / side;
        for (uint32_t c = 0; c < 8; c++)
            shape_add_vertex(shape, x + (c % 4 == 1 || c % 4 == 2 ? size : -size), y + (c % 4 >= 2 ? size : -size),
                             z + (c >= 4 ? size : -size));
        for (uint32_t t = at % 11 == 0 ? 8 : at % 3 == 0; t < 12; t++)
            shape_add_triangle(shape, 8 * i + corners[t][0], 8 * i + corners[t][at % 5 ? 1 : 2],
                               8 * i + corners[t][at % 5 ? 2 : 1]);
    }
    return 0;
}

/* Triangles anywhere, of 300 vertices: every edge non-manifold, or nearly. */
static int make_soup(uint32_t count, struct shape *shape)
{
    uint64_t random = 5;
    if (shape_begin(shape, 300, count))
        return -1;
    for (uint32_t v = 0; v < 300; v++)
        shape_add_vertex(shape, random_in(&random, -1, 1), random_in(&random, -1, 1), random_in(&random, -1, 1));
    for (uint32_t t = 0; t < count; t++)
        shape_add_triangle(shape, random_bits(&random) % 300, random_bits(&random) % 300, random_bits(&random) % 300);
    return 0;
}

static int make(const char *name, uint32_t count, struct shape *shape)
{
    shape_reason reason;
    if (!strcmp(name, "boxes"))
        return make_boxes(count, shape);
    if (!strcmp(name, "soup"))
        return make_soup(count, shape);
    return shape_make(name, count, 0, shape, reason);
}

static dpt_result compile(const struct shape *shape, uint32_t threads, dpt_compiled *out)
{
    dpt_compile_def def = { .size = sizeof def, .threads = threads };
    forget_threads();
    return dpt_compile_arrays(shape->vertices, shape->vertex_count, shape->corners, shape->triangle_count, &def, out,
                              NULL);
}

static int same(const dpt_compiled *a, const dpt_compiled *b)
{
    return a->bytes && b->bytes && a->size == b->size && !memcmp(a->bytes, b->bytes, a->size);
}

static const struct {
    const char *name;
    uint32_t count;
} shapes[] = {
    { "membrane", 2 }, { "hub", 3 },        { "box", 12 },      { "torus", 96 },     { "torus", 4096 },
    { "torus", 8190 }, { "torus", 8192 },   { "torus", 65538 }, { "stomach", 9001 }, { "membrane", 20000 },
    { "hub", 30001 },  { "star", 20480 },   { "boxes", 2 },     { "boxes", 12 },     { "soup", 400 },
    { "soup", 30000 }, { "torus", 300000 },
};

/* Large shapes take most of the time. */
static int is_left_out(uint32_t count)
{
    return check_percent < 100 && count > part_of(100000);
}

static void bytes_do_not_depend_on_threads(void)
{
    const uint32_t threads[] = { 2, 3, 7, 64, UINT32_MAX };
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct shape shape;
        dpt_compiled one, many;
        if (is_left_out(shapes[i].count))
            continue;
        if (make(shapes[i].name, shapes[i].count, &shape)) {
            CHECK(0, "no %s", shapes[i].name);
            continue;
        }
        CHECK(compile(&shape, 1, &one) == DPT_OK && asked == 0, "%s %u: %ld threads for 1", shapes[i].name,
              shapes[i].count, asked);
        for (size_t n = 0; n < sizeof threads / sizeof *threads; n++) {
            long most = threads[n] < 64 ? threads[n] : 64;
            CHECK(compile(&shape, threads[n], &many) == DPT_OK && same(&one, &many),
                  "%s %u: other bytes with %u threads", shapes[i].name, shapes[i].count, threads[n]);
            CHECK(alive == 0 && most_alive < most, "%ld threads at once with %u, %ld left", most_alive + 1, threads[n],
                  alive);
            CHECK(shape.triangle_count < 1000 ? asked == 0 : shape.triangle_count < 2 * PARALLEL_MIN || made > 0,
                  "%s %u: %ld threads made", shapes[i].name, shapes[i].count, made);
            CHECK(shape.triangle_count < 64 * PARALLEL_MIN || most < 64 || most_alive == 63, "%ld threads at once",
                  most_alive + 1);
            dpt_compiled_free(&many);
        }
        dpt_compiled_free(&one);
        shape_free(&shape);
    }
}

/* As an STL: the hash beside the reader. */
static void a_file_is_read_and_hashed(void)
{
    const size_t count = 3000, size = 84 + 50 * count;
    unsigned char *stl = calloc(1, size);
    const uint32_t announced = (uint32_t)count;
    uint64_t random = 3;
    memcpy(stl + 80, &announced, 4);
    for (size_t t = 0; t < count; t++)
        for (size_t k = 0; k < 9; k++) {
            float x = (float)random_in(&random, -1, 1);
            memcpy(stl + 84 + 50 * t + 12 + 4 * k, &x, 4);
        }
    dpt_compile_def def = { .size = sizeof def };
    dpt_compiled one, two;
    CHECK(dpt_compile_bytes(stl, size, &def, &one, NULL) == DPT_OK, "one thread");
    def.threads = 2;
    forget_threads();
    CHECK(dpt_compile_bytes(stl, size, &def, &two, NULL) == DPT_OK && same(&one, &two) && made > 0,
          "other bytes, with %ld threads", made);
    dpt_compiled_free(&two);
    stl[84 + 12 + 3] = 0x7f; /* no longer finite */
    stl[84 + 12 + 2] = 0xff;
    dpt_diag diag = { .size = sizeof diag };
    CHECK(dpt_compile_bytes(stl, size, &def, &two, &diag) == DPT_E_FINITE && diag.byte == 96 && alive == 0, "%s at %u",
          diag.text, (unsigned)diag.byte);
    dpt_compiled_free(&one);
    free(stl);
}

static void refused_threads_change_nothing(void)
{
    const uint64_t grants[] = { 0, 1, 0xaaaaaaaaaaaaaaaau, 0x5555555555555555u, 0x00ff00ff00ff00ffu };
    const struct {
        const char *name;
        uint32_t count;
    } some[] = { { "torus", 65538 }, { "boxes", 12 }, { "stomach", 9001 } };
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        struct shape shape;
        dpt_compiled one, many;
        if (is_left_out(some[i].count) || make(some[i].name, some[i].count, &shape))
            continue;
        CHECK(compile(&shape, 1, &one) == DPT_OK, "%s", some[i].name);
        for (size_t g = 0; g < sizeof grants / sizeof *grants; g++) {
            long refused = 0;
            for (uint32_t threads = 2; threads <= (check_percent < 100 ? 7 : 64); threads = 3 * threads + 1) {
                granted = grants[g];
                dpt_result result = compile(&shape, threads, &many);
                granted = UINT64_MAX;
                CHECK(result == DPT_OK && same(&one, &many) && alive == 0 && (made == 0) == (grants[g] == 0),
                      "%s: %d with %ld of %ld threads", some[i].name, result, made, asked);
                refused += asked - made;
                dpt_compiled_free(&many);
            }
            CHECK(refused > 0, "%s: none refused", some[i].name);
        }
        dpt_compiled_free(&one);
        shape_free(&shape);
    }
}

/* An allocation here or there fails, in whichever thread asks for it. */
static void memory_that_ends_in_a_thread_is_told(void)
{
    struct shape shape;
    dpt_compiled out;
    dpt_result result = DPT_E_MEMORY;
    const double low[3] = { -1, -1, -1 }, high[3] = { 10, 10, 10 };
    dpt_compile_def def = { .size = sizeof def, .threads = 5 };
    struct lattice lattice;
    int failures = 0;
    if (make("boxes", 10, &shape))
        return;
    lattice_make(&lattice, 5, low, high, 1);
    lattice_use(&lattice, &def);
    for (long fail_at = 1; result != DPT_OK && fail_at < 1000000; fail_at += 1 + fail_at / 8) {
        dpt_diag diag = { .size = sizeof diag };
        long before = blocks;
        forget_threads();
        allocations_left = fail_at;
        result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def, &out,
                                    &diag);
        allocations_left = -1;
        failures += result != DPT_OK;
        CHECK(result == DPT_OK || (result == DPT_E_MEMORY && !out.bytes && !out.size), "allocation %ld: %s", fail_at,
              dpt_result_name(result));
        CHECK(diag.code == result && (result == DPT_OK || diag.text[0]), "allocation %ld: %d", fail_at, diag.code);
        dpt_compiled_free(&out);
        CHECK(blocks == before && alive == 0, "allocation %ld: %ld blocks left, %ld threads", fail_at, blocks - before,
              alive);
    }
    CHECK(result == DPT_OK && failures > 40, "%d failures", failures);
    lattice_free(&lattice);
    shape_free(&shape);
}

struct watch {
    pthread_t caller;
    int calls, stop_at, elsewhere, back;
    char step[16];
    double done;
};

static int watch_progress(void *user, const char *step, double done)
{
    struct watch *watch = user;
    watch->elsewhere += !pthread_equal(pthread_self(), watch->caller);
    watch->back += !strcmp(step, watch->step) && !(done >= watch->done);
    watch->back += !(done >= 0.0 && done <= 1.0);
    snprintf(watch->step, sizeof watch->step, "%s", step);
    watch->done = done;
    return ++watch->calls == watch->stop_at;
}

static void progress_comes_from_the_calling_thread(void)
{
    struct shape shape;
    struct watch watch;
    if (make("torus", check_percent < 100 ? 200000 : 1200000, &shape)) /* a large half and a small one */
        return;
    for (int stop = 0, calls = 1; stop <= calls; stop += 1 + stop) {
        watch = (struct watch){ .caller = pthread_self(), .stop_at = stop };
        dpt_compile_def def = { .size = sizeof def, .threads = 2, .progress = watch_progress, .user = &watch };
        dpt_compiled out;
        forget_threads();
        dpt_result result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count,
                                               &def, &out, NULL);
        calls = stop ? calls : watch.calls;
        CHECK(watch.elsewhere == 0 && watch.back == 0, "%d calls elsewhere, %d back", watch.elsewhere, watch.back);
        CHECK(stop ? result == DPT_E_CANCELLED && watch.calls == stop && !out.bytes : result == DPT_OK && calls > 8,
              "stopped at %d: %d after %d", stop, result, watch.calls);
        CHECK(alive == 0, "%ld threads left", alive);
        dpt_compiled_free(&out);
    }
    shape_free(&shape);
}

static void a_def_without_threads_makes_none(void)
{
    const size_t sizes[] = { offsetof(dpt_compile_def, crease), offsetof(dpt_compile_def, threads),
                             offsetof(dpt_compile_def, recentre), sizeof(dpt_compile_def) };
    struct shape shape;
    if (make("torus", 10000, &shape))
        return;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        dpt_compile_def def = { .size = (uint32_t)sizes[i], .threads = 4 };
        dpt_compiled out;
        forget_threads();
        CHECK(dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def, &out,
                                 NULL) == DPT_OK,
              "size %zu", sizes[i]);
        CHECK((asked > 0) == (sizes[i] > offsetof(dpt_compile_def, threads)), "%ld threads for size %zu", asked,
              sizes[i]);
        dpt_compiled_free(&out);
    }
    dpt_compiled out;
    CHECK(compile(&shape, 0, &out) == DPT_OK && asked == 0, "0 is 1, and not %ld", asked + 1);
    dpt_compiled_free(&out);
    shape_free(&shape);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(a_loop_does_each_item_once);
    TEST(bytes_do_not_depend_on_threads);
    TEST(a_file_is_read_and_hashed);
    TEST(refused_threads_change_nothing);
    TEST(memory_that_ends_in_a_thread_is_told);
    TEST(progress_comes_from_the_calling_thread);
    TEST(a_def_without_threads_makes_none);
    return check_report();
}
