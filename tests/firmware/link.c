/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From end to end: the driver for serial lines against firmware that runs on an emulated Cortex-M7, its UART on a pty,
 * with a relay between that cuts and damages the line. run.sh gives the command that starts it:
 *
 *     link QEMU ARGUMENTS...      which says "redirected to /dev/pts/N"
 */
#include "drivers/relay.h"

#include <math.h>
#include <pthread.h>
#include <time.h>

#include "dynpoint/device.h"
#include "firmware/emulator.h"
#include "lib/check.h"

enum { GOOD, DAMAGED, CUT };

static struct emulator firmware;
static char ours[64];
static struct relay_way out, back; /* to the firmware, from it */
static volatile int out_line, back_line, ended;
static uint64_t seed = 1;
static uint32_t out_damaged, back_damaged;
static pthread_mutex_t samples_lock = PTHREAD_MUTEX_INITIALIZER;
static uint64_t sample_ns;     /* when the last whole sample passed */
static double longest_silence; /* s, without one */
static pthread_t relay;
static dpt_device *device;
static dpt_device_error error = { .size = sizeof error };
static dpt_device_state state = { .size = sizeof state };
static dpt_device_counts counts = { .size = sizeof counts };

static void pause_ms(long milliseconds)
{
    const struct timespec wait = { milliseconds / 1000, milliseconds % 1000 * 1000000 };
    nanosleep(&wait, NULL);
}

static uint64_t now_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000 + (uint64_t)now.tv_nsec;
}

static double since(uint64_t then_ns)
{
    return 1e-9 * (double)(now_ns() - then_ns);
}

static void note_sample(void)
{
    pthread_mutex_lock(&samples_lock);
    longest_silence = fmax(longest_silence, since(sample_ns));
    sample_ns = now_ns();
    pthread_mutex_unlock(&samples_lock);
}

/* From now on, or where the link was opened anew. */
static void begin_silence(void)
{
    pthread_mutex_lock(&samples_lock);
    longest_silence = 0.0;
    sample_ns = now_ns();
    pthread_mutex_unlock(&samples_lock);
}

/* s: the longest that there was, or the one that goes on. */
static double silence(void)
{
    pthread_mutex_lock(&samples_lock);
    const double longest = fmax(longest_silence, since(sample_ns));
    pthread_mutex_unlock(&samples_lock);
    return longest;
}

static int choose_fate(struct relay_way *way, uint8_t *frame, size_t size)
{
    const int line = way == &out ? out_line : back_line;
    if (line == CUT)
        return RELAY_DROP;
    /* Samples and commands, whose numbers tell. */
    if (line == DAMAGED && size > 30 && random_bits(&seed) % 20 == 0) {
        const size_t at = random_bits(&seed) % (size - 1), bit = random_bits(&seed) % 8;
        if (frame[at] != 1 << bit) {
            frame[at] = (uint8_t)(frame[at] ^ 1 << bit);
            *(way == &out ? &out_damaged : &back_damaged) += 1;
            return RELAY_PASS;
        }
    }
    if (way == &back && size > 30)
        note_sample();
    return RELAY_PASS;
}

static void *keep_relaying(void *unused)
{
    const struct timespec wait = { 0, 500000 };
    while (!ended) {
        relay_turn(&out);
        relay_turn(&back);
        nanosleep(&wait, NULL);
    }
    return unused;
}

/* A device is lost where no whole sample passed the relay for as long as `silent` says; a little less is allowed. */
static void read_state(void)
{
    const dpt_result got = dpt_device_read(device, &state);
    CHECK(got == DPT_OK || (got == DPT_E_LOST && state.status == DPT_DEVICE_STATUS_LOST &&
                            (state.reasons & DPT_REASON_SILENT) && silence() > 1.9),
          "read: %d, reasons %u, %.2f s without a sample", got, state.reasons, silence());
}

/* Answers every sample, until `enough` says so, at most a minute. */
static int go_on(double force, int (*enough)(void))
{
    const dpt_wrench wrench = { { force, 0, 0 }, { 0, 0, 0 } };
    for (int i = 0; i < 60000; i++) {
        read_state();
        if (enough())
            return 1;
        if (state.fresh > 0)
            dpt_device_write(device, &wrench);
        pause_ms(1);
    }
    return 0;
}

static int is_ready(void)
{
    return state.status == DPT_DEVICE_STATUS_READY && state.fresh > 0;
}

static int is_fault(void)
{
    return state.status == DPT_DEVICE_STATUS_FAULT;
}

static int is_lost(void)
{
    return state.status == DPT_DEVICE_STATUS_LOST;
}

static int is_settled(void)
{
    return fabs(state.pose.position[0] - 0.01) < 1e-5 && fabs(state.velocity[0]) < 1e-4;
}

/*
 * On a busy machine the watchdog or the limit of silence may end the link besides. Where the answer to the reset is
 * damaged or late, the next call tries again.
 */
static void clear_if_ended(void)
{
    CHECK(!is_fault() || state.reasons == DPT_REASON_WATCHDOG, "fault, reasons %u", state.reasons);
    if (!is_fault() && !is_lost())
        return;
    if (dpt_device_clear(device) == DPT_OK)
        begin_silence();
}

static int has_seen_much(void)
{
    clear_if_ended();
    return out_damaged >= 40 && back_damaged >= 40;
}

