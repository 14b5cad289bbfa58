/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Inputs that a naive compiler or search needs quadratic time for. What is compared is the count of basic blocks
 * with that of an ordinary mesh (lib/block_count.h), and work in units of 16 lanes.
 *
 *     test_linear_cost [ITEMS]      triangles, parts or corners; 50000
 */
#include <math.h>
#include <stdarg.h>

#include "lib/block_count.h"
#include "lib/fixture.h"
#include "lib/rig.h"

/* So many times the cost of a torus of as many bytes. Measured: 2.4. */
#define RATIO_MAX 4.0

/*
 * Where all boxes meet, the search for pairs that cut each other takes 2^23 units beside what is linear, of up to 91
 * basic blocks (compile/test_compile_cost.c). Measured in all: 11 for 50,000 items, 29 for 8,000; of parts 25 and
 * 72.
 */
#define RATIO_MEET_MAX  10.0
#define RATIO_PARTS_MAX 50.0
#define MEET_MAX        (100.0 * 0x1p23)

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

/* Basic blocks, by the reader of `format`. */
static uint64_t compile_cost(const struct text *text, uint32_t format, dpt_result expected)
{
    const dpt_compile_def def = { .size = sizeof def, .format = format };
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled;
    const uint64_t begin = block_count;
    dpt_result result = dpt_compile_bytes(text->bytes, text->size, &def, &compiled, &diag);
    const uint64_t cost = block_count - begin;
    CHECK(result == expected, "%s: %s", dpt_result_name(result), diag.text);
    dpt_compiled_free(&compiled);
    return cost;
}

static double norm_of_byte; /* basic blocks, of a torus */

static void an_ordinary_mesh(void)
{
    struct text text = { NULL, 0, 0 };
    struct shape shape;
    shape_reason reason;
    CHECK(shape_make("torus", items, 0, &shape, reason) == 0, "%s", reason);
    for (size_t v = 0; v < shape.vertex_count; v++)
        print(&text, "v %.6g %.6g %.6g\n", shape.vertices[3 * v], shape.vertices[3 * v + 1], shape.vertices[3 * v + 2]);
    for (size_t t = 0; t < shape.triangle_count; t++)
        print(&text, "f %u %u %u\n", shape.corners[3 * t] + 1, shape.corners[3 * t + 1] + 1,
              shape.corners[3 * t + 2] + 1);
    const uint64_t cost = compile_cost(&text, DPT_FORMAT_OBJ, DPT_OK);
    norm_of_byte = (double)cost / (double)text.size;
    CHECK(compile_cost(&text, DPT_FORMAT_OBJ, DPT_OK) == cost, "not %llu again", (unsigned long long)cost);
    printf("    %zu triangles in %zu bytes: %llu basic blocks\n", shape.triangle_count, text.size,
           (unsigned long long)cost);
    shape_free(&shape);
    free(text.bytes);
}

/* At most `ratio_max` times the norm and `beside` basic blocks. Frees the text. */
static void expect_within(double ratio_max, double beside, const char *what, struct text *text, uint32_t format,
                          dpt_result expected)
{
    const double cost = (double)compile_cost(text, format, expected);
    const double norm = norm_of_byte * (double)text->size;
    printf("    %s: %zu bytes, %.2f of the norm\n", what, text->size, cost / norm);
    CHECK(cost < ratio_max * norm + beside, "%s: %.3g blocks for %zu bytes is %.1f of the norm", what, cost, text->size,
          cost / norm);
    free(text->bytes);
    *text = (struct text){ NULL, 0, 0 };
}

static void expect_linear(const char *what, struct text *text, uint32_t format, dpt_result expected)
{
    expect_within(RATIO_MAX, 0.0, what, text, format, expected);
}

static void expect_bounded(const char *what, struct text *text)
{
    expect_within(RATIO_MEET_MAX, MEET_MAX, what, text, DPT_FORMAT_OBJ, DPT_OK);
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
    expect_bounded("a convex polygon", &text);
    print_circle(&text, 0.9);
    print_polygon(&text);
    expect_bounded("a star", &text);
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
        print(&text, "f %u %u %u\nf %u %u %u\n", items + 1, i + 1, (i + 1) % items + 1, items + 2, (i + 1) % items + 1,
              i + 1);
    expect_linear("two hubs that close", &text, DPT_FORMAT_OBJ, DPT_OK);
    print_circle(&text, 0.0);
    print(&text, "v 0 0 0.1\nv 0 0 -0.1\n");
    for (uint32_t i = 0; i < items; i++)
        print(&text, "f %u %u %u\n", items + 1, items + 2, i + 1);
    expect_bounded("the pages of a book", &text);
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
    expect_bounded("all through one point", &text);
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
    for (uint32_t i = 0; i < items; i++) {
        print(&text, "v %u 0 9\nv %u 1 9\nv %u 0 10\nf -1 -2 -3\n", i, i, i);
        print_tetrahedron(&text, 0.5, i % side, i / side, 0.0);
    }
    expect_linear("triangles and tetrahedra", &text, DPT_FORMAT_OBJ, DPT_OK);
}

