/* SPDX-License-Identifier: BSD-3-Clause */
/* Life of worlds, bodies and tools; the tick is in step.c. */
#include "world/world_state.h"

#include "base/return_if_error.h"
#include "world/contacts.h"
#include "world/tool_strips.h"

/* The sums that dpt_world_bytes documents; a struct that outgrows its share fails to compile. */
enum {
    BYTES_WORLD = 24576, /* with room for one profile */
    BYTES_BODY = 576,    /* with its box */
    BYTES_TOOL = 256,
    BYTES_SEGMENT = 1408,
    BYTES_PAUSE = 1536,
    BYTES_VOYAGE = 2048,
    BYTES_PROOF = 64,
    BYTES_MEMO = 21504, /* and for each segment BYTES_MEMO_MORE */
    BYTES_MEMO_MORE = 3072,
    BYTES_LAID = 512,
    BYTES_CONTACT = 1408 /* this tick's and the last one's */
};
typedef char world_fits[sizeof(struct dpt_world) <= BYTES_WORLD ? 1 : -1];
typedef char body_fits[sizeof(struct body) + sizeof(struct box) <= BYTES_BODY ? 1 : -1];
typedef char tool_fits[sizeof(struct tool) <= BYTES_TOOL ? 1 : -1];
typedef char segment_fits[sizeof(struct segment) <= BYTES_SEGMENT ? 1 : -1];
typedef char pause_fits[2 * sizeof(struct pause) <= BYTES_PAUSE ? 1 : -1];
typedef char voyage_fits[sizeof(struct voyage) <= BYTES_VOYAGE ? 1 : -1];
typedef char proof_fits[sizeof(struct proof) <= BYTES_PROOF ? 1 : -1];
typedef char laid_fits[sizeof(struct laid) <= BYTES_LAID ? 1 : -1];
typedef char contact_fits[2 * sizeof(struct hold) <= BYTES_CONTACT ? 1 : -1];

/* The size that the first release gave its def, and one that none will ever reach. */
enum { DEF_SIZE_FIRST = 48, DEF_SIZE_MOST = 4096 };
typedef char def_has_first_size[sizeof(dpt_world_def) >= DEF_SIZE_FIRST ? 1 : -1];

void dpt_world_def_defaults(dpt_world_def *def, size_t size)
{
    const dpt_world_def defaults = {
        .size = (uint32_t)size,
        .max_bodies = 16,
        .max_tools = 4,
        .max_segments = 16,
        .parts = 1,
        .stiffness = 500.0,
        .certificate_bytes = 1 << 20,
        .margin = 0.001,
        .max_contacts = 32,
        .strip_capacity = 1024,
        .strip_search = 16384,
    };
    if (!def || size < sizeof defaults.size || size > DEF_SIZE_MOST)
        return;
    memset(def, 0, size);
    memcpy(def, &defaults, size < sizeof defaults ? size : sizeof defaults);
}

/* Where the number of blocks still fits into 32 bits. */
static const uint64_t CERTIFICATE_BYTES_MOST = (uint64_t)1 << 40;

static int count_is_valid(uint32_t count)
{
    return count >= 1 && count <= 0xffff;
}

/*
 * A caller's def, which may be older and shorter than ours (the rest gets defaults) or newer and longer
 * (then what we do not know must be 0).
 */
static dpt_result take_def(const dpt_world_def *given, dpt_world_def *def)
{
    if (!given)
        return DPT_E_ARGUMENT;
    uint32_t size = given->size;
    if (size < DEF_SIZE_FIRST || size > DEF_SIZE_MOST)
        return DPT_E_SIZE;
    for (uint32_t i = sizeof *def; i < size; i++)
        if (((const char *)given)[i])
            return DPT_E_SIZE;
    dpt_world_def_defaults(def, sizeof *def);
    memcpy(def, given, size < sizeof *def ? size : sizeof *def);
    def->size = sizeof *def;
    return DPT_OK;
}

