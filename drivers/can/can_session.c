/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/can_session.h"

#include <string.h>

#include "base/return_if_error.h"
#include "can/can_setup.h"
#include "platform/clock.h"
#include "settings.h"

#define MS            1000000u
#define REQUEST_EVERY (100u * MS)
#define VERSION_WAIT  (200u * MS) /* for an answer to Get_Version, which 0.5 does not give */
#define FEED_EVERY    (2u * MS)   /* while motors are switched on: controllers' watchdogs may run */
#define SWITCH_EVERY  (100u * MS)
#define SWITCH_WITHIN (2000u * MS)
#define RECEIVES      4

void can_session_put(struct can_session *session, uint32_t index, struct drive_message message)
{
    struct drive_node end = session->arm.ends[index];
    end.generation = session->monitor.nodes[index].generation;
    if (session->out_count < SOCKETCAN_BATCH && end.drive->encode(&end, &message, &session->out[session->out_count]))
        session->out_count++;
}

void can_session_put_all(struct can_session *session, struct drive_message message)
{
    for (uint32_t i = 0; i < session->monitor.count; i++)
        can_session_put(session, i, message);
}

void can_session_put_reporters(struct can_session *session, struct drive_message message)
{
    for (uint32_t i = 0; i < session->monitor.count; i++)
        if (!session->arm.ends[i].drive->answers)
            can_session_put(session, i, message);
}

void can_session_put_odrive(struct can_session *session, uint32_t index, struct odrive_message message)
{
    const struct can_node *node = &session->monitor.nodes[index];
    message.node = node->node;
    if (session->out_count < SOCKETCAN_BATCH && node->end->drive == &odrive_drive &&
        odrive_encode(&message, node->generation, &session->out[session->out_count]))
        session->out_count++;
}

const struct drive_message can_no_torque = { .kind = DRIVE_TORQUE }, can_estop = { .kind = DRIVE_STOP },
                           can_idle = { .kind = DRIVE_OFF }, can_ask = { .kind = DRIVE_ASK };

int can_session_send(struct can_session *session)
{
    const int count = session->out_count;
    if (count == 0)
        return 1;
    session->out_count = 0;
    const uint64_t now = clock_now();
    can_monitor_note_attempt(&session->monitor, now);
    const int sent = socketcan_send(&session->socketcan, session->out, count);
    for (int i = 0; i < sent; i++)
        can_monitor_note_sent(&session->monitor, &session->out[i], now);
    return sent == count;
}

void can_session_check_line(struct can_session *session)
{
    const struct socketcan *socketcan = &session->socketcan;
    struct can_monitor *monitor = &session->monitor;
    const uint32_t dropped = socketcan->dropped + socketcan->overruns;
    if (socketcan->is_gone)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_UNPLUGGED,
                               CAN_CODE(CAN_CODE_GONE, CAN_CODE_BUS));
    if (socketcan->is_down)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE(CAN_CODE_DOWN, CAN_CODE_BUS));
    if (socketcan->is_bus_off)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE(CAN_CODE_OFF, CAN_CODE_BUS));
    if (socketcan->is_error_passive)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_PASSIVE, CAN_CODE_BUS));
    if (dropped != session->dropped)
        can_monitor_set_status(monitor, DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK,
                               CAN_CODE(CAN_CODE_DROPPED, CAN_CODE_BUS));
    session->dropped = dropped;
}

int can_session_receive(struct can_session *session)
{
    int calls = 0;
    do {
        const int count = socketcan_receive(&session->socketcan, session->in);
        for (int k = 0; k < count; k++)
            can_monitor_take(&session->monitor, &session->in[k]);
    } while (!session->socketcan.is_drained && ++calls < RECEIVES);
    can_session_check_line(session);
    return session->socketcan.is_drained;
}

int can_session_is_dead(const struct can_session *session)
{
    return session->socketcan.is_gone || session->socketcan.is_down || session->socketcan.is_bus_off;
}

void can_session_wait(struct can_session *session, uint64_t deadline)
{
    do {
        socketcan_wait(&session->socketcan, deadline);
        can_session_receive(session);
    } while (clock_now() < deadline && !can_session_is_dead(session));
}

static const char *line_trouble(const struct can_session *session)
{
    return session->socketcan.is_gone            ? "it went away"
           : session->socketcan.is_down          ? "it was shut down"
           : session->socketcan.is_bus_off       ? "the bus is off: too many errors, look at wires, ends (120 Ohm) "
                                                   "and bit rate"
           : session->socketcan.is_error_passive ? "the bus has many errors: look at wires, ends (120 Ohm) and bit rate"
                                                 : NULL;
}

/*
 * The longest a frame can be: a frame with an 11-bit id has 47 bits and 8 for each byte of data. Of the first 34 bits
 * and the data, stuffing adds at most one bit for every 4. So 135 bits for 8 bytes, 95 for 4, 55 for none.
 */
