/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a CAN bus carries between the driver for arms (drivers/can/can.c) and simulated motor controllers, on a bus that stands
 * in for the kernel's, or on the interface that $DPT_CAN names (can_kernel.h): what is lost, late or reordered, and clocks
 * that differ. Time is simulated.
 *
 *     test_can [CYCLES]
 */
#include "drivers/can_fixture.h"

#include "platform/clock.h"

static int cycles = 60000;

/* What was on the bus, and so what the driver must have noticed. */
enum { NUMBERS = 1 << 17 };
static struct {
    int is_rough;
    uint64_t seed;
    uint32_t count[3], newest[3]; /* torques of each node */
    uint32_t bits[3][NUMBERS];
    uint64_t sent_ns[3][NUMBERS];
    uint8_t is_carried[3][NUMBERS];
    uint64_t lost, late, reordered;
    uint8_t is_fresh[3]; /* estimates */
    uint64_t said_ns[3];
    uint64_t sets, first_ns, last_ns;
    uint64_t lost_estimates, late_estimates;
} truth;

static int is_torque(int fd, const struct can_frame *frame)
{
    return fd != simulated.line.fd && frame->can_id >> 5 < 3 && (frame->can_id & 31) == ODRIVE_SET_TORQUE;
}

static int is_estimate(int fd, const struct can_frame *frame)
{
    return fd == simulated.line.fd && (frame->can_id & 31) == ODRIVE_ESTIMATES;
}

static int choose_fate(int fd, const struct can_frame *frame)
{
    if (is_torque(fd, frame)) {
        const uint32_t node = frame->can_id >> 5, number = truth.count[node]++;
        memcpy(&truth.bits[node][number], frame->data, 4);
        truth.sent_ns[node][number] = clock_now();
    } else if (!is_estimate(fd, frame)) {
        return CAN_PASS;
    }
    /* Now and then all are held, and come together. */
    const uint64_t turn = clock_now() / 1000000 % 997;
    if (truth.is_rough && turn < 6)
        return 6 - (int)turn;
    const uint64_t dice = truth.is_rough ? random_bits(&truth.seed) % 1000 : 1000;
    const int held = 1 + (int)(random_bits(&truth.seed) % 12);
    if (is_estimate(fd, frame)) {
        truth.lost_estimates += dice < 15;
        truth.late_estimates += dice >= 15 && dice < 30;
    }
    return dice < 15 ? CAN_DROP : dice < 45 ? held : CAN_PASS;
}

static void keep_truth(int fd, const struct can_frame *frame)
{
    const uint32_t node = frame->can_id >> 5;
    if (is_estimate(fd, frame)) {
        truth.is_fresh[node] = 1;
        truth.said_ns[node] = clock_now();
        for (int k = 0; k < 3; k++) /* what is older than five periods is no part of a sample */
            truth.is_fresh[k] &= clock_now() - truth.said_ns[k] <= 5000000;
        if (!(truth.is_fresh[0] && truth.is_fresh[1] && truth.is_fresh[2]))
            return;
        memset(truth.is_fresh, 0, sizeof truth.is_fresh);
        truth.last_ns = clock_now();
        if (truth.sets++ == 0)
            truth.first_ns = truth.last_ns;
    }
    if (!is_torque(fd, frame))
        return;
    uint32_t number = truth.count[node] - 1;
    while (memcmp(&truth.bits[node][number], frame->data, 4) || truth.is_carried[node][number])
        number--;
    truth.is_carried[node][number] = 1;
    if (number < truth.newest[node])
        truth.reordered++;
    else if (clock_now() - truth.sent_ns[node][number] > 2000000)
        truth.late++;
    truth.newest[node] = number > truth.newest[node] ? number : truth.newest[node];
}

/*
 * A closed loop on a bus that loses, delays and reorders torques before the bus, and estimates on it: each torque that did not
 * come in time and in order is counted, and each sample.
 */
