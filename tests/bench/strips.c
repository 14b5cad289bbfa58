/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What strips cost: `strips MESH.dpa ...` prints CSV, medians in ns.
 *
 * A tool lies on the surface, about as long as so many edges (rings). Shadow, of width 0 and of 1 mm: `new`, at a random
 * place where no one has looked; `sliding`, next tick of a tool that moves at up to 0.17 m/s, at 1 kHz; `again`, the same
 * one. Route: from end to end, by the library, and by search over the paper's own graph, triangles that share a vertex,
 * from both ends and from one. Those are the yardstick, and `wrong` counts routes that are not as long as theirs.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/timing.h"
#include "dynpoint.h"
#include "mesh/mesh_format.h"

enum { PLACES = 300, SLIDES = 40, STEPS = 25 };

static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, by_size);
    return count ? values[count / 2] : 0.0;
}

static uint64_t seed = 1;

static double random_in(double low, double high)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

struct yard {
    const struct dpt_mesh *mesh;
    const uint32_t *corners, *first, *fans;
    uint32_t *mark; /* of a triangle: of which search, and at what distance */
    uint32_t *queue[2];
};

/* The number of triangles on a shortest route; `both`: from both ends. Marks are stamp * 2^16 + distance * 2 + side. */
static uint32_t search(struct yard *y, uint32_t from, uint32_t to, int both, uint32_t stamp)
{
    uint32_t head[2] = { 0, 0 }, tail[2] = { 1, 1 }, ring[2] = { 0, 0 };
    const uint32_t base = stamp << 16;
    if (from == to)
        return 1;
    y->queue[0][0] = from;
    y->queue[1][0] = to;
    y->mark[from] = base;
    y->mark[to] = base + 1;
    for (;;) {
        int side = both && tail[1] - head[1] < tail[0] - head[0];
        uint32_t end = tail[side];
        if (head[side] == end)
            return 0;
        for (; head[side] < end; head[side]++) {
            const uint32_t *corner = y->corners + 3 * (size_t)y->queue[side][head[side]];
            for (int k = 0; k < 3; k++)
                for (uint32_t i = y->first[corner[k]]; i < y->first[corner[k] + 1]; i++) {
                    uint32_t next = y->fans[i], mark = y->mark[next];
                    if (mark < base) {
                        y->mark[next] = base + 2 * (ring[side] + 1) + (uint32_t)side;
                        y->queue[side][tail[side]++] = next;
                    } else if ((int)(mark & 1) != side) {
                        return ring[side] + 2 + (mark - base) / 2;
                    }
                }
        }
        ring[side]++;
    }
}

struct place {
    double ends[6];
    dpt_hit hit;
    uint32_t from, to;
};

static dpt_hit nearest(const dpt_mesh *mesh, const double ends[6])
{
    dpt_hit hit = DPT_HIT_INIT;
    dpt_query_segments(mesh, NULL, ends, NULL, 1, &hit, NULL);
    return hit;
}

static uint32_t nearest_to(const dpt_mesh *mesh, const double point[3])
{
    double ends[6] = { point[0], point[1], point[2], point[0], point[1], point[2] };
    return nearest(mesh, ends).triangle;
}

