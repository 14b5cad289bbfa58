/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The float bounds: the same bits from every kernel of this machine, never above the true distance by
 * more than the stated margin, and tight enough to be of use. The truth is the pair distance in double,
 * which test_pair.c holds against oracles of its own.
 */
#include "check.h"
#include "kernel.h"
#include "segment_triangle.h"

#define BLOCKS 20000

enum shape { ORDINARY, SLIVERS, POINTS, FLAT, SHAPES };

static float coordinate(uint64_t *random)
{
    return (float)random_in(random, -1.0, 1.0);
}

/* 16 triangles within -1..1 of one kind. */
static void make_triangles(uint64_t *random, int shape, float block[9 * LANES])
{
    for (int lane = 0; lane < LANES; lane++) {
        double size = pow(10.0, random_in(random, -4.0, 0.0));
        float centre[3] = { coordinate(random), coordinate(random), coordinate(random) };
        float first[3], along_edge[3];
        for (int axis = 0; axis < 3; axis++) {
            first[axis] = centre[axis] * (float)(1.0 - size);
            along_edge[axis] = (float)(size * random_in(random, -1.0, 1.0));
        }
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) {
                float x = first[axis] + (float)(size * random_in(random, -1.0, 1.0));
                if (shape == SLIVERS)
                    x = first[axis] + along_edge[axis] * (float)(0.5 * k) +
                        (k == 1 ? 1e-6f * coordinate(random) : 0.0f);
                if (shape == POINTS)
                    x = first[axis];
                if (shape == FLAT && axis == 2)
                    x = 0.25f;
                block[(3 * k + axis) * LANES + lane] = x < -1.0f ? -1.0f : x > 1.0f ? 1.0f : x;
            }
    }
}

/* An axis in double, and the probe that the search makes of it. */
struct tool {
    vec3 a, u;
    struct probe probe;
};

static void unit_frame(vec3 x, vec3 *y, vec3 *z)
{
    vec3 other = fabs(x.x) < 0.6 ? (vec3){ 1.0, 0.0, 0.0 } : (vec3){ 0.0, 1.0, 0.0 };
    *y = cross(other, x);
    *y = scaled(*y, 1.0 / length(*y));
    *z = cross(x, *y);
}

static void put(vec3 v, float out[3])
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static struct tool make_tool(uint64_t *random, int shape)
{
    struct tool tool;
    double reach = random_bits(random) % 8 ? 1.5 : 100.0;
    double size = random_bits(random) % 8 ? pow(10.0, random_in(random, -3.0, 1.0)) : 0.0;
    tool.a = (vec3){ random_in(random, -reach, reach), random_in(random, -reach, reach),
                     random_in(random, -reach, reach) };
    vec3 x = { random_in(random, -1.0, 1.0), random_in(random, -1.0, 1.0),
               random_in(random, -1.0, 1.0) };
    if (shape == FLAT && random_bits(random) % 2)
        x.z = random_in(random, -1e-6, 1e-6);
    vec3 y, z;
    x = scaled(x, 1.0 / length(x));
    unit_frame(x, &y, &z);
    tool.u = scaled(x, size);
    put(tool.a, tool.probe.a);
    put(x, tool.probe.x);
    put(y, tool.probe.y);
    put(z, tool.probe.z);
    tool.probe.length = (float)size;
    return tool;
}

static double margin_of(const struct tool *tool)
{
    return (double)KERNEL_MARGIN * (1.0 + length(tool->a) + length(add(tool->a, tool->u)));
}

static vec3 corner(const float *block, int k, int lane)
{
    return (vec3){ block[3 * k * LANES + lane], block[(3 * k + 1) * LANES + lane],
                   block[(3 * k + 2) * LANES + lane] };
}

