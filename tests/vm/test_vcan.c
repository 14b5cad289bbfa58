/* SPDX-License-Identifier: BSD-3-Clause */
/* What the CAN driver takes for granted of a kernel's SocketCAN, on a virtual interface. For tests/vm/run.sh. */
#include "vm/can_socket.h"

#include <sys/wait.h>

#include "lib/check.h"
#include "vm/net.h"

enum { SOON = 1000, BUS = 0x123 };

static const char name[] = "vcan7";
static int sender, listener;

static void check_silent(int line)
{
    const struct can_heard heard = can_next(line, 0);
    CHECK(heard.problem == EAGAIN, "problem %d, id %x", heard.problem, heard.frame.can_id);
}

static void check_heard(int line, const struct can_frame *frame)
{
    const struct can_heard heard = can_next(line, SOON);
    CHECK(heard.problem == 0, "no frame %x: %s", frame->can_id, strerror(heard.problem));
    CHECK(heard.frame.can_id == frame->can_id && heard.frame.can_dlc == frame->can_dlc &&
              !memcmp(heard.frame.data, frame->data, frame->can_dlc),
          "id %x, %u bytes, instead of %x, %u", heard.frame.can_id, heard.frame.can_dlc, frame->can_id, frame->can_dlc);
}

/* A new interface, and two programs on it. */
static void begin(void)
{
    const int problem = net_add(name);
    CHECK(problem == 0 && net_up(name) == 0, "%s: %s", name, strerror(problem));
    sender = can_socket(name);
    listener = can_socket(name);
    CHECK(sender >= 0 && listener >= 0, "%s", strerror(errno));
}

static void end(void)
{
    close(sender);
    close(listener);
    net_remove(name);
}

static void every_other_socket_hears_a_frame_once_and_in_order(void)
{
    begin();
    for (unsigned i = 0; i < 100; i++) {
        const struct can_frame frame = can_frame_of(i, i % 9, 0x1122334455667788 + i);
        CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    }
    for (unsigned i = 0; i < 100; i++) {
        const struct can_frame frame = can_frame_of(i, i % 9, 0x1122334455667788 + i);
        check_heard(listener, &frame);
    }
    check_silent(listener);
    check_silent(sender);
    end();
}

static void own_frames_come_back_confirmed_where_asked(void)
{
    begin();
    CHECK(can_option(sender, CAN_RAW_RECV_OWN_MSGS, 1) == 0, "%s", strerror(errno));
    const struct can_frame mine = can_frame_of(BUS, 2, 1), other = can_frame_of(BUS, 2, 2);
    CHECK(can_send(sender, &mine) == 0 && can_send(listener, &other) == 0, "%s", strerror(errno));
    const struct can_heard first = can_next(sender, SOON), second = can_next(sender, SOON);
    CHECK(first.problem == 0 && first.frame.data[0] == 1, "%d", first.problem);
    CHECK(second.problem == 0 && second.frame.data[0] == 2, "%d", second.problem);
    CHECK(first.flags == (MSG_CONFIRM | MSG_DONTROUTE), "flags %x", (unsigned)first.flags);
    CHECK(second.flags == MSG_DONTROUTE, "flags %x", (unsigned)second.flags);
    end();
}

static void filters_choose_by_identifier_and_kind(void)
{
    begin();
    const canid_t whole = CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_SFF_MASK;
    const struct can_filter filters[] = { { 0x009, 0x01f | CAN_EFF_FLAG | CAN_RTR_FLAG }, { 0x001, whole } };
    CHECK(setsockopt(listener, SOL_CAN_RAW, CAN_RAW_FILTER, filters, sizeof filters) == 0, "%s", strerror(errno));
    const canid_t ids[] = { 0x009, 0x029, 0x7e9, 0x001, 0x021, 0x00a, 0x009 | CAN_RTR_FLAG, 0x009 | CAN_EFF_FLAG };
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        const struct can_frame frame = can_frame_of(ids[i], 0, 0);
        CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    }
    for (size_t i = 0; i < 4; i++) {
        const struct can_frame frame = can_frame_of(ids[i], 0, 0);
        check_heard(listener, &frame);
    }
    check_silent(listener);
    CHECK(setsockopt(listener, SOL_CAN_RAW, CAN_RAW_FILTER, NULL, 0) == 0, "%s", strerror(errno));
    const struct can_frame frame = can_frame_of(0x009, 0, 0);
    CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    check_silent(listener);
    end();
}

