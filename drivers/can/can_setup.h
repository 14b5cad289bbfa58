/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Set up the motors of drives that answer (drive.h), before they are switched on: read what their numbers mean, check what
 * they are, set their watchdog and read it back.
 */
#ifndef DPT_DRIVERS_CAN_SETUP_H
#define DPT_DRIVERS_CAN_SETUP_H

#include "can/can_session.h"

/*
 * Do what the drives' tables of parameters say, for all motors at once, and apply the ranges that were read to the arm. Blocks
 * until all have answered, or for the setting `answer`.
 *
 * DPT_E_DEVICE: a motor does not answer. DPT_E_PROTOCOL: it does not have a parameter, or not with a value that it must have.
 */
dpt_result can_setup_motors(struct can_session *session, dpt_device_error *error);

#endif
