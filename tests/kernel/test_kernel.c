/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The float bounds: the same bits from every kernel of this machine, never above the true distance
 * by more than the stated margin, at the pose that made the planes and at any other, and tight
 * enough to be of use. The truth is the pair distance in double, which test_pair.c holds against
 * oracles of its own.
 */
#include "base/angle.h"
#include "kernel/kernel_ops.h"
#include "lib/check.h"
#include "mesh/mesh_format.h"
#include "nearest/segment_triangle.h"

#define BLOCKS 20000

enum shape { ORDINARY, SLIVERS, POINTS, FLAT, SHAPES };

static const char *const shape_names[SHAPES] = { "ordinary", "slivers", "points", "flat" };

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

/* An axis in double, and the probe that the search makes of it. */
struct tool {
    vec3 a, u;
    vec3 x; /* the direction of u, also where u is zero */
    struct filter_segment probe;
};

static vec3 random_vec(uint64_t *random, double reach)
{
    return (vec3){ random_in(random, -reach, reach), random_in(random, -reach, reach),
                   random_in(random, -reach, reach) };
}

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

static float dot_float(const float n[3], const float p[3])
{
    return n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
}

static void put_normal(vec3 normal, struct filter_segment *segment)
{
    put(normal, segment->normal);
    float at_a = dot_float(segment->normal, segment->a);
    float at_b = dot_float(segment->normal, segment->b);
    segment->height = at_a > at_b ? at_a : at_b;
}

static struct tool tool_at(uint64_t *random, vec3 a, vec3 x, double size)
{
    struct tool tool = { .a = a, .u = scaled(x, size), .x = x };
    vec3 y, z;
    unit_frame(x, &y, &z);
    put(a, tool.probe.a);
    put(add(a, tool.u), tool.probe.b);
    put(x, tool.probe.x);
    put(y, tool.probe.y);
    put(z, tool.probe.z);
    tool.probe.length = (float)size;
    tool.probe.limit = (float)pow(10.0, random_in(random, -3.0, 2.0));
    put_normal(y, &tool.probe);
    return tool;
}

static struct tool make_tool(uint64_t *random, int shape)
{
    double reach = random_bits(random) % 8 ? 1.5 : 100.0;
    double size = random_bits(random) % 8 ? pow(10.0, random_in(random, -3.0, 1.0)) : 0.0;
    vec3 a = random_vec(random, reach);
    vec3 x = random_vec(random, 1.0);
    if (shape == FLAT && random_bits(random) % 2)
        x.z = random_in(random, -1e-6, 1e-6);
    return tool_at(random, a, scaled(x, 1.0 / length(x)), size);
}

/* One whose ends are farther out than all triangles: each lies beside it. */
static struct tool make_long_tool(uint64_t *random)
{
    vec3 through = random_vec(random, 1.5), x = random_vec(random, 1.0);
    x = scaled(x, 1.0 / length(x));
    return tool_at(random, along(through, -5.0, x), x, 10.0);
}

