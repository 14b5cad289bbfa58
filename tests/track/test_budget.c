/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The budget: a step that may not do all it would need. Every tick of tools of one and several
 * segments among one and many bodies is held against a world that asks the tree about everything,
 * and that against brute force on a sample. What a bounded answer says must be true, and a tool
 * that rests must have its exact answer as soon as the budget has paid for one search.
 *
 * How that is counted: tick 1 of a rest is the first step whose input, all segments, all poses and
 * which bodies there are, is that of the step before; after the first step of a world, or after a
 * reset, that step itself, as there is nothing to undo. `full` is dpt_step.work of the first step
 * of another world of the same def, but without a budget, at that place. Tick ceil(full / budget)
 * of the rest, and every later one, is exact in all segments. Where bodies are equally near, which is
 * searched first is a matter of slots, which differ between the two worlds, and so may the cost be, up to
 * `search_most` times; at most one rest in a hundred takes a tick more (docs/algorithms/budget.md).
 *
 *     test_budget [TICKS]   of each mesh, motion and budget; the default is what make check runs
 */
#include "track/budget_scene.h"

static const double search_most = 8.0, search_most_alone = 1.5; /* of one segment and body */

static struct tally {
    uint64_t ticks, answers, bounded, crossing, without_force, rests, brute, full, spent;
    double slowest; /* work of a rest, in full searches */
    uint64_t late;  /* rests that took more ticks than one full search */
    double loosest; /* error bound, in parts of what motion allows */
} all;

struct run {
    struct budget_input input;
    struct budget_sim found, truth;
    uint32_t budget, tick;
    uint64_t bytes;
    double moved[SEGMENTS_MAX];  /* since the segment was exact; beside a moving body HUGE_VAL */
    double before[SEGMENTS_MAX]; /* its lower bound, a tick ago */
    double after[SEGMENTS_MAX];  /* and its distance */
    char what[80];
};

/* Nothing that was proven need count any more. */
static void run_forgets(struct run *run)
{
    for (uint32_t i = 0; i < SEGMENTS_MAX; i++)
        run->moved[i] = HUGE_VAL;
}

static void run_open(struct run *run)
{
    budget_sim_open(&run->found, &run->input, DPT_METHOD_EXACT, run->budget, run->bytes);
    budget_sim_open(&run->truth, &run->input, DPT_METHOD_TREE, 0, 0);
    run->tick = 0;
    run_forgets(run);
}

static void run_close(struct run *run)
{
    rig_close(&run->found.rig);
    rig_close(&run->truth.rig);
}

/* p lies on the axis, q on the named triangle of the named body, and they are as far as is said. */
static void pair_is_real(const struct run *run, const dpt_hit *hit, uint32_t i, double tight)
{
    const struct place *place = run->input.places;
    const dpt_segment *now = &run->input.now[i];
    double on[3], q[6], corners[9];
    uint32_t b = 0;
    while (b < run->input.scene->bodies && !(place[b].there && run->found.body[b] == hit->body))
        b++;
    CHECK(b < run->input.scene->bodies, "%s: body %u", run->what, hit->body);
    if (b == run->input.scene->bodies)
        return;
    for (int k = 0; k < 3; k++)
        on[k] = now->a[k] + hit->s * (now->b[k] - now->a[k]);
    CHECK(hit->s >= 0.0 && hit->s <= 1.0 && apart(on, hit->p) <= tight, "%s: p", run->what);
    CHECK(fabs(apart(hit->p, hit->q) - hit->distance) <= tight, "%s: |p - q|", run->what);
    pose_local(&place[b].pose, hit->q, q);
    memcpy(q + 3, q, 3 * sizeof *q);
    CHECK(dpt_mesh_get_triangle(place[b].mesh, hit->triangle, corners) == DPT_OK &&
              dpt_segment_triangle(q, corners, NULL, NULL, NULL) <= tight,
          "%s, tick %u: q is not on triangle %u", run->what, run->tick, hit->triangle);
}

