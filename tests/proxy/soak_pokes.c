/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/soak_pokes.h"

#include "lib/rig.h"
#include "lib/solid.h"
#include "proxy/soak_oracle.h"

/* A world serves so many pokes; so many ticks may one have. */
enum { POKES_A_WORLD = 100, TICKS_MAX = 500 };

#define THICK   1e-4
#define BALL    0.1 /* of the shell, m */
#define JUMP    0.3
#define DEPTH   0.5
#define BORDER  0.01
#define TURN    0.9 /* rad, of one leap */
#define GAP_MIN 0.75e-6

/* Of the gap at what is flat: the mesh is rounded to floats, and the body is turned. */
#define FLAT_ROUNDING 0.4

struct target {
    const char *name;
    struct solid solid, outer; /* outer: of the shell, to tell outside from cavity */
    struct soak_oracle triangles, sides;
    int is_shell;
    /* m: how far off the middle it is poked; of what is flat, to its border and below its top at 0 */
    double reach, half, bottom;
};

enum { TARGETS = 6 };
static struct target targets[TARGETS];

enum { CREEP, PRESS, LEAP, PRESS_AND_LEAP, WAYS };

struct poke {
    const struct target *target;
    struct rig rig;
    dpt_pose body;
    uint64_t seed, number;
    char name[160];
    double normal[3], across[2][3]; /* of the target, towards the tool; of a shell where it is poked */
    double start[3], way[3], step;
    double axis[3], turn, twist;
    int kind, side, ticks;
};

static struct {
    uint64_t pokes, ticks, held, replaced, left;
    double least;
} all = { .least = INFINITY };

static const struct {
    const char *name;
    dpt_segment segment;
} instruments[] = {
    { "point", { { 0, 0, 0 }, { 0, 0, 0 }, 0 } },
    { "ball of 1 mm", { { 0, 0, 0 }, { 0, 0, 0 }, 1e-3 } },
    { "line of 30 mm", { { 0, 0, 0 }, { 0, 0, 0.03 }, 0 } },
    { "needle of 30 mm", { { 0, 0, -0.01 }, { 0, 0, 0.02 }, 1e-3 } },
    { "wire of 20 mm", { { 0, 0, 0 }, { 0.02, 0, 0 }, 1e-5 } },
    { "line of 100 mm", { { 0, 0, 0 }, { 0, 0, 0.1 }, 0 } },
    { "rod of 100 mm", { { 0, 0, -0.03 }, { 0, 0.01, 0.07 }, 4e-3 } },
};
/* The first ones fit into the shell. */
enum { INSTRUMENTS = sizeof instruments / sizeof *instruments, SHORT_ONES = 5 };

static double half_width;

static void flat(double u, double v, double x[3])
{
    x[0] = half_width * (2 * v - 1);
    x[1] = half_width * (2 * u - 1);
    x[2] = 0;
}

static int make_sheet(struct target *target, const char *name, double half, uint32_t cells)
{
    half_width = half;
    *target = (struct target){ .name = name, .reach = 0.6 * half - 0.05, .half = half };
    return solid_from_net(&target->solid, name, cells, cells, 0, flat);
}

/* The box of `dynpoint make`, flattened. */
static int make_wall(struct target *target, const char *name, double half, uint64_t triangles)
{
    struct shape shape;
    shape_reason reason;
    *target = (struct target){ .name = name, .reach = 0.6 * half - 0.05, .half = half, .bottom = -THICK };
    if (shape_make("box", triangles, 0, &shape, reason))
        return 0;
    for (size_t i = 0; i < shape.vertex_count; i++) {
        double *x = shape.vertices + 3 * i;
        x[0] *= half / 0.06;
        x[1] *= half / 0.05;
        x[2] = x[2] > 0.039 ? 0 : x[2] < -0.039 ? -THICK : (x[2] / 0.08 - 0.5) * THICK;
    }
    const int opened = solid_from_arrays(&target->solid, name, shape.vertices, shape.vertex_count, shape.corners,
                                         shape.triangle_count);
    shape_free(&shape);
    return opened;
}

