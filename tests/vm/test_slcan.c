/* SPDX-License-Identifier: BSD-3-Clause */
/* What the CAN driver takes for granted of a real bus, on a serial adapter that a test is. For tests/vm/run.sh. */
#include "vm/can_socket.h"

#include <linux/can/netlink.h>

#include "lib/check.h"
#include "vm/net.h"
#include "vm/slcan.h"

enum { SOON = 1000, BUS = 0x123, FAR_BEYOND = 10000 };

static struct slcan adapter;
static struct net_state state;
static int line;

static void begin(void)
{
    const int problem = slcan_plug(&adapter, -1);
    CHECK(problem == 0, "no adapter: %s", strerror(problem));
    line = problem ? -1 : can_socket(adapter.name);
    CHECK(line >= 0 && can_option(line, CAN_RAW_ERR_FILTER, CAN_ERR_MASK) == 0, "%s", strerror(errno));
    if (line >= 0)
        return;
    check_failed++;
    exit(check_report());
}

/* Set down first: an adapter that is just pulled lets the kernel wait for a second. */
static void end(void)
{
    close(line);
    net_down(adapter.name);
    slcan_unplug(&adapter);
}

static void check_silent(int on)
{
    const struct can_heard heard = can_next(on, 0);
    CHECK(heard.problem == EAGAIN, "problem %d, id %x", heard.problem, heard.frame.can_id);
}

static struct can_frame check_heard(int on, canid_t id, const char *what)
{
    const struct can_heard heard = can_next(on, SOON);
    CHECK(heard.problem == 0, "%s: %s", what, strerror(heard.problem));
    CHECK(heard.frame.can_id == id, "%s: id %x instead of %x", what, heard.frame.can_id, id);
    return heard.frame;
}

static void said(const char *what)
{
    char commands[SLCAN_COMMANDS], all[4 * SLCAN_COMMANDS] = "";
    for (int i = 0; i < SOON && strcmp(all, what); i++) {
        slcan_commands(&adapter, commands);
        if (strlen(all) + strlen(commands) < sizeof all)
            strcat(all, commands);
        poll(NULL, 0, strcmp(all, what) ? 1 : 0);
    }
    CHECK(!strcmp(all, what), "it said \"%s\", not \"%s\"", all, what);
}

static void an_adapter_is_opened_and_closed_by_the_kernel(void)
{
    begin();
    said("C S8 O ");
    CHECK(net_query(adapter.name, &state) == 0 && state.up && state.carrier &&
              state.error_state == CAN_STATE_ERROR_ACTIVE && state.bitrate == 1000000 && state.mtu == CAN_MTU,
          "up %d, carrier %d, error state %d, %u bit/s, mtu %u", state.up, state.carrier, state.error_state,
          state.bitrate, state.mtu);
    CHECK(net_set_bitrate(adapter.name, 500000) == EBUSY, "another rate while it is up");
    CHECK(net_down(adapter.name) == 0, "up");
    said("C ");
    CHECK(net_set_bitrate(adapter.name, 500000) == 0 && net_up(adapter.name) == 0, "down");
    said("C S6 O ");
    end();
}

static void frames_go_both_ways_as_they_are(void)
{
    begin();
    const struct can_frame frames[] = { can_frame_of(0x7ff, 8, 0x0123456789abcdef), can_frame_of(0x000, 0, 0),
                                        can_frame_of(0x1fffffff | CAN_EFF_FLAG, 3, 0xabcdef),
                                        can_frame_of(0x020 | CAN_RTR_FLAG, 0, 0),
                                        can_frame_of(0x12345 | CAN_EFF_FLAG | CAN_RTR_FLAG, 8, 0) };
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        const int ways[2] = { line, adapter.bus };
        for (int k = 0; k < 2; k++) {
            CHECK(can_send(ways[k], &frames[i]) == 0, "%s", strerror(errno));
            const struct can_frame heard = check_heard(ways[!k], frames[i].can_id, "a frame");
            CHECK(heard.can_dlc == frames[i].can_dlc && !memcmp(heard.data, frames[i].data, 8),
                  "frame %zu is another one", i);
        }
    }
    check_silent(line);
    check_silent(adapter.bus);
    end();
}

