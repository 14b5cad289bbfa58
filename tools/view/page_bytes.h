/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The viewer's page inside the program, and the Content-Security-Policy that goes with it. A build without node or
 * three.js has none (`make deps view` gets them).
 */
#ifndef DPT_TOOLS_PAGE_BYTES_H
#define DPT_TOOLS_PAGE_BYTES_H

#include <stddef.h>

struct view_page {
    const char *html; /* NULL: there is none */
    size_t size;
    const char *csp; /* the header's value: one line, with a zero at its end */
};

struct view_page view_page_bytes(void);

#endif
