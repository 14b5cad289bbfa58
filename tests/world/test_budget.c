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
#include <math.h>

#include "lib/fixture.h"

#if defined(__SANITIZE_ADDRESS__)
static uint32_t ticks = 20;
#else
static uint32_t ticks = 160;
#endif

enum { BODIES_MAX = 40, SEGMENTS_MAX = 12, SCENES = 6 };
enum motion { REST, SLIDE, SPIN, FLY, JUMP, MOVED, MOTIONS };
static const char *const motions[MOTIONS] = { "rest", "slide", "spin", "fly", "jump", "moved" };

static const double search_most = 8.0, search_most_alone = 1.5; /* of one segment and body */

static const uint32_t budgets[] = { 1, 2, 3, 5, 16, 64, 1000 };
static const uint64_t caches[] = { 0, 272, 1 << 20 };
enum { BUDGETS = sizeof budgets / sizeof *budgets, CACHES = sizeof caches / sizeof *caches };

/* A rigid tool is a star of lines, moved by its pose; a free one a rope, moved by its segments. */
static const struct scene {
    uint32_t segments, bodies;
    int rigid;
} scenes[SCENES] = {
    { 1, 1, 0 }, { 5, 1, 1 }, { 12, 1, 0 }, { 1, 3, 0 }, { 5, 40, 1 }, { 12, 3, 0 }
};

static struct fixture subject, small;

static double one(uint64_t *random)
{
    return random_in(random, -1.0, 1.0);
}

static double gap_of(const double v[3], const double w[3])
{
    double x = v[0] - w[0], y = v[1] - w[1], z = v[2] - w[2];
    return sqrt(x * x + y * y + z * z);
}

/* out = base + sign R(pose)^sign v */
static void turned(const dpt_pose *pose, double sign, const double v[3], double out[3])
{
    const double *q = pose->orientation;
    double u[5], once[5], w = q[0];
    for (int k = 0; k < 5; k++)
        u[k] = sign * q[1 + k % 3];
    for (int k = 0; k < 5; k++)
        once[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
        out[k] = v[k] + 2.0 * (w * once[k] + u[k + 1] * once[k + 2] - u[k + 2] * once[k + 1]);
}

/* A small turn, from any q to one of unit length. */
static void turn_by(dpt_pose *pose, const double turn[3])
{
    double *q = pose->orientation, old[4], size = 0.0;
    memcpy(old, q, sizeof old);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        q[0] -= turn[k] * old[k + 1];
        q[k + 1] += turn[k] * old[0] + turn[i] * old[j + 1] - turn[j] * old[i + 1];
    }
    for (int k = 0; k < 4; k++)
        size += q[k] * q[k];
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(size);
}

/* What all worlds of a run are told. */
struct stage {
    uint64_t random;
    const struct scene *scene;
    double size; /* of the mesh */
    struct place {
        const dpt_mesh *mesh;
        dpt_pose pose;
        int there;
    } places[BODIES_MAX];
    dpt_pose pose;                 /* of the tool */
    dpt_segment own[SEGMENTS_MAX]; /* in its frame */
    dpt_segment now[SEGMENTS_MAX]; /* in the world */
    double way[3], turn[3];
    double moved; /* the most that an end moved in this tick */
};

static void stage_set_tool(struct stage *stage)
{
    stage->moved = 0.0;
    for (uint32_t i = 0; i < stage->scene->segments; i++) {
        dpt_segment next = stage->own[i];
        turned(&stage->pose, 1.0, stage->own[i].a, next.a);
        turned(&stage->pose, 1.0, stage->own[i].b, next.b);
        for (int k = 0; k < 3; k++) {
            next.a[k] += stage->pose.position[k];
            next.b[k] += stage->pose.position[k];
        }
        stage->moved = fmax(stage->moved, gap_of(next.a, stage->now[i].a));
        stage->moved = fmax(stage->moved, gap_of(next.b, stage->now[i].b));
        stage->now[i] = next;
    }
}

