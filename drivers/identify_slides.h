/* SPDX-License-Identifier: BSD-3-Clause */
/* What a record of pushes shows: the sensor's step, and slides for the fit. */
#ifndef DPT_DRIVERS_IDENTIFY_SLIDES_H
#define DPT_DRIVERS_IDENTIFY_SLIDES_H

#include "identify_fit.h"
#include "identify_record.h"

/* The smallest change of position, or of angle, that the samples show; 0 if they show none. */
double identify_step(const struct identify_sample *samples, uint32_t count);

/*
 * Slides: the parts of a record in which a device moves one way, and their sums for a linear fit.
 *
 * In a slide the motion y obeys M y'' = f - B y' - F sign + G - K y, with f the motor's force. Integrated twice this is
 * linear in the unknowns and needs no derivative of a measured position:
 *     y = y0 + v0 t + W U - C I - p sign t^2/2 + h t^2/2 - k S
 * with W = M^-1, C = W B, p = W F, h = W G, k = W K, U the double integral of the motor's force, I the integral of y
 * and S its double integral. The error of y is the sensor's; U is known exactly.
 */

/* The terms of the equation that slides share: U, I of each coordinate, sign t^2/2, t^2/2, S and y of each. */
enum { TERM_U, TERM_I, TERM_FRICTION = TERM_I + 3, TERM_CONSTANT, TERM_S, TERM_Y = TERM_S + 3, TERMS = TERM_Y + 3 };

/*
 * The unknowns of one coordinate: W, p and h of each pushed axis, C, k. A constant force is one of a pushed axis, for
 * friction may hold the other coordinates against it.
 */
enum { UNKNOWN_W, UNKNOWN_P = 3, UNKNOWN_H = 6, UNKNOWN_C = 9, UNKNOWN_K = 12 };
enum { UNKNOWNS = IDENTIFY_UNKNOWNS_MAX };

/* Sums of products of the terms of each axis and block, for i >= j, with y0 and v0 of each slide eliminated. */
struct identify_sums {
    double of[3][IDENTIFY_BLOCKS_MAX][TERMS][TERMS];
};

/* What is assumed while slides are summed. */
struct identify_view {
    const struct identify_record *record;
    const struct identify_fit_def *def;
    double delay, lag; /* s; of a command until it acts, and of the motor */
    /*
     * The unknowns of each coordinate as known so far; NULL: not at all. I and S are then those of the motion that
     * these predict. The measured motion's have errors of the sensor, which weigh in short slides.
     */
    double (*known)[UNKNOWNS];
    double (*predicted)[3]; /* room for as many samples as a block has */
};

void identify_slides_sum(const struct identify_view *view, struct identify_sums *sums);

#endif