static dpt_strip_def strip_def(const dpt_world_def *def)
{
    return (dpt_strip_def){ .size = sizeof(dpt_strip_def),
                            .capacity = def->strip_capacity,
                            .search = def->strip == DPT_STRIP_ROUTES ? def->strip_search : 0 };
}

static int strips_are_valid(const dpt_world_def *def)
{
    const dpt_strip_def strip = strip_def(def);
    if (def->strip > DPT_STRIP_ROUTES || def->reserved)
        return 0;
    return !def->strip ||
           (dpt_strip_bytes(&strip) && def->strip_width >= 0.0 && def->strip_depth >= 0.0 &&
            within(def->strip_width, DPT_COORDINATE_MAX) &&
            within(def->strip_depth, DPT_COORDINATE_MAX));
}

static int def_is_valid(const dpt_world_def *def)
{
    return count_is_valid(def->max_bodies) && count_is_valid(def->max_tools) &&
           count_is_valid(def->max_segments) && def->method <= DPT_METHOD_PAPER &&
           def->until <= DPT_UNTIL_CONTACT && def->parts >= 1 &&
           def->parts <= (def->method == DPT_METHOD_PAPER ? 64u : 1u) && def->one_step <= 1 &&
           (def->budget == 0 || def->method == DPT_METHOD_EXACT) && def->stiffness >= 0.0 &&
           within(def->stiffness, 1e9) && def->certificate_bytes <= CERTIFICATE_BYTES_MOST &&
           def->margin >= 0.0 && within(def->margin, DPT_COORDINATE_MAX) &&
           def->side_limit >= 0.0 && within(def->side_limit, DPT_COORDINATE_MAX) &&
           def->max_contacts <= 0xffff && def->smooth_normals <= 1 && strips_are_valid(def);
}

/* What there is of each segment and body. */
static uint64_t bonds(const dpt_world_def *def)
{
    return (uint64_t)def->max_segments * def->max_bodies;
}

static uint64_t bytes_last(const dpt_world_def *def)
{
    return mesh_aligned(4 * bonds(def) * def->parts);
}

static uint64_t bytes_near(const dpt_world_def *def)
{
    return mesh_aligned(8 * bonds(def));
}

static uint64_t bytes_memo(const dpt_world_def *def)
{
    return def->budget ? BYTES_MEMO + BYTES_MEMO_MORE * (uint64_t)def->max_segments : 0;
}

static uint64_t bytes_budget(const dpt_world_def *def)
{
    const uint64_t segments = def->max_segments;
    return def->budget ? (BYTES_PAUSE + BYTES_VOYAGE) * segments + BYTES_PROOF * bonds(def) : 0;
}

static uint64_t bytes_strip(const dpt_world_def *def)
{
    const dpt_strip_def strip = strip_def(def);
    return def->strip ? BYTES_LAID + (uint64_t)dpt_strip_bytes(&strip) : 0;
}

/* Whole blocks only; what is left over of the bytes is left over. */
static uint64_t certificate_blocks(const dpt_world_def *def)
{
    return def->certificate_bytes / sizeof(struct block);
}

static size_t bytes_of(const dpt_world_def *def)
{
    if (!def_is_valid(def))
        return 0;
    uint64_t bytes = BYTES_WORLD + BYTES_BODY * (uint64_t)def->max_bodies +
                     BYTES_TOOL * (uint64_t)def->max_tools +
                     BYTES_SEGMENT * (uint64_t)def->max_segments + bytes_budget(def) +
                     bytes_memo(def) + BYTES_CONTACT * (uint64_t)def->max_contacts +
                     bytes_strip(def) * def->max_segments + bytes_last(def) + bytes_near(def) +
                     mesh_aligned(def->certificate_bytes);
    return bytes <= SIZE_MAX ? (size_t)bytes : 0;
}

size_t dpt_world_bytes(const dpt_world_def *given)
{
    dpt_world_def def;
    return take_def(given, &def) == DPT_OK ? bytes_of(&def) : 0;
}

