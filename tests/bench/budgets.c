/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What contact costs and what it is worth with a budget: `budgets NAME MESH.dpa TRACE.csv` prints CSV, a row a budget, the
 * last one without (0). Times in ns of the step until contact, least of three passes a tick, the first tick apart. Of the
 * ticks on which a world without a budget finds regions: `unknown` those whose contact is not decided, `coarse` those that
 * are and say that a region is, `off` those that are
 * not decided or whose overlap or thrust differs by more than 2 % of the largest overlap; `gap_off` is the largest difference of a gap that is told, over the mesh's diagonal.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/timing.h"
#include "dynpoint.h"

enum { TICKS_MAX = 100000, CONTACTS = 32, PASSES = 3 };

/* What is felt on a tick. */
struct felt {
    double gap, overlap, thrust[3];
    uint32_t known, regions, coarse;
};

static void *read_file(const char *path, size_t *bytes_read)
{
    FILE *file = fopen(path, "rb");
    void *bytes = NULL;
    long size = -1;
    int here = file && fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) > 0 && fseek(file, 0, SEEK_SET) == 0 &&
               !posix_memalign(&bytes, 64, (size_t)size);
    if (!here || fread(bytes, (size_t)size, 1, file) != 1) {
        fprintf(stderr, "budgets: %s cannot be read\n", path);
        exit(2);
    }
    fclose(file);
    *bytes_read = (size_t)size;
    return bytes;
}

static size_t read_trace(const char *path, dpt_segment *segments)
{
    FILE *file = fopen(path, "r");
    char line[512];
    size_t ticks = 0;
    while (file && ticks < TICKS_MAX && fgets(line, sizeof line, file)) {
        double *a = segments[ticks].a, *b = segments[ticks].b;
        segments[ticks].radius = 0.0;
        ticks += sscanf(line, "%*[^,],%lf,%lf,%lf,%lf,%lf,%lf", a, a + 1, a + 2, b, b + 1, b + 2) == 6;
    }
    if (file)
        fclose(file);
    if (ticks < 2) {
        fprintf(stderr, "budgets: %s holds no motion\n", path);
        exit(2);
    }
    return ticks;
}

static void ask(const dpt_world *world, dpt_tool tool, struct felt *felt)
{
    dpt_contact contacts[CONTACTS] = { { .size = sizeof *contacts } };
    dpt_hit hit = DPT_HIT_INIT;
    uint32_t count;
    dpt_tool_get_hit(world, tool, &hit);
    dpt_tool_get_contacts(world, tool, contacts, CONTACTS, &count);
    *felt = (struct felt){ .gap = hit.gap, .known = hit.contact != DPT_CONTACT_UNKNOWN };
    felt->regions = felt->known ? count : 0;
    for (uint32_t i = 0; i < felt->regions; i++) {
        felt->overlap += contacts[i].overlap;
        felt->coarse |= contacts[i].flags & DPT_CONTACT_FLAG_COARSE;
        for (int k = 0; k < 3; k++)
            felt->thrust[k] += contacts[i].thrust[k];
    }
}

/* All passes of one budget. */
static void run(const dpt_mesh *mesh, const dpt_segment *segments, size_t ticks, uint32_t budget, struct felt *felt,
                double *ns)
{
    dpt_world_def def;
    dpt_world *world;
    dpt_body body;
    dpt_tool tool;
    dpt_world_def_init(&def);
    def.max_contacts = 32;
    def.law = DPT_LAW_POINT;
    def.budget = budget;
    def.until = DPT_UNTIL_CONTACT;
    void *block = malloc(dpt_world_bytes(&def));
    if (!block || dpt_world_create(block, dpt_world_bytes(&def), &def, &world) != DPT_OK ||
        dpt_body_add(world, mesh, NULL, &body) != DPT_OK || dpt_tool_add(world, segments, 1, &tool) != DPT_OK) {
        fprintf(stderr, "budgets: no world\n");
        exit(2);
    }
    for (int pass = 0; pass < PASSES; pass++) {
        dpt_world_reset(world);
        for (size_t i = 0; i < ticks; i++) {
            dpt_tool_set_segments(world, tool, &segments[i], 1);
            double begin = now();
            dpt_world_step(world, 0.001, NULL);
            double took = now() - begin;
            ns[i] = pass && ns[i] < took ? ns[i] : took;
            if (!pass)
                ask(world, tool, &felt[i]);
        }
    }
    free(block);
}

static int differs(const struct felt *felt, const struct felt *truth, double allowed)
{
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += pow(felt->thrust[k] - truth->thrust[k], 2.0);
    return !felt->known || fabs(felt->overlap - truth->overlap) > allowed || sqrt(square) > allowed;
}

int main(int argc, char **argv)
{
    static const uint32_t budgets[] = { 25, 50, 100, 200, 400, 800, 1600, 3200, 0 };
    static dpt_segment segments[TICKS_MAX];
    static struct felt truth[TICKS_MAX], felt[TICKS_MAX];
    static double ns[TICKS_MAX];
    if (argc != 4) {
        fprintf(stderr, "usage: budgets NAME MESH.dpa TRACE.csv\n");
        return 2;
    }
    size_t size;
    const dpt_mesh *mesh;
    const void *bytes = read_file(argv[2], &size);
    dpt_mesh_info info = { .size = sizeof info };
    if (dpt_mesh_open(bytes, size, &mesh) != DPT_OK || dpt_mesh_get_info(mesh, &info) != DPT_OK) {
        fprintf(stderr, "budgets: %s is no compiled mesh\n", argv[2]);
        return 2;
    }
    size_t ticks = read_trace(argv[3], segments), felt_ticks = 0;
    double peak = 0.0, diagonal = 0.0;
    for (int k = 0; k < 3; k++)
        diagonal += pow((double)info.box_max[k] - (double)info.box_min[k], 2.0);
    run(mesh, segments, ticks, 0, truth, ns);
    for (size_t i = 0; i < ticks; i++) {
        felt_ticks += truth[i].regions > 0;
        peak = fmax(peak, truth[i].overlap);
    }
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; b++) {
        size_t unknown = 0, coarse = 0, off = 0;
        double gap_off = 0.0;
        run(mesh, segments, ticks, budgets[b], felt, ns);
        for (size_t i = 0; i < ticks; i++) {
            if (felt[i].known && truth[i].known)
                gap_off = fmax(gap_off, fabs(felt[i].gap - truth[i].gap));
            if (!truth[i].regions)
                continue;
            unknown += !felt[i].known;
            coarse += felt[i].coarse != 0;
            off += differs(&felt[i], &truth[i], 0.02 * peak) != 0;
        }
        qsort(ns + 1, ticks - 1, sizeof *ns, by_size);
        printf("%s,%u,%u,%zu,%zu,%.0f,%.0f,%.0f,%zu,%zu,%zu,%.2g\n", argv[1], info.triangles, budgets[b], ticks,
               felt_ticks, ns[ticks / 2], ns[ticks - ticks / 100], ns[ticks - 1], unknown, coarse, off,
               gap_off / sqrt(diagonal));
        fflush(stdout);
    }
    return 0;
}
