/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "openhaptics/openhaptics_servo.h"

#include <string.h>
#include <time.h>

#include "base/vec3.h"
#include "clock.h"
#include "dynpoint/openhaptics.h"

enum { CALIBRATE_EVERY = 50, ERRORS_A_TICK = 32, START_MS = 100, LEAVE_MS = 1000 };

static const uint64_t FAULT_IS_OVER_NS = 100000000; /* after this long without the error */
static const double WARM = 0.7;                     /* of 1, from where forces get less */

enum { STOPPED, PAUSED, RUNNING };
enum { DRIVES, RESTS_SOON, RESTS };
enum { NOBODY, SERVO, HOST };

static struct {
    const struct hd_library *hd;
    struct servo *servos[SERVOS_MAX];
    unsigned long callback;
    uint64_t since_ns;
    int state;
    int rest;          /* resting, it sends zero to all */
    int errors_are_of; /* who takes them from the stack */
} scheduler;

void servo_wait(void)
{
    const struct timespec time = { 0, 1000000 };
    nanosleep(&time, NULL);
}

static struct servo *servo_at(int i)
{
    return __atomic_load_n(&scheduler.servos[i], __ATOMIC_ACQUIRE);
}

static void set_servo(int i, struct servo *servo)
{
    __atomic_store_n(&scheduler.servos[i], servo, __ATOMIC_RELEASE);
}

static void note(struct servo *servo, unsigned code, uint64_t now)
{
    const int is_fatal = dpt_hd_is_scheduler_error(code) || code == HD_DEVICE_FAULT ||
                         code == HD_BAD_HANDLE || code == HD_INVALID_LICENSE;
    if (!servo->fault || (is_fatal && !servo->is_lost))
        servo->fault = code;
    servo->is_lost |= is_fatal;
    servo->fault_ns = now;
}

/* There is one stack for all devices. What belongs to none of ours is taken to concern all of them. */
static void give_to_whom_it_concerns(hd_error error, uint64_t now)
{
    int is_known = 0;
    for (int i = 0; i < SERVOS_MAX; i++)
        is_known |= servo_at(i) && servo_at(i)->device == error.device;
    for (int i = 0; i < SERVOS_MAX; i++)
        if (servo_at(i) && (!is_known || servo_at(i)->device == error.device))
            note(servo_at(i), error.code, now);
}

/* Empties the stack. 0 when something that was asked for is not to be had; that is all that it means then. */
static int drain(uint64_t now, int is_asking)
{
    int is_told = 1;
    for (int i = 0; i < ERRORS_A_TICK; i++) {
        const hd_error error = scheduler.hd->hdGetError();
        if (error.code == HD_SUCCESS)
            break;
        if (is_asking && error.code <= HD_INVALID_INPUT_TYPE)
            is_told = 0;
        else
            give_to_whom_it_concerns(error, now);
    }
    return is_told;
}

/* In its first frame: what it tells of itself. */
static void meet(struct servo *servo, uint64_t now)
{
    const struct hd_library *hd = servo->hd;
    double values[SERVO_MOTORS];
    unsigned char is_out;
    int buttons;
    servo->is_met = 1;
    drain(now, 0);
    hd->hdGetIntegerv(HD_CURRENT_BUTTONS, &buttons);
    servo->buttons = drain(now, 1) ? 4 : 0;
    hd->hdGetDoublev(HD_CURRENT_JOINT_ANGLES, values);
    servo->joints = drain(now, 1) ? 3 : 0;
    hd->hdGetDoublev(HD_MOTOR_TEMPERATURE, values);
    servo->temperatures = drain(now, 1) ? servo->temperatures : 0;
    hd->hdGetBooleanv(HD_CURRENT_INKWELL_SWITCH, &is_out);
    servo->has_inkwell = drain(now, 1) && servo->has_inkwell;
    if (servo->inputs < 6)
        return;
    hd->hdGetDoublev(HD_CURRENT_ANGULAR_VELOCITY, values);
    servo->has_spin = drain(now, 1);
    hd->hdGetDoublev(HD_CURRENT_GIMBAL_ANGLES, values);
    if (drain(now, 1) && servo->joints == 3)
        servo->joints = 6;
}

