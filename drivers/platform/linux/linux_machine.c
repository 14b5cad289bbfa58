/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include <errno.h>
#include <linux/serial.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/random.h>
#include <sys/utsname.h>

#include "platform/library.h"
#include "platform/machine.h"
#include "platform/opener.h"
#include "platform/serial_latency.h"

const char *const library_names_of_hd[] = { "libHD.so", "libHD.so.3.4", "libHD.so.3.0", NULL };
const char library_names_text_of_hd[] = "libHD.so, .3.4 or .3.0";

const char opener_name[] = "xdg-open", opener_is_missing[] = "xdg-open cannot be started (Debian: xdg-utils)";

void machine_processor(char *text, size_t room)
{
    char line[256];
    struct utsname name;
    snprintf(text, room, "%s", uname(&name) >= 0 ? name.machine : "unknown");
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (!strncmp(line, "model name", 10) && colon && colon[1]) {
            snprintf(text, room, "%s", colon + 2);
            break;
        }
    }
    if (file)
        fclose(file);
}

int machine_random(void *bytes, size_t size)
{
    ssize_t got;
    do
        got = getrandom(bytes, size, 0);
    while (got < 0 && errno == EINTR);
    return got == (ssize_t)size ? 0 : -1;
}

int serial_lower_latency(int line)
{
    struct serial_struct serial;
    if (ioctl(line, TIOCGSERIAL, &serial))
        return -1;
    serial.flags = (int)((unsigned)serial.flags | ASYNC_LOW_LATENCY);
    return ioctl(line, TIOCSSERIAL, &serial) ? -1 : 0;
}