static void bounds_of_triangles_are_sound(void)
{
    const char *const names[SHAPES] = { "ordinary", "slivers", "points", "flat" };
    uint64_t random = 7;
    struct kernel kernel;
    uint32_t chosen;
    kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int shape = 0; shape < SHAPES; shape++) {
        double worst = 0.0, slack = 0.0;
        int apart = 0;
        for (int i = 0; i < BLOCKS; i++) {
            float block[9 * LANES], bound[LANES];
            make_triangles(&random, shape, block);
            struct tool tool = make_tool(&random, shape);
            kernel.triangles(block, &tool.probe, bound);
            for (int lane = 0; lane < LANES; lane++) {
                pair truth = segment_triangle(tool.a, tool.u, corner(block, 0, lane),
                                              corner(block, 1, lane), corner(block, 2, lane));
                double distance = sqrt(truth.distance2);
                double over = ((double)bound[lane] - distance) / margin_of(&tool);
                worst = larger(worst, over);
                if (distance > 1e-3 + 8.0 * margin_of(&tool)) {
                    apart++;
                    slack += isfinite(bound[lane]) ? 1.0 - (double)bound[lane] / distance : 1.0;
                }
                CHECK(!(over > 1.0), "%s: bound %.9g above %.17g by %.3g margins", names[shape],
                      (double)bound[lane], distance, over);
            }
        }
        slack /= apart;
        printf("    %-10s above the truth by at most %5.3f margins; mean slack %.2g of %d apart\n",
               names[shape], worst, slack, apart);
        CHECK(slack < 1e-6, "%s: bounds lose %.3g of the distance on average", names[shape], slack);
        CHECK(apart > BLOCKS * LANES / 2, "%s: only %d apart", names[shape], apart);
    }
}

/*
 * One plane for all lanes, as the search takes it: through the nearest pair of one of them. Bounds of the
 * others may be as loose as they like, never above the truth.
 */
static void bounds_of_planes_are_sound(void)
{
    uint64_t random = 13;
    struct kernel kernel;
    uint32_t chosen;
    double worst = -HUGE_VAL, tight = 0.0;
    int planes = 0;
    kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < BLOCKS; i++) {
        float block[9 * LANES], bound[LANES];
        pair truth[LANES];
        make_triangles(&random, i % SHAPES, block);
        struct tool tool = make_tool(&random, i % SHAPES);
        for (int lane = 0; lane < LANES; lane++)
            truth[lane] = segment_triangle(tool.a, tool.u, corner(block, 0, lane),
                                           corner(block, 1, lane), corner(block, 2, lane));
        double distance = sqrt(truth[0].distance2);
        if (distance < 1e-3)
            continue;
        vec3 normal = scaled(truth[0].gap, -1.0 / distance);
        put(normal, tool.probe.normal);
        tool.probe.height = (float)(dot(normal, tool.a) + larger(0.0, dot(normal, tool.u)));
        kernel.planes(block, &tool.probe, bound);
        for (int lane = 0; lane < LANES; lane++) {
            double over = ((double)bound[lane] - sqrt(truth[lane].distance2)) / margin_of(&tool);
            worst = larger(worst, over);
            CHECK(!(over > 1.0), "plane bound above the truth by %.3g margins", over);
        }
        tight += fabs((double)bound[0] - distance) / margin_of(&tool) <= 1.0;
        planes++;
    }
    printf("    above the truth by at most %5.3f margins, equal to it on its own lane %.1f %%\n",
           worst, 100.0 * tight / planes);
    CHECK(planes > BLOCKS / 2 && tight > 0.99 * planes, "%d planes, %g tight", planes, tight);
}

