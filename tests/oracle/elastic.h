/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A block of an isotropic material, indented: linear elasticity by trilinear cubes of eight Gauss points, solved by
 * conjugate gradients in double. It shares nothing with the library.
 *
 * The block is 2 half x 2 half x depth; its lower face is held, its sides are free. A square of 2 patch x 2 patch in the
 * middle of its upper face is pushed in and does not move sideways. A quarter of it is solved; the rest is its mirror
 * image. `half`, `depth` and `patch` are whole numbers of `cell`.
 *
 * Strains are small: it cannot judge how a force grows with depth. At the border of the patch the pressure has no bound,
 * so that the force converges with the first power of `cell`, from above: its limit is near twice that of half the cell
 * less that of the whole (tests/deform/test_springs_indent.c measures it).
 */
#ifndef DPT_TESTS_ORACLE_ELASTIC_H
#define DPT_TESTS_ORACLE_ELASTIC_H

struct elastic_block {
    double half, depth, patch, cell; /* m */
    double young, poisson;           /* Pa */
    /*
     * 1: an element's dilatation is its mean (the term of lambda by one point, that of mu by eight), so that a ratio near a
     * half does not lock; 0: it is that of each point
     */
    int is_mean;
    int slides; /* 1: patch and lower face are held along z alone */
};

/*
 * What presses it in place of the patch, without friction: a ball, or a cylinder along y that is longer than the block, so
 * deep below the upper face. Nodes of that face are held where they would be in the tool, as long as it pushes them. The
 * pressure goes to 0 at the border of what is touched, and the force converges faster than with a patch.
 */
struct elastic_tool {
    double radius, depth; /* m */
    int is_long;          /* 1: a cylinder */
};

/* N: on the tool. Negative: as below. */
double oracle_elastic_force(const struct elastic_block *block, const struct elastic_tool *tool);

/* N/m: the force on the patch by how far it is in. Negative: there is no memory, or the block is not whole cells. */
double oracle_elastic_stiffness(const struct elastic_block *block);

/* How far the middle of a side moves outward, by how far the patch is in. 0 for what cannot be solved. */
double oracle_elastic_bulge(const struct elastic_block *block);

/* The share of its volume that it loses, by the share of its depth by which it is pressed. 0 likewise. */
double oracle_elastic_loss(const struct elastic_block *block);

#endif
