/* SPDX-License-Identifier: BSD-3-Clause */
#include "world/proxy_friction.h"

#include "world/proxy_constraints.h"
#include "world/proxy_solve.h"

/* Passes between the normal and the tangential problem. */
enum { PASSES_MAX = 6 };

/* Of the clearance: passes end where the goal moves by less. */
#define SETTLED 1e-3

/* Ticks for which a contact that holds nothing is kept: features change under a tool that is led along. */
#define AGE_MAX 2

/* Two contacts of a segment and a body are the same where they are within that share of its length, or its radius. */
#define SAME_PLACE 0.02

/* The tool's point of a constraint, in its frame. */
static vec3 place_of(const struct proxy_tick *tick, uint32_t space)
{
    return frame_to_local(&tick->at.frame, tick->sources[space].p);
}

/* m: what places on a tip are told apart by. */
static double size_of_tip(const struct tip *tip)
{
    return length(sub(tip->hull->axis_b, tip->hull->axis_a)) + 2.0 * tip->hull->reach;
}

/*
 * The contact of the same segment and body that is nearest along the axis, or NULL; *apart is how far that is, as a share
 * of its length. Of a tip: nearest to the place on it, as a share of its size.
 */
static struct proxy_contact *nearest_contact(const struct proxy_tick *tick, uint32_t space,
                                             double *apart)
{
    const struct proxy_source *source = &tick->sources[space];
    const struct proxy_triangle *triangle = &tick->triangles[source->triangle];
    const struct tip *tip = proxy_tip_of(tick, triangle);
    struct proxy_contact *best = NULL;
    *apart = HUGE_VAL;
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++) {
        struct proxy_contact *contact = &tick->proxy->contacts[i];
        if (contact->body_id != triangle->body_id || contact->segment != triangle->segment)
            continue;
        const double away = tip ? length(sub(contact->at, place_of(tick, space))) / size_of_tip(tip)
                                : fabs(contact->s - source->s);
        if (away < *apart) {
            best = contact;
            *apart = away;
        }
    }
    return best;
}

/* The contact that was here in the last solution, or NULL. */
static struct proxy_contact *find_contact(const struct proxy_tick *tick, uint32_t space)
{
    const struct proxy_triangle *triangle = &tick->triangles[tick->sources[space].triangle];
    const struct tip *tip = proxy_tip_of(tick, triangle);
    const struct segment *segment =
        tip ? NULL : &tick->world->segments[tick->tool->first_segment + triangle->segment];
    const double size = tip ? size_of_tip(tip) : length(sub(segment->b, segment->a));
    const double near = size > 0.0 ? max_of(SAME_PLACE, proxy_radius_of(tick, space) / size) : 1.0;
    double apart;
    struct proxy_contact *found = nearest_contact(tick, space, &apart);
    return found && apart <= near ? found : NULL;
}

static struct proxy_contact *find_or_make_contact(struct proxy_tick *tick, uint32_t space)
{
    struct proxy_contact *found = find_contact(tick, space);
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX && !found; i++)
        if (!tick->proxy->contacts[i].body_id) {
            const struct proxy_source *source = &tick->sources[space];
            const struct proxy_triangle *triangle = &tick->triangles[source->triangle];
            found = &tick->proxy->contacts[i];
            *found = (struct proxy_contact){ .body_id = triangle->body_id,
                                             .segment = triangle->segment,
                                             .s = source->s,
                                             .at = place_of(tick, space) };
        }
    return found;
}

/* Where the tool's surface touches, from its centre. */
static vec3 arm_of(const struct proxy_tick *tick, uint32_t space)
{
    return sub(proxy_touch_of(tick, space), tick->at.centre);
}

static void fill_contact(struct proxy_tick *tick, uint32_t space, double multiplier,
                         const struct proxy_contact *kept, const struct body *body,
                         struct friction_contact *contact)
{
    const vec3 normal = vec3_of(tick->spaces[space].normal), arm = arm_of(tick, space);
    const struct proxy_source *source = &tick->sources[space];
    const vec3 slip = kept ? sub(kept->slip, source->carried) : scaled(source->carried, -1.0);
    vec3 tangents[2];
    unit_across(normal, tangents);
    memcpy(contact->normal, tick->spaces[space].normal, sizeof contact->normal);
    contact->multiplier = multiplier;
    /* A contact that is new beside one that slips does not stick. */
    double apart;
    const struct proxy_contact *beside = nearest_contact(tick, space, &apart);
    contact->coefficient =
        beside && beside->is_slipping ? body->kinetic_friction : body->static_friction;
    for (int d = 0; d < 2; d++) {
        const vec3 turn = cross(arm, tangents[d]);
        vec3_store(tangents[d], contact->across[d]);
        for (uint32_t k = 3; k < proxy_unknowns(tick->proxy); k++)
            contact->across[d][k] = dot(turn, tick->axes[k - 3]) / proxy_rho_of(tick->proxy, k);
        contact->slip[d] = dot(slip, tangents[d]);
    }
    memset(contact->about, 0, sizeof contact->about);
    for (uint32_t k = 3; k < proxy_unknowns(tick->proxy); k++)
        contact->about[k] = dot(normal, tick->axes[k - 3]) / proxy_rho_of(tick->proxy, k);
    contact->turned = kept ? kept->turned : 0.0;
}

