/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Writes a shape as OBJ, binary STL, binary PLY (little-endian) or OFF. Vertices are rounded to
 * float; numbers in text read back to the same float.
 */
#ifndef DPT_TOOLS_MESH_FILE_H
#define DPT_TOOLS_MESH_FILE_H

#include <stdio.h>

#include "scene/shape.h"

/* Errors are left in the file's error flag. */
typedef void mesh_writer(FILE *file, const struct shape *shape);

/* The writer for the path's ending, in upper or lower case; NULL when it names no format. */
mesh_writer *mesh_file_writer(const char *path);

#endif
