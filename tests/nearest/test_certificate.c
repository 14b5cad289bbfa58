/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The certificate against the tree, which keeps nothing: every tick of a tool that rests, slides, spins, flies
 * and jumps near a mesh that may move too, with a cache of every size. The tree is held against brute force
 * on a sample here and on every tick in test_exactness.c; what both share, the pair, test_pair.c judges.
 *
 *     test_certificate [TICKS]   of each mesh, motion and cache; the default is what make check runs
 */
#include "lib/fixture.h"
#include "lib/rig.h"

#if defined(__SANITIZE_ADDRESS__)
static uint32_t ticks = 800;
#else
static uint32_t ticks = 8400;
#endif

enum motion { REST, SLIDE, SPIN, FLY, JUMP, MOVED, MOTIONS };
static const char *const motions[MOTIONS] = { "rest", "slide", "spin", "fly", "jump", "moved" };

static const struct subject {
    const char *name;
    uint64_t triangles;
} subjects[] = { { "torus", 5568 }, { "liver", 0 }, { "membrane", 0 }, { "star", 0 }, { "soup", 3000 } };

/* Worlds that differ in method and memory alone. */
static int twin_open(struct rig *twin, const dpt_mesh *mesh, uint32_t method, uint64_t bytes,
                     const dpt_segment *segment)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.max_contacts = 0;
    def.max_bodies = 3;
    def.max_tools = def.max_segments = 2;
    def.method = method;
    def.until = DPT_UNTIL_TRACK;
    def.certificate_bytes = bytes;
    return rig_open(twin, &def, mesh, segment, 1);
}

static dpt_hit twin_step(struct rig *twin, const dpt_segment *segment)
{
    dpt_tool_set_segments(twin->world, twin->tool, segment, 1);
    rig_tick(twin);
    return twin->hit;
}

static double one(uint64_t *random)
{
    return 2.0 * shape_random(random) - 1.0;
}

/*
 * What no one should be given: triangles of all sizes, that cut each other, slivers a millionth as wide as long,
 * edges that many share, and the same triangle twice, both ways around.
 */
static int soup(struct fixture *fixture, uint32_t count)
{
    double *vertices = malloc(9 * sizeof *vertices * (size_t)count);
    uint32_t *corners = malloc(3 * sizeof *corners * (size_t)count);
    uint64_t random = 99;
    int opened = 0;
    for (uint32_t i = 0; vertices && corners && i < count; i++) {
        double *v = vertices + 9 * (size_t)i, size = 0.1 * pow(1e-3, shape_random(&random));
        double thin = i % 5 ? 1.0 : 1e-6;
        for (int k = 0; k < 3; k++) {
            v[k] = 0.15 * one(&random);
            v[3 + k] = v[k] + size * one(&random);
            v[6 + k] = v[3 + k] + thin * size * one(&random);
            corners[3 * i + (uint32_t)k] = 3 * i + (uint32_t)k;
        }
        if (i % 7 == 0 && i > 30)
            corners[3 * i] = corners[3 * (i - 21)];
        if (i % 11 == 0 && i > 30) {
            corners[3 * i] = corners[3 * (i - 8) + 1];
            corners[3 * i + 1] = corners[3 * (i - 8)];
        }
        if (i % 50 == 1)
            for (uint32_t k = 0; k < 3; k++)
                corners[3 * i + k] = corners[3 * (i - 1) + (i % 100 ? 2 - k : k)];
    }
    if (vertices && corners)
        opened = fixture_from_arrays(fixture, vertices, 3 * (size_t)count, corners, count);
    free(vertices);
    free(corners);
    return opened;
}

static int subject_open(const struct subject *subject, struct fixture *fixture)
{
    if (!strcmp(subject->name, "soup"))
        return soup(fixture, (uint32_t)subject->triangles);
    return fixture_from_shape(fixture, subject->name, subject->triangles);
}

static void unit(double v[3])
{
    double size = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++)
        v[k] = size > 0.0 ? v[k] / size : k == 0;
}

/* A tool near a mesh: drawn to the surface, past it, and on. */
struct tool {
    uint64_t random;
    double centre[3], axis[3], way[3], turn[3];
    double length, size;
};

