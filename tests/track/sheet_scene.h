/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A world of one sheet and one tool that is moved from tick to tick, all that a tick says of it, and sheets that are
 * made here.
 */
#ifndef DPT_TESTS_SHEET_SCENE_H
#define DPT_TESTS_SHEET_SCENE_H

#include "track/sheet_truth.h"

/* The state of all random numbers of a program; the second number of its command line. */
extern uint64_t sheet_random;

static inline int one_in(unsigned n)
{
    return random_bits(&sheet_random) % n == 0;
}

static inline double power_in(double low, double high)
{
    return pow(10.0, random_in(&sheet_random, low, high));
}

void any_unit(double v[3]);

static inline void any_across(double v[3], const double of[3])
{
    double any[3];
    any_unit(any);
    cross3(of, any, v);
    unit_or_z(v);
}

static inline int sheet_from_shape(struct sheet *sheet, const char *name, uint32_t count, double flat)
{
    memset(sheet, 0, sizeof *sheet);
    sheet->flat = flat;
    return fixture_from_shape(&sheet->fixture, name, count) && sheet_of(sheet, name);
}

/* A square of 0.3 m, flat or bent to a bowl, or with a square hole in the middle. */
int sheet_from_grid(struct sheet *sheet, const char *name, double bend, int hole);

/* A world of one sheet and one tool. */
struct scene {
    struct sheet *sheet;
    struct rig rig;
    dpt_world_def def;
};

/* `like`: the same as that but for the budget, or NULL. */
int scene_begin(struct scene *scene, struct sheet *sheet, uint32_t budget, const struct scene *like);

static inline double side_limit(const struct scene *scene)
{
    return scene->def.side_limit > 0.0 ? scene->def.side_limit : 0.25 * scene->sheet->diagonal;
}

/* A rigid tool is made anew where its segment is another one. */
void scene_place(struct scene *scene, const struct state *state, int teleport);

/* All that the library says of a tick. */
struct tick_answer {
    dpt_step step;
    dpt_hit hit;
    dpt_sweep sweep;
    dpt_wrench wrench;
    dpt_contact contact[8];
    uint32_t contacts;
};

void scene_tick(struct scene *scene, struct tick_answer *answer);

/* As numbers to paste. */
const char *motion_text(const struct state *from, const struct state *to);

#endif
