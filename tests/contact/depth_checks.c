/* SPDX-License-Identifier: BSD-3-Clause */
#include "contact/depth_checks.h"

double ends_before[6];

const char *answer_text(const struct solid *solid, const char *by, const double ends[6], double radius,
                        const dpt_hit *hit)
{
    static char text[512];
    const int so_far =
        snprintf(text, sizeof text, "%s, %s: %a %a %a  %a %a %a, radius %g: distance %.9g gap %.9g", solid->name, by,
                 ends[0], ends[1], ends[2], ends[3], ends[4], ends[5], radius, hit->distance, hit->gap);
    const double *e = ends_before;
    if (strcmp(by, "query") != 0)
        snprintf(text + so_far, sizeof text - (size_t)so_far, ", after %a %a %a  %a %a %a", e[0], e[1], e[2], e[3],
                 e[4], e[5]);
    return text;
}

void check_form(const char *text, const dpt_hit *hit)
{
    CHECK(isfinite(hit->gap + hit->depth), "%s", text);
    CHECK(hit->status == DPT_STATUS_EXACT && (hit->flags & DPT_HIT_FLAG_GAP), "flags %u: %s", hit->flags, text);
    CHECK(hit->depth == fmax(0, -hit->gap), "depth %.9g: %s", hit->depth, text);
    CHECK(hit->contact == (hit->gap > hit->error_bound    ? DPT_CONTACT_SEPARATED
                           : hit->gap < -hit->error_bound ? DPT_CONTACT_PENETRATING
                                                          : DPT_CONTACT_TOUCHING),
          "contact %u: %s", hit->contact, text);
}

double check_way_out(const struct solid *solid, const struct rig *rig, double margin, const double ends[6],
                     double radius, const dpt_hit *hit)
{
    dpt_contact contacts[RIG_CONTACTS], *found = NULL;
    const uint32_t count = rig_contacts(rig, contacts);
    const char *text = answer_text(solid, "way out", ends, radius, hit);
    const double bound = 1e-5 * solid->diagonal;
    for (uint32_t i = 0; i < count; i++) {
        CHECK(contacts[i].gap >= hit->gap - bound, "a region has a gap of %.9g: %s", contacts[i].gap, text);
        if (fabs(contacts[i].gap - hit->gap) <= bound && (!found || contacts[i].gap < found->gap))
            found = &contacts[i];
    }
    if (hit->gap > margin - bound)
        return 0;
    CHECK(found, "%u regions, none with the gap: %s", count, text);
    if (!found)
        return 0;
    double out[6], p[3];
    point_at(ends, found->s, p);
    CHECK(apart(p, found->p) <= 1e-12 * solid->oracle.extent, "p is off by %g: %s", apart(p, found->p), text);
    CHECK(fabs(oracle_signed(&solid->oracle, p) - (found->gap + radius)) <= bound, "%.9g at p, gap %.9g: %s",
          oracle_signed(&solid->oracle, p), found->gap, text);
    if (dot3(found->normal, found->normal) == 0) {
        CHECK(fabs(hit->gap + radius) <= hit->error_bound, "no way out: %s", text);
        return 0;
    }
    for (int k = 0; k < 3; k++)
        out[k] = out[3 + k] = p[k] - (hit->gap + radius) * found->normal[k];
    const double off = oracle_brute(solid->brute, out, NULL);
    CHECK(off <= bound, "lands %g off: %s", off, text);
    return off;
}

void ends_about(uint64_t *seed, double size, uint64_t i, double ends[6])
{
    for (int k = 0; k < 6; k++)
        ends[k] = size * (i % 5 == 1 ? random_in(seed, -0.5, 0.5) : random_in(seed, -1.5, 1.5));
    if (i % 5 == 2)
        memcpy(ends + 3, ends, 3 * sizeof *ends);
    if (i % 5 == 3)
        for (int k = 0; k < 3; k++)
            ends[3 + k] = -ends[k];
}

int box_of(struct solid *solid, const double half[3])
{
    double vertices[24];
    static const uint32_t corners[36] = { 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            vertices[3 * i + k] = i >> k & 1 ? half[k] : -half[k];
    return solid_from_arrays(solid, "box", vertices, 8, corners, 12);
}

int depth_rig_open(struct rig *rig, const dpt_mesh *mesh, double margin, uint32_t max_contacts)
{
    dpt_world_def def = rig_def(DPT_LAW_POINT);
    def.margin = margin;
    def.max_contacts = max_contacts;
    return rig_open(rig, &def, mesh, &rig_point, 1);
}
