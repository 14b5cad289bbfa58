/* SPDX-License-Identifier: BSD-3-Clause */
/* The file of a plan, JSON (docs/plan.md): written by `plan -o`, read by `replay` and `run`. */
#ifndef DPT_TOOLS_PLAN_FILE_H
#define DPT_TOOLS_PLAN_FILE_H

#include "cli/command_options.h"
#include "measure/judgement.h"
#include "measure/measure_setting.h"
#include "scene/file_identity.h"

/*
 * What a scene needs: what was asked, the setting that was chosen, what it was measured to do, and what is promised of it
 * (docs/plan.md).
 */

/* Of ticks, at most one in so many may be unknown. */
#define PLAN_UNKNOWN_ONE_IN 10000

/* Of a period: what 999 ticks of 1000 may take. */
#define PLAN_TIME_SHARE 0.5

/* What was seen counts so many times for a capacity. */
#define PLAN_HEADROOM 1.5

/* Where something gives way. */
#define PLAN_SOFT_HEADROOM 3.0

/* And for a budget: so much larger may the largest tick of another trace be (docs/plan.md). It costs only that tick. */
#define PLAN_BUDGET_HEADROOM 3.0

/* From a budget that breaks a bound to the next one. */
#define PLAN_BUDGET_RAISE 1.4142135623730951

/*
 * Ends no step. A world with a budget, however large, searches in another order than one without, and where a proxy rests
 * may differ in the last digits: plans have a budget, and so has what they are held against.
 */
#define PLAN_BUDGET_AMPLE UINT32_MAX

/* So much faster than the fastest motion of its trace a plan holds. */
#define PLAN_SPEED_FACTOR 1.5

/* How many times stiffer the loop with the device could be before it shakes. */
#define PLAN_GAIN_MARGIN 1.5

/* Of the file. */
enum { PLAN_FORMAT = 1 };

/* Units at 99.9 % may rise to so many times those of the richest setting where memory is saved. */
#define PLAN_WORK_FACTOR 1.1

/* What a setting has to keep, in the order in which it is looked at. */
enum plan_bound {
    PLAN_HOLDS, /* none is broken */
    PLAN_STEPS, /* a step failed, as one of springs that are too stiff for it does */
    PLAN_BITS,  /* an answer is another one */
    PLAN_DISTANCE,
    PLAN_FORCE,
    PLAN_UNKNOWN,
    PLAN_CONTACTS, /* capacities */
    PLAN_STRIP,
    PLAN_WORK,
    PLAN_TIME,
    PLAN_BOUNDS
};

struct plan_asked {
    double error;       /* of distances, m */
    double force_error; /* of wrenches, N; INFINITY: no force is needed */
    double rate;        /* Hz */
};

/* What a setting did over a trace, or the worst over several. */
struct plan_figures {
    uint64_t ticks;
    uint64_t failed; /* ticks from the first step that failed on */
    double distance_error, force_error;
    uint64_t felt;                  /* ticks with a force, of this setting or the richest, that are judged */
    uint64_t near_folds;            /* ticks that are not in the force error, as they are within 5 of a fold */
    uint64_t unknown;               /* ticks that are not decided, where the richest setting is */
    uint32_t contacts, strip, work; /* the most in one tick */
    double work_p999, time_median, time_p999; /* units; s of a tick, with what gives way */
    uint64_t work_total, bytes;               /* bytes of the world, and of what gives way */
    double busy;                              /* measure_run.busy where it was measured; it is in no file */
};

/* Other programs took so much of the processor that what is left of them may show in the times. */
static inline int plan_was_busy(const struct plan_figures *figures)
{
    return figures->busy > 1.1;
}

/* What is promised: the limits of each bound. */
struct plan_limits {
    int same_bits;                   /* 1: no answer may differ at all, as what is cached must not be felt */
    double error, force_error, time; /* m, N, s */
    double work;                     /* units at 99.9 % */
    uint32_t contacts, strip;
};

/*
 * The traces: the half by which is chosen, the other half, and that one backwards and faster. Where the trace is made, two
 * more of as many ticks as a half, of other seeds.
 */
enum {
    PLAN_FIRST_HALF,
    PLAN_SECOND_HALF,
    PLAN_BACKWARDS,
    PLAN_OTHER,
    PLAN_ANOTHER,
    PLAN_TRACES,
    PLAN_TRACES_OF_FILE = PLAN_OTHER
};

