/* SPDX-License-Identifier: BSD-3-Clause */
#include "bindings/python/parts/part.h"

#include <stdio.h>
#include <string.h>

#include "platform/library.h"
#include "platform/thread.h"

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* The loader looks beside what asks: it is linked with $ORIGIN. */
static void load(dpy_part *part)
{
    part->is_tried = 1;
    char why[sizeof part->fault];
    part->library = library_load_apart(part->file, why, sizeof why);
    if (part->library)
        return;
    const int is_there = strncmp(why, part->file, strlen(part->file)) != 0;
    snprintf(part->fault, sizeof part->fault, "it needs %s (Debian: %s): %.100s", part->needs, part->packages,
             is_there ? why : "this package was built without it");
}

void *dpy_part_find(dpy_part *part, const char *symbol)
{
    pthread_mutex_lock(&lock);
    if (!part->is_tried)
        load(part);
    void *found = part->library ? library_find(part->library, symbol) : NULL;
    if (part->library && !found)
        snprintf(part->fault, sizeof part->fault, "%s is of another version: it has no %s", part->file, symbol);
    pthread_mutex_unlock(&lock);
    return found;
}
