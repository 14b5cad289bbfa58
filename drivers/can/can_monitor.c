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
/* How far ahead, in quarters of a period, and how quickly it leaks: 1.4 of the heartbeats' rate pass, 1.18 of the samples'. */
#define BEATS_AHEAD   10
#define BEATS_LEAK    8
#define SAMPLES_AHEAD 160
#define SAMPLES_LEAK  256
#define OLD_PERIODS   5    /* parts of a sample are not further apart */
#define TURNS_AT      20.0 /* rad/s, faster than hands start a joint from rest */
#define SLIDES_AT     5.0  /* m/s */

static uint64_t larger_time(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

void can_monitor_init(struct can_monitor *monitor, const struct can_arm *arm,
                      const struct can_settings *settings)
{
    memset(monitor, 0, sizeof *monitor);
    memset(monitor->index, 0xff, sizeof monitor->index);
    monitor->count = arm->joints;
    monitor->period_ns = (uint64_t)(1e9 / settings->rate);
    monitor->heartbeat_ns = (uint64_t)(1e9 * settings->heartbeat);
    monitor->silent_ns = (uint64_t)(1e9 * settings->silent);
    for (uint32_t i = 0; i < monitor->count; i++) {
        monitor->at[i].node = arm->nodes[i];
        monitor->at[i].quickest = (arm->slides[i] ? SLIDES_AT : TURNS_AT) / fabs(arm->per_turn[i]);
        monitor->index[arm->nodes[i]] = (uint8_t)i;
    }
    can_monitor_forget(monitor);
}

void can_monitor_forget(struct can_monitor *monitor)
{
    for (uint32_t i = 0; i < monitor->count; i++) {
        const struct can_node kept = { .node = monitor->at[i].node,
                                       .generation = monitor->at[i].generation,
                                       .quickest = monitor->at[i].quickest };
        monitor->at[i] = kept;
    }
    monitor->is_armed = monitor->has_confirmed = 0;
    monitor->parts = monitor->strangers = monitor->dropped = 0;
    monitor->waiting_ns = monitor->sample_ns = 0;
}

void can_monitor_restart_counts(struct can_monitor *monitor)
{
    for (uint32_t i = 0; i < monitor->count; i++)
        monitor->at[i].seen = monitor->at[i].pulses = 0;
}

void can_monitor_set_status(struct can_monitor *monitor, uint32_t status, uint32_t reasons,
                            uint32_t code)
{
    if (!monitor->is_armed)
        return;
    if (status < monitor->status) {
        monitor->status = status;
        monitor->code = code;
    }
    monitor->reasons |= reasons;
}

int can_node_is_active(const struct can_node *node)
{
    return node->has_beaten && node->beat.state == ODRIVE_STATE_CLOSED_LOOP && !node->beat.errors &&
           !node->beat.failed;
}

/*
 * By how much a cyclic message is ahead of the clock. What stood still may catch up; what is a little too quick leaks away,
 * 1 / leak each time; two nodes of one number gain half a period each time.
 */
static void run_ahead(struct can_monitor *monitor, const struct can_node *node, int64_t *ahead,
                      uint64_t passed, uint64_t period, int most, int leak)
{
    const int64_t limit = most * (int64_t)period / 4;
    *ahead += (int64_t)period - (int64_t)passed - *ahead / leak;
    *ahead = *ahead > -limit ? *ahead : -limit;
    if (*ahead > limit) {
        *ahead = 0;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_DUPLICATE, node->node));
    }
}

static void count_frame(struct can_monitor *monitor, struct can_node *node, uint64_t time)
{
    const uint64_t window = larger_time(WINDOW, WINDOW_PERIODS * monitor->period_ns);
    if (++node->frames * monitor->period_ns > 4 * window)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_BABBLES, node->node));
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

static void take_beat(struct can_monitor *monitor, struct can_node *node,
                      const struct odrive_heartbeat *beat, uint64_t time)
{
    if (node->has_beaten)
        run_ahead(monitor, node, &node->beats_ahead, time - node->beat_ns, monitor->heartbeat_ns,
                  BEATS_AHEAD, BEATS_LEAK);
    node->beat = *beat;
    node->has_beaten = 1;
    node->beat_ns = time;
    node->pulses++;
    node->errors[node->generation == ODRIVE_0_5 ? ODRIVE_AXIS_ERRORS : ODRIVE_ERRORS_0_6] =
        beat->errors;
    if (beat->failed)
        monitor->parts |= 1u << (node - monitor->at);
    if (!monitor->is_armed || can_node_is_active(node))
        return;
    const uint32_t reasons = reasons_of(node);
    if (reasons || beat->failed)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT,
                               reasons ? reasons : DPT_REASON_DEVICE, beat->errors);
    else if (monitor->status == DPT_DEVICE_STATUS_READY) {
        monitor->counts.resets++;
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_DEVICE,
                               CAN_CODE(CAN_CODE_BEGAN, node->node));
    }
}

