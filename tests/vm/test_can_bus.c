/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The driver for arms on CAN on a real kernel, by the clock: in the servo loop against simulated controllers, against controllers
 * by someone else's code (peer.py), and on interfaces that go off the bus, down, away, and full. tests/drivers/test_can.c and
 * tests/drivers/test_can_faults.c have the rest, on the same kernel with a simulated clock (test_can.sh, test_can_faults.sh). For
 * tests/vm/run.sh.
 */
#include "dynpoint/driver.h"
#include "vm/can_socket.h"

#include <math.h>
#include <pthread.h>
#include <time.h>

#include "dynpoint/loop.h"
#include "lib/arm_bytes.h"
#include "lib/check.h"
#include "simulate/simulate_can.h"
#include "vm/net.h"
#include "vm/peer.h"
#include "vm/slcan.h"

static const char bus_name[] = "vcan2";
static char elbow_path[64], cross_path[64], build[200]; /* build: the folder that the program is in */
static struct simulate_can simulated;
static pthread_t thread;
static volatile int stop;
static dpt_device *device;
static dpt_device_state state;
static dpt_device_error error;

static void *serve(void *unused)
{
    simulate_can_run(&simulated, &stop);
    return unused;
}

static void go(void)
{
    stop = 0;
    CHECK(pthread_create(&thread, NULL, serve, NULL) == 0, "no thread");
}

static void halt(void)
{
    stop = 1;
    pthread_join(thread, NULL);
}

static void pause_ms(long milliseconds)
{
    const struct timespec wait = { milliseconds / 1000, milliseconds % 1000 * 1000000 };
    nanosleep(&wait, NULL);
}

static int is_pushing(void)
{
    for (uint32_t i = 0; i < simulated.arm.joints; i++)
        if (simulated.node[i].state == ODRIVE_STATE_CLOSED_LOOP && simulated.node[i].torque != 0.0f)
            return 1;
    return 0;
}

static dpt_result write_up(double force)
{
    const dpt_wrench wrench = { { 0.0, force, 0.0 }, { 0.0, 0.0, 0.0 } };
    return dpt_device_write(device, &wrench);
}

/* Times that an emulated machine keeps when the one that it is on has other work as well. */
#define SETTINGS "gear=8,-8,10&weight=0&watchdog=2&silent=1&answer=4&rate=100"
#define PERIOD   10
#define WATCHDOG 2100

/* Controllers that are simulated may have no time to say all that they must: then once more. */
static dpt_result open_patiently(const char *name)
{
    for (int i = 0;; i++) {
        const dpt_result result = dpt_device_open(name, &device, &error);
        if (result == DPT_OK || i == 9)
            return result;
    }
}

/* Nodes on the bus, and a device that is open on an interface to it. */
static int start(const char *interface, const char *settings)
{
    char where[256], name[300];
    error.size = sizeof error;
    state.size = sizeof state;
    device = NULL;
    snprintf(where, sizeof where, "%s?arm=%s&%s", bus_name, elbow_path, settings);
    CHECK(simulate_can_start(&simulated, where, &error) == DPT_OK, "%s", error.text);
    go();
    snprintf(name, sizeof name, "can:%s?arm=%s&%s", interface, elbow_path, settings);
    const dpt_result result = open_patiently(name);
    CHECK(result == DPT_OK, "%s", error.text);
    if (result != DPT_OK) {
        halt();
        simulate_can_end(&simulated);
    }
    return result == DPT_OK;
}

static void finish(void)
{
    dpt_device_close(device);
    pause_ms(20);
    halt();
    CHECK(!is_pushing(), "a motor pushes after close");
    simulate_can_end(&simulated);
}

static dpt_result feel(void *user, const dpt_loop_sample *sample, dpt_wrench *wrench)
{
    (void)user;
    wrench->force[1] = -60.0 * sample->state->pose.position[1];
    return DPT_OK;
}

