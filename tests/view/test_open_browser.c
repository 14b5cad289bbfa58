/* SPDX-License-Identifier: BSD-3-Clause */
/* A browser is opened at a secret address: with a made-up xdg-open, which notes what it is given and may see. */
#define _GNU_SOURCE
#include "view/open_browser.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "lib/check.h"

#define URL "http://127.0.0.1:8123/#00112233445566778899aabbccddeeff"

static char folder[] = "/tmp/dynpoint-test-XXXXXX";

static void in_folder(char *path, size_t room, const char *name)
{
    snprintf(path, room, "%s/%s", folder, name);
}

static void make_opener(void)
{
    char path[256];
    in_folder(path, sizeof path, "xdg-open");
    FILE *file = fopen(path, "w");
    CHECK(file != NULL, "%s", path);
    if (!file)
        return;
    fprintf(file,
            "#!/bin/sh\n{ echo \"$# $1\"; cat \"$1\"; } >'%s/noted.part'\n"
            "echo heard\nmv '%s/noted.part' '%s/noted'\n",
            folder, folder, folder);
    fclose(file);
    chmod(path, 0700);
}

static int read_note(char *text, size_t room)
{
    char path[256];
    in_folder(path, sizeof path, "noted");
    for (int i = 0; i < 500; i++) {
        FILE *file = fopen(path, "r");
        if (file) {
            const size_t size = fread(text, 1, room - 1, file);
            text[size] = '\0';
            fclose(file);
            unlink(path);
            return 1;
        }
        nanosleep(&(struct timespec){ 0, 10000000 }, NULL);
    }
    return 0;
}

static void leads_through_a_file(void)
{
    struct opened_browser browser;
    struct stat status;
    char note[4096] = "", expected[300];
    setenv("XDG_RUNTIME_DIR", folder, 1);
    /* The made-up one needs cat and mv. */
    char path[300];
    snprintf(path, sizeof path, "%s:/usr/bin:/bin", folder);
    setenv("PATH", path, 1);
    make_opener();
    umask(0);
    const char *fault = view_open_browser(URL, &browser);
    CHECK(!fault, "%s", fault);
    CHECK(stat(browser.file, &status) == 0 && (status.st_mode & 07777) == 0600, "mode %o",
          (unsigned)status.st_mode & 07777);
    CHECK(stat(browser.folder, &status) == 0 && (status.st_mode & 07777) == 0700, "mode %o",
          (unsigned)status.st_mode & 07777);
    CHECK(strncmp(browser.folder, folder, strlen(folder)) == 0, "%s", browser.folder);
    CHECK(read_note(note, sizeof note), "the opener was not started");
    snprintf(expected, sizeof expected, "1 %s\n", browser.file);
    CHECK(strncmp(note, expected, strlen(expected)) == 0, "it was given %s", note);
    CHECK(strstr(note, "content=\"0;url=" URL "\"") != NULL, "the file leads elsewhere: %s", note);
    CHECK(strchr(expected, '#') == NULL && !strstr(expected, "00112233"), "%s", expected);
    const char *file = strdup(browser.file), *parent = strdup(browser.folder);
    view_close_browser(&browser);
    CHECK(stat(file, &status) != 0 && errno == ENOENT, "%s is left over", file);
    CHECK(stat(parent, &status) != 0 && errno == ENOENT, "%s is left over", parent);
    view_close_browser(&browser);
    free((char *)(size_t)file);
    free((char *)(size_t)parent);
}

/* How many folders of it there are below ours. */
static int folders_left(void)
{
    char command[300];
    int count = -1;
    snprintf(command, sizeof command, "ls -d %s/dynpoint-* 2>/dev/null | wc -l", folder);
    FILE *list = popen(command, "r");
    if (!list || fscanf(list, "%d", &count) != 1)
        count = -1;
    if (list)
        pclose(list);
    return count;
}

static void leaves_nothing_after_a_fault(void)
{
    struct opened_browser browser;
    char path[256], before[300];
    snprintf(before, sizeof before, "%s", getenv("PATH"));
    CHECK(view_open_browser("http://127.0.0.1:8123/\"><script>", &browser) != NULL, "not plain");
    CHECK(view_open_browser("", &browser) != NULL, "no address");
    setenv("PATH", "/nonexistent", 1);
    const char *fault = view_open_browser(URL, &browser);
    CHECK(fault && strstr(fault, "xdg-open"), "no opener: %s", fault ? fault : "no fault");
    CHECK(browser.folder[0] == '\0', "%s", browser.folder);
    setenv("PATH", before, 1);
    CHECK(folders_left() == 0, "%d folders are left over", folders_left());
    setenv("XDG_RUNTIME_DIR", "/nonexistent", 1);
    in_folder(path, sizeof path, "temporary");
    mkdir(path, 0700);
    setenv("TMPDIR", path, 1);
    fault = view_open_browser(URL, &browser);
    CHECK(!fault && strncmp(browser.folder, path, strlen(path)) == 0, "not in TMPDIR: %s", browser.folder);
    char note[4096];
    CHECK(read_note(note, sizeof note), "the opener was not started");
    view_close_browser(&browser);
    CHECK(rmdir(path) == 0, "something is left in %s", path);
}

int main(void)
{
    char path[256];
    CHECK(mkdtemp(folder) != NULL, "%s", folder);
    TEST(leads_through_a_file);
    TEST(leaves_nothing_after_a_fault);
    in_folder(path, sizeof path, "xdg-open");
    unlink(path);
    CHECK(rmdir(folder) == 0, "something is left in %s", folder);
    return check_report();
}
