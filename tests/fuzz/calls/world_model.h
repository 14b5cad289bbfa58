/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a world must be like, told only by what it was asked: lists that are searched from end to end. A scene is a
 * world and, often, its twin: of the same def but another kernel, in another block, asked the same; their answers
 * must be alike to the bit.
 */
#ifndef DPT_TESTS_CALLS_WORLD_MODEL_H
#define DPT_TESTS_CALLS_WORLD_MODEL_H

#include "dynpoint/baseline.h"
#include "fuzz/calls/calls.h"

enum { SCENES = 3, BODIES_MAX = 24, TOOLS_MAX = 12, SEGMENTS_MAX = 24 };

/* A removed id is refused for so many adds, at least (world.h); of some more it is known when it comes round. */
enum { REFUSED_FOR = 4094, REMEMBERED_FOR = REFUSED_FOR + 66 };

/* What is known of a tool's answers. */
enum answers {
    ANSWERS_NONE, /* all must be stale */
    ANSWERS_THERE,
    ANSWERS_EITHER /* it jumped since the last step: of then, or stale */
};

struct model_body {
    dpt_body id;
    int is_usable; /* its pose is */
    uint64_t user;
    dpt_pose pose; /* the last one that could be used */
    double side_limit, static_friction, kinetic_friction, stiffness;
    uint32_t unfelt;
    const struct subject *subject;
    struct soft *soft; /* of a deformable one (deform_model.h); else NULL */
};

struct model_tool {
    dpt_tool id;
    int is_usable, is_free;
    uint32_t count;
    uint64_t user;
    dpt_pose pose;
    uint32_t law;
    double stiffness, rotational_stiffness, damping;
    uint32_t lock_rotation, near_only;
    int is_shaped, was_shaped;         /* it has a function of its own; and at the last step */
    dpt_segment segment[SEGMENTS_MAX]; /* of a free one in the world, else in its frame */
    enum answers answers;
    dpt_segment at[SEGMENTS_MAX]; /* in the world, at the last step */
    double origin[3];             /* what its torque is about, then */
    double stiffness_then;
    uint32_t law_then, near_only_then;
    /* Of one with a proxy: where that was at the last step, and its segments there. */
    dpt_pose proxy;
    dpt_segment proxy_at[SEGMENTS_MAX];
    /* Of a free one, in all steps since it was placed: the least length and radius, and that one was less than now. */
    dpt_segment least;
    int has_grown, is_placed_anew;
};

/* Ids of one kind that were removed, and after how many adds. */
struct removed {
    uint32_t id[REMEMBERED_FOR];
    uint64_t adds_then[REMEMBERED_FOR];
    uint64_t adds, count;
};

/* A body as of the last step. */
struct body_then {
    dpt_body id;
    dpt_pose pose;
    const struct subject *subject;
    const float *positions; /* of a deformable one's vertices; else NULL */
    int is_affine;          /* they are as in struct soft */
    int is_vague;           /* where they were exactly was not told */
};

/* What the loads of the last step must sum up to, if it is known. */
struct due_loads {
    int is_none; /* there was no step, or it failed: there are no loads */
    int is_known;
    double wrench[6]; /* of all tools, about the origin */
};

struct scene {
    int world_count; /* 0: there is none */
    dpt_world *world[2];
    unsigned char *block[2]; /* as it was taken from the heap */
    size_t room;             /* bytes for a world in it */
    size_t offset;           /* of the world in the block */
    dpt_world_def def;       /* as the library must understand it */
    dpt_baseline_def baseline;
    struct model_body body[BODIES_MAX];
    struct model_tool tool[TOOLS_MAX];
    uint32_t body_count, tool_count, segment_count;
    struct removed removed_bodies, removed_tools;
    struct body_then then[BODIES_MAX];
    float then_positions[BODIES_MAX][3 * VERTICES_MOST]; /* where then[].positions are */
    uint32_t then_count;
    struct due_loads due;
    int is_as_stepped;      /* nothing that answers depend on changed since the last step */
    uint32_t contacts_then; /* of all tools, as the last step said, or as counted */
    dpt_world_info least;   /* what the usage must come to at least; bodies, tools and segments exactly */
};

extern struct scene scenes[SCENES];

/* The tool has one, in that world. */
static inline int has_proxy(const struct scene *scene, uint32_t law)
{
    return law == DPT_LAW_PROXY && scene->def.until == DPT_UNTIL_RESPOND && scene->def.method != DPT_METHOD_PAPER;
}

/* A scene with a world; NULL where there is none. */
struct scene *draw_scene(void);

struct model_body *scene_body(struct scene *scene, uint32_t id);
struct model_tool *scene_tool(struct scene *scene, uint32_t id);
const struct body_then *scene_body_then(const struct scene *scene, uint32_t id);

/* An id of any sort: mostly one of that kind that is there. */
uint32_t draw_body_id(struct scene *scene);
uint32_t draw_tool_id(struct scene *scene);

/* An id that the world gave: it is not 0, nobody's else, and no removed one's that is still refused. */
void scene_takes_id(struct scene *scene, struct removed *removed, uint32_t id);
void scene_removes_id(struct removed *removed, uint32_t id);

/* One step, of all worlds, and much of what they tell of it. */
void scene_steps(struct scene *scene);

void scene_forgets(struct scene *scene);                /* everything: a new world */
void scene_has_stepped(struct scene *scene, double dt); /* successfully */
void scene_is_stale(struct scene *scene);               /* all answers are */

/* Segments for a tool, or for none: which codes they may earn. */
void segments_codes(const struct scene *scene, const struct model_tool *tool, const dpt_segment *segments,
                    uint32_t count, struct codes *codes);

/* A tool was given a pose or segments that can be used; with NULL one that cannot. */
void tool_has_pose(struct scene *scene, struct model_tool *tool, const dpt_pose *pose);
void tool_has_segments(struct scene *scene, struct model_tool *tool, const dpt_segment *segments);

void scene_remove_body(struct scene *scene, struct model_body *body);
void scene_remove_tool(struct scene *scene, struct model_tool *tool);

/* World i's memory, of scene->room bytes. */
static inline unsigned char *scene_block(const struct scene *scene, int i)
{
    return scene->block[i] + scene->offset;
}

/* Something to feel, and something that feels: one to three, as far as they fit. */
void scene_gets_bodies(struct scene *scene);
void scene_gets_soft(struct scene *scene, const struct subject *subject);
void scene_gets_tools(struct scene *scene);

/* x of a pose's frame in the world. */
void to_world(const dpt_pose *pose, const double x[3], double out[3]);
void to_frame(const dpt_pose *pose, const double x[3], double out[3]);

/* A world, or NULL where the draw says so. */
static inline dpt_world *world_or_null(const struct scene *scene, int i, int is_null)
{
    return is_null ? NULL : scene->world[i];
}

#define EACH_WORLD(scene, i) for (int i = 0; i < (scene)->world_count; i++)

/* The twin's code is that of the first. */
#define SAME_RESULT(i, result, one)                                                                                    \
    do {                                                                                                               \
        const dpt_result same_result = (one);                                                                          \
        HOLDS((i) == 0 || same_result == (result), "the twin answers %s", dpt_result_name(same_result));               \
        (result) = same_result;                                                                                        \
    } while (0)

#endif
