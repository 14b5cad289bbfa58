/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/return_if_error.h"
#include "base/sized.h"
#include "exchange/snapshot_format.h"
#include "proxy/proxy.h"
#include "proxy/proxy_pose.h"
#include "track/tool_parts.h"
#include "world/deform_body.h"
#include "world/tool_results.h"

enum { SNAPSHOT_CONTACTS_MAX = 1 << 20, SNAPSHOT_STRIP_MAX = 1 << 20, SNAPSHOT_VERTICES_MAX = 1 << 28 };

/* The place of each section of a snapshot, and how much of it is written. */
struct taking {
    const struct dpt_world *world;
    unsigned char *to;
    uint32_t count[SNAPSHOT_KINDS_END]; /* room */
    uint32_t done[SNAPSHOT_KINDS_END];
    uint64_t offset[SNAPSHOT_KINDS_END];
    uint64_t bytes;
    uint32_t flags;
};

void dpt_snapshot_def_defaults(dpt_snapshot_def *def, size_t size)
{
    const dpt_snapshot_def defaults = { .max_contacts = 256, .max_strip = 1024 };
    sized_defaults(def, size, &defaults, sizeof defaults);
}

static dpt_result read_def(const dpt_snapshot_def *given, dpt_snapshot_def *def)
{
    dpt_snapshot_def_init(def);
    if (given)
        DPT_TRY(sized_read(given, sizeof *def, def, sizeof *def));
    return def->max_contacts <= SNAPSHOT_CONTACTS_MAX && def->max_strip <= SNAPSHOT_STRIP_MAX &&
                   def->max_vertices <= SNAPSHOT_VERTICES_MAX
               ? DPT_OK
               : DPT_E_LIMIT;
}

static int is_seen(const struct persistent_contact *item)
{
    return !item->is_unseen;
}

static uint32_t strip_count(const struct dpt_world *world, uint32_t segment_index)
{
    return world->def.strip ? world->segment_strips[segment_index].strip->count : 0;
}

/* Count what there is, at most as much as the def has room for. */
static void count_sections(struct taking *taking, const dpt_snapshot_def *def)
{
    const struct dpt_world *world = taking->world;
    const struct persistent_contacts *contacts = &world->contacts[world->contacts_index];
    uint64_t strip = 0, vertices = 0;
    uint32_t *count = taking->count, seen = 0, edges = 0;
    for (uint32_t i = 0; i < contacts->count; i++)
        seen += (uint32_t)is_seen(&contacts->items[i]);
    for (uint32_t i = 0; i < world->segment_count; i++)
        strip += strip_count(world, i);
    for (uint32_t i = 0; i < world->tip_count; i++) {
        edges += world->tips[i].hull->edge_count;
        seen += world->tips[i].contact.id != 0;
    }
    for (uint32_t i = 0; i < world->body_slot_end; i++) {
        const struct body *body = &world->bodies[i];
        const uint32_t own = body->slot.used && deform_of(body) ? body->surface.mesh->vertices : 0;
        if (vertices + own <= def->max_vertices)
            vertices += own;
        else if (def->max_vertices)
            taking->flags |= DPT_SNAPSHOT_FLAG_VERTICES_CUT;
    }
    count[SNAPSHOT_BODIES] = world->body_count;
    count[SNAPSHOT_TOOLS] = world->tool_count;
    count[SNAPSHOT_SEGMENTS] = world->segment_count + edges;
    count[SNAPSHOT_CONTACTS] = seen < def->max_contacts ? seen : def->max_contacts;
    count[SNAPSHOT_STRIPS] = strip < def->max_strip ? (uint32_t)strip : def->max_strip;
    count[SNAPSHOT_VERTICES] = (uint32_t)vertices;
    for (uint32_t i = 0; world->channels && i < world->def.max_channels; i++)
        count[SNAPSHOT_CHANNELS] += world->channels[i].body_id != 0;
    if (count[SNAPSHOT_CONTACTS] < seen && def->max_contacts)
        taking->flags |= DPT_SNAPSHOT_FLAG_CONTACTS_CUT;
    if (count[SNAPSHOT_STRIPS] < strip && def->max_strip)
        taking->flags |= DPT_SNAPSHOT_FLAG_STRIPS_CUT;
}

