/* SPDX-License-Identifier: BSD-3-Clause */
/* What the compiler refuses of springs, and what it says; the files of regions and of fixed vertices, with their lines. */
#include <math.h>

#include "compile/read_regions.h"
#include "lib/dpa.h"

static dpt_result compile(const char *shape_name, uint64_t count, const dpt_spring_net_def *springs, dpt_diag *diag)
{
    struct shape shape;
    shape_reason reason;
    dpt_compiled compiled = { NULL, 0 };
    const dpt_compile_def def = { .size = sizeof def, .springs = springs };
    dpt_result result = DPT_E_ARGUMENT;
    diag->size = sizeof *diag;
    if (shape_make(shape_name, count, 0, &shape, reason) == 0)
        result = dpt_compile_arrays(shape.vertices, shape.vertex_count, shape.corners, shape.triangle_count, &def,
                                    &compiled, diag);
    CHECK((result == DPT_OK) == (compiled.bytes != NULL), "%s", dpt_result_name(result));
    shape_free(&shape);
    dpt_compiled_free(&compiled);
    return result;
}

static void expect_refusal(const char *shape, uint64_t count, const dpt_spring_net_def *def, dpt_result code,
                           const char *text)
{
    dpt_diag diag;
    const dpt_result result = compile(shape, count, def, &diag);
    CHECK(result == code && diag.code == code && strstr(diag.text, text), "%s: %s, not %s", dpt_result_name(result),
          diag.text, text);
}

static dpt_spring_net_def def_of(uint32_t kind)
{
    dpt_spring_net_def def;
    dpt_spring_net_def_init(&def);
    def.kind = kind;
    return def;
}

static void numbers_out_of_range_are_refused(void)
{
    const struct {
        size_t at;
        double most;
        const char *name;
    } fields[] = { { offsetof(dpt_spring_net_def, young), 1e12, "Young's modulus must" },
                   { offsetof(dpt_spring_net_def, density), 1e9, "density" },
                   { offsetof(dpt_spring_net_def, drag), 1e9, "drag" },
                   { offsetof(dpt_spring_net_def, viscosity), 1e9, "viscosity" },
                   { offsetof(dpt_spring_net_def, thickness), 1e6, "thickness" },
                   { offsetof(dpt_spring_net_def, bending), 1e12, "bending" },
                   { offsetof(dpt_spring_net_def, spacing), 1e6, "spacing" } };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        const double wrong[] = { -1e-9, 1.001 * fields[i].most, NAN, INFINITY };
        for (int k = 0; k < 4; k++) {
            dpt_spring_net_def def = def_of(DPT_NET_SHEET);
            memcpy((char *)&def + fields[i].at, &wrong[k], sizeof wrong[k]);
            expect_refusal("membrane", 18, &def, DPT_E_ARGUMENT, fields[i].name);
        }
    }
    const double ratios[] = { -0.25, 0.099, 0.451, NAN };
    for (int k = 0; k < 4; k++) {
        dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
        def.poisson = ratios[k];
        expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "Poisson's ratio must be 0.1 to 0.45");
    }
    dpt_spring_net_def sheet = def_of(DPT_NET_SHEET);
    sheet.poisson = 0.3;
    expect_refusal("membrane", 18, &sheet, DPT_E_ARGUMENT, "it cannot be chosen");
    for (uint32_t kind = 0; kind < 4; kind += 3) {
        const dpt_spring_net_def def = def_of(kind);
        expect_refusal("membrane", 18, &def, DPT_E_ARGUMENT, "kind");
    }
}

static void meshes_without_such_springs_are_refused(void)
{
    dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    expect_refusal("membrane", 18, &def, DPT_E_ARGUMENT, "no part of the mesh is closed");
    def.spacing = 1e-4;
    expect_refusal("box", 12, &def, DPT_E_LIMIT, "more than 4194304 cells");
    def = def_of(DPT_NET_SHEET);
    expect_refusal("hub", 1025, &def, DPT_E_LIMIT, "has more than 1024 springs");
    def.density = 1e-12;
    def.thickness = 1e-6;
    expect_refusal("membrane", 18, &def, DPT_E_FINITE, "mass of the node");
    def = def_of(DPT_NET_SHEET);
    def.young = 1e-15;
    expect_refusal("membrane", 18, &def, DPT_E_FINITE, "stiffness of a spring");
}

static void regions_that_say_nothing_are_refused(void)
{
    const dpt_spring_region good = { DPT_REGION_BOX, 0, { -1, -1, -1, 1, 1, 1 }, 1e3, 1e3, 0.0 };
    dpt_spring_region regions[2] = { good, good };
    dpt_spring_net_def def = def_of(DPT_NET_VOLUME);
    dpt_diag diag;
    def.spacing = 0.02;
    def.region_count = 2;
    expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "no regions");
    def.regions = regions;
    CHECK(compile("box", 12, &def, &diag) == DPT_OK, "%s", diag.text);
    for (int i = 0; i < 9; i++) {
        dpt_spring_region *region = &regions[1];
        *region = good;
        *(i == 0   ? &region->young
          : i == 1 ? &region->density
          : i == 2 ? &region->drag
          : i == 3 ? &region->box[3]
          : i == 4 ? &region->box[1]
                   : &region->young) = i == 4   ? 3e6
                                       : i == 3 ? -2.0
                                                : -1.0;
        if (i == 5)
            region->kind = 3;
        if (i == 6)
            region->fixed = 2;
        if (i == 7)
            *region = (dpt_spring_region){ DPT_REGION_SPHERE, 0, { 0 }, 1e3, 1e3, 0.0 };
        if (i == 8) {
            *region = good;
            region->box[5] = 3e6;
        }
        expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "region 2");
    }
    for (uint32_t fixed = 0; fixed < 2; fixed++) {
        regions[1] = (dpt_spring_region){ DPT_REGION_SPHERE, fixed, { 0.3, 0, 0, 0.1 }, 1e3, 1e3, 0 };
        expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "region 2 holds nothing");
    }
    regions[1] = good;
    regions[1].fixed = 1;
    expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "all of the body is fixed");
    def.fixed_count = 1;
    expect_refusal("box", 12, &def, DPT_E_ARGUMENT, "no fixed vertices");
}