/* The whole of it, as a host uses it. What is late on this machine is not asked; what is lost or pushed wrongly is. */
static void the_loop_is_closed_by_the_clock(void)
{
    dpt_loop_def def;
    dpt_guard_def guard;
    dpt_loop *loop;
    dpt_loop_stats stats = { .size = sizeof stats };
    dpt_device_counts counts = { .size = sizeof counts };
    if (!start(bus_name, SETTINGS))
        return;
    dpt_loop_def_init(&def);
    def.tick = feel;
    def.ticks = 600;
    dpt_guard_def_init(&guard);
    guard.hold = 0.5;
    def.guard = &guard;
    CHECK(dpt_loop_open(device, &def, &loop) == DPT_OK && dpt_loop_run(loop, &stats) == DPT_OK, "run");
    dpt_loop_close(loop);
    dpt_device_get_counts(device, &counts);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%x %x", state.reasons,
          state.code);
    CHECK(stats.fresh + stats.stale == stats.ticks && stats.fresh > stats.ticks / 2 && stats.lost == 0 &&
              stats.not_ready == 0,
          "%u fresh, %u stale, %u lost of %u", (unsigned)stats.fresh, (unsigned)stats.stale, (unsigned)stats.lost,
          (unsigned)stats.ticks);
    CHECK(stats.sent + 1 == counts.commands && counts.refused == 0 && counts.damaged == 0, "%u sent",
          (unsigned)stats.sent);
    CHECK(counts.samples > 500 && 5 * counts.lost < counts.samples, "%u samples, %u lost", (unsigned)counts.samples,
          (unsigned)counts.lost);
    CHECK(50 * counts.missed < 3 * counts.commands, "%u torques missed", (unsigned)counts.missed);
    printf("    %u ticks: %u fresh, %u commands, %u torques late; %u samples, %u late or lost\n", (unsigned)stats.ticks,
           (unsigned)stats.fresh, (unsigned)counts.commands, (unsigned)counts.missed, (unsigned)counts.samples,
           (unsigned)counts.lost);
    finish();
    for (int i = 0; i < 3; i++)
        CHECK(simulated.node[i].torques >= counts.commands && simulated.unsent == 0, "node %d took %u", i,
              (unsigned)simulated.node[i].torques);
}

