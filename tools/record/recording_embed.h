/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The files that a recording carries, in pieces (docs/format.md, "pieces of a file"): that of its scene, and that of its
 * tool's arm. Then it can be shown and replayed where these files are not.
 */
#ifndef DPT_TOOLS_RECORDING_EMBED_H
#define DPT_TOOLS_RECORDING_EMBED_H

#include "record/recording_file.h"
#include "scene/scene_text.h"

enum { EMBED_SCENE, EMBED_TOOL, EMBED_FILES };
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
 * For `dynpoint run --embed`: load the files of a scene, and let the scene's bytes be these. Refuses a scene file. A scene
 * by name has no file, and the user is told. `record` is where it will be written. Returns 0, or 2 after a message. Free it
 * in any case, after the scene was opened.
 */
int recording_embed_load(struct recording_embed *embed, struct scene_def *def, const char *record);

/* Append them to a recording that was closed. If that fails it is as it was. Returns 0, or 2 after a message. */
int recording_embed_write(const struct recording_embed *embed, const char *path);

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