/* Two spheres, the inner one turned inside out. */
static int make_shell(struct target *target, const char *name, uint64_t triangles)
{
    struct shape shape;
    shape_reason reason;
    *target = (struct target){ .name = name, .is_shell = 1, .reach = 0.03 };
    if (shape_make("sphere", triangles, 0, &shape, reason))
        return 0;
    const size_t n = shape.vertex_count, count = shape.triangle_count;
    double *vertices = malloc(6 * n * sizeof *vertices);
    uint32_t *corners = malloc(6 * count * sizeof *corners);
    for (size_t i = 0; i < 3 * n; i++) {
        vertices[i] = shape.vertices[i];
        vertices[3 * n + i] = (1 - THICK / BALL) * shape.vertices[i];
    }
    for (size_t i = 0; i < 3 * count; i++) {
        corners[i] = shape.corners[i];
        corners[6 * count - 1 - i] = (uint32_t)n + shape.corners[i];
    }
    const int opened = solid_from_arrays(&target->solid, name, vertices, 2 * n, corners, 2 * count) &&
                       solid_from_arrays(&target->outer, name, shape.vertices, n, shape.corners, count) &&
                       soak_oracle_open(&target->triangles, &target->solid) &&
                       soak_oracle_open(&target->sides, &target->outer);
    free(vertices);
    free(corners);
    shape_free(&shape);
    return opened;
}

/* The lowest point of the tool, along the normal, from the origin of its frame. */
static double lowest(const struct poke *poke)
{
    const dpt_segment *segment = &poke->rig.segments[0];
    double a[3], b[3];
    turn3(poke->rig.device.orientation, segment->a, a);
    turn3(poke->rig.device.orientation, segment->b, b);
    return fmin(dot3(a, poke->normal), dot3(b, poke->normal)) - segment->radius;
}

/* Beside the target: how far the tool is from it is drawn too. */
static void draw_start(struct poke *poke)
{
    const struct target *target = poke->target;
    uint64_t *seed = &poke->seed;
    double local[3][3] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } };
    const double apart_by = pow(10, random_in(seed, -4.5, -2));
    poke->side = random_bits(seed) % 2 ? 1 : -1;
    if (target->is_shell) {
        random_unit(seed, local[2]);
        random_unit(seed, local[0]);
        random_unit(seed, local[1]);
    } else {
        local[0][0] = local[1][1] = 1;
        local[2][2] = poke->side;
    }
    turn3(poke->body.orientation, local[0], poke->across[0]);
    turn3(poke->body.orientation, local[1], poke->across[1]);
    turn3(poke->body.orientation, local[2], poke->normal);
    double height = apart_by - lowest(poke);
    if (target->is_shell && poke->side > 0)
        height += BALL;
    else if (target->is_shell)
        height = random_in(seed, -target->reach, target->reach);
    else if (poke->side < 0)
        height -= target->bottom;
    const double x = target->is_shell ? 0 : random_in(seed, -target->reach, target->reach);
    const double y = target->is_shell ? 0 : random_in(seed, -target->reach, target->reach);
    for (int k = 0; k < 3; k++)
        poke->start[k] =
            poke->body.position[k] + height * poke->normal[k] + x * poke->across[0][k] + y * poke->across[1][k];
}

static void draw(struct poke *poke)
{
    uint64_t *seed = &poke->seed;
    random_unit(seed, poke->axis);
    poke->turn = random_in(seed, 0, 3.14);
    poke->twist = random_bits(seed) % 2 ? random_in(seed, -0.03, 0.03) : 0;
    pose_orient(&poke->rig.device, poke->axis, poke->turn);
    draw_start(poke);
    const double into = poke->target->is_shell && poke->side < 0 ? 1 : -1;
    random_unit(seed, poke->way);
    const double up = dot3(poke->way, poke->normal), slant = random_in(seed, 0.1, 1);
    for (int k = 0; k < 3; k++)
        poke->way[k] = into * poke->normal[k] + 2 * (1 - slant) * (poke->way[k] - up * poke->normal[k]);
    unit3(poke->way);
    poke->kind = (int)(random_bits(seed) % WAYS);
    poke->step = poke->kind == CREEP ? 1e-3 * pow(10, random_in(seed, -3, 0)) : 1e-3;
    poke->ticks = 6 + (int)(random_bits(seed) % 12);
    if (poke->kind == PRESS && random_bits(seed) % 16 == 0)
        poke->ticks = TICKS_MAX;
}

