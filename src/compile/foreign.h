/* SPDX-License-Identifier: BSD-3-Clause */
/* Formats of meshes that are not read, but known by their content; and the way from each to one that is. */
#ifndef DPT_COMPILE_FOREIGN_H
#define DPT_COMPILE_FOREIGN_H

#include <stddef.h>

struct foreign_format {
    const char *name;     /* "glTF" */
    const char *packages; /* of Python, for pip; NULL: the command is no Python */
    const char *command; /* Python, or the shell's: a printf format of the source and, of Python, of the STL to write */
    const char *unit;    /* what to tell `dynpoint compile` then, and why */
};

/* The format that the bytes are in, or NULL. Only what no reader takes is asked about. */
const struct foreign_format *foreign_format_of(const unsigned char *bytes, size_t size);

#endif
