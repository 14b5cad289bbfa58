/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulated motor controllers, and the driver's device for them, on a bus that stands in for the kernel's (can_kernel.h). */
#ifndef DPT_TESTS_CAN_FIXTURE_H
#define DPT_TESTS_CAN_FIXTURE_H

#include "drivers/can_kernel.h"

#include <math.h>

#include "base/vec3.h"
#include "can/can_session.h"
#include "lib/arm_bytes.h"
#include "lib/check.h"
#include "simulate/simulate_can.h"

static struct simulate_can simulated;
static dpt_device *device;
static dpt_device_error error;
static dpt_device_state state;
static dpt_device_counts counts;
static char elbow_path[64] __attribute__((unused));

static inline const char *interface(void)
{
    return can_real ? can_real : "can0";
}

static inline void each_ms(void)
{
    simulate_can_tick(&simulated);
}

static inline void pass_ms(int milliseconds)
{
    for (int i = 0; i < milliseconds; i++)
        can_tick();
}

static inline dpt_result open_at(const char *where)
{
    char name[512];
    snprintf(name, sizeof name, "can:%s", where);
    error.size = sizeof error;
    state.size = sizeof state;
    counts.size = sizeof counts;
    device = NULL;
    can_watched = 1;
    const dpt_result result = dpt_device_open(name, &device, &error);
    can_watched = 0;
    return result;
}

static inline dpt_result clear(void)
{
    can_watched = 1;
    const dpt_result result = dpt_device_clear(device);
    can_watched = 0;
    return result;
}

static inline void close_device(void)
{
    can_watched = 1;
    dpt_device_close(device);
    can_watched = 0;
    device = NULL;
    CHECK(can_held_open == 0, "%d are left open", can_held_open);
    can_held_open = 0;
}

static inline const char *where_of(const char *path, const char *settings)
{
    static char where[400];
    snprintf(where, sizeof where, "%s?arm=%s&%s", interface(), path, settings);
    return where;
}

static inline void simulate(const char *path, const char *settings)
{
    const dpt_result result = simulate_can_start(&simulated, where_of(path, settings), &error);
    CHECK(result == DPT_OK, "%s", error.text);
    if (result != DPT_OK)
        exit(1);
    can_spared = simulated.line.fd;
    can_each_ms = each_ms;
}

static inline void end_simulation(void)
{
    can_each_ms = NULL;
    can_spared = -1;
    simulate_can_end(&simulated);
}

/* The nodes, and a device that is open. */
static inline void start(const char *path, const char *settings)
{
    error.size = sizeof error;
    simulate(path, settings);
    const dpt_result result = open_at(where_of(path, settings));
    CHECK(result == DPT_OK, "%s", error.text);
    if (result != DPT_OK)
        exit(1);
    dpt_device_read(device, &state);
}

static inline void finish(void)
{
    close_device();
    pass_ms(1);
    for (uint32_t i = 0; i < simulated.arm.joints; i++)
        CHECK(simulated.node[i].state == ODRIVE_STATE_IDLE && simulated.node[i].torque == 0.0f,
              "motor %u is on after close", i);
    end_simulation();
}

static inline dpt_result write_force(double x, double y, double z)
{
    const dpt_wrench wrench = { { x, y, z }, { 0.0, 0.0, 0.0 } };
    return dpt_device_write(device, &wrench);
}

static inline dpt_result write_up(double force)
{
    return write_force(0.0, force, 0.0);
}

/* 1: a node gives a torque. */
static inline int is_pushing(void)
{
    for (uint32_t i = 0; i < simulated.arm.joints; i++)
        if (simulated.node[i].state == ODRIVE_STATE_CLOSED_LOOP && simulated.node[i].torque != 0.0f)
            return 1;
    return 0;
}

#define ELBOW "gear=8,-8,10&weight=0&watchdog=none"

static inline int push_until_it_fails(int limit)
{
    for (int i = 1; i <= limit; i++) {
        write_up(1.0);
        can_tick();
        dpt_device_read(device, &state);
        if (state.status != DPT_DEVICE_STATUS_READY)
            return i;
    }
    return limit + 1;
}

static inline void refused(dpt_result result, dpt_result code, const char *word)
{
    CHECK(result == code && error.code == code, "%d: %s", result, error.text);
    CHECK(strstr(error.text, word) && strlen(error.text) < sizeof error.text - 1, "'%s' lacks '%s'", error.text, word);
    CHECK(device == NULL && can_held_open == 0, "%d are left open", can_held_open);
    can_held_open = 0;
}

/* Someone else on the bus, with a socket of their own. */
static struct socketcan stranger;

static inline void open_stranger(void)
{
    static const struct can_wanted all[] = { { .id = 0 }, { .id = 0, .is_extended = 1 } };
    CHECK(socketcan_open(&stranger, interface(), all, 2, 1, NULL) == DPT_OK, "no second socket");
}

static inline void someone_says(uint8_t node, uint8_t command, float torque)
{
    const struct odrive_message message = { .node = node, .command = command, .as.torque = torque };
    struct can_message frame;
    CHECK(odrive_encode(&message, ODRIVE_0_6, &frame), "%x", command);
    CHECK(socketcan_send(&stranger, &frame, 1) == 1, "no room");
}

/* What may happen to the bus, for tables of faults. */
static inline void go_off(void)
{
    bus_has_error(CAN_ERR_BUSOFF, 0);
}

static inline void come_on(void)
{
    bus_has_error(CAN_ERR_RESTARTED, 0);
}

static inline void shut(void)
{
    bus_fails(ENETDOWN);
}

static inline void unplug(void)
{
    bus_fails(ENODEV);
}

static inline void mend(void)
{
    bus_fails(0);
}

#endif