static void springs_and_cells_exclude_each_other(void)
{
    const double nodes[] = { -9, -9, -9, 9, -9, -9, 0, 9, -9, 0, 0, 9 };
    const uint32_t cell[] = { 0, 1, 2, 3 }, corners[] = { 0, 1, 2 };
    const dpt_spring_net_def springs = def_of(DPT_NET_SHEET);
    const dpt_compile_def def = {
        .size = sizeof def, .nodes = nodes, .cells = cell, .node_count = 4, .cell_count = 1, .springs = &springs
    };
    dpt_compiled compiled;
    CHECK(dpt_compile_arrays(nodes, 3, corners, 1, &def, &compiled, NULL) == DPT_E_ARGUMENT, "springs in cells");
}

/* With a byte order mark, comments, empty lines, and ends of lines of either kind. */
static void files_are_read(void)
{
    static const char text[] = "\xef\xbb\xbf# liver, and where it hangs\n"
                               "box -1 -2 -3  1 2 3   8e3 1060 0.5\r\n"
                               "\n"
                               "  sphere 0.1 0.2 0.3 0.04 fixed # vena cava\n"
                               "box 0 0 0 0 0 0 fixed";
    static const char numbers[] = "17 0 # two\n\n4294967294";
    struct spring_regions read = { .regions = NULL };
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    compile_context_init(&context, NULL, &diag);
    CHECK(regions_read(&read, &context, (const unsigned char *)text, sizeof text - 1) == DPT_OK &&
              read.region_count == 3,
          "%s, line %llu", diag.text, (unsigned long long)diag.line);
    if (read.region_count == 3) {
        const dpt_spring_region *r = read.regions;
        CHECK(r[0].kind == DPT_REGION_BOX && !r[0].fixed && r[0].box[0] == -1.0 && r[0].box[5] == 3.0 &&
                  r[0].young == 8e3 && r[0].density == 1060.0 && r[0].drag == 0.5,
              "the box");
        CHECK(r[1].kind == DPT_REGION_SPHERE && r[1].fixed && r[1].box[2] == 0.3 && r[1].box[3] == 0.04 && r[2].fixed,
              "the sphere");
    }
    CHECK(fixed_read(&read, &context, (const unsigned char *)numbers, sizeof numbers - 1) == DPT_OK &&
              read.fixed_count == 3 && read.fixed[0] == 17 && read.fixed[1] == 0 && read.fixed[2] == 4294967294u,
          "%s", diag.text);
    regions_free(&read);
}

static void wrong_files_are_refused_with_their_line(void)
{
    const struct {
        int is_fixed;
        uint64_t line;
        const char *text, *reason;
    } files[] = {
        { 0, 2, "# a\ncube 1 2 3\n", "'cube' is not box or sphere" },
        { 0, 1, "box 1 2 3 4 5\n6 fixed\n", "the highest z" },
        { 0, 1, "sphere 1 2 3 x fixed\n", "the radius" },
        { 0, 1, "sphere 1 2 3 4 frozen\n", "Young's modulus, or fixed," },
        { 0, 1, "box 0 0 0 1 1 1 5e3 1000\n", "the drag" },
        { 0, 1, "box 0 0 0 1 1 1 5e3 1000 0 0\n", "'0' follows" },
        { 0, 1, "box 0 0 0 1 1 1 fixed fixed\n", "'fixed' follows" },
        { 0, 3, "\n\nbox 0 0 0 -1 1 1 fixed\n", "region 1 is empty" },
        { 0, 2, "box 0 0 0 1 1 1 fixed\nsphere 0 0 0 0 fixed\n", "region 2 is empty" },
        { 0, 1, "sphere 0 0 0 1 0 1000 0\n", "region 1: Young's modulus" },
        { 0, 1, "sphere 0 0 0 1 5000 nan 0\n", "the density" },
        { 0, 1, "sphere 0 0 0 1 5000 1000 -1\n", "region 1: the drag" },
        { 1, 2, "1\n-1\n", "-1 is no number of a vertex" },
        { 1, 1, "1.5\n", "a vertex" },
        { 1, 1, "4294967295\n", "is no number of a vertex" },
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        struct spring_regions read = { .regions = NULL };
        dpt_diag diag = { .size = sizeof diag };
        struct compile_context context;
        compile_context_init(&context, NULL, &diag);
        const unsigned char *bytes = (const unsigned char *)files[i].text;
        const dpt_result result =
            (files[i].is_fixed ? fixed_read : regions_read)(&read, &context, bytes, strlen(files[i].text));
        CHECK(result != DPT_OK && diag.code == result && diag.line == files[i].line &&
                  strstr(diag.text, files[i].reason),
              "file %zu: %s in line %llu", i, diag.text, (unsigned long long)diag.line);
        regions_free(&read);
    }
}

int main(void)
{
    TEST(numbers_out_of_range_are_refused);
    TEST(meshes_without_such_springs_are_refused);
    TEST(regions_that_say_nothing_are_refused);
    TEST(springs_and_cells_exclude_each_other);
    TEST(files_are_read);
    TEST(wrong_files_are_refused_with_their_line);
    return check_report();
}
