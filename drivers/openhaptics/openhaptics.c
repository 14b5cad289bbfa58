/* SPDX-License-Identifier: BSD-3-Clause */
/* The driver "openhaptics": Touch and Phantom devices, "openhaptics:Left Device?rate=1000" (docs/back_ends.md). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/return_if_error.h"
#include "base/wrench_limit.h"
#include "dynpoint/driver.h"
#include "dynpoint/openhaptics.h"
#include "openhaptics/openhaptics_servo.h"
#include "platform/clock.h"
#include "platform/thread.h"
#include "settings.h"

typedef char joints_fit[(int)SERVO_JOINTS <= DPT_JOINTS_MAX ? 1 : -1];

enum { ANSWER_MS = 1000, CALIBRATED_MS = 300, PORTS = 16 };

static const double RAMP = 0.1; /* s, from no force to all of it */
static const uint64_t SECOND = 1000000000u;

struct haptics {
    dpt_device base;
    struct servo servo;
    struct servo_sample last; /* the newest sample that was read */
    char name[64], library[256];
    double rate, watchdog, silent_after; /* rate in Hz, 0: the device's own; times in s */
    struct dynamics dynamics;
    int is_open; /* hdInitDevice succeeded */
    uint64_t sequence_read;
    uint32_t lost_reasons; /* DPT_REASON_..., from the first read that finds it lost until clear */
    dpt_device_info info;
    dpt_device_counts counts;
    struct haptics *next; /* in `abandoned` */
};

/* A process has one library, and the library one scheduler and one stack of errors. */
static pthread_mutex_t library_mutex = PTHREAD_MUTEX_INITIALIZER;
static double common_rate;        /* of the scheduler while devices are open, Hz */
static double requested_rate;     /* the last rate that was set; the library keeps it */
static struct haptics *abandoned; /* closed while the servo thread hung */

static int has_no_error(const struct hd_library *hd)
{
    return hd_take_error(hd).code == HD_SUCCESS;
}

/* 1 if there is a port of a vendor's device that this user may not open; its path is in `path`. */
static int is_forbidden(char path[32])
{
    static const char *const classes[] = { "tty/ttyACM", "hidraw/hidraw" };
    for (int i = 0; i < 2 * PORTS; i++) {
        char about[64], text[512];
        snprintf(about, sizeof about, "/sys/class/%s%d/device/uevent", classes[i % 2], i / 2);
        snprintf(path, 32, "/dev/%s%d", strchr(classes[i % 2], '/') + 1, i / 2);
        FILE *file = fopen(about, "r");
        if (!file)
            continue;
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        fclose(file);
        if ((strstr(text, "PRODUCT=2988/") || strstr(text, ":00002988:")) && access(path, R_OK | W_OK) != 0)
            return 1;
    }
    return 0;
}

static dpt_result explain_no_answer(const struct haptics *device, dpt_device_error *error)
{
    char path[32];
    if (is_forbidden(path))
        return device_error(error, DPT_E_PERMISSION,
                            "this user may not use %s: sudo usermod -aG dialout,plugdev $USER and "
                            "log in again; for a hidraw port see docs/back_ends.md",
                            path);
    if (device->name[0])
        return device_error(error, DPT_E_DEVICE,
                            "no device of the name '%.40s' answers: is it the name in the vendor's "
                            "Touch_Setup? Its driver of 2022 knows no names: try openhaptics alone",
                            device->name);
    return device_error(error, DPT_E_DEVICE,
                        "no device answers: has it power and cable, does the vendor's "
                        "Touch_Diagnostic see it, may this user open its port?%s",
                        getenv("GTDD_HOME") ? ""
                                            : " GTDD_HOME is not set: log in again after the driver was installed");
}