/* A setting beside the chosen one: what was changed, into what, and what that did. */
struct plan_neighbour {
    char knob[48], value[48]; /* "": there is none */
    enum plan_bound broken;
    int trace; /* PLAN_FIRST_HALF, ...: where that was measured */
    struct measure_setting setting;
    struct plan_figures figures;
};

enum { PLAN_MESHES_MAX = 64 };

/* Of a mesh: its triangles, and the CRC-32 of its vertices and corners. */
struct plan_mesh {
    uint32_t triangles, crc32;
};

/* The trace: of the hand of `dynpoint make trace`, or of a file. */
struct plan_motion {
    char *file; /* NULL: made */
    uint64_t seed, ticks;
    double speed; /* the fastest of an end, m/s */
};

struct plan {
    struct plan_asked asked;
    char *scene; /* as it was given: a path from the folder in which the program runs, or a name */
    struct file_identity identity;
    double length, radius; /* of the stylus, m; NAN: the tool is no stylus */
    struct plan_mesh mesh[PLAN_MESHES_MAX];
    uint32_t mesh_count;
    struct plan_motion motion;
    struct measure_setting setting;
    double thinnest; /* wall of all bodies, m; 0: there is none */
    double quantum;  /* step of the device's positions, in the scene, m */
    char *device;    /* file of its dynamics; NULL: none was given, and nothing is said of stability */
    double stable;   /* N/m at the hand, without a margin; 0: not known */
    struct plan_limits limits;
    struct plan_figures figures; /* the worst over the traces by which it was verified */
    struct plan_neighbour cheaper, better;
    struct measure_machine machine;
};

void plan_free(struct plan *plan);

/* A text of its own, for the caller to free; NULL if memory ran out. */
char *copy_text(const char *text);

/* How many ticks may be unknown. */
uint64_t plan_unknown_limit(uint64_t ticks);

/* The first bound that is broken; with_time 0: time is not looked at. */
enum plan_bound plan_judge(const struct plan_limits *limits, const struct plan_figures *figures, int with_time);

/* What is broken, for people: "the force is 0.31 N off, 0.05 were asked for". */
struct plan_text {
    char text[160];
};
struct plan_text plan_broken_text(const struct plan_limits *limits, const struct plan_figures *figures,
                                  enum plan_bound bound);

/* The worse of two, number by number; ticks and units are added up. */
void plan_figures_join(struct plan_figures *figures, const struct plan_figures *other);

/* How far a plan is, on a terminal: each measurement goes a quarter of the way to where the next part of it begins. */
struct plan_progress {
    struct meter meter;
    double at, until; /* 0..1 of all */
};

/*
 * A trace by which settings are measured: the richest setting over it once, and then others beside that. Close it also
 * after a failure. Calls return 0, or 2 after a message.
 *   richest         measure_setting_richest, with an ample budget
 *   bench_open      `setting` says what is felt: law, stiffness, margin, ...
 *   bench_measure   `passes` of which the least time counts
 */
struct plan_bench {
    struct plan_progress
        *progress; /* the caller sets it before plan_bench_open; NULL: each measurement shows its own */
    const struct scene *scene;
    const struct csv_table *trace;
    struct measure_run reference;
    size_t unknown;     /* ticks of the reference */
    double wrench_peak; /* its largest wrench, N */
    struct plan_figures richest;
};
struct measure_setting plan_richest(const struct measure_setting *setting, const struct scene *scene);
int plan_bench_open(struct plan_bench *bench, const struct scene *scene, const struct csv_table *trace,
                    const struct measure_setting *setting);
int plan_bench_measure(const struct plan_bench *bench, const struct measure_setting *setting, uint32_t passes,
                       struct plan_figures *figures);
void plan_bench_close(struct plan_bench *bench);

/* Words of the file, each list ended with NULL, in the order of their numbers. */
extern const char *const plan_integrator_words[]; /* DPT_INTEGRATOR_... and last "scene" */
extern const char *const plan_bound_words[];      /* enum plan_bound */
extern const char *const plan_trace_words[];      /* PLAN_FIRST_HALF, ... */

/* Write it. The caller checks the file's error flag. */
void plan_file_write(FILE *file, const struct plan *plan);

/*
 * Read a file. Returns 0, or 2 after a message that names the file, the place and the reason; always 2 in a build without
 * jansson. plan_free frees it, also after a failure.
 */
int plan_file_read(struct plan *plan, const char *command, const char *path);

/* Read a text. Returns 1, or 0 after filling the fault. Free the plan also then. For plan_file_read, where there is JSON. */
struct json_fault;
int plan_file_parse(struct plan *plan, const char *text, size_t size, struct json_fault *fault);

#endif
