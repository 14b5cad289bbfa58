/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The second writing of drivers/openhaptics/hd_api.h, with who says so:
 *   A  danepowell/openhaptics usr/include/HD (version 3.0, Linux x86-64)
 *   B  hhmai/PhantomAPI include/HD/hdDefines.h (version 3.30)
 *   C  huangmin007/OpenHaptics4CSharp OH4CSharp/HD/HDDLLDefines.cs
 *   D  mikelitu/pyOpenHaptics pyOpenHaptics/hd_define.py, which has HD_INVALID_OPERATION wrong, and is not counted there
 * Signatures are of A; what a name stands for is a fact, the words are ours.
 *
 * A program that includes this does not compile when the two differ, when hd_api.h has a name that is not here, or
 * the other way round. Nothing is to be called by it.
 */
#ifndef DPT_TESTS_HD_TABLE_H
#define DPT_TESTS_HD_TABLE_H

#include <stddef.h>

#include "openhaptics/hd_api.h"

/* clang-format off */
#define TABLE_CONSTANTS(X) \
    X(HD_CALLBACK_DONE, 0, "A B C D") \
    X(HD_CALLBACK_CONTINUE, 1, "A B C D") \
    X(HD_WAIT_CHECK_STATUS, 0, "A B C") \
    X(HD_MAX_SCHEDULER_PRIORITY, 0xFFFF, "A B C D") \
    X(HD_SUCCESS, 0x0000, "A B C D") \
    X(HD_INVALID_ENUM, 0x0100, "A B C D") \
    X(HD_INVALID_VALUE, 0x0101, "A B C D") \
    X(HD_INVALID_OPERATION, 0x0102, "A B C") \
    X(HD_INVALID_INPUT_TYPE, 0x0103, "A B C") \
    X(HD_BAD_HANDLE, 0x0104, "A B C D") \
    X(HD_WARM_MOTORS, 0x0200, "A B C D") \
    X(HD_EXCEEDED_MAX_FORCE, 0x0201, "A B C D") \
    X(HD_EXCEEDED_MAX_FORCE_IMPULSE, 0x0202, "A B C D") \
    X(HD_EXCEEDED_MAX_VELOCITY, 0x0203, "A B C D") \
    X(HD_FORCE_ERROR, 0x0204, "A B C D") \
    X(HD_DEVICE_FAULT, 0x0300, "A B C D") \
    X(HD_DEVICE_ALREADY_INITIATED, 0x0301, "A B C D") \
    X(HD_COMM_ERROR, 0x0302, "A B C D") \
    X(HD_COMM_CONFIG_ERROR, 0x0303, "A B C D") \
    X(HD_TIMER_ERROR, 0x0304, "A B C D") \
    X(HD_ILLEGAL_BEGIN, 0x0400, "A B C D") \
    X(HD_ILLEGAL_END, 0x0401, "A B C D") \
    X(HD_FRAME_ERROR, 0x0402, "A B C D") \
    X(HD_INVALID_PRIORITY, 0x0500, "A B C D") \
    X(HD_SCHEDULER_FULL, 0x0501, "A B C D") \
    X(HD_INVALID_LICENSE, 0x0600, "A B C D") \
    X(HD_CURRENT_BUTTONS, 0x2000, "A B C D") \
    X(HD_CURRENT_INKWELL_SWITCH, 0x2002, "A B C D") \
    X(HD_CURRENT_VELOCITY, 0x2051, "A B C D") \
    X(HD_CURRENT_TRANSFORM, 0x2052, "A B C D") \
    X(HD_CURRENT_ANGULAR_VELOCITY, 0x2053, "A B C D") \
    X(HD_CURRENT_JOINT_ANGLES, 0x2100, "A B C D") \
    X(HD_CURRENT_GIMBAL_ANGLES, 0x2150, "A B C D") \
    X(HD_DEVICE_MODEL_TYPE, 0x2501, "A B C D") \
    X(HD_DEVICE_SERIAL_NUMBER, 0x2504, "A B C D") \
    X(HD_MAX_WORKSPACE_DIMENSIONS, 0x2550, "A B C D") \
    X(HD_USABLE_WORKSPACE_DIMENSIONS, 0x2551, "A B C D") \
    X(HD_INPUT_DOF, 0x2553, "A B C D") \
    X(HD_OUTPUT_DOF, 0x2554, "A B C D") \
    X(HD_CALIBRATION_STYLE, 0x2555, "A B C D") \
    X(HD_UPDATE_RATE, 0x2600, "A B C D") \
    X(HD_NOMINAL_MAX_STIFFNESS, 0x2602, "A B C D") \
    X(HD_NOMINAL_MAX_FORCE, 0x2603, "A B C D") \
    X(HD_NOMINAL_MAX_CONTINUOUS_FORCE, 0x2604, "A B C D") \
    X(HD_MOTOR_TEMPERATURE, 0x2605, "A B C D") \
    X(HD_NOMINAL_MAX_TORQUE_FORCE, 0x2622, "A B C D") \
    X(HD_CURRENT_FORCE, 0x2700, "A B C D") \
    X(HD_CURRENT_TORQUE, 0x2701, "A B C D") \
    X(HD_FORCE_OUTPUT, 0x4000, "A B C D") \
    X(HD_MAX_FORCE_CLAMPING, 0x4001, "A B C D") \
    X(HD_FORCE_RAMPING, 0x4002, "A B C D") \
    X(HD_CALIBRATION_OK, 0x5000, "A B C D") \
    X(HD_CALIBRATION_NEEDS_UPDATE, 0x5001, "A B C D") \
    X(HD_CALIBRATION_NEEDS_MANUAL_INPUT, 0x5002, "A B C D") \
    X(HD_CALIBRATION_ENCODER_RESET, 0x0001, "A B C D") \
    X(HD_CALIBRATION_AUTO, 0x0002, "A B C D") \
    X(HD_CALIBRATION_INKWELL, 0x0004, "A B C D")

