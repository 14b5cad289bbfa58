/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/can_session.h"

#include <string.h>

#include "clock.h"
#include "settings.h"

#define MS           1000000u
#define ASK_EVERY    (100u * MS)
#define SETTLE       (200u * MS) /* for an answer to Get_Version, which 0.5 does not give */
#define FEED_EVERY   (2u * MS)   /* while motors are switched on: controllers' watchdogs may run */
#define SWITCH_EVERY (100u * MS)
#define SWITCH_IN    (2000u * MS)
#define RECEIVES     4

void can_host_say(struct can_host *host, uint32_t index, struct odrive_message message)
{
    const struct can_node *node = &host->nodes.at[index];
    message.node = node->node;
    if (host->count < CAN_LINE_BATCH &&
        odrive_encode(&message, node->generation, &host->out[host->count]))
        host->count++;
}

void can_host_say_all(struct can_host *host, struct odrive_message message)
{
    for (uint32_t i = 0; i < host->nodes.count; i++)
        can_host_say(host, i, message);
}

const struct odrive_message can_no_torque = { .command = ODRIVE_SET_TORQUE },
                            can_estop = { .command = ODRIVE_ESTOP },
                            can_idle = { .command = ODRIVE_SET_STATE,
                                         .as.state = ODRIVE_STATE_IDLE },
                            can_where = { .command = ODRIVE_ESTIMATES, .asks = 1 };

int can_host_send(struct can_host *host)
{
    const int count = host->count;
    if (count == 0)
        return 1;
    host->count = 0;
    const uint64_t now = clock_now();
    can_nodes_tried(&host->nodes, now);
    const int sent = can_line_send(&host->line, host->out, count);
    for (int i = 0; i < sent; i++) {
        struct odrive_message said;
        if (odrive_decode(&host->out[i], ODRIVE_ANY, &said) == ODRIVE_MESSAGE &&
            said.command == ODRIVE_SET_TORQUE)
            can_nodes_sent(&host->nodes, host->nodes.index[said.node], said.as.torque, now);
    }
    return sent == count;
}

void can_host_look(struct can_host *host)
{
    const struct can_line *line = &host->line;
    struct can_nodes *nodes = &host->nodes;
    const uint32_t dropped = line->dropped + line->overruns;
    if (line->is_gone)
        can_nodes_blame(nodes, DPT_DEVICE_STATUS_LOST, DPT_REASON_UNPLUGGED,
                        CAN_CODE(CAN_CODE_GONE, CAN_CODE_BUS));
    if (line->is_down)
        can_nodes_blame(nodes, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK,
                        CAN_CODE(CAN_CODE_DOWN, CAN_CODE_BUS));
    if (line->is_off)
        can_nodes_blame(nodes, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK,
                        CAN_CODE(CAN_CODE_OFF, CAN_CODE_BUS));
    if (line->is_passive)
        can_nodes_blame(nodes, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                        CAN_CODE(CAN_CODE_PASSIVE, CAN_CODE_BUS));
    if (dropped != host->dropped)
        can_nodes_blame(nodes, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                        CAN_CODE(CAN_CODE_DROPPED, CAN_CODE_BUS));
    host->dropped = dropped;
}

int can_host_pump(struct can_host *host)
{
    int calls = 0;
    do {
        const int count = can_line_receive(&host->line, host->in);
        for (int k = 0; k < count; k++)
            can_nodes_take(&host->nodes, &host->in[k]);
    } while (!host->line.is_empty && ++calls < RECEIVES);
    can_host_look(host);
    return host->line.is_empty;
}

int can_host_is_dead(const struct can_host *host)
{
    return host->line.is_gone || host->line.is_down || host->line.is_off;
}

void can_host_wait(struct can_host *host, uint64_t deadline)
{
    do {
        can_line_wait(&host->line, deadline);
        can_host_pump(host);
    } while (clock_now() < deadline && !can_host_is_dead(host));
}

static const char *line_trouble(const struct can_host *host)
{
    return host->line.is_gone   ? "it went away"
           : host->line.is_down ? "it was shut down"
           : host->line.is_off  ? "the bus is off: too many errors, look at wires, ends (120 Ohm) "
                                  "and bit rate"
           : host->line.is_passive ? "the bus has many errors: look at wires, ends (120 Ohm) and "
                                     "bit rate"
                                   : NULL;
}

/*
 * Frames of 11-bit ids take 47 bits and 8 for each byte, and 1 for every 4 of the first 34 and the data's where the worst is
 * stuffed: 135 for 8 bytes, 95 for 4, 55 for none.
 */