static dpt_result check_load(const struct can_session *session, dpt_device_error *error)
{
    const struct socketcan *line = &session->socketcan;
    const double load = line->bitrate
                            ? drive_bus_load(session->arm.ends, session->arm.joints, session->settings.rate,
                                             session->settings.request != 0.0, line->bitrate, line->data_bitrate)
                            : 0.0;
    if (load <= 1.0)
        return DPT_OK;
    return device_error(error, DPT_E_SETTING,
                        "%.20s has %u bit/s, and %u joints at %g Hz need up to %.0f: set a higher "
                        "bit rate (1000000) there and at the controllers, or a lower ?rate=",
                        session->settings.interface, (unsigned)line->bitrate, (unsigned)session->arm.joints,
                        session->settings.rate, load * line->bitrate);
}

static dpt_result explain_silence(const struct can_session *session, dpt_device_error *error)
{
    const char *name = session->settings.interface, *trouble = line_trouble(session);
    if (trouble)
        return device_error(error, DPT_E_DEVICE, "%.20s: %s", name, trouble);
    if (!session->monitor.has_confirmed)
        return device_error(error, DPT_E_DEVICE,
                            "nobody on %.20s acknowledges: are the controllers powered and wired, "
                            "both ends terminated (120 Ohm), all at the same bit rate?",
                            name);
    for (uint32_t i = 0; i < session->monitor.count; i++) {
        const struct can_node *node = &session->monitor.nodes[i];
        if (node->end->drive->answers && !node->has_estimate)
            return device_error(error, DPT_E_DEVICE, "%s %u on %.20s sends no status", node->end->drive->title,
                                node->node, name);
        if (node->has_estimate && !node->has_heartbeat)
            return device_error(error, DPT_E_DEVICE,
                                "node %u answers but has no heartbeat: set axis.config.can."
                                "heartbeat_rate_ms (0.5) or heartbeat_msg_rate_ms (0.6) to 100",
                                node->node);
        if (!node->has_heartbeat)
            return device_error(error, DPT_E_DEVICE,
                                "no node %u on %.20s within %g s: is it powered, and is its "
                                "axis.config.can.node_id %u? Joints' nodes are set by ?nodes=",
                                node->node, name, session->settings.answer, node->node);
    }
    return device_error(error, DPT_E_DEVICE, "%.20s: no whole sample came", name);
}

/* Find a node's generation. 0.6 answers a request for its version, 0.5 does not. Some heartbeats show it, too. */
static void find_generation(struct can_session *session, struct can_node *node, uint64_t heard_ns)
{
    if (node->generation != ODRIVE_ANY)
        return;
    if (strcmp(session->settings.firmware, "auto"))
        node->generation = session->settings.firmware[2] == '5' ? ODRIVE_0_5 : ODRIVE_0_6;
    else if (node->has_heartbeat && clock_now() - heard_ns > VERSION_WAIT)
        node->generation = ODRIVE_0_5;
}

/* Wait for a heartbeat of each node and find its firmware's generation. */
static dpt_result identify_nodes(struct can_session *session, dpt_device_error *error)
{
    const uint64_t start = clock_now();
    const uint64_t deadline = start + (uint64_t)(1e9 * session->settings.answer);
    uint64_t heard_ns[DPT_JOINTS_MAX] = { 0 }; /* when the first heartbeat came: from then on it can answer */
    uint64_t next = start, now = start;
    uint32_t identified = 0;
    while (identified < session->monitor.count && !can_session_is_dead(session)) {
        if ((now = clock_now()) >= deadline)
            return explain_silence(session, error);
        identified = 0;
        for (uint32_t i = 0; i < session->monitor.count; i++) {
            struct can_node *node = &session->monitor.nodes[i];
            heard_ns[i] = node->has_heartbeat && !heard_ns[i] ? now : heard_ns[i];
            if (node->end->drive->answers) {
                identified++;
                continue;
            }
            find_generation(session, node, heard_ns[i]);
            identified += node->has_heartbeat && node->generation != ODRIVE_ANY;
            if (now < next)
                continue;
            const struct odrive_message version = { .command = ODRIVE_VERSION, .is_request = 1 };
            if (node->proven_generation == ODRIVE_ANY)
                can_session_put_odrive(session, i, version);
            can_session_put(session, i, can_ask);
        }
        next = now >= next ? now + REQUEST_EVERY : next;
        can_session_send(session);
        if (identified < session->monitor.count)
            can_session_wait(session, now + 5 * MS);
    }
    return can_session_is_dead(session) ? explain_silence(session, error) : DPT_OK;
}

