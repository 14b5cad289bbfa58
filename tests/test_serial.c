/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The driver for serial lines (drivers/serial.c) against the simulated device at the other end of a pty: a real line but for
 * its speed. Where no pty can do it (another speed than was asked for, no permission, calls that fail) the call is
 * wrapped by the linker, for the driver alone.
 */
#include "relay.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <time.h>

#include "check.h"
#include "dynpoint/driver.h"
#include "serial_line.h"
#include "simulate_serial.h"
#include "wire_frame.h"

/*
 * Calls of the driver, while `watched`: counted, and the one of number `fail_at` fails with fail_errno. `held` is
 * how many descriptors it has open.
 */
static __thread int watched;
static int calls, fail_at, fail_errno, held, descriptor, not_a_tty, other_speed;

static int fails(void)
{
    if (!watched || ++calls != fail_at)
        return 0;
    errno = fail_errno;
    return 1;
}

int __real_open(const char *path, int flags, ...);
int __real_close(int fd);
ssize_t __real_read(int fd, void *bytes, size_t size);
ssize_t __real_write(int fd, const void *bytes, size_t size);
int __real_poll(struct pollfd *lines, nfds_t count, int timeout);
int __real_ioctl(int fd, unsigned long request, ...);
int __real_flock(int fd, int operation);
int __real_tcgetattr(int fd, struct termios *settings);
int __real_tcsetattr(int fd, int when, const struct termios *settings);
int __real_tcflush(int fd, int queue);
void *__real_calloc(size_t count, size_t size);

int __wrap_open(const char *path, int flags, ...);
int __wrap_close(int fd);
ssize_t __wrap_read(int fd, void *bytes, size_t size);
ssize_t __wrap_write(int fd, const void *bytes, size_t size);
int __wrap_poll(struct pollfd *lines, nfds_t count, int timeout);
int __wrap_ioctl(int fd, unsigned long request, ...);
int __wrap_flock(int fd, int operation);
int __wrap_tcgetattr(int fd, struct termios *settings);
int __wrap_tcsetattr(int fd, int when, const struct termios *settings);
int __wrap_tcflush(int fd, int queue);
void *__wrap_calloc(size_t count, size_t size);

int __wrap_open(const char *path, int flags, ...)
{
    const int fd = fails() ? -1 : __real_open(path, flags);
    if (watched && fd >= 0) {
        held++;
        descriptor = fd;
    }
    return fd;
}

int __wrap_close(int fd)
{
    if (watched)
        held--;
    return __real_close(fd);
}

ssize_t __wrap_read(int fd, void *bytes, size_t size)
{
    return fails() ? -1 : __real_read(fd, bytes, size);
}

ssize_t __wrap_write(int fd, const void *bytes, size_t size)
{
    return fails() ? -1 : __real_write(fd, bytes, size);
}

int __wrap_poll(struct pollfd *lines, nfds_t count, int timeout)
{
    return fails() ? -1 : __real_poll(lines, count, timeout);
}

int __wrap_ioctl(int fd, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *argument = va_arg(arguments, void *);
    va_end(arguments);
    if (fails())
        return -1;
    const int result = __real_ioctl(fd, request, argument);
    if (watched && request == TIOCMBIS && result < 0 && errno == ENOTTY)
        not_a_tty++;
    return result;
}

int __wrap_flock(int fd, int operation)
{
    return fails() ? -1 : __real_flock(fd, operation);
}

int __wrap_tcgetattr(int fd, struct termios *settings)
{
    if (fails())
        return -1;
    const int result = __real_tcgetattr(fd, settings);
    if (watched && other_speed)
        cfsetspeed(settings, B9600);
    return result;
}

int __wrap_tcsetattr(int fd, int when, const struct termios *settings)
{
    return fails() ? -1 : __real_tcsetattr(fd, when, settings);
}

int __wrap_tcflush(int fd, int queue)
{
    return fails() ? -1 : __real_tcflush(fd, queue);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails() ? NULL : __real_calloc(count, size);
}

/* The simulated device, in a thread of its own while the host may block; between, a test ticks it. */
static struct simulate_serial simulated;
static pthread_t thread;
static volatile int stop;

