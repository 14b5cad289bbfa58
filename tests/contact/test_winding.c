/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How often parts go round a point: against sums over all triangles, near the surface and far from it, and a series
 * against its own bound.
 *
 * With DPT_DATA in the environment also on public meshes, with which of their parts have an inside.
 */
#include "lib/mesh_builder.h"

#include "base/angle.h"
#include "compile/cluster.h"

/* `points` within the box and as many near the surface, on all kernels; returns the largest error. */
static double check_against_brute(const char *name, const struct mesh_builder *builder, int points)
{
    static const double shares[] = { 1e-2, -1e-3, 1e-4, -1e-6, 1e-9 };
    uint64_t random = 41;
    uint32_t chosen, most_work = 0;
    double worst = 0.0;
    for (int i = 0; i < 2 * points; i++) {
        uint32_t place = (uint32_t)(random_bits(&random) % builder->info.triangles);
        struct work work = work_of(WORK_UNLIMITED);
        vec3 x = i % 2 ? point_in_box(builder, &random) : point_off(builder, place, shares[i / 2 % 5]);
        double winding = dpti_winding_number(&builder->surface, &builder->kernel, x, &work);
        double error = fabs(winding - brute_winding_at(builder, x));
        CHECK(error <= WINDING_ERROR, "%s: off by %g at %g %g %g", name, error, x.x, x.y, x.z);
        worst = max_of(worst, error);
        most_work = work.done > most_work ? work.done : most_work;
        for (uint32_t id = DPT_KERNEL_SCALAR; id <= DPT_KERNEL_WASM128; id++) {
            struct kernel other;
            struct work again = work_of(WORK_UNLIMITED);
            if (!dpti_kernel_get(id, &other, &chosen))
                continue;
            double same = dpti_winding_number(&builder->surface, &other, x, &again);
            CHECK(!memcmp(&same, &winding, sizeof same) && again.done == work.done, "%s: %s says %g, not %g", name,
                  dpt_kernel_name(id), same, winding);
        }
    }
    printf("    %-12s %7u triangles: off by at most %.1e, work at most %u\n", name, builder->info.triangles, worst,
           most_work);
    CHECK(most_work < 2 * (builder->info.triangles / LANES) + 40, "%s: work %u", name, most_work);
    return worst;
}

static void windings_agree_with_brute_force(void)
{
    static const struct {
        const char *name;
        uint32_t count;
    } shapes[] = { { "sphere", 300 }, { "torus", 5568 },   { "liver", 20000 },
                   { "star", 8000 },  { "stomach", 4000 }, { "sphere", 100000 } };
    double worst = 0.0;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct mesh_builder builder = { .vertices = NULL };
        builder_add_shape(&builder, shapes[i].name, shapes[i].count, (vec3){ 0.3, -0.2, 0.1 }, 1.0, 0, 1);
        if (builder_compile(&builder)) {
            CHECK(builder.info.winding_components == 1, "%s has no moments", shapes[i].name);
            worst = max_of(worst, check_against_brute(shapes[i].name, &builder, (int)part_of(200)));
        }
        builder_free(&builder);
    }
    CHECK(worst < 1e-3, "the bound is proven, but this is a tenth of what it was: %g", worst);
}

/* Four sets of four triangles, joined twice, about `middle`; their true sum as seen from x. */
static struct winding_moment make_set(uint64_t *random, vec3 middle, double size, vec3 x, double *truth)
{
    struct winding_moment sets[4], triangles[4];
    vec3 c[3];
    *truth = 0.0;
    for (int s = 0; s < 4; s++) {
        const vec3 part = { random_in(random, -size, size), random_in(random, -size, size),
                            random_in(random, -size, size) };
        for (int t = 0; t < 4; t++) {
            for (int k = 0; k < 3; k++)
                c[k] = add(add(middle, part), (vec3){ random_in(random, -size, size), random_in(random, -size, size),
                                                      random_in(random, -size, size) });
            triangles[t] = moment_of_triangle(c[0], c[1], c[2]);
            *truth += solid_turns(sub(c[0], x), sub(c[1], x), sub(c[2], x));
        }
        sets[s] = moment_of_sets(triangles, 4);
    }
    return moment_of_sets(sets, 4);
}

