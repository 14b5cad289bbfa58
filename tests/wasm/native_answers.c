/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What the native library answers along a trace, as the bytes of its structs; layer_answers.js asks the same of the
 * WebAssembly module, in the same order.
 *
 *     native_answers MESH.dpa TRACE.csv LAW KERNEL [repeat]
 *
 * LAW and KERNEL are numbers of the headers. A mesh with springs is a body that deforms, stepped in each tick. Standard
 * output: for each tick the hit, the wrench, the force report, how many contacts there are, and these; after every 64th tick a
 * snapshot. Standard error: the kernel, and the microseconds that a tick took, of the fastest of `repeat` passes.
 */
#include <dynpoint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CONTACTS_MAX = 32, SNAPSHOT_EVERY = 64, ROWS_MAX = 1 << 16 };

static double rows[ROWS_MAX][7];

static void must(int is_good, const char *what)
{
    if (is_good)
        return;
    fprintf(stderr, "native_answers: %s\n", what);
    exit(2);
}

static void *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    must(file && fseek(file, 0, SEEK_END) == 0, path);
    *size = (size_t)ftell(file);
    rewind(file);
    void *bytes = malloc(*size + 8);
    must(bytes && fread(bytes, 1, *size, file) == *size, path);
    fclose(file);
    return bytes;
}

static int read_trace(const char *path)
{
    char line[512];
    int count = 0;
    FILE *file = fopen(path, "r");
    must(file && fgets(line, sizeof line, file) != NULL, path);
    while (count < ROWS_MAX && fgets(line, sizeof line, file)) {
        char *at = line;
        for (int k = 0; k < 7; k++, at++)
            rows[count][k] = strtod(at, &at);
        count++;
    }
    fclose(file);
    return count;
}

static void put(const void *bytes, size_t size, FILE *out)
{
    if (out)
        must(fwrite(bytes, 1, size, out) == size, "standard output");
}

static void put_tick(dpt_world *world, dpt_tool tool, FILE *out)
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_wrench wrench;
    dpt_force_info report = { .size = sizeof report };
    static dpt_contact contacts[CONTACTS_MAX];
    uint32_t count;
    contacts[0].size = sizeof contacts[0];
    must(!dpt_tool_get_hit(world, tool, &hit) && !dpt_tool_get_wrench(world, tool, &wrench) &&
             !dpt_tool_get_force_info(world, tool, &report) &&
             !dpt_tool_get_contacts(world, tool, contacts, CONTACTS_MAX, &count),
         "an answer");
    put(&hit, sizeof hit, out);
    put(&wrench, sizeof wrench, out);
    put(&report, sizeof report, out);
    put(&count, sizeof count, out);
    put(contacts, count * sizeof contacts[0], out);
}

static void put_snapshot(const dpt_world *world, FILE *out)
{
    const size_t room = dpt_snapshot_bytes(world, NULL);
    void *block = malloc(room);
    size_t bytes;
    must(block && !dpt_world_take_snapshot(world, NULL, block, room, &bytes), "a snapshot");
    put(block, bytes, out);
    free(block);
}

static dpt_springs *add_body(dpt_world *world, const dpt_mesh *mesh, dpt_body *body, void *blocks[2])
{
    dpt_mesh_springs net = { .size = sizeof net };
    dpt_deformable_def def;
    dpt_springs_def springs_def;
    dpt_springs *springs;
    must(!dpt_mesh_get_springs(mesh, &net), "the springs");
    if (net.nodes == 0) {
        must(!dpt_body_add(world, mesh, NULL, body), "the body");
        return NULL;
    }
    dpt_deformable_def_init(&def);
    def.mesh = mesh;
    blocks[0] = malloc(dpt_deformable_bytes(&def));
    dpt_springs_def_init(&springs_def);
    springs_def.mesh = mesh;
    blocks[1] = malloc(dpt_springs_bytes(&springs_def));
    must(blocks[0] && blocks[1] && !dpt_body_add_deformable(world, blocks[0], dpt_deformable_bytes(&def), &def, body) &&
             !dpt_springs_create(blocks[1], dpt_springs_bytes(&springs_def), &springs_def, &springs),
         "the body");
    return springs;
}

/* s: the time of all ticks. out: NULL to look at the time alone */
static double run(const dpt_mesh *mesh, int count, uint32_t law, uint32_t kernel, FILE *out)
{
    dpt_world_def def;
    dpt_world *world;
    dpt_tool tool;
    dpt_body body;
    void *blocks[2] = { NULL, NULL };
    dpt_segment segment = { { 0, 0, 0 }, { 0, 0, 0.1 }, 0.002 };
    dpt_world_def_init(&def);
    def.law = law;
    def.max_contacts = 32;
    def.kernel = kernel;
    void *block = malloc(dpt_world_bytes(&def));
    must(block && !dpt_world_create(block, dpt_world_bytes(&def), &def, &world), "the world");
    dpt_springs *springs = add_body(world, mesh, &body, blocks);
    must(!dpt_tool_add(world, &segment, 1, &tool), "the tool");
    /* As the module's layer: a report reads the hits, so their search is part of the step's work. */
    dpt_step report = { .size = sizeof report };
    const clock_t begin = clock();
    for (int row = 0; row < count; row++) {
        memcpy(segment.a, rows[row] + 1, sizeof segment.a);
        memcpy(segment.b, rows[row] + 4, sizeof segment.b);
        must(!dpt_tool_set_segments(world, tool, &segment, 1) && !dpt_world_step(world, 0.001, &report), "a step");
        if (springs)
            must(!dpt_body_step_springs(world, body, springs, 0.001, NULL), "the springs' step");
        put_tick(world, tool, out);
        if (out && row % SNAPSHOT_EVERY == 0)
            put_snapshot(world, out);
    }
    const clock_t end = clock();
    dpt_world_info info = { .size = sizeof info };
    dpt_world_get_info(world, &info);
    fprintf(stderr, "%s ", dpt_kernel_name(info.kernel));
    free(block);
    free(blocks[0]);
    free(blocks[1]);
    return (double)(end - begin) / CLOCKS_PER_SEC;
}

int main(int argc, char **argv)
{
    size_t size;
    const dpt_mesh *mesh;
    must(argc >= 5, "MESH.dpa TRACE.csv LAW KERNEL [repeat]");
    void *file = read_file(argv[1], &size);
    must(!dpt_mesh_open(file, size, &mesh), argv[1]);
    const int count = read_trace(argv[2]), passes = argc > 5 ? atoi(argv[5]) : 0;
    const uint32_t law = (uint32_t)atoi(argv[3]), kernel = (uint32_t)atoi(argv[4]);
    double least = run(mesh, count, law, kernel, passes ? NULL : stdout);
    for (int pass = 1; pass < passes; pass++) {
        const double took = run(mesh, count, law, kernel, NULL);
        least = took < least ? took : least;
    }
    fprintf(stderr, "%.3f\n", 1e6 * least / count);
    free(file);
    return 0;
}
