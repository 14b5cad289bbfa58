/* SPDX-License-Identifier: BSD-3-Clause */
/* Stateless questions: batches of segments, one segment and one triangle. */
#include "fuzz/calls/rules.h"

enum { SEGMENTS = 8 };

static void hit_must_answer(const dpt_hit *hit, const struct subject *subject, int is_good, int pair_alone)
{
    if (!is_good) {
        hit_must_be_stale(hit);
        return;
    }
    HOLDS(hit->status == DPT_STATUS_EXACT && hit->body == 0 && hit->segment == 0, "status %u, body %x", hit->status,
          hit->body);
    HOLDS(hit->s >= 0.0 && hit->s <= 1.0 && hit->lower_bound <= hit->distance && hit->depth == fmax(0.0, -hit->gap),
          "s %g, distance %g, bound %g", hit->s, hit->distance, hit->lower_bound);
    HOLDS(fabs(apart(hit->p, hit->q) - hit->distance) <= hit->error_bound + 1e-9, "p and q are %g apart, and not %g",
          apart(hit->p, hit->q), hit->distance);
    HOLDS(!pair_alone || (hit->contact == DPT_CONTACT_UNKNOWN && hit->gap == 0.0 && !(hit->flags & DPT_HIT_FLAG_GAP)),
          "contact %u of the pair alone", hit->contact);
    HOLDS((hit->contact == DPT_CONTACT_UNKNOWN) == !(hit->flags & DPT_HIT_FLAG_GAP), "contact %u, flags %x",
          hit->contact, hit->flags);
    triangle_must_be_there(subject, hit->triangle);
}

/* A def, and what `n` segments may fail with because of it. */
static const void *draw_def(const dpt_query_def *good, uint32_t n, struct codes *codes)
{
    struct codes of_def = { .count = 0 };
    const void *def = draw_input(2, good, draw_size(sizeof *good, sizeof *good), sizeof *good, sizeof *good, &of_def);
    may_fail(&of_def, good->method > DPT_METHOD_BRUTE || good->pair > 1 || good->kernel > DPT_KERNEL_WASM128,
             DPT_E_ARGUMENT);
    may_fail(&of_def, good->kernel != DPT_KERNEL_AUTO, DPT_E_UNSUPPORTED);
    const int is_free = of_def.count == 1 && of_def.code[0] == DPT_E_UNSUPPORTED && good->kernel != DPT_KERNEL_AUTO &&
                        good->kernel <= DPT_KERNEL_WASM128;
    for (int i = 0; n && i < of_def.count; i++)
        may_fail(codes, 1, of_def.code[i]);
    codes->or_done = n && is_free && codes->count == 1;
    return def;
}

static void segments(void)
{
    const struct subject *subject = draw_subject();
    const dpt_pose pose = draw_pose(NULL);
    const uint32_t n = draw_one_in(40) ? 0 : 1 + draw_below(draw_one_in(6) ? SEGMENTS : 3);
    double ends[6 * SEGMENTS], radii[SEGMENTS];
    int is_good[SEGMENTS];
    struct codes codes = { .count = 0 }, one;
    const int no_mesh = draw_one_in(60), no_pose = draw_one_in(3), no_ends = draw_one_in(60);
    const int no_radii = draw_one_in(3), no_hits = draw_one_in(60), no_def = draw_one_in(3);
    for (uint32_t i = 0; i < n; i++) {
        const dpt_segment segment = draw_segment();
        dpt_segment asked = segment;
        memcpy(ends + 6 * i, segment.a, sizeof segment.a);
        memcpy(ends + 6 * i + 3, segment.b, sizeof segment.b);
        radii[i] = segment.radius;
        asked.radius = no_radii ? 0.0 : segment.radius;
        one = (struct codes){ .count = 0 };
        segment_codes(&asked, &one);
        is_good[i] = !one.count;
        may_fail(&codes, !is_good[i] && n, DPT_E_FINITE);
    }
    const dpt_query_def good = { .method = draw_one_in(30) ? draw_below(6) : draw_below(3),
                                 .kernel = draw_one_in(20) ? draw_below(9) : DPT_KERNEL_AUTO,
                                 .pair = draw_one_in(30) ? 2 : draw_below(2) };
    const uint32_t size = draw_size(sizeof(dpt_hit), sizeof(dpt_hit));
    const uint32_t room = size > 4096 || size < 8 ? 8 : size;
    const void *def = NULL;
    may_fail(&codes, no_mesh || (n && (no_ends || no_hits)), DPT_E_ARGUMENT);
    if (n && !no_hits)
        size_codes_of_output(size, sizeof(dpt_hit), 1, &codes);
    if (!no_def)
        def = draw_def(&good, n, &codes);
    if (!no_pose && n) {
        const int before = codes.count;
        pose_codes(&pose, &codes);
        codes.or_done &= codes.count == before;
    }
    unsigned char *out = output_of(0, (size_t)room * n);
    if (n)
        memcpy(out, &size, sizeof size);
    call_with("%llu segments, size %llu, method %llu", n, size, good.method, 0);
    const dpt_result result =
        RESULT(dpt_query_segments, no_mesh ? NULL : subject->mesh, no_pose ? NULL : &pose, no_ends ? NULL : ends,
               no_radii ? NULL : radii, n, no_hits ? NULL : (void *)out, def);
    expect(result, &codes);
    outputs_are_guarded(0, 1);
    if (!n || output_is_untouched(0, sizeof size)) {
        HOLDS(!n || result != DPT_OK, "nothing was told");
        return;
    }
    HOLDS(result == DPT_OK || result == DPT_E_FINITE, "%s, and something was written", dpt_result_name(result));
    game_digest(out, (size_t)size * n);
    for (uint32_t i = 0; i < n && size == sizeof(dpt_hit); i++) {
        const dpt_hit *hit = (const dpt_hit *)(const void *)(out + i * size);
        HOLDS(hit->size == size, "size %u of hit %u", hit->size, i);
        numbers_are_finite(&hit->distance, 12, "a hit");
        hit_must_answer(hit, subject, is_good[i], !no_def && good.pair);
    }
}