static void no_command_is_lost_late_or_reordered_unnoticed(void)
{
    uint64_t fresh = 0;
    start(elbow_path, ELBOW "&nodes=0,1,2");
    for (int i = 0; i < 50; i++) {
        write_force(0.01 * i, 0.3, 0.2);
        can_tick();
        dpt_device_read(device, &state);
    }
    dpt_device_get_counts(device, &counts);
    const dpt_device_counts before = counts;
    CHECK(before.missed == 0 && before.lost == 0, "%u missed on a good bus", (unsigned)before.missed);
    memset(&truth, 0, sizeof truth);
    truth.seed = 3;
    can_fate = choose_fate;
    can_carried = keep_truth;
    const uint64_t sequence = state.sequence;
    for (int i = 0; i < cycles; i++) {
        truth.is_rough = i < cycles - 50;
        /* A hand that pulls, a wall that pushes, and no two torques alike. */
        const double wall = state.pose.position[1] < 0.0 ? -300.0 * state.pose.position[1] : 0.0;
        simulated.hand[1] = 0.02 * sin(0.005 * i);
        const dpt_result written =
            write_force(random_in(&truth.seed, -0.5, 0.5), wall + random_in(&truth.seed, 0.0, 0.5),
                        random_in(&truth.seed, -0.5, 0.5));
        CHECK(written == DPT_OK, "write in cycle %d: %d", i, written);
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "cycle %d: %u, %x",
              i, state.status, state.code);
        fresh += state.fresh;
    }
    can_fate = NULL;
    can_carried = NULL;
    for (int node = 0; node < 3; node++)
        for (uint32_t i = 0; i < truth.count[node]; i++)
            truth.lost += !truth.is_carried[node][i];
    dpt_device_get_counts(device, &counts);
    CHECK(counts.commands - before.commands == (uint64_t)cycles && counts.refused == 0, "%u",
          (unsigned)counts.commands);
    CHECK(counts.missed == truth.lost + truth.late + truth.reordered, "%u missed, not %u lost, %u late, %u reordered",
          (unsigned)counts.missed, (unsigned)truth.lost, (unsigned)truth.late, (unsigned)truth.reordered);
    const uint64_t periods = (truth.last_ns - truth.first_ns) / 1000000 + 1;
    CHECK(counts.samples - before.samples == periods && counts.lost == periods - truth.sets,
          "%u samples, %u lost, not %u, %u", (unsigned)(counts.samples - before.samples), (unsigned)counts.lost,
          (unsigned)periods, (unsigned)(periods - truth.sets));
    CHECK(fresh == state.sequence - sequence, "%u fresh, %u in sequence", (unsigned)fresh,
          (unsigned)(state.sequence - sequence));
    const uint64_t some = (uint64_t)cycles / 100;
    CHECK(truth.lost > some && truth.reordered > some && truth.late > some / 50 && truth.lost_estimates > some &&
              counts.lost > some,
          "too little went wrong to show anything");
    printf("    %u torques: %u lost, %u late, %u reordered; %u samples: %u lost\n", (unsigned)(3 * counts.commands),
           (unsigned)truth.lost, (unsigned)truth.late, (unsigned)truth.reordered, (unsigned)counts.samples,
           (unsigned)counts.lost);
    finish();
}

static int lose_all(int fd, const struct can_frame *frame)
{
    (void)frame;
    return fd != simulated.line.fd ? CAN_DROP : CAN_PASS;
}

