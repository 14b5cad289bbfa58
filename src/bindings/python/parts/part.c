/* SPDX-License-Identifier: BSD-3-Clause */
#define _POSIX_C_SOURCE 200809L
#include "bindings/python/parts/part.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* The loader looks beside what asks: it is linked with $ORIGIN. */
static void load(dpy_part *part)
{
    part->is_tried = 1;
    part->library = dlopen(part->file, RTLD_NOW | RTLD_LOCAL);
    if (part->library)
        return;
    const char *why = dlerror();
    const int is_there = why && strncmp(why, part->file, strlen(part->file)) != 0;
    snprintf(part->fault, sizeof part->fault, "it needs %s (Debian: %s): %s", part->needs, part->packages,
             is_there ? why : "this package was built without it");
}

void *dpy_part_find(dpy_part *part, const char *symbol)
{
    pthread_mutex_lock(&lock);
    if (!part->is_tried)
        load(part);
    void *found = part->library ? dlsym(part->library, symbol) : NULL;
    if (part->library && !found)
        snprintf(part->fault, sizeof part->fault, "%s is of another version: it has no %s", part->file, symbol);
    pthread_mutex_unlock(&lock);
    return found;
}