static void tool_start(struct tool *tool, const dpt_mesh_info *info, uint64_t seed)
{
    tool->random = seed;
    tool->size = 0.0;
    for (int k = 0; k < 3; k++) {
        double low = info->box_min[k], high = info->box_max[k];
        tool->size = fmax(tool->size, high - low);
        tool->centre[k] = 0.5 * (low + high) + 0.6 * one(&tool->random) * (high - low);
        tool->axis[k] = one(&tool->random);
        tool->way[k] = one(&tool->random);
        tool->turn[k] = one(&tool->random);
    }
    unit(tool->axis);
    unit(tool->way);
    tool->length = tool->size * pow(10.0, 0.5 - 3.0 * shape_random(&tool->random));
}

static void tool_move(struct tool *tool, int motion, uint32_t tick, const dpt_hit *hit)
{
    static const double speeds[MOTIONS] = { 0.0, 1e-3, 2e-4, 7e-3, 1e-3, 1e-3 };
    double speed = speeds[motion] * tool->size, turn = motion == SPIN ? 0.05 : 3.0 * speeds[motion];
    if (motion == REST && tick % 50 == 0)
        speed = 0.01 * tool->size;
    if (tick % 200 == 0)
        for (int k = 0; k < 3; k++) {
            tool->way[k] = one(&tool->random);
            tool->turn[k] = one(&tool->random);
        }
    unit(tool->way);
    int far = hit->distance > 0.02 * tool->size;
    for (int k = 0; k < 3; k++) {
        double home = far ? (hit->q[k] - hit->p[k]) / hit->distance : 0.0;
        tool->centre[k] += speed * (tool->way[k] + 1.5 * home);
        tool->axis[k] += turn * tool->turn[k];
        if (motion == JUMP && tick % 20 == 0)
            tool->centre[k] = hit->q[k] + 0.3 * tool->size * one(&tool->random);
    }
    unit(tool->axis);
}

static dpt_segment tool_segment(const struct tool *tool)
{
    dpt_segment segment = { .radius = 0.0 };
    for (int k = 0; k < 3; k++) {
        segment.a[k] = tool->centre[k] - 0.5 * tool->length * tool->axis[k];
        segment.b[k] = tool->centre[k] + 0.5 * tool->length * tool->axis[k];
    }
    return segment;
}

static dpt_pose body_pose(uint32_t tick, double size)
{
    double angle = 1e-3 * tick, x = 0.1 * size * sin(0.01 * tick);
    return (dpt_pose){ { x, -x, 0.5 * x }, { cos(angle), 0.6 * sin(angle), 0.0, 0.8 * sin(angle) } };
}

static struct tally {
    uint64_t ticks, crossing, brute;
    double worst; /* in error bounds */
} all;

static void agree(const dpt_hit *exact, const dpt_hit *truth, const char *what, uint32_t tick)
{
    double bound = exact->error_bound + truth->error_bound;
    double error = fabs(exact->distance - truth->distance);
    CHECK(exact->status == DPT_STATUS_EXACT, "%s, tick %u: status %u", what, tick, exact->status);
    CHECK(error <= bound, "%s, tick %u: %.17g, the truth is %.17g", what, tick, exact->distance, truth->distance);
    CHECK((exact->distance == 0.0) == (truth->distance == 0.0) || error <= bound, "%s, tick %u: missed crossing", what,
          tick);
    CHECK(exact->lower_bound <= truth->distance + truth->error_bound, "%s, tick %u: lower bound", what, tick);
    if (error / bound > all.worst)
        all.worst = error / bound;
}

/* One mesh, one motion, one size of cache. */
static void follow(const struct subject *subject, const dpt_mesh *mesh, int motion, uint64_t bytes)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(mesh, &info);
    struct tool tool;
    struct rig exact, tree, brute;
    char what[64];
    snprintf(what, sizeof what, "%s, %s, %u bytes", subject->name, motions[motion], (unsigned)bytes);
    tool_start(&tool, &info, 77u * (uint64_t)motion + bytes + 5);
    dpt_segment segment = tool_segment(&tool);
    int opened = twin_open(&exact, mesh, DPT_METHOD_EXACT, bytes, &segment) +
                 twin_open(&tree, mesh, DPT_METHOD_TREE, 0, &segment) +
                 twin_open(&brute, mesh, DPT_METHOD_BRUTE, 0, &segment);
    CHECK(opened == 3, "%s: worlds", what);
    uint32_t every = ticks / 4 * (1 + info.triangles / 10000);
    every = every < 20000 ? every : 20000;
    for (uint32_t tick = 0; opened == 3 && tick < ticks; tick++) {
        if (motion == MOVED) {
            dpt_pose pose = body_pose(tick, tool.size);
            dpt_body_set_pose(exact.world, exact.body, &pose);
            dpt_body_set_pose(tree.world, tree.body, &pose);
            dpt_body_set_pose(brute.world, brute.body, &pose);
        }
        if (tick % 1500 == 0)
            tool_start(&tool, &info, tool.random);
        segment = tool_segment(&tool);
        dpt_hit found = twin_step(&exact, &segment), truth = twin_step(&tree, &segment);
        agree(&found, &truth, what, tick);
        all.crossing += truth.distance == 0.0;
        all.ticks++;
        if (tick % every == every / 2) {
            dpt_hit sample = twin_step(&brute, &segment);
            agree(&truth, &sample, "tree against brute force", tick);
            all.brute++;
        }
        tool_move(&tool, motion, tick, &truth);
    }
    rig_close(&exact);
    rig_close(&tree);
    rig_close(&brute);
}

