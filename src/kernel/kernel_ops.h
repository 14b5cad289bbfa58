/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The inner loops: lower bounds of 16 distances at once, in float. Each loop is written once (kernel_body.h) and
 * compiled for each instruction set. All kernels give the same bits (tests/kernel/test_kernel_bits.c).
 *
 * All values here are in the filter's frame: coordinates are (x - centre) * scale with the surface's filter_centre and
 * filter_scale, so that every vertex lies within -1..1.
 *
 * A bound is sound for ANY direction n: (min n.v - max(n.A, n.B)) / |n|, where v runs over the vertices, is a lower
 * bound of the distance from segment AB to the vertices' hull. A bad guess of n makes the bound loose, never wrong.
 * What remains is the rounding of a few dot products; kernel_margin covers it.
 */
#ifndef DPT_KERNEL_OPS_H
#define DPT_KERNEL_OPS_H

#include "base/lanes.h"
#include "dynpoint/kernel.h"
#include "dynpoint/types.h"

/*
 * A bound exceeds the true distance by at most kernel_margin(|A|, |B|), plus KERNEL_STRETCH times itself, since a
 * direction may be longer than 1. docs/algorithms/bvh.md adds up the terms: at most 47 + 20 |A| + |B| units of 2^-24,
 * and 10 units of the bound.
 */
static inline double kernel_margin(double a, double b)
{
    return (56.0 + 24.0 * a + 4.0 * b) * 0x1p-24;
}
#define KERNEL_STRETCH 0x1p-20

/*
 * The same for a swept hull, |X| that of its farthest end: at most 16 + 10 |X| units. PIECE_MARGIN, of `beside`, is far
 * more than the rounding of the part of the axis that counts. An axis that is shorter along the tool than
 * PIECE_AXIS_MIN counts as a whole.
 */
static inline double kernel_swept_margin(double x)
{
    return (24.0 + 12.0 * x) * 0x1p-24;
}
#define PIECE_MARGIN   0x1p-15
#define PIECE_AXIS_MIN 0x1p-16f

/* 16 planes: all vertices v of a lane have n.v >= support. A lane of zeros has no plane. */
struct planes {
    float x[LANES], y[LANES], z[LANES]; /* n, about unit length */
    float support[LANES];
};

/* A tool axis from a to b, with a right-handed orthonormal frame x, y, z of which x leads from a to b. */
struct filter_segment {
    float a[3], b[3];
    float limit;  /* a lane whose bound exceeds it is closed */
    float margin; /* kernel_margin(|a|, |b|) */
    float x[3], y[3], z[3];
    float length;
    float normal[3]; /* of the plane through the best pair, away from the axis */
    float height;    /* the larger of normal.a and normal.b */
};

/*
 * The swept hull of a moving axis: the convex hull of the positions of its two ends at two times, which contains the
 * axis at all times between. Bounds are of the distance to the part of the axis that can be near a lane: where one
 * is beyond the limit, so is the whole axis at all times between, up to kernel_swept_margin.
 */
struct swept_hull {
    float end[4][3];
    float reach[2]; /* end a of the tool's axis may be as far from its two positions' line; end b */
    /* A box around the hull, used only to choose directions: axes along the tool, along its motion, across both. */
    float axis[3][3]; /* orthonormal rows */
    float centre[3], half[3];
    float limit;
    /* A point of the axis is near a lane only within that distance before and behind it, along the tool. */
    float beside;
};

/*
 * The loops. Each returns the open lanes as bits: those whose bound does not exceed the limit. A bound that is no
 * number leaves its lane open.
 *
 *   cached_*   in: 16 cached planes. out: the bounds that they give for the axis now
 *   boxes      out: 16 new planes, and the bounds that they give; the loop `triangles` likewise
 *   better     replace each cached plane, and its bound, by the new one if that has the greater bound, or if the
 *              cached bound is no number
 *   swept_*    out: bounds of the distance to a swept hull
 *   point_*    out: squared bounds of the distance to a point. For boxes they are exact but for rounding. The limit is
 *              a square too
 *   common_*   out: the supports of 16 boxes or triangles along one normal. A lane is open if its support does not
 *              exceed `limit`
 *
 * A block of boxes has 6 rows of 16 numbers: centre x, y, z, half width x, y, z. A block of triangles has 9 rows of 16:
 * x, y, z of corner 0, then of corner 1, then of corner 2.
 */
typedef uint32_t kernel_cached(const float *block, const struct filter_segment *segment, const struct planes *planes,
                               float *bound);
