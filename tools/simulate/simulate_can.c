/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "simulate/simulate_can.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "settings.h"
#include "simulate/sim_clock.h"
#include "simulate/simulate_can_drive.h"

#define RECEIVES 16
#define PARTS    4

void simulate_can_send(struct simulate_can *simulated, const struct simulate_can_node *node,
                       const struct can_message *frame)
{
    for (uint32_t i = 0; i < node->copies && !node->is_mute; i++) {
        if (simulated->count == SOCKETCAN_BATCH) {
            const int sent = socketcan_send(&simulated->line, simulated->out, simulated->count);
            simulated->unsent += (uint64_t)(simulated->count - sent);
            simulated->count = 0;
        }
        simulated->out[simulated->count++] = *frame;
    }
}

static void send_message(struct simulate_can *simulated, const struct simulate_can_node *node,
                         struct odrive_message message)
{
    struct can_message frame;
    message.node = node->node;
    if (odrive_encode(&message, node->generation, &frame))
        simulate_can_send(simulated, node, &frame);
}

static uint32_t watchdog_error(const struct simulate_can_node *node)
{
    return node->generation == ODRIVE_0_5 ? 0x800 : 0x1000000;
}

static uint32_t estop_error(const struct simulate_can_node *node)
{
    return node->generation == ODRIVE_0_5 ? 0x4000 : 0x2000000;
}

static void send_heartbeat(struct simulate_can *simulated, const struct simulate_can_node *node)
{
    struct odrive_message message = { .command = ODRIVE_HEARTBEAT };
    message.as.heartbeat.errors = node->errors;
    message.as.heartbeat.state = node->state;
    message.as.heartbeat.is_done = node->is_done;
    message.as.heartbeat.failed = node->motor_errors ? ODRIVE_FAILED_MOTOR : 0;
    send_message(simulated, node, message);
}

static void send_estimates(struct simulate_can *simulated, uint32_t index)
{
    const struct can_arm *arm = &simulated->arm;
    struct odrive_message message = { .command = ODRIVE_ESTIMATES };
    message.as.estimates.position = (float)((simulated->joint[index] - arm->zero[index]) / arm->joint_per_turn[index]);
    message.as.estimates.velocity = (float)(simulated->speed[index] / arm->joint_per_turn[index]);
    send_message(simulated, &simulated->node[index], message);
}

static void answer(struct simulate_can *simulated, uint32_t index, unsigned command)
{
    struct simulate_can_node *node = &simulated->node[index];
    struct odrive_message message = { .command = (uint8_t)command };
    switch (command) {
    case ODRIVE_VERSION:
        message.as.version.protocol = 2;
        message.as.version.firmware[1] = 6;
        message.as.version.firmware[2] = 10;
        break;
    case ODRIVE_HEARTBEAT:
        send_heartbeat(simulated, node);
        return;
    case ODRIVE_ESTIMATES:
        send_estimates(simulated, index);
        return;
    case ODRIVE_ERROR:
        message.as.error.active = node->generation == ODRIVE_0_5 ? node->motor_errors : node->errors;
        break;
    case ODRIVE_ADDRESS:
        /* Nodes with the same number have different serial numbers. */
        message.as.address.node = node->node;
        for (uint32_t i = 0, copies = node->copies; i < copies; i++) {
            message.as.address.serial = node->serial + i;
            node->copies = 1;
            send_message(simulated, node, message);
            node->copies = copies;
        }
        return;
    default:
        break;
    }
    send_message(simulated, node, message);
}

static void fail(struct simulate_can_node *node, uint32_t errors)
{
    node->errors |= errors;
    if (node->errors)
        node->state = ODRIVE_STATE_IDLE;
}

static int is_odrive(const struct simulate_can_node *node)
{
    return node->end->drive == &odrive_drive;
}

