/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/can_monitor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/vec3.h"

#define MS             1000000u
#define LOST_AFTER     (20u * MS)
#define WINDOW         (100u * MS)
#define WINDOW_PERIODS 20
/*
 * check_rate: how far ahead a cyclic message may be, in quarters of its period, and its leak. Heartbeats may come at
 * 1.4 times their rate, samples at 1.18 times.
 */
#define HEARTBEATS_AHEAD 10
#define HEARTBEATS_LEAK  8
#define SAMPLES_AHEAD    160
#define SAMPLES_LEAK     256
#define SURPLUS_MAX      10
#define ROOM             20.0 /* degrees Celsius */
#define SPREAD_PERIODS   5    /* parts of a sample are not further apart */
#define ROTARY_ALLOWANCE 20.0 /* rad/s, faster than hands start a joint from rest */
#define SLIDER_ALLOWANCE 5.0  /* m/s */

static uint64_t max_time(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

void can_monitor_init(struct can_monitor *monitor, const struct can_arm *arm, const struct can_settings *settings)
{
    memset(monitor, 0, sizeof *monitor);
    memset(monitor->index, 0xff, sizeof monitor->index);
    monitor->count = arm->joints;
    monitor->period_ns = (uint64_t)(1e9 / settings->rate);
    monitor->heartbeat_period_ns = (uint64_t)(1e9 * settings->heartbeat);
    monitor->silent_ns = (uint64_t)(1e9 * settings->silent);
    for (uint32_t i = 0; i < monitor->count; i++) {
        monitor->nodes[i].end = &arm->ends[i];
        monitor->nodes[i].node = (uint8_t)arm->ends[i].number;
        monitor->nodes[i].speed_allowance =
            (arm->is_slider[i] ? SLIDER_ALLOWANCE : ROTARY_ALLOWANCE) / fabs(arm->joint_per_turn[i]);
        if (!arm->ends[i].drive->answers)
            monitor->index[arm->ends[i].number] = (uint8_t)i;
    }
    can_monitor_forget(monitor);
}

void can_monitor_forget(struct can_monitor *monitor)
{
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct can_node remembered = { .end = monitor->nodes[i].end,
                                             .node = monitor->nodes[i].node,
                                             .generation = monitor->nodes[i].generation,
                                             .speed_allowance = monitor->nodes[i].speed_allowance };
        monitor->nodes[i] = remembered;
    }
    monitor->is_armed = monitor->has_confirmed = 0;
    monitor->failed_nodes = monitor->foreign_orders = monitor->dropped = 0;
    monitor->unconfirmed_ns = monitor->sample_ns = 0;
}

void can_monitor_restart_counts(struct can_monitor *monitor)
{
    for (uint32_t i = 0; i < monitor->count; i++)
        monitor->nodes[i].estimates = monitor->nodes[i].heartbeats = 0;
}

void can_monitor_set_status(struct can_monitor *monitor, uint32_t status, uint32_t reasons, uint32_t code)
{
    if (!monitor->is_armed)
        return;
    if (status < monitor->status) {
        monitor->status = status;
        monitor->code = code;
    }
    monitor->reasons |= reasons;
}

int can_node_is_on(const struct can_node *node)
{
    return node->end->drive->answers ? node->is_on : node->heartbeat.state == ODRIVE_STATE_CLOSED_LOOP;
}

int can_node_is_active(const struct can_node *node)
{
    if (node->end->drive->answers)
        return node->has_heartbeat && node->is_on && !node->fault;
    return node->has_heartbeat && node->heartbeat.state == ODRIVE_STATE_CLOSED_LOOP && !node->heartbeat.errors &&
           !node->heartbeat.failed;
}

/*
 * Check a cyclic message for two nodes with one number. *ahead_ns is by how much the messages are ahead of their
 * period. A message that was held up may catch up. A rate a little too high leaks away, by 1 / leak of *ahead_ns each
 * time. Two nodes with one number gain half a period each time, and so reach the limit.
 */
static void check_rate(struct can_monitor *monitor, const struct can_node *node, int64_t *ahead_ns, uint64_t elapsed_ns,
                       uint64_t period, int max_quarters, int leak)
{
    const int64_t limit = max_quarters * (int64_t)period / 4;
    *ahead_ns += (int64_t)period - (int64_t)elapsed_ns - *ahead_ns / leak;
    *ahead_ns = *ahead_ns > -limit ? *ahead_ns : -limit;
    if (*ahead_ns > limit) {
        *ahead_ns = 0;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_DUPLICATE, node->node));
    }
}