/* X(result, name, arguments): each is declared once more, and a C compiler refuses two declarations that differ. */
#define TABLE_FUNCTIONS(X) \
    X(unsigned int, hdInitDevice, (const char *)) \
    X(void, hdDisableDevice, (unsigned int)) \
    X(void, hdMakeCurrentDevice, (unsigned int)) \
    X(void, hdBeginFrame, (unsigned int)) \
    X(void, hdEndFrame, (unsigned int)) \
    X(struct hd_error, hdGetError, (void)) \
    X(const char *, hdGetErrorString, (unsigned int)) \
    X(void, hdEnable, (unsigned int)) \
    X(void, hdGetBooleanv, (unsigned int, unsigned char *)) \
    X(void, hdGetIntegerv, (unsigned int, int *)) \
    X(void, hdGetDoublev, (unsigned int, double *)) \
    X(const char *, hdGetString, (unsigned int)) \
    X(void, hdSetDoublev, (unsigned int, const double *)) \
    X(unsigned int, hdCheckCalibration, (void)) \
    X(unsigned int, hdCheckCalibrationStyle, (void)) \
    X(void, hdUpdateCalibration, (unsigned int)) \
    X(void, hdStartScheduler, (void)) \
    X(void, hdStopScheduler, (void)) \
    X(void, hdSetSchedulerRate, (unsigned long)) \
    X(unsigned long, hdScheduleAsynchronous, (unsigned int (*)(void *), void *, unsigned short)) \
    X(void, hdUnschedule, (unsigned long)) \
    X(unsigned char, hdWaitForCompletion, (unsigned long, unsigned int))
/* clang-format on */

#define CLAIM(name, holds) typedef char name[(holds) ? 1 : -1];

#define VALUE(name, value, sources) TABLE_##name = (value),
enum { TABLE_CONSTANTS(VALUE) TABLE_END };
#define SAME(name, value) CLAIM(name##_has_its_value, (int)(name) == (int)TABLE_##name)
HD_CONSTANTS(SAME)
#define KNOWN(name, value, sources) CLAIM(name##_is_in_the_header, (int)(name) == (value))
TABLE_CONSTANTS(KNOWN)

#define OURS(result, name, arguments) __attribute__((visibility("default"))) result HD_CALL name arguments;
HD_FUNCTIONS(OURS, OURS)
#define THEIRS(result, name, arguments)                                                                                \
    result HD_CALL name arguments;                                                                                     \
    enum { TABLE_##name };
TABLE_FUNCTIONS(THEIRS)
#define LISTED(result, name, arguments) CLAIM(name##_is_listed, (int)TABLE_##name == 0)
HD_FUNCTIONS(LISTED, LISTED)
#define ONE(result, name, arguments) +1
CLAIM(as_many_functions, (0 HD_FUNCTIONS(ONE, ONE)) == (0 TABLE_FUNCTIONS(ONE)))

/* The error, by value; codes as wide as they are. */
CLAIM(an_error_is_three_words, sizeof(hd_error) == 12)
CLAIM(an_error_begins_with_its_code,
      offsetof(hd_error, code) == 0 && offsetof(hd_error, internal) == 4 && offsetof(hd_error, device) == 8)

#undef VALUE
#undef SAME
#undef KNOWN
#undef OURS
#undef THEIRS
#undef LISTED
#undef ONE
#undef CLAIM

#endif
