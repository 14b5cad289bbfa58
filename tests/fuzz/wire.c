/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The protocol of serial devices. The bytes come over the line as they are; then as bodies that are framed well, so that
 * nonsense gets past the checksum: a byte is the length of what follows, 255 lets a device take a sample. What is read is
 * the very bytes that would be sent; a device stays within its limits, gives force only when it is ready, and says
 * nothing that is no frame.
 */
#include "serial/wire_device.h"

#include <math.h>
#include <string.h>

#include "drivers/wire_frame.h"
#include "fuzz/target.h"

struct line {
    struct wire_reader reader;
    struct wire_device device;
    uint8_t frame[512];
    size_t size;
    int messages;
};

static void check_device(const struct wire_device *device)
{
    double force = 0.0, torque = 0.0;
    for (int i = 0; i < 3; i++) {
        force += (double)device->force[i] * (double)device->force[i];
        torque += (double)device->torque[i] * (double)device->torque[i];
    }
    MUST(sqrt(force) <= 5.0 * 1.000001 && sqrt(torque) <= 0.1 * 1.000001);
    MUST(wire_device_status(device) == WIRE_STATUS_READY || (force == 0.0 && torque == 0.0));
    MUST(device->samples_since_command <= device->watchdog_samples);
}

static void feed(struct line *line, uint8_t byte)
{
    struct wire_message message;
    uint8_t again[WIRE_FRAME_MAX];
    if (line->size < sizeof line->frame)
        line->frame[line->size++] = byte;
    const int result = wire_read(&line->reader, byte, &message);
    wire_device_take(&line->device, byte);
    check_device(&line->device);
    MUST(result == WIRE_MORE || byte == 0);
    if (result == WIRE_MESSAGE) {
        MUST(wire_encode(&message, again) == line->size && !memcmp(again, line->frame, line->size));
        line->messages++;
    }
    if (byte == 0)
        line->size = 0;
}

static void sample(struct line *line, uint8_t causes)
{
    struct wire_reader host = { 0 };
    struct wire_message message;
    struct wire_sample measured = { .causes = causes & 127, .orientation = { 1, 0, 0, 0 } };
    uint8_t out[WIRE_OUT_MAX];
    const size_t size = wire_device_sample(&line->device, &measured, out);
    MUST(size <= sizeof out);
    for (size_t i = 0; i < size; i++)
        wire_read(&host, out[i], &message);
    MUST(host.damaged == 0 && host.foreign == 0 && host.count == 0);
    MUST((size > 0) == (host.messages > 0));
    check_device(&line->device);
}

FUZZ_TARGET(wire)
{
    static const struct wire_info info = {
        .pose_dofs = 6, .wrench_dofs = 6, .rate = 1000, .force_max = 5, .torque_max = 0.1f, .watchdog = 0.002f
    };
    struct line line = { .size = 0 };
    wire_device_init(&line.device, &info);
    for (size_t i = 0; i < size; i++)
        feed(&line, bytes[i]);
    feed(&line, 0);
    for (size_t i = 0; i < size;) {
        uint8_t frame[256 + 7];
        const uint8_t length = bytes[i++];
        if (length == 255) {
            sample(&line, i < size ? bytes[i++] : 0);
            continue;
        }
        const size_t left = size - i, taken = length < left ? length : left;
        const size_t count = frame_of(bytes + i, taken < 253 ? taken : 253, frame);
        for (size_t k = 0; k < count; k++)
            feed(&line, frame[k]);
        i += taken;
    }
    fuzz_accepted += line.messages > 0;
    return 0;
}