static void parts_within_parts(void)
{
    struct text text = { NULL, 0, 0 };
    for (uint32_t i = 0; i < items / 4; i++) {
        double low = 1e-5 * (i + 1);
        print_tetrahedron(&text, 2.0 - 4.0 * low, low, low, low);
    }
    expect_within(RATIO_PARTS_MAX, MEET_MAX, "tetrahedra one in the other", &text, DPT_FORMAT_OBJ, DPT_OK);
    for (uint32_t i = 0; i < items / 4; i++)
        print_tetrahedron(&text, 1.0 + 1e-3 * (i % 37), 1e-3 * (i % 41), 1e-3 * (i % 43), 1e-5 * i);
    expect_within(RATIO_PARTS_MAX, MEET_MAX, "tetrahedra that all cross", &text, DPT_FORMAT_OBJ, DPT_OK);
}

/*
 * Parts are labelled edge by edge, in the order of the vertices, which are numbered by the first triangle that uses
 * them. Each vertex of a strip along -x is first used by a needle: the needles come before the strip and in the
 * opposite order, so that each label of the strip is replaced by a lower one. Measured: 1.2; 8.8 where labels are
 * followed one by one.
 */
static void a_strip_labelled_backwards(void)
{
    struct text text = { NULL, 0, 0 };
    for (uint32_t i = 0; i < items; i++) {
        const double y = 0.1 * i, far = 2.0 * i - 15.0 * items;
        print(&text, "v %d %.9g %u\nv %.9g %.9g 0\nv %.9g %.9g 0\nf -3 -2 -1\n", -(int)i, y, i % 2, far, y, far,
              y + 0.05);
    }
    for (uint32_t i = 0; i + 2 < items; i++)
        print(&text, "f %u %u %u\n", 3 * i + 1, 3 * i + 4, 3 * i + 7);
    expect_within(1.5, 0.0, "a strip labelled backwards", &text, DPT_FORMAT_OBJ, DPT_OK);
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
    CHECK(info.solid_components == 500 && info.cavities == 0, "%u solid, %u cavities", info.solid_components,
          info.cavities);
    CHECK(info.winding_components > 100 && info.winding_components < 500, "%u by winding number",
          info.winding_components);
    CHECK(dpt_query_segments(mesh, NULL, points[0], NULL, 2, hits, NULL) == DPT_OK, "asked");
    CHECK(hits[0].contact == DPT_CONTACT_PENETRATING && hits[1].contact == DPT_CONTACT_SEPARATED, "contact %u and %u",
          hits[0].contact, hits[1].contact);
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
    struct rig rig;
    double at[3];
};

static void scene_open(struct scene *scene, const char *name, uint64_t count, double scale, uint32_t budget)
{
    struct shape shape;
    shape_reason reason;
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.2 }, 0.002 };
    CHECK(shape_make(name, count, 0, &shape, reason) == 0, "%s: %s", name, reason);
    for (size_t i = 0; i < 3 * shape.vertex_count; i++)
        shape.vertices[i] *= scale;
    fixture_from_arrays(&scene->fixture, shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count);
    shape_free(&shape);
    def.budget = budget;
    rig_open(&scene->rig, &def, scene->fixture.mesh, &segment, 1);
}

static void scene_close(struct scene *scene)
{
    rig_close(&scene->rig);
    fixture_free(&scene->fixture);
}

enum { TICKS = 200 };

struct cost {
    uint64_t blocks; /* basic blocks, of all ticks */
    uint64_t work;
    uint32_t most, contacts;
};

static double ratio(struct cost one, struct cost other)
{
    return (double)one.blocks / (double)other.blocks;
}

static double of_unit(struct cost cost)
{
    return (double)cost.blocks / (double)cost.work;
}

