/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/scene_list.h"

#include <stdio.h>
#include <string.h>

#include "dynpoint/springs.h"
#include "text/near_word.h"

#define UPRIGHT                                                                                                        \
    {                                                                                                                  \
        { 0.0, 0.0, 0.0 },                                                                                             \
        {                                                                                                              \
            1.0, 0.0, 0.0, 0.0                                                                                         \
        }                                                                                                              \
    }

/* What lies in the plane z = 0 lies in y = height. */
#define LYING(height)                                                                                                  \
    {                                                                                                                  \
        { 0.0, (height), 0.0 },                                                                                        \
        {                                                                                                              \
            0.70710678118654752, -0.70710678118654752, 0.0, 0.0                                                        \
        }                                                                                                              \
    }

/* The belly's wall, inclined by 45 degrees, so that its hole is the port of the scene laparoscopy. */
#define OVER_THE_PORT                                                                                                  \
    {                                                                                                                  \
        { 0.0038, 0.0523959, -0.0009041 },                                                                             \
        {                                                                                                              \
            0.92387953251128674, -0.38268343236508977, 0.0, 0.0                                                        \
        }                                                                                                              \
    }

#define STYLUS .length = 0.1, .radius = 0.002

#define FIXED_BOX(...)                                                                                                 \
    {                                                                                                                  \
        .kind = DPT_REGION_BOX, .fixed = 1, .box = { __VA_ARGS__ }                                                     \
    }

/* The border of the square of 0.2 m. */
static const dpt_spring_region membrane_border[] = {
    FIXED_BOX(-0.11, -0.11, -0.01, -0.0999, 0.11, 0.01),
    FIXED_BOX(0.0999, -0.11, -0.01, 0.11, 0.11, 0.01),
    FIXED_BOX(-0.11, -0.11, -0.01, 0.11, -0.0999, 0.01),
    FIXED_BOX(-0.11, 0.0999, -0.01, 0.11, 0.11, 0.01),
};

/* The corners of the square of 0.3 m: a cloth that nothing holds slides off a smooth rod. */
static const dpt_spring_region cloth_corners[] = {
    FIXED_BOX(-0.16, -0.16, -0.1, -0.14, -0.14, 0.1),
    FIXED_BOX(0.14, -0.16, -0.1, 0.16, -0.14, 0.1),
    FIXED_BOX(-0.16, 0.14, -0.1, -0.14, 0.16, 0.1),
    FIXED_BOX(0.14, 0.14, -0.1, 0.16, 0.16, 0.1),
};

/* A liver hangs on its back; in the scene laparoscopy the patient lies on it. */
static const dpt_spring_region liver_bed[] = { FIXED_BOX(-0.2, -0.2, -0.1, 0.2, 0.2, -0.035) };

#define REGIONS(of) .regions = (of), .region_count = sizeof(of) / sizeof *(of)

/* Healthy livers have a Young's modulus of 2 to 7 kPa by transient elastography. */
#define LIVER_SPRINGS                                                                                                  \
    {                                                                                                                  \
        .size = sizeof(dpt_spring_net_def), .kind = DPT_NET_VOLUME, .young = 5000.0, .density = 1000.0, .drag = 5.0,   \
        .viscosity = 1e-3, REGIONS(liver_bed)                                                                          \
    }

#define COLOUR(red, green, blue) .has_colour = 1, .colour = { red, green, blue }
#define LIVER_RED                COLOUR(0.55, 0.15, 0.12)

