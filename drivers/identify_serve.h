/* SPDX-License-Identifier: BSD-3-Clause */
/* The servo loop of an identification: one stage after the other, each with its pushes, all within the limits. */
#ifndef DPT_DRIVERS_IDENTIFY_SERVE_H
#define DPT_DRIVERS_IDENTIFY_SERVE_H

#include "dynpoint/identify.h"
#include "dynpoint/loop.h"
#include "identify_motion.h"
#include "identify_push.h"
#include "identify_record.h"

enum identify_stage {
    IDENTIFY_REST,  /* no force; samples are recorded */
    IDENTIFY_TRIAL, /* one trial push */
    IDENTIFY_BLOCK, /* random pushes; samples and commands are recorded */
    IDENTIFY_RETURN /* back to where the measurement began, as far as the force suffices */
};

/* A spring and a damper that bring the device back; 0: not yet known. */
struct identify_return {
    double stiffness, damping;
};

/* Room for what is recorded in one space. */
struct identify_store {
    struct identify_sample *samples;
    struct identify_command *commands;
    uint32_t sample_count, command_count, capacity;
};

struct identify_server {
    dpt_device *device;
    dpt_device_info info;
    dpt_identify_def def;
    dpt_identify_result *result;
    double bound[IDENTIFY_SPACES];                         /* N, Nm */
    double speed[IDENTIFY_SPACES], range[IDENTIFY_SPACES]; /* that pushes aim at */
    double planned;                                        /* duration of all stages, s */
    double past;                                           /* of the stages before this one, s */
    struct identify_motion motion;
    struct identify_store store[IDENTIFY_SPACES];
    struct identify_return back[IDENTIFY_SPACES][3];
    /* The present stage. */
    enum identify_stage stage;
    uint32_t space, axis;
    double duration; /* s; of a trial and a return at most */
    struct identify_trial trial;
    struct identify_pushes pushes;
    double settled; /* since when the device is back, s; negative: it is not */
    dpt_loop *loop;
    int is_over;       /* the stage has come to its end */
    int has_sample;    /* in this stage */
    uint64_t begin_ns; /* of its first sample */
    uint64_t last_ns, sent_ns;
    uint32_t unsent; /* ticks in a row after which the device had taken no command */
    double reported; /* when, s */
};

/*
 * Run a stage, which `stage`, `space`, `axis`, `duration`, `trial` and `pushes` describe. At its end the force is zero.
 * Why it ended early is in result->end. DPT_E_SYSTEM: the loop could not run.
 */
dpt_result identify_serve(struct identify_server *server);

#endif
