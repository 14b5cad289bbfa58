/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The boxes and leaves of a surface whose vertices move: after any updates, and wherever it was followed, each box holds
 * the vertices below it once it is widened by its travel, and a leaf that was followed is that of the positions.
 *
 *     test_surface_motion [PER CENT]   of the updates
 */
#include "deform/deform_vertices.h"
#include "lib/fixture.h"

static uint64_t seed = 11;

struct moving_mesh {
    struct fixture fixture;
    struct surface_motion motion;
    struct surface surface;
    struct kernel kernel;
    void *raw;
    float *next;
    uint32_t *list;
    uint32_t tick, times_anew;
};

static int open_mesh(struct moving_mesh *moving, const char *shape, uint64_t triangles)
{
    uint32_t chosen;
    memset(moving, 0, sizeof *moving);
    if (!fixture_from_shape(&moving->fixture, shape, triangles))
        return 0;
    const struct dpt_mesh *mesh = moving->fixture.mesh;
    const double low[3] = { -1.0, -1.0, -1.0 }, high[3] = { 1.0, 1.0, 1.0 };
    moving->raw = malloc((size_t)dpti_surface_motion_bytes(mesh) + 64);
    moving->next = malloc(3 * sizeof *moving->next * (size_t)mesh->vertices);
    moving->list = malloc(sizeof *moving->list * (size_t)mesh->vertices);
    CHECK(dpti_kernel_get(DPT_KERNEL_AUTO, &moving->kernel, &chosen), "no kernel");
    dpti_surface_of_motion(mesh, low, high, (char *)(mesh_aligned((uintptr_t)moving->raw)), &moving->motion,
                           &moving->surface);
    return 1;
}

static void close_mesh(struct moving_mesh *moving)
{
    free(moving->raw);
    free(moving->next);
    free(moving->list);
    fixture_free(&moving->fixture);
}

/* All vertices below a node, in the filter's frame, within its box and what that lacks. */
static double largest_excess(const struct moving_mesh *moving, uint32_t level, uint32_t node)
{
    const struct surface_motion *motion = &moving->motion;
    const struct surface *surface = &moving->surface;
    const float *block = motion->level[level + 1] + (size_t)(node / LANES) * MESH_BOX_WORDS;
    const uint32_t lane = node % LANES, number = motion->first[level] + node;
    const double lacks = (double)motion->travel[number] - (double)motion->boxed[number];
    const uint32_t each = LANES << 4 * level, first = node * each;
    double excess = -HUGE_VAL;
    for (uint32_t t = first; t < first + each && t < surface_triangles(surface); t++)
        for (uint32_t k = 0; k < 3; k++) {
            double x[3];
            const vec3 v = scaled(sub(surface_vertex(surface, surface_corner(surface, t, k)), surface->filter_centre),
                                  surface->filter_scale);
            vec3_store(v, x);
            for (uint32_t axis = 0; axis < 3; axis++)
                excess = max_of(excess, fabs(x[axis] - (double)block[axis * LANES + lane]) -
                                            (double)block[(3 + axis) * LANES + lane] - lacks);
        }
    return excess;
}

static void check_boxes(const struct moving_mesh *moving, const char *what)
{
    for (uint32_t level = 0; level < moving->motion.levels; level++)
        for (uint32_t node = 0; node < moving->motion.count[level]; node++) {
            const double excess = largest_excess(moving, level, node);
            CHECK(excess <= 0x1p-22, "%s: %g beyond the box of node %u of level %u", what, excess, node, level);
        }
}

/* A leaf that is up to date holds its triangles, to the bit. */
static void check_leaf(const struct moving_mesh *moving, uint32_t leaf)
{
    const struct surface *surface = &moving->surface;
    const float *rows = moving->motion.leaves + (size_t)leaf * MESH_LEAF_WORDS;
    for (uint32_t i = 0; i < LANES && leaf * LANES + i < surface_triangles(surface); i++)
        for (uint32_t k = 0; k < 3; k++) {
            double x[3], centre[3];
            vec3_store(surface_vertex(surface, surface_corner(surface, leaf * LANES + i, k)), x);
            vec3_store(surface->filter_centre, centre);
            for (uint32_t axis = 0; axis < 3; axis++) {
                const float offset = (float)(x[axis] - centre[axis]);
                CHECK(rows[(3 * k + axis) * LANES + i] == (float)((double)offset * surface->filter_scale),
                      "corner %u of triangle %u is old", k, leaf * LANES + i);
            }
        }
}

