/* SPDX-License-Identifier: BSD-3-Clause */
#include "openhaptics/openhaptics_servo.h"

#include <string.h>

#include "base/vec3.h"
#include "dynpoint/openhaptics.h"
#include "platform/clock.h"

enum { CALIBRATE_EVERY = 50, ERRORS_A_TICK = 32, START_MS = 100, LEAVE_MS = 1000 };

static const uint64_t FAULT_CLEAR_NS = 100000000; /* after this long without the error */
static const double WARM_TEMPERATURE = 0.7;       /* of 1, the limit: from here on forces are scaled down */

enum { STOPPED, PAUSED, RUNNING };
enum { FORCES_ON, ZERO_REQUESTED, ZERO_SENT }; /* scheduler.zero_state */
enum { NOBODY, SERVO, HOST };                  /* scheduler.error_reader */

static struct {
    const struct hd_library *hd;
    struct servo *servos[SERVOS_MAX];
    unsigned long callback;
    uint64_t since_ns;
    int state;
    int zero_state;   /* not FORCES_ON: zero is sent to all */
    int error_reader; /* which thread empties the stack of errors */
} scheduler;

void servo_wait(void)
{
    clock_sleep(1000000);
}

static struct servo *servo_at(int i)
{
    return __atomic_load_n(&scheduler.servos[i], __ATOMIC_ACQUIRE);
}

static void set_servo(int i, struct servo *servo)
{
    __atomic_store_n(&scheduler.servos[i], servo, __ATOMIC_RELEASE);
}

static void note_error(struct servo *servo, unsigned code, uint64_t now)
{
    const int is_fatal = dpt_hd_is_scheduler_error(code) || code == HD_DEVICE_FAULT || code == HD_BAD_HANDLE ||
                         code == HD_INVALID_LICENSE;
    if (!servo->fault || (is_fatal && !servo->is_lost))
        servo->fault = code;
    servo->is_lost |= is_fatal;
    servo->fault_ns = now;
}

/* The library has one stack of errors for all devices. An error of no device of ours is noted for all of them. */
static void assign_error(hd_error error, uint64_t now)
{
    int is_known = 0;
    for (int i = 0; i < SERVOS_MAX; i++)
        is_known |= servo_at(i) && servo_at(i)->device == error.device;
    for (int i = 0; i < SERVOS_MAX; i++)
        if (servo_at(i) && (!is_known || servo_at(i)->device == error.device))
            note_error(servo_at(i), error.code, now);
}

/*
 * Empty the stack of errors.
 *   is_query   1: a value that a device may lack was just queried. Returns 0 if an error says so; that error is no fault
 */
static int drain_errors(uint64_t now, int is_query)
{
    int is_answered = 1;
    for (int i = 0; i < ERRORS_A_TICK; i++) {
        const hd_error error = scheduler.hd->hdGetError();
        if (error.code == HD_SUCCESS)
            break;
        if (is_query && error.code <= HD_INVALID_INPUT_TYPE)
            is_answered = 0;
        else
            assign_error(error, now);
    }
    return is_answered;
}

/* In a device's first frame: find which values it has. */
static void query_capabilities(struct servo *servo, uint64_t now)
{
    const struct hd_library *hd = servo->hd;
    double values[SERVO_MOTORS];
    unsigned char is_out;
    int buttons;
    servo->has_capabilities = 1;
    drain_errors(now, 0);
    hd->hdGetIntegerv(HD_CURRENT_BUTTONS, &buttons);
    servo->buttons = drain_errors(now, 1) ? 4 : 0;
    hd->hdGetDoublev(HD_CURRENT_JOINT_ANGLES, values);
    servo->joints = drain_errors(now, 1) ? 3 : 0;
    hd->hdGetDoublev(HD_MOTOR_TEMPERATURE, values);
    servo->temperature_count = drain_errors(now, 1) ? servo->temperature_count : 0;
    hd->hdGetBooleanv(HD_CURRENT_INKWELL_SWITCH, &is_out);
    servo->has_inkwell = drain_errors(now, 1) && servo->has_inkwell;
    if (servo->input_dofs < 6)
        return;
    hd->hdGetDoublev(HD_CURRENT_ANGULAR_VELOCITY, values);
    servo->has_spin = drain_errors(now, 1);
    hd->hdGetDoublev(HD_CURRENT_GIMBAL_ANGLES, values);
    if (drain_errors(now, 1) && servo->joints == 3)
        servo->joints = 6;
}

