/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A scene on a haptic device, and safely so: the coupling is the stiffest that the device can hold, energy that the scene
 * would give the hand is taken away, and the force ends within five ticks when anything falls silent.
 *
 *     cc safe_device.c $(pkg-config --cflags --libs libdynpoint_host) -o safe_device
 *     ./safe_device liver 'sim:?hand=press' 3000
 *     ./safe_device scene.json serial:/dev/ttyACM0
 */
#include <dynpoint/host.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

static dpt_host *host;

static void interrupted(int signal)
{
    (void)signal;
    dpt_host_stop(host);
}

int main(int argc, char **argv)
{
    dpt_host_def def;
    dpt_host_error error = { .size = sizeof error };
    dpt_host_info info = { .size = sizeof info };
    dpt_host_def_init(&def);
    def.scene = argc > 1 ? argv[1] : "liver";
    def.device = argc > 2 ? argv[2] : "sim:?hand=press&live=1";
    def.ticks = argc > 3 ? strtoul(argv[3], NULL, 10) : 0;

    dpt_result result = dpt_host_open(&def, &host, &error);
    if (error.text[0])
        fprintf(stderr, "%s\n", error.text);
    if (result != DPT_OK)
        return 2;
    signal(SIGINT, interrupted);
    result = dpt_host_run(host, NULL, &error);

    dpt_host_get_info(host, &info);
    printf("%.0f ticks, in contact on %.0f, at most %.2f N, coupled by %.4g N/m\n", (double)info.ticks,
           (double)info.contacts, info.force_max, info.stiffness);
    if (info.trouble[0])
        fprintf(stderr, "%s\n", info.trouble);
    dpt_host_close(host, NULL);
    if (result != DPT_OK)
        fprintf(stderr, "%s\n", error.text);
    return result == DPT_OK && !info.trouble[0] ? 0 : 2;
}
