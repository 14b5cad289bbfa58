/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint device simulate: a simulated device at the other end of a line, so that the loop closes on one machine. */
#include <string.h>

#include "built_with.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/stop.h"
#include "simulate/simulate_can.h"
#include "simulate/simulate_serial.h"

#define LEFT_OUT "simulate: this build has no back end '%s': run make again with it among DRIVERS"

#ifdef DPT_HAS_SERIAL

static int simulate_serial(double swing, double seconds)
{
    static struct simulate_serial simulated;
    int reason = simulate_serial_start(&simulated, NULL);
    if (reason)
        return complain("device", "simulate: no pseudo-terminal: %s", strerror(reason));
    simulated.swing = swing;
    printf("serial:%s\n", simulated.path);
    fflush(stdout);
    stop_watch(NULL, seconds);
    simulate_serial_run(&simulated, stop_flag());
    simulate_serial_end(&simulated);
    return 0;
}

#else

static int simulate_serial(double swing, double seconds)
{
    (void)swing, (void)seconds;
    return complain("device", LEFT_OUT, "serial");
}

#endif

#ifdef DPT_HAS_CAN

static int simulate_can(const char *where, double swing, double seconds)
{
    static struct simulate_can simulated;
    dpt_device_error error = { .size = sizeof error };
    if (simulate_can_start(&simulated, where, &error) != DPT_OK)
        return complain("device", "simulate: can:%s: %s", where, error.text);
    simulated.swing = swing;
    printf("can:%s\n", where);
    fflush(stdout);
    stop_watch(NULL, seconds);
    simulate_can_run(&simulated, stop_flag());
    simulate_can_end(&simulated);
    return 0;
}

#else

static int simulate_can(const char *where, double swing, double seconds)
{
    (void)where, (void)swing, (void)seconds;
    return complain("device", LEFT_OUT, "can");
}

#endif

int device_simulate(const char *what, double swing, double seconds)
{
    if (!strcmp(what, "serial"))
        return simulate_serial(swing, seconds);
    if (!strncmp(what, "can:", 4))
        return simulate_can(what + 4, swing, seconds);
    return complain("device", "simulate: there is no '%s', only serial and can:INTERFACE?arm=...", what);
}
