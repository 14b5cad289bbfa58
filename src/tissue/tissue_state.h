/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * What a step of tissue works with, together with the tools that touch it: docs/algorithms/tissue.md.
 */
#ifndef DPT_TISSUE_STATE_H
#define DPT_TISSUE_STATE_H

#include "deform/loaded_step.h"
#include "force/complementarity.h"
#include "insertion/world_channels.h"
#include "tissue/touches.h"

enum {
    TISSUE_NODES_MAX = 1536,
    TISSUE_WEIGHTS_MAX = 16384,
    TISSUE_TABLE = 4096,
    TISSUE_SLICES = 2048,
    TISSUE_BODIES_MAX = 16,
    TISSUE_TOOLS_MAX = 16,
    TISSUE_RUBS_MAX = 64,
    TISSUE_SHAFTS_MAX = 16,
    TISSUE_ROWS = COMPLEMENTARITY_MAX - 2 * TISSUE_RUBS_MAX - TISSUE_TOOLS_MAX, /* of touches and shafts */
    TWIST_NODES = 12
};

/* A body whose springs are stepped. */
struct tissue_body {
    uint32_t number; /* the caller's */
    const struct body *body;
    uint32_t is_touched;
    uint32_t
        shaft; /* one more than the number of the shaft that alone touches it; 0: others do, too, or nothing does */
    struct loaded_step step;
};

enum { RUB_OPEN, RUB_STICKS, RUB_SLIPS };

/*
 * Friction against a tool's turn about the normal of a touch: a couple on the corners of the touched triangle. Its row is of
 * how far the tool turns on the surface, times the tool's radius there.
 */
struct tissue_twist {
    uint32_t is_known; /* 1: it was looked for since touches were linked */
    uint32_t touch;
    uint32_t row; /* 0: there is none */
    uint32_t state;
    uint32_t has_returned; /* as of a rub */
    uint32_t count;        /* of nodes */
    double hold, kinetic;  /* friction's share of the push */
    double carried;        /* m: how far the surface was turned since the last step, by others */
    double pull;           /* N, while it slips */
    double mean;           /* N: of all substeps */
    double widest;         /* m: how far the corners are from their middle, in the mean */
    vec3 corner[3];        /* in the world */
    vec3 push[3];          /* on the tool there, of one newton of it */
    vec3 torque;           /* m: what these sum up to */
    uint16_t node[TWIST_NODES];
    double force[3][TWIST_NODES]; /* the same on nodes, but against it, in the body's frame: all x, y, z */
};

/* A tool that touches. Its unknowns are those of a motion from the proxy's pose. */
struct tissue_tool {
    uint32_t slot;
    uint32_t is_sliding; /* 1: all that held it by friction slid at the end of the last substep */
    uint32_t sticking;   /* touches that friction holds, and those that slip */
    uint32_t slipping;
    const struct proxy *proxy;
    struct proxy_pose at;
    vec3 axes[3];                    /* for turns */
    double stiffness;                /* N/m: of its spring, and of its damper over this step */
    double device[TOUCH_DIMENSIONS]; /* to the device */
    double away[TOUCH_DIMENSIONS];   /* to where it would be without any push: a damper keeps it from the device */
    double begin[TOUCH_DIMENSIONS];  /* to where it was before the step */
    double end[TOUCH_DIMENSIONS];    /* to where it was at the end of the last substep */
    double known[TOUCH_DIMENSIONS];  /* to where it would be with the pushes that are known, of friction that slides */
    double felt[TOUCH_DIMENSIONS];   /* from the device to its end pose: the mean of all substeps */
    struct tissue_twist twist;
    uint32_t is_pushed; /* something pushes it */
    uint32_t is_held;   /* and it has not turned too far from its device to be held there */
    dpt_pose last_end;  /* the proxy's before the step, if that is undone */
    struct displacement last_end_motion;
};

/* A node that a touch loads. */
struct tissue_node {
    uint32_t body; /* of the solve */
    uint32_t node;
    double response; /* m/N: how far a load on it moves it in a substep; of others that it moves see loaded_step.h */
    vec3 begin;      /* where it was before the step, in the body's frame */
    vec3 moved;      /* m: how far from there it would be after the substep, without tools */
    vec3 slid;       /* m: how far it would move in the substep, as friction sees it */
    vec3 load;       /* N, of a substep's answer */
    vec3 answer;     /* m: what pushes add to both: those that are known, and in the end all */
    int is_foreseen; /* `moved` is of this substep */
    uint32_t next;   /* one more than the number of another node of its slice; 0: none */
    uint32_t seen;   /* by the link that was made last of those that load it: its number */
    uint32_t place;  /* in that touch's link */
};

