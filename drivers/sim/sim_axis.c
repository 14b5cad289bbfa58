/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/sim_axis.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "settings.h"
#include "text/near_word.h"

enum { POSITION, VELOCITY, CONSTANT, DECAYING, COLUMNS };

/* How finely a moment is located, as a share of the time it lies in. */
static const double RESOLUTION = 0x1p-50;

/*
 * A Taylor series over a fraction of the time, squared as often as it was halved. Time is counted in units of `time`
 * and force in m per unit^2.
 */
struct sim_transition sim_axis_transition(const struct sim_axis *axis, double time)
{
    const double k = axis->spring * time * time / axis->mass, c = axis->damping * time / axis->mass;
    const double decay = axis->lag > 0.0 ? time / axis->lag : 0.0;
    double sum[2][COLUMNS] = { { 1.0, 0.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0, 0.0 } };
    double term[2][COLUMNS] = { { 1.0, 0.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0, 0.0 } };
    double force[COLUMNS] = { 0.0, 0.0, 1.0, 1.0 }, part = 1.0, left = 1.0;
    int halvings = 0;
    for (double norm = 1.0 + k + c + decay; norm * part > 0.25; part *= 0.5)
        halvings++;
    for (int i = 1; i <= 14; i++) {
        const double scale = part / i;
        for (int column = 0; column < COLUMNS; column++) {
            double x = term[0][column], v = term[1][column];
            term[0][column] = v * scale;
            term[1][column] = (force[column] - k * x - c * v) * scale;
            sum[0][column] += term[0][column];
            sum[1][column] += term[1][column];
        }
        force[CONSTANT] = 0.0;
        force[DECAYING] *= -decay * scale;
        left += force[DECAYING];
    }
    for (; halvings > 0; halvings--) {
        double unsquared[2][COLUMNS];
        memcpy(unsquared, sum, sizeof unsquared);
        for (int row = 0; row < 2; row++) {
            for (int column = 0; column < COLUMNS; column++)
                sum[row][column] =
                    unsquared[row][POSITION] * unsquared[0][column] + unsquared[row][VELOCITY] * unsquared[1][column];
            sum[row][CONSTANT] += unsquared[row][CONSTANT];
            sum[row][DECAYING] += unsquared[row][DECAYING] * left;
        }
        left *= left;
    }
    const double push = time * time / axis->mass;
    return (struct sim_transition){ .time = time,
                                    .xx = sum[0][POSITION],
                                    .xv = sum[0][VELOCITY] * time,
                                    .xf = sum[0][CONSTANT] * push,
                                    .xd = sum[0][DECAYING] * push,
                                    .vx = sum[1][POSITION] / time,
                                    .vv = sum[1][VELOCITY],
                                    .vf = sum[1][CONSTANT] * push / time,
                                    .vd = sum[1][DECAYING] * push / time,
                                    .dd = left };
}

/* An axis in one direction, or at rest, with its position counted from where it is at time 0. */
struct stretch {
    const struct sim_axis *axis;
    const struct sim_transition *whole; /* one that is known */
    double direction;                   /* 1 or -1: of the velocity, or at rest of the force */
    double v;                           /* m/s */
    double force;                       /* the constant one at time 0, with friction if it moves, N */
    double decaying;                    /* the decaying one at time 0, N */
};

static struct sim_transition over_time(const struct stretch *stretch, double time)
{
    return time == stretch->whole->time ? *stretch->whole : sim_axis_transition(stretch->axis, time);
}

static double x_after(const struct stretch *stretch, const struct sim_transition *over)
{
    const double x = over->xv * stretch->v + over->xf * stretch->force;
    return stretch->axis->lag > 0.0 ? x + over->xd * stretch->decaying : x;
}

static double v_after(const struct stretch *stretch, const struct sim_transition *over)
{
    const double v = over->vv * stretch->v + over->vf * stretch->force;
    return stretch->axis->lag > 0.0 ? v + over->vd * stretch->decaying : v;
}

static double speed_at(const struct stretch *stretch, double time)
{
    const struct sim_transition over = over_time(stretch, time);
    return stretch->direction * v_after(stretch, &over);
}

/*
 * y = v' + v / lag, times the mass. v exp(t / lag) rises where y is positive and falls where it is negative. y itself
 * follows m y'' + damping y' + spring y = 0.
 */
static double rise_at(const struct stretch *stretch, double time)
{
    const struct sim_axis *axis = stretch->axis;
    double x = 0.0, v = stretch->v, decaying = stretch->decaying;
    if (time > 0.0) {
        const struct sim_transition over = over_time(stretch, time);
        x = x_after(stretch, &over);
        v = v_after(stretch, &over);
        decaying *= over.dd;
    }
    return stretch->direction *
           (stretch->force + decaying - axis->spring * x - axis->damping * v + axis->mass / axis->lag * v);
}

/* By how much the force on an axis at rest is above stiction. */
static double excess_at(const struct stretch *stretch, double time)
{
    const struct sim_transition over = over_time(stretch, time);
    return stretch->direction * (stretch->force + stretch->decaying * over.dd) - stretch->axis->stiction;
}

