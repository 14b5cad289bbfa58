/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * One way to feel a scene: a method, a law, and every knob that costs time or accuracy. measure_run.h runs it, and
 * judgement.h holds what came of it against another.
 */
#ifndef DPT_TOOLS_MEASURE_SETTING_H
#define DPT_TOOLS_MEASURE_SETTING_H

#include "dynpoint/baseline.h"
#include "scene/scene.h"

/* A plain value: copy it, and change what is to be another. */
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

/* What it says of bodies, before they are added to a world. */
void measure_setting_change(const struct measure_setting *setting, struct scene_bodies *bodies);

#endif