/* Without room for channels a snapshot is as it was before there were any. */
static uint32_t kinds_end(const struct taking *taking)
{
    return taking->world->channels ? SNAPSHOT_KINDS_END : SNAPSHOT_CHANNELS;
}

static void place_sections(struct taking *taking)
{
    uint64_t at = SNAPSHOT_HEADER_BYTES + (uint64_t)(kinds_end(taking) - 1) * SNAPSHOT_ENTRY_BYTES;
    for (uint32_t kind = 1; kind < kinds_end(taking); kind++) {
        taking->offset[kind] = at;
        at += ((uint64_t)taking->count[kind] * snapshot_stride[kind] + 7) / 8 * 8;
    }
    taking->bytes = at;
}

/* The place of the next item of a kind; NULL: there is no room for it. */
static unsigned char *next_place(struct taking *taking, enum snapshot_kind kind)
{
    const uint32_t i = taking->done[kind];
    if (i == taking->count[kind])
        return NULL;
    taking->done[kind]++;
    return taking->to + taking->offset[kind] + (uint64_t)i * snapshot_stride[kind];
}

static void put(struct taking *taking, enum snapshot_kind kind, const void *item)
{
    unsigned char *to = next_place(taking, kind);
    if (to)
        dpti_snapshot_put_item(kind, item, to);
}

/* In this tick, or after it. */
static int is_held(const struct dpt_world *world, const struct body *body)
{
    return body->held_tick && world_coming_tick(world) - body->held_tick <= 1;
}

static void put_body(struct taking *taking, const struct body *body)
{
    const uint32_t own = deform_of(body) ? body->surface.mesh->vertices : 0;
    const uint32_t first = taking->done[SNAPSHOT_VERTICES];
    const int is_in = own && own <= taking->count[SNAPSHOT_VERTICES] - first;
    const dpt_snapshot_body item = { .id = body->id,
                                     .flags =
                                         (own ? (uint32_t)DPT_SNAPSHOT_BODY_FLAG_DEFORMS : 0) |
                                         (body->slot.valid ? 0 : (uint32_t)DPT_SNAPSHOT_BODY_FLAG_STALE) |
                                         (is_held(taking->world, body) ? (uint32_t)DPT_SNAPSHOT_BODY_FLAG_HELD : 0),
                                     .first_vertex = is_in ? first : DPT_NONE,
                                     .vertices = own,
                                     .user = body->user,
                                     .pose = body->pose };
    put(taking, SNAPSHOT_BODIES, &item);
    if (!is_in)
        return;
    unsigned char *to = next_place(taking, SNAPSHOT_VERTICES);
    dpti_snapshot_put_vertices(body->surface.positions, own, to);
    taking->done[SNAPSHOT_VERTICES] = first + own;
}

/* An axis of the tool's frame, where the device has it, and where the proxy has it. */
static void put_axes(const struct dpt_world *world, const struct tool *tool, vec3 a, vec3 b, double radius,
                     dpt_snapshot_segment *item)
{
    const int has_proxy = dpti_proxy_is_used(world, tool);
    const struct proxy *proxy = has_proxy ? proxy_of(world, tool) : NULL;
    struct frame frame = tool_device_frame(tool);
    vec3_store(frame_to_world(&frame, a), item->a);
    vec3_store(frame_to_world(&frame, b), item->b);
    item->radius = radius;
    if (has_proxy && tool->is_free) {
        const dpt_segment given = dpti_proxy_given_segment(world, tool);
        memcpy(item->a, given.a, sizeof item->a);
        memcpy(item->b, given.b, sizeof item->b);
        item->radius = given.radius;
    }
    memcpy(item->proxy_a, item->a, sizeof item->a);
    memcpy(item->proxy_b, item->b, sizeof item->b);
    if (!has_proxy || proxy->state == PROXY_NONE)
        return;
    frame_of_pose(&proxy->pose, &frame);
    vec3_store(frame_to_world(&frame, a), item->proxy_a);
    vec3_store(frame_to_world(&frame, b), item->proxy_b);
}

