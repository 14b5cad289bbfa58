/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm with a motor at each joint, as the settings of can:can0?... describe it. Converts turns of the motors to the
 * pose of the tool in the device's frame, and a wrench in that frame to torques of the motors. The root's frame is that
 * of the arm's root (arm.h).
 */
#ifndef DPT_DRIVERS_CAN_ARM_H
#define DPT_DRIVERS_CAN_ARM_H

#include "can/drive.h"
#include "dynpoint/arm.h"
#include "dynpoint/device.h"
#include "settings.h"

/* The settings of the driver "can"; docs/back_ends.md has their table. */
struct can_settings {
    char interface[32];
    char arm[256], nodes[64], gear[160], zero[160], torque[160], centre[96];
    char drive[96], model[96], answers[64];
    char axes[8], firmware[8];
    double rate;      /* of estimates and commands, Hz */
    double weight;    /* 1: hold up the arm's own weight; 0: do not */
    double request;   /* 1: request each estimate; 0: controllers send them cyclically */
    double answer;    /* how long to wait for the nodes at open, s */
    double silent;    /* the device is lost after so long without an estimate, s */
    double heartbeat; /* period of heartbeats, as configured at the controllers, s */
    double watchdog;  /* ODrive: as configured at the controllers; others: set there; s; 0: none */
    struct dynamics dynamics;
    int gives_force; /* 1: the user named the controllers' watchdog, or said that there is none, or the driver sets it */
};

struct can_arm {
    const dpt_arm *arm;
    void *bytes;
    uint32_t joints;
    uint32_t wrench_dofs;
    struct drive_node ends[DPT_JOINTS_MAX]; /* the motor of each joint; its numbers are in the words of its drive */
    uint8_t is_slider[DPT_JOINTS_MAX];
    double joint_per_turn[DPT_JOINTS_MAX];     /* rad or m of the joint for a turn of its motor */
    double torque_per_effort[DPT_JOINTS_MAX];  /* Nm of the motor for an Nm or N of its joint */
    double zero[DPT_JOINTS_MAX];               /* the joint's coordinate where its motor is at 0 turns */
    double joint_limit[DPT_JOINTS_MAX];        /* largest effort of the joint, Nm or N */
    double limit[DPT_JOINTS_MAX];              /* likewise, of the joint and its motor */
    double middle[DPT_JOINTS_MAX];             /* the joint's coordinate in the middle of its limits */
    uint8_t root_axis[3];                      /* axis of the root's frame that the device's x, y, z lies along */
    double sign[3];                            /* 1, or -1 if the two point in opposite directions */
    double root_to_device[4];                  /* the same rotation as a quaternion (w, x, y, z) */
    double centre[3];                          /* the device's origin in the root's frame, m */
    double gravity[3];                         /* in the root's frame, m/s^2; 0: no weight is held up */
    double force_max;                          /* smallest along the device's three axes, joints in the middle, N */
    double torque_max;                         /* likewise, Nm; 0 if wrench_dofs is not 6 */
    double workspace_min[3], workspace_max[3]; /* in the device's frame, m */
};

/* Read the settings in `where`; those that it does not name get their defaults. */
dpt_result can_settings_read(const char *where, struct can_settings *settings, dpt_device_error *error);

/*
 * Open the arm that the settings describe; reads its file. Without a word about watchdogs the settings get one if the driver can
 * set it at all motors. After a failure nothing is left to close.
 */
dpt_result can_arm_open(struct can_arm *arm, struct can_settings *settings, dpt_device_error *error);
void can_arm_close(struct can_arm *arm);

/* 1 if a drive that reports by itself is among the motors; and 1 if CAN-FD is needed. */
int can_arm_has_reporters(const struct can_arm *arm);
int can_arm_is_fd(const struct can_arm *arm);

/* The frames of all motors. Returns their number, at most DRIVE_WANTED for each joint. */
int can_arm_wanted(const struct can_arm *arm, struct can_wanted *wanted);

/*
 * The motors' ranges are known now: limit the joints' efforts to what the motors can give, less half of their smallest step, so
 * that a torque that is rounded is not above a joint's limit either; and `force_max` and `torque_max` accordingly.
 */
void can_arm_apply_ranges(struct can_arm *arm);

/*
 * The smallest changes of the tool's position, m, and angle, rad, that all motors measure: for the joint whose step moves the
 * tool furthest, over the whole workspace. 0 if a motor's step is not known.
 */
void can_arm_steps(const struct can_arm *arm, double *position, double *angle);

/* Convert a vector from the device's frame to the root's. */
void can_arm_to_root(const struct can_arm *arm, const double *device, double *root);

/*
 * Convert motors to joints.
 *   turns, rates     of the motors, turns and turns/s
 *   joints, speeds   of the joints, rad and rad/s, or m and m/s
 */
void can_arm_joints(const struct can_arm *arm, const float *turns, const float *rates, double *joints, double *speeds);

/*
 * Fill in the tool's pose, velocity and spin in the device's frame, and the joints. Other fields of `state` stay.
 * DPT_E_FINITE: a number is not finite; `state` is as it was.
 */
dpt_result can_arm_pose(const struct can_arm *arm, const double *joints, const double *speeds, dpt_device_state *state);

/*
 * Compute the torques of the motors, Nm, that hold up `weight_share` (0..1) of the arm's weight and give `wrench` (in
 * the device's frame) on the hand. The weight takes its part of each joint's limit first. The wrench is then scaled
 * down as a whole so that no joint exceeds its limit.
 */
dpt_result can_arm_torques(const struct can_arm *arm, const double *joints, const dpt_wrench *wrench,
                           double weight_share, float *torques);

#endif