static void *serve(void *unused)
{
    simulate_serial_run(&simulated, &stop);
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

static dpt_device *device;
static dpt_device_error error;
static dpt_device_state state;
static dpt_device_counts counts;

static void pause_ms(long milliseconds)
{
    const struct timespec wait = { milliseconds / 1000, milliseconds % 1000 * 1000000 };
    nanosleep(&wait, NULL);
}

static dpt_result open_at(const char *path, const char *settings)
{
    char name[128];
    snprintf(name, sizeof name, "serial:%s%s", path, settings);
    error.size = sizeof error;
    state.size = sizeof state;
    counts.size = sizeof counts;
    watched = 1;
    const dpt_result result = dpt_device_open(name, &device, &error);
    watched = 0;
    return result;
}

static dpt_result clear(void)
{
    watched = 1;
    const dpt_result result = dpt_device_clear(device);
    watched = 0;
    return result;
}

static void close_device(void)
{
    watched = 1;
    dpt_device_close(device);
    watched = 0;
    device = NULL;
    CHECK(held == 0, "%d descriptors are left", held);
}

static dpt_result write_force(double y)
{
    const dpt_wrench wrench = { { 0, y, 0 }, { 0, 0, 0 } };
    return dpt_device_write(device, &wrench);
}

/* Open, with the device running, and then not any more. */
static void start(const struct wire_info *info, const char *settings)
{
    CHECK(simulate_serial_start(&simulated, info) == 0, "no pty");
    go();
    const dpt_result result = open_at(simulated.path, settings);
    halt();
    CHECK(result == DPT_OK, "%s", error.text);
    if (result != DPT_OK)
        exit(1);
    /* What is still under way. */
    for (int i = 0; i < 3; i++) {
        simulate_serial_tick(&simulated);
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
}

static void finish(void)
{
    go();
    close_device();
    halt();
    CHECK(simulated.device.enabled == 0 && simulated.device.reasons == 0,
          "motors are on after close");
    simulate_serial_end(&simulated);
}

static void opens_and_tells(void)
{
    dpt_device_info info = { .size = sizeof info };
    not_a_tty = 0;
    start(NULL, "?silent=30");
    CHECK(not_a_tty == 1, "a pty has modem lines: then this shows nothing");
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "info");
    CHECK(info.pose_dofs == 3 && info.wrench_dofs == 3 && info.joints == 0 && info.buttons == 1,
          "dofs");
    CHECK(info.flags == DPT_DEVICE_SIMULATED && info.rate == 1000 && info.force_max == 5 &&
              info.watchdog == (double)0.02f && info.workspace_max[1] == (double)0.1f,
          "numbers");
    CHECK(strcmp(info.name, "simulated serial device") == 0 && strcmp(info.serial, "0") == 0, "%s",
          info.name);
    CHECK(state.status == DPT_DEVICE_READY && state.reasons == 0 && state.temperature == -1, "%u",
          state.status);
    CHECK(simulated.device.force[1] == 0, "it pushes before it was told to");
    simulated.buttons = 1;
    uint64_t time = 0;
    for (int i = 0; i < 100; i++) {
        simulate_serial_tick(&simulated);
        const uint64_t sequence = state.sequence;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "%u fresh",
              state.fresh);
        CHECK(state.sequence == sequence + 1 && state.time_ns > time && state.buttons == 1, "at %d",
              i);
        CHECK(state.time_ns <= serial_now(), "a sample of the future");
        CHECK(state.pose.orientation[0] == 1, "orientation");
        time = state.time_ns;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 0, "read twice");
        CHECK(state.sequence == sequence + 1 && state.time_ns == time, "an old one is another");
    }
    for (int i = 0; i < 3; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 3, "%u fresh", state.fresh);
    finish();
}

