/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Where masses and springs are in balance: Newton's method in double, each step by conjugate gradients. It shares nothing
 * with the library.
 *
 * Of several balances it finds one near where it starts; a spring that is pressed counts along itself alone in the
 * matrix, so that it does not leave a minimum. It cannot judge which one a body that moves would end in.
 */
#ifndef DPT_TESTS_ORACLE_SPRING_BALANCE_H
#define DPT_TESTS_ORACLE_SPRING_BALANCE_H

#include <stddef.h>
#include <stdint.h>

struct oracle_spring {
    uint32_t a, b;
    double stiffness, length; /* N/m, m */
};

struct oracle_springs {
    uint32_t nodes, springs;
    const struct oracle_spring *list;
    const float *mass;  /* 1 a node; 0: it is fixed */
    const double *load; /* 3 a node, N */
};

/*
 * x: 3 a node, m; in: where to start; out: the balance. A step moves no coordinate by more than `longest` m. Returns the
 * last step's size, which is below 1e-10 m or what 80 rounds leave; negative if there is no memory.
 */
double oracle_spring_balance(const struct oracle_springs *springs, double longest, double *x);

/* N: the largest part of a force that is left on a free node. Negative if there is no memory. */
double oracle_spring_rest(const struct oracle_springs *springs, const double *x);

#endif
