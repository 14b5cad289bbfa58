/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The files that a recording carries, as pieces behind its records (docs/format.md, "pieces of a file"): that of its
 * scene, and that of its tool's arm. Then it can be shown and replayed where these files are not.
 */
#ifndef DPT_HOST_EMBED_H
#define DPT_HOST_EMBED_H

#include "scene/scene_def.h"

enum { EMBED_SCENE, EMBED_TOOL, EMBED_FILES };

/* The kind of a record that is a piece, and offsets in it. What comes before AT_FILE is that of records of any kind. */
enum {
    EMBED_KIND_PIECE = 2,
    EMBED_AT_KIND = 0,
    EMBED_AT_BYTES = 4,
    EMBED_AT_CRC = 8,
    EMBED_AT_NUMBER = 16,
    EMBED_AT_FILE = 24,
    EMBED_AT_PIECE_BYTES = 28,
    EMBED_AT_OFFSET = 32,
    EMBED_AT_TOTAL = 40,
    EMBED_AT_PIECE = 48
};

/* How long a piece of so many bytes of a file is. */
static inline size_t embed_piece_size(size_t bytes)
{
    return (EMBED_AT_PIECE + bytes + 7) & ~(size_t)7;
}

/* Begin with zeros. */
struct host_embed {
    struct {
        void *bytes; /* NULL: there is none to carry */
        size_t size;
    } file[EMBED_FILES];
};

/*
 * Load the files of a scene, and let the def's bytes be these, until host_embed_free. Refuses a scene file; a scene by name
 * has no file, and a note says so. `record` is where they will be written.
 */
dpt_result host_embed_load(struct host_embed *embed, struct scene_def *def, const char *record, dpt_host_error *error);

/* Append them to a recording that was closed. If that fails it is as it was. */
dpt_result host_embed_write(const struct host_embed *embed, const char *record, dpt_host_error *error);

void host_embed_free(struct host_embed *embed);

#endif
