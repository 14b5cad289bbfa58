/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "measure/measure_machine.h"

#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

#include "dynpoint/kernel.h"

#ifdef __clang__
#define COMPILER "clang " __clang_version__
#elif defined __GNUC__
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown compiler"
#endif

static void take_text(char *to, size_t room, const char *from)
{
    size_t n = 0;
    for (; *from && n + 1 < room; from++)
        if (*from >= ' ' && *from <= '~' && !strchr("\"\\*/", *from))
            to[n++] = *from;
    while (n > 0 && to[n - 1] == ' ')
        n--;
    to[n] = '\0';
}

/* The line of Linux, if there is one. */
static void find_processor(char *to, size_t room)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (!strncmp(line, "model name", 10) && colon && colon[1]) {
            take_text(to, room, colon + 2);
            break;
        }
    }
    if (file)
        fclose(file);
}

void measure_machine_read(struct measure_machine *machine, uint32_t kernel)
{
    struct utsname name;
    char system[sizeof name.sysname + sizeof name.release + 2] = "unknown system";
    const int is_known = uname(&name) >= 0;
    if (is_known)
        snprintf(system, sizeof system, "%s %s", name.sysname, name.release);
    take_text(machine->processor, sizeof machine->processor, is_known ? name.machine : "unknown");
    find_processor(machine->processor, sizeof machine->processor);
    take_text(machine->system, sizeof machine->system, system);
    take_text(machine->compiler, sizeof machine->compiler, COMPILER);
    take_text(machine->version, sizeof machine->version, dpt_version());
    take_text(machine->kernel, sizeof machine->kernel, dpt_kernel_name(kernel));
}
