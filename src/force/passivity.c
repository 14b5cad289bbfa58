/* SPDX-License-Identifier: BSD-3-Clause */
/* The passivity observer and controller (passivity.h): docs/algorithms/passivity.md. */
#include "dynpoint/passivity.h"

#include "base/frame.h"
#include "base/quaternion.h"
#include "base/return_if_error.h"
#include "base/sized.h"
#include "base/wrench_limit.h"

/* The share of the device's damping that is credited. */
#define CREDITED 0.8

/* s: how long a speed is expected again. */
#define SPEED_MEMORY 0.02

/* Beyond these, sums would not stay finite. */
#define TIME_MIN   1e-9
#define NUMBER_MAX 1e9

/* J: an account that is so little below zero is empty. */
#define EMPTY 1e-9

/* Samples. */
enum { DELAY_MAX = 7 };

/* The content of a dpt_passivity, copied out of and back into its opaque bytes, which are an object of another type. */
struct observer {
    uint64_t mark; /* OBSERVER_MARK once it is initialised */
    dpt_passivity_def def;
    dpt_passivity_info info;
    dpt_pose pose;
    /* Sent, the newest first, and how long ago the newer of the two samples around it was taken, s. */
    dpt_wrench sent[DELAY_MAX + 1];
    double age[DELAY_MAX + 1];
    dpt_wrench withheld; /* asked for less allowed, in the last step */
    double speed, spin;  /* m/s, rad/s: expected at most */
    uint64_t has_pose;
};

typedef char observer_fits[sizeof(struct observer) <= sizeof((dpt_passivity *)0)->opaque ? 1 : -1];

static const uint64_t OBSERVER_MARK = 0x7061737369766974u;

static int load(const dpt_passivity *from, struct observer *observer)
{
    if (!from || sized_check(from, sizeof *from, 0) != DPT_OK)
        return 0;
    memcpy(observer, from->opaque, sizeof *observer);
    return observer->mark == OBSERVER_MARK;
}

void dpt_passivity_def_defaults(dpt_passivity_def *def, size_t size)
{
    const dpt_passivity_def defaults = { .force_max = 5.0,
                                         .torque_max = 0.2,
                                         .force_slew = 2000.0,
                                         .torque_slew = 80.0,
                                         .reserve = 0.01,
                                         .body_power = 1.0 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static int in_range(double value, double max)
{
    return value >= 0.0 && value <= max;
}

static int def_is_valid(const dpt_passivity_def *def)
{
    return def->observe_only <= 1 && in_range(def->damping, 1e6) && in_range(def->spin_damping, 1e6) &&
           in_range(def->force_max, 1e3) && in_range(def->torque_max, 1e3) && in_range(def->force_slew, DBL_MAX) &&
           in_range(def->torque_slew, DBL_MAX) && in_range(def->delay, 10.0) && in_range(def->reserve, 1.0) &&
           in_range(def->body_power, 1e3);
}

dpt_result dpt_passivity_init(dpt_passivity *to, const dpt_passivity_def *given)
{
    struct observer observer;
    if (!to)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(to, sizeof *to, 0));
    const uint32_t size = to->size;
    memset(to, 0, size);
    to->size = size;
    memset(&observer, 0, sizeof observer);
    dpt_passivity_def_init(&observer.def);
    observer.info.size = sizeof observer.info;
    if (given)
        DPT_TRY(sized_read(given, sizeof *given, &observer.def, sizeof observer.def));
    if (!def_is_valid(&observer.def))
        return DPT_E_ARGUMENT;
    observer.mark = OBSERVER_MARK;
    memcpy(to->opaque, &observer, sizeof observer);
    return DPT_OK;
}

dpt_result dpt_passivity_get_info(const dpt_passivity *from, dpt_passivity_info *info)
{
    struct observer observer;
    dpt_passivity_info own = { .size = sizeof own };
    if (!info)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(info, sizeof *info, 0));
    const int is_made = load(from, &observer);
    if (is_made)
        own = observer.info;
    sized_write(info, info->size, &own, sizeof own);
    return is_made ? DPT_OK : DPT_E_ARGUMENT;
}

/* What the device did between two samples. */
struct motion {
    vec3 shift, turn; /* m, and a rotation vector, rad */
};

static struct motion motion_between(const dpt_pose *from, const dpt_pose *to)
{
    const struct quaternion turn =
        quaternion_product(quaternion_of(to->orientation), quaternion_inverse(quaternion_of(from->orientation)));
    return (struct motion){ sub(vec3_of(to->position), vec3_of(from->position)), quaternion_rotation_vector(turn) };
}

/* J, that the wrench gives. */
static double work_of(const dpt_wrench *wrench, const struct motion *motion)
{
    return dot(vec3_of(wrench->force), motion->shift) + dot(vec3_of(wrench->torque), motion->turn);
}

/* Note the newest wrench; returns how many later ones are under way behind the one that acted in the last sample. */
static int note_sent(struct observer *observer, const dpt_wrench *sent, double dt)
{
    int under_way = 0;
    memmove(observer->sent + 1, observer->sent, DELAY_MAX * sizeof *observer->sent);
    memmove(observer->age + 1, observer->age, DELAY_MAX * sizeof *observer->age);
    observer->sent[0] = *sent;
    observer->age[0] = -dt;
    for (int i = 0; i <= DELAY_MAX; i++)
        observer->age[i] += dt;
    while (under_way < DELAY_MAX && observer->age[under_way] + 0.5 * dt < observer->def.delay)
        under_way++;
    return under_way;
}

