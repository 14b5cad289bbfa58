/* SPDX-License-Identifier: BSD-3-Clause */
/* Identification of a device (identify.h): the order of the stages, and their results. */
#include "dynpoint/identify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/return_if_error.h"
#include "base/sized.h"
#include "identify_fit.h"
#include "identify_serve.h"
#include "identify_slides.h"
#include "settings.h"
#include "text/parse_number.h"

/* Largest force, N, and torque, Nm, and as a part of the device's. */
static const double BOUND[IDENTIFY_SPACES] = { 0.5, 0.01 }, BOUND_PART = 0.1;

/* Pushes keep within these parts of the limits of speed and displacement. */
static const double SPEED_PART = 0.5, RANGE_PART = 0.6;

static const double BLOCK_TIME = 1.0, RETURN_TIME = 0.8; /* s */

/* Trial pushes: the first are short; the last, with all the force, is long. s */
static const double TRIAL_SHORT = 0.02, TRIAL_LONG = 0.25;
enum { TRIAL_HALVINGS = 5 };

/* It moves if it moves by this part of the range, and by 4 steps. */
static const double MOVES_PART = 0.005;

/* A device that no one touches stays within this, m and rad, and 4 steps, while it rests. */
static const double REST_MAX[IDENTIFY_SPACES] = { 0.3e-3, 5e-3 };

/* Delays up to this are looked for, s and periods. */
static const double DELAY_TIME_MAX = 0.02, DELAY_PERIODS_MAX = 20.0;