/* Read pose, velocity, spin and joints. If a number is not finite, `sample` keeps the values before. */
static void read_motion(struct servo *servo, struct servo_sample *sample)
{
    static const double identity[12] = { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
    const struct hd_library *hd = servo->hd;
    struct servo_sample read = *sample;
    double transform[16] = { 0.0 }, speed[3] = { 0.0 };
    hd->hdGetDoublev(HD_CURRENT_TRANSFORM, transform);
    hd->hdGetDoublev(HD_CURRENT_VELOCITY, speed);
    for (int k = 0; k < 3; k++)
        transform[12 + k] -= servo->centre_mm[k];
    if (servo->input_dofs < 6)
        memcpy(transform, identity, sizeof identity);
    if (servo->joints >= 3)
        hd->hdGetDoublev(HD_CURRENT_JOINT_ANGLES, read.joint);
    if (servo->joints == 6)
        hd->hdGetDoublev(HD_CURRENT_GIMBAL_ANGLES, read.joint + 3);
    if (servo->has_spin)
        hd->hdGetDoublev(HD_CURRENT_ANGULAR_VELOCITY, read.spin);
    servo->is_valid = dpt_hd_to_pose(transform, &read.pose) == DPT_OK &&
                      dpt_hd_to_metres(speed, read.velocity) == DPT_OK && vec3_within(read.spin, DPT_COORDINATE_MAX) &&
                      vec3_within(read.joint, DPT_COORDINATE_MAX) && vec3_within(read.joint + 3, DPT_COORDINATE_MAX);
    if (servo->is_valid)
        *sample = read;
}

static void read_sample(struct servo *servo, struct servo_sample *sample, uint64_t now)
{
    const struct hd_library *hd = servo->hd;
    int buttons = 0;
    unsigned char is_out = 1;
    double temperatures[SERVO_MOTORS] = { 0.0 };
    sample->sequence++;
    sample->time_ns = now != 0 ? now : servo->last.time_ns;
    read_motion(servo, sample);
    if (servo->buttons > 0)
        hd->hdGetIntegerv(HD_CURRENT_BUTTONS, &buttons);
    sample->buttons = (uint32_t)buttons & ((1u << servo->buttons) - 1);
    if (servo->has_inkwell)
        hd->hdGetBooleanv(HD_CURRENT_INKWELL_SWITCH, &is_out);
    servo->is_docked = !is_out;
    sample->temperature = -1.0;
    if (servo->temperature_count == 0)
        return;
    hd->hdGetDoublev(HD_MOTOR_TEMPERATURE, temperatures);
    for (int i = 0; i < servo->temperature_count; i++)
        sample->temperature = max_of(temperatures[i], sample->temperature);
}

static int is_ready(const struct servo *servo)
{
    return !servo->is_lost && !servo->fault && servo->is_valid && servo->is_calibrated && !servo->is_docked;
}

/* The factor by which forces of warm motors are scaled: 1 up to WARM_TEMPERATURE, 0 at the limit. */
static double heat_scale(double temperature)
{
    return temperature <= WARM_TEMPERATURE ? 1.0
                                           : 1.0 - clamp01((temperature - WARM_TEMPERATURE) / (1.0 - WARM_TEMPERATURE));
}

/*
 * Send the latest command, if it is younger than the watchdog. After silence, a fault or a stop of this thread in a
 * debugger the force returns along a ramp, so that nothing kicks.
 */
static void drive(struct servo *servo, struct servo_sample *sample, uint64_t now, int must_send_zero)
{
    static const double zero[3];
    const int is_new = latest_value_take(&servo->commands);
    const struct servo_command *command = &servo->command[servo->commands.reading];
    servo->is_armed = is_ready(servo) && (servo->is_armed || is_new);
    const int is_young = now != 0 && command->time_ns != 0 && now < command->time_ns + servo->watchdog_ns;
    if (now - servo->last.time_ns > servo->watchdog_ns)
        servo->live_ticks = 0;
    const int is_live = servo->is_armed && is_young && !servo->is_leaving && !must_send_zero;
    servo->live_ticks = !is_live                                ? 0
                        : servo->live_ticks < servo->ramp_ticks ? servo->live_ticks + 1
                                                                : servo->live_ticks;
    sample->missed += servo->is_armed && !is_young;
    servo->gives_force = 0;
    if (servo->output_dofs < 3)
        return;
    const double scale = (double)servo->live_ticks / servo->ramp_ticks * heat_scale(sample->temperature);
    double out[2][3];
    vec3_store(scaled(vec3_of(is_live ? command->wrench.force : zero), scale), out[0]);
    vec3_store(scaled(vec3_of(is_live ? command->wrench.torque : zero), 1000.0 * scale), out[1]);
    servo->hd->hdSetDoublev(HD_CURRENT_FORCE, out[0]);
    if (servo->output_dofs == 6)
        servo->hd->hdSetDoublev(HD_CURRENT_TORQUE, out[1]);
    servo->gives_force = extent_of(vec3_of(out[0])) > 0.0 || extent_of(vec3_of(out[1])) > 0.0;
}

/*
 * Calibrate, but never under force, because the pose jumps. Call it before the frame, whose sample then has the new
 * pose.
 */
static void calibrate(struct servo *servo)
{
    const struct hd_library *hd = servo->hd;
    if (servo->last.sequence % CALIBRATE_EVERY != 0)
        return;
    hd->hdMakeCurrentDevice(servo->device);
    unsigned status = hd->hdCheckCalibration();
    if (status == HD_CALIBRATION_NEEDS_UPDATE && servo->gives_force)
        return;
    if (status == HD_CALIBRATION_NEEDS_UPDATE &&
        (servo->style == HD_CALIBRATION_AUTO || servo->style == HD_CALIBRATION_INKWELL)) {
        hd->hdUpdateCalibration(servo->style);
        status = hd->hdCheckCalibration();
        servo->live_ticks = 0;
    }
    servo->is_calibrated = status == HD_CALIBRATION_OK;
}

static uint32_t reasons_of(const struct servo *servo)
{
    if (servo->is_lost)
        return servo->fault == HD_COMM_ERROR || servo->fault == HD_COMM_CONFIG_ERROR ? DPT_REASON_LINK
                                                                                     : DPT_REASON_DEVICE;
    if (servo->fault == HD_WARM_MOTORS)
        return DPT_REASON_OVERHEATED;
    if (servo->fault)
        return dpt_hd_is_force_error(servo->fault) && servo->fault != HD_FORCE_ERROR ? DPT_REASON_OVERLOADED
                                                                                     : DPT_REASON_DEVICE;
    return (servo->is_calibrated && servo->is_valid ? 0u : DPT_REASON_UNCALIBRATED) |
           (servo->is_docked ? DPT_REASON_DOCKED : 0u);
}

/*
 * End a fault if the host requested it and the error did not come again for FAULT_CLEAR_NS. Force waits for a new
 * command.
 */
static void clear_fault(struct servo *servo, uint64_t now)
{
    const uint32_t clear_requests = __atomic_load_n(&servo->clear_requests, __ATOMIC_RELAXED);
    if (clear_requests != servo->last.clear_requests) {
        servo->fault = now - servo->fault_ns > FAULT_CLEAR_NS ? 0 : servo->fault;
        servo->is_armed = 0;
    }
    servo->last.clear_requests = clear_requests;
}

static void publish_sample(struct servo *servo, uint64_t now)
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

/* After a start the first thread that claims the errors keeps them; otherwise nobody knew whose call raised one. */
static int claim_errors(int claimant)
{
    int reader = NOBODY;
    return __atomic_compare_exchange_n(&scheduler.error_reader, &reader, claimant, 0, __ATOMIC_ACQ_REL,
                                       __ATOMIC_ACQUIRE) ||
           reader == claimant;
}

static unsigned serve(void *unused)
{
    (void)unused;
    const struct hd_library *hd = scheduler.hd;
    const int must_send_zero = __atomic_load_n(&scheduler.zero_state, __ATOMIC_RELAXED) != FORCES_ON;
    struct servo *servos[SERVOS_MAX];
    struct servo_sample next[SERVOS_MAX];
    const uint64_t now = clock_now();
    if (!claim_errors(SERVO))
        return HD_CALLBACK_CONTINUE;
    for (int i = 0; i < SERVOS_MAX; i++) {
        servos[i] = servo_at(i);
        if (!servos[i])
            continue;
        servos[i]->is_leaving = __atomic_load_n(&servos[i]->must_leave, __ATOMIC_RELAXED) != 0;
        const int was_lost = servos[i]->is_lost;
        /* A lost device gets one last frame without force: perhaps it arrives. */
        if (was_lost && !servos[i]->gives_force)
            continue;
        next[i] = servos[i]->last;
        if (!was_lost)
            calibrate(servos[i]);
        hd->hdBeginFrame(servos[i]->device);
        if (!servos[i]->has_capabilities)
            query_capabilities(servos[i], now);
        if (!was_lost)
            read_sample(servos[i], &next[i], now);
        drive(servos[i], &next[i], now, must_send_zero);
        hd->hdEndFrame(servos[i]->device);
    }
    drain_errors(now, 0);
    for (int i = 0; i < SERVOS_MAX; i++) {
        if (!servos[i])
            continue;
        if (!servos[i]->is_lost)
            servos[i]->last = next[i];
        publish_sample(servos[i], now);
        if (servos[i]->is_leaving)
            set_servo(i, NULL);
    }
    int requested = ZERO_REQUESTED;
    if (must_send_zero)
        __atomic_compare_exchange_n(&scheduler.zero_state, &requested, ZERO_SENT, 0, __ATOMIC_RELEASE,
                                    __ATOMIC_RELAXED);
    return HD_CALLBACK_CONTINUE;
}

static void set_scheduler_state(int state)
{
    __atomic_store_n(&scheduler.state, state, __ATOMIC_RELEASE);
}

static int scheduler_state(void)
{
    return __atomic_load_n(&scheduler.state, __ATOMIC_ACQUIRE);
}

static void stop_scheduler(int state)
{
    const int state_before = scheduler_state();
    set_scheduler_state(state);
    if (state_before != RUNNING)
        return;
    scheduler.hd->hdStopScheduler();
    scheduler.hd->hdUnschedule(scheduler.callback);
}

/* Send zero to all devices: it is not documented whether a device without frames keeps its force. */
static int send_zero_to_all(void)
{
    __atomic_store_n(&scheduler.zero_state, ZERO_REQUESTED, __ATOMIC_RELAXED);
    for (int i = 0; i < LEAVE_MS; i++) {
        if (__atomic_load_n(&scheduler.zero_state, __ATOMIC_ACQUIRE) == ZERO_SENT || scheduler_is_dead())
            return 1;
        servo_wait();
    }
    __atomic_store_n(&scheduler.zero_state, FORCES_ON, __ATOMIC_RELAXED);
    return 0;
}

int scheduler_pause(const struct hd_library *hd)
{
    if (!scheduler.hd)
        scheduler.hd = hd;
    if (scheduler_state() == RUNNING && !send_zero_to_all())
        return 0;
    stop_scheduler(PAUSED);
    __atomic_store_n(&scheduler.zero_state, FORCES_ON, __ATOMIC_RELAXED);
    return 1;
}

static int add_servo(struct servo *servo)
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
        count += servo_at(i) ? 1 : 0;
    return count;
}