/* None is nearer than the distance, and one is as near, unless the segment goes through the triangle. */
static void pairs_must_hold(const double *segment, const double *triangle, int is_good, double distance, double extent)
{
    dpt_segment_pair pairs[DPT_SEGMENT_PAIRS_MAX];
    const int no_pairs = draw_one_in(40);
    const uint32_t count = CALL(dpt_segment_triangle_pairs, segment, triangle, no_pairs ? NULL : pairs);
    HOLDS(is_good && !no_pairs ? count >= 1 && count <= DPT_SEGMENT_PAIRS_MAX : !count, "%u pairs", count);
    const double slack = 64.0 * 0x1p-53 * extent + 1e-60;
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        numbers_are_finite(pairs[i].p, 3, "p");
        numbers_are_finite(pairs[i].q, 3, "q");
        HOLDS(pairs[i].s >= 0.0 && pairs[i].s <= 1.0 && pairs[i].distance >= distance - slack,
              "pair %u at %g, %g, and the distance is %g", i, pairs[i].s, pairs[i].distance, distance);
        least = fmin(least, pairs[i].distance);
    }
    HOLDS(!count || distance <= slack || fabs(least - distance) <= slack, "the least is %g, and the distance %g", least,
          distance);
    game_digest(&least, sizeof least);
}

/* Against a sampled minimum, which it must not be above, and its own points, which it must be. */
static void pair(void)
{
    double segment[6], triangle[9], s = 7.0, p[3], q[3];
    int is_good = 1;
    const double scale = draw_one_in(4) ? pow(10.0, draw_in(-30.0, 30.0)) : 1.0;
    for (int k = 0; k < 6; k++)
        segment[k] = scale * draw_in(-1.0, 1.0);
    for (int k = 0; k < 9; k++)
        triangle[k] = scale * draw_in(-1.0, 1.0);
    if (draw_one_in(6))
        memcpy(triangle + 3, triangle, 3 * sizeof *triangle);
    if (draw_one_in(6))
        memcpy(segment + 3, segment, 3 * sizeof *segment);
    if (draw_one_in(6))
        segment[draw_below(6)] = draw_odd_number();
    if (draw_one_in(6))
        triangle[draw_below(9)] = draw_odd_number();
    double extent = 0.0;
    for (int k = 0; k < 6; k++) {
        is_good &= fabs(segment[k]) <= 1e60;
        extent = fmax(extent, fabs(segment[k]));
    }
    for (int k = 0; k < 9; k++) {
        is_good &= fabs(triangle[k]) <= 1e60;
        extent = fmax(extent, fabs(triangle[k]));
    }
    const int no_segment = draw_one_in(40), no_triangle = draw_one_in(40);
    const int no_out = draw_one_in(4);
    is_good &= !no_segment && !no_triangle;
    const double distance = CALL(dpt_segment_triangle, no_segment ? NULL : segment, no_triangle ? NULL : triangle,
                                 no_out ? NULL : &s, no_out ? NULL : p, no_out ? NULL : q);
    HOLDS(is_good ? distance >= 0.0 && isfinite(distance) : distance == INFINITY, "distance %g", distance);
    game_digest(&distance, sizeof distance);
    pairs_must_hold(no_segment ? NULL : segment, no_triangle ? NULL : triangle, is_good, distance, extent);
    if (no_out)
        return;
    HOLDS(s >= 0.0 && s <= 1.0, "s %g", s);
    numbers_are_finite(p, 3, "p");
    numbers_are_finite(q, 3, "q");
    if (!is_good)
        return;
    const double slack = 64.0 * 0x1p-53 * extent + 1e-60;
    HOLDS(fabs(apart(p, q) - distance) <= slack || extent > 1e150, "p and q are %g apart, not %g", apart(p, q),
          distance);
    for (int i = 0; i < 4; i++) {
        const double t = draw_in(0.0, 1.0), v = draw_in(0.0, 1.0), w = draw_in(0.0, 1.0 - v);
        double x[3], y[3];
        for (int k = 0; k < 3; k++) {
            x[k] = segment[k] + t * (segment[3 + k] - segment[k]);
            y[k] = (1.0 - v - w) * triangle[k] + v * triangle[3 + k] + w * triangle[6 + k];
        }
        HOLDS(distance <= apart(x, y) + slack, "%g, and two points are %g apart", distance, apart(x, y));
    }
}

static const struct move moves[] = { { "segments", segments, 12 }, { "pair", pair, 6 }, { NULL, NULL, 0 } };

const struct noun query_noun = { "query", NULL, NULL, moves };