/*
 * A driver with an echo of its own confirms a frame when the bus has taken it. slcan has none: for it, as for vcan, the kernel
 * confirms what is queued.
 */
static void own_frames_come_back_confirmed_where_asked(void)
{
    begin();
    CHECK(can_option(line, CAN_RAW_RECV_OWN_MSGS, 1) == 0, "%s", strerror(errno));
    const struct can_frame frame = can_frame_of(BUS, 8, 1);
    CHECK(can_send(line, &frame) == 0, "%s", strerror(errno));
    CHECK(net_query(adapter.name, &state) == 0 && !state.echo, "it has an echo");
    const struct can_heard heard = can_next(line, SOON);
    CHECK(heard.problem == 0 && heard.flags == (MSG_CONFIRM | MSG_DONTROUTE), "problem %d, flags %x", heard.problem,
          (unsigned)heard.flags);
    check_heard(adapter.bus, BUS, "the bus");
    CHECK(can_send(adapter.bus, &frame) == 0, "%s", strerror(errno));
    const struct can_heard other = can_next(line, SOON);
    CHECK(other.problem == 0 && other.flags == 0, "problem %d, flags %x", other.problem, (unsigned)other.flags);
    end();
}

static void check_state(const char *say, canid_t id, uint8_t detail, int error_state, int carrier)
{
    slcan_say(&adapter, say);
    const struct can_frame frame = check_heard(line, id, say);
    CHECK(frame.can_dlc == CAN_ERR_DLC && frame.data[1] == detail, "%s: %u bytes, detail %02x", say, frame.can_dlc,
          frame.data[1]);
    CHECK(net_query(adapter.name, &state) == 0 && state.error_state == error_state && state.up &&
              state.carrier == carrier,
          "%s: error state %d, up %d, carrier %d", say, state.error_state, state.up, state.carrier);
}

static const canid_t controller = CAN_ERR_FLAG | CAN_ERR_CRTL | CAN_ERR_CNT;

static void states_of_the_controller_are_told(void)
{
    begin();
    check_state("sw000096", controller, CAN_ERR_CRTL_TX_WARNING, CAN_STATE_ERROR_WARNING, 1);
    check_state("sp000128", controller, CAN_ERR_CRTL_TX_PASSIVE, CAN_STATE_ERROR_PASSIVE, 1);
    check_state("sa000000", controller, CAN_ERR_CRTL_ACTIVE, CAN_STATE_ERROR_ACTIVE, 1);
    check_state("sw096000", controller, CAN_ERR_CRTL_RX_WARNING, CAN_STATE_ERROR_WARNING, 1);
    check_state("sp128000", controller, CAN_ERR_CRTL_RX_PASSIVE, CAN_STATE_ERROR_PASSIVE, 1);
    check_state("sb000256", CAN_ERR_FLAG | CAN_ERR_BUSOFF, 0, CAN_STATE_BUS_OFF, 0);
    slcan_say(&adapter, "sb000256");
    check_silent(line);
    end();
}

static void await_running(int running)
{
    for (int i = 0; i < 5 * SOON; i++) {
        if (net_query(adapter.name, &state) == 0 && state.running == running)
            return;
        poll(NULL, 0, 1);
    }
    CHECK(0, "not running %d", running);
}

/* What is written to a bus that is off is lost without an error, and confirmed for all that. */
static void check_lost(const char *when)
{
    const struct can_frame frame = can_frame_of(BUS, 8, 1);
    for (int i = 0; i < 30; i++) {
        CHECK(can_send(line, &frame) == 0, "%s: %s", when, strerror(errno));
        check_heard(line, BUS, when);
    }
    CHECK(can_next(adapter.bus, 20).problem == EAGAIN, "%s: the adapter hears it", when);
    check_silent(line);
}