void dpt_identify_def_defaults(dpt_identify_def *def, size_t size)
{
    const dpt_identify_def defaults = { .button = DPT_IDENTIFY_NO_BUTTON, .blocks = 8, .seed = 1, .seconds = 1.0 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

const char *dpt_identify_end_text(uint32_t end)
{
    static const char *const texts[] = {
        "complete",
        "stopped",
        "the dead man's button was not held",
        "it moved too fast",
        "it moved too far",
        "samples or commands were lost or late",
        "the device was not ready",
        "the device was lost",
        "the device has no watchdog: nothing would end its force if this program died"
    };
    return end < sizeof texts / sizeof *texts ? texts[end] : "?";
}

static int goes_on(const struct identify_server *server)
{
    return server->result->end == DPT_IDENTIFY_END_COMPLETE;
}

/* ---- at rest ---- */

static void measure_times(const struct identify_store *store, double period, dpt_identify_result *result)
{
    const struct identify_sample *samples = store->samples;
    const uint32_t count = store->sample_count;
    double periods = 0.0, square = 0.0, intervals = 0.0;
    if (count < 10)
        return;
    for (uint32_t n = 1; n < count; n++)
        periods += floor((samples[n].time - samples[n - 1].time) / period + 0.5);
    const double mean = (samples[count - 1].time - samples[0].time) / fmax(periods, 1.0);
    for (uint32_t n = 1; n < count; n++) {
        const double dt = samples[n].time - samples[n - 1].time;
        const double off = dt - mean * floor(dt / mean + 0.5);
        result->jitter_max = fmax(result->jitter_max, fabs(off));
        if (dt < 1.5 * mean) {
            square += (dt - mean) * (dt - mean);
            intervals++;
        }
    }
    if (!(mean > 0.0) || periods < 1.0)
        return;
    result->rate = 1.0 / mean;
    result->jitter = sqrt(square / fmax(intervals, 1.0));
    result->measured |= DPT_IDENTIFIED_RATE;
}

static double step_of(const struct identify_server *server, uint32_t space)
{
    const double reported = space == IDENTIFY_ANGLES ? server->info.angle_step : server->info.position_step;
    const double seen = space == IDENTIFY_ANGLES ? server->result->angle_step : server->result->position_step;
    return fmax(0.0, seen > 0.0 ? seen : reported);
}

static void measure_step(struct identify_server *server, uint32_t space)
{
    const struct identify_store *store = &server->store[space];
    const double step = identify_step(store->samples, store->sample_count);
    if (!(step > 0.0))
        return;
    *(space == IDENTIFY_ANGLES ? &server->result->angle_step : &server->result->position_step) = step;
    server->result->measured |= space == IDENTIFY_ANGLES ? DPT_IDENTIFIED_ANGLE_STEP : DPT_IDENTIFIED_POSITION_STEP;
}

static int moves_at_rest(const struct identify_server *server, uint32_t space)
{
    const struct identify_store *store = &server->store[space];
    const double allowed = fmax(REST_MAX[space], 4.0 * step_of(server, space));
    for (int k = 0; k < 3; k++) {
        double min = 0.0, max = 0.0;
        for (uint32_t n = 0; n < store->sample_count; n++) {
            const double y = store->samples[n].y[k] - store->samples[0].y[k];
            min = fmin(min, y);
            max = fmax(max, y);
        }
        if (max - min > allowed)
            return 1;
    }
    return 0;
}

static dpt_result watch_at_rest(struct identify_server *server)
{
    server->stage = IDENTIFY_REST;
    server->duration = server->def.seconds;
    DPT_TRY(identify_serve(server));
    measure_times(&server->store[IDENTIFY_POSITIONS], 1.0 / server->info.rate, server->result);
    for (uint32_t space = 0; space < server->motion.spaces; space++) {
        measure_step(server, space);
        if (moves_at_rest(server, space))
            server->result->flags |= DPT_IDENTIFY_FLAG_HELD;
    }
    return DPT_OK;
}

/* ---- pushes along an axis ---- */

static dpt_result run_return(struct identify_server *server)
{
    server->stage = IDENTIFY_RETURN;
    server->duration = RETURN_TIME;
    return identify_serve(server);
}

/* The least displacement, m or rad, that counts as motion. */
static double min_motion(const struct identify_server *server)
{
    return fmax(4.0 * step_of(server, server->space), MOVES_PART * server->range[server->space]);
}

static dpt_result run_trial(struct identify_server *server, double level, double push_time)
{
    const double aim = 1.0 / 3.0;
    server->stage = IDENTIFY_TRIAL;
    server->trial = (struct identify_trial){ .level = level,
                                             .push_time = push_time,
                                             .speed = aim * server->speed[server->space],
                                             .range = aim * server->range[server->space],
                                             .min_motion = min_motion(server),
                                             .brake = -1.0,
                                             .rest = -1.0 };
    server->trial.y0 = server->motion.displacement[server->space][server->axis];
    server->duration = 4.0 * push_time + 0.05;
    return identify_serve(server);
}

/*
 * Push ever harder until the device moves well. Returns its strength; a level of 0: all the force does not move it.
 */
static dpt_result find_strength(struct identify_server *server, struct identify_strength *strength)
{
    const double bound = server->bound[server->space], speed = server->speed[server->space];
    const double shortest = fmax(TRIAL_SHORT, 8.0 / server->info.rate);
    const struct identify_trial *trial = &server->trial;
    double level = bound;
    int moves = 0;
    *strength = (struct identify_strength){ .speed = speed, .range = server->range[server->space] };
    for (int i = TRIAL_HALVINGS; i >= -1 && !moves && goes_on(server); i--) {
        const double sign = i % 2 ? 1.0 : -1.0;
        level = bound / (double)(1u << (i > 0 ? i : 0));
        DPT_TRY(run_trial(server, sign * level, i < 0 ? TRIAL_LONG : shortest));
        moves = trial->peak >= min_motion(server) && trial->peak_speed > (i < 0 ? 0.0 : speed / 3.0);
    }
    if (!moves || !goes_on(server)) {
        if (trial->peak > 2.0 * step_of(server, server->space) && trial->peak > 1e-3 * server->range[server->space] &&
            trial->last < 0.5 * trial->peak)
            server->result->flags |= DPT_IDENTIFY_FLAG_HELD;
        return DPT_OK;
    }
    strength->level = level;
    strength->rise = speed * trial->peak_time / trial->peak_speed;
    struct identify_return *back = &server->back[server->space][server->axis];
    back->stiffness = 4.0 * level / strength->range;
    back->damping = 1.4 * sqrt(back->stiffness * level * strength->rise / speed);
    return DPT_OK;
}

static void add_block(struct identify_server *server, uint32_t number, uint32_t first_sample, uint32_t first_command,
                      struct identify_record *record)
{
    const struct identify_store *store = &server->store[server->space];
    record->blocks[record->count++] = (struct identify_block){ .samples = store->samples + first_sample,
                                                               .commands = store->commands + first_command,
                                                               .sample_count = store->sample_count - first_sample,
                                                               .command_count = store->command_count - first_command,
                                                               .axis = server->axis,
                                                               .number = number };
}

static dpt_result push_axis(struct identify_server *server, struct identify_record *record, double *level)
{
    struct identify_strength strength;
    DPT_TRY(run_return(server));
    DPT_TRY(find_strength(server, &strength));
    if (goes_on(server) && !(strength.level > 0.0))
        server->result->flags |=
            server->space == IDENTIFY_ANGLES ? DPT_IDENTIFY_FLAG_TURN_STUCK : DPT_IDENTIFY_FLAG_STUCK;
    *level = fmax(*level, strength.level);
    for (uint32_t number = 0; number < server->def.blocks && strength.level > 0.0 && goes_on(server); number++) {
        const struct identify_store *store = &server->store[server->space];
        const uint32_t first_sample = store->sample_count, first_command = store->command_count;
        DPT_TRY(run_return(server));
        server->stage = IDENTIFY_BLOCK;
        server->duration = BLOCK_TIME;
        server->pushes =
            (struct identify_pushes){ .strength = strength,
                                      .dwell_min = fmax(0.008, 6.0 / server->info.rate),
                                      .random = server->def.seed * 0x9e3779b97f4a7c15u +
                                                (((uint64_t)server->space * 3 + server->axis) << 32 | number) };
        if (!goes_on(server))
            break;
        DPT_TRY(identify_serve(server));
        add_block(server, number, first_sample, first_command, record);
    }
    return DPT_OK;
}

/* ---- a space ---- */

static void take_positions(dpt_identify_result *result, const struct identify_fit *fit)
{
    result->mass = fit->mass;
    result->damping = fit->damping;
    result->friction = fit->friction;
    result->delay = fit->delay;
    result->stiffness = fit->stiffness.value;
    memcpy(result->mass_matrix, fit->mass_matrix, sizeof fit->mass_matrix);
    memcpy(result->damping_matrix, fit->damping_matrix, sizeof fit->damping_matrix);
    memcpy(result->mass_direction, fit->mass_direction, sizeof fit->mass_direction);
    memcpy(result->damping_direction, fit->damping_direction, sizeof fit->damping_direction);
    result->measured |= DPT_IDENTIFIED_MASS | DPT_IDENTIFIED_DAMPING | DPT_IDENTIFIED_FRICTION | DPT_IDENTIFIED_DELAY;
}

static void take_angles(dpt_identify_result *result, const struct identify_fit *fit)
{
    result->inertia = fit->mass;
    result->spin_damping = fit->damping;
    result->spin_friction = fit->friction;
    result->turn_stiffness = fit->stiffness.value;
    memcpy(result->inertia_matrix, fit->mass_matrix, sizeof fit->mass_matrix);
    memcpy(result->spin_damping_matrix, fit->damping_matrix, sizeof fit->damping_matrix);
    memcpy(result->inertia_direction, fit->mass_direction, sizeof fit->mass_direction);
    memcpy(result->spin_damping_direction, fit->damping_direction, sizeof fit->damping_direction);
    result->measured |= DPT_IDENTIFIED_INERTIA | DPT_IDENTIFIED_SPIN_DAMPING | DPT_IDENTIFIED_SPIN_FRICTION;
}

static dpt_result push_space(struct identify_server *server, uint32_t space, struct identify_record *record)
{
    const double period = 1.0 / server->info.rate;
    const uint32_t stuck = space == IDENTIFY_ANGLES ? DPT_IDENTIFY_FLAG_TURN_STUCK : DPT_IDENTIFY_FLAG_STUCK;
    struct identify_fit_def def = { .period = period,
                                    .speed = server->speed[space],
                                    .range = server->range[space],
                                    .delay_max = fmax(DELAY_TIME_MAX, DELAY_PERIODS_MAX * period) };
    struct identify_fit fit;
    record->count = 0;
    record->numbers = server->def.blocks;
    server->space = space;
    for (server->axis = 0; server->axis < 3 && goes_on(server) && !(server->result->flags & stuck); server->axis++)
        DPT_TRY(push_axis(server, record, &def.force));
    server->axis = 2;
    if (goes_on(server))
        DPT_TRY(run_return(server));
    measure_step(server, space);
    if (!goes_on(server) || server->result->flags & stuck)
        return DPT_OK;
    def.step = step_of(server, space);
    const dpt_result result = identify_fit(record, &def, &fit);
    if (result == DPT_E_EMPTY) {
        server->result->flags |= stuck;
        return DPT_OK;
    }
    DPT_TRY(result);
    if (fit.is_held)
        server->result->flags |= DPT_IDENTIFY_FLAG_HELD;
    (space == IDENTIFY_ANGLES ? take_angles : take_positions)(server->result, &fit);
    return DPT_OK;
}

static int may_push(struct identify_server *server)
{
    const uint32_t pretended = DPT_DEVICE_FLAG_SIMULATED | DPT_DEVICE_FLAG_DETERMINISTIC;
    if (!goes_on(server) || !server->def.may_move || !(server->bound[IDENTIFY_POSITIONS] > 0.0))
        return 0;
    if (!(server->info.watchdog > 0.0) && (server->info.flags & pretended) != pretended)
        server->result->end = DPT_IDENTIFY_END_NO_WATCHDOG;
    return goes_on(server);
}

static dpt_result measure(struct identify_server *server, struct identify_record *record)
{
    DPT_TRY(watch_at_rest(server));
    if (!may_push(server))
        return DPT_OK;
    DPT_TRY(push_space(server, IDENTIFY_POSITIONS, record));
    if (goes_on(server) && server->bound[IDENTIFY_ANGLES] > 0.0)
        DPT_TRY(push_space(server, IDENTIFY_ANGLES, record));
    return DPT_OK;
}

/* ---- the call ---- */

static int is_within(double value, double min, double max)
{
    return value >= min && value <= max;
}

static dpt_result read_def(const dpt_identify_def *given, dpt_identify_def *def)
{
    dpt_identify_def_init(def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *def, def, sizeof *def));
    return def->may_move <= 1 && (def->button < 32 || def->button == DPT_IDENTIFY_NO_BUTTON) && def->blocks >= 4 &&
                   def->blocks <= IDENTIFY_BLOCKS_MAX && is_within(def->seconds, 0.1, 60.0)
               ? DPT_OK
               : DPT_E_ARGUMENT;
}

static void set_limits(struct identify_server *server)
{
    const dpt_device_info *info = &server->info;
    const double strongest[IDENTIFY_SPACES] = { info->wrench_dofs >= 3 ? info->force_max : 0.0,
                                                info->wrench_dofs == 6 && info->pose_dofs == 6 ? info->torque_max
                                                                                               : 0.0 };
    for (int space = 0; space < IDENTIFY_SPACES; space++) {
        server->bound[space] = fmax(0.0, fmin(BOUND[space], BOUND_PART * strongest[space]));
        server->speed[space] = SPEED_PART * identify_speed_max[space];
        server->range[space] = RANGE_PART * identify_displacement_max[space];
    }
    const double spaces = (server->bound[0] > 0.0) + (server->bound[1] > 0.0);
    const double axis = 1.5 + (double)server->def.blocks * (BLOCK_TIME + RETURN_TIME);
    server->planned = server->def.seconds + (server->def.may_move ? 3.0 * spaces * axis : 0.0);
}

static dpt_result allocate(struct identify_server *server)
{
    const double block = BLOCK_TIME * 1.25 * server->info.rate + 50.0;
    const double samples = 1.25 * server->def.seconds * server->info.rate + 50.0 +
                           (server->def.may_move ? 3.0 * (double)server->def.blocks * block : 0.0);
    for (uint32_t space = 0; space < server->motion.spaces; space++) {
        struct identify_store *store = &server->store[space];
        store->capacity = (uint32_t)fmin(samples, 1e9);
        store->samples = malloc(store->capacity * sizeof *store->samples);
        store->commands = malloc(store->capacity * sizeof *store->commands);
        if (!store->samples || !store->commands)
            return DPT_E_MEMORY;
        /* Pages that are first touched in a tick would make it late. */
        memset(store->samples, 0, store->capacity * sizeof *store->samples);
        memset(store->commands, 0, store->capacity * sizeof *store->commands);
    }
    return DPT_OK;
}

static dpt_result identify(struct identify_server *server)
{
    struct identify_record *record = malloc(sizeof *record);
    dpt_result result = record ? allocate(server) : DPT_E_MEMORY;
    if (result == DPT_OK)
        result = measure(server, record);
    for (int space = 0; space < IDENTIFY_SPACES; space++) {
        free(server->store[space].samples);
        free(server->store[space].commands);
    }
    free(record);
    return result;
}

dpt_result dpt_device_identify(dpt_device *device, const dpt_identify_def *given, dpt_identify_result *out)
{
    dpt_identify_result result = { .size = sizeof result };
    dpt_identify_def def;
    if (!device || !out)
        return DPT_E_ARGUMENT;
    DPT_TRY(sized_check(out, sizeof *out, 0));
    DPT_TRY(read_def(given, &def));
    struct identify_server *server = calloc(1, sizeof *server);
    if (!server)
        return DPT_E_MEMORY;
    server->device = device;
    server->def = def;
    server->result = &result;
    server->info.size = sizeof server->info;
    dpt_device_get_info(device, &server->info);
    dpt_result code = DPT_E_ARGUMENT;
    if (server->info.rate >= 1.0 && server->info.rate <= 1e5) {
        set_limits(server);
        identify_motion_init(&server->motion, &server->info);
        code = identify(server);
    }
    result.force_bound = server->bound[IDENTIFY_POSITIONS];
    result.torque_bound = server->bound[IDENTIFY_ANGLES];
    result.speed_max = server->motion.fastest[IDENTIFY_POSITIONS];
    result.displacement_max = server->motion.furthest[IDENTIFY_POSITIONS];
    result.pose = server->motion.start;
    free(server);
    sized_write(out, out->size, &result, sizeof result);
    return code;
}

/* ---- a file of the dynamics ---- */

/* Device dynamics from a file: lines "name=value" (identify.h). */

/* The values of one name: itself, and the ends of its interval. */
enum { VALUE, LOW, HIGH, KINDS };

struct dynamics_file {
    const char *path;
    struct dynamics dynamics;
    struct setting settings[DYNAMICS_SETTINGS];
    double value[DYNAMICS_SETTINGS][KINDS];
    int is_set[DYNAMICS_SETTINGS][KINDS];
};

static dpt_result complain(const struct settings_line *line, dpt_device_error *error, const char *what, size_t length,
                           const char *reason)
{
    return device_error(error, DPT_E_SYNTAX, "%.100s: line %d: '%.*s' %s", line->path, line->number,
                        (int)(length < 40 ? length : 40), what, reason);
}

/* The setting of a name that may end in _low or _high; -1: none. */
static int find_name(const struct dynamics_file *file, const char *name, size_t length, int *kind)
{
    static const char *const ends[KINDS] = { "", "_low", "_high" };
    for (int i = 0; i < DYNAMICS_SETTINGS; i++)
        for (*kind = 0; *kind < KINDS; ++*kind) {
            const size_t own = strlen(file->settings[i].name), more = strlen(ends[*kind]);
            if (length == own + more && !memcmp(name, file->settings[i].name, own) &&
                !memcmp(name + own, ends[*kind], more))
                return i;
        }
    return -1;
}

static dpt_result take_line(void *user, const struct settings_line *line, dpt_device_error *error)
{
    struct dynamics_file *file = user;
    const char *text = line->text;
    const size_t length = (size_t)(line->end - text);
    const size_t name = line->equals ? (size_t)(line->equals - text) : length;
    int kind;
    double number;
    if (!line->equals)
        return complain(line, error, text, length, "is not name=value");
    const int i = find_name(file, text, name, &kind);
    if (i < 0)
        return complain(line, error, text, name, "is no name of a value");
    if (file->is_set[i][kind])
        return complain(line, error, text, name, "comes twice");
    if (parse_double(line->equals + 1, line->end, &number) != line->end)
        return complain(line, error, line->equals + 1, length - name - 1, "is not a number");
    if (!(number >= file->settings[i].min && (kind != VALUE || number <= file->settings[i].max)))
        return complain(line, error, text, length, "is out of range");
    file->is_set[i][kind] = 1;
    file->value[i][kind] = number;
    return DPT_OK;
}

/* The ends of an interval must have their value between them. */
static dpt_result check_intervals(const struct dynamics_file *file, dpt_device_error *error)
{
    for (int i = 0; i < DYNAMICS_SETTINGS; i++) {
        const double *value = file->value[i];
        const int *is_set = file->is_set[i];
        if (((is_set[LOW] || is_set[HIGH]) && !is_set[VALUE]) || (is_set[LOW] && value[LOW] > value[VALUE]) ||
            (is_set[HIGH] && value[HIGH] < value[VALUE]))
            return device_error(error, DPT_E_SYNTAX, "%.100s: %s is not within its interval", file->path,
                                file->settings[i].name);
    }
    return DPT_OK;
}

static void replace(const struct dynamics_file *file, dpt_device_info *info)
{
    double *const fields[DYNAMICS_SETTINGS] = { &info->mass,         &info->inertia,       &info->damping,
                                                &info->spin_damping, &info->friction,      &info->spin_friction,
                                                &info->delay,        &info->position_step, &info->angle_step };
    for (int i = 0; i < DYNAMICS_SETTINGS; i++)
        if (file->is_set[i][VALUE])
            *fields[i] = file->value[i][VALUE];
}

static dpt_result read_file(const char *path, dpt_device_info *info, dpt_device_error *error)
{
    dpt_device_info own = { .size = sizeof own };
    struct dynamics_file file = { .path = path };
    if (!path || !info)
        return device_error(error, DPT_E_ARGUMENT, "there is no file, or no info");
    DPT_TRY(sized_read(info, sizeof own, &own, sizeof own));
    dynamics_settings(&file.dynamics, file.settings);
    DPT_TRY(settings_file_read(path, take_line, &file, error));
    DPT_TRY(check_intervals(&file, error));
    replace(&file, &own);
    sized_write(info, info->size, &own, sizeof own);
    return DPT_OK;
}

dpt_result dpt_device_dynamics_read(const char *path, dpt_device_info *info, dpt_device_error *error)
{
    dpt_device_error own = { .size = sizeof own };
    if (error)
        DPT_TRY(sized_check(error, sizeof *error, 0));
    own.code = read_file(path, info, &own);
    if (own.code != DPT_OK && !own.text[0])
        device_error(&own, own.code, "%s", dpt_result_text(own.code));
    if (error)
        sized_write(error, error->size, &own, sizeof own);
    return own.code;
}