static void stage_start(struct stage *stage, const struct scene *scene, uint64_t seed)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(subject.mesh, &info);
    *stage = (struct stage){ .random = seed, .scene = scene, .pose = DPT_POSE_IDENTITY };
    for (int k = 0; k < 3; k++)
        stage->size = fmax(stage->size, info.box_max[k] - info.box_min[k]);
    double apart = (scene->bodies > 3 ? 3.0 : 1.2) * stage->size;
    double length = 0.5 * stage->size * pow(10.0, -1.5 * random_in(&stage->random, 0.0, 1.0));
    for (uint32_t b = 0; b < scene->bodies; b++) {
        struct place *place = &stage->places[b];
        *place = (struct place){ b % 3 ? small.mesh : subject.mesh, DPT_POSE_IDENTITY, 1 };
        for (int k = 0; k < 3 && b; k++) {
            place->pose.position[k] = apart * one(&stage->random);
            stage->turn[k] = one(&stage->random);
        }
        turn_by(&place->pose, stage->turn);
    }
    for (uint32_t i = 0; i < scene->segments; i++) {
        dpt_segment *own = &stage->own[i];
        own->radius = i % 3 ? 0.01 * i * stage->size : 0.0;
        for (int k = 0; k < 3; k++) {
            own->a[k] = scene->rigid || !i ? 0.1 * length * one(&stage->random) : own[-1].b[k];
            own->b[k] = own->a[k] + length * one(&stage->random);
        }
    }
    for (int k = 0; k < 3; k++)
        stage->pose.position[k] =
            0.5 * (info.box_min[k] + info.box_max[k]) + 0.4 * stage->size * one(&stage->random);
    stage_set_tool(stage);
}

/* The next tick; `near` is a pair that leads to the surface. */
static void stage_move(struct stage *stage, int motion, const dpt_hit *near)
{
    const double speeds[MOTIONS] = { 0.01, 1e-3, 2e-4, 2e-3 / stage->size, 0.0, 2e-4 };
    double speed = speeds[motion] * stage->size, home = 0.0, spin[3];
    int frozen = (motion == MOVED || motion == REST) && random_bits(&stage->random) % 2;
    if (near->distance > 0.02 * stage->size)
        home = speed / near->distance;
    int turns = random_bits(&stage->random) % 32 == 0 || motion == REST;
    for (int k = 0; k < 3; k++) {
        stage->way[k] = turns ? one(&stage->random) : stage->way[k];
        stage->turn[k] = turns ? one(&stage->random) : stage->turn[k];
        spin[k] = (motion == SPIN ? 0.05 : 0.5 * speeds[motion]) * stage->turn[k];
    }
    for (uint32_t b = 0; b < stage->scene->bodies && motion == MOVED; b += 1 + b % 3) {
        for (int k = 0; k < 3; k++)
            stage->places[b].pose.position[k] += 1e-3 * stage->size * stage->turn[(b + 1) % 3];
        turn_by(&stage->places[b].pose, spin);
    }
    for (int k = 0; k < 3 && !frozen; k++) {
        stage->pose.position[k] += speed * stage->way[k] + home * (near->q[k] - near->p[k]);
        if (motion == JUMP)
            stage->pose.position[k] = near->q[k] + 0.3 * stage->size * one(&stage->random);
    }
    if (!frozen)
        turn_by(&stage->pose, spin);
    stage_set_tool(stage);
}

/* A world that is told so. */
struct side {
    void *block;
    dpt_world *world;
    dpt_body body[BODIES_MAX];
    dpt_tool tool;
    dpt_step step;
    dpt_hit hits[SEGMENTS_MAX];
};

static void side_add_body(struct side *side, const struct stage *stage, uint32_t b)
{
    const struct place *place = &stage->places[b];
    CHECK(dpt_body_add(side->world, place->mesh, &place->pose, &side->body[b]) == DPT_OK, "add");
}

static void side_open(struct side *side, const struct stage *stage, uint32_t method,
                      uint32_t budget, uint64_t bytes)
{
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.max_bodies = stage->scene->bodies + 1;
    def.method = method;
    def.budget = budget;
    def.certificate_bytes = bytes;
    def.fade = 0.0; /* the force is of this tick alone */
    side->block = malloc(dpt_world_bytes(&def));
    if (dpt_world_create(side->block, dpt_world_bytes(&def), &def, &side->world) != DPT_OK)
        exit(2);
    for (uint32_t b = 0; b < stage->scene->bodies; b++)
        if (stage->places[b].there)
            side_add_body(side, stage, b);
    CHECK(dpt_tool_add(side->world, stage->own, stage->scene->segments, &side->tool) == DPT_OK,
          "tool");
}

/* Poses that did not change are given again: hosts do so. */
static void side_step(struct side *side, const struct stage *stage)
{
    const struct scene *scene = stage->scene;
    for (uint32_t b = 0; b < scene->bodies; b++)
        if (stage->places[b].there)
            dpt_body_set_pose(side->world, side->body[b], &stage->places[b].pose);
    if (scene->rigid)
        dpt_tool_set_pose(side->world, side->tool, &stage->pose);
    else
        dpt_tool_set_segments(side->world, side->tool, stage->now, scene->segments);
    side->step.size = sizeof side->step;
    CHECK(dpt_world_step(side->world, 1e-3, &side->step) == DPT_OK, "step");
    for (uint32_t i = 0; i < scene->segments; i++) {
        side->hits[i].size = sizeof side->hits[i];
        dpt_tool_get_segment_hit(side->world, side->tool, i, &side->hits[i]);
    }
}

