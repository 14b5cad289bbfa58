/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/open_browser.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/file.h"
#include "platform/program.h"

/* Nothing in it ends an attribute of HTML. */
static int is_plain(const char *url)
{
    return url[0] != '\0' && url[strspn(url, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                             "0123456789:/.#[]-_")] == '\0';
}

static int make_folder(const char *parent, struct opened_browser *browser)
{
    return parent && parent[0] && file_make_private_folder(parent, browser->folder, sizeof browser->folder);
}

static int write_file(const char *path, const char *url)
{
    const int number = file_open_new(path);
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

const char *view_open_browser(const char *url, struct opened_browser *browser)
{
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    char temporary[sizeof browser->folder];
    *browser = (struct opened_browser){ .opener = 0 };
    if (!is_plain(url))
        return "no address for a browser";
    file_temporary_folder(temporary, sizeof temporary);
    if (!make_folder(runtime, browser) && !make_folder(temporary, browser)) {
        browser->folder[0] = '\0';
        return "no folder for the file that leads there";
    }
    snprintf(browser->file, sizeof browser->file, "%s/open.html", browser->folder);
    const char *fault = NULL;
    if (!write_file(browser->file, url))
        fault = "the file that leads there cannot be written";
    else
        fault = program_open_document(browser->file, &browser->opener);
    if (fault) {
        browser->opener = 0;
        view_close_browser(browser);
    }
    return fault;
}

void view_close_browser(struct opened_browser *browser)
{
    if (browser->folder[0]) {
        file_remove(browser->file);
        file_remove_folder(browser->folder);
    }
    program_forget(browser->opener);
    *browser = (struct opened_browser){ .opener = 0 };
}
