/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * All kernels of this machine give the same bits: bounds, planes that are renewed, winding numbers. The scalar kernel
 * is the reference, lane by lane. Solid angles are also compared with the arctangent of the C library. That the bounds
 * are true is for test_kernel.
 *
 *     test_kernel_bits [PER CENT]   of the random blocks
 */
#include "kernel/kernel_scene.h"

/* Bit for bit; but which NaN a NaN is depends on the order of its operands, and no one asks. */
static int same_floats(const float *x, const float *y, int count)
{
    for (int i = 0; i < count; i++)
        if (memcmp(&x[i], &y[i], sizeof x[i]) != 0 && !(isnan(x[i]) && isnan(y[i])))
            return 0;
    return 1;
}

static int same_planes(const struct planes *p, const struct planes *q)
{
    return same_floats(p->x, q->x, LANES) && same_floats(p->y, q->y, LANES) && same_floats(p->z, q->z, LANES) &&
           same_floats(p->support, q->support, LANES);
}

/* Two kernels on one block of triangles or boxes: planes, bounds and lanes, made and held. */
static void check_same_renewal(const char *what, kernel_cached *plain, kernel_new_planes *one, kernel_cached *wide,
                               kernel_new_planes *two, const float *block, const struct filter_segment *segment,
                               const struct filter_segment *later)
{
    struct planes expected_planes, planes;
    float expected[LANES], bound[LANES];
    uint32_t expected_open = one(block, segment, &expected_planes, expected);
    uint32_t open = two(block, segment, &planes, bound);
    CHECK(same_planes(&expected_planes, &planes), "%s: planes", what);
    CHECK(same_floats(expected, bound, LANES), "%s: bounds", what);
    CHECK(expected_open == open, "%s: open %x, not %x", what, open, expected_open);
    expected_open = plain(block, later, &expected_planes, expected);
    open = wide(block, later, &expected_planes, bound);
    CHECK(same_floats(expected, bound, LANES), "%s: held bounds", what);
    CHECK(expected_open == open, "%s: held open %x, not %x", what, open, expected_open);
}

/* Lane by lane that whose bound is greater; any plane is better than one whose bound is no number. */
static void the_better_planes_are_kept(void)
{
    uint64_t random = 37;
    uint32_t chosen, taken = 0;
    struct kernel kernel;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++) {
        if (!dpti_kernel_get(id, &kernel, &chosen))
            continue;
        for (int i = 0; i < BLOCKS / 10; i++) {
            struct planes kept, made, after;
            float bound[LANES], made_bound[LANES], after_bound[LANES];
            float *const kept_rows = (float *)&kept, *const made_rows = (float *)&made;
            const float *const rows = (const float *)&after;
            for (int k = 0; k < 4 * LANES; k++) {
                kept_rows[k] = (float)random_in(&random, -1.0, 1.0);
                made_rows[k] = (float)random_in(&random, -1.0, 1.0);
            }
            for (int lane = 0; lane < LANES; lane++) {
                bound[lane] = random_bits(&random) % 8 ? kept.y[lane] : NAN;
                made_bound[lane] = random_bits(&random) % 8 ? made.y[lane] : NAN;
                if (random_bits(&random) % 8 == 0)
                    made_bound[lane] = bound[lane];
            }
            after = kept;
            memcpy(after_bound, bound, sizeof bound);
            kernel.better(&made, made_bound, &after, after_bound);
            for (int lane = 0; lane < LANES; lane++) {
                int takes = isnan(bound[lane]) || made_bound[lane] > bound[lane];
                float expected = takes ? made_bound[lane] : bound[lane];
                taken += (uint32_t)takes;
                CHECK(same_floats(&after_bound[lane], &expected, 1), "%s: bound %g, not %g", dpt_kernel_name(id),
                      (double)after_bound[lane], (double)expected);
                for (int row = 0; row < 4; row++)
                    CHECK(rows[row * LANES + lane] == (takes ? made_rows : kept_rows)[row * LANES + lane],
                          "%s: row %d of lane %d", dpt_kernel_name(id), row, lane);
            }
        }
    }
    CHECK(taken > 0, "none");
}

