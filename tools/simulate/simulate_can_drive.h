/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulated motors of drives that answer (can/drive.h): Damiao, RobStride, CyberGear, moteus. For simulate_can.c. */
#ifndef DPT_TOOLS_SIMULATE_CAN_DRIVE_H
#define DPT_TOOLS_SIMULATE_CAN_DRIVE_H

#include "simulate/simulate_can.h"

/* A motor as it leaves the factory: without a watchdog, in another control mode. Fills in ranges that a host would read. */
void simulate_can_drive_start(struct simulate_can_node *node, struct drive_node *end);

/* It was switched off: the watchdog is forgotten. */
void simulate_can_drive_reboot(struct simulate_can_node *node);

/* Obey a message, and answer. */
void simulate_can_drive_take(struct simulate_can *simulated, uint32_t index, const struct drive_message *message);

/* Stop with a fault of the drive's; and: no command came in time. */
void simulate_can_drive_fail(struct simulate_can_node *node, uint32_t fault);
void simulate_can_drive_expire(struct simulate_can_node *node);

#endif