static struct tally {
    uint64_t ticks, asked, bounded, crossing, silent, rests, brute, full, spent;
    double slowest; /* work of a rest, in full searches */
    uint64_t late;  /* rests that took more ticks than one full search */
    double loosest; /* error bound, in parts of what motion allows */
} all;

struct run {
    struct stage stage;
    struct side found, truth;
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
    side_open(&run->found, &run->stage, DPT_METHOD_EXACT, run->budget, run->bytes);
    side_open(&run->truth, &run->stage, DPT_METHOD_TREE, 0, 0);
    run->tick = 0;
    run_forgets(run);
}

static void run_close(struct run *run)
{
    free(run->found.block);
    free(run->truth.block);
}

/* p lies on the axis, q on the named triangle of the named body, and they are as far as is said. */
static void pair_is_real(const struct run *run, const dpt_hit *hit, uint32_t i, double tight)
{
    const struct place *place = run->stage.places;
    const dpt_segment *now = &run->stage.now[i];
    double on[3], from[3], q[6], corners[9];
    uint32_t b = 0;
    while (b < run->stage.scene->bodies && !(place[b].there && run->found.body[b] == hit->body))
        b++;
    CHECK(b < run->stage.scene->bodies, "%s: body %u", run->what, hit->body);
    if (b == run->stage.scene->bodies)
        return;
    for (int k = 0; k < 3; k++) {
        on[k] = now->a[k] + hit->s * (now->b[k] - now->a[k]);
        from[k] = hit->q[k] - place[b].pose.position[k];
    }
    CHECK(hit->s >= 0.0 && hit->s <= 1.0 && gap_of(on, hit->p) <= tight, "%s: p", run->what);
    CHECK(fabs(gap_of(hit->p, hit->q) - hit->distance) <= tight, "%s: |p - q|", run->what);
    turned(&place[b].pose, -1.0, from, q);
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
    run->moved[i] += !rests && run->stage.moved > 0.0 ? run->stage.moved + 4.0 * tiny : 0.0;
    double most = 2.0 * run->moved[i] + 4.0 * tiny;
    CHECK(hit->status == DPT_STATUS_EXACT || hit->status == DPT_STATUS_BOUNDED,
          "%s, tick %u: status %u", what, run->tick, hit->status);
    CHECK(above >= -2.0 * tiny && above <= hit->error_bound + tiny,
          "%s, tick %u: %.17g, the truth is %.17g", what, run->tick, hit->distance,
          truth->distance);
    CHECK(hit->lower_bound >= 0.0 && hit->lower_bound <= truth->distance + tiny,
          "%s, tick %u: lower bound %.17g, the truth is %.17g", what, run->tick, hit->lower_bound,
          truth->distance);
    CHECK(hit->error_bound <= most, "%s, tick %u, segment %u: error bound %g, may be %g", what,
          run->tick, i, hit->error_bound, most);
    CHECK(!(hit->flags & DPT_HIT_FLAG_CROSSING) == (hit->distance > 0.0), "%s: crossing", what);
    CHECK(!(hit->flags & DPT_HIT_FLAG_CROSSING) || truth->distance <= tiny, "%s: none crosses",
          what);
    CHECK(!rests || (hit->lower_bound >= run->before[i] && hit->distance <= run->after[i]),
          "%s, tick %u, segment %u rests: %.17g to %.17g was %.17g to %.17g", what, run->tick, i,
          hit->lower_bound, hit->distance, run->before[i], run->after[i]);
    run->before[i] = hit->lower_bound;
    run->after[i] = hit->distance;
    if (hit->status == DPT_STATUS_BOUNDED) {
        CHECK(hit->contact == DPT_CONTACT_UNKNOWN && !(hit->flags & DPT_HIT_FLAG_GAP),
              "%s, tick %u: contact %u, flags %u", what, run->tick, hit->contact, hit->flags);
        if (run->moved[i] > 0.0 && run->moved[i] < HUGE_VAL)
            all.loosest = fmax(all.loosest, hit->error_bound / most);
        all.bounded++;
    } else {
        CHECK(hit->error_bound <= 2.0 * tiny, "%s: exact within %g", what, hit->error_bound);
        run->moved[i] = 0.0;
    }
    all.crossing += truth->distance == 0.0;
    all.asked++;
    pair_is_real(run, hit, i, 4.0 * tiny);
}

