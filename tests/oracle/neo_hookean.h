/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Blocks of a compressible Neo-Hookean solid, whose strains may be large: energy per volume
 *
 *     mu / 2 (F:F - 3 - 2 ln J) + lambda / 2 (J - 1)^2
 *
 * (J. Bonet, R. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, with this volume term). With free sides in
 * closed form; between plates that hold it by trilinear cubes of eight Gauss points whose J in the second term is its mean
 * in the cube, so that nothing locks, by conjugate gradients on the energy. It shares nothing with the library.
 *
 * Another volume term, lambda / 2 (ln J)^2, keeps 0.1 to 0.2 % more of the volume where a fifth is pressed away: it cannot
 * judge more finely.
 */
#ifndef DPT_TESTS_ORACLE_NEO_HOOKEAN_H
#define DPT_TESTS_ORACLE_NEO_HOOKEAN_H

/* The share of its volume that a block has left when it is pressed to `length` times its own, its sides free. */
double oracle_neo_hookean_free(double poisson, double length);

/*
 * The same of a cube between plates to which it sticks, of `cells` cubes a side, an even number, at most 16. 0: there is no
 * memory, or it has not come to rest.
 */
double oracle_neo_hookean_held(double poisson, double length, unsigned cells);

#endif
