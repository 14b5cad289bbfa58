/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Files by their names in UTF-8, of any length that the system takes; always as bytes. Streams are opened by
 * text/open_file.h. Functions that fail set errno.
 */
#ifndef DPT_PLATFORM_FILE_H
#define DPT_PLATFORM_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Descriptors, for close of <unistd.h>: to read; to write, made or made empty; to write, made for this user alone, and new. */
int file_open_read(const char *path);
int file_open_write(const char *path);
int file_open_new(const char *path);

/* As read and write of POSIX: how many bytes, 0 at a file's end, -1 and errno. */
long file_read(int file, void *bytes, size_t size);
long file_write(int file, const void *bytes, size_t size);

struct file_status {
    int is_regular;          /* 1: a file that has a length; 0: a folder, a device, a pipe */
    uint64_t bytes;          /* of a regular file */
    uint64_t volume, number; /* the same file has the same two */
    unsigned mode;           /* for file_keep_mode */
};

/* What lies there, links followed; a link itself; what a stream is open at. Returns 0, or -1. */
int file_get_status(const char *path, struct file_status *status);
int file_get_link_status(const char *path, struct file_status *status);
int file_get_stream_status(FILE *stream, struct file_status *status);

/* Who may use the file becomes as it was of the other one. */
void file_keep_mode(FILE *stream, const struct file_status *other);

/* Cut an open file to so many bytes, and write on from there. Returns 0, or -1. */
int file_cut(int file, uint64_t bytes);
int file_cut_stream(FILE *stream, uint64_t bytes);

/*
 * Lock a file for one program at a time, until the descriptor in *file is closed, or the program has ended. Returns 0 if
 * it is had, or where the file system has no locks; and with -1 in *file where there is nothing to lock: no file, or one
 * without a length, as a pipe. 1: another one has it.
 */
int file_lock(const char *path, int *file);

/* `to` becomes what `from` was, at once: whoever opens it finds the old bytes or the new ones. Returns 0, or -1. */
int file_replace(const char *from, const char *to);

/* Returns 0, or -1. */
int file_remove(const char *path);
int file_remove_folder(const char *path);

/* The names in a folder that `is_wanted` takes, sorted by their bytes. Returns how many, or -1: then there is no list. */
int file_list(const char *folder, int (*is_wanted)(const char *name), char ***names);
void file_list_free(char **names, int count);

/* Where temporary files go; "" if that name has no room. */
void file_temporary_folder(char *folder, size_t room);

/* A new folder for this user alone, below `parent`: its name goes to `folder`. Returns 0 if there is none. */
int file_make_private_folder(const char *parent, char *folder, size_t room);

/*
 * A file that outlives the program, in a folder: opened to read and write, made if it is not there. -1 if the system
 * has no such folder, or if folder or file are not this user's alone.
 */
int file_open_kept(const char *folder, const char *path);

/* Memory aligned for a file's bytes or a block of the library's, which free() frees. NULL: it ran out. */
void *file_memory(size_t size);

#endif
