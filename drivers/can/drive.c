/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/drive.h"

#include <math.h>
#include <string.h>

#include "base/vec3.h"
#include "dynpoint/device.h"
#include "text/parse_number.h"

#define TURN 6.283185307179586476925

static const struct can_drive *const drives[] = { &odrive_drive, &damiao_drive, &robstride_drive, &cybergear_drive,
                                                  &moteus_drive };

const struct can_drive *drive_get(uint32_t index)
{
    return index < sizeof drives / sizeof *drives ? drives[index] : NULL;
}

const struct can_drive *drive_find(const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof drives / sizeof *drives; i++)
        if (strlen(drives[i]->name) == length && !memcmp(drives[i]->name, name, length))
            return drives[i];
    return NULL;
}

/* RobStride's models whose ranges two sources agree on (docs/motors.md). */
static const struct {
    const char *name;
    double velocity, torque;
} models[] = { { "rs-01", 44.0, 17.0 }, { "rs-02", 44.0, 17.0 }, { "rs-03", 50.0, 60.0 }, { "rs-04", 15.0, 120.0 } };

int drive_set_model(struct drive_node *node, const char *name, size_t length)
{
    for (size_t i = 0; i < sizeof models / sizeof *models; i++)
        if (strlen(models[i].name) == length && !memcmp(models[i].name, name, length)) {
            node->velocity_range = models[i].velocity;
            node->torque_range = models[i].torque;
            return 1;
        }
    const char *end = name + length, *colon = parse_double(name, end, &node->velocity_range);
    return colon && colon < end && *colon == ':' && parse_double(colon + 1, end, &node->torque_range) == end &&
           node->velocity_range > 0.0 && node->velocity_range < 1e4 && node->torque_range > 0.0 &&
           node->torque_range < 1e4;
}

double drive_position_step(const struct drive_node *node)
{
    const struct can_drive *drive = node->drive;
    return drive->position_steps ? 2.0 * node->position_range / (TURN * drive->position_steps) : drive->position_step;
}

double drive_torque_step(const struct drive_node *node)
{
    const struct can_drive *drive = node->drive;
    return drive->torque_steps ? 2.0 * node->torque_range / drive->torque_steps : drive->torque_step;
}

const struct drive_parameter *drive_parameter_of(const struct can_drive *drive, unsigned parameter)
{
    for (uint32_t i = 0; i < drive->parameter_count; i++)
        if (drive->parameters[i].parameter == parameter)
            return &drive->parameters[i];
    return NULL;
}

const char *drive_fault_name(const struct can_drive *drive, uint32_t fault)
{
    for (const struct drive_fault *at = drive->faults; at && at->name; at++)
        if (drive->faults_are_bits ? at->fault & fault : at->fault == fault)
            return at->name;
    return fault ? "unknown" : NULL;
}

uint32_t drive_reasons(const struct can_drive *drive, uint32_t fault)
{
    uint32_t reasons = 0, left = fault;
    for (const struct drive_fault *at = drive->faults; at && at->name; at++)
        if (fault && (drive->faults_are_bits ? at->fault & fault : at->fault == fault)) {
            reasons |= at->reason;
            left &= ~at->fault;
        }
    return left ? reasons | DPT_REASON_DEVICE : reasons;
}

double drive_bus_load(const struct drive_node *nodes, uint32_t count, double rate, int request, uint32_t bitrate,
                      uint32_t data_bitrate)
{
    const double request_bits = 55.0;
    double bits = 0.0, data_bits = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const struct can_drive *drive = nodes[i].drive;
        bits += drive->command_bits + drive->answer_bits + (request && !drive->answers ? request_bits : 0.0);
        data_bits += drive->command_data_bits + drive->answer_data_bits;
    }
    return rate * (bits / bitrate + data_bits / (data_bitrate ? data_bitrate : bitrate));
}

int drive_nodes_collide(const struct drive_node *a, const struct drive_node *b)
{
    struct can_wanted of_a[DRIVE_WANTED], of_b[DRIVE_WANTED];
    const int count_a = a->drive->wanted(a, of_a), count_b = b->drive->wanted(b, of_b);
    for (int i = 0; i < count_a; i++)
        for (int k = 0; k < count_b; k++) {
            /* The ids of Damiao's registers are shared; the data says whose they are. */
            const int is_shared = a->drive == b->drive && of_a[i].id == of_b[k].id && of_a[i].id == 0x7ff;
            if (of_a[i].is_extended == of_b[k].is_extended && !is_shared &&
                !((of_a[i].id ^ of_b[k].id) & of_a[i].mask & of_b[k].mask))
                return 1;
        }
    return 0;
}

uint32_t drive_quantise(double value, double range, unsigned bits)
{
    const double steps = (double)((1u << bits) - 1u);
    const double number = floor((max_of(min_of(value, range), -range) + range) * (steps / (2.0 * range)) + 0.5);
    return number > 0.0 ? (uint32_t)min_of(number, steps) : 0;
}

double drive_value_of(uint32_t number, double range, unsigned bits)
{
    return (double)number * (2.0 * range / (double)((1u << bits) - 1u)) - range;
}

void drive_put_value(const struct drive_parameter *parameter, double value, uint8_t *at)
{
    uint32_t bits;
    const float real = (float)value;
    memcpy(&bits, &real, 4);
    if (parameter->bytes)
        bits = value > 0.0 ? (uint32_t)min_of(floor(value / parameter->unit + 0.5), 4294967295.0) : 0;
    for (int i = 0; i < 4; i++)
        at[i] = (uint8_t)(bits >> 8 * i);
}

int drive_get_value(const struct drive_parameter *parameter, const uint8_t *at, double *value)
{
    uint32_t bits = 0;
    float real;
    for (int i = 0; i < (parameter->bytes ? parameter->bytes : 4); i++)
        bits |= (uint32_t)at[i] << 8 * i;
    memcpy(&real, &bits, 4);
    *value = parameter->bytes ? bits * parameter->unit : (double)real;
    return parameter->bytes || (bits >> 23 & 0xff) != 0xff;
}
