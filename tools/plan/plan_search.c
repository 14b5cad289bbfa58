/* SPDX-License-Identifier: BSD-3-Clause */
#include "plan/plan_search.h"

#include <math.h>
#include <string.h>

#include "plan/plan_knobs.h"
#include "plan/plan_trace.h"

/* Of the chosen setting, and of those beside it: times are the least of so many passes. */
enum { PASSES = 3 };

/* Of units: a knob that leaves more saves nothing. */
#define SAVED 0.9

/* How far a plan is when its traces are felt by the richest setting, when the knobs are turned, and when it is verified. */
#define OF_BENCHES   0.1
#define OF_KNOBS     0.6
#define OF_VERIFYING 0.9

/* What was taken away, so that it can be given back. */
enum { TAKEN_MAX = 512 };
struct taken {
    const struct plan_knob *knob;
    uint32_t body;
    struct measure_setting before;
};

struct climb {
    struct plan_search *search;
    const struct plan_asked *asked;
    const struct scene *scene;
    struct measure_setting setting;
    int is_richest;              /* everything was given back */
    struct plan_figures figures; /* of it, on the first half */
    struct taken taken[TAKEN_MAX];
    size_t taken_count;
};

struct plan_limits plan_limits_of(const struct plan_asked *asked, const struct measure_setting *setting,
                                  const struct plan_bench *bench, int same_bits)
{
    return (struct plan_limits){
        .error = asked->error,
        .force_error = asked->force_error,
        .time = PLAN_TIME_SHARE / asked->rate,
        .work = same_bits ? ceil(PLAN_WORK_FACTOR * bench->richest.work_p999) : HUGE_VAL,
        .same_bits = same_bits,
        .contacts = setting->world.max_contacts ? setting->world.max_contacts : UINT32_MAX,
        .strip = setting->world.strip_capacity,
    };
}

static void describe(struct plan_neighbour *neighbour, const struct plan_knob *knob, uint32_t body,
                     const struct scene *scene)
{
    plan_knob_name(knob, body, neighbour->knob, sizeof neighbour->knob);
    knob->print(&neighbour->setting, scene, body, neighbour->value, sizeof neighbour->value);
}

/* What counts is what was refused of a knob last. */
static void refuse(struct climb *climb, const struct plan_knob *knob, uint32_t body, const struct plan_neighbour *tried)
{
    struct plan_search *search = climb->search;
    struct plan_neighbour refused = *tried;
    uint32_t i = 0;
    describe(&refused, knob, body, climb->scene);
    while (i < search->refused_count && strcmp(search->refused[i].knob, refused.knob))
        i++;
    if (i == PLAN_REFUSED_MAX)
        return;
    search->refused_count += i == search->refused_count;
    search->refused[i] = refused;
    search->last_refused = i;
}

static int is_budget(const struct plan_knob *knob)
{
    return knob == &plan_knobs[plan_knob_count - 1];
}

/* What it leaves is told as it was. */
static int is_thrift(const struct plan_knob *knob)
{
    return is_budget(knob) || knob->must != KNOB_HOLDS;
}

/* What a setting has to keep on a trace, while it is looked for. */
static struct plan_limits limits_on(const struct climb *climb, const struct plan_neighbour *tried, int same_bits)
{
    return plan_limits_of(climb->asked, &tried->setting, &climb->search->bench[tried->trace], same_bits);
}

/* What a setting breaks. */
static struct plan_text text_of(const struct climb *climb, const struct plan_neighbour *tried)
{
    const struct plan_limits limits = limits_on(climb, tried, 0);
    return plan_broken_text(&limits, &tried->figures, tried->broken);
}

/* Measure a setting on its trace, and judge: with times if there is more than one pass. Returns 0, or 2 after a message. */
static int measure(const struct climb *climb, struct plan_neighbour *tried, uint32_t passes, int same_bits)
{
    const struct plan_limits limits = limits_on(climb, tried, same_bits);
    const int status =
        plan_bench_measure(&climb->search->bench[tried->trace], &tried->setting, passes, &tried->figures);
    tried->broken = plan_judge(&limits, &tried->figures, passes > 1);
    return status;
}