static void a_frame_keeps_its_kind(void)
{
    begin();
    const struct can_frame frames[] = { can_frame_of(0x7ff, 8, 0x0123456789abcdef),
                                        can_frame_of(0x1fffffff | CAN_EFF_FLAG, 3, 0xabcdef),
                                        can_frame_of(0x020 | CAN_RTR_FLAG, 0, 0),
                                        can_frame_of(0x020 | CAN_RTR_FLAG, 8, 0) };
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        CHECK(can_send(sender, &frames[i]) == 0, "%s", strerror(errno));
        check_heard(listener, &frames[i]);
    }
    const struct can_frame nine = { .can_id = BUS, .can_dlc = 9 };
    CHECK(can_send(sender, &nine) == EINVAL, "nine bytes are sent");
    /* CAN FD: only for those who ask. */
    const int fd = can_socket(name);
    const struct canfd_frame frame = { .can_id = BUS, .len = 12 };
    CHECK(can_option(fd, CAN_RAW_FD_FRAMES, 1) == 0, "%s", strerror(errno));
    CHECK(write(fd, &frame, sizeof frame) == sizeof frame, "%s", strerror(errno));
    check_silent(listener);
    close(fd);
    end();
}

static void a_socket_outlives_that_its_interface_is_down(void)
{
    begin();
    const struct can_frame frame = can_frame_of(BUS, 1, 7);
    struct pollfd ready = { .fd = listener, .events = POLLIN };
    CHECK(net_down(name) == 0, "still up");
    CHECK(poll(&ready, 1, SOON) == 1 && ready.revents & POLLERR, "revents %x", (unsigned)ready.revents);
    CHECK(can_next(listener, 0).problem == ENETDOWN, "the first read says nothing");
    check_silent(listener);
    CHECK(can_send(sender, &frame) == ENETDOWN, "the first write says nothing");
    CHECK(can_send(sender, &frame) == ENETDOWN, "the second write says nothing");
    const int late = can_socket(name);
    CHECK(late >= 0, "cannot be bound while it is down: %s", strerror(errno));
    CHECK(can_next(late, 0).problem == ENETDOWN, "bound while it is down, it is not told");
    check_silent(late);
    CHECK(can_send(late, &frame) == ENETDOWN, "it is sent");
    CHECK(net_up(name) == 0, "still down");
    CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    check_heard(listener, &frame);
    check_heard(late, &frame);
    close(late);
    end();
}

/* The news waits for the next call, a read or a write, however old it is then; a write that brings it sends nothing. */
static void news_of_a_pause_comes_late(void)
{
    begin();
    const struct can_frame frame = can_frame_of(BUS, 1, 7);
    CHECK(net_down(name) == 0 && net_up(name) == 0, "not down and up");
    CHECK(can_send(sender, &frame) == ENETDOWN, "not told");
    CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    CHECK(can_next(listener, 0).problem == ENETDOWN, "not told");
    check_heard(listener, &frame);
    check_silent(listener);
    end();
}

static void a_socket_is_dead_when_its_interface_is_removed(void)
{
    begin();
    const struct can_frame frame = can_frame_of(BUS, 1, 7);
    struct net_state state;
    CHECK(net_remove(name) == 0 && net_query(name, &state) == ENODEV, "still there");
    CHECK(can_next(listener, SOON).problem == ENODEV, "the first read says nothing");
    check_silent(listener);
    CHECK(can_send(listener, &frame) == ENXIO, "%s", strerror(errno));
    CHECK(can_send(sender, &frame) == ENXIO, "%s", strerror(errno));
    CHECK(can_socket(name) < 0 && errno == ENODEV, "%s", strerror(errno));
    /* It comes again: under the same name, but not for sockets that were bound before. */
    CHECK(net_add(name) == 0 && net_up(name) == 0, "it does not come again");
    CHECK(can_send(sender, &frame) == ENXIO, "%s", strerror(errno));
    const int again = can_socket(name), another = can_socket(name);
    CHECK(can_send(again, &frame) == 0, "%s", strerror(errno));
    check_heard(another, &frame);
    check_silent(listener);
    close(again);
    close(another);
    end();
}

/* Nobody waits for a slow reader: its buffer fills, and of the rest it hears only how many there were. */
static void what_a_slow_reader_loses_is_counted(void)
{
    begin();
    const int on = 1;
    const unsigned sent = 3000;
    CHECK(setsockopt(listener, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) == 0, "%s", strerror(errno));
    for (unsigned i = 0; i < sent; i++) {
        const struct can_frame frame = can_frame_of(BUS, 4, i);
        CHECK(can_send(sender, &frame) == 0, "frame %u: %s", i, strerror(errno));
    }
    unsigned kept = 0;
    for (struct can_heard heard; (heard = can_next(listener, 0)).problem == 0; kept++) {
        CHECK(heard.frame.data[0] == (uint8_t)kept && heard.frame.data[1] == kept >> 8, "frame %u is another one",
              kept);
        CHECK(heard.dropped == 0, "%u lost before frame %u", heard.dropped, kept);
    }
    CHECK(kept > 100 && kept < sent, "%u kept", kept);
    const struct can_frame frame = can_frame_of(BUS, 4, sent);
    CHECK(can_send(sender, &frame) == 0, "%s", strerror(errno));
    const struct can_heard heard = can_next(listener, SOON);
    CHECK(heard.problem == 0 && heard.dropped == sent - kept, "%u counted, %u lost", heard.dropped, sent - kept);
    end();
}