static dpt_result check_load(const struct can_host *host, dpt_device_error *error)
{
    const double bits = 135.0 + 95.0 + (host->settings.request != 0.0 ? 55.0 : 0.0);
    const double needed = bits * host->settings.rate * host->arm.joints;
    if (host->line.bitrate == 0 || needed <= (double)host->line.bitrate)
        return DPT_OK;
    return device_error(error, DPT_E_SETTING,
                        "%.20s has %u bit/s, and %u joints at %g Hz need up to %.0f: set a higher "
                        "bit rate (1000000) there and at the controllers, or a lower ?rate=",
                        host->settings.interface, (unsigned)host->line.bitrate,
                        (unsigned)host->arm.joints, host->settings.rate, needed);
}

static dpt_result refuse_silence(const struct can_host *host, dpt_device_error *error)
{
    const char *name = host->settings.interface, *trouble = line_trouble(host);
    if (trouble)
        return device_error(error, DPT_E_DEVICE, "%.20s: %s", name, trouble);
    if (!host->nodes.has_confirmed)
        return device_error(error, DPT_E_DEVICE,
                            "nobody on %.20s acknowledges: are the controllers powered and wired, "
                            "both ends terminated (120 Ohm), all at the same bit rate?",
                            name);
    for (uint32_t i = 0; i < host->nodes.count; i++) {
        const struct can_node *node = &host->nodes.at[i];
        if (node->has_estimate && !node->has_beaten)
            return device_error(error, DPT_E_DEVICE,
                                "node %u answers but has no heartbeat: set axis.config.can."
                                "heartbeat_rate_ms (0.5) or heartbeat_msg_rate_ms (0.6) to 100",
                                node->node);
        if (!node->has_beaten)
            return device_error(error, DPT_E_DEVICE,
                                "no node %u on %.20s within %g s: is it powered, and is its "
                                "axis.config.can.node_id %u? Joints' nodes are set by ?nodes=",
                                node->node, name, host->settings.answer, node->node);
    }
    return device_error(error, DPT_E_DEVICE, "%.20s: no whole sample came", name);
}

/* 0.6 answers when it is asked for its version, 0.5 does not; heartbeats of some contents tell, too. */
static void find_generation(struct can_host *host, struct can_node *node, uint64_t heard)
{
    if (node->generation != ODRIVE_ANY)
        return;
    if (strcmp(host->settings.firmware, "auto"))
        node->generation = host->settings.firmware[2] == '5' ? ODRIVE_0_5 : ODRIVE_0_6;
    else if (node->has_beaten && clock_now() - heard > SETTLE)
        node->generation = ODRIVE_0_5;
}

/* Each node is heard, and known for what it is. */
static dpt_result meet(struct can_host *host, dpt_device_error *error)
{
    const uint64_t start = clock_now();
    const uint64_t deadline = start + (uint64_t)(1e9 * host->settings.answer);
    uint64_t heard[DPT_JOINTS_MAX] = { 0 }; /* first, and so can have been asked since */
    uint64_t next = start, now = start;
    uint32_t met = 0;
    while (met < host->nodes.count && !can_host_is_dead(host)) {
        if ((now = clock_now()) >= deadline)
            return refuse_silence(host, error);
        met = 0;
        for (uint32_t i = 0; i < host->nodes.count; i++) {
            struct can_node *node = &host->nodes.at[i];
            heard[i] = node->has_beaten && !heard[i] ? now : heard[i];
            find_generation(host, node, heard[i]);
            met += node->has_beaten && node->generation != ODRIVE_ANY;
            if (now < next)
                continue;
            const struct odrive_message version = { .command = ODRIVE_VERSION, .asks = 1 };
            if (node->told == ODRIVE_ANY)
                can_host_say(host, i, version);
            can_host_say(host, i, can_where);
        }
        next = now >= next ? now + ASK_EVERY : next;
        can_host_send(host);
        if (met < host->nodes.count)
            can_host_wait(host, now + 5 * MS);
    }
    return can_host_is_dead(host) ? refuse_silence(host, error) : DPT_OK;
}