/* A force that is held comes to where the hand's spring holds it, and too much is cut. */
static void closes_the_loop(void)
{
    start(NULL, "?silent=30");
    for (int i = 0; i < 4000; i++) {
        CHECK(write_force(1.5) == DPT_OK, "write");
        simulate_serial_tick(&simulated);
        CHECK(simulated.device.force[1] == 1.5f, "%g", (double)simulated.device.force[1]);
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 1, "read");
    }
    CHECK(fabs(state.pose.position[1] - 1.5 / 150) < 1e-6, "%g", state.pose.position[1]);
    CHECK(fabs(state.velocity[1]) < 1e-6, "%g", state.velocity[1]);
    CHECK(write_force(-1e300) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    CHECK(fabs((double)simulated.device.force[1] + 5) < 1e-5, "%g",
          (double)simulated.device.force[1]);
    CHECK(write_force(NAN) == DPT_E_FINITE, "NaN");
    simulate_serial_tick(&simulated);
    CHECK(simulated.device.force[1] == 0, "%g", (double)simulated.device.force[1]);
    finish();
}

/* Orientation, spin and joints, and torque, of a device that has them. */
static void six_freedoms_and_joints(void)
{
    struct wire_info info;
    simulate_serial_info(&info);
    info.pose_dofs = info.wrench_dofs = 6;
    info.joints = 1;
    info.torque_max = 0.1f;
    info.flags = 0xffffffffu;
    start(&info, "?silent=30");
    dpt_device_info told = { .size = sizeof told };
    CHECK(dpt_device_get_info(device, &told) == DPT_OK &&
              told.flags == (DPT_DEVICE_SIMULATED | DPT_DEVICE_ARM),
          "flags %x: a loop does not wait for a device that has its own time", told.flags);
    const dpt_wrench wrench = { { 3, 4, 12 }, { 0, 0.3, 0.4 } };
    CHECK(dpt_device_write(device, &wrench) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    const float *force = simulated.device.force, *torque = simulated.device.torque;
    CHECK(fabs((double)force[0] - 3 * 5 / 13.0) < 1e-6 &&
              fabs((double)force[2] - 12 * 5 / 13.0) < 1e-6,
          "%g", (double)force[0]);
    CHECK(fabs((double)torque[1] - 0.06) < 1e-7 && fabs((double)torque[2] - 0.08) < 1e-7, "%g",
          (double)torque[1]);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.pose.orientation[0] == 1, "read");
    finish();
}

/* What really went over the line, and so what both sides must have counted. */
struct truth {
    struct relay_way way; /* first */
    uint64_t seed;
    int calm; /* pass all */
    uint32_t sent, damaged, newest, lost, reordered, late, from;
    uint8_t *came;
    int is_commands;
};
enum { CYCLES = 60000, NUMBERS = 1 << 20 };

static int number_of(const uint8_t *frame, size_t size, uint8_t type, uint32_t *number,
                     uint32_t *answers)
{
    struct wire_reader reader = { 0 };
    struct wire_message message;
    for (size_t i = 0; i < size; i++)
        if (wire_read(&reader, frame[i], &message) == WIRE_MESSAGE && message.type == type) {
            *number = type == WIRE_STATE ? message.as.state.sequence : message.as.command.sequence;
            *answers = type == WIRE_STATE ? 0 : message.as.command.answers;
            return *number < NUMBERS;
        }
    return 0;
}

static int choose_fate(struct relay_way *way, uint8_t *frame, size_t size)
{
    struct truth *truth = (struct truth *)way;
    uint32_t number, answers;
    if (!number_of(frame, size, truth->is_commands ? WIRE_COMMAND : WIRE_STATE, &number, &answers))
        return RELAY_PASS;
    truth->sent++;
    if (truth->calm)
        return RELAY_PASS;
    /* Now and then all are held for longer than the watchdog waits. */
    if (way->turn % 9973 < 30)
        return 30 - way->turn % 9973;
    const uint64_t dice = random_bits(&truth->seed) % 1000;
    if (dice < 15)
        return RELAY_DROP;
    if (dice < 30) {
        const size_t bit = random_bits(&truth->seed) % 8,
                     at = random_bits(&truth->seed) % (size - 1);
        /* Not into a zero, which would make two damaged pieces of one frame. */
        if (frame[at] != 1 << bit) {
            frame[at] = (uint8_t)(frame[at] ^ 1 << bit);
            truth->damaged++;
        }
        return RELAY_PASS;
    }
    return dice < 60 ? 1 + (int)(random_bits(&truth->seed) % 12) : RELAY_PASS;
}