static void error_frames_are_for_those_who_ask(void)
{
    begin();
    const int deaf = can_socket(name), choosy = can_socket(name);
    CHECK(can_option(listener, CAN_RAW_ERR_FILTER, CAN_ERR_MASK) == 0 &&
              can_option(choosy, CAN_RAW_ERR_FILTER, CAN_ERR_BUSOFF) == 0,
          "%s", strerror(errno));
    const struct can_frame off = can_frame_of(CAN_ERR_FLAG | CAN_ERR_BUSOFF, CAN_ERR_DLC, 0);
    const struct can_frame passive =
        can_frame_of(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_DLC, CAN_ERR_CRTL_TX_PASSIVE << 8);
    CHECK(can_send(sender, &passive) == 0 && can_send(sender, &off) == 0, "%s", strerror(errno));
    check_heard(listener, &passive);
    check_heard(listener, &off);
    check_heard(choosy, &off);
    check_silent(choosy);
    check_silent(deaf);
    close(deaf);
    close(choosy);
    end();
}

/* Filters for data and for errors do not touch each other: no filter for data hears errors all the same. */
static void error_frames_pass_data_filters(void)
{
    begin();
    const struct can_filter one = { 0x001, CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG };
    CHECK(setsockopt(listener, SOL_CAN_RAW, CAN_RAW_FILTER, &one, sizeof one) == 0 &&
              can_option(listener, CAN_RAW_ERR_FILTER, CAN_ERR_MASK) == 0,
          "%s", strerror(errno));
    const struct can_frame off = can_frame_of(CAN_ERR_FLAG | CAN_ERR_BUSOFF, CAN_ERR_DLC, 0);
    const struct can_frame data = can_frame_of(0x002, 0, 0);
    CHECK(can_send(sender, &data) == 0 && can_send(sender, &off) == 0, "%s", strerror(errno));
    check_heard(listener, &off);
    check_silent(listener);
    end();
}

static void a_virtual_bus_is_never_full(void)
{
    struct net_state state;
    begin();
    const struct can_frame frame = can_frame_of(BUS, 8, 0);
    int refused = 0;
    for (unsigned i = 0; i < 20000; i++)
        refused += can_send(sender, &frame) != 0;
    CHECK(refused == 0, "%d refused", refused);
    CHECK(net_query(name, &state) == 0 && state.up && state.carrier && state.error_state == -1 && state.bitrate == 0 &&
              state.mtu == CANFD_MTU,
          "up %d, carrier %d, error state %d, mtu %u", state.up, state.carrier, state.error_state, state.mtu);
    end();
}

static void what_is_no_can_interface_is_refused(void)
{
    CHECK(can_socket("vcan99") < 0 && errno == ENODEV, "%s", strerror(errno));
    CHECK(can_socket("lo") < 0 && errno == ENODEV, "%s", strerror(errno));
    CHECK(net_up("vcan99") == ENODEV && net_remove("vcan99") == ENODEV, "it is there");
}

static void it_needs_no_rights_but_for_the_interface(void)
{
    begin();
    const pid_t child = fork();
    if (child == 0) {
        const struct can_frame frame = can_frame_of(BUS, 1, 7);
        if (setgid(65534) || setuid(65534))
            _exit(9);
        const int line = can_socket(name);
        const int right =
            line >= 0 && can_send(line, &frame) == 0 && net_down(name) == EPERM && net_remove(name) == EPERM;
        _exit(right ? 0 : 1);
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0, "status %x",
          (unsigned)status);
    const struct can_frame frame = can_frame_of(BUS, 1, 7);
    check_heard(listener, &frame);
    end();
}

int main(void)
{
    TEST(every_other_socket_hears_a_frame_once_and_in_order);
    TEST(own_frames_come_back_confirmed_where_asked);
    TEST(filters_choose_by_identifier_and_kind);
    TEST(a_frame_keeps_its_kind);
    TEST(a_socket_outlives_that_its_interface_is_down);
    TEST(news_of_a_pause_comes_late);
    TEST(a_socket_is_dead_when_its_interface_is_removed);
    TEST(what_a_slow_reader_loses_is_counted);
    TEST(error_frames_are_for_those_who_ask);
    TEST(error_frames_pass_data_filters);
    TEST(a_virtual_bus_is_never_full);
    TEST(what_is_no_can_interface_is_refused);
    TEST(it_needs_no_rights_but_for_the_interface);
    return check_report();
}
