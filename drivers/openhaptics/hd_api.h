/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The part of the OpenHaptics device API (HDAPI) that the driver uses, in our own declarations. libHD is loaded when a
 * device is opened (openhaptics_library.h); nothing here is linked. tests/drivers/hd/function_table.h has the same
 * declarations with the public sources that agree on them, and the compiler compares the two.
 *
 * Units of the library: mm, mm/s, N, mNm, rad, N/mm.
 */
#ifndef DPT_DRIVERS_HD_API_H
#define DPT_DRIVERS_HD_API_H

/* Calling convention of the library's functions, not of callbacks. On x86-64 there is only one. */
#ifdef __i386__
#define HD_CALL __attribute__((stdcall))
#else
#define HD_CALL
#endif

/* Returned by value. Without an error only `code` is valid. */
typedef struct hd_error {
    unsigned code;
    int internal;
    unsigned device;
} hd_error;

typedef unsigned hd_callback(void *user);

/* X(result, name, arguments); OPTIONAL ones are missing in version 3.0. */
#define HD_FUNCTIONS(REQUIRED, OPTIONAL)                                                                               \
    REQUIRED(unsigned, hdInitDevice, (const char *name))                                                               \
    REQUIRED(void, hdDisableDevice, (unsigned device))                                                                 \
    REQUIRED(void, hdMakeCurrentDevice, (unsigned device))                                                             \
    REQUIRED(void, hdBeginFrame, (unsigned device))                                                                    \
    REQUIRED(void, hdEndFrame, (unsigned device))                                                                      \
    REQUIRED(hd_error, hdGetError, (void))                                                                             \
    REQUIRED(const char *, hdGetErrorString, (unsigned code))                                                          \
    REQUIRED(void, hdEnable, (unsigned capability))                                                                    \
    REQUIRED(void, hdGetBooleanv, (unsigned what, unsigned char *values))                                              \
    REQUIRED(void, hdGetIntegerv, (unsigned what, int *values))                                                        \
    REQUIRED(void, hdGetDoublev, (unsigned what, double *values))                                                      \
    REQUIRED(const char *, hdGetString, (unsigned what))                                                               \
    REQUIRED(void, hdSetDoublev, (unsigned what, const double *values))                                                \
    REQUIRED(unsigned, hdCheckCalibration, (void))                                                                     \
    REQUIRED(void, hdUpdateCalibration, (unsigned style))                                                              \
    REQUIRED(void, hdStartScheduler, (void))                                                                           \
    REQUIRED(void, hdStopScheduler, (void))                                                                            \
    REQUIRED(void, hdSetSchedulerRate, (unsigned long rate))                                                           \
    REQUIRED(unsigned long, hdScheduleAsynchronous, (hd_callback * callback, void *user, unsigned short priority))     \
    REQUIRED(void, hdUnschedule, (unsigned long callback))                                                             \
    REQUIRED(unsigned char, hdWaitForCompletion, (unsigned long callback, unsigned wait))                              \
    OPTIONAL(unsigned, hdCheckCalibrationStyle, (void))

