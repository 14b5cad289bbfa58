/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * libdynpoint_drivers: open, read and write haptic devices of all kinds with the same calls. The servo loop that does
 * so at the device's rate is in loop.h.
 *
 *     dpt_device_error error = { .size = sizeof error };
 *     dpt_device_state state = { .size = sizeof state };
 *     if (dpt_device_open("sim:?hand=press&live=1", &device, &error) != DPT_OK)
 *         complain(error.text);
 *     while (dpt_device_read(device, &state) == DPT_OK) { ... dpt_device_write(device, &wrench); ... }
 *     dpt_device_close(device);
 *
 * Units are SI. The device's frame is right-handed: x to the right, y up, z towards the user. Its origin is the middle
 * of the workspace.
 *
 * Threads: a device and all calls on it belong to one thread at a time; different devices may be served by different
 * threads. Functions without a device argument may be called from any thread.
 */
#ifndef DYNPOINT_DEVICE_H
#define DYNPOINT_DEVICE_H

#include "dynpoint/coupling.h"
#include "dynpoint/types.h"

DPT_BEGIN

typedef struct dpt_device dpt_device;

/*
 * What a device is and can do. It does not change while the device is open.
 *
 * A coupling is computed from the fields `mass` to `delay`. Many makers do not publish them. The caller can supply a
 * missing value as a setting of the field's name, as in "serial:/dev/ttyACM0?mass=0.1&damping=0.5" (docs/drivers.md).
 */
typedef struct dpt_device_info {
    uint32_t size;           /* sizeof(dpt_device_info), set by the caller */
    uint32_t pose_dofs;      /* 3: position alone, the orientation is the identity; 6: both */
    uint32_t wrench_dofs;    /* 0: it only senses; 3: force; 6: force and torque */
    uint32_t joints;         /* number of joints in the state, 0..DPT_JOINTS_MAX */
    uint32_t buttons;        /* number of buttons, 0..32 */
    uint32_t flags;          /* DPT_DEVICE_FLAG_... */
    double rate;             /* at which it samples and expects commands, Hz */
    double force_max;        /* largest length of the force vector, N */
    double force_continuous; /* largest force that it can hold for ever, N; 0: unknown */
    double torque_max;       /* largest length of the torque vector, Nm */
    double stiffness_max;    /* stiffness that its maker states, N/m; 0: unknown */
    double position_step;    /* smallest change of position that it measures, m; 0: unknown */
    double angle_step;       /* smallest change of angle that it measures, rad; 0: unknown */
    double mass;             /* mass that the hand moves, kg; 0: unknown */
    double inertia;          /* inertia that the hand turns, kg m2; 0: unknown */
    double damping;          /* viscous damping, Ns/m; 0: unknown */
    double spin_damping;     /* viscous damping of rotation, Nms/rad; 0: unknown */
    double friction;         /* Coulomb friction, N; 0: unknown */
    double spin_friction;    /* Coulomb friction of rotation, Nm; 0: unknown */
    double delay;            /* from a sample to its command, without the loop's, s; 0: unknown */
    double watchdog;         /* the force ends after so long without a command, s; 0: none */
    double workspace_min[3]; /* m */
    double workspace_max[3]; /* m */
    char name[48];           /* of the kind of device, for people */
    char serial[48];         /* serial number, or "" */
} dpt_device_info;

/* Bits of dpt_device_info.flags. */
enum {
    /* No hand holds it. */
    DPT_DEVICE_FLAG_SIMULATED = 1,
    /* Its time passes by reads: each sample is one period later than the last. */
    DPT_DEVICE_FLAG_DETERMINISTIC = 2,
    /* It is an arm: dpt_device_state.joint holds coordinates as in arm.h, and the pose is that of the arm's tool. */
    DPT_DEVICE_FLAG_ARM = 4
};

/* dpt_device_state.status */
enum {
    /* It is unplugged or does not answer. dpt_device_clear reopens it when it is back. */
    DPT_DEVICE_STATUS_LOST = 0,
    /* It stopped itself and gives no force until dpt_device_clear. */
    DPT_DEVICE_STATUS_FAULT = 1,
    /* It is not calibrated, or its motors are off: its poses may be wrong, and it gives no force. */
    DPT_DEVICE_STATUS_UNREADY = 2,
    DPT_DEVICE_STATUS_READY = 3
};

/*
 * Why a device is not ready; bits of dpt_device_state.reasons. If a driver sets a bit that has no name here,
 * dpt_device_read reports DPT_REASON_DEVICE instead.
 */
enum {
    DPT_REASON_UNPLUGGED = 1,
    DPT_REASON_SILENT = 2,   /* no sample came in time */
    DPT_REASON_WATCHDOG = 4, /* the device's own watchdog got no command in time */
    DPT_REASON_OVERHEATED = 8,
    DPT_REASON_OVERLOADED = 16, /* force, current or velocity was above its limit */
    DPT_REASON_UNCALIBRATED = 32,
    DPT_REASON_ESTOP = 64,    /* emergency stop */
    DPT_REASON_LINK = 128,    /* the line is bad: too many damaged frames, bus off */
    DPT_REASON_VERSION = 256, /* the device speaks another version of the protocol */
    DPT_REASON_DEVICE = 512,  /* a fault of the device's own; dpt_device_state.code says which */
    DPT_REASON_DOCKED = 1024  /* it lies in its holder (inkwell, dock) and gives no force there */
};

