/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The float bounds: the same bits from every kernel of this machine, never above the true distance
 * by more than the stated margin, at the pose that made the planes and at any other, and tight
 * enough to be of use. The truth is the pair distance in double, which test_pair.c holds against
 * oracles of its own.
 *
 *     test_kernel [PER CENT]   of the random blocks
 */
#include "kernel/kernel_scene.h"

static const char *const shape_names[SHAPES] = { "ordinary", "slivers", "points", "flat" };

/* The boxes of 16 triangles, as narrow as floats allow. */
static void make_boxes(const float *content, float block[6 * LANES])
{
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
}

static double margin_of(const struct tool *tool)
{
    return kernel_margin(length(tool->a), length(add(tool->a, tool->u)));
}

/* A distance that rounding leaves alone. */
static int is_apart(const struct tool *tool, double distance)
{
    return distance > 1e-3 + 8.0 * margin_of(tool);
}

static pair pair_of(const struct tool *tool, const float *block, int lane)
{
    return segment_triangle(tool->a, tool->u, corner(block, 0, lane), corner(block, 1, lane), corner(block, 2, lane));
}

/* By how many margins the worst of 16 bounds lies above the truth. A NaN bounds nothing. */
static double check_sound(const char *what, const struct tool *tool, const float *content, const float *bound)
{
    double worst = -HUGE_VAL;
    for (int lane = 0; lane < LANES; lane++) {
        double distance = sqrt(pair_of(tool, content, lane).distance2);
        double over = ((double)bound[lane] - distance) / margin_of(tool);
        CHECK(!(over > 1.0), "%s: bound %.9g above %.17g by %.3g margins", what, (double)bound[lane], distance, over);
        worst = max_of(over, worst);
    }
    return worst;
}

static uint32_t not_beyond(const float *bound, float limit)
{
    uint32_t lanes = 0;
    for (int lane = 0; lane < LANES; lane++)
        lanes |= (uint32_t) !(bound[lane] > limit) << lane;
    return lanes;
}

/* How far bounds are above the truth, in margins, and below it on average, in distances. */
static void check_tight(const char *name, double worst, double slack, int apart)
{
    printf("    %-10s above the truth by at most %5.3f margins; mean slack %.2g of %d apart\n", name, worst, slack,
           apart);
    CHECK(slack < 1e-6, "%s: bounds lose %.3g of the distance on average", name, slack);
    CHECK(apart > BLOCKS * LANES / 2, "%s: only %d apart", name, apart);
}

static void bounds_of_triangles_are_sound(void)
{
    uint64_t random = 7;
    struct kernel kernel = best_kernel();
    for (int shape = 0; shape < SHAPES; shape++) {
        double worst = -HUGE_VAL, slack = 0.0;
        int apart = 0;
        for (int i = 0; i < BLOCKS; i++) {
            float block[9 * LANES], bound[LANES];
            struct planes planes;
            make_triangles(&random, shape, block);
            struct tool tool = i % 4 ? make_tool(&random, shape) : make_long_tool(&random);
            uint32_t open = kernel.triangles(block, &tool.filter, &planes, bound);
            CHECK(open == not_beyond(bound, tool.filter.limit), "%x", open);
            worst = max_of(check_sound(shape_names[shape], &tool, block, bound), worst);
            for (int lane = 0; lane < LANES; lane++) {
                double distance = sqrt(pair_of(&tool, block, lane).distance2);
                if (!is_apart(&tool, distance))
                    continue;
                apart++;
                slack += isfinite(bound[lane]) ? 1.0 - (double)bound[lane] / distance : 1.0;
            }
        }
        check_tight(shape_names[shape], worst, slack / apart, apart);
    }
}

/*
 * A box's bound against its content is sound. It is tight against the one plane that it means:
 * across the nearest connection of centre and axis, as far from the centre as the box reaches.
 */
