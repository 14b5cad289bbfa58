/* SPDX-License-Identifier: BSD-3-Clause */
/* The vertices' numbers in the source, by hand; test_compile compares those of every mesh with a search of it. */
#include "lib/dpa.h"

/* Unused vertices have no vertex in the file, even where a used one is; of equal ones the first counts. */
static void vertices_have_their_numbers(void)
{
    static const char obj[] = "v 1 0 0\nv 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\n"
                              "f 3 4 5\nf 6 4 7\n";
    const float at[5][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };
    const uint32_t numbers[] = { 2, 3, 4, 6 };
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    const float *xyz;
    const uint32_t *sources;
    uint32_t count = 0;
    CHECK(dpt_compile_bytes(obj, sizeof obj - 1, NULL, &compiled, NULL) == DPT_OK &&
              dpt_mesh_convert(compiled.bytes, compiled.size, NULL) == DPT_OK &&
              dpt_mesh_open(compiled.bytes, compiled.size, &mesh) == DPT_OK,
          "does not open");
    CHECK(dpt_mesh_get_vertices(mesh, &xyz, &count) == DPT_OK &&
              dpt_mesh_get_vertex_sources(mesh, &sources, &count) == DPT_OK && count == 4,
          "%u vertices", count);
    for (uint32_t v = 0; v < count; v++)
        for (int i = 0; i < 4; i++)
            CHECK(sources[v] != numbers[i] || !memcmp(xyz + 3 * (size_t)v, at[i], 12), "vertex %u is %u", v,
                  sources[v]);
    for (uint32_t v = 0; v < count; v++)
        CHECK(sources[v] == 2 || sources[v] == 3 || sources[v] == 4 || sources[v] == 6, "vertex %u is %u", v,
              sources[v]);
    dpt_compiled_free(&compiled);
}

/* An STL has three vertices a triangle, in the order of the file. */
static void an_stl_numbers_its_corners(void)
{
    const float corners[2][9] = { { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, { 1, 0, 0, 1, 1, 0, 0, 1, 0 } };
    unsigned char stl[84 + 2 * 50] = { 0 };
    dpt_compiled compiled;
    const dpt_mesh *mesh;
    const float *xyz;
    const uint32_t *sources;
    uint32_t count = 0, seen = 0;
    stl[80] = 2;
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < 9; i++) {
            uint32_t bits;
            memcpy(&bits, &corners[t][i], 4);
            for (int k = 0; k < 4; k++)
                stl[84 + 50 * t + 12 + 4 * i + k] = (unsigned char)(bits >> 8 * k);
        }
    CHECK(dpt_compile_bytes(stl, sizeof stl, NULL, &compiled, NULL) == DPT_OK &&
              dpt_mesh_convert(compiled.bytes, compiled.size, NULL) == DPT_OK &&
              dpt_mesh_open(compiled.bytes, compiled.size, &mesh) == DPT_OK &&
              dpt_mesh_get_vertices(mesh, &xyz, &count) == DPT_OK &&
              dpt_mesh_get_vertex_sources(mesh, &sources, &count) == DPT_OK && count == 4,
          "%u vertices", count);
    for (uint32_t v = 0; v < count; v++) {
        const uint32_t number = sources[v];
        seen |= 1u << number;
        CHECK(number < 6 && !memcmp(xyz + 3 * (size_t)v, &corners[number / 3][3 * (number % 3)], 12), "vertex %u is %u",
              v, number);
    }
    CHECK(seen == 0x17, "numbers %x", seen); /* 0, 1, 2 and 4: 3 is 1, 5 is 2 */
    dpt_compiled_free(&compiled);
}

int main(void)
{
    TEST(vertices_have_their_numbers);
    TEST(an_stl_numbers_its_corners);
    return check_report();
}
