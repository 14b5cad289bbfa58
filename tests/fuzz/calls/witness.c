/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/witness.h"

struct witness witness;

static const dpt_wrench zero;

/* `where` is the name of the device that is passed on. */
static dpt_result witness_open(const dpt_driver *driver, const char *where, dpt_device **device,
                               dpt_device_error *error)
{
    (void)driver;
    memset(&witness, 0, sizeof witness);
    witness.state.size = sizeof witness.state;
    *device = &witness.device;
    return dpt_device_open(where, &witness.inner, error);
}

static void witness_info(const dpt_device *device, dpt_device_info *info)
{
    (void)device;
    dpt_device_get_info(witness.inner, info);
}

/* A device that is not ready, or is lost, gives no force: from the sample on that says so. */
static void nothing_acts(void)
{
    witness.acts = zero;
    witness.acts_ns = 0;
}

/* Nobody saw the last sample before the next call. */
static void not_shown(void)
{
    witness.unseen += witness.is_to_be_seen ? 1 : 0;
    witness.is_to_be_seen = 0;
}

static void be_clumsy(dpt_device_state *state)
{
    switch (draw_below(24)) {
    case 0:
        state->fresh = 0;
        break;
    case 1:
        state->sequence -= state->sequence < 2 ? 0 : 2;
        break;
    case 2:
        state->pose.orientation[0] *= 1.01;
        break;
    case 3:
        state->pose.position[1] = 2.0 * DPT_COORDINATE_MAX;
        break;
    default:
        break;
    }
}

static dpt_result witness_read(dpt_device *device, dpt_device_state *state)
{
    struct codes of_pose = { .count = 0 };
    (void)device;
    if (witness.reads && witness.state.status != DPT_DEVICE_STATUS_READY)
        nothing_acts();
    not_shown();
    witness.reads++;
    witness.read = dpt_device_read(witness.inner, state);
    if (witness.is_clumsy && witness.read == DPT_OK)
        be_clumsy(state);
    witness.state = *state;
    if (witness.read == DPT_E_LOST) {
        witness.lost++;
        witness.has_sequence = witness.has_ticked = 0;
        nothing_acts();
        return witness.read;
    }
    const int is_new = state->fresh && !(witness.has_sequence && state->sequence <= witness.sequence);
    if (is_new) {
        witness.has_sequence = 1;
        witness.sequence = state->sequence;
    }
    pose_codes(&state->pose, &of_pose);
    witness.is_to_be_seen = is_new && !of_pose.count;
    return witness.read;
}

static double size_of(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static dpt_result pass_on(const dpt_wrench *wrench)
{
    if (witness.is_deaf && !memcmp(wrench, &zero, sizeof zero))
        return DPT_E_BUSY;
    if (witness.is_clumsy && draw_one_in(6))
        return draw_one_in(2) ? DPT_E_BUSY : DPT_E_DEVICE;
    return dpt_device_write(witness.inner, wrench);
}

static dpt_result witness_write(dpt_device *device, const dpt_wrench *wrench)
{
    (void)device;
    numbers_are_finite(wrench->force, 6, "what a loop sends");
    HOLDS(size_of(wrench->force) <= witness.force_max && size_of(wrench->torque) <= witness.torque_max,
          "%.17g N of %.17g, %.17g Nm of %.17g", size_of(wrench->force), witness.force_max, size_of(wrench->torque),
          witness.torque_max);
    HOLDS(!memcmp(wrench, &zero, sizeof zero) || witness.state.status == DPT_DEVICE_STATUS_READY,
          "a force for a device that is not ready");
    not_shown();
    const dpt_result result = pass_on(wrench);
    witness.writes++;
    witness.last = *wrench;
    witness.last_result = result;
    met[MET_DROPPED] += result == DPT_E_BUSY;
    if (result == DPT_OK) {
        witness.written++;
        witness.taken++;
        witness.acts = *wrench;
        witness.acts_ns = witness.state.time_ns;
    } else if (result == DPT_E_NOT_READY || result == DPT_E_LOST) {
        nothing_acts();
    }
    return result;
}

static dpt_result witness_clear(dpt_device *device)
{
    (void)device;
    return dpt_device_clear(witness.inner);
}

static void witness_counts(const dpt_device *device, dpt_device_counts *counts)
{
    (void)device;
    dpt_device_get_counts(witness.inner, counts);
}

static void witness_close(dpt_device *device)
{
    (void)device;
    dpt_device_close(witness.inner);
    witness.inner = NULL;
}

const dpt_driver witness_driver = { .size = sizeof witness_driver,
                                    .version = DPT_DRIVER_VERSION,
                                    .name = "witness",
                                    .about = "passes another device on",
                                    .open = witness_open,
                                    .info = witness_info,
                                    .read = witness_read,
                                    .write = witness_write,
                                    .clear = witness_clear,
                                    .counts = witness_counts,
                                    .close = witness_close };