static void bounds_of_boxes_are_sound(void)
{
    uint64_t random = 11;
    struct kernel kernel = best_kernel();
    for (int shape = 0; shape < SHAPES; shape++) {
        double worst = -HUGE_VAL, slack = 0.0;
        int apart = 0;
        for (int i = 0; i < BLOCKS; i++) {
            float content[9 * LANES], block[6 * LANES], bound[LANES];
            struct planes planes;
            make_triangles(&random, shape, content);
            make_boxes(content, block);
            struct tool tool = make_tool(&random, shape);
            uint32_t open = kernel.boxes(block, &tool.filter, &planes, bound);
            CHECK(open == not_beyond(bound, tool.filter.limit), "%x", open);
            worst = max_of(check_sound(shape_names[shape], &tool, content, bound), worst);
            for (int lane = 0; lane < LANES; lane++) {
                vec3 centre = corner(block, 0, lane), half = corner(block, 1, lane);
                pair truth = segment_triangle(tool.a, tool.u, centre, centre, centre);
                double distance = sqrt(truth.distance2);
                if (!is_apart(&tool, distance))
                    continue;
                double reach =
                    (fabs(truth.gap.x) * half.x + fabs(truth.gap.y) * half.y + fabs(truth.gap.z) * half.z) / distance;
                apart++;
                slack += isfinite(bound[lane]) ? 1.0 - ((double)bound[lane] + reach) / distance : 1.0;
            }
        }
        check_tight(shape_names[shape], worst, slack / apart, apart);
    }
}

/* Squares, of a tool without length. A box' is that of its nearest point. */
static void bounds_of_points_are_sound(void)
{
    uint64_t random = 29;
    struct kernel kernel = best_kernel();
    for (int shape = 0; shape < SHAPES; shape++) {
        double worst[2] = { -HUGE_VAL, -HUGE_VAL }, slack[2] = { 0.0, 0.0 };
        int apart = 0;
        for (int i = 0; i < BLOCKS; i++) {
            float content[9 * LANES], block[6 * LANES], bound[2][LANES];
            make_triangles(&random, shape, content);
            make_boxes(content, block);
            struct tool any = make_tool(&random, shape);
            struct tool tool = tool_at(&random, any.a, any.x, 0.0);
            float limit = tool.filter.limit * tool.filter.limit;
            uint32_t open = kernel.point_triangles(content, tool.filter.a, limit, bound[0]);
            CHECK(open == not_beyond(bound[0], limit), "%x", open);
            /* Where all are closed no bound need be tight. */
            for (int lane = 0; lane < LANES; lane++)
                bound[0][lane] = sqrtf(bound[0][lane]);
            worst[0] = max_of(check_sound(shape_names[shape], &tool, content, bound[0]), worst[0]);
            kernel.point_triangles(content, tool.filter.a, HUGE_VALF, bound[0]);
            open = kernel.point_boxes(block, tool.filter.a, limit, bound[1]);
            CHECK(open == not_beyond(bound[1], limit), "boxes: %x", open);
            for (int lane = 0; lane < LANES; lane++) {
                vec3 off = sub(tool.a, corner(block, 0, lane)), half = corner(block, 1, lane);
                double box = length((vec3){ max_of(fabs(off.x) - half.x, 0.0), max_of(fabs(off.y) - half.y, 0.0),
                                            max_of(fabs(off.z) - half.z, 0.0) });
                double distance = sqrt(pair_of(&tool, content, lane).distance2);
                for (int k = 0; k < 2; k++)
                    bound[k][lane] = sqrtf(bound[k][lane]);
                apart += is_apart(&tool, distance);
                if (is_apart(&tool, distance))
                    slack[0] += isfinite(bound[0][lane]) ? 1.0 - (double)bound[0][lane] / distance : 1.0;
                if (is_apart(&tool, box))
                    slack[1] += fabs(1.0 - (double)bound[1][lane] / box);
            }
            for (int k = 0; k < 2; k++)
                worst[k] = max_of(check_sound(shape_names[shape], &tool, content, bound[k]), worst[k]);
        }
        printf("    %-10s above the truth by at most %5.3f margins, boxes %5.3f; mean slack %.2g, boxes %.2g\n",
               shape_names[shape], worst[0], worst[1], slack[0] / apart, slack[1] / apart);
        CHECK(slack[0] < 1e-5 * apart && slack[1] < 1e-6 * apart, "%s: loose", shape_names[shape]);
        CHECK(apart > BLOCKS * LANES / 2, "%s: only %d apart", shape_names[shape], apart);
    }
}

/*
 * One normal for all lanes, as the search takes it: through the nearest pair of one of them. Bounds
 * of the others may be as loose as they like, never above the truth, nor when the planes are held.
 */