static void bus_off_lasts_until_the_interface_is_set_up_again(void)
{
    begin();
    const struct can_frame frame = can_frame_of(BUS, 8, 1);
    CHECK(can_option(line, CAN_RAW_RECV_OWN_MSGS, 1) == 0, "%s", strerror(errno));
    await_running(1);
    check_state("sb000256", CAN_ERR_FLAG | CAN_ERR_BUSOFF, 0, CAN_STATE_BUS_OFF, 0);
    await_running(0);
    check_lost("off");
    CHECK(net_restart(adapter.name) == EOPNOTSUPP, "slcan can restart");
    check_state("sa000000", controller, CAN_ERR_CRTL_ACTIVE, CAN_STATE_ERROR_ACTIVE, 0);
    check_lost("active again");
    CHECK(net_down(adapter.name) == 0 && net_up(adapter.name) == 0, "not down and up");
    CHECK(net_query(adapter.name, &state) == 0 && state.carrier && state.error_state == CAN_STATE_ERROR_ACTIVE,
          "carrier %d, error state %d", state.carrier, state.error_state);
    CHECK(can_next(line, 0).problem == ENETDOWN, "not told");
    CHECK(can_send(line, &frame) == 0, "%s", strerror(errno));
    check_heard(line, BUS, "confirmed");
    check_heard(adapter.bus, BUS, "the bus");
    end();
}

static void errors_on_the_bus_are_told(void)
{
    begin();
    const canid_t protocol = CAN_ERR_FLAG | CAN_ERR_PROT | CAN_ERR_BUSERROR;
    static const struct {
        const char *say;
        canid_t more;
        uint8_t detail[3];
    } errors[] = {
        { "e1a", CAN_ERR_ACK, { 0, 0, CAN_ERR_PROT_LOC_ACK } },
        { "e1b", 0, { 0, CAN_ERR_PROT_BIT0, 0 } },
        { "e1B", 0, { 0, CAN_ERR_PROT_BIT1, 0 } },
        { "e1c", 0, { 0, CAN_ERR_PROT_BIT, CAN_ERR_PROT_LOC_CRC_SEQ } },
        { "e1f", 0, { 0, CAN_ERR_PROT_FORM, 0 } },
        { "e1s", 0, { 0, CAN_ERR_PROT_STUFF, 0 } },
        { "e2ab", CAN_ERR_ACK, { 0, CAN_ERR_PROT_BIT0, CAN_ERR_PROT_LOC_ACK } },
        { "e1o", CAN_ERR_CRTL, { CAN_ERR_CRTL_RX_OVERFLOW, 0, 0 } },
        { "e1O", CAN_ERR_CRTL, { CAN_ERR_CRTL_TX_OVERFLOW, 0, 0 } },
    };
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) {
        slcan_say(&adapter, errors[i].say);
        const struct can_frame frame = check_heard(line, protocol | errors[i].more, errors[i].say);
        CHECK(!memcmp(frame.data + 1, errors[i].detail, 3), "%s: %02x %02x %02x", errors[i].say, frame.data[1],
              frame.data[2], frame.data[3]);
    }
    CHECK(net_query(adapter.name, &state) == 0 && state.error_state == CAN_STATE_ERROR_ACTIVE, "error state %d",
          state.error_state);
    end();
}

/* Counts from 0, until nothing more comes. */
static unsigned check_counts(unsigned most)
{
    unsigned count = 0;
    for (struct can_heard heard; count < most && !(heard = can_next(adapter.bus, 100)).problem; count++)
        CHECK(heard.frame.data[0] == (uint8_t)count && heard.frame.data[1] == count >> 8, "frame %u is another one",
              count);
    return count;
}

