/* SPDX-License-Identifier: BSD-3-Clause */
/* Arms of ODrive motor controllers on a CAN bus: "can:can0?arm=arm.dpa&nodes=0,1,2&gear=8,-8,10&watchdog=0.05". */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "can/can_session.h"
#include "clock.h"
#include "dynpoint/driver.h"
#include "settings.h"

#define MS         1000000u
#define STOP_EVERY (10u * MS)
#define END_IN     (400u * MS)
#define RAMP       (50u * MS) /* until the whole weight is held */
#define IDLE_FEED  (10u * MS) /* while no force is written */
#define HOST_HANGS (20u * MS)

struct can_device {
    dpt_device base;
    struct can_session host;
    dpt_device_state last;
    double joints[DPT_JOINTS_MAX];
    uint64_t sequence_read;
    uint8_t is_driving;  /* the host writes; otherwise zero is sent to feed watchdogs */
    uint64_t driving_ns; /* since when, and the last write */
    uint64_t written_ns;
    uint64_t fed_ns;
    uint64_t stopped_ns; /* last; 0: not yet */
};

/* Joints and pose of the newest sample. */
static void look(struct can_device *device)
{
    struct can_session *session = &device->host;
    double speeds[DPT_JOINTS_MAX];
    can_arm_joints(&session->arm, session->monitor.position, session->monitor.velocity,
                   device->joints, speeds);
    if (can_arm_pose(&session->arm, device->joints, speeds, &device->last) != DPT_OK)
        can_monitor_set_status(&session->monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_UNCALIBRATED,
                               0);
}

/* Connected, or switched on again: what came meanwhile is one sample, that has not been read. */
static void begin(struct can_device *device)
{
    device->is_driving = 0;
    device->stopped_ns = 0;
    device->sequence_read = device->host.monitor.sequence - 1;
    look(device);
}

static dpt_result can_open(const dpt_driver *driver, const char *where, dpt_device **opened,
                           dpt_device_error *error)
{
    (void)driver;
    struct can_device *device = calloc(1, sizeof *device);
    if (!device)
        return device_error(error, DPT_E_MEMORY, "no memory");
    device->host.socketcan.fd = -1;
    dpt_result result = can_settings_read(where, &device->host.settings, error);
    if (result == DPT_OK && !device->host.settings.interface[0])
        result =
            device_error(error, DPT_E_SETTING,
                         "which interface? As in can:can0?arm=arm.dpa&gear=8,-8,10&watchdog=0.05");
    if (result == DPT_OK)
        result = can_arm_open(&device->host.arm, &device->host.settings, error);
    if (result == DPT_OK) {
        can_monitor_init(&device->host.monitor, &device->host.arm, &device->host.settings);
        result = can_session_connect(&device->host, error);
    }
    if (result == DPT_OK) {
        device->host.monitor.sequence = device->host.monitor.counts.samples = 1;
        begin(device);
        *opened = &device->base;
        if (device->host.settings.gives_force)
            return DPT_OK;
        return device_error(error, DPT_OK,
                            "it gives no force: without a watchdog its motors keep their last "
                            "torque when the host dies. Say ?watchdog=0.05, the time that is "
                            "configured at the controllers, or at your own risk ?watchdog=none");
    }
    socketcan_close(&device->host.socketcan);
    can_arm_close(&device->host.arm);
    free(device);
    return result;
}

static void can_info(const dpt_device *base, dpt_device_info *info)
{
    const struct can_device *device = (const struct can_device *)base;
    const struct can_node *first = &device->host.monitor.at[0];
    info->pose_dofs = 6;
    info->joints = device->host.arm.joints;
    info->flags = DPT_DEVICE_FLAG_ARM;
    info->rate = device->host.settings.rate;
    if (device->host.settings.gives_force) {
        info->wrench_dofs = device->host.arm.wrench_dofs;
        info->force_max = device->host.arm.force_max;
        info->torque_max = device->host.arm.torque_max;
    }
    info->watchdog = device->host.settings.watchdog;
    memcpy(info->workspace_min, device->host.arm.workspace_min, sizeof info->workspace_min);
    memcpy(info->workspace_max, device->host.arm.workspace_max, sizeof info->workspace_max);
    snprintf(info->name, sizeof info->name, "arm of ODrives, firmware 0.%u", first->generation);
    if (first->serial)
        snprintf(info->serial, sizeof info->serial, "%012llX", (unsigned long long)first->serial);
    dynamics_override(&device->host.settings.dynamics, info);
}