/* What every block of a mesh needs. */
static uint64_t whole_cache(const dpt_mesh *mesh)
{
    dpt_mesh_info info = { .size = sizeof info };
    dpt_mesh_get_info(mesh, &info);
    uint64_t blocks = 1;
    for (uint64_t nodes = (info.triangles + 15) / 16; nodes > 1; nodes = (nodes + 15) / 16)
        blocks += nodes;
    return 272 * blocks;
}

static void certificate_is_the_tree(void)
{
    for (size_t s = 0; s < sizeof subjects / sizeof *subjects; s++) {
        struct fixture fixture;
        if (!subject_open(&subjects[s], &fixture))
            continue;
        uint64_t whole = whole_cache(fixture.mesh);
        const uint64_t caches[] = { 0, 272, whole / 10, whole, 3 * whole };
        for (size_t c = 0; c < sizeof caches / sizeof *caches; c++)
            for (int motion = 0; motion < MOTIONS; motion++)
                follow(&subjects[s], fixture.mesh, motion, caches[c]);
        fixture_free(&fixture);
    }
    printf("    %llu ticks, %.0f %% crossing, %llu of them against brute force; worst %.2f of the bounds\n",
           (unsigned long long)all.ticks, 100.0 * (double)all.crossing / (double)all.ticks,
           (unsigned long long)all.brute, all.worst);
    CHECK(all.crossing * 20 > all.ticks && all.crossing * 20 < 19 * all.ticks, "one-sided");
    CHECK(all.brute > 100, "%llu", (unsigned long long)all.brute);
}

/* Planes cost less than a search: in work units, along the same slide. */
static void what_is_kept_saves_work(void)
{
    struct fixture fixture;
    dpt_mesh_info info = { .size = sizeof info };
    struct tool tool;
    struct rig kept, none;
    uint64_t with = 0, without = 0;
    if (!fixture_from_shape(&fixture, "liver", 0))
        return;
    dpt_mesh_get_info(fixture.mesh, &info);
    tool_start(&tool, &info, 3);
    tool.length = 0.5 * tool.size;
    dpt_segment segment = tool_segment(&tool);
    twin_open(&kept, fixture.mesh, DPT_METHOD_EXACT, 1 << 20, &segment);
    twin_open(&none, fixture.mesh, DPT_METHOD_EXACT, 0, &segment);
    for (uint32_t tick = 0; tick < 500; tick++) {
        segment = tool_segment(&tool);
        dpt_hit a = twin_step(&kept, &segment), b = twin_step(&none, &segment);
        with += a.work;
        without += b.work;
        CHECK(tick > 0 || a.work == b.work, "the first tick has nothing to keep: %u, %u", a.work, b.work);
        tool_move(&tool, SPIN, tick + 1, &b);
    }
    printf("    %llu units with planes, %llu without\n", (unsigned long long)with, (unsigned long long)without);
    CHECK(with < without, "%llu, %llu", (unsigned long long)with, (unsigned long long)without);
    rig_close(&kept);
    rig_close(&none);
    fixture_free(&fixture);
}

/*
 * A tool that jumps by more than 1/64 of the diagonal on each tick does no more work than the tree, but for what a motion in
 * which planes are of use takes: with planes on each tick it did up to three times as much.
 */
