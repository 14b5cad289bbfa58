/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Helpers for programs written for the OpenHaptics device API. They replace what such programs use of its utility
 * library (HDU), in plain C and without OpenHaptics. dpt_device_map maps a workspace. The driver for the devices is
 * "openhaptics" (driver.h, docs/drivers.md); dpt_device_state.code of its devices is the number of an OpenHaptics
 * error.
 *
 * OpenHaptics measures in mm, mm/s, N and mNm. A transform is 16 doubles, column by column: the three axes and the
 * position, each followed by a fourth number (0, 0, 0, 1).
 *
 * Threads: all functions are stateless and may be called from any thread.
 */
#ifndef DYNPOINT_OPENHAPTICS_H
#define DYNPOINT_OPENHAPTICS_H

#include "dynpoint/types.h"

DPT_BEGIN

/*
 * The class of an error by its number: 1 if it belongs to the class, else 0.
 *   force      0x200 to 0x204: the motors are warm, or a force, impulse or velocity was too large. The device recovers
 *              by itself.
 *   scheduler  0x302 to 0x304, 0x500, 0x501: the line, the timer or the scheduler failed. The device must be opened
 *              again.
 */
DPT_API int dpt_hd_is_force_error(uint32_t code);
DPT_API int dpt_hd_is_scheduler_error(uint32_t code);

/*
 * Convert millimetres to metres and back; mm/s and m/s likewise. Each number is rounded once. `from` may equal `to`.
 *
 * DPT_E_FINITE: a number is not finite, or is beyond DPT_COORDINATE_MAX in m.
 */
DPT_API dpt_result dpt_hd_to_metres(const double from[3], double to[3]);
DPT_API dpt_result dpt_hd_to_millimetres(const double from[3], double to[3]);

/*
 * Convert an HD_CURRENT_TRANSFORM to a pose and back. If the axes are not exactly of unit length and perpendicular, the
 * z axis (the stylus) keeps its direction and the x axis is made perpendicular to it.
 *
 * DPT_E_FINITE: a number is not finite, or is too large.
 * DPT_E_POSE: the length of an axis is off by more than 0.1, the dot product of two axes is beyond 0.1, the axes are
 * left-handed, or the quaternion is not of unit length.
 */
DPT_API dpt_result dpt_hd_to_pose(const double transform[16], dpt_pose *pose);
DPT_API dpt_result dpt_hd_to_transform(const dpt_pose *pose, double transform[16]);

DPT_END

#endif
