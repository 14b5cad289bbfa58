/* SPDX-License-Identifier: BSD-3-Clause */
/* Libraries that are loaded as a program runs. A program that is linked statically has none. */
#include "platform/library.h"

#include <dlfcn.h>
#include <stdio.h>

void *library_load(const char *name, char *reason, size_t room)
{
    void *library = dlopen(name, RTLD_NOW | RTLD_GLOBAL);
    const char *text = library ? NULL : dlerror();
    snprintf(reason, room, "%s", text ? text : "");
    return library;
}

void *library_find(void *library, const char *name)
{
    return dlsym(library, name);
}
