/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How much of what is under a tool strips hold: of the triangles within the margin, and of those that the shadow meets.
 *
 * Real meshes from DPT_DATA.
 */
#include "strip/strip_coverage.h"

static const char *data;

/* Of tools that lie on a closed mesh; over vertices, where the walk goes over edges. */
static void recall_on(const struct subject *subject)
{
    static const double lengths[] = { 0.05, 0.1, 0.2, 0.5 };
    struct coverage sum = { .poses = 0 };
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        struct coverage r;
        coverage_of(subject, lengths[i], 12, i, &r);
        CHECK(r.poses == 12, "%s: %zu poses", subject->name, r.poses);
        sum.near += r.near;
        for (int kind = 0; kind < COVERAGE_STRIPS; kind++) {
            sum.found[kind] += r.found[kind];
            sum.sheet[kind] += r.sheet[kind];
            sum.in_strip[kind] += r.in_strip[kind];
        }
    }
    double found[COVERAGE_STRIPS];
    for (int kind = 0; kind < COVERAGE_STRIPS; kind++)
        found[kind] = 100 * share_of(sum.found[kind], sum.near);
    printf("    %-28s near: routes %.1f %%, shadow %.1f %%, widened by the margin %.1f %%; of the sheet "
           "%.2f, %.2f %%\n",
           subject->name, found[COVERAGE_ROUTES], found[COVERAGE_NARROW], found[COVERAGE_WIDE],
           100 * share_of(sum.in_strip[COVERAGE_NARROW], sum.sheet[COVERAGE_NARROW]),
           100 * share_of(sum.in_strip[COVERAGE_WIDE], sum.sheet[COVERAGE_WIDE]));
    for (int kind = COVERAGE_NARROW; kind < COVERAGE_STRIPS; kind++)
        CHECK(share_of(sum.in_strip[kind], sum.sheet[kind]) >= 0.99, "%s, %d: %zu of %zu", subject->name, kind,
              sum.in_strip[kind], sum.sheet[kind]);
    CHECK(found[COVERAGE_ROUTES] < found[COVERAGE_NARROW] && found[COVERAGE_WIDE] >= 95, "%s: %g, %g, %g",
          subject->name, found[COVERAGE_ROUTES], found[COVERAGE_NARROW], found[COVERAGE_WIDE]);
}

static void what_strips_hold(void)
{
    static const char *const organs[] = { "openhelp_liver.stl",    "openhelp_stomach.stl",
                                          "openhelp_spleen.stl",   "openhelp_kidney_left.stl",
                                          "openhelp_duodenum.stl", "openhelp_abdominal_wall.stl",
                                          "gallbladder_fine.stl",  "liver_sks.ply" };
    struct subject subject;
    if (subject_from_shape(&subject, "torus", 5568))
        recall_on(&subject);
    subject_close(&subject);
    if (subject_from_shape(&subject, "liver", 50332))
        recall_on(&subject);
    subject_close(&subject);
    for (size_t i = 0; data && i < sizeof organs / sizeof *organs; i++) {
        if (subject_from_file(&subject, data, "organs", organs[i]))
            recall_on(&subject);
        subject_close(&subject);
    }
}

int main(void)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    data = getenv("DPT_DATA");
    TEST(what_strips_hold);
    if (!data)
        SKIP("strips on organs", "DPT_DATA does not name the data folder");
    return check_report();
}
