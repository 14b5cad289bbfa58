/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Inputs that a naive compiler or search needs quadratic time for. What is compared is the processor's time of one run
 * with that of an ordinary mesh in the same run, and work in 16-lane blocks, never a time by itself.
 *
 *     test_linear_cost [ITEMS]      triangles, parts or corners; 50000
 */
#include <math.h>
#include <stdarg.h>
#include <time.h>

#include "lib/fixture.h"

/* So many times the norm of its length is a fault; where parts all meet, they may cost as much as is put into that. */
#define RATIO_MAX       20.0
#define RATIO_PARTS_MAX 100.0

static uint32_t items = 50000;

struct text {
    char *bytes;
    size_t size, room;
};

static void print(struct text *text, const char *format, ...)
{
    va_list arguments;
    if (text->room - text->size < 128) {
        text->room = 2 * text->room + 65536;
        text->bytes = realloc(text->bytes, text->room);
    }
    va_start(arguments, format);
    text->size += (size_t)vsnprintf(text->bytes + text->size, 128, format, arguments);
    va_end(arguments);
}

static void print_often(struct text *text, const char *piece, size_t times)
{
    while (times--)
        print(text, "%s", piece);
}

static double seconds(void)
{
    struct timespec at;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &at);
    return (double)at.tv_sec + 1e-9 * (double)at.tv_nsec;
}

/* The least of three, in s, by the reader of `format`. */
static double compile_time(const struct text *text, uint32_t format, dpt_result expected)
{
    const dpt_compile_def def = { .size = sizeof def, .format = format };
    double least = HUGE_VAL;
    for (int pass = 0; pass < 3; pass++) {
        dpt_diag diag = { .size = sizeof diag };
        dpt_compiled compiled;
        double begin = seconds();
        dpt_result result = dpt_compile_bytes(text->bytes, text->size, &def, &compiled, &diag);
        double took = seconds() - begin;
        least = took < least ? took : least;
        CHECK(result == expected, "%s: %s", dpt_result_name(result), diag.text);
        dpt_compiled_free(&compiled);
        if (took > 5.0)
            break;
    }
    return least;
}

static double norm_of_byte, norm_of_triangle; /* s, of a torus */

static void an_ordinary_mesh(void)
{
    struct text text = { NULL, 0, 0 };
    struct shape shape;
    shape_reason reason;
    CHECK(shape_make("torus", items, 0, &shape, reason) == 0, "%s", reason);
    for (size_t v = 0; v < shape.vertex_count; v++)
        print(&text, "v %.6g %.6g %.6g\n", shape.vertices[3 * v], shape.vertices[3 * v + 1],
              shape.vertices[3 * v + 2]);
    for (size_t t = 0; t < shape.triangle_count; t++)
        print(&text, "f %u %u %u\n", shape.corners[3 * t] + 1, shape.corners[3 * t + 1] + 1,
              shape.corners[3 * t + 2] + 1);
    double took = compile_time(&text, DPT_FORMAT_OBJ, DPT_OK);
    norm_of_byte = took / (double)text.size;
    norm_of_triangle = took / (double)shape.triangle_count;
    printf("    %zu triangles in %.3g s, %zu bytes\n", shape.triangle_count, took, text.size);
    shape_free(&shape);
    free(text.bytes);
}

/* Frees the text. */
static void expect_within(double most, const char *what, struct text *text, uint32_t format,
                          dpt_result expected)
{
    double took = compile_time(text, format, expected);
    double ratio = took / (norm_of_byte * (double)text->size);
    printf("    %s: %zu bytes, %.2f of the norm\n", what, text->size, ratio);
    CHECK(ratio < most, "%s: %.3g s for %zu bytes is %.1f of the norm", what, took, text->size,
          ratio);
    free(text->bytes);
    *text = (struct text){ NULL, 0, 0 };
}

static void expect_linear(const char *what, struct text *text, uint32_t format, dpt_result expected)
{
    expect_within(RATIO_MAX, what, text, format, expected);
}

static void print_circle(struct text *text, double uneven)
{
    for (uint32_t i = 0; i < items; i++) {
        double turn = 6.283185307179586 * i / items, r = i % 2 ? 1.0 : 1.0 - uneven;
        print(text, "v %.9g %.9g 0\n", r * cos(turn), r * sin(turn));
    }
}