static void keep_truth(struct relay_way *way, const uint8_t *frame, size_t size)
{
    struct truth *truth = (struct truth *)way;
    uint32_t number, answers;
    if (!number_of(frame, size, truth->is_commands ? WIRE_COMMAND : WIRE_STATE, &number, &answers))
        return;
    CHECK(!truth->came[number], "number %u twice", number);
    truth->came[number] = 1;
    if (number > truth->newest) {
        truth->newest = number;
        /* The device takes it in before it makes its next sample. */
        if (truth->is_commands && simulated.device.sequence - answers > simulated.device.watchdog)
            truth->late++;
    } else {
        truth->reordered++;
    }
}

static struct truth commands, states;

static void cycle(void)
{
    relay_turn(&commands.way);
    simulate_serial_tick(&simulated);
    relay_turn(&states.way);
}

static void *keep_cycling(void *unused)
{
    while (!stop) {
        cycle();
        pause_ms(1);
    }
    return unused;
}

/* While the host blocks, the rest goes on, and the line is good. */
static void cycle_while(dpt_result (*blocking)(void), const char *what)
{
    stop = 0;
    commands.calm = states.calm = 1;
    pthread_create(&thread, NULL, keep_cycling, NULL);
    const dpt_result result = blocking();
    halt();
    commands.calm = states.calm = 0;
    CHECK(result == DPT_OK, "%s: %d %s", what, result, error.text);
}

static char middle[64];

static dpt_result open_middle(void)
{
    return open_at(middle, "?silent=60");
}

static void all_that_goes_wrong_is_counted_on_both_sides(void)
{
    uint64_t fresh = 0;
    int faults = 0;
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    memset(&commands, 0, sizeof commands);
    memset(&states, 0, sizeof states);
    commands.way.from = states.way.to = relay_pty(middle);
    commands.way.to = states.way.from = relay_open(simulated.path);
    commands.way.fate = states.way.fate = choose_fate;
    commands.way.delivered = states.way.delivered = keep_truth;
    commands.came = calloc(2, NUMBERS);
    states.came = commands.came + NUMBERS;
    commands.is_commands = 1;
    commands.seed = 10;
    states.seed = 11;
    cycle_while(open_middle, "open");
    if (!device)
        return;
    dpt_device_get_counts(device, &counts);
    dpt_device_read(device, &state);
    for (int i = 0; i < CYCLES; i++) {
        const dpt_result written = write_force(0.001 * (i % 1000));
        CHECK(written == DPT_OK || written == DPT_E_NOT_READY, "write: %d", written);
        commands.calm = states.calm = i >= CYCLES - 100;
        cycle();
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read in cycle %d", i);
        fresh += state.fresh;
        if (state.status == DPT_DEVICE_FAULT) {
            CHECK(state.reasons == DPT_REASON_WATCHDOG, "%u", state.reasons);
            faults++;
            cycle_while(clear, "clear");
        }
    }
    dpt_device_get_counts(device, &counts);
    const struct wire_device *there = &simulated.device;
    for (uint32_t i = 1; i < commands.newest; i++)
        commands.lost += !commands.came[i];
    /* States before the first one that came are none of this host's. */
    uint32_t first = 1;
    while (!states.came[first])
        first++;
    for (uint32_t i = first; i < states.newest; i++)
        states.lost += !states.came[i];
    CHECK(commands.newest == counts.commands - counts.refused && counts.refused == 0, "%u, %u",
          commands.newest, (unsigned)counts.commands);
    CHECK(there->order.lost == commands.lost && there->order.reordered == commands.reordered &&
              there->late == commands.late && there->order.repeated == 0,
          "the device counts %u lost, %u reordered, %u late, not %u, %u, %u", there->order.lost,
          there->order.reordered, there->late, commands.lost, commands.reordered, commands.late);
    CHECK(counts.missed == (uint64_t)commands.lost + commands.reordered + commands.late,
          "%u missed", (unsigned)counts.missed);
    CHECK(there->reader.damaged == commands.damaged, "%u damaged at the device, not %u",
          there->reader.damaged, commands.damaged);
    CHECK(counts.lost == states.lost && counts.reordered == states.reordered,
          "the host counts %u lost, %u reordered, not %u, %u", (unsigned)counts.lost,
          (unsigned)counts.reordered, states.lost, states.reordered);
    CHECK(counts.damaged == states.damaged, "%u damaged at the host, not %u",
          (unsigned)counts.damaged, states.damaged);
    CHECK(counts.samples == states.newest - first + 1 && counts.resets == 0, "%u samples, not %u",
          (unsigned)counts.samples, states.newest - first + 1);
    CHECK(commands.lost > 500 && commands.reordered > 500 && commands.late > 20 &&
              states.lost > 500 && states.reordered > 500 && faults > 3,
          "too little went wrong to show anything");
    CHECK(fresh > CYCLES / 2, "%u fresh", (unsigned)fresh);
    printf("    %u commands: %u lost, %u reordered, %u late; %u samples: %u lost, %u reordered; %d "
           "faults cleared\n",
           commands.newest, commands.lost, commands.reordered, commands.late,
           (unsigned)counts.samples, states.lost, states.reordered, faults);
    stop = 0;
    commands.calm = states.calm = 1;
    pthread_create(&thread, NULL, keep_cycling, NULL);
    close_device();
    halt();
    close(commands.way.from);
    close(commands.way.to);
    simulate_serial_end(&simulated);
    free(commands.came);
}

