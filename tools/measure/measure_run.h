/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Run a setting over a scene and a trace, and keep the answers and the cost of every tick.
 *
 *     struct measure_setting setting;
 *     struct measure_run run;
 *     measure_setting_init(&setting, &scene);          a scene that scene_open opened; it needs no world
 *     setting.world.budget = 800;
 *     status = measure_run(&run, &scene, &trace, &setting, &(struct measure_effort){ .passes = 3 });
 *     ... run.tick[i], run.work ...
 *     measure_run_free(&run);
 *
 * The same arguments give the same answers, bit for bit, in every pass and on every machine; only times differ.
 */
#ifndef DPT_TOOLS_MEASURE_RUN_H
#define DPT_TOOLS_MEASURE_RUN_H

#include <stddef.h>
#include <stdint.h>

#include "cli/command_options.h"
#include "csv.h"
#include "measure/measure_setting.h"

/* The answers of a tick: those of dpt_hit and dpt_force_info after its step. A stale answer is not to be used. */
struct measure_tick {
    double distance; /* of the device's axis, m */
    double gap;      /* of its surface, m; NAN where it is not known, as under a proxy that is held back */
    /* N: the force, and the torque about the tool's centre over rho: |W| is its length. Zeros without a response. */
    double wrench[6];
    double lag;       /* of the proxy, m */
    uint32_t work;    /* units of the whole step */
    uint32_t ns;      /* of the step alone; the least of all passes */
    uint32_t soft_ns; /* of physics behind it, likewise; 0 where nothing gives way */
    uint8_t status;   /* DPT_STATUS_... */
    uint8_t contact;  /* DPT_CONTACT_... */
    uint8_t hit_flags, force_reason, force_flags;
    uint8_t is_jump;   /* the trace jumps to this tick */
    uint16_t contacts; /* 65535: so many, or more */
};

/* Distances against brute force in double, over the triangles as they lie in that tick, by another world. */
struct measure_check {
    size_t every; /* that many ticks; 0: nothing was checked */
    size_t ticks, wrong;
    double tolerance, error; /* m: beyond the first an answer is wrong; the largest of all */
    uint32_t *ns;            /* what brute force took for each of these ticks; the run's own */
    uint32_t work;           /* its units in one of them, the most */
    uint32_t searches;       /* of which the least time counts */
};

struct measure_run {
    struct measure_setting setting;
    struct measure_tick *tick;
    size_t ticks;
    /* Not DPT_OK: this tick failed, as physics does that is too stiff, and it and all that follow are stale. */
    dpt_result failure;
    size_t failed_tick;
    size_t world_bytes;
    size_t body_bytes;    /* of what gives way: shape and physics */
    size_t mesh_bytes;    /* of all meshes, used in place */
    dpt_world_info usage; /* for capacities */
    uint32_t kernel;      /* DPT_KERNEL_... */
    double diagonal;      /* of the largest mesh's box, m */
    double busy;          /* how many times as long all passes took by the clock as of the processor's time */
    struct measure_check check;
};

/* How much to spend on a run. */
struct measure_effort {
    uint32_t passes;   /* times are the least of so many; at least 1 */
    int by_processor;  /* 1: the processor's time counts where it is less than the clock's: other programs do not */
    size_t every;      /* check one tick in this many by brute force; 0: none */
    uint32_t searches; /* brute force's times are the least of so many; 0: one */
    /* Progress on a terminal, from `begin` to `end` of all, 0..1, under this name; NULL: none. */
    struct meter *meter;
    const char *name;
    double begin, end;
};

/*
 * Returns 0, or 2 after a message: memory ran out, or the scene cannot be felt like that (measure_setting_fault). Free the
 * run also then.
 */
int measure_run(struct measure_run *run, const struct scene *scene, const struct csv_table *trace,
                const struct measure_setting *setting, const struct measure_effort *effort);
void measure_run_free(struct measure_run *run);

/* An `every` for which brute force on a trace of this scene takes about a second. */
size_t measure_check_every(const struct scene *scene, const struct csv_table *trace);

/* |W| of a wrench as it is told above, N. */
double measure_wrench_size(const double wrench[6]);

/* A histogram of the ticks' times, or of their work. Peers count their times in the same bins (tests/bench/peer.h). */

enum tick_histogram_of { TICK_HISTOGRAM_NS, TICK_HISTOGRAM_WORK, TICK_HISTOGRAMS };

/* In files and in JSON: "ns" and "work". */
extern const char *const tick_histogram_words[TICK_HISTOGRAMS];

enum { TICK_HISTOGRAM_EDGES = 8 * 16 + 1 };

/* Bin 0 counts values below the first edge, bin i what is at or above edge i - 1 and below edge i, the last all beyond. */
struct tick_histogram {
    uint32_t bin[TICK_HISTOGRAM_EDGES + 1];
};

/* The edges: whole numbers, 8 to a doubling from 16 ns on, or 4 from 1 unit on. Returns how many; there is one bin more. */
int tick_histogram_edges(enum tick_histogram_of of, double edges[TICK_HISTOGRAM_EDGES]);

/* Count sorted numbers. The bins add up to their count. */
struct tick_histogram tick_histogram_count(enum tick_histogram_of of, const double *sorted, size_t count);

/* The second world of a measure_run: the same bodies as they lie now, searched triangle by triangle in double. */
struct measure_brute {
    struct scene_stage stage;
    uint32_t segments;
    uint32_t body_count;
    uint32_t searches; /* a comparison; the least time counts */
    uint32_t ns, work; /* of the last comparison */
    /* Of each body: its id, and its memory if it gives way. */
    dpt_body id[DPT_ARM_BODIES_MAX];
    void *body_block[DPT_ARM_BODIES_MAX];
};

/* After the bodies were added to the world that is checked. Close it also after a failure. */
dpt_result measure_brute_open(struct measure_brute *brute, const struct scene_bodies *bodies,
                              const struct measure_tool *tool, uint32_t searches);
void measure_brute_close(struct measure_brute *brute);

/*
 * By how much the world's distances of the tool's segments, of the step just taken, differ from those of all triangles, m.
 * Tips are not looked at.
 */
dpt_result measure_brute_compare(struct measure_brute *brute, const struct scene_bodies *bodies,
                                 const struct measure_tool *tool, const dpt_world *world, dpt_tool id, double *error);

#endif
