/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The readers of mesh files: the soup, every format, right and wrong files. Numbers are for test_read_numbers.
 *
 *     test_read [GOLDEN]
 *
 * GOLDEN is the folder golden-bad; from the top of the tree it is found without. Its expected.txt
 * says what each file must come to. With DPT_DATA in the environment the files of data-counts.txt
 * are read as well, from there.
 */
#include <inttypes.h>
#include <math.h>

#include "compile/reading.h"

static const char *golden = "tests/golden-bad";

/* Allocations can be made to fail where the C library lets realloc be replaced. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define REPLACED_BY_SANITIZER
#endif
#endif
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) &&                           \
    !defined(REPLACED_BY_SANITIZER)
#define CAN_FAIL_ALLOCATIONS
static long allocations_left = -1;
extern void *__libc_realloc(void *block, size_t size);

void *realloc(void *block, size_t size)
{
    if (allocations_left == 0)
        return NULL;
    if (allocations_left > 0)
        allocations_left--;
    return __libc_realloc(block, size);
}
#endif

static const char *code_name(dpt_result code)
{
#define NAME_OF(name, value, text)                                                                                     \
    if (code == (value))                                                                                               \
        return #name;
    DPT_RESULTS(NAME_OF)
#undef NAME_OF
    return "no code";
}

static uint32_t format_of(const char *path)
{
    return source_format(path, (const unsigned char *)"", 0);
}

/* All bytes of a file; NULL when it is not there. */
static unsigned char *load(const char *folder, const char *name, size_t *size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return NULL;
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    unsigned char *bytes = malloc(*size + 1);
    size_t got = fread(bytes, 1, *size, file);
    fclose(file);
    CHECK(got == *size, "%s", path);
    return bytes;
}

static void read_golden(reading *r, const char *name)
{
    size_t size = 0;
    unsigned char *bytes = load(golden, name, &size);
    read_bytes(r, format_of(name), bytes, size, NULL);
    free(bytes);
}

static const source_location somewhere = { 3, 0 };

static void vertices_are_scaled_and_rounded(void)
{
    dpt_compile_def def = { .size = sizeof def, .scale = 0.001 };
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    soup s;
    compile_context_init(&context, &def, &diag);
    soup_init(&s, &context);
    CHECK(soup_add_vertex(&s, 1.0, -0.0, -1e-60, somewhere) == DPT_OK, "%s", diag.text);
    CHECK(s.positions[0] == (float)0.001, "%g", (double)s.positions[0]);
    CHECK(!signbit(s.positions[1]) && !signbit(s.positions[2]), "a negative zero");
    CHECK(s.rounding == fabs((double)(float)0.001 - 0.001), "%g", s.rounding);
    CHECK(soup_add_vertex(&s, 1e9, -1e9, 0.0, somewhere) == DPT_OK, "%s", diag.text);
    CHECK(soup_add_vertex(&s, 0.0, 1.0001e9, 0.0, somewhere) == DPT_E_FINITE, "too large");
    CHECK(diag.code == DPT_E_FINITE && diag.line == 3 && strstr(diag.text, "y is 1.0001e+09"), "line %" PRIu64 ": %s",
          diag.line, diag.text);
    CHECK(soup_add_vertex(&s, NAN, 0.0, 0.0, (source_location){ 0, 77 }) == DPT_E_FINITE, "nan");
    CHECK(diag.line == 0 && diag.byte == 77, "byte %" PRIu64, diag.byte);
    CHECK(s.vertex_count == 2, "%zu vertices", s.vertex_count);
    soup_free(&s);
}

static void counts_have_limits(void)
{
    const uint32_t corners[4] = { 0, 1, 2, 3 };
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    soup s;
    compile_context_init(&context, NULL, &diag);
    soup_init(&s, &context);
    s.vertex_count = INT32_MAX;
    CHECK(soup_add_vertex(&s, 0.0, 0.0, 0.0, somewhere) == DPT_E_LIMIT, "%s", diag.text);
    s.vertex_count = 0;
    s.triangle_count = s.triangle_capacity = UINT32_MAX / 3 - 1; /* 3 half-edges a triangle */
    CHECK(soup_add_polygon(&s, corners, 4, somewhere) == DPT_E_LIMIT, "%s", diag.text);
    CHECK(soup_add_polygon(&s, corners, SIZE_MAX, somewhere) == DPT_E_LIMIT, "%s", diag.text);
    soup_free(&s);
}