static void jumps_cost_what_the_tree_does(void)
{
    static const double jumps[] = { 0.02, 0.05, 0.2, 0.7 };
    for (size_t i = 0; i < sizeof subjects / sizeof subjects[0]; i++) {
        struct fixture fixture;
        dpt_mesh_info info = { .size = sizeof info };
        if (!subject_open(&subjects[i], &fixture))
            continue;
        dpt_mesh_get_info(fixture.mesh, &info);
        const double diagonal =
            sqrt(pow(info.box_max[0] - info.box_min[0], 2) + pow(info.box_max[1] - info.box_min[1], 2) +
                 pow(info.box_max[2] - info.box_min[2], 2));
        for (size_t j = 0; j < sizeof jumps / sizeof jumps[0]; j++) {
            uint64_t random = 5, work = 0, of_tree = 0;
            struct rig exact, tree;
            double x[3], way[3];
            for (int k = 0; k < 3; k++)
                x[k] = info.box_max[k];
            dpt_segment segment = { { x[0], x[1], x[2] }, { x[0], x[1], x[2] + 0.5 * diagonal }, 0 };
            twin_open(&exact, fixture.mesh, DPT_METHOD_EXACT, 1 << 20, &segment);
            twin_open(&tree, fixture.mesh, DPT_METHOD_TREE, 0, &segment);
            for (uint32_t tick = 0; tick < 600; tick++) {
                for (int k = 0; k < 3; k++)
                    way[k] = one(&random);
                unit(way);
                for (int k = 0; k < 3; k++) {
                    const double to = x[k] + jumps[j] * diagonal * way[k];
                    const double room = 0.1 * diagonal;
                    if (to < info.box_min[k] - room || to > info.box_max[k] + room)
                        way[k] = -way[k];
                    x[k] += jumps[j] * diagonal * way[k];
                    segment.a[k] = x[k];
                    segment.b[k] = x[k] + (k == 2 ? 0.5 * diagonal : 0.0);
                }
                const dpt_hit a = twin_step(&exact, &segment), b = twin_step(&tree, &segment);
                agree(&a, &b, subjects[i].name, tick);
                work += tick ? a.work : 0;
                of_tree += tick ? b.work : 0;
            }
            CHECK((double)work < 1.1 * (double)of_tree, "%s, jumps of %g: %llu units, %llu of the tree",
                  subjects[i].name, jumps[j], (unsigned long long)work, (unsigned long long)of_tree);
            rig_close(&exact);
            rig_close(&tree);
        }
        fixture_free(&fixture);
    }
}

/* A tool that is pushed through a mesh: what it crosses next is found over edges, without a search. */
static void crossings_are_walked_to(void)
{
    struct fixture fixture;
    struct rig exact, tree;
    dpt_mesh_info info = { .size = sizeof info };
    uint32_t moves = 0, walks = 0, last = DPT_NONE;
    if (!fixture_from_shape(&fixture, "liver", 0))
        return;
    dpt_mesh_get_info(fixture.mesh, &info);
    double middle[3], size = info.box_max[0] - info.box_min[0];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (info.box_min[k] + info.box_max[k]);
    dpt_segment segment = { { middle[0], middle[1], middle[2] - size },
                            { middle[0], middle[1], middle[2] + size },
                            0.0 };
    twin_open(&exact, fixture.mesh, DPT_METHOD_EXACT, 1 << 20, &segment);
    twin_open(&tree, fixture.mesh, DPT_METHOD_TREE, 0, &segment);
    for (uint32_t tick = 0; tick < 2000; tick++) {
        for (int k = 0; k < 2; k++) {
            segment.a[k] = middle[k] + 0.1 * size * sin(2e-2 * tick + k);
            segment.b[k] = middle[k] + 0.1 * size * cos(3e-2 * tick - k);
        }
        dpt_hit a = twin_step(&exact, &segment), b = twin_step(&tree, &segment);
        agree(&a, &b, "pushed through", tick);
        moves += tick > 0 && a.triangle != last;
        walks += tick > 0 && a.triangle != last && a.work <= 4;
        last = a.triangle;
    }
    printf("    %u times onto another triangle, %u of them over at most 4 edges\n", moves, walks);
    CHECK(moves > 200 && walks * 20 > moves * 19, "%u of %u", walks, moves);
    rig_close(&exact);
    rig_close(&tree);
    fixture_free(&fixture);
}