static uint32_t crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
    crc = ~crc;
    for (size_t i = 0; i < 8 * size; i++) {
        crc ^= bytes[i / 8] >> i % 8 & 1;
        crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

static int listener;
static uint32_t heard_crc;
static unsigned heard, versions;

/* What our host puts on the bus for node 0, as a third party hears it. */
static void listen_in(void)
{
    for (struct can_heard next; (next = can_next(listener, 0)).problem == 0;) {
        if (next.frame.can_id == ODRIVE_SET_TORQUE) {
            heard_crc = crc32(heard_crc, next.frame.data, next.frame.can_dlc);
            heard++;
        } else if (next.frame.can_id == (1 << 5 | ODRIVE_VERSION | CAN_RTR_FLAG)) {
            versions++;
        }
    }
}

/* What the peer says of the frames that came, against what was heard on the bus. */
static void check_what_came(struct peer *peer)
{
    static const struct {
        const char *name;
        double value;
    } numbers[] = {
        { "0.state", 1 },
        { "1.state", 1 },
        { "0.error", 0 },
        { "1.error", 0 },
        { "0.Set_Controller_Mode.Control_Mode", 1 },
        { "0.Set_Controller_Mode.Input_Mode", 1 },
        { "1.Set_Controller_Mode.Control_Mode", 1 },
        { "0.Set_Axis_State.Axis_Requested_State", 1 },
        { "0.Set_Input_Torque.Input_Torque", 0 },
        { "errors", 0 },
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        CHECK(peer_number(peer, numbers[i].name) == numbers[i].value, "%s: %g, not %g", numbers[i].name,
              peer_number(peer, numbers[i].name), numbers[i].value);
    /* 0.5 knows no version: that it is asked for one is all that is strange to it. */
    CHECK(versions > 0 && peer_number(peer, "strangers") == versions, "%g strange frames, not %u",
          peer_number(peer, "strangers"), versions);
    CHECK(isnan(peer_number(peer, "1.Set_Axis_Node_ID.count")) &&
              isnan(peer_number(peer, "1.Set_Axis_Node_ID.requests")),
          "0.5 was asked for its address, which sets it");
    CHECK(heard > 50 && peer_number(peer, "0.Set_Input_Torque.count") == heard &&
              peer_number(peer, "0.Set_Input_Torque.crc") == heard_crc,
          "%g torques came, %u were sent", peer_number(peer, "0.Set_Input_Torque.count"), heard);
}

/* An axis of each generation: told apart, switched on, moved by the torques that were meant, and switched off. */
static void someone_elses_controllers_are_moved(void)
{
    static const double friction = 0.01, gear = 8.0;
    struct peer peer;
    char name[256];
    const int started = peer_start(&peer, "--interface vcan2 --axis 0:0.6 --axis 1:0.5 --rate 100 "
                                          "--friction 0.01 --inertia 0.0001");
    if (started == ENOENT) {
        SKIP("the driver against python-can", "it is not to be had");
        return;
    }
    CHECK(started == 0, "the peer: %s", strerror(started));
    const int room = 1 << 22;
    listener = can_socket(bus_name);
    CHECK(setsockopt(listener, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room) == 0, "room");
    error.size = sizeof error;
    state.size = sizeof state;
    snprintf(name, sizeof name, "can:%s?arm=%s&nodes=0,1&gear=%g,-%g&weight=0&watchdog=none&axes=xyz&rate=100&silent=1",
             bus_name, cross_path, gear, gear);
    const dpt_result opened = open_patiently(name);
    CHECK(opened == DPT_OK, "%s", error.text);
    if (opened != DPT_OK)
        return;
    uint64_t samples = 0;
    double first[2] = { 0.0, 0.0 };
    for (int i = 0; i < 400 && samples < 150; i++) {
        const dpt_wrench wrench = { { 0.5, 0.25, 3.0 }, { 1.0, 1.0, 1.0 } };
        CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
        pause_ms(10);
        listen_in();
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%u: %x, %x",
              state.status, state.reasons, state.code);
        samples += state.fresh;
        if (i == 0)
            memcpy(first, state.pose.position, sizeof first);
    }
    static const double force[2] = { 0.5, 0.25 };
    for (int k = 0; k < 2; k++) {
        const double torque = force[k] / (2.0 * M_PI * gear);
        const double speed = torque / friction / (2.0 * M_PI) / gear;
        CHECK(fabs(state.velocity[k] - speed) < 1e-6 * speed + 1e-9, "%c: %g m/s, not %g", "xy"[k], state.velocity[k],
              speed);
        CHECK(state.pose.position[k] > first[k] + 0.1 * speed, "%c: it is at %g m", "xy"[k], state.pose.position[k]);
    }
    CHECK(state.velocity[2] == 0.0 && state.pose.position[2] == 0.0, "z");
    dpt_device_close(device);
    pause_ms(300);
    listen_in();
    close(listener);
    CHECK(peer_stop(&peer) == 0, "no report");
    check_what_came(&peer);
    printf("    %u torques for an axis, all as they were sent\n", heard);
}

/* Pushes, by the clock, until the device is not ready any more, three seconds at most; and a while longer. */
static void push_until_it_fails(void)
{
    int after = 10;
    for (int i = 0; i < 300 && after > 0; i++) {
        write_up(1.0);
        pause_ms(PERIOD);
        dpt_device_read(device, &state);
        after -= state.status != DPT_DEVICE_STATUS_READY;
    }
    /* Where nothing can be sent, the controllers' watchdogs end it. */
    pause_ms(WATCHDOG);
}

static void push(int cycles)
{
    for (int i = 0; i < cycles; i++) {
        const dpt_result written = write_up(1.0);
        CHECK(written == DPT_OK, "write %d of %d: %d", i, cycles, written);
        pause_ms(PERIOD);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%u: %x, %x",
              state.status, state.reasons, state.code);
        if (state.status != DPT_DEVICE_STATUS_READY)
            return;
    }
}