static void opens(void)
{
    char name[128];
    dpt_device_info info = { .size = sizeof info };
    snprintf(name, sizeof name, "serial:%s?answer=20&silent=2", ours);
    CHECK(dpt_device_open(name, &device, &error) == DPT_OK, "%s", error.text);
    if (!device)
        return;
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "info");
    CHECK(strcmp(info.name, "emulated Cortex-M7") == 0 && strcmp(info.serial, "an500") == 0, "%s", info.name);
    CHECK(info.rate == 250 && info.watchdog == 0.5 && info.force_max == 5, "numbers");
    CHECK(go_on(0, is_ready), "never ready");
}

/* 1.5 N against the hand's 150 N/m. */
static void moves_where_the_force_leads(void)
{
    CHECK(go_on(1.5, is_settled), "at %g m", state.pose.position[0]);
}

static void damage_is_counted_on_both_sides(void)
{
    dpt_device_get_counts(device, &counts);
    const dpt_device_counts before = counts;
    begin_silence();
    out_line = back_line = DAMAGED;
    CHECK(go_on(1.5, has_seen_much), "%u, %u frames damaged", out_damaged, back_damaged);
    out_line = back_line = GOOD;
    for (int i = 0; i < 500; i++) {
        const dpt_wrench wrench = { { 1.5, 0, 0 }, { 0, 0, 0 } };
        read_state();
        clear_if_ended();
        if (state.fresh > 0)
            dpt_device_write(device, &wrench);
        pause_ms(1);
    }
    dpt_device_get_counts(device, &counts);
    CHECK(counts.damaged - before.damaged == back_damaged, "%u counted of %u",
          (unsigned)(counts.damaged - before.damaged), back_damaged);
    /* A busy machine may be late besides. */
    CHECK(counts.missed - before.missed >= out_damaged, "%u missed of %u damaged",
          (unsigned)(counts.missed - before.missed), out_damaged);
    CHECK(counts.lost - before.lost >= back_damaged, "%u lost of %u damaged", (unsigned)(counts.lost - before.lost),
          back_damaged);
}

static void a_cut_on_the_way_there_trips_the_watchdog(void)
{
    out_line = CUT;
    CHECK(go_on(1.5, is_fault), "no fault");
    CHECK(state.reasons == DPT_REASON_WATCHDOG, "%u", state.reasons);
    out_line = GOOD;
    /*
     * It stays, whatever is written, and there is no force: the hand pulls back to the middle. On a busy machine the limit
     * of silence may end the link besides.
     */
    int faults = 0;
    for (int i = 0; i < 1000; i++) {
        const dpt_wrench wrench = { { 1.5, 0, 0 }, { 0, 0, 0 } };
        const dpt_result written = dpt_device_write(device, &wrench), read = dpt_device_read(device, &state);
        CHECK(written == DPT_E_NOT_READY || written == DPT_E_LOST, "%d", written);
        CHECK((read == DPT_OK && is_fault()) || (read == DPT_E_LOST && is_lost()), "%d, %u", read, state.status);
        faults += is_fault();
        pause_ms(1);
    }
    CHECK(faults >= 100, "a fault on %d of 1000", faults);
    CHECK(fabs(state.pose.position[0]) < 1e-4, "at %g m", state.pose.position[0]);
    CHECK(dpt_device_clear(device) == DPT_OK, "clear");
    CHECK(go_on(1.5, is_settled), "at %g m", state.pose.position[0]);
}

static void silence_is_loss_and_is_cleared(void)
{
    back_line = CUT;
    CHECK(go_on(1.5, is_lost), "not lost");
    CHECK(state.reasons == DPT_REASON_SILENT, "%u", state.reasons);
    back_line = GOOD;
    begin_silence();
    CHECK(dpt_device_clear(device) == DPT_OK, "clear");
    CHECK(go_on(1.5, is_settled), "at %g m", state.pose.position[0]);
}

static void the_end_of_the_firmware_is_noticed(void)
{
    emulator_kill(&firmware);
    CHECK(go_on(1.5, is_lost), "not lost");
    ended = 1;
    pthread_join(relay, NULL);
    close(out.from);
    dpt_device_read(device, &state);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_UNPLUGGED, "%u", state.reasons);
    CHECK(dpt_device_clear(device) == DPT_E_LOST, "clear");
    dpt_device_close(device);
}

int main(int argc, char **argv)
{
    if (argc < 2 || !emulator_start(&firmware, argv + 1)) {
        printf("    the firmware does not start\n1 failed\n");
        return 2;
    }
    begin_silence();
    out.from = back.to = relay_pty(ours);
    out.to = back.from = relay_open(firmware.line);
    out.fate = back.fate = choose_fate;
    if (out.from >= 0 && out.to >= 0 && pthread_create(&relay, NULL, keep_relaying, NULL) == 0)
        TEST(opens);
    if (device) {
        TEST(moves_where_the_force_leads);
        TEST(damage_is_counted_on_both_sides);
        TEST(a_cut_on_the_way_there_trips_the_watchdog);
        TEST(silence_is_loss_and_is_cleared);
        TEST(the_end_of_the_firmware_is_noticed);
    } else {
        check_failed++;
    }
    emulator_kill(&firmware);
    return check_report();
}