static void print_polygon(struct text *text)
{
    print(text, "f");
    for (uint32_t i = 1; i <= items; i++)
        print(text, " %u", i);
    print(text, "\n");
}

static void polygons_of_many_corners(void)
{
    struct text text = { NULL, 0, 0 };
    print_circle(&text, 0.0);
    print_polygon(&text);
    expect_linear("a convex polygon", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_circle(&text, 0.9);
    print_polygon(&text);
    expect_linear("a star", &text, DPT_FORMAT_OBJ, DPT_OK);
    print(&text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
    print_often(&text, " 1 2 3", items / 3);
    expect_linear("a polygon of three vertices", &text, DPT_FORMAT_OBJ, DPT_OK);
}

static void hubs(void)
{
    struct text text = { NULL, 0, 0 };
    print_circle(&text, 0.0);
    print(&text, "v 0 0 0.1\nv 0 0 -0.1\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "f %u %u %u\n", items + 1, i + 1, (i + 1) % items + 1);
    expect_linear("an open hub", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_circle(&text, 0.0);
    print(&text, "v 0 0 0.1\nv 0 0 -0.1\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "f %u %u %u\nf %u %u %u\n", items + 1, i + 1, (i + 1) % items + 1, items + 2,
              (i + 1) % items + 1, i + 1);
    expect_linear("two hubs that close", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_circle(&text, 0.0);
    print(&text, "v 0 0 0.1\nv 0 0 -0.1\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "f %u %u %u\n", items + 1, items + 2, i + 1);
    expect_linear("the pages of a book", &text, DPT_FORMAT_OBJ, DPT_OK);
}

static void triangles_alike(void)
{
    struct text text = { NULL, 0, 0 };
    print(&text, "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    print_often(&text, "f 1 2 3\n", items);
    expect_linear("one triangle again and again", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_often(&text, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n", items);
    expect_linear("with vertices of its own", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_often(&text, "v 0 0 0\n", items);
    print_often(&text, "f -1 -2 -3\n", items);
    expect_linear("all vertices alike", &text, DPT_FORMAT_OBJ, DPT_E_EMPTY);
    for (uint32_t i = 0; i < items; i++) {
        double turn = 6.283185307179586 * i / items, x = cos(turn), y = sin(turn);
        print(&text, "v %.9g %.9g 0\nv %.9g %.9g 0\nv 0 0 %d\nf -1 -2 -3\n", x, y, -x, -y, i % 2);
    }
    expect_linear("all through one point", &text, DPT_FORMAT_OBJ, DPT_OK);
}

static void print_tetrahedron(struct text *text, double size, double x, double y, double z)
{
    print(text, "v %.9g %.9g %.9g\nv %.9g %.9g %.9g\n", x, y, z, x + size, y, z);
    print(text, "v %.9g %.9g %.9g\nv %.9g %.9g %.9g\n", x, y + size, z, x, y, z + size);
    print(text, "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -4 -1 -2\n");
}

static void many_parts(void)
{
    struct text text = { NULL, 0, 0 };
    const uint32_t side = (uint32_t)sqrt(items);
    for (uint32_t i = 0; i < items; i++)
        print(&text, "v %u 0 0\nv %u 1 0\nv %u 0 1\nf -1 -2 -3\n", i, i, i);
    expect_linear("triangles apart", &text, DPT_FORMAT_OBJ, DPT_OK);
    for (uint32_t i = 0; i < items; i++)
        print_tetrahedron(&text, 0.5, i % side, i / side, 0.0);
    expect_linear("tetrahedra apart, in a plane", &text, DPT_FORMAT_OBJ, DPT_OK);
    for (uint32_t i = 0; i < items; i++)
        print_tetrahedron(&text, 1.5, i, 0.0, 0.0);
    expect_linear("a chain of tetrahedra that cross", &text, DPT_FORMAT_OBJ, DPT_OK);
}

static void parts_within_parts(void)
{
    struct text text = { NULL, 0, 0 };
    for (uint32_t i = 0; i < items / 4; i++) {
        double low = 1e-5 * (i + 1);
        print_tetrahedron(&text, 2.0 - 4.0 * low, low, low, low);
    }
    expect_within(RATIO_PARTS_MAX, "tetrahedra one in the other", &text, DPT_FORMAT_OBJ, DPT_OK);
    for (uint32_t i = 0; i < items / 4; i++)
        print_tetrahedron(&text, 1.0 + 1e-3 * (i % 37), 1e-3 * (i % 41), 1e-3 * (i % 43), 1e-5 * i);
    expect_within(RATIO_PARTS_MAX, "tetrahedra that all cross", &text, DPT_FORMAT_OBJ, DPT_OK);
}

/* More of them than are compared with each other: still solid, wound outward, and with one inside. */
static void parts_beyond_the_limit(void)
{
    const dpt_compile_def def = { .size = sizeof def, .format = DPT_FORMAT_OBJ };
    const double points[2][6] = { { 0.3, 0.3, 0.3, 0.3, 0.3, 0.3 }, { 1.5, 1.5, 0.1, 2, 2, 2 } };
    struct text text = { NULL, 0, 0 };
    dpt_compiled compiled;
    dpt_mesh_info info = { .size = sizeof info };
    dpt_hit hits[2] = { DPT_HIT_INIT };
    const dpt_mesh *mesh;
    for (uint32_t i = 0; i < 500; i++) {
        double low = 1e-5 * (i + 1);
        print_tetrahedron(&text, 2.0 - 4.0 * low, low, low, low);
    }
    CHECK(dpt_compile_bytes(text.bytes, text.size, &def, &compiled, NULL) == DPT_OK, "compiles");
    CHECK(dpt_mesh_open(compiled.bytes, compiled.size, &mesh) == DPT_OK, "opens");
    dpt_mesh_get_info(mesh, &info);
    CHECK(info.solid_components == 500 && info.cavities == 0, "%u solid, %u cavities",
          info.solid_components, info.cavities);
    CHECK(info.winding_components > 100 && info.winding_components < 500, "%u by winding number",
          info.winding_components);
    CHECK(dpt_query_segments(mesh, NULL, points[0], NULL, 2, hits, NULL) == DPT_OK, "asked");
    CHECK(hits[0].contact == DPT_CONTACT_PENETRATING && hits[1].contact == DPT_CONTACT_SEPARATED,
          "contact %u and %u", hits[0].contact, hits[1].contact);
    dpt_compiled_free(&compiled);
    free(text.bytes);
}

static void long_lines(void)
{
    struct text text = { NULL, 0, 0 };
    const size_t length = 64 * (size_t)items;
    const char *mesh = "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
    print(&text, "#");
    print_often(&text, "a long line ", length / 12);
    print(&text, "%s", mesh);
    expect_linear("a comment", &text, DPT_FORMAT_OBJ, DPT_OK);
    print(&text, "v 0.");
    print_often(&text, "1234567", length / 7);
    print(&text, " 0 0%s", mesh);
    expect_linear("a number", &text, DPT_FORMAT_OBJ, DPT_OK);
    print(&text, "v 1e-");
    print_often(&text, "0000007", length / 7);
    print(&text, " 0 0%s", mesh);
    expect_linear("an exponent", &text, DPT_FORMAT_OBJ, DPT_OK);
    print(&text, "v 0 0 0");
    print_often(&text, " \\\n", length / 3);
    print(&text, "%s", mesh);
    expect_linear("lines joined", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_often(&text, "\r", length);
    print(&text, "%s", mesh);
    expect_linear("empty lines", &text, DPT_FORMAT_OBJ, DPT_OK);
    print(&text, "solid ");
    print_often(&text, "name ", length / 5);
    print(&text, "\nfacet");
    expect_linear("an STL's name", &text, DPT_FORMAT_STL, DPT_E_TRUNCATED);
    print_often(&text, "solid a\nendsolid a\n", length / 19);
    expect_linear("empty solids", &text, DPT_FORMAT_STL, DPT_E_EMPTY);
    print(&text, "OFF\n");
    print_often(&text, "# none\n", length / 7);
    expect_linear("an OFF of comments", &text, DPT_FORMAT_OFF, DPT_E_TRUNCATED);
}

static void long_headers(void)
{
    struct text text = { NULL, 0, 0 };
    print(&text, "ply\nformat ascii 1.0\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "element a%u 4294967295\n", i);
    print(&text, "end_header\n");
    expect_linear("elements", &text, DPT_FORMAT_PLY, DPT_E_EMPTY);
    print(&text, "ply\nformat binary_little_endian 1.0\nelement vertex 1\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "property list double uchar x%u\n", i);
    print(&text, "property float x\nproperty float y\nproperty float z\nend_header\n");
    expect_linear("properties", &text, DPT_FORMAT_PLY, DPT_E_TRUNCATED);
    print(&text, "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n");
    print(&text, "property float z\nproperty list uint char a\nend_header\n0 0 0 %u", items);
    print_often(&text, " 1", items);
    expect_linear("a list", &text, DPT_FORMAT_PLY, DPT_E_EMPTY);
}

struct scene {
    struct fixture fixture;
    dpt_world *world;
    void *block;
    dpt_tool tool;
    double at[3];
};

static void scene_open(struct scene *scene, const char *name, uint64_t count, double scale,
                       uint32_t budget)
{
    struct shape shape;
    shape_reason reason;
    dpt_world_def def;
    dpt_body body;
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.2 }, 0.002 };
    CHECK(shape_make(name, count, 0, &shape, reason) == 0, "%s: %s", name, reason);
    for (size_t i = 0; i < 3 * shape.vertex_count; i++)
        shape.vertices[i] *= scale;
    fixture_from_arrays(&scene->fixture, shape.vertices, shape.vertex_count, shape.corners,
                        shape.triangle_count);
    shape_free(&shape);
    dpt_world_def_init(&def);
    def.budget = budget;
    scene->block = malloc(dpt_world_bytes(&def));
    dpt_world_create(scene->block, dpt_world_bytes(&def), &def, &scene->world);
    CHECK(dpt_body_add(scene->world, scene->fixture.mesh, NULL, &body) == DPT_OK, "%s", name);
    CHECK(dpt_tool_add(scene->world, &segment, 1, &scene->tool) == DPT_OK, "%s", name);
}

static void scene_close(struct scene *scene)
{
    free(scene->block);
    fixture_free(&scene->fixture);
}

enum { TICKS = 200 };

struct cost {
    double time; /* s, of all ticks */
    uint64_t work;
    uint32_t most, contacts;
};

/* A tool goes round and through the surface, 4 mm about (x, 0, z). */
static struct cost slide(struct scene *scene, double x, double z)
{
    struct cost cost = { 0.0, 0, 0, 0 };
    dpt_step step = { .size = sizeof step };
    for (int tick = 0; tick < TICKS; tick++) {
        const double turn = 0.06 * tick;
        const dpt_pose pose = { { x + 0.004 * cos(turn), 0.004 * sin(turn),
                                  z + 0.004 * cos(0.03 * tick) - 0.001 },
                                { cos(0.15), sin(0.15), 0.0, 0.0 } };
        dpt_tool_set_pose(scene->world, scene->tool, &pose);
        double begin = seconds();
        CHECK(dpt_world_step(scene->world, 1e-3, &step) == DPT_OK, "tick %d", tick);
        cost.time += seconds() - begin;
        cost.work += step.work;
        cost.most = step.work > cost.most ? step.work : cost.most;
        cost.contacts += step.contacts;
    }
    return cost;
}

/* As many triangles as the hub has, or a few less. */
static uint64_t sheet_count(void)
{
    const uint64_t side = (uint64_t)sqrt(items / 2.0);
    return 2 * side * side;
}

static double open_time(const struct fixture *fixture)
{
    double least = HUGE_VAL;
    for (int pass = 0; pass < 3; pass++) {
        double begin = seconds();
        CHECK(dpt_mesh_verify(fixture->compiled.bytes, fixture->compiled.size, NULL) == DPT_OK,
              "it does not open");
        double took = seconds() - begin;
        least = took < least ? took : least;
    }
    return least;
}

static double query_time(const struct fixture *fixture, uint32_t method, double z, dpt_hit *hit)
{
    const double ends[6] = { 0.001, 0.002, z, 0.05, 0.1, 0.2 };
    const dpt_query_def def = { .size = sizeof def, .method = method };
    double least = HUGE_VAL;
    for (int pass = 0; pass < 3; pass++) {
        double begin = seconds();
        CHECK(dpt_query_segments(fixture->mesh, NULL, ends, NULL, 1, hit, &def) == DPT_OK, "hit");
        double took = seconds() - begin;
        least = took < least ? took : least;
    }
    return least;
}

/* To open it costs what another mesh of that size does; to search near its tip is no worse than brute force. */
static void hub_is_opened_and_asked(void)
{
    struct scene hub, sheet;
    dpt_hit hit[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
    scene_open(&hub, "hub", items, 1.0, 0);
    scene_open(&sheet, "membrane", sheet_count(), 1.0, 0);
    double opened = open_time(&hub.fixture) / open_time(&sheet.fixture);
    double brute = query_time(&hub.fixture, DPT_METHOD_BRUTE, 0.0205, &hit[0]);
    double tree = query_time(&hub.fixture, DPT_METHOD_TREE, 0.0205, &hit[1]);
    printf("    opened in %.2f of a sheet's time; by tree in %.3f of brute force\n", opened,
           tree / brute);
    CHECK(opened < 3.0, "%.2f of the sheet's time", opened);
    CHECK(tree < 1.5 * brute, "%.3g s by tree, %.3g s by brute force", tree, brute);
    CHECK(fabs(hit[0].distance - hit[1].distance) <= hit[0].error_bound + hit[1].error_bound,
          "%.17g and %.17g", hit[0].distance, hit[1].distance);
    scene_close(&hub);
    scene_close(&sheet);
}

/*
 * At its tip all triangles of a hub are within reach, and elsewhere its boxes overlap, for slivers that stand aslant
 * fill little of them: a tick in contact passes over all of it some times. No more than that, whatever its size; and
 * per block of work it costs what a sheet does.
 */
static void hub_in_contact(void)
{
    const double leaves = ceil(items / 16.0);
    struct scene hub, sheet, dense;
    scene_open(&hub, "hub", items, 1.0, 0);
    scene_open(&sheet, "membrane", sheet_count(), 1.0, 0);
    scene_open(&dense, "membrane", sheet_count(), 0.03, 0);
    const struct cost tip = slide(&hub, 0.0, 0.02), side = slide(&hub, 0.05, 0.01);
    const struct cost plain = slide(&sheet, 0.0, 0.0), near = slide(&dense, 0.0, 0.0);
    printf("    tick at the tip %.1f, at the side %.1f times a sheet's; all of the sheet in reach "
           "%.1f\n",
           tip.time / plain.time, side.time / plain.time, near.time / plain.time);
    printf("    of the hub's leaves %.2f, at most %.2f; at the side %.2f, at most %.2f\n",
           (double)tip.work / (TICKS * leaves), tip.most / leaves,
           (double)side.work / (TICKS * leaves), side.most / leaves);
    CHECK(tip.contacts > 100 && side.contacts > 100 && plain.contacts > 100 && near.contacts > 100,
          "%u, %u, %u, %u contacts", tip.contacts, side.contacts, plain.contacts, near.contacts);
    CHECK(tip.most < 20.0 * leaves && side.most < 20.0 * leaves, "%u and %u blocks, %.0f leaves",
          tip.most, side.most, leaves);
    CHECK(tip.time / (double)tip.work < 5.0 * plain.time / (double)plain.work,
          "a block costs %.3g s, not %.3g s", tip.time / (double)tip.work,
          plain.time / (double)plain.work);
    CHECK(tip.time < 50.0 * near.time, "%.3g s, not %.3g s", tip.time, near.time);
    scene_close(&hub);
    scene_close(&sheet);
    scene_close(&dense);
}

/* With a budget a tick costs what the budget does. Beside it is the fan of a vertex, for its normal (sign.md). */
static void hub_within_a_budget(void)
{
    struct scene hub, sheet;
    scene_open(&hub, "hub", items, 1.0, 256);
    scene_open(&sheet, "membrane", sheet_count(), 1.0, 256);
    const struct cost tip = slide(&hub, 0.0, 0.02), plain = slide(&sheet, 0.0, 0.0);
    printf("    tick at the tip %.1f times a sheet's\n", tip.time / plain.time);
    CHECK(tip.most <= 256 && plain.most <= 256, "%u and %u blocks", tip.most, plain.most);
    CHECK(tip.time < 50.0 * plain.time, "%.3g s, not %.3g s", tip.time, plain.time);
    scene_close(&hub);
    scene_close(&sheet);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        items = (uint32_t)strtoul(argv[1], NULL, 10);
    TEST(an_ordinary_mesh);
    TEST(polygons_of_many_corners);
    TEST(hubs);
    TEST(triangles_alike);
    TEST(many_parts);
    TEST(parts_within_parts);
    TEST(parts_beyond_the_limit);
    TEST(long_lines);
    TEST(long_headers);
    TEST(hub_is_opened_and_asked);
    TEST(hub_in_contact);
    TEST(hub_within_a_budget);
    return check_report();
}
