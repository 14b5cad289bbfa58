/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A .dpa file as bytes, for tests that look into one, damage it or forge it. By code of its own
 * where the library has some too: checksums and byte order.
 *
 * A file lies in a block of its exact length, so that the sanitizer sees a read beyond it.
 */
#ifndef DPT_TESTS_DPA_H
#define DPT_TESTS_DPA_H

#include "dynpoint.h"
#include "dynpoint/compile.h"
#include "lib/check.h"
#include "mesh/mesh_format.h"
#include "scene/shape.h"

struct file {
    unsigned char *bytes;
    size_t size;
};

static inline struct file file_of(const void *bytes, size_t size)
{
    struct file file = { malloc(size), size };
    if (size)
        memcpy(file.bytes, bytes, size);
    return file;
}

static inline struct file copy_of(const struct file *file)
{
    return file_of(file->bytes, file->size);
}

/* Without the last triangles of the shape, `missing` of them. */
struct file file_of_holed_shape(const char *name, uint64_t count, size_t missing);

static inline struct file file_of_shape(const char *name, uint64_t count)
{
    return file_of_holed_shape(name, count, 0);
}

/* With an embedding in 27 nodes within 0.05 m of the origin along every axis: some vertices are outside. */
struct file file_of_embedded_shape(const char *name, uint64_t count);

/* With springs of this kind, DPT_SPRINGS_...; a volume's lattice has a spacing of 0.05 m. */
struct file file_of_sprung_shape(const char *name, uint64_t count, uint32_t kind);

/* With a volume of another Poisson's ratio: its cells have a term. */
struct file file_of_bulging_shape(const char *name, uint64_t count, double poisson);

/* Moved to the origin by the compiler, from 1000 m along x. */
struct file file_of_moved_shape(const char *name, uint64_t count);

/* Bit by bit: slower than the library's, and not derived from it. */
uint32_t crc_of(const unsigned char *bytes, size_t size);

static inline struct dpt_mesh header_of(const struct file *file)
{
    struct dpt_mesh header;
    memcpy(&header, file->bytes, sizeof header);
    return header;
}

/* Of files without cells: how many sections they have, where a field of the tail is, where the header ends. */
#define PLAIN_SECTIONS      ((int)mesh_section_count(MESH_VERSION_PLAIN))
#define PLAIN_TAIL_AT(name) (mesh_tail_offset(MESH_VERSION_PLAIN) + offsetof(struct mesh_tail, name))
#define PLAIN_HEADER        ((size_t)mesh_header_bytes(MESH_VERSION_PLAIN))

/* By the version alone: other numbers may be forged. */
size_t header_bytes_of(const struct dpt_mesh *header);

void seal_header(struct file *file);

/* Sections that leave the file are not summed: a forger cannot either. */
void seal(struct file *file);

/* The section that a byte lies in: MESH_SECTION_COUNT the header, -1 the padding between two. */
int section_at(const struct dpt_mesh *header, uint64_t byte);

static inline const char *section_name_at(const struct dpt_mesh *header, uint64_t byte)
{
    int id = section_at(header, byte);
    return id < 0 ? "padding" : id == MESH_SECTION_COUNT ? "header" : header->section[id].name;
}

/* Reverse the bytes of each of `count` numbers of `width` bytes. */
void reverse(unsigned char *bytes, size_t width, size_t count);

/* The same file as a machine of the other byte order holds it, its checksums those of these bytes. */
struct file other_order(const struct file *file);

#endif