static void put_segment(struct taking *taking, const struct tool *tool, vec3 a, vec3 b, double radius,
                        const dpt_hit *hit)
{
    dpt_snapshot_segment item = { .status = hit->status,
                                  .contact = hit->contact,
                                  .flags = hit->flags,
                                  .triangle = hit->triangle,
                                  .body = hit->body,
                                  .work = hit->work,
                                  .tool = taking->done[SNAPSHOT_TOOLS],
                                  .distance = hit->distance,
                                  .gap = hit->gap,
                                  .depth = hit->depth,
                                  .error_bound = hit->error_bound,
                                  .lower_bound = hit->lower_bound };
    memcpy(item.p, hit->p, sizeof item.p);
    memcpy(item.q, hit->q, sizeof item.q);
    put_axes(taking->world, tool, a, b, radius, &item);
    put(taking, SNAPSHOT_SEGMENTS, &item);
}

static void put_contact(struct taking *taking, const dpt_contact *contact, uint32_t segment)
{
    dpt_snapshot_contact item = { .id = contact->id,
                                  .body = contact->body,
                                  .segment = segment,
                                  .triangle = contact->triangle,
                                  .contact = contact->contact,
                                  .flags = contact->flags,
                                  .tool = taking->done[SNAPSHOT_TOOLS],
                                  .s0 = contact->s0,
                                  .s1 = contact->s1,
                                  .s = contact->s,
                                  .gap = contact->gap,
                                  .overlap = contact->overlap };
    memcpy(item.p, contact->p, sizeof item.p);
    memcpy(item.q, contact->q, sizeof item.q);
    memcpy(item.normal, contact->normal, sizeof item.normal);
    put(taking, SNAPSHOT_CONTACTS, &item);
}

static void put_contacts(struct taking *taking, uint32_t index)
{
    const struct dpt_world *world = taking->world;
    const struct persistent_contacts *contacts = &world->contacts[world->contacts_index];
    for (uint32_t i = 0; i < contacts->count; i++) {
        if (contacts->items[i].segment_index == index && is_seen(&contacts->items[i]))
            put_contact(taking, &contacts->items[i].contact, contacts->items[i].contact.segment);
    }
}

static void put_strip(struct taking *taking, uint32_t index, uint32_t number)
{
    const struct dpt_world *world = taking->world;
    const uint32_t count = strip_count(world, index);
    if (!count)
        return;
    const struct segment_strip *strip = &world->segment_strips[index];
    const struct surface surface = surface_view(&strip->surface, world_coming_tick(world), 0.0);
    const uint32_t *places = mesh_words(strip->strip->mesh, MESH_PLACES);
    const struct strip_tool tool = { strip->a, strip->u, strip->radius, strip->side };
    const uint32_t body = strip->body_slot < world->body_slot_end ? world->bodies[strip->body_slot].id : 0;
    for (uint32_t i = 0; i < count; i++) {
        dpt_overlap overlap;
        unsigned char *to = next_place(taking, SNAPSHOT_STRIPS);
        if (!to)
            return;
        dpti_strip_overlap(&surface, &strip->frame, &tool, places[strip->strip->triangles[i]], &overlap);
        const dpt_snapshot_strip item = { .triangle = overlap.triangle,
                                          .body = body,
                                          .segment = number,
                                          .flags = overlap.flags,
                                          .gap = overlap.gap,
                                          .overlap = overlap.overlap };
        dpti_snapshot_put_item(SNAPSHOT_STRIPS, &item, to);
    }
}

