/* SPDX-License-Identifier: BSD-3-Clause */
/* Libraries that are loaded while the program runs. */
#ifndef DPT_PLATFORM_LIBRARY_H
#define DPT_PLATFORM_LIBRARY_H

#include <stddef.h>

/* The names under which a vendor's library is looked for, newest first; NULL at the end. */
extern const char *const library_names_of_hd[];
extern const char library_names_text_of_hd[]; /* the same, for people */

/*
 * Load a library, and what it needs, for the rest of the program's life. NULL: `reason` says why not; it begins with
 * "NAME: No such file or directory" if the library, or one that it needs, is not there.
 */
void *library_load(const char *name, char *reason, size_t room);

/* The same, but what it and its libraries define serves nothing else that is loaded later. */
void *library_load_apart(const char *name, char *reason, size_t room);

/* A function or object of it, or NULL. */
void *library_find(void *library, const char *name);

#endif
