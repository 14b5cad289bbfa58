/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A tool that stands still is not computed again, and nobody can tell but by its work. Two worlds get the same input; in one
 * of them settings are set again before every tick, to what they are: a tool's, so that it never rests, and a body's, so that
 * its nearest pair is searched for again. Every answer must be the same, bit for bit, in every other run, whose worlds keep
 * no planes. With planes a search may name another one of two triangles that are as near, and last digits may differ. It
 * does not judge the answers themselves. With friction the pair is not searched for again: another lower bound changes last
 * digits, of which the cones make more.
 *
 *     test_rest [PER CENT]   of the runs
 */
#include <math.h>
#include <stdlib.h>

#include "lib/fixture.h"
#include "lib/random.h"
#include "lib/rig.h"

enum { TICKS = 400, CONTACTS = 16, OVERLAPS = 64, MESHES = 4, TOOLS_MAX = 3 };

static unsigned per_cent = 100;

static const char *const shapes[MESHES] = { "torus", "membrane", "star", "box" };
static const uint64_t counts[MESHES] = { 2000, 512, 2000, 12 };
static struct fixture fixtures[MESHES];

/* What a world and its tools are made of. */
struct setting {
    const char *name;
    uint32_t law, until, method, strip, budget, is_free;
    double friction, damping;
};

static const struct setting settings[] = {
    { "point", DPT_LAW_POINT, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 0, 0.0, 0.0 },
    { "bed", DPT_LAW_BED, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 0, 0.0, 0.0 },
    { "proxy", DPT_LAW_PROXY, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 0, 0.0, 0.0 },
    { "proxy, damper", DPT_LAW_PROXY, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 0, 0.0, 2.0 },
    { "proxy, friction", DPT_LAW_PROXY, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 0, 0.4, 0.0 },
    { "proxy, budget", DPT_LAW_PROXY, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 1000000, 0, 0.2, 0.0 },
    { "proxy, free", DPT_LAW_PROXY, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 1, 0.0, 0.0 },
    { "point, budget", DPT_LAW_POINT, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 1000000, 0, 0.0, 0.0 },
    { "bed, free", DPT_LAW_BED, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, 0, 0, 1, 0.0, 0.0 },
    { "contacts", DPT_LAW_POINT, DPT_UNTIL_CONTACT, DPT_METHOD_TREE, 0, 0, 0, 0.0, 0.0 },
    { "strips", DPT_LAW_POINT, DPT_UNTIL_RESPOND, DPT_METHOD_EXACT, DPT_STRIP_KIND_SHADOW, 0, 0, 0.0, 0.0 },
    { "pairs", DPT_LAW_POINT, DPT_UNTIL_TRACK, DPT_METHOD_EXACT, 0, 0, 0, 0.0, 0.0 },
};

/* One of the two worlds. */
struct run {
    struct rig rig;
    dpt_body body[2];
    dpt_tool tool[TOOLS_MAX];
    uint32_t tools;
};

static const dpt_segment parts[3] = { { { -0.15, 0.0, 0.0 }, { 0.15, 0.0, 0.0 }, 0.003 },
                                      { { 0.15, 0.0, 0.0 }, { 0.2, 0.05, 0.0 }, 0.002 },
                                      { { 0.15, 0.0, 0.0 }, { 0.2, -0.05, 0.0 }, 0.0 } };

static void add_tool(struct run *run, const struct setting *setting, uint32_t count)
{
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_tool *added = &run->tool[run->tools++];
    *added = rig_add_tool(&run->rig, parts, count);
    dpt_tool_get_settings(run->rig.world, *added, &tool);
    tool.damping = setting->damping;
    CHECK(dpt_tool_set_settings(run->rig.world, *added, &tool) == DPT_OK, "settings");
}

static void open_run(struct run *run, const struct setting *setting, uint32_t mesh, int keeps_planes)
{
    dpt_world_def def = rig_def(setting->law);
    def.until = setting->until;
    def.method = setting->method;
    def.strip = setting->strip;
    def.budget = setting->budget;
    def.max_tools = TOOLS_MAX;
    if (!keeps_planes)
        def.certificate_bytes = 0;
    if (setting->until == DPT_UNTIL_CONTACT)
        def.max_contacts = 1;
    run->tools = 0;
    rig_open(&run->rig, &def, NULL, NULL, 0);
    const dpt_pose beside = { { 0.2, 0.1, 0.2 }, { 1.0, 0.0, 0.0, 0.0 } };
    for (uint32_t i = 0; i < 2; i++) {
        dpt_body_settings body = { .size = sizeof body };
        run->body[i] = rig_add_body(&run->rig, fixtures[(mesh + i) % MESHES].mesh, i ? &beside : NULL);
        dpt_body_get_settings(run->rig.world, run->body[i], &body);
        body.static_friction = setting->friction;
        body.kinetic_friction = 0.5 * setting->friction;
        CHECK(dpt_body_set_settings(run->rig.world, run->body[i], &body) == DPT_OK, "settings");
    }
    add_tool(run, setting, setting->is_free ? 1 : 3);
    add_tool(run, setting, 1);
}

