/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The driver "can": arms of motors on a CAN bus, "can:can0?arm=arm.dpa&nodes=0,1,2&gear=8,-8,10&watchdog=0.05" of ODrives,
 * "can:can0?arm=arm.dpa&drive=damiao" of others.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "can/can_session.h"
#include "dynpoint/driver.h"
#include "platform/clock.h"
#include "settings.h"

#define MS                1000000u
#define STOP_EVERY        (10u * MS)
#define CLOSE_WITHIN      (400u * MS)
#define RAMP              (50u * MS) /* until the whole weight is held */
#define FEED_EVERY_IDLE   (10u * MS) /* while no force is written */
#define HOST_SILENT_AFTER (20u * MS)

struct can_device {
    dpt_device base;
    struct can_session session;
    dpt_device_state last;
    double joint[DPT_JOINTS_MAX];
    uint64_t sequence_read;
    uint8_t is_driving;  /* 1: the host writes; 0: the driver sends zero torque to feed watchdogs */
    uint64_t driving_ns; /* since when, and the last write */
    uint64_t written_ns;
    uint64_t fed_ns;
    uint64_t stopped_ns; /* when stop_all sent last; 0: not yet */
};

/* Compute joints and pose from the newest sample. */
static void update_pose(struct can_device *device)
{
    struct can_session *session = &device->session;
    double speeds[DPT_JOINTS_MAX];
    can_arm_joints(&session->arm, session->monitor.position, session->monitor.velocity, device->joint, speeds);
    if (can_arm_pose(&session->arm, device->joint, speeds, &device->last) != DPT_OK)
        can_monitor_set_status(&session->monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_UNCALIBRATED, 0);
}

/* Call after connecting or switching on. All that came meanwhile counts as one sample, not yet read. */
static void restart_samples(struct can_device *device)
{
    device->is_driving = 0;
    device->stopped_ns = 0;
    device->sequence_read = device->session.monitor.sequence - 1;
    update_pose(device);
}

static dpt_result read_and_connect(struct can_session *session, const char *where, dpt_device_error *error)
{
    DPT_TRY(can_settings_read(where, &session->settings, error));
    if (!session->settings.interface[0])
        return device_error(error, DPT_E_SETTING,
                            "which interface? As in can:can0?arm=arm.dpa&gear=8,-8,10&watchdog=0.05");
    DPT_TRY(can_arm_open(&session->arm, &session->settings, error));
    can_monitor_init(&session->monitor, &session->arm, &session->settings);
    return can_session_connect(session, error);
}

static dpt_result can_open(const dpt_driver *driver, const char *where, dpt_device **opened, dpt_device_error *error)
{
    (void)driver;
    struct can_device *device = calloc(1, sizeof *device);
    if (!device)
        return device_error(error, DPT_E_MEMORY, "no memory");
    device->session.socketcan.fd = -1;
    const dpt_result result = read_and_connect(&device->session, where, error);
    if (result != DPT_OK) {
        socketcan_close(&device->session.socketcan);
        can_arm_close(&device->session.arm);
        free(device);
        return result;
    }
    device->session.monitor.sequence = device->session.monitor.counts.samples = 1;
    restart_samples(device);
    *opened = &device->base;
    if (device->session.settings.gives_force)
        return DPT_OK;
    return device_error(error, DPT_OK,
                        "it gives no force: without a watchdog its motors keep their last "
                        "torque when the host dies. Say ?watchdog=0.05, the time that is "
                        "configured at the controllers, or at your own risk ?watchdog=none");
}

static void describe_motors(const struct can_session *session, dpt_device_info *info)
{
    const struct can_drive *drive = session->arm.ends[0].drive;
    int is_mixed = 0;
    for (uint32_t i = 1; i < session->arm.joints; i++)
        is_mixed |= session->arm.ends[i].drive != drive;
    if (is_mixed)
        snprintf(info->name, sizeof info->name, "arm of motors of several makers");
    else if (drive == &odrive_drive)
        snprintf(info->name, sizeof info->name, "arm of ODrives, firmware 0.%u", session->monitor.nodes[0].generation);
    else
        snprintf(info->name, sizeof info->name, "arm of %s motors", drive->title);
}

