/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The driver's device at one end of a pty and the simulated one at the other: a real line but for its speed. Where no
 * pty can do it (another speed than was asked for, no permission, calls that fail) the call is wrapped by the linker,
 * for the driver alone. So is the clock: it is made up, and goes on where the driver waits, so that nothing depends on
 * how busy the machine is.
 */
#ifndef DPT_TESTS_SERIAL_FIXTURE_H
#define DPT_TESTS_SERIAL_FIXTURE_H

#include "drivers/relay.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <time.h>

#include "dynpoint/device.h"
#include "lib/check.h"
#include "platform/serial_line.h"
#include "simulate/simulate_serial.h"

/*
 * Calls of the driver, while `watched`: counted, and the one of number `fail_at` fails with fail_errno. `held` is
 * how many descriptors it has open.
 */
static int watched;
static int calls, fail_at, fail_errno, held, descriptor, not_a_tty, other_speed;

static inline int fails(void)
{
    if (!watched || ++calls != fail_at)
        return 0;
    errno = fail_errno;
    return 1;
}

/* The made-up clock. What happens in each millisecond of it: a device's tick; NULL: nothing. */
static uint64_t now_ns = 1000000000u;
static void (*each_ms)(void);

static inline void pause_ms(long milliseconds)
{
    const int was_watched = watched;
    watched = 0;
    for (long i = 0; i < milliseconds; i++) {
        now_ns += 1000000u;
        if (each_ms)
            each_ms();
    }
    watched = was_watched;
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
int __wrap_clock_gettime(clockid_t clock, struct timespec *time);

int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
    (void)clock;
    now_ns += 1000;
    *time = (struct timespec){ (time_t)(now_ns / 1000000000u), (long)(now_ns % 1000000000u) };
    return 0;
}

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
    if (fails())
        return -1;
    for (;;) {
        const int ready = __real_poll(lines, count, 0);
        if (ready != 0 || timeout-- <= 0)
            return ready;
        pause_ms(1);
    }
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

/* The simulated device. From go() to halt() it runs while the driver waits; apart from that, a test ticks it. */
static struct simulate_serial simulated;

static inline void tick_simulated(void)
{
    simulate_serial_tick(&simulated);
}

static inline void go(void)
{
    each_ms = tick_simulated;
}

static inline void halt(void)
{
    each_ms = NULL;
}

static dpt_device *device;
static dpt_device_error error;
static dpt_device_state state;
static dpt_device_counts counts;

static inline dpt_result open_at(const char *path, const char *settings)
{
    char name[512];
    snprintf(name, sizeof name, "serial:%s%s", path, settings);
    error.size = sizeof error;
    state.size = sizeof state;
    counts.size = sizeof counts;
    watched = 1;
    const dpt_result result = dpt_device_open(name, &device, &error);
    watched = 0;
    return result;
}

static inline dpt_result clear(void)
{
    watched = 1;
    const dpt_result result = dpt_device_clear(device);
    watched = 0;
    return result;
}

static inline void close_device(void)
{
    watched = 1;
    dpt_device_close(device);
    watched = 0;
    device = NULL;
    CHECK(held == 0, "%d descriptors are left", held);
}

static inline dpt_result write_force(double y)
{
    const dpt_wrench wrench = { { 0, y, 0 }, { 0, 0, 0 } };
    return dpt_device_write(device, &wrench);
}

/* Open, with the device running, and then not any more. */
static inline void start(const struct wire_info *info, const char *settings)
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

static inline void finish(void)
{
    go();
    close_device();
    halt();
    CHECK(simulated.device.is_enabled == 0 && simulated.device.reasons == 0, "motors are on after close");
    simulate_serial_end(&simulated);
}

/* Whether this machine has ptys; what needs them is named as skipped where it has none. */
static inline int has_ptys(const char *what)
{
    char path[64];
    const int pty = relay_pty(path);
    if (pty < 0)
        SKIP(what, "no pty on this machine");
    else
        close(pty);
    return pty >= 0;
}

#endif
