/* SPDX-License-Identifier: BSD-3-Clause */
/* Nodes and cells that the compiler refuses, from arrays and from TetGen's files, and where it says the fault is. */
#include <math.h>

#include "compile/read_tetgen.h"
#include "lib/check.h"

/* Compile `points`, three a triangle. */
static dpt_result compile(const double *points, uint32_t count, const dpt_compile_def *given, dpt_diag *diag)
{
    dpt_compile_def def = *given;
    dpt_compiled compiled;
    uint32_t *corners = malloc(count * sizeof *corners);
    for (uint32_t i = 0; i < count; i++)
        corners[i] = i;
    def.size = sizeof def;
    const dpt_result result = dpt_compile_arrays(points, count, corners, count / 3, &def, &compiled, diag);
    CHECK((result == DPT_OK) == (compiled.bytes != NULL), "left an output");
    dpt_compiled_free(&compiled);
    free(corners);
    return result;
}

static void expect_refusal(const dpt_compile_def *def, dpt_result code, const char *text)
{
    static const double points[] = { 0.1, 0.1, 0.1, 0.2, 0.1, 0.1, 0.1, 0.2, 0.1 };
    dpt_diag diag = { .size = sizeof diag };
    const dpt_result result = compile(points, 3, def, &diag);
    CHECK(result == code && diag.code == code && strstr(diag.text, text), "%s: %s, not %s: %s", dpt_result_name(result),
          diag.text, dpt_result_name(code), text);
}

static void wrong_cells_are_refused(void)
{
    double nodes[15] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1 };
    uint32_t cells[8] = { 0, 1, 2, 3, 1, 2, 3, 4 };
    const dpt_compile_def good = { .nodes = nodes, .cells = cells, .node_count = 5, .cell_count = 2 };
    const double wrong[] = { NAN, INFINITY, -INFINITY, 1.0000001e6, -1e300 };
    dpt_compile_def def = good;
    expect_refusal(&good, DPT_OK, "");
    def.nodes = NULL;
    expect_refusal(&def, DPT_E_ARGUMENT, "no nodes or no cells");
    def = good;
    def.cells = NULL;
    expect_refusal(&def, DPT_E_ARGUMENT, "no nodes or no cells");
    def = good;
    def.node_count = 0;
    expect_refusal(&def, DPT_E_ARGUMENT, "nodes without cells");
    def = good;
    def.cell_count = 0;
    expect_refusal(&def, DPT_E_ARGUMENT, "nodes without cells");
    def.node_count = 0;
    expect_refusal(&def, DPT_OK, "");
    def = good;
    def.node_count = 4;
    expect_refusal(&def, DPT_E_INDEX, "cell 1 names node 4, and there are only 4");
    def.node_count = 0x80000000u;
    expect_refusal(&def, DPT_E_LIMIT, "more than 2147483647 nodes or cells");
    def = good;
    def.cell_count = 0x80000000u;
    expect_refusal(&def, DPT_E_LIMIT, "more than 2147483647 nodes or cells");
    for (size_t i = 0; i < 15; i++) {
        const double kept = nodes[i];
        char text[32];
        nodes[i] = wrong[i % 5];
        snprintf(text, sizeof text, "%c of node %zu is", "xyz"[i % 3], i / 3);
        expect_refusal(&good, DPT_E_FINITE, text);
        nodes[i] = kept;
    }
    /* In one plane: by equal nodes, by a tie of the coordinates, and but for rounding. */
    cells[6] = 2;
    expect_refusal(&good, DPT_E_FINITE, "cell 1 has no volume");
    cells[6] = 3;
    nodes[12] = nodes[13] = 0.5;
    nodes[14] = 0.0;
    expect_refusal(&good, DPT_E_FINITE, "cell 1 has no volume");
    for (int k = 0; k < 3; k++) /* of the plane of three odd points */
        nodes[12 + k] = 0.7 * nodes[3 + k] + 0.2 * nodes[6 + k] + 0.1 * nodes[9 + k];
    expect_refusal(&good, DPT_E_FINITE, "cell 1 has no volume");
    nodes[12] += 1e-9;
    expect_refusal(&good, DPT_OK, "");
    /* Nodes in another unit, and the mesh's own scale. */
    for (int i = 0; i < 15; i++)
        nodes[i] *= 1e-3;
    expect_refusal(&good, DPT_E_FINITE, "vertex 0 is 0.173 m from all cells: too far");
    def = good;
    def.scale = 1e10;
    expect_refusal(&def, DPT_E_FINITE, "beyond 1000000 m");
}

