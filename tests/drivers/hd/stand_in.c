/* SPDX-License-Identifier: BSD-3-Clause */
/* The stand-in's devices, frames and errors. */
#define _POSIX_C_SOURCE 200809L
#include "drivers/hd/stand_in.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/hd/function_table.h"

enum { ERRORS = 64 };

__attribute__((visibility("default"))) struct stand_in stand_in;

static const unsigned NO_HANDLE = 0xFFFFFFFFu; /* HD_INVALID_HANDLE */
static int current = STAND_IN_NONE, has_failed;
static pthread_mutex_t stack_lock = PTHREAD_MUTEX_INITIALIZER;
static hd_error stack[ERRORS];
static int height;

void stand_in_push(unsigned code, int internal, unsigned device)
{
    pthread_mutex_lock(&stack_lock);
    if (height < ERRORS)
        stack[height++] = (hd_error){ code, internal, device };
    pthread_mutex_unlock(&stack_lock);
    if (!stand_in.lingers || !stand_in_is_servo())
        return;
    for (int i = 0; i < 100 && stand_in.errors(); i++)
        stand_in_wait();
    stand_in.lingers = 0;
}

void stand_in_break(const char *rule)
{
    stand_in.violations++;
    snprintf(stand_in.violation, sizeof stand_in.violation, "%s", rule);
}

void stand_in_meanwhile(void (**what)(void))
{
    void (*once)(void) = __atomic_exchange_n(what, NULL, __ATOMIC_ACQ_REL);
    if (once)
        once();
}

static int errors(void)
{
    pthread_mutex_lock(&stack_lock);
    const int count = height;
    pthread_mutex_unlock(&stack_lock);
    return count;
}

/* Like a Touch: six degrees of freedom in, three out. */
static void make_device(struct stand_in_device *device, const char *name, const char *serial)
{
    static const double workspace[6] = { -80, -60, -35, 80, 60, 35 };
    memset(device, 0, sizeof *device);
    snprintf(device->name, sizeof device->name, "%s", name);
    snprintf(device->model, sizeof device->model, "stand-in");
    snprintf(device->serial, sizeof device->serial, "%s", serial);
    device->inputs = 6;
    device->outputs = 3;
    device->force_max = 3.3;
    device->force_continuous = 0.88;
    device->stiffness = 0.5;
    device->torque_max = 188;
    memcpy(device->workspace, workspace, sizeof workspace);
    device->styles = HD_CALIBRATION_INKWELL;
    device->is_plugged = 1;
    device->calibration = HD_CALIBRATION_OK;
    for (int i = 0; i < 4; i++)
        device->transform[5 * i] = 1.0;
    device->moves = 1;
    mechanism_init(&device->mechanism);
}

static void reset(void)
{
    const char *swing = getenv("STAND_IN_SWING");
    stand_in = (struct stand_in){ .rate = 1000,
                                  .reset = stand_in.reset,
                                  .hold = stand_in.hold,
                                  .go = stand_in.go,
                                  .tick = stand_in.tick,
                                  .errors = stand_in.errors };
    make_device(&stand_in.device[0], "Default Device", "A0");
    make_device(&stand_in.device[1], "Left Device", "B1");
    stand_in.device[0].swing = swing ? atof(swing) : 0.0;
    stand_in_clear_scheduler();
    current = STAND_IN_NONE;
    has_failed = height = 0;
}

__attribute__((constructor)) static void begin(void)
{
    stand_in.reset = reset;
    stand_in.errors = errors;
    reset();
}

static struct stand_in_device *device_of(unsigned handle)
{
    if (handle < STAND_IN_DEVICES && stand_in.device[handle].is_open)
        return &stand_in.device[handle];
    stand_in_push(HD_BAD_HANDLE, 0, handle);
    return NULL;
}

