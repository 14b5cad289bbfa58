/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Opens a browser at a secret address. Any user may read a process's command line; so the browser is given the name of a
 * file that only this user may read (mode 0600, in a folder of its own with mode 0700), and the file leads on. The desktop's
 * own program is started for it, by no shell.
 */
#ifndef DPT_TOOLS_OPEN_BROWSER_H
#define DPT_TOOLS_OPEN_BROWSER_H

struct opened_browser {
    char folder[240], file[256]; /* "": none */
    long opener;                 /* 0: none */
};

/*
 * `url` has letters, digits and ":/.#[]-_" only. The folder is made in XDG_RUNTIME_DIR, or else among temporary files.
 * Returns NULL, or what went wrong; then nothing is left over.
 */
const char *view_open_browser(const char *url, struct opened_browser *browser);

/* Removes the file and its folder. The browser stays. */
void view_close_browser(struct opened_browser *browser);

#endif