/* Check that each node has the expected firmware, sends at the expected rates, and has a number of its own. */
static dpt_result check_nodes(const struct can_session *session, uint32_t requests, dpt_device_error *error)
{
    const double rate = session->settings.rate;
    for (uint32_t i = 0; i < session->monitor.count; i++) {
        const struct can_node *node = &session->monitor.nodes[i];
        if (node->end->drive->answers)
            continue;
        if (node->proven_generation != ODRIVE_ANY && node->proven_generation != node->generation)
            return device_error(error, DPT_E_PROTOCOL, "node %u has firmware 0.%u: leave ?firmware= away", node->node,
                                node->proven_generation);
        const double seconds = 1e-9 * (double)(node->estimate_ns - node->first_ns);
        const double estimate_rate = node->estimates > 1 && seconds > 0.0 ? (node->estimates - 1) / seconds : 0.0;
        const double heartbeats = (double)node->heartbeats;
        const double heartbeats_expected =
            1.0 + 1e-9 * (double)(clock_now() - session->requested_ns) / session->settings.heartbeat;
        if (node->is_duplicate || heartbeats > 1.4 * heartbeats_expected)
            return device_error(error, DPT_E_DEVICE,
                                "there are two controllers with the number %u: give each its own "
                                "axis.config.can.node_id (or their heartbeat is not every %g s: ?heartbeat=)",
                                node->node, session->settings.heartbeat);
        if (heartbeats < 0.45 * heartbeats_expected)
            return device_error(error, DPT_E_DEVICE,
                                "node %u has a heartbeat less often than every %g s: set axis."
                                "config.can.heartbeat_rate_ms (0.5) or heartbeat_msg_rate_ms (0.6) "
                                "to %.3g, or ?heartbeat=",
                                node->node, session->settings.heartbeat, 1000.0 * session->settings.heartbeat);
        if (session->settings.request != 0.0 && (double)node->estimates > 1.15 * requests + 2.0)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %u times, asked %u times: two "
                                "controllers have that number, or it does so by itself and ?request=1 is needless",
                                node->node, (unsigned)node->estimates, (unsigned)requests);
        if (session->settings.request != 0.0 && 5 * node->estimates < 4 * requests)
            return device_error(error, DPT_E_DEVICE,
                                "node %u answers %u of %u requests: the bus or the adapter is too slow for ?rate=%g",
                                node->node, (unsigned)node->estimates, (unsigned)requests, rate);
        if (session->settings.request == 0.0 && estimate_rate < 0.8 * rate)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %.0f times a second, not %g: set axis."
                                "config.can.encoder_rate_ms (0.5) or encoder_msg_rate_ms (0.6) to "
                                "%.3g, or ask each time: ?request=1, or be content: ?rate=",
                                node->node, estimate_rate, rate, 1000.0 / rate);
        if (session->settings.request == 0.0 && estimate_rate > 1.15 * rate)
            return device_error(error, DPT_E_DEVICE,
                                "node %u says where it is %.0f times a second, not %g: two "
                                "controllers have that number, or ?rate= is more",
                                node->node, estimate_rate, rate);
    }
    return session->monitor.foreign_orders == 0
               ? DPT_OK
               : device_error(error, DPT_E_DEVICE,
                              "someone else on %.20s gives our controllers orders: end that program first",
                              session->settings.interface);
}

static double max_seconds(double a, double b)
{
    return a > b ? a : b;
}

static dpt_result measure_rates(struct can_session *session, dpt_device_error *error)
{
    const double seconds =
        max_seconds(0.3, max_seconds(3.2 * session->settings.heartbeat, 30.0 / session->settings.rate));
    const struct odrive_message address = { .command = ODRIVE_ADDRESS, .is_request = 1 };
    uint32_t requests = 0;
    if (!can_arm_has_reporters(&session->arm))
        return DPT_OK;
    can_session_receive(session);
    can_monitor_restart_counts(&session->monitor);
    session->monitor.foreign_orders = 0;
    session->requested_ns = clock_now();
    /* On 0.5 the same id would set the node's number, so the setting `firmware` is not proof enough. */
    for (uint32_t i = 0; i < session->monitor.count; i++)
        if (session->monitor.nodes[i].proven_generation == ODRIVE_0_6)
            can_session_put_odrive(session, i, address);
    can_session_send(session);
    const uint64_t deadline = session->requested_ns + (uint64_t)(1e9 * seconds);
    for (uint64_t now; (now = clock_now()) < deadline && !can_session_is_dead(session);) {
        if (session->settings.request != 0.0) {
            can_session_put_reporters(session, can_ask);
            requests += can_session_send(session) != 0;
        }
        can_session_wait(session, now + session->monitor.period_ns);
    }
    return can_session_is_dead(session) ? explain_silence(session, error) : check_nodes(session, requests, error);
}

