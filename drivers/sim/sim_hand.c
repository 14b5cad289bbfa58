/* SPDX-License-Identifier: BSD-3-Clause */
#include "sim/sim_hand.h"

#include <math.h>
#include <string.h>

#include "settings.h"

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
    return csv_table_read(&hand->table, script, &hand_format, error);
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
