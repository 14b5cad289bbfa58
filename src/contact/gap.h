/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a nearest pair to contact: on which side the tool is, its gap, and where a force would push it.
 * docs/algorithms/sign.md.
 */
#ifndef DPT_GAP_H
#define DPT_GAP_H

#include "contact/distance_profile.h"

/* Where and how a force would push the tool. */
struct push {
    vec3 direction; /* unit, the way out; zero where it is not known */
    vec3 at;        /* the point of the axis */
    double depth;   /* how far, >= 0 */
};

/* What a profile tells of one body. */
enum {
    CONTACT_NONE,    /* the axis is outside and nothing is within the profile's reach */
    CONTACT_PROFILE, /* its least height is the profile's deepest sample */
    CONTACT_UNKNOWN /* it goes through an open sheet of which no side is kept, or more often than can be told */
};

/* The gap of a capsule of this radius, in *gap; the rest as profile_make. */
int contact_find(struct profile *profile, const struct nearest *nearest, const struct seed *seeds,
                 uint32_t seed_count, double radius, double *gap);

/* The way out at a sample, in the body's frame; `smooth` as dpt_world_def has it. */
vec3 contact_normal(const struct profile *profile, const struct sample *sample, uint32_t smooth);

/* The push at the profile's deepest sample, in the world. */
struct push contact_push(const struct profile *profile, const struct frame *body, double gap,
                         uint32_t smooth);

/* Contact, gap and depth of one axis and one body without a past, for a hit that track_hit has written. */
void contact_of(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                const struct nearest *nearest, double radius, dpt_hit *hit);

/* Of a gap that is known within `error`. */
uint32_t contact_of_gap(double gap, double error);

/*
 * The paper's signed gap of one part of a segment and its push in the world (docs/algorithms/paper.md): the sign is
 * that of the triangle's own plane; a part that crosses is as deep as its lower end is under it.
 */
double contact_paper(const struct surface *surface, const struct frame *body,
                     const struct axis *part, const struct nearest *nearest, double radius,
                     struct push *push);

/* Fill contact, flags, gap and depth for a gap that is known. */
void contact_set_gap(dpt_hit *hit, double gap, double error);

#endif
