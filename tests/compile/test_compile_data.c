/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What compiling makes of public meshes.
 *
 *     test_compile_data [TABLE]
 *
 * With DPT_DATA in the environment the meshes of TABLE, tests/data/data-meshes.txt, are compiled from
 * there.
 */
#include "compile/compiled.h"

static const char *table = "tests/data/data-meshes.txt";

/* One line of the table; -1 where it tells nothing. */
struct expected {
    char path[128];
    long triangles, closed, open, many, parts, degenerate, duplicate, unused;
};

static void check_count(const char *path, const char *what, long found, long expected)
{
    CHECK(expected < 0 || found == expected, "%s: %ld %s, not %ld", path, found, what, expected);
}

static void check_public_mesh(const char *folder, const struct expected *wanted)
{
    char path[1024];
    dpt_compiled out;
    struct sections s;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compile_def def = { .size = sizeof def };
    snprintf(path, sizeof path, "%s/%s", folder, wanted->path);
    dpt_result result = dpt_compile_file(path, &def, &out, &diag);
    if (result == DPT_E_FINITE) {
        def.scale = 1e-34; /* cray_right_floatmax: the largest floats */
        result = dpt_compile_file(path, &def, &out, &diag);
    }
    CHECK(result == DPT_OK, "%s: %s", wanted->path, diag.text);
    if (result != DPT_OK || !sections_open(&s, &out))
        return;
    const dpt_mesh_info *info = &s.info;
    check_count(wanted->path, "triangles", info->source_triangles, wanted->triangles);
    check_count(wanted->path, "degenerate", info->dropped_degenerate, wanted->degenerate);
    check_count(wanted->path, "duplicate", info->dropped_duplicate, wanted->duplicate);
    check_count(wanted->path, "unused", info->unused_vertices, wanted->unused);
    check_count(wanted->path, "open edges", info->open_edges, wanted->open);
    check_count(wanted->path, "many-edges", info->nonmanifold_edges, wanted->many);
    check_count(wanted->path, "parts", info->components, wanted->parts);
    check_count(wanted->path, "closed", info->closed_components == info->components, wanted->closed);
    check_leaves(&s);
    check_boxes(&s);
    sections_close(&s);
    dpt_compiled_free(&out);
}

static void public_meshes_have_their_counts(void)
{
    const char *folder = getenv("DPT_DATA");
    char line[512];
    int count = 0;
    FILE *file = fopen(table, "r");
    CHECK(file != NULL, "%s", table);
    if (!file)
        return;
    while (folder && fgets(line, sizeof line, file)) {
        struct expected w;
        if (line[0] == '#' || line[0] == '\n')
            continue;
        int fields = sscanf(line, "%127s %ld %ld %ld %ld %ld %ld %ld %ld", w.path, &w.triangles, &w.closed, &w.open,
                            &w.many, &w.parts, &w.degenerate, &w.duplicate, &w.unused);
        CHECK(fields == 9, "%d fields in: %s", fields, line);
        if (fields == 9)
            check_public_mesh(folder, &w);
        count++;
    }
    fclose(file);
    CHECK(!folder || count == 61, "%d meshes", count);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        table = argv[1];
    if (getenv("DPT_DATA"))
        TEST(public_meshes_have_their_counts);
    else
        SKIP("counts of public meshes", "DPT_DATA is not set");
    return check_report();
}
