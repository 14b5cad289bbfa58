/* SPDX-License-Identifier: BSD-3-Clause */
/* A scene of the user's own: docs/scene.md. SI units; y is up. */
#ifndef DPT_SCENE_FILE_H
#define DPT_SCENE_FILE_H

#include "dynpoint/arm.h"
#include "dynpoint/world.h"
#include "scene/file_identity.h"
#include "scene/json_value.h"
#include "scene/scene_dress.h"
#include "scene/scene_list.h"
#include "scene/scene_tips.h"
#include "scene/surface_regions.h"
#include "scene/tip_shape.h"

enum {
    SCENE_FILE_BYTES_MAX = 1 << 20,
    SCENE_FILE_REGIONS_MAX = 1000,       /* of one body */
    SCENE_FILE_TRIANGLES_MAX = 10000000, /* of all shapes together */
};

/* Whether what can give way does. */
enum scene_file_softness { SCENE_FILE_AS_IT_IS, SCENE_FILE_RIGID, SCENE_FILE_SOFT };

struct scene_file_body {
    char *mesh;                /* path of a compiled mesh; NULL: it is the listed shape */
    struct listed_body listed; /* of a mesh, without shape and springs */
    dpt_spring_region *regions;
    enum scene_file_softness softness;
    dpt_body_settings settings;
    struct surface_regions surface_regions;
};

/* Where nothing was given: NULL, NAN, -1 or a count of 0. */
struct scene_file {
    struct file_identity identity; /* of the file alone */
    struct scene_file_body *bodies;
    uint32_t body_count;
    double gravity;
    /* The tool is one of three: segments, an arm's, or else a stylus. */
    dpt_segment segments[DPT_ARM_SEGMENTS_MAX];
    uint32_t segment_count;
    char *arm;
    struct tip_shapes tips; /* beside these */
    struct jaw_motion jaw;  /* of the arm's tool */
    double length, radius;
    int law, look;                            /* look: enum tool_look */
    struct dress_part dress[DRESS_PARTS_MAX]; /* in place of a look */
    uint32_t dress_count;
    uint32_t piercing; /* DPT_PIERCING_..., of a stylus or of one segment */
    int has_port;
    double port[3]; /* m: where a stylus enters */
    char *device;   /* as of --device */
    double zoom, force_scale, origin[3];
    int has_origin, clutch;
    struct scene_camera camera, inset;
};

/* Read a file. The error names the file, the line or the place, and the reason. Free it also after a failure. */
dpt_result scene_file_load(struct scene_file *file, const char *path, dpt_host_error *error);
void scene_file_free(struct scene_file *file);

/*
 * Read a text. Paths in it begin where `path` lies. Returns 1, or 0 after filling the fault; free the file also then.
 * What is read is in its range; whether meshes are there, and shapes can be made, is not looked at.
 */
int scene_file_parse(struct scene_file *file, const char *path, const char *text, size_t size,
                     struct json_fault *fault);

/*
 * For the parts of the reader: a body, tips, a pose that has its place, of at most `max` m, under the key `place`; and a
 * path of its own from the file's folder, NULL after a fault.
 */
void scene_file_read_body(struct scene_file_body *body, struct json_reader *reader, const struct json_value *at,
                          const char *path);
void scene_file_read_tips(struct tip_shapes *tips, struct json_reader *reader, const struct json_value *list);
void scene_file_read_pose(dpt_pose *pose, struct json_reader *reader, const struct json_value *at, const char *place,
                          double max);
char *scene_file_take_path(struct json_reader *reader, const struct json_value *object, const char *key,
                           const char *path);

#endif
