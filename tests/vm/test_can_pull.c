/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * docs/samples/safe_device.c presses onto a sheet by an arm on CAN, and the plug is pulled at random instants of its run: the
 * interface goes down or away, a controller falls silent, all lose their power; the host is killed, stopped or interrupted. The
 * controllers' torque is zero within their watchdogs' time after the last one that came, and stays so; where the host sees that
 * samples are missing, its guard ends it before that. And the host says why it ended. Times are of the controllers' ticks. For
 * tests/vm/run.sh:
 *
 *     test_can_pull [PULLS [SEED]]
 */
#define _GNU_SOURCE
#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include "lib/arm_bytes.h"
#include "lib/check.h"
#include "lib/plug.h"
#include "simulate/sim_clock.h"
#include "simulate/simulate_can.h"
#include "vm/net.h"

/* Hz, and of the watchdogs s: times that an emulated machine keeps when the one that it is on has other work as well. */
enum { RATE = 100, WATCHDOG = 1 };

/*
 * Torques of a controller after another one's last estimate: the command to its sample, the guard's three periods and its ramp;
 * and the parts of a sample may be five periods apart.
 */
enum { GUARDED_MAX = 10 };

enum { DOWN, AWAY, SILENT, NO_POWER, KILLED, STOPPED, INTERRUPTED, KINDS };

static struct plug_kind kinds[KINDS] = {
    [DOWN] = { "interface down", 0, 2, "the device is gone" },
    [AWAY] = { "interface away", 0, 2, "the device is gone" },
    [SILENT] = { "a controller silent", 0, 2, "the device is gone" },
    [NO_POWER] = { "controllers without power", 0, 2, "the device is gone" },
    [KILLED] = { "host killed", 0, 128 + SIGKILL, "" },
    [STOPPED] = { "host stopped", 1, 2, "and gave no force" },
    [INTERRUPTED] = { "host interrupted", 0, 0, "ticks, in contact on" },
};

static const char bus_name[] = "vcan3";
static char safe_device[256], arm_path[64], scene_path[64], where[256];
static unsigned long pulls = 7;
static uint64_t seed = 1;
static struct plug plug;
static struct simulate_can nodes;
static pthread_t thread;
static volatile int stop;

/* What the controllers' motors do. */
static pthread_mutex_t meter_lock = PTHREAD_MUTEX_INITIALIZER;
struct meter {
    uint64_t tick, torques; /* of controller 0 */
    uint64_t torque_tick;   /* when its last torque came */
    uint64_t zero_tick;     /* when no motor had a torque any more */
    uint64_t pushed;        /* torques to controller 0 that are not zero */
    int is_pushing, is_closed;
};
static struct meter meter;

static void tick(void *unused)
{
    (void)unused;
    pthread_mutex_lock(&meter_lock);
    simulate_can_tick(&nodes);
    int is_pushing = 0, is_closed = 1;
    for (uint32_t i = 0; i < nodes.arm.joints; i++) {
        const int closed = nodes.node[i].state == ODRIVE_STATE_CLOSED_LOOP;
        is_closed &= closed;
        is_pushing |= closed && nodes.node[i].torque != 0.0f;
    }
    meter.tick = nodes.ticks;
    if (nodes.node[0].torques != meter.torques) {
        meter.torque_tick = nodes.ticks;
        meter.pushed += nodes.node[0].torque != 0.0f ? nodes.node[0].torques - meter.torques : 0;
    }
    if (!is_pushing && meter.is_pushing)
        meter.zero_tick = nodes.ticks;
    meter.torques = nodes.node[0].torques;
    meter.is_pushing = is_pushing;
    meter.is_closed = is_closed;
    pthread_mutex_unlock(&meter_lock);
}

static struct meter read_meter(void)
{
    pthread_mutex_lock(&meter_lock);
    const struct meter now = meter;
    pthread_mutex_unlock(&meter_lock);
    return now;
}

static void *serve(void *unused)
{
    sim_clock_run(RATE, tick, NULL, &stop);
    return unused;
}

static int power_on(void)
{
    dpt_device_error error = { .size = sizeof error };
    memset(&meter, 0, sizeof meter);
    CHECK(simulate_can_start(&nodes, where, &error) == DPT_OK, "%s", error.text);
    nodes.swing = 0.02;
    nodes.swing_period = 1.0;
    stop = 0;
    return pthread_create(&thread, NULL, serve, NULL) == 0;
}

static void power_off(void)
{
    stop = 1;
    pthread_join(thread, NULL);
    simulate_can_end(&nodes);
}

/* Wait for so long, or until `enough` says so; whether it did. */
static int wait_for(double seconds, int (*enough)(void))
{
    const struct timespec wait = { 0, 5000000 };
    for (double t = 0.0; t < seconds; t += 5e-3) {
        if (enough())
            return 1;
        nanosleep(&wait, NULL);
    }
    return 0;
}

static int has_ended(void)
{
    return child_has_ended(&plug.host);
}

