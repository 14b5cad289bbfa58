/* SPDX-License-Identifier: BSD-3-Clause */
#include "track.h"

void axis_of(const struct tree *tree, const struct frame *body, vec3 a, vec3 b, struct axis *axis)
{
    axis->a = a;
    axis->b = b;
    axis->local_a = frame_to_local(body, a);
    vec3 local_b = frame_to_local(body, b);
    axis->u = sub(local_b, axis->local_a);
    double reach = larger(larger(extent_of(a), extent_of(b)), extent_of(body->origin));
    reach = larger(reach, larger(extent_of(axis->local_a), extent_of(local_b)));
    axis->error = TREE_ERROR * larger(reach, tree_extent(tree));
}

static void search(const struct tree *tree, const struct kernel *kernel, uint32_t method,
                   const struct axis *axis, struct nearest *nearest)
{
    if (method == DPT_METHOD_BRUTE)
        tree_brute(tree, axis->local_a, axis->u, nearest);
    else
        tree_search(tree, kernel, axis->local_a, axis->u, nearest);
}

void track_once(const struct tree *tree, const struct kernel *kernel, uint32_t method,
                const struct axis *axis, uint32_t hint, struct nearest *nearest)
{
    *nearest = (struct nearest){ .pair = { .distance2 = HUGE_VAL }, .triangle = DPT_NONE };
    if (hint != DPT_NONE && method != DPT_METHOD_BRUTE)
        nearest->pair.distance2 = tree_pair(tree, hint, axis->local_a, axis->u).distance2;
    search(tree, kernel, method, axis, nearest);
}

void track_next(const struct tree *tree, const struct kernel *kernel, uint32_t method,
                const struct axis *axis, uint32_t last, double limit2, struct nearest *nearest)
{
    *nearest = (struct nearest){ .pair = { .distance2 = limit2 }, .triangle = DPT_NONE };
    if (last == DPT_NONE || method == DPT_METHOD_BRUTE) {
        search(tree, kernel, method, axis, nearest);
        return;
    }
    pair old = tree_pair(tree, last, axis->local_a, axis->u);
    if (old.distance2 < limit2) {
        nearest->pair = old;
        nearest->triangle = last;
    }
    if (old.distance2 > 0.0)
        search(tree, kernel, method, axis, nearest);
    if (sqrt(old.distance2) <= sqrt(nearest->pair.distance2) + 0.5 * axis->error &&
        old.distance2 < limit2) {
        nearest->pair = old;
        nearest->triangle = last;
    }
}

void track_hit(const struct tree *tree, const struct axis *axis, const struct frame *body,
               const struct nearest *nearest, dpt_hit *hit)
{
    const pair *found = &nearest->pair;
    vec3 p = along(axis->a, found->s, sub(axis->b, axis->a));
    vec3 q = sub(p, frame_turn(body, found->gap));
    hit->status = DPT_STATUS_EXACT;
    hit->flags = found->distance2 == 0.0 ? DPT_HIT_CROSSING : 0;
    hit->triangle = tree->sources[nearest->triangle];
    hit->work = nearest->work;
    hit->distance = sqrt(found->distance2);
    hit->s = found->s;
    vec3_store(p, hit->p);
    vec3_store(q, hit->q);
    hit->error_bound = axis->error;
    hit->lower_bound = larger(0.0, hit->distance - axis->error);
}