static void silence_is_loss_and_can_be_cleared(void)
{
    start(NULL, "?silent=0.2");
    write_force(1);
    simulate_serial_tick(&simulated);
    pause_ms(300);
    CHECK(dpt_device_read(device, &state) == DPT_OK, "a sample that waits is no silence");
    pause_ms(300);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.status == DPT_DEVICE_LOST &&
              state.reasons == DPT_REASON_SILENT && state.fresh == 0,
          "%u %u", state.status, state.reasons);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    /* It speaks again, its watchdog has bitten: still lost, until it is cleared. */
    for (int i = 0; i < 30; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && write_force(1) == DPT_E_LOST, "read");
    CHECK(simulated.device.reasons == WIRE_REASON_WATCHDOG && simulated.device.force[1] == 0, "%d",
          simulated.device.reasons);
    const uint64_t sequence = state.sequence;
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_READY, "read");
    CHECK(state.sequence > sequence, "its numbers begin anew");
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 1 && counts.damaged == 0, "%u", (unsigned)counts.resets);
    finish();
}

/* A fault stays until it is cleared, and while its cause is there it cannot be. */
static void faults_are_cleared(void)
{
    start(NULL, "?silent=30");
    CHECK(write_force(1) == DPT_OK, "write");
    for (int i = 0; i < 25; i++)
        simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_FAULT &&
              state.reasons == DPT_REASON_WATCHDOG,
          "%u %u", state.status, state.reasons);
    CHECK(write_force(1) == DPT_E_NOT_READY && simulated.device.force[1] == 0, "write");
    go();
    CHECK(clear() == DPT_OK, "clear");
    simulated.causes = WIRE_REASON_ESTOP;
    for (int i = 0; i < 10000 && state.reasons != DPT_REASON_ESTOP; i++) {
        pause_ms(1);
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
    CHECK(state.status == DPT_DEVICE_FAULT && state.reasons == DPT_REASON_ESTOP, "%u",
          state.reasons);
    CHECK(clear() == DPT_E_NOT_READY, "clear");
    simulated.causes = 0;
    CHECK(clear() == DPT_OK, "clear");
    halt();
    dpt_device_read(device, &state);
    CHECK(state.status == DPT_DEVICE_READY && state.reasons == 0, "%u", state.reasons);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 0, "%u", (unsigned)counts.resets);
    finish();
}

/* A host that only reads shows life, or the device would end the session after 1000 samples. */
static void a_host_that_reads_is_there(void)
{
    start(NULL, "?silent=30");
    const uint32_t begin = simulated.device.sequence;
    go();
    while (simulated.device.sequence - begin < 3000) {
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        pause_ms(5);
    }
    halt();
    CHECK(state.status == DPT_DEVICE_READY && simulated.device.session != 0, "%u", state.status);
    finish();
}