/* A slot's next body, and a segment that moves up, must not meet the planes of those before. */
static void planes_leave_with_their_owner(void)
{
    struct fixture small, large;
    struct rig exact, tree;
    if (!fixture_from_shape(&small, "torus", 600) || !fixture_from_shape(&large, "liver", 5000))
        return;
    const dpt_segment far = { { 0.2, 0.1, 0.3 }, { 0.25, 0.1, 0.3 }, 0.0 };
    const dpt_segment near = { { -0.1, 0.0, 0.09 }, { 0.1, 0.02, 0.1 }, 0.0 };
    struct rig *const twins[2] = { &exact, &tree };
    dpt_hit hit[2];
    twin_open(&exact, small.mesh, DPT_METHOD_EXACT, 1 << 20, &near);
    twin_open(&tree, small.mesh, DPT_METHOD_TREE, 0, &near);
    for (int i = 0; i < 2; i++) {
        dpt_tool second;
        hit[i] = twin_step(twins[i], &near);
        CHECK(dpt_body_remove(twins[i]->world, twins[i]->body) == DPT_OK, "remove");
        twins[i]->body = rig_add_body(twins[i], large.mesh, NULL);
        hit[i] = twin_step(twins[i], &near);
        second = rig_add_tool(twins[i], &far, 1);
        rig_tick(twins[i]);
        CHECK(dpt_tool_remove(twins[i]->world, twins[i]->tool) == DPT_OK, "remove");
        twins[i]->tool = second;
    }
    agree(&hit[0], &hit[1], "another body in the slot", 0);
    for (int i = 0; i < 2; i++)
        hit[i] = twin_step(twins[i], &near);
    agree(&hit[0], &hit[1], "another tool", 0);
    rig_close(&exact);
    rig_close(&tree);
    fixture_free(&small);
    fixture_free(&large);
}

