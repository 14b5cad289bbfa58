/* SPDX-License-Identifier: BSD-3-Clause */
/* Files: their names, what is read of them as a whole, and compiled meshes and arms in them. */
#ifndef DPT_HOST_FILE_H
#define DPT_HOST_FILE_H

#include <stddef.h>

#include "dynpoint/arm.h"
#include "dynpoint/mesh.h"
#include "scene/host_error.h"

/* 1 if a path is longer than an ending and has it, in capitals or not. The ending is in small letters: ".json". */
int host_file_ends_in(const char *path, const char *ending);

/* 1 if both are there, and are one file, by whatever names. Each may be NULL. */
int host_file_is_same(const char *path, const char *other);

/* 1 if a path is one of the files in a device's name: its address or the value of a setting. */
int host_file_is_of_device(const char *path, const char *device);

/*
 * Read a file; "-" is standard input. It is opened and read once, so it may be a pipe. The bytes are aligned to 64 and
 * followed by a zero; the caller frees them. NULL after filling the error.
 */
void *host_file_load(const char *path, size_t *size, dpt_host_error *error);

/* Bytes of the caller as host_file_load gives those of a file. */
void *host_file_copy(const void *bytes, size_t size, dpt_host_error *error);

/* 1 if the bytes are an arm, damaged or not; 0 for a mesh. */
int host_file_is_arm(const void *bytes, size_t size);

/*
 * Convert a file's bytes to this machine's byte order and open them. NULL after filling the error, which names `path`,
 * the wrong byte and its section.
 */
const dpt_mesh *host_file_open_mesh(const char *path, void *bytes, size_t size, dpt_host_error *error);
const dpt_arm *host_file_open_arm(const char *path, void *bytes, size_t size, dpt_host_error *error);

#endif