/* The strips of all segments, behind the list of them. */
static char *place_strips(struct dpt_world *world, char *at)
{
    const dpt_strip_def def = strip_def(&world->def);
    if (!world->def.strip)
        return at;
    const size_t bytes = dpt_strip_bytes(&def);
    world->laid = (void *)at;
    at += BYTES_LAID * (size_t)world->def.max_segments;
    for (uint32_t i = 0; i < world->def.max_segments; i++, at += bytes)
        dpt_strip_create(at, bytes, &def, &world->laid[i].strip);
    strips_forget(world, 0, world->def.max_segments);
    return at;
}

dpt_result dpt_world_create(void *block, size_t bytes, const dpt_world_def *given,
                            dpt_world **world)
{
    dpt_world_def def;
    if (!block || !world)
        return DPT_E_ARGUMENT;
    DPT_TRY(take_def(given, &def));
    if (!def_is_valid(&def))
        return DPT_E_ARGUMENT;
    if ((uintptr_t)block % 8)
        return DPT_E_ALIGN;
    size_t needed = bytes_of(&def);
    if (!needed || bytes < needed)
        return DPT_E_MEMORY;

    memset(block, 0, needed);
    struct dpt_world *made = block;
    char *at = (char *)block + BYTES_WORLD;
    made->def = def;
    if (!kernel_get(def.kernel, &made->kernel, &made->kernel_id))
        return DPT_E_UNSUPPORTED;
    made->bodies = (void *)at;
    made->boxes = (void *)(made->bodies + def.max_bodies);
    at += BYTES_BODY * (size_t)def.max_bodies;
    made->tools = (void *)at;
    at += BYTES_TOOL * (size_t)def.max_tools;
    made->segments = (void *)at;
    at += BYTES_SEGMENT * (size_t)def.max_segments;
    made->pauses = (void *)at;
    made->voyages = (void *)(at + BYTES_PAUSE * (size_t)def.max_segments);
    made->proofs = (void *)(at + (BYTES_PAUSE + BYTES_VOYAGE) * (size_t)def.max_segments);
    at += bytes_budget(&def);
    made->memo.entries = (void *)at;
    made->memo.sets = (uint32_t)(bytes_memo(&def) / (MEMO_WAYS * sizeof *made->memo.entries));
    at += bytes_memo(&def);
    for (int i = 0; i < 2; i++) {
        made->holds[i].hold = (void *)at;
        at += BYTES_CONTACT / 2 * (size_t)def.max_contacts;
    }
    at = place_strips(made, at);
    made->last = (void *)at;
    at += bytes_last(&def);
    made->near = (void *)at;
    at += bytes_near(&def);
    made->certificate.blocks = (void *)at;
    made->certificate.count = (uint32_t)certificate_blocks(&def);
    *world = made;
    return DPT_OK;
}

uint32_t dpt_world_kernel(const dpt_world *world)
{
    return world ? world->kernel_id : DPT_KERNEL_AUTO;
}

/*
 * Empty the blocks of some segments, from `first` to before `end`, on one body or, with DPT_NONE, on all:
 * before a number of theirs means another.
 */
static void forget_planes(struct dpt_world *world, uint32_t first, uint32_t end, uint32_t body)
{
    const struct certificate *c = &world->certificate;
    for (uint32_t i = 0; i < c->count; i++) {
        uint32_t owner = (uint32_t)(c->blocks[i].key >> 32);
        if (!owner)
            continue;
        uint32_t segment = (owner - 1) / world->def.max_bodies;
        if (segment >= first && segment < end &&
            (body == DPT_NONE || (owner - 1) % world->def.max_bodies == body))
            c->blocks[i].key = 0;
    }
}

/* What a budget left undone, and what is proven, of a segment and, unless it is DPT_NONE, one body alone. */
static void forget_proofs(struct dpt_world *world, uint32_t segment, uint32_t body)
{
    if (!world->def.budget)
        return;
    struct proof *proof = world_proof(world, segment, body == DPT_NONE ? 0 : body);
    memset(proof, 0, (body == DPT_NONE ? world->def.max_bodies : 1) * sizeof *proof);
    for (int rests = 0; rests < 2; rests++) {
        struct pause *pause = world_pause(world, segment, rests);
        if (body == DPT_NONE || pause->body == body)
            pause->walk.at = 0;
        if (body == DPT_NONE)
            pause->next = DPT_NONE;
    }
    struct voyage *voyage = &world->voyages[segment];
    if (body == DPT_NONE)
        voyage->count = 0;
    voyage->body = 0; /* its first leg begins anew */
}

