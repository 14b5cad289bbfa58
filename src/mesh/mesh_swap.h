/* SPDX-License-Identifier: BSD-3-Clause */
/* Changing the byte order of the numbers of a .dpa file. */
#ifndef DPT_MESH_SWAP_H
#define DPT_MESH_SWAP_H

#include "mesh/mesh_format.h"

/* Reverse the bytes of each of `count` 4-byte words. */
static inline void mesh_swap4(void *words, uint64_t count)
{
    unsigned char *b = words;
    for (; count; count--, b += 4) {
        unsigned char t = b[0];
        b[0] = b[3];
        b[3] = t;
        t = b[1];
        b[1] = b[2];
        b[2] = t;
    }
}

/* The same for 8-byte words. */
static inline void mesh_swap8(void *words, uint64_t count)
{
    unsigned char *b = words;
    for (; count; count--, b += 8)
        for (int i = 0; i < 4; i++) {
            unsigned char t = b[i];
            b[i] = b[7 - i];
            b[7 - i] = t;
        }
}

/* Swap the numbers of a header of `version`, the section table included; its own inverse. */
static inline void mesh_swap_header(struct dpt_mesh *mesh, uint32_t version)
{
    const uint32_t sections = mesh_section_count(version);
    size_t first4 = offsetof(struct dpt_mesh, byte_order);
    size_t first8 = offsetof(struct dpt_mesh, bytes);
    size_t table = offsetof(struct dpt_mesh, section);
    mesh_swap4((char *)mesh + first4, (first8 - first4) / 4);
    mesh_swap8((char *)mesh + first8, (table - first8) / 8);
    for (uint32_t i = 0; i < sections; i++) {
        mesh_swap8(&mesh->section[i].offset, 2);
        mesh_swap4(&mesh->section[i].crc32, 4);
    }
    char *tail = (char *)mesh + mesh_tail_offset(version);
    const size_t bytes = mesh_tail_bytes(version);
    for (size_t at = 0; at < bytes;) {
        const int is_double = at == offsetof(struct mesh_tail, crease) ||
                              at == offsetof(struct mesh_tail, outside_distance) ||
                              at >= offsetof(struct mesh_tail, viscosity);
        if (is_double)
            mesh_swap8(tail + at, 1);
        else
            mesh_swap4(tail + at, 1);
        at += is_double ? 8 : 4;
    }
}

#endif