/* One step of both; the truth rests with the tool. Returns whether all segments are exact. */
static int run_tick(struct run *run, int rests)
{
    uint32_t work = 0, exact = 1, pushes = 0;
    dpt_wrench wrench;
    side_step(&run->found, &run->stage);
    if (!rests)
        side_step(&run->truth, &run->stage);
    for (uint32_t i = 0; i < run->stage.scene->segments; i++) {
        const dpt_hit *hit = &run->found.hits[i];
        answer_is_true(run, i, rests);
        work += hit->work;
        exact &= hit->status == DPT_STATUS_EXACT;
        pushes |= hit->status == DPT_STATUS_EXACT && (hit->depth > 0.0 || hit->distance == 0.0);
    }
    CHECK(work == run->found.step.work && work <= run->budget, "%s, tick %u: work %u, %u",
          run->what, run->tick, work, run->found.step.work);
    dpt_tool_get_wrench(run->found.world, run->found.tool, &wrench);
    for (int k = 0; k < 3 && !pushes; k++)
        CHECK(wrench.force[k] == 0.0 && wrench.torque[k] == 0.0, "%s: a bounded push", run->what);
    all.silent += !pushes && run->truth.step.contact == DPT_CONTACT_PENETRATING;
    all.ticks++;
    run->tick++;
    return (int)exact;
}

/* The first step without a budget, at this place. */
static struct side first_step(const struct run *run)
{
    struct side fresh;
    side_open(&fresh, &run->stage, DPT_METHOD_EXACT, 0, run->bytes);
    side_step(&fresh, &run->stage);
    free(fresh.block);
    return fresh;
}

/* `begun`: the step before had this input. If not, this is the first of all, or after a reset. */
static void run_rest(struct run *run, int begun)
{
    uint32_t full = first_step(run).step.work, done = 0, spent = 0;
    uint32_t expected = full ? (full + run->budget - 1) / run->budget : 1;
    int alone = run->stage.scene->segments == 1 && run->stage.scene->bodies == 1;
    uint32_t allowed = (uint32_t)ceil((alone ? search_most_alone : search_most) * expected);
    for (uint32_t rest = 1; rest <= expected + 3 || (!done && rest <= allowed); rest++) {
        int exact = run_tick(run, begun || rest > 1);
        uint32_t work = run->found.step.work;
        CHECK(!done || exact, "%s, tick %u: work %u, no longer exact", run->what, run->tick, work);
        CHECK(exact || work == run->budget, "%s, tick %u: only %u done", run->what, run->tick,
              work);
        done = exact && !done ? rest : done;
        spent += work;
    }
    CHECK(done && done <= allowed, "%s, tick %u: exact at rest's tick %u, not %u; full search %u",
          run->what, run->tick, done, allowed, full);
    all.slowest = fmax(all.slowest, (double)spent / (full > 16 ? full : 16));
    all.full += full;
    all.spent += spent;
    all.rests++;
    all.late += done > expected;
}