static void damage_alone_is_the_line(void)
{
    start(NULL, "?silent=0.2");
    pause_ms(300);
    CHECK(write(simulated.master, "no frame at all\0", 16) == 16, "write");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST, "read");
    CHECK(state.reasons == (DPT_REASON_SILENT | DPT_REASON_LINK), "%u", state.reasons);
    const uint8_t body[] = { WIRE_STATE, WIRE_VERSION + 1, 0, 0 };
    uint8_t frame[16];
    const size_t size = frame_of(body, sizeof body, frame);
    CHECK(write(simulated.master, frame, size) == (ssize_t)size, "write");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons & DPT_REASON_VERSION, "%u",
          state.reasons);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.damaged == 2, "%u", (unsigned)counts.damaged);
    finish();
}

static void a_device_that_begins_anew_is_noticed(void)
{
    start(NULL, "?silent=30");
    const struct wire_info info = simulated.device.info;
    for (int i = 0; i < 200; i++) {
        simulate_serial_tick(&simulated);
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
    }
    wire_device_init(&simulated.device, &info);
    for (int i = 0; i < 200; i++)
        simulate_serial_tick(&simulated);
    CHECK(write_force(1) == DPT_OK, "not known yet");
    simulate_serial_tick(&simulated);
    CHECK(simulated.device.force[1] == 0, "a command of a session that it does not know");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST, "read");
    dpt_device_get_counts(device, &counts);
    CHECK(counts.resets == 1, "%u", (unsigned)counts.resets);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_READY, "read");
    finish();
}

/* Firmware that shows life within a session, and what is left in a line of an earlier one, end none. */
static void only_a_heartbeat_without_a_session_ends_it(void)
{
    struct wire_message alive = { .type = WIRE_HEARTBEAT };
    uint8_t frame[WIRE_FRAME_MAX];
    start(NULL, "?silent=30");
    const uint16_t session = simulated.device.session,
                   sessions[] = { session, session == 7 ? 8 : 7, 0 };
    for (int i = 0; i < 3; i++) {
        alive.session = sessions[i];
        alive.as.heartbeat.sequence = simulated.device.sequence;
        const size_t size = wire_encode(&alive, frame);
        CHECK(write(simulated.master, frame, size) == (ssize_t)size, "no room");
        simulate_serial_tick(&simulated);
        const dpt_result result = dpt_device_read(device, &state);
        CHECK(result == (sessions[i] ? DPT_OK : DPT_E_LOST), "session %u of %u: %s", sessions[i],
              session, dpt_result_name(result));
    }
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    finish();
}

static void unplugged_and_plugged_in_again(void)
{
    char link[64];
    snprintf(link, sizeof link, "build/tests/serial.%ld", (long)getpid());
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    unlink(link);
    CHECK(symlink(simulated.path, link) == 0, "%s", strerror(errno));
    go();
    CHECK(open_at(link, "?answer=0.5") == DPT_OK, "%s", error.text);
    halt();
    simulate_serial_end(&simulated);
    if (!device)
        return;
    dpt_device_read(device, &state);
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_UNPLUGGED,
          "%u", state.reasons);
    CHECK(write_force(1) == DPT_E_LOST, "write");
    unlink(link);
    CHECK(clear() == DPT_E_LOST && held == 0, "clear while it is gone");
    CHECK(dpt_device_read(device, &state) == DPT_E_LOST && state.reasons == DPT_REASON_UNPLUGGED,
          "read");
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    CHECK(symlink(simulated.path, link) == 0, "%s", strerror(errno));
    CHECK(clear() == DPT_E_LOST, "clear while it does not answer");
    go();
    CHECK(clear() == DPT_OK, "clear");
    halt();
    simulate_serial_tick(&simulated);
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_READY, "%u",
          state.status);
    finish();
    unlink(link);
}

