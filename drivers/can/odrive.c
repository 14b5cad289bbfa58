/* SPDX-License-Identifier: BSD-3-Clause */
#include "can/odrive.h"

#include <stddef.h>
#include <string.h>

#include "can/drive.h"
#include "dynpoint/device.h"

enum { TO_CONTROLLER = 1, TO_HOST = 2, ONLY_0_5 = 4, ONLY_0_6 = 8 };

/* Each command: the bytes of data that we send, the fewest that we accept, and flags. */
static const struct {
    uint8_t size, min_size, flags;
} commands[32] = {
    [ODRIVE_VERSION] = { 8, 7, TO_HOST | ONLY_0_6 },
    [ODRIVE_HEARTBEAT] = { 8, 8, TO_HOST },
    [ODRIVE_ESTOP] = { 0, 0, TO_CONTROLLER },
    [ODRIVE_ERROR] = { 8, 8, TO_HOST },
    [ODRIVE_ENCODER_ERROR] = { 8, 4, TO_HOST | ONLY_0_5 },
    [ODRIVE_ADDRESS] = { 8, 7, TO_HOST | ONLY_0_6 },
    [ODRIVE_SET_STATE] = { 4, 4, TO_CONTROLLER },
    [ODRIVE_ESTIMATES] = { 8, 8, TO_HOST },
    [ODRIVE_SET_MODE] = { 8, 8, TO_CONTROLLER },
    [ODRIVE_SET_TORQUE] = { 4, 4, TO_CONTROLLER },
    [ODRIVE_CLEAR_ERRORS] = { 1, 0, TO_CONTROLLER },
    [ODRIVE_CONTROLLER_ERROR] = { 8, 4, TO_HOST | ONLY_0_5 },
};

static int has_command(unsigned command, unsigned generation)
{
    const unsigned flags = commands[command].flags;
    return flags && !(flags & ONLY_0_5 && generation != ODRIVE_0_5) && !(flags & ONLY_0_6 && generation == ODRIVE_0_5);
}

static void put(uint8_t *at, unsigned bytes, uint64_t value)
{
    for (unsigned i = 0; i < bytes; i++)
        at[i] = (uint8_t)(value >> 8 * i);
}

static uint64_t get(const uint8_t *at, unsigned bytes)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++)
        value |= (uint64_t)at[i] << 8 * i;
    return value;
}

/* Returns 0 for infinities and NaN. */
static int put_float(uint8_t *at, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, 4);
    put(at, 4, bits);
    return (bits >> 23 & 0xff) != 0xff;
}

static int get_float(const uint8_t *at, float *value)
{
    const uint32_t bits = (uint32_t)get(at, 4);
    memcpy(value, &bits, 4);
    return (bits >> 23 & 0xff) != 0xff;
}

static void put_heartbeat(uint8_t *data, const struct odrive_heartbeat *heartbeat, unsigned generation)
{
    put(data, 4, heartbeat->errors);
    data[4] = heartbeat->state;
    if (generation == ODRIVE_0_5) {
        data[5] = (heartbeat->failed & ODRIVE_FAILED_MOTOR) != 0;
        data[6] = (heartbeat->failed & ODRIVE_FAILED_ENCODER) != 0;
        data[7] =
            (uint8_t)((heartbeat->failed & ODRIVE_FAILED_CONTROLLER) != 0) | (uint8_t)((heartbeat->is_done & 1) << 7);
    } else {
        data[5] = heartbeat->result;
        data[6] = heartbeat->is_done & 1;
        data[7] = heartbeat->reserved;
    }
}

static void get_heartbeat(const uint8_t *data, unsigned generation, struct odrive_heartbeat *heartbeat)
{
    heartbeat->errors = (uint32_t)get(data, 4);
    heartbeat->state = data[4];
    if (generation == ODRIVE_0_5) {
        heartbeat->failed =
            (uint8_t)((data[5] & 1 ? ODRIVE_FAILED_MOTOR : 0) | (data[6] & 1 ? ODRIVE_FAILED_ENCODER : 0) |
                      (data[7] & 1 ? ODRIVE_FAILED_CONTROLLER : 0));
        heartbeat->is_done = data[7] >> 7;
    } else {
        heartbeat->result = data[5];
        heartbeat->is_done = data[6] & 1;
        heartbeat->reserved = data[7];
    }
}