/* What happens between two ticks. Returns 1 if the next one knows nothing. */
static int run_event(struct run *run)
{
    struct stage *stage = &run->stage;
    struct side *const sides[2] = { &run->found, &run->truth };
    enum { LEAVES_OR_COMES, APPROACHES, RETIRES, TELEPORT, RESET, EVENTS };
    uint32_t event = (uint32_t)(random_bits(&stage->random) % (EVENTS + 2));
    uint32_t b = (uint32_t)(random_bits(&stage->random) % stage->scene->bodies);
    struct place *place = &stage->places[b];
    if ((event < TELEPORT && !b) || event >= EVENTS)
        return 0;
    /* Who comes is another one, in the slot of who left. */
    if (event == LEAVES_OR_COMES && !place->there)
        place->mesh = place->mesh == small.mesh ? subject.mesh : small.mesh;
    if (event == APPROACHES || event == RETIRES || (event == LEAVES_OR_COMES && !place->there))
        for (int k = 0; k < 3; k++)
            place->pose.position[k] = stage->pose.position[k] + (event == RETIRES ? 9.0 : 0.4) *
                                                                    stage->size *
                                                                    one(&stage->random);
    for (int i = 0; i < 2; i++) {
        dpt_world *world = sides[i]->world;
        if (event == LEAVES_OR_COMES && place->there)
            CHECK(dpt_body_remove(world, sides[i]->body[b]) == DPT_OK, "remove");
        else if (event == LEAVES_OR_COMES)
            side_add_body(sides[i], stage, b);
        else if (event == TELEPORT)
            CHECK(dpt_tool_teleport(world, sides[i]->tool, &stage->pose) == DPT_OK, "teleport");
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
    uint32_t i = run->tick % run->stage.scene->segments;
    double ends[6], least = HUGE_VAL;
    memcpy(ends, run->stage.now[i].a, sizeof ends / 2);
    memcpy(ends + 3, run->stage.now[i].b, sizeof ends / 2);
    for (uint32_t b = 0; b < run->stage.scene->bodies; b++) {
        const struct place *place = &run->stage.places[b];
        dpt_hit hit = DPT_HIT_INIT;
        if (place->there)
            dpt_query_segments(place->mesh, &place->pose, ends, NULL, 1, &hit, &def);
        least = place->there ? fmin(least, hit.distance) : least;
    }
    const dpt_hit *truth = &run->truth.hits[i];
    CHECK(fabs(least - truth->distance) <= 2.0 * truth->error_bound, "%s: %.17g, brute force %.17g",
          run->what, truth->distance, least);
    all.brute++;
}

static void follow(struct run *run, int motion)
{
    run_open(run);
    run_rest(run, 0);
    while (run->tick < ticks) {
        uint32_t most = motion == REST ? 1 : motion == JUMP ? 3 : 24;
        uint32_t moves = 1 + (uint32_t)(random_bits(&run->stage.random) % most);
        int knows = !run_event(run);
        for (uint32_t i = 0; i < moves && knows; i++) {
            stage_move(&run->stage, motion, &run->truth.hits[0]);
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
            centre[k] = one(&random);
        for (uint32_t i = 0; i < 9; i++)
            vertices[9 * t + i] =
                0.15 * centre[i % 3] / gap_of(centre, origin) + size * one(&random);
        for (uint32_t k = 3 * t; k < 3 * t + 3; k++)
            corners[k] = k;
    }
    return fixture_from_arrays(fixture, vertices, 3 * COUNT, corners, COUNT);
}

static int subject_open(uint32_t s)
{
    return s == SUBJECTS - 1 ? confetti(&subject)
                             : fixture_from_shape(&subject, names[s], s == 0 ? 5568 : 0);
}

static double percent(uint64_t part)
{
    return 100.0 * (double)part / (double)all.asked;
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
                snprintf(run.what, sizeof run.what, "%s, %s, budget %u, %u bytes, scene %u",
                         names[s], motions[motion], run.budget, (unsigned)run.bytes, scene);
                stage_start(&run.stage, &scenes[scene], 31 * count + 7);
                follow(&run, (int)motion);
            }
        fixture_free(&subject);
    }
    printf(
        "    %llu ticks, %llu answers, %.0f %% bounded, %.0f %% crossing; %llu ticks without the "
        "force they should have; %llu against brute force\n",
        (unsigned long long)all.ticks, (unsigned long long)all.asked, percent(all.bounded),
        percent(all.crossing), (unsigned long long)all.silent, (unsigned long long)all.brute);
    printf("    %llu rests, %.2f of a full search each, %.2f at most, %llu late; "
           "error bounds at most %.2f of what motion allows\n",
           (unsigned long long)all.rests, (double)all.spent / (double)all.full, all.slowest,
           (unsigned long long)all.late, all.loosest);
    CHECK(all.late * 50 <= all.rests, "%llu late", (unsigned long long)all.late);
    CHECK(percent(all.bounded) > 10.0 && percent(all.bounded) < 90.0, "one-sided");
    CHECK(percent(all.crossing) > 2.0 && percent(all.crossing) < 50.0, "one-sided");
    CHECK(all.silent > 100 && all.brute > 50, "too few");
}

