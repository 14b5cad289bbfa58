/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Polynomials in time with whole coefficients, their roots between 0 and 1, and the sign of one at a root of another.
 * All of it is exact, for any coefficients. Multiple roots, common roots and the polynomial 0 are cases like others.
 */
#ifndef DPT_TESTS_ORACLE_ROOT_H
#define DPT_TESTS_ORACLE_ROOT_H

#include <gmpxx.h>
#include <vector>

// [k] belongs to time^k. The last is not 0; the polynomial 0 is empty.
typedef std::vector<mpz_class> polynomial;

polynomial operator+(const polynomial &a, const polynomial &b);
polynomial operator-(const polynomial &a, const polynomial &b);
polynomial operator*(const polynomial &a, const polynomial &b);

// The greatest common divisor, up to a factor; that of 0 and a is a.
polynomial common_divisor(polynomial a, polynomial b);

// A time: m / 2^k where `before` is 0. Otherwise the only root of p between m / 2^k and (m + 1) / 2^k, both not
// included. There p changes its sign, from `before`.
struct moment {
    polynomial p;
    mpz_class m;
    unsigned long k;
    int before;
};

// All roots between 0 and 1, both not included, in any order. None for the polynomial 0.
std::vector<moment> roots_of(const polynomial &f);

// -1, 0 or 1. It narrows the moment as far as it needs to.
int sign_at(const polynomial &f, moment &when);

// The largest double that is not later, and the smallest that is not earlier; equal where the moment is a double. The
// moment is between 0 and 1.
void doubles_around(const moment &when, double *low, double *high);

#endif
