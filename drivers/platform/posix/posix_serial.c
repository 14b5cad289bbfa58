/* SPDX-License-Identifier: BSD-3-Clause */
#ifdef __APPLE__
#define _DARWIN_C_SOURCE
#else
#define _GNU_SOURCE
#endif
#include "platform/serial_line.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include "platform/clock.h"
#include "platform/serial_latency.h"
#include "settings.h"

#define SPEED(baud) { baud, B##baud },
static const struct {
    uint32_t baud;
    speed_t code;
} speeds[] = {
    /* clang-format off */
    SPEED(1200) SPEED(2400) SPEED(4800) SPEED(9600) SPEED(19200) SPEED(38400)
#ifdef B57600
    SPEED(57600) SPEED(115200)
#endif
#ifdef B230400
    SPEED(230400)
#endif
#ifdef B460800
    SPEED(460800)
#endif
#ifdef B500000
    SPEED(500000)
#endif
#ifdef B576000
    SPEED(576000)
#endif
#ifdef B921600
    SPEED(921600)
#endif
#ifdef B1000000
    SPEED(1000000) SPEED(1152000) SPEED(1500000) SPEED(2000000)
#endif
#ifdef B2500000
    SPEED(2500000) SPEED(3000000) SPEED(3500000) SPEED(4000000)
#endif
    /* clang-format on */
};
#define SPEEDS (sizeof speeds / sizeof *speeds)

static uint32_t baud_of(speed_t code)
{
    for (size_t i = 0; i < SPEEDS; i++)
        if (speeds[i].code == code)
            return speeds[i].baud;
    return 0;
}

static dpt_result explain_open_error(const char *path, int reason, dpt_device_error *error)
{
    switch (reason) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
    case EIO:
        return device_error(error, DPT_E_DEVICE,
                            "%.60s is not there: is the device plugged in and switched on? Ports are "
                            "/dev/ttyACM*, /dev/ttyUSB* and /dev/serial/by-id/*",
                            path);
    case EACCES:
    case EPERM:
        return device_error(error, DPT_E_PERMISSION,
                            "no permission for %.60s: join its group and log in again: sudo usermod -aG dialout $USER",
                            path);
    case EBUSY:
    case EWOULDBLOCK:
        return device_error(error, DPT_E_SYSTEM,
                            "%.60s is in use by another program: end that one first; fuser -v %.60s names it", path,
                            path);
    default:
        return device_error(error, DPT_E_SYSTEM, "%.60s: %.80s", path, strerror(reason));
    }
}

/* 1 for an error of an optional request: a pty and many USB adapters do not have it. */
static int is_optional_failure(int reason)
{
    return reason == ENOTTY || reason == EINVAL || reason == EOPNOTSUPP || reason == ENOSYS || reason == EPERM ||
           reason == EACCES;
}

/*
 * Modem lines that tell a board that a host is there (many boards wait for them), and low latency. Both are optional.
 */
static int set_optional(int fd)
{
    int lines = TIOCM_DTR | TIOCM_RTS;
    if (ioctl(fd, TIOCMBIS, &lines) && !is_optional_failure(errno))
        return -1;
    return serial_lower_latency(fd) && !is_optional_failure(errno) ? -1 : 0;
}

static void make_raw(struct termios *settings)
{
    settings->c_iflag = IGNBRK;
    settings->c_oflag = 0;
    settings->c_lflag = 0;
    settings->c_cflag = CS8 | CREAD | CLOCAL;
    /* With VMIN 0 a line without bytes would read like an unplugged one. */
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
}

static dpt_result set_up_port(int fd, const char *path, size_t speed, dpt_device_error *error)
{
    struct termios settings, read_back;
    if (tcgetattr(fd, &settings))
        return errno == ENOTTY || errno == EINVAL
                   ? device_error(error, DPT_E_DEVICE, "%.60s is not a serial port", path)
                   : explain_open_error(path, errno, error);
    /*
     * flock keeps out other hosts that lock, also those of root. TIOCEXCL makes every other open fail, except root's.
     */
    if ((flock(fd, LOCK_EX | LOCK_NB) && !is_optional_failure(errno)) ||
        (ioctl(fd, TIOCEXCL) && !is_optional_failure(errno)))
        return explain_open_error(path, errno, error);
    make_raw(&settings);
    const uint32_t baud = speeds[speed].baud;
    if (cfsetispeed(&settings, speeds[speed].code) || cfsetospeed(&settings, speeds[speed].code) ||
        tcsetattr(fd, TCSANOW, &settings))
        return device_error(error, DPT_E_SYSTEM,
                            "%.60s does not take %u baud (%.60s): choose another by ?speed=, the same as the device's",
                            path, (unsigned)baud, strerror(errno));
    if (tcgetattr(fd, &read_back))
        return explain_open_error(path, errno, error);
    if (cfgetospeed(&read_back) != speeds[speed].code || cfgetispeed(&read_back) != speeds[speed].code)
        return device_error(error, DPT_E_SYSTEM,
                            "%.60s runs at %u baud where %u were asked for: it does not have that "
                            "speed; choose one by ?speed=, the same as the device's",
                            path, (unsigned)baud_of(cfgetospeed(&read_back)), (unsigned)baud);
    if ((read_back.c_cflag & (CSIZE | PARENB | CSTOPB)) != CS8 || read_back.c_iflag & (ISTRIP | IXON | ICRNL) ||
        read_back.c_lflag & (ICANON | ECHO) || read_back.c_oflag & OPOST)
        return device_error(error, DPT_E_SYSTEM, "%.60s does not carry plain bytes of 8 bits", path);
    if (set_optional(fd) || (tcflush(fd, TCIOFLUSH) && !is_optional_failure(errno)))
        return explain_open_error(path, errno, error);
    return DPT_OK;
}