/* The same tool at another pose: 1e-6 .. 1 away, and turned by as many radians. */
static struct tool move_tool(uint64_t *random, const struct tool *tool)
{
    vec3 way = random_vec(random, 1.0), pivot = random_vec(random, 1.0);
    way = scaled(way, pow(10.0, random_in(random, -6.0, 0.0)) / length(way));
    pivot = scaled(pivot, 1.0 / length(pivot));
    double angle = pow(10.0, random_in(random, -6.0, 0.0));
    vec3 x = scaled(tool->x, cos(angle));
    x = along(x, sin(angle), cross(pivot, tool->x));
    x = along(x, (1.0 - cos(angle)) * dot(pivot, tool->x), pivot);
    return tool_at(random, add(tool->a, way), scaled(x, 1.0 / length(x)), length(tool->u));
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

static vec3 corner(const float *block, int k, int lane)
{
    return (vec3){ block[3 * k * LANES + lane], block[(3 * k + 1) * LANES + lane],
                   block[(3 * k + 2) * LANES + lane] };
}

static pair pair_of(const struct tool *tool, const float *block, int lane)
{
    return segment_triangle(tool->a, tool->u, corner(block, 0, lane), corner(block, 1, lane),
                            corner(block, 2, lane));
}

/* By how many margins the worst of 16 bounds lies above the truth. A NaN bounds nothing. */
static double check_sound(const char *what, const struct tool *tool, const float *content,
                          const float *bound)
{
    double worst = -HUGE_VAL;
    for (int lane = 0; lane < LANES; lane++) {
        double distance = sqrt(pair_of(tool, content, lane).distance2);
        double over = ((double)bound[lane] - distance) / margin_of(tool);
        CHECK(!(over > 1.0), "%s: bound %.9g above %.17g by %.3g margins", what,
              (double)bound[lane], distance, over);
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
    return same_floats(p->x, q->x, LANES) && same_floats(p->y, q->y, LANES) &&
           same_floats(p->z, q->z, LANES) && same_floats(p->support, q->support, LANES);
}

static struct kernel best_kernel(void)
{
    struct kernel kernel;
    uint32_t chosen;
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    return kernel;
}

/* How far bounds are above the truth, in margins, and below it on average, in distances. */
static void check_tight(const char *name, double worst, double slack, int apart)
{
    printf("    %-10s above the truth by at most %5.3f margins; mean slack %.2g of %d apart\n",
           name, worst, slack, apart);
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
            uint32_t open = kernel.triangles(block, &tool.probe, &planes, bound);
            CHECK(open == not_beyond(bound, tool.probe.limit), "%x", open);
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
            uint32_t open = kernel.boxes(block, &tool.probe, &planes, bound);
            CHECK(open == not_beyond(bound, tool.probe.limit), "%x", open);
            worst = max_of(check_sound(shape_names[shape], &tool, content, bound), worst);
            for (int lane = 0; lane < LANES; lane++) {
                vec3 centre = corner(block, 0, lane), half = corner(block, 1, lane);
                pair truth = segment_triangle(tool.a, tool.u, centre, centre, centre);
                double distance = sqrt(truth.distance2);
                if (!is_apart(&tool, distance))
                    continue;
                double reach = (fabs(truth.gap.x) * half.x + fabs(truth.gap.y) * half.y +
                                fabs(truth.gap.z) * half.z) /
                               distance;
                apart++;
                slack +=
                    isfinite(bound[lane]) ? 1.0 - ((double)bound[lane] + reach) / distance : 1.0;
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
            float limit = tool.probe.limit * tool.probe.limit;
            uint32_t open = kernel.point_triangles(content, tool.probe.a, limit, bound[0]);
            CHECK(open == not_beyond(bound[0], limit), "%x", open);
            /* Where all are closed no bound need be tight. */
            for (int lane = 0; lane < LANES; lane++)
                bound[0][lane] = sqrtf(bound[0][lane]);
            worst[0] = max_of(check_sound(shape_names[shape], &tool, content, bound[0]), worst[0]);
            kernel.point_triangles(content, tool.probe.a, HUGE_VALF, bound[0]);
            open = kernel.point_boxes(block, tool.probe.a, limit, bound[1]);
            CHECK(open == not_beyond(bound[1], limit), "boxes: %x", open);
            for (int lane = 0; lane < LANES; lane++) {
                vec3 off = sub(tool.a, corner(block, 0, lane)), half = corner(block, 1, lane);
                double box = length((vec3){ max_of(fabs(off.x) - half.x, 0.0),
                                            max_of(fabs(off.y) - half.y, 0.0),
                                            max_of(fabs(off.z) - half.z, 0.0) });
                double distance = sqrt(pair_of(&tool, content, lane).distance2);
                for (int k = 0; k < 2; k++)
                    bound[k][lane] = sqrtf(bound[k][lane]);
                apart += is_apart(&tool, distance);
                if (is_apart(&tool, distance))
                    slack[0] +=
                        isfinite(bound[0][lane]) ? 1.0 - (double)bound[0][lane] / distance : 1.0;
                if (is_apart(&tool, box))
                    slack[1] += fabs(1.0 - (double)bound[1][lane] / box);
            }
            for (int k = 0; k < 2; k++)
                worst[k] =
                    max_of(check_sound(shape_names[shape], &tool, content, bound[k]), worst[k]);
        }
        printf("    %-10s above the truth by at most %5.3f margins, boxes %5.3f; mean slack %.2g, "
               "boxes %.2g\n",
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
        put_normal(scaled(truth.gap, -1.0 / distance), &tool.probe);
        const float beyond = tool.probe.height + tool.probe.limit;
        uint32_t open = kernel.common_triangles(block, tool.probe.normal, beyond, low);
        CHECK(open == not_beyond(low, beyond), "%x", open);
        for (int lane = 0; lane < LANES; lane++) {
            double there = sqrt(pair_of(&tool, block, lane).distance2);
            double over =
                ((double)low[lane] - (double)tool.probe.height - there) / margin_of(&tool);
            worst = max_of(over, worst);
            CHECK(!(over > 1.0), "common bound above the truth by %.3g margins", over);
            CHECK(open >> lane & 1 || there > (double)tool.probe.limit - margin_of(&tool),
                  "closed at %.9g, limit %.9g", there, (double)tool.probe.limit);
            planes.x[lane] = tool.probe.normal[0];
            planes.y[lane] = tool.probe.normal[1];
            planes.z[lane] = tool.probe.normal[2];
            planes.support[lane] = low[lane];
        }
        tight += fabs((double)low[0] - (double)tool.probe.height - distance) <= margin_of(&tool);
        taken++;
        struct tool other = move_tool(&random, &tool);
        kernel.cached_triangles(block, &other.probe, &planes, bound);
        moved = max_of(check_sound("common, held", &other, block, bound), moved);
    }
    printf("    above the truth by at most %5.3f margins, held %5.3f; equal to it on its own lane "
           "%.1f %%\n",
           worst, moved, 100.0 * tight / taken);
    CHECK(taken > BLOCKS / 2 && tight > 0.99 * taken, "%d planes, %g tight", taken, tight);
}

/*
 * Planes bound the distance at whatever pose. `content` lies in what `planes` were made of, `block`; `made`
 * are the bounds that came with them, at the pose of `tool`. Held bounds are those, or better.
 */
static void check_held(const char *what, kernel_cached *held, uint64_t *random,
                       const struct tool *tool, const float *content, const float *block,
                       const struct planes *planes, const float *made, double *near_by,
                       double *elsewhere)
{
    float bound[LANES];
    uint32_t open = held(block, &tool->probe, planes, bound);
    for (int lane = 0; lane < LANES; lane++)
        CHECK(!((double)bound[lane] < (double)made[lane] - 0.25 * margin_of(tool)),
              "%s: %.9g at the same pose, was %.9g", what, (double)bound[lane], (double)made[lane]);
    for (int k = 0; k < 3; k++) {
        struct tool other = k < 2 ? move_tool(random, tool) : make_tool(random, ORDINARY);
        double *worst = k < 2 ? near_by : elsewhere;
        open = held(block, &other.probe, planes, bound);
        CHECK(open == not_beyond(bound, other.probe.limit), "%s: open %x", what, open);
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
        kernel.triangles(content, &tool.probe, &planes, bound);
        check_held("triangles, held", kernel.cached_triangles, &random, &tool, content, content,
                   &planes, bound, &near_by[0], &elsewhere[0]);
        kernel.boxes(block, &tool.probe, &planes, bound);
        check_held("boxes, held", kernel.cached_boxes, &random, &tool, content, block, &planes,
                   bound, &near_by[1], &elsewhere[1]);
        kernel.common_boxes(block, tool.probe.normal, 0.0f, planes.support);
        for (int lane = 0; lane < LANES; lane++) {
            planes.x[lane] = tool.probe.normal[0];
            planes.y[lane] = tool.probe.normal[1];
            planes.z[lane] = tool.probe.normal[2];
            bound[lane] = planes.support[lane] - tool.probe.height;
        }
        check_held("common, held", kernel.cached_boxes, &random, &tool, content, block, &planes,
                   bound, &near_by[1], &elsewhere[1]);
    }
    printf("    triangles: above the truth by at most %5.3f margins after a move, %5.3f anywhere\n",
           near_by[0], elsewhere[0]);
    printf("    boxes:     above the truth by at most %5.3f margins after a move, %5.3f anywhere\n",
           near_by[1], elsewhere[1]);
}

static void zero_planes_close_nothing(void)
{
    const float limits[] = { 0.0f, 1e-45f, 1e-6f, 1.0f, 1e30f, HUGE_VALF };
    const uint32_t count = sizeof limits / sizeof limits[0];
    const struct planes none = { .x = { 0.0f } };
    uint64_t random = 19;
    uint32_t chosen;
    struct kernel kernel;
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++) {
        if (!dpti_kernel_get(id, &kernel, &chosen))
            continue;
        for (uint32_t i = 0; i < BLOCKS; i++) {
            float bound[LANES];
            struct tool tool = make_tool(&random, ORDINARY);
            if (i % 2)
                tool.probe.limit = limits[i / 2 % count];
            float block[9 * LANES];
            make_triangles(&random, ORDINARY, block);
            uint32_t open = kernel.cached_triangles(block, &tool.probe, &none, bound);
            CHECK(open == 0xffff, "%s: open %x, limit %g", dpt_kernel_name(id), open,
                  (double)tool.probe.limit);
            open = kernel.cached_boxes(block, &tool.probe, &none, bound);
            CHECK(open == 0xffff, "%s: boxes open %x, limit %g", dpt_kernel_name(id), open,
                  (double)tool.probe.limit);
        }
    }
}

/* What lies at the axis's own end has no direction: set such lanes, and return them. */
static uint32_t degenerate_lanes(uint64_t *random, const struct tool *tool, float block[9 * LANES])
{
    uint32_t lanes = (uint32_t)(random_bits(random) & random_bits(random) & 0xffff);
    for (int lane = 0; lane < LANES; lane++)
        for (int row = 0; lanes >> lane & 1 && row < 9; row++)
            block[row * LANES + lane] = tool->probe.a[row % 3];
    return lanes;
}

static void check_no_number(const char *what, const struct filter_segment *segment,
                            const float *bound, uint32_t open, uint32_t degenerate)
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
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++) {
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
            open = kernel.triangles(content, &tool.probe, &planes, bound);
            check_no_number("triangles", &tool.probe, bound, open, degenerate);
            closed |= ~open & 0xffff;
            open = kernel.cached_triangles(content, &other.probe, &planes, bound);
            check_no_number("triangles, held", &other.probe, bound, open, degenerate);
            open = kernel.boxes(block, &tool.probe, &planes, bound);
            check_no_number("boxes", &tool.probe, bound, open, degenerate);
            closed |= (~open & 0xffff) << LANES;
            open = kernel.cached_boxes(block, &other.probe, &planes, bound);
            check_no_number("boxes, held", &other.probe, bound, open, degenerate);
        }
    }
    CHECK(closed == 0xffffffff, "lanes that ever closed: %x", closed);
}

