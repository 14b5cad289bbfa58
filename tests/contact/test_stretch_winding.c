/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Winding numbers that are counted along an axis, against those by definition.
 *
 *     test_stretch_winding [AXES = 400]
 */
#include "contact/distance_profile.h"

#include "contact/defective_meshes.h"

static int axes = 400;

/* By how much the winding number grows along an axis: all triangles of solid parts that it goes through, by signs. */
static int crossings_by_definition(const struct mesh_builder *builder, vec3 a, vec3 b)
{
    int sum = 0;
    for (uint32_t t = 0; t < builder->info.triangles; t++) {
        vec3 v[3];
        surface_corners(&builder->surface, t, v);
        if (!(surface_part_flags(&builder->surface, surface_part(&builder->surface, t)) & MESH_PART_SOLID))
            continue;
        const vec3 normal = cross(sub(v[1], v[0]), sub(v[2], v[0])), u = sub(b, a);
        const double from = dot(sub(a, v[0]), normal), to = dot(sub(b, v[0]), normal);
        int is_left = 0, is_right = 0;
        for (int k = 0; k < 3; k++) {
            const double side = dot(cross(sub(v[k], a), sub(v[(k + 1) % 3], a)), u);
            is_left += side > 0.0;
            is_right += side < 0.0;
        }
        if ((from < 0.0) != (to < 0.0) && (is_left == 3 || is_right == 3))
            sum += from < 0.0 ? -1 : 1;
    }
    return sum;
}

/* Far from all holes the winding number, by definition, is nearly whole, and grows by what crosses. Returns how often. */
static int follow_windings(const char *name, const struct mesh_builder *builder, int count)
{
    struct holes holes;
    uint64_t random = 9;
    int far = 0, crossed = 0;
    double worst = 0.0;
    dpti_holes_find(&builder->surface, &builder->kernel, &holes);
    for (int i = 0; i < count; i++) {
        double ends[6], winding[2];
        any_axis(builder, &random, ends);
        const vec3 a = vec3_of(ends), b = vec3_of(ends + 3);
        if (!dpti_holes_are_far_from(&holes, a, sub(b, a)))
            continue;
        winding[0] = brute_winding_at(builder, a);
        winding[1] = brute_winding_at(builder, b);
        const int grown = crossings_by_definition(builder, a, b);
        CHECK(round(winding[1]) - round(winding[0]) == grown, "%s: %g and %g, %d crossings", name, winding[0],
              winding[1], grown);
        for (int k = 0; k < 2; k++)
            worst = max_of(worst, fabs(winding[k] - round(winding[k])));
        crossed += grown != 0;
        far++;
    }
    printf("    %-28s %d of %d far, %d have another number at the other end; off by %.2g\n", name, far, count, crossed,
           worst);
    CHECK(worst < 0.45, "%s: %g", name, worst);
    return crossed;
}

static void winding_numbers_change_at_crossings_alone(void)
{
    for (int kind = 0; kind < DEFECTS; kind++) {
        const char *name;
        struct mesh_builder builder;
        if (defective(&builder, kind, &name))
            CHECK(follow_windings(name, &builder, axes / 4) > 0, "%s", name);
        builder_free(&builder);
    }
}

static void in_public_meshes(void)
{
    int crossed = 0;
    for (int i = 0; i < DEFECTIVE_FILES; i++) {
        const char *name;
        struct mesh_builder builder;
        if (defective_file(&builder, getenv("DPT_DATA"), i, &name))
            crossed += follow_windings(name, &builder, axes / 20);
        builder_free(&builder);
    }
    CHECK(crossed > axes / 20, "%d crossed", crossed);
}

/* The crossings and windings of an axis. Returns 1 if those of all stretches are known. */
static int find_windings(const struct surface *surface, const struct kernel *kernel, const struct axis *axis,
                         struct distance_profile *profile)
{
    static const struct sides none;
    profile->surface = surface;
    profile->kernel = kernel;
    profile->axis = axis;
    profile->sides = &none;
    profile->axis_length = length(axis->u);
    profile->work = work_of(WORK_UNLIMITED);
    profile->crossing_count = 0;
    dpti_profile_find_crossings(profile);
    return dpti_stretch_windings_find(profile);
}