static dpt_result explain_failure(const struct haptics *device, hd_error failure, dpt_device_error *error)
{
    switch (failure.code) {
    case HD_DEVICE_FAULT:
        return explain_no_answer(device, error);
    case HD_DEVICE_ALREADY_INITIATED:
        return device_error(error, DPT_E_DEVICE,
                            "the device is open already: close it there, or name another one as in openhaptics:NAME");
    case HD_COMM_ERROR:
    case HD_COMM_CONFIG_ERROR:
        return device_error(error, DPT_E_DEVICE,
                            "the line to the device fails (0x%x, %d): try another port and cable, "
                            "no hub; pair one at Ethernet again in Touch_Setup",
                            failure.code, failure.internal);
    case HD_TIMER_ERROR:
    case HD_INVALID_PRIORITY:
    case HD_SCHEDULER_FULL:
        return device_error(error, DPT_E_DEVICE,
                            "the scheduler of OpenHaptics has no room or does not start (0x%x, "
                            "%d): close other devices and programs that use it",
                            failure.code, failure.internal);
    case HD_INVALID_LICENSE:
        return device_error(error, DPT_E_UNSUPPORTED,
                            "OpenHaptics finds no valid licence: install its developer edition "
                            "anew, or the licence that the vendor gave for this machine");
    default:
        return device_error(error, DPT_E_DEVICE, "OpenHaptics says %.80s (0x%x, %d)",
                            device->servo.hd->hdGetErrorString(failure.code), failure.code, failure.internal);
    }
}

static int read_number(const struct hd_library *hd, unsigned what, double *value)
{
    double number = 0.0;
    hd->hdGetDoublev(what, &number);
    if (!has_no_error(hd) || !(number >= 0.0 && number <= 1e6))
        return 0;
    *value = number;
    return 1;
}

static int read_count(const struct hd_library *hd, unsigned what, int *value)
{
    int number = 0;
    hd->hdGetIntegerv(what, &number);
    if (!has_no_error(hd))
        return 0;
    *value = number;
    return 1;
}