typedef uint32_t kernel_new_planes(const float *block, const struct filter_segment *segment, struct planes *planes,
                                   float *bound);
typedef void kernel_better(const struct planes *made, const float *made_bound, struct planes *planes, float *bound);
typedef uint32_t kernel_common(const float *block, const float normal[3], float limit, float *support);
typedef uint32_t kernel_swept(const float *block, const struct swept_hull *hull, float *bound);
typedef uint32_t kernel_point(const float *block, const float at[3], float limit, float *bound);

/*
 * The loops for the winding number (docs/algorithms/winding.md), as seen from the point `at`. Both add the winding of
 * 16 lanes, in turns, to the 16 sums winding[]. They return the open lanes, for which they added nothing.
 *
 *   moments   16 sets of triangles, in rows that cluster.h makes. Adds the error bound of each lane to error_sum[]. A
 *             lane is open if its error may be max_error or more
 *   angles    those of a leaf's 16 triangles that are in `lanes`. A triangle is open if it fills so much of the view,
 *             or is so near, that float is not accurate enough
 */
typedef uint32_t kernel_moments(const float *block, const float at[3], float max_error, float *winding,
                                float *error_sum);
typedef uint32_t kernel_angles(const float *block, const float at[3], uint32_t lanes, float *winding);

/*
 * When a triangle's solid angle is accurate in float. a, b, c lead from the point to its corners. The denominator of
 * the half angle's tangent must exceed KERNEL_ANGLE_OPEN |a| |b| |c|, and the nearest corner's squared distance
 * KERNEL_ANGLE_NEAR: then the rounding of the point matters little.
 */
#define KERNEL_ANGLE_OPEN 0x1p-4f
#define KERNEL_ANGLE_NEAR 0x1p-24f

/*
 * Vertices that move, in the body's frame: groups of KERNEL_GROUP vertices, x, y, z each.
 *
 *   move      copies `next` to `to`, and sets square[] to the largest squared distance of a vertex of each group from
 *             where it was, `last`
 *   outside   1 if any coordinate is below `low`, above `high` or no number; both are a group's, of one vertex repeated
 */
enum { KERNEL_GROUP = 16 };
typedef void kernel_move(const float *next, const float *last, float *to, uint32_t groups, float *square);
typedef uint32_t kernel_outside(const float *positions, uint32_t groups, const float *low, const float *high);

/*
 * Springs (docs/algorithms/springs.md). 16 nodes make a slice. Rows of 16 entries for each slice, as in
 * mesh/spring_net.h. Points are x, y, z and an unused number a node; all other vectors of a slice are rows of 16: x, y,
 * z. A slice's sums run over its entries in order, lane by lane, so they are the same with every kernel.
 *
 *   spring_forces   force = the sum over a node's springs of k (1 - L / l) d, where d leads to the other node and l is |d|,
 *                   or half of L if that is longer
 *   spring_energy   the same, and adds k ((l - L)^2 + l^2 - |d|^2) to each node's lane of sum[]: twice a spring's energy
 *   spring_product  out = scale * sum of k (u_i - u_j) + diagonal * u_i, and adds u . out to the lanes of sum[]
 *   spring_move     an explicit step of a slice. Sets *square to the largest squared speed after it. Returns 0 if all
 *                   coordinates and speeds are numbers within the motion's limits
 *   spring_descend  change += by * direction, residual -= by * product; adds residual . per_diagonal residual to sum[]
 *   spring_turn     direction = per_diagonal residual + by * direction
 *   spring_aim      points where nodes fly to, and `back` seconds of their speed ahead
 *   spring_begin    the right-hand side of an implicit step as the residual, from the forces; the first direction, no
 *                   change yet. Adds residual . per_diagonal residual to sum[]
 *   spring_end      where nodes are after the change, and how fast. Adds to bound[] and work[], lane by lane, what
 *                   deform/spring_step.c needs. Sets *square and returns as spring_move does
 *   spring_points   the points of a slice: its nodes, `lead` s ahead of where they are
 *   spring_follow   where 16 vertices are, x, y, z each: the sum of four weighted points each, in double. A
 *                   number more is written
 *
 * Cells (docs/algorithms/springs.md, "Cells keep their volume"), 16 a slice. A cell pulls at its corners 0 to 3 with four
 * points, and at corners 7 to 4 the other way.
 *
 *   cell_pulls      those of a slice of cells: four rows of 16 points
 *   cell_energy     the same, and adds each cell's energy to its lane of sum[]
 *   cell_forces     adds to the force of a slice of nodes what their cells pull. at: 8 rows of 16 numbers: where
 *                   in all pulls the points of the cells are whose corner 0, 1, ... 7 a node is; a point that is zero
 *                   where there is none
 */
