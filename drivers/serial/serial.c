/* SPDX-License-Identifier: BSD-3-Clause */
/* The driver "serial": devices with our protocol (wire.h), "serial:/dev/ttyACM0?speed=1000000". */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/wrench_limit.h"
#include "dynpoint/driver.h"
#include "platform/clock.h"
#include "platform/serial_line.h"
#include "serial/wire.h"
#include "settings.h"

/* wire.h repeats these numbers, because firmware has no other header of ours. */
typedef char status_is_the_same[(int)WIRE_STATUS_READY == (int)DPT_DEVICE_STATUS_READY ? 1 : -1];
typedef char reasons_are_the_same[(int)WIRE_REASON_DEVICE == (int)DPT_REASON_DEVICE ? 1 : -1];
typedef char joints_are_the_same[WIRE_JOINTS_MAX == DPT_JOINTS_MAX ? 1 : -1];

#define SECOND          1000000000u
#define HELLO_EVERY     (SECOND / 10)
#define ORDER_EVERY     (SECOND / 20)
#define ORDER_WITHIN    SECOND
#define HEARTBEAT_EVERY (SECOND / 10)
#define READ_AT_ONCE    1024
#define READS           4
#define DRIFT_PER_TICK  200 /* ns a sample by which the two clocks may drift apart: 200 ppm at 1 kHz */

struct serial_device {
    dpt_device base;
    char path[256];
    double speed, answer_within, silent_after;
    struct dynamics dynamics;
    int fd;
    struct wire_reader reader;
    struct wire_sequence samples;
    struct wire_info info;
    struct wire_state last; /* the newest sample */
    uint16_t session;       /* 0: the device has ended it */
    uint8_t has_info, has_sample, is_gone;
    uint32_t lost_reasons;     /* DPT_REASON_..., from the first read that finds the device lost until clear */
    uint32_t command_sequence; /* number of the last command */
    uint64_t sequence;         /* of the newest sample, from the open, without wrapping */
    uint64_t sequence_read;    /* of the last sample that was read */
    uint64_t heard_ns;         /* when the newest sample came */
    uint64_t sent_ns;          /* when a frame was sent last */
    uint64_t device_ns;        /* the device's clock at the newest sample, without wrapping */
    int64_t clock_offset;      /* from the device's clock to the host's, ns */
    uint64_t time_ns;          /* of the newest sample, on the host's clock */
    /* The reader's counts at the newest sample. */
    uint32_t damaged_at_sample;
    uint32_t foreign_at_sample;
    dpt_device_counts counts;
    uint8_t pending[WIRE_FRAME_MAX]; /* the rest of a frame that was sent in part */
    size_t pending_at, pending_size;
    char log[WIRE_LOG_MAX + 1];
};

static uint64_t to_ns(double time)
{
    return (uint64_t)(time * SECOND);
}

static void mark_gone(struct serial_device *device)
{
    device->is_gone = 1;
    device->session = 0;
}

/*
 * Compute a sample's time on the host's clock. The offset of the clocks is the smallest difference seen between a
 * sample's arrival and the device's clock, that of the quickest frame. It grows a little with each sample, so that it
 * follows clocks that drift.
 */
static void update_time(struct serial_device *device, uint32_t device_us, uint64_t now)
{
    if (!device->has_sample)
        device->device_ns = 0;
    else
        device->device_ns += (uint64_t)(uint32_t)(device_us - device->last.time) * 1000u;
    const int64_t offset = (int64_t)(now - device->device_ns);
    device->clock_offset += DRIFT_PER_TICK;
    if (!device->has_sample || offset < device->clock_offset)
        device->clock_offset = offset;
    const uint64_t time = device->device_ns + (uint64_t)device->clock_offset;
    device->time_ns = time > device->time_ns ? time : device->time_ns + 1;
}

static void accept_state(struct serial_device *device, const struct wire_state *state)
{
    if (!device->has_info || state->pose_dofs != device->info.pose_dofs || state->joints != device->info.joints)
        return;
    if (!device->has_sample) {
        wire_sequence_start(&device->samples, state->sequence - 1);
        memset(&device->last, 0, sizeof device->last);
        device->last.sequence = state->sequence - 1;
    }
    const struct wire_sequence samples_before = device->samples;
    const int is_newer = wire_sequence_accept(&device->samples, state->sequence);
    /* These differences may be negative: a lost number that comes late becomes reordered and is no longer lost. */
    device->counts.lost += (uint64_t)(int64_t)(int32_t)(device->samples.lost - samples_before.lost);
    device->counts.reordered += device->samples.reordered - samples_before.reordered;
    if (!is_newer)
        return;
    device->heard_ns = clock_now();
    update_time(device, state->time, device->heard_ns);
    device->sequence += state->sequence - device->last.sequence;
    device->counts.samples += state->sequence - device->last.sequence;
    device->counts.missed += (uint64_t)(int64_t)(int16_t)(state->lost - device->last.lost);
    device->counts.missed += (uint64_t)(int64_t)(int16_t)(state->late - device->last.late);
    device->counts.missed += (uint64_t)(int64_t)(int8_t)(state->reordered - device->last.reordered);
    device->last = *state;
    device->has_sample = 1;
    device->damaged_at_sample = device->reader.damaged;
    device->foreign_at_sample = device->reader.foreign;
}