static void forget_segment(struct dpt_world *world, uint32_t segment)
{
    struct segment *s = &world->segments[segment];
    memset(world_last(world, segment, 0), 0xff, world_lasts(world) * sizeof *world->last);
    memset(&s->near, 0, sizeof s->near);
    s->was.known = 0;
    s->last_body = DPT_NONE;
    forget_proofs(world, segment, DPT_NONE);
    contacts_forget(world, segment, segment + 1, DPT_NONE);
    strips_forget(world, segment, segment + 1);
}

void tool_clear_hits(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++)
        world->segments[tool->first + i].hit = (dpt_hit){
            .size = sizeof(dpt_hit), .status = DPT_STATUS_STALE, .triangle = DPT_NONE, .segment = i
        };
    tool->nearest = 0;
}

void tool_clear(struct dpt_world *world, struct tool *tool)
{
    tool_clear_hits(world, tool);
    for (uint32_t i = 0; i < tool->count; i++) {
        struct segment *segment = &world->segments[tool->first + i];
        memset(&segment->wrench, 0, sizeof segment->wrench);
        memset(&segment->push, 0, sizeof segment->push);
        segment->passed = 0;
        segment->sweep =
            (dpt_sweep){ .size = sizeof segment->sweep, .triangle = DPT_NONE, .segment = i };
        if (world->def.strip)
            strip_clear(world->laid[tool->first + i].strip, NULL);
    }
    memset(&tool->wrench, 0, sizeof tool->wrench);
}

static void forget_tool(struct dpt_world *world, struct tool *tool)
{
    for (uint32_t i = 0; i < tool->count; i++)
        forget_segment(world, tool->first + i);
    tool_clear(world, tool);
}

dpt_result dpt_world_reset(dpt_world *world)
{
    if (!world)
        return DPT_E_ARGUMENT;
    for (uint32_t t = 0; t < world->tool_end; t++)
        if (world->tools[t].slot.used)
            forget_tool(world, &world->tools[t]);
    forget_planes(world, 0, world->segment_count, DPT_NONE);
    memo_forget(&world->memo, DPT_NONE);
    for (uint32_t i = 0; i < world->body_end; i++)
        world->bodies[i].moved = world->bodies[i].added = 0;
    world->turn = 0;
    world->ticks = 0;
    return DPT_OK;
}

/* Body ids. */

static struct body *find_body(const struct dpt_world *world, dpt_body body)
{
    uint32_t index = handle_index(body);
    if (index >= world->body_end || !handle_fits(body, HANDLE_BODY, &world->bodies[index].slot))
        return NULL;
    return &world->bodies[index];
}