/* What is left of a series is within its bound, in double and in float, from near the set to far away. */
static void series_keep_their_bound(void)
{
    uint64_t random = 61;
    struct kernel kernel;
    uint32_t chosen;
    double worst = 0.0;
    dpti_kernel_get(DPT_KERNEL_AUTO, &kernel, &chosen);
    for (int i = 0; i < 2000; i++) {
        float block[MESH_MOMENT_ROWS * LANES], sums[LANES] = { 0.0f }, doubts[LANES] = { 0.0f };
        double truth[LANES], errors[LANES];
        const float at[3] = { (float)random_in(&random, -1, 1), (float)random_in(&random, -1, 1),
                              (float)random_in(&random, -1, 1) };
        const vec3 x = { at[0], at[1], at[2] };
        const double size = pow(10.0, random_in(&random, -2.5, -0.5));
        for (int lane = 0; lane < LANES; lane++) {
            const vec3 middle = { random_in(&random, -1, 1), random_in(&random, -1, 1), random_in(&random, -1, 1) };
            struct winding_moment set = make_set(&random, middle, size, x, &truth[lane]);
            double series = moment_winding(&set, x, &errors[lane]);
            moment_store(&set, block + lane);
            if (errors[lane] < HUGE_VAL) {
                CHECK(fabs(series - truth[lane]) <= errors[lane] + 1e-15, "off by %g, bound %g", series - truth[lane],
                      errors[lane]);
                worst = max_of(worst, fabs(series - truth[lane]) / errors[lane]);
            }
        }
        const uint32_t open = kernel.moments(block, at, 1e-2f, sums, doubts);
        for (int lane = 0; lane < LANES; lane++) {
            const int closed = !(open >> lane & 1);
            CHECK(closed ? fabs(errors[lane] - (double)doubts[lane]) <= 1e-4 * errors[lane]
                         : sums[lane] == 0.0f && !(errors[lane] < 0.999e-2),
                  "lane %d: bound %g, %g in float", lane, errors[lane], (double)doubts[lane]);
            CHECK(!closed || fabs((double)sums[lane] - truth[lane]) <= errors[lane] + 1e-6, "lane %d: %g, not %g", lane,
                  (double)sums[lane], truth[lane]);
        }
    }
    printf("    off by at most %.2f of the bound\n", worst);
}

/* Beside a surface, nearer than float tells, it is still known which side is which. */
static void check_sides(uint64_t triangles)
{
    static const double shares[] = { 1e-3, 1e-5, 1e-7, 1e-9, 1e-11 };
    struct mesh_builder builder = { .vertices = NULL };
    uint64_t random = 59;
    int bad = 0, asked = 0;
    builder_add_shape(&builder, "sphere", triangles, (vec3){ 0.2, 0.3, -0.1 }, 1.0, 0, 1);
    if (builder_compile(&builder)) {
        const uint32_t gone = mesh_words(builder.mesh, MESH_PLACES)[0]; /* beside the hole */
        for (int i = 0; i < (int)part_of(1000); i++) {
            const double share = shares[i % 5];
            uint32_t place = (uint32_t)(random_bits(&random) % builder.info.triangles);
            if (place / 64 == gone / 64)
                continue;
            vec3 in = point_off(&builder, place, -share), out = point_off(&builder, place, share);
            double step = winding_at(&builder, in.x, in.y, in.z) - winding_at(&builder, out.x, out.y, out.z);
            asked++;
            bad += !(fabs(step - 1.0) < 0.1);
            /* By a vertex, and by an edge. */
            const uint32_t *corner = builder.surface.corners + 3 * (size_t)place;
            const float *p = builder.surface.positions + 3 * (size_t)corner[0];
            const float *q = builder.surface.positions + 3 * (size_t)corner[i % 2];
            const vec3 on = scaled(add(vec3_of_float(p), vec3_of_float(q)), 0.5);
            const vec3 way = { random_in(&random, -1, 1), random_in(&random, -1, 1), random_in(&random, -1, 1) };
            in = along(on, -share, way);
            out = along(on, share, way);
            asked++;
            bad += !(fabs(winding_at(&builder, in.x, in.y, in.z) - brute_winding_at(&builder, in)) < 0.001 &&
                     fabs(winding_at(&builder, out.x, out.y, out.z) - brute_winding_at(&builder, out)) < 0.001);
        }
        CHECK(bad == 0 && asked > (int)part_of(1000), "%d of %d", bad, asked);
        const float *v = builder.surface.positions;
        double on = winding_at(&builder, v[0], v[1], v[2]);
        CHECK(on > -0.1 && on < 1.1, "at a vertex %g", on);
        vec3 face = point_off(&builder, 77, 0.0);
        on = winding_at(&builder, face.x, face.y, face.z);
        CHECK(on > -0.1 && on < 1.1, "in a face %g", on);
        const double odd[] = { NAN, INFINITY, -INFINITY, 1e300, -1e30, 1e9 };
        for (size_t k = 0; k < 6; k++)
            for (int axis = 0; axis < 3; axis++) {
                double x[3] = { 0.0, 0.0, 0.0 };
                x[axis] = odd[k];
                CHECK(winding_at(&builder, x[0], x[1], x[2]) == 0.0, "%g on axis %d", odd[k], axis);
            }
    }
    builder_free(&builder);
}