dpt_result serial_line_open(const char *path, uint32_t speed, int *fd, dpt_device_error *error)
{
    *fd = -1;
    size_t index = 0;
    while (index < SPEEDS && speeds[index].baud != speed)
        index++;
    if (index == SPEEDS)
        return device_error(error, DPT_E_SETTING,
                            "%u baud is not a speed that this system has; 115200, 921600 and 1000000 are common",
                            (unsigned)speed);
    const int opened = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (opened < 0)
        return explain_open_error(path, errno, error);
    const dpt_result result = set_up_port(opened, path, index, error);
    if (result == DPT_OK)
        *fd = opened;
    else
        close(opened);
    return result;
}

static int is_temporary(int reason)
{
    return reason == EAGAIN || reason == EWOULDBLOCK || reason == EINTR;
}

long serial_line_read(int fd, void *bytes, size_t size)
{
    const ssize_t count = read(fd, bytes, size);
    if (count > 0)
        return (long)count;
    if (count < 0)
        return is_temporary(errno) ? 0 : -1;
    struct pollfd line = { fd, POLLIN, 0 };
    if (poll(&line, 1, 0) < 0)
        return is_temporary(errno) ? 0 : -1;
    return line.revents & (POLLHUP | POLLERR | POLLNVAL) ? -1 : 0;
}

long serial_line_write(int fd, const void *bytes, size_t size)
{
    const ssize_t count = write(fd, bytes, size);
    if (count >= 0)
        return (long)count;
    return is_temporary(errno) ? 0 : -1;
}

void serial_line_wait(int fd, uint64_t deadline)
{
    const uint64_t now = clock_now();
    const uint64_t left = deadline > now ? (deadline - now) / 1000000 + 1 : 0;
    struct pollfd line = { fd, POLLIN, 0 };
    poll(&line, 1, left < 20 ? (int)left : 20);
}

void serial_line_close(int fd)
{
    tcflush(fd, TCIOFLUSH);
    ioctl(fd, TIOCNXCL);
    close(fd);
}

static const struct {
    const char *prefix;
    const char *about;
} ports[] = {
    { "ttyACM", "USB device with a serial line of its own" },
    { "ttyUSB", "USB adapter to a serial line" },
    { "cu.usb", "USB serial line" },
};

void serial_line_find(void (*found)(void *user, const char *path, const char *about), void *user)
{
    DIR *folder = opendir("/dev");
    if (!folder)
        return;
    for (const struct dirent *entry; (entry = readdir(folder));)
        for (size_t i = 0; i < sizeof ports / sizeof *ports; i++)
            if (!strncmp(entry->d_name, ports[i].prefix, strlen(ports[i].prefix))) {
                char path[300];
                snprintf(path, sizeof path, "/dev/%s", entry->d_name);
                found(user, path, ports[i].about);
            }
    closedir(folder);
}

int serial_line_simulate(char *path, size_t room)
{
    const int line = posix_openpt(O_RDWR | O_NOCTTY);
    if (line < 0)
        return -1;
    const char *name = NULL;
    struct termios settings;
    if (fcntl(line, F_SETFD, FD_CLOEXEC) == 0 && fcntl(line, F_SETFL, O_NONBLOCK) == 0 && !grantpt(line) &&
        !unlockpt(line))
        name = ptsname(line);
    /* Make it raw, or the line would echo what the device sends before a host has set it up. */
    if (name && strlen(name) < room && !tcgetattr(line, &settings)) {
        strcpy(path, name);
        cfmakeraw(&settings);
        if (!tcsetattr(line, TCSANOW, &settings))
            return line;
    }
    const int reason = errno ? errno : ENAMETOOLONG;
    close(line);
    errno = reason;
    return -1;
}
