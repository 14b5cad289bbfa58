/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_matrix.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

/* A pivot below this fraction of its column is rounding. */
static const double PIVOT_MIN = 1e-12;

/* Jacobi's method converges in fewer. */
enum { N = IDENTIFY_UNKNOWNS_MAX, SWEEPS = 20 };

/* By Cholesky's factors, each column scaled to unit length. A column without a pivot is left out. */
int identify_solve(int n, const double a[N][N], const double *b, double *x)
{
    double scale[N], factor[N][N], y[N];
    int is_used[N], used = 0;
    for (int i = 0; i < n; i++)
        scale[i] = a[i][i] > 0.0 ? 1.0 / sqrt(a[i][i]) : 0.0;
    for (int i = 0; i < n; i++) {
        double pivot = scale[i] > 0.0 ? 1.0 : 0.0, rest = scale[i] * b[i];
        for (int j = 0; j < i; j++) {
            double sum = scale[i] * scale[j] * a[i][j];
            for (int k = 0; k < j; k++)
                sum -= factor[i][k] * factor[j][k];
            factor[i][j] = is_used[j] ? sum / factor[j][j] : 0.0;
            pivot -= factor[i][j] * factor[i][j];
            rest -= factor[i][j] * y[j];
        }
        is_used[i] = pivot > PIVOT_MIN;
        used += is_used[i];
        factor[i][i] = is_used[i] ? sqrt(pivot) : 0.0;
        y[i] = is_used[i] ? rest / factor[i][i] : 0.0;
        for (int j = 0; j < i && !is_used[i]; j++)
            factor[i][j] = 0.0;
    }
    for (int i = n - 1; i >= 0; i--) {
        double rest = y[i];
        for (int k = i + 1; k < n; k++)
            rest -= factor[k][i] * x[k];
        x[i] = is_used[i] ? rest / factor[i][i] : 0.0;
    }
    for (int i = 0; i < n; i++)
        x[i] *= scale[i];
    return used;
}

int identify_inverse(const double *a, double *inverse)
{
    const vec3 row[3] = { vec3_of(a), vec3_of(a + 3), vec3_of(a + 6) };
    const vec3 column[3] = { cross(row[1], row[2]), cross(row[2], row[0]), cross(row[0], row[1]) };
    const double determinant = dot(row[0], column[0]);
    memset(inverse, 0, 9 * sizeof *inverse);
    if (!(fabs(determinant) > 1e-9 * length(row[0]) * length(row[1]) * length(row[2])))
        return 0;
    for (int k = 0; k < 3; k++) {
        inverse[k] = column[k].x / determinant;
        inverse[3 + k] = column[k].y / determinant;
        inverse[6 + k] = column[k].z / determinant;
    }
    return 1;
}

void identify_product(const double *a, const double *b, double *out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

void identify_symmetric(double *a)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < i; j++)
            a[3 * i + j] = a[3 * j + i] = 0.5 * (a[3 * i + j] + a[3 * j + i]);
}

/* Turn rows and columns p and q of `a`, and the vectors, so that a[p][q] becomes 0 (Jacobi). */
static void turn(int n, double *a, double *vectors, int p, int q)
{
    const double off = a[n * p + q];
    if (off == 0.0)
        return;
    const double ratio = (a[n * q + q] - a[n * p + p]) / (2.0 * off);
    const double tangent = (ratio < 0.0 ? -1.0 : 1.0) / (fabs(ratio) + sqrt(ratio * ratio + 1.0));
    const double cosine = 1.0 / sqrt(tangent * tangent + 1.0), sine = tangent * cosine;
    for (int k = 0; k < n; k++) {
        const double x = a[n * k + p], y = a[n * k + q];
        a[n * k + p] = cosine * x - sine * y;
        a[n * k + q] = sine * x + cosine * y;
    }
    for (int k = 0; k < n; k++) {
        const double x = a[n * p + k], y = a[n * q + k];
        a[n * p + k] = cosine * x - sine * y;
        a[n * q + k] = sine * x + cosine * y;
        const double u = vectors[n * p + k], v = vectors[n * q + k];
        vectors[n * p + k] = cosine * u - sine * v;
        vectors[n * q + k] = sine * u + cosine * v;
    }
}

void identify_eigen(int n, const double *matrix, double *values, double *vectors)
{
    double a[N * N], found[N * N] = { 0.0 };
    int order[N];
    memcpy(a, matrix, (size_t)(n * n) * sizeof *a);
    for (int i = 0; i < n; i++)
        found[n * i + i] = 1.0;
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++)
                turn(n, a, found, p, q);
    for (int i = 0; i < n; i++) {
        int k = i;
        for (; k > 0 && a[(n + 1) * order[k - 1]] > a[(n + 1) * i]; k--)
            order[k] = order[k - 1];
        order[k] = i;
    }
    for (int i = 0; i < n; i++) {
        values[i] = a[(n + 1) * order[i]];
        memcpy(vectors + n * i, found + n * order[i], (size_t)n * sizeof *vectors);
    }
}