int odrive_encode(const struct odrive_message *message, unsigned generation, struct can_message *frame)
{
    memset(frame, 0, sizeof *frame);
    if (message->node >= ODRIVE_NODES || message->command >= 32 || !has_command(message->command, generation))
        return 0;
    frame->id = (uint32_t)message->node << 5 | message->command;
    if (message->is_request) {
        frame->flags = CAN_MESSAGE_REMOTE;
        return (commands[message->command].flags & TO_HOST) != 0;
    }
    uint8_t *data = frame->data;
    frame->size = commands[message->command].size;
    if (message->command == ODRIVE_CLEAR_ERRORS && generation == ODRIVE_0_5)
        frame->size = 0;
    switch (message->command) {
    case ODRIVE_VERSION:
        data[0] = message->as.version.protocol;
        memcpy(data + 1, message->as.version.hardware, 3);
        memcpy(data + 4, message->as.version.firmware, 3);
        data[7] = message->as.version.is_unreleased;
        break;
    case ODRIVE_HEARTBEAT:
        put_heartbeat(data, &message->as.heartbeat, generation);
        break;
    case ODRIVE_ERROR:
        put(data, 8, message->as.error.active);
        if (generation != ODRIVE_0_5)
            put(data + 4, 4, message->as.error.disarm);
        break;
    case ODRIVE_ENCODER_ERROR:
    case ODRIVE_CONTROLLER_ERROR:
        put(data, 4, message->as.error.active);
        break;
    case ODRIVE_ADDRESS:
        data[0] = message->as.address.node;
        put(data + 1, 6, message->as.address.serial);
        break;
    case ODRIVE_SET_STATE:
        put(data, 4, message->as.state);
        break;
    case ODRIVE_ESTIMATES:
        return put_float(data, message->as.estimates.position) & put_float(data + 4, message->as.estimates.velocity);
    case ODRIVE_SET_MODE:
        put(data, 4, message->as.mode.control);
        put(data + 4, 4, message->as.mode.input);
        break;
    case ODRIVE_SET_TORQUE:
        return put_float(data, message->as.torque);
    default:
        break;
    }
    return 1;
}

int odrive_decode(const struct can_message *frame, unsigned generation, struct odrive_message *message)
{
    const uint8_t *data = frame->data;
    memset(message, 0, sizeof *message);
    message->node = (uint8_t)(frame->id >> 5 & (ODRIVE_NODES - 1));
    message->command = (uint8_t)(frame->id & 31);
    message->is_request = (frame->flags & CAN_MESSAGE_REMOTE) != 0;
    if (frame->flags & (CAN_MESSAGE_EXTENDED | CAN_MESSAGE_FD) || frame->id >= ODRIVE_NODES << 5 ||
        !has_command(message->command, generation))
        return ODRIVE_OTHER;
    if (message->is_request)
        return ODRIVE_MESSAGE;
    if (frame->size < commands[message->command].min_size || frame->size > 8)
        return ODRIVE_DAMAGED;
    int is_finite = 1;
    switch (message->command) {
    case ODRIVE_VERSION:
        message->as.version.protocol = data[0];
        memcpy(message->as.version.hardware, data + 1, 3);
        memcpy(message->as.version.firmware, data + 4, 3);
        message->as.version.is_unreleased = frame->size == 8 ? data[7] : 0;
        break;
    case ODRIVE_HEARTBEAT:
        get_heartbeat(data, generation, &message->as.heartbeat);
        break;
    case ODRIVE_ERROR:
        message->as.error.active = get(data, generation == ODRIVE_0_5 ? 8 : 4);
        message->as.error.disarm = generation == ODRIVE_0_5 ? 0 : (uint32_t)get(data + 4, 4);
        break;
    case ODRIVE_ENCODER_ERROR:
    case ODRIVE_CONTROLLER_ERROR:
        message->as.error.active = get(data, 4);
        break;
    case ODRIVE_ADDRESS:
        message->as.address.node = data[0];
        message->as.address.serial = get(data + 1, 6);
        break;
    case ODRIVE_SET_STATE:
        message->as.state = (uint32_t)get(data, 4);
        break;
    case ODRIVE_ESTIMATES:
        is_finite =
            get_float(data, &message->as.estimates.position) & get_float(data + 4, &message->as.estimates.velocity);
        break;
    case ODRIVE_SET_MODE:
        message->as.mode.control = (uint32_t)get(data, 4);
        message->as.mode.input = (uint32_t)get(data + 4, 4);
        break;
    case ODRIVE_SET_TORQUE:
        is_finite = get_float(data, &message->as.torque);
        break;
    default:
        break;
    }
    return is_finite ? ODRIVE_MESSAGE : ODRIVE_DAMAGED;
}