/* The channels that a tool has made. */
static void put_channels(struct taking *taking, const struct tool *tool, uint32_t id)
{
    const struct dpt_world *world = taking->world;
    for (uint32_t i = 0; world->channels && i < world->def.max_channels; i++) {
        if (!world->channels[i].body_id || world->channels[i].tool_id != id)
            continue;
        const dpt_channel channel = dpti_tool_channel(world, tool, &world->channels[i]);
        dpt_snapshot_channel item = { .id = channel.id,
                                      .body = channel.body,
                                      .triangle = channel.triangle,
                                      .flags = channel.flags,
                                      .ruptures = channel.ruptures,
                                      .layers = channel.layers,
                                      .tool = taking->done[SNAPSHOT_TOOLS],
                                      .radius = world->channels[i].radius,
                                      .depth = channel.depth,
                                      .deepest = channel.deepest,
                                      .inside = channel.inside,
                                      .friction = channel.friction,
                                      .tip = channel.tip };
        memcpy(item.entry, channel.entry, sizeof item.entry);
        memcpy(item.axis, channel.axis, sizeof item.axis);
        put(taking, SNAPSHOT_CHANNELS, &item);
    }
}

/* The edges of a tool's tips, as further segments with the tip's hit; what names a tip names its first edge. */
static void put_tips(struct taking *taking, const struct tool *tool, dpt_snapshot_tool *item)
{
    for (uint32_t i = 0; i < tool->tip_count; i++) {
        const struct tip *tip = tool_tip(taking->world, tool, i);
        const struct dpt_hull *hull = tip->hull;
        if (tool->nearest_segment == tool->segment_count + i)
            item->nearest_segment = item->segments;
        if (tip->contact.id)
            put_contact(taking, &tip->contact, item->segments);
        for (uint32_t e = 0; e < hull->edge_count; e++)
            put_segment(taking, tool, hull->corner[hull->edge[e][0]], hull->corner[hull->edge[e][1]], hull->radius,
                        &tip->hit);
        item->segments += hull->edge_count;
    }
}

static void put_tool(struct taking *taking, const struct tool *tool)
{
    const struct dpt_world *world = taking->world;
    const int has_proxy = dpti_proxy_is_used(world, tool);
    const struct proxy *proxy = &world->proxies[has_proxy ? tool - world->tools : 0];
    const dpt_pose identity = DPT_POSE_IDENTITY;
    dpt_snapshot_tool item = { .id = handle_make(HANDLE_TOOL, &tool->slot, (uint32_t)(tool - world->tools)),
                               .law = tool->law,
                               .reason = tool->force_reason,
                               .flags = tool->force_flags,
                               .first_segment = taking->done[SNAPSHOT_SEGMENTS],
                               .segments = tool->segment_count,
                               .first_contact = taking->done[SNAPSHOT_CONTACTS],
                               .first_strip = taking->done[SNAPSHOT_STRIPS],
                               .nearest_segment = tool->nearest_segment,
                               .is_free = tool->is_free,
                               .user = tool->user,
                               .pose = tool->is_free ? identity : tool->pose,
                               .wrench = tool->wrench,
                               .energy = tool->energy,
                               .body_work = tool->body_work };
    item.proxy = has_proxy && proxy->state != PROXY_NONE ? dpti_proxy_told_pose(proxy) : tool->pose;
    dpt_tool_get_end(world, item.id, &item.end);
    if (has_proxy) {
        item.lag = proxy->lag;
        item.folds = proxy->folds;
    }
    for (uint32_t i = 0; i < tool->segment_count; i++) {
        const struct segment *segment = &world->segments[tool->first_segment + i];
        put_segment(taking, tool, segment->a, segment->b, segment->radius, &segment->hit);
        put_contacts(taking, tool->first_segment + i);
        put_strip(taking, tool->first_segment + i, i);
    }
    put_tips(taking, tool, &item);
    put_channels(taking, tool, item.id);
    item.contacts = taking->done[SNAPSHOT_CONTACTS] - item.first_contact;
    item.strip = taking->done[SNAPSHOT_STRIPS] - item.first_strip;
    put(taking, SNAPSHOT_TOOLS, &item);
}

