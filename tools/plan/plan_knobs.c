/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_knobs.h"

#include <inttypes.h>
#include <math.h>

#include "scene/setting_words.h"

/* From one budget to the next cheaper one: the square root of a half. */
#define BUDGET_STEP 0.70710678118654752

/* Less memory for certificates than this is none. */
#define CERTIFICATES_LEAST 16384

/* Units of a step's sweeps with which hardly one comes to its end. */
#define SWEEPS_LEAST 64

/* Iterations of an implicit step where neither the setting nor the scene says how many. */
#define ITERATIONS_USUAL 2

uint32_t plan_times(double seen, double factor)
{
    return (uint32_t)fmin(ceil(factor * seen), (double)UINT32_MAX);
}

static int is_soft(const struct measure_setting *setting, const struct scene *scene, uint32_t body)
{
    return scene_body_is_soft(&scene->bodies.body[body]) && !(setting->rigid >> body & 1);
}

int plan_gives_way(const struct measure_setting *setting, const struct scene *scene)
{
    int gives_way = 0;
    for (uint32_t i = 0; i < scene->bodies.count; i++)
        gives_way |= is_soft(setting, scene, i);
    return gives_way;
}

uint32_t plan_capacity(double seen, const struct measure_setting *setting, const struct scene *scene)
{
    return plan_times(seen, plan_gives_way(setting, scene) ? PLAN_SOFT_HEADROOM : PLAN_HEADROOM);
}

/* Contacts are told on the way to a force; nobody asked for them alone. */
static int reduce_until(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                        const struct plan_figures *seen)
{
    const int may_less = setting->world.until == DPT_UNTIL_RESPOND && !scene->tips.count;
    (void)body, (void)seen;
    setting->world.until = DPT_UNTIL_TRACK;
    return may_less;
}

static void print_until(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                        size_t room)
{
    (void)scene, (void)body;
    snprintf(text, room, "%s", until_words[setting->world.until]);
}

static int reduce_rigid(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                        const struct plan_figures *seen)
{
    (void)seen;
    if (!is_soft(setting, scene, body))
        return 0;
    setting->rigid |= (uint64_t)1 << body;
    return 1;
}

static void print_rigid(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                        size_t room)
{
    snprintf(text, room, "%s", is_soft(setting, scene, body) ? "gives way" : "rigid");
}

static uint32_t integrator_of(const struct measure_setting *setting, const struct scene_body *body)
{
    return setting->integrator >= 0 ? (uint32_t)setting->integrator : body->integrator;
}

/* The most iterations of a body that is stepped implicitly; 0: none is. */
static uint32_t iterations_of(const struct measure_setting *setting, const struct scene *scene)
{
    uint32_t max = 0;
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        const struct scene_body *body = &scene->bodies.body[i];
        if (!is_soft(setting, scene, i) || integrator_of(setting, body) != DPT_INTEGRATOR_IMPLICIT)
            continue;
        const uint32_t count = setting->iterations ? setting->iterations
                               : body->iterations  ? body->iterations
                                                   : ITERATIONS_USUAL;
        max = count > max ? count : max;
    }
    return max;
}

static int reduce_integrator(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                             const struct plan_figures *seen)
{
    (void)body, (void)seen;
    if (!iterations_of(setting, scene))
        return 0;
    setting->integrator = DPT_INTEGRATOR_SYMPLECTIC;
    return 1;
}

static void print_integrator(const struct measure_setting *setting, const struct scene *scene, uint32_t body,
                             char *text, size_t room)
{
    (void)body;
    snprintf(text, room, "%s",
             !plan_gives_way(setting, scene) ? "none"
             : iterations_of(setting, scene) ? "implicit"
             : setting->integrator >= 0      ? "symplectic"
                                             : "the scene's");
}

static int reduce_iterations(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                             const struct plan_figures *seen)
{
    const uint32_t now = iterations_of(setting, scene);
    (void)body, (void)seen;
    setting->iterations = now / 2;
    return now > 1;
}

static void print_iterations(const struct measure_setting *setting, const struct scene *scene, uint32_t body,
                             char *text, size_t room)
{
    (void)body;
    snprintf(text, room, "%" PRIu32, iterations_of(setting, scene));
}

static int reduce_smooth(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                         const struct plan_figures *seen)
{
    const int was = (int)setting->world.smooth_normals;
    (void)scene, (void)body, (void)seen;
    setting->world.smooth_normals = 0;
    return was;
}

static void print_smooth(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                         size_t room)
{
    (void)scene, (void)body;
    snprintf(text, room, "%" PRIu32, setting->world.smooth_normals);
}

static int reduce_contacts(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                           const struct plan_figures *seen)
{
    const uint32_t needed = plan_capacity(seen->contacts, setting, scene);
    const uint32_t now = setting->world.max_contacts;
    (void)body;
    setting->world.max_contacts = needed < now ? needed : 0;
    return now > 0;
}