#define SPRING_SHORTEST 0.5f
enum { SPRING_ROWS = 3 * LANES, SPRING_POINTS = 4 * LANES };

struct spring_rows {
    const uint32_t *first;
    const uint32_t *neighbour;
    const float *stiffness;
    const float *length;
};

/* The state of a slice between steps: positions, their rounding remainders, speeds. */
struct spring_slice {
    float x[SPRING_ROWS], rest[SPRING_ROWS], v[SPRING_ROWS];
};

/*
 * Of a cell's volume, in units of that at rest. It is exact while the squares of the cell's mean edges, by their length
 * at rest, sum up to no more than CELL_EXACT, and grows with the size alone where it has far outgrown CELL_MOST.
 */
#define CELL_EXACT  3.375f
#define CELL_MOST   4.125f
enum { CELL_CORNERS = 8 * LANES, CELL_PULLS = 4 * SPRING_POINTS };

struct spring_cells {
    const uint32_t *nodes;     /* 8 rows of 16 a slice of cells */
    const float *stiffness;    /* 16 a slice: N/m */
    float per_edges, quarter;  /* 1/m: 1 / four edges at rest; m: a quarter of one */
    float slope, turn, turn_slope; /* of the pressure over the volume, by the shear modulus; the second below `turn` */
    float smallest, largest;   /* volumes beyond which the pressure is what it is there */
};

/* What stays the same in a slice: 1 / mass, 0 for a node that is fixed; drag, 1/s. */
struct spring_nodes {
    float per_mass[LANES], drag[LANES];
};

/* A step: its length, what forces are multiplied by, the points' lead before the nodes. */
struct spring_motion {
    float step, scale, lead;
    float gravity[3];
    float far, fast; /* m, m/s: the limits */
    uint32_t is_euler;
};

/*
 * An implicit step: from where nodes fly to with a `common` acceleration, m/s2, if `flies` is 1, or from where they
 * are, if it is 0; springs are taken `back` seconds of their speed ahead of that.
 */
struct spring_trial {
    float step, per_step, flies, back, scale;
    float gravity[3], common[3];
    float far, fast;
    uint32_t has_lead;
};

/* Of a slice, in an implicit step. */
struct spring_system {
    /* 0 for a fixed node. glide: the share of the speed that drag leaves after a step */
    float mass[LANES], glide[LANES], diagonal[LANES], per_diagonal[LANES];
    float residual[SPRING_ROWS], change[SPRING_ROWS];
};

typedef void kernel_spring_forces(const struct spring_rows *rows, uint32_t slice, const float *points, float *force);
typedef void kernel_spring_energy(const struct spring_rows *rows, uint32_t slice, const float *points, float *force,
                                  double *sum);
typedef void kernel_spring_product(const struct spring_rows *rows, uint32_t slice, float scale, const float *diagonal,
                                   const float *points, float *out, double *sum);
typedef uint32_t kernel_spring_move(const struct spring_motion *motion, const struct spring_nodes *nodes,
                                    const float *force, const float *load, const struct spring_slice *from,
                                    struct spring_slice *to, float *points, float *square);
typedef void kernel_spring_descend(float by, const float *direction, const float *product, struct spring_system *system,
                                   double *sum);
typedef void kernel_spring_turn(float by, const struct spring_system *system, float *direction);
typedef void kernel_spring_aim(const struct spring_trial *trial, const struct spring_slice *state,
                               const struct spring_system *system, float *points);
typedef void kernel_spring_begin(const struct spring_trial *trial, const struct spring_slice *state, const float *force,
                                 const float *load, struct spring_system *system, float *direction, double *sum);
typedef uint32_t kernel_spring_end(const struct spring_trial *trial, const struct spring_slice *from,
                                   const float *force, const float *load, const struct spring_system *system,
                                   struct spring_slice *to, double *bound, double *work, float *square);
typedef void kernel_spring_points(const struct spring_slice *slice, float lead, float *points);
typedef void kernel_spring_follow(const float *points, const uint32_t *nodes, const float *weights, float *to);
typedef void kernel_cell_pulls(const struct spring_cells *cells, uint32_t slice, const float *points, float *pulls);
typedef void kernel_cell_energy(const struct spring_cells *cells, uint32_t slice, const float *points, float *pulls,
                                double *sum);