/* More under way than can be remembered: none is forgotten uncounted. */
static void many_torques_may_be_under_way(void)
{
    start(elbow_path, ELBOW "&silent=5");
    push_until_it_fails(10);
    can_fate = lose_all;
    for (int i = 0; i < 100; i++)
        CHECK(write_up(0.01 * i) == DPT_OK, "write");
    for (int i = 0; i < 40; i++) {
        can_tick();
        dpt_device_read(device, &state);
        write_up(1.0);
    }
    can_fate = NULL;
    for (int i = 0; i < 40; i++) {
        can_tick();
        dpt_device_read(device, &state);
        write_up(1.0);
    }
    dpt_device_get_counts(device, &counts);
    const uint64_t known = counts.missed;
    for (int i = 0; i < 40; i++) {
        can_tick();
        dpt_device_read(device, &state);
    }
    dpt_device_get_counts(device, &counts);
    /* Equal ones in a row: some are found to lack when the row ends. */
    CHECK(known >= 3 * 100 && known < counts.missed, "%u", (unsigned)known);
    CHECK(counts.missed == 3 * 140, "%u missed, not %u", (unsigned)counts.missed, 3 * 140);
    finish();
}

/* A hand that is quick is no encoder that jumps: from rest, with what the motor says of its velocity, and after a gap. */
static void quick_hands_are_no_fault(void)
{
    static const double speeds[2] = { 15.0, 60.0 };
    start(elbow_path, ELBOW);
    simulated.is_kinematic = 1;
    for (int i = 0; i < 400; i++) {
        const int way = i / 20 % 2 ? -1 : 1, told = i >= 200;
        simulated.joint[1] += 1e-3 * way * speeds[told];
        simulated.speed[1] = told ? way * speeds[1] : 0.0;
        simulated.node[1].is_mute = i % 20 > 2 && i % 20 < 18;
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%d: %x", i,
              state.code);
    }
    finish();
}

/* What one joint said long ago is no sample with what the others say now. */
static void old_places_are_not_mixed_with_new(void)
{
    start(elbow_path, ELBOW);
    for (int late = 0; late < 3; late++) {
        for (int i = 0; i < 3; i++)
            simulated.node[i].is_mute = i != late;
        can_tick();
        simulated.node[late].is_mute = 1;
        dpt_device_read(device, &state);
        for (int i = 0; i < 30; i++) {
            can_tick();
            dpt_device_read(device, &state);
        }
        for (int i = 0; i < 3; i++)
            simulated.node[i].is_mute = i == late;
        for (int i = 0; i < 5; i++) {
            can_tick();
            CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "joint %d is %d ms old, %u fresh",
                  late, 31 + i, state.fresh);
        }
        simulated.node[late].is_mute = 0;
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh > 0, "joint %d", late);
    }
    finish();
}

/* Timestamps are of the wall's clock, which someone may set: a sample is not older or younger for it. */
static void the_clock_may_be_set(void)
{
    start(elbow_path, ELBOW);
    for (int i = 0; i < 20; i++) {
        const uint64_t last = state.time_ns;
        can_tick();
        can_wall_ns = i % 2 ? 1000000000000u : 4600000000000u;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY &&
                  state.fresh == 1 && state.time_ns > last && state.time_ns <= clock_now(),
              "%u: %x, %u fresh", state.status, state.code, state.fresh);
    }
    finish();
}

/* Clocks that are a hundredth off, and more: no sample is taken for lost, and no node for two. */
static void clocks_may_differ(void)
{
    static const int rates[] = { 880, 990, 1010 };
    for (size_t r = 0; r < sizeof rates / sizeof *rates; r++) {
        const int rate = rates[r];
        char settings[64];
        snprintf(settings, sizeof settings, ELBOW "&rate=%d", rate);
        simulate(elbow_path, ELBOW);
        simulated.node[1].heartbeat_ticks = 80;
        CHECK(open_at(where_of(elbow_path, settings)) == DPT_OK, "%s", error.text);
        if (!device)
            return;
        uint64_t fresh = 0;
        for (int i = 0; i < 200; i++) {
            can_tick();
            dpt_device_read(device, &state);
        }
        dpt_device_get_counts(device, &counts);
        const uint64_t lost = counts.lost, samples = counts.samples;
        for (int i = 0; i < 8000; i++) {
            can_tick();
            CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY,
                  "%d Hz, cycle %d: %x", rate, i, state.code);
            fresh += state.fresh;
        }
        dpt_device_get_counts(device, &counts);
        CHECK(fresh == 8000 && counts.lost == lost, "%d Hz: %u fresh, %u lost", rate, (unsigned)fresh,
              (unsigned)(counts.lost - lost));
        /* What comes a tenth too often is more samples than there are periods. */
        CHECK(rate < 900 || counts.samples - samples == 8000, "%d Hz: %u samples", rate,
              (unsigned)(counts.samples - samples));
        finish();
    }
}

