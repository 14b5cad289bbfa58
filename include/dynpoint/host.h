/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_host: feel a scene with a device, safely. It does what `dynpoint run` does, as a library. It opens the
 * scene (a name, a scene file, a compiled mesh or arm) and the device, and chooses the stiffest coupling that the device
 * can hold. A passivity controller removes energy that the scene would add to the hand, and a guard limits what reaches
 * the motors.
 *
 *     dpt_host_def def;
 *     dpt_host *host;
 *     dpt_host_error error = { .size = sizeof error };
 *     dpt_host_def_init(&def);
 *     def.scene = "liver";
 *     def.device = "serial:/dev/ttyACM0";
 *     if (dpt_host_open(&def, &host, &error) != DPT_OK)
 *         complain(error.text);
 *     dpt_host_run(host, NULL, &error);        returns after dpt_host_stop(host), or when the device is lost
 *     dpt_host_close(host, NULL);
 *
 * To run a loop of your own, leave `device` NULL, describe the device in `info`, and call dpt_host_tick with each sample.
 *
 * Units are SI, in the scene's metres; the device's are the hand's (docs/scene.md, docs/drivers.md).
 *
 * Threads: a host belongs to one thread at a time, its callback to the one that runs it. dpt_host_stop may be called
 * from any thread, and from a signal handler. Physics at a rate of its own has a thread, which dpt_host_run starts and
 * ends.
 */
#ifndef DYNPOINT_HOST_H
#define DYNPOINT_HOST_H

#include "dynpoint/body.h"
#include "dynpoint/device.h"
#include "dynpoint/loop.h"
#include "dynpoint/world.h"

DPT_BEGIN

typedef struct dpt_host dpt_host;

/*
 * What a call has to say to a person, in one line.
 *   code   what the call returned
 *   text   after a failure, the file, its place and the reason. After a success, what a person should know, as that the
 *          coupling is softer than was asked for, and why; or "" for nothing
 */
typedef struct dpt_host_error {
    uint32_t size; /* sizeof(dpt_host_error), set by the caller */
    int32_t code;
    char text[1000];
} dpt_host_error;

/* Bits of dpt_host_def.flags. */
enum {
    DPT_HOST_FLAG_UNSTABLE = 1, /* `stiffness` counts, whatever the device can hold */
    DPT_HOST_FLAG_ACTIVE = 2,   /* what energy the scene gives the hand is not taken away */
    DPT_HOST_FLAG_CONTACTS = 4, /* the world lists its contacts, for a viewer */
    DPT_HOST_FLAG_REOPEN = 8,   /* dpt_loop_def.reopen */
    DPT_HOST_FLAG_AWAKE = 16,   /* dpt_loop_def.awake */
    DPT_HOST_FLAG_EMBED = 32    /* `record` carries the compiled files of scene and tool, to be replayed without them */
};

/* Bits of dpt_host_body.flags. */
enum {
    DPT_HOST_BODY_FLAG_RIGID = 1 /* it does not give way, though its mesh has springs */
};

/*
 * A body of your own. What is 0 or NULL is the default, as in a scene file (docs/scene.md); the numbers from load_radius on
 * are of a mesh with springs.
 */
typedef struct dpt_host_body {
    uint32_t size;        /* sizeof(dpt_host_body), set by the caller; in an array, set that of the first item */
    uint32_t flags;       /* DPT_HOST_BODY_FLAG_... */
    const dpt_mesh *mesh; /* stays open as long as the host */
    const dpt_pose *pose; /* of the mesh's frame in the scene's; read by the call. NULL: the same frame */
    const dpt_body_settings *settings; /* friction and the like; read by the call. NULL: those of new bodies */
    const char *name;                  /* in texts; stays as long as the host. NULL: it has none */
    double load_radius;                /* dpt_deformable_def.load_radius, m; 0: as tissue and tool need it */
    double period;                     /* dpt_deformable_def.period, s, 0..1000 */
    double room;                       /* m: how far vertices may get beyond the mesh's box; 0: 10 m or more */
    double sleep_speed;                /* dpt_springs_def.sleep_speed, m/s; 0: its default; -1: no node falls asleep */
    uint32_t integrator;               /* DPT_INTEGRATOR_... */
    uint32_t iterations;               /* dpt_springs_def.iterations; 0: its default */
    uint32_t response;                 /* DPT_RESPONSE_...; DISPLACE is for the laws point and bed, and for sheets */
    uint32_t reserved;                 /* 0 */
} dpt_host_body;