static void put_header(struct taking *taking)
{
    const struct dpt_world *world = taking->world;
    unsigned char *to = taking->to;
    uint64_t time;
    memcpy(&time, &world->time, sizeof time);
    memset(to, 0, (size_t)taking->offset[1]);
    dpti_snapshot_put_magic(to);
    snapshot_put4(to + SNAPSHOT_AT_HEADER_BYTES, SNAPSHOT_HEADER_BYTES);
    snapshot_put8(to + SNAPSHOT_AT_BYTES, taking->bytes);
    snapshot_put8(to + SNAPSHOT_AT_STEPS, world->steps);
    snapshot_put8(to + SNAPSHOT_AT_TIME, time);
    snapshot_put4(to + SNAPSHOT_AT_FLAGS, taking->flags);
    snapshot_put4(to + SNAPSHOT_AT_SECTIONS, kinds_end(taking) - 1);
    snapshot_put4(to + SNAPSHOT_AT_WORK, world->work.done);
    for (uint32_t kind = 1; kind < kinds_end(taking); kind++) {
        unsigned char *entry = to + SNAPSHOT_HEADER_BYTES + (kind - 1) * SNAPSHOT_ENTRY_BYTES;
        snapshot_put4(entry + SNAPSHOT_AT_KIND, kind);
        snapshot_put4(entry + SNAPSHOT_AT_COUNT, taking->count[kind]);
        snapshot_put4(entry + SNAPSHOT_AT_STRIDE, snapshot_stride[kind]);
        snapshot_put8(entry + SNAPSHOT_AT_OFFSET, taking->offset[kind]);
    }
}

static dpt_result begin(const dpt_world *world, const dpt_snapshot_def *given, struct taking *taking)
{
    dpt_snapshot_def def;
    *taking = (struct taking){ .world = world };
    if (!world)
        return DPT_E_ARGUMENT;
    DPT_TRY(read_def(given, &def));
    count_sections(taking, &def);
    return DPT_OK;
}

size_t dpt_snapshot_bytes(const dpt_world *world, const dpt_snapshot_def *given)
{
    struct taking taking;
    dpt_snapshot_def def;
    if (begin(world, given, &taking) != DPT_OK)
        return 0;
    read_def(given, &def);
    taking.count[SNAPSHOT_CONTACTS] = def.max_contacts;
    taking.count[SNAPSHOT_STRIPS] = world->def.strip ? def.max_strip : 0;
    taking.count[SNAPSHOT_CHANNELS] = world->def.max_channels;
    place_sections(&taking);
    return taking.bytes <= SIZE_MAX ? (size_t)taking.bytes : 0;
}

dpt_result dpt_world_take_snapshot(const dpt_world *world, const dpt_snapshot_def *given, void *block, size_t capacity,
                                   size_t *bytes)
{
    struct taking taking;
    if (!block || !bytes)
        return DPT_E_ARGUMENT;
    *bytes = 0;
    DPT_TRY(begin(world, given, &taking));
    place_sections(&taking);
    if (capacity < taking.bytes)
        return DPT_E_MEMORY;
    taking.to = block;
    memset(taking.to + taking.bytes - 8, 0, 8); /* the last section may end before the block */
    put_header(&taking);
    for (uint32_t i = 0; i < world->body_slot_end; i++)
        if (world->bodies[i].slot.used)
            put_body(&taking, &world->bodies[i]);
    for (uint32_t i = 0; i < world->tool_slot_end; i++)
        if (world->tools[i].slot.used) {
            dpti_tool_read_hits(world, &world->tools[i]);
            put_tool(&taking, &world->tools[i]);
        }
    *bytes = (size_t)taking.bytes;
    return DPT_OK;
}