static void can_info(const dpt_device *base, dpt_device_info *info)
{
    const struct can_device *device = (const struct can_device *)base;
    const struct can_node *first = &device->session.monitor.nodes[0];
    info->pose_dofs = 6;
    info->joints = device->session.arm.joints;
    info->flags = DPT_DEVICE_FLAG_ARM;
    info->rate = device->session.settings.rate;
    if (device->session.settings.gives_force) {
        info->wrench_dofs = device->session.arm.wrench_dofs;
        info->force_max = device->session.arm.force_max;
        info->torque_max = device->session.arm.torque_max;
    }
    info->watchdog = device->session.settings.watchdog;
    memcpy(info->workspace_min, device->session.arm.workspace_min, sizeof info->workspace_min);
    memcpy(info->workspace_max, device->session.arm.workspace_max, sizeof info->workspace_max);
    can_arm_steps(&device->session.arm, &info->position_step, &info->angle_step);
    describe_motors(&device->session, info);
    if (first->serial)
        snprintf(info->serial, sizeof info->serial, "%012llX", (unsigned long long)first->serial);
    dynamics_override(&device->session.settings.dynamics, info);
}

/*
 * Send zero torque and idle, again every STOP_EVERY while an axis is active: on a bad line only some frames get
 * through.
 */
static void stop_all(struct can_device *device, uint64_t now)
{
    uint32_t active = 0;
    for (uint32_t i = 0; i < device->session.monitor.count; i++)
        active += can_node_is_on(&device->session.monitor.nodes[i]) != 0;
    device->is_driving = 0;
    if (device->stopped_ns && (now - device->stopped_ns < STOP_EVERY || !active))
        return;
    device->stopped_ns = now;
    can_session_put_all(&device->session, can_no_torque);
    can_session_put_all(&device->session,
                        device->session.monitor.status == DPT_DEVICE_STATUS_LOST ? can_estop : can_idle);
}

/* Feed the controllers' watchdogs with zero torque while the host does not write. */
static void keep_alive(struct can_device *device, uint64_t now)
{
    const uint64_t period = device->session.monitor.period_ns;
    uint64_t feed = FEED_EVERY_IDLE;
    if (device->session.settings.watchdog > 0.0 && 0.25e9 * device->session.settings.watchdog < (double)feed)
        feed = (uint64_t)(0.25e9 * device->session.settings.watchdog);
    if (device->is_driving && now - device->written_ns > HOST_SILENT_AFTER + 5 * period)
        device->is_driving = 0;
    if (!device->is_driving && now - device->fed_ns >= feed) {
        device->fed_ns = now;
        can_session_put_reporters(&device->session, can_no_torque);
    }
}

/*
 * Request estimates, of a stopped device too: its pose stays current, and silence would be another fault. Motors that answer do so
 * to the host's torques, or to zero torque while the host does not write.
 */
static void request_estimates(struct can_device *device, uint64_t now)
{
    struct can_session *session = &device->session;
    const uint64_t period = session->monitor.period_ns;
    const int is_ready = session->monitor.status == DPT_DEVICE_STATUS_READY;
    if (now - session->requested_ns < period - period / 8)
        return;
    session->requested_ns = now;
    if (session->settings.request != 0.0)
        can_session_put_reporters(session, can_ask);
    for (uint32_t i = 0; i < session->monitor.count; i++)
        if (session->arm.ends[i].drive->answers && !(is_ready && device->is_driving))
            can_session_put(session, i, is_ready ? can_no_torque : can_ask);
}

/* A heartbeat of 0.5 says which parts have errors, but not which errors: request them. */
static void request_part_errors(struct can_device *device)
{
    static const uint8_t parts[] = { ODRIVE_ERROR, ODRIVE_ENCODER_ERROR, ODRIVE_CONTROLLER_ERROR };
    for (uint32_t i = 0; i < device->session.monitor.count; i++)
        for (int k = 0; k < 3 && device->session.monitor.failed_nodes >> i & 1; k++) {
            const struct odrive_message request = { .command = parts[k], .is_request = 1 };
            if (device->session.monitor.nodes[i].heartbeat.failed >> k & 1)
                can_session_put_odrive(&device->session, i, request);
        }
    device->session.monitor.failed_nodes = 0;
}