static dpt_result explain_not_active(const struct can_session *session, dpt_device_error *error)
{
    char text[160] = "";
    const char *trouble = line_trouble(session);
    if (trouble)
        return device_error(error, DPT_E_DEVICE, "%.20s: %s", session->settings.interface, trouble);
    for (uint32_t i = 0; i < session->monitor.count && !text[0]; i++)
        if (!can_node_is_active(&session->monitor.nodes[i]))
            can_node_describe(&session->monitor.nodes[i], text, sizeof text);
    return device_error(error, DPT_E_NOT_READY,
                        "%s, where closed loop is needed: calibrate it, and end the cause of errors", text);
}

dpt_result can_session_switch_on(struct can_session *session, dpt_device_error *error)
{
    const struct drive_message clear = { .kind = DRIVE_CLEAR }, mode = { .kind = DRIVE_MODE },
                               loop = { .kind = DRIVE_ON };
    struct can_monitor *monitor = &session->monitor;
    monitor->failed_nodes = 0;
    DPT_TRY(can_setup_motors(session, error));
    const uint64_t start = clock_now(), deadline = start + SWITCH_WITHIN;
    uint64_t next[DPT_JOINTS_MAX], now = start;
    uint32_t active = 0;
    for (uint32_t i = 0; i < monitor->count; i++) {
        next[i] = start;
        monitor->nodes[i].has_heartbeat = monitor->nodes[i].is_fresh = 0;
        memset(monitor->nodes[i].errors, 0, sizeof monitor->nodes[i].errors);
    }
    while (active < monitor->count && (now = clock_now()) < deadline && !can_session_is_dead(session)) {
        active = 0;
        for (uint32_t i = 0; i < monitor->count; i++) {
            struct can_node *node = &monitor->nodes[i];
            const int is_due = now >= next[i] && !can_node_is_active(node);
            active += can_node_is_active(node) != 0;
            can_session_put(session, i, can_no_torque);
            if (!is_due) {
                can_session_send(session);
                continue;
            }
            can_session_put(session, i, clear);
            can_session_put(session, i, mode);
            /* Do not interrupt a calibration or a search; it may end in time. */
            if (node->end->drive->answers || !node->has_heartbeat || node->heartbeat.state <= ODRIVE_STATE_IDLE)
                can_session_put(session, i, loop);
            if (can_session_send(session))
                next[i] = now + SWITCH_EVERY;
            else /* It may be active from before, in another mode: its heartbeat counts only after this was sent. */
                node->has_heartbeat = 0;
        }
        can_session_wait(session, now + FEED_EVERY);
    }
    if (active < monitor->count || can_session_is_dead(session) || session->socketcan.is_error_passive) {
        can_session_put_all(session, can_idle);
        can_session_send(session);
        return explain_not_active(session, error);
    }
    monitor->status = DPT_DEVICE_STATUS_READY;
    monitor->reasons = monitor->code = 0;
    monitor->unconfirmed_ns = monitor->sample_ns = 0;
    monitor->is_armed = 1;
    return DPT_OK;
}

dpt_result can_session_first_sample(struct can_session *session, dpt_device_error *error)
{
    const uint64_t deadline = clock_now() + session->monitor.silent_ns + 20 * MS;
    while (!session->monitor.sample_ns && clock_now() < deadline && !can_session_is_dead(session)) {
        if (session->settings.request != 0.0)
            can_session_put_reporters(session, can_ask);
        can_session_put_all(session, can_no_torque);
        can_session_send(session);
        can_session_wait(session, clock_now() + FEED_EVERY);
    }
    if (session->monitor.sample_ns)
        return DPT_OK;
    can_monitor_check(&session->monitor, clock_now(), 1);
    can_session_put_all(session, can_idle);
    can_session_send(session);
    return explain_silence(session, error);
}

/* With the line open: check the nodes, and switch them on. */
static dpt_result connect_nodes(struct can_session *session, dpt_device_error *error)
{
    DPT_TRY(check_load(session, error));
    DPT_TRY(identify_nodes(session, error));
    DPT_TRY(measure_rates(session, error));
    DPT_TRY(can_session_switch_on(session, error));
    return can_session_first_sample(session, error);
}

dpt_result can_session_connect(struct can_session *session, dpt_device_error *error)
{
    struct can_wanted wanted[DPT_JOINTS_MAX * DRIVE_WANTED];
    const int count = can_arm_wanted(&session->arm, wanted);
    DPT_TRY(socketcan_open(&session->socketcan, session->settings.interface, wanted, count,
                           can_arm_is_fd(&session->arm), error));
    const dpt_device_counts counts = session->monitor.counts;
    can_monitor_forget(&session->monitor);
    session->dropped = 0;
    if (session->was_connected) {
        can_session_put_all(session, can_no_torque);
        can_session_put_all(session, can_idle);
        can_session_send(session);
    }
    const dpt_result result = connect_nodes(session, error);
    /* What came while connecting does not count. */
    session->monitor.counts = counts;
    return result;
}
