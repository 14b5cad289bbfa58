/* SPDX-License-Identifier: BSD-3-Clause */
#include "fuzz/calls/guard_model.h"

/* Of a limit, where it is a matter of rounding. */
static const double CLOSE = 1e-9;

static double size_of(const double *v)
{
    const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    const double x = v[0] / most, y = v[1] / most, z = v[2] / most;
    return most == 0.0 ? 0.0 : most * sqrt(x * x + y * y + z * z);
}

int wrench_is_usable(const dpt_wrench *wrench)
{
    int is_finite = 1;
    for (int k = 0; k < 3; k++)
        is_finite &= isfinite(wrench->force[k]) && isfinite(wrench->torque[k]);
    return is_finite;
}

void guard_model_init(struct guard_model *of, const dpt_guard_def *def)
{
    *of = (struct guard_model){
        .is_made = 1, .def = *def, .hold = (uint64_t)(def->hold * 1e9 + 0.5), .stop = (uint64_t)(def->stop * 1e9 + 0.5)
    };
}

static int is_on(const struct guard_model *of)
{
    return of->state == DPT_GUARD_STARTING || of->state == DPT_GUARD_RUNNING;
}

static void go_off(struct guard_model *of)
{
    of->stops += is_on(of) ? 1 : 0;
    of->state = DPT_GUARD_OFF;
    of->gain = 0.0;
    memset(&of->sent, 0, sizeof of->sent);
}

/* v, but no longer than `most`: 1 if it was, 2 if that is a matter of rounding. */
static int shorten(double *v, double most)
{
    const double size = size_of(v), much = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (size <= most)
        return size > most * (1.0 - CLOSE) && size > 0.0 ? 2 : 0;
    for (int k = 0; k < 3; k++)
        v[k] = v[k] / much * (most / (size / much));
    return size < most * (1.0 + CLOSE) ? 2 : 1;
}

static void count(int one, int other, uint64_t *least, uint64_t *most)
{
    *least += one == 1 || other == 1;
    *most += one || other;
}

static void after_silence(struct guard_model *of)
{
    const uint64_t silence = of->now - of->fresh;
    if (is_on(of) && silence > of->hold) {
        of->stops++;
        of->state = DPT_GUARD_STOPPING;
        of->held = of->sent;
        of->stop_gain = of->gain;
    }
    if (of->state != DPT_GUARD_STOPPING)
        return;
    if (silence >= of->hold + of->stop) {
        go_off(of);
        return;
    }
    const double left = (double)(of->hold + of->stop - silence) / (double)of->stop;
    of->gain = of->stop_gain * left;
    for (int k = 0; k < 3; k++) {
        of->sent.force[k] = of->held.force[k] * left;
        of->sent.torque[k] = of->held.torque[k] * left;
    }
}

/* Towards a share of the command, as fast as it may: what shorten says of the change. */
static int approach(double *sent, const double *command, double gain, double slew, double dt)
{
    double change[3];
    for (int k = 0; k < 3; k++)
        change[k] = gain * command[k] - sent[k];
    const double size = size_of(change), noise = 1e-12 * (size_of(command) + size_of(sent));
    int slewed = slew > 0.0 ? shorten(change, slew * dt) : 0;
    if (slew > 0.0 && fabs(size - slew * dt) <= noise)
        slewed = 2;
    for (int k = 0; k < 3; k++)
        sent[k] += change[k];
    return slewed;
}

static void ramp_up(struct guard_model *of, double dt)
{
    of->gain = of->def.start > 0.0 ? of->gain + dt / of->def.start : 1.0;
    if (of->gain < 1.0)
        return;
    of->gain = 1.0;
    of->state = DPT_GUARD_RUNNING;
}

static void take(struct guard_model *of, const dpt_wrench *command)
{
    of->fresh = of->now;
    of->command = *command;
    const int force = shorten(of->command.force, of->def.force_max);
    const int torque = shorten(of->command.torque, of->def.torque_max);
    count(force, torque, &of->clamped, &of->clamped_most);
    met[MET_CLAMPED] += force == 1 || torque == 1;
    if (!is_on(of))
        of->state = DPT_GUARD_STARTING;
}