/*
 * Called after each tick that had a sample, with its wrench at the hand before the guard. It must not wait. `result` is
 * not DPT_OK if the tick gave no force: DPT_E_NOT_READY while the clutch is down.
 */
typedef void dpt_host_felt_fn(void *user, dpt_host *host, const dpt_loop_sample *sample, dpt_result result,
                              const dpt_wrench *wrench);

/*
 * What is felt, and how. dpt_host_def_init fills in the defaults, which are given last below. What is NAN, or NULL, or
 * DPT_NONE is that of the scene, or of its file.
 */
typedef struct dpt_host_def {
    uint32_t size;  /* sizeof(dpt_host_def), set by dpt_host_def_init */
    uint32_t flags; /* DPT_HOST_FLAG_...; 0 */
    /* A name (dpt_host_get_scene), or the path of a scene file (.json), of a compiled mesh or of a compiled arm; NULL */
    const char *scene;
    const char *device; /* as dpt_device_open takes it; NULL: the scene file's, or none where `info` is given; NULL */
    const char *tool;   /* path of a compiled arm, whose tool is used; NULL */
    const char *identified; /* path of the device's dynamics (dpt_device_dynamics_read); NULL: as it tells; NULL */
    /* The device of a loop of your own. Flags, rate, limits and dynamics count. NULL: there is none; NULL */
    const dpt_device_info *info;
    /* Path of a recording of all ticks, which `dynpoint replay` and `view` take. NULL: there is none; NULL */
    const char *record;
    dpt_host_felt_fn *felt; /* NULL */
    void *user;             /* first argument of `felt`; NULL */
    uint32_t law;           /* DPT_LAW_...; DPT_NONE */
    uint32_t clutch;        /* device button that holds the tool where it is; DPT_NONE */
    uint32_t budget;        /* units of work a tick; 0: 3e6 a second, so that a tick keeps within its period; 0 */
    uint32_t cpu;           /* dpt_loop_def.cpu; 0 */
    uint64_t ticks;         /* dpt_loop_def.ticks; 0 */
    double origin[3];       /* of the device, in the scene's frame, m; NAN */
    double stiffness;       /* N/m; 0: as much as the device can hold; 0 */
    double gain_margin;     /* dpt_coupling_def.gain_margin; 1.5 */
    double friction;        /* of all bodies; NAN */
    double damping;         /* of the tool's spring, Ns/m; 0 */
    double zoom;            /* metres of the scene for one of the hand, above 0, at most 1000; NAN */
    double force_scale;     /* newtons at the hand for one of the scene, 0.001..1000; NAN */
    double length;          /* of a stylus, m, 0..10; NAN */
    double radius;          /* of a stylus, m, 0..1; NAN */
    double physics;         /* Hz of what gives way, apart from the loop, 1..5000; 0: in each tick; 0 */
    double rate;            /* of the loop, Hz, 1..100000; 0: the device's; 0 */
    double force_max; /* of the guard, N, 0..1000; NAN: the guard's default, and the device's if that is less; NAN */
    /* Tips of the tool beside its segments, up to 16, NULL behind the last: each as `dynpoint run --tip` takes it; NULL */
    const char *const *tips;
    const char *jaw; /* how the tool's jaws move, as `dynpoint run --jaw` takes it; NULL */
    /* Bodies of your own instead of a scene, y being up; and segments, in the tool's frame, instead of its own; NULL */
    const dpt_host_body *bodies;
    const dpt_segment *segments;
    uint32_t body_count;    /* 1..64; 0 */
    uint32_t segment_count; /* 1..64; 0 */
    double gravity;         /* of `bodies`, m/s^2 against y, 0..1000; 0 */
} dpt_host_def;

