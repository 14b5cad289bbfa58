/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_drivers: haptic devices behind one set of calls. The loop that serves one is in loop.h.
 *
 *     dpt_device_error error = { .size = sizeof error };
 *     dpt_device_state state = { .size = sizeof state };
 *     if (dpt_device_open("sim:?hand=press&live=1", &device, &error) != DPT_OK)
 *         complain(error.text);
 *     while (dpt_device_read(device, &state) == DPT_OK) { ... dpt_device_write(device, &wrench); ... }
 *     dpt_device_close(device);
 *
 * Units are SI. The device's frame is right-handed, x to the right, y up, z towards the user, its origin in the middle
 * of the workspace.
 *
 * Threads: a device and all calls on it belong to one thread at a time; different devices may be served by different
 * threads. What takes no device may be called from any thread.
 */
#ifndef DYNPOINT_DEVICE_H
#define DYNPOINT_DEVICE_H

#include "dynpoint/types.h"

DPT_BEGIN

typedef struct dpt_device dpt_device;

/*
 * What a device is and can do; fixed while it is open. From mass to delay: what a coupling is computed from. Of what
 * its maker does not tell, whoever opens it may: settings of these names, as in
 * "serial:/dev/ttyACM0?mass=0.1&damping=0.5" (docs/drivers.md).
 */
typedef struct dpt_device_info {
    uint32_t size;           /* sizeof(dpt_device_info), set by the caller */
    uint32_t pose_dofs;      /* 3: position alone, the orientation is the identity; 6: both */
    uint32_t wrench_dofs;    /* 0: it only senses; 3: force; 6: force and torque */
    uint32_t joints;         /* in the state, 0..DPT_JOINTS_MAX */
    uint32_t buttons;        /* 0..32 */
    uint32_t flags;          /* DPT_DEVICE_FLAG_SIMULATED ... */
    double rate;             /* at which it samples and wants commands, Hz */
    double force_max;        /* N, of the vector's length */
    double force_continuous; /* N, that it can hold for ever; 0: not known */
    double torque_max;       /* Nm, of the vector's length */
    double stiffness_max;    /* N/m, that its maker states; 0: not known */
    double position_step;    /* m, the least that it can tell; 0: not known */
    double angle_step;       /* rad, likewise */
    double mass;             /* kg, that the hand moves; 0: not known, as all below */
    double inertia;          /* kg m2, that it turns */
    double damping;          /* Ns/m, viscous */
    double spin_damping;     /* Nms/rad */
    double friction;         /* N, Coulomb */
    double spin_friction;    /* Nm */
    double delay;    /* s, from a sample to the command that it caused, beyond the loop's own */
    double watchdog; /* s without a command, then it gives no force; 0: it has none */
    double workspace_min[3]; /* m */
    double workspace_max[3];
    char name[48];   /* of the kind, for people */
    char serial[48]; /* of this one, or empty */
} dpt_device_info;

/* Bits of dpt_device_info.flags. */
enum {
    DPT_DEVICE_FLAG_SIMULATED = 1, /* there is no hand on it */
    DPT_DEVICE_FLAG_DETERMINISTIC =
        2, /* time passes by reads: each is one period later than the last */
    DPT_DEVICE_FLAG_ARM =
        4 /* it is an arm: `joint` are coordinates as those of arm.h, the pose is its tool's */
};

/* How a device is. */
enum {
    DPT_DEVICE_STATUS_LOST =
        0, /* unplugged, or it does not answer; dpt_device_clear when it is back */
    DPT_DEVICE_STATUS_FAULT = 1, /* it stopped itself and gives no force until dpt_device_clear */
    DPT_DEVICE_STATUS_UNREADY =
        2, /* not calibrated, or its motors are off: poses may be wrong, no force */
    DPT_DEVICE_STATUS_READY = 3
};

/* Why a device is not ready; bits of dpt_device_state.reasons. A driver's that are none of these become DPT_REASON_DEVICE. */
enum {
    DPT_REASON_UNPLUGGED = 1,
    DPT_REASON_SILENT = 2,   /* no sample within its time */
    DPT_REASON_WATCHDOG = 4, /* its own watchdog missed our commands */
    DPT_REASON_OVERHEATED = 8,
    DPT_REASON_OVERLOADED = 16, /* force, current or velocity above what it allows */
    DPT_REASON_UNCALIBRATED = 32,
    DPT_REASON_ESTOP = 64,
    DPT_REASON_LINK = 128,    /* the line is damaged: too many bad frames, bus off */
    DPT_REASON_VERSION = 256, /* it speaks another version of the protocol */
    DPT_REASON_DEVICE = 512,  /* its own fault, `code` says which */
    DPT_REASON_DOCKED =
        1024 /* it lies in its holder (an inkwell, a dock), where it gives no force */
};

