/* SPDX-License-Identifier: BSD-3-Clause */
/* A scene that is felt with a device: its coupling, world, guard and passivity; its ticks, and what they count. */
#ifndef DPT_HOST_SESSION_H
#define DPT_HOST_SESSION_H

#include "dynpoint/guard.h"
#include "host/host_coupling.h"
#include "scene/scene.h"
#include "scene/scene_text.h"
#include "scene/scene_trouble.h"

/* A budget: 3000 units a tick at 1 kHz, in proportion to the period, so that a tick keeps within one. */
#define HOST_BUDGET_BY_RATE UINT64_MAX

struct host_settings {
    struct coupling_options coupling; /* `rate` and `loop_delay` are filled in */
    double force_max;                 /* of the guard, N; NAN: its default */
    double rate;                      /* of the loop, Hz; 0: the device's */
    uint64_t budget;                  /* units of work a tick, 0: unlimited; HOST_BUDGET_BY_RATE */
    int is_active;                    /* 1: what the scene gives the hand is not taken away */
    int shows_contacts;               /* 1: the world lists its contacts */
};

/* How often the proxy was put at the device, why, and how long it had no force for that: docs/algorithms/force.md. */
struct host_puts {
    uint64_t squeezed, turned; /* ticks in which it was put */
    uint64_t inside;           /* ticks without force: where it was put, or began, may be inside or behind something */
};

/* What the ticks count. Begin with zeros. */
struct host_counts {
    uint64_t contacts, penetrating, unknown, clutched;
    uint64_t stopped;        /* ticks in which the device had stopped itself */
    uint32_t reasons;        /* why the device was not ready, DPT_REASON_... */
    double depth_max;        /* m */
    double force_max;        /* N at the hand, before the guard */
    double needle_depth_max; /* m: of a needle's tip */
    uint64_t ruptures;       /* walls that a needle has pierced */
    uint32_t open_walls;     /* of the channels that it was in in the last tick */
    struct scene_trouble trouble;
    struct host_puts puts;
};

struct host_session {
    struct scene scene;
    dpt_coupling coupling;
    dpt_guard_def guard;
    uint32_t budget;
    double rate; /* of the loop, Hz */
    struct host_counts counts;
};

/*
 * End a fault that a device has from before, for example because a host died; a note says so. An error: the fault stays. A
 * deterministic device is left alone, because a read would use up one of its samples. `name` is the device's.
 */
dpt_result host_device_end_fault(dpt_device *device, const char *name, dpt_host_error *error);

/*
 * Couple a scene that scene_open opened to a device: as stiff as that can hold, with a world, a guard and a controller of
 * passivity. A note says why the coupling is softer than was asked for. `path` is the scene's.
 */
dpt_result host_session_couple(struct host_session *session, const struct host_settings *settings,
                               const dpt_device_info *device, const char *path, dpt_host_error *error);

/*
 * Of a scene that was opened as a recording's text says, instead of host_session_couple: the world and the controller that
 * there were, without a guard. Fields of the text are in range.
 */
dpt_result host_session_restore(struct host_session *session, const struct scene_text *text, dpt_host_error *error);

/*
 * Before and after a loop: the thread of physics at a rate of its own, unless the device has a time of its own, by which
 * physics goes then. Without such physics they do nothing.
 */
dpt_result host_session_start(struct host_session *session, dpt_host_error *error);
void host_session_stop(struct host_session *session);

/* The text of a recording's header. device: its name */
void host_session_text(const struct host_session *session, const struct scene_def *def, const char *device,
                       struct scene_text *text);

/* A tick: the wrench at the hand, before the guard. Allocates nothing, reads no clock. */
dpt_result host_session_feel(struct host_session *session, const dpt_loop_sample *sample, dpt_wrench *wrench);

#endif