/*
 * Where a value changes its sign between `low` and `high`, both above 0: the end of the interval that is left, which has
 * the sign of `high`. If `low` has that sign too, about `low`. Of three steps two are false position, with the weight of
 * the end that stays halved, and one is a bisection.
 */
static double locate(const struct stretch *stretch, double (*value)(const struct stretch *stretch, double time),
                     double low, double high)
{
    const double resolution = RESOLUTION * high;
    double at_low = value(stretch, low), at_high = value(stretch, high);
    const int is_above = at_high > 0.0;
    for (int i = 0; high - low > resolution; i++) {
        double time = (low * at_high - high * at_low) / (at_high - at_low);
        if (i % 3 == 2 || !(time > low && time < high))
            time = 0.5 * (low + high);
        const double at_time = value(stretch, time);
        if ((at_time > 0.0) == is_above) {
            high = time;
            at_high = at_time;
            at_low *= 0.5;
        } else {
            low = time;
            at_low = at_time;
            at_high *= 0.5;
        }
    }
    return high;
}

/* How long an axis at rest stays there: all of `left`, or until the motor's force is above stiction. */
static double time_at_rest(struct stretch *stretch, double left)
{
    const double limit = stretch->axis->stiction;
    if (fabs(stretch->force + stretch->decaying) > limit)
        return 0.0;
    if (stretch->axis->lag == 0.0)
        return left;
    const double end = stretch->force + stretch->decaying * over_time(stretch, left).dd;
    if (fabs(end) <= limit)
        return left;
    stretch->direction = end > 0.0 ? 1.0 : -1.0;
    return locate(stretch, excess_at, RESOLUTION * left, left);
}

/*
 * When a moving axis stops within `step`; *stops is 0 if it does not. A step is shorter than half a period of the
 * axis's own oscillation, so without a lag v has at most one zero in it. With a lag y has at most one, so v exp(t / lag)
 * has at most one extremum, and v at most two zeros, one on each side of it. For an axis that leaves rest, time 0 is
 * one of these.
 */
static double time_to_stop(const struct stretch *stretch, double step, int *stops)
{
    const double low = RESOLUTION * step;
    double high = step;
    *stops = speed_at(stretch, step) <= 0.0;
    if (stretch->axis->lag > 0.0 && !*stops && stretch->v != 0.0 && rise_at(stretch, 0.0) <= 0.0 &&
        rise_at(stretch, step) > 0.0) {
        high = locate(stretch, rise_at, low, step);
        *stops = speed_at(stretch, high) <= 0.0;
    }
    return *stops ? locate(stretch, speed_at, low, high) : step;
}

static void advance_with_friction(const struct sim_axis *axis, const struct sim_transition *whole,
                                  const struct sim_load *load, struct sim_motion *motion)
{
    const double frequency = sqrt(axis->spring / axis->mass);
    double left = whole->time, decaying = axis->lag > 0.0 ? motion->f - load->command : 0.0;
    while (left > 0.0) {
        const double force = load->command + load->push - axis->spring * (motion->x - load->centre);
        struct stretch stretch = { axis, whole, force + decaying > 0.0 ? 1.0 : -1.0, motion->v, force, decaying };
        double time = 0.0;
        if (motion->v == 0.0)
            time = time_at_rest(&stretch, left);
        if (time > 0.0) {
            decaying *= over_time(&stretch, time).dd;
            left -= time;
            continue;
        }
        if (motion->v != 0.0)
            stretch.direction = motion->v > 0.0 ? 1.0 : -1.0;
        stretch.force -= stretch.direction * axis->friction;
        /* 3 is below pi, half a period. */
        const double step = left / (floor(left * frequency / 3.0) + 1.0);
        int stops;
        time = time_to_stop(&stretch, step, &stops);
        const struct sim_transition over = over_time(&stretch, time);
        motion->x += x_after(&stretch, &over);
        motion->v = stops ? 0.0 : v_after(&stretch, &over);
        decaying *= over.dd;
        left -= time;
    }
    motion->f = load->command + decaying;
}

void sim_axis_advance(const struct sim_axis *axis, const struct sim_transition *over, const struct sim_load *load,
                      struct sim_motion *motion)
{
    if (axis->stiction > 0.0) {
        advance_with_friction(axis, over, load, motion);
        return;
    }
    const double x = motion->x - load->centre, v = motion->v, force = load->command + load->push;
    double to_x = over->xx * x + over->xv * v + over->xf * force;
    double to_v = over->vx * x + over->vv * v + over->vf * force, decaying = 0.0;
    if (axis->lag > 0.0) {
        decaying = motion->f - load->command;
        to_x += over->xd * decaying;
        to_v += over->vd * decaying;
        decaying *= over->dd;
    }
    motion->x = load->centre + to_x;
    motion->v = to_v;
    motion->f = load->command + decaying;
}

/* ---- the hand ---- */

static const char *const script_names[] = { "", "hold", "press", "wipe", NULL };

