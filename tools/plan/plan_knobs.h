/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What can be taken away from a setting, in the order in which it is tried. Memory goes first, as it must not be felt, and
 * that shows while nothing else is taken; then what saves most; the budget last, as it bounds what the others left.
 */
#ifndef DPT_TOOLS_PLAN_KNOBS_H
#define DPT_TOOLS_PLAN_KNOBS_H

#include "plan/plan_file.h"

/* What a knob must do beside holding all bounds, to stay turned. Then it is turned back by a step, which was seen to hold. */
enum plan_must {
    KNOB_HOLDS,     /* nothing else; it is not turned back */
    KNOB_SAME_BITS, /* change no answer */
    KNOB_SAVES      /* save a tenth of the largest tick's units, or of those at 99.9 % */
};

struct plan_knob {
    const char *name; /* as in world.h */
    /* Of each body that gives way, apart; else once. */
    int of_bodies;
    enum plan_must must;
    /*
     * The next cheaper value. Returns 0 where there is none.
     *   body    its number, of a knob of bodies
     *   seen    what the setting did on the trace by which is chosen
     */
    int (*reduce)(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                  const struct plan_figures *seen);
    /* Its value as it is in `from`. */
    void (*restore)(struct measure_setting *setting, const struct measure_setting *from, uint32_t body);
    /* The value, as text. */
    void (*print)(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                  size_t room);
};

extern const struct plan_knob plan_knobs[];
extern const size_t plan_knob_count;

/* What it is called: "budget", "bodies[2] rigid". */
void plan_knob_name(const struct plan_knob *knob, uint32_t body, char *text, size_t room);

/* Whether a body of the scene is left to give way. */
int plan_gives_way(const struct measure_setting *setting, const struct scene *scene);

/* Whole, at most UINT32_MAX: a capacity with what is to be left above what was seen, and any number so many times. */
uint32_t plan_capacity(double seen, const struct measure_setting *setting, const struct scene *scene);
uint32_t plan_times(double seen, double factor);

#endif