static void remove_servo(const struct servo *servo)
{
    for (int i = 0; i < SERVOS_MAX; i++)
        if (servo && servo_at(i) == servo)
            set_servo(i, NULL);
}

/* Start the scheduler. It has started when the servo thread claims the errors. */
static hd_error start_scheduler(const struct hd_library *hd)
{
    hd_error failure = { .code = HD_SUCCESS };
    hd->hdStartScheduler();
    for (int i = 0; i < START_MS; i++) {
        if (__atomic_load_n(&scheduler.error_reader, __ATOMIC_RELAXED) == SERVO)
            return failure;
        servo_wait();
    }
    if (!claim_errors(HOST))
        return failure;
    failure = hd_take_error(hd);
    if (dpt_hd_is_force_error(failure.code))
        failure.code = HD_SUCCESS;
    if (failure.code == HD_SUCCESS)
        __atomic_store_n(&scheduler.error_reader, NOBODY, __ATOMIC_RELEASE);
    return failure;
}

hd_error scheduler_resume(struct servo *servo)
{
    const struct hd_library *hd = scheduler.hd;
    hd_error failure = { .code = HD_SCHEDULER_FULL };
    if (servo && !add_servo(servo)) {
        scheduler_resume(NULL);
        return failure;
    }
    failure.code = HD_SUCCESS;
    if (scheduler_devices() == 0) {
        set_scheduler_state(STOPPED);
        return failure;
    }
    hd_take_error(hd);
    __atomic_store_n(&scheduler.error_reader, NOBODY, __ATOMIC_RELAXED);
    __atomic_store_n(&scheduler.callback, hd->hdScheduleAsynchronous(serve, NULL, HD_MAX_SCHEDULER_PRIORITY),
                     __ATOMIC_RELAXED);
    failure = hd_take_error(hd);
    if (failure.code == HD_SUCCESS) {
        failure = start_scheduler(hd);
        __atomic_store_n(&scheduler.since_ns, clock_now(), __ATOMIC_RELAXED);
        set_scheduler_state(RUNNING);
    }
    if (failure.code == HD_SUCCESS)
        return failure;
    remove_servo(servo);
    stop_scheduler(STOPPED);
    return failure;
}