static void print_contacts(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                           size_t room)
{
    (void)scene, (void)body;
    snprintf(text, room, "%" PRIu32, setting->world.max_contacts);
}

static int reduce_certificates(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                               const struct plan_figures *seen)
{
    const uint64_t now = setting->world.certificate_bytes;
    (void)scene, (void)body, (void)seen;
    setting->world.certificate_bytes = now / 4 >= CERTIFICATES_LEAST ? now / 4 : 0;
    return now > 0;
}

static void print_certificates(const struct measure_setting *setting, const struct scene *scene, uint32_t body,
                               char *text, size_t room)
{
    (void)scene, (void)body;
    snprintf(text, room, "%" PRIu64, setting->world.certificate_bytes);
}

/* The first may end a sweep that takes half of the largest tick. */
static int reduce_sweeps(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                         const struct plan_figures *seen)
{
    const uint32_t now = setting->world.sweep_budget;
    (void)scene, (void)body;
    setting->world.sweep_budget = (now ? now : seen->work) / 2;
    return setting->world.until != DPT_UNTIL_TRACK && setting->world.sweep_budget >= SWEEPS_LEAST;
}

static void print_sweeps(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                         size_t room)
{
    (void)scene, (void)body;
    if (setting->world.sweep_budget)
        snprintf(text, room, "%" PRIu32, setting->world.sweep_budget);
    else
        snprintf(text, room, "none");
}

/*
 * The first budget is what the largest tick took; a step's least is one unit. Where something gives way, rare ticks take
 * more than any multiple of what was seen, and one that ends early is felt ever after: none then.
 */
static int reduce_budget(struct measure_setting *setting, const struct scene *scene, uint32_t body,
                         const struct plan_figures *seen)
{
    const uint32_t now = setting->world.budget;
    (void)body;
    if (plan_gives_way(setting, scene))
        return 0;
    setting->world.budget = now != PLAN_BUDGET_AMPLE ? (uint32_t)(BUDGET_STEP * now) : seen->work ? seen->work : 1;
    return setting->world.budget > 0;
}

static void print_budget(const struct measure_setting *setting, const struct scene *scene, uint32_t body, char *text,
                         size_t room)
{
    (void)scene, (void)body;
    if (setting->world.budget != PLAN_BUDGET_AMPLE)
        snprintf(text, room, "%" PRIu32, setting->world.budget);
    else
        snprintf(text, room, "none");
}

/* Restore one field. */
#define RESTORE(name, field)                                                                                           \
    static void restore_##name(struct measure_setting *setting, const struct measure_setting *from, uint32_t body)     \
    {                                                                                                                  \
        (void)body;                                                                                                    \
        setting->field = from->field;                                                                                  \
    }
RESTORE(until, world.until)
RESTORE(integrator, integrator)
RESTORE(iterations, iterations)
RESTORE(smooth, world.smooth_normals)
RESTORE(contacts, world.max_contacts)
RESTORE(certificates, world.certificate_bytes)
RESTORE(sweeps, world.sweep_budget)
RESTORE(budget, world.budget)

static void restore_rigid(struct measure_setting *setting, const struct measure_setting *from, uint32_t body)
{
    const uint64_t bit = (uint64_t)1 << body;
    setting->rigid = (setting->rigid & ~bit) | (from->rigid & bit);
}

const struct plan_knob plan_knobs[] = {
    { "certificate_bytes", .must = KNOB_SAME_BITS, .reduce = reduce_certificates, .restore = restore_certificates,
      .print = print_certificates },
    { "rigid", .of_bodies = 1, .reduce = reduce_rigid, .restore = restore_rigid, .print = print_rigid },
    { "until", .reduce = reduce_until, .restore = restore_until, .print = print_until },
    { "integrator", .reduce = reduce_integrator, .restore = restore_integrator, .print = print_integrator },
    { "iterations", .reduce = reduce_iterations, .restore = restore_iterations, .print = print_iterations },
    { "smooth_normals", .reduce = reduce_smooth, .restore = restore_smooth, .print = print_smooth },
    { "max_contacts", .reduce = reduce_contacts, .restore = restore_contacts, .print = print_contacts },
    { "sweep_budget", .must = KNOB_SAVES, .reduce = reduce_sweeps, .restore = restore_sweeps, .print = print_sweeps },
    { "budget", .reduce = reduce_budget, .restore = restore_budget, .print = print_budget },
};
const size_t plan_knob_count = sizeof plan_knobs / sizeof *plan_knobs;

void plan_knob_name(const struct plan_knob *knob, uint32_t body, char *text, size_t room)
{
    if (knob->of_bodies)
        snprintf(text, room, "bodies[%u] %s", (unsigned)body, knob->name);
    else
        snprintf(text, room, "%s", knob->name);
}
