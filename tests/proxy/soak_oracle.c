/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/soak_oracle.h"

enum { CHUNK = 256 };

int soak_oracle_open(struct soak_oracle *oracle, const struct solid *solid)
{
    const uint32_t count = solid->place.triangles, room = (count + CHUNK - 1) / CHUNK * CHUNK;
    *oracle = (struct soak_oracle){ .solid = solid, .count = count, .room = room };
    oracle->is_closed = solid->info.open_edges == 0 && solid->info.nonmanifold_edges == 0;
    oracle->balls = calloc(4 * (size_t)room + 1, sizeof *oracle->balls);
    oracle->near = malloc(((size_t)room + 1) * sizeof *oracle->near);
    CHECK(oracle->balls && oracle->near, "no memory");
    if (!oracle->balls || !oracle->near)
        return 0;
    for (uint32_t i = 0; i < count; i++) {
        const float *c = solid->corners + 9 * (size_t)i;
        double centre[3], radius = 0;
        for (int k = 0; k < 3; k++) {
            centre[k] = ((double)c[k] + (double)c[3 + k] + (double)c[6 + k]) / 3;
            oracle->balls[(size_t)k * room + i] = centre[k];
        }
        for (int corner = 0; corner < 3; corner++) {
            const double x[3] = { (double)c[3 * corner], (double)c[3 * corner + 1], (double)c[3 * corner + 2] };
            radius = fmax(radius, apart(x, centre));
        }
        oracle->balls[3 * (size_t)room + i] = radius;
    }
    return 1;
}

void soak_oracle_close(struct soak_oracle *oracle)
{
    free(oracle->balls);
    free(oracle->near);
}

/* How far the squared distances of some balls' middles are beyond what they would be if the balls were in reach. */
static void beyond_reach(const struct soak_oracle *oracle, uint32_t first, const double ends[6], double limit,
                         double *beyond)
{
    const double *x = oracle->balls + first, *y = x + oracle->room, *z = y + oracle->room;
    const double *r = z + oracle->room;
    const double u[3] = { ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2] };
    const double square = dot3(u, u), per_square = square > 0 ? 1 / square : 0;
    const double ax = ends[0], ay = ends[1], az = ends[2], ux = u[0], uy = u[1], uz = u[2];
    for (uint32_t i = 0; i < CHUNK; i++) {
        double dx = x[i] - ax, dy = y[i] - ay, dz = z[i] - az;
        double s = (dx * ux + dy * uy + dz * uz) * per_square;
        s = s < 0 ? 0 : s;
        s = s > 1 ? 1 : s;
        dx -= s * ux;
        dy -= s * uy;
        dz -= s * uz;
        const double reach = limit + r[i];
        beyond[i] = dx * dx + dy * dy + dz * dz - reach * reach;
    }
}

/* The triangles whose balls are within `limit`, and some more. */
static uint32_t list_near(struct soak_oracle *oracle, const double ends[6], double limit)
{
    const double margin = limit + 1e-9 * oracle->solid->oracle.extent;
    double beyond[CHUNK];
    uint32_t found = 0;
    for (uint32_t first = 0; first < oracle->count; first += CHUNK) {
        beyond_reach(oracle, first, ends, margin, beyond);
        for (uint32_t i = 0; i < CHUNK && first + i < oracle->count; i++) {
            oracle->near[found] = first + i;
            found += beyond[i] <= 0;
        }
    }
    return found;
}

double soak_distance(struct soak_oracle *oracle, const double ends[6], double limit)
{
    const uint32_t count = list_near(oracle, ends, limit);
    double least = limit;
    for (uint32_t i = 0; i < count; i++)
        least = fmin(least, oracle_brute_triangle(oracle->solid->brute, oracle->near[i], ends));
    return least;
}

/* Six times the volume of a tetrahedron. */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3])
{
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = d[k] - a[k];
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

static int goes_through(const float *corners, const double ends[6])
{
    double c[3][3];
    for (int k = 0; k < 9; k++)
        c[k / 3][k % 3] = (double)corners[k];
    if ((volume(c[0], c[1], c[2], ends) > 0) == (volume(c[0], c[1], c[2], ends + 3) > 0))
        return 0;
    const int side = volume(ends, ends + 3, c[0], c[1]) > 0;
    return (volume(ends, ends + 3, c[1], c[2]) > 0) == side && (volume(ends, ends + 3, c[2], c[0]) > 0) == side;
}

uint32_t soak_crossings(struct soak_oracle *oracle, const double ends[6])
{
    const uint32_t count = list_near(oracle, ends, 0);
    uint32_t crossed = 0;
    for (uint32_t i = 0; i < count; i++)
        crossed += (uint32_t)goes_through(oracle->solid->corners + 9 * (size_t)oracle->near[i], ends);
    return crossed;
}

int soak_is_inside(struct soak_oracle *oracle, const double x[3], uint64_t *seed)
{
    const struct motion_place *place = &oracle->solid->place;
    uint32_t odd = 0;
    double far = 2 * oracle->solid->diagonal;
    for (int k = 0; k < 3; k++)
        far += fabs(x[k] - place->low[k]);
    for (int ray = 0; ray < 3; ray++) {
        double way[3], ends[6];
        random_unit(seed, way);
        for (int k = 0; k < 3; k++) {
            ends[k] = x[k];
            ends[3 + k] = x[k] + far * way[k];
        }
        odd += soak_crossings(oracle, ends) & 1u;
    }
    return odd > 1;
}