static void all_kernels_give_the_same_bits(void)
{
    uint64_t random = 3;
    uint32_t chosen, compared = 0;
    struct kernel plain, other;
    dpti_kernel_get(DPT_KERNEL_SCALAR, &plain, &chosen);
    for (uint32_t id = DPT_KERNEL_SSE2; id <= DPT_KERNEL_WASM128; id++) {
        const char *name = dpt_kernel_name(id);
        if (!dpti_kernel_get(id, &other, &chosen)) {
            SKIP(name, "not on this machine or in this build");
            continue;
        }
        compared++;
        for (int i = 0; i < BLOCKS; i++) {
            float block[9 * LANES], expected[LANES], low[LANES];
            make_triangles(&random, i % SHAPES, block);
            struct tool tool = i % 3 ? make_tool(&random, i % SHAPES) : make_long_tool(&random);
            struct tool later = move_tool(&random, &tool);
            if (i % 16 == 0)
                degenerate_lanes(&random, &tool, block);
            check_same_renewal(name, plain.cached_triangles, plain.triangles, other.cached_triangles, other.triangles,
                               block, &tool.filter, &later.filter);
            uint32_t expected_open = plain.common_triangles(block, tool.filter.normal, tool.filter.height, expected);
            uint32_t open = other.common_triangles(block, tool.filter.normal, tool.filter.height, low);
            CHECK(same_floats(expected, low, LANES), "%s: common, block %d", name, i);
            CHECK(expected_open == open, "%s: common open %x, not %x", name, open, expected_open);
            expected_open = plain.point_triangles(block, tool.filter.a, tool.filter.limit, expected);
            open = other.point_triangles(block, tool.filter.a, tool.filter.limit, low);
            CHECK(same_floats(expected, low, LANES), "%s: point, block %d", name, i);
            CHECK(expected_open == open, "%s: point open %x, not %x", name, open, expected_open);
            for (int row = 3 * LANES; row < 6 * LANES; row++)
                block[row] = fabsf(block[row]);
            check_same_renewal(name, plain.cached_boxes, plain.boxes, other.cached_boxes, other.boxes, block,
                               &tool.filter, &later.filter);
            const float *normal = tool.filter.normal;
            expected_open = plain.common_boxes(block, normal, tool.filter.height, expected);
            open = other.common_boxes(block, normal, tool.filter.height, low);
            CHECK(same_floats(expected, low, LANES), "%s: common of boxes, block %d", name, i);
            CHECK(expected_open == open, "%s: common open %x, not %x", name, open, expected_open);
            expected_open = plain.point_boxes(block, tool.filter.a, tool.filter.limit, expected);
            open = other.point_boxes(block, tool.filter.a, tool.filter.limit, low);
            CHECK(same_floats(expected, low, LANES), "%s: point of boxes, block %d", name, i);
            CHECK(expected_open == open, "%s: point open %x, not %x", name, open, expected_open);
        }
    }
    printf("    %u kernels against the scalar one\n", compared);
}

/* Rows of moments as any triangles may give them, some lanes empty; at times the point lies on one. */
static void make_moments(uint64_t *random, float block[MESH_MOMENT_ROWS * LANES], float at[3])
{
    for (int row = 0; row < MESH_MOMENT_ROWS; row++)
        for (int lane = 0; lane < LANES; lane++)
            block[row * LANES + lane] = coordinate(random);
    for (int lane = 0; lane < LANES; lane++) {
        const double size = pow(10.0, random_in(random, -4.0, 0.0));
        block[MESH_MOMENT_REMAINDER * LANES + lane] = (float)(size * size * size);
        block[MESH_MOMENT_RADIUS * LANES + lane] = (float)size;
        for (int row = 0; row < MESH_MOMENT_ROWS && random_bits(random) % 8 == 0; row++)
            block[row * LANES + lane] = row == MESH_MOMENT_RADIUS ? -1.0f : 0.0f;
    }
    for (int k = 0; k < 3; k++)
        at[k] = random_bits(random) % 16 ? 2.0f * coordinate(random) : block[(MESH_MOMENT_AT + k) * LANES + 3];
}

/* Triangles seen from near one of them, from a corner, from afar. */
static void make_view(uint64_t *random, const float *block, float at[3])
{
    const double off = pow(10.0, random_in(random, -8.0, 1.0));
    const uint64_t lane = random_bits(random) % LANES, corners = 1 + random_bits(random) % 3;
    for (uint64_t k = 0; k < 3; k++) {
        double sum = 0.0;
        for (uint64_t c = 0; c < corners; c++)
            sum += (double)block[(3 * c + k) * LANES + lane] / (double)corners;
        at[k] = (float)(sum + (random_bits(random) % 32 ? off * random_in(random, -1, 1) : 0.0));
    }
}