/* A tool goes round and through the surface, 4 mm about (x, 0, z). */
static struct cost slide(struct scene *scene, double x, double z)
{
    struct cost cost = { 0, 0, 0, 0 };
    dpt_step step = { .size = sizeof step };
    for (int tick = 0; tick < TICKS; tick++) {
        const double turn = 0.06 * tick;
        const dpt_pose pose = { { x + 0.004 * cos(turn), 0.004 * sin(turn), z + 0.004 * cos(0.03 * tick) - 0.001 },
                                { cos(0.15), sin(0.15), 0.0, 0.0 } };
        dpt_tool_set_pose(scene->rig.world, scene->rig.tool, &pose);
        const uint64_t begin = block_count;
        CHECK(dpt_world_step(scene->rig.world, 1e-3, &step) == DPT_OK, "tick %d", tick);
        cost.blocks += block_count - begin;
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

static double open_cost(const struct fixture *fixture)
{
    const uint64_t begin = block_count;
    CHECK(dpt_mesh_verify(fixture->compiled.bytes, fixture->compiled.size, NULL) == DPT_OK, "it does not open");
    return (double)(block_count - begin);
}

static double query_cost(const struct fixture *fixture, uint32_t method, double z, dpt_hit *hit)
{
    const double ends[6] = { 0.001, 0.002, z, 0.05, 0.1, 0.2 };
    const dpt_query_def def = { .size = sizeof def, .method = method };
    const uint64_t begin = block_count;
    CHECK(dpt_query_segments(fixture->mesh, NULL, ends, NULL, 1, hit, &def) == DPT_OK, "hit");
    return (double)(block_count - begin);
}

/*
 * To open it costs what another mesh of that size does, measured 1.2 times that; to search near its tip is no worse
 * than brute force, measured 0.04 of that.
 */
static void hub_is_opened_and_asked(void)
{
    struct scene hub, sheet;
    dpt_hit hit[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
    scene_open(&hub, "hub", items, 1.0, 0);
    scene_open(&sheet, "membrane", sheet_count(), 1.0, 0);
    double opened = open_cost(&hub.fixture) / open_cost(&sheet.fixture);
    double brute = query_cost(&hub.fixture, DPT_METHOD_BRUTE, 0.0205, &hit[0]);
    double tree = query_cost(&hub.fixture, DPT_METHOD_TREE, 0.0205, &hit[1]);
    printf("    opened for %.2f of a sheet's cost; by tree for %.3f of brute force\n", opened, tree / brute);
    CHECK(opened < 2.0, "%.2f of the sheet's cost", opened);
    CHECK(tree < 0.2 * brute, "%.3g blocks by tree, %.3g by brute force", tree, brute);
    CHECK(fabs(hit[0].distance - hit[1].distance) <= hit[0].error_bound + hit[1].error_bound, "%.17g and %.17g",
          hit[0].distance, hit[1].distance);
    scene_close(&hub);
    scene_close(&sheet);
}

/*
 * At its tip all triangles of a hub are within reach, and elsewhere its boxes overlap, for slivers that stand aslant
 * fill little of them: a tick in contact passes over all of it some times, measured 14. No more than that, whatever
 * its size; and a unit of work costs what it does on a sheet, measured 1.1 times that. A tick costs up to 5.5 times
 * one with all of a sheet within reach.
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
    printf("    tick at the tip %.1f, at the side %.1f times a sheet's; all of the sheet in reach %.1f\n",
           ratio(tip, plain), ratio(side, plain), ratio(near, plain));
    printf("    of the hub's leaves %.2f, at most %.2f; at the side %.2f, at most %.2f\n",
           (double)tip.work / (TICKS * leaves), tip.most / leaves, (double)side.work / (TICKS * leaves),
           side.most / leaves);
    CHECK(tip.contacts > 100 && side.contacts > 100 && plain.contacts > 100 && near.contacts > 100,
          "%u, %u, %u, %u contacts", tip.contacts, side.contacts, plain.contacts, near.contacts);
    CHECK(tip.most < 20.0 * leaves && side.most < 20.0 * leaves, "%u and %u blocks, %.0f leaves", tip.most, side.most,
          leaves);
    printf("    basic blocks a unit of work: %.1f, %.1f, %.1f and %.1f\n", of_unit(tip), of_unit(side), of_unit(plain),
           of_unit(near));
    CHECK(of_unit(tip) < 2.0 * of_unit(plain) && of_unit(side) < 2.0 * of_unit(plain),
          "a unit of work costs %.1f and %.1f blocks, not %.1f", of_unit(tip), of_unit(side), of_unit(plain));
    CHECK(ratio(tip, near) < 15.0, "%.1f times the cost", ratio(tip, near));
    scene_close(&hub);
    scene_close(&sheet);
    scene_close(&dense);
}

/*
 * With a budget a tick costs what the budget does. Beside it is the fan of a vertex, for its normal (sign.md):
 * measured are 2.7 to 5.1 times a sheet's tick.
 */
static void hub_within_a_budget(void)
{
    struct scene hub, sheet;
    scene_open(&hub, "hub", items, 1.0, 256);
    scene_open(&sheet, "membrane", sheet_count(), 1.0, 256);
    const struct cost tip = slide(&hub, 0.0, 0.02), plain = slide(&sheet, 0.0, 0.0);
    printf("    tick at the tip %.1f times a sheet's\n", ratio(tip, plain));
    CHECK(tip.most <= 256 && plain.most <= 256, "%u and %u blocks", tip.most, plain.most);
    CHECK(ratio(tip, plain) < 15.0, "%.1f times the cost", ratio(tip, plain));
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
    TEST(a_strip_labelled_backwards);
    TEST(parts_beyond_the_limit);
    TEST(long_lines);
    TEST(long_headers);
    TEST(hub_is_opened_and_asked);
    TEST(hub_in_contact);
    TEST(hub_within_a_budget);
    return check_report();
}
