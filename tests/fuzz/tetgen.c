/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Meshes of tetrahedra: the bytes up to the first zero are a .node file, those behind it the .ele. Refused with a line,
 * or a triangle is embedded in what they hold.
 */
#include <math.h>
#include <string.h>

#include "compile/read_tetgen.h"
#include "fuzz/target.h"

static uint64_t lines_of(const uint8_t *bytes, size_t size)
{
    uint64_t lines = 1;
    for (size_t i = 0; i < size; i++)
        lines += bytes[i] == '\n' || bytes[i] == '\r';
    return lines;
}

static void check_refusal(dpt_result result, const dpt_diag *diag, const uint8_t *bytes, size_t size)
{
    MUST(result == DPT_E_FINITE || result == DPT_E_TRUNCATED || result == DPT_E_TRAILING || result == DPT_E_INDEX ||
         result == DPT_E_FORMAT || result == DPT_E_SYNTAX || result == DPT_E_EMPTY);
    MUST(diag->code == result && diag->line <= lines_of(bytes, size));
    const char *end = memchr(diag->text, 0, sizeof diag->text);
    MUST(end && end > diag->text);
    for (const char *at = diag->text; at < end; at++)
        MUST(*at >= ' ' && *at <= '~');
}

/* What was read is what the compiler takes, unless the triangle is too far away. */
static void embed(const struct tetgen *mesh)
{
    static const double vertices[] = { 0.1, 0.1, 0.1, 0.3, 0.1, 0.2, 0.1, 0.4, 0.2 };
    static const uint32_t corners[] = { 0, 1, 2 };
    const dpt_compile_def def = { .size = sizeof def,
                                  .nodes = mesh->nodes,
                                  .cells = mesh->cells,
                                  .node_count = mesh->node_count,
                                  .cell_count = mesh->cell_count };
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled;
    const dpt_mesh *opened;
    const dpt_result result = dpt_compile_arrays(vertices, 3, corners, 1, &def, &compiled, &diag);
    MUST(result == DPT_OK || (result == DPT_E_FINITE && strstr(diag.text, "from all cells")));
    if (result != DPT_OK)
        return;
    fuzz_accepted++;
    MUST(dpt_mesh_open(compiled.bytes, compiled.size, &opened) == DPT_OK);
    fuzz_use_mesh(opened, FUZZ_COMPILED, FUZZ_QUERY);
    dpt_compiled_free(&compiled);
}

FUZZ_TARGET(tetgen)
{
    const uint8_t *zero = size ? memchr(bytes, 0, size) : NULL;
    const size_t node_size = zero ? (size_t)(zero - bytes) : size;
    const size_t ele_at = zero ? node_size + 1 : size;
    struct tetgen mesh = { .nodes = NULL };
    dpt_diag diag = { .size = sizeof diag };
    struct compile_context context;
    compile_context_init(&context, NULL, &diag);
    dpt_result result = tetgen_read_nodes(&mesh, &context, bytes, node_size);
    if (result != DPT_OK)
        check_refusal(result, &diag, bytes, node_size);
    for (size_t i = 0; result == DPT_OK && i < 3 * (size_t)mesh.node_count; i++)
        MUST(fabs(mesh.nodes[i]) <= DPT_COORDINATE_MAX);
    if (result == DPT_OK) {
        result = tetgen_read_cells(&mesh, &context, bytes + ele_at, size - ele_at);
        if (result != DPT_OK)
            check_refusal(result, &diag, bytes + ele_at, size - ele_at);
    }
    for (size_t i = 0; result == DPT_OK && i < 4 * (size_t)mesh.cell_count; i++)
        MUST(mesh.cells[i] < mesh.node_count);
    if (result == DPT_OK)
        embed(&mesh);
    tetgen_free(&mesh);
    return 0;
}
