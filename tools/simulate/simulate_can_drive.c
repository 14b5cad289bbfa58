/* SPDX-License-Identifier: BSD-3-Clause */
#include "simulate/simulate_can_drive.h"

#include <math.h>
#include <string.h>

/* What a motor says of itself when it leaves the factory; a Damiao DM-J4310's ranges. */
static void fill_values(const struct drive_node *end, double value[DRIVE_PARAMETERS])
{
    value[DRIVE_VERSION] = 5.0;
    value[DRIVE_CONTROL] = 2.0; /* positions and speeds: the host must change it */
    value[DRIVE_WATCHDOG] = 0.0;
    value[DRIVE_POSITION_RANGE] = end->position_range;
    value[DRIVE_VELOCITY_RANGE] = end->velocity_range;
    value[DRIVE_TORQUE_RANGE] = end->torque_range;
    value[DRIVE_TORQUE_LIMIT] = end->torque_range;
    value[DRIVE_HEAT_LIMIT] = 100.0;
}

void simulate_can_drive_start(struct simulate_can_node *node, struct drive_node *end)
{
    if (end->drive == &damiao_drive) {
        end->position_range = 12.5;
        end->velocity_range = 30.0;
        end->torque_range = 10.0;
    }
    node->end = end;
    node->watchdog = 0.0;
    node->temperature = 30.0f;
    fill_values(end, node->value);
}

/* Whether it obeys torques. */
static void note_control(struct simulate_can_node *node)
{
    const struct drive_parameter *control = drive_parameter_of(node->end->drive, DRIVE_CONTROL);
    node->is_torque_mode = !control || fabs(node->value[DRIVE_CONTROL] - control->min) < 0.5;
}

void simulate_can_drive_reboot(struct simulate_can_node *node)
{
    node->watchdog = 0.0;
    node->value[DRIVE_WATCHDOG] = 0.0;
    note_control(node);
}

static void answer(struct simulate_can *simulated, uint32_t index, const struct drive_message *message)
{
    const struct simulate_can_node *node = &simulated->node[index];
    struct can_message frame;
    if (node->end->drive->encode(node->end, message, &frame))
        simulate_can_send(simulated, node, &frame);
}

static void answer_status(struct simulate_can *simulated, uint32_t index)
{
    const struct can_arm *arm = &simulated->arm;
    const struct simulate_can_node *node = &simulated->node[index];
    const struct drive_message message = {
        .kind = DRIVE_STATUS,
        .as.status = { .position = (float)((simulated->joint[index] - arm->zero[index]) / arm->joint_per_turn[index]),
                       .velocity = (float)(simulated->speed[index] / arm->joint_per_turn[index]),
                       .torque = node->state == ODRIVE_STATE_CLOSED_LOOP ? node->torque : 0.0f,
                       .temperature = node->temperature,
                       .fault = node->errors,
                       .is_on = node->state == ODRIVE_STATE_CLOSED_LOOP }
    };
    answer(simulated, index, &message);
}

static void answer_value(struct simulate_can *simulated, uint32_t index, unsigned parameter)
{
    const struct simulate_can_node *node = &simulated->node[index];
    const struct drive_message message = { .kind = DRIVE_VALUE,
                                           .parameter = (uint8_t)parameter,
                                           .as.value = node->value[parameter] };
    if (!(node->lacks >> parameter & 1))
        answer(simulated, index, &message);
}

static void switch_off(struct simulate_can_node *node)
{
    node->state = ODRIVE_STATE_IDLE;
    node->torque = 0.0f;
}

void simulate_can_drive_fail(struct simulate_can_node *node, uint32_t fault)
{
    node->errors = fault;
    switch_off(node);
}

void simulate_can_drive_expire(struct simulate_can_node *node)
{
    if (node->end->drive == &damiao_drive)
        simulate_can_drive_fail(node, 0xd);
    else if (node->end->drive == &moteus_drive)
        simulate_can_drive_fail(node, 11);
    else
        switch_off(node);
}

static void set_value(struct simulate_can_node *node, unsigned parameter, double value)
{
    const int is_kept = (int)(node->refuses >> parameter & 1);
    node->value[parameter] = is_kept ? node->value[parameter] : value;
    node->watchdog = node->value[DRIVE_WATCHDOG];
    note_control(node);
}

static void take_torque(struct simulate_can_node *node, const struct drive_message *message)
{
    const float torque = message->as.command.torque;
    if (node->end->drive == &moteus_drive && !node->errors) {
        const double watchdog = (double)message->as.command.watchdog, limit = (double)message->as.command.limit;
        node->state = ODRIVE_STATE_CLOSED_LOOP;
        set_value(node, DRIVE_WATCHDOG, isfinite(watchdog) ? watchdog : 0.0);
        set_value(node, DRIVE_TORQUE_LIMIT, isfinite(limit) ? limit : 0.0);
    }
    node->torques++;
    if (node->state == ODRIVE_STATE_CLOSED_LOOP)
        node->torque = torque;
}

void simulate_can_drive_take(struct simulate_can *simulated, uint32_t index, const struct drive_message *message)
{
    struct simulate_can_node *node = &simulated->node[index];
    node->heard_tick = simulated->ticks;
    switch (message->kind) {
    case DRIVE_TORQUE:
        take_torque(node, message);
        break;
    case DRIVE_ON:
        if (!node->errors && node->state == ODRIVE_STATE_IDLE) {
            node->state = ODRIVE_STATE_CLOSED_LOOP;
            node->torque = 0.0f;
        }
        break;
    case DRIVE_OFF:
        switch_off(node);
        if (node->end->drive == &moteus_drive)
            node->errors = node->causes;
        break;
    case DRIVE_CLEAR:
        switch_off(node);
        node->errors = node->causes;
        break;
    case DRIVE_ASK:
        break;
    case DRIVE_READ:
        answer_value(simulated, index, message->parameter);
        return;
    case DRIVE_WRITE:
        set_value(node, message->parameter, message->as.value);
        break;
    default:
        return;
    }
    answer_status(simulated, index);
}
