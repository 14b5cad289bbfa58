/* SPDX-License-Identifier: BSD-3-Clause */
/* The program: hands the rest of the line to a sub-command. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/complete.h"
#include "platform/program.h"
#include "text/near_word.h"

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

enum { COMMANDS = sizeof commands / sizeof *commands };

static void print_help(void)
{
    puts("usage: dynpoint COMMAND ...\n\nLets a line-shaped tool feel triangle meshes.\n");
    for (size_t i = 0; i < COMMANDS; i++)
        printf("  %-11s %s\n", commands[i].name, commands[i].what);
    puts("\ndynpoint help COMMAND, or COMMAND --help, tells more; dynpoint --version tells the version.\n"
         "Exit status: 0 done, 1 done and the answer is no, 2 usage, input or system error, or ticks\n"
         "went wrong (docs/index.md).");
}

/* Their names, ended by NULL. */
static void list_names(const char *names[COMMANDS + 2])
{
    size_t count = 0;
    for (; count < COMMANDS; count++)
        names[count] = commands[count].name;
    names[count++] = "help";
    names[count] = NULL;
}

static int find_command(const char *name)
{
    for (int i = 0; i < COMMANDS; i++)
        if (strcmp(name, commands[i].name) == 0)
            return i;
    return -1;
}

static int complain_of_command(const char *name)
{
    const char *names[COMMANDS + 2];
    struct near_word near = near_word_begin(name, strlen(name));
    list_names(names);
    for (const char **known = names; *known; known++)
        near_word_try(&near, *known);
    if (near.word)
        return complain(name, "no such command; did you mean %s? (see --help)", near.word);
    return complain(name, "no such command (see --help)");
}

/* Run a command with one word more: before the words that follow its name, or behind them. */
static int run_with(int argc, char **argv, char *more, int is_first)
{
    const int command = find_command(argv[0]);
    if (command < 0)
        return complain_of_command(argv[0]);
    char **words = calloc((size_t)argc + 2, sizeof *words);
    if (!words)
        return complain(argv[0], "memory ran out");
    words[0] = argv[0];
    words[is_first ? 1 : argc] = more;
    for (int i = 1; i < argc; i++)
        words[i + is_first] = argv[i];
    const int status = commands[command].run(argc + 1, words);
    free(words);
    return status;
}

static int help(int argc, char **argv)
{
    static char option[] = "--help";
    if (argc > 1)
        return run_with(argc - 1, argv + 1, option, 0);
    print_help();
    return 0;
}

/* `dynpoint complete WORD...`, for the shells' scripts (complete.h). */
static int complete(int argc, char **argv)
{
    static const char *const options[] = { "--help", "--version", NULL };
    static char marked[] = COMPLETE_ARGUMENT;
    const char *names[COMMANDS + 2], *text = argv[argc - 1];
    list_names(names);
    if (argc > 2 && strcmp(argv[1], "help") && find_command(argv[1]) >= 0)
        return run_with(argc - 1, argv + 1, marked, 1);
    if (argc == 2 || (argc == 3 && !strcmp(argv[1], "help")))
        complete_words(text, text[0] == '-' ? options : names);
    return 0;
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return complain("", "a command is needed (see --help)");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0)
        return help(argc - 1, argv + 1);
    if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "-V") == 0) {
        printf("dynpoint %s\n", dpt_version());
        return 0;
    }
    if (strcmp(argv[1], "complete") == 0)
        return argc > 2 ? complete(argc - 1, argv + 1) : 0;
    const int command = find_command(argv[1]);
    return command < 0 ? complain_of_command(argv[1]) : commands[command].run(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    char **arguments = program_begin(&argc, argv);
    int status = run(argc, arguments);
    return status == 2 ? 2 : flush_stdout("") ? 2 : status;
}