dpt_result dpt_body_add(dpt_world *world, const dpt_mesh *mesh, const dpt_pose *pose,
                        dpt_body *body)
{
    struct frame frame;
    if (!world || !mesh || !body)
        return DPT_E_ARGUMENT;
    DPT_TRY(frame_of_pose(pose, &frame));
    uint32_t index = 0;
    while (index < world->body_end && !slot_is_free(&world->bodies[index].slot))
        index++;
    if (index == world->def.max_bodies)
        return DPT_E_FULL;
    struct body *made = &world->bodies[index];
    if (index == world->body_end) {
        world->body_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    made->id = handle_make(HANDLE_BODY, &made->slot, index);
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->frame = frame;
    made->pose = pose ? *pose : identity;
    made->moved = 0;
    made->added = world->ticks + 1;
    made->valid = 1;
    surface_of_mesh(mesh, &made->surface);
    for (uint32_t s = 0; s < world->segment_count; s++)
        memset(world_last(world, s, index), 0xff, world->def.parts * sizeof *world->last);
    forget_planes(world, 0, world->segment_count, index);
    bodies_place(world, index);
    *body = made->id;
    return DPT_OK;
}

dpt_result dpt_body_remove(dpt_world *world, dpt_body body)
{
    struct body *old = world ? find_body(world, body) : NULL;
    if (!old)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    slot_release(&old->slot);
    world->invalid -= !old->valid;
    contacts_forget(world, 0, world->segment_count, handle_index(body));
    memo_forget(&world->memo, handle_index(body));
    strips_forget_body(world, handle_index(body));
    for (uint32_t s = 0; s < world->segment_count; s++) {
        forget_proofs(world, s, handle_index(body));
        if (world->segments[s].last_body == handle_index(body))
            world->segments[s].last_body = DPT_NONE;
    }
    return DPT_OK;
}

/*
 * At most so far has any point of it moved: with the origin, and by the angle around that, which is 4 asin(c / 2), c
 * being how far the quaternions are apart.
 */
static double way_of(const struct body *body)
{
    const double *from = body->before.orientation, *to = body->pose.orientation;
    vec3 low = body->surface.box_min, high = body->surface.box_max;
    double farthest = 0.5 * (length(add(low, high)) + length(sub(high, low)));
    double same = 0.0, opposite = 0.0;
    for (int k = 0; k < 4; k++) {
        same += (to[k] - from[k]) * (to[k] - from[k]);
        opposite += (to[k] + from[k]) * (to[k] + from[k]);
    }
    double square = smaller(same, opposite);
    /* Quaternions may be off unit length by 1e-6. */
    double angle = sqrt(square) * (2.0 + 0.3 * square) + 1e-5;
    return length(sub(vec3_of(body->pose.position), vec3_of(body->before.position))) +
           angle * farthest;
}

/* Where the body was in the last tick stays known until the next one. */
static void move_body(struct dpt_world *world, struct body *body, const dpt_pose *pose,
                      const struct frame *frame)
{
    if (body->moved != world->ticks + 1)
        body->before = body->pose;
    body->moved = world->ticks + 1;
    body->pose = *pose;
    body->frame = *frame;
    body->travelled = way_of(body);
    if (world->travelled_at != body->moved)
        world->travelled = 0.0;
    world->travelled_at = body->moved;
    world->travelled = larger(world->travelled, body->travelled);
    bodies_place(world, handle_index(body->id));
}

dpt_result dpt_body_set_pose(dpt_world *world, dpt_body body, const dpt_pose *pose)
{
    struct body *moved = world ? find_body(world, body) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    struct frame frame = moved->frame;
    dpt_result result = pose ? frame_of_pose(pose, &frame) : DPT_E_ARGUMENT;
    world->invalid -= !moved->valid;
    moved->valid = result == DPT_OK;
    world->invalid += !moved->valid;
    if (moved->valid && !pose_is_same(&moved->pose, pose))
        move_body(world, moved, pose, &frame);
    return result;
}

/* Tool ids. */

struct tool *world_tool(const struct dpt_world *world, dpt_tool tool)
{
    uint32_t index = handle_index(tool);
    if (index >= world->tool_end || !handle_fits(tool, HANDLE_TOOL, &world->tools[index].slot))
        return NULL;
    return &world->tools[index];
}

static dpt_result check_segments(const dpt_segment *segments, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if (!vec3_within(segments[i].a, DPT_COORDINATE_MAX) ||
            !vec3_within(segments[i].b, DPT_COORDINATE_MAX) ||
            !(segments[i].radius >= 0.0 && segments[i].radius <= DPT_COORDINATE_MAX))
            return DPT_E_FINITE;
    return DPT_OK;
}

static void put_segments(struct dpt_world *world, const struct tool *tool,
                         const dpt_segment *segments)
{
    uint32_t index = (uint32_t)(tool - world->tools);
    for (uint32_t i = 0; i < tool->count; i++) {
        struct segment *to = &world->segments[tool->first + i];
        to->a = vec3_of(segments[i].a);
        to->b = vec3_of(segments[i].b);
        to->radius = segments[i].radius;
        to->tool = index;
    }
}

dpt_result dpt_tool_add(dpt_world *world, const dpt_segment *segments, uint32_t count,
                        dpt_tool *tool)
{
    if (!world || !segments || !tool || count == 0)
        return DPT_E_ARGUMENT;
    DPT_TRY(check_segments(segments, count));
    uint32_t index = 0;
    while (index < world->tool_end && !slot_is_free(&world->tools[index].slot))
        index++;
    if (index == world->def.max_tools || count > world->def.max_segments - world->segment_count)
        return DPT_E_FULL;
    struct tool *made = &world->tools[index];
    if (index == world->tool_end) {
        world->tool_end++;
        made->slot.generation = 1;
    }
    made->slot.used = 1;
    const dpt_pose identity = DPT_POSE_IDENTITY;
    made->frame = frame_identity;
    made->pose = identity;
    made->valid = 1;
    made->free = 0;
    made->first = world->segment_count;
    made->count = count;
    world->segment_count += count;
    put_segments(world, made, segments);
    forget_tool(world, made);
    *tool = handle_make(HANDLE_TOOL, &made->slot, index);
    return DPT_OK;
}

/* The segments of all tools lie close together: those behind the removed ones move up. */
dpt_result dpt_tool_remove(dpt_world *world, dpt_tool tool)
{
    struct tool *old = world ? world_tool(world, tool) : NULL;
    if (!old)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    uint32_t behind = old->first + old->count;
    forget_planes(world, old->first, world->segment_count, DPT_NONE);
    size_t moved = world->segment_count - behind, bodies = world->def.max_bodies;
    memmove(&world->segments[old->first], &world->segments[behind],
            moved * sizeof *world->segments);
    memmove(world_last(world, old->first, 0), world_last(world, behind, 0),
            moved * world_lasts(world) * sizeof *world->last);
    memmove(world_near(world, old->first, 0), world_near(world, behind, 0),
            moved * 2 * bodies * sizeof *world->near);
    if (world->def.budget) {
        memmove(world_pause(world, old->first, 0), world_pause(world, behind, 0),
                moved * 2 * sizeof *world->pauses);
        memmove(&world->voyages[old->first], &world->voyages[behind],
                moved * sizeof *world->voyages);
        memmove(world_proof(world, old->first, 0), world_proof(world, behind, 0),
                moved * bodies * sizeof *world->proofs);
    }
    contacts_remove(world, old->first, behind);
    strips_remove(world, old->first, behind, (uint32_t)moved);
    world->turn = 0;
    for (uint32_t t = 0; t < world->tool_end; t++)
        if (world->tools[t].slot.used && world->tools[t].first >= behind)
            world->tools[t].first -= old->count;
    world->segment_count -= old->count;
    slot_release(&old->slot);
    return DPT_OK;
}

dpt_result dpt_tool_set_pose(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    struct tool *moved = world ? world_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    dpt_result result = pose ? frame_of_pose(pose, &moved->frame) : DPT_E_ARGUMENT;
    moved->valid = result == DPT_OK;
    if (moved->valid)
        moved->pose = *pose;
    moved->free = 0;
    return result;
}

dpt_result dpt_tool_teleport(dpt_world *world, dpt_tool tool, const dpt_pose *pose)
{
    dpt_result result = dpt_tool_set_pose(world, tool, pose);
    if (result == DPT_OK)
        forget_tool(world, world_tool(world, tool));
    return result;
}

dpt_result dpt_tool_set_segments(dpt_world *world, dpt_tool tool, const dpt_segment *segments,
                                 uint32_t count)
{
    struct tool *moved = world ? world_tool(world, tool) : NULL;
    if (!moved)
        return world ? DPT_E_HANDLE : DPT_E_ARGUMENT;
    dpt_result result =
        segments && count == moved->count ? check_segments(segments, count) : DPT_E_ARGUMENT;
    moved->valid = result == DPT_OK;
    if (result != DPT_OK)
        return result;
    moved->free = 1;
    moved->frame = frame_identity;
    put_segments(world, moved, segments);
    return DPT_OK;
}
