/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <string.h>

#include "plan/plan.h"

/* How a judgement counts for a plan. What a setting does not ask for is as wrong as it can be. */
static void figures_of(struct plan_figures *figures, const struct judgement *judgement, const struct measure_run *run,
                       const struct plan_bench *bench)
{
    const uint64_t undecided = judgement->has_contact ? judgement->unknown : judgement->bounded + judgement->stale;
    *figures = (struct plan_figures){
        .ticks = run->ticks,
        .failed = run->failure == DPT_OK ? 0 : run->ticks - run->failed_tick,
        .distance_error = judgement->distance_error,
        .force_error = judgement->has_wrench ? judgement->wrench.max : bench->wrench_peak,
        .felt = judgement->wrench_ticks,
        .near_folds = judgement->near_fold_ticks,
        .unknown = undecided > bench->unknown ? undecided - bench->unknown : 0,
        .contacts = run->usage.contacts,
        .strip = run->usage.strip,
        .work = run->usage.work,
        .work_p999 = judgement->work.p999,
        .time_median = 1e-9 * judgement->whole_ns.median,
        .time_p999 = 1e-9 * judgement->whole_ns.p999,
        .bytes = run->world_bytes + run->body_bytes,
    };
    for (size_t i = 0; i < run->ticks; i++)
        figures->work_total += run->tick[i].work;
}

static int run_and_judge(const struct plan_bench *bench, const struct measure_setting *setting, uint32_t passes,
                         struct measure_run *run, struct judgement *judgement)
{
    struct meter meter = { .began = 0 };
    const struct measure_effort effort = { .passes = passes, .meter = &meter, .name = "a setting", .end = 1.0 };
    int status = measure_run(run, bench->scene, bench->trace, setting, &effort);
    meter_show(&meter, "", 1.0);
    const struct measure_run *reference = bench->reference.tick ? &bench->reference : run;
    if (status == 0 && measure_judge(judgement, run, reference))
        status = complain(bench->scene->command, "memory ran out");
    return status;
}

struct measure_setting plan_richest(const struct measure_setting *setting, const struct scene *scene)
{
    struct measure_setting richest = measure_setting_richest(setting, scene);
    richest.world.budget = PLAN_BUDGET_AMPLE;
    return richest;
}

int plan_bench_open(struct plan_bench *bench, const struct scene *scene, const struct csv_table *trace,
                    const struct measure_setting *setting)
{
    const struct measure_setting richest = plan_richest(setting, scene);
    struct judgement judgement;
    struct measure_run run;
    *bench = (struct plan_bench){ .scene = scene, .trace = trace };
    const int status = run_and_judge(bench, &richest, 1, &run, &judgement);
    bench->reference = run;
    if (status)
        return status;
    if (run.failure != DPT_OK)
        return complain(scene->command,
                        "the richest setting fails at tick %zu: %s. The scene needs another trace, "
                        "as run --record F.csv writes it",
                        run.failed_tick, dpt_result_text(run.failure));
    figures_of(&bench->richest, &judgement, &run, bench);
    bench->unknown = judgement.unknown;
    bench->wrench_peak = judgement.wrench_peak;
    bench->richest.unknown = 0;
    return 0;
}

int plan_bench_measure(const struct plan_bench *bench, const struct measure_setting *setting, uint32_t passes,
                       struct plan_figures *figures)
{
    struct judgement judgement;
    struct measure_run run;
    const int status = run_and_judge(bench, setting, passes, &run, &judgement);
    if (status == 0)
        figures_of(figures, &judgement, &run, bench);
    measure_run_free(&run);
    return status;
}

void plan_bench_close(struct plan_bench *bench)
{
    measure_run_free(&bench->reference);
}
