/* SPDX-License-Identifier: BSD-3-Clause */
/* The one function of the C library that the core calls; the others are instructions of WebAssembly. */
#include <string.h>

int memcmp(const void *one, const void *other, size_t size)
{
    const unsigned char *a = one, *b = other;
    for (size_t i = 0; i < size; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}
