/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The frames of motor drives (drivers/can/drive.h): bytes written out from the makers' documents, round trips within half a step of
 * what the frames carry, and what is not of a motor. drive_peers.py compares them with libraries that others wrote; for it
 *
 *     test_drive write DRIVE COUNT SEED    prints commands and statuses: kind, torque, position, velocity, id, flags, bytes
 *     test_drive read DRIVE                reads such lines, of another's frames, and prints the largest error in steps
 */
#include "can/drive.h"

#include <math.h>

#include "lib/check.h"

#define TURN 6.283185307179586476925

/* A motor of each drive; Damiao's ranges are those of a DM-J4310. */
static struct drive_node node_of(const struct can_drive *drive)
{
    struct drive_node node = {
        .drive = drive, .number = 3, .answer = drive->answer, .watchdog = 0.05, .torque_limit = 5.0
    };
    node.answer = (uint16_t)(node.answer + (drive->answer_has_number ? node.number : 0));
    node.position_range = drive->position_range > 0.0 ? drive->position_range : 12.5;
    node.velocity_range = drive->velocity_range > 0.0 ? drive->velocity_range : drive->has_models ? 44.0 : 30.0;
    node.torque_range = drive->torque_range > 0.0 ? drive->torque_range : drive->has_models ? 17.0 : 10.0;
    return node;
}

static const struct can_drive *const answering[] = { &damiao_drive, &robstride_drive, &cybergear_drive, &moteus_drive };
enum { ANSWERING = 4 };

static void is_frame(const struct can_drive *drive, const struct drive_message *message, uint32_t id, const char *bytes)
{
    struct drive_node node = node_of(drive);
    struct can_message frame;
    char text[2 * CAN_MESSAGE_BYTES + 1] = "";
    CHECK(drive->encode(&node, message, &frame), "%s: kind %u", drive->name, message->kind);
    for (int i = 0; i < frame.size; i++)
        snprintf(text + 2 * i, 3, "%02x", frame.data[i]);
    CHECK(frame.id == id && !strcmp(text, bytes), "%s, kind %u: %x %s, not %x %s", drive->name, message->kind, frame.id,
          text, id, bytes);
}

static void bytes_are_as_documented(void)
{
    struct drive_message message = { .kind = DRIVE_ON };
    is_frame(&damiao_drive, &message, 3, "fffffffffffffffc");
    is_frame(&robstride_drive, &message, 0x0300fd03, "0000000000000000");
    message.kind = DRIVE_OFF;
    is_frame(&damiao_drive, &message, 3, "fffffffffffffffd");
    is_frame(&cybergear_drive, &message, 0x0400fd03, "0000000000000000");
    is_frame(&moteus_drive, &message, 0x8003, "01000011001f01120e505050");
    message.kind = DRIVE_CLEAR;
    is_frame(&damiao_drive, &message, 3, "fffffffffffffffb");
    is_frame(&robstride_drive, &message, 0x0400fd03, "0100000000000000");
    message.kind = DRIVE_ASK;
    is_frame(&damiao_drive, &message, 0x7ff, "0300cc0000000000");
    message.kind = DRIVE_WRITE;
    message.parameter = DRIVE_WATCHDOG;
    message.as.value = 0.05; /* 1000 units of 50 us */
    is_frame(&damiao_drive, &message, 0x7ff, "03005509e8030000");
    is_frame(&robstride_drive, &message, 0x1200fd03, "28700000e8030000");
    is_frame(&cybergear_drive, &message, 0x1200fd03, "0c200000e8030000");
    message.kind = DRIVE_READ;
    is_frame(&damiao_drive, &message, 0x7ff, "0300330900000000");
    is_frame(&robstride_drive, &message, 0x1100fd03, "2870000000000000");
    message.parameter = DRIVE_VERSION;
    is_frame(&moteus_drive, &message, 0x8003, "1982025050505050");
    message = (struct drive_message){ .kind = DRIVE_TORQUE, .as.command.torque = 10.0f };
    is_frame(&damiao_drive, &message, 3,
             "80008000"
             "00000fff");
    message.as.command.torque = -17.0f;
    is_frame(&robstride_drive, &message, 0x01000003, "8000800000000000");
    message.as.command.torque = 12.0f;
    is_frame(&cybergear_drive, &message, 0x01ffff03, "8000800000000000");
    message.as.command.torque = 0.5f;
    is_frame(&moteus_drive, &message, 0x8003,
             "01000a0f200000c07f000000000000003f022300000d250000a0400d27cdcc4c3d012b0011001f01120e"
             "505050505050");
    message = (struct drive_message){ .kind = DRIVE_STATUS };
    message.as.status.is_on = 1;
    message.as.status.temperature = 41.0f;
    is_frame(&damiao_drive, &message, 19, "1380008008002929");
    is_frame(&robstride_drive, &message, 0x028003fd, "800080008000019a");
    message.as.status.fault = 0x4; /* too hot */
    message.as.status.is_on = 0;
    is_frame(&cybergear_drive, &message, 0x020403fd, "800080008000019a");
    message.as.status.fault = 38;
    is_frame(&moteus_drive, &message, 0x0300,
             "2100012f010000000000000000000000"
             "00220e2926505050");
}

