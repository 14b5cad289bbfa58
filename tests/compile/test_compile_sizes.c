/* SPDX-License-Identifier: BSD-3-Clause */
/* The compiler's structs of callers that are older or newer than the library. */
#include "dynpoint/compile.h"
#include "lib/size_checks.h"

static const double vertices[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
static const uint32_t corners[12] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };

static dpt_result arrays(const dpt_compile_def *def, dpt_diag *diag)
{
    dpt_compiled out;
    dpt_result result = dpt_compile_arrays(vertices, 4, corners, 4, def, &out, diag);
    CHECK((result == DPT_OK) == (out.bytes != NULL), "%s", dpt_result_name(result));
    dpt_compiled_free(&out);
    return result;
}

static dpt_result take_def(void *given)
{
    return arrays(given, NULL);
}

static dpt_result take_def_for_bytes(void *given)
{
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    dpt_compiled out;
    dpt_result result = dpt_compile_bytes(text, sizeof text - 1, given, &out, NULL);
    dpt_compiled_free(&out);
    return result;
}

static dpt_result take_def_for_file(void *given)
{
    dpt_compiled out;
    dpt_result result = dpt_compile_file("tests/golden/torus.ply", given, &out, NULL);
    dpt_compiled_free(&out);
    return result;
}

static dpt_result take_springs(void *given)
{
    const dpt_compile_def def = { .size = sizeof def, .springs = given };
    return arrays(&def, NULL);
}

/* The kind alone has no default. */
static dpt_result take_kindless_springs(void *given)
{
    dpt_spring_net_def *def = given;
    def->kind = DPT_NET_VOLUME;
    return take_springs(given);
}

/* What is refused fills the diag, and says so by its code. */
static dpt_result refused(dpt_result result)
{
    return result == DPT_E_ARGUMENT ? DPT_OK : result;
}

static dpt_result fill_diag(void *out)
{
    const dpt_compile_def wrong = { .size = sizeof wrong, .scale = -1.0 };
    return refused(arrays(&wrong, out));
}

static dpt_result fill_diag_of_an_arm(void *out)
{
    dpt_compiled compiled;
    return refused(dpt_compile_arm(NULL, &compiled, out));
}

static dpt_result fill_diag_of_success(void *out)
{
    return arrays(NULL, out);
}

static void structs_of_any_size(void)
{
    const size_t first = offsetof(dpt_compile_def, crease);
    const struct sized defs[] = {
        { "dpt_compile_def", first, sizeof(dpt_compile_def), take_def },
        { "dpt_compile_def for bytes", first, sizeof(dpt_compile_def), take_def_for_bytes },
        { "dpt_compile_def for a file", first, sizeof(dpt_compile_def), take_def_for_file },
    };
    const struct sized diags[] = {
        { "dpt_diag", sizeof(dpt_diag), sizeof(dpt_diag), fill_diag },
        { "dpt_diag of an arm", sizeof(dpt_diag), sizeof(dpt_diag), fill_diag_of_an_arm },
        { "dpt_diag of success", sizeof(dpt_diag), sizeof(dpt_diag), fill_diag_of_success },
    };
    const struct sized springs = { "dpt_spring_net_def", offsetof(dpt_spring_net_def, poisson),
                                   sizeof(dpt_spring_net_def), take_springs };
    dpt_compile_def good;
    dpt_compile_def_init(&good);
    dpt_spring_net_def good_springs;
    dpt_spring_net_def_init(&good_springs);
    good_springs.kind = DPT_NET_SHEET;
    check_input(&springs, &good_springs);
    for (size_t i = 0; i < sizeof defs / sizeof *defs; i++)
        check_input(&defs[i], &good);
    for (size_t i = 0; i < sizeof diags / sizeof *diags; i++)
        check_output(&diags[i]);
}

/* Bytes whose content tells of no format. */
static dpt_result bytes_of(const dpt_compile_def *def)
{
    dpt_compiled out;
    dpt_result result = dpt_compile_bytes("half of a part", 14, def, &out, NULL);
    dpt_compiled_free(&out);
    return result;
}