static void read_text(const struct hd_library *hd, unsigned what, char out[48])
{
    const char *text = hd->hdGetString(what);
    if (!has_no_error(hd) || !text)
        return;
    for (int i = 0; i < 47 && text[i]; i++)
        out[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
}

static int read_workspace(const struct hd_library *hd, unsigned what, double box[6])
{
    for (int i = 0; i < 6; i++)
        box[i] = 0.0;
    hd->hdGetDoublev(what, box);
    int is_box = has_no_error(hd);
    for (int i = 0; i < 3; i++)
        is_box &= box[i] < box[3 + i] && within(box[i], 1e5) && within(box[3 + i], 1e5);
    return is_box;
}

/* The calibration styles that the device has, HD_CALIBRATION_... bits. */
static unsigned read_styles(const struct hd_library *hd)
{
    int known = 0;
    if (read_count(hd, HD_CALIBRATION_STYLE, &known) || !hd->hdCheckCalibrationStyle)
        return (unsigned)known;
    const unsigned styles = hd->hdCheckCalibrationStyle();
    return has_no_error(hd) ? styles : 0;
}

static unsigned best_style(unsigned styles)
{
    return styles & HD_CALIBRATION_AUTO      ? HD_CALIBRATION_AUTO
           : styles & HD_CALIBRATION_INKWELL ? HD_CALIBRATION_INKWELL
                                             : styles & HD_CALIBRATION_ENCODER_RESET;
}

/* Read the device's info. Degrees of freedom, force limit and workspace are required; other missing values are 0. */
static dpt_result read_info(struct haptics *device, dpt_device_error *error)
{
    struct servo *servo = &device->servo;
    const struct hd_library *hd = servo->hd;
    dpt_device_info *info = &device->info;
    int inputs = 0, outputs = 0, rate = 0;
    double stiffness = 0.0, torque = 0.0, box[6];
    const int is_known = read_count(hd, HD_INPUT_DOF, &inputs) && read_count(hd, HD_OUTPUT_DOF, &outputs) &&
                         read_number(hd, HD_NOMINAL_MAX_FORCE, &info->force_max) &&
                         (read_workspace(hd, HD_USABLE_WORKSPACE_DIMENSIONS, box) ||
                          read_workspace(hd, HD_MAX_WORKSPACE_DIMENSIONS, box));
    if (!is_known || inputs < 3 || info->force_max <= 0.0)
        return device_error(error, DPT_E_DEVICE,
                            "the device does not say what it can do: OpenHaptics and the device "
                            "driver must be of one version, and Touch_Diagnostic see it");
    read_number(hd, HD_NOMINAL_MAX_CONTINUOUS_FORCE, &info->force_continuous);
    read_number(hd, HD_NOMINAL_MAX_STIFFNESS, &stiffness);
    if (outputs >= 6)
        read_number(hd, HD_NOMINAL_MAX_TORQUE_FORCE, &torque);
    read_text(hd, HD_DEVICE_MODEL_TYPE, info->name);
    read_text(hd, HD_DEVICE_SERIAL_NUMBER, info->serial);
    const unsigned styles = read_styles(hd);
    servo->has_inkwell = (styles & HD_CALIBRATION_INKWELL) != 0;
    servo->temperature_count = outputs < 3 ? 3 : outputs < SERVO_MOTORS ? outputs : SERVO_MOTORS;
    servo->style = best_style(styles);
    servo->input_dofs = inputs >= 6 ? 6 : 3;
    servo->output_dofs = torque > 0.0 ? 6 : outputs >= 3 ? 3 : 0;

    read_count(hd, HD_UPDATE_RATE, &rate);
    info->rate = rate >= 100 && rate <= 100000 ? rate : 1000;
    if (!info->name[0])
        snprintf(info->name, sizeof info->name, "OpenHaptics device");
    info->pose_dofs = (uint32_t)servo->input_dofs;
    info->wrench_dofs = (uint32_t)servo->output_dofs;
    info->torque_max = torque / 1000.0;
    info->stiffness_max = stiffness * 1000.0;
    info->watchdog = device->watchdog;
    for (int k = 0; k < 3; k++) {
        servo->centre_mm[k] = 0.5 * (box[k] + box[3 + k]);
        info->workspace_min[k] = (box[k] - servo->centre_mm[k]) / 1000.0;
        info->workspace_max[k] = (box[3 + k] - servo->centre_mm[k]) / 1000.0;
    }
    return DPT_OK;
}

/* Calibrate a device that a person must hold in its reset position now. */
static dpt_result calibrate(const struct haptics *device, dpt_device_error *error)
{
    const struct hd_library *hd = device->servo.hd;
    if (device->servo.style != HD_CALIBRATION_ENCODER_RESET || hd->hdCheckCalibration() == HD_CALIBRATION_OK)
        return DPT_OK;
    hd->hdUpdateCalibration(HD_CALIBRATION_ENCODER_RESET);
    const unsigned status = hd->hdCheckCalibration();
    if (has_no_error(hd) && status == HD_CALIBRATION_OK)
        return DPT_OK;
    return device_error(error, DPT_E_NOT_READY,
                        "not calibrated: hold the device in its reset position (its manual shows "
                        "it; most often all links at right angles) and open it again");
}

static dpt_result set_rate(struct haptics *device, dpt_device_error *error)
{
    const struct hd_library *hd = device->servo.hd;
    if (scheduler_devices() > 0 && device->rate != 0.0 && device->rate != common_rate)
        return device_error(error, DPT_E_SETTING,
                            "all devices share one scheduler, which runs at %g Hz: leave rate= "
                            "out, or close the others first",
                            common_rate);
    if (scheduler_devices() == 0) {
        common_rate = device->rate != 0.0 ? device->rate : requested_rate != 0.0 ? requested_rate : device->info.rate;
        if (device->rate != 0.0)
            hd->hdSetSchedulerRate((unsigned long)device->rate);
        if (!has_no_error(hd))
            return device_error(error, DPT_E_SETTING,
                                "OpenHaptics refuses %g Hz: 500, 1000 or 2000 is usual, at "
                                "FireWire 8000 / N; without rate= it takes its own",
                                device->rate);
        requested_rate = device->rate != 0.0 ? device->rate : requested_rate;
    }
    device->info.rate = common_rate;
    device->servo.ramp_ticks = (uint32_t)(RAMP * common_rate + 0.5);
    return DPT_OK;
}

/* Open the device in the library. The scheduler must be stopped. */
static dpt_result init_device(struct haptics *device, dpt_device_error *error)
{
    const struct hd_library *hd = device->servo.hd;
    device->servo.device = hd->hdInitDevice(device->name[0] ? device->name : NULL);
    const hd_error failure = hd_take_error(hd);
    if (failure.code != HD_SUCCESS)
        return explain_failure(device, failure, error);
    if (device->servo.device > HD_HANDLE_MAX)
        return device_error(error, DPT_E_DEVICE,
                            "OpenHaptics gave 0x%x, which is no device, as it does after an open "
                            "that failed: end this program and start it again",
                            device->servo.device);
    device->is_open = 1;
    hd->hdMakeCurrentDevice(device->servo.device);
    hd->hdEnable(HD_FORCE_OUTPUT);
    hd->hdEnable(HD_MAX_FORCE_CLAMPING);
    hd->hdEnable(HD_FORCE_RAMPING);
    hd_take_error(hd);
    DPT_TRY(read_info(device, error));
    DPT_TRY(set_rate(device, error));
    return calibrate(device, error);
}

static void read_latest_sample(struct haptics *device)
{
    if (latest_value_take(&device->servo.samples))
        device->last = device->servo.sample[device->servo.samples.reading];
}

/* Wait for the first sample, and up to CALIBRATED_MS for a calibration that needs no person. */
static dpt_result wait_for_sample(struct haptics *device, dpt_device_error *error)
{
    const uint64_t sequence_before = device->last.sequence;
    for (int i = 0; i < ANSWER_MS && device->last.status != DPT_DEVICE_STATUS_LOST; i++) {
        read_latest_sample(device);
        if (device->last.sequence != sequence_before &&
            (i >= CALIBRATED_MS || !(device->last.reasons & DPT_REASON_UNCALIBRATED)))
            return DPT_OK;
        servo_wait();
    }
    const hd_error failure = { .code = device->last.code };
    if (device->last.status == DPT_DEVICE_STATUS_LOST)
        return explain_failure(device, failure, error);
    return device_error(error, DPT_E_DEVICE,
                        "the device is open, but no sample comes within %g s: does another program use it?",
                        ANSWER_MS * 1e-3);
}

/* Returns 0 if the servo thread hangs and may still use the device. */
static int disconnect(struct haptics *device)
{
    if (!scheduler_leave(&device->servo))
        return 0;
    if (device->is_open) {
        if (!scheduler_pause(device->servo.hd))
            return 0;
        device->servo.hd->hdDisableDevice(device->servo.device);
        scheduler_resume(NULL);
        device->is_open = 0;
    }
    return 1;
}

/* Disconnect and free the device, or abandon it as long as the servo thread may use it. */
static void release_device(struct haptics *device)
{
    if (disconnect(device)) {
        free(device);
        return;
    }
    device->next = abandoned;
    abandoned = device;
}

/* Try again to free the abandoned devices. */
static void release_abandoned(void)
{
    struct haptics *device = abandoned, *next;
    abandoned = NULL;
    for (; device; device = next) {
        next = device->next;
        release_device(device);
    }
}

static dpt_result connect_device(struct haptics *device, dpt_device_error *error)
{
    struct servo_sample *last = &device->last;
    const struct hd_library *hd = device->servo.hd;
    const struct servo fresh = { .hd = hd,
                                 .watchdog_ns = (uint64_t)(device->watchdog * 1e9),
                                 .last.sequence = last->sequence,
                                 .last.missed = last->missed };
    device->servo = fresh;
    memset(&device->info, 0, sizeof device->info);
    last->status = DPT_DEVICE_STATUS_UNREADY;
    last->code = 0;
    if (!scheduler_pause(hd))
        return device_error(error, DPT_E_DEVICE,
                            "the thread of OpenHaptics that serves all its devices hangs: end this "
                            "program and start it again");
    hd_take_error(hd);
    const dpt_result result = init_device(device, error);
    const hd_error failure = scheduler_resume(result == DPT_OK ? &device->servo : NULL);
    DPT_TRY(result);
    if (failure.code != HD_SUCCESS)
        DPT_TRY(explain_failure(device, failure, error));
    DPT_TRY(wait_for_sample(device, error));
    device->info.joints = (uint32_t)device->servo.joints;
    device->info.buttons = (uint32_t)device->servo.buttons;
    device->lost_reasons = 0;
    return DPT_OK;
}

/* Tell the user what must still be done before there is force. */
static void advise(const struct haptics *device, dpt_device_error *error)
{
    const uint32_t reasons = device->last.reasons;
    if (reasons & DPT_REASON_UNCALIBRATED && device->servo.style == HD_CALIBRATION_INKWELL)
        device_error(error, DPT_OK,
                     "not calibrated, no force yet: put the stylus into the inkwell for a moment, then take it out");
    else if (reasons & DPT_REASON_UNCALIBRATED)
        device_error(error, DPT_OK,
                     "not calibrated, no force yet: move it slowly through its workspace, or run "
                     "the vendor's Touch_Diagnostic");
    else if (reasons & DPT_REASON_DOCKED)
        device_error(error, DPT_OK, "the stylus is in the inkwell, no force there: take it out and hold it");
    else if (device->last.status == DPT_DEVICE_STATUS_FAULT)
        device_error(error, DPT_OK, "the device has a fault, no force (0x%x): let it rest, and open it again",
                     device->last.code);
}

static dpt_result openhaptics_open(const dpt_driver *driver, const char *where, dpt_device **opened,
                                   dpt_device_error *error)
{
    (void)driver;
    struct haptics *device = calloc(1, sizeof *device);
    if (!device)
        return device_error(error, DPT_E_MEMORY, "no memory");
    device->watchdog = 0.01;
    device->silent_after = 0.1;
    const struct setting settings[] = {
        { .name = "library", .text = device->library, .text_bytes = sizeof device->library },
        { .name = "rate", .number = &device->rate, .min = 100, .max = 1e5 },
        { .name = "watchdog", .number = &device->watchdog, .min = 0.002, .max = 1 },
        { .name = "silent", .number = &device->silent_after, .min = 0.01, .max = 60 },
    };
    pthread_mutex_lock(&library_mutex);
    release_abandoned();
    dpt_result result = settings_read(where, device->name, sizeof device->name, settings,
                                      sizeof settings / sizeof *settings, &device->dynamics, error);
    if (result == DPT_OK)
        result = hd_library_load(device->library, &device->servo.hd, error);
    if (result == DPT_OK)
        result = connect_device(device, error);
    if (result != DPT_OK)
        release_device(device);
    pthread_mutex_unlock(&library_mutex);
    if (result != DPT_OK)
        return result;
    advise(device, error);
    *opened = &device->base;
    return DPT_OK;
}

static void openhaptics_info(const dpt_device *base, dpt_device_info *info)
{
    *info = ((const struct haptics *)base)->info;
    dynamics_override(&((const struct haptics *)base)->dynamics, info);
}

/* Why the device is lost, or 0. It stays so when samples come again, because nothing is known of the time between. */
static uint32_t find_loss(struct haptics *device)
{
    if (device->lost_reasons || scheduler_is_paused())
        return device->lost_reasons;
    if (device->last.status == DPT_DEVICE_STATUS_LOST)
        return device->lost_reasons = device->last.reasons;
    const uint64_t since = scheduler_since(), sampled = device->last.time_ns;
    const int64_t age = (int64_t)(clock_now() - (sampled > since ? sampled : since));
    if (age > (int64_t)(device->silent_after * (double)SECOND) ||
        (age > (int64_t)device->servo.watchdog_ns && scheduler_is_dead()))
        device->lost_reasons = DPT_REASON_SILENT;
    return device->lost_reasons;
}

static dpt_result openhaptics_read(dpt_device *base, dpt_device_state *state)
{
    struct haptics *device = (struct haptics *)base;
    read_latest_sample(device);
    const struct servo_sample *last = &device->last;
    const uint64_t fresh = last->sequence - device->sequence_read;
    device->sequence_read = last->sequence;
    state->status = last->status;
    state->reasons = last->reasons;
    state->code = last->code;
    state->buttons = last->buttons;
    state->fresh = fresh < UINT32_MAX ? (uint32_t)fresh : UINT32_MAX;
    state->sequence = last->sequence;
    state->time_ns = last->time_ns;
    state->pose = last->pose;
    memcpy(state->velocity, last->velocity, sizeof state->velocity);
    memcpy(state->spin, last->spin, sizeof state->spin);
    memset(state->joint, 0, sizeof state->joint);
    memcpy(state->joint, last->joint, sizeof last->joint);
    state->temperature = last->temperature;
    const uint32_t reasons = find_loss(device);
    if (reasons == 0)
        return DPT_OK;
    state->status = DPT_DEVICE_STATUS_LOST;
    state->reasons = reasons;
    state->fresh = 0;
    return DPT_E_LOST;
}

static dpt_result openhaptics_write(dpt_device *base, const dpt_wrench *wrench)
{
    struct haptics *device = (struct haptics *)base;
    read_latest_sample(device);
    if (find_loss(device))
        return DPT_E_LOST;
    if (device->last.status != DPT_DEVICE_STATUS_READY)
        return DPT_E_NOT_READY;
    struct servo *servo = &device->servo;
    struct servo_command *command = &servo->command[servo->commands.writing];
    command->wrench = *wrench;
    limit_length(command->wrench.force, device->info.force_max);
    limit_length(command->wrench.torque, device->info.torque_max);
    command->time_ns = clock_now();
    latest_value_publish(&servo->commands);
    device->counts.commands++;
    return DPT_OK;
}

static dpt_result openhaptics_clear(dpt_device *base)
{
    struct haptics *device = (struct haptics *)base;
    struct servo *servo = &device->servo;
    const dpt_device_info info = device->info;
    dpt_result result = DPT_OK;
    read_latest_sample(device);
    pthread_mutex_lock(&library_mutex);
    if (find_loss(device)) {
        result = disconnect(device) ? connect_device(device, NULL) : DPT_E_LOST;
        if (result != DPT_OK) {
            disconnect(device);
            device->info = info;
            device->lost_reasons = device->lost_reasons ? device->lost_reasons : DPT_REASON_SILENT;
        }
        device->counts.resets += result == DPT_OK;
    } else {
        const uint32_t clear_requests = servo->clear_requests + 1;
        __atomic_store_n(&servo->clear_requests, clear_requests, __ATOMIC_RELAXED);
        for (int i = 0; i < ANSWER_MS && device->last.clear_requests != clear_requests; i++) {
            servo_wait();
            read_latest_sample(device);
        }
        if (device->last.clear_requests != clear_requests && !device->lost_reasons)
            device->lost_reasons = DPT_REASON_SILENT;
    }
    pthread_mutex_unlock(&library_mutex);
    if (result != DPT_OK || find_loss(device))
        return DPT_E_LOST;
    return device->last.status == DPT_DEVICE_STATUS_READY ? DPT_OK : DPT_E_NOT_READY;
}

static void openhaptics_counts(const dpt_device *base, dpt_device_counts *counts)
{
    const struct haptics *device = (const struct haptics *)base;
    *counts = device->counts;
    counts->samples = device->last.sequence;
    counts->missed = device->last.missed;
}

static void openhaptics_close(dpt_device *base)
{
    pthread_mutex_lock(&library_mutex);
    release_device((struct haptics *)base);
    pthread_mutex_unlock(&library_mutex);
}

const dpt_driver openhaptics_driver = {
    .size = sizeof openhaptics_driver,
    .version = DPT_DRIVER_VERSION,
    .name = "openhaptics",
    .about = "Touch and Phantom devices by the vendor's library, if there: openhaptics:NAME",
    .open = openhaptics_open,
    .info = openhaptics_info,
    .read = openhaptics_read,
    .write = openhaptics_write,
    .clear = openhaptics_clear,
    .counts = openhaptics_counts,
    .close = openhaptics_close,
};