/* Where the first tool is: on its way through the bodies, at one of its stops, or where nothing is. */
struct hand {
    dpt_pose pose;
    double to[3], turn[3];
    uint32_t moves;
};

static void move_hand(struct hand *hand)
{
    double *q = hand->pose.orientation, square = 0.0;
    if (hand->moves == 0)
        return;
    hand->moves--;
    for (int k = 0; k < 3; k++) {
        hand->pose.position[k] += hand->to[k];
        q[k + 1] += hand->turn[k];
    }
    for (int k = 0; k < 4; k++)
        square += q[k] * q[k];
    for (int k = 0; k < 4; k++)
        q[k] /= sqrt(square);
}

static void begin_move(struct hand *hand, uint64_t *rng)
{
    const int jumps = random_in(rng, 0.0, 1.0) < 0.3;
    hand->moves = jumps ? 1 : 1 + (uint32_t)random_in(rng, 0.0, 30.0);
    for (int k = 0; k < 3; k++) {
        hand->to[k] = (jumps ? 100.0 : 1.0) * random_in(rng, -1e-3, 1e-3) - 0.02 * hand->pose.position[k];
        hand->turn[k] = random_in(rng, -0.02, 0.02);
    }
}

static void put_hand(struct run *run, const struct setting *setting, const dpt_pose *pose)
{
    if (!setting->is_free) {
        dpt_tool_set_pose(run->rig.world, run->tool[0], pose);
        return;
    }
    dpt_segment segment = parts[0];
    for (int k = 0; k < 3; k++) {
        segment.a[k] = pose->position[k];
        segment.b[k] = pose->position[k] + 0.1 * pose->orientation[k + 1] + 0.1 * (k == 0);
    }
    dpt_tool_set_segments(run->rig.world, run->tool[0], &segment, 1);
}

/* Something besides the hand changes, the same in both worlds. */
static void change(struct run *run, const struct setting *setting, uint32_t kind, double amount)
{
    const dpt_pose pose = { { 0.2 + amount, 0.1, 0.2 }, { 1.0, 0.0, 0.0, 0.0 } };
    dpt_body_settings body = { .size = sizeof body };
    dpt_tool_settings tool = { .size = sizeof tool };
    dpt_segment longer = parts[0];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    switch (kind) {
    case 0:
        dpt_body_set_pose(run->rig.world, run->body[1], &pose);
        break;
    case 1:
        dpt_body_teleport(run->rig.world, run->body[1], &pose);
        break;
    case 2:
        dpt_body_get_settings(run->rig.world, run->body[0], &body);
        body.stiffness = 500.0 + 1e3 * amount;
        body.unfelt = amount > 0.025;
        dpt_body_set_settings(run->rig.world, run->body[0], &body);
        break;
    case 3:
        dpt_tool_get_settings(run->rig.world, run->tool[0], &tool);
        tool.stiffness = 400.0 + 1e3 * amount;
        dpt_tool_set_settings(run->rig.world, run->tool[0], &tool);
        break;
    case 4:
        if (run->tools < TOOLS_MAX)
            add_tool(run, setting, 1);
        else
            dpt_tool_remove(run->rig.world, run->tool[--run->tools]);
        break;
    case 5:
        longer.b[0] += amount;
        dpt_tool_set_segments(run->rig.world, run->tool[1], &longer, 1);
        break;
    case 6:
        if (setting->law != DPT_LAW_PROXY || amount < 0.003)
            dpt_tool_teleport(run->rig.world, run->tool[0], &pose);
        break;
    case 7:
        dpt_tool_set_pose(run->rig.world, run->tool[1], &identity);
        break;
    case 8:
        if (!dpt_body_is_valid(run->rig.world, run->body[1]))
            run->body[1] = rig_add_body(&run->rig, fixtures[0].mesh, &pose);
        else
            dpt_body_remove(run->rig.world, run->body[1]);
        break;
    default:
        if (setting->law != DPT_LAW_PROXY || amount < 0.003)
            dpt_world_reset(run->rig.world);
        break;
    }
}

enum { CHANGES = 10 };

/* All that a tool answers; `work` alone may differ. */
struct answers {
    dpt_hit hit[3];
    dpt_sweep sweep[3];
    dpt_contact contact[CONTACTS];
    dpt_overlap overlap[OVERLAPS];
    dpt_force_info report;
    dpt_wrench wrench;
    dpt_pose proxy;
    uint32_t count[4]; /* of contacts, of overlaps; flags of the strip, of the step */
};