/* Take as much away by one knob as holds on the first half. Returns 0, or 2 after a message. */
static int turn(struct climb *climb, const struct plan_knob *knob, uint32_t body)
{
    while (climb->taken_count < TAKEN_MAX) {
        struct plan_neighbour tried = { .setting = climb->setting };
        if (!knob->reduce(&tried.setting, climb->scene, body, &climb->figures) ||
            measure_setting_fault(&tried.setting, climb->scene))
            return 0;
        if (measure(climb, &tried, 1, knob->must == KNOB_SAME_BITS))
            return 2;
        if (tried.broken != PLAN_HOLDS) {
            refuse(climb, knob, body, &tried);
            return 0;
        }
        climb->taken[climb->taken_count++] = (struct taken){ .knob = knob, .body = body, .before = climb->setting };
        climb->setting = tried.setting;
        climb->figures = tried.figures;
    }
    return 0;
}

static int saves(const struct plan_figures *before, const struct plan_figures *now)
{
    return now->work <= SAVED * before->work || now->work_p999 <= SAVED * before->work_p999;
}

/*
 * Memory is not to be felt on other traces either, and a sweep is to end there: one step more than is needed. Returns 0, or
 * 2 after a message.
 */
static int turn_back(struct climb *climb, const struct plan_knob *knob, const struct plan_figures *before,
                     size_t taken_before)
{
    if (knob->must == KNOB_HOLDS || climb->taken_count == taken_before)
        return 0;
    climb->setting = climb->taken[--climb->taken_count].before;
    if (knob->must != KNOB_SAVES)
        return 0;
    struct plan_neighbour tried = { .setting = climb->setting };
    if (measure(climb, &tried, 1, 0))
        return 2;
    climb->figures = tried.figures;
    if (climb->taken_count == taken_before || saves(before, &tried.figures))
        return 0;
    climb->setting = climb->taken[taken_before].before;
    climb->taken_count = taken_before;
    climb->figures = *before;
    return 0;
}

static int climb_down(struct climb *climb)
{
    int status = 0;
    for (size_t i = 0; status == 0 && i < plan_knob_count; i++) {
        const uint32_t bodies = plan_knobs[i].of_bodies ? climb->scene->bodies.count : 1;
        const struct plan_figures before = climb->figures;
        const size_t taken_before = climb->taken_count;
        climb->search->progress.until =
            OF_BENCHES + (OF_KNOBS - OF_BENCHES) * (double)(i + 1) / (double)plan_knob_count;
        for (uint32_t body = 0; status == 0 && body < bodies; body++)
            status = turn(climb, &plan_knobs[i], body);
        if (status == 0)
            status = turn_back(climb, &plan_knobs[i], &before, taken_before);
    }
    if (climb->setting.world.strip && climb->figures.strip)
        climb->setting.world.strip_capacity = plan_capacity(climb->figures.strip + 1, &climb->setting, climb->scene);
    return status;
}

/* Undo what was taken, and say so. */
static void give_back(struct climb *climb, size_t index, const struct plan_neighbour *tried)
{
    const struct taken *taken = &climb->taken[index];
    refuse(climb, taken->knob, taken->body, tried);
    taken->knob->restore(&climb->setting, &taken->before, taken->body);
    climb->taken_count--;
    memmove(&climb->taken[index], &climb->taken[index + 1], (climb->taken_count - index) * sizeof *climb->taken);
}

/*
 * What is at fault, other than the budget: the last thing that was taken whose return alone mends what is broken; else the
 * last one of all. Returns 0, 1 if nothing is left to give back, or 2 after a message.
 */
static int find_fault(struct climb *climb, const struct plan_neighbour *tried)
{
    const struct taken *asked = NULL;
    size_t last = climb->taken_count;
    for (size_t i = climb->taken_count; i-- > 0;) {
        const struct taken *taken = &climb->taken[i];
        struct plan_neighbour mended = *tried;
        if (is_budget(taken->knob))
            continue;
        last = last == climb->taken_count ? i : last;
        if (asked && asked->knob == taken->knob && asked->body == taken->body)
            continue; /* only the last step of each */
        asked = taken;
        taken->knob->restore(&mended.setting, &taken->before, taken->body);
        if (measure(climb, &mended, 1, 0))
            return 2;
        if (mended.broken == PLAN_HOLDS) {
            last = i;
            break;
        }
    }
    if (last == climb->taken_count) {
        /* Capacities, too. */
        const int was_richest = climb->is_richest;
        climb->setting = plan_richest(&tried->setting, climb->scene);
        climb->is_richest = 1;
        return was_richest;
    }
    give_back(climb, last, tried);
    return 0;
}

