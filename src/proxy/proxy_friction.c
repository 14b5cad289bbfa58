/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_friction.h"

#include "proxy/proxy_constraints.h"

/* As a share of the clearance: by how much a constraint may be missed. */
#define TOLERANCE 1e-6

/* As a share of the clearance: the gap that is left between walls that leave no room for more. */
#define GAP_SPARED 0.5

/*
 * How many times longer than the bounds that it makes good a motion may become. Between walls that are almost parallel
 * it would otherwise go meters along them.
 */
#define LENGTHENED_MAX 100.0

/* Without bounds above 0 a motion is at most twice as long as the wanted one. */
static int is_short(const struct proxy_tick *tick, const struct half_spaces_result *solved, const double *wanted)
{
    const uint32_t n = proxy_unknowns(tick->proxy);
    double max_bound = 0.0;
    for (uint32_t i = 0; i < tick->space_count; i++)
        max_bound = max_of(max_bound, tick->spaces[i].bound);
    return norm_of(solved->y, n) <= 2.0 * norm_of(wanted, n) + LENGTHENED_MAX * max_bound;
}

static struct half_space_problem problem_of(const struct proxy_tick *tick, const double *wanted)
{
    return (struct half_space_problem){
        tick->spaces,        tick->space_count,        proxy_unknowns(tick->proxy), wanted, TOLERANCE * tick->clearance,
        tick->solved.active, tick->solved.active_count
    };
}

static int nearest(struct proxy_tick *tick, const double *wanted)
{
    const struct half_space_problem problem = problem_of(tick, wanted);
    return dpti_half_spaces_nearest(&problem, &tick->solved);
}

/*
 * The motion nearest to the wanted one that the constraints allow, into tick->solved. Where none meets them all: one
 * that makes nothing worse; where there is none either: one that leaves half of the clearance. 0: not even that.
 */
static int solve(struct proxy_tick *tick, const double *wanted)
{
    double spare[HALF_SPACES_MAX];
    if (nearest(tick, wanted) && is_short(tick, &tick->solved, wanted))
        return 1;
    for (uint32_t i = 0; i < tick->space_count; i++) {
        struct half_space *space = &tick->spaces[i];
        const double pushed = dot(vec3_of(space->normal), tick->sources[i].carried);
        spare[i] = max_of(0.0, (1.0 - GAP_SPARED) * tick->clearance - (space->bound - pushed));
        space->bound = min_of(space->bound, pushed);
    }
    if (nearest(tick, wanted))
        return 1;
    /* Between walls that are almost parallel, rounding alone decides whether there is a motion. */
    for (uint32_t i = 0; i < tick->space_count; i++)
        tick->spaces[i].bound -= spare[i];
    return nearest(tick, wanted);
}

/* Passes between the normal and the tangential problem. */
enum { PASSES_MAX = 4 };

/*
 * After so many of them the mean normals of places stay where they are: they have moved by less and less, and would so in
 * each pass.
 */
enum { FIXED_AFTER = 2 };

/* As a share of the clearance: passes end when the goal moves by less. */
#define SETTLED 1e-2
/* The same as a share of a long motion: what it is off is made good by the next one. */
#define SETTLED_FAR 1e-3

/* For how many ticks a contact that holds nothing is kept, as features change under a tool that slides. */
#define AGE_MAX 2

/* Contacts at the same place whose normals have a larger cosine are one. */
#define ALIKE 0.9

/*
 * Two contacts of a segment and a body are the same if they are within this share of its length, or within its radius.
 */
#define SAME_PLACE 0.02

/* Where the tool's surface touches, in its frame. */
static vec3 place_of(const struct proxy_tick *tick, uint32_t space)
{
    return frame_to_local(&tick->at.frame, proxy_touch_of(tick, space));
}

/* m: the length to which distances between places on a tip are compared. */
static double size_of_tip(const struct tip *tip)
{
    return length(sub(tip->hull->axis_b, tip->hull->axis_a)) + 2.0 * tip->hull->reach;
}