/*
 * A sphere that is pressed in by `depth` touches on a disc of the radius sqrt(2 r depth). Coulomb's torsion on a disc
 * under even pressure is 2/3 of its radius times the friction's force. A tool that touches at several places is held
 * against such turns by these: there is torsion only as far as one of them holds more than all others.
 */
static void set_torsion_arms(const struct proxy_tick *tick, struct friction_contact *contacts,
                             uint32_t count)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < tick->solved.active_count; k++)
        sum += tick->solved.multiplier[k];
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t space = tick->contact_spaces[i];
        const double radius = proxy_radius_of(tick, space);
        const double depth = contacts[i].multiplier;
        const double alone = sum > 0.0 ? max_of(0.0, 2.0 * depth / sum - 1.0) : 0.0;
        contacts[i].torsion_arm = alone * (2.0 / 3.0) * min_of(radius, sqrt(2.0 * radius * depth));
    }
}

/* The wanted motion, and what friction pulled with in the last tick: this tick's is about the same. */
static void begin_pulled(const struct proxy_tick *tick, const double *wanted, double *pulled)
{
    const struct proxy *proxy = tick->proxy;
    memcpy(pulled, wanted, HALF_SPACE_DIMENSIONS * sizeof *pulled);
    const vec3 shift = add(vec3_of(wanted), proxy->pull_shift);
    vec3_store(shift, pulled);
    for (uint32_t k = 3; k < proxy_unknowns(proxy); k++)
        pulled[k] += dot(proxy->pull_turn, tick->axes[k - 3]) / proxy_rho_of(proxy, k);
}

/* The contacts with friction of the present solution; those that the last one had keep their pulls. Returns how many. */
static uint32_t list_contacts(struct proxy_tick *tick, uint32_t before)
{
    const struct half_spaces_result *solved = &tick->solved;
    struct friction_contact last[HALF_SPACE_DIMENSIONS];
    uint32_t last_spaces[HALF_SPACE_DIMENSIONS], count = 0;
    memcpy(last, tick->contacts, before * sizeof *last);
    memcpy(last_spaces, tick->contact_spaces, before * sizeof *last_spaces);
    for (uint32_t k = 0; k < solved->active_count; k++) {
        const uint32_t space = solved->active[k];
        const struct body *body =
            world_find_body(tick->world, tick->triangles[tick->sources[space].triangle].body_id);
        if (!body || !(body->static_friction > 0.0))
            continue;
        struct friction_contact *contact = &tick->contacts[count];
        tick->contact_spaces[count++] = space;
        fill_contact(tick, space, solved->multiplier[k], find_contact(tick, space), body, contact);
        contact->pull[0] = contact->pull[1] = contact->torsion = 0.0;
        for (uint32_t i = 0; i < before; i++)
            if (last_spaces[i] == space) {
                memcpy(contact->pull, last[i].pull, sizeof contact->pull);
                contact->torsion = last[i].torsion;
            }
    }
    set_torsion_arms(tick, tick->contacts, count);
    return count;
}

/* How far two motions are apart in any unknown. */
static double apart(const double *a, const double *b, uint32_t n)
{
    double most = 0.0;
    for (uint32_t k = 0; k < n; k++)
        most = max_of(most, fabs(a[k] - b[k]));
    return most;
}

int dpti_proxy_solve_rubbing(struct proxy_tick *tick, const double *wanted)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    double pulled[HALF_SPACE_DIMENSIONS], next[HALF_SPACE_DIMENSIONS];
    uint32_t count = 0;
    tick->contact_count = 0;
    begin_pulled(tick, wanted, pulled);
    if (!dpti_proxy_solve(tick, pulled))
        return 0;
    for (int pass = 0; pass < PASSES_MAX; pass++) {
        count = list_contacts(tick, count);
        dpti_friction_pulls(tick->contacts, count, n, wanted, pass == 0);
        dpti_friction_goal(tick->contacts, count, n, wanted, next);
        if (apart(next, pulled, n) <= SETTLED * tick->clearance)
            break;
        memcpy(pulled, next, n * sizeof *pulled);
        if (!dpti_proxy_solve(tick, pulled))
            return 0;
    }
    tick->contact_count = count;
    return 1;
}

