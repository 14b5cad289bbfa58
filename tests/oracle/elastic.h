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
};

/* N/m: the force on the patch by how far it is in. Negative: there is no memory, or the block is not whole cells. */
double oracle_elastic_stiffness(const struct elastic_block *block);

#endif
