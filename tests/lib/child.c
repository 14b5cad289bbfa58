/* SPDX-License-Identifier: BSD-3-Clause */
#define _GNU_SOURCE
#include "lib/child.h"

#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

int child_start(struct child *child, char *const *words)
{
    int ends[2];
    memset(child, 0, sizeof *child);
    child->status = 127;
    if (pipe(ends))
        return 0;
    child->process = fork();
    if (child->process == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(ends[1], STDERR_FILENO);
        /* What the test holds is not the program's: a line is cut when the test closes it. */
        for (int file = 3; file < 256; file++)
            close(file);
        execv(words[0], words);
        _exit(127);
    }
    close(ends[1]);
    child->from = ends[0];
    return child->process > 0;
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int child_has_ended(const struct child *child)
{
    siginfo_t info = { .si_pid = 0 };
    return waitid(P_PID, (id_t)child->process, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != 0;
}

int child_end(struct child *child, double seconds)
{
    const double deadline = now() + seconds;
    size_t used = 0;
    int is_open = 1, status = 0;
    /* Its outputs close when it ends. What is more than `text` holds is read and left out. */
    for (double left = seconds; is_open && left > 0.0; left = deadline - now()) {
        char more[512];
        struct pollfd ready = { .fd = child->from, .events = POLLIN };
        if (poll(&ready, 1, (int)(1e3 * left) + 1) <= 0)
            continue;
        const ssize_t count = read(child->from, more, sizeof more);
        is_open = count > 0;
        for (ssize_t i = 0; i < count && used + 1 < sizeof child->text; i++)
            child->text[used++] = more[i];
    }
    child->text[used] = 0;
    close(child->from);
    if (is_open)
        kill(child->process, SIGKILL);
    waitpid(child->process, &status, 0);
    child->process = 0;
    child->status = is_open ? -1 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return !is_open;
}