static void count_frame(struct can_monitor *monitor, struct can_node *node, uint64_t time)
{
    const uint64_t window = max_time(WINDOW, WINDOW_PERIODS * monitor->period_ns);
    if (++node->frames * monitor->period_ns > 4 * window)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_BABBLING, node->node));
    if (time - node->window_ns >= window) {
        node->window_ns = time;
        node->frames = 0;
    }
}

static uint32_t reasons_of(const struct can_node *node)
{
    uint32_t reasons = 0;
    for (unsigned word = 0; word < ODRIVE_ERROR_WORDS; word++)
        reasons |= odrive_reasons(word, node->errors[word]);
    return reasons;
}

static void take_heartbeat(struct can_monitor *monitor, struct can_node *node, const struct odrive_heartbeat *heartbeat,
                           uint64_t time)
{
    if (node->has_heartbeat)
        check_rate(monitor, node, &node->heartbeats_ahead_ns, time - node->heartbeat_ns, monitor->heartbeat_period_ns,
                   HEARTBEATS_AHEAD, HEARTBEATS_LEAK);
    node->heartbeat = *heartbeat;
    node->has_heartbeat = 1;
    node->heartbeat_ns = time;
    node->heartbeats++;
    node->errors[node->generation == ODRIVE_0_5 ? ODRIVE_AXIS_ERRORS : ODRIVE_ERRORS_0_6] = heartbeat->errors;
    if (heartbeat->failed)
        monitor->failed_nodes |= 1u << (node - monitor->nodes);
    if (!monitor->is_armed || can_node_is_active(node))
        return;
    const uint32_t reasons = reasons_of(node);
    if (reasons || heartbeat->failed)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, reasons ? reasons : DPT_REASON_DEVICE,
                               heartbeat->errors);
    else if (monitor->status == DPT_DEVICE_STATUS_READY) {
        monitor->counts.resets++;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_DEVICE,
                               CAN_CODE(CAN_CODE_RESTARTED, node->node));
    }
}

/*
 * Find a jump: a position that the motor cannot have reached since the last estimate, even if that was two periods
 * late.
 */
static void check_jump(struct can_monitor *monitor, const struct can_node *node, float position, float velocity,
                       int64_t elapsed_ns)
{
    const double seconds = 1e-9 * ((elapsed_ns > 0 ? (double)elapsed_ns : 0.0) + 2.0 * (double)monitor->period_ns);
    const double speed = node->speed_allowance + max_of(fabs((double)velocity), fabs((double)node->velocity));
    if (fabs((double)position - (double)node->position) > speed * seconds)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_UNCALIBRATED,
                               CAN_CODE(CAN_CODE_JUMPED, node->node));
}

/* If all nodes have sent an estimate since the last sample, and none is too old, the estimates are the next sample. */
static void complete_sample(struct can_monitor *monitor, uint64_t time)
{
    for (uint32_t i = 0; i < monitor->count; i++)
        if (!monitor->nodes[i].is_fresh ||
            (int64_t)(time - monitor->nodes[i].estimate_ns) > SPREAD_PERIODS * (int64_t)monitor->period_ns)
            return;
    for (uint32_t i = 0; i < monitor->count; i++) {
        monitor->position[i] = monitor->nodes[i].position;
        monitor->velocity[i] = monitor->nodes[i].velocity;
        monitor->nodes[i].is_fresh = 0;
    }
    if (!monitor->sample_ns)
        monitor->expected_ns = time - monitor->period_ns;
    /* Periods that passed, rounded. 0 if a late sample came together with the next one: then it was not lost. */
    const int64_t period = (int64_t)monitor->period_ns;
    const int64_t behind = (int64_t)(time - monitor->expected_ns);
    const int64_t elapsed_ns = behind > 0 ? (behind + period / 2) / period : 0;
    monitor->expected_ns += (uint64_t)(elapsed_ns * period);
    /* The nodes' clocks and ours drift apart: follow them slowly, so that jitter has little effect. */
    monitor->expected_ns += (uint64_t)((int64_t)(time - monitor->expected_ns) / 16);
    monitor->sample_ns = time > monitor->sample_ns ? time : monitor->sample_ns + 1;
    monitor->sequence += elapsed_ns > 0 ? (uint64_t)elapsed_ns : 1;
    monitor->counts.samples += (uint64_t)elapsed_ns;
    if (elapsed_ns > 0)
        monitor->counts.lost += (uint64_t)elapsed_ns - 1;
    else
        monitor->counts.lost -= monitor->counts.lost > 0;
}