/* One sample. Pose, velocity and spin are in the device's frame. */
typedef struct dpt_device_state {
    uint32_t size;     /* sizeof(dpt_device_state), set by the caller */
    uint32_t status;   /* DPT_DEVICE_STATUS_... */
    uint32_t reasons;  /* DPT_REASON_...: why it is not ready */
    uint32_t code;     /* the device's own number of its fault */
    uint32_t buttons;  /* bit k: button k is down */
    uint32_t fresh;    /* samples since the last read; 0: no new one; n: the newest, n - 1 unseen */
    uint64_t sequence; /* the sample's number, counted by the device; it grows by 1 */
    /* When the sample was taken, on the host's monotonic clock. A deterministic device has a time of its own. */
    uint64_t time_ns;
    dpt_pose pose;
    double velocity[3];           /* m/s */
    double spin[3];               /* rad/s; zero if pose_dofs is 3 */
    double temperature;           /* of the hottest motor: 0 is cold, 1 is its limit; -1: unknown */
    double reserved[6];           /* 0 */
    double joint[DPT_JOINTS_MAX]; /* the first `joints`: rad, or m for a slider; the others 0 */
} dpt_device_state;

/* Counts since the device was opened. */
typedef struct dpt_device_counts {
    uint32_t size; /* sizeof(dpt_device_counts), set by the caller */
    uint32_t reserved;
    uint64_t samples;   /* samples that the device took, by its sequence numbers */
    uint64_t lost;      /* samples that never arrived */
    uint64_t reordered; /* samples that arrived after a later one, and were dropped */
    uint64_t damaged;   /* frames refused: wrong checksum or length, or unknown */
    uint64_t commands;  /* commands written, those refused with DPT_E_BUSY included */
    uint64_t refused;   /* commands that the line had no room for */
    uint64_t missed;    /* commands that the device expected and did not get, as it reports */
    uint64_t resets;    /* restarts of the device, and reopenings by dpt_device_clear */
} dpt_device_counts;

/*
 * What an open has to say to a person, in one line without the driver's name.
 *   code   what the open returned
 *   text   after a failure, what was tried and what to do. After a success, what a person must still do before the
 *          device gives force, or "" for nothing
 */
typedef struct dpt_device_error {
    uint32_t size; /* sizeof(dpt_device_error), set by the caller */
    int32_t code;
    char text[240];
} dpt_device_error;

/*
 * Open a device by the name that people type: "DRIVER" or "DRIVER:WHERE", as in "serial:/dev/ttyACM0".
 *   device   the open device; NULL after a failure
 *   error    may be NULL
 */
DPT_API dpt_result dpt_device_open(const char *name, dpt_device **device, dpt_device_error *error);

/*
 * Each calls the driver's function of the same name; driver.h has their contracts. A NULL argument is DPT_E_ARGUMENT;
 * dpt_device_close(NULL) does nothing. For a wrench that is not finite, dpt_device_write writes zero and returns
 * DPT_E_FINITE.
 */
DPT_API dpt_result dpt_device_get_info(const dpt_device *device, dpt_device_info *info);
DPT_API dpt_result dpt_device_read(dpt_device *device, dpt_device_state *state);
DPT_API dpt_result dpt_device_write(dpt_device *device, const dpt_wrench *wrench);
DPT_API dpt_result dpt_device_clear(dpt_device *device);
DPT_API dpt_result dpt_device_get_counts(const dpt_device *device, dpt_device_counts *counts);
DPT_API void dpt_device_close(dpt_device *device);

/*
 * Steer the hand of a simulated device: from now on it goes to `position`, in the device's frame, at 0.5 m/s at most, and
 * pulls the device there by its spring. For a person who has no device but a mouse. In any one thread, also while a loop
 * serves the device.
 *
 * DPT_E_UNSUPPORTED: the device is real, or has no hand, or one that pushes by a force. DPT_E_FINITE: the position is not
 * finite or is beyond DPT_COORDINATE_MAX.
 */
DPT_API dpt_result dpt_device_steer(dpt_device *device, const double position[3]);

/*
 * Map the device's workspace onto a model so that the hand can reach the model's whole box. The middle of the workspace
 * is mapped to the middle of the box: a point p of the device is at offset + scale p in the model. Forces are not
 * scaled.
 *   box_min, box_max   in the model's frame, m
 *   scale              metres of the model for one metre of the hand; 1 if the box is a point
 *   offset             in the model's frame, m
 *
 * DPT_E_FINITE: a number is not finite or is beyond DPT_COORDINATE_MAX, or the device reports no workspace.
 * DPT_E_ARGUMENT: box_max is below box_min.
 */
DPT_API dpt_result dpt_device_map(const dpt_device_info *info, const double box_min[3], const double box_max[3],
                                  double *scale, double offset[3]);

/*
 * Fill in what a device and its rate say of a coupling (coupling.h); the fields of loop_delay, zoom, force_scale, tool and
 * wishes stay.
 */
DPT_API dpt_result dpt_device_fill_coupling(const dpt_device_info *info, dpt_coupling_def *def);

/* The name of a DPT_DEVICE_STATUS_..., as "ready" or "fault"; "?" for any other number. */
DPT_API const char *dpt_device_status_name(uint32_t status);

/*
 * The name of the lowest reason in `reasons`, as "overheated"; NULL if there is none. To print all of them:
 *     for (uint32_t left = state.reasons; left; left &= left - 1)
 *         puts(dpt_device_reason_name(left));
 */
DPT_API const char *dpt_device_reason_name(uint32_t reasons);

DPT_END

#endif