/* A box's bound against its corners: the least distance to a box of known content. */
static void bounds_of_boxes_are_sound(void)
{
    uint64_t random = 11;
    struct kernel kernel;
    uint32_t chosen;
    double worst = 0.0;
    kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < BLOCKS; i++) {
        float content[9 * LANES], block[6 * LANES], bound[LANES];
        make_triangles(&random, ORDINARY, content);
        struct tool tool = make_tool(&random, ORDINARY);
        for (int lane = 0; lane < LANES; lane++)
            for (int axis = 0; axis < 3; axis++) {
                float low = HUGE_VALF, high = -HUGE_VALF;
                for (int k = 0; k < 3; k++) {
                    float x = content[(3 * k + axis) * LANES + lane];
                    low = x < low ? x : low;
                    high = x > high ? x : high;
                }
                float centre = 0.5f * (low + high);
                float half = high - centre > centre - low ? high - centre : centre - low;
                block[axis * LANES + lane] = centre;
                block[(3 + axis) * LANES + lane] = nextafterf(half, HUGE_VALF);
            }
        kernel.boxes(block, &tool.probe, bound);
        for (int lane = 0; lane < LANES; lane++) {
            pair truth = segment_triangle(tool.a, tool.u, corner(content, 0, lane),
                                          corner(content, 1, lane), corner(content, 2, lane));
            double over = ((double)bound[lane] - sqrt(truth.distance2)) / margin_of(&tool);
            worst = larger(worst, over);
            CHECK(!(over > 1.0), "box bound above its content by %.3g margins", over);
        }
    }
    printf("    above the truth by at most %5.3f margins\n", worst);
}

static void all_kernels_give_the_same_bits(void)
{
    uint64_t random = 3;
    uint32_t chosen, compared = 0;
    struct kernel plain, other;
    kernel_get(DPT_KERNEL_SCALAR, &plain, &chosen);
    for (uint32_t id = DPT_KERNEL_SSE2; id <= DPT_KERNEL_NEON; id++) {
        if (!kernel_get(id, &other, &chosen)) {
            SKIP(dpt_kernel_name(id), "not on this machine or in this build");
            continue;
        }
        compared++;
        for (int i = 0; i < BLOCKS; i++) {
            float block[9 * LANES], expected[LANES], bound[LANES];
            make_triangles(&random, i % SHAPES, block);
            struct tool tool = make_tool(&random, i % SHAPES);
            plain.triangles(block, &tool.probe, expected);
            other.triangles(block, &tool.probe, bound);
            CHECK(!memcmp(expected, bound, sizeof bound), "%s: triangles, block %d",
                  dpt_kernel_name(id), i);
            for (int k = 0; k < 3; k++)
                tool.probe.normal[k] = tool.probe.x[(k + 1) % 3];
            tool.probe.height = tool.probe.a[0];
            plain.planes(block, &tool.probe, expected);
            other.planes(block, &tool.probe, bound);
            CHECK(!memcmp(expected, bound, sizeof bound), "%s: planes, block %d",
                  dpt_kernel_name(id), i);
            for (int row = 3 * LANES; row < 6 * LANES; row++)
                block[row] = fabsf(block[row]);
            plain.boxes(block, &tool.probe, expected);
            other.boxes(block, &tool.probe, bound);
            CHECK(!memcmp(expected, bound, sizeof bound), "%s: boxes, block %d",
                  dpt_kernel_name(id), i);
        }
    }
    printf("    %u kernels against the scalar one\n", compared);
}

static void best_kernel_is_to_be_had(void)
{
    struct kernel kernel;
    uint32_t chosen;
    CHECK(kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen), "auto");
    CHECK(chosen == dpt_kernel_best(), "%u", chosen);
    CHECK(kernel_get(DPT_KERNEL_ALWAYS, &kernel, &chosen), "always");
    CHECK(!kernel_get(99, &kernel, &chosen), "no such kernel");
    CHECK(strcmp(dpt_kernel_name(99), "none") == 0, "%s", dpt_kernel_name(99));
}

int main(void)
{
    TEST(best_kernel_is_to_be_had);
    TEST(bounds_of_triangles_are_sound);
    TEST(bounds_of_planes_are_sound);
    TEST(bounds_of_boxes_are_sound);
    TEST(all_kernels_give_the_same_bits);
    return check_report();
}
