/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a tick costs in a loop that does something else between ticks. A tool of 0.15 m with a radius of 2 mm slides over a
 * mesh at 0.1 m/s: 1 mm above it for the nearest pair, else pressed in by 5 mm. Three worlds take the same ticks, CHUNK at a
 * time in turns: back to back, with other memory of MEMORY bytes read for 1 ms before each tick, and asleep for 1 ms before
 * each. A CSV: mesh, triangles, what is asked for, pause, and the step's ns, median and 99 %.
 *
 *     pauses [TICKS=2000]
 */
#define _GNU_SOURCE
#include <stdio.h>

#include "lib/rig.h"
#include "lib/solid.h"
#include "timing.h"

enum { CHUNK = 100, MEMORY = 4 << 20, LINE = 64 };
#define PAUSE  1e6 /* ns */
#define LENGTH 0.15
#define RADIUS 0.002
#define DEEP   0.005

enum pause { BACK_TO_BACK, READING, ASLEEP, PAUSES };
static const char *const pause_names[PAUSES] = { "none", "reading", "asleep" };

static const struct row {
    const char *name;
    uint32_t until, law, max_contacts;
    double friction;
    int is_deep;
} rows[] = { { "nearest pair", DPT_UNTIL_TRACK, DPT_LAW_POINT, 0, 0.0, 0 },
             { "depth", DPT_UNTIL_CONTACT, DPT_LAW_POINT, 0, 0.0, 1 },
             { "contacts", DPT_UNTIL_CONTACT, DPT_LAW_POINT, 32, 0.0, 1 },
             { "proxy", DPT_UNTIL_RESPOND, DPT_LAW_PROXY, 0, 0.0, 1 },
             { "proxy with friction", DPT_UNTIL_RESPOND, DPT_LAW_PROXY, 0, 0.3, 1 } };

static volatile unsigned char other[MEMORY];

static void pass_time(enum pause pause)
{
    const struct timespec sleep = { 0, (long)PAUSE };
    const double until = now() + PAUSE;
    if (pause == ASLEEP)
        nanosleep(&sleep, NULL);
    while (pause == READING && now() < until)
        for (int i = 0; i < MEMORY; i += LINE)
            (void)other[i];
}

static void make_ways(const struct solid *solid, int ticks, double (*above)[6], double (*deep)[6])
{
    struct slide slide;
    slide_begin(&slide, solid, 3, LENGTH, RADIUS);
    slide.gap = 0.001;
    slide.step = 1e-4;
    slide.spin = 1e-3;
    for (int i = 0; i < ticks; i++) {
        dpt_hit hit = { .size = sizeof hit };
        slide_step(&slide);
        if (dpt_query_segments(solid->mesh, NULL, slide.ends, NULL, 1, &hit, NULL))
            exit(2);
        for (int k = 0; k < 6; k++) {
            const double way_out = (hit.p[k % 3] - hit.q[k % 3]) / hit.distance;
            above[i][k] = slide.ends[k];
            deep[i][k] = slide.ends[k] - (hit.distance - RADIUS + DEEP) * way_out;
        }
    }
}

static void open_world(struct rig *rig, const dpt_mesh *mesh, const struct row *row)
{
    dpt_body_settings settings = { .size = sizeof settings };
    dpt_world_def def = rig_def(row->law);
    def.until = row->until;
    def.max_contacts = row->max_contacts;
    if (!rig_open(rig, &def, mesh, &rig_point, 1) || dpt_body_get_settings(rig->world, rig->body, &settings))
        exit(2);
    settings.static_friction = settings.kinetic_friction = row->friction;
    if (dpt_body_set_settings(rig->world, rig->body, &settings))
        exit(2);
}

/* One tick, from the ends as a pose of a tool along x; ns. */
static double tick(const struct rig *rig, const double ends[6])
{
    const double u[3] = { (ends[3] - ends[0]) / LENGTH, (ends[4] - ends[1]) / LENGTH, (ends[5] - ends[2]) / LENGTH };
    dpt_pose pose = { { ends[0], ends[1], ends[2] }, { 1.0 + u[0], 0.0, -u[2], u[1] } };
    const double size = sqrt(2.0 + 2.0 * u[0]);
    for (int k = 0; k < 4; k++)
        pose.orientation[k] /= size;
    const double begin = now();
    if (dpt_tool_set_pose(rig->world, rig->tool, &pose) || dpt_world_step(rig->world, 1e-3, NULL))
        exit(2);
    return now() - begin;
}

static void measure(const struct solid *solid, const struct row *row, int ticks, double (*way)[6], double (*above)[6])
{
    const dpt_segment segment = { { 0.0, 0.0, 0.0 }, { LENGTH, 0.0, 0.0 }, RADIUS };
    struct rig rig[PAUSES];
    double *took[PAUSES];
    for (int p = 0; p < PAUSES; p++) {
        took[p] = malloc((size_t)ticks * sizeof *took[p]);
        open_world(&rig[p], solid->mesh, row);
        if (!took[p] || dpt_tool_set_segments(rig[p].world, rig[p].tool, &segment, 1))
            exit(2);
        for (int i = 0; i < 100; i++) { /* down from above */
            double ends[6];
            for (int k = 0; k < 6; k++)
                ends[k] = above[0][k] + 0.01 * i * (way[0][k] - above[0][k]);
            tick(&rig[p], ends);
        }
    }
    for (int from = 0; from < ticks; from += CHUNK)
        for (enum pause p = BACK_TO_BACK; p < PAUSES; p++)
            for (int i = from; i < ticks && i < from + CHUNK; i++) {
                pass_time(p);
                took[p][i] = tick(&rig[p], way[i]);
            }
    for (int p = 0; p < PAUSES; p++) {
        qsort(took[p], (size_t)ticks, sizeof *took[p], by_size);
        printf("%s,%u,%s,%s,%.0f,%.0f\n", solid->name, solid->info.triangles, row->name, pause_names[p],
               took[p][ticks / 2], took[p][(int)(0.99 * ticks)]);
        free(took[p]);
        rig_close(&rig[p]);
    }
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        uint64_t triangles;
    } shapes[] = { { "liver", 50332 }, { "torus", 5568 }, { "torus", 61358 }, { "torus", 1000000 } };
    const int ticks = argc > 1 ? atoi(argv[1]) : 2000;
    double(*above)[6], (*deep)[6];
    if (ticks < 1)
        return 2;
    above = malloc((size_t)ticks * sizeof *above);
    deep = malloc((size_t)ticks * sizeof *deep);
    puts("mesh,triangles,what,pause,median_ns,p99_ns");
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++) {
        struct solid solid;
        if (!above || !deep || !solid_from_shape(&solid, shapes[i].name, shapes[i].triangles))
            return 2;
        make_ways(&solid, ticks, above, deep);
        for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r++)
            measure(&solid, &rows[r], ticks, rows[r].is_deep ? deep : above, above);
        solid_close(&solid);
    }
    free(above);
    free(deep);
    return 0;
}