/* As searches do: from the root down, at random. */
static void follow_some(struct moving_mesh *moving)
{
    struct work work = work_of(WORK_UNLIMITED);
    const struct surface *surface = &moving->surface;
    for (uint32_t level = surface->levels; level >= 1; level--)
        for (uint32_t node = 0; node < surface->count[level]; node++)
            if (random_bits(&seed) % 3)
                surface_node(surface, level, node, &work);
    for (uint32_t leaf = 0; leaf < surface->count[0]; leaf++)
        if (random_bits(&seed) % 4 == 0) {
            surface_leaf(surface, leaf, &work);
            check_leaf(moving, leaf);
        }
}

/* All vertices away from the middle or towards it, by the same length, or each somewhere. */
static void make_next(struct moving_mesh *moving, double length, int is_even)
{
    const struct surface *surface = &moving->surface;
    for (uint32_t v = 0; v < moving->fixture.mesh->vertices; v++) {
        const vec3 x = surface_vertex(surface, v);
        vec3 way = unit_of(x);
        if (!is_even)
            way = (vec3){ random_in(&seed, -0.5, 0.5), random_in(&seed, -0.5, 0.5), random_in(&seed, -0.5, 0.5) };
        const vec3 to = along(x, length, way);
        moving->next[3 * v] = (float)to.x;
        moving->next[3 * v + 1] = (float)to.y;
        moving->next[3 * v + 2] = (float)to.z;
    }
}

static void update(struct moving_mesh *moving, double length)
{
    const uint32_t vertices = moving->fixture.mesh->vertices;
    const uint32_t form = (uint32_t)(random_bits(&seed) % 4);
    struct vertex_update change = { .positions = moving->next,
                                    .count = vertices,
                                    .bound = form == 1 ? fabs(length) * 1.0001 : -1.0,
                                    .tick = moving->tick };
    int has_begun_anew;
    if (form == 2) {
        change.first = (uint32_t)(random_bits(&seed) % vertices);
        change.count = vertices - change.first;
        change.positions += 3 * (size_t)change.first;
    } else if (form == 3) {
        change.count = 1 + (uint32_t)(random_bits(&seed) % 40);
        change.list = moving->list;
        for (uint32_t i = 0; i < change.count; i++)
            moving->list[i] = (uint32_t)(random_bits(&seed) % vertices);
    }
    dpti_deform_move(&moving->surface, &moving->kernel, &change, &has_begun_anew);
    moving->times_anew += (uint32_t)has_begun_anew;
}

static void follow_shape(const char *shape, uint64_t triangles, double length, uint64_t updates)
{
    struct moving_mesh moving;
    if (!open_mesh(&moving, shape, triangles))
        return;
    for (uint64_t i = 0; i < updates; i++) {
        const double way = i / 16 % 2 ? -length : length;
        moving.tick += random_bits(&seed) % 2 ? 1 : moving.tick == 0;
        make_next(&moving, way, i / 64 % 2 == 0);
        update(&moving, way);
        if (random_bits(&seed) % 3 == 0)
            follow_some(&moving);
        check_boxes(&moving, shape);
    }
    CHECK(length < 0.01 || moving.times_anew > 0, "travels did not begin anew");
    close_mesh(&moving);
}

static void boxes_hold_their_vertices(void)
{
    static const char *const shapes[] = { "sphere", "liver", "cloth", "star" };
    static const uint64_t triangles[] = { 320, 1500, 450, 2000 };
    static const double lengths[] = { 1e-7, 1e-4, 0.02 };
    for (int s = 0; s < 4; s++)
        for (int k = 0; k < 3; k++)
            follow_shape(shapes[s], triangles[s], lengths[k], part_of(300) + (k == 2 ? 260 : 0));
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(boxes_hold_their_vertices);
    return check_report();
}