static struct slcan adapter;

static void check_fault(const char *name, uint32_t status, uint32_t reasons, uint32_t kind)
{
    push_until_it_fails();
    CHECK(state.status == status && state.reasons & reasons && state.code == CAN_CODE(kind, CAN_CODE_BUS),
          "%s: status %u, reasons %x, code %x", name, state.status, state.reasons, state.code);
    halt();
    CHECK(!is_pushing(), "%s: a motor pushes", name);
    go();
    const dpt_result code = status == DPT_DEVICE_STATUS_LOST ? DPT_E_LOST : DPT_E_NOT_READY;
    CHECK(write_up(1.0) == code, "%s: it takes a force", name);
    CHECK(dpt_device_clear(device) == code, "%s: cleared in spite of its cause", name);
}

static void check_cured(const char *name)
{
    const dpt_result cleared = dpt_device_clear(device);
    CHECK(cleared == DPT_OK, "%s: not cleared: %d", name, cleared);
    if (cleared == DPT_OK)
        push(30);
    halt();
    CHECK(is_pushing(), "%s: it does not push again", name);
    go();
}

/* A serial adapter behind the kernel's slcan: the same driver, and a bus that has states. */
static void an_adapter_at_a_serial_line(void)
{
    const int plugged = slcan_plug(&adapter, can_socket(bus_name));
    CHECK(plugged == 0, "%s", strerror(plugged));
    if (plugged || !start(adapter.name, SETTINGS))
        return;
    push(50);
    dpt_device *other;
    char name[256];
    snprintf(name, sizeof name, "can:%s?arm=%s&gear=8,8,8&rate=5000", adapter.name, elbow_path);
    CHECK(dpt_device_open(name, &other, &error) == DPT_E_SETTING &&
              strstr(error.text, "has 1000000 bit/s, and 3 joints at 5000 Hz need up to 3450000"),
          "%s", error.text);

    slcan_say(&adapter, "sp128000");
    check_fault("error-passive", DPT_DEVICE_STATUS_FAULT, DPT_REASON_LINK, CAN_CODE_PASSIVE);
    slcan_say(&adapter, "sa000000");
    pause_ms(20);
    check_cured("error-passive");

    slcan_say(&adapter, "sb256000");
    check_fault("bus-off", DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE_OFF);
    CHECK(net_down(adapter.name) == 0, "down");
    slcan_say(&adapter, "sa000000");
    CHECK(net_up(adapter.name) == 0, "up");
    check_cured("bus-off");

    slcan_hang(&adapter, 1);
    push_until_it_fails();
    CHECK(state.status == DPT_DEVICE_STATUS_LOST && state.reasons & DPT_REASON_LINK, "full: %u, %x, %x", state.status,
          state.reasons, state.code);
    dpt_device_counts counts = { .size = sizeof counts };
    dpt_device_get_counts(device, &counts);
    CHECK(counts.refused > 0, "an adapter that hangs takes all");
    slcan_hang(&adapter, 0);
    pause_ms(200);
    check_cured("full");

    CHECK(net_down(adapter.name) == 0, "down");
    check_fault("down", DPT_DEVICE_STATUS_LOST, DPT_REASON_LINK, CAN_CODE_DOWN);
    CHECK(net_up(adapter.name) == 0, "up");
    check_cured("down");

    char before[16];
    strcpy(before, adapter.name);
    slcan_unplug(&adapter);
    check_fault("unplugged", DPT_DEVICE_STATUS_LOST, DPT_REASON_UNPLUGGED, CAN_CODE_GONE);
    CHECK(slcan_plug(&adapter, can_socket(bus_name)) == 0 && !strcmp(adapter.name, before), "it comes back as %s",
          adapter.name);
    check_cured("unplugged");
    finish();
    slcan_unplug(&adapter);
}

