/* SPDX-License-Identifier: BSD-3-Clause */
/* The channels of a world, and which tool is in which of them: docs/algorithms/insertion.md. */
#ifndef DPT_WORLD_CHANNELS_H
#define DPT_WORLD_CHANNELS_H

#include "insertion/channel.h"
#include "insertion/shaft_balance.h"
#include "track/world_state.h"

/* The tool in one of its channels. */
struct inserted {
    uint32_t channel; /* in the world's */
    uint32_t reserved;
    double anchor;   /* of its shaft there, as in struct shaft */
    double place;    /* of its tip there, m */
    double last;     /* m: likewise at the end of the last tick, before bodies moved */
    double slid;     /* m: so far the motion of this body against the host's has brought the tip deeper in this tick */
    double friction; /* N, in the last tick: along the shaft, against going in */
    double tip;      /* N: likewise what it takes at the tip, to cut or before a wall */
    /* Beside bodies that give way: src/tissue/tissue_shaft.h. */
    double rest;                       /* of the mean of its points: where bristles along are not stretched, m */
    double shared;                     /* the anchor by which points have their shares in that mean */
    double inside;                     /* m: of the shaft, while it sticks */
    double push;                       /* N: of the tip on the wall that stops it */
    double pace;                       /* m: so far the tip may go deeper in the next step */
    uint32_t is_shared;                /* 1: `rest`, `shared` and `inside` are known */
    uint32_t is_slipping, has_slipped; /* at the end of the last tick, and in it */
    uint32_t is_cutting;               /* the tip has gone on cutting in the last tick */
    uint32_t is_paced;                 /* the pace held the tip in the last tick */
};

/* Of a tool. All zeros: it is in no channel. The first is its host: the others lie on its line. */
struct insertion {
    uint32_t count;              /* of channels that the tool is in */
    uint32_t is_dropping;        /* a wall has ruptured, and the tip has not come to rest since */
    double energy;               /* J: that the bristles store */
    double push;                 /* N: of the tip on what stops it, beside cutting */
    double others_work;          /* J: of bodies other than the host, by their motion against it, in this tick */
    uint32_t stopped_by;         /* the body that does and that it is not in, by its id; 0: none */
    uint32_t stopped_at;         /* place of its triangle */
    struct displacement carried; /* by the host's motion, in the last tick */
    struct inserted in[INSERTION_CHANNELS_MAX];
};

/* What a tool is in, and its search for the walls behind one that its tip is about to rupture. */
struct piercing_tool {
    struct insertion insertion;
    struct channel_search search;
};

/* Their share of dpt_world_bytes: none where the def has no room for channels. */
uint64_t dpti_channels_bytes(const dpt_world_def *def);

/* Place their memory at `at`; returns where it ends. */
char *dpti_channels_place(struct dpt_world *world, char *at);

/* What a tool is in; only where the world has channels. */
static inline struct insertion *insertion_of(const struct dpt_world *world, const struct tool *tool)
{
    return &world->piercing_tools[tool - world->tools].insertion;
}

/* Its search; likewise. */
static inline struct channel_search *channel_search_of(const struct dpt_world *world, const struct tool *tool)
{
    return &world->piercing_tools[tool - world->tools].search;
}

/* 1 if a tool is in a channel. */
static inline int tool_is_inserted(const struct dpt_world *world, const struct tool *tool)
{
    return world->channels && insertion_of(world, tool)->count > 0;
}

/* 1 if a tool is in a channel of a body that deforms. */
int dpti_is_inserted_in_tissue(const struct dpt_world *world, const struct tool *tool);

/* 1 if a tool is in a channel of the body. */
int dpti_is_inserted_in(const struct dpt_world *world, const struct tool *tool, uint32_t body_id);

/* The body of a channel. A channel ends with its body. */
const struct body *dpti_channel_body(const struct dpt_world *world, const struct channel *channel);

/* A channel that is free, or NULL. */
struct channel *dpti_channel_free(const struct dpt_world *world);

/* Give a channel that was laid its id: from now on it is there. */
void dpti_channel_open(struct dpt_world *world, struct channel *channel, const struct body *body,
                       const struct tool *tool);

/* The tool is in a channel from now on, its tip at `place`. There must be room in its insertion. */
void dpti_insertion_add(struct dpt_world *world, const struct tool *tool, const struct channel *channel, double place);

/* The tool leaves one of its channels, by its number. The hole stays. */
void dpti_insertion_drop(struct insertion *insertion, uint32_t number);

/* The tool leaves all of them, if it is in any. */
void dpti_insertion_forget(struct dpt_world *world, const struct tool *tool);

/* All holes of a body close, or all that a tool made. A tool that was in one goes on from where it is. */
void dpti_channels_forget_body(struct dpt_world *world, uint32_t body_id);
void dpti_channels_forget_tool(struct dpt_world *world, const struct tool *tool);

#endif
