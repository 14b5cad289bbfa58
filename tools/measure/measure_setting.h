/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One way to feel a scene: a method, a law, and every knob that costs time or accuracy. measure_run.h runs it, and
 * judgement.h holds what came of it against another.
 */
#ifndef DPT_TOOLS_MEASURE_SETTING_H
#define DPT_TOOLS_MEASURE_SETTING_H

#include <stdint.h>

#include "csv.h"
#include "dynpoint/baseline.h"
#include "dynpoint/types.h"
#include "scene/scene.h"

/* A plain value: copy it, and change the copy. */
struct measure_setting {
    /*
     * Method, until, law, stiffness, budgets, memory, margin, contacts, strips, smooth normals: as world.h says. How many
     * bodies, tools, segments and tips there are is the scene's. `baseline` is not used.
     */
    dpt_world_def world;
    uint32_t parts, one_step; /* of DPT_METHOD_PAPER, as in dpt_baseline_def */
    double friction;          /* of all bodies; NAN: each has its own */
    double damping;           /* of the proxy's spring, Ns/m */
    uint32_t lock_rotation;   /* 1: for a device without torque, as in dpt_tool_settings; 0 */
    uint64_t rigid;           /* bit i: body i of the scene does not give way, though it could */
    /* Of all bodies that give way: DPT_INTEGRATOR_..., or -1: the scene's; dpt_springs_def, or 0 and NAN: the scene's. */
    int32_t integrator;
    uint32_t iterations;
    double sleep_speed;
    double physics; /* Hz, of what gives way, apart from the ticks, by their time; 0: in each tick */
    double dt;      /* of a tick, s */
};

/* The scene as it is felt by default: exact, to the end, the scene's law, no budget; 500 N/m where it says nothing. */
void measure_setting_init(struct measure_setting *setting, const struct scene *scene);

/*
 * The same law with every knob at its richest, to judge others by: exact, to the end, without budgets, with room for all
 * contacts, and everything gives way that can, as the scene says. The law, its stiffness, friction, damping, margin, smooth
 * normals and dt stay: they are what is felt, not how well. So does the law point where the method was the paper's.
 */
struct measure_setting measure_setting_richest(const struct measure_setting *setting, const struct scene *scene);

/* NULL if the scene can be felt like that; else why not, as "the paper's method has no proxy". */
const char *measure_setting_fault(const struct measure_setting *setting, const struct scene *scene);

/* Apply the setting to bodies, before they are added to a world. */
void measure_setting_change(const struct measure_setting *setting, struct scene_bodies *bodies);

/*
 * How a trace leads the tool of a scene. A stylus is the trace's segment, with the scene's radius. Any other tool goes as a
 * whole: its origin to end a, and its z axis towards end b, turned from tick to tick by the least turn.
 */

struct measure_tool {
    const struct scene *scene;
    int is_jump;                                /* at this row the motion jumps */
    dpt_pose pose;                              /* of a tool that goes as a whole */
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX]; /* in the scene's frame, without tips */
    /* The norm of wrenches (docs/algorithms/force.md): the tool's centre, m, scene's frame, and how much a turn counts. */
    double centre[3];
    double rho;
    double own_centre[3]; /* in the tool's own frame */
    double axis[3];       /* unit: where z points; zeros before the first row */
};

void measure_tool_begin(struct measure_tool *tool, const struct scene *scene);

/* Lead the tool to a row, counted from 0. */
void measure_tool_lead(struct measure_tool *tool, const struct csv_table *trace, size_t row);

/* Move the tool of a world to where measure_tool_lead put it. */
dpt_result measure_tool_move(const struct measure_tool *tool, dpt_world *world, dpt_tool id);

/* What the wrench of this tool weighs, in N: force, and torque about the centre over rho; zeros for a rho of 0. */
void measure_tool_weigh(const struct measure_tool *tool, const dpt_wrench *wrench, double weighed[6]);

/* Traces to measure a scene by: of a file, or a hand's that slides over a body of the scene (trace_hand.h). */

/* What a trace is made of. */
struct measure_hand {
    uint32_t body; /* its number in the scene */
    uint64_t seed;
    size_t ticks;               /* at least 1; 1 ms each */
    double length, band, speed; /* as for trace_hand_begin; 0: its defaults, for the body's size */
    int stands;                 /* the tool stands on its tip */
};

/*
 * Make a trace in the scene's frame: over the body where it stands, before it gives way. Returns 0, or 2 after a
 * message. csv_table_free frees it.
 */
int measure_trace_make(struct csv_table *trace, const struct scene *scene, const struct measure_hand *hand);

/*
 * Read a trace of at least so many ticks, for a scene; a note says if its unit is probably wrong. Returns 0, or 2 after a
 * message, with nothing to free.
 */
int measure_trace_read(struct csv_table *trace, const struct scene *scene, const char *path, size_t min);

/* The machine on which times were measured. They hold for no other one. */

/* ASCII without quotes, backslashes, asterisks and slashes: it stands in JSON, in CSV and in a comment as it is. */
struct measure_machine {
    char processor[80]; /* its name, or its architecture */
    char system[64];    /* of the operating system: name and release */
    char compiler[80];
    char version[24]; /* of dynpoint */
    char kernel[16];  /* of the library's search: avx512, ... */
};

/* The machine that runs this; `kernel` is DPT_KERNEL_... as a world tells it. */
void measure_machine_read(struct measure_machine *machine, uint32_t kernel);

#endif
