/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * An arm with a motor at each joint: what stands behind can:can0?..., and how turns of motors become the pose of the
 * tool in the device's frame, and a wrench there torques of motors.
 */
#ifndef DPT_DRIVERS_CAN_ARM_H
#define DPT_DRIVERS_CAN_ARM_H

#include "dynpoint/arm.h"
#include "dynpoint/device.h"
#include "settings.h"

/* The settings, as the table in docs/drivers.md has them. */
struct can_settings {
    char interface[32];
    char arm[256], nodes[64], gear[160], zero[160], torque[160], centre[96];
    char axes[8], firmware[8];
    double rate;      /* Hz, of estimates and commands */
    double weight;    /* 1: hold up the arm's own weight */
    double request;   /* 1: ask for each estimate */
    double answer;    /* s, until a node has answered */
    double silent;    /* s without an estimate, then it is lost */
    double heartbeat; /* s, their period as it is configured */
    double watchdog;  /* s, likewise; 0: none */
    struct dynamics dynamics;
    int gives_force; /* the controllers have a watchdog, or it was said that they have none */
};

struct can_arm {
    const dpt_arm *arm;
    void *bytes;
    uint32_t joints;
    uint32_t wrench_dofs;
    uint8_t nodes[DPT_JOINTS_MAX];
    uint8_t is_slider[DPT_JOINTS_MAX];
    double joint_per_turn[DPT_JOINTS_MAX];    /* rad or m for a turn of the motor */
    double torque_per_effort[DPT_JOINTS_MAX]; /* Nm of the motor for an Nm or N of the joint */
    double zero[DPT_JOINTS_MAX];              /* the joint's coordinate where the motor's is 0 */
    double limit[DPT_JOINTS_MAX];             /* Nm or N of the joint */
    double middle[DPT_JOINTS_MAX];            /* of the joints' limits */
    uint8_t root_axis[3]; /* the device's x, y, z are which axes of the root's frame */
    double sign[3];
    double root_to_device[4]; /* the same as a quaternion, from the root's frame to the device's */
    double centre[3];         /* the device's origin in the root's frame, m */
    double gravity[3];        /* in the root's frame, m/s^2; 0 where no weight is held */
    double force_max;         /* N in any direction, at the centre */
    double torque_max;        /* Nm, likewise; 0 without wrench_dofs 6 */
    double workspace_min[3], workspace_max[3]; /* of the device's frame, m */
};

/* Defaults, and what `where` says. */
dpt_result can_settings_read(const char *where, struct can_settings *settings,
                             dpt_device_error *error);

/* Reads the arm's file. On failure nothing stays. */
dpt_result can_arm_open(struct can_arm *arm, const struct can_settings *settings,
                        dpt_device_error *error);
void can_arm_close(struct can_arm *arm);

/* A vector of the device's frame, in the root's. */
void can_arm_to_root(const struct can_arm *arm, const double *device, double *root);

/* The joints' coordinates and rates of the motors' turns and turns/s. */
void can_arm_joints(const struct can_arm *arm, const float *turns, const float *rates,
                    double *joints, double *speeds);

/* The tool's pose, velocity and spin, and the joints, into a state. DPT_E_FINITE leaves it as it was. */
dpt_result can_arm_pose(const struct can_arm *arm, const double *joints, const double *speeds,
                        dpt_device_state *state);

/*
 * Torques of the motors, Nm, that give `wrench` on the hand, scaled down as one so that no joint's effort is above its
 * limit, and hold up `share` of the weight, which goes first.
 */
dpt_result can_arm_torques(const struct can_arm *arm, const double *joints,
                           const dpt_wrench *wrench, double weight_share, float *torques);

#endif
