/* SPDX-License-Identifier: BSD-3-Clause */
/* Random motions in which a tool meets a body at a time that is known, followed to the end and sometimes back. */
#ifndef DPT_TESTS_SHEET_FLIGHT_H
#define DPT_TESTS_SHEET_FLIGHT_H

#include "track/sheet_ride.h"

/*
 * A flight: a tool and a body, each at an even pace, that meet at the time `meeting`: the point `share` of the axis and
 * the target on the mesh.
 */
struct flight {
    int free;
    double end[2][3], rate[2][3]; /* of a free tool at the meeting, in the world; else in its frame, at rest */
    dpt_pose tool, body;          /* at the meeting */
    double tool_pace[3], body_pace[3], tool_axis[3], body_axis[3], tool_turn, body_turn;
    double radius, meeting;
};

struct state flight_at(const struct flight *flight, double time);

/* A point of the mesh: in a face, on an edge, a vertex; or beside. Returns 1 where it is on the mesh. */
int any_target(const struct sheet *sheet, double target[3], double normal[3]);

/* Direction of the tool: across the sheet, nearly in it, along its own motion, sideways, any. */
void any_direction(double u[3], const double normal[3], const double way[3]);

/* Returns 1 where a crossing at the meeting is certain, if the tool gets so far. */
int any_flight(const struct sheet *sheet, struct flight *f);

/* One flight to its end, on, and sometimes back; returns 1 if the tool began free. */
int fly(struct scene *scene, struct sums *sums);

/* Flights until so many crossings were certain, with their sums printed. */
void fly_through(struct sheet *sheet, unsigned long crossings);

#endif
