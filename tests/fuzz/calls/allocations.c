/* SPDX-License-Identifier: BSD-3-Clause */
/* The heap as this program's own code uses it (the linker's --wrap): what is alive at a game's end leaks. */
#include "fuzz/calls/calls.h"

int64_t blocks_alive;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);

void *__wrap_malloc(size_t size)
{
    void *block = __real_malloc(size);
    blocks_alive += block != NULL;
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *block = __real_calloc(count, size);
    blocks_alive += block != NULL;
    return block;
}

void *__wrap_realloc(void *block, size_t size)
{
    void *grown = __real_realloc(block, size);
    blocks_alive += !block && grown;
    return grown;
}

void __wrap_free(void *block)
{
    blocks_alive -= block != NULL;
    __real_free(block);
}
