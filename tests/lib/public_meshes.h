/* SPDX-License-Identifier: BSD-3-Clause */
/* The public meshes below DPT_DATA, which is not part of the tree. */
#ifndef DPT_TESTS_PUBLIC_MESHES_H
#define DPT_TESTS_PUBLIC_MESHES_H

/* Its coordinates are the largest floats: it does not compile in metres, and for_each_public_mesh leaves it out. */
#define TOO_LARGE_MESH "cray_right_floatmax.obj"

typedef void visit_mesh(const char *folder, const char *file, void *user);

/*
 * Call `visit` for each mesh in data/meshes/organs, tools, sheets_tori and hard, in the order of their names. A folder
 * that is empty is a failed check.
 */
void for_each_public_mesh(const char *data, visit_mesh *visit, void *user);

#endif