static int is_pushing(void)
{
    return read_meter().is_pushing;
}

/* A while after the force has ended: the watchdogs' time is over too. */
static int has_rested(void)
{
    const struct meter now = read_meter();
    return !now.is_pushing && now.tick - now.torque_tick > WATCHDOG * RATE + 10;
}

static void mute(void)
{
    pthread_mutex_lock(&meter_lock);
    nodes.node[1].is_mute = 1;
    pthread_mutex_unlock(&meter_lock);
}

static void pull(int kind)
{
    switch (kind) {
    case DOWN:
        CHECK(net_down(bus_name) == 0, "down");
        break;
    case AWAY:
        CHECK(net_remove(bus_name) == 0, "away");
        break;
    case SILENT:
        mute();
        break;
    case NO_POWER:
        power_off();
        break;
    default:
        plug_signal(&plug, &kinds[kind]);
    }
}

static void bring_back(int kind)
{
    if (kind != NO_POWER)
        power_off();
    if (kind == AWAY)
        CHECK(net_add(bus_name) == 0, "add");
    if (kind == DOWN || kind == AWAY)
        CHECK(net_up(bus_name) == 0, "up");
}

/*
 * safe_device begins, and runs for a random time, and until it pushes if it must. 0: the machine is so busy that it could not
 * open the arm, or controllers have stopped themselves before.
 */
static int run_host(int must_push)
{
    char name[300];
    char *const words[] = { safe_device, scene_path, name, NULL };
    snprintf(name, sizeof name, "can:%s", where);
    CHECK(power_on(), "no thread");
    CHECK(child_start(&plug.host, words), "%s does not start", safe_device);
    wait_for(random_in(&seed, 0.0, 3.0), has_ended);
    if (must_push)
        wait_for(5.0, is_pushing);
    const struct meter now = read_meter();
    if (!has_ended() && (now.torques == 0 || now.is_closed))
        return 1;
    plug_give_up(&plug);
    power_off();
    return 0;
}

static void pull_once(int kind)
{
    const struct meter before = read_meter();
    const int was_running = before.is_closed && before.torques > 0;
    unsigned ms = 0, guarded = 0;
    pull(kind);
    if (kind != NO_POWER)
        CHECK(wait_for(20.0, has_rested), "%s: it pushes", kinds[kind].name);
    const struct meter after = read_meter();
    if (kind != NO_POWER && before.is_pushing) {
        CHECK((int64_t)(after.zero_tick - after.torque_tick) <= WATCHDOG * RATE + 2,
              "%s: a torque %d ticks after the last", kinds[kind].name, (int)(after.zero_tick - after.torque_tick));
        ms = (unsigned)(1000 * (after.zero_tick - before.tick) / RATE);
    }
    if (kind == SILENT) {
        guarded = (unsigned)(after.pushed - before.pushed);
        CHECK(guarded <= GUARDED_MAX, "%u torques", guarded);
    }
    plug_check_end(&plug, &kinds[kind], was_running);
    bring_back(kind);
    plug_note(&kinds[kind], was_running, before.is_pushing, ms, guarded);
}

static void the_force_ends_when_the_plug_is_pulled(void)
{
    plug = (struct plug){ .kinds = kinds,
                          .kind_count = KINDS,
                          .wait_for = wait_for,
                          .has_ended = has_ended,
                          .is_pushing = is_pushing,
                          .patience = 20.0,
                          .busy = "this machine is busy: the controllers' watchdogs ended the force before" };
    plug_pull_all(&plug, pulls, run_host, pull_once);
}

int main(int argc, char **argv)
{
    /* This is BUILD/tests/vm/test_can_pull. */
    char command[600];
    const char *end = strstr(argv[0], "/vm/");
    const int size = end ? (int)(end - argv[0]) : 0;
    take_count(argc, argv, &pulls, &seed);
    snprintf(safe_device, sizeof safe_device, "%.*s/safe_device", size, argv[0]);
    snprintf(scene_path, sizeof scene_path, "/tmp/sheet.%d.dpa", (int)getpid());
    snprintf(command, sizeof command,
             "{ %.*s/../dynpoint make membrane 512 -o %s.ply && %.*s/../dynpoint compile %s.ply -o %s; } >%s.says 2>&1",
             size, argv[0], scene_path, size, argv[0], scene_path, scene_path, scene_path);
    arm_file(arm_path, elbow, 3, elbow_tool);
    snprintf(where, sizeof where, "%s?arm=%s&gear=8,-8,10&weight=0&watchdog=%d&silent=0.5&answer=4&rate=%d", bus_name,
             arm_path, WATCHDOG, RATE);
    if (net_add(bus_name) || net_up(bus_name)) {
        SKIP("the plug of an arm on CAN", "no virtual interface can be made");
        return check_report();
    }
    CHECK(system(command) == 0, "no sheet");
    TEST(the_force_ends_when_the_plug_is_pulled);
    net_remove(bus_name);
    unlink(arm_path);
    return check_report();
}