static void take_frame(struct simulate_can *simulated, const struct can_message *frame)
{
    struct odrive_message message;
    struct drive_message other;
    uint32_t index = 0;
    if (frame->flags & CAN_MESSAGE_OWN)
        return;
    for (; index < simulated->arm.joints; index++) {
        const struct drive_node *end = simulated->node[index].end;
        if (is_odrive(&simulated->node[index]) && simulated->node[index].node == frame->id >> 5)
            break;
        if (!is_odrive(&simulated->node[index]) && end->drive->decode(end, frame, &other)) {
            simulate_can_drive_take(simulated, index, &other);
            return;
        }
    }
    if (index == simulated->arm.joints)
        return;
    struct simulate_can_node *node = &simulated->node[index];
    node->heard_tick = simulated->ticks;
    /* A host must not send this: 0.5 takes it as an order to change the number, to 0 if the frame has no data. */
    if (node->generation == ODRIVE_0_5 && (frame->id & 31) == ODRIVE_ADDRESS)
        node->node = frame->data[0];
    if (odrive_decode(frame, node->generation, &message) != ODRIVE_MESSAGE)
        return;
    if (message.is_request) {
        answer(simulated, index, message.command);
        return;
    }
    switch (message.command) {
    case ODRIVE_ESTOP:
        fail(node, estop_error(node));
        break;
    case ODRIVE_SET_STATE:
        if (message.as.state == ODRIVE_STATE_IDLE ||
            (message.as.state == ODRIVE_STATE_CLOSED_LOOP && !node->errors && !node->motor_errors))
            node->state = (uint8_t)message.as.state;
        break;
    case ODRIVE_SET_MODE:
        node->is_torque_mode =
            message.as.mode.control == ODRIVE_CONTROL_TORQUE && message.as.mode.input == ODRIVE_INPUT_PASSTHROUGH;
        break;
    case ODRIVE_SET_TORQUE:
        node->torque = message.as.torque;
        node->torques++;
        break;
    case ODRIVE_CLEAR_ERRORS:
        node->errors = node->causes;
        node->motor_errors = 0;
        break;
    default:
        break;
    }
}

/* Move each joint by itself for one period, pushed by its motor and by the hand at the tool. */
static void move_joints(struct simulate_can *simulated)
{
    const struct can_arm *arm = &simulated->arm;
    const double h = 1.0 / (PARTS * simulated->settings.rate);
    double efforts[DPT_JOINTS_MAX], weight[DPT_JOINTS_MAX] = { 0.0 };
    dpt_device_state state;
    if (simulated->swing > 0.0) {
        const double turns = (double)simulated->ticks / simulated->settings.rate / simulated->swing_period;
        simulated->hand[1] = simulated->swing * (fabs(4.0 * (turns - floor(turns)) - 2.0) - 1.0);
    }
    for (int part = 0; part < PARTS; part++) {
        dpt_wrench pull = { { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 } };
        double device[3];
        if (can_arm_pose(arm, simulated->joint, simulated->speed, &state) != DPT_OK)
            return;
        for (int i = 0; i < 3; i++)
            device[i] = simulated->hand_stiffness * (simulated->hand[i] - state.pose.position[i]) -
                        simulated->hand_damping * state.velocity[i];
        can_arm_to_root(arm, device, pull.force);
        dpt_arm_efforts(arm->arm, simulated->joint, &pull, efforts);
        dpt_arm_weight(arm->arm, simulated->joint, arm->gravity, weight);
        for (uint32_t i = 0; i < arm->joints; i++) {
            const struct simulate_can_node *node = &simulated->node[i];
            const double motor = node->state == ODRIVE_STATE_CLOSED_LOOP && node->is_torque_mode
                                     ? (double)node->torque / arm->torque_per_effort[i]
                                     : 0.0;
            const double sum = motor + efforts[i] - weight[i] - simulated->damping[i] * simulated->speed[i];
            simulated->speed[i] += sum / simulated->inertia[i] * h;
            simulated->joint[i] += simulated->speed[i] * h;
        }
    }
}

static void expire(struct simulate_can_node *node)
{
    if (node->state == ODRIVE_STATE_CLOSED_LOOP)
        simulate_can_drive_expire(node);
}