static void polygons_become_fans(void)
{
    reading r;
    read_string(&r, DPT_FORMAT_OBJ, "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3\nf 1 2 3 4 5\nf 5 4 3 2\n");
    static const uint32_t want[] = { 0, 1, 2, 0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 3, 2, 4, 2, 1 };
    CHECK(r.soup.triangle_count == 6, "%zu triangles", r.soup.triangle_count);
    CHECK(memcmp(r.soup.corners, want, sizeof want) == 0, "other corners");
    CHECK(r.soup.polygon_count == 2, "%zu polygons", r.soup.polygon_count);
    CHECK(r.soup.polygons[0].first_triangle == 1 && r.soup.polygons[0].corners == 5, "first");
    CHECK(r.soup.polygons[1].first_triangle == 4 && r.soup.polygons[1].corners == 4, "second");
    CHECK(soup_cut_polygons(&r.soup) == DPT_OK && r.soup.concave_polygons == 0, "none is concave");
    CHECK(memcmp(r.soup.corners, want, sizeof want) == 0, "other corners");
    soup_free(&r.soup);
}

static void concave_polygons_are_counted(void)
{
    static const struct {
        const char *text;
        uint32_t concave;
    } cases[] = { { "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\nf 5 4 3 2 1", 2 },
                  { "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0.5 0.5 0\nf 1 2 3 4\n", 0 }, /* straight */
                  { "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0.5 0.49 0\nf 1 2 3 4\n", 1 },
                  { "v 1e4 0 .3\nv 1e4 .1 .4\nv 1e4 .2 .5\nv 1e4 .3 .6\nv 9e3 0 0\nf 1 2 3 4 5", 0 },
                  { "v 1 1 1\nf 1 1 1 1\n", 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        reading r;
        read_string(&r, DPT_FORMAT_OBJ, cases[i].text);
        CHECK(soup_cut_polygons(&r.soup) == DPT_OK, "case %zu", i);
        uint32_t concave = r.soup.concave_polygons;
        CHECK(r.result == DPT_OK && concave == cases[i].concave, "case %zu: %u", i, concave);
        soup_free(&r.soup);
    }
}

/* Files. */

typedef struct expected {
    char name[200], code[40];
    size_t triangles;
    source_location place;
} expected;

/* One line, "name triangles -" or "name code line|byte number"; 0 when it says nothing. */
static int parse_expected(const char *line, expected *e)
{
    char unit[8] = "-";
    uint64_t number = 0;
    memset(e, 0, sizeof *e);
    if (line[0] == '#' || sscanf(line, "%199s %39s %7s %" SCNu64, e->name, e->code, unit, &number) < 2)
        return 0;
    if (e->code[0] != 'D') {
        e->triangles = (size_t)strtoul(e->code, NULL, 10);
        strcpy(e->code, "DPT_OK");
    }
    *(unit[0] == 'l' ? &e->place.line : &e->place.byte) = number;
    return 1;
}

static int reads_right(const expected *e)
{
    return strcmp(e->code, "DPT_OK") == 0;
}

static void check_outcome(const expected *e, const reading *r, int with_place)
{
    const dpt_diag *diag = &r->diag;
    CHECK(strcmp(code_name(r->result), e->code) == 0, "%s: %s (%s)", e->name, code_name(r->result), diag->text);
    CHECK(r->result != DPT_OK || r->soup.triangle_count == e->triangles, "%s: %zu triangles", e->name,
          r->soup.triangle_count);
    CHECK(r->result == DPT_OK || (diag->code == r->result && diag->text[0] != 0), "%s: no reason", e->name);
    CHECK(!with_place || (diag->line == e->place.line && diag->byte == e->place.byte),
          "%s: line %" PRIu64 ", byte %" PRIu64 " (%s)", e->name, diag->line, diag->byte, diag->text);
}

/* Call `visit` for every line of a table beside the files it speaks of; how many there were. */
typedef void visit_file(const expected *e, const unsigned char *bytes, size_t size);

static int visit_files(const char *folder, const char *table, const char *files, visit_file *visit)
{
    size_t size = 0;
    int count = 0;
    char *text = (char *)load(folder, table, &size);
    if (text == NULL)
        return 0;
    text[size] = 0;
    for (char *line = strtok(text, "\r\n"); line != NULL; line = strtok(NULL, "\r\n")) {
        expected e;
        size_t length = 0;
        if (!parse_expected(line, &e))
            continue;
        unsigned char *bytes = load(files, e.name, &length);
        CHECK(bytes != NULL, "%s is missing", e.name);
        if (bytes != NULL)
            visit(&e, bytes, length);
        free(bytes);
        count++;
    }
    free(text);
    return count;
}

static void check_golden(const expected *e, const unsigned char *bytes, size_t size)
{
    reading r;
    read_bytes(&r, format_of(e->name), bytes, size, NULL);
    check_outcome(e, &r, 1);
    soup_free(&r.soup);
}

static void golden_files(void)
{
    int count = visit_files(golden, "expected.txt", golden, check_golden);
    CHECK(count > 100, "%d files in %s", count, golden);
}

static void cut_golden(const expected *e, const unsigned char *bytes, size_t size)
{
    for (size_t length = 0; length < size; length++) {
        reading r;
        read_bytes(&r, format_of(e->name), bytes, length, NULL);
        if (r.result != DPT_OK)
            CHECK(r.diag.code == r.result && r.diag.byte <= length, "%s: %zu", e->name, length);
        else if (reads_right(e))
            CHECK(r.soup.triangle_count <= e->triangles, "%s: %zu bytes", e->name, length);
        soup_free(&r.soup);
    }
}

static void files_cut_at_every_byte(void)
{
    visit_files(golden, "expected.txt", golden, cut_golden);
}

static uint64_t mutation_seed = 2024;

static void mutate_golden(const expected *e, const unsigned char *bytes, size_t size)
{
    static const char favourites[] = "0123456789-+.eE#/\\ \t\n\r\0\x7f\xff";
    unsigned char *changed = malloc(size + 1);
    for (int i = 0; size > 0 && i < 120; i++) {
        uint64_t bits = random_bits(&mutation_seed);
        size_t at = (size_t)((bits >> 16) % size);
        memcpy(changed, bytes, size);
        changed[at] =
            bits & 1 ? (unsigned char)(bits >> 8) : (unsigned char)favourites[(bits >> 8) % (sizeof favourites - 1)];
        reading r;
        read_bytes(&r, format_of(e->name), changed, size, NULL);
        CHECK(r.result == DPT_OK || r.diag.text[0] != 0, "%s: no reason", e->name);
        if (r.result == DPT_OK)
            soup_cut_polygons(&r.soup);
        soup_free(&r.soup);
    }
    free(changed);
}

static void files_with_one_byte_changed(void)
{
    visit_files(golden, "expected.txt", golden, mutate_golden);
}

#ifdef CAN_FAIL_ALLOCATIONS
static void starve_golden(const expected *e, const unsigned char *bytes, size_t size)
{
    reading r = { .result = DPT_E_MEMORY };
    for (long grants = 0; r.result == DPT_E_MEMORY && grants < 100; grants++) {
        begin_reading(&r, NULL);
        allocations_left = grants;
        r.result = read_source(&r.soup, format_of(e->name), bytes, size);
        allocations_left = -1;
        if (r.result == DPT_OK)
            r.result = soup_check_corners(&r.soup);
        if (r.result != DPT_E_MEMORY)
            check_outcome(e, &r, 0);
        soup_free(&r.soup);
    }
    CHECK(r.result != DPT_E_MEMORY, "%s needs 100 allocations", e->name);
}

static void memory_runs_out(void)
{
    visit_files(golden, "expected.txt", golden, starve_golden);
}
#endif

static void coordinates_are_those_of_the_file(void)
{
    char names[] = "ascii.ply little.ply big.ply extras.ply crlf.obj tetrahedron.obj bom.obj "
                   "weights_and_colours.obj tetrahedron.off vertex_colours.off header_crlf.ply "
                   "end_header_crlf.ply ascii.stl binary.stl";
    static const float want[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    for (char *name = strtok(names, " "); name != NULL; name = strtok(NULL, " ")) {
        reading r;
        read_golden(&r, name);
        CHECK(r.soup.vertex_count >= 3 && memcmp(r.soup.positions, want, sizeof want) == 0, "%s", name);
        soup_free(&r.soup);
    }
}

static void binary_reads_as_ascii(void)
{
    static const char *const kinds[] = { "integers", "naturals", "extras" };
    for (size_t i = 0; i < 6; i++) {
        char name[40];
        reading ascii, binary;
        snprintf(name, sizeof name, "%s.ply", kinds[i / 2]);
        read_golden(&ascii, name);
        snprintf(name, sizeof name, "%s_%s.ply", kinds[i / 2], i % 2 ? "big" : "little");
        read_golden(&binary, name);
        size_t vertices = ascii.soup.vertex_count, triangles = ascii.soup.triangle_count;
        CHECK(vertices > 0 && binary.soup.vertex_count == vertices, "%s", name);
        CHECK(triangles > 0 && binary.soup.triangle_count == triangles, "%s", name);
        CHECK(memcmp(ascii.soup.positions, binary.soup.positions, 12 * vertices) == 0, "%s", name);
        CHECK(memcmp(ascii.soup.corners, binary.soup.corners, 12 * triangles) == 0, "%s", name);
        soup_free(&ascii.soup);
        soup_free(&binary.soup);
    }
}

static void formats_are_told(void)
{
    static const struct {
        const char *path, *content;
        uint32_t format;
    } cases[] = { { NULL, "ply\nformat ascii 1.0\n", DPT_FORMAT_PLY },
                  { "x.obj", "ply\r\n", DPT_FORMAT_PLY },
                  { NULL, "# c\nOFF\n", DPT_FORMAT_OFF },
                  { NULL, "OFF8 6 12\n", DPT_FORMAT_OFF },
                  { NULL, "4OFF\n", DPT_FORMAT_OFF },
                  { NULL, "solid a\n\n  facet normal 0 0 1\n", DPT_FORMAT_STL },
                  { NULL, "# c\n\n v 0 0 0\n", DPT_FORMAT_OBJ },
                  { "a.b/c.STL", "", DPT_FORMAT_STL },
                  { "x.Obj", "OFFICE\n", DPT_FORMAT_OBJ },
                  { "x.ply", "plying\n", DPT_FORMAT_PLY },
                  { "x.txt", "v\nvn 1 2 3\n", DPT_FORMAT_AUTO },
                  { "obj", "", DPT_FORMAT_AUTO } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *text = cases[i].content;
        uint32_t format = source_format(cases[i].path, (const unsigned char *)text, strlen(text));
        CHECK(format == cases[i].format, "case %zu: %u", i, format);
    }
    size_t size = 0;
    for (int i = 0; i < 4; i++) {
        const char *path = i % 2 ? "x.obj" : "x.stl";
        const char *magic = i < 2 ? "\211DPA\r\n\032\nmore" : "\211DPK\r\n\032\nmore";
        reading r;
        const uint32_t format = source_format(path, (const unsigned char *)magic, 12);
        read_bytes(&r, i % 2 ? DPT_FORMAT_OBJ : format, magic, 12, NULL);
        CHECK(format == DPT_FORMAT_AUTO && r.result == DPT_E_FORMAT && strstr(r.diag.text, "compiled already"),
              "%s: %u, %s", path, format, r.diag.text);
        soup_free(&r.soup);
    }
    unsigned char *bytes = load(golden, "binary_begins_with_solid.stl", &size);
    CHECK(size > 0 && source_format(NULL, bytes, size) == DPT_FORMAT_STL, "binary STL");
    CHECK(size > 0 && source_format(NULL, bytes, size - 1) == DPT_FORMAT_AUTO, "its beginning");
    free(bytes);
}

typedef struct watch {
    int calls, stop_at;
    double done;
} watch;

static int watch_progress(void *user, const char *step, double done)
{
    watch *w = user;
    CHECK(strcmp(step, "read") == 0 && done >= w->done && done <= 1.0, "%s %g", step, done);
    w->done = done;
    return ++w->calls == w->stop_at;
}

/* A big file of each format: `count` triangles, each with its own three vertices. */
static char *big_file(uint32_t format, size_t count, size_t *size)
{
    const int obj = format == DPT_FORMAT_OBJ;
    char *text = calloc(100, count + 100), *at = text;
    if (format == DPT_FORMAT_STL) {
        for (int i = 0; i < 4; i++)
            text[80 + i] = (char)(count >> 8 * i & 0xff);
        *size = 84 + 50 * count;
        return text;
    }
    if (format == DPT_FORMAT_OFF)
        at += sprintf(at, "OFF\n%zu %zu 0\n", 3 * count, count);
    if (format == DPT_FORMAT_PLY)
        at += sprintf(at,
                      "ply\nformat ascii 1.0\nelement vertex %zu\nproperty float x\nproperty "
                      "float y\nproperty float z\nelement face %zu\nproperty list int int vertex_index\nend_header\n",
                      3 * count, count);
    for (size_t i = 0; i < 3 * count; i++)
        at += sprintf(at, "%s%zu.25 %zu 0.5\n", obj ? "v " : "", i, i % 7);
    for (size_t i = (size_t)obj; i < 3 * count; i += 3)
        at += sprintf(at, "%s %zu %zu %zu\n", obj ? "f" : "3", i, i + 1, i + 2);
    *size = (size_t)(at - text);
    return text;
}

static void progress_is_told_and_stops(void)
{
    const size_t count = 150000;
    for (uint32_t format = DPT_FORMAT_OBJ; format <= DPT_FORMAT_OFF; format++) {
        size_t size = 0;
        char *file = big_file(format, count, &size);
        for (int stop = 0; stop < 4; stop++) {
            watch w = { 0, stop, 0.0 };
            dpt_compile_def def = { .size = sizeof def, .progress = watch_progress, .user = &w };
            reading r;
            read_bytes(&r, format, file, size, &def);
            CHECK(r.result == (stop ? DPT_E_CANCELLED : DPT_OK), "%s", code_name(r.result));
            CHECK(stop ? w.calls == stop : w.calls >= 3, "%d calls", w.calls);
            CHECK(stop || r.soup.triangle_count == count, "%zu", r.soup.triangle_count);
            soup_free(&r.soup);
        }
        free(file);
    }
}

static void long_lines(void)
{
    const size_t corners = 300000;
    char *text = malloc(8 * corners + 3000000), *at = text;
    at += sprintf(at, "v 0 0 0\nv 1 0 0\nv 0 1 0\n#");
    fill_text(at, 'x', 1000000);
    at += 1000000;
    at += sprintf(at, "\nvt ");
    fill_text(at, '9', 1000000);
    at += 1000000;
    at += sprintf(at, "\nf");
    for (size_t i = 0; i < corners; i++)
        at += sprintf(at, i % 10 ? " %d" : " \\\n%d", (int)(i % 3) + 1);
    reading r;
    read_string(&r, DPT_FORMAT_OBJ, text);
    CHECK(r.result == DPT_OK && r.soup.triangle_count == corners - 2, "%s", r.diag.text);
    CHECK(soup_cut_polygons(&r.soup) == DPT_OK && r.soup.concave_polygons <= 1, "one polygon");
    soup_free(&r.soup);
    at += sprintf(at, " x");
    read_string(&r, DPT_FORMAT_OBJ, text);
    CHECK(r.result == DPT_E_SYNTAX && r.diag.line == 6 + corners / 10, "line %" PRIu64, r.diag.line);
    soup_free(&r.soup);
    free(text);
}

static void messages_are_printable(void)
{
    reading r;
    read_string(&r, DPT_FORMAT_OBJ, "v 0 0 \x01\xff\x1b[2Jaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\n");
    CHECK(r.result == DPT_E_SYNTAX, "%s", code_name(r.result));
    CHECK(strcmp(r.diag.text, "z is '???[2Jaaaaaaaaaaaaaaaaaaaaaa...': not a number") == 0, "%s", r.diag.text);
    soup_free(&r.soup);
}

static void vertices_are_numbered_as_the_file_does(void)
{
    const uint32_t corners[] = { 0, 1, 3 };
    reading r;
    read_string(&r, DPT_FORMAT_OBJ, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    CHECK(r.result == DPT_E_INDEX && strstr(r.diag.text, "vertex 4, counted from 1, "), "%s", r.diag.text);
    soup_free(&r.soup);
    begin_reading(&r, NULL);
    soup_add_polygon(&r.soup, corners, 3, somewhere);
    CHECK(soup_check_corners(&r.soup) == DPT_E_INDEX && strstr(r.diag.text, "vertex 3, counted from 0, "), "%s",
          r.diag.text);
    soup_free(&r.soup);
}

static void check_data(const expected *e, const unsigned char *bytes, size_t size)
{
    reading r;
    read_bytes(&r, source_format(e->name, bytes, size), bytes, size, NULL);
    check_outcome(e, &r, 0);
    soup_free(&r.soup);
}

static void public_meshes(void)
{
    char tests[1024];
    snprintf(tests, sizeof tests, "%s/../data", golden);
    int count = visit_files(tests, "data-counts.txt", getenv("DPT_DATA"), check_data);
    CHECK(count > 0, "no table in %s", tests);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        golden = argv[1];
    TEST(vertices_are_scaled_and_rounded);
    TEST(counts_have_limits);
    TEST(polygons_become_fans);
    TEST(concave_polygons_are_counted);
    TEST(golden_files);
    TEST(coordinates_are_those_of_the_file);
    TEST(binary_reads_as_ascii);
    TEST(formats_are_told);
    TEST(messages_are_printable);
    TEST(vertices_are_numbered_as_the_file_does);
    TEST(progress_is_told_and_stops);
    TEST(long_lines);
    TEST(files_cut_at_every_byte);
    TEST(files_with_one_byte_changed);
#ifdef CAN_FAIL_ALLOCATIONS
    TEST(memory_runs_out);
#else
    SKIP("memory_runs_out", "realloc cannot be replaced in this build");
#endif
    if (getenv("DPT_DATA") != NULL)
        TEST(public_meshes);
    else
        SKIP("public_meshes", "DPT_DATA does not name the data folder");
    return check_report();
}
