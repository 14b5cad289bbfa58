/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * For programs that know the OpenHaptics device API: what its utility library (HDU) offers and is needed beside this
 * library, in plain C and without OpenHaptics. The driver itself is "openhaptics" (driver.h, docs/drivers.md); the
 * number of an error is dpt_device_state.code of one of its devices. A workspace is mapped by dpt_device_map.
 *
 * OpenHaptics measures in mm, mm/s, N and mNm. A transform is 16 doubles, column by column: three axes and the position,
 * each with a fourth number behind it (0, 0, 0, 1).
 *
 * Threads: stateless; every function may be called from any thread.
 */
#ifndef DYNPOINT_OPENHAPTICS_H
#define DYNPOINT_OPENHAPTICS_H

#include "dynpoint/types.h"

DPT_BEGIN

/*
 * What the numbers of errors mean, 1 or 0.
 *   force      0x200 to 0x204: motors are warm, or a force, impulse or velocity was too great. The device goes on by itself
 *   scheduler  0x302 to 0x304, 0x500, 0x501: the line, the timer or the scheduler fails. It has to be opened again
 */
DPT_API int dpt_hd_is_force_error(uint32_t code);
DPT_API int dpt_hd_is_scheduler_error(uint32_t code);

/* Millimetres to metres and back, also of velocities; `from` may be `to`. What is rounded is rounded once. */
DPT_API dpt_result dpt_hd_to_metres(const double from[3], double to[3]);
DPT_API dpt_result dpt_hd_to_millimetres(const double from[3], double to[3]);

/*
 * HD_CURRENT_TRANSFORM to a pose and back. Of axes that are not quite unit and square to each other the z axis, which is
 * the stylus, keeps its direction, and x gives way to it.
 *   DPT_E_FINITE   a number is not finite or too large
 *   DPT_E_POSE     axes off unit length or a right angle by more than 0.1, or left-handed; a quaternion not of unit length
 */
DPT_API dpt_result dpt_hd_to_pose(const double transform[16], dpt_pose *pose);
DPT_API dpt_result dpt_hd_to_transform(const dpt_pose *pose, double transform[16]);

DPT_END

#endif