unsigned odrive_heartbeat_generation(const struct can_message *frame)
{
    if (frame->size < 8 || frame->data[7] != 0)
        return frame->size < 8 ? ODRIVE_ANY : ODRIVE_0_5;
    return frame->data[5] > 1 ? ODRIVE_0_6 : ODRIVE_ANY;
}

int odrive_is_control(unsigned command)
{
    /* Besides our own: inputs, limits, trajectories, reboot, the encoder's position, gains, new firmware. */
    return (command >= 0x0c && command <= 0x13) || command == 0x16 || (command >= 0x19 && command <= 0x1b) ||
           command == 0x1f || (command < 32 && commands[command].flags & TO_CONTROLLER);
}

struct odrive_error {
    uint64_t bit;
    uint32_t reason;
    const char *name;
};

enum {
    HEAT = DPT_REASON_OVERHEATED,
    LOAD = DPT_REASON_OVERLOADED,
    CALIB = DPT_REASON_UNCALIBRATED,
    OWN = DPT_REASON_DEVICE
};

/* clang-format off */
static const struct odrive_error errors_0_6[] = {
    { 0x1, OWN, "INITIALIZING" }, { 0x2, OWN, "SYSTEM_LEVEL" }, { 0x4, OWN, "TIMING_ERROR" },
    { 0x8, CALIB, "MISSING_ESTIMATE" }, { 0x10, OWN, "BAD_CONFIG" }, { 0x20, OWN, "DRV_FAULT" },
    { 0x40, OWN, "MISSING_INPUT" }, { 0x100, OWN, "DC_BUS_OVER_VOLTAGE" },
    { 0x200, OWN, "DC_BUS_UNDER_VOLTAGE" }, { 0x400, LOAD, "DC_BUS_OVER_CURRENT" },
    { 0x800, LOAD, "DC_BUS_OVER_REGEN_CURRENT" }, { 0x1000, LOAD, "CURRENT_LIMIT_VIOLATION" },
    { 0x2000, HEAT, "MOTOR_OVER_TEMP" }, { 0x4000, HEAT, "INVERTER_OVER_TEMP" },
    { 0x8000, LOAD, "VELOCITY_LIMIT_VIOLATION" }, { 0x10000, LOAD, "POSITION_LIMIT_VIOLATION" },
    { 0x1000000, DPT_REASON_WATCHDOG, "WATCHDOG_TIMER_EXPIRED" },
    { 0x2000000, DPT_REASON_ESTOP, "ESTOP_REQUESTED" }, { 0x4000000, CALIB, "SPINOUT_DETECTED" },
    { 0x8000000, OWN, "BRAKE_RESISTOR_DISARMED" }, { 0x10000000, OWN, "THERMISTOR_DISCONNECTED" },
    { 0x40000000, CALIB, "CALIBRATION_ERROR" }, { 0, 0, NULL }
};
static const struct odrive_error axis_errors[] = {
    { 0x1, OWN, "INVALID_STATE" }, { 0x40, OWN, "MOTOR_FAILED" },
    { 0x80, OWN, "SENSORLESS_ESTIMATOR_FAILED" }, { 0x100, CALIB, "ENCODER_FAILED" },
    { 0x200, OWN, "CONTROLLER_FAILED" }, { 0x800, DPT_REASON_WATCHDOG, "WATCHDOG_TIMER_EXPIRED" },
    { 0x1000, OWN, "MIN_ENDSTOP_PRESSED" }, { 0x2000, OWN, "MAX_ENDSTOP_PRESSED" },
    { 0x4000, DPT_REASON_ESTOP, "ESTOP_REQUESTED" }, { 0x20000, CALIB, "HOMING_WITHOUT_ENDSTOP" },
    { 0x40000, HEAT, "OVER_TEMP" }, { 0x80000, CALIB, "UNKNOWN_POSITION" }, { 0, 0, NULL }
};
static const struct odrive_error motor_errors[] = {
    { 0x1, CALIB, "PHASE_RESISTANCE_OUT_OF_RANGE" }, { 0x2, CALIB, "PHASE_INDUCTANCE_OUT_OF_RANGE" },
    { 0x8, OWN, "DRV_FAULT" }, { 0x10, OWN, "CONTROL_DEADLINE_MISSED" },
    { 0x80, LOAD, "MODULATION_MAGNITUDE" }, { 0x400, LOAD, "CURRENT_SENSE_SATURATION" },
    { 0x1000, LOAD, "CURRENT_LIMIT_VIOLATION" }, { 0x10000, OWN, "MODULATION_IS_NAN" },
    { 0x20000, HEAT, "MOTOR_THERMISTOR_OVER_TEMP" }, { 0x40000, HEAT, "FET_THERMISTOR_OVER_TEMP" },
    { 0x80000, OWN, "TIMER_UPDATE_MISSED" }, { 0x100000, OWN, "CURRENT_MEASUREMENT_UNAVAILABLE" },
    { 0x200000, OWN, "CONTROLLER_FAILED" }, { 0x400000, LOAD, "I_BUS_OUT_OF_RANGE" },
    { 0x800000, OWN, "BRAKE_RESISTOR_DISARMED" }, { 0x1000000, OWN, "SYSTEM_LEVEL" },
    { 0x2000000, OWN, "BAD_TIMING" }, { 0x4000000, CALIB, "UNKNOWN_PHASE_ESTIMATE" },
    { 0x8000000, CALIB, "UNKNOWN_PHASE_VEL" }, { 0x10000000, OWN, "UNKNOWN_TORQUE" },
    { 0x20000000, OWN, "UNKNOWN_CURRENT_COMMAND" }, { 0x40000000, OWN, "UNKNOWN_CURRENT_MEASUREMENT" },
    { 0x80000000, OWN, "UNKNOWN_VBUS_VOLTAGE" }, { 0x100000000, OWN, "UNKNOWN_VOLTAGE_COMMAND" },
    { 0x200000000, OWN, "UNKNOWN_GAINS" }, { 0x400000000, OWN, "CONTROLLER_INITIALIZING" },
    { 0x800000000, OWN, "UNBALANCED_PHASES" }, { 0, 0, NULL }
};
static const struct odrive_error encoder_errors[] = {
    { 0x1, CALIB, "UNSTABLE_GAIN" }, { 0x2, CALIB, "CPR_POLEPAIRS_MISMATCH" },
    { 0x4, CALIB, "NO_RESPONSE" }, { 0x8, CALIB, "UNSUPPORTED_ENCODER_MODE" },
    { 0x10, CALIB, "ILLEGAL_HALL_STATE" }, { 0x20, CALIB, "INDEX_NOT_FOUND_YET" },
    { 0x40, CALIB, "ABS_SPI_TIMEOUT" }, { 0x80, CALIB, "ABS_SPI_COM_FAIL" },
    { 0x100, CALIB, "ABS_SPI_NOT_READY" }, { 0x200, CALIB, "HALL_NOT_CALIBRATED_YET" }, { 0, 0, NULL }
};
static const struct odrive_error controller_errors[] = {
    { 0x1, LOAD, "OVERSPEED" }, { 0x2, OWN, "INVALID_INPUT_MODE" }, { 0x4, OWN, "UNSTABLE_GAIN" },
    { 0x8, OWN, "INVALID_MIRROR_AXIS" }, { 0x10, OWN, "INVALID_LOAD_ENCODER" },
    { 0x20, CALIB, "INVALID_ESTIMATE" }, { 0x40, OWN, "INVALID_CIRCULAR_RANGE" },
    { 0x80, CALIB, "SPINOUT_DETECTED" }, { 0, 0, NULL }
};
/* clang-format on */