/* How a touch loads the tissue. */
struct tissue_link {
    uint32_t body;      /* of the solve, or DPT_NONE: what is touched is stepped by nobody here */
    uint32_t tool;      /* of the solve */
    uint32_t count;     /* of nodes */
    uint32_t is_narrow; /* 1: its load is not spread, for want of room */
    uint16_t *node;     /* of the solve */
    double *weight;     /* how much of the touch's force each takes, and of each one's motion the touch feels */
    double yields;      /* m/N: the body's own compliance, in series; 0: it is hard */
    double yielded;     /* m: by how much, in the last substep */
    double spread;      /* m: touches that are nearer to each other share it */
    double unfelt;      /* m: how far the point of the touch has risen unfelt, as it rose more than what is loaded */
    double depth; /* m: so far beneath the touch, along its normal, lies the mean of these, where the force acts */
};

/* What a touch that spreads its load passes on to the next step. */
struct spread_touch {
    uint32_t tool_slot, part, body_id;
    vec3 at;       /* in the body's frame */
    double unfelt; /* as that of its link */
};

/* A direction along which a touch may push: its normal, or a tangent; or the twist of its tool. */
struct tissue_row {
    uint32_t touch;
    uint32_t is_twist;
    vec3 along;                     /* unit, in the world */
    vec3 within;                    /* the same, in the body's frame */
    double lever[TOUCH_DIMENSIONS]; /* how the tool moves along it with its unknowns */
    double compliance;              /* m/N: of bristles between the two */
};

/* The friction of a touch that pushes: its rows are two tangents. */
struct tissue_rub {
    uint32_t touch;
    uint32_t row; /* the first one */
    uint32_t state;
    uint32_t has_returned; /* 1: it slipped in this solve, and friction would have driven it on */
    vec3 against;         /* unit, in the world: which way it pulled as it began to slip in this solve; 0: it did not */
    double hold, kinetic; /* friction's share of the push, while it sticks and while it slips */
    double carried[2];    /* m: how far the surface was moved along the tangents since the last step, by others */
    double pull[2];       /* N, along them: of one that slips it is known */
    double twist;         /* N: of the twist about its normal, if it was there in the last step, and slipped */
};

/*
 * A shaft in one of its channels: tissue_shaft.h. Forces on the tool are positive against going in. Rows are 0 where there is
 * none.
 */
struct tissue_shaft {
    uint32_t tool;   /* of the solve */
    uint32_t number; /* in the tool's insertion */
    struct channel *channel;
    uint32_t channel_id;
    uint32_t point_count; /* of those that hold it */
    const struct body *body;
    vec3 axis;                          /* of the tool at its proxy, in the world */
    uint32_t touch[CHANNEL_POINTS_MAX]; /* one more than that of each point of the channel; 0: it has none */
    double share[CHANNEL_POINTS_MAX];   /* of each point in the mean of all */
    vec3
        moved[CHANNEL_POINTS_MAX]; /* m: how far each would go, as a node's `moved` and `answer`, in the body's frame */
    vec3 known[CHANNEL_POINTS_MAX];          /* N, likewise: what is known to load it */
    vec3 load[CHANNEL_POINTS_MAX];           /* N: all that loads it in a substep */
    double across[CHANNEL_POINTS_MAX];       /* N/m */
    vec3 offset[CHANNEL_POINTS_MAX];         /* as a point's, in the world */
    uint32_t across_row[CHANNEL_POINTS_MAX]; /* the first of two */
    uint32_t friction_row, drag_row, stop_row, cut_row;
    double stiffness, stretch_max, limit; /* N/m, m, N: of the bristles along */
    double drag;                          /* Ns/m */
    double cutting;                       /* N */
    double place, wall, stop, uncut;      /* of the tip at the proxy, and where it is stopped, and begins to cut */
    double shared, mean, rest; /* as of struct inserted; where the tip is at the proxy, by the mean of points */
    double stretch;            /* m: in the last substep */
    double gone;               /* m: by which the tip has gone on in the step so far, as drag has it */
    double pull;               /* N, while it slips */
    double felt_friction, felt_cut, felt_stop; /* N: in the mean of the substeps */
    uint32_t is_slipping, is_cutting, has_slipped, is_paced;
};

