/* SPDX-License-Identifier: BSD-3-Clause */
/* What verifying and opening a file must say, and the files that the tests of mesh files start from. */
#ifndef DPT_TESTS_MESH_CHECKS_H
#define DPT_TESTS_MESH_CHECKS_H

#include "lib/dpa.h"

/*
 * A mesh with one level of boxes, one with two, one that is solid but for a hole, so that it has moments, and one with
 * an embedding; sheet and volume, the same with springs.
 */
extern struct file small_file, large_file, holed_file, embedded_file, sheet_file, volume_file;

/* Compile these four, or free them. */
int open_files(void);
void free_files(void);

/* What verify says. Its result and its fault must agree. */
dpt_mesh_fault verified(const struct file *file);

/* What verify says; open must agree, and leave its output alone unless all is well. */
dpt_mesh_fault fault_of(const struct file *file);

/* The file is refused with this code, at this byte of this section. */
void expect_fault(const struct file *file, dpt_result code, uint64_t byte, const char *section);

/* The offset of a field of the header. */
#define AT(field) offsetof(struct dpt_mesh, field)

/* Search, sign and force on a mesh that opened: whatever it says, it stays within the bytes. */
void use_mesh(const dpt_mesh *mesh, uint64_t *random);

#endif
