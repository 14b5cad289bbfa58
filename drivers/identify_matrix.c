/* SPDX-License-Identifier: BSD-3-Clause */
#include "identify_matrix.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"

/* A pivot below this fraction of its column is rounding. */
static const double PIVOT_MIN = 1e-12;

enum { N = IDENTIFY_UNKNOWNS_MAX };

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
static void turn(double *a, double *vectors, int p, int q)
{
    const double off = a[3 * p + q];
    if (off == 0.0)
        return;
    const double ratio = (a[3 * q + q] - a[3 * p + p]) / (2.0 * off);
    const double tangent = (ratio < 0.0 ? -1.0 : 1.0) / (fabs(ratio) + sqrt(ratio * ratio + 1.0));
    const double cosine = 1.0 / sqrt(tangent * tangent + 1.0), sine = tangent * cosine;
    for (int k = 0; k < 3; k++) {
        const double x = a[3 * k + p], y = a[3 * k + q];
        a[3 * k + p] = cosine * x - sine * y;
        a[3 * k + q] = sine * x + cosine * y;
    }
    for (int k = 0; k < 3; k++) {
        const double x = a[3 * p + k], y = a[3 * q + k];
        a[3 * p + k] = cosine * x - sine * y;
        a[3 * q + k] = sine * x + cosine * y;
        const double u = vectors[3 * p + k], v = vectors[3 * q + k];
        vectors[3 * p + k] = cosine * u - sine * v;
        vectors[3 * q + k] = sine * u + cosine * v;
    }
}

void identify_eigen(const double *matrix, double *values, double *vectors)
{
    double a[9], found[9] = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
    int order[3] = { 0, 1, 2 };
    memcpy(a, matrix, sizeof a);
    for (int sweep = 0; sweep < 20; sweep++) {
        turn(a, found, 0, 1);
        turn(a, found, 0, 2);
        turn(a, found, 1, 2);
    }
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            if (a[4 * order[j]] > a[4 * order[j + 1]]) {
                const int swapped = order[j];
                order[j] = order[j + 1];
                order[j + 1] = swapped;
            }
    for (int i = 0; i < 3; i++) {
        values[i] = a[4 * order[i]];
        memcpy(vectors + 3 * i, found + 3 * order[i], 3 * sizeof *vectors);
    }
}