/*
 * How large may the error be? Since the segment was exact, the truth fell by no more than its ends
 * moved, and what was nearest then is farther by no more than that. So a bounded answer need not be
 * wrong by more than twice that way, and what was proven then must still tell so.
 */
static void answer_is_true(struct run *run, uint32_t i, int rests)
{
    const dpt_hit *hit = &run->found.hits[i], *truth = &run->truth.hits[i];
    double tiny = truth->error_bound, above = hit->distance - truth->distance;
    const char *what = run->what;
    run->moved[i] += !rests && run->input.moved > 0.0 ? run->input.moved + 4.0 * tiny : 0.0;
    double most = 2.0 * run->moved[i] + 4.0 * tiny;
    CHECK(hit->status == DPT_STATUS_EXACT || hit->status == DPT_STATUS_BOUNDED, "%s, tick %u: status %u", what,
          run->tick, hit->status);
    CHECK(above >= -2.0 * tiny && above <= hit->error_bound + tiny, "%s, tick %u: %.17g, the truth is %.17g", what,
          run->tick, hit->distance, truth->distance);
    CHECK(hit->lower_bound >= 0.0 && hit->lower_bound <= truth->distance + tiny,
          "%s, tick %u: lower bound %.17g, the truth is %.17g", what, run->tick, hit->lower_bound, truth->distance);
    CHECK(hit->error_bound <= most, "%s, tick %u, segment %u: error bound %g, may be %g", what, run->tick, i,
          hit->error_bound, most);
    CHECK(!(hit->flags & DPT_HIT_FLAG_CROSSING) == (hit->distance > 0.0), "%s: crossing", what);
    CHECK(!(hit->flags & DPT_HIT_FLAG_CROSSING) || truth->distance <= tiny, "%s: none crosses", what);
    CHECK(!rests || (hit->lower_bound >= run->before[i] && hit->distance <= run->after[i]),
          "%s, tick %u, segment %u rests: %.17g to %.17g was %.17g to %.17g", what, run->tick, i, hit->lower_bound,
          hit->distance, run->before[i], run->after[i]);
    run->before[i] = hit->lower_bound;
    run->after[i] = hit->distance;
    if (hit->status == DPT_STATUS_BOUNDED) {
        CHECK(hit->contact == DPT_CONTACT_UNKNOWN && hit->flags == DPT_HIT_FLAG_BUDGET,
              "%s, tick %u: contact %u, flags %u", what, run->tick, hit->contact, hit->flags);
        if (run->moved[i] > 0.0 && run->moved[i] < HUGE_VAL)
            all.loosest = fmax(all.loosest, hit->error_bound / most);
        all.bounded++;
    } else {
        CHECK(hit->error_bound <= 2.0 * tiny, "%s: exact within %g", what, hit->error_bound);
        run->moved[i] = 0.0;
    }
    all.crossing += truth->distance == 0.0;
    all.answers++;
    pair_is_real(run, hit, i, 4.0 * tiny);
}

/* One step of both; the truth rests with the tool. Returns whether all segments are exact. */
static int run_tick(struct run *run, int rests)
{
    uint32_t work = 0, exact = 1, pushes = 0;
    dpt_wrench wrench;
    budget_sim_step(&run->found, &run->input);
    if (!rests)
        budget_sim_step(&run->truth, &run->input);
    for (uint32_t i = 0; i < run->input.scene->segments; i++) {
        const dpt_hit *hit = &run->found.hits[i];
        answer_is_true(run, i, rests);
        work += hit->work;
        exact &= hit->status == DPT_STATUS_EXACT;
        pushes |= hit->status == DPT_STATUS_EXACT && (hit->depth > 0.0 || hit->distance == 0.0);
    }
    CHECK(work == run->found.rig.step.work && work <= run->budget, "%s, tick %u: work %u, %u", run->what, run->tick,
          work, run->found.rig.step.work);
    dpt_tool_get_wrench(run->found.rig.world, run->found.rig.tool, &wrench);
    for (int k = 0; k < 3 && !pushes; k++)
        CHECK(wrench.force[k] == 0.0 && wrench.torque[k] == 0.0, "%s: a bounded push", run->what);
    all.without_force += !pushes && run->truth.rig.step.contact == DPT_CONTACT_PENETRATING;
    all.ticks++;
    run->tick++;
    return (int)exact;
}