/* Nobody takes the bytes: commands are refused, none is cut in two, and those that were not arrive. */
static void a_full_line_never_blocks(void)
{
    start(NULL, "?silent=30");
    int ok = 0, busy = 0;
    for (int i = 0; i < 3000; i++) {
        const dpt_result result = write_force(1);
        CHECK(result == DPT_OK || result == DPT_E_BUSY, "%d", result);
        ok += result == DPT_OK;
        busy += result == DPT_E_BUSY;
    }
    CHECK(ok > 10 && busy > 100, "%d, %d", ok, busy);
    for (int i = 0; i < 5; i++)
        simulate_serial_tick(&simulated);
    /* The rest of one that was begun goes before the next. */
    CHECK(write_force(1) == DPT_OK, "write");
    simulate_serial_tick(&simulated);
    const struct wire_device *there = &simulated.device;
    CHECK(there->order.taken == (uint32_t)ok + 1 && there->order.lost == 0 &&
              there->reader.damaged == 0,
          "%u of %d, %u lost, %u damaged", there->order.taken, ok + 1, there->order.lost,
          there->reader.damaged);
    dpt_device_get_counts(device, &counts);
    CHECK(counts.commands == 3001 && counts.refused == (uint64_t)busy, "%u, %u",
          (unsigned)counts.commands, (unsigned)counts.refused);
    dpt_device_read(device, &state);
    finish();
}

/* However much waits: four reads, a poll, a heartbeat; and a command is one write, two after one in part. */
static void calls_are_bounded(void)
{
    struct wire_info info;
    simulate_serial_info(&info);
    info.watchdog = 10;
    start(&info, "?silent=30");
    for (int round = 0; round < 300; round++) {
        for (int i = 0; i < round; i++)
            simulate_serial_tick(&simulated);
        watched = 1;
        calls = 0;
        CHECK(dpt_device_read(device, &state) == DPT_OK, "read");
        const int reading = calls;
        calls = 0;
        write_force(1);
        watched = 0;
        CHECK(reading <= 6 && calls <= 2, "%d, %d calls", reading, calls);
    }
    finish();
}

static void refused(dpt_result result, dpt_result code, const char *word)
{
    CHECK(result == code && error.code == code, "%d: %s", result, error.text);
    CHECK(strstr(error.text, word) && strlen(error.text) < sizeof error.text - 1, "'%s' lacks '%s'",
          error.text, word);
    CHECK(device == NULL && held == 0, "%d descriptors are left", held);
}

static void refusals_say_the_cure(void)
{
    char path[64];
    refused(open_at("/dev/does-not-exist", ""), DPT_E_DEVICE, "plugged in");
    refused(open_at("/dev/null", ""), DPT_E_DEVICE, "not a serial port");
    refused(open_at("/dev/null", "?speed=1234567"), DPT_E_SETTING, "115200");
    refused(open_at("/dev/null", "?spede=9600"), DPT_E_SETTING, "spede");
    const int master = relay_pty(path);
    calls = 0;
    fail_at = 2; /* the allocation, and then open */
    fail_errno = EACCES;
    refused(open_at(path, ""), DPT_E_PERMISSION, "usermod -aG dialout");
    fail_at = 0;
    other_speed = 1;
    refused(open_at(path, ""), DPT_E_SYSTEM, "runs at 9600 baud where 1000000");
    other_speed = 0;
    refused(open_at(path, "?answer=0.2"), DPT_E_DEVICE, "no answer");
    const int line = relay_open(path);
    CHECK(flock(line, LOCK_EX) == 0, "flock");
    refused(open_at(path, ""), DPT_E_SYSTEM, "in use by another program");
    close(line);
    close(master);
}

/* Something else is at the other end: says `bytes` again and again. */
static uint8_t noise[64];
static size_t noise_size;
static int noisy;

static void *make_noise(void *unused)
{
    while (!stop) {
        if (write(noisy, noise, noise_size) < 0)
            pause_ms(1);
        pause_ms(5);
    }
    return unused;
}

static void other_devices_are_told_apart(void)
{
    char path[64];
    const uint8_t body[] = { WIRE_HEARTBEAT, 9, 0, 0 };
    noisy = relay_pty(path);
    noise_size = 16;
    memcpy(noise, "$GPGGA,123519\r\n\0", 16);
    stop = 0;
    pthread_create(&thread, NULL, make_noise, NULL);
    refused(open_at(path, "?answer=0.5"), DPT_E_DEVICE, "another speed");
    halt();
    noise_size = frame_of(body, sizeof body, noise);
    stop = 0;
    pthread_create(&thread, NULL, make_noise, NULL);
    refused(open_at(path, "?answer=0.5"), DPT_E_PROTOCOL, "version 9");
    halt();
    close(noisy);
    /* Samples that the line cannot carry. */
    struct wire_info info;
    simulate_serial_info(&info);
    CHECK(simulate_serial_start(&simulated, &info) == 0, "no pty");
    go();
    refused(open_at(simulated.path, "?speed=460800"), DPT_E_SETTING, "at least 610000 baud");
    simulated.device.info.wrench_dofs = 4;
    refused(open_at(simulated.path, ""), DPT_E_DEVICE, "makes no sense");
    halt();
    simulate_serial_end(&simulated);
}