/* Where it is and how it moves; of numbers that are none nothing is taken. */
static void sense_motion(struct servo *servo, struct servo_sample *sample)
{
    static const double identity[12] = { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
    const struct hd_library *hd = servo->hd;
    struct servo_sample read = *sample;
    double transform[16] = { 0.0 }, speed[3] = { 0.0 };
    hd->hdGetDoublev(HD_CURRENT_TRANSFORM, transform);
    hd->hdGetDoublev(HD_CURRENT_VELOCITY, speed);
    for (int k = 0; k < 3; k++)
        transform[12 + k] -= servo->middle[k];
    if (servo->inputs < 6)
        memcpy(transform, identity, sizeof identity);
    if (servo->joints >= 3)
        hd->hdGetDoublev(HD_CURRENT_JOINT_ANGLES, read.joint);
    if (servo->joints == 6)
        hd->hdGetDoublev(HD_CURRENT_GIMBAL_ANGLES, read.joint + 3);
    if (servo->has_spin)
        hd->hdGetDoublev(HD_CURRENT_ANGULAR_VELOCITY, read.spin);
    servo->is_sound = dpt_hd_to_pose(transform, &read.pose) == DPT_OK &&
                      dpt_hd_to_metres(speed, read.velocity) == DPT_OK &&
                      vec3_within(read.spin, DPT_COORDINATE_MAX) &&
                      vec3_within(read.joint, DPT_COORDINATE_MAX) &&
                      vec3_within(read.joint + 3, DPT_COORDINATE_MAX);
    if (servo->is_sound)
        *sample = read;
}

static void sense(struct servo *servo, struct servo_sample *sample, uint64_t now)
{
    const struct hd_library *hd = servo->hd;
    int buttons = 0;
    unsigned char is_out = 1;
    double heat[SERVO_MOTORS] = { 0.0 };
    sample->sequence++;
    sample->time_ns = now != 0 ? now : servo->last.time_ns;
    sense_motion(servo, sample);
    if (servo->buttons > 0)
        hd->hdGetIntegerv(HD_CURRENT_BUTTONS, &buttons);
    sample->buttons = (uint32_t)buttons & ((1u << servo->buttons) - 1);
    if (servo->has_inkwell)
        hd->hdGetBooleanv(HD_CURRENT_INKWELL_SWITCH, &is_out);
    servo->is_docked = !is_out;
    sample->temperature = -1.0;
    if (servo->temperatures == 0)
        return;
    hd->hdGetDoublev(HD_MOTOR_TEMPERATURE, heat);
    for (int i = 0; i < servo->temperatures; i++)
        sample->temperature = max_of(heat[i], sample->temperature);
}

static int is_ready(const struct servo *servo)
{
    return !servo->is_lost && !servo->fault && servo->is_sound && servo->is_calibrated &&
           !servo->is_docked;
}

/* Motors that get warm give less from WARM on, and nothing at their limit. */
static double share_of_heat(double temperature)
{
    return temperature <= WARM ? 1.0 : 1.0 - clamp01((temperature - WARM) / (1.0 - WARM));
}

/*
 * What is sent: the latest command, if it is young enough. After silence, a fault or a stop of this thread in a debugger
 * force comes back along a ramp, so that nothing kicks.
 */
static void drive(struct servo *servo, struct servo_sample *sample, uint64_t now, int rests)
{
    static const double zero[3];
    const int is_new = latest_value_take(&servo->commands);
    const struct servo_command *command = &servo->command[servo->commands.reading];
    servo->is_armed = is_ready(servo) && (servo->is_armed || is_new);
    const int is_young =
        now != 0 && command->time_ns != 0 && now < command->time_ns + servo->watchdog_ns;
    if (now - servo->last.time_ns > servo->watchdog_ns)
        servo->live = 0;
    const int is_live = servo->is_armed && is_young && !servo->is_leaving && !rests;
    servo->live = !is_live ? 0 : servo->live < servo->ramp ? servo->live + 1 : servo->live;
    sample->missed += servo->is_armed && !is_young;
    servo->gives_force = 0;
    if (servo->outputs < 3)
        return;
    const double share = (double)servo->live / servo->ramp * share_of_heat(sample->temperature);
    double out[2][3];
    vec3_store(scaled(vec3_of(is_live ? command->wrench.force : zero), share), out[0]);
    vec3_store(scaled(vec3_of(is_live ? command->wrench.torque : zero), 1000.0 * share), out[1]);
    servo->hd->hdSetDoublev(HD_CURRENT_FORCE, out[0]);
    if (servo->outputs == 6)
        servo->hd->hdSetDoublev(HD_CURRENT_TORQUE, out[1]);
    servo->gives_force = extent_of(vec3_of(out[0])) > 0.0 || extent_of(vec3_of(out[1])) > 0.0;
}

/* Never under force: where the device believes to be jumps then. Before the frame, whose sample is of the new place. */
static void calibrate(struct servo *servo)
{
    const struct hd_library *hd = servo->hd;
    if (servo->last.sequence % CALIBRATE_EVERY != 0)
        return;
    hd->hdMakeCurrentDevice(servo->device);
    unsigned is = hd->hdCheckCalibration();
    if (is == HD_CALIBRATION_NEEDS_UPDATE && servo->gives_force)
        return;
    if (is == HD_CALIBRATION_NEEDS_UPDATE &&
        (servo->style == HD_CALIBRATION_AUTO || servo->style == HD_CALIBRATION_INKWELL)) {
        hd->hdUpdateCalibration(servo->style);
        is = hd->hdCheckCalibration();
        servo->live = 0;
    }
    servo->is_calibrated = is == HD_CALIBRATION_OK;
}

static uint32_t reasons_of(const struct servo *servo)
{
    if (servo->is_lost)
        return servo->fault == HD_COMM_ERROR || servo->fault == HD_COMM_CONFIG_ERROR
                   ? DPT_REASON_LINK
                   : DPT_REASON_DEVICE;
    if (servo->fault == HD_WARM_MOTORS)
        return DPT_REASON_OVERHEATED;
    if (servo->fault)
        return dpt_hd_is_force_error(servo->fault) && servo->fault != HD_FORCE_ERROR
                   ? DPT_REASON_OVERLOADED
                   : DPT_REASON_DEVICE;
    return (servo->is_calibrated && servo->is_sound ? 0u : DPT_REASON_UNCALIBRATED) |
           (servo->is_docked ? DPT_REASON_DOCKED : 0u);
}

/* A fault ends when the host asked for it and the error has not come again for a while; force waits for a new command. */
static void clear_fault(struct servo *servo, uint64_t now)
{
    const uint32_t clears = __atomic_load_n(&servo->clears, __ATOMIC_RELAXED);
    if (clears != servo->last.clears) {
        servo->fault = now - servo->fault_ns > FAULT_IS_OVER_NS ? 0 : servo->fault;
        servo->is_armed = 0;
    }
    servo->last.clears = clears;
}

static void hand_over(struct servo *servo, uint64_t now)
{
    struct servo_sample *last = &servo->last;
    if (!servo->is_lost)
        clear_fault(servo, now);
    last->code = servo->fault;
    last->reasons = reasons_of(servo);
    last->status = servo->is_lost  ? DPT_DEVICE_STATUS_LOST
                   : servo->fault  ? DPT_DEVICE_STATUS_FAULT
                   : last->reasons ? DPT_DEVICE_STATUS_UNREADY
                                   : DPT_DEVICE_STATUS_READY;
    servo->sample[servo->samples.writing] = *last;
    latest_value_publish(&servo->samples);
}

/* They are of the thread that asks first after a start, as it would not be known whose call raised one. */
static int take_errors(int who)
{
    int is = NOBODY;
    return __atomic_compare_exchange_n(&scheduler.errors_are_of, &is, who, 0, __ATOMIC_ACQ_REL,
                                       __ATOMIC_ACQUIRE) ||
           is == who;
}

static unsigned serve(void *unused)
{
    (void)unused;
    const struct hd_library *hd = scheduler.hd;
    const int rests = __atomic_load_n(&scheduler.rest, __ATOMIC_RELAXED) != DRIVES;
    struct servo *servos[SERVOS_MAX];
    struct servo_sample next[SERVOS_MAX];
    const uint64_t now = clock_now();
    if (!take_errors(SERVO))
        return HD_CALLBACK_CONTINUE;
    for (int i = 0; i < SERVOS_MAX; i++) {
        servos[i] = servo_at(i);
        if (!servos[i])
            continue;
        servos[i]->is_leaving = __atomic_load_n(&servos[i]->leaves, __ATOMIC_RELAXED) != 0;
        const int was_lost = servos[i]->is_lost;
        /* The last frame of one that is lost is without force: perhaps it gets through. */
        if (was_lost && !servos[i]->gives_force)
            continue;
        next[i] = servos[i]->last;
        if (!was_lost)
            calibrate(servos[i]);
        hd->hdBeginFrame(servos[i]->device);
        if (!servos[i]->is_met)
            meet(servos[i], now);
        if (!was_lost)
            sense(servos[i], &next[i], now);
        drive(servos[i], &next[i], now, rests);
        hd->hdEndFrame(servos[i]->device);
    }
    drain(now, 0);
    for (int i = 0; i < SERVOS_MAX; i++) {
        if (!servos[i])
            continue;
        if (!servos[i]->is_lost)
            servos[i]->last = next[i];
        hand_over(servos[i], now);
        if (servos[i]->is_leaving)
            set_servo(i, NULL);
    }
    int soon = RESTS_SOON;
    if (rests)
        __atomic_compare_exchange_n(&scheduler.rest, &soon, RESTS, 0, __ATOMIC_RELEASE,
                                    __ATOMIC_RELAXED);
    return HD_CALLBACK_CONTINUE;
}

static void set_state(int state)
{
    __atomic_store_n(&scheduler.state, state, __ATOMIC_RELEASE);
}

static int state_of(void)
{
    return __atomic_load_n(&scheduler.state, __ATOMIC_ACQUIRE);
}

static void halt(int state)
{
    const int was = state_of();
    set_state(state);
    if (was != RUNNING)
        return;
    scheduler.hd->hdStopScheduler();
    scheduler.hd->hdUnschedule(scheduler.callback);
}

/* Zero to all: whether a device that gets no frames keeps its force is not documented. */
static int rest(void)
{
    __atomic_store_n(&scheduler.rest, RESTS_SOON, __ATOMIC_RELAXED);
    for (int i = 0; i < LEAVE_MS; i++) {
        if (__atomic_load_n(&scheduler.rest, __ATOMIC_ACQUIRE) == RESTS || scheduler_is_dead())
            return 1;
        servo_wait();
    }
    __atomic_store_n(&scheduler.rest, DRIVES, __ATOMIC_RELAXED);
    return 0;
}

int scheduler_pause(const struct hd_library *hd)
{
    if (!scheduler.hd)
        scheduler.hd = hd;
    if (state_of() == RUNNING && !rest())
        return 0;
    halt(PAUSED);
    __atomic_store_n(&scheduler.rest, DRIVES, __ATOMIC_RELAXED);
    return 1;
}

static int enter(struct servo *servo)
{
    latest_value_init(&servo->samples);
    latest_value_init(&servo->commands);
    for (int i = 0; i < SERVOS_MAX; i++)
        if (!servo_at(i)) {
            set_servo(i, servo);
            return 1;
        }
    return 0;
}

unsigned scheduler_devices(void)
{
    unsigned count = 0;
    for (int i = 0; i < SERVOS_MAX; i++)
        count += servo_at(i) != NULL;
    return count;
}

static void forget(const struct servo *servo)
{
    for (int i = 0; i < SERVOS_MAX; i++)
        if (servo && servo_at(i) == servo)
            set_servo(i, NULL);
}

/* Once it ticks it has started, and errors are those of its ticks. */
static hd_error start(const struct hd_library *hd)
{
    hd_error why = { .code = HD_SUCCESS };
    hd->hdStartScheduler();
    for (int i = 0; i < START_MS; i++) {
        if (__atomic_load_n(&scheduler.errors_are_of, __ATOMIC_RELAXED) == SERVO)
            return why;
        servo_wait();
    }
    if (!take_errors(HOST))
        return why;
    why = hd_take_error(hd);
    if (dpt_hd_is_force_error(why.code))
        why.code = HD_SUCCESS;
    if (why.code == HD_SUCCESS)
        __atomic_store_n(&scheduler.errors_are_of, NOBODY, __ATOMIC_RELEASE);
    return why;
}

hd_error scheduler_resume(struct servo *servo)
{
    const struct hd_library *hd = scheduler.hd;
    hd_error why = { .code = HD_SCHEDULER_FULL };
    if (servo && !enter(servo)) {
        scheduler_resume(NULL);
        return why;
    }
    why.code = HD_SUCCESS;
    if (scheduler_devices() == 0) {
        set_state(STOPPED);
        return why;
    }
    hd_take_error(hd);
    __atomic_store_n(&scheduler.errors_are_of, NOBODY, __ATOMIC_RELAXED);
    __atomic_store_n(&scheduler.callback,
                     hd->hdScheduleAsynchronous(serve, NULL, HD_MAX_SCHEDULER_PRIORITY),
                     __ATOMIC_RELAXED);
    why = hd_take_error(hd);
    if (why.code == HD_SUCCESS) {
        why = start(hd);
        __atomic_store_n(&scheduler.since_ns, clock_now(), __ATOMIC_RELAXED);
        set_state(RUNNING);
    }
    if (why.code == HD_SUCCESS)
        return why;
    forget(servo);
    halt(STOPPED);
    return why;
}

int scheduler_leave(struct servo *servo)
{
    int at = 0;
    while (at < SERVOS_MAX && servo_at(at) != servo)
        at++;
    if (at == SERVOS_MAX)
        return 1;
    __atomic_store_n(&servo->leaves, 1, __ATOMIC_RELAXED);
    for (int i = 0; i < LEAVE_MS && servo_at(at) == servo; i++) {
        if (state_of() != RUNNING || scheduler_is_dead())
            set_servo(at, NULL);
        else
            servo_wait();
    }
    return servo_at(at) != servo;
}

int scheduler_is_paused(void)
{
    return state_of() == PAUSED;
}

int scheduler_is_dead(void)
{
    const uint64_t since = scheduler_since();
    if (state_of() != RUNNING)
        return state_of() == STOPPED;
    const unsigned long callback = __atomic_load_n(&scheduler.callback, __ATOMIC_RELAXED);
    /* A pause meanwhile is no death. */
    return !scheduler.hd->hdWaitForCompletion(callback, HD_WAIT_CHECK_STATUS) &&
           state_of() == RUNNING && scheduler_since() == since;
}

uint64_t scheduler_since(void)
{
    return __atomic_load_n(&scheduler.since_ns, __ATOMIC_RELAXED);
}