static void remove_sent(struct can_node *node, uint32_t at)
{
    node->sent_count--;
    memmove(&node->sent[at], &node->sent[at + 1], (node->sent_count - at) * sizeof *node->sent);
}

/* Frames with other ids or data have other numbers, but for one pair in four thousand million. */
static uint32_t number_of(const struct can_message *message)
{
    uint32_t number = 2166136261u;
    for (int i = 0; i < 4; i++)
        number = (number ^ (message->id >> 8 * i & 0xff)) * 16777619u;
    for (int i = 0; i < message->size; i++)
        number = (number ^ message->data[i]) * 16777619u;
    return number;
}

/*
 * A torque of ours came back from the bus: match it with the first unconfirmed torque of the same bits. Equal torques
 * in a row cannot be told apart: it counts as late if it is late even for the last of them, and a lost one is left over
 * when the row ends.
 */
static void confirm_torque(struct can_monitor *monitor, struct can_node *node, const struct can_message *message)
{
    const uint32_t number = number_of(message);
    uint32_t at = 0;
    while (at < node->sent_count && node->sent[at].frame != number)
        at++;
    if (at == node->sent_count)
        return; /* it was counted as missed before */
    for (uint32_t i = 0; i < at; i++)
        node->sent[i].is_overtaken = 1;
    uint32_t last = at;
    while (last + 1 < node->sent_count && node->sent[last + 1].frame == number)
        last++;
    const int64_t late = (int64_t)(message->time_ns - node->sent[last].time_ns);
    monitor->counts.missed += node->sent[at].is_overtaken || late > (int64_t)(2 * monitor->period_ns);
    remove_sent(node, at);
}

/*
 * The node that a frame is of, to it or from it; NULL: none of ours. kind: what it says; DRIVE_OTHER of an ODrive, but for a
 * torque.
 */
static struct can_node *find_node(struct can_monitor *monitor, const struct can_message *message,
                                  struct drive_message *decoded)
{
    const int is_short = !(message->flags & (CAN_MESSAGE_EXTENDED | CAN_MESSAGE_FD));
    const uint8_t index = is_short ? monitor->index[message->id >> 5 & (ODRIVE_NODES - 1)] : 0xff;
    decoded->kind = DRIVE_OTHER;
    if (index != 0xff) {
        if ((message->id & 31) == ODRIVE_SET_TORQUE && !(message->flags & CAN_MESSAGE_REMOTE))
            decoded->kind = DRIVE_TORQUE;
        return &monitor->nodes[index];
    }
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct drive_node *end = monitor->nodes[i].end;
        if (end->drive->answers && end->drive->decode(end, message, decoded) != DRIVE_OTHER)
            return &monitor->nodes[i];
    }
    return NULL;
}

static void report_foreign_order(struct can_monitor *monitor, const struct can_node *node, int is_estop)
{
    monitor->foreign_orders++;
    can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, is_estop ? DPT_REASON_ESTOP : DPT_REASON_LINK,
                           CAN_CODE(CAN_CODE_FOREIGN_ORDER, node->node));
}

/* Take a word of error bits, which was requested or comes cyclically, and so before the next heartbeat. */
static void take_errors(struct can_monitor *monitor, struct can_node *node, unsigned word, uint64_t errors)
{
    node->errors[word] = errors;
    if (!errors)
        return;
    can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, odrive_reasons(word, errors), (uint32_t)errors);
    /* A heartbeat of 0.5 said only that there are errors. */
    monitor->code = monitor->code ? monitor->code : (uint32_t)errors;
}

static void take_address(struct can_monitor *monitor, struct can_node *node, uint64_t serial)
{
    if (node->serial && node->serial != serial) {
        node->is_duplicate = 1;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_DUPLICATE, node->node));
    }
    node->serial = serial;
}