/* A crossing that rounding lost is noticed where faces and counts disagree: then each sample asks. */
static void a_lost_crossing_is_noticed(void)
{
    static const int32_t wanted[6] = { 0, 1, 2, 1, 2, 1 };
    static struct distance_profile profile;
    struct mesh_builder builder;
    struct holes holes;
    if (balls_and_a_sheet(&builder, 0)) {
        const struct axis axis = { .local_a = { -0.2, 0.0021, 0.0133 }, .u = { 0.3, 0.0017, 0.0009 }, .error = 1e-16 };
        dpti_holes_find(&builder.surface, &builder.kernel, &holes);
        builder.surface.holes = &holes;
        CHECK(find_windings(&builder.surface, &builder.kernel, &axis, &profile) && profile.crossing_count == 5,
              "%u crossings", profile.crossing_count);
        for (int k = 0; k < 6; k++)
            CHECK(profile.winding[k] == wanted[k], "%d: %d", k, profile.winding[k]);
        memmove(profile.crossing + 2, profile.crossing + 3, 2 * sizeof *profile.crossing);
        profile.crossing_count--;
        CHECK(!dpti_stretch_windings_find(&profile) && profile.winding[0] == WINDING_UNKNOWN, "the third one was lost");
    }
    builder_free(&builder);
}

/* By definition: the same number at each place of a range. Returns how many there are, and the most on an axis. */
static int check_ranges(const struct mesh_builder *builder, uint32_t *most)
{
    static struct distance_profile profile;
    struct surface surface = builder->surface;
    struct holes holes;
    uint64_t random = 23;
    int count = 0;
    dpti_holes_find(&surface, &builder->kernel, &holes);
    surface.holes = &holes;
    *most = 0;
    for (int i = 0; i < axes; i++) {
        double ends[6];
        any_axis(builder, &random, ends);
        const vec3 a = vec3_of(ends);
        const struct axis axis = { .local_a = a, .u = scaled(sub(vec3_of(ends + 3), a), 3.0), .error = 1e-16 };
        find_windings(&surface, &builder->kernel, &axis, &profile);
        for (uint32_t k = 0; k < profile.winding_range_count; k++) {
            const struct winding_range *range = &profile.winding_range[k];
            for (int place = 0; place < 3; place++) {
                const double s = random_in(&random, range->from, range->to);
                const double winding = brute_winding_at(builder, along(axis.local_a, s, axis.u));
                CHECK(round(winding) == range->winding, "%g at %g, %d in %g to %g", winding, s, range->winding,
                      range->from, range->to);
            }
            count++;
        }
        *most = profile.winding_range_count > *most ? profile.winding_range_count : *most;
    }
    return count;
}

/* Near a hole what is farther from it has a number. */
static void ranges_have_one_number(void)
{
    for (int kind = 0; kind < 2; kind++) {
        struct mesh_builder builder;
        const char *name = "liver";
        uint32_t most = 0;
        if (kind ? defective(&builder, 8, &name) : holed_shape(&builder, name, 4000, 4, 0.008)) {
            const int count = check_ranges(&builder, &most);
            printf("    %s: %d ranges, up to %u on an axis\n", name, count, most);
            CHECK(count > axes / 8 && most > 1 && most <= PROFILE_WINDING_RANGES, "%d, %u", count, most);
        }
        builder_free(&builder);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1)
        axes = atoi(argv[1]);
    TEST(winding_numbers_change_at_crossings_alone);
    if (getenv("DPT_DATA"))
        TEST(in_public_meshes);
    else
        SKIP("public meshes with defects", "DPT_DATA does not name the data folder");
    TEST(a_lost_crossing_is_noticed);
    TEST(ranges_have_one_number);
    return check_report();
}