/* In leaps it turns too, and is anywhere, on either side, at most DEPTH from where it began. */
static void move_device(struct poke *poke, int tick)
{
    uint64_t *seed = &poke->seed;
    const int leaps = poke->kind == LEAP || (poke->kind == PRESS_AND_LEAP && tick >= 6);
    double *x = poke->rig.device.position, off[3];
    if (leaps) {
        double way[3];
        random_unit(seed, way);
        const double leap = random_in(seed, 0, JUMP);
        for (int k = 0; k < 3; k++)
            x[k] += leap * (random_bits(seed) % 4 ? way[k] : poke->way[k]);
    } else {
        for (int k = 0; k < 3; k++)
            x[k] += poke->step * poke->way[k];
    }
    for (int k = 0; k < 3; k++)
        off[k] = x[k] - poke->start[k];
    const double far = sqrt(dot3(off, off));
    for (int k = 0; k < 3 && far > DEPTH; k++)
        x[k] = poke->start[k] + DEPTH / far * off[k];
    /* Not round the border. */
    for (int i = 0; i < 2 && !poke->target->is_shell; i++) {
        for (int k = 0; k < 3; k++)
            off[k] = x[k] - poke->body.position[k];
        const double aside = dot3(off, poke->across[i]), limit = poke->target->reach;
        const double spare = aside > limit ? aside - limit : aside < -limit ? aside + limit : 0;
        for (int k = 0; k < 3; k++)
            x[k] -= spare * poke->across[i][k];
    }
    poke->turn += leaps && random_bits(seed) % 2 ? random_in(seed, -TURN, TURN) : poke->twist;
    if (leaps && random_bits(seed) % 8 == 0)
        random_unit(seed, poke->axis);
    pose_orient(&poke->rig.device, poke->axis, poke->turn);
}

/* With friction a tool that is turned walks as far as the border, and round it. */
static int is_at_border(const struct poke *poke)
{
    double world[6];
    rig_proxy_ends(&poke->rig, 0, world);
    for (int e = 0; e < 2 && !poke->target->is_shell; e++) {
        double x[3];
        pose_local(&poke->body, world + 3 * e, x);
        if (fmax(fabs(x[0]), fabs(x[1])) > poke->target->half - BORDER)
            return 1;
    }
    return 0;
}

static void judge(struct poke *poke, int tick)
{
    const struct target *target = poke->target;
    const double radius = poke->rig.segments[0].radius, scale = fmin(target->solid.diagonal, 1);
    double world[6], ends[6], gap;
    rig_proxy_ends(&poke->rig, 0, world);
    pose_local(&poke->body, world, ends);
    pose_local(&poke->body, world + 3, ends + 3);
    if (target->is_shell) {
        /* What the poke is told of, not a part of it. */
        struct target *asked = &targets[target - targets];
        gap = soak_distance(&asked->triangles, ends, radius + 1e-3) - radius;
        for (int i = 0; i < 3; i++) {
            double x[3];
            point_at(ends, 0.5 * i, x);
            CHECK(soak_is_inside(&asked->sides, x, &poke->seed) == (poke->side < 0),
                  "%s, poke %llu, tick %d: it passed the shell", poke->name, (unsigned long long)poke->number, tick);
        }
    } else if (poke->side > 0) {
        gap = fmin(ends[2], ends[5]) - radius;
    } else {
        gap = target->bottom - fmax(ends[2], ends[5]) - radius;
    }
    all.least = fmin(all.least, gap / scale);
    CHECK(gap >= FLAT_ROUNDING * GAP_MIN * scale, "%s, poke %llu, kind %d, tick %d: gap %g m, side %d, flags %u",
          poke->name, (unsigned long long)poke->number, poke->kind, tick, gap, poke->side, poke->rig.force.flags);
}

