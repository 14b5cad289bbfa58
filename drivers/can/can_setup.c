/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/can_setup.h"

#include <math.h>

#include "base/return_if_error.h"
#include "base/vec3.h"
#include "platform/clock.h"
#include "settings.h"

#define MS        1000000u
#define AGAIN     (20u * MS) /* until a parameter is asked for again */
#define TRIES_MAX 20         /* of a parameter, once the motor has answered another */
#define RANGE_MAX 1e5
#define ASKS      15 /* for a status, of each motor that is set up: two of one number answer twice */

/* The value that a parameter is set to. */
static double target_of(const struct drive_node *end, const struct drive_parameter *parameter)
{
    switch (parameter->parameter) {
    case DRIVE_WATCHDOG:
        return end->watchdog;
    case DRIVE_TORQUE_LIMIT:
        return end->torque_limit;
    default:
        return parameter->min;
    }
}

/* Use a value that was learnt. Returns 0 if it makes no sense. */
static int learn(struct drive_node *end, unsigned parameter, double value)
{
    double *const places[DRIVE_PARAMETERS] = { [DRIVE_POSITION_RANGE] = &end->position_range,
                                               [DRIVE_VELOCITY_RANGE] = &end->velocity_range,
                                               [DRIVE_TORQUE_RANGE] = &end->torque_range,
                                               [DRIVE_HEAT_LIMIT] = &end->heat_limit };
    if (!places[parameter])
        return 1;
    if (!(value > 0.0 && value < RANGE_MAX))
        return 0;
    *places[parameter] = value;
    return 1;
}

/* A value came: 1 if it is as it must be. */
static int accept(struct drive_node *end, const struct drive_parameter *parameter, double value)
{
    const double target = target_of(end, parameter);
    switch (parameter->action) {
    case DRIVE_CHECK:
        return value >= parameter->min && value <= parameter->max;
    case DRIVE_LEARN:
        return learn(end, parameter->parameter, value);
    default:
        return fabs(value - target) <= max_of(parameter->bytes ? 0.51 * parameter->unit : 0.0, 1e-6 * fabs(target));
    }
}

/* Go on as far as the values that have come allow, and ask for the next. Returns 1 if all is done. */
static int go_on(struct can_session *session, uint32_t index, uint64_t now)
{
    struct can_node *node = &session->monitor.nodes[index];
    struct drive_node *end = &session->arm.ends[index];
    const struct can_drive *drive = end->drive;
    for (; node->setup_at < drive->parameter_count; node->setup_at++, node->setup_tries = 0, node->setup_ns = now) {
        const struct drive_parameter *parameter = &drive->parameters[node->setup_at];
        if (!(node->known_values >> parameter->parameter & 1))
            break;
        if (!accept(end, parameter, node->value[parameter->parameter])) {
            node->is_refused = 1;
            return 0;
        }
    }
    if (node->setup_at == drive->parameter_count)
        return 1;
    if (now < node->setup_ns)
        return 0;
    const struct drive_parameter *parameter = &drive->parameters[node->setup_at];
    struct drive_message message = { .kind = DRIVE_WRITE,
                                     .parameter = parameter->parameter,
                                     .as.value = target_of(end, parameter) };
    if (parameter->action == DRIVE_SET)
        can_session_put(session, index, message);
    message.kind = DRIVE_READ;
    can_session_put(session, index, message);
    node->setup_ns = now + AGAIN;
    node->setup_tries++;
    return 0;
}

static const char *name_of(unsigned parameter)
{
    static const char *const names[DRIVE_PARAMETERS] = { [DRIVE_VERSION] = "version of its registers",
                                                         [DRIVE_CONTROL] = "control mode",
                                                         [DRIVE_WATCHDOG] = "watchdog",
                                                         [DRIVE_POSITION_RANGE] = "range of positions",
                                                         [DRIVE_VELOCITY_RANGE] = "range of velocities",
                                                         [DRIVE_TORQUE_RANGE] = "range of torques",
                                                         [DRIVE_TORQUE_LIMIT] = "torque limit",
                                                         [DRIVE_HEAT_LIMIT] = "temperature limit" };
    return names[parameter];
}

static dpt_result explain(const struct can_session *session, uint32_t index, dpt_device_error *error)
{
    const struct can_node *node = &session->monitor.nodes[index];
    const struct can_drive *drive = node->end->drive;
    if (node->is_duplicate)
        return device_error(error, DPT_E_DEVICE, "there are two motors with the number %u: give each its own",
                            node->node);
    const struct drive_parameter *parameter = &drive->parameters[node->setup_at];
    const char *name = name_of(parameter->parameter);
    if (node->is_refused && parameter->action == DRIVE_SET)
        return device_error(error, DPT_E_PROTOCOL, "%s %u: its %s was set to %g, and reads back as %g", drive->title,
                            node->node, name, target_of(node->end, parameter), node->value[parameter->parameter]);
    if (node->is_refused)
        return device_error(error, DPT_E_PROTOCOL, "%s %u: its %s is %g, which this driver does not know", drive->title,
                            node->node, name, node->value[parameter->parameter]);
    if (node->known_values || node->has_heartbeat)
        return device_error(error, DPT_E_PROTOCOL,
                            "%s %u does not tell its %s: its firmware is too old, or of another kind", drive->title,
                            node->node, name);
    return device_error(
        error, DPT_E_DEVICE,
        "no %s %u on %.20s within %g s: is it powered, and has it that number? Joints' motors are set by "
        "?drive= and ?nodes=",
        drive->title, node->node, session->settings.interface, session->settings.answer);
}

dpt_result can_setup_motors(struct can_session *session, dpt_device_error *error)
{
    struct can_monitor *monitor = &session->monitor;
    const struct drive_message clear = { .kind = DRIVE_CLEAR };
    const uint64_t start = clock_now(), deadline = start + (uint64_t)(1e9 * session->settings.answer);
    for (uint32_t i = 0; i < monitor->count; i++) {
        struct can_node *node = &monitor->nodes[i];
        if (!node->end->drive->answers)
            continue;
        node->setup_at = node->setup_tries = node->is_refused = node->is_duplicate = 0;
        node->surplus = 0;
        node->known_values = 0;
        node->setup_ns = start;
        can_session_put(session, i, clear); /* in a fault a motor may not take what is set */
    }
    int asks = 0;
    for (uint64_t now = start; !can_session_is_dead(session); now = clock_now()) {
        uint32_t waiting = 0, answering = 0;
        for (uint32_t i = 0; i < monitor->count; i++) {
            const struct can_node *node = &monitor->nodes[i];
            if (!node->end->drive->answers)
                continue;
            answering++;
            if (go_on(session, i, now) && !node->is_duplicate)
                continue;
            if (node->is_refused || node->is_duplicate || now >= deadline ||
                (node->setup_tries > TRIES_MAX && node->known_values)) {
                session->out_count = 0;
                return explain(session, i, error);
            }
            waiting++;
        }
        if (!answering || (!waiting && asks == ASKS))
            break;
        for (uint32_t i = 0; i < monitor->count && !waiting; i++)
            if (monitor->nodes[i].end->drive->answers)
                can_session_put(session, i, can_ask);
        asks += !waiting;
        can_session_send(session);
        can_session_wait(session, now + MS);
    }
    can_arm_apply_ranges(&session->arm);
    return DPT_OK;
}