static struct drive_message random_message(uint64_t *random, const struct drive_node *node, int kind)
{
    struct drive_message message = { .kind = (uint8_t)kind };
    const double position = node->drive->is_fd ? 4.0 * TURN : node->position_range;
    if (kind == DRIVE_TORQUE) {
        message.as.command.torque = (float)(node->torque_range * (random_in(random, -1.0, 1.0)));
        return message;
    }
    message.as.status.position = (float)(position * (random_in(random, -1.0, 1.0)) / TURN);
    message.as.status.velocity = (float)(node->velocity_range * (random_in(random, -1.0, 1.0)) / TURN);
    message.as.status.torque = (float)(node->torque_range * (random_in(random, -1.0, 1.0)));
    message.as.status.temperature = (float)(random_bits(random) % 100);
    message.as.status.is_on = 1;
    return message;
}

/* The largest error, in steps: of torque, position, and velocity, which has the steps of Damiao's 12 bits at most. */
static double error_of(const struct drive_node *node, const struct drive_message *said,
                       const struct drive_message *heard)
{
    const double torque_step = drive_torque_step(node), position_step = drive_position_step(node);
    const double velocity_step = node->drive->is_fd ? position_step : 2.0 * node->velocity_range / (TURN * 4095.0);
    if (said->kind == DRIVE_TORQUE)
        return fabs((double)heard->as.command.torque - (double)said->as.command.torque) / torque_step;
    return fmax(fabs((double)heard->as.status.torque - (double)said->as.status.torque) / torque_step,
                fmax(fabs((double)heard->as.status.position - (double)said->as.status.position) / position_step,
                     fabs((double)heard->as.status.velocity - (double)said->as.status.velocity) / velocity_step));
}

static void round_trips(void)
{
    uint64_t random = 1;
    for (int d = 0; d < ANSWERING; d++) {
        const struct drive_node node = node_of(answering[d]);
        double worst = 0.0;
        for (int i = 0; i < 20000; i++) {
            const struct drive_message said = random_message(&random, &node, i & 1 ? DRIVE_STATUS : DRIVE_TORQUE);
            struct drive_message heard;
            struct can_message frame;
            CHECK(node.drive->encode(&node, &said, &frame), "%s", node.drive->name);
            CHECK(node.drive->decode(&node, &frame, &heard) == said.kind, "%s: kind %u", node.drive->name, heard.kind);
            worst = fmax(worst, error_of(&node, &said, &heard));
        }
        CHECK(worst <= 0.51, "%s: %g steps", node.drive->name, worst);
    }
}

static void parameters_round_trip(void)
{
    for (int d = 0; d < ANSWERING; d++) {
        const struct drive_node node = node_of(answering[d]);
        for (uint32_t i = 0; i < node.drive->parameter_count; i++) {
            const struct drive_parameter *parameter = &node.drive->parameters[i];
            const double value = parameter->bytes ? 7.0 * parameter->unit : 0.125;
            const struct drive_message said = { .kind = DRIVE_VALUE,
                                                .parameter = parameter->parameter,
                                                .as.value = value };
            struct drive_message heard;
            struct can_message frame;
            CHECK(node.drive->encode(&node, &said, &frame) &&
                      node.drive->decode(&node, &frame, &heard) == DRIVE_VALUE &&
                      heard.parameter == parameter->parameter && fabs(heard.as.value - value) < 1e-9,
                  "%s: parameter %u is %g", node.drive->name, parameter->parameter, heard.as.value);
        }
    }
}

/* Nothing that is not finite is sent; a frame of another motor, or cut short, is not taken for a status. */
static void nonsense_is_refused(void)
{
    for (int d = 0; d < ANSWERING; d++) {
        struct drive_node node = node_of(answering[d]), other = node;
        struct drive_message said = { .kind = DRIVE_TORQUE }, heard;
        struct can_message frame;
        said.as.command.torque = NAN;
        CHECK(!node.drive->encode(&node, &said, &frame), "%s: sends NaN", node.drive->name);
        said.as.command.torque = INFINITY;
        CHECK(!node.drive->encode(&node, &said, &frame), "%s: sends infinity", node.drive->name);
        said = (struct drive_message){ .kind = DRIVE_STATUS };
        CHECK(node.drive->encode(&node, &said, &frame), "%s", node.drive->name);
        other.number = 4;
        other.answer = (uint16_t)(node.answer + node.drive->answer_has_number);
        CHECK(node.drive->decode(&other, &frame, &heard) == DRIVE_OTHER, "%s: takes another's", node.drive->name);
        frame.size = 5;
        CHECK(node.drive->decode(&node, &frame, &heard) != DRIVE_STATUS, "%s: takes a part", node.drive->name);
    }
    const struct drive_node moteus = node_of(&moteus_drive);
    struct drive_message heard;
    const struct can_message not_finite = { .id = 0x300,
                                            .size = 16,
                                            .flags = CAN_MESSAGE_FD,
                                            .data = { 0x21, 0, 10, 0x2e, 1, 0, 0, 0xc0, 0x7f, 0, 0, 0, 0, 0x50, 0x50,
                                                      0x50 } };
    CHECK(moteus_drive.decode(&moteus, &not_finite, &heard) == DRIVE_DAMAGED, "a position that is none: %u",
          heard.kind);
}