/* Each node is what it was taken for, says where it is as often as it should, and is there once. */
static dpt_result check_nodes(const struct can_host *host, uint32_t asked, dpt_device_error *error)
{
    const double rate = host->settings.rate;
    for (uint32_t i = 0; i < host->nodes.count; i++) {
        const struct can_node *node = &host->nodes.at[i];
        if (node->told != ODRIVE_ANY && node->told != node->generation)
            return device_error(error, DPT_E_PROTOCOL,
                                "node %u has firmware 0.%u: leave ?firmware= away", node->node,
                                node->told);
        const double seconds = 1e-9 * (double)(node->estimate_ns - node->first_ns);
        const double heard = node->seen > 1 && seconds > 0.0 ? (node->seen - 1) / seconds : 0.0;
        const double beats = (double)node->pulses;
        const double expected =
            1.0 + 1e-9 * (double)(clock_now() - host->asked_ns) / host->settings.heartbeat;
        if (node->is_doubtful || beats > 1.4 * expected)
            return device_error(error, DPT_E_DEVICE,
                                "there are two controllers with the number %u: give each its own "
                                "axis.config.can.node_id (or their heartbeat is not every %g s: "
                                "?heartbeat=)",
                                node->node, host->settings.heartbeat);
        if (beats < 0.45 * expected)
            return device_error(error, DPT_E_DEVICE,
                                "node %u has a heartbeat less often than every %g s: set axis."
                                "config.can.heartbeat_rate_ms (0.5) or heartbeat_msg_rate_ms (0.6) "
                                "to %.3g, or ?heartbeat=",
                                node->node, host->settings.heartbeat,
                                1000.0 * host->settings.heartbeat);
        if (host->settings.request != 0.0 && (double)node->seen > 1.15 * asked + 2.0)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %u times, asked %u times: two "
                                "controllers have that number, or it does so by itself and "
                                "?request=1 is needless",
                                node->node, (unsigned)node->seen, (unsigned)asked);
        if (host->settings.request != 0.0 && 5 * node->seen < 4 * asked)
            return device_error(error, DPT_E_DEVICE,
                                "node %u answers %u of %u requests: the bus or the adapter is too "
                                "slow for ?rate=%g",
                                node->node, (unsigned)node->seen, (unsigned)asked, rate);
        if (host->settings.request == 0.0 && heard < 0.8 * rate)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %.0f times a second, not %g: set axis."
                                "config.can.encoder_rate_ms (0.5) or encoder_msg_rate_ms (0.6) to "
                                "%.3g, or ask each time: ?request=1, or be content: ?rate=",
                                node->node, heard, rate, 1000.0 / rate);
        if (host->settings.request == 0.0 && heard > 1.15 * rate)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %.0f times a second, not %g: two "
                                "controllers have that number, or ?rate= is more",
                                node->node, heard, rate);
    }
    return host->nodes.strangers == 0
               ? DPT_OK
               : device_error(error, DPT_E_DEVICE,
                              "someone else on %.20s gives our controllers orders: end that "
                              "program first",
                              host->settings.interface);
}

static double most(double a, double b)
{
    return a > b ? a : b;
}

static dpt_result listen_to(struct can_host *host, dpt_device_error *error)
{
    const double seconds =
        most(0.3, most(3.2 * host->settings.heartbeat, 30.0 / host->settings.rate));
    const struct odrive_message address = { .command = ODRIVE_ADDRESS, .asks = 1 };
    uint32_t asked = 0;
    can_host_pump(host);
    can_nodes_count(&host->nodes);
    host->nodes.strangers = 0;
    host->asked_ns = clock_now();
    /* On 0.5 the same id would set the node's number: what the setting says is no proof. */
    for (uint32_t i = 0; i < host->nodes.count; i++)
        if (host->nodes.at[i].told == ODRIVE_0_6)
            can_host_say(host, i, address);
    can_host_send(host);
    const uint64_t deadline = host->asked_ns + (uint64_t)(1e9 * seconds);
    for (uint64_t now; (now = clock_now()) < deadline && !can_host_is_dead(host);) {
        if (host->settings.request != 0.0) {
            can_host_say_all(host, can_where);
            asked += can_host_send(host) != 0;
        }
        can_host_wait(host, now + host->nodes.period_ns);
    }
    return can_host_is_dead(host) ? refuse_silence(host, error) : check_nodes(host, asked, error);
}

static dpt_result refuse_switch(const struct can_host *host, dpt_device_error *error)
{
    char text[160] = "";
    const char *trouble = line_trouble(host);
    if (trouble)
        return device_error(error, DPT_E_DEVICE, "%.20s: %s", host->settings.interface, trouble);
    for (uint32_t i = 0; i < host->nodes.count && !text[0]; i++)
        if (!can_node_is_active(&host->nodes.at[i]))
            can_node_describe(&host->nodes.at[i], text, sizeof text);
    return device_error(error, DPT_E_NOT_READY,
                        "%s, where closed loop is needed: calibrate it, and end the cause of "
                        "errors",
                        text);
}