int scheduler_leave(struct servo *servo)
{
    int at = 0;
    while (at < SERVOS_MAX && servo_at(at) != servo)
        at++;
    if (at == SERVOS_MAX)
        return 1;
    __atomic_store_n(&servo->must_leave, 1, __ATOMIC_RELAXED);
    for (int i = 0; i < LEAVE_MS && servo_at(at) == servo; i++) {
        if (scheduler_state() != RUNNING || scheduler_is_dead())
            set_servo(at, NULL);
        else
            servo_wait();
    }
    return servo_at(at) != servo;
}

int scheduler_is_paused(void)
{
    return scheduler_state() == PAUSED;
}

int scheduler_is_dead(void)
{
    const uint64_t since = scheduler_since();
    if (scheduler_state() != RUNNING)
        return scheduler_state() == STOPPED;
    const unsigned long callback = __atomic_load_n(&scheduler.callback, __ATOMIC_RELAXED);
    /* It is not dead if it was paused and resumed meanwhile. */
    return !scheduler.hd->hdWaitForCompletion(callback, HD_WAIT_CHECK_STATUS) && scheduler_state() == RUNNING &&
           scheduler_since() == since;
}

uint64_t scheduler_since(void)
{
    return __atomic_load_n(&scheduler.since_ns, __ATOMIC_RELAXED);
}