unsigned HD_CALL hdInitDevice(const char *name)
{
    const unsigned failure = stand_in.fail_init;
    int at = 0;
    stand_in.fail_init = 0;
    stand_in_meanwhile(&stand_in.in_init);
    if (stand_in_runs())
        stand_in_break("a device opened while the scheduler runs");
    if (has_failed && stand_in.goes_stale) {
        has_failed = 0;
        return STAND_IN_STALE;
    }
    while (at < STAND_IN_DEVICES && strcmp(stand_in.device[at].name, name ? name : "Default Device"))
        at++;
    const int is_there = at < STAND_IN_DEVICES && stand_in.device[at].is_plugged;
    if (failure || !is_there || stand_in.device[at].is_open) {
        has_failed = 1;
        stand_in_push(failure ? failure : !is_there ? HD_DEVICE_FAULT : HD_DEVICE_ALREADY_INITIATED, -7, NO_HANDLE);
        return NO_HANDLE;
    }
    stand_in.device[at].is_open = 1;
    stand_in.device[at].enabled = 0;
    stand_in.device[at].frames = 0;
    current = at;
    return (unsigned)at;
}

void HD_CALL hdDisableDevice(unsigned handle)
{
    struct stand_in_device *device = device_of(handle);
    if (!device)
        return;
    if (device->depth)
        stand_in_break("a device closed in its frame");
    if (stand_in_runs())
        stand_in_break("a device closed while the scheduler runs");
    device->is_open = device->depth = 0;
    memset(device->force, 0, sizeof device->force);
    memset(device->torque, 0, sizeof device->torque);
    if (current == (int)handle)
        current = STAND_IN_NONE;
}

void HD_CALL hdMakeCurrentDevice(unsigned handle)
{
    if (device_of(handle))
        current = (int)handle;
}

void HD_CALL hdBeginFrame(unsigned handle)
{
    struct stand_in_device *device = device_of(handle);
    if (!device)
        return;
    if (stand_in_runs() && !stand_in_is_servo())
        stand_in_break("a frame outside of the scheduler's thread");
    if (device->depth == 0 && device->frames > 0 && device->frame_tick == stand_in.ticks) {
        stand_in_push(HD_ILLEGAL_BEGIN, 0, handle);
        return;
    }
    current = (int)handle;
    if (device->depth++ > 0)
        return;
    device->frames++;
    device->frame_tick = stand_in.ticks;
    memset(device->set_force, 0, sizeof device->set_force);
    memset(device->set_torque, 0, sizeof device->set_torque);
}

static int is_enabled(const struct stand_in_device *device, unsigned capability)
{
    return device->enabled >> (capability - HD_FORCE_OUTPUT) & 1;
}

void HD_CALL hdEndFrame(unsigned handle)
{
    struct stand_in_device *device = device_of(handle);
    double square = 0.0, share = 1.0;
    if (!device)
        return;
    if (device->depth == 0) {
        stand_in_push(HD_ILLEGAL_END, 0, handle);
        return;
    }
    if (--device->depth > 0)
        return;
    for (int k = 0; k < 3; k++)
        square += device->set_force[k] * device->set_force[k];
    if (!is_enabled(device, HD_FORCE_OUTPUT))
        share = 0.0;
    else if (square > device->force_max * device->force_max * (1.0 + 1e-12)) {
        if (!is_enabled(device, HD_MAX_FORCE_CLAMPING))
            stand_in_push(HD_EXCEEDED_MAX_FORCE, 0, handle);
        share = is_enabled(device, HD_MAX_FORCE_CLAMPING) ? device->force_max / sqrt(square) : 0.0;
    }
    for (int k = 0; k < 3; k++) {
        device->force[k] = share * device->set_force[k];
        device->torque[k] = share * device->set_torque[k];
    }
}

hd_error HD_CALL hdGetError(void)
{
    hd_error top = { HD_SUCCESS, 0x5eed, 0xdead };
    pthread_mutex_lock(&stack_lock);
    if (height > 0)
        top = stack[--height];
    pthread_mutex_unlock(&stack_lock);
    return top;
}

const char *HD_CALL hdGetErrorString(unsigned code)
{
    return code == HD_SUCCESS ? "no error" : "an error of the stand-in";
}