/* Of pairs that are as near a hit may name any: which one depends on where the search began. */
static void take_out_choice(dpt_hit *hit)
{
    hit->triangle = 0;
    hit->s = 0.0;
    memset(hit->p, 0, sizeof hit->p);
    memset(hit->q, 0, sizeof hit->q);
}

/* Integrals come from samples, which depend on those of earlier ticks. Only the law `bed` feels them. */
static void take_out_integrals(dpt_contact *contact)
{
    contact->overlap = contact->moment = contact->square = 0.0;
    contact->flags &= ~(uint32_t)DPT_CONTACT_FLAG_COARSE;
    memset(contact->thrust, 0, sizeof contact->thrust);
    memset(contact->thrust_moment, 0, sizeof contact->thrust_moment);
}

static uint32_t read_answers(const struct run *run, const struct setting *setting, uint32_t t, struct answers *answers)
{
    const dpt_world *world = run->rig.world;
    const dpt_tool tool = run->tool[t];
    uint32_t work = 0;
    memset(answers, 0, sizeof *answers);
    for (uint32_t i = 0; i < 3; i++) {
        answers->hit[i].size = sizeof answers->hit[i];
        answers->sweep[i].size = sizeof answers->sweep[i];
        dpt_tool_get_segment_hit(world, tool, i, &answers->hit[i]);
        dpt_tool_get_sweep(world, tool, i, &answers->sweep[i]);
        work += answers->hit[i].work;
        answers->hit[i].work = 0;
        take_out_choice(&answers->hit[i]);
    }
    answers->contact[0].size = sizeof answers->contact[0];
    answers->overlap[0].size = sizeof answers->overlap[0];
    answers->report.size = sizeof answers->report;
    dpt_tool_get_contacts(world, tool, answers->contact, CONTACTS, &answers->count[0]);
    for (uint32_t i = 0; i < CONTACTS && i < answers->count[0]; i++) {
        answers->contact[i].triangle = 0;
        memset(answers->contact[i].weight, 0, sizeof answers->contact[i].weight);
        if (setting->budget || setting->law == DPT_LAW_PROXY)
            take_out_integrals(&answers->contact[i]);
    }
    dpt_tool_get_strip(world, tool, 0, answers->overlap, OVERLAPS, &answers->count[1], &answers->count[2]);
    dpt_tool_get_force_info(world, tool, &answers->report);
    dpt_tool_get_wrench(world, tool, &answers->wrench);
    answers->count[3] = run->rig.step.flags;
    dpt_tool_get_proxy(world, tool, &answers->proxy);
    return work;
}

/*
 * Words of both are the same, or numbers that differ by rounding: a tool that has rested may name the other one of two triangles
 * that are as near, and computes their common point from that. The run ends there, as what follows may differ by more.
 */
static int is_same(const void *one, const void *other, size_t bytes)
{
    for (size_t i = 0; i < bytes; i += sizeof(double)) {
        double x, y;
        memcpy(&x, (const char *)one + i, sizeof x);
        memcpy(&y, (const char *)other + i, sizeof y);
        const int is_number = fabs(x) > 1e-300 && fabs(y) < 1e300;
        if (memcmp(&x, &y, sizeof x) && !(is_number && fabs(x - y) <= 1e-12 * (1.0 + fabs(x))))
            return 0;
    }
    return 1;
}

/* In which part of the answers two differ first. */
static const char *difference(const struct answers *one, const struct answers *other)
{
#define DIFFERS(part) !is_same(&one->part, &other->part, sizeof one->part)
    return DIFFERS(hit)       ? "hits"
           : DIFFERS(sweep)   ? "sweeps"
           : DIFFERS(contact) ? "contacts"
           : DIFFERS(overlap) ? "strips"
           : DIFFERS(report)  ? "reports"
           : DIFFERS(wrench)  ? "wrenches"
           : DIFFERS(proxy)   ? "proxies"
           : DIFFERS(count)   ? "counts"
                              : NULL;
#undef DIFFERS
}

static uint64_t compared, rested, pressed, nudged, parted, parted_without_planes;

