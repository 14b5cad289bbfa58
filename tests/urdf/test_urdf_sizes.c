/* SPDX-License-Identifier: BSD-3-Clause */
/* The arguments of dpt_urdf_compile_file: structs of any size, values that make no sense. */
#include <math.h>

#include "dynpoint.h"
#include "dynpoint/urdf.h"
#include "lib/size_checks.h"

#define FOLDER "tests/golden-urdf/"

static dpt_result take_def(void *given)
{
    dpt_compiled compiled;
    dpt_result result = dpt_urdf_compile_file(FOLDER "two.urdf", given, &compiled, NULL);
    dpt_compiled_free(&compiled);
    return result;
}

static dpt_result take_mesh_def(void *given)
{
    const dpt_urdf_def def = { .size = sizeof def, .mesh = given };
    return take_def((void *)&def);
}

static dpt_result fill_diag(void *out)
{
    dpt_compiled compiled;
    dpt_result result = dpt_urdf_compile_file(FOLDER "nonesuch.urdf", NULL, &compiled, out);
    return result == DPT_E_OPEN ? DPT_OK : result;
}

static void defaults(void *def, size_t size)
{
    dpt_urdf_def_defaults(def, size);
}

static void structs_of_any_size(void)
{
    const struct sized def = { "dpt_urdf_def", sizeof(dpt_urdf_def), sizeof(dpt_urdf_def), take_def };
    const struct sized mesh = { "its dpt_compile_def", offsetof(dpt_compile_def, crease), sizeof(dpt_compile_def),
                                take_mesh_def };
    const struct sized diag = { "dpt_diag", sizeof(dpt_diag), sizeof(dpt_diag), fill_diag };
    dpt_urdf_def good;
    dpt_compile_def good_mesh;
    dpt_urdf_def_init(&good);
    dpt_compile_def_init(&good_mesh);
    check_input(&def, &good);
    check_input(&mesh, &good_mesh);
    check_output(&diag);
    check_defaults(&def, defaults, &good);
    good_mesh.scale = -1.0;
    CHECK(take_mesh_def(&good_mesh) == DPT_E_ARGUMENT, "a negative scale");
    good_mesh.scale = NAN;
    CHECK(take_mesh_def(&good_mesh) == DPT_E_ARGUMENT, "no scale");
    good_mesh.scale = 1.0;
    good_mesh.node_count = 4;
    CHECK(take_mesh_def(&good_mesh) == DPT_E_ARGUMENT, "nodes");
    good_mesh.node_count = 0;
    good_mesh.cell_count = 1;
    CHECK(take_mesh_def(&good_mesh) == DPT_E_ARGUMENT, "cells");
    good_mesh.cell_count = 0;
    CHECK(take_mesh_def(&good_mesh) == DPT_OK, "neither");
}

static void arguments_are_checked(void)
{
    const char *good = FOLDER "two.urdf";
    dpt_compiled compiled = { &compiled, 1 };
    dpt_diag diag = { .size = 8 };
    dpt_urdf_def def = { .size = 8 };
    CHECK(dpt_urdf_compile_file(good, NULL, NULL, NULL) == DPT_E_ARGUMENT, "no out");
    CHECK(dpt_urdf_compile_file(good, NULL, &compiled, &diag) == DPT_E_SIZE && !compiled.bytes, "a short diag");
    CHECK(dpt_urdf_compile_file(good, &def, &compiled, NULL) == DPT_E_SIZE, "a short def");
    def = (dpt_urdf_def){ .size = sizeof def, .without_scene = 2 };
    CHECK(dpt_urdf_compile_file(good, &def, &compiled, NULL) == DPT_E_ARGUMENT, "without_scene");
    const char *const skip[] = { "tip", "nonesuch", NULL };
    def = (dpt_urdf_def){ .size = sizeof def, .skip = skip };
    CHECK(dpt_urdf_compile_file(good, &def, &compiled, NULL) == DPT_E_ARGUMENT, "a link that is not there");
    dpt_compile_def mesh = { .size = 8 };
    def = (dpt_urdf_def){ .size = sizeof def, .mesh = &mesh };
    CHECK(dpt_urdf_compile_file(good, &def, &compiled, NULL) == DPT_E_SIZE, "a short mesh def");
    def = (dpt_urdf_def){ .size = sizeof def, .tool = "nonesuch" };
    diag.size = sizeof diag;
    CHECK(dpt_urdf_compile_file(good, &def, &compiled, &diag) == DPT_E_ARGUMENT && strstr(diag.text, "'nonesuch'"),
          "%s", diag.text);
    CHECK(dpt_urdf_compile_file(good, NULL, &compiled, NULL) == DPT_OK, "the defaults");
    dpt_compiled_free(&compiled);
}

int main(void)
{
    TEST(structs_of_any_size);
    TEST(arguments_are_checked);
    return check_report();
}
