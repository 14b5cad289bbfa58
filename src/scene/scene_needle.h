/* SPDX-License-Identifier: BSD-3-Clause */
/* What a scene's needle is in, all channels together: insertion.h. */
#ifndef DPT_SCENE_NEEDLE_H
#define DPT_SCENE_NEEDLE_H

#include "scene/scene.h"

/* Zeros: it is in none, or the scene has no needle. */
struct scene_needle {
    double depth;      /* m: of the tip beyond the entry of the first channel */
    double inside;     /* m: of the shaft, inside of all bodies */
    uint32_t ruptures; /* walls that are open in these channels */
    uint32_t layers;   /* that the tip has gone into and not come back from */
};

struct scene_needle scene_get_needle(const struct scene *scene);

#endif