/* Ticks of both worlds, up to the first that differs. */
static void compare_runs(const struct setting *setting, uint32_t mesh, uint64_t seed)
{
    struct run runs[2];
    struct hand hand = { .pose = { { 0.0, 0.0, 0.2 }, { 1.0, 0.0, 0.0, 0.0 } } };
    const int keeps_planes = (mesh + seed) % 2 == 0;
    int same = 1;
    for (int r = 0; r < 2; r++)
        open_run(&runs[r], setting, mesh, keeps_planes);
    for (int tick = 0; tick < TICKS && same; tick++) {
        const double what = random_in(&seed, 0.0, 1.0), amount = random_in(&seed, 0.0, 0.03);
        const uint32_t kind = (uint32_t)random_in(&seed, 0.0, CHANGES);
        if (what < 0.03)
            begin_move(&hand, &seed);
        move_hand(&hand);
        for (int r = 0; r < 2; r++) {
            dpt_tool_settings own = { .size = sizeof own };
            put_hand(&runs[r], setting, &hand.pose);
            if (what > 0.98)
                change(&runs[r], setting, kind, amount);
            for (uint32_t t = 0; r && t < runs[r].tools; t++) {
                dpt_tool_get_settings(runs[r].rig.world, runs[r].tool[t], &own);
                dpt_tool_set_settings(runs[r].rig.world, runs[r].tool[t], &own);
            }
            if (r && !(setting->friction > 0.0)) {
                dpt_body_settings body = { .size = sizeof body };
                dpt_body_get_settings(runs[r].rig.world, runs[r].body[0], &body);
                dpt_body_set_settings(runs[r].rig.world, runs[r].body[0], &body);
            }
            runs[r].rig.step.size = sizeof runs[r].rig.step;
            CHECK(dpt_world_step(runs[r].rig.world, 1e-3, &runs[r].rig.step) == DPT_OK, "step");
        }
        for (uint32_t t = 0; t < runs[0].tools; t++) {
            static struct answers one, other;
            const uint32_t work = read_answers(&runs[0], setting, t, &one);
            const uint32_t work_nudged = read_answers(&runs[1], setting, t, &other);
            const char *differs = difference(&one, &other);
            CHECK(!differs, "%s, %s, tick %d, tool %u: other %s", setting->name, shapes[mesh], tick, t, differs);
            nudged += work_nudged == 0 && other.hit[0].status != DPT_STATUS_STALE;
            same &= !differs && !memcmp(&one, &other, sizeof one);
            compared++;
            rested += work == 0;
            pressed += work == 0 && one.report.reason == DPT_FORCE_ACTS;
        }
    }
    parted += !same;
    parted_without_planes += !same && !keeps_planes;
    for (int r = 0; r < 2; r++)
        rig_close(&runs[r].rig);
}

static void nobody_can_tell(void)
{
    const unsigned seeds = 1 + per_cent * 5 / 100;
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        compared = rested = pressed = nudged = parted = parted_without_planes = 0;
        for (uint32_t mesh = 0; mesh < MESHES; mesh++)
            for (unsigned seed = 1; seed <= seeds; seed++)
                compare_runs(&settings[i], mesh, 1000 * i + seed);
        printf("    %s: %.0f %% of the ticks at rest, %.0f %% at rest with a force, %u runs parted\n", settings[i].name,
               100.0 * (double)rested / (double)compared, 100.0 * (double)pressed / (double)compared, (unsigned)parted);
        CHECK(settings[i].budget || settings[i].until == DPT_UNTIL_TRACK || settings[i].friction > 0.0 || nudged == 0,
              "%s: the other world rests too", settings[i].name);
        CHECK(parted <= seeds * MESHES / 4, "%s: %u runs parted", settings[i].name, (unsigned)parted);
        CHECK(parted_without_planes == 0, "%s: %u runs parted", settings[i].name, (unsigned)parted_without_planes);
        CHECK(compared >= (uint64_t)seeds * MESHES * TICKS, "%s: only %u ticks", settings[i].name, (unsigned)compared);
        CHECK(rested > compared / 5, "%s: only %.3f at rest", settings[i].name, (double)rested / (double)compared);
    }
}

/* A free tool that rests on a box, and is rigid from now on where it is: its proxy begins anew. */
static void a_free_tool_turns_rigid(void)
{
    const dpt_segment segment = { { 0.0, 0.0, 0.06 }, { 0.05, 0.0, 0.06 }, 0.002 };
    struct rig rig;
    rig_open(&rig, NULL, fixtures[MESHES - 1].mesh, &segment, 1);
    for (int tick = 0; tick < 200; tick++) {
        const double height = fmax(0.039, 0.06 - 2e-4 * tick), ends[6] = { 0.0, 0.0, height, 0.05, 0.0, height };
        rig_step_ends(&rig, ends, segment.radius);
    }
    CHECK(rig.hit.work == 0 && rig.force.reason == DPT_FORCE_ACTS, "work %u, reason %u", rig.hit.work,
          rig.force.reason);
    rig_step(&rig);
    CHECK(rig.hit.work > 0, "it rests");
    rig_close(&rig);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        per_cent = (unsigned)strtoul(argv[1], NULL, 10);
    for (int i = 0; i < MESHES; i++)
        fixture_from_shape(&fixtures[i], shapes[i], counts[i]);
    TEST(a_free_tool_turns_rigid);
    TEST(nobody_can_tell);
    for (int i = 0; i < MESHES; i++)
        fixture_free(&fixtures[i]);
    return check_report();
}
