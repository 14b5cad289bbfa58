/* SPDX-License-Identifier: BSD-3-Clause */
/* What the user says of a run: the options of dynpoint run, and what its scene file has in place of those. */
#ifndef DPT_TOOLS_RUN_SETTINGS_H
#define DPT_TOOLS_RUN_SETTINGS_H

#include "dynpoint/coupling.h"
#include "host/host_embed.h"
#include "host/host_session.h"
#include "plan/plan_file.h"
#include "scene/scene.h"
#include "scene/scene_def.h"
#include "view/run_view.h"

/* The word for what limits a coupling, as "stability". */
const char *coupling_limit_word(uint32_t limit);

/* Physics of a run at a rate of its own, `run --physics HZ`. Without that option these do nothing. */

/* Refuse a recording with a device that goes by the clock: it has nothing of what a thread did. Returns 0, or 2. */
int run_physics_check(const struct scene *scene, const dpt_device_info *device, int is_recorded);

/* A part of the report at the end, after host_session_stop: a line, or keys of a JSON object behind others. */
void run_physics_print(const struct scene *scene, int is_json);

/* Not given. */
#define RUN_NO_NUMBER UINT64_MAX

struct run_settings {
    struct scene_def scene;
    const char *device, *record, *identified;
    struct coupling_options coupling;
    double force_max, rate, seconds; /* force_max NAN, rate 0: not given */
    uint64_t ticks, budget;          /* HOST_BUDGET_BY_RATE: not given */
    uint64_t clutch, cpu;            /* RUN_NO_NUMBER: not given */
    struct run_view_options view;
    struct host_embed embed;
    const char *plan_path; /* NULL: there is no plan */
    struct plan plan;
    int json, reopen, is_active, awake, embeds;
};

/* 1 if what is recorded is a trace alone. */
int run_is_traced(const struct run_settings *settings);

/*
 * Read and check the options. Returns -1 to go on, else the exit status. Free settings->scene, settings->embed and
 * settings->plan in either case.
 */
int run_settings_read(struct run_settings *settings, int argc, char **argv);

#endif