/* More of the budget; all where what the largest tick takes is not enough. */
static void raise_budget(struct climb *climb, const struct plan_neighbour *tried)
{
    const double raised = ceil(tried->setting.world.budget * PLAN_BUDGET_RAISE);
    const uint32_t max = climb->search->bench[tried->trace].richest.work;
    refuse(climb, &plan_knobs[plan_knob_count - 1], 0, tried);
    climb->setting.world.budget = raised < 2.0 * max ? (uint32_t)raised : PLAN_BUDGET_AMPLE;
}

/*
 * Mend what was broken on a trace that was not chosen by: a capacity, the budget where it is at fault, or else what was
 * taken away last. Returns 0, 1 if nothing is left to give back, or 2 after a message.
 */
static int mend(struct climb *climb, const struct plan_neighbour *tried)
{
    dpt_world_def *world = &climb->setting.world;
    struct plan_neighbour unlimited = *tried;
    switch (tried->broken) {
    case PLAN_CONTACTS:
        world->max_contacts = plan_capacity(tried->figures.contacts, &climb->setting, climb->scene);
        return 0;
    case PLAN_STRIP:
        world->strip_capacity = plan_capacity(tried->figures.strip + 1, &climb->setting, climb->scene);
        return 0;
    case PLAN_TIME:
        return 1;
    default:
        break;
    }
    const int has_budget = world->budget != PLAN_BUDGET_AMPLE;
    if (has_budget) {
        unlimited.setting.world.budget = PLAN_BUDGET_AMPLE;
        if (measure(climb, &unlimited, 1, 0))
            return 2;
        if (unlimited.broken == PLAN_HOLDS) {
            raise_budget(climb, tried);
            return 0;
        }
    }
    return find_fault(climb, has_budget ? &unlimited : tried);
}

/*
 * What the chosen setting does, and takes, where it was not chosen by, and which bound that breaks, if any. Returns 0, or 2
 * after a message.
 */
static int time_it(const struct climb *climb, struct plan *plan, struct plan_neighbour *tried)
{
    plan->figures = (struct plan_figures){ .ticks = 0 };
    tried->broken = PLAN_HOLDS;
    for (int i = PLAN_SECOND_HALF; tried->broken == PLAN_HOLDS && i < climb->search->traces; i++) {
        *tried = (struct plan_neighbour){ .setting = climb->setting, .trace = i };
        if (measure(climb, tried, PASSES, 0))
            return 2;
        /* Other programs may have been at work. */
        if (tried->broken == PLAN_TIME && measure(climb, tried, 3 * PASSES, 0))
            return 2;
        plan_figures_join(&plan->figures, &tried->figures);
    }
    return 0;
}

/* Give back until the setting holds on all traces, times apart. Returns 0, 1 with the limit, or 2 after a message. */
static int hold(struct climb *climb, struct plan_text *limit)
{
    for (int i = PLAN_SECOND_HALF; i < climb->search->traces;) {
        struct plan_neighbour tried = { .setting = climb->setting, .trace = i };
        if (measure(climb, &tried, 1, 0))
            return 2;
        if (tried.broken == PLAN_HOLDS) {
            i++;
            continue;
        }
        *limit = text_of(climb, &tried);
        const int status = mend(climb, &tried);
        if (status)
            return status;
        i = PLAN_SECOND_HALF;
    }
    return 0;
}

/* Hold the setting against all traces, leave headroom above the budget, and see what it takes. As plan_search. */
static int verify(struct climb *climb, struct plan *plan, struct plan_text *limit)
{
    uint32_t *budget = &climb->setting.world.budget;
    for (;;) {
        struct plan_neighbour tried;
        int status = hold(climb, limit);
        if (status)
            return status;
        const uint32_t held = *budget;
        *budget = plan_times(held, PLAN_BUDGET_HEADROOM);
        if (time_it(climb, plan, &tried))
            return 2;
        if (tried.broken == PLAN_HOLDS)
            return 0;
        /* A larger budget may lead a proxy elsewhere. */
        *limit = text_of(climb, &tried);
        *budget = held;
        status = mend(climb, &tried);
        if (status)
            return status;
    }
}