/* Errors cleared, torque control, closed loop, and each node's own word for it. */
dpt_result can_host_switch_on(struct can_host *host, dpt_device_error *error)
{
    const struct odrive_message clear = { .command = ODRIVE_CLEAR_ERRORS },
                                mode = { .command = ODRIVE_SET_MODE,
                                         .as.mode = { ODRIVE_CONTROL_TORQUE,
                                                      ODRIVE_INPUT_PASSTHROUGH } },
                                loop = { .command = ODRIVE_SET_STATE,
                                         .as.state = ODRIVE_STATE_CLOSED_LOOP };
    struct can_nodes *nodes = &host->nodes;
    const uint64_t start = clock_now(), deadline = start + SWITCH_IN;
    uint64_t next[DPT_JOINTS_MAX], now = start;
    uint32_t active = 0;
    nodes->parts = 0;
    for (uint32_t i = 0; i < nodes->count; i++) {
        next[i] = start;
        nodes->at[i].has_beaten = nodes->at[i].is_fresh = 0;
        memset(nodes->at[i].errors, 0, sizeof nodes->at[i].errors);
    }
    while (active < nodes->count && (now = clock_now()) < deadline && !can_host_is_dead(host)) {
        active = 0;
        for (uint32_t i = 0; i < nodes->count; i++) {
            struct can_node *node = &nodes->at[i];
            const int is_due = now >= next[i] && !can_node_is_active(node);
            active += can_node_is_active(node) != 0;
            can_host_say(host, i, can_no_torque);
            if (!is_due) {
                can_host_send(host);
                continue;
            }
            can_host_say(host, i, clear);
            can_host_say(host, i, mode);
            /* What calibrates or searches is let be; it may end in time. */
            if (!node->has_beaten || node->beat.state <= ODRIVE_STATE_IDLE)
                can_host_say(host, i, loop);
            if (can_host_send(host))
                next[i] = now + SWITCH_EVERY;
            else /* It may have been on before: that it is says nothing until it was told its mode. */
                node->has_beaten = 0;
        }
        can_host_wait(host, now + FEED_EVERY);
    }
    if (active < nodes->count || can_host_is_dead(host) || host->line.is_passive) {
        can_host_say_all(host, can_idle);
        can_host_send(host);
        return refuse_switch(host, error);
    }
    nodes->status = DPT_DEVICE_STATUS_READY;
    nodes->reasons = nodes->code = 0;
    nodes->waiting_ns = nodes->sample_ns = 0;
    nodes->is_armed = 1;
    return DPT_OK;
}

dpt_result can_host_first_sample(struct can_host *host, dpt_device_error *error)
{
    const uint64_t deadline = clock_now() + host->nodes.silent_ns + 20 * MS;
    while (!host->nodes.sample_ns && clock_now() < deadline && !can_host_is_dead(host)) {
        if (host->settings.request != 0.0)
            can_host_say_all(host, can_where);
        can_host_say_all(host, can_no_torque);
        can_host_send(host);
        can_host_wait(host, clock_now() + FEED_EVERY);
    }
    if (host->nodes.sample_ns)
        return DPT_OK;
    can_nodes_judge(&host->nodes, clock_now(), 1);
    can_host_say_all(host, can_idle);
    can_host_send(host);
    return refuse_silence(host, error);
}

dpt_result can_host_connect(struct can_host *host, dpt_device_error *error)
{
    uint64_t nodes = 0;
    for (uint32_t i = 0; i < host->arm.joints; i++)
        nodes |= (uint64_t)1 << host->arm.nodes[i];
    dpt_result result = can_line_open(&host->line, host->settings.interface, nodes, error);
    if (result != DPT_OK)
        return result;
    const dpt_device_counts counts = host->nodes.counts;
    can_nodes_forget(&host->nodes);
    host->dropped = 0;
    if (host->is_ours) {
        can_host_say_all(host, can_no_torque);
        can_host_say_all(host, can_idle);
        can_host_send(host);
    }
    result = check_load(host, error);
    if (result == DPT_OK)
        result = meet(host, error);
    if (result == DPT_OK)
        result = listen_to(host, error);
    if (result == DPT_OK)
        result = can_host_switch_on(host, error);
    if (result == DPT_OK)
        result = can_host_first_sample(host, error);
    /* Nothing that came while they got acquainted counts. */
    host->nodes.counts = counts;
    return result;
}