/* The vertex that is told of is the source's, whichever thread met it first. */
static void the_first_vertex_is_told(void)
{
    const double nodes[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    const uint32_t cell[] = { 0, 1, 2, 3 };
    uint64_t random = 17;
    char told[sizeof((dpt_diag *)0)->text] = "";
    double *points = malloc(3 * 9000 * sizeof *points);
    for (int i = 0; i < 3 * 9000; i++)
        points[i] = random_in(&random, -200.0, 200.0);
    for (uint32_t threads = 1; threads <= 64; threads = 3 * threads + 1) {
        dpt_diag diag = { .size = sizeof diag };
        const dpt_compile_def def = {
            .nodes = nodes, .cells = cell, .node_count = 4, .cell_count = 1, .threads = threads
        };
        CHECK(compile(points, 9000, &def, &diag) == DPT_E_FINITE && strstr(diag.text, "vertex "), "%s", diag.text);
        unsigned number = 0;
        double distance = 0.0;
        CHECK(sscanf(diag.text, "vertex %u is %lf m", &number, &distance) == 2 && number < 9000, "%s", diag.text);
        const double *x = points + 3 * (size_t)number;
        CHECK(fabs(distance - sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])) < 2.0, "%s", diag.text);
        if (threads == 1)
            memcpy(told, diag.text, sizeof told);
        CHECK(!strcmp(diag.text, told), "%s, with %u threads %s", told, threads, diag.text);
    }
    free(points);
}

/* ---- TetGen's files ---- */

/* Copies that end where their blocks end, so that a sanitizer sees a byte too far. */
static dpt_result read(struct tetgen *mesh, const char *node, size_t node_size, const char *ele, size_t ele_size,
                       dpt_diag *diag)
{
    const dpt_compile_def def = { .size = sizeof def, .scale = 2.0 };
    unsigned char *nodes = malloc(node_size + !node_size), *cells = malloc(ele_size + !ele_size);
    struct compile_context context;
    memcpy(nodes, node, node_size);
    memcpy(cells, ele, ele_size);
    *diag = (dpt_diag){ .size = sizeof *diag };
    *mesh = (struct tetgen){ .nodes = NULL };
    compile_context_init(&context, &def, diag);
    dpt_result result = tetgen_read_nodes(mesh, &context, nodes, node_size);
    if (result == DPT_OK)
        result = tetgen_read_cells(mesh, &context, cells, ele_size);
    free(nodes);
    free(cells);
    return result;
}

static const char good_node[] = "# nodes\n5 3 1 1\n# x y z\n1 0 0 0 7.5 1\n2 1 0 0 7.5 0 # two\n"
                                "\n3\t0 1e0 0 0 0\r\n4 0 0 1.0 0 0\n5 -1 -.5 -2 0 0\n# end";
static const char good_ele[] = "\n2 4 1 # cells\n10 1 2 3 4 8\n11 1 2 3 5 9\n# Generated by hand\n\n";

static void tetgen_files_are_read(void)
{
    static const char from_0[] = "4 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1";
    const double nodes[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, -0.5, -2 };
    const uint32_t cells[] = { 0, 1, 2, 3, 0, 1, 2, 4 };
    struct tetgen mesh;
    dpt_diag diag;
    CHECK(read(&mesh, good_node, sizeof good_node - 1, good_ele, sizeof good_ele - 1, &diag) == DPT_OK, "%s",
          diag.text);
    CHECK(mesh.node_count == 5 && mesh.cell_count == 2 && mesh.base == 1 && !memcmp(mesh.nodes, nodes, sizeof nodes) &&
              !memcmp(mesh.cells, cells, sizeof cells),
          "%u nodes, %u cells", mesh.node_count, mesh.cell_count);
    tetgen_free(&mesh);
    CHECK(read(&mesh, from_0, sizeof from_0 - 1, "1 4 0\n0 3 2 1 0", 15, &diag) == DPT_OK && mesh.base == 0 &&
              mesh.cells[0] == 3 && mesh.cells[3] == 0,
          "%s", diag.text);
    tetgen_free(&mesh);
}