/*
 * The contact of the same segment and body that is nearest along the axis, or NULL; *apart is how far that is, as a
 * share of its length. Of a tip: nearest to the place on it, as a share of its size.
 */
static struct proxy_contact *nearest_contact(const struct proxy_tick *tick, uint32_t space, double *apart)
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
        const double away =
            tip ? length(sub(contact->at, place_of(tick, space))) / size_of_tip(tip) : fabs(contact->s - source->s);
        if (away < *apart) {
            best = contact;
            *apart = away;
        }
    }
    return best;
}

/* How far two contacts of a segment, or a tip, may be apart, as a share of it, to be the same. */
static double near_share(const struct proxy_tick *tick, const struct proxy_triangle *triangle)
{
    const struct tip *tip = proxy_tip_of(tick, triangle);
    const struct segment *segment = tip ? NULL : &tick->world->segments[tick->tool->first_segment + triangle->segment];
    const double size = tip ? size_of_tip(tip) : length(sub(segment->b, segment->a));
    const double radius = part_radius(tool_part(tick->world, tick->tool, triangle->segment));
    return size > 0.0 ? max_of(SAME_PLACE, radius / size) : 1.0;
}

/* The contact that was here in the last solution, or NULL. */
static struct proxy_contact *find_contact(const struct proxy_tick *tick, uint32_t space)
{
    const struct proxy_triangle *triangle = &tick->triangles[tick->sources[space].triangle];
    double apart;
    struct proxy_contact *found = nearest_contact(tick, space, &apart);
    return found && apart <= near_share(tick, triangle) ? found : NULL;
}

/* How far the places of two constraints of one segment, or tip, are apart, as a share of it. */
static double apart_of(const struct proxy_tick *tick, uint32_t one, uint32_t other)
{
    const struct proxy_source *a = &tick->sources[one], *b = &tick->sources[other];
    const struct tip *tip = proxy_tip_of(tick, &tick->triangles[a->triangle]);
    return tip ? length(sub(a->p, b->p)) / size_of_tip(tip) : fabs(a->s - b->s);
}

/* Whether two constraints hold the tool at one place, as where flat triangles meet under its tip. */
static int are_at_one_place(const struct proxy_tick *tick, uint32_t one, uint32_t other)
{
    const struct proxy_source *a = &tick->sources[one], *b = &tick->sources[other];
    const struct proxy_triangle *first = &tick->triangles[a->triangle];
    const struct proxy_triangle *second = &tick->triangles[b->triangle];
    return first->segment == second->segment && first->body_id == second->body_id &&
           apart_of(tick, one, other) <= near_share(tick, first) &&
           dot(vec3_of(tick->spaces[one].normal), vec3_of(tick->spaces[other].normal)) > ALIKE;
}

static struct proxy_contact *find_or_make_contact(struct proxy_tick *tick, uint32_t space)
{
    struct proxy_contact *found = find_contact(tick, space);
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX && !found; i++)
        if (!tick->proxy->contacts[i].body_id) {
            const struct proxy_source *source = &tick->sources[space];
            const struct proxy_triangle *triangle = &tick->triangles[source->triangle];
            found = &tick->proxy->contacts[i];
            *found = (struct proxy_contact){
                .s = source->s, .at = place_of(tick, space), .body_id = triangle->body_id, .segment = triangle->segment
            };
        }
    return found;
}

/* Where the tool's surface touches, from its centre. */
static vec3 arm_of(const struct proxy_tick *tick, uint32_t space)
{
    return sub(proxy_touch_of(tick, space), tick->at.centre);
}

/* Which way a place's contacts push the tool, each as much as it holds. */
static vec3 normal_of_place(const struct proxy_tick *tick, uint32_t count, uint32_t place)
{
    const vec3 first = vec3_of(tick->spaces[tick->contact_spaces[place]].normal);
    vec3 sum = scaled(first, tick->contacts[place].share);
    uint32_t others = 0;
    for (uint32_t i = place + 1; i < count; i++)
        if (tick->contacts[i].place == place) {
            sum = along(sum, tick->contacts[i].share, vec3_of(tick->spaces[tick->contact_spaces[i]].normal));
            others++;
        }
    return others ? unit_of(sum) : first;
}

