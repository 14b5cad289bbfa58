/* SPDX-License-Identifier: BSD-3-Clause */
/* The host's byte order: files and snapshots are little-endian. */
#ifndef DPT_BYTE_ORDER_H
#define DPT_BYTE_ORDER_H

#include <stdint.h>
#include <string.h>

/* 1 if the host is little-endian. Compilers know the answer. */
static inline int host_is_little(void)
{
    const uint32_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

#endif
