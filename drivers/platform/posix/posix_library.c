/* SPDX-License-Identifier: BSD-3-Clause */
/* Libraries that are loaded as a program runs. A program that is linked statically has none. */
#include "platform/library.h"

#include <dlfcn.h>
#include <stdio.h>

static void *load(const char *name, int scope, char *reason, size_t room)
{
    void *library = dlopen(name, RTLD_NOW | scope);
    const char *text = library ? NULL : dlerror();
    snprintf(reason, room, "%s", text ? text : "");
    return library;
}

void *library_load(const char *name, char *reason, size_t room)
{
    return load(name, RTLD_GLOBAL, reason, room);
}

void *library_load_apart(const char *name, char *reason, size_t room)
{
    return load(name, RTLD_LOCAL, reason, room);
}

void *library_find(void *library, const char *name)
{
    return dlsym(library, name);
}