static void accept_message(struct serial_device *device, const struct wire_message *message)
{
    switch (message->type) {
    case WIRE_INFO:
        if (message->session == device->session && !device->has_info) {
            device->info = message->as.info;
            device->has_info = 1;
        }
        break;
    case WIRE_STATE:
        if (message->session == device->session && device->session != 0)
            accept_state(device, &message->as.state);
        break;
    case WIRE_HEARTBEAT:
        if (message->session != 0 || !device->has_sample || device->session == 0)
            break;
        /* A device without a session has ended ours, or has restarted. */
        if (message->as.heartbeat.sequence - device->last.sequence >= 0x80000000u)
            device->counts.resets++;
        device->session = 0;
        break;
    case WIRE_LOG:
        memcpy(device->log, message->as.log.text, message->as.log.size);
        device->log[message->as.log.size] = '\0';
        for (char *c = device->log; *c; c++)
            if (*c < ' ' || *c > '~')
                *c = '?';
        break;
    default:
        break;
    }
}

/* Process what has come, in at most READS reads. */
static void receive_all(struct serial_device *device)
{
    uint8_t bytes[READ_AT_ONCE];
    struct wire_message message;
    for (int i = 0; i < READS && !device->is_gone && device->fd >= 0; i++) {
        const long count = serial_line_read(device->fd, bytes, sizeof bytes);
        if (count < 0)
            mark_gone(device);
        for (long k = 0; k < count; k++)
            switch (wire_read(&device->reader, bytes[k], &message)) {
            case WIRE_MESSAGE:
                accept_message(device, &message);
                break;
            case WIRE_DAMAGED:
            case WIRE_FOREIGN:
                device->counts.damaged++;
            }
        /* Read on after a short read: the system may return more, the newest bytes, on the next call. */
        if (count <= 0)
            break;
    }
}

/*
 * Send a frame. Returns 1 if it was sent, 0 if there is no room. If only a part of it fits, the rest goes first next
 * time, because the device could not tell a piece from damage.
 */
static int send_bytes(struct serial_device *device, const uint8_t *bytes, size_t size)
{
    if (device->pending_at < device->pending_size) {
        const long count = serial_line_write(device->fd, device->pending + device->pending_at,
                                             device->pending_size - device->pending_at);
        if (count < 0)
            mark_gone(device);
        device->pending_at += count > 0 ? (size_t)count : 0;
        if (device->pending_at < device->pending_size)
            return 0;
    }
    const long count = serial_line_write(device->fd, bytes, size);
    if (count < 0)
        mark_gone(device);
    if (count <= 0)
        return 0;
    device->pending_at = 0;
    device->pending_size = size - (size_t)count;
    memcpy(device->pending, bytes + count, device->pending_size);
    device->sent_ns = clock_now();
    return 1;
}

static int send_message(struct serial_device *device, struct wire_message *message)
{
    uint8_t frame[WIRE_FRAME_MAX];
    message->session = device->session;
    const size_t size = wire_encode(message, frame);
    return size > 0 && send_bytes(device, frame, size);
}

static void send_order(struct serial_device *device, uint8_t order)
{
    struct wire_message message = { .type = WIRE_ORDER };
    message.as.order = order;
    send_message(device, &message);
}

/* Begin a session with a new number. Waits for the device's INFO and first sample. Returns 0 if they do not come. */
static int begin_session(struct serial_device *device)
{
    static const uint8_t zero;
    const uint64_t start = clock_now(), deadline = start + to_ns(device->answer_within);
    const uint16_t before = device->session;
    device->session = (uint16_t)(start >> 10 ^ start >> 26);
    if (device->session == 0 || device->session == before)
        device->session = (uint16_t)(before + 1) ? (uint16_t)(before + 1) : 1;
    device->has_info = device->has_sample = 0;
    device->command_sequence = 0;
    device->pending_at = device->pending_size = 0;
    uint64_t now = start, next = start;
    while (!device->has_sample && !device->is_gone && (now = clock_now()) < deadline) {
        if (now >= next) {
            struct wire_message hello = { .type = WIRE_HELLO };
            /* A zero ends the rest of an earlier host's frame. */
            send_bytes(device, &zero, 1);
            send_message(device, &hello);
            next = now + HELLO_EVERY;
        }
        serial_line_wait(device->fd, next);
        receive_all(device);
    }
    return device->has_sample;
}

