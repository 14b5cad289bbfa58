/* SPDX-License-Identifier: BSD-3-Clause */
/* What the program asks of Linux and macOS. */
#ifdef __APPLE__
#define _DARWIN_C_SOURCE
#else
#define _GNU_SOURCE
#endif
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include "platform/opener.h"
#include "platform/program.h"
#include "platform/sockets.h"

extern char **environ;

char **program_begin(int *argc, char **argv)
{
    (void)argc;
    return argv;
}

/* ---- signals ---- */

static void (*call_stop)(void);

static void on_signal(int number)
{
    (void)number;
    call_stop();
}

void program_watch(void (*stop)(void), double seconds)
{
    struct sigaction action = { .sa_handler = on_signal }, before;
    call_stop = stop;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGPIPE, &action, NULL);
    /* nohup ignores SIGHUP: leave it so. */
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
    if (seconds < 1e9) {
        struct itimerval timer = { .it_value = { (time_t)seconds,
                                                 (suseconds_t)(1e6 * (seconds - (double)(time_t)seconds)) } };
        /* A timer of 0 would be none. */
        if (seconds < 1e-6)
            timer.it_value.tv_usec = 1;
        sigaction(SIGALRM, &action, NULL);
        setitimer(ITIMER_REAL, &timer, NULL);
    }
}

void program_ignore_file_limit(void)
{
    signal(SIGXFSZ, SIG_IGN);
}

void program_ignore_closed_pipe(void)
{
    signal(SIGPIPE, SIG_IGN);
}

void program_keep_closed_pipe(void (*call)(void *user), void *user)
{
    struct sigaction pipe;
    sigaction(SIGPIPE, NULL, &pipe);
    call(user);
    sigaction(SIGPIPE, &pipe, NULL);
}

/* ---- keys ---- */

void keyboard_open(struct keyboard *keyboard)
{
    struct termios *before = malloc(sizeof *before);
    *keyboard = (struct keyboard){ .before = before };
    if (!before || !isatty(STDIN_FILENO) || tcgetattr(STDIN_FILENO, before) != 0)
        return;
    /* Keys arrive as they are pressed, and reads do not wait. */
    struct termios raw = *before;
    raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    raw.c_cc[VMIN] = raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
    keyboard->is_terminal = 1;
}

int keyboard_is_pressed(const struct keyboard *keyboard)
{
    char key;
    return keyboard->is_terminal && read(STDIN_FILENO, &key, 1) == 1;
}

void keyboard_close(struct keyboard *keyboard)
{
    if (keyboard->is_terminal)
        tcsetattr(STDIN_FILENO, TCSANOW, keyboard->before);
    free(keyboard->before);
    *keyboard = (struct keyboard){ .before = NULL };
}

/* ---- other programs ---- */

int program_run(const char *const *words, const char *output)
{
    pid_t child;
    int status;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    const int failed = posix_spawn(&child, words[0], &actions, NULL, (char *const *)(size_t)words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed)
        return 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return 0;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/* Silent, and with the signals as a shell would give them. */
static int start_opener(const char *path, pid_t *process)
{
    char *const words[] = { (char *)(size_t)opener_name, (char *)(size_t)path, NULL };
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    if (posix_spawn_file_actions_init(&files))
        return 0;
    if (posix_spawnattr_init(&attributes)) {
        posix_spawn_file_actions_destroy(&files);
        return 0;
    }
    int result = 0;
    for (int stream = 0; stream < 3 && !result; stream++)
        result = posix_spawn_file_actions_addopen(&files, stream, "/dev/null", stream ? O_WRONLY : O_RDONLY, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    if (!result)
        result = posix_spawnp(process, words[0], &files, &attributes, words, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return result == 0;
}

const char *program_open_document(const char *path, long *process)
{
    pid_t opener = 0;
    if (!start_opener(path, &opener)) {
        *process = 0;
        return opener_is_missing;
    }
    *process = (long)opener;
    return NULL;
}

void program_forget(long process)
{
    if (process > 0)
        waitpid((pid_t)process, NULL, WNOHANG);
}

int sockets_have_local_6(void)
{
    const struct sockaddr_in6 address = { .sin6_family = AF_INET6, .sin6_addr = IN6ADDR_LOOPBACK_INIT };
    const int probe = socket(AF_INET6, SOCK_STREAM, 0);
    if (probe < 0)
        return 0;
    const int result = bind(probe, (const struct sockaddr *)&address, sizeof address);
    close(probe);
    return result == 0;
}
