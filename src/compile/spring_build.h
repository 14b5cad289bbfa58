/* SPDX-License-Identifier: BSD-3-Clause */
/* Masses and springs under construction. Sheets and lattices add them; spring_build.c arranges them for the file. */
#ifndef DPT_COMPILE_SPRING_BUILD_H
#define DPT_COMPILE_SPRING_BUILD_H

#include "compile/model.h"

/* One share of the stiffness of a spring; a spring is the sum of its shares, in the order in which they were added. */
struct spring_share {
    uint32_t low, high; /* nodes, low < high */
    uint32_t order;     /* in which it was added */
    double stiffness;   /* N/m */
};

struct net {
    const dpt_spring_net_def *def;
    soup *source;
    uint32_t node_count;
    const float *rest;   /* 3 each, m */
    const int32_t *grid; /* 3 each: whole coordinates in the lattice, ascending by z, y, x; NULL: a sheet */
    double *mass;        /* kg */
    struct spring_share *shares;
    size_t share_count, share_capacity;
    double cell_size;   /* of a lattice, m */
    double *cell_bound; /* 1 a node: what the volumes of its cells add to a row's sum, N/m; NULL: no cell has a term */
    uint32_t *cell_nodes; /* as the file has them (spring_net.h) */
    float *cell_stiffness;
    uint32_t cell_count;
    uint8_t *is_used; /* of each region: 1 if it holds a part of the body */
    double square;    /* 1/s^2: no part of the net that has its own mass moves faster; 0: not known */
};

/* The material at a point. */
struct material {
    double young, density, drag;
};

/* Check the numbers of a def, and replace zeros by defaults. Returns DPT_OK, or fills the diag. */
dpt_result springs_check(const struct compile_context *context, dpt_spring_net_def *def);

/* Check a region. The diag gets its `number` and the location. */
dpt_result springs_check_region(const struct compile_context *context, const dpt_spring_region *region, uint32_t number,
                                source_location location);

/* The material at a point, by the last region that holds it. Notes which regions are used. */
struct material spring_material(struct net *net, const double x[3]);

/* Add stiffness to the spring between two nodes. */
dpt_result spring_add(struct net *net, uint32_t a, uint32_t b, double stiffness);

/* Fill in masses and springs of a sheet. The nodes and room for their masses must exist. */
dpt_result sheet_springs(struct net *net, const struct model *model);

/* A lattice in the closed parts. Call spring_lattice_free, also after an error. */
struct spring_lattice {
    double low[3];     /* its lowest corner, m */
    double spacing;    /* m */
    uint32_t cells[3]; /* along x, y and z */
    float *share;      /* of each cell, x fastest: the share of it that is inside; 0: not a cell of the body */
    uint32_t *node;    /* of each corner of a cell, x fastest: its number, or DPT_NONE */
    float *rest;       /* 3 a node, m */
    int32_t *grid;     /* 3 a node */
    uint32_t node_count, cell_count;
};

/* Find the cells, their shares and the nodes. spacing 0: the default. */
dpt_result spring_lattice_make(struct spring_lattice *lattice, const struct model *model, soup *source, double spacing);

/* Fill in masses and springs of the lattice. */
dpt_result spring_lattice_springs(struct net *net, const struct spring_lattice *lattice);

/* Embed the model's vertices in the lattice: each cell is cut into six tetrahedra about a diagonal. */
dpt_result spring_lattice_embed(const struct spring_lattice *lattice, struct model *model, soup *source);

void spring_lattice_free(struct spring_lattice *lattice);

/* Sort and add up the shares, and arrange everything as in the file. */
dpt_result spring_lay_out(struct net *net, struct model *model, const uint8_t *is_fixed);

#endif