/* The first step without a budget, at this place. */
static struct budget_sim first_step(const struct run *run)
{
    struct budget_sim fresh;
    budget_sim_open(&fresh, &run->input, DPT_METHOD_EXACT, 0, run->bytes);
    budget_sim_step(&fresh, &run->input);
    rig_close(&fresh.rig);
    return fresh;
}

/* `begun`: the step before had this input. If not, this is the first of all, or after a reset. */
static void run_rest(struct run *run, int begun)
{
    uint32_t full = first_step(run).rig.step.work, done = 0, spent = 0;
    uint32_t expected = full ? (full + run->budget - 1) / run->budget : 1;
    int alone = run->input.scene->segments == 1 && run->input.scene->bodies == 1;
    uint32_t allowed = (uint32_t)ceil((alone ? search_most_alone : search_most) * expected);
    for (uint32_t rest = 1; rest <= expected + 3 || (!done && rest <= allowed); rest++) {
        int exact = run_tick(run, begun || rest > 1);
        uint32_t work = run->found.rig.step.work;
        CHECK(!done || exact, "%s, tick %u: work %u, no longer exact", run->what, run->tick, work);
        CHECK(exact || work == run->budget, "%s, tick %u: only %u done", run->what, run->tick, work);
        done = exact && !done ? rest : done;
        spent += work;
    }
    CHECK(done && done <= allowed, "%s, tick %u: exact at rest's tick %u, not %u; full search %u", run->what, run->tick,
          done, allowed, full);
    all.slowest = fmax(all.slowest, (double)spent / (full > 16 ? full : 16));
    all.full += full;
    all.spent += spent;
    all.rests++;
    all.late += done > expected;
}

/* What happens between two ticks. Returns 1 if the next one knows nothing. */
static int run_event(struct run *run)
{
    struct budget_input *input = &run->input;
    struct budget_sim *const sims[2] = { &run->found, &run->truth };
    enum { LEAVES_OR_COMES, APPROACHES, RETIRES, TELEPORT, RESET, EVENTS };
    uint32_t event = (uint32_t)(random_bits(&input->random) % (EVENTS + 2));
    uint32_t b = (uint32_t)(random_bits(&input->random) % input->scene->bodies);
    struct place *place = &input->places[b];
    if ((event < TELEPORT && !b) || event >= EVENTS)
        return 0;
    /* Who comes is another one, in the slot of who left. */
    if (event == LEAVES_OR_COMES && !place->there)
        place->mesh = place->mesh == small_mesh.mesh ? budget_mesh.mesh : small_mesh.mesh;
    if (event == APPROACHES || event == RETIRES || (event == LEAVES_OR_COMES && !place->there))
        for (int k = 0; k < 3; k++)
            place->pose.position[k] =
                input->pose.position[k] + (event == RETIRES ? 9.0 : 0.4) * input->size * random_signed(&input->random);
    for (int i = 0; i < 2; i++) {
        dpt_world *world = sims[i]->rig.world;
        if (event == LEAVES_OR_COMES && place->there)
            CHECK(dpt_body_remove(world, sims[i]->body[b]) == DPT_OK, "remove");
        else if (event == LEAVES_OR_COMES)
            budget_sim_add_body(sims[i], input, b);
        else if (event == TELEPORT)
            CHECK(dpt_tool_teleport(world, sims[i]->rig.tool, &input->pose) == DPT_OK, "teleport");
        else if (event == RESET)
            CHECK(dpt_world_reset(world) == DPT_OK, "reset");
    }
    place->there ^= event == LEAVES_OR_COMES;
    run_forgets(run);
    return event == RESET;
}