static void common_supports_are_sound(void)
{
    uint64_t random = 13;
    struct kernel kernel = best_kernel();
    double worst = -HUGE_VAL, moved = -HUGE_VAL, tight = 0.0;
    int taken = 0;
    for (int i = 0; i < BLOCKS; i++) {
        float block[9 * LANES], low[LANES], bound[LANES];
        struct planes planes;
        make_triangles(&random, i % SHAPES, block);
        struct tool tool = make_tool(&random, i % SHAPES);
        pair truth = pair_of(&tool, block, 0);
        double distance = sqrt(truth.distance2);
        if (distance < 1e-3)
            continue;
        put_normal(scaled(truth.gap, -1.0 / distance), &tool.filter);
        const float beyond = tool.filter.height + tool.filter.limit;
        uint32_t open = kernel.common_triangles(block, tool.filter.normal, beyond, low);
        CHECK(open == not_beyond(low, beyond), "%x", open);
        for (int lane = 0; lane < LANES; lane++) {
            double there = sqrt(pair_of(&tool, block, lane).distance2);
            double over = ((double)low[lane] - (double)tool.filter.height - there) / margin_of(&tool);
            worst = max_of(over, worst);
            CHECK(!(over > 1.0), "common bound above the truth by %.3g margins", over);
            CHECK(open >> lane & 1 || there > (double)tool.filter.limit - margin_of(&tool),
                  "closed at %.9g, limit %.9g", there, (double)tool.filter.limit);
            planes.x[lane] = tool.filter.normal[0];
            planes.y[lane] = tool.filter.normal[1];
            planes.z[lane] = tool.filter.normal[2];
            planes.support[lane] = low[lane];
        }
        tight += fabs((double)low[0] - (double)tool.filter.height - distance) <= margin_of(&tool);
        taken++;
        struct tool other = move_tool(&random, &tool);
        kernel.cached_triangles(block, &other.filter, &planes, bound);
        moved = max_of(check_sound("common, held", &other, block, bound), moved);
    }
    printf("    above the truth by at most %5.3f margins, held %5.3f; equal to it on its own lane %.1f %%\n", worst,
           moved, 100.0 * tight / taken);
    CHECK(taken > BLOCKS / 2 && tight > 0.99 * taken, "%d planes, %g tight", taken, tight);
}

/*
 * Planes bound the distance at whatever pose. `content` lies in what `planes` were made of, `block`; `made`
 * are the bounds that came with them, at the pose of `tool`. Held bounds are those, or better.
 */
static void check_held(const char *what, kernel_cached *held, uint64_t *random, const struct tool *tool,
                       const float *content, const float *block, const struct planes *planes, const float *made,
                       double *near_by, double *elsewhere)
{
    float bound[LANES];
    uint32_t open = held(block, &tool->filter, planes, bound);
    for (int lane = 0; lane < LANES; lane++)
        CHECK(!((double)bound[lane] < (double)made[lane] - 0.25 * margin_of(tool)),
              "%s: %.9g at the same pose, was %.9g", what, (double)bound[lane], (double)made[lane]);
    for (int k = 0; k < 3; k++) {
        struct tool other = k < 2 ? move_tool(random, tool) : make_tool(random, ORDINARY);
        double *worst = k < 2 ? near_by : elsewhere;
        open = held(block, &other.filter, planes, bound);
        CHECK(open == not_beyond(bound, other.filter.limit), "%s: open %x", what, open);
        *worst = max_of(check_sound(what, &other, content, bound), *worst);
    }
}

static void held_planes_are_sound_at_other_poses(void)
{
    uint64_t random = 17;
    struct kernel kernel = best_kernel();
    double near_by[2] = { -HUGE_VAL, -HUGE_VAL }, elsewhere[2] = { -HUGE_VAL, -HUGE_VAL };
    for (int i = 0; i < BLOCKS; i++) {
        float content[9 * LANES], block[6 * LANES], bound[LANES];
        struct planes planes;
        make_triangles(&random, i % SHAPES, content);
        make_boxes(content, block);
        struct tool tool = make_tool(&random, i % SHAPES);
        kernel.triangles(content, &tool.filter, &planes, bound);
        check_held("triangles, held", kernel.cached_triangles, &random, &tool, content, content, &planes, bound,
                   &near_by[0], &elsewhere[0]);
        kernel.boxes(block, &tool.filter, &planes, bound);
        check_held("boxes, held", kernel.cached_boxes, &random, &tool, content, block, &planes, bound, &near_by[1],
                   &elsewhere[1]);
        kernel.common_boxes(block, tool.filter.normal, 0.0f, planes.support);
        for (int lane = 0; lane < LANES; lane++) {
            planes.x[lane] = tool.filter.normal[0];
            planes.y[lane] = tool.filter.normal[1];
            planes.z[lane] = tool.filter.normal[2];
            bound[lane] = planes.support[lane] - tool.filter.height;
        }
        check_held("common, held", kernel.cached_boxes, &random, &tool, content, block, &planes, bound, &near_by[1],
                   &elsewhere[1]);
    }
    printf("    triangles: above the truth by at most %5.3f margins after a move, %5.3f anywhere\n", near_by[0],
           elsewhere[0]);
    printf("    boxes:     above the truth by at most %5.3f margins after a move, %5.3f anywhere\n", near_by[1],
           elsewhere[1]);
}

