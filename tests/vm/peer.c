/* SPDX-License-Identifier: BSD-3-Clause */
#include "vm/peer.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* A line of at most `size` - 1 bytes into `line`, if it comes in time. */
static int next_line(int from, char *line, size_t size, int seconds)
{
    size_t used = 0;
    struct pollfd ready = { .fd = from, .events = POLLIN };
    while (used + 1 < size) {
        if (poll(&ready, 1, 1000 * seconds) == 0)
            return ETIMEDOUT;
        const ssize_t count = read(from, line + used, 1);
        if (count <= 0)
            return EPIPE;
        if (line[used] == '\n')
            break;
        used++;
    }
    line[used] = 0;
    return 0;
}

static void end(struct peer *peer)
{
    kill(peer->process, SIGKILL);
    waitpid(peer->process, NULL, 0);
    close(peer->said);
}

int peer_start(struct peer *peer, const char *arguments)
{
    const char *program = getenv("DPT_PEER");
    char command[1024], line[16];
    int pipes[2];
    memset(peer, 0, sizeof *peer);
    if (!program || snprintf(command, sizeof command, "exec %s %s", program, arguments) >= (int)sizeof command)
        return ENOENT;
    if (pipe(pipes))
        return errno;
    peer->said = pipes[0];
    peer->process = fork();
    if (peer->process == 0) {
        dup2(pipes[1], STDOUT_FILENO);
        close(pipes[0]);
        close(pipes[1]);
        execl("/bin/sh", "sh", "-c", command, (char *)NULL);
        _exit(127);
    }
    close(pipes[1]);
    const int result = peer->process < 0 ? errno : next_line(peer->said, line, sizeof line, 60);
    if (result || strcmp(line, "ready")) {
        end(peer);
        return result ? result : EPIPE;
    }
    return 0;
}

int peer_stop(struct peer *peer)
{
    kill(peer->process, SIGTERM);
    const int result = next_line(peer->said, peer->report, sizeof peer->report, 10);
    end(peer);
    return result;
}

double peer_number(const struct peer *peer, const char *name)
{
    char key[128];
    snprintf(key, sizeof key, "\"%s\": ", name);
    const char *at = strstr(peer->report, key);
    return at ? strtod(at + strlen(key), NULL) : NAN;
}