/* What the tree says of a segment, by every triangle of every body. */
static void truth_is_brute_force(const struct run *run)
{
    const dpt_query_def def = { .size = sizeof def, .method = DPT_METHOD_BRUTE };
    uint32_t i = run->tick % run->input.scene->segments;
    double ends[6], least = HUGE_VAL;
    memcpy(ends, run->input.now[i].a, sizeof ends / 2);
    memcpy(ends + 3, run->input.now[i].b, sizeof ends / 2);
    for (uint32_t b = 0; b < run->input.scene->bodies; b++) {
        const struct place *place = &run->input.places[b];
        dpt_hit hit = DPT_HIT_INIT;
        if (place->there)
            dpt_query_segments(place->mesh, &place->pose, ends, NULL, 1, &hit, &def);
        least = place->there ? fmin(least, hit.distance) : least;
    }
    const dpt_hit *truth = &run->truth.hits[i];
    CHECK(fabs(least - truth->distance) <= 2.0 * truth->error_bound, "%s: %.17g, brute force %.17g", run->what,
          truth->distance, least);
    all.brute++;
}

static void follow(struct run *run, int motion)
{
    run_open(run);
    run_rest(run, 0);
    while (run->tick < budget_ticks) {
        uint32_t most = motion == REST ? 1 : motion == JUMP ? 3 : 24;
        uint32_t moves = 1 + (uint32_t)(random_bits(&run->input.random) % most);
        int knows = !run_event(run);
        for (uint32_t i = 0; i < moves && knows; i++) {
            input_move(&run->input, motion, &run->truth.hits[0]);
            if (motion == MOVED)
                run_forgets(run);
            run_tick(run, 0);
        }
        run_rest(run, knows);
    }
    if (run->budget % 3)
        truth_is_brute_force(run);
    run_close(run);
}

static const char *const names[] = { "torus", "liver", "membrane", "star", "confetti" };
enum { SUBJECTS = sizeof names / sizeof *names };

/* Triangles of all sizes that share nothing, on a ball. */
static int confetti(struct fixture *fixture)
{
    enum { COUNT = 1500 };
    static double vertices[9 * COUNT];
    static uint32_t corners[3 * COUNT];
    const double origin[3] = { 0.0, 0.0, 0.0 };
    uint64_t random = 2;
    for (uint32_t t = 0; t < COUNT; t++) {
        double centre[3], size = 0.05 * pow(10.0, 2.0 * random_in(&random, -1.0, 0.0));
        for (int k = 0; k < 3; k++)
            centre[k] = random_signed(&random);
        for (uint32_t i = 0; i < 9; i++)
            vertices[9 * t + i] = 0.15 * centre[i % 3] / apart(centre, origin) + size * random_signed(&random);
        for (uint32_t k = 3 * t; k < 3 * t + 3; k++)
            corners[k] = k;
    }
    return fixture_from_arrays(fixture, vertices, 3 * COUNT, corners, COUNT);
}

static int subject_open(uint32_t s)
{
    return s == SUBJECTS - 1 ? confetti(&budget_mesh) : fixture_from_shape(&budget_mesh, names[s], s == 0 ? 5568 : 0);
}

static double percent(uint64_t part)
{
    return 100.0 * (double)part / (double)all.answers;
}

