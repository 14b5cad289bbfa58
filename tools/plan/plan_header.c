/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_header.h"

#include <inttypes.h>
#include <math.h>

#include "cli/law_name.h"

static const char *until_name(uint32_t until)
{
    static const char *const names[] = { "DPT_UNTIL_RESPOND", "DPT_UNTIL_TRACK", "DPT_UNTIL_CONTACT" };
    return names[until];
}

static const char *const law_constants[] = { "DPT_LAW_POINT", "DPT_LAW_BED", "DPT_LAW_PROXY" };
static const char *const integrator_constants[] = { "DPT_INTEGRATOR_SYMPLECTIC", "DPT_INTEGRATOR_EULER",
                                                    "DPT_INTEGRATOR_IMPLICIT" };

static void write_intro(FILE *file, const struct plan *plan)
{
    fprintf(file,
            "/*\n * Made by dynpoint plan: the settings of a scene, and what is promised of them.\n"
            " *\n *   distances are within %g m, at most 1 tick in %d is unknown, and 99.9 %% of\n"
            " *   ticks take at most %g s and %.0f units, at %g Hz, for motions of up to %g m/s\n",
            plan->limits.error, PLAN_UNKNOWN_ONE_IN, plan->limits.time, plan->limits.work, plan->asked.rate,
            PLAN_SPEED_FACTOR * plan->motion.speed);
    if (plan->limits.force_error < INFINITY)
        fprintf(file, " *   the wrench is within %g N of that of the richest setting\n", plan->limits.force_error);
    fprintf(file,
            " *\n * Measured on %s, %s, kernel %s, %s, dynpoint %s.\n"
            " * Not promised: other speeds, bodies that its trace has not met, other machines%s.\n"
            " */\n",
            plan->machine.processor, plan->machine.system, plan->machine.kernel, plan->machine.compiler,
            plan->machine.version, plan->stable > 0.0 ? ", another device" : ", stability");
}

static void write_world(FILE *file, const struct plan *plan, const struct scene *scene)
{
    const dpt_world_def *world = &plan->setting.world;
    fprintf(file,
            "/* The world. */\nstatic inline void plan_fill_world(dpt_world_def *def)\n{\n"
            "    dpt_world_def_init(def);\n    def->max_bodies = PLAN_BODIES;\n"
            "    def->max_tools = 1;\n    def->max_segments = %" PRIu32 ";\n    def->max_tips = "
            "%" PRIu32 ";\n    def->until = %s;\n    def->law = %s;\n    def->budget = %" PRIu32
            ";\n    def->sweep_budget = %" PRIu32 ";\n    def->certificate_bytes = %" PRIu64
            "u;\n    def->max_contacts = %" PRIu32 ";\n    def->smooth_normals = %" PRIu32
            ";\n    def->margin = %.17g;\n"
            "    def->stiffness = %.17g;\n",
            scene->segment_count, scene->tips.count, until_name(world->until), law_constants[world->law], world->budget,
            world->sweep_budget, world->certificate_bytes, world->max_contacts, world->smooth_normals, world->margin,
            world->stiffness);
    if (world->strip)
        fprintf(file, "    def->strip = DPT_STRIP_KIND_SHADOW;\n    def->strip_capacity = %" PRIu32 ";\n",
                world->strip_capacity);
    fprintf(file, "}\n\n");
}

static void write_bodies(FILE *file, const struct plan *plan, const struct scene *scene)
{
    fprintf(file, "/* A body, of 0 to PLAN_BODIES - 1, after it was added. */\n"
                  "static inline void plan_fill_body(uint32_t body, dpt_body_settings *settings)\n"
                  "{\n    switch (body) {\n");
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        const dpt_body_settings *own = &scene->bodies.body[i].settings;
        const double friction = plan->setting.friction;
        if (isnan(friction) && !own->size)
            continue;
        fprintf(file, "    case %" PRIu32 ":\n", i);
        if (own->size)
            fprintf(file,
                    "        settings->unfelt = %" PRIu32 ";\n        settings->side_limit = %.17g;\n"
                    "        settings->stiffness = %.17g;\n",
                    own->unfelt, own->side_limit, own->stiffness);
        fprintf(file,
                "        settings->static_friction = %.17g;\n"
                "        settings->kinetic_friction = %.17g;\n        break;\n",
                isnan(friction) ? own->static_friction : friction, isnan(friction) ? own->kinetic_friction : friction);
    }
    fprintf(file, "    default:\n        (void)settings;\n        break;\n    }\n}\n\n");
}

static void write_tool(FILE *file, const struct plan *plan)
{
    fprintf(file,
            "/* The tool, after it was added. */\n"
            "static inline void plan_fill_tool(dpt_tool_settings *settings)\n{\n"
            "    settings->law = %s;\n    settings->stiffness = %.17g;\n"
            "    settings->damping = %.17g;\n    settings->lock_rotation = %" PRIu32
            ";\n    settings->near_only = 1;\n}\n\n",
            law_constants[plan->setting.world.law], plan->setting.world.stiffness, plan->setting.damping,
            plan->setting.lock_rotation);
}

/* Which bodies give way, and how they are stepped. */
static void write_springs(FILE *file, const struct plan *plan, const struct scene *scene)
{
    const struct measure_setting *setting = &plan->setting;
    fprintf(file, "/* 1 if a body gives way, and how its springs are stepped; 0: it is rigid. */\n"
                  "static inline int plan_fill_springs(uint32_t body, dpt_springs_def *springs)\n"
                  "{\n    switch (body) {\n");
    for (uint32_t i = 0; i < scene->bodies.count; i++) {
        const struct scene_body *body = &scene->bodies.body[i];
        const uint32_t iterations = setting->iterations ? setting->iterations : body->iterations;
        if (!scene_body_is_soft(body) || setting->rigid >> i & 1)
            continue;
        fprintf(file, "    case %" PRIu32 ":\n        springs->integrator = %s;\n", i,
                integrator_constants[setting->integrator >= 0 ? (uint32_t)setting->integrator : body->integrator]);
        if (iterations)
            fprintf(file, "        springs->iterations = %" PRIu32 ";\n", iterations);
        if (body->sleep_speed != 0.0)
            fprintf(file, "        springs->sleep_speed = %.17g;\n", fmax(body->sleep_speed, 0.0));
        fprintf(file, "        return 1;\n");
    }
    fprintf(file, "    default:\n        (void)springs;\n        return 0;\n    }\n}\n\n");
}

void plan_header_write(FILE *file, const struct plan *plan, const struct scene *scene)
{
    write_intro(file, plan);
    fprintf(file,
            "#ifndef DYNPOINT_PLAN_H\n#define DYNPOINT_PLAN_H\n\n#include \"dynpoint.h\"\n\n"
            "#define PLAN_BODIES %" PRIu32 "\n#define PLAN_RATE %.17g /* Hz */\n\n",
            scene->bodies.count, plan->asked.rate);
    if (!isnan(plan->length))
        fprintf(file, "/* Of the stylus, m. */\n#define PLAN_LENGTH %.17g\n#define PLAN_RADIUS %.17g\n\n", plan->length,
                plan->radius);
    write_world(file, plan, scene);
    write_bodies(file, plan, scene);
    write_tool(file, plan);
    write_springs(file, plan, scene);
    fprintf(file, "#endif\n");
}
