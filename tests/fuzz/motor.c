/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Frames of a CAN bus on which four motors are, one of each drive that answers: a byte of flags, an id of four, a byte for the
 * length, the data. Each goes to the drives, to the host's monitor, and to simulated motors. What is decoded is finite, and says the
 * same once it is encoded again; a motor gives no torque beyond its range, and none while it is off; what it says is decoded.
 */
#include <math.h>
#include <string.h>

#include "can/can_monitor.h"
#include "fuzz/target.h"
#include "simulate/simulate_can_drive.h"

enum { MOTORS = 4 };

static void set_up(struct can_arm *arm)
{
    static const struct can_drive *const drives[MOTORS] = { &damiao_drive, &robstride_drive, &cybergear_drive,
                                                            &moteus_drive };
    memset(arm, 0, sizeof *arm);
    arm->joints = MOTORS;
    for (uint32_t i = 0; i < MOTORS; i++) {
        const struct can_drive *drive = drives[i];
        const uint16_t number = (uint16_t)(i + 1);
        arm->joint_per_turn[i] = arm->torque_per_effort[i] = 1.0;
        arm->ends[i] =
            (struct drive_node){ .drive = drive,
                                 .number = number,
                                 .answer = (uint16_t)(drive->answer + (drive->answer_has_number ? number : 0)),
                                 .position_range = 12.5,
                                 .velocity_range = 30.0,
                                 .torque_range = 10.0,
                                 .heat_limit = 80.0 };
    }
}

static void check_message(const struct drive_node *node, const struct drive_message *said)
{
    const struct drive_status *status = &said->as.status;
    struct can_message frame;
    struct drive_message again;
    if (said->kind == DRIVE_TORQUE)
        MUST(isfinite((double)said->as.command.torque));
    if (said->kind == DRIVE_STATUS)
        MUST(isfinite((double)status->position) && isfinite((double)status->velocity) &&
             isfinite((double)status->torque) && isfinite((double)status->temperature));
    if (said->kind == DRIVE_VALUE)
        MUST(isfinite(said->as.value) && said->parameter < DRIVE_PARAMETERS);
    if (said->kind == DRIVE_OTHER || said->kind == DRIVE_DAMAGED || said->kind == DRIVE_ORDER)
        return;
    if (!node->drive->encode(node, said, &frame))
        return;
    MUST(frame.size <= CAN_MESSAGE_BYTES);
    const int kind = node->drive->decode(node, &frame, &again);
    /* moteus writes by a command, and RobStride asks by an order to be off. */
    MUST(kind == said->kind || said->kind == DRIVE_WRITE || said->kind == DRIVE_ON || said->kind == DRIVE_ASK ||
         said->kind == DRIVE_CLEAR);
}

static void check_motors(const struct simulate_can *simulated)
{
    for (uint32_t i = 0; i < MOTORS; i++) {
        const struct simulate_can_node *node = &simulated->node[i];
        const double torque = fabs((double)node->torque);
        MUST(isfinite(torque) && (node->end->drive == &moteus_drive || torque <= 1.001 * node->end->torque_range));
        MUST(node->state == ODRIVE_STATE_CLOSED_LOOP || !(torque > 0.0));
    }
}

/* What the motors said since the last frame goes to the host. */
static void carry(struct simulate_can *simulated, struct can_monitor *monitor, uint64_t now)
{
    for (int i = 0; i < simulated->count; i++) {
        simulated->out[i].time_ns = now;
        can_monitor_take(monitor, &simulated->out[i]);
    }
    simulated->count = 0;
}

static void take(struct simulate_can *simulated, struct can_monitor *monitor, struct can_message *frame)
{
    struct drive_message said;
    for (uint32_t i = 0; i < MOTORS; i++) {
        const struct drive_node *node = &simulated->arm.ends[i];
        const int kind = node->drive->decode(node, frame, &said);
        MUST(kind == said.kind && kind <= DRIVE_DAMAGED);
        fuzz_accepted += kind != DRIVE_OTHER && kind != DRIVE_DAMAGED;
        check_message(node, &said);
        if (kind != DRIVE_OTHER)
            simulate_can_drive_take(simulated, i, &said);
    }
    check_motors(simulated);
    can_monitor_take(monitor, frame);
    can_monitor_note_sent(monitor, frame, frame->time_ns);
    carry(simulated, monitor, frame->time_ns);
    can_monitor_check(monitor, frame->time_ns, 1);
    for (uint32_t i = 0; i < MOTORS; i++)
        MUST(isfinite((double)monitor->position[i]) && isfinite((double)monitor->velocity[i]));
    MUST(monitor->status <= DPT_DEVICE_STATUS_READY && can_monitor_temperature(monitor) >= -1.0);
}

FUZZ_TARGET(motor)
{
    static struct simulate_can simulated;
    static struct can_monitor monitor;
    const struct can_settings settings = { .rate = 1000.0, .heartbeat = 0.1, .silent = 0.05 };
    const uint64_t accepted = fuzz_accepted;
    memset(&simulated, 0, sizeof simulated);
    simulated.line.fd = -1;
    set_up(&simulated.arm);
    for (uint32_t i = 0; i < MOTORS; i++) {
        simulate_can_drive_start(&simulated.node[i], &simulated.arm.ends[i]);
        simulate_can_reboot(&simulated.node[i]);
    }
    can_monitor_init(&monitor, &simulated.arm, &settings);
    monitor.is_armed = 1;
    monitor.status = DPT_DEVICE_STATUS_READY;
    uint64_t now = 1000000000u;
    for (size_t at = 0; at + 6 <= size;) {
        struct can_message frame = { .time_ns = now += 500000u, .flags = bytes[at] & 15 };
        for (int i = 0; i < 4; i++)
            frame.id |= (uint32_t)bytes[at + 1 + (size_t)i] << 8 * i;
        frame.id &= frame.flags & CAN_MESSAGE_EXTENDED ? 0x1fffffffu : 0x7ffu;
        const size_t most = frame.flags & CAN_MESSAGE_FD ? CAN_MESSAGE_BYTES : 8, left = size - at - 6;
        size_t length = bytes[at + 5] < most ? bytes[at + 5] : most;
        length = length < left ? length : left;
        frame.size = (uint8_t)length;
        memcpy(frame.data, bytes + at + 6, length);
        at += 6 + length;
        take(&simulated, &monitor, &frame);
    }
    fuzz_accepted = accepted + (fuzz_accepted > accepted);
    return 0;
}