/* The kernel keeps some hundred frames for a host that does not read, and counts what it drops then. */
static void frames_that_the_kernel_drops(void)
{
    if (!start(bus_name, SETTINGS))
        return;
    push(50);
    /* Of node 2, and of a command that says nothing to us. */
    const struct can_frame frame = can_frame_of(2 << 5 | 0x14, 8, 0);
    const int other = can_socket(bus_name);
    for (int i = 0; i < 3000; i++)
        can_send(other, &frame);
    push_until_it_fails();
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT && state.reasons & DPT_REASON_LINK, "%u, %x, %x", state.status,
          state.reasons, state.code);
    close(other);
    halt();
    CHECK(!is_pushing(), "a motor pushes");
    go();
    pause_ms(20);
    check_cured("drops");
    finish();
}

/* The program on both ends: what people type. Its loop wants 400 Hz at least. */
static void the_program_feels_a_mesh_through_it(void)
{
    static const char script[] =
        "d=/tmp/can.$$; mkdir $d; n=\"can:%s?arm=%s&%s\"; p=%s/dynpoint\n"
        "$p make torus 2000 -o $d/torus.ply && $p compile $d/torus.ply -o $d/torus.dpa || exit 9\n"
        "$p device simulate \"$n\" --swing 0.02 --for 60 >$d/name & s=$!\n"
        "while [ ! -s $d/name ]; do sleep 0.1; done\n"
        "[ \"$(cat $d/name)\" = \"$n\" ] || exit 8\n"
        "i=0; until $p run $d/torus.dpa --device \"$n\" --ticks 200 --json >$d/json 2>$d/error; do\n"
        "[ $((i += 1)) -lt 10 ] || { cat $d/error; exit 7; }\n"
        "done\n"
        "kill $s; wait $s\n"
        "tr -d ' \\n' <$d/json | grep -q '\"ticks\":200,' || exit 6\n"
        "grep -q '\"lost\": *0' $d/json || exit 5\n"
        "rm -r $d\n";
    char command[2048];
    snprintf(command, sizeof command, script, bus_name, elbow_path, "gear=8,-8,10&watchdog=2&silent=1&rate=400", build);
    const int status = system(command);
    CHECK(status == 0, "status %d", WEXITSTATUS(status));
}

static void note_interface(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    CHECK(driver == dpt_driver_find("can") && about[0], "%s", where);
    *(int *)user += !strcmp(where, bus_name);
}

static void interfaces_are_found(void)
{
    int found = 0;
    dpt_driver_find("can")->find(dpt_driver_find("can"), note_interface, &found);
    CHECK(found == 1, "%s is found %d times", bus_name, found);
    error.size = sizeof error;
    CHECK(dpt_device_open("can:lo?arm=x", &device, &error) == DPT_E_OPEN, "%s", error.text);
    char name[128];
    snprintf(name, sizeof name, "can:lo?arm=%s", elbow_path);
    CHECK(dpt_device_open(name, &device, &error) == DPT_E_DEVICE && strstr(error.text, "no CAN interface"), "%s",
          error.text);
}

int main(int argc, char **argv)
{
    /* This is BUILD/tests/vm/test_can_bus. */
    const char *end = argc > 0 ? strstr(argv[0], "/tests/vm/") : NULL;
    snprintf(build, sizeof build, "%.*s", end ? (int)(end - argv[0]) : 5, end ? argv[0] : "build");
    arm_file(elbow_path, elbow, 3, elbow_tool);
    arm_file(cross_path, gantry, 2, no_tool);
    if (net_add(bus_name) || net_up(bus_name)) {
        SKIP("the driver on a real kernel", "no virtual interface can be made");
        return check_report();
    }
    TEST(interfaces_are_found);
    TEST(the_loop_is_closed_by_the_clock);
    TEST(someone_elses_controllers_are_moved);
    TEST(an_adapter_at_a_serial_line);
    TEST(frames_that_the_kernel_drops);
    TEST(the_program_feels_a_mesh_through_it);
    net_remove(bus_name);
    unlink(elbow_path);
    unlink(cross_path);
    return check_report();
}