static void take_estimates(struct can_monitor *monitor, struct can_node *node, float position, float velocity,
                           uint64_t time_ns)
{
    if (node->has_estimate) {
        const uint64_t elapsed_ns = time_ns - node->estimate_ns;
        if (!node->end->drive->answers)
            check_rate(monitor, node, &node->estimates_ahead_ns, elapsed_ns, monitor->period_ns, SAMPLES_AHEAD,
                       SAMPLES_LEAK);
        check_jump(monitor, node, position, velocity, (int64_t)elapsed_ns);
    }
    node->position = position;
    node->velocity = velocity;
    node->estimate_ns = time_ns;
    node->has_estimate = node->is_fresh = 1;
    if (node->estimates++ == 0)
        node->first_ns = time_ns;
    complete_sample(monitor, time_ns);
}

/* An answer more than there were commands: a few may be left over from before. */
static void count_answer(struct can_monitor *monitor, struct can_node *node)
{
    if (++node->surplus <= SURPLUS_MAX)
        return;
    node->surplus = 0;
    node->is_duplicate = 1;
    can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DUPLICATE, node->node));
}

static void take_fault(struct can_monitor *monitor, struct can_node *node, uint32_t fault)
{
    node->fault = fault;
    if (fault)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, drive_reasons(node->end->drive, fault), fault);
}

static void take_status(struct can_monitor *monitor, struct can_node *node, const struct drive_status *status,
                        uint64_t time)
{
    node->has_heartbeat = 1;
    node->heartbeat_ns = time;
    node->is_on = status->is_on;
    node->temperature = status->temperature;
    take_fault(monitor, node, status->fault);
    if (node->end->heat_limit > 0.0 && (double)status->temperature >= node->end->heat_limit)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_OVERHEATED,
                               CAN_CODE(CAN_CODE_HOT, node->node));
    if (monitor->is_armed && !status->is_on && monitor->status == DPT_DEVICE_STATUS_READY) {
        monitor->counts.resets++;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_DEVICE,
                               CAN_CODE(CAN_CODE_RESTARTED, node->node));
    }
    take_estimates(monitor, node, status->position, status->velocity, time);
}

/* A frame of a drive that answers. */
static void take_answer(struct can_monitor *monitor, struct can_node *node, const struct drive_message *decoded,
                        uint64_t time)
{
    switch (decoded->kind) {
    case DRIVE_STATUS:
        count_answer(monitor, node);
        take_status(monitor, node, &decoded->as.status, time);
        break;
    case DRIVE_FAULT:
        take_fault(monitor, node, decoded->as.fault);
        break;
    case DRIVE_VALUE:
        count_answer(monitor, node);
        node->value[decoded->parameter] = decoded->as.value;
        node->known_values |= 1u << decoded->parameter;
        break;
    case DRIVE_DAMAGED:
        monitor->counts.damaged++;
        break;
    case DRIVE_ASK:
    case DRIVE_READ:
        break; /* whoever asks does no harm */
    default:
        report_foreign_order(monitor, node, decoded->kind == DRIVE_STOP);
        break;
    }
}

double can_monitor_temperature(const struct can_monitor *monitor)
{
    double hottest = -1.0;
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct can_node *node = &monitor->nodes[i];
        if (node->end->heat_limit > ROOM && node->end->drive->answers && node->has_heartbeat)
            hottest = max_of(hottest, max_of(((double)node->temperature - ROOM) / (node->end->heat_limit - ROOM), 0.0));
    }
    return hottest;
}

