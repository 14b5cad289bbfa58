/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Long runs: a proxy penetrates nothing, and never comes to be on the other side of anything.
 *
 *     test_proxy_soak [TICKS = 400000 [SEED = 1 [MESH]]]
 *
 * Hands walk through all made shapes and, with DPT_DATA, all public meshes, at up to 1 m/s, with a tremor, some with
 * jumps of 0.3 m, some within a budget, some through meshes that move and turn. The gap is asked of a brute force
 * (soak_oracle.h) in the mesh's frame: at each tick on meshes of up to 6,000 triangles, at each 100th above. On closed
 * meshes so is the side of both ends and the middle of each segment: a point that moved by less than its two distances
 * together has passed nothing, else the crossings on the straight way between are counted, and where they are odd, those
 * of three rays. A tenth as many pokes as ticks try to get through
 * walls and sheets that are flat, where the side is a sign, and through spherical shells.
 *
 * It cannot judge the way between two ticks, but where that must end. The side of open meshes is judged on flat sheets
 * alone.
 */
#include "lib/public_meshes.h"
#include "lib/rig.h"
#include "lib/solid.h"
#include "proxy/soak_oracle.h"
#include "proxy/soak_pokes.h"

enum { RUN_TICKS = 2000, BRUTE_MAX = 6000, BRUTE_EACH = 100, RAYS_EACH = 1000, POINTS = 3, PLACING = 3000 };

/* The least gap that the proxy keeps, of the body's diagonal, which counts as 1 m at most; and what rounding may take. */
#define GAP_MIN  0.75e-6
#define ROUNDING 0.7

#define SPEED_MAX 1.0
#define JUMP      0.3

static unsigned long ticks_wanted = 400000;
static uint64_t first_seed = 1;
static const char *only;

struct instrument {
    const char *name;
    uint32_t count;
    dpt_segment segments[RIG_SEGMENTS];
};

