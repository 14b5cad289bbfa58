/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world with one deformable body and a tool, and motions of its vertices in closed form. What the oracles get is the
 * scene's own copy of the positions.
 */
#ifndef DPT_TESTS_DEFORM_SCENE_H
#define DPT_TESTS_DEFORM_SCENE_H

#include "lib/fixture.h"
#include "lib/rig.h"

/* How vertices move. */
enum deform_kind {
    DEFORM_MODES, /* sums of waves through the whole body, without an end */
    DEFORM_DENT,  /* one place goes in and out, and wanders */
    DEFORM_FOLD,  /* half of it turns about an axis, through itself */
    DEFORM_BREATH /* it grows and shrinks about its middle */
};
enum { DEFORM_KINDS = 4 };

/* How they are handed over. */
enum deform_form { DEFORM_WHOLE, DEFORM_RANGES, DEFORM_LIST, DEFORM_BOUNDED };
enum { DEFORM_FORMS = 4 };

struct deform_scene {
    struct fixture fixture;
    struct rig rig;
    uint32_t vertices;
    const float *rest;     /* the mesh's */
    float *positions;      /* where they are now */
    float *next, *changed; /* scratch of deform_scene_set */
    uint32_t *list;
    double low[3], high[3], diagonal;
    double step; /* m: about how far a vertex moves in a tick, at most */
    enum deform_kind kind;
    uint64_t random;
    double time, phase[6];
};

/* `def` and `deform` may be NULL: the defaults. 0 where a part of it fails. */
int deform_scene_open(struct deform_scene *scene, const char *shape, uint64_t triangles, const dpt_world_def *def,
                      const dpt_deformable_def *deform);

/* The same with a mesh from a file, and with one that is open as scene->fixture; the rest of the scene is zeros. */
int deform_scene_open_mesh(struct deform_scene *scene, const dpt_world_def *def, const dpt_deformable_def *deform);
int deform_scene_open_file(struct deform_scene *scene, const char *path, double scale, const dpt_world_def *def);
void deform_scene_close(struct deform_scene *scene);

/* Make scene->next: one tick of the motion. */
void deform_scene_advance(struct deform_scene *scene);

/* Hand scene->next over to the world in a form, and note it as the positions. */
void deform_scene_set(struct deform_scene *scene, enum deform_form form);

/* The corners of a triangle, by its source number, at the scene's positions; 0 if it was dropped. */
int deform_scene_triangle(const struct deform_scene *scene, uint32_t number, double corners[9]);

#endif
