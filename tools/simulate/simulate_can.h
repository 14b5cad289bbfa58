/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Simulated motor controllers: the nodes of an arm on a CAN interface, ODrives of firmware 0.5 or 0.6 or motors of another
 * drive (simulate_can_drive.h), and a mechanism between their motors and a hand that holds the tool. It takes the same name as the driver, so both have the
 * same arm, and the loop closes on one machine.
 *
 *     simulate_can_start(&simulated, "vcan0?arm=arm.dpa&gear=8,8,8", &error);
 *     simulate_can_run(&simulated, &stop);
 *     simulate_can_end(&simulated);
 */
#ifndef DPT_TOOLS_SIMULATE_CAN_H
#define DPT_TOOLS_SIMULATE_CAN_H

#include "can/can_monitor.h"
#include "can/socketcan.h"

struct simulate_can_node {
    const struct drive_node *end; /* its drive, number and ranges */
    uint8_t node, generation;     /* of an ODrive */
    uint8_t state;                /* ODRIVE_STATE_IDLE or _CLOSED_LOOP; of other drives: off or on */
    uint8_t is_done;              /* a trajectory is done; on 0.5 this bit shows the firmware */
    uint8_t is_torque_mode;       /* 1: torque control with direct input */
    uint32_t errors;              /* of the axis; of other drives: the fault */
    uint32_t motor_errors;        /* 0.5 */
    uint32_t causes;              /* errors that clearing does not end */
    float torque;                 /* of the motor, as set last, Nm; it acts in closed loop */
    uint64_t torques;             /* number of torques received */
    uint64_t heard_tick;          /* when the last frame to this node came */
    uint64_t serial;              /* 0.6 */
    double watchdog;              /* s, 0: none */
    uint32_t estimate_ticks;      /* between estimates; 0: only on request */
    uint32_t heartbeat_ticks;
    uint32_t copies;       /* nodes with this number; usually 1 */
    uint32_t extra_frames; /* sent in each tick, to babble */
    uint8_t is_mute;       /* 1: it sends nothing */
    /* Of drives that answer. */
    double value[DRIVE_PARAMETERS];
    uint32_t refuses, lacks; /* bit k: it keeps the parameter k as it is; it does not tell it */
    float temperature;       /* degrees Celsius */
};

struct simulate_can {
    struct can_settings settings;
    struct can_arm arm;
    struct socketcan line;
    struct simulate_can_node node[DPT_JOINTS_MAX];
    uint64_t ticks;
    double inertia[DPT_JOINTS_MAX]; /* kg m^2 or kg, of each joint alone */
    double damping[DPT_JOINTS_MAX]; /* Nms/rad or Ns/m */
    double joint[DPT_JOINTS_MAX];   /* rad or m */
    double speed[DPT_JOINTS_MAX];
    double hand[3];        /* where the hand wants the tool to be, in the device's frame, m */
    double hand_stiffness; /* N/m; 0: nobody holds it */
    double hand_damping;   /* Ns/m */
    double swing;          /* m, how far up and down the hand goes */
    double swing_period;   /* s */
    uint8_t is_kinematic;  /* 1: joints stay where the test puts them; no mechanism */
    uint64_t unsent;       /* frames for which the line had no room */
    int count;             /* of `out` */
    struct can_message out[SOCKETCAN_BATCH];
};

/* Start with idle nodes and the joints in the middle of their limits. After a failure nothing stays open. */
dpt_result simulate_can_start(struct simulate_can *simulated, const char *where, dpt_device_error *error);

/*
 * One period of the setting `rate`: receive, move the mechanism, send. Reads no clock except for receive times.
 */
void simulate_can_tick(struct simulate_can *simulated);

/* Tick at the rate until *stop is not 0. */
void simulate_can_run(struct simulate_can *simulated, const volatile int *stop);

/* End, as if the controllers' power were cut. */
void simulate_can_end(struct simulate_can *simulated);

/* Queue a frame of this node, as often as it has copies. */
void simulate_can_send(struct simulate_can *simulated, const struct simulate_can_node *node,
                       const struct can_message *frame);

/* Switch a controller off and on again. */
void simulate_can_reboot(struct simulate_can_node *node);

#endif
