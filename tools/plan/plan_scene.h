/* SPDX-License-Identifier: BSD-3-Clause */
/* The scene of a plan that was read. */
#ifndef DPT_TOOLS_PLAN_SCENE_H
#define DPT_TOOLS_PLAN_SCENE_H

#include "plan/plan.h"

/*
 * What the plan says of its scene, where `def` has nothing: path, law, stylus, friction, damping. The plan must outlive the
 * def.
 */
void plan_scene_def(const struct plan *plan, struct scene_def *def);

/* Note what a scene's meshes are. */
void plan_meshes_of(struct plan *plan, const struct scene *scene);

/* Refuse a scene whose files are not those of the plan. Returns 0, or 2 after a message. */
int plan_scene_check(const struct plan *plan, const struct scene *scene, const char *path);

#endif
