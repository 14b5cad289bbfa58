/* SPDX-License-Identifier: BSD-3-Clause */
/* Routes over a mesh, and the oracle's for the same pairs of triangles. */
#ifndef DPT_TESTS_ROUTE_WALK_H
#define DPT_TESTS_ROUTE_WALK_H

#include "dynpoint/baseline.h"
#include "lib/strip_subject.h"
#include "oracle/route.h"

/* A strip, and the oracle's room, for routes over a mesh. */
struct walk {
    const struct subject *subject;
    struct held_strip held;
    dpt_strip *strip;
    uint32_t *tau, *route, *back;
};

static inline void walk_open(struct walk *walk, const struct subject *subject)
{
    const uint32_t count = subject->info.source_triangles;
    walk->subject = subject;
    walk->strip =
        hold_strip(&walk->held, count < 1u << 20 ? count : 1u << 20, subject->info.vertices);
    walk->tau = malloc(count * sizeof *walk->tau);
    walk->route = malloc(count * sizeof *walk->route);
    walk->back = malloc(count * sizeof *walk->back);
}

static inline void walk_close(struct walk *walk)
{
    drop_strip(&walk->held);
    free(walk->tau);
    free(walk->route);
    free(walk->back);
}

static inline int is_there(const struct subject *subject, uint32_t triangle)
{
    return subject->surface.corner[triangle][0] != ORACLE_NONE;
}

/* The code that is due for a pair, with tau towards `to`. */
static inline dpt_result due(const struct walk *walk, uint32_t from, uint32_t to)
{
    if (!is_there(walk->subject, from) || !is_there(walk->subject, to))
        return DPT_E_DROPPED;
    return walk->tau[from] == ORACLE_NONE ? DPT_E_UNREACHABLE : DPT_OK;
}

/* A strip holds just these, in this order. */
static inline int holds(const dpt_strip *strip, const uint32_t *route, uint32_t length)
{
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    return count == length && flags == 0 &&
           (!length || memcmp(triangles, route, length * sizeof *route) == 0);
}

static inline const char *text_of(const dpt_strip *strip)
{
    static char text[256];
    uint32_t count = 0, flags = 0;
    const uint32_t *triangles = dpt_strip_get_triangles(strip, &count, &flags);
    int length = snprintf(text, sizeof text, "flags %u, %u triangles:", flags, count);
    for (uint32_t i = 0; i < count && length < 240; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, " %u", triangles[i]);
    return text;
}

/* An answer of the library for a pair whose tau is in the walk; by whichever call. */
static inline void check_answer(const struct walk *walk, uint32_t from, uint32_t to,
                                dpt_result result, const char *by)
{
    const dpt_result wanted = due(walk, from, to);
    const uint32_t length = oracle_route(&walk->subject->surface, walk->tau, from, walk->route);
    CHECK(result == wanted, "%s, %s, %u to %u: %s, not %s", walk->subject->name, by, from, to,
          dpt_result_name(result), dpt_result_name(wanted));
    if (result == wanted)
        CHECK(holds(walk->strip, walk->route, result == DPT_OK ? length : 0),
              "%s, %s, %u to %u: %s; not %u: %u %u %u ...", walk->subject->name, by, from, to,
              text_of(walk->strip), length, walk->route[0], length > 1 ? walk->route[1] : 0,
              length > 2 ? walk->route[2] : 0);
}

static inline uint32_t length_of(const struct walk *walk, uint32_t from, uint32_t to)
{
    uint32_t count = 0;
    const dpt_result result = dpt_strip_route(walk->strip, walk->subject->mesh, from, to);
    dpt_strip_get_triangles(walk->strip, &count, NULL);
    return result == DPT_OK ? count : 0;
}

/* A triangle a few steps away. */
static inline uint32_t stray(const struct oracle_surface *surface, uint32_t from, uint64_t *seed)
{
    for (uint64_t steps = random_bits(seed) % 8;
         steps > 0 && surface->corner[from][0] != ORACLE_NONE; steps--) {
        const uint32_t v = surface->corner[from][random_bits(seed) % 3];
        from = surface->fan[surface->first[v] +
                            random_bits(seed) % (surface->first[v + 1] - surface->first[v])];
    }
    return from;
}

/*
 * A fan about one vertex, and a straight strip of `tail` squares at two opposite edges of its rim: every way from one
 * to the other leads through the fan.
 */
static inline int subject_with_hub(struct subject *subject, uint32_t fan, uint32_t tail)
{
    const uint32_t points = 1 + fan + 4 * tail, triangles = fan + 4 * tail;
    double *vertices = calloc(3 * (size_t)points, sizeof *vertices);
    uint32_t *corners = malloc(3 * (size_t)triangles * sizeof *corners), *c = corners;
    for (uint32_t i = 0; i < fan; i++) {
        vertices[3 * (i + 1)] = 0.1 * cos(6.283185307179586 * i / fan);
        vertices[3 * (i + 1) + 1] = 0.1 * sin(6.283185307179586 * i / fan);
        const uint32_t triangle[3] = { 0, 1 + i, 1 + (i + 1) % fan };
        memcpy(c, triangle, sizeof triangle);
        c += 3;
    }
    for (uint32_t side = 0; side < 2; side++) {
        const uint32_t first = 1 + fan + 2 * tail * side;
        uint32_t a = 1 + side * (fan / 2), b = a + 1;
        for (uint32_t i = 0; i < tail; i++) {
            for (uint32_t k = 0; k < 2; k++) {
                double *v = vertices + 3 * (first + 2 * i + k);
                v[0] = (side ? -1 : 1) * (0.11 + 0.01 * i);
                v[1] = 0.01 * k;
            }
            const uint32_t square[6] = { a, b, first + 2 * i, b, first + 2 * i, first + 2 * i + 1 };
            memcpy(c, square, sizeof square);
            c += 6;
            a = first + 2 * i;
            b = a + 1;
        }
    }
    const int opened =
        subject_from_arrays(subject, "hub with tails", vertices, points, corners, triangles);
    free(vertices);
    free(corners);
    return opened;
}

#endif
