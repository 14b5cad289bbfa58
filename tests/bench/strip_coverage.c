/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * How much of what is under a tool a strip holds, as CSV: the paper's strip of routes, and shadows as wide as the tool and
 * as the margin, by mesh and by the tool's length (strip_recall.h).
 *
 *     recall [POSES = 50]    a mesh and length; organs from DPT_DATA, where that is
 */
#include "strip/strip_coverage.h"

/* Closed, and wound one way. */
static const char *const organs[] = {
    "openhelp_liver.stl",    "openhelp_stomach.stl",  "openhelp_spleen.stl",         "openhelp_kidney_left.stl",
    "openhelp_duodenum.stl", "openhelp_pancreas.stl", "openhelp_abdominal_wall.stl", "gallbladder_fine.stl",
    "aneurysm_sofa.off",     "liver_sks.ply",         "liver_smooth_sofa.obj",       "hepatic_veins_sks.obj",
    "pelvis_sofa.obj",
};
static const struct {
    const char *name;
    uint64_t count;
} shapes[] = { { "torus", 5568 }, { "torus", 61358 }, { "liver", 50332 } };

static void measure(const struct subject *subject, size_t poses)
{
    static const double lengths[] = { 0.05, 0.1, 0.2, 0.5 };
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        struct coverage r;
        coverage_of(subject, lengths[i], poses, 1 + i, &r);
        const double n = (double)(r.poses ? r.poses : 1);
        printf("%s,%u,%g,%zu,%.1f", subject->name, subject->info.triangles, 100 * lengths[i], r.poses,
               (double)r.near / n);
        for (int kind = 0; kind < COVERAGE_STRIPS; kind++)
            printf(",%.1f", (double)r.size[kind] / n);
        for (int kind = 0; kind < COVERAGE_STRIPS; kind++)
            printf(",%.2f", 100 * share_of(r.found[kind], r.near));
        for (int kind = COVERAGE_NARROW; kind < COVERAGE_STRIPS; kind++)
            printf(",%.2f", 100 * share_of(r.in_strip[kind], r.sheet[kind]));
        printf("\n");
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    const char *data = getenv("DPT_DATA");
    const size_t poses = argc > 1 ? strtoul(argv[1], NULL, 10) : 50;
    struct subject subject;
    if (poses < 1 || poses > 100000) {
        fprintf(stderr, "recall: from 1 to 100000 poses\n");
        return 2;
    }
    printf("mesh,triangles,length,poses,near,routes,narrow,wide,routes_found,narrow_found,"
           "wide_found,narrow_walked,wide_walked\n");
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (subject_from_shape(&subject, shapes[i].name, shapes[i].count))
            measure(&subject, poses);
        subject_close(&subject);
    }
    for (size_t i = 0; data && i < sizeof organs / sizeof *organs; i++) {
        if (subject_from_file(&subject, data, "organs", organs[i]))
            measure(&subject, poses);
        subject_close(&subject);
    }
    return check_bad ? 1 : 0;
}