static const struct odrive_error *const words[ODRIVE_ERROR_WORDS] = { errors_0_6, axis_errors, motor_errors,
                                                                      encoder_errors, controller_errors };

const char *odrive_error_name(unsigned word, uint64_t errors)
{
    const uint64_t lowest = errors & (~errors + 1);
    if (word >= ODRIVE_ERROR_WORDS || !lowest)
        return NULL;
    for (const struct odrive_error *error = words[word]; error->name; error++)
        if (error->bit == lowest)
            return error->name;
    return "unknown";
}

uint32_t odrive_reasons(unsigned word, uint64_t errors)
{
    uint32_t reasons = 0;
    if (word >= ODRIVE_ERROR_WORDS)
        return 0;
    for (const struct odrive_error *error = words[word]; error->name; error++)
        if (errors & error->bit) {
            reasons |= error->reason;
            errors &= ~error->bit;
        }
    return reasons | (errors ? OWN : 0);
}

const char *odrive_state_name(unsigned state)
{
    static const char *const names[] = {
        "UNDEFINED",
        "IDLE",
        "STARTUP_SEQUENCE",
        "FULL_CALIBRATION_SEQUENCE",
        "MOTOR_CALIBRATION",
        "SENSORLESS_CONTROL",
        "ENCODER_INDEX_SEARCH",
        "ENCODER_OFFSET_CALIBRATION",
        "CLOSED_LOOP_CONTROL",
        "LOCKIN_SPIN",
        "ENCODER_DIR_FIND",
        "HOMING",
        "ENCODER_HALL_POLARITY_CALIBRATION",
        "ENCODER_HALL_PHASE_CALIBRATION",
        "ANTICOGGING_CALIBRATION",
    };
    return state < sizeof names / sizeof *names ? names[state] : "unknown";
}

