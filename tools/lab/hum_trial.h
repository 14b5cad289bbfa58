/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that a device without inertia leads on to a scene, and holds, presses or wipes there, at 1 kHz; and the force of
 * each tick, before limits.
 *
 *     struct hum_trial trial = { .scene = &scene, .hand = HUM_STILL, .lean = 90.0, .stiffness = 667.0, .radius = 0.002 };
 *     hum_trial_run(&trial)
 *     look at trial.tick[trial.judged .. trial.count - 1]
 *     hum_trial_close(&trial);
 *
 * The device comes down at 0.05 mm a tick until there is a force. Then, without a jerk and never faster than that, nor
 * than 0.02 mm a tick where it presses:
 *   STILL   it goes `depth` deeper and stands still; judged from 1 s later on
 *   PRESS   it goes `depth` deeper and out again, once
 *   WIPE    it goes `depth` deeper and from there 16 mm across and back, at 30 degrees to the tool; the last two are judged
 *           from 60 ms after contact began to the last tick with a force
 * A needle goes in on its way deeper, and is in at the end.
 * Where the body falls on to the tool, the device waits for it for 1.5 s, presses upwards or wipes, and is judged from then
 * on.
 */
#ifndef DPT_TOOLS_HUM_TRIAL_H
#define DPT_TOOLS_HUM_TRIAL_H

#include "lab/hum_scene.h"
#include "scene/scene_stage.h"

enum hum_hand { HUM_STILL, HUM_PRESS, HUM_WIPE };

struct hum_tick {
    double force[3];             /* N */
    double motion;               /* m: of the device since the tick before */
    uint32_t flags;              /* DPT_FORCE_FLAG_... */
    uint32_t sticking, slipping; /* touches with friction */
};

struct hum_trial {
    /* Given. */
    struct hum_scene *scene;
    enum hum_hand hand;
    uint32_t integrator; /* DPT_INTEGRATOR_..., of what gives way */
    double lean;         /* degrees: 0 upright on its tip; 90 lying along z, held in its middle */
    double stiffness;    /* N/m */
    double radius;       /* m, of the tool */
    int turns;           /* the device gives torque; else the proxy's rotation is locked */
    int is_usual;        /* as dynpoint run has it: held at its end, and all bodies are felt, not the first alone */
    double depth;        /* m */
    double static_friction, kinetic_friction; /* of the first body; 0: its own */
    size_t still_ticks;                       /* of STILL: those that are judged */

    /* Made. */
    struct hum_tick *tick;
    size_t count, judged;
    int is_refused; /* the integrator has no stable step of 1 ms */
    int has_failed; /* it exploded, there was never a force, or a needle is not in */
    double rise;    /* m: half of what the tool's ends differ in height */
    struct scene_stage stage;
};

/* Returns 0 if memory ran out. hum_trial_close is due in any case. */
int hum_trial_run(struct hum_trial *trial);
void hum_trial_close(struct hum_trial *trial);

#endif