/* Every motion and budget of each mesh; caches and scenes take turns. */
static void bounded_answers_are_true(void)
{
    static struct run run;
    for (uint32_t s = 0, count = 0; s < SUBJECTS; s++) {
        if (!subject_open(s))
            continue;
        for (uint32_t motion = 0; motion < MOTIONS; motion++)
            for (uint32_t b = 0; b < BUDGETS; b++, count++) {
                uint32_t scene = (count + motion) % SCENES;
                run.budget = budgets[b];
                run.bytes = caches[(count + s) % CACHES];
                snprintf(run.what, sizeof run.what, "%s, %s, budget %u, %u bytes, scene %u", names[s], motions[motion],
                         run.budget, (unsigned)run.bytes, scene);
                input_start(&run.input, &budget_scenes[scene], 31 * count + 7);
                follow(&run, (int)motion);
            }
        fixture_free(&budget_mesh);
    }
    printf("    %llu ticks, %llu answers, %.0f %% bounded, %.0f %% crossing; %llu ticks without the "
           "force they should have; %llu against brute force\n",
           (unsigned long long)all.ticks, (unsigned long long)all.answers, percent(all.bounded), percent(all.crossing),
           (unsigned long long)all.without_force, (unsigned long long)all.brute);
    printf("    %llu rests, %.2f of a full search each, %.2f at most, %llu late; "
           "error bounds at most %.2f of what motion allows\n",
           (unsigned long long)all.rests, (double)all.spent / (double)all.full, all.slowest,
           (unsigned long long)all.late, all.loosest);
    CHECK(all.late * 50 <= all.rests, "%llu late", (unsigned long long)all.late);
    CHECK(percent(all.bounded) > 10.0 && percent(all.bounded) < 90.0, "one-sided");
    CHECK(percent(all.crossing) > 2.0 && percent(all.crossing) < 50.0, "one-sided");
    CHECK(all.without_force > 100 && all.brute > 50, "too few");
}

/* Half of what a slow slide needs: what is lost, and that every segment has its turn. */
static void half_of_the_need(void)
{
    static struct run run;
    static const uint32_t at[] = { 0, 3, 2, 5 };
    uint32_t count = budget_ticks > 100 ? 4 * budget_ticks : 400;
    for (uint32_t n = 0; n < 4; n++) {
        const struct scene *scene = &budget_scenes[at[n]];
        uint64_t work = 0, exact = 0;
        uint32_t waits[SEGMENTS_MAX] = { 0 }, longest = 0;
        double lost = 0.0, asked = (double)count * scene->segments;
        run.bytes = 1 << 20;
        for (int pass = 0; pass < 2; pass++) {
            input_start(&run.input, scene, 5 + n);
            run.budget = pass ? (uint32_t)(work / count / 2 + 1) : 1 << 30;
            snprintf(run.what, sizeof run.what, "slow, budget %u, scene %u", run.budget, at[n]);
            run_open(&run);
            for (uint32_t tick = 0; tick < count; tick++) {
                input_move(&run.input, SLIDE, &run.truth.hits[0]);
                run_tick(&run, 0);
                work += pass ? 0 : run.found.rig.step.work;
                for (uint32_t i = 0; pass && i < scene->segments; i++) {
                    const dpt_hit *hit = &run.found.hits[i];
                    waits[i] = hit->status == DPT_STATUS_EXACT ? 0 : waits[i] + 1;
                    longest = waits[i] > longest ? waits[i] : longest;
                    exact += !waits[i];
                    lost += (hit->distance - hit->lower_bound) / run.input.size;
                }
            }
            run_close(&run);
        }
        printf("    %2u segments, %u bodies, budget %2u: %.0f %% exact, error bound %.2g of the "
               "size, at most %u ticks from one exact answer to the next\n",
               scene->segments, scene->bodies, run.budget, 100.0 * (double)exact / asked, lost / asked, longest + 1);
        CHECK(longest < count / 2 || scene->segments == 1, "a segment starves");
    }
}

/*
 * A rope that moves a little, pauses for three ticks, and so on. A pause is half of what all of it
 * needs, but three times what a segment does: each has its turn within a pause for every segment.
 */
