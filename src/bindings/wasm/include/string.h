/* SPDX-License-Identifier: BSD-3-Clause */
/* What the core needs of <string.h>, for a machine without a C library (memory.c). */
#ifndef DPT_WASM_STRING_H
#define DPT_WASM_STRING_H

#include <stddef.h>

void *memcpy(void *restrict to, const void *restrict from, size_t size);
void *memmove(void *to, const void *from, size_t size);
void *memset(void *to, int value, size_t size);
int memcmp(const void *one, const void *other, size_t size);

#endif