/* Once more while an axis may still give force: of a line that is bad some frames get through. */
static void stop_all(struct can_device *device, uint64_t now)
{
    uint32_t active = 0;
    for (uint32_t i = 0; i < device->host.monitor.count; i++)
        active += device->host.monitor.at[i].beat.state == ODRIVE_STATE_CLOSED_LOOP;
    device->is_driving = 0;
    if (device->stopped_ns && (now - device->stopped_ns < STOP_EVERY || !active))
        return;
    device->stopped_ns = now;
    can_session_put_all(&device->host, can_no_torque);
    can_session_put_all(&device->host, device->host.monitor.status == DPT_DEVICE_STATUS_LOST
                                           ? can_estop
                                           : can_idle);
}

/* While no host writes: zero torque, as watchdogs want to be fed. */
static void keep_alive(struct can_device *device, uint64_t now)
{
    const uint64_t period = device->host.monitor.period_ns;
    uint64_t feed = IDLE_FEED;
    if (device->host.settings.watchdog > 0.0 &&
        0.25e9 * device->host.settings.watchdog < (double)feed)
        feed = (uint64_t)(0.25e9 * device->host.settings.watchdog);
    if (device->is_driving && now - device->written_ns > HOST_HANGS + 5 * period)
        device->is_driving = 0;
    if (!device->is_driving && now - device->fed_ns >= feed) {
        device->fed_ns = now;
        can_session_put_all(&device->host, can_no_torque);
    }
}

/* Of a device that has stopped, too: poses go on, and silence would be another fault. */
static void ask_places(struct can_device *device, uint64_t now)
{
    const uint64_t period = device->host.monitor.period_ns;
    if (device->host.settings.request == 0.0 || now - device->host.asked_ns < period - period / 8)
        return;
    device->host.asked_ns = now;
    can_session_put_all(&device->host, can_where);
}

/* Of which part 0.5 says only that it has errors: it is asked for them. */
static void ask_parts(struct can_device *device)
{
    static const uint8_t parts[] = { ODRIVE_ERROR, ODRIVE_ENCODER_ERROR, ODRIVE_CONTROLLER_ERROR };
    for (uint32_t i = 0; i < device->host.monitor.count; i++)
        for (int k = 0; k < 3 && device->host.monitor.parts >> i & 1; k++) {
            const struct odrive_message part = { .command = parts[k], .asks = 1 };
            if (device->host.monitor.at[i].beat.failed >> k & 1)
                can_session_put(&device->host, i, part);
        }
    device->host.monitor.parts = 0;
}

static dpt_result can_read(dpt_device *base, dpt_device_state *state)
{
    struct can_device *device = (struct can_device *)base;
    struct can_monitor *monitor = &device->host.monitor;
    const int is_all = can_session_receive(&device->host);
    const uint64_t now = clock_now();
    can_monitor_check(monitor, now, is_all);
    const uint64_t fresh = monitor->sequence - device->sequence_read;
    if (fresh)
        look(device);
    if (monitor->status != DPT_DEVICE_STATUS_READY)
        stop_all(device, now);
    else
        keep_alive(device, now);
    ask_places(device, now);
    if (monitor->parts)
        ask_parts(device);
    can_session_send(&device->host);
    device->sequence_read = monitor->sequence;
    device->last.fresh = fresh < UINT32_MAX ? (uint32_t)fresh : UINT32_MAX;
    device->last.sequence = monitor->sequence;
    device->last.time_ns = monitor->sample_ns;
    device->last.temperature = -1.0;
    device->last.status = monitor->status;
    device->last.reasons = monitor->reasons;
    device->last.code = monitor->code;
    *state = device->last;
    if (monitor->status != DPT_DEVICE_STATUS_LOST)
        return DPT_OK;
    state->fresh = 0;
    return DPT_E_LOST;
}