static int tetrahedron(struct fixture *fixture, double size)
{
    const double vertices[] = { 0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, size };
    const uint32_t corners[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    return fixture_from_arrays(fixture, vertices, 4, corners, 4);
}

/*
 * Two bodies and two segments share a cache that holds little of any of them. The bodies have the same two
 * node numbers, and, being in the first and the third slot, of two blocks they use the same.
 */
static void owners_do_not_mix(void)
{
    struct fixture small, large;
    struct rig exact, tree;
    struct tool tools[2];
    dpt_mesh_info info = { .size = sizeof info };
    if (!tetrahedron(&small, 0.05) || !tetrahedron(&large, 0.2))
        return;
    dpt_mesh_get_info(large.mesh, &info);
    for (uint32_t blocks = 1; blocks <= 8; blocks++) {
        for (uint64_t i = 0; i < 2; i++)
            tool_start(&tools[i], &info, 11 + 2 * blocks + i);
        const dpt_segment at_first = tool_segment(&tools[0]);
        struct rig *const twins[2] = { &exact, &tree };
        twin_open(&exact, small.mesh, DPT_METHOD_EXACT, 272 * blocks, &at_first);
        twin_open(&tree, small.mesh, DPT_METHOD_TREE, 0, &at_first);
        dpt_tool other[2];
        for (int i = 0; i < 2; i++) {
            dpt_pose pose = { { 0.05, 0.02, -0.03 }, { 1.0, 0.0, 0.0, 0.0 } };
            const dpt_body between = rig_add_body(twins[i], small.mesh, &pose);
            pose.position[0] = -0.1;
            rig_add_body(twins[i], large.mesh, &pose);
            CHECK(dpt_body_remove(twins[i]->world, between) == DPT_OK, "remove");
            other[i] = rig_add_tool(twins[i], &at_first, 1);
        }
        for (uint32_t tick = 0; tick < ticks / 4; tick++) {
            const dpt_segment a = tool_segment(&tools[0]), b = tool_segment(&tools[1]);
            dpt_hit found[2], second[2] = { DPT_HIT_INIT, DPT_HIT_INIT };
            for (int i = 0; i < 2; i++) {
                dpt_tool_set_segments(twins[i]->world, other[i], &b, 1);
                found[i] = twin_step(twins[i], &a);
                dpt_tool_get_hit(twins[i]->world, other[i], &second[i]);
            }
            agree(&found[0], &found[1], "first tool", tick);
            agree(&second[0], &second[1], "second tool", tick);
            tool_move(&tools[0], SLIDE, tick, &found[1]);
            tool_move(&tools[1], SPIN, tick, &second[1]);
        }
        rig_close(&exact);
        rig_close(&tree);
    }
    fixture_free(&small);
    fixture_free(&large);
}

/*
 * Two bodies of one leaf each in a cache of two blocks: their nodes have the same numbers and the same blocks. The
 * first is left, the second visited, and then the first again, where another of its triangles is nearest. The
 * second's plane, taken for that triangle's, would put it 4 m away, behind one that is known.
 */
static void keys_name_their_owner(void)
{
    const double first[] = { -1.0, -1.0, 10.0, 6.0, -1.0, 10.0, 2.0, 9.0, 10.0,
                             4.8,  -0.2, 10.5, 5.3, -0.2, 10.5, 5.0, 0.3, 10.5 };
    const double second[] = { -1.0, -1.0, 4.0,  6.0,  -1.0, 4.0,  2.0,  9.0, 4.0,
                              -5.2, -0.2, 20.0, -4.7, -0.2, 20.0, -5.0, 0.3, 20.0 };
    const uint32_t corners[] = { 0, 1, 2, 3, 4, 5 };
    struct fixture meshes[2];
    struct rig exact, tree;
    if (!fixture_from_arrays(&meshes[0], first, 6, corners, 2) ||
        !fixture_from_arrays(&meshes[1], second, 6, corners, 2))
        return;
    dpt_segment segment = { { 0.0, 0.0, 11.0 }, { 0.0, 0.01, 11.0 }, 0.0 };
    struct rig *const twins[2] = { &exact, &tree };
    twin_open(&exact, meshes[0].mesh, DPT_METHOD_EXACT, 2 * 272, &segment);
    twin_open(&tree, meshes[0].mesh, DPT_METHOD_TREE, 0, &segment);
    dpt_body other[2], between;
    for (int i = 0; i < 2; i++) {
        between = rig_add_body(twins[i], meshes[0].mesh, NULL);
        other[i] = rig_add_body(twins[i], meshes[1].mesh, NULL);
        CHECK(dpt_body_remove(twins[i]->world, between) == DPT_OK, "remove");
    }
    for (uint32_t tick = 0; tick < 15; tick++) {
        const dpt_pose here = { { 0.0, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
        const dpt_pose away = { { 1e3, 0.0, 0.0 }, { 1.0, 0.0, 0.0, 0.0 } };
        int visit = tick >= 5 && tick < 10;
        dpt_hit hit[2];
        segment.a[0] = segment.b[0] = tick < 10 ? 0.0 : 5.0;
        for (int i = 0; i < 2; i++) {
            dpt_body_set_pose(twins[i]->world, twins[i]->body, visit ? &away : &here);
            dpt_body_set_pose(twins[i]->world, other[i], visit ? &here : &away);
            hit[i] = twin_step(twins[i], &segment);
        }
        agree(&hit[0], &hit[1], "one block for two", tick);
        CHECK(fabs(hit[0].distance - (tick < 5 ? 1.0 : visit ? 7.0 : 0.5)) < 1e-9, "%.17g", hit[0].distance);
    }
    rig_close(&exact);
    rig_close(&tree);
    fixture_free(&meshes[0]);
    fixture_free(&meshes[1]);
}

/* The same calls give the same bits, whatever was kept before a reset. */
static void reset_forgets(void)
{
    struct fixture fixture;
    struct rig twin;
    dpt_hit first[40];
    if (!fixture_from_shape(&fixture, "liver", 5000))
        return;
    dpt_segment segment = { { -0.1, 0.0, 0.1 }, { 0.1, 0.0, 0.12 }, 0.0 };
    twin_open(&twin, fixture.mesh, DPT_METHOD_EXACT, 1 << 20, &segment);
    for (int pass = 0; pass < 2; pass++) {
        dpt_world_reset(twin.world);
        for (int tick = 0; tick < 40; tick++) {
            segment.a[0] = -0.1 + 1e-3 * tick;
            dpt_hit hit = twin_step(&twin, &segment);
            if (pass == 0)
                first[tick] = hit;
            CHECK(!memcmp(&hit, &first[tick], sizeof hit), "tick %d differs, work %u and %u", tick, hit.work,
                  first[tick].work);
        }
    }
    rig_close(&twin);
    fixture_free(&fixture);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        ticks = (uint32_t)strtoul(argv[1], NULL, 10);
    TEST(certificate_is_the_tree);
    TEST(what_is_kept_saves_work);
    TEST(jumps_cost_what_the_tree_does);
    TEST(crossings_are_walked_to);
    TEST(owners_do_not_mix);
    TEST(keys_name_their_owner);
    TEST(planes_leave_with_their_owner);
    TEST(reset_forgets);
    return check_report();
}