static void faults_have_names(void)
{
    CHECK(!strcmp(drive_fault_name(&damiao_drive, 0xc), "COIL_OVER_TEMPERATURE") &&
              drive_reasons(&damiao_drive, 0xc) == 8,
          "Damiao's");
    CHECK(!strcmp(drive_fault_name(&robstride_drive, 0x24), "OVER_TEMPERATURE") &&
              drive_reasons(&robstride_drive, 0x24) == (8 | 32),
          "RobStride's");
    CHECK(!strcmp(drive_fault_name(&moteus_drive, 38), "OVER_TEMPERATURE") && drive_reasons(&moteus_drive, 38) == 8 &&
              !strcmp(drive_fault_name(&moteus_drive, 99), "unknown") && drive_reasons(&moteus_drive, 99) == 512 &&
              !drive_fault_name(&moteus_drive, 0),
          "moteus'");
}

/* ---- for drive_peers.py ---- */

static int write_frames(const struct can_drive *drive, unsigned long count, uint64_t seed)
{
    const struct drive_node node = node_of(drive);
    uint64_t random = seed;
    for (unsigned long i = 0; i < count; i++) {
        const struct drive_message said = random_message(&random, &node, i & 1 ? DRIVE_STATUS : DRIVE_TORQUE);
        struct can_message frame;
        if (!drive->encode(&node, &said, &frame))
            return 1;
        const int is_command = said.kind == DRIVE_TORQUE;
        printf("%c %.9g %.9g %.9g %x %u ", is_command ? 'c' : 's',
               (double)(is_command ? said.as.command.torque : said.as.status.torque),
               is_command ? 0.0 : (double)said.as.status.position, is_command ? 0.0 : (double)said.as.status.velocity,
               frame.id, frame.flags);
        for (int k = 0; k < frame.size; k++)
            printf("%02x", frame.data[k]);
        putchar('\n');
    }
    return 0;
}

static int read_frames(const struct can_drive *drive)
{
    const struct drive_node node = node_of(drive);
    char line[400], bytes[2 * CAN_MESSAGE_BYTES + 1], kind;
    double torque, position, velocity, worst = 0.0;
    unsigned long count = 0, wrong = 0;
    while (fgets(line, sizeof line, stdin)) {
        struct can_message frame = { .size = 0 };
        struct drive_message said = { .kind = DRIVE_TORQUE }, heard;
        unsigned id, flags;
        if (sscanf(line, "%c %lf %lf %lf %x %u %128s", &kind, &torque, &position, &velocity, &id, &flags, bytes) != 7)
            return 2;
        frame.id = id;
        frame.flags = (uint8_t)flags;
        for (const char *at = bytes; at[0] && at[1]; at += 2) {
            const char pair[3] = { at[0], at[1], '\0' };
            frame.data[frame.size++] = (uint8_t)strtoul(pair, NULL, 16);
        }
        if (kind == 's') {
            said.kind = DRIVE_STATUS;
            said.as.status.torque = (float)torque;
            said.as.status.position = (float)position;
            said.as.status.velocity = (float)velocity;
        } else {
            said.as.command.torque = (float)torque;
        }
        if (drive->decode(&node, &frame, &heard) == said.kind)
            worst = fmax(worst, error_of(&node, &said, &heard));
        else
            wrong++;
        count++;
    }
    printf("%lu %lu %.6f\n", count, wrong, worst);
    return 0;
}

int main(int argc, char **argv)
{
    if (argc >= 3 && (!strcmp(argv[1], "write") || !strcmp(argv[1], "read"))) {
        const struct can_drive *drive = drive_find(argv[2], strlen(argv[2]));
        if (!drive || !drive->decode)
            return 2;
        return argv[1][0] == 'r' ? read_frames(drive)
                                 : write_frames(drive, argc > 3 ? strtoul(argv[3], NULL, 10) : 1,
                                                argc > 4 ? strtoull(argv[4], NULL, 10) : 1);
    }
    TEST(bytes_are_as_documented);
    TEST(round_trips);
    TEST(parameters_round_trip);
    TEST(nonsense_is_refused);
    TEST(faults_have_names);
    return check_report();
}