static void poke_once(struct poke *poke)
{
    struct rig *rig = &poke->rig;
    draw(poke);
    memcpy(rig->device.position, poke->start, sizeof poke->start);
    rig_place(rig);
    all.pokes++;
    CHECK(rig->force.reason == DPT_FORCE_FREE, "%s, poke %llu: reason %u at the start", poke->name,
          (unsigned long long)poke->number, rig->force.reason);
    int is_held = 0;
    for (int tick = 0; tick < poke->ticks; tick++) {
        move_device(poke, tick);
        rig_step(rig);
        all.ticks++;
        /* It was turned by more than 1 rad, and is where the device is: it may be behind the wall. */
        if (rig->force.flags & DPT_FORCE_FLAG_REPLACED) {
            all.replaced++;
            break;
        }
        if (is_at_border(poke)) {
            all.left++;
            break;
        }
        is_held |= rig->force.reason == DPT_FORCE_ACTS;
        judge(poke, tick);
    }
    all.held += (uint64_t)is_held;
}

static void poke_in_a_world(const struct target *target, uint64_t number, uint64_t count, uint64_t seed)
{
    struct poke poke = { .target = target, .seed = seed * 1000003 + number };
    const size_t which = random_bits(&poke.seed) % (target->is_shell ? SHORT_ONES : (size_t)INSTRUMENTS);
    double axis[3];
    snprintf(poke.name, sizeof poke.name, "%s, %s, world %llu", target->name, instruments[which].name,
             (unsigned long long)number);
    rig_open(&poke.rig, NULL, target->solid.mesh, &instruments[which].segment, 1);
    random_unit(&poke.seed, axis);
    for (int k = 0; k < 3; k++)
        poke.body.position[k] = random_in(&poke.seed, -0.1, 0.1);
    pose_orient(&poke.body, axis, random_bits(&poke.seed) % 4 ? random_in(&poke.seed, 0, 3.14) : 0);
    dpt_body_teleport(poke.rig.world, poke.rig.body, &poke.body);
    rig_vary(&poke.rig, &poke.seed);
    for (poke.number = 0; poke.number < count; poke.number++)
        poke_once(&poke);
    rig_close(&poke.rig);
}

static int make_targets(void)
{
    return make_sheet(&targets[0], "sheet of 0.4 m", 0.2, 6) && make_sheet(&targets[1], "sheet of 2 m", 1, 16) &&
           make_sheet(&targets[2], "two triangles", 0.2, 1) && make_wall(&targets[3], "wall of 12", 0.2, 12) &&
           make_wall(&targets[4], "wall of 1200", 1, 1200) && make_shell(&targets[5], "shell of 640", 320);
}

void soak_pokes(uint64_t count, uint64_t seed)
{
    const int made = make_targets();
    CHECK(made, "no targets");
    for (uint64_t number = 0, left = made ? count : 0; left > 0; number++) {
        const uint64_t part = left < POKES_A_WORLD ? left : POKES_A_WORLD;
        poke_in_a_world(&targets[number % TARGETS], number, part, seed);
        left -= part;
    }
    for (int i = 0; i < TARGETS && made; i++)
        solid_close(&targets[i].solid);
    solid_close(&targets[TARGETS - 1].outer);
    soak_oracle_close(&targets[TARGETS - 1].triangles);
    soak_oracle_close(&targets[TARGETS - 1].sides);
    printf("    %llu pokes, %llu ticks, %llu pokes with a force, %llu ended by a turn of 1 rad, "
           "%llu at a border; least gap %.3g of the diagonal\n",
           (unsigned long long)all.pokes, (unsigned long long)all.ticks, (unsigned long long)all.held,
           (unsigned long long)all.replaced, (unsigned long long)all.left, all.least);
    CHECK(!made || all.held > all.pokes / 3, "%llu of %llu pokes with a force", (unsigned long long)all.held,
          (unsigned long long)all.pokes);
}
