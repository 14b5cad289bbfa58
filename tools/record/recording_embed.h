/* SPDX-License-Identifier: BSD-3-Clause */
/* The files that a recording carries (host/host_embed.h), found in it again. */
#ifndef DPT_TOOLS_RECORDING_EMBED_H
#define DPT_TOOLS_RECORDING_EMBED_H

#include "host/host_embed.h"
#include "record/recording_file.h"
#include "scene/scene_text.h"

enum { EMBED_FAULT_BYTES = 200 };

struct embedded_file {
    uint64_t total;                /* its length */
    uint64_t held;                 /* bytes of it that were found, from its first one on without a gap */
    uint32_t pieces, crc32;        /* of what was found */
    unsigned char *bytes;          /* aligned to 64; NULL: they were only counted, or there are none */
    char fault[EMBED_FAULT_BYTES]; /* what is wrong, with the byte; "": nothing */
};

/* Begin with zeros. */
struct recording_embed {
    struct embedded_file file[EMBED_FILES];
    uint64_t room;   /* how many bytes all files may have together, at most: as many as the recording has */
    int keeps_bytes; /* or only counts them */
    int is_damaged;  /* what came last is damage, from `damage` on */
    uint64_t damage;
};

extern const char *const embedded_names[EMBED_FILES]; /* "scene", "tool" */

/*
 * Take what recording_next gave, with wants_pieces set, in order and to the end. Counts, and notes the first fault of each
 * file. recording_embed_begin says how long the recording is; an open one that is no regular file carries nothing.
 */
void recording_embed_begin(struct recording_embed *embed, struct recording_file *recording);
void recording_embed_take(struct recording_embed *embed, const struct recording_file *recording,
                          enum recording_item item);

/*
 * Read those files that are wanted, in a pass of its own over the recording, and compare them with its text. Returns 0, or 2
 * after a message with the byte where it is damaged.
 *   wanted   1 or 0, of each file
 */
int recording_embed_read(struct recording_embed *embed, const char *command, const char *path,
                         const struct scene_text *text, const int wanted[EMBED_FILES]);

void recording_embed_free(struct recording_embed *embed);

#endif