static void fill_contact(struct proxy_tick *tick, uint32_t space, vec3 place_normal, const struct proxy_contact *kept,
                         const struct body *body, struct friction_contact *contact)
{
    const vec3 normal = vec3_of(tick->spaces[space].normal), arm = arm_of(tick, space);
    const struct proxy_source *source = &tick->sources[space];
    const vec3 slip = kept ? sub(kept->slip, source->carried) : scaled(source->carried, -1.0);
    vec3 tangents[2];
    unit_across(place_normal, tangents);
    memcpy(contact->normal, tick->spaces[space].normal, sizeof contact->normal);
    /* A contact that is new beside one that slips does not stick. */
    double apart;
    const struct proxy_contact *beside = nearest_contact(tick, space, &apart);
    contact->coefficient = beside && beside->is_slipping ? body->kinetic_friction : body->static_friction;
    for (int d = 0; d < 2; d++) {
        const vec3 turn = cross(arm, tangents[d]);
        memset(contact->across[d], 0, sizeof contact->across[d]);
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
static void set_torsion_arms(const struct proxy_tick *tick, struct friction_contact *contacts, uint32_t count)
{
    double sum = 0.0, depths[HALF_SPACE_DIMENSIONS] = { 0.0 }; /* of each place */
    for (uint32_t k = 0; k < tick->solved.active_count; k++)
        sum += tick->solved.multiplier[k];
    for (uint32_t i = 0; i < count; i++)
        depths[contacts[i].place] += contacts[i].multiplier;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t space = tick->contact_spaces[i];
        const double radius = proxy_radius_of(tick, space);
        const double depth = depths[contacts[i].place];
        const double alone = sum > 0.0 ? max_of(0.0, 2.0 * depth / sum - 1.0) : 0.0;
        contacts[i].torsion_arm = alone * (2.0 / 3.0) * min_of(radius, sqrt(2.0 * radius * depth));
    }
}

/* The wanted motion, and what friction pulled with in the last motion that was solved for: it is about the same. */
static void begin_pulled(const struct proxy_tick *tick, const double *wanted, double *pulled)
{
    const struct proxy *proxy = tick->proxy;
    memcpy(pulled, wanted, HALF_SPACE_DIMENSIONS * sizeof *pulled);
    const vec3 shift = add(vec3_of(wanted), proxy->pull_shift);
    vec3_store(shift, pulled);
    for (uint32_t k = 3; k < proxy_unknowns(proxy); k++)
        pulled[k] += dot(proxy->pull_turn, tick->axes[k - 3]) / proxy_rho_of(proxy, k);
}

static const struct body *rough_body(const struct proxy_tick *tick, uint32_t space)
{
    const struct body *body = world_find_body(tick->world, tick->triangles[tick->sources[space].triangle].body_id);
    return body && body->static_friction > 0.0 && !tick->is_led ? body : NULL;
}

static void share_places(struct friction_contact *contacts, uint32_t count)
{
    double wholes[HALF_SPACE_DIMENSIONS] = { 0.0 };
    for (uint32_t i = 0; i < count; i++)
        wholes[contacts[i].place] += contacts[i].multiplier;
    for (uint32_t i = 0; i < count; i++) {
        const double whole = wholes[contacts[i].place];
        contacts[i].share = whole > 0.0 ? contacts[i].multiplier / whole : contacts[i].place == i;
    }
}

/* Which constraints of the present solution have friction, and which of them are one contact. Returns how many. */
static uint32_t list_places(struct proxy_tick *tick)
{
    const struct half_spaces_result *solved = &tick->solved;
    uint32_t count = 0;
    for (uint32_t k = 0; k < solved->active_count; k++) {
        const uint32_t space = solved->active[k];
        if (!rough_body(tick, space))
            continue;
        uint32_t place = 0;
        while (place < count &&
               (tick->contacts[place].place != place || !are_at_one_place(tick, tick->contact_spaces[place], space)))
            place++;
        tick->contacts[count].place = place;
        tick->contacts[count].multiplier = solved->multiplier[k];
        tick->contact_spaces[count++] = space;
    }
    share_places(tick->contacts, count);
    return count;
}

/* Contacts that were listed. */
struct contact_list {
    struct friction_contact contact[HALF_SPACE_DIMENSIONS];
    uint32_t space[HALF_SPACE_DIMENSIONS];
    uint32_t count;
};

/* The number of a constraint's contact; `count` if there is none. */
static uint32_t number_of(const struct contact_list *list, uint32_t space)
{
    uint32_t i = 0;
    while (i < list->count && list->space[i] != space)
        i++;
    return i;
}

static uint32_t members_of(const struct friction_contact *contacts, uint32_t count, uint32_t place)
{
    uint32_t members = 0;
    for (uint32_t i = 0; i < count; i++)
        members += contacts[i].place == place;
    return members;
}

/* Whether a place has the same contacts as it had; *members is how many they are. */
static int is_same_place(const struct proxy_tick *tick, uint32_t count, uint32_t place, const struct contact_list *last,
                         uint32_t *members)
{
    const uint32_t first = number_of(last, tick->contact_spaces[place]);
    *members = members_of(tick->contacts, count, place);
    if (first == last->count || members_of(last->contact, last->count, last->contact[first].place) != *members)
        return 0;
    for (uint32_t i = place; i < count; i++) {
        const uint32_t was = number_of(last, tick->contact_spaces[i]);
        if (tick->contacts[i].place == place &&
            (was == last->count || last->contact[was].place != last->contact[first].place))
            return 0;
    }
    return 1;
}

/*
 * The contacts with friction of the present solution; those that the last one had keep their pulls. The mean normal of a
 * place follows what its contacts hold, or stays where it is if is_fixed. Returns how many.
 */
static uint32_t list_contacts(struct proxy_tick *tick, uint32_t before, int is_fixed)
{
    struct contact_list last;
    last.count = before;
    memcpy(last.contact, tick->contacts, before * sizeof *last.contact);
    memcpy(last.space, tick->contact_spaces, before * sizeof *last.space);
    const uint32_t count = list_places(tick);
    set_torsion_arms(tick, tick->contacts, count);
    for (uint32_t k = 0; k < count; k++) {
        struct friction_contact *contact = &tick->contacts[k];
        const struct friction_contact now = *contact;
        const uint32_t space = tick->contact_spaces[k], was = number_of(&last, space);
        uint32_t members;
        if (is_same_place(tick, count, now.place, &last, &members) && (members == 1 || is_fixed)) {
            *contact = last.contact[was];
            contact->place = now.place;
            contact->multiplier = now.multiplier;
            contact->share = now.share;
            if (!is_fixed)
                contact->torsion_arm = now.torsion_arm;
            continue;
        }
        fill_contact(tick, space, normal_of_place(tick, count, now.place),
                     find_contact(tick, tick->contact_spaces[now.place]), rough_body(tick, space), contact);
        contact->pull[0] = contact->pull[1] = contact->torsion = 0.0;
        if (was < last.count) {
            memcpy(contact->pull, last.contact[was].pull, sizeof contact->pull);
            contact->torsion = last.contact[was].torsion;
        }
    }
    return count;
}

/* What a contact pulls with, for the next motion. */
static void note_pull(const struct proxy_tick *tick, uint32_t i)
{
    const struct friction_contact *contact = &tick->contacts[i];
    const vec3 arm = arm_of(tick, tick->contact_spaces[i]);
    const vec3 pull =
        along(scaled(vec3_of(contact->across[0]), contact->pull[0]), contact->pull[1], vec3_of(contact->across[1]));
    struct proxy *proxy = tick->proxy;
    proxy->pull_shift = add(proxy->pull_shift, pull);
    proxy->pull_turn = add(proxy->pull_turn, along(cross(arm, pull), contact->torsion, vec3_of(contact->normal)));
}

static void note_pulls(const struct proxy_tick *tick)
{
    const vec3 none = { 0.0, 0.0, 0.0 };
    tick->proxy->pull_shift = tick->proxy->pull_turn = none;
    for (uint32_t i = 0; i < tick->contact_count; i++)
        note_pull(tick, i);
}

int dpti_proxy_solve_rubbing(struct proxy_tick *tick, const double *wanted)
{
    double pulled[HALF_SPACE_DIMENSIONS];
    uint32_t count = tick->is_begun ? tick->contact_count : 0;
    const int is_begun = count > 0;
    begin_pulled(tick, wanted, pulled);
    if (!is_begun)
        tick->solved.active_count = 0;
    tick->contact_count = 0;
    tick->is_begun = 0;
    if (!solve(tick, pulled))
        return 0;
    for (int pass = 0; pass < PASSES_MAX; pass++) {
        count = list_contacts(tick, count, pass >= FIXED_AFTER);
        const struct friction_problem problem = { .contacts = tick->contacts,
                                                  .contact_spaces = tick->contact_spaces,
                                                  .count = count,
                                                  .spaces = tick->spaces,
                                                  .solved = &tick->solved,
                                                  .goal = wanted,
                                                  .dimensions = proxy_unknowns(tick->proxy),
                                                  .space_count = tick->space_count,
                                                  .tolerance = TOLERANCE * tick->clearance,
                                                  .is_fixed = pass >= FIXED_AFTER };
        const double settled =
            max_of(SETTLED * tick->clearance, SETTLED_FAR * norm_of(tick->solved.y, problem.dimensions));
        if (dpti_friction_pass(&problem, pass == 0 && !is_begun, settled, pulled))
            break;
        if (!solve(tick, pulled))
            return 0;
    }
    tick->contact_count = count;
    tick->is_begun = 1;
    note_pulls(tick);
    return 1;
}

/* As a multiple of the clearance: how far from the proxy a surface that holds it may be. */
#define HOLDING 20.0

int dpti_proxy_solve_held(struct proxy_tick *tick, double *left)
{
    const struct proxy *proxy = tick->proxy;
    const struct displacement displacement = dpti_proxy_displacement(proxy, &tick->at, &tick->goal);
    const struct displacement away = dpti_proxy_pulled(&displacement);
    if (tick->is_led || !(displacement_norm(&proxy->coupling, &away) > 0.0))
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

/* As a share of the limit: a larger torsion counts as being at it, as the shares of a place are rounded. */
#define TURNING (1.0 - 1e-9)

/* rad: the turn about the normal that torsion still holds. At its limit it slips, and nothing is left. */
static double turned_after(const struct friction_contact *solved, const struct proxy_contact *contact, vec3 normal,
                           vec3 turn)
{
    const double limit = solved->coefficient * solved->multiplier * solved->torsion_arm;
    return fabs(solved->torsion) < TURNING * limit ? contact->turned + dot(turn, normal) : 0.0;
}

/* How far a place slipped where the tool moved by that: the mean of its contacts by what they hold. */
static vec3 slip_of_place(const struct proxy_tick *tick, uint32_t place, vec3 shift, vec3 turn)
{
    vec3 sum = { 0.0, 0.0, 0.0 };
    for (uint32_t i = place; i < tick->contact_count; i++) {
        const uint32_t space = tick->contact_spaces[i];
        const vec3 moved = add(shift, cross(turn, arm_of(tick, space)));
        const vec3 carried = scaled(tick->sources[space].carried, tick->made);
        if (tick->contacts[i].place == place)
            sum = along(sum, tick->contacts[i].share, sub(moved, carried));
    }
    return sum;
}

/* What is kept of a place, by its first contact; NULL for the others, and where there is no room. */
static struct proxy_contact *kept_of_place(struct proxy_tick *tick, uint32_t i)
{
    return tick->contacts[i].place == i ? find_or_make_contact(tick, tick->contact_spaces[i]) : NULL;
}

void dpti_proxy_note_slip(struct proxy_tick *tick, vec3 shift, vec3 turn)
{
    for (uint32_t i = 0; i < tick->contact_count; i++) {
        struct proxy_contact *contact = kept_of_place(tick, i);
        if (!contact)
            continue;
        const vec3 normal = normal_of_place(tick, tick->contact_count, i);
        const vec3 slip = add(contact->slip, slip_of_place(tick, i, shift, turn));
        contact->s = tick->sources[tick->contact_spaces[i]].s;
        contact->at = place_of(tick, tick->contact_spaces[i]);
        contact->turned = turned_after(&tick->contacts[i], contact, normal, turn);
        contact->is_slipping = (uint32_t)tick->contacts[i].is_slipping;
        contact->has_slipped |= contact->is_slipping;
        contact->slip = contact->is_slipping ? (vec3){ 0.0, 0.0, 0.0 } : along(slip, -dot(slip, normal), normal);
    }
}

/* The axis' point at a contact, in the tool's frame; a tip's radius is not known here: the contact itself. */
static vec3 middle_of_contact(const struct proxy_tick *tick, const struct proxy_contact *contact)
{
    if (contact->segment >= tick->tool->segment_count)
        return contact->at;
    const struct segment *segment = &tick->world->segments[tick->tool->first_segment + contact->segment];
    return along(segment->a, contact->s, sub(segment->b, segment->a));
}

/* A contact's body may have moved from `before`; the tool went from `from` to `to`. */
static void note_carried(const struct proxy_tick *tick, const struct frame *before, const struct frame *now,
                         const struct frame *from, const struct frame *to, struct proxy_contact *contact)
{
    const vec3 p = frame_to_world(from, contact->at);
    const vec3 lever = frame_turn(to, sub(middle_of_contact(tick, contact), contact->at));
    const vec3 body_moved = sub(frame_to_world(now, frame_to_local(before, p)), p);
    contact->slip = add(contact->slip, sub(sub(frame_to_world(to, contact->at), p), body_moved));
    if (!(dot(lever, lever) > 0.0))
        return;
    vec3 tangents[2];
    const vec3 normal = unit_of(lever);
    unit_across(normal, tangents);
    const vec3 with_body = frame_turn(now, frame_turn_back(before, tangents[0]));
    const vec3 with_tool = frame_turn(to, frame_turn_back(from, tangents[0]));
    contact->turned += dot(normal, cross(with_body, with_tool));
}

void dpti_proxy_note_carried(struct proxy_tick *tick, const struct proxy_pose *to, const struct body *body)
{
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++) {
        struct proxy_contact *contact = &tick->proxy->contacts[i];
        const struct body *other = contact->body_id ? world_find_body(tick->world, contact->body_id) : NULL;
        if (!other || other == body)
            continue;
        const dpt_pose pose = dpti_proxy_body_pose(tick, other);
        struct frame before;
        frame_of_pose(&pose, &before);
        note_carried(tick, &before, &other->frame, &tick->at.frame, &to->frame, contact);
        tick->is_dragged = 1;
    }
}

void dpti_proxy_keep_contacts(struct proxy_tick *tick)
{
    tick->proxy->sticking = tick->proxy->slipping = 0;
    if (!tick->contact_count)
        note_pulls(tick);
    for (uint32_t i = 0; i < PROXY_CONTACTS_MAX; i++)
        tick->proxy->contacts[i].age += tick->proxy->contacts[i].body_id != 0;
    for (uint32_t i = 0; i < tick->contact_count; i++) {
        struct proxy_contact *contact = kept_of_place(tick, i);
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