/* A tool that lies on a random triangle, its middle a little above it. */
static struct place lie(const dpt_mesh *mesh, uint32_t triangles, double size)
{
    struct place place;
    double c[9], e[2][3], n[3], way[3], square = 0.0, area = 0.0;
    while (dpt_mesh_get_triangle(mesh, (uint32_t)random_in(0.0, triangles), c) != DPT_OK)
        ;
    for (int k = 0; k < 3; k++) {
        e[0][k] = c[3 + k] - c[k];
        e[1][k] = c[6 + k] - c[k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    double turn = random_in(0.0, 1.0);
    for (int k = 0; k < 3; k++) {
        way[k] = turn * e[0][k] + (1.0 - turn) * e[1][k];
        square += way[k] * way[k];
        area += n[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        double middle = (c[k] + c[3 + k] + c[6 + k]) / 3.0 + 0.02 * size * n[k] / sqrt(area);
        place.ends[k] = middle - 0.5 * size * way[k] / sqrt(square);
        place.ends[3 + k] = middle + 0.5 * size * way[k] / sqrt(square);
    }
    place.hit = nearest(mesh, place.ends);
    place.from = nearest_to(mesh, place.ends);
    place.to = nearest_to(mesh, place.ends + 3);
    return place;
}

static dpt_shadow shadow_of(const struct place *place, double size, double width)
{
    dpt_shadow shadow = { .size = sizeof shadow, .triangle = place->hit.triangle, .width = width, .depth = 0.5 * size };
    memcpy(shadow.segment.a, place->ends, sizeof shadow.segment.a);
    memcpy(shadow.segment.b, place->ends + 3, sizeof shadow.segment.b);
    for (int k = 0; k < 3; k++)
        shadow.direction[k] = place->hit.q[k] - place->hit.p[k];
    if (place->hit.flags & DPT_HIT_FLAG_CROSSING)
        shadow.direction[2] = 1.0;
    return shadow;
}

static double mean_edge(const dpt_mesh *mesh, uint32_t triangles)
{
    double sum = 0.0;
    for (int i = 0; i < 1000; i++) {
        double c[9], square = 0.0;
        if (dpt_mesh_get_triangle(mesh, (uint32_t)random_in(0.0, triangles), c) != DPT_OK)
            continue;
        for (int k = 0; k < 3; k++)
            square += (c[3 + k] - c[k]) * (c[3 + k] - c[k]);
        sum += sqrt(square);
    }
    return sum / 1000.0;
}

static void time_shadows(const dpt_mesh *mesh, dpt_strip *strip, uint32_t triangles, double size, double width,
                         int rings, const char *name)
{
    static double cold[PLACES], warm[SLIDES * STEPS], rest[PLACES], held[PLACES];
    uint32_t count = 0, flags;
    for (int i = 0; i < PLACES; i++) {
        struct place place = lie(mesh, triangles, size);
        dpt_shadow shadow = shadow_of(&place, size, width);
        double begin = now();
        dpt_strip_shadow(strip, mesh, NULL, &shadow);
        cold[i] = now() - begin;
        dpt_strip_get_triangles(strip, &count, &flags);
        held[i] = count;
        begin = now();
        dpt_strip_shadow(strip, mesh, NULL, &shadow);
        rest[i] = now() - begin;
    }
    for (int i = 0; i < SLIDES; i++) {
        struct place place = lie(mesh, triangles, size);
        double way[3];
        for (int k = 0; k < 3; k++)
            way[k] = random_in(-1e-4, 1e-4);
        for (int step = 0; step < STEPS; step++) {
            for (int k = 0; k < 6; k++)
                place.ends[k] += way[k % 3];
            place.hit = nearest(mesh, place.ends);
            dpt_shadow shadow = shadow_of(&place, size, width);
            double begin = now();
            dpt_strip_shadow(strip, mesh, NULL, &shadow);
            warm[i * STEPS + step] = now() - begin;
        }
    }
    printf("%s,%u,%d,shadow %s,%.0f,%.0f,%.0f,%.0f,,,\n", name, triangles, rings, width > 0.0 ? "1 mm" : "0",
           median(held, PLACES), median(cold, PLACES), median(warm, SLIDES * STEPS), median(rest, PLACES));
}

static void time_routes(const dpt_mesh *mesh, dpt_strip *strip, uint32_t triangles, double size, int rings,
                        const char *name)
{
    static double found[PLACES], both[PLACES], full[PLACES], steps[PLACES];
    struct yard y = {
        .mesh = mesh,
        .corners = mesh_words(mesh, MESH_TRIANGLES),
        .first = mesh_words(mesh, MESH_FAN_FIRST),
        .fans = mesh_words(mesh, MESH_FANS),
        .mark = calloc(triangles, 4),
        .queue = { malloc(4 * (size_t)triangles), malloc(4 * (size_t)triangles) },
    };
    const uint32_t *places = mesh_words(mesh, MESH_PLACES);
    uint32_t stamp = 0, wrong = 0, count;
    for (int i = 0; i < PLACES; i++) {
        struct place place = lie(mesh, triangles, size);
        double begin = now();
        dpt_strip_route(strip, mesh, place.from, place.to);
        found[i] = now() - begin;
        dpt_strip_get_triangles(strip, &count, NULL);
        begin = now();
        uint32_t way = search(&y, places[place.from], places[place.to], 1, ++stamp);
        both[i] = now() - begin;
        begin = now();
        wrong += search(&y, places[place.from], places[place.to], 0, ++stamp) != way;
        full[i] = now() - begin;
        wrong += way != count;
        steps[i] = count;
    }
    printf("%s,%u,%d,route,%.0f,%.0f,,,%.0f,%.0f,%u\n", name, triangles, rings, median(steps, PLACES),
           median(found, PLACES), median(both, PLACES), median(full, PLACES), wrong);
    free(y.mark);
    free(y.queue[0]);
    free(y.queue[1]);
}

int main(int argc, char **argv)
{
    dpt_strip_def def = { .size = sizeof def, .capacity = 4096, .search = 1 << 19 };
    dpt_strip *strip;
    void *block = malloc(dpt_strip_bytes(&def));
    dpt_strip_create(block, dpt_strip_bytes(&def), &def, &strip);
    puts("mesh,triangles,rings,strip,median_triangles,new,sliding,again,both_ends,one_end,wrong");
    for (int i = 1; i < argc; i++) {
        const dpt_mesh *mesh;
        FILE *file = fopen(argv[i], "rb");
        if (!file)
            return 2;
        fseek(file, 0, SEEK_END);
        size_t size = (size_t)ftell(file);
        void *bytes = malloc(size);
        rewind(file);
        if (fread(bytes, 1, size, file) != size || dpt_mesh_open(bytes, size, &mesh) != DPT_OK)
            return 2;
        fclose(file);
        const char *name = strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i];
        dpt_mesh_info info = { .size = sizeof info };
        dpt_mesh_get_info(mesh, &info);
        double edge = mean_edge(mesh, info.source_triangles);
        for (int rings = 8; rings <= 128; rings *= 4) {
            time_shadows(mesh, strip, info.triangles, rings * edge, 0.0, rings, name);
            time_shadows(mesh, strip, info.triangles, rings * edge, 0.001, rings, name);
            time_routes(mesh, strip, info.triangles, rings * edge, rings, name);
        }
        free(bytes);
    }
    return 0;
}