/* Repeat an order while the device's status is `status`, for at most ORDER_WITHIN. */
static void repeat_order(struct serial_device *device, uint8_t order, uint32_t status)
{
    uint64_t now = clock_now(), next = now;
    const uint64_t deadline = now + ORDER_WITHIN;
    while (device->last.status == status && !device->is_gone && device->session != 0 &&
           (now = clock_now()) < deadline) {
        if (now >= next) {
            send_order(device, order);
            next = now + ORDER_EVERY;
        }
        serial_line_wait(device->fd, next);
        receive_all(device);
    }
}

static int is_plausible(const struct wire_info *info)
{
    const float not_negative[] = { info->force_max,     info->force_continuous, info->torque_max,
                                   info->stiffness_max, info->position_step,    info->watchdog };
    for (size_t i = 0; i < sizeof not_negative / sizeof *not_negative; i++)
        if (not_negative[i] < 0.0f)
            return 0;
    for (int i = 0; i < 3; i++)
        if (info->workspace_min[i] > info->workspace_max[i])
            return 0;
    return (info->pose_dofs == 3 || info->pose_dofs == 6) && info->joints <= WIRE_JOINTS_MAX &&
           (info->wrench_dofs == 0 || info->wrench_dofs == 3 || info->wrench_dofs == 6) && info->buttons <= 16 &&
           info->rate > 0.0f && info->rate <= 1e5f;
}

static dpt_result explain_no_answer(const struct serial_device *device, dpt_device_error *error)
{
    const struct wire_reader *reader = &device->reader;
    if (device->is_gone)
        return device_error(error, DPT_E_LOST, "%.60s went away while it was asked", device->path);
    if (reader->foreign > 0)
        return device_error(error, DPT_E_PROTOCOL,
                            "%.60s speaks version %u of the protocol, this library %u: renew the older "
                            "one of firmware and library",
                            device->path, reader->version, WIRE_VERSION);
    if (reader->damaged > 0 || reader->count > 0)
        return device_error(error, DPT_E_DEVICE,
                            "%.60s sends what is none of ours at %u baud: is it another device, or "
                            "another speed (?speed=)?",
                            device->path, (unsigned)device->speed);
    return device_error(error, DPT_E_DEVICE,
                        "no answer from %.60s at %u baud within %g s: is it the right port and speed "
                        "(?speed=), and has the device power?%s%.80s",
                        device->path, (unsigned)device->speed, device->answer_within,
                        device->log[0] ? " It says: " : "", device->log);
}

static dpt_result check_info(const struct serial_device *device, dpt_device_error *error)
{
    if (!is_plausible(&device->info))
        return device_error(error, DPT_E_DEVICE, "what %.60s says of itself makes no sense: repair its firmware",
                            device->path);
    const double needed =
        10.0 * device->info.rate * (double)wire_state_bytes(device->info.pose_dofs, device->info.joints);
    if (needed > device->speed)
        return device_error(error, DPT_E_SETTING,
                            "%.60s needs at least %.0f baud for its %g samples a second: set a higher "
                            "?speed=, also where the line is USB and ignores it",
                            device->path, needed, (double)device->info.rate);
    return DPT_OK;
}

static dpt_result connect_line(struct serial_device *device, dpt_device_error *error)
{
    DPT_TRY(serial_line_open(device->path, (uint32_t)device->speed, &device->fd, error));
    device->is_gone = 0;
    memset(&device->reader, 0, sizeof device->reader);
    const uint64_t damaged = device->counts.damaged;
    const dpt_result result = begin_session(device) ? check_info(device, error) : explain_no_answer(device, error);
    /* What came while connecting does not count as damage. */
    device->counts.damaged = damaged;
    if (result == DPT_OK) {
        device->lost_reasons = 0;
        repeat_order(device, WIRE_ENABLE, DPT_DEVICE_STATUS_UNREADY);
    } else {
        device->session = 0;
    }
    return result;
}

static void use_first_port(void *user, const char *path, const char *about)
{
    struct serial_device *device = user;
    (void)about;
    if (!device->path[0])
        snprintf(device->path, sizeof device->path, "%s", path);
}