/* A place that it cannot have come to since the last one, which may have been late by two periods. */
static void find_jump(struct can_monitor *monitor, const struct can_node *node, float position,
                      float velocity, int64_t passed)
{
    const double seconds =
        1e-9 * ((passed > 0 ? (double)passed : 0.0) + 2.0 * (double)monitor->period_ns);
    const double speed =
        node->quickest + max_of(fabs((double)velocity), fabs((double)node->velocity));
    if (fabs((double)position - (double)node->position) > speed * seconds)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_UNCALIBRATED,
                               CAN_CODE(CAN_CODE_JUMPED, node->node));
}

/* All nodes have said where they are since the last sample, and lately: the next one. */
static void take_sample(struct can_monitor *monitor, uint64_t time)
{
    for (uint32_t i = 0; i < monitor->count; i++)
        if (!monitor->at[i].is_fresh || (int64_t)(time - monitor->at[i].estimate_ns) >
                                            OLD_PERIODS * (int64_t)monitor->period_ns)
            return;
    for (uint32_t i = 0; i < monitor->count; i++) {
        monitor->position[i] = monitor->at[i].position;
        monitor->velocity[i] = monitor->at[i].velocity;
        monitor->at[i].is_fresh = 0;
    }
    if (!monitor->sample_ns)
        monitor->expected_ns = time - monitor->period_ns;
    /* Periods, to the nearest; none when what had been late came with the next one: then it was not lost. */
    const int64_t period = (int64_t)monitor->period_ns;
    const int64_t behind = (int64_t)(time - monitor->expected_ns);
    const int64_t passed = behind > 0 ? (behind + period / 2) / period : 0;
    monitor->expected_ns += (uint64_t)(passed * period);
    /* The nodes' clocks and ours drift apart: follow them slowly, so that jitter does not count. */
    monitor->expected_ns += (uint64_t)((int64_t)(time - monitor->expected_ns) / 16);
    monitor->sample_ns = time > monitor->sample_ns ? time : monitor->sample_ns + 1;
    monitor->sequence += passed > 0 ? (uint64_t)passed : 1;
    monitor->counts.samples += (uint64_t)passed;
    if (passed > 0)
        monitor->counts.lost += (uint64_t)passed - 1;
    else
        monitor->counts.lost -= monitor->counts.lost > 0;
}

static void forget_sent(struct can_node *node, uint32_t at)
{
    node->sent_count--;
    memmove(&node->sent[at], &node->sent[at + 1], (node->sent_count - at) * sizeof *node->sent);
}

/*
 * A torque of ours was on the bus: the first of its bits that is under way. Of equal ones in a row any may have come: it is late
 * when it is so for the last of them, and one that is lost stays over when the row ends.
 */
static void confirm(struct can_monitor *monitor, struct can_node *node,
                    const struct can_message *message)
{
    const uint32_t bits = (uint32_t)message->data[0] | (uint32_t)message->data[1] << 8 |
                          (uint32_t)message->data[2] << 16 | (uint32_t)message->data[3] << 24;
    uint32_t at = 0;
    while (at < node->sent_count && node->sent[at].bits != bits)
        at++;
    if (at == node->sent_count)
        return; /* given up before */
    for (uint32_t i = 0; i < at; i++)
        node->sent[i].is_overtaken = 1;
    uint32_t last = at;
    while (last + 1 < node->sent_count && node->sent[last + 1].bits == bits)
        last++;
    const int64_t late = (int64_t)(message->time_ns - node->sent[last].time_ns);
    monitor->counts.missed +=
        node->sent[at].is_overtaken || late > (int64_t)(2 * monitor->period_ns);
    forget_sent(node, at);
}

static void take_own(struct can_monitor *monitor, struct can_node *node,
                     const struct can_message *message)
{
    monitor->waiting_ns = 0;
    monitor->has_confirmed = 1;
    if ((message->id & 31) == ODRIVE_SET_TORQUE && !(message->flags & CAN_MESSAGE_REMOTE))
        confirm(monitor, node, message);
}

static void take_order(struct can_monitor *monitor, const struct can_node *node, unsigned command)
{
    monitor->strangers++;
    can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT,
                           command == ODRIVE_ESTOP ? DPT_REASON_ESTOP : DPT_REASON_LINK,
                           CAN_CODE(CAN_CODE_STRANGER, node->node));
}

/* Asked for, or cyclic: then they are here before the next heartbeat. */
static void take_errors(struct can_monitor *monitor, struct can_node *node, unsigned word,
                        uint64_t errors)
{
    node->errors[word] = errors;
    if (!errors)
        return;
    can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, odrive_reasons(word, errors),
                           (uint32_t)errors);
    /* Of 0.5 the heartbeat had only that there are some. */
    monitor->code = monitor->code ? monitor->code : (uint32_t)errors;
}