/*
 * One sample. dpt_device_info.joints says how many of `joint` count.
 */
typedef struct dpt_device_state {
    uint32_t size;    /* sizeof(dpt_device_state), set by the caller */
    uint32_t status;  /* DPT_DEVICE_STATUS_READY ... */
    uint32_t reasons; /* DPT_REASON_..., while it is not ready */
    uint32_t code;    /* the device's own number of its fault */
    uint32_t buttons; /* bit k: button k is down */
    uint32_t
        fresh; /* samples since the last read. 0: this one was read before; 2: one was never seen */
    uint64_t sequence; /* of the sample, by the device's count; it grows by 1 */
    uint64_t
        time_ns; /* when it was taken, on the host's monotonic clock; a deterministic one's own time */
    dpt_pose pose;
    double velocity[3];           /* m/s */
    double spin[3];               /* rad/s; zero with 3 pose_dofs */
    double temperature;           /* of the hottest motor: 0 cold, 1 its limit; -1: not known */
    double reserved[6];           /* 0 */
    double joint[DPT_JOINTS_MAX]; /* rad, or m of a slider; zero behind the last one */
} dpt_device_state;

/* Counts since the device was opened. */
typedef struct dpt_device_counts {
    uint32_t size; /* sizeof(dpt_device_counts), set by the caller */
    uint32_t reserved;
    uint64_t samples;   /* taken by the device, as its numbers tell */
    uint64_t lost;      /* of them that never arrived */
    uint64_t reordered; /* of them that arrived after a later one, and were dropped */
    uint64_t damaged;   /* frames that were refused: checksum, length, unknown */
    uint64_t commands;  /* written, those with DPT_E_BUSY too */
    uint64_t refused;   /* of them that the line had no room for */
    uint64_t missed;    /* that the device wanted and had not got, as it says */
    uint64_t resets; /* times that the device began anew, or was opened again by dpt_device_clear */
} dpt_device_counts;

/*
 * Why an open failed, for a person: what was tried and what to do; one line, without the driver's name. After one that
 * did not, `code` is DPT_OK, and text what a person has still to do before there is force, or "".
 */
typedef struct dpt_device_error {
    uint32_t size; /* sizeof(dpt_device_error), set by the caller */
    int32_t code;
    char text[240];
} dpt_device_error;

/*
 * Open a device by a name as people type it: "DRIVER" or "DRIVER:WHERE", as in "serial:/dev/ttyACM0".
 *   error   may be NULL
 */
DPT_API dpt_result dpt_device_open(const char *name, dpt_device **device, dpt_device_error *error);

/*
 * What its driver does (driver.h). NULL is DPT_E_ARGUMENT, or nothing where nothing is returned. A wrench that is not finite
 * writes zero and is DPT_E_FINITE.
 */
DPT_API dpt_result dpt_device_get_info(const dpt_device *device, dpt_device_info *info);
DPT_API dpt_result dpt_device_read(dpt_device *device, dpt_device_state *state);
DPT_API dpt_result dpt_device_write(dpt_device *device, const dpt_wrench *wrench);
DPT_API dpt_result dpt_device_clear(dpt_device *device);
DPT_API dpt_result dpt_device_get_counts(const dpt_device *device, dpt_device_counts *counts);
DPT_API void dpt_device_close(dpt_device *device);

/*
 * How a model's box is reached as a whole from the device's workspace, middle on middle: a point p of the device is at
 * offset + scale p in the model. Forces stay as they are.
 *   scale    m of the model for one of the hand; 1 for a box that is a point
 *   DPT_E_FINITE  a number is not finite or too large, or the device tells no workspace
 *   DPT_E_ARGUMENT  box_max is below box_min
 */
DPT_API dpt_result dpt_device_map(const dpt_device_info *info, const double box_min[3],
                                  const double box_max[3], double *scale, double offset[3]);

/* "ready", "fault" ...; "?" for a number that is none. */
DPT_API const char *dpt_device_status_name(uint32_t status);

/*
 * The name of the lowest bit, "overheated"; NULL for 0 and for bits that are none. All of them:
 *     for (uint32_t left = state.reasons; left; left &= left - 1)
 *         puts(dpt_device_reason_name(left));
 */
DPT_API const char *dpt_device_reason_name(uint32_t reasons);

DPT_END

#endif