/*
 * Each system call of an open, a few cycles, a clear and a close fails in its turn, with each of some errors: nothing
 * hangs, nothing stays open, what is refused has a reason, and a line that lives works when it is cleared.
 */
static void every_call_may_fail(void)
{
    static const int errors[] = { EIO, EINTR, EAGAIN, ENOTTY, ENOMEM };
    int walked = 0, refusals = 0;
    CHECK(simulate_serial_start(&simulated, NULL) == 0, "no pty");
    go();
    for (size_t e = 0; e < sizeof errors / sizeof *errors; e++) {
        int done = 0;
        fail_errno = errors[e];
        for (int number = 1; !done && number < 200; number++) {
            calls = 0;
            fail_at = number;
            device = NULL;
            const dpt_result opened = open_at(simulated.path, "?answer=2&silent=5");
            walked++;
            if (opened != DPT_OK) {
                refusals++;
                CHECK(device == NULL && error.text[0] && held == 0,
                      "call %d, error %d: %s, %d left", number, fail_errno, error.text, held);
                continue;
            }
            for (int i = 0; i < 3; i++) {
                watched = 1;
                const dpt_result got = dpt_device_read(device, &state);
                const dpt_result put = write_force(0.1);
                watched = 0;
                CHECK(got == DPT_OK || got == DPT_E_LOST, "call %d, error %d: read %d", number,
                      fail_errno, got);
                CHECK(put == DPT_OK || put == DPT_E_LOST || put == DPT_E_BUSY ||
                          put == DPT_E_NOT_READY,
                      "call %d, error %d: write %d", number, fail_errno, put);
            }
            clear();
            const int before = fail_at;
            fail_at = 0;
            const dpt_result cleared = clear();
            CHECK(cleared == DPT_OK, "call %d, error %d: clear %d", number, fail_errno, cleared);
            fail_at = before;
            done = calls < number;
            close_device();
        }
        CHECK(done, "error %d: no end", fail_errno);
    }
    fail_at = 0;
    halt();
    simulate_serial_end(&simulated);
    CHECK(refusals > 20, "%d", refusals);
    printf("    %d calls failed, %d opens were refused\n", walked, refusals);
}

static void count_ports(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    CHECK(driver == dpt_driver_named("serial") && !strncmp(where, "/dev/", 5) && about[0], "%s",
          where);
    ++*(int *)user;
}

static void finds_ports(void)
{
    int ports = 0;
    const dpt_driver *driver = dpt_driver_named("serial");
    driver->find(driver, count_ports, &ports);
    error.size = sizeof error;
    if (ports == 0)
        CHECK(dpt_device_open("serial", &device, &error) == DPT_E_DEVICE &&
                  strstr(error.text, "no serial port"),
              "%s", error.text);
    dpt_device_close(device);
}

int main(void)
{
    char path[64];
    const int pty = relay_pty(path);
    if (pty < 0) {
        SKIP("all of test_serial", "no pty on this machine");
        return check_report();
    }
    close(pty);
    TEST(opens_and_tells);
    TEST(closes_the_loop);
    TEST(six_freedoms_and_joints);
    TEST(all_that_goes_wrong_is_counted_on_both_sides);
    TEST(silence_is_loss_and_can_be_cleared);
    TEST(faults_are_cleared);
    TEST(a_host_that_reads_is_there);
    TEST(damage_alone_is_the_line);
    TEST(a_device_that_begins_anew_is_noticed);
    TEST(only_a_heartbeat_without_a_session_ends_it);
    TEST(unplugged_and_plugged_in_again);
    TEST(a_full_line_never_blocks);
    TEST(calls_are_bounded);
    TEST(refusals_say_the_cure);
    TEST(other_devices_are_told_apart);
    TEST(every_call_may_fail);
    TEST(finds_ports);
    return check_report();
}
