/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene_list.h"

#include <string.h>

#define AT(x, y, z)                                                                                \
    {                                                                                              \
        { (x), (y), (z) },                                                                         \
        {                                                                                          \
            1.0, 0.0, 0.0, 0.0                                                                     \
        }                                                                                          \
    }

/* What lies in the plane z = 0 is turned to lie in y = 0. */
#define LYING_AT(x, y, z)                                                                          \
    {                                                                                              \
        { (x), (y), (z) },                                                                         \
        {                                                                                          \
            0.70710678118654752, -0.70710678118654752, 0.0, 0.0                                    \
        }                                                                                          \
    }

static const struct listed_scene scenes[] = {
    { .name = "membrane",
      .about = "a square of 0.2 m (512 triangles)",
      .bodies = { { "membrane", 512, LYING_AT(0.0, 0.0, 0.0) } } },
    { .name = "cloth",
      .about = "a cloth with folds (2,048 triangles)",
      .bodies = { { "cloth", 2048, LYING_AT(0.0, 0.0, 0.0) } } },
    { .name = "laparoscopy",
      .about = "liver, stomach and spleen (5,387 triangles)",
      .bodies = { { "liver", 2692, AT(0.0, 0.0, 0.0) },
                  { "stomach", 1619, AT(0.0, 0.0, 0.0) },
                  { "spleen", 1076, AT(0.0, 0.0, 0.0) } } },
    { .name = "liver",
      .about = "a liver (50,332 triangles)",
      .bodies = { { "liver", 50332, AT(0.0, 0.0, 0.0) } } },
    { .name = "tori",
      .about = "two linked tori (61,358 and 5,568 triangles)",
      .bodies = { { "torus", 61358, AT(0.0, 0.0, 0.0) },
                  { "torus", 5568, LYING_AT(0.1, 0.0, 0.0) } } },
};
enum { SCENES = sizeof scenes / sizeof *scenes };

const struct listed_scene *scene_listed(const char *name)
{
    for (int i = 0; i < SCENES; i++)
        if (!strcmp(scenes[i].name, name))
            return &scenes[i];
    return NULL;
}
