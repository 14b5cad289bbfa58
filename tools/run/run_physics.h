/* SPDX-License-Identifier: BSD-3-Clause */
/* Physics of a run at a rate of its own, `run --physics HZ`. Without that option these do nothing. */
#ifndef DPT_TOOLS_RUN_PHYSICS_H
#define DPT_TOOLS_RUN_PHYSICS_H

#include "scene/scene.h"

/*
 * Refuse what cannot be had with this device: it is by the device's own time, if it has one; and a recording has nothing
 * of what a thread did. Returns 0, or 2 after a message.
 *   is_recorded   every tick is, for a replay
 */
int run_physics_check(const struct scene *scene, const dpt_device_info *device, int is_recorded);

/* s: by how much later vertices arrive than with physics in each tick. */
double run_physics_delay(const struct scene *scene);

/* s: a step of what is soft. */
double run_physics_step(const struct scene *scene, double loop_rate);

/* Start the thread, unless the device has a time of its own. Returns 0, or 2 after a message. */
int run_physics_start(struct scene *scene, double loop_rate);

/* A part of the report at the end, after scene_physics_stop: a line, or keys of a JSON object behind others. */
void run_physics_print(const struct scene *scene, int is_json);

#endif