/* A field counts from where the size reaches it. */
static void a_longer_def_has_more_say(void)
{
    dpt_compile_def def = { .size = offsetof(dpt_compile_def, crease), .crease = -1.0 };
    CHECK(arrays(&def, NULL) == DPT_OK, "a crease behind the end is looked at");
    def.size = offsetof(dpt_compile_def, threads);
    CHECK(arrays(&def, NULL) == DPT_E_ARGUMENT, "a crease before the end is not");
    def = (dpt_compile_def){ .size = offsetof(dpt_compile_def, nodes), .node_count = 4 };
    CHECK(arrays(&def, NULL) == DPT_OK, "nodes behind the end are looked at");
    def.size = sizeof def;
    CHECK(arrays(&def, NULL) == DPT_E_ARGUMENT, "nodes before the end are not");
    const dpt_spring_net_def wrong = { .size = sizeof wrong };
    def = (dpt_compile_def){ .size = offsetof(dpt_compile_def, name), .springs = &wrong };
    CHECK(arrays(&def, NULL) == DPT_E_ARGUMENT, "springs of no kind");
    def.size -= 4;
    CHECK(arrays(&def, NULL) == DPT_OK, "half a pointer to springs is looked at");
    def = (dpt_compile_def){ .size = offsetof(dpt_compile_def, note) - 4, .name = (const char *)1 };
    CHECK(bytes_of(&def) == DPT_E_FORMAT, "half a pointer to a name is looked at");
    def = (dpt_compile_def){ .size = sizeof def, .name = "a/b.c/part.STL" };
    CHECK(bytes_of(&def) == DPT_E_TRUNCATED, "a name tells of no format");
    def.name = "part";
    CHECK(bytes_of(&def) == DPT_E_FORMAT && bytes_of(NULL) == DPT_E_FORMAT, "without an extension");
    def = (dpt_compile_def){ .size = offsetof(dpt_compile_def, recentre), .recentre = 2 };
    CHECK(arrays(&def, NULL) == DPT_OK, "recentre behind the end is looked at");
    def.size = sizeof def;
    CHECK(arrays(&def, NULL) == DPT_E_ARGUMENT, "recentre before the end is not");
}

static void spring_defaults(void *def, size_t size)
{
    dpt_spring_net_def_defaults(def, size);
}

static void defaults(void *def, size_t size)
{
    dpt_compile_def_defaults(def, size);
}

static void zeros_are_the_defaults(void)
{
    const struct sized of = { "dpt_compile_def", 0, sizeof(dpt_compile_def), take_def };
    const dpt_compile_def zeros = { .size = sizeof zeros };
    dpt_compile_def good;
    dpt_compiled by_zeros, by_defaults, by_nothing;
    dpt_compile_def_init(&good);
    CHECK(good.scale == 1.0 && good.crease > 1.047 && good.crease < 1.048 && good.threads == 1,
          "scale %g, crease %g, %u threads", good.scale, good.crease, good.threads);
    check_defaults(&of, defaults, &good);
    const struct sized of_springs = { "dpt_spring_net_def", 0, sizeof(dpt_spring_net_def), take_kindless_springs };
    dpt_spring_net_def springs;
    dpt_spring_net_def_init(&springs);
    CHECK(springs.young == 5000.0 && springs.density == 1000.0 && springs.thickness == 0.001 && springs.drag == 0.0 &&
              springs.spacing == 0.0 && !springs.kind,
          "E %g Pa, %g kg/m^3, %g m", springs.young, springs.density, springs.thickness);
    check_defaults(&of_springs, spring_defaults, &springs);
    CHECK(dpt_compile_arrays(vertices, 4, corners, 4, &zeros, &by_zeros, NULL) == DPT_OK &&
              dpt_compile_arrays(vertices, 4, corners, 4, &good, &by_defaults, NULL) == DPT_OK &&
              dpt_compile_arrays(vertices, 4, corners, 4, NULL, &by_nothing, NULL) == DPT_OK,
          "compile");
    CHECK(by_zeros.size == by_defaults.size && by_zeros.size == by_nothing.size &&
              !memcmp(by_zeros.bytes, by_defaults.bytes, by_zeros.size) &&
              !memcmp(by_zeros.bytes, by_nothing.bytes, by_zeros.size),
          "they differ");
    dpt_compiled_free(&by_zeros);
    dpt_compiled_free(&by_defaults);
    dpt_compiled_free(&by_nothing);
}

int main(void)
{
    TEST(structs_of_any_size);
    TEST(a_longer_def_has_more_say);
    TEST(zeros_are_the_defaults);
    return check_report();
}
