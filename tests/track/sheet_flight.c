/* SPDX-License-Identifier: BSD-3-Clause */
#include "track/sheet_flight.h"

static dpt_pose pose_moved(const dpt_pose *pose, const double pace[3], const double axis[3], double turn, double t)
{
    dpt_pose moved, by;
    add_scaled(moved.position, pose->position, t, pace);
    pose_orient(&by, axis, turn * t);
    turn_times(by.orientation, pose->orientation, moved.orientation);
    return moved;
}

struct state flight_at(const struct flight *flight, double time)
{
    double t = time - flight->meeting;
    struct state at = { .free = flight->free, .radius = flight->radius };
    at.tool = pose_moved(&flight->tool, flight->tool_pace, flight->tool_axis, flight->tool_turn, t);
    at.body = pose_moved(&flight->body, flight->body_pace, flight->body_axis, flight->body_turn, t);
    for (int e = 0; e < 2; e++)
        add_scaled(at.end[e], flight->end[e], flight->free ? t : 0.0, flight->rate[e]);
    return at;
}

/* The velocity of a frame's origin with which the point x, off it by `arm`, goes at `pace`. */
static void pace_of_origin(double out[3], const double pace[3], const double axis[3], double turn, const double arm[3])
{
    double around[3];
    cross3(axis, arm, around);
    add_scaled(out, pace, -turn, around);
}

static double any_turn(double length)
{
    if (one_in(8))
        return random_in(&sheet_random, -3.0, 3.0);
    return one_in(2) ? 0.0 : random_in(&sheet_random, -1.0, 1.0) * 0.02 / fmax(length, 0.02);
}

int any_target(const struct sheet *sheet, double target[3], double normal[3])
{
    const double *c = sheet->corners + 9 * (size_t)(random_bits(&sheet_random) % sheet->count);
    double u = random_in(&sheet_random, 0.0, 1.0), v = random_in(&sheet_random, 0.0, 1.0 - u), off[3];
    int where = (int)(random_bits(&sheet_random) % 8);
    if (where == 0)
        u = v = 0.0;
    else if (where == 1)
        v = 0.0;
    for (int k = 0; k < 3; k++)
        target[k] = where == 0 ? c[k] : (1.0 - u - v) * c[k] + u * c[3 + k] + v * c[6 + k];
    normal_of(c, normal);
    if (where != 2)
        return 1;
    any_unit(off); /* beside, and over the border where that is near */
    if (sheet->borders) {
        const double *edge = sheet->border + 9 * (size_t)(random_bits(&sheet_random) % sheet->borders);
        for (int k = 0; k < 3; k++)
            target[k] = edge[k] + u * (edge[3 + k] - edge[k]);
        add_scaled(target, target, power_in(-5.0, -1.0) * sheet->unit, off);
    }
    return sheet->borders == 0;
}

void any_direction(double u[3], const double normal[3], const double way[3])
{
    double across[3];
    any_across(across, normal);
    switch (random_bits(&sheet_random) % 5) {
    case 0:
        memcpy(u, normal, 3 * sizeof *u);
        break;
    case 1:
        add_scaled(u, across, random_in(&sheet_random, -1.0, 1.0) * power_in(-7.0, -1.0), normal);
        break;
    case 2:
        memcpy(u, way, 3 * sizeof *u);
        break;
    case 3:
        cross3(normal, way, u);
        break;
    default:
        any_unit(u);
    }
    unit_or_z(u);
}

/*
 * A body at any pose that moves and turns so that its target goes at -way; then u, way and the target are the world's.
 */
static void move_body(const struct sheet *sheet, struct flight *f, const double target[3], double world[3], double u[3],
                      double way[3])
{
    double arm[3];
    double axis[3], rest[3] = { 0.0, 0.0, 0.0 };
    any_unit(axis);
    any_unit(f->body_axis);
    any_unit(f->body.position);
    pose_orient(&f->body, axis, random_in(&sheet_random, -3.0, 3.0));
    for (int k = 0; k < 3; k++) {
        f->body.position[k] *= 0.3 * sheet->unit;
        rest[k] = -way[k];
    }
    turn3(f->body.orientation, target, arm);
    turn3(f->body.orientation, rest, rest);
    f->body_turn = any_turn(length3(arm) / sheet->unit);
    pace_of_origin(f->body_pace, rest, f->body_axis, f->body_turn, arm);
    pose_point(&f->body, target, world);
    turn3(f->body.orientation, u, u);
    turn3(f->body.orientation, way, way);
}

/* A rigid tool at any pose whose axis along u has the point `share` at the target, at the meeting. */
static void place_rigid_tool(const struct sheet *sheet, struct flight *f, const double world[3], double u[3],
                             const double way[3], double share, double length, int moves)
{
    double arm[3];
    double axis[3], spot[3];
    any_unit(axis);
    any_unit(f->tool_axis);
    any_unit(arm);
    pose_orient(&f->tool, axis, random_in(&sheet_random, -3.0, 3.0));
    double reach = one_in(2) ? 0.0 : 0.1 * sheet->unit;
    turn_back3(f->tool.orientation, u, u);
    for (int k = 0; k < 3; k++)
        spot[k] = reach * arm[k] + (one_in(2) ? 0.0 : share * length * u[k]);
    for (int e = 0; e < 2; e++)
        add_scaled(f->end[e], spot, (e - share) * length, u);
    turn3(f->tool.orientation, spot, arm);
    add_scaled(f->tool.position, world, -1.0, arm);
    f->tool_turn = moves ? any_turn(length / sheet->unit) : 0.0;
    pace_of_origin(f->tool_pace, way, f->tool_axis, f->tool_turn, arm);
}