void can_monitor_take(struct can_monitor *monitor, const struct can_message *message)
{
    struct odrive_message said;
    const uint8_t index = monitor->index[message->id >> 5 & (ODRIVE_NODES - 1)];
    if (index == 0xff)
        return;
    struct can_node *node = &monitor->at[index];
    if (message->flags & CAN_MESSAGE_OWN) {
        take_own(monitor, node, message);
        return;
    }
    count_frame(monitor, node, message->time_ns);
    if (message->flags & CAN_MESSAGE_REMOTE)
        return;
    if (odrive_is_order(message->id & 31)) {
        take_order(monitor, node, message->id & 31);
        return;
    }
    const int is = odrive_decode(message, node->generation, &said);
    monitor->counts.damaged += is == ODRIVE_DAMAGED;
    if (is != ODRIVE_MESSAGE)
        return;
    switch (said.command) {
    case ODRIVE_VERSION:
        node->told = ODRIVE_0_6;
        if (node->generation == ODRIVE_ANY)
            node->generation = ODRIVE_0_6;
        break;
    case ODRIVE_HEARTBEAT:
        if (odrive_heartbeat_of(message) != ODRIVE_ANY)
            node->told = (uint8_t)odrive_heartbeat_of(message);
        if (node->generation == ODRIVE_ANY)
            node->generation = node->told;
        odrive_decode(message, node->generation, &said);
        take_beat(monitor, node, &said.as.heartbeat, message->time_ns);
        break;
    case ODRIVE_ERROR:
        take_errors(monitor, node,
                    node->generation == ODRIVE_0_5 ? ODRIVE_MOTOR_ERRORS : ODRIVE_ERRORS_0_6,
                    said.as.error.active);
        break;
    case ODRIVE_ENCODER_ERROR:
        take_errors(monitor, node, ODRIVE_ENCODER_ERRORS, said.as.error.active);
        break;
    case ODRIVE_CONTROLLER_ERROR:
        take_errors(monitor, node, ODRIVE_CONTROLLER_ERRORS, said.as.error.active);
        break;
    case ODRIVE_ADDRESS:
        if (node->serial && node->serial != said.as.address.serial) {
            node->is_doubtful = 1;
            can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                                   CAN_CODE(CAN_CODE_DUPLICATE, node->node));
        }
        node->serial = said.as.address.serial;
        break;
    case ODRIVE_ESTIMATES:
        if (node->has_estimate) {
            const uint64_t passed = message->time_ns - node->estimate_ns;
            run_ahead(monitor, node, &node->ahead, passed, monitor->period_ns, SAMPLES_AHEAD,
                      SAMPLES_LEAK);
            find_jump(monitor, node, said.as.estimates.position, said.as.estimates.velocity,
                      (int64_t)passed);
        }
        node->position = said.as.estimates.position;
        node->velocity = said.as.estimates.velocity;
        node->estimate_ns = message->time_ns;
        node->has_estimate = node->is_fresh = 1;
        if (node->seen++ == 0)
            node->first_ns = message->time_ns;
        take_sample(monitor, message->time_ns);
        break;
    default:
        break;
    }
}

void can_monitor_note_sent(struct can_monitor *monitor, uint32_t index, float torque, uint64_t now)
{
    struct can_node *node = &monitor->at[index];
    if (node->sent_count == CAN_SENT_MAX) {
        monitor->counts.missed++;
        forget_sent(node, 0);
    }
    struct can_sent *sent = &node->sent[node->sent_count++];
    memcpy(&sent->bits, &torque, 4);
    sent->time_ns = now;
    sent->is_overtaken = 0;
}

void can_monitor_note_tried(struct can_monitor *monitor, uint64_t now)
{
    if (!monitor->waiting_ns)
        monitor->waiting_ns = now;
}

void can_monitor_check(struct can_monitor *monitor, uint64_t now, int is_all)
{
    const uint64_t give_up = larger_time(LOST_AFTER, 5 * monitor->period_ns);
    if (!is_all)
        return;
    for (uint32_t i = 0; i < monitor->count; i++) {
        struct can_node *node = &monitor->at[i];
        while (node->sent_count && (int64_t)(now - node->sent[0].time_ns) > (int64_t)give_up) {
            monitor->counts.missed++;
            forget_sent(node, 0);
        }
        if ((int64_t)(now - node->estimate_ns) > (int64_t)monitor->silent_ns)
            can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT,
                                   CAN_CODE(CAN_CODE_SILENT, node->node));
        if ((int64_t)(now - node->beat_ns) > (int64_t)(5 * monitor->heartbeat_ns))
            can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_SILENT,
                                   CAN_CODE(CAN_CODE_PULSELESS, node->node));
    }
    if (monitor->waiting_ns && (int64_t)(now - monitor->waiting_ns) > (int64_t)monitor->silent_ns)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_STUCK, CAN_CODE_BUS));
}

void can_node_describe(const struct can_node *node, char *text, size_t size)
{
    static const char *const part[ODRIVE_ERROR_WORDS] = { "", "", "motor ", "encoder ",
                                                          "controller " };
    size_t used = (size_t)snprintf(text, size, "node %u: %s", node->node,
                                   odrive_state_name(node->beat.state));
    for (unsigned word = 0; word < ODRIVE_ERROR_WORDS; word++)
        for (uint64_t left = node->errors[word]; left && used < size; left &= left - 1)
            used += (size_t)snprintf(text + used, size - used, ", %s%s", part[word],
                                     odrive_error_name(word, left));
}