/* m/N: how far a newton on one point of a shaft moves another one along itself; and what touches beside it. */
struct shaft_products {
    uint32_t is_known;
    uint32_t
        beside; /* one more than where these begin in the solve's `beside`, a row of points a touch; 0: not known */
    double of[CHANNEL_POINTS_MAX][CHANNEL_POINTS_MAX];
};

enum { TISSUE_BESIDE = 4096 };

enum { KEPT_LINKS_MAX = 64 };

/* What the link of a touch of a shaft is made of. */
struct kept_link {
    uint32_t channel_id, kind; /* a channel ends with its body, and a body has one mesh */
    uint32_t body, tool;       /* of the solve */
};

/* A touch that held at the end of a step: by what it is known again in the next one, and how it rubbed. */
struct touch_name {
    uint32_t tool_slot, part, body_id, triangle, feature;
};
struct held_touch {
    struct touch_name name;
    double push;  /* N */
    vec3 against; /* of its rub; 0: it did not slip */
    double twist; /* as of a rub */
};

struct tissue_solve {
    const struct dpt_world *world;
    double dt;        /* s, of the tick */
    double step;      /* s, of what is stepped of it: less where no tool could follow the whole */
    struct work work; /* of the whole step */
    uint32_t body_count;
    uint32_t tool_count;
    uint32_t node_count;
    uint32_t rub_count;
    uint32_t shaft_count;
    uint32_t row_count;  /* of all touches, then of shafts, then two of each rub and one of each twist */
    uint32_t is_begun;   /* 1: there was a substep since touches were linked */
    uint32_t substep;    /* of the step, from 0 on */
    uint32_t is_touched; /* 1: a tool's proxy does not reach its device in this tick */
    uint32_t tick;       /* the world's, in which its answer was told */
    uint32_t repeats;    /* how often in a row the answer was the same */
    uint32_t is_full; /* 1: touches or nodes had no room, too many held at one time, or one could be met by no push */
    uint32_t is_cut;  /* 1: a device leapt past more surface than a tick has time for */
    struct tissue_body bodies[TISSUE_BODIES_MAX];
    struct tissue_tool tools[TISSUE_TOOLS_MAX];
    double told[TISSUE_TOOLS_MAX][TOUCH_DIMENSIONS]; /* what each tool felt then */
    struct touches touches;
    struct touch_vertices vertices; /* of touches */
    struct touches room;            /* at the end of the step */
    struct tissue_link links[TOUCHES_MAX];
    struct tissue_node nodes[TISSUE_NODES_MAX];
    uint32_t linked;       /* links that were made, from 1 on */
    uint32_t weight_count; /* of all links */
    uint16_t weighted[TISSUE_WEIGHTS_MAX];
    double weight[TISSUE_WEIGHTS_MAX];
    struct tissue_rub rubs[TISSUE_RUBS_MAX];
    struct tissue_shaft shafts[TISSUE_SHAFTS_MAX];
    struct shaft_products products[TISSUE_SHAFTS_MAX]; /* of each shaft */
    uint32_t beside_count;
    double beside[TISSUE_BESIDE];
    /* Links of shafts that come before all others are the same from step to step, as their nodes are. */
    uint32_t kept_count, kept_nodes, kept_weights;
    struct kept_link kept[KEPT_LINKS_MAX];
    struct tissue_row rows[COMPLEMENTARITY_MAX];
    uint8_t kind[COMPLEMENTARITY_MAX]; /* of the rows, for the solver */
    uint32_t table[TISSUE_TABLE];      /* one more than a node's number; 0: none */
    uint16_t slices[TISSUE_SLICES];    /* of slices of nodes: likewise of the last one that was made */
    double spread[TISSUE_NODES_MAX];   /* how a newton of one touch moves each node; zero between uses */
    double free_gap[COMPLEMENTARITY_MAX];
    double multiplier[COMPLEMENTARITY_MAX]; /* N, of each row in a substep */
    vec3 push[TOUCHES_MAX];                 /* N, of each touch on its tool, in the world: the mean of all substeps */
    uint32_t spread_count;                  /* touches of the last step that spread their loads */
    struct spread_touch spread_touches[TOUCHES_MAX];
    uint32_t held_count; /* touches that held at the end of the last step */
    struct held_touch held[COMPLEMENTARITY_ACTIVE_MAX];
    struct complementarity problem;
};

/* Where the force of a touch acts, in the world. */
static inline vec3 tissue_middle(const struct tissue_solve *solve, uint32_t touch)
{
    return along(solve->touches.touch[touch].at, -solve->links[touch].depth, solve->touches.touch[touch].normal);
}

#endif