/* Two kernels on one block of triangles or boxes: planes, bounds and lanes, made and held. */
static void check_same_renewal(const char *what, kernel_cached *plain, kernel_new_planes *one,
                               kernel_cached *wide, kernel_new_planes *two, const float *block,
                               const struct filter_segment *segment,
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
    for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_NEON; id++) {
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
                CHECK(same_floats(&after_bound[lane], &expected, 1), "%s: bound %g, not %g",
                      dpt_kernel_name(id), (double)after_bound[lane], (double)expected);
                for (int row = 0; row < 4; row++)
                    CHECK(rows[row * LANES + lane] ==
                              (takes ? made_rows : kept_rows)[row * LANES + lane],
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
    for (uint32_t id = DPT_KERNEL_SSE2; id <= DPT_KERNEL_NEON; id++) {
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
            check_same_renewal(name, plain.cached_triangles, plain.triangles,
                               other.cached_triangles, other.triangles, block, &tool.probe,
                               &later.probe);
            uint32_t expected_open =
                plain.common_triangles(block, tool.probe.normal, tool.probe.height, expected);
            uint32_t open =
                other.common_triangles(block, tool.probe.normal, tool.probe.height, low);
            CHECK(same_floats(expected, low, LANES), "%s: common, block %d", name, i);
            CHECK(expected_open == open, "%s: common open %x, not %x", name, open, expected_open);
            expected_open = plain.point_triangles(block, tool.probe.a, tool.probe.limit, expected);
            open = other.point_triangles(block, tool.probe.a, tool.probe.limit, low);
            CHECK(same_floats(expected, low, LANES), "%s: point, block %d", name, i);
            CHECK(expected_open == open, "%s: point open %x, not %x", name, open, expected_open);
            for (int row = 3 * LANES; row < 6 * LANES; row++)
                block[row] = fabsf(block[row]);
            check_same_renewal(name, plain.cached_boxes, plain.boxes, other.cached_boxes,
                               other.boxes, block, &tool.probe, &later.probe);
            const float *normal = tool.probe.normal;
            expected_open = plain.common_boxes(block, normal, tool.probe.height, expected);
            open = other.common_boxes(block, normal, tool.probe.height, low);
            CHECK(same_floats(expected, low, LANES), "%s: common of boxes, block %d", name, i);
            CHECK(expected_open == open, "%s: common open %x, not %x", name, open, expected_open);
            expected_open = plain.point_boxes(block, tool.probe.a, tool.probe.limit, expected);
            open = other.point_boxes(block, tool.probe.a, tool.probe.limit, low);
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
        at[k] = random_bits(random) % 16 ? 2.0f * coordinate(random)
                                         : block[(MESH_MOMENT_AT + k) * LANES + 3];
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
    for (uint32_t id = DPT_KERNEL_SSE2; id <= DPT_KERNEL_NEON; id++) {
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
            CHECK(open == expected && !(open & ~lanes), "%s: angles open %x, not %x", name, open,
                  expected);
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
            double turns =
                solid_turns(sub(corner(block, 0, lane), x), sub(corner(block, 1, lane), x),
                            sub(corner(block, 2, lane), x));
            const int added = ((lanes & ~open) >> lane & 1) != 0;
            open_lanes += (open >> lane & 1) != 0;
            worst = max_of(worst, added ? fabs((double)sums[lane] - turns) : 0.0);
            CHECK(added || sums[lane] == 0.0f, "lane %d of %x, open %x: %g", lane, lanes, open,
                  (double)sums[lane]);
            CHECK(added || !(lanes >> lane & 1) || open >> lane & 1, "lost");
        }
    }
    printf("    off by at most %.2g turns; %.2g %% left open\n", worst,
           100.0 * open_lanes / (BLOCKS * LANES * 0.75));
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
            v[2] = along(scaled(v[0], -random_in(&random, 0.0, 2.0)), random_in(&random, -2.0, 0.0),
                         v[1]);
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

int main(void)
{
    TEST(best_kernel_is_to_be_had);
    TEST(bounds_of_triangles_are_sound);
    TEST(bounds_of_boxes_are_sound);
    TEST(bounds_of_points_are_sound);
    TEST(common_supports_are_sound);
    TEST(held_planes_are_sound_at_other_poses);
    TEST(zero_planes_close_nothing);
    TEST(bounds_that_are_no_number_leave_lanes_open);
    TEST(the_better_planes_are_kept);
    TEST(all_kernels_give_the_same_bits);
    TEST(turns_agree_with_the_c_library);
    TEST(angles_are_solid_angles);
    TEST(all_kernels_give_the_same_windings);
    return check_report();
}