static dpt_result read_and_connect(struct serial_device *device, const char *where, dpt_device_error *error)
{
    device->speed = 1e6;
    device->answer_within = 3.0;
    device->silent_after = 0.1;
    const struct setting settings[] = {
        { .name = "speed", .number = &device->speed, .min = 1200, .max = 4e6 },
        { .name = "answer", .number = &device->answer_within, .min = 0.01, .max = 60 },
        { .name = "silent", .number = &device->silent_after, .min = 0.001, .max = 60 },
    };
    DPT_TRY(settings_read(where, device->path, sizeof device->path, settings, sizeof settings / sizeof *settings,
                          &device->dynamics, error));
    if (!device->path[0])
        serial_line_find(use_first_port, device);
    if (!device->path[0])
        return device_error(error, DPT_E_DEVICE,
                            "no serial port is there: is the device plugged in? Others are named as "
                            "in serial:/dev/ttyS0");
    return connect_line(device, error);
}

static dpt_result serial_open(const dpt_driver *driver, const char *where, dpt_device **opened, dpt_device_error *error)
{
    (void)driver;
    struct serial_device *device = calloc(1, sizeof *device);
    if (!device)
        return device_error(error, DPT_E_MEMORY, "no memory");
    device->fd = -1;
    const dpt_result result = read_and_connect(device, where, error);
    if (result == DPT_OK) {
        *opened = &device->base;
        return DPT_OK;
    }
    if (device->fd >= 0)
        serial_line_close(device->fd);
    free(device);
    return result;
}

static void copy_text(char out[48], const char *text)
{
    for (int i = 0; i < 47 && text[i]; i++)
        out[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
}

static void serial_info(const dpt_device *base, dpt_device_info *info)
{
    const struct wire_info *from = &((const struct serial_device *)base)->info;
    info->pose_dofs = from->pose_dofs;
    info->wrench_dofs = from->wrench_dofs;
    info->joints = from->joints;
    info->buttons = from->buttons;
    /* Never DETERMINISTIC, whatever the device says: a loop would not wait for it. */
    info->flags = from->flags & (DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_ARM);
    info->rate = from->rate;
    info->force_max = from->force_max;
    info->force_continuous = from->force_continuous;
    info->torque_max = from->torque_max;
    info->stiffness_max = from->stiffness_max;
    info->position_step = from->position_step;
    info->watchdog = from->watchdog;
    for (int i = 0; i < 3; i++) {
        info->workspace_min[i] = from->workspace_min[i];
        info->workspace_max[i] = from->workspace_max[i];
    }
    copy_text(info->name, from->name);
    copy_text(info->serial, from->serial);
    dynamics_override(&((const struct serial_device *)base)->dynamics, info);
}

static void copy_pose(const struct wire_state *from, dpt_device_state *state)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    state->pose = identity;
    for (int i = 0; i < 3; i++) {
        state->pose.position[i] = from->position[i];
        state->velocity[i] = from->velocity[i];
        state->spin[i] = from->spin[i];
    }
    if (from->pose_dofs == 6) {
        double square = 0.0;
        for (int i = 0; i < 4; i++)
            square += (double)from->orientation[i] * from->orientation[i];
        for (int i = 0; i < 4; i++)
            state->pose.orientation[i] = from->orientation[i] / sqrt(square);
    }
    for (int i = 0; i < WIRE_JOINTS_MAX; i++)
        state->joint[i] = from->joint[i];
}

/* Why the device is lost, or 0. It stays so when samples come again, because nothing is known of the time between. */
static uint32_t find_loss(struct serial_device *device)
{
    if (device->is_gone) {
        device->lost_reasons = DPT_REASON_UNPLUGGED;
    } else if (device->session == 0 || clock_now() - device->heard_ns > to_ns(device->silent_after)) {
        device->lost_reasons |= DPT_REASON_SILENT;
        if (device->reader.damaged != device->damaged_at_sample)
            device->lost_reasons |= DPT_REASON_LINK;
        if (device->reader.foreign != device->foreign_at_sample)
            device->lost_reasons |= DPT_REASON_VERSION;
    }
    return device->lost_reasons;
}