static void sides_are_known_near_the_surface(void)
{
    check_sides(2000);
    check_sides(20000);
}

struct expected {
    const char *path;
    uint32_t solid, cavities, winding, buried;
};

/* As looked at one by one; docs/algorithms/winding.md. */
static void public_meshes_are_what_they_seem(void)
{
    static const struct expected meshes[] = {
        { "organs/openhelp_liver.stl", 1, 0, 0, 0 },
        { "organs/liver_metres.stl", 1, 0, 1, 0 },
        { "organs/vessel_open_ends.stl", 1, 0, 1, 0 },
        { "organs/liver_intraop_patch.stl", 0, 0, 0, 0 },
        { "organs/skin_wound_oss.ply", 0, 0, 0, 0 },
        { "organs/tooth_chai3d.obj", 2, 0, 0, 1 },
        /* A crumb of six triangles within cuts itself. */
        { "organs/liver_dirty_fine.stl", 2, 0, 2, 0 },
        { "organs/skull_and_teeth_sofa.obj", 34, 0, 34, 0 },
        { "sheets_tori/square_cloth_2594.obj", 0, 0, 0, 0 },
        { "sheets_tori/gauze.obj", 1, 0, 0, 0 },
        { "tools/dissection_electrode.stl", 2, 0, 2, 0 },
        { "hard/bunny_dirty.ply", 1, 0, 1, 0 },
        { "hard/sphere_with_hole_ascii.stl", 1, 0, 1, 0 },
        { "hard/cray_left.obj", 2, 1, 0, 0 },
        { "hard/soup.stl", 0, 0, 0, 0 },
    };
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
        char path[1024];
        const struct expected *wanted = &meshes[i];
        struct mesh_builder builder;
        snprintf(path, sizeof path, "%s/meshes/%s", getenv("DPT_DATA"), wanted->path);
        if (!builder_compile_file(&builder, path))
            continue;
        const dpt_mesh_info *info = &builder.info;
        CHECK(info->solid_components == wanted->solid && info->cavities == wanted->cavities &&
                  info->winding_components == wanted->winding && info->buried_components == wanted->buried,
              "%s: %u solid, %u cavities, %u by winding, %u buried", wanted->path, info->solid_components,
              info->cavities, info->winding_components, info->buried_components);
        if (info->winding_components)
            check_against_brute(strrchr(wanted->path, '/') + 1, &builder, 60);
        builder_free(&builder);
    }
}

int main(int argc, char **argv)
{
    take_percent(argc, argv);
    TEST(windings_agree_with_brute_force);
    TEST(series_keep_their_bound);
    TEST(sides_are_known_near_the_surface);
    if (getenv("DPT_DATA"))
        TEST(public_meshes_are_what_they_seem);
    else
        SKIP("what public meshes seem", "DPT_DATA is not set");
    return check_report();
}