/* Half of what a slow slide needs: what is lost, and that every segment has its turn. */
static void half_of_the_need(void)
{
    static struct run run;
    static const uint32_t at[] = { 0, 3, 2, 5 };
    uint32_t count = ticks > 100 ? 4 * ticks : 400;
    for (uint32_t n = 0; n < 4; n++) {
        const struct scene *scene = &scenes[at[n]];
        uint64_t work = 0, exact = 0;
        uint32_t waits[SEGMENTS_MAX] = { 0 }, longest = 0;
        double lost = 0.0, asked = (double)count * scene->segments;
        run.bytes = 1 << 20;
        for (int pass = 0; pass < 2; pass++) {
            stage_start(&run.stage, scene, 5 + n);
            run.budget = pass ? (uint32_t)(work / count / 2 + 1) : 1 << 30;
            snprintf(run.what, sizeof run.what, "slow, budget %u, scene %u", run.budget, at[n]);
            run_open(&run);
            for (uint32_t tick = 0; tick < count; tick++) {
                stage_move(&run.stage, SLIDE, &run.truth.hits[0]);
                run_tick(&run, 0);
                work += pass ? 0 : run.found.step.work;
                for (uint32_t i = 0; pass && i < scene->segments; i++) {
                    const dpt_hit *hit = &run.found.hits[i];
                    waits[i] = hit->status == DPT_STATUS_EXACT ? 0 : waits[i] + 1;
                    longest = waits[i] > longest ? waits[i] : longest;
                    exact += !waits[i];
                    lost += (hit->distance - hit->lower_bound) / run.stage.size;
                }
            }
            run_close(&run);
        }
        printf("    %2u segments, %u bodies, budget %2u: %.0f %% exact, error bound %.2g of the "
               "size, at most %u ticks from one exact answer to the next\n",
               scene->segments, scene->bodies, run.budget, 100.0 * (double)exact / asked,
               lost / asked, longest + 1);
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
    stage_start(&run.stage, &scenes[5], 9);
    run.bytes = 1 << 20;
    struct side fresh = first_step(&run);
    run.budget = fresh.step.work / 6;
    for (uint32_t i = 0; i < scenes[5].segments; i++)
        run.budget = fresh.hits[i].work > run.budget ? fresh.hits[i].work : run.budget;
    snprintf(run.what, sizeof run.what, "pauses, budget %u", run.budget);
    run_open(&run);
    for (uint32_t tick = 0; tick < 8 * ticks; tick++) {
        if (tick % CYCLE == 0)
            stage_move(&run.stage, SLIDE, &run.truth.hits[0]);
        run_tick(&run, tick % CYCLE != 0);
        for (uint32_t i = 0; i < scenes[5].segments; i++) {
            waits[i] = run.found.hits[i].status == DPT_STATUS_EXACT ? 0 : waits[i] + 1;
            CHECK(waits[i] <= CYCLE * scenes[5].segments, "tick %u: segment %u waits", tick, i);
        }
    }
    run_close(&run);
}

/* A tool that rests beside one that moves, and is never done, is exact before long. */
static void who_moves_leaves_something(void)
{
    struct fixture liver;
    if (!fixture_from_shape(&liver, "liver", 5000))
        return;
    for (uint32_t budget = 1; budget <= 4; budget++) {
        const dpt_segment resting = { { 0.0, -0.1, -0.15 }, { 0.0, 0.1, -0.15 }, 0.0 };
        dpt_segment moving = { { -0.1, 0.0, 0.15 }, { 0.1, 0.0, 0.15 }, 0.0 };
        dpt_world_def def;
        dpt_world *world;
        dpt_body body;
        dpt_tool tools[2];
        dpt_hit hit = DPT_HIT_INIT;
        uint32_t tick = 0;
        dpt_world_def_init(&def);
        def.budget = budget;
        def.until = DPT_UNTIL_TRACK;
        void *block = malloc(dpt_world_bytes(&def));
        CHECK(block && dpt_world_create(block, dpt_world_bytes(&def), &def, &world) == DPT_OK &&
                  dpt_body_add(world, liver.mesh, NULL, &body) == DPT_OK &&
                  dpt_tool_add(world, &moving, 1, &tools[0]) == DPT_OK &&
                  dpt_tool_add(world, &resting, 1, &tools[1]) == DPT_OK,
              "world");
        for (; hit.status != DPT_STATUS_EXACT && tick < 400; tick++) {
            moving.a[1] = moving.b[1] = 1e-4 * (tick % 7);
            dpt_tool_set_segments(world, tools[0], &moving, 1);
            dpt_world_step(world, 1e-3, NULL);
            dpt_tool_get_hit(world, tools[1], &hit);
        }
        CHECK(tick < 100, "budget %u: exact at tick %u", budget, tick);
        free(block);
    }
    fixture_free(&liver);
}

/* Poses that come every second tick, of a device that is slower than the loop, are motion, not rests. */
static void held_poses_are_motion(void)
{
    static struct run run;
    uint32_t exact[2] = { 0, 0 };
    for (uint32_t hold = 1; hold <= 2; hold++) {
        stage_start(&run.stage, &scenes[0], 4);
        run.bytes = 1 << 20;
        run.budget = 9;
        snprintf(run.what, sizeof run.what, "held for %u", hold);
        run_open(&run);
        for (uint32_t tick = 0; tick < 10 * ticks; tick++) {
            if (tick % hold == 0)
                stage_move(&run.stage, SLIDE, &run.truth.hits[0]);
            run_tick(&run, tick % hold != 0);
            exact[hold - 1] += run.found.hits[0].status == DPT_STATUS_EXACT;
        }
        run_close(&run);
    }
    printf("    exact with a pose every tick %u, every second %u of %u\n", exact[0], exact[1],
           10 * ticks);
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
        struct stage *stage = &run.stage;
        stage_start(stage, &scenes[3], 21);
        run.budget = budgets[b];
        run.bytes = caches[b % CACHES];
        snprintf(run.what, sizeof run.what, "tremble, budget %u", run.budget);
        stage->pose.position[2] = 0.8 * stage->size;
        for (uint32_t i = 1; i < 3; i++)
            stage->places[i].pose.position[2] = -9.0 * stage->size;
        stage_set_tool(stage);
        run_open(&run);
        uint32_t full = first_step(&run).step.work, came = 8 + 2 * full / run.budget, tick = 0;
        for (; tick < came || run.found.hits[0].body != run.found.body[2]; tick++) {
            if (tick > 10 * came)
                break;
            stage->pose.position[tick % 3] += (tick / 3 % 2 ? 1e-4 : -1e-4) * stage->size;
            if (tick == came) {
                memcpy(stage->places[2].pose.position, stage->pose.position, 3 * sizeof(double));
                run_forgets(&run);
            }
            stage_set_tool(stage);
            run_tick(&run, 0);
        }
        CHECK(tick <= 10 * came, "%s: not found in %u ticks", run.what, tick - came);
        run_close(&run);
    }
}