/* Controllers that say nothing by themselves are asked, each period once. */
static void estimates_can_be_asked_for(void)
{
    start(elbow_path, ELBOW "&request=1&watchdog=0.02");
    for (int i = 0; i < 300; i++) {
        CHECK(write_up(1.0) == DPT_OK, "write");
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
    const uint64_t sequence = state.sequence;
    for (int i = 0; i < 1000; i++) {
        CHECK(write_up(1.0) == DPT_OK, "write");
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%u", state.status);
    }
    CHECK(state.sequence - sequence == 1000, "%u samples of 1000", (unsigned)(state.sequence - sequence));
    CHECK(fabs(state.pose.position[1] - 1.0 / 150.0) < 1e-4, "%g", state.pose.position[1]);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.lost <= 3 && counts.missed == 0, "%u lost, %u missed", (unsigned)counts.lost, (unsigned)counts.missed);
    finish();
}

/* One that only reads keeps watchdogs fed, without force; one that reads on but stops writing gives none soon. */
static void a_host_that_reads_is_there(void)
{
    start(elbow_path, ELBOW "&watchdog=0.02");
    for (int i = 0; i < 1000; i++) {
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%x",
              state.reasons);
        CHECK(!is_pushing(), "it pushes by itself");
    }
    finish();
    /* Here no watchdog helps. */
    start(elbow_path, ELBOW);
    CHECK(push_until_it_fails(20) > 20 && is_pushing(), "push");
    int pushes = 0;
    for (int i = 0; i < 500; i++) {
        can_tick();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "read");
        pushes += is_pushing();
    }
    CHECK(pushes >= 20 && pushes <= 27, "it pushed for %d ms after the last write", pushes);
    CHECK(push_until_it_fails(20) > 20 && is_pushing(), "push again");
    finish();
}

/* However much waits: four receives and one send; and a command is one send. */
static void calls_are_bounded(void)
{
    start(elbow_path, ELBOW "&request=1");
    can_room = CAN_QUEUE;
    for (int round = 0; round < 200; round++) {
        pass_ms(round);
        simulated.node[0].extra_frames = round % 3 == 0 ? 20 : 0;
        can_watched = 1;
        can_calls = 0;
        dpt_device_read(device, &state);
        const int reading = can_calls;
        can_calls = 0;
        write_up(0.5);
        can_watched = 0;
        CHECK(reading <= 5 && can_calls <= 1, "%d, %d calls", reading, can_calls);
    }
    can_room = 278;
    close_device();
    end_simulation();
}

int main(int argc, char **argv)
{
    can_real = getenv("DPT_CAN");
    cycles = argc > 1 ? atoi(argv[1]) : cycles;
    arm_file(elbow_path, elbow, 3, elbow_tool);
    TEST(no_command_is_lost_late_or_reordered_unnoticed);
    TEST(many_torques_may_be_under_way);
    TEST(quick_hands_are_no_fault);
    TEST(old_places_are_not_mixed_with_new);
    TEST(estimates_can_be_asked_for);
    TEST(a_host_that_reads_is_there);
    TEST(calls_are_bounded);
    /* Of these a kernel could say nothing new. */
    if (!can_real) {
        TEST(clocks_may_differ);
        TEST(the_clock_may_be_set);
    }
    unlink(elbow_path);
    return check_report();
}