static const char *const headers[] = {
    "t,x,y,z",    "t,x,y,z,rx,ry,rz",    "t,x,y,z,buttons",    "t,x,y,z,rx,ry,rz,buttons",
    "t,fx,fy,fz", "t,fx,fy,fz,tx,ty,tz", "t,fx,fy,fz,buttons", "t,fx,fy,fz,tx,ty,tz,buttons",
    NULL
};
enum { FIRST_FORCE_HEADER = 4 };

static const char *check_row(const double *row, size_t columns)
{
    for (size_t i = 0; i < columns; i++)
        if (!(fabs(row[i]) < 0x1p53))
            return "a number is too large";
    return NULL;
}

static const struct csv_format hand_format = {
    .headers = headers,
    .header_error = "the header is not one that is known",
    .check_row = check_row,
};

dpt_result sim_hand_open(struct sim_hand *hand, const char *script, double reach, double cycle, dpt_device_error *error)
{
    *hand = (struct sim_hand){ .reach = reach, .cycle = cycle };
    latest_value_init(&hand->steering);
    for (int i = 0; script_names[i]; i++) {
        if (strcmp(script, script_names[i]))
            continue;
        hand->kind = (enum hand_kind)i;
        return DPT_OK;
    }
    hand->kind = HAND_TABLE;
    const dpt_result result = csv_table_read(&hand->table, script, &hand_format, error);
    if (result != DPT_E_OPEN || errno != ENOENT || strpbrk(script, "./\\"))
        return result;
    struct near_word near = near_word_begin(script, strlen(script));
    for (int i = 1; script_names[i]; i++)
        near_word_try(&near, script_names[i]);
    device_error(error, result, "there is no hand '%.60s', and no such file: hands are hold, press and wipe", script);
    return device_error_meant(error, result, near.word);
}

void sim_hand_close(struct sim_hand *hand)
{
    csv_table_free(&hand->table);
}

/* Goes from 0 to 1 and back once in each unit of t, with zero velocity at both ends. */
static double to_and_fro(double t)
{
    double s = 1.0 - fabs(2.0 * (t - floor(t)) - 1.0);
    return s * s * (3.0 - 2.0 * s);
}

static void interpolate_table(struct sim_hand *hand, double time, struct hand_target *target)
{
    const struct csv_table *table = &hand->table;
    size_t columns = table->columns, numbers = columns < 7 ? 3 : 6;
    while (hand->row + 1 < table->rows && table->values[(hand->row + 1) * columns] <= time)
        hand->row++;
    const double *row = table->values + hand->row * columns, *next = row;
    double part = 0.0;
    if (hand->row + 1 < table->rows && time > row[0]) {
        next = row + columns;
        part = (time - row[0]) / (next[0] - row[0]);
    }
    for (size_t i = 0; i < numbers; i++)
        target->value[i] = row[1 + i] + part * (next[1 + i] - row[1 + i]);
    if (columns == numbers + 2 && row[columns - 1] >= 0.0 && row[columns - 1] <= 0xffffffffu)
        target->buttons = (uint32_t)row[columns - 1];
    target->is_position = table->header < FIRST_FORCE_HEADER;
}

int sim_hand_steer(struct sim_hand *hand, const double position[3])
{
    if (hand->kind == HAND_NONE || (hand->kind == HAND_TABLE && hand->table.header >= FIRST_FORCE_HEADER))
        return 0;
    memcpy(hand->wanted[hand->steering.writing], position, sizeof hand->wanted[0]);
    latest_value_publish(&hand->steering);
    return 1;
}

/* From where the script had it, or where it is, towards what is wanted. */
static void steer(struct sim_hand *hand, double time, struct hand_target *target)
{
    if (latest_value_take(&hand->steering) && !hand->is_steered) {
        hand->is_steered = 1;
        hand->steered_time = time;
        memcpy(hand->steered_at, target->value, sizeof hand->steered_at);
    }
    if (!hand->is_steered)
        return;
    const double *wanted = hand->wanted[hand->steering.reading];
    const double reach = STEERING_SPEED * (time - hand->steered_time);
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (wanted[k] - hand->steered_at[k]) * (wanted[k] - hand->steered_at[k]);
    const double share = square > reach * reach ? reach / sqrt(square) : 1.0;
    for (int k = 0; k < 3; k++)
        target->value[k] = hand->steered_at[k] += share * (wanted[k] - hand->steered_at[k]);
    hand->steered_time = time;
}

void sim_hand_at(struct sim_hand *hand, double time, struct hand_target *target)
{
    *target = (struct hand_target){ .is_position = hand->kind != HAND_NONE };
    if (hand->kind == HAND_TABLE)
        interpolate_table(hand, time, target);
    if (hand->kind == HAND_PRESS)
        target->value[1] = -hand->reach * to_and_fro(time / hand->cycle);
    if (hand->kind == HAND_WIPE) {
        target->value[1] = -hand->reach * to_and_fro(time < hand->cycle ? 0.5 * time / hand->cycle : 0.5);
        target->value[0] = hand->reach * (2.0 * to_and_fro(0.5 * time / hand->cycle + 0.25) - 1.0);
    }
    steer(hand, time, target);
}