/*
 * A point in a torus' hole, 0.03 m under a sheet. Nothing of the torus is as near, which is proven;
 * then another sheet, 0.01 m below the point, takes its slot and its pose.
 */
static void what_was_proven_leaves_with_its_body(void)
{
    const dpt_segment point = { { 0.0, 0.0, 0.01 }, { 0.0, 0.0, 0.01 }, 0.0 };
    const dpt_pose above = { { 0.0, 0.0, 0.04 }, { 1.0, 0.0, 0.0, 0.0 } };
    struct fixture sheet;
    if (!fixture_from_shape(&sheet, "membrane", 0))
        return;
    for (uint32_t b = 0; b < BUDGETS; b++) {
        dpt_world_def def;
        dpt_world *world;
        dpt_body first, second;
        dpt_tool tool;
        dpt_hit hit = DPT_HIT_INIT;
        dpt_world_def_init(&def);
        def.budget = budgets[b];
        void *block = malloc(dpt_world_bytes(&def));
        if (dpt_world_create(block, dpt_world_bytes(&def), &def, &world) != DPT_OK)
            exit(2);
        dpt_body_add(world, sheet.mesh, &above, &first);
        dpt_body_add(world, small.mesh, NULL, &second);
        dpt_tool_add(world, &point, 1, &tool);
        for (int pass = 0; pass < 2; pass++) {
            double truth = pass ? 0.01 : 0.03;
            for (int tick = 0; tick < 100; tick++) {
                CHECK(dpt_world_step(world, 1e-3, NULL) == DPT_OK, "step");
                dpt_tool_get_hit(world, tool, &hit);
                CHECK(hit.lower_bound <= truth + 1e-8, "budget %u: %g", def.budget,
                      hit.lower_bound);
            }
            CHECK(hit.status == DPT_STATUS_EXACT && fabs(hit.distance - truth) < 1e-8,
                  "budget %u: status %u, %g", def.budget, hit.status, hit.distance);
            dpt_body_remove(world, second);
            dpt_body_add(world, sheet.mesh, NULL, &second);
        }
        free(block);
    }
    fixture_free(&sheet);
}

/*
 * A budget that is never reached costs nothing: all is exact, and the same. (Not the same bits: what is
 * proven already is not searched again, and of two triangles as near either may be named.)
 */
/* Where the nearest pair alone is asked, a rest that is proven costs nothing more. */
static void a_proven_rest_costs_nothing(void)
{
    struct fixture mesh;
    if (!fixture_from_shape(&mesh, "torus", 5568))
        return;
    dpt_world_def def;
    dpt_world_def_init(&def);
    def.budget = 3;
    def.until = DPT_UNTIL_TRACK;
    void *block = malloc(dpt_world_bytes(&def));
    dpt_world *world = NULL;
    dpt_body body;
    dpt_tool tool;
    dpt_world_create(block, dpt_world_bytes(&def), &def, &world);
    dpt_body_add(world, mesh.mesh, NULL, &body);
    const dpt_segment segment = { { 0.02, 0.01, 0.2 }, { 0.3, 0.1, 0.25 }, 0.0 };
    dpt_tool_add(world, &segment, 1, &tool);
    uint32_t exact = 0, rests = 0;
    for (uint32_t tick = 0; tick < 1000 && rests < 20; tick++) {
        dpt_step step = { .size = sizeof step };
        dpt_world_step(world, 1e-3, &step);
        CHECK(!exact || (step.status == DPT_STATUS_EXACT && step.work == 0),
              "tick %u: status %u, work %u though exact", tick, step.status, step.work);
        rests += exact;
        exact |= step.status == DPT_STATUS_EXACT;
    }
    CHECK(rests == 20, "exact in %u ticks only", rests);
    free(block);
    fixture_free(&mesh);
}

