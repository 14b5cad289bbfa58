/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include "firmware/emulator.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

int emulator_start(struct emulator *emulator, char *const *command)
{
    int ends[2];
    emulator->line[0] = 0;
    emulator->process = 0;
    if (pipe(ends) || (emulator->process = fork()) < 0)
        return 0;
    if (emulator->process == 0) {
        dup2(ends[1], 1);
        dup2(ends[1], 2);
        close(ends[0]);
        execvp(command[0], command);
        _exit(127);
    }
    close(ends[1]);
    FILE *said = fdopen(ends[0], "r");
    char text[256];
    while (!emulator->line[0] && fgets(text, sizeof text, said)) {
        const char *name = strstr(text, "redirected to ");
        if (name)
            sscanf(name, "redirected to %63s", emulator->line);
        else
            printf("    %s", text);
    }
    fclose(said);
    return emulator->line[0] != 0;
}

void emulator_kill(struct emulator *emulator)
{
    if (emulator->process > 0) {
        kill(emulator->process, SIGKILL);
        waitpid(emulator->process, NULL, 0);
    }
    emulator->process = 0;
}