/* What is so now, and what has happened since dpt_host_open. */
typedef struct dpt_host_info {
    uint32_t size;               /* sizeof(dpt_host_info), set by the caller */
    uint32_t limit;              /* what limits the coupling: DPT_COUPLING_... */
    uint32_t budget;             /* units of work a tick */
    uint32_t reasons;            /* why the device was not ready: DPT_REASON_... */
    double stiffness;            /* of the coupling, N/m */
    double rotational_stiffness; /* Nm/rad; 0: the stiffness times rho^2 (dpt_coupling) */
    double stable;               /* N/m at the hand: the device is at its limit there; 0: unknown */
    double rate;                 /* of the loop, Hz */
    uint64_t ticks;              /* with a sample */
    uint64_t failed;             /* of them, those that failed and gave no force */
    uint64_t held;               /* in which a body that could not go on was held where it was (springs.h) */
    uint64_t clutched;           /* in which the clutch was down */
    uint64_t contacts;           /* in which the tool touched, or was inside */
    uint64_t penetrating;        /* in which the device was behind a surface */
    uint64_t unknown;            /* which the budget left undecided */
    uint64_t put;                /* in which the proxy was put at the device (docs/algorithms/force.md) */
    uint64_t inside;             /* without force, as the tool may be inside of something, or behind it */
    uint64_t limited;            /* whose wrench the controller of passivity changed */
    double taken;                /* J: dpt_passivity_info.taken */
    double account_min;          /* J: the least of its account */
    double depth_max;            /* m of the scene: the deepest */
    double force_max;            /* N at the hand: the strongest, before the guard */
    /* What went wrong in ticks, or stopped the device, how often, why and what helps; "": nothing */
    char trouble[640];
} dpt_host_info;

/* Fill in the first `size` bytes; what dpt_host_def_init calls with its own caller's sizeof. */
DPT_API void dpt_host_def_defaults(dpt_host_def *def, size_t size);

static inline void dpt_host_def_init(dpt_host_def *def)
{
    dpt_host_def_defaults(def, sizeof *def);
}

/* The name of a scene that the library makes itself, from 0; NULL after the last one. */
DPT_API const char *dpt_host_get_scene(uint32_t index);

/*
 * Open a scene and its device. Texts of the def are used during the call alone.
 *   host    NULL after a failure
 *   error   may be NULL
 *
 * DPT_E_ARGUMENT: a value is out of range, there is neither a scene nor bodies, or both, or neither a device nor an info.
 * DPT_E_ABSENT: this build reads no scene files. DPT_E_UNSUPPORTED: what there is does not go together, such as a recording
 * of `bodies` or `segments`, of which a replay knows nothing. Otherwise what reading, compiling or opening returned.
 */
DPT_API dpt_result dpt_host_open(const dpt_host_def *def, dpt_host **host, dpt_host_error *error);

/*
 * Close host and device, and end the recording. It must not be running. NULL is allowed.
 *   error   may be NULL. A note tells how many records were dropped, as the disk was too slow
 *
 * DPT_E_WRITE: some of the recording could not be written. The host is closed in any case.
 */
DPT_API dpt_result dpt_host_close(dpt_host *host, dpt_host_error *error);

/*
 * Serve the device in this thread, as dpt_loop_run does: until dpt_host_stop, after `ticks`, or when the device is lost.
 * At the end it sends zero force.
 *   stats   may be NULL
 *   error   may be NULL
 *
 * DPT_E_ARGUMENT: the host has no device. DPT_E_SYSTEM: there is no thread for physics. Otherwise as dpt_loop_run.
 */
DPT_API dpt_result dpt_host_run(dpt_host *host, dpt_loop_stats *stats, dpt_host_error *error);

/* End the present run, or the next one if none is running. From any thread, and from a signal handler. */
DPT_API void dpt_host_stop(dpt_host *host);

/*
 * One tick of a loop of your own, of a host without a device. Allocates nothing and reads no clock, but for how long a
 * step takes in a recording. Physics at a rate of its own goes by the ticks' time.
 *   state    the newest sample; `fresh`, `status`, `sequence`, `time_ns` and the pose count
 *   now_ns   of the clock of time_ns: for the guard
 *   wrench   out: what to send, after the guard; zero if an argument is NULL, and where the device is not ready
 *
 * It returns what the tick returned: DPT_OK also without a fresh sample, and DPT_E_NOT_READY while the clutch is down.
 * The wrench is to be sent in any case: after a tick that failed the guard ends the force.
 */
DPT_API dpt_result dpt_host_tick(dpt_host *host, const dpt_device_state *state, uint64_t now_ns, dpt_wrench *wrench);

DPT_API dpt_result dpt_host_get_info(const dpt_host *host, dpt_host_info *info);

/* The world and the tool in it, for what world.h, tool.h and snapshot.h tell. NULL and 0 for a host that is NULL. */
DPT_API dpt_world *dpt_host_get_world(const dpt_host *host);
DPT_API dpt_tool dpt_host_get_tool(const dpt_host *host);

/* A body in the world, in the order of the scene, from 0: to move it, or to ask for its vertices. 0: there is none. */
DPT_API dpt_body dpt_host_get_body(const dpt_host *host, uint32_t index);

DPT_END

#endif
