/* SPDX-License-Identifier: BSD-3-Clause */
/* The program: hands the rest of the line to a sub-command. */
#include <stdio.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *what;
} commands[] = {
    { "make", command_make, "generate a mesh, or a motion over one" },
    { "compile", command_compile, "turn OBJ, STL, PLY, OFF or URDF into a .dpa file" },
    { "info", command_info, "show or verify a .dpa file" },
    { "replay", command_replay, "move a tool along a trace, or prove that a recording gives the same bits" },
    { "device", command_device, "list, watch, test or simulate haptic devices" },
    { "run", command_run, "feel a mesh with a device, live" },
    { "view", command_view, "show a mesh, a scene or a recording in a browser" },
    { "record", command_record, "show a recording of a run, or export it as CSV" },
    { "plot", command_plot, "draw force, depth and energy of a run, or of two, as an SVG" },
    { "plan", command_plan, "find the cheapest setting that keeps a scene within bounds" },
    { "chart", command_chart, "draw speed against accuracy of every method and law over a scene" },
    { "force-test", command_force_test, "test on a mesh whether a force can be held: turns, jumps, energy" },
    { "stability", command_stability, "break methods of force on purpose, and say which hold" },
};

static void print_help(void)
{
    puts("usage: dynpoint COMMAND ...\n\nLets a line-shaped tool feel triangle meshes.\n");
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        printf("  %-11s %s\n", commands[i].name, commands[i].what);
    puts("\ndynpoint COMMAND --help tells more; dynpoint --version tells the version.\n"
         "Exit status: 0 done, 1 done and the answer is no, 2 usage, input or system error, or ticks\n"
         "went wrong (docs/index.md).");
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return complain("", "a command is needed (see --help)");
    if (strcmp(argv[1], "--help") == 0) {
        print_help();
        return 0;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("dynpoint %s\n", dpt_version());
        return 0;
    }
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(argv[1], commands[i].name))
            continue;
        return commands[i].run(argc - 1, argv + 1);
    }
    return complain(argv[1], "no such command (see --help)");
}

int main(int argc, char **argv)
{
    int status = run(argc, argv);
    return status == 2 ? 2 : flush_stdout("") ? 2 : status;
}