#define HD_CONSTANTS(X)                                                                                                \
    X(HD_CALLBACK_DONE, 0)                                                                                             \
    X(HD_CALLBACK_CONTINUE, 1)                                                                                         \
    X(HD_WAIT_CHECK_STATUS, 0)                                                                                         \
    X(HD_MAX_SCHEDULER_PRIORITY, 65535)                                                                                \
    X(HD_SUCCESS, 0)                                                                                                   \
    X(HD_INVALID_ENUM, 0x100)                                                                                          \
    X(HD_INVALID_VALUE, 0x101)                                                                                         \
    X(HD_INVALID_OPERATION, 0x102)                                                                                     \
    X(HD_INVALID_INPUT_TYPE, 0x103)                                                                                    \
    X(HD_BAD_HANDLE, 0x104)                                                                                            \
    X(HD_WARM_MOTORS, 0x200)                                                                                           \
    X(HD_EXCEEDED_MAX_FORCE, 0x201)                                                                                    \
    X(HD_EXCEEDED_MAX_FORCE_IMPULSE, 0x202)                                                                            \
    X(HD_EXCEEDED_MAX_VELOCITY, 0x203)                                                                                 \
    X(HD_FORCE_ERROR, 0x204)                                                                                           \
    X(HD_DEVICE_FAULT, 0x300)                                                                                          \
    X(HD_DEVICE_ALREADY_INITIATED, 0x301)                                                                              \
    X(HD_COMM_ERROR, 0x302)                                                                                            \
    X(HD_COMM_CONFIG_ERROR, 0x303)                                                                                     \
    X(HD_TIMER_ERROR, 0x304)                                                                                           \
    X(HD_ILLEGAL_BEGIN, 0x400)                                                                                         \
    X(HD_ILLEGAL_END, 0x401)                                                                                           \
    X(HD_FRAME_ERROR, 0x402)                                                                                           \
    X(HD_INVALID_PRIORITY, 0x500)                                                                                      \
    X(HD_SCHEDULER_FULL, 0x501)                                                                                        \
    X(HD_INVALID_LICENSE, 0x600)                                                                                       \
    X(HD_CURRENT_BUTTONS, 0x2000)                                                                                      \
    X(HD_CURRENT_INKWELL_SWITCH, 0x2002)                                                                               \
    X(HD_CURRENT_VELOCITY, 0x2051)                                                                                     \
    X(HD_CURRENT_TRANSFORM, 0x2052)                                                                                    \
    X(HD_CURRENT_ANGULAR_VELOCITY, 0x2053)                                                                             \
    X(HD_CURRENT_JOINT_ANGLES, 0x2100)                                                                                 \
    X(HD_CURRENT_GIMBAL_ANGLES, 0x2150)                                                                                \
    X(HD_DEVICE_MODEL_TYPE, 0x2501)                                                                                    \
    X(HD_DEVICE_SERIAL_NUMBER, 0x2504)                                                                                 \
    X(HD_MAX_WORKSPACE_DIMENSIONS, 0x2550)                                                                             \
    X(HD_USABLE_WORKSPACE_DIMENSIONS, 0x2551)                                                                          \
    X(HD_INPUT_DOF, 0x2553)                                                                                            \
    X(HD_OUTPUT_DOF, 0x2554)                                                                                           \
    X(HD_CALIBRATION_STYLE, 0x2555)                                                                                    \
    X(HD_UPDATE_RATE, 0x2600)                                                                                          \
    X(HD_NOMINAL_MAX_STIFFNESS, 0x2602)                                                                                \
    X(HD_NOMINAL_MAX_FORCE, 0x2603)                                                                                    \
    X(HD_NOMINAL_MAX_CONTINUOUS_FORCE, 0x2604)                                                                         \
    X(HD_MOTOR_TEMPERATURE, 0x2605)                                                                                    \
    X(HD_NOMINAL_MAX_TORQUE_FORCE, 0x2622)                                                                             \
    X(HD_CURRENT_FORCE, 0x2700)                                                                                        \
    X(HD_CURRENT_TORQUE, 0x2701)                                                                                       \
    X(HD_FORCE_OUTPUT, 0x4000)                                                                                         \
    X(HD_MAX_FORCE_CLAMPING, 0x4001)                                                                                   \
    X(HD_FORCE_RAMPING, 0x4002)                                                                                        \
    X(HD_CALIBRATION_OK, 0x5000)                                                                                       \
    X(HD_CALIBRATION_NEEDS_UPDATE, 0x5001)                                                                             \
    X(HD_CALIBRATION_NEEDS_MANUAL_INPUT, 0x5002)                                                                       \
    X(HD_CALIBRATION_ENCODER_RESET, 1)                                                                                 \
    X(HD_CALIBRATION_AUTO, 2)                                                                                          \
    X(HD_CALIBRATION_INKWELL, 4)

#define HD_CONSTANT(name, value) name = value,
enum { HD_CONSTANTS(HD_CONSTANT) HD_HANDLE_MAX = 1024 /* larger numbers are no handles */ };
#undef HD_CONSTANT

#endif