int any_flight(const struct sheet *sheet, struct flight *f)
{
    double target[3], normal[3], way[3], u[3], world[3], share = one_in(2) ? one_in(2) : 0.5;
    int on = any_target(sheet, target, normal);
    memset(f, 0, sizeof *f);
    f->meeting = (double)(random_bits(&sheet_random) % 3) + random_in(&sheet_random, 0.001, 0.999);
    f->tool.orientation[0] = f->body.orientation[0] = 1.0;
    any_unit(way);
    if (one_in(3)) { /* almost in the sheet */
        double rise = dot3(way, normal);
        add_scaled(way, way, -rise * (1.0 - power_in(-4.0, 0.0)), normal);
        unit_or_z(way);
    } else if (one_in(3)) {
        memcpy(way, normal, sizeof way);
    }
    any_direction(u, normal, way);
    double pace = 0.02 * power_in(-3.3, 0.0) * sheet->unit, ahead = one_in(2) ? -1.0 : 1.0;
    double length = one_in(8) ? 0.0 : power_in(-3.0, -0.30103) * sheet->unit;
    for (int k = 0; k < 3; k++)
        way[k] *= pace * ahead;
    if (one_in(3))
        share = random_in(&sheet_random, 0.0, 1.0);
    else if (share != 0.5) /* the rest of it stays behind */
        share = dot3(u, normal) * dot3(way, normal) > 0.0 ? 1.0 : 0.0;
    f->radius = one_in(2) ? 0.0 : power_in(-4.0, -2.0) * sheet->unit;
    int mode = (int)(random_bits(&sheet_random) % 6); /* who moves: free, free, rigid, body, both, both */
    f->free = mode < 2 || (mode >= 3 && one_in(2));
    int body_moves = mode >= 3, tool_moves = mode != 3;
    memcpy(world, target, sizeof world);
    if (body_moves)
        move_body(sheet, f, target, world, u, way);
    if (!tool_moves || mode >= 4)
        for (int k = 0; k < 3; k++)
            way[k] *= tool_moves ? random_in(&sheet_random, -0.5, 1.0) : 0.0;
    if (f->free) {
        double bend[3];
        any_unit(bend);
        double by = tool_moves && one_in(2) ? 0.02 * sheet->unit * power_in(-3.0, 0.0) : 0.0;
        for (int e = 0; e < 2; e++) {
            add_scaled(f->end[e], world, (e - share) * length, u);
            add_scaled(f->rate[e], way, (e - share) * by, bend);
        }
        return on;
    }
    place_rigid_tool(sheet, f, world, u, way, share, length, tool_moves);
    return on;
}

int fly(struct scene *scene, struct sums *sums)
{
    struct flight flight;
    struct ride ride = { .scene = scene, .sums = sums };
    int on = any_flight(scene->sheet, &flight), at = 0;
    struct state now = flight_at(&flight, 0.0);
    struct ends3 ends = ends_between(&now, &now, 0.0);
    struct close close = closest_of_all(scene->sheet, &ends);
    if (close.distance <= now.radius + 1e-9 * scene->sheet->diagonal && !one_in(20))
        return 0;
    int began = close.distance > 0.0;
    uint32_t contact = ride_tick(&ride, &now, 1, -1.0);
    int last = (int)flight.meeting + 1 + (int)(random_bits(&sheet_random) % 5), back = one_in(2);
    while (at < last) {
        now = flight_at(&flight, ++at);
        int here = on && at == (int)flight.meeting + 1 && ride.previous_distance > 0.0;
        contact = ride_tick(&ride, &now, 0, here ? flight.meeting - (at - 1) : -1.0);
    }
    if (one_in(8)) { /* all is forgotten */
        ride_tick(&ride, &now, 1, -1.0);
        if (ride.previous_distance == 0.0 && at) { /* and not known until it was free */
            now = flight_at(&flight, --at);
            contact = ride_tick(&ride, &now, 0, -1.0);
            ends = ends_between(&now, &now, 0.0);
            close = closest_of_all(scene->sheet, &ends);
            CHECK(ride.reported_distance > 0.0 || contact == DPT_CONTACT_UNKNOWN || !scene->sheet->info.open_edges ||
                      !goes_through(scene->sheet, &ends, close.s),
                  "%s: contact %u", scene->sheet->name, contact);
        }
    }
    while (back && at > 0) {
        now = flight_at(&flight, --at);
        ride_tick(&ride, &now, 0, -1.0);
    }
    return began;
}

static void print_sums(const struct sheet *sheet, const struct sums *s)
{
    printf("    %-22s %7lu ticks: swept %lu, met %lu (planned %lu), clear %lu, near %lu, undecided %lu\n"
           "      gap: did not cross %lu, behind %lu, back %lu, side lost %lu, not judged %lu, unknown %lu; "
           "worst touch %.3f, gap %.3f of the tolerance, %.1e late\n",
           sheet->name, s->ticks, s->swept, s->met, s->planned, s->clear, s->near, s->undecided, s->clean, s->behind,
           s->turned_back, s->lost, s->doubtful, s->unknown, s->worst_off, s->worst_gap, s->worst_late);
}

void fly_through(struct sheet *sheet, unsigned long crossings)
{
    struct sums sums = { .worst_off = -HUGE_VAL, .worst_late = -HUGE_VAL };
    unsigned long tries = 0;
    struct scene scene = { NULL };
    while (sums.planned < crossings && tries < 20 * crossings + 1000) {
        if (tries++ % 1000 == 0) {
            rig_close(&scene.rig);
            if (!scene_begin(&scene, sheet, 0, NULL))
                break;
        }
        fly(&scene, &sums);
    }
    rig_close(&scene.rig);
    print_sums(sheet, &sums);
    CHECK(sums.planned >= crossings, "%s: %lu crossings", sheet->name, sums.planned);
}