/* 1 if what a setting tells becomes less, and not only what it may hold. */
static int tells_less(const struct taken *taken, const struct measure_setting *chosen)
{
    if (is_thrift(taken->knob))
        return 0;
    return strcmp(taken->knob->name, "max_contacts") ||
           (chosen->world.until == DPT_UNTIL_RESPOND && !chosen->world.max_contacts);
}

/* The last thing that was taken away and that told something. A budget is not what it costs. */
static int find_better(struct climb *climb, struct plan *plan)
{
    struct plan_neighbour better = { .setting = climb->setting };
    size_t last = climb->taken_count;
    while (last > 0 && !tells_less(&climb->taken[last - 1], &climb->setting))
        last--;
    if (!last)
        return 0;
    climb->taken[last - 1].knob->restore(&better.setting, &climb->taken[last - 1].before, climb->taken[last - 1].body);
    better.setting.world.budget = PLAN_BUDGET_AMPLE;
    better.setting.world.sweep_budget = 0;
    describe(&better, climb->taken[last - 1].knob, climb->taken[last - 1].body, climb->scene);
    for (int i = PLAN_SECOND_HALF; i < climb->search->traces; i++) {
        struct plan_figures figures;
        if (plan_bench_measure(&climb->search->bench[i], &better.setting, PASSES, &figures))
            return 2;
        plan_figures_join(&better.figures, &figures);
    }
    plan->better = better;
    return 0;
}

/* Returns 0, or 2 after a message. */
static int open_benches(struct plan_search *search, const struct plan *plan, const struct scene *scene,
                        const struct csv_table *whole)
{
    const int traces = plan->motion.file ? PLAN_TRACES_OF_FILE : PLAN_TRACES;
    int status = 0;
    for (int i = 0; status == 0 && i < traces; i++) {
        status = plan_trace_of(&search->trace[i], scene, plan, whole, i);
        if (status)
            break;
        search->traces = i + 1;
        search->bench[i].progress = &search->progress;
        search->progress.until = OF_BENCHES * (i + 1) / traces;
        status = plan_bench_open(&search->bench[i], scene, &search->trace[i], &plan->setting);
        if (i != PLAN_FIRST_HALF)
            plan_figures_join(&search->richest, &search->bench[i].richest);
    }
    return status;
}

int plan_search(struct plan_search *search, struct plan *plan, const struct scene *scene, const struct csv_table *whole,
                struct plan_text *limit)
{
    struct climb climb = {
        .search = search, .asked = &plan->asked, .scene = scene, .setting = plan_richest(&plan->setting, scene)
    };
    memset(search, 0, sizeof *search);
    int status = open_benches(search, plan, scene, whole);
    climb.figures = search->bench[PLAN_FIRST_HALF].richest;
    if (status == 0 && plan->asked.force_error < INFINITY && !climb.figures.felt)
        status = complain(scene->command, "no tick in the first half of the trace feels a force: "
                                          "--force-error needs another one (--trace, --seed)");
    if (status == 0)
        status = climb_down(&climb);
    search->progress.until = OF_VERIFYING;
    if (status == 0)
        status = verify(&climb, plan, limit);
    search->progress.until = 1.0;
    plan->setting = climb.setting;
    if (search->refused_count)
        plan->cheaper = search->refused[search->last_refused];
    if (status == 0)
        status = plan_bench_measure(&search->bench[PLAN_FIRST_HALF], &climb.setting, 1, &search->first);
    if (status == 0)
        status = find_better(&climb, plan);
    meter_show(&search->progress.meter, "", 1.0);
    plan->limits = plan_limits_of(&plan->asked, &plan->setting, &search->bench[0], 0);
    plan->limits.work = plan_capacity(plan->figures.work, &plan->setting, scene);
    return status;
}

void plan_search_close(struct plan_search *search)
{
    for (int i = 0; i < search->traces; i++) {
        plan_bench_close(&search->bench[i]);
        plan_trace_leave(&search->trace[i], i);
    }
}