static void zero_planes_close_nothing(void)
{
    const float limits[] = { 0.0f, 1e-45f, 1e-6f, 1.0f, 1e30f, HUGE_VALF };
    const uint32_t count = sizeof limits / sizeof limits[0];
    const struct planes none = { .x = { 0.0f } };
    uint64_t random = 19;
    uint32_t chosen;
    struct kernel kernel;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++) {
        if (!dpti_kernel_get(id, &kernel, &chosen))
            continue;
        for (uint32_t i = 0; i < (uint32_t)BLOCKS; i++) {
            float bound[LANES];
            struct tool tool = make_tool(&random, ORDINARY);
            if (i % 2)
                tool.filter.limit = limits[i / 2 % count];
            float block[9 * LANES];
            make_triangles(&random, ORDINARY, block);
            uint32_t open = kernel.cached_triangles(block, &tool.filter, &none, bound);
            CHECK(open == 0xffff, "%s: open %x, limit %g", dpt_kernel_name(id), open, (double)tool.filter.limit);
            open = kernel.cached_boxes(block, &tool.filter, &none, bound);
            CHECK(open == 0xffff, "%s: boxes open %x, limit %g", dpt_kernel_name(id), open, (double)tool.filter.limit);
        }
    }
}

static void check_no_number(const char *what, const struct filter_segment *segment, const float *bound, uint32_t open,
                            uint32_t degenerate)
{
    CHECK(open == not_beyond(bound, segment->limit), "%s: open %x", what, open);
    CHECK((open & degenerate) == degenerate, "%s: open %x of %x", what, open, degenerate);
    for (int lane = 0; lane < LANES; lane++)
        if (degenerate >> lane & 1)
            CHECK(isnan(bound[lane]), "%s: bound %g", what, (double)bound[lane]);
}

static void bounds_that_are_no_number_leave_lanes_open(void)
{
    uint64_t random = 23;
    uint32_t chosen, closed = 0;
    struct kernel kernel;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++) {
        if (!dpti_kernel_get(id, &kernel, &chosen))
            continue;
        for (int i = 0; i < BLOCKS / 4; i++) {
            float content[9 * LANES], block[6 * LANES], bound[LANES];
            struct planes planes;
            make_triangles(&random, i % SHAPES, content);
            struct tool tool = make_tool(&random, i % SHAPES);
            struct tool other = move_tool(&random, &tool);
            uint32_t degenerate = degenerate_lanes(&random, &tool, content), open;
            make_boxes(content, block);
            open = kernel.triangles(content, &tool.filter, &planes, bound);
            check_no_number("triangles", &tool.filter, bound, open, degenerate);
            closed |= ~open & 0xffff;
            open = kernel.cached_triangles(content, &other.filter, &planes, bound);
            check_no_number("triangles, held", &other.filter, bound, open, degenerate);
            open = kernel.boxes(block, &tool.filter, &planes, bound);
            check_no_number("boxes", &tool.filter, bound, open, degenerate);
            closed |= (~open & 0xffff) << LANES;
            open = kernel.cached_boxes(block, &other.filter, &planes, bound);
            check_no_number("boxes, held", &other.filter, bound, open, degenerate);
        }
    }
    CHECK(closed == 0xffffffff, "lanes that ever closed: %x", closed);
}

static void best_kernel_is_to_be_had(void)
{
    struct kernel kernel;
    uint32_t chosen;
    CHECK(dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen), "auto");
    CHECK(chosen == dpt_kernel_best(), "%u", chosen);
    CHECK(dpti_kernel_get(DPT_KERNEL_ALWAYS, &kernel, &chosen), "always");
    CHECK(!dpti_kernel_get(99, &kernel, &chosen), "no such kernel");
    CHECK(strcmp(dpt_kernel_name(99), "none") == 0, "%s", dpt_kernel_name(99));
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(best_kernel_is_to_be_had);
    TEST(bounds_of_triangles_are_sound);
    TEST(bounds_of_boxes_are_sound);
    TEST(bounds_of_points_are_sound);
    TEST(common_supports_are_sound);
    TEST(held_planes_are_sound_at_other_poses);
    TEST(zero_planes_close_nothing);
    TEST(bounds_that_are_no_number_leave_lanes_open);
    return check_report();
}