static void budget_out_of_reach(void)
{
    for (uint32_t n = 0; n < SCENES * MOTIONS; n++) {
        struct stage stage;
        struct side sides[2];
        int motion = (int)(n % MOTIONS);
        stage_start(&stage, &scenes[n / MOTIONS], n + 70);
        for (uint32_t i = 0; i < 2; i++)
            side_open(&sides[i], &stage, DPT_METHOD_EXACT, i ? UINT32_MAX : 0, caches[n % CACHES]);
        for (uint32_t tick = 0; tick < ticks && motion != REST; tick++) {
            for (int i = 0; i < 2; i++)
                side_step(&sides[i], &stage);
            for (uint32_t i = 0; i < stage.scene->segments; i++) {
                dpt_hit *with = &sides[1].hits[i], *without = &sides[0].hits[i];
                double apart = fabs(with->distance - without->distance);
                CHECK(with->status == DPT_STATUS_EXACT && apart <= with->error_bound &&
                          with->error_bound == without->error_bound,
                      "%s, %u segments, tick %u: %.17g, without a budget %.17g", motions[motion],
                      stage.scene->segments, tick, with->distance, without->distance);
            }
            do
                stage_move(&stage, motion, &sides[0].hits[0]);
            while (!(stage.moved > 0.0));
        }
        free(sides[0].block);
        free(sides[1].block);
    }
}

/* The same calls give the same bits: in another world, and after a reset. */
static void same_calls_same_bits(void)
{
    for (uint32_t n = 0; n < 2 * SCENES; n++) {
        struct stage stage, begin;
        struct side sides[2];
        uint64_t hash[4] = { 0 };
        stage_start(&begin, &scenes[n % SCENES], n + 3);
        for (int i = 0; i < 2; i++)
            side_open(&sides[i], &begin, DPT_METHOD_EXACT, budgets[n % BUDGETS],
                      caches[n % CACHES]);
        for (uint32_t pass = 0; pass < 4; pass++) {
            struct side *side = &sides[pass % 2];
            CHECK(pass < 2 || dpt_world_reset(side->world) == DPT_OK, "reset");
            stage = begin;
            for (uint32_t tick = 0; tick < 2 * ticks; tick++) {
                const unsigned char *byte = (const unsigned char *)side->hits;
                side_step(side, &stage);
                for (size_t k = 0; k < stage.scene->segments * sizeof *side->hits; k++)
                    hash[pass] = (hash[pass] ^ byte[k]) * 0x100000001b3u;
                if (tick % 30 < 20)
                    stage_move(&stage, tick % 60 < 30 ? MOVED : SLIDE, &side->hits[0]);
            }
            CHECK(hash[pass] == hash[0], "scene %u, pass %u", n % SCENES, pass);
        }
        free(sides[0].block);
        free(sides[1].block);
    }
}

static uint32_t some(uint64_t *random)
{
    return 1 + (uint32_t)(random_bits(random) % 2000);
}

static void a_def_says_what_it_costs(void)
{
    uint64_t random = 4;
    char block[64] = { 0 };
    dpt_world *world = NULL;
    for (uint32_t n = 0; n < 1000; n++) {
        dpt_world_def def;
        dpt_world_def_init(&def);
        CHECK(def.budget == 0, "a budget by default");
        uint64_t bodies = def.max_bodies = some(&random), tools = def.max_tools = some(&random);
        uint64_t segments = def.max_segments = some(&random), both = segments * bodies;
        def.certificate_bytes = random_bits(&random) % 100000;
        def.budget = n % 2 * some(&random);
        uint64_t contacts = def.max_contacts = n % 3 * some(&random);
        const size_t bytes = dpt_world_bytes(&def);
        CHECK(bytes >= 24 * bodies + 24 * tools + 200 * segments + 200 * contacts + 12 * both,
              "%zu bytes cannot hold it", bytes);
        CHECK(bytes <= (1 << 20) + 2048 * (bodies + tools + contacts) + 10000 * segments +
                           80 * both + def.certificate_bytes,
              "%zu bytes", bytes);
        def.method = DPT_METHOD_TREE + n / 2 % 3;
        CHECK((dpt_world_bytes(&def) == 0) == (def.budget > 0), "method %u", def.method);
        dpt_result made = dpt_world_create(block, sizeof block, &def, &world);
        CHECK(made == (def.budget ? DPT_E_ARGUMENT : DPT_E_MEMORY), "%s", dpt_result_name(made));
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        ticks = (uint32_t)strtoul(argv[1], NULL, 10);
    TEST(a_def_says_what_it_costs);
    if (!fixture_from_shape(&small, "torus", 600))
        return 2;
    TEST(bounded_answers_are_true);
    if (!subject_open(0))
        return 2;
    TEST(half_of_the_need);
    TEST(pauses_serve_every_segment);
    TEST(who_moves_leaves_something);
    TEST(held_poses_are_motion);
    TEST(no_body_starves);
    TEST(what_was_proven_leaves_with_its_body);
    TEST(a_proven_rest_costs_nothing);
    TEST(budget_out_of_reach);
    TEST(same_calls_same_bits);
    fixture_free(&subject);
    fixture_free(&small);
    return check_report();
}
