/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What of the package needs a library that a system may lack: it lies beside the extension and the program as a library
 * of its own, and is loaded when it is first asked for.
 */
#ifndef PYTHON_PART_H
#define PYTHON_PART_H

typedef struct dpy_part {
    const char *file;     /* of the package */
    const char *needs;    /* the library, for a person */
    const char *packages; /* of Debian, that have it */
    void *library;
    int is_tried;
    char fault[160]; /* as long as that of dpt_diag */
} dpy_part;

/*
 * A function of a part, or NULL: then part->fault says what is missing, and what to install. From any thread; a symbol
 * that the part lacks counts as the part.
 */
void *dpy_part_find(dpy_part *part, const char *symbol);

#endif