/* Of the clearance: how far a surface that holds the proxy may be from it. */
#define HOLDING 20.0

int dpti_proxy_solve_held(struct proxy_tick *tick, double *left)
{
    const struct proxy *proxy = tick->proxy;
    const struct displacement away = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    if (!(displacement_norm(&proxy->coupling, &away) > 0.0))
        return 0;
    if (tick->held != PROXY_HELD_UNKNOWN) {
        dpti_proxy_to_unknowns(proxy, tick->axes, &away, left);
        return tick->held == PROXY_HELD_SOLVED;
    }
    dpti_proxy_turn_axes(proxy, &tick->at, tick->axes);
    dpti_proxy_to_unknowns(proxy, tick->axes, &away, left);
    dpti_proxy_gather(tick, HOLDING * tick->clearance);
    tick->held = dpti_proxy_solve_rubbing(tick, left) ? PROXY_HELD_SOLVED : PROXY_HELD_NOT;
    return tick->held == PROXY_HELD_SOLVED;
}

/* rad: what is left to make good of a turn about the normal; a torsion at its limit has nothing. */
static double turned_after(const struct friction_contact *solved,
                           const struct proxy_contact *contact, vec3 normal, vec3 turn)
{
    const double limit = solved->coefficient * solved->multiplier * solved->torsion_arm;
    return fabs(solved->torsion) < limit ? contact->turned + dot(turn, normal) : 0.0;
}

void dpti_proxy_note_slip(struct proxy_tick *tick, vec3 shift, vec3 turn)
{
    for (uint32_t i = 0; i < tick->contact_count; i++) {
        const uint32_t space = tick->contact_spaces[i];
        struct proxy_contact *contact = find_or_make_contact(tick, space);
        if (!contact)
            continue;
        const vec3 normal = vec3_of(tick->spaces[space].normal);
        const vec3 moved = add(shift, cross(turn, arm_of(tick, space)));
        const vec3 carried = scaled(tick->sources[space].carried, tick->made);
        const vec3 slip = add(contact->slip, sub(moved, carried));
        contact->s = tick->sources[space].s;
        contact->at = place_of(tick, space);
        contact->turned = turned_after(&tick->contacts[i], contact, normal, turn);
        contact->is_slipping = (uint32_t)tick->contacts[i].is_slipping;
        contact->has_slipped |= contact->is_slipping;
        contact->slip = contact->is_slipping ? (vec3){ 0.0, 0.0, 0.0 }
                                             : along(slip, -dot(slip, normal), normal);
    }
}

/* What a contact pulls with, for the next tick. */
static void note_pull(const struct proxy_tick *tick, uint32_t i)
{
    const struct friction_contact *contact = &tick->contacts[i];
    const vec3 arm = arm_of(tick, tick->contact_spaces[i]);
    const vec3 pull = along(scaled(vec3_of(contact->across[0]), contact->pull[0]), contact->pull[1],
                            vec3_of(contact->across[1]));
    struct proxy *proxy = tick->proxy;
    proxy->pull_shift = add(proxy->pull_shift, pull);
    proxy->pull_turn =
        add(proxy->pull_turn, along(cross(arm, pull), contact->torsion, vec3_of(contact->normal)));
}

void dpti_proxy_keep_contacts(struct proxy_tick *tick)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    tick->proxy->sticking = tick->proxy->slipping = 0;
    tick->proxy->pull_shift = tick->proxy->pull_turn = none;
    for (uint32_t i = 0; i < tick->contact_count; i++)
        note_pull(tick, i);
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++)
        tick->proxy->contacts[i].age++;
    for (uint32_t i = 0; i < tick->contact_count; i++) {
        struct proxy_contact *contact = find_or_make_contact(tick, tick->contact_spaces[i]);
        if (!contact)
            continue;
        contact->age = 0;
        if (contact->has_slipped)
            tick->proxy->slipping++;
        else
            tick->proxy->sticking++;
        contact->has_slipped = 0;
    }
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++)
        if (tick->proxy->contacts[i].age > AGE_MAX)
            tick->proxy->contacts[i] = (struct proxy_contact){ .body_id = 0 };
}