static dpt_result can_write(dpt_device *base, const dpt_wrench *wrench)
{
    static const dpt_wrench no_force;
    struct can_device *device = (struct can_device *)base;
    struct can_monitor *monitor = &device->host.monitor;
    float torques[DPT_JOINTS_MAX];
    if (monitor->status != DPT_DEVICE_STATUS_READY)
        return monitor->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_NOT_READY;
    const uint64_t now = clock_now();
    if (!device->is_driving) {
        device->is_driving = 1;
        device->driving_ns = now;
    }
    device->written_ns = now;
    const double held = (double)(now - device->driving_ns) / RAMP;
    double share = held < 1.0 ? held : 1.0;
    if (!device->host.settings.gives_force) {
        wrench = &no_force;
        share = 0.0;
    }
    const dpt_result result =
        can_arm_torques(&device->host.arm, device->joints, wrench, share, torques);
    if (result != DPT_OK)
        return result;
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct odrive_message command = { .command = ODRIVE_SET_TORQUE,
                                                .as.torque = torques[i] };
        can_session_put(&device->host, i, command);
    }
    monitor->counts.commands++;
    if (can_session_send(&device->host))
        return DPT_OK;
    monitor->counts.refused++;
    can_session_check_line(&device->host);
    return monitor->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_BUSY;
}

static dpt_result can_clear(dpt_device *base)
{
    struct can_device *device = (struct can_device *)base;
    struct can_monitor *monitor = &device->host.monitor;
    can_session_receive(&device->host);
    if (monitor->status == DPT_DEVICE_STATUS_READY)
        return DPT_OK;
    socketcan_query(&device->host.socketcan);
    if (monitor->status == DPT_DEVICE_STATUS_LOST) {
        socketcan_close(&device->host.socketcan);
        device->host.is_ours = 1;
        if (can_session_connect(&device->host, NULL) != DPT_OK)
            return DPT_E_LOST;
        monitor->counts.resets++;
    } else if (device->host.socketcan.is_passive ||
               can_session_switch_on(&device->host, NULL) != DPT_OK ||
               can_session_first_sample(&device->host, NULL) != DPT_OK) {
        return DPT_E_NOT_READY;
    }
    begin(device);
    return DPT_OK;
}

static void can_counts(const dpt_device *base, dpt_device_counts *counts)
{
    *counts = ((const struct can_device *)base)->host.monitor.counts;
}

static void can_close(dpt_device *base)
{
    struct can_device *device = (struct can_device *)base;
    const uint64_t deadline = clock_now() + END_IN;
    uint32_t active = device->host.monitor.count;
    device->host.monitor.is_armed = 0;
    while (active && device->host.socketcan.fd >= 0 && !can_session_is_dead(&device->host) &&
           clock_now() < deadline) {
        can_session_put_all(&device->host, can_no_torque);
        can_session_put_all(&device->host, can_idle);
        can_session_send(&device->host);
        can_session_wait(&device->host, clock_now() + STOP_EVERY);
        active = 0;
        for (uint32_t i = 0; i < device->host.monitor.count; i++)
            active += device->host.monitor.at[i].beat.state == ODRIVE_STATE_CLOSED_LOOP;
    }
    socketcan_close(&device->host.socketcan);
    can_arm_close(&device->host.arm);
    free(device);
}

struct can_finder {
    const dpt_driver *driver;
    dpt_device_found_fn *found;
    void *user;
};

static void pass_on(void *user, const char *name, const char *about)
{
    const struct can_finder *finding = user;
    finding->found(finding->user, finding->driver, name, about);
}

static void can_find(const dpt_driver *driver, dpt_device_found_fn *found, void *user)
{
    struct can_finder finding = { driver, found, user };
    socketcan_find(pass_on, &finding);
}

const dpt_driver can_driver = {
    .size = sizeof can_driver,
    .version = DPT_DRIVER_VERSION,
    .name = "can",
    .about = "arms of ODrive motor controllers on a CAN bus: "
             "can:can0?arm=arm.dpa&gear=8,-8,10&watchdog=0.05",
    .open = can_open,
    .info = can_info,
    .read = can_read,
    .write = can_write,
    .clear = can_clear,
    .counts = can_counts,
    .close = can_close,
    .find = can_find,
};