static const struct listed_scene scenes[] = {
    { .name = "membrane",
      STYLUS,
      .origin = { 0.0, 0.007, -0.05 }, /* a stylus that lies is within the border */
      .has_origin = 1,
      .bodies = { { .shape = "membrane",
                    .triangles = 512,
                    .pose = LYING(0.0),
                    .springs = { .size = sizeof(dpt_spring_net_def),
                                 .kind = DPT_NET_SHEET,
                                 .young = 1e5,
                                 .thickness = 1e-3,
                                 .density = 1000.0,
                                 .drag = 10.0,
                                 .viscosity = 1e-3,
                                 REGIONS(membrane_border) },
                    .spread = 0.0375 } } },
    { .name = "cloth",
      .gravity = 9.81,
      .origin = { 0.0, -0.02, -0.1 },
      .has_origin = 1,
      .length = 0.2,
      .radius = 0.004,
      .bodies = { { .shape = "cloth",
                    .triangles = 2048,
                    .pose = LYING(0.0),
                    .springs = { .size = sizeof(dpt_spring_net_def),
                                 .kind = DPT_NET_SHEET,
                                 .young = 1e5,
                                 .thickness = 1e-3,
                                 .density = 400.0,
                                 .drag = 10.0,
                                 .viscosity = 1e-4,
                                 REGIONS(cloth_corners) },
                    .sleep_speed = 0.01,
                    .look = BODY_LOOK_CLOTH } } },
    { .name = "laparoscopy",
      STYLUS,
      .look = TOOL_LOOK_FORCEPS,
      .origin = { 0.0038, 0.0545, 0.0012 },
      .has_origin = 1,
      .port = { 0.0038, 0.1125, 0.0592 },
      .has_port = 1,
      .camera = { 1, { -0.155, 0.15, -0.045, 0.0038, 0.074, 0.018, 0.0, 1.0, 0.0 } },
      .inset = { 1, { -0.22, 0.22, 0.44, 0.045, 0.055, 0.035, 0.0, 1.0, 0.0 } },
      .bodies = { { .shape = "liver",
                    .triangles = 2692,
                    .pose = LYING(0.0),
                    .springs = LIVER_SPRINGS,
                    .spread = 0.02,
                    LIVER_RED },
                  { .shape = "stomach", .triangles = 1619, .pose = LYING(0.0), COLOUR(0.85, 0.6, 0.5) },
                  { .shape = "spleen", .triangles = 1076, .pose = LYING(0.0), COLOUR(0.45, 0.1, 0.2) },
                  { .shape = "wall", .triangles = 1024, .pose = OVER_THE_PORT, COLOUR(0.85, 0.65, 0.55) } } },
    { .name = "liver", STYLUS, .bodies = { { .shape = "liver", .triangles = 50332, .pose = UPRIGHT, LIVER_RED } } },
    { .name = "soft-liver",
      STYLUS,
      .bodies = { { .shape = "liver",
                    .triangles = 50332,
                    .pose = UPRIGHT,
                    .springs = LIVER_SPRINGS,
                    .spread = 0.02,
                    LIVER_RED } } },
    { .name = "needle",
      .look = TOOL_LOOK_NEEDLE,
      .origin = { 0.011, 0.052, 0.007 },
      .has_origin = 1,
      .length = 0.12,
      .radius = 0.0006,
      .is_needle = 1,
      .bodies = { { .shape = "box",
                    .triangles = 12,
                    .pose = UPRIGHT,
                    .surface = { .size = sizeof(dpt_body_settings),
                                 .stiffness = 1500.0,
                                 .static_friction = 0.5,
                                 .kinetic_friction = 0.5,
                                 .puncture_force = 1.5,
                                 .cutting_force = 0.4,
                                 .shaft_friction = 30.0,
                                 .shaft_viscosity = 5.0,
                                 .shaft_stiffness = 20000.0 },
                    COLOUR(0.85, 0.65, 0.55) },
                  { .shape = "box",
                    .triangles = 12,
                    .pose = { { 0.0, -0.13, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } },
                    COLOUR(0.9, 0.88, 0.8) } } },
    { .name = "biopsy",
      .look = TOOL_LOOK_NEEDLE,
      .origin = { 0.0038, 0.0545, 0.0012 },
      .has_origin = 1,
      .length = 0.12,
      .radius = 0.0006,
      .is_needle = 1,
      .bodies = { { .shape = "liver",
                    .triangles = 2692,
                    .pose = LYING(0.0),
                    .springs = LIVER_SPRINGS,
                    .surface = { .size = sizeof(dpt_body_settings),
                                 .static_friction = 0.5,
                                 .kinetic_friction = 0.5,
                                 .puncture_force = 0.5,
                                 .cutting_force = 0.1,
                                 .shaft_friction = 10.0,
                                 .shaft_viscosity = 5.0,
                                 .shaft_stiffness = 20000.0 },
                    LIVER_RED },
                  { .shape = "wall", .triangles = 1024, .pose = LYING(0.0), COLOUR(0.85, 0.65, 0.55) } } },
    { .name = "tori",
      STYLUS,
      .bodies = { { .shape = "torus", .triangles = 61358, .pose = UPRIGHT },
                  { .shape = "torus",
                    .triangles = 5568,
                    .pose = { { 0.1, 0.0, 0.0 }, { 0.70710678118654752, -0.70710678118654752, 0.0, 0.0 } } } } },
};
enum { SCENES = sizeof scenes / sizeof *scenes };

const char *scene_listed_name(uint32_t index)
{
    return index < SCENES ? scenes[index].name : NULL;
}

const struct listed_scene *scene_listed(const char *name)
{
    for (int i = 0; i < SCENES; i++)
        if (!strcmp(scenes[i].name, name))
            return &scenes[i];
    return NULL;
}

int scene_listed_is_meant(const char *text)
{
    return text[0] && !strpbrk(text, "./\\");
}

void scene_listed_tell(const char *text, char *told, size_t bytes)
{
    struct near_word near = near_word_begin(text, strlen(text));
    size_t length = 0;
    for (int i = 0; i < SCENES; i++) {
        near_word_try(&near, scenes[i].name);
        if (length < bytes)
            length +=
                (size_t)snprintf(told + length, bytes - length, "%s%s", i ? ", " : "the scenes are ", scenes[i].name);
    }
    if (near.word && length < bytes)
        snprintf(told + length, bytes - length, "; did you mean %s?", near.word);
}
