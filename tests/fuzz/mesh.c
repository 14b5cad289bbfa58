/* SPDX-License-Identifier: BSD-3-Clause */
/* Bytes as they are: refused with code, section and byte, or used. */
#include <string.h>

#include "fuzz/target.h"

static dpt_mesh_fault verify(const void *bytes, size_t size)
{
    dpt_mesh_fault fault = { .size = sizeof fault };
    dpt_result result = dpt_mesh_verify(bytes, size, &fault);
    MUST(fault.code == result);
    MUST(memchr(fault.section, 0, sizeof fault.section) && fault.byte <= size);
    MUST((result == DPT_OK) == !fault.section[0]);
    return fault;
}

/* A copy in the host's byte order, if it can be had: converted files verify. */
static void convert(const uint8_t *bytes, size_t size)
{
    dpt_mesh_fault fault = { .size = sizeof fault };
    uint8_t *copy = malloc(size);
    MUST(copy);
    memcpy(copy, bytes, size);
    if (dpt_mesh_convert(copy, size, &fault) == DPT_OK)
        MUST(dpt_mesh_verify(copy, size, NULL) == DPT_OK);
    else
        MUST(fault.section[0] && fault.byte <= size);
    free(copy);
}

FUZZ_TARGET(mesh)
{
    const dpt_mesh *mesh = NULL;
    if (size == 0)
        return 0;
    dpt_mesh_fault fault = verify(bytes, size);
    MUST(dpt_mesh_open(bytes, size, &mesh) == fault.code);
    MUST((fault.code == DPT_OK) == (mesh != NULL));
    convert(bytes, size);
    if (mesh) {
        fuzz_accepted++;
        fuzz_use_mesh(mesh, FUZZ_FORGED, FUZZ_ALL);
    }
    return 0;
}