static void wrong_tetgen_files_are_refused(void)
{
    static const char nodes[] = "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    static const char cell[] = "1 4 0\n1 1 2 3 4\n";
    const struct {
        const char *node, *ele;
        dpt_result code;
        uint64_t line;
        const char *text;
    } wrong[] = {
        { "", cell, DPT_E_TRUNCATED, 1, "ends before its counts" },
        { "# nothing\n\n", cell, DPT_E_TRUNCATED, 3, "ends before its counts" },
        { "four 3 0 0\n", cell, DPT_E_SYNTAX, 1, "the number of nodes is 'four': not an integer" },
        { "4\n", cell, DPT_E_SYNTAX, 1, "the line ends where the dimension should be" },
        { "4 2 0 0\n1 0 0\n", cell, DPT_E_FORMAT, 1, "the dimension is 2: only 3 is read" },
        { "0 3 0 0\n", cell, DPT_E_EMPTY, 1, "the number of nodes is 0" },
        { "-4 3 0 0\n", cell, DPT_E_EMPTY, 1, "the number of nodes is -4" },
        { "1000000000 3 0 0\n1 0 0 0\n", cell, DPT_E_TRUNCATED, 1, "do not fit in" },
        { "2 3 0 0\n1 0 0 0 0 0 0\n\n", cell, DPT_E_TRUNCATED, 4, "ends after 1 of 2 nodes" },
        { "2 3 0 0\n2 0 0 0\n3 0 0 0\n", cell, DPT_E_SYNTAX, 2, "has the number 2, not 0 or 1" },
        { "2 3 0 0\n1 0 0 0\n3 0 0 0\n", cell, DPT_E_SYNTAX, 3, "node 3 follows node 1" },
        { "2 3 0 0\n1 0 0 0\n1 0 0 0\n", cell, DPT_E_SYNTAX, 3, "node 1 follows node 1" },
        { "1 3 0 0\n1 0 y 0\n", cell, DPT_E_SYNTAX, 2, "y is 'y': not a number" },
        { "1 3 0 0\n1 0 0 # 0\n", cell, DPT_E_SYNTAX, 2, "the line ends where z should be" },
        { "1 3 0 0\n1 0 nan 0\n", cell, DPT_E_FINITE, 2, "y is nan: not a finite number" },
        { "1 3 0 0\n1 0 0 500001\n", cell, DPT_E_FINITE, 2, "z of node 1 is 500001 (times 2)" },
        { "1 3 0 0\n1 0 0 0\n2 0 0 0\n", cell, DPT_E_TRAILING, 3, "follows the last of 1 nodes" },
        { nodes, "", DPT_E_TRUNCATED, 1, "ends before its counts" },
        { nodes, "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n", DPT_E_FORMAT, 1, "the nodes of a cell is 10: only 4 is read" },
        { nodes, "0 4 0\n", DPT_E_EMPTY, 1, "the number of cells is 0" },
        { nodes, "3 4 0\n1 1 2 3 4\n", DPT_E_TRUNCATED, 1, "3 cells do not fit in" },
        { nodes, "2 4 0\n1 1 2 3 4 # and no more\n", DPT_E_TRUNCATED, 3, "ends after 1 of 2 cells" },
        { nodes, "1 4 0\n1 1 2 3\n  ", DPT_E_SYNTAX, 2, "the line ends where a node should be" },
        { nodes, "1 4 0\n1 1 2 3 4.5\n", DPT_E_SYNTAX, 2, "a node is '4.5': not an integer" },
        { nodes, "1 4 0\n\n7 1 2 3 5\n", DPT_E_INDEX, 3, "cell 7 names node 5: there are 4, counted from 1" },
        { nodes, "1 4 0\n7 0 2 3 4\n", DPT_E_INDEX, 2, "cell 7 names node 0" },
        { nodes, "1 4 0\n7 1 2 3 -1\n", DPT_E_INDEX, 2, "cell 7 names node -1" },
        { nodes, "1 4 0\n7 1 2 3 3\n", DPT_E_FINITE, 2, "cell 7 has no volume" },
        { nodes, "1 4 0\n1 1 2 3 4\n2 1 2 3 4\n", DPT_E_TRAILING, 3, "the last of 1 cells" },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct tetgen mesh;
        dpt_diag diag;
        const dpt_result result =
            read(&mesh, wrong[i].node, strlen(wrong[i].node), wrong[i].ele, strlen(wrong[i].ele), &diag);
        CHECK(result == wrong[i].code && diag.code == result && diag.line == wrong[i].line &&
                  strstr(diag.text, wrong[i].text),
              "row %zu: %s in line %u: %s", i, dpt_result_name(result), (unsigned)diag.line, diag.text);
        tetgen_free(&mesh);
    }
}

/* Cut anywhere, a file is refused or complete; no byte behind its end is read. */
static void cut_tetgen_files_do_no_harm(void)
{
    struct tetgen mesh;
    dpt_diag diag;
    uint32_t good = 0;
    for (size_t size = 0; size < sizeof good_node; size++) {
        good += read(&mesh, good_node, size, good_ele, sizeof good_ele - 1, &diag) == DPT_OK;
        CHECK(diag.code == DPT_OK || (diag.line > 0 && diag.text[0]), "%zu bytes", size);
        tetgen_free(&mesh);
    }
    for (size_t size = 0; size < sizeof good_ele; size++) {
        good += read(&mesh, good_node, sizeof good_node - 1, good_ele, size, &diag) == DPT_OK;
        tetgen_free(&mesh);
    }
    CHECK(good > 20 && good < 80, "%u are whole", good);
}

int main(void)
{
    TEST(wrong_cells_are_refused);
    TEST(the_first_vertex_is_told);
    TEST(tetgen_files_are_read);
    TEST(wrong_tetgen_files_are_refused);
    TEST(cut_tetgen_files_do_no_harm);
    return check_report();
}