void HD_CALL hdEnable(unsigned capability)
{
    if (current == STAND_IN_NONE || capability < HD_FORCE_OUTPUT || capability > 0x4004)
        stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
    else
        stand_in.device[current].enabled |= 1u << (capability - HD_FORCE_OUTPUT);
}

/* The current device, when `what` may be had of it now. */
static struct stand_in_device *asked(unsigned what)
{
    struct stand_in_device *device = current == STAND_IN_NONE ? NULL : &stand_in.device[current];
    if (!device || !device->is_open) {
        stand_in_push(HD_BAD_HANDLE, 0, (unsigned)current);
        return NULL;
    }
    for (int i = 0; i < 4; i++)
        if (stand_in.unsupported[i] == what) {
            stand_in_push(stand_in.unsupported_as ? stand_in.unsupported_as : HD_INVALID_ENUM, 0, (unsigned)current);
            return NULL;
        }
    if (device->depth > 0 || (what >= 0x2500 && what < 0x2700 && what != HD_MOTOR_TEMPERATURE))
        return device;
    stand_in_push(HD_FRAME_ERROR, 0, (unsigned)current);
    stand_in_break("a value asked for or set outside of a frame");
    return NULL;
}

void HD_CALL hdGetBooleanv(unsigned what, unsigned char *value)
{
    const struct stand_in_device *device = asked(what);
    if (device && what == HD_CURRENT_INKWELL_SWITCH)
        *value = !device->in_inkwell;
    else if (device)
        stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
}

void HD_CALL hdGetIntegerv(unsigned what, int *value)
{
    const struct stand_in_device *device = asked(what);
    if (!device)
        return;
    switch (what) {
    case HD_CURRENT_BUTTONS:
        *value = device->buttons;
        break;
    case HD_INPUT_DOF:
        *value = device->inputs;
        break;
    case HD_OUTPUT_DOF:
        *value = device->outputs;
        break;
    case HD_CALIBRATION_STYLE:
        *value = (int)device->styles;
        break;
    case HD_UPDATE_RATE:
        *value = (int)stand_in.rate;
        break;
    default:
        stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
    }
}

/* An uncalibrated one believes to be here, whatever its arm does. */
static void tell_transform(const struct stand_in_device *device, double *values)
{
    memcpy(values, device->transform, sizeof device->transform);
    if (device->calibration == HD_CALIBRATION_OK)
        return;
    values[12] = 0.0;
    values[13] = -110.0;
    values[14] = -35.0;
}

void HD_CALL hdGetDoublev(unsigned what, double *values)
{
    const struct stand_in_device *device = asked(what);
    if (!device)
        return;
    const struct {
        unsigned what;
        const double *values;
        int count;
    } known[] = { { HD_CURRENT_VELOCITY, device->velocity, 3 },
                  { HD_CURRENT_ANGULAR_VELOCITY, device->spin, 3 },
                  { HD_CURRENT_JOINT_ANGLES, device->joints, 3 },
                  { HD_CURRENT_GIMBAL_ANGLES, device->gimbal, 3 },
                  { HD_USABLE_WORKSPACE_DIMENSIONS, device->workspace, 6 },
                  { HD_MAX_WORKSPACE_DIMENSIONS, device->workspace, 6 },
                  { HD_NOMINAL_MAX_FORCE, &device->force_max, 1 },
                  { HD_NOMINAL_MAX_CONTINUOUS_FORCE, &device->force_continuous, 1 },
                  { HD_NOMINAL_MAX_STIFFNESS, &device->stiffness, 1 },
                  { HD_NOMINAL_MAX_TORQUE_FORCE, &device->torque_max, 1 },
                  { HD_MOTOR_TEMPERATURE, device->temperature, device->outputs },
                  { HD_CURRENT_FORCE, device->set_force, 3 },
                  { HD_CURRENT_TORQUE, device->set_torque, 3 } };
    if (what == HD_CURRENT_TRANSFORM) {
        tell_transform(device, values);
        return;
    }
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (known[i].what == what) {
            memcpy(values, known[i].values, (size_t)known[i].count * sizeof *values);
            return;
        }
    stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
}