/* The most work, J, that a wrench does in `time` at the expected speeds. */
static double work_expected(const struct observer *observer, const dpt_wrench *wrench, double time)
{
    return (length(vec3_of(wrench->force)) * observer->speed + length(vec3_of(wrench->torque)) * observer->spin) * time;
}

/* What cannot be prevented any more: wrenches under way, and the guard's ramp from the newest to zero, J. */
static double work_committed(const struct observer *observer, int under_way, double dt)
{
    const dpt_passivity_def *def = &observer->def;
    const double force = length(vec3_of(observer->sent[0].force));
    const double torque = length(vec3_of(observer->sent[0].torque));
    double sum = 0.0;
    for (int i = 0; i < under_way; i++)
        sum += work_expected(observer, &observer->sent[i], dt);
    if (def->force_slew > 0.0)
        sum += 0.5 * force * force / def->force_slew * observer->speed;
    if (def->torque_slew > 0.0)
        sum += 0.5 * torque * torque / def->torque_slew * observer->spin;
    return sum;
}

/*
 * Book what happened since the last sample. Bodies that draw back take no more than there is: what they did to the tool
 * has gone from the law's energy already.
 */
static void book(struct observer *observer, const dpt_passivity_sample *sample, const struct motion *motion,
                 const dpt_wrench *acting)
{
    const dpt_passivity_def *def = &observer->def;
    dpt_passivity_info *info = &observer->info;
    const double shift = length(motion->shift), turn = length(motion->turn), dt = sample->dt;
    const double damped = CREDITED * (def->damping * shift * shift + def->spin_damping * turn * turn) / dt;
    const double body_work = max_of(min_of(sample->body_work, def->body_power * dt), -max_of(0.0, info->account));
    info->damped += damped;
    info->body_work += body_work;
    info->taken += work_of(&observer->withheld, motion);
    info->eps = max_of(info->eps, def->force_max * shift + def->torque_max * turn);
    info->account += damped + body_work - work_of(acting, motion);
    info->account_min = min_of(info->account_min, info->account);
    info->account = min_of(info->account, max_of(0.0, sample->energy) + def->reserve);
    const double kept = max_of(0.0, 1.0 - dt / SPEED_MEMORY);
    observer->speed = max_of(shift / dt, kept * observer->speed);
    observer->spin = max_of(turn / dt, kept * observer->spin);
}

/* Whether the wrench that is asked for may go on. */
static int is_allowed(const struct observer *observer, const dpt_wrench *asked, const struct motion *motion,
                      double committed)
{
    const double account = observer->info.account;
    if (account < -observer->info.eps)
        return 0;
    return account >= committed - EMPTY || work_of(asked, motion) <= 0.0;
}

static int wrench_is_usable(const dpt_wrench *wrench)
{
    return vec3_within(wrench->force, NUMBER_MAX) && vec3_within(wrench->torque, NUMBER_MAX);
}

static dpt_result check_sample(const dpt_passivity_sample *sample)
{
    struct frame ignored;
    if (!(sample->dt >= TIME_MIN && sample->dt <= 1e6) || sample->reserved)
        return DPT_E_ARGUMENT;
    if (!within(sample->energy, NUMBER_MAX) || !within(sample->body_work, NUMBER_MAX) ||
        !wrench_is_usable(&sample->sent))
        return DPT_E_FINITE;
    return frame_of_pose(&sample->pose, &ignored);
}

static void step(struct observer *observer, const dpt_passivity_sample *sample, dpt_wrench *wrench)
{
    static const dpt_wrench zero = { { 0.0 }, { 0.0 } };
    const dpt_pose from = observer->has_pose ? observer->pose : sample->pose;
    const struct motion motion = motion_between(&from, &sample->pose);
    const int under_way = note_sent(observer, &sample->sent, sample->dt);
    book(observer, sample, &motion, &observer->sent[under_way]);
    observer->pose = sample->pose;
    observer->has_pose = 1;
    observer->info.steps++;
    observer->withheld = zero;
    if (observer->def.observe_only ||
        is_allowed(observer, wrench, &motion, work_committed(observer, under_way, sample->dt)))
        return;
    observer->withheld = *wrench;
    observer->info.acted += wrench_is_zero(wrench) ? 0u : 1u;
    *wrench = zero;
}

dpt_result dpt_passivity_step(dpt_passivity *at, const dpt_passivity_sample *given, dpt_wrench *wrench)
{
    struct observer observer;
    dpt_passivity_sample sample = { .size = sizeof sample };
    const dpt_wrench asked = wrench ? *wrench : (dpt_wrench){ { 0.0 }, { 0.0 } };
    if (wrench)
        memset(wrench, 0, sizeof *wrench);
    if (!wrench || !given || !load(at, &observer))
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_read(given, sizeof sample, &sample, sizeof sample));
    DPT_TRY(check_sample(&sample));
    if (!wrench_is_usable(&asked))
        return DPT_E_FINITE;
    *wrench = asked;
    step(&observer, &sample, wrench);
    memcpy(at->opaque, &observer, sizeof observer);
    return DPT_OK;
}