void can_monitor_take(struct can_monitor *monitor, const struct can_message *message)
{
    struct odrive_message decoded;
    struct drive_message said;
    struct can_node *node = find_node(monitor, message, &said);
    if (!node)
        return;
    if (message->flags & CAN_MESSAGE_OWN) {
        monitor->unconfirmed_ns = 0;
        monitor->has_confirmed = 1;
        if (said.kind == DRIVE_TORQUE)
            confirm_torque(monitor, node, message);
        return;
    }
    count_frame(monitor, node, message->time_ns);
    if (message->flags & CAN_MESSAGE_REMOTE)
        return;
    if (node->end->drive->answers) {
        take_answer(monitor, node, &said, message->time_ns);
        return;
    }
    if (odrive_is_control(message->id & 31)) {
        report_foreign_order(monitor, node, (message->id & 31) == ODRIVE_ESTOP);
        return;
    }
    const int kind = odrive_decode(message, node->generation, &decoded);
    monitor->counts.damaged += kind == ODRIVE_DAMAGED;
    if (kind != ODRIVE_MESSAGE)
        return;
    switch (decoded.command) {
    case ODRIVE_VERSION:
        node->proven_generation = ODRIVE_0_6;
        if (node->generation == ODRIVE_ANY)
            node->generation = ODRIVE_0_6;
        break;
    case ODRIVE_HEARTBEAT:
        if (odrive_heartbeat_generation(message) != ODRIVE_ANY)
            node->proven_generation = (uint8_t)odrive_heartbeat_generation(message);
        if (node->generation == ODRIVE_ANY)
            node->generation = node->proven_generation;
        odrive_decode(message, node->generation, &decoded);
        take_heartbeat(monitor, node, &decoded.as.heartbeat, message->time_ns);
        break;
    case ODRIVE_ERROR:
        take_errors(monitor, node, node->generation == ODRIVE_0_5 ? ODRIVE_MOTOR_ERRORS : ODRIVE_ERRORS_0_6,
                    decoded.as.error.active);
        break;
    case ODRIVE_ENCODER_ERROR:
        take_errors(monitor, node, ODRIVE_ENCODER_ERRORS, decoded.as.error.active);
        break;
    case ODRIVE_CONTROLLER_ERROR:
        take_errors(monitor, node, ODRIVE_CONTROLLER_ERRORS, decoded.as.error.active);
        break;
    case ODRIVE_ADDRESS:
        take_address(monitor, node, decoded.as.address.serial);
        break;
    case ODRIVE_ESTIMATES:
        take_estimates(monitor, node, decoded.as.estimates.position, decoded.as.estimates.velocity, message->time_ns);
        break;
    default:
        break;
    }
}

void can_monitor_note_sent(struct can_monitor *monitor, const struct can_message *frame, uint64_t now)
{
    struct drive_message said;
    struct can_node *node = find_node(monitor, frame, &said);
    if (node && node->surplus > -SURPLUS_MAX)
        node->surplus--;
    if (!node || said.kind != DRIVE_TORQUE)
        return;
    if (node->sent_count == CAN_SENT_MAX) {
        monitor->counts.missed++;
        remove_sent(node, 0);
    }
    struct can_sent *sent = &node->sent[node->sent_count++];
    sent->frame = number_of(frame);
    sent->time_ns = now;
    sent->is_overtaken = 0;
}

void can_monitor_note_attempt(struct can_monitor *monitor, uint64_t now)
{
    if (!monitor->unconfirmed_ns)
        monitor->unconfirmed_ns = now;
}

void can_monitor_check(struct can_monitor *monitor, uint64_t now, int is_drained)
{
    const uint64_t give_up = max_time(LOST_AFTER, 5 * monitor->period_ns);
    if (!is_drained)
        return;
    for (uint32_t i = 0; i < monitor->count; i++) {
        struct can_node *node = &monitor->nodes[i];
        while (node->sent_count && (int64_t)(now - node->sent[0].time_ns) > (int64_t)give_up) {
            monitor->counts.missed++;
            remove_sent(node, 0);
        }
        if ((int64_t)(now - node->estimate_ns) > (int64_t)monitor->silent_ns)
            can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT,
                                   CAN_CODE(CAN_CODE_NO_ESTIMATE, node->node));
        if ((int64_t)(now - node->heartbeat_ns) > (int64_t)(5 * monitor->heartbeat_period_ns))
            can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT,
                                   CAN_CODE(CAN_CODE_NO_HEARTBEAT, node->node));
    }
    if (monitor->unconfirmed_ns && (int64_t)(now - monitor->unconfirmed_ns) > (int64_t)monitor->silent_ns)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_STUCK, CAN_CODE_BUS));
}

void can_node_describe(const struct can_node *node, char *text, size_t size)
{
    static const char *const part[ODRIVE_ERROR_WORDS] = { "", "", "motor ", "encoder ", "controller " };
    if (node->end->drive->answers) {
        const char *fault = drive_fault_name(node->end->drive, node->fault);
        snprintf(text, size, "node %u: %s%s%s", node->node, node->is_on ? "on" : "off", fault ? ", " : "",
                 fault ? fault : "");
        return;
    }
    size_t used = (size_t)snprintf(text, size, "node %u: %s", node->node, odrive_state_name(node->heartbeat.state));
    for (unsigned word = 0; word < ODRIVE_ERROR_WORDS; word++)
        for (uint64_t left = node->errors[word]; left && used < size; left &= left - 1)
            used += (size_t)snprintf(text + used, size - used, ", %s%s", part[word], odrive_error_name(word, left));
}