static void pauses_serve_every_segment(void)
{
    static struct run run;
    enum { CYCLE = 4 };
    uint32_t waits[SEGMENTS_MAX] = { 0 };
    input_start(&run.input, &budget_scenes[5], 9);
    run.bytes = 1 << 20;
    struct budget_sim fresh = first_step(&run);
    run.budget = fresh.rig.step.work / 6;
    for (uint32_t i = 0; i < budget_scenes[5].segments; i++)
        run.budget = fresh.hits[i].work > run.budget ? fresh.hits[i].work : run.budget;
    snprintf(run.what, sizeof run.what, "pauses, budget %u", run.budget);
    run_open(&run);
    for (uint32_t tick = 0; tick < 8 * budget_ticks; tick++) {
        if (tick % CYCLE == 0)
            input_move(&run.input, SLIDE, &run.truth.hits[0]);
        run_tick(&run, tick % CYCLE != 0);
        for (uint32_t i = 0; i < budget_scenes[5].segments; i++) {
            waits[i] = run.found.hits[i].status == DPT_STATUS_EXACT ? 0 : waits[i] + 1;
            CHECK(waits[i] <= CYCLE * budget_scenes[5].segments, "tick %u: segment %u waits", tick, i);
        }
    }
    run_close(&run);
}

/* Poses that come every second tick, of a device that is slower than the loop, are motion, not rests. */
static void held_poses_are_motion(void)
{
    static struct run run;
    uint32_t exact[2] = { 0, 0 };
    for (uint32_t hold = 1; hold <= 2; hold++) {
        input_start(&run.input, &budget_scenes[0], 4);
        run.bytes = 1 << 20;
        run.budget = 9;
        snprintf(run.what, sizeof run.what, "held for %u", hold);
        run_open(&run);
        for (uint32_t tick = 0; tick < 10 * budget_ticks; tick++) {
            if (tick % hold == 0)
                input_move(&run.input, SLIDE, &run.truth.hits[0]);
            run_tick(&run, tick % hold != 0);
            exact[hold - 1] += run.found.hits[0].status == DPT_STATUS_EXACT;
        }
        run_close(&run);
    }
    printf("    exact with a pose every tick %u, every second %u of %u\n", exact[0], exact[1], 10 * budget_ticks);
    CHECK(4 * exact[1] > 3 * exact[0], "%u, held %u", exact[0], exact[1]);
}

/*
 * Three bodies and a tool that trembles, so that the first body never stays proven; then the third
 * comes nearer than that one. It is found all the same, after some searches of all three.
 */
static void no_body_starves(void)
{
    static struct run run;
    for (uint32_t b = 0; b < 5; b++) {
        struct budget_input *input = &run.input;
        input_start(input, &budget_scenes[3], 21);
        run.budget = budgets[b];
        run.bytes = caches[b % CACHES];
        snprintf(run.what, sizeof run.what, "tremble, budget %u", run.budget);
        input->pose.position[2] = 0.8 * input->size;
        for (uint32_t i = 1; i < 3; i++)
            input->places[i].pose.position[2] = -9.0 * input->size;
        input_set_tool(input);
        run_open(&run);
        uint32_t full = first_step(&run).rig.step.work, came = 8 + 2 * full / run.budget, tick = 0;
        for (; tick < came || run.found.hits[0].body != run.found.body[2]; tick++) {
            if (tick > 10 * came)
                break;
            input->pose.position[tick % 3] += (tick / 3 % 2 ? 1e-4 : -1e-4) * input->size;
            if (tick == came) {
                memcpy(input->places[2].pose.position, input->pose.position, 3 * sizeof(double));
                run_forgets(&run);
            }
            input_set_tool(input);
            run_tick(&run, 0);
        }
        CHECK(tick <= 10 * came, "%s: not found in %u ticks", run.what, tick - came);
        run_close(&run);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        budget_ticks = (uint32_t)strtoul(argv[1], NULL, 10);
    if (!fixture_from_shape(&small_mesh, "torus", 600))
        return 2;
    TEST(bounded_answers_are_true);
    if (!subject_open(0))
        return 2;
    TEST(half_of_the_need);
    TEST(pauses_serve_every_segment);
    TEST(held_poses_are_motion);
    TEST(no_body_starves);
    fixture_free(&budget_mesh);
    fixture_free(&small_mesh);
    return check_report();
}
