/* SPDX-License-Identifier: BSD-3-Clause */
/* A token that is kept for a port: the same again, for this user alone, or none. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lib/check.h"
#include "view/view_request.h"

static char folder[] = "/tmp/dynpoint-token-XXXXXX";

static const char *file_of(unsigned port)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/dynpoint-view-%u", folder, port);
    return path;
}

static int keeps(uint16_t port, struct view_token *token)
{
    memset(token, 0, sizeof *token);
    return view_token_keep(port, token);
}

static void write_file(unsigned port, const char *text, mode_t mode)
{
    FILE *file = fopen(file_of(port), "w");
    fputs(text, file);
    fclose(file);
    chmod(file_of(port), mode);
}

static void the_same_again(void)
{
    struct view_token first, second, other;
    struct stat status;
    CHECK(keeps(4000, &first) && keeps(4000, &second) && keeps(4001, &other), "not kept");
    CHECK(strlen(first.digits) == 32 && !strcmp(first.digits, second.digits), "%s, then %s", first.digits,
          second.digits);
    CHECK(strcmp(first.digits, other.digits) != 0, "two ports have one token");
    CHECK(stat(file_of(4000), &status) == 0 && (status.st_mode & 0777) == 0600, "others may read it");
}

static void what_is_no_token_is_replaced(void)
{
    static const char *const texts[] = { "", "abc", "0123456789abcdef0123456789abcdeG",
                                         "0123456789ABCDEF0123456789ABCDEF" };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct view_token token, again;
        write_file(4002, texts[i], 0600);
        CHECK(keeps(4002, &token) && strlen(token.digits) == 32 && strncmp(token.digits, texts[i], 32) != 0,
              "'%s' is taken", texts[i]);
        CHECK(keeps(4002, &again) && !strcmp(token.digits, again.digits), "'%s' twice", texts[i]);
    }
}

static void what_others_see_is_not_used(void)
{
    struct view_token token;
    char good[128];
    snprintf(good, sizeof good, "%s", file_of(4000));
    write_file(4003, "0123456789abcdef0123456789abcdef", 0644);
    CHECK(!keeps(4003, &token), "a file that others may read");
    CHECK(symlink(good, file_of(4004)) == 0 && !keeps(4004, &token), "a link");
    CHECK(mkfifo(file_of(4005), 0600) == 0 && !keeps(4005, &token), "a pipe");
    CHECK(mkdir(file_of(4006), 0700) == 0 && !keeps(4006, &token), "a folder");
    chmod(folder, 0755);
    CHECK(!keeps(4000, &token), "a folder that others may look into");
    chmod(folder, 0700);
    setenv("XDG_RUNTIME_DIR", "relative", 1);
    CHECK(!keeps(4000, &token), "a folder without a place");
    unsetenv("XDG_RUNTIME_DIR");
    CHECK(!keeps(4000, &token), "no folder");
    setenv("XDG_RUNTIME_DIR", folder, 1);
}

int main(void)
{
    char command[64];
    if (!mkdtemp(folder)) {
        check_failed++;
        return check_report();
    }
    setenv("XDG_RUNTIME_DIR", folder, 1);
    TEST(the_same_again);
    TEST(what_is_no_token_is_replaced);
    TEST(what_others_see_is_not_used);
    snprintf(command, sizeof command, "rm -r %s", folder);
    if (system(command))
        check_failed++;
    return check_report();
}
