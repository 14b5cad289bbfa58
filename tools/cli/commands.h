/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The sub-commands of the program dynpoint. argv[0] is the command's own name ("make", "trace",
 * "compile", ...), its arguments follow.
 *
 * Each returns the exit status: 0 done; 1 done, and the answer is no; 2 usage, input or system
 * error, after one line on standard error.
 */
#ifndef DPT_TOOLS_COMMANDS_H
#define DPT_TOOLS_COMMANDS_H

#include <stdint.h>

int command_make(int argc, char **argv);
int command_make_trace(int argc, char **argv);
int command_compile(int argc, char **argv);
int command_info(int argc, char **argv);
int command_replay(int argc, char **argv);
int command_device(int argc, char **argv);
int command_run(int argc, char **argv);
int command_record(int argc, char **argv);
int command_plan(int argc, char **argv);
int command_plot(int argc, char **argv);
int command_chart(int argc, char **argv);
int command_force_test(int argc, char **argv);
int command_stability(int argc, char **argv);
int command_view(int argc, char **argv);

/* dynpoint device simulate. */
int device_simulate(const char *what, double swing, double seconds, int json);

/* dynpoint device identify. */
struct identify_request {
    const char *name;   /* of the device */
    const char *output; /* file, or NULL */
    uint32_t button;    /* as dpt_identify_def.button */
    int may_move, json;
};
int device_identify(const struct identify_request *request);

#endif