static int encode_order(const struct drive_node *node, const struct drive_message *order, struct can_message *frame)
{
    struct odrive_message message = { .node = (uint8_t)node->number };
    switch (order->kind) {
    case DRIVE_TORQUE:
        message.command = ODRIVE_SET_TORQUE;
        message.as.torque = order->as.command.torque;
        break;
    case DRIVE_MODE:
        message.command = ODRIVE_SET_MODE;
        message.as.mode.control = ODRIVE_CONTROL_TORQUE;
        message.as.mode.input = ODRIVE_INPUT_PASSTHROUGH;
        break;
    case DRIVE_ON:
    case DRIVE_OFF:
        message.command = ODRIVE_SET_STATE;
        message.as.state = order->kind == DRIVE_ON ? ODRIVE_STATE_CLOSED_LOOP : ODRIVE_STATE_IDLE;
        break;
    case DRIVE_STOP:
        message.command = ODRIVE_ESTOP;
        break;
    case DRIVE_CLEAR:
        message.command = ODRIVE_CLEAR_ERRORS;
        break;
    case DRIVE_ASK:
        message.command = ODRIVE_ESTIMATES;
        message.is_request = 1;
        break;
    default:
        return 0;
    }
    return odrive_encode(&message, node->generation, frame);
}

static int wanted(const struct drive_node *node, struct can_wanted *out)
{
    out[0] = (struct can_wanted){ .id = (uint32_t)node->number << 5, .mask = 0x7ffu & ~31u };
    return 1;
}

const struct can_drive odrive_drive = {
    .name = "odrive",
    .title = "ODrive",
    .number_max = ODRIVE_NODES - 1,
    .command_bits = 95,
    .answer_bits = 135,
    .encode = encode_order,
    .wanted = wanted,
};