static const struct instrument instruments[] = {
    { "point", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 0 } } },
    { "ball of 1 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 } } },
    { "ball of 5 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0 }, 5e-3 } } },
    { "line of 30 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.03 }, 0 } } },
    { "wire of 30 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.03 }, 1e-5 } } },
    { "needle of 30 mm", 1, { { { 0, 0, -0.01 }, { 0, 0, 0.02 }, 1e-3 } } },
    { "line of 100 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 } } },
    { "needle of 100 mm", 1, { { { 0, 0, 0 }, { 0, 0, 0.1 }, 1e-3 } } },
    { "rod of 100 mm", 1, { { { 0, 0, -0.03 }, { 0, 0.01, 0.07 }, 4e-3 } } },
    { "bent",
      3,
      { { { 0, 0, 0 }, { 0, 0, 0.04 }, 0.002 },
        { { 0, 0, 0 }, { 0.02, 0, -0.01 }, 0.001 },
        { { 0, 0, 0 }, { -0.02, 0, -0.01 }, 0.001 } } },
};
enum { INSTRUMENTS = sizeof instruments / sizeof *instruments, STRAIGHT = INSTRUMENTS - 1 };

/* So far, of all meshes. */
static struct {
    uint64_t meshes, ticks, moved, acts, judged, proven, crossed, grazed, rays, replaced, squeezed, folds;
    double least; /* gap, of the diagonal as above */
} all = { .least = INFINITY };

/* A hand and what it leads. */
struct walk {
    struct soak_oracle *oracle;
    const struct instrument *instrument;
    struct rig rig;
    uint64_t seed, tick;
    char name[160];
    double at[3], velocity[3], aim[3];      /* without the tremor */
    double speed, tremor, frequency, jumps; /* m/s, m, rad per tick, m */
    double axis[3], nod[3], turn, swing, rate;
    uint64_t hold; /* ticks: an aim is kept so long */
    dpt_pose body;
    double sway, lean, pace; /* m, rad, rad per tick: how the body goes to and fro */
    /* The pose that was judged last. */
    double points[RIG_SEGMENTS][POINTS][3], away[RIG_SEGMENTS];
    int is_known;
    int has_felt; /* a force: until then it hurries */
};

static void hand_orient(struct walk *walk)
{
    double axis[3];
    const double time = (double)walk->tick;
    for (int k = 0; k < 3; k++)
        axis[k] = walk->axis[k] + 0.3 * sin(0.7 * walk->rate * time) * walk->nod[k];
    unit3(axis);
    pose_orient(&walk->rig.device, axis, walk->turn + walk->swing * sin(walk->rate * time));
}

/* Mostly close to the surface, on either side of it; else anywhere about the mesh. */
static void hand_aim(struct walk *walk)
{
    const struct motion_place *place = &walk->oracle->solid->place;
    const float *c = place->corners + 9 * (random_bits(&walk->seed) % place->triangles);
    const int is_close = random_bits(&walk->seed) % 4 != 0;
    for (int k = 0; k < 3; k++) {
        const double spare = 0.1 * (place->high[k] - place->low[k]) + 0.002;
        const double middle = ((double)c[k] + (double)c[3 + k] + (double)c[6 + k]) / 3;
        walk->aim[k] = is_close ? middle + random_in(&walk->seed, -0.015, 0.015)
                                : random_in(&walk->seed, place->low[k] - spare, place->high[k] + spare);
    }
}

/* To the open, beside the mesh: where every hand begins. */
static void hand_place(struct walk *walk)
{
    const struct solid *solid = walk->oracle->solid;
    double way[3];
    random_unit(&walk->seed, way);
    for (int k = 0; k < 3; k++) {
        walk->at[k] = 0.5 * (solid->place.low[k] + solid->place.high[k]) + (0.5 * solid->diagonal + 0.12) * way[k];
        walk->rig.device.position[k] = walk->at[k];
        walk->velocity[k] = 0;
    }
    hand_orient(walk);
    rig_place(&walk->rig);
    /* Within a budget it takes a while to know that nothing is near. */
    for (int i = 0; i < PLACING && walk->rig.force.reason != DPT_FORCE_FREE; i++)
        rig_step(&walk->rig);
    CHECK(walk->rig.force.reason == DPT_FORCE_FREE, "%s: reason %u in the open", walk->name, walk->rig.force.reason);
    walk->is_known = walk->has_felt = 0;
    hand_aim(walk);
}

static void hand_begin(struct walk *walk)
{
    uint64_t *seed = &walk->seed;
    walk->speed = SPEED_MAX * pow(10, random_in(seed, -2, 0));
    walk->tremor = random_bits(seed) % 4 ? random_in(seed, 0, 3e-4) : 0;
    walk->frequency = 6.2831853 * RIG_DT * random_in(seed, 7, 13);
    walk->jumps = random_bits(seed) % 8 ? 0 : JUMP;
    walk->hold = 50 + random_bits(seed) % 400;
    random_unit(seed, walk->axis);
    random_unit(seed, walk->nod);
    walk->turn = random_in(seed, 0, 3.14);
    walk->swing = random_bits(seed) % 2 ? random_in(seed, 0, 1) : 0;
    walk->rate = random_in(seed, 0, 0.01);
    walk->body = (dpt_pose)DPT_POSE_IDENTITY;
    walk->sway = random_bits(seed) % 3 ? 0 : random_in(seed, 0, 0.01);
    walk->lean = walk->sway > 0 ? random_in(seed, 0, 0.1) : 0;
    walk->pace = random_in(seed, 0, 0.02);
    hand_place(walk);
}

/* One tick of the body, if it moves. */
static void body_move(struct walk *walk)
{
    static const double axis[3] = { 0.48, 0.6, 0.64 };
    const double time = walk->pace * (double)walk->tick;
    if (!(walk->sway > 0))
        return;
    for (int k = 0; k < 3; k++)
        walk->body.position[k] = walk->sway * sin((1 + 0.3 * k) * time);
    pose_orient(&walk->body, axis, walk->lean * sin(0.7 * time));
    CHECK(dpt_body_set_pose(walk->rig.world, walk->rig.body, &walk->body) == DPT_OK, "%s: no pose", walk->name);
    all.moved++;
}

/* One tick of the hand: it bends towards its aim, trembles, and is no faster than 1 m/s but where it jumps. */
static void hand_move(struct walk *walk)
{
    double to[3], way[3];
    if (walk->tick % walk->hold == 0)
        hand_aim(walk);
    walk->has_felt |= walk->rig.force.reason == DPT_FORCE_ACTS;
    const double speed = walk->has_felt ? walk->speed : SPEED_MAX;
    for (int k = 0; k < 3; k++)
        way[k] = walk->aim[k] - walk->at[k];
    const double far = unit3(way);
    for (int k = 0; k < 3; k++) {
        const double wanted = speed * fmin(1, far / 0.02) * way[k];
        walk->velocity[k] += 0.04 * (wanted - walk->velocity[k]);
        walk->at[k] += RIG_DT * walk->velocity[k];
        to[k] = walk->at[k] + walk->tremor * sin(walk->frequency * (1 + 0.1 * k) * (double)walk->tick + k);
    }
    const double step = apart(to, walk->rig.device.position), longest = SPEED_MAX * RIG_DT;
    for (int k = 0; k < 3; k++)
        walk->rig.device.position[k] += (step > longest ? longest / step : 1) * (to[k] - walk->rig.device.position[k]);
    if (walk->jumps > 0 && walk->tick % 64 == 63) {
        const double leap = random_in(&walk->seed, 0, walk->jumps);
        random_unit(&walk->seed, way);
        for (int k = 0; k < 3; k++)
            walk->rig.device.position[k] = walk->at[k] += leap * way[k];
    }
    hand_orient(walk);
}

/* Of a closed mesh: no point has come to its other side since the pose that was judged before. */
static void judge_side(struct walk *walk, uint32_t number, const double ends[6], double away)
{
    const int points = apart(ends, ends + 3) > 0 ? POINTS : 1;
    for (int i = 0; i < points; i++) {
        double piece[6];
        memcpy(piece, walk->points[number][i], 3 * sizeof *piece);
        point_at(ends, 0.5 * i, piece + 3);
        memcpy(walk->points[number][i], piece + 3, 3 * sizeof *piece);
        int is_asked = !walk->is_known || all.judged % RAYS_EACH == 0;
        if (!is_asked && apart(piece, piece + 3) < away + walk->away[number]) {
            all.proven++;
        } else if (!is_asked) {
            all.crossed++;
            is_asked = (soak_crossings(walk->oracle, piece) & 1u) != 0;
            all.grazed += (uint64_t)is_asked;
        }
        if (!is_asked)
            continue;
        all.rays++;
        const int is_inside = soak_is_inside(walk->oracle, piece + 3, &walk->seed);
        CHECK(!is_inside, "%s, tick %llu: segment %u passed to the other side", walk->name,
              (unsigned long long)walk->tick, number);
    }
    walk->away[number] = away;
}

static void judge(struct walk *walk)
{
    const struct rig *rig = &walk->rig;
    const double scale = fmin(walk->oracle->solid->diagonal, 1);
    all.judged++;
    for (uint32_t s = 0; s < rig->count; s++) {
        const double radius = rig->segments[s].radius;
        double ends[6];
        rig_proxy_ends(rig, s, ends);
        pose_local(&walk->body, ends, ends);
        pose_local(&walk->body, ends + 3, ends + 3);
        const double away = soak_distance(walk->oracle, ends, radius + 2e-3);
        const double gap = (away - radius) / scale;
        all.least = fmin(all.least, gap);
        CHECK(gap >= ROUNDING * GAP_MIN, "%s, tick %llu: gap %g of the diagonal, flags %u", walk->name,
              (unsigned long long)walk->tick, gap, rig->force.flags);
        if (walk->oracle->is_closed)
            judge_side(walk, s, ends, away);
    }
    walk->is_known = 1;
}

static void walk_once(struct soak_oracle *oracle, uint64_t number, uint64_t ticks)
{
    struct walk walk = { .oracle = oracle, .seed = first_seed };
    dpt_world_def def = rig_def(DPT_LAW_PROXY);
    for (const char *c = oracle->solid->name; *c; c++)
        walk.seed = walk.seed * 31 + (uint64_t)(unsigned char)*c;
    walk.seed = walk.seed * 1000003 + number;
    walk.instrument = &instruments[random_bits(&walk.seed) % INSTRUMENTS];
    snprintf(walk.name, sizeof walk.name, "%s, %s, run %llu", oracle->solid->name, walk.instrument->name,
             (unsigned long long)number);
    if (random_bits(&walk.seed) % 6 == 0)
        def.budget = 20 + (uint32_t)(random_bits(&walk.seed) % 400);
    rig_open(&walk.rig, &def, oracle->solid->mesh, walk.instrument->segments, walk.instrument->count);
    rig_vary(&walk.rig, &walk.seed);
    hand_begin(&walk);
    for (; walk.tick < ticks; walk.tick++) {
        hand_move(&walk);
        body_move(&walk);
        rig_step(&walk.rig);
        all.ticks++;
        all.acts += walk.rig.force.reason == DPT_FORCE_ACTS;
        all.squeezed += (walk.rig.force.flags & DPT_FORCE_FLAG_SQUEEZED) != 0;
        /* It was turned by more than 1 rad, and started again where the device is: in the open once more. */
        if (walk.rig.force.flags & DPT_FORCE_FLAG_REPLACED) {
            all.replaced++;
            hand_place(&walk);
            continue;
        }
        CHECK(walk.rig.force.reason <= DPT_FORCE_FREE, "%s, tick %llu: reason %u, flags %u", walk.name,
              (unsigned long long)walk.tick, walk.rig.force.reason, walk.rig.force.flags);
        if (oracle->count <= BRUTE_MAX || walk.tick % BRUTE_EACH == 0)
            judge(&walk);
    }
    all.folds += walk.rig.force.folds;
    rig_close(&walk.rig);
}

static void walk_through(const struct solid *solid, uint64_t ticks)
{
    struct soak_oracle oracle;
    if (only && strcmp(only, solid->name))
        return;
    if (soak_oracle_open(&oracle, solid)) {
        uint64_t number = 0;
        for (uint64_t left = ticks; left > 0; number++) {
            const uint64_t part = left < RUN_TICKS ? left : RUN_TICKS;
            walk_once(&oracle, number, part);
            left -= part;
        }
        all.meshes++;
    }
    soak_oracle_close(&oracle);
}

/* All that `dynpoint make` makes, coarse and fine. */
static const struct {
    const char *name;
    uint64_t triangles;
} shapes[] = { { "box", 12 },       { "box", 1200 },      { "sphere", 320 },  { "sphere", 5120 },  { "torus", 32 },
               { "torus", 5568 },   { "star", 2000 },     { "star", 20480 },  { "liver", 4000 },   { "liver", 50332 },
               { "stomach", 5001 }, { "stomach", 2000 },  { "spleen", 3000 }, { "membrane", 512 }, { "cloth", 2048 },
               { "hub", 100 },      { "membrane", 5000 }, { "hub", 5000 } };
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Half of all ticks where there are public meshes, and all where not. */
static void nothing_made_is_penetrated(void)
{
    const uint64_t share = ticks_wanted / (getenv("DPT_DATA") ? 2 : 1) / SHAPES + 1;
    for (size_t i = 0; i < SHAPES; i++) {
        struct solid solid;
        char name[64];
        snprintf(name, sizeof name, "%s %llu", shapes[i].name, (unsigned long long)shapes[i].triangles);
        if (solid_from_shape(&solid, shapes[i].name, shapes[i].triangles)) {
            solid.name = name;
            walk_through(&solid, share);
        }
        solid_close(&solid);
    }
}

static void count_mesh(const char *folder, const char *file, void *count)
{
    (void)folder;
    (void)file;
    ++*(uint64_t *)count;
}

/* In metres, or what is far from the size of an organ made one of 0.35 m. */
static void walk_public(const char *folder, const char *file, void *share)
{
    char path[1024];
    struct solid solid;
    snprintf(path, sizeof path, "%s/meshes/%s/%s", getenv("DPT_DATA"), folder, file);
    int opened = solid_from_file(&solid, file, path, 1);
    if (opened && !(solid.diagonal > 0.05 && solid.diagonal < 1)) {
        const double scale = 0.35 / solid.diagonal;
        solid_close(&solid);
        opened = solid_from_file(&solid, file, path, scale);
    }
    if (opened)
        walk_through(&solid, *(const uint64_t *)share);
    solid_close(&solid);
}

static void nothing_public_is_penetrated(void)
{
    uint64_t count = 0;
    for_each_public_mesh(getenv("DPT_DATA"), count_mesh, &count);
    uint64_t share = ticks_wanted / 2 / (count + 1) + 1;
    for_each_public_mesh(getenv("DPT_DATA"), walk_public, &share);
}

static void thin_things_are_never_passed(void)
{
    if (!only)
        soak_pokes(ticks_wanted / 10 + 1, first_seed);
}

static void walks_are_worth_it(void)
{
    printf(
        "    %llu meshes, %llu ticks, %llu of them moving, %llu with a force, %llu judged; least gap %.3g of the diagonal\n",
        (unsigned long long)all.meshes, (unsigned long long)all.ticks, (unsigned long long)all.moved,
        (unsigned long long)all.acts, (unsigned long long)all.judged, all.least);
    printf("    sides: %llu proven, %llu crossings counted, %llu of them grazing; rays from %llu points\n",
           (unsigned long long)all.proven, (unsigned long long)all.crossed, (unsigned long long)all.grazed,
           (unsigned long long)all.rays);
    printf("    %llu folds, %llu ticks without a solution, %llu began again (turned by 1 rad)\n",
           (unsigned long long)all.folds, (unsigned long long)all.squeezed, (unsigned long long)all.replaced);
    CHECK(only || all.ticks < 100000 || all.acts > all.ticks / 4, "%llu of %llu ticks with a force",
          (unsigned long long)all.acts, (unsigned long long)all.ticks);
}

/* What passes over far triangles against what looks at all, and rays against solid angles. */
static void the_oracle_tells_what_is_known(void)
{
    struct solid solid;
    struct soak_oracle oracle;
    uint64_t seed = first_seed;
    uint32_t near = 0, inside = 0;
    if (!solid_from_shape(&solid, "star", 2000) || !soak_oracle_open(&oracle, &solid))
        return;
    CHECK(oracle.is_closed, "the star is open");
    for (int i = 0; i < 300; i++) {
        const double limit = i % 3 ? random_in(&seed, 0, 0.03) : 1;
        double ends[6];
        for (int k = 0; k < 6; k++)
            ends[k] = random_in(&seed, -0.12, 0.12);
        for (int k = 3; k < 6 && i % 2; k++)
            ends[k] = ends[k - 3] + (i % 4 == 1 ? 0 : 0.1 * ends[k]);
        const double told = soak_distance(&oracle, ends, limit);
        const double wanted = fmin(limit, oracle_brute(solid.brute, ends, NULL));
        const int is_inside = soak_is_inside(&oracle, ends, &seed);
        CHECK(fabs(told - wanted) < 1e-12, "segment %d: %g, not %g", i, told, wanted);
        CHECK(is_inside == (fabs(oracle_winding(&solid.oracle, ends)) > 0.5), "point %d: %d", i, is_inside);
        near += told < limit;
        inside += (uint32_t)is_inside;
    }
    CHECK(near > 50 && inside > 20, "%u near, %u inside", near, inside);
    soak_oracle_close(&oracle);
    solid_close(&solid);
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    take_count(argc, argv, &ticks_wanted, &first_seed);
    only = argc > 3 ? argv[3] : NULL;
    TEST(the_oracle_tells_what_is_known);
    TEST(nothing_made_is_penetrated);
    if (getenv("DPT_DATA"))
        TEST(nothing_public_is_penetrated);
    else
        SKIP("the public meshes", "DPT_DATA does not name the data folder");
    TEST(walks_are_worth_it);
    TEST(thin_things_are_never_passed);
    return check_report();
}