void simulate_can_tick(struct simulate_can *simulated)
{
    struct can_message in[SOCKETCAN_BATCH];
    int calls = 0;
    simulated->ticks++;
    do {
        const int count = socketcan_receive(&simulated->line, in);
        for (int k = 0; k < count; k++)
            take_frame(simulated, &in[k]);
    } while (!simulated->line.is_drained && ++calls < RECEIVES);
    if (!simulated->is_kinematic)
        move_joints(simulated);
    for (uint32_t i = 0; i < simulated->arm.joints; i++) {
        struct simulate_can_node *node = &simulated->node[i];
        if (node->watchdog > 0.0 &&
            (double)(simulated->ticks - node->heard_tick) > node->watchdog * simulated->settings.rate)
            is_odrive(node) ? fail(node, watchdog_error(node)) : expire(node);
        if (!is_odrive(node)) {
            if (node->causes && node->errors != node->causes)
                simulate_can_drive_fail(node, node->causes);
            continue;
        }
        if (node->causes & ~node->errors)
            fail(node, node->causes);
        if (node->motor_errors)
            node->state = ODRIVE_STATE_IDLE;
        for (uint32_t k = 0; k < node->extra_frames; k++)
            answer(simulated, i, ODRIVE_ERROR);
        if (node->estimate_ticks && simulated->ticks % node->estimate_ticks == 0)
            send_estimates(simulated, i);
        if (node->heartbeat_ticks && simulated->ticks % node->heartbeat_ticks == 0)
            send_heartbeat(simulated, node);
    }
    const int sent = socketcan_send(&simulated->line, simulated->out, simulated->count);
    simulated->unsent += (uint64_t)(simulated->count - sent);
    simulated->count = 0;
}

dpt_result simulate_can_start(struct simulate_can *simulated, const char *where, dpt_device_error *error)
{
    struct can_wanted wanted[DPT_JOINTS_MAX * DRIVE_WANTED];
    memset(simulated, 0, sizeof *simulated);
    simulated->line.fd = -1;
    dpt_result result = can_settings_read(where, &simulated->settings, error);
    if (result == DPT_OK)
        result = can_arm_open(&simulated->arm, &simulated->settings, error);
    if (result != DPT_OK)
        return result;
    for (uint32_t i = 0; i < simulated->arm.joints; i++) {
        struct simulate_can_node *node = &simulated->node[i];
        node->end = &simulated->arm.ends[i];
        node->node = (uint8_t)simulated->arm.ends[i].number;
        node->generation = simulated->settings.firmware[2] == '5' ? ODRIVE_0_5 : ODRIVE_0_6;
        node->serial = 0x300000000000u + i;
        node->watchdog = simulated->settings.watchdog;
        node->estimate_ticks = simulated->settings.request == 0.0;
        node->heartbeat_ticks = (uint32_t)(simulated->settings.heartbeat * simulated->settings.rate + 0.5);
        simulated->inertia[i] = simulated->arm.is_slider[i] ? 0.2 : 0.005;
        simulated->damping[i] = simulated->arm.is_slider[i] ? 1.0 : 0.02;
        simulated->joint[i] = simulated->arm.middle[i];
        if (!is_odrive(node))
            simulate_can_drive_start(node, &simulated->arm.ends[i]);
        simulate_can_reboot(node);
    }
    simulated->hand_stiffness = 150.0;
    simulated->hand_damping = 5.0;
    simulated->swing_period = 4.0;
    const int count = can_arm_wanted(&simulated->arm, wanted);
    result = socketcan_open(&simulated->line, simulated->settings.interface, wanted, count,
                            can_arm_is_fd(&simulated->arm), error);
    if (result != DPT_OK)
        can_arm_close(&simulated->arm);
    return result;
}

void simulate_can_reboot(struct simulate_can_node *node)
{
    node->state = ODRIVE_STATE_IDLE;
    node->errors = node->motor_errors = 0;
    node->is_torque_mode = 0;
    node->torque = 0.0f;
    node->copies = node->is_done = 1;
    if (!is_odrive(node))
        simulate_can_drive_reboot(node);
}

static void tick(void *user)
{
    simulate_can_tick(user);
}

void simulate_can_run(struct simulate_can *simulated, const volatile int *stop)
{
    sim_clock_run(simulated->settings.rate, tick, simulated, stop);
}

void simulate_can_end(struct simulate_can *simulated)
{
    socketcan_close(&simulated->line);
    can_arm_close(&simulated->arm);
}