static void decide(struct guard_model *of, uint64_t now, const dpt_wrench *command, int is_ready)
{
    double dt = 0.0;
    if (now > of->now) {
        dt = (double)(now - of->now) * 1e-9;
        of->now = now;
    }
    after_silence(of);
    if (command && !wrench_is_usable(command)) {
        of->not_finite++;
        is_ready = 0;
    }
    if (!is_ready) {
        go_off(of);
        return;
    }
    /* The ramp has grown by the time since the last step, if it was on its way then. */
    if (of->state == DPT_GUARD_OFF)
        dt = 0.0;
    if (of->state == DPT_GUARD_STARTING)
        ramp_up(of, dt);
    if (command)
        take(of, command);
    if (of->state == DPT_GUARD_STARTING && of->def.start == 0.0)
        ramp_up(of, 0.0);
    if (!is_on(of))
        return;
    const int force = approach(of->sent.force, of->command.force, of->gain, of->def.force_slew, dt);
    const int torque = approach(of->sent.torque, of->command.torque, of->gain, of->def.torque_slew, dt);
    count(force, torque, &of->slewed, &of->slewed_most);
    met[MET_SLEWED] += force == 1 || torque == 1;
}

static void must_be_near(const double *is, const double *expected, double most, const char *what)
{
    for (int k = 0; k < 3; k++)
        HOLDS(fabs(is[k] - expected[k]) <= CLOSE * most + 1e-300, "%s %d is %.17g, and not %.17g", what, k, is[k],
              expected[k]);
}

void guard_model_step(struct guard_model *of, uint64_t now, const dpt_wrench *command, int is_ready,
                      const dpt_wrench *out)
{
    decide(of, now, command, is_ready);
    met[MET_STARTING] += of->state == DPT_GUARD_STARTING;
    met[MET_RUNNING] += of->state == DPT_GUARD_RUNNING;
    met[MET_STOPPING] += of->state == DPT_GUARD_STOPPING;
    if (!out)
        return;
    must_be_near(out->force, of->sent.force, of->def.force_max, "force");
    must_be_near(out->torque, of->sent.torque, of->def.torque_max, "torque");
    of->sent = *out;
}

void guard_model_must_tell(const struct guard_model *of, const dpt_guard_info *info)
{
    HOLDS(info->state == of->state, "state %u, and not %u", info->state, of->state);
    HOLDS(info->stops == of->stops && info->not_finite == of->not_finite,
          "%llu stops, and not %llu; %llu commands that are not finite, and not %llu", (unsigned long long)info->stops,
          (unsigned long long)of->stops, (unsigned long long)info->not_finite, (unsigned long long)of->not_finite);
    HOLDS(info->clamped >= of->clamped && info->clamped <= of->clamped_most, "%llu clamped, and not %llu to %llu",
          (unsigned long long)info->clamped, (unsigned long long)of->clamped, (unsigned long long)of->clamped_most);
    HOLDS(info->slewed >= of->slewed && info->slewed <= of->slewed_most, "%llu slewed, and not %llu to %llu",
          (unsigned long long)info->slewed, (unsigned long long)of->slewed, (unsigned long long)of->slewed_most);
    HOLDS(info->now_ns == of->now && info->fresh_ns == of->fresh, "now %llu, and not %llu; fresh %llu, and not %llu",
          (unsigned long long)info->now_ns, (unsigned long long)of->now, (unsigned long long)info->fresh_ns,
          (unsigned long long)of->fresh);
    HOLDS(info->gain >= 0.0 && info->gain <= 1.0 && fabs(info->gain - of->gain) <= CLOSE, "gain %g, and not %g",
          info->gain, of->gain);
    must_be_near(info->command.force, of->command.force, of->def.force_max, "the command's force");
    must_be_near(info->command.torque, of->command.torque, of->def.torque_max, "the command's torque");
    must_be_near(info->sent.force, of->sent.force, of->def.force_max, "the force sent");
    must_be_near(info->sent.torque, of->sent.torque, of->def.torque_max, "the torque sent");
}
