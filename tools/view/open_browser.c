/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/open_browser.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Nothing in it ends an attribute of HTML. */
static int is_plain(const char *url)
{
    return url[0] != '\0' && url[strspn(url, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                             "0123456789:/.#[]-_")] == '\0';
}

static int make_folder(const char *parent, char *folder, size_t room)
{
    if (!parent || !parent[0])
        return 0;
    const int size = snprintf(folder, room, "%s/dynpoint-XXXXXX", parent);
    return size > 0 && (size_t)size < room && mkdtemp(folder) != NULL;
}

static int write_file(const char *path, const char *url)
{
    const int number = open(path, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC | O_NOFOLLOW, 0600);
    FILE *file = number < 0 ? NULL : fdopen(number, "w");
    if (!file)
        return 0;
    const int size = fprintf(file,
                             "<!doctype html><meta charset=\"utf-8\"><title>dynpoint</title>"
                             "<meta name=\"referrer\" content=\"no-referrer\">"
                             "<meta http-equiv=\"refresh\" content=\"0;url=%s\"><a href=\"%s\">dynpoint view</a>\n",
                             url, url);
    return fclose(file) == 0 && size > 0;
}

/* Silent, and with the signals as a shell would give them. */
static int start_opener(const char *path, pid_t *opener)
{
    char *const words[] = { (char[]){ "xdg-open" }, (char *)(size_t)path, NULL };
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
        result = posix_spawnp(opener, words[0], &files, &attributes, words, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    return result == 0;
}

const char *view_open_browser(const char *url, struct opened_browser *browser)
{
    const char *temporary = getenv("TMPDIR");
    *browser = (struct opened_browser){ .opener = 0 };
    if (!is_plain(url))
        return "no address for a browser";
    if (!make_folder(getenv("XDG_RUNTIME_DIR"), browser->folder, sizeof browser->folder) &&
        !make_folder(temporary && temporary[0] ? temporary : "/tmp", browser->folder, sizeof browser->folder)) {
        browser->folder[0] = '\0';
        return "no folder for the file that leads there";
    }
    snprintf(browser->file, sizeof browser->file, "%s/open.html", browser->folder);
    const char *fault = NULL;
    if (!write_file(browser->file, url))
        fault = "the file that leads there cannot be written";
    else if (!start_opener(browser->file, &browser->opener))
        fault = "xdg-open cannot be started (Debian: xdg-utils)";
    if (fault) {
        browser->opener = 0;
        view_close_browser(browser);
    }
    return fault;
}

void view_close_browser(struct opened_browser *browser)
{
    if (browser->folder[0]) {
        unlink(browser->file);
        rmdir(browser->folder);
    }
    if (browser->opener > 0)
        waitpid(browser->opener, NULL, WNOHANG);
    *browser = (struct opened_browser){ .opener = 0 };
}