static dpt_result can_read(dpt_device *base, dpt_device_state *state)
{
    struct can_device *device = (struct can_device *)base;
    struct can_monitor *monitor = &device->session.monitor;
    const int is_drained = can_session_receive(&device->session);
    const uint64_t now = clock_now();
    can_monitor_check(monitor, now, is_drained);
    const uint64_t fresh = monitor->sequence - device->sequence_read;
    if (fresh)
        update_pose(device);
    if (monitor->status != DPT_DEVICE_STATUS_READY)
        stop_all(device, now);
    else
        keep_alive(device, now);
    request_estimates(device, now);
    if (monitor->failed_nodes)
        request_part_errors(device);
    can_session_send(&device->session);
    device->sequence_read = monitor->sequence;
    device->last.fresh = fresh < UINT32_MAX ? (uint32_t)fresh : UINT32_MAX;
    device->last.sequence = monitor->sequence;
    device->last.time_ns = monitor->sample_ns;
    device->last.temperature = can_monitor_temperature(monitor);
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
    struct can_monitor *monitor = &device->session.monitor;
    float torques[DPT_JOINTS_MAX];
    if (monitor->status != DPT_DEVICE_STATUS_READY)
        return monitor->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_NOT_READY;
    const uint64_t now = clock_now();
    if (!device->is_driving) {
        device->is_driving = 1;
        device->driving_ns = now;
    }
    device->written_ns = now;
    const double ramp = (double)(now - device->driving_ns) / RAMP;
    double weight_share = ramp < 1.0 ? ramp : 1.0;
    if (!device->session.settings.gives_force) {
        wrench = &no_force;
        weight_share = 0.0;
    }
    DPT_TRY(can_arm_torques(&device->session.arm, device->joint, wrench, weight_share, torques));
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct drive_message command = { .kind = DRIVE_TORQUE, .as.command.torque = torques[i] };
        can_session_put(&device->session, i, command);
    }
    monitor->counts.commands++;
    if (can_session_send(&device->session))
        return DPT_OK;
    monitor->counts.refused++;
    can_session_check_line(&device->session);
    return monitor->status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_BUSY;
}

static dpt_result can_clear(dpt_device *base)
{
    struct can_device *device = (struct can_device *)base;
    struct can_monitor *monitor = &device->session.monitor;
    can_session_receive(&device->session);
    if (monitor->status == DPT_DEVICE_STATUS_READY)
        return DPT_OK;
    socketcan_query(&device->session.socketcan);
    if (monitor->status == DPT_DEVICE_STATUS_LOST) {
        socketcan_close(&device->session.socketcan);
        device->session.was_connected = 1;
        if (can_session_connect(&device->session, NULL) != DPT_OK)
            return DPT_E_LOST;
        monitor->counts.resets++;
    } else if (device->session.socketcan.is_error_passive || can_session_switch_on(&device->session, NULL) != DPT_OK ||
               can_session_first_sample(&device->session, NULL) != DPT_OK) {
        return DPT_E_NOT_READY;
    }
    restart_samples(device);
    return DPT_OK;
}

static void can_counts(const dpt_device *base, dpt_device_counts *counts)
{
    *counts = ((const struct can_device *)base)->session.monitor.counts;
}

static void can_close(dpt_device *base)
{
    struct can_device *device = (struct can_device *)base;
    const uint64_t deadline = clock_now() + CLOSE_WITHIN;
    uint32_t active = device->session.monitor.count;
    device->session.monitor.is_armed = 0;
    while (active && device->session.socketcan.fd >= 0 && !can_session_is_dead(&device->session) &&
           clock_now() < deadline) {
        can_session_put_all(&device->session, can_no_torque);
        can_session_put_all(&device->session, can_idle);
        can_session_send(&device->session);
        can_session_wait(&device->session, clock_now() + STOP_EVERY);
        active = 0;
        for (uint32_t i = 0; i < device->session.monitor.count; i++)
            active += can_node_is_on(&device->session.monitor.nodes[i]) != 0;
    }
    socketcan_close(&device->session.socketcan);
    can_arm_close(&device->session.arm);
    free(device);
}

struct can_finder {
    const dpt_driver *driver;
    dpt_device_found_fn *found;
    void *user;
};

static void report_found(void *user, const char *name, const char *about)
{
    const struct can_finder *finder = user;
    finder->found(finder->user, finder->driver, name, about);
}

static void can_find(const dpt_driver *driver, dpt_device_found_fn *found, void *user)
{
    struct can_finder finder = { driver, found, user };
    socketcan_find(report_found, &finder);
}

const dpt_driver can_driver = {
    .size = sizeof can_driver,
    .version = DPT_DRIVER_VERSION,
    .name = "can",
    .about = "arms of ODrive, Damiao, RobStride, CyberGear or moteus motors on a CAN bus: "
             "can:can0?arm=arm.dpa&drive=odrive&gear=8,-8,10&watchdog=0.05",
    .open = can_open,
    .info = can_info,
    .read = can_read,
    .write = can_write,
    .clear = can_clear,
    .counts = can_counts,
    .close = can_close,
    .find = can_find,
};