typedef void kernel_cell_forces(const uint32_t *at, const float *pulls, float *force);

struct kernel {
    kernel_cached *cached_boxes;
    kernel_cached *cached_triangles;
    kernel_new_planes *boxes;
    kernel_new_planes *triangles;
    kernel_better *better;
    kernel_common *common_boxes;
    kernel_common *common_triangles;
    kernel_swept *swept_boxes;
    kernel_swept *swept_triangles;
    kernel_point *point_boxes;
    kernel_point *point_triangles;
    kernel_moments *moments;
    kernel_angles *angles;
    kernel_move *move;
    kernel_outside *outside;
    kernel_spring_forces *spring_forces;
    kernel_spring_energy *spring_energy;
    kernel_spring_product *spring_product;
    kernel_spring_move *spring_move;
    kernel_spring_descend *spring_descend;
    kernel_spring_turn *spring_turn;
    kernel_spring_aim *spring_aim;
    kernel_spring_begin *spring_begin;
    kernel_spring_end *spring_end;
    kernel_spring_points *spring_points;
    kernel_spring_follow *spring_follow;
    kernel_cell_pulls *cell_pulls;
    kernel_cell_energy *cell_energy;
    kernel_cell_forces *cell_forces;
};

/* The widest kernel that every machine of this kind has. */
#if defined(DPT_SCALAR)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SCALAR
#elif defined(__x86_64__)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SSE2
#elif defined(__aarch64__)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_NEON
#elif defined(__wasm_simd128__)
#define DPT_KERNEL_ALWAYS DPT_KERNEL_WASM128
#else
#define DPT_KERNEL_ALWAYS DPT_KERNEL_SCALAR
#endif

/*
 * Fill `kernel` with the loops of DPT_KERNEL_... `id`; AUTO stands for the best one of this machine. *chosen is its id.
 * Returns 0 if this build or machine does not have it.
 */
int dpti_kernel_get(uint32_t id, struct kernel *kernel, uint32_t *chosen);

#define KERNEL_DECLARE(set)                                                                                            \
    kernel_cached dpti_kernel_##set##_cached_boxes, dpti_kernel_##set##_cached_triangles;                              \
    kernel_new_planes dpti_kernel_##set##_boxes, dpti_kernel_##set##_triangles;                                        \
    kernel_better dpti_kernel_##set##_better;                                                                          \
    kernel_common dpti_kernel_##set##_common_boxes, dpti_kernel_##set##_common_triangles;                              \
    kernel_swept dpti_kernel_##set##_swept_boxes, dpti_kernel_##set##_swept_triangles;                                 \
    kernel_point dpti_kernel_##set##_point_boxes, dpti_kernel_##set##_point_triangles;                                 \
    kernel_moments dpti_kernel_##set##_moments;                                                                        \
    kernel_angles dpti_kernel_##set##_angles;                                                                          \
    kernel_move dpti_kernel_##set##_move;                                                                              \
    kernel_outside dpti_kernel_##set##_outside;                                                                        \
    kernel_spring_forces dpti_kernel_##set##_spring_forces;                                                            \
    kernel_spring_energy dpti_kernel_##set##_spring_energy;                                                            \
    kernel_spring_product dpti_kernel_##set##_spring_product;                                                          \
    kernel_spring_move dpti_kernel_##set##_spring_move;                                                                \
    kernel_spring_descend dpti_kernel_##set##_spring_descend;                                                          \
    kernel_spring_turn dpti_kernel_##set##_spring_turn;                                                                \
    kernel_spring_aim dpti_kernel_##set##_spring_aim;                                                                  \
    kernel_spring_begin dpti_kernel_##set##_spring_begin;                                                              \
    kernel_spring_end dpti_kernel_##set##_spring_end;                                                                  \
    kernel_spring_points dpti_kernel_##set##_spring_points;                                                            \
    kernel_spring_follow dpti_kernel_##set##_spring_follow;                                                            \
    kernel_cell_pulls dpti_kernel_##set##_cell_pulls;                                                                  \
    kernel_cell_energy dpti_kernel_##set##_cell_energy;                                                                \
    kernel_cell_forces dpti_kernel_##set##_cell_forces;
KERNEL_DECLARE(scalar)
KERNEL_DECLARE(sse2)
KERNEL_DECLARE(avx2)
KERNEL_DECLARE(avx512)
KERNEL_DECLARE(neon)
KERNEL_DECLARE(wasm128)
#undef KERNEL_DECLARE

#endif
