/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint device simulate: the other end of a line, with dynamics, so that the loop closes on one machine. */
#include <string.h>

#include "../drivers/simulate_serial.h"
#include "command.h"
#include "common.h"
#include "stop.h"

int device_simulate(const char *what, double swing, double seconds)
{
    static struct simulate_serial simulated;
    if (strcmp(what, "serial") != 0)
        return complain("device", "simulate: there is no '%s', only serial", what);
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