void HD_CALL hdSetDoublev(unsigned what, const double *values)
{
    struct stand_in_device *device = asked(what);
    if (!device)
        return;
    if (what == HD_CURRENT_FORCE && device->outputs >= 3)
        memcpy(device->set_force, values, sizeof device->set_force);
    else if (what == HD_CURRENT_TORQUE && device->outputs >= 6)
        memcpy(device->set_torque, values, sizeof device->set_torque);
    else
        stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
}

const char *HD_CALL hdGetString(unsigned what)
{
    const struct stand_in_device *device = asked(what);
    if (device && what == HD_DEVICE_MODEL_TYPE)
        return device->model;
    if (device && what == HD_DEVICE_SERIAL_NUMBER)
        return device->serial;
    if (device)
        stand_in_push(HD_INVALID_ENUM, 0, (unsigned)current);
    return NULL;
}

/* In the inkwell an arm is where the library knows it. */
unsigned HD_CALL hdCheckCalibration(void)
{
    const struct stand_in_device *device = current == STAND_IN_NONE ? NULL : &stand_in.device[current];
    if (!device) {
        stand_in_push(HD_BAD_HANDLE, 0, (unsigned)current);
        return HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    }
    return device->calibration == HD_CALIBRATION_NEEDS_MANUAL_INPUT && device->in_inkwell &&
                   device->styles & HD_CALIBRATION_INKWELL
               ? HD_CALIBRATION_NEEDS_UPDATE
               : device->calibration;
}

#ifndef STAND_IN_3_0
unsigned HD_CALL hdCheckCalibrationStyle(void)
{
    return current == STAND_IN_NONE ? 0 : stand_in.device[current].styles;
}
#endif

void HD_CALL hdUpdateCalibration(unsigned style)
{
    struct stand_in_device *device = current == STAND_IN_NONE ? NULL : &stand_in.device[current];
    if (!device || !(style & device->styles) || style & (style - 1)) {
        stand_in_push(HD_INVALID_VALUE, 0, (unsigned)current);
        return;
    }
    device->updates++;
    if (style == HD_CALIBRATION_ENCODER_RESET && stand_in_runs())
        stand_in_break("encoders reset while the scheduler runs");
    if (style != HD_CALIBRATION_ENCODER_RESET && !stand_in_is_servo())
        stand_in_break("calibrated outside of the scheduler's thread");
    for (int k = 0; k < 3; k++)
        if (device->force[k] != 0.0)
            stand_in_break("calibrated under force");
    if (style == HD_CALIBRATION_INKWELL && !device->in_inkwell)
        stand_in_push(HD_INVALID_OPERATION, 0, (unsigned)current);
    else if (!device->resists)
        device->calibration = HD_CALIBRATION_OK;
}

static void move(struct stand_in_device *device)
{
    struct mechanism *mechanism = &device->mechanism;
    float force[3];
    for (int k = 0; k < 3; k++)
        force[k] = device->in_inkwell ? 0.0f : (float)device->force[k];
    const double phase = 3.141592653589793 * (double)stand_in.ticks / stand_in.rate;
    mechanism->hand[1] = -0.5 * device->swing * (1.0 - cos(phase));
    mechanism_step(mechanism, force, 1.0 / stand_in.rate, 4);
    for (int k = 0; k < 3; k++) {
        device->transform[12 + k] = 1000.0 * mechanism->position[k];
        device->velocity[k] = 1000.0 * mechanism->velocity[k];
        device->joints[k] = mechanism->position[k] / 0.2;
    }
}

void stand_in_after_tick(void)
{
    for (int i = 0; i < STAND_IN_DEVICES; i++) {
        struct stand_in_device *device = &stand_in.device[i];
        if (device->depth > 0)
            stand_in_break("a frame is open at the end of a tick");
        if (device->moves)
            move(device);
        for (int k = 0; k < device->outputs; k++)
            if (device->is_open && device->temperature[k] >= 1.0)
                stand_in_push(HD_WARM_MOTORS, k, (unsigned)i);
    }
}