static void a_queue_that_is_full_refuses(void)
{
    begin();
    CHECK(net_query(adapter.name, &state) == 0 && state.queue == 10, "holds %u", state.queue);
    slcan_hang(&adapter, 1);
    unsigned taken = 0;
    int problem = 0, refused = 0;
    while (refused < 2 && taken < FAR_BEYOND) {
        const struct can_frame frame = can_frame_of(BUS, 8, taken);
        problem = can_send(line, &frame);
        taken += problem == 0;
        refused = problem ? refused + 1 : 0;
        poll(NULL, 0, refused == 1 ? 50 : 0);
    }
    CHECK(problem == ENOBUFS && taken > 10, "after %u: %s", taken, strerror(problem));
    check_silent(adapter.bus);
    struct pollfd ready = { .fd = line, .events = POLLOUT };
    CHECK(poll(&ready, 1, 0) == 1 && ready.revents == POLLOUT, "poll knows it: %x", (unsigned)ready.revents);
    check_silent(line);
    slcan_hang(&adapter, 0);
    const unsigned came = check_counts(FAR_BEYOND);
    CHECK(came == taken, "%u taken, %u came", taken, came);
    const struct can_frame again = can_frame_of(BUS, 8, 0);
    CHECK(can_send(line, &again) == 0 && check_counts(1) == 1, "it takes nothing any more");
    end();
    CHECK(adapter.lost == 0, "%u lost", adapter.lost);
}

static void frames_that_the_test_does_not_take_are_counted(void)
{
    begin();
    unsigned sent = 0, came = 0;
    for (int i = 0; i < 2000; i++) {
        const struct can_frame frame = can_frame_of(BUS, 8, 0);
        sent += can_send(line, &frame) == 0;
        poll(NULL, 0, i % 10 == 9 ? 1 : 0);
    }
    /* Until nothing more comes: what an interface still holds when it is set down is lost uncounted. */
    while (can_next(adapter.bus, SOON).problem == 0)
        came++;
    end();
    CHECK(adapter.lost > 0 && came > 0 && came + adapter.lost == sent, "%u sent, %u came, %u lost", sent, came,
          adapter.lost);
}

static void it_can_be_unplugged_and_plugged_in_again(void)
{
    begin();
    char name[sizeof adapter.name];
    const struct can_frame frame = can_frame_of(BUS, 8, 1);
    strcpy(name, adapter.name);
    slcan_unplug(&adapter);
    CHECK(can_next(line, SOON).problem == ENODEV, "the first read says nothing");
    check_silent(line);
    CHECK(can_send(line, &frame) == ENXIO, "it is sent");
    const int old = line;
    begin();
    CHECK(!strcmp(name, adapter.name), "%s comes again as %s", name, adapter.name);
    CHECK(can_send(old, &frame) == ENXIO, "the old socket lives");
    CHECK(can_send(line, &frame) == 0, "%s", strerror(errno));
    check_heard(adapter.bus, BUS, "the bus");
    close(old);
    end();
}

static void a_bus_of_two_interfaces(void)
{
    CHECK(net_add("vcan8") == 0 && net_up("vcan8") == 0, "no vcan8");
    const int far = can_socket("vcan8");
    CHECK(slcan_plug(&adapter, can_socket("vcan8")) == 0, "no adapter");
    const int near = can_socket(adapter.name);
    for (unsigned i = 0; i < 200; i++) {
        const struct can_frame there = can_frame_of(i, 8, i), back = can_frame_of(i, 4, i);
        CHECK(can_send(near, &there) == 0, "%s", strerror(errno));
        CHECK(check_heard(far, i, "there").can_dlc == 8, "another one");
        CHECK(can_send(far, &back) == 0, "%s", strerror(errno));
        CHECK(check_heard(near, i, "back").can_dlc == 4, "another one");
    }
    check_silent(near);
    check_silent(far);
    close(near);
    close(far);
    net_down(adapter.name);
    slcan_unplug(&adapter);
    net_remove("vcan8");
}

int main(void)
{
    TEST(an_adapter_is_opened_and_closed_by_the_kernel);
    TEST(frames_go_both_ways_as_they_are);
    TEST(own_frames_come_back_confirmed_where_asked);
    TEST(states_of_the_controller_are_told);
    TEST(bus_off_lasts_until_the_interface_is_set_up_again);
    TEST(errors_on_the_bus_are_told);
    TEST(a_queue_that_is_full_refuses);
    TEST(frames_that_the_test_does_not_take_are_counted);
    TEST(it_can_be_unplugged_and_plugged_in_again);
    TEST(a_bus_of_two_interfaces);
    return check_report();
}