static void all_kernels_give_the_same_windings(void)
{
    uint64_t random = 29;
    uint32_t chosen;
    struct kernel plain, other;
    dpti_kernel_get(DPT_KERNEL_SCALAR, &plain, &chosen);
    for (uint32_t id = DPT_KERNEL_SSE2; id <= DPT_KERNEL_WASM128; id++) {
        const char *name = dpt_kernel_name(id);
        if (!dpti_kernel_get(id, &other, &chosen)) {
            SKIP(name, "not on this machine or in this build");
            continue;
        }
        for (int i = 0; i < BLOCKS; i++) {
            float block[MESH_MOMENT_ROWS * LANES], at[3];
            float sums[2][LANES], doubts[2][LANES];
            for (int lane = 0; lane < LANES; lane++) {
                sums[0][lane] = sums[1][lane] = coordinate(&random);
                doubts[0][lane] = doubts[1][lane] = fabsf(coordinate(&random));
            }
            const float most = (float)pow(10.0, random_in(&random, -8.0, 0.0));
            make_moments(&random, block, at);
            uint32_t expected = plain.moments(block, at, most, sums[0], doubts[0]);
            uint32_t open = other.moments(block, at, most, sums[1], doubts[1]);
            CHECK(open == expected, "%s: moments open %x, not %x", name, open, expected);
            CHECK(same_floats(sums[0], sums[1], LANES), "%s: sums, block %d", name, i);
            CHECK(same_floats(doubts[0], doubts[1], LANES), "%s: doubts, block %d", name, i);
            make_triangles(&random, i % SHAPES, block);
            make_view(&random, block, at);
            const uint32_t lanes = (uint32_t)random_bits(&random) & 0xffff;
            expected = plain.angles(block, at, lanes, sums[0]);
            open = other.angles(block, at, lanes, sums[1]);
            CHECK(open == expected && !(open & ~lanes), "%s: angles open %x, not %x", name, open, expected);
            CHECK(same_floats(sums[0], sums[1], LANES), "%s: angles, block %d", name, i);
        }
    }
}

/* What float adds of a triangle is its solid angle; what it does not add is rare, and left open. */
static void angles_are_solid_angles(void)
{
    uint64_t random = 31;
    struct kernel kernel = best_kernel();
    double worst = 0.0;
    int open_lanes = 0;
    for (int i = 0; i < BLOCKS; i++) {
        float block[9 * LANES], at[3], sums[LANES] = { 0.0f };
        make_triangles(&random, i % SHAPES, block);
        make_view(&random, block, at);
        const uint32_t lanes = i % 2 ? 0xffff : (uint32_t)random_bits(&random) & 0xffff;
        const uint32_t open = kernel.angles(block, at, lanes, sums);
        for (int lane = 0; lane < LANES; lane++) {
            const vec3 x = { at[0], at[1], at[2] };
            double turns = solid_turns(sub(corner(block, 0, lane), x), sub(corner(block, 1, lane), x),
                                       sub(corner(block, 2, lane), x));
            const int added = ((lanes & ~open) >> lane & 1) != 0;
            open_lanes += (open >> lane & 1) != 0;
            worst = max_of(worst, added ? fabs((double)sums[lane] - turns) : 0.0);
            CHECK(added || sums[lane] == 0.0f, "lane %d of %x, open %x: %g", lane, lanes, open, (double)sums[lane]);
            CHECK(added || !(lanes >> lane & 1) || open >> lane & 1, "lost");
        }
    }
    printf("    off by at most %.2g turns; %.2g %% left open\n", worst, 100.0 * open_lanes / (BLOCKS * LANES * 0.75));
    CHECK(worst < 2e-6, "off by %g turns", worst);
    CHECK(open_lanes < BLOCKS * LANES / 4, "%d lanes are left open", open_lanes);
}

/* atan2 of the C library, of which solid_turns knows nothing. */
static void turns_agree_with_the_c_library(void)
{
    uint64_t random = 37;
    double worst = 0.0;
    for (int i = 0; i < 20 * BLOCKS; i++) {
        vec3 v[3];
        for (int k = 0; k < 3; k++)
            v[k] = random_vec(&random, pow(10.0, random_in(&random, -3.0, 3.0)));
        if (i % 4 == 0)
            v[2] = along(scaled(v[0], -random_in(&random, 0.0, 2.0)), random_in(&random, -2.0, 0.0), v[1]);
        if (i % 8 == 0)
            v[2] = add(v[2], random_vec(&random, 1e-9));
        double a = length(v[0]), b = length(v[1]), c = length(v[2]);
        double volume = dot(v[0], cross(v[1], v[2]));
        double sides = a * b * c + dot(v[0], v[1]) * c + dot(v[1], v[2]) * a + dot(v[2], v[0]) * b;
        double turns = volume != 0.0 ? atan2(volume, sides) / ANGLE_TURN : 0.0;
        worst = max_of(worst, fabs(solid_turns(v[0], v[1], v[2]) - turns));
    }
    CHECK(worst < 1e-14, "off by %g turns", worst);
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(the_better_planes_are_kept);
    TEST(all_kernels_give_the_same_bits);
    TEST(turns_agree_with_the_c_library);
    TEST(angles_are_solid_angles);
    TEST(all_kernels_give_the_same_windings);
    return check_report();
}