static dpt_result serial_read(dpt_device *base, dpt_device_state *state)
{
    struct serial_device *device = (struct serial_device *)base;
    receive_all(device);
    if (!device->is_gone && device->session != 0 && clock_now() - device->sent_ns > HEARTBEAT_EVERY) {
        struct wire_message heartbeat = { .type = WIRE_HEARTBEAT };
        heartbeat.as.heartbeat.sequence = device->last.sequence;
        send_message(device, &heartbeat);
    }
    const struct wire_state *last = &device->last;
    const uint64_t fresh = device->sequence - device->sequence_read;
    device->sequence_read = device->sequence;
    state->status = last->status;
    state->reasons = last->status == DPT_DEVICE_STATUS_READY ? 0 : last->reasons;
    state->code = last->code;
    state->buttons = last->buttons;
    state->fresh = fresh < UINT32_MAX ? (uint32_t)fresh : UINT32_MAX;
    state->sequence = device->sequence;
    state->time_ns = device->time_ns;
    state->temperature =
        last->temperature == WIRE_TEMPERATURE_UNKNOWN ? -1.0 : (double)last->temperature / WIRE_TEMPERATURE_LIMIT;
    copy_pose(last, state);
    const uint32_t reasons = find_loss(device);
    if (reasons == 0)
        return DPT_OK;
    state->status = DPT_DEVICE_STATUS_LOST;
    state->reasons = reasons;
    state->fresh = 0;
    return DPT_E_LOST;
}

static dpt_result serial_write(dpt_device *base, const dpt_wrench *wrench)
{
    struct serial_device *device = (struct serial_device *)base;
    if (find_loss(device))
        return DPT_E_LOST;
    if (device->last.status != DPT_DEVICE_STATUS_READY)
        return DPT_E_NOT_READY;
    dpt_wrench limited = *wrench;
    limit_length(limited.force, device->info.wrench_dofs >= 3 ? (double)device->info.force_max : 0);
    limit_length(limited.torque, device->info.wrench_dofs >= 6 ? (double)device->info.torque_max : 0);
    struct wire_message message = { .type = WIRE_COMMAND };
    message.as.command.sequence = device->command_sequence + 1;
    message.as.command.answers = device->last.sequence;
    for (int i = 0; i < 3; i++) {
        message.as.command.force[i] = (float)limited.force[i];
        message.as.command.torque[i] = (float)limited.torque[i];
    }
    device->counts.commands++;
    if (send_message(device, &message)) {
        device->command_sequence++;
        return DPT_OK;
    }
    device->counts.refused++;
    return device->is_gone ? DPT_E_LOST : DPT_E_BUSY;
}

static dpt_result serial_clear(dpt_device *base)
{
    struct serial_device *device = (struct serial_device *)base;
    receive_all(device);
    if (find_loss(device)) {
        const struct wire_info info = device->info;
        if (device->fd >= 0)
            serial_line_close(device->fd);
        mark_gone(device);
        if (connect_line(device, NULL) != DPT_OK) {
            device->info = info;
            return DPT_E_LOST;
        }
        device->counts.resets++;
    }
    repeat_order(device, WIRE_CLEAR, DPT_DEVICE_STATUS_FAULT);
    repeat_order(device, WIRE_ENABLE, DPT_DEVICE_STATUS_UNREADY);
    if (find_loss(device))
        return DPT_E_LOST;
    return device->last.status == DPT_DEVICE_STATUS_READY ? DPT_OK : DPT_E_NOT_READY;
}

static void serial_counts(const dpt_device *base, dpt_device_counts *counts)
{
    const struct serial_device *device = (const struct serial_device *)base;
    *counts = device->counts;
    counts->size = sizeof *counts;
}

static void serial_close(dpt_device *base)
{
    struct serial_device *device = (struct serial_device *)base;
    if (device->fd >= 0) {
        repeat_order(device, WIRE_STOP, DPT_DEVICE_STATUS_READY);
        serial_line_close(device->fd);
    }
    free(device);
}

struct serial_finder {
    const dpt_driver *driver;
    dpt_device_found_fn *found;
    void *user;
};

static void report_found(void *user, const char *path, const char *about)
{
    const struct serial_finder *finder = user;
    finder->found(finder->user, finder->driver, path, about);
}

static void serial_find(const dpt_driver *driver, dpt_device_found_fn *found, void *user)
{
    struct serial_finder finder = { driver, found, user };
    serial_line_find(report_found, &finder);
}

const dpt_driver serial_driver = {
    .size = sizeof serial_driver,
    .version = DPT_DRIVER_VERSION,
    .name = "serial",
    .about = "devices of our own protocol at a serial line: serial:/dev/ttyACM0?speed=1000000",
    .open = serial_open,
    .info = serial_info,
    .read = serial_read,
    .write = serial_write,
    .clear = serial_clear,
    .counts = serial_counts,
    .close = serial_close,
    .find = serial_find,
};
