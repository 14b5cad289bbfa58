/* SPDX-License-Identifier: BSD-3-Clause */
#include "run/replay_report.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/quaternion.h"
#include "cli/command_options.h"
#include "csv.h"
#include "measure/measure_run.h"
#include "scene/tip_shape.h"

static const char *const status_words[] = { "stale", "local", "bounded", "exact" };
static const char *const contact_words[] = { "unknown", "separated", "touching", "penetrating" };

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort_numbers(double *values, size_t count)
{
    if (count) /* qsort takes no NULL */
        qsort(values, count, sizeof *values, by_value);
}

double percentile(const double *sorted, size_t count, double fraction)
{
    if (!count)
        return 0.0;
    size_t rank = (size_t)ceil(fraction * (double)count);
    return sorted[rank ? rank - 1 : 0];
}

static void write_numbers(FILE *file, const double *values, int count)
{
    for (int i = 0; i < count; i++)
        fprintf(file, ",%.17g", values[i]);
}

static int has_proxy(const struct replayed *replayed)
{
    return replayed->law == DPT_LAW_PROXY && replayed->until == DPT_UNTIL_RESPOND;
}

static void write_row(FILE *file, const struct replayed *replayed, size_t i)
{
    const struct replayed_tick *tick = &replayed->ticks[i];
    const dpt_hit *hit = &tick->hit;
    fprintf(file, "%" PRId64 ",%s,%s", (int64_t)csv_table_row(replayed->trace, i)[0], status_words[hit->status],
            replayed->until == DPT_UNTIL_TRACK ? "" : contact_words[hit->contact]);
    write_numbers(file, &hit->distance, 1);
    if (hit->flags & DPT_HIT_FLAG_GAP)
        fprintf(file, ",%.17g,%.17g", hit->gap, hit->depth);
    else
        fputs(",,", file);
    write_numbers(file, &hit->s, 1);
    write_numbers(file, hit->p, 3);
    write_numbers(file, hit->q, 3);
    fprintf(file, ",%" PRIu32, hit->triangle);
    write_numbers(file, &hit->error_bound, 1);
    write_numbers(file, &hit->lower_bound, 1);
    if (replayed->until == DPT_UNTIL_RESPOND) {
        write_numbers(file, tick->wrench.force, 3);
        write_numbers(file, tick->wrench.torque, 3);
    } else {
        fputs(",,,,,,", file);
    }
    if (replayed->until == DPT_UNTIL_RESPOND && replayed->law != DPT_LAW_POINT)
        write_numbers(file, &tick->energy, 1);
    else
        fputc(',', file);
    if (has_proxy(replayed)) {
        write_numbers(file, tick->proxy.position, 3);
        write_numbers(file, tick->proxy.orientation, 4);
    } else {
        fputs(",,,,,,,", file);
    }
    fputc('\n', file);
}

void replay_write_csv(FILE *file, const struct replayed *replayed)
{
    fputs("tick,status,contact,distance,gap,depth,s,px,py,pz,qx,qy,qz,triangle,error_bound,"
          "lower_bound,fx,fy,fz,tx,ty,tz,energy,ox,oy,oz,qw,qi,qj,qk\n",
          file);
    for (size_t i = 0; i < replayed->trace->rows; i++)
        write_row(file, replayed, i);
}

/* Counts and sorted times of a replay. */
struct summary {
    uint64_t status[4], contact[4];
    double *ns, *crossing_ns, *other_ns, *work, *strip_sizes;
    size_t count, crossing, other;   /* without the first tick */
    size_t strip_count, full_strips; /* ticks with a strip, with a full one */
    uint64_t inside, folds;          /* ticks of a proxy that began inside, that folds */
};

static int summarise(const struct replayed *replayed, struct summary *summary)
{
    size_t count = replayed->trace->rows;
    memset(summary, 0, sizeof *summary);
    summary->ns = malloc(5 * count * sizeof *summary->ns);
    if (!summary->ns)
        return 0;
    summary->crossing_ns = summary->ns + count;
    summary->other_ns = summary->crossing_ns + count;
    summary->work = summary->other_ns + count;
    summary->strip_sizes = summary->work + count;
    for (size_t i = 0; i < count; i++) {
        const struct replayed_tick *tick = &replayed->ticks[i];
        summary->inside += tick->reason == DPT_FORCE_INSIDE;
        summary->folds += (tick->force_flags & DPT_FORCE_FLAG_FOLD) != 0;
        summary->status[tick->hit.status]++;
        summary->contact[tick->hit.contact]++;
        if (tick->strip_triangles)
            summary->strip_sizes[summary->strip_count++] = tick->strip_triangles;
        summary->full_strips += (tick->strip_flags & DPT_STRIP_FLAG_FULL) != 0;
        if (i == 0)
            continue;
        summary->work[summary->count] = tick->hit.work;
        summary->ns[summary->count++] = tick->ns;
        if (tick->hit.distance == 0.0)
            summary->crossing_ns[summary->crossing++] = tick->ns;
        else
            summary->other_ns[summary->other++] = tick->ns;
    }
    sort_numbers(summary->ns, summary->count);
    sort_numbers(summary->work, summary->count);
    sort_numbers(summary->strip_sizes, summary->strip_count);
    sort_numbers(summary->crossing_ns, summary->crossing);
    sort_numbers(summary->other_ns, summary->other);
    return 1;
}

static void json_times(FILE *file, const char *name, const double *sorted, size_t count)
{
    fprintf(file, "\"%s\":{\"median\":%.0f,\"p99\":%.0f,\"p999\":%.0f,\"max\":%.0f}", name,
            percentile(sorted, count, 0.5), percentile(sorted, count, 0.99), percentile(sorted, count, 0.999),
            percentile(sorted, count, 1.0));
}

static void json_histogram(FILE *file, enum tick_histogram_of of, const double *sorted, size_t count)
{
    double edges[TICK_HISTOGRAM_EDGES];
    const int edge_count = tick_histogram_edges(of, edges);
    const struct tick_histogram histogram = tick_histogram_count(of, sorted, count);
    fprintf(file, ",\"%s_histogram\":{\"edges\":[", tick_histogram_words[of]);
    for (int i = 0; i < edge_count; i++)
        fprintf(file, i ? ",%.0f" : "%.0f", edges[i]);
    fputs("],\"counts\":[", file);
    for (int i = 0; i <= edge_count; i++)
        fprintf(file, i ? ",%" PRIu32 : "%" PRIu32, histogram.bin[i]);
    fputs("]}", file);
}

void replay_print_json(FILE *file, const struct replayed *replayed)
{
    struct summary s;
    if (!summarise(replayed, &s))
        return;
    fprintf(file, "{\"ticks\":%zu,\"method\":\"%s\"", replayed->trace->rows, replayed->method);
    for (int i = 3; i >= 0; i--)
        fprintf(file, ",\"%s\":%" PRIu64, status_words[i], s.status[i]);
    for (int i = 1; i <= 4; i++)
        fprintf(file, ",\"%s\":%" PRIu64, contact_words[i % 4], s.contact[i % 4]);
    fputc(',', file);
    json_times(file, "ns", s.ns, s.count);
    fputc(',', file);
    json_times(file, "ns_crossing", s.crossing_ns, s.crossing);
    fputc(',', file);
    json_times(file, "ns_other", s.other_ns, s.other);
    fprintf(file, ",\"crossing\":%zu,\"first_ns\":%.0f", s.crossing, replayed->ticks[0].ns);
    fprintf(file, ",\"work\":{\"median\":%.0f,\"p99\":%.0f,\"max\":%.0f}", percentile(s.work, s.count, 0.5),
            percentile(s.work, s.count, 0.99), percentile(s.work, s.count, 1.0));
    json_histogram(file, TICK_HISTOGRAM_NS, s.ns, s.count);
    json_histogram(file, TICK_HISTOGRAM_WORK, s.work, s.count);
    fprintf(file, ",\"bytes\":%zu,\"mesh_bytes\":%" PRIu64 ",\"kernel\":\"%s\"", replayed->world_bytes,
            replayed->mesh_bytes, dpt_kernel_name(replayed->kernel));
    if (replayed->strip_kind)
        fprintf(file, ",\"strips\":{\"ticks\":%zu,\"median\":%.0f,\"p99\":%.0f,\"max\":%.0f,\"full\":%zu}",
                s.strip_count, percentile(s.strip_sizes, s.strip_count, 0.5),
                percentile(s.strip_sizes, s.strip_count, 0.99), percentile(s.strip_sizes, s.strip_count, 1.0),
                s.full_strips);
    if (replayed->tip_error > 0.0)
        fprintf(file, ",\"tip_error\":%.17g", replayed->tip_error);
    if (has_proxy(replayed))
        fprintf(file, ",\"inside\":%" PRIu64 ",\"folds\":%" PRIu64, s.inside, s.folds);
    const struct comparison *against = &replayed->against;
    if (against->method)
        fprintf(file,
                ",\"against\":{\"method\":\"%s\",\"ticks\":%" PRIu64 ",\"wrong\":%" PRIu64 ",\"missed\":%" PRIu64
                ",\"largest_error\":%.17g,\"tolerance\":%.17g,\"ns\":%.0f}",
                against->method, against->ticks, against->wrong_count, against->missed_crossings, against->error_max,
                against->tolerance, against->median_ns);
    fputs("}\n", file);
    free(s.ns);
}

static void print_time_row(FILE *file, const char *what, const double *sorted, size_t count)
{
    if (count)
        fprintf(file, "  %-22s %8zu %9.2f %9.2f %9.2f\n", what, count, 1e-3 * percentile(sorted, count, 0.5),
                1e-3 * percentile(sorted, count, 0.99), 1e-3 * percentile(sorted, count, 1.0));
}

void replay_print_table(FILE *file, const struct replayed *replayed)
{
    struct summary s;
    if (!summarise(replayed, &s))
        return;
    fprintf(file, "method %s, kernel %s, %.0f kB for the world, %.1f MB of mesh used in place\n\n", replayed->method,
            dpt_kernel_name(replayed->kernel), (double)replayed->world_bytes / 1e3, (double)replayed->mesh_bytes / 1e6);
    fprintf(file, "  %-22s %8s %9s %9s %9s\n", "microseconds a tick", "ticks", "median", "99 %", "worst");
    print_time_row(file, "all", s.ns, s.count);
    print_time_row(file, "axis crosses the mesh", s.crossing_ns, s.crossing);
    print_time_row(file, "axis does not", s.other_ns, s.other);
    fprintf(file, "  %-22s %8d %9.2f\n\n", "first, from nothing", 1, 1e-3 * replayed->ticks[0].ns);
    int status = s.status[DPT_STATUS_LOCAL] ? DPT_STATUS_LOCAL : DPT_STATUS_EXACT;
    fprintf(file, "  %s on %" PRIu64 " of %zu ticks", status_words[status], s.status[status], replayed->trace->rows);
    if (replayed->until != DPT_UNTIL_TRACK)
        fprintf(file, "; separated %" PRIu64 ", touching %" PRIu64 ", penetrating %" PRIu64 ", unknown %" PRIu64,
                s.contact[DPT_CONTACT_SEPARATED], s.contact[DPT_CONTACT_TOUCHING], s.contact[DPT_CONTACT_PENETRATING],
                s.contact[DPT_CONTACT_UNKNOWN]);
    fputs("\n", file);
    curved_tips_print_error(file, replayed->curved, replayed->tip_error);
    if (s.inside)
        fprintf(file, "  no force on %" PRIu64 " ticks: the tool began inside, and has not been outside since\n",
                s.inside);
    if (s.folds)
        fprintf(file, "  folds on %" PRIu64 " ticks: the pose that held the proxy was gone\n", s.folds);
    if (replayed->strip_kind)
        fprintf(file, "  strips on %zu ticks: %.0f triangles at the median, at most %.0f; %zu full\n", s.strip_count,
                percentile(s.strip_sizes, s.strip_count, 0.5), percentile(s.strip_sizes, s.strip_count, 1.0),
                s.full_strips);
    const struct comparison *against = &replayed->against;
    if (against->method)
        fprintf(file,
                "  against %s on %" PRIu64 " ticks: %" PRIu64
                " wrong, largest difference %.2g m (%.1g of the diagonal); %s took %.0f us a tick\n",
                against->method, against->ticks, against->wrong_count, against->error_max,
                against->error_max / replayed->diagonal, against->method, 1e-3 * against->median_ns);
    free(s.ns);
}

/* Of the tool's length: rows of a trace with few digits differ by that. */
#define LENGTH_ERROR 1e-4

static dpt_segment segment_of(const struct csv_table *trace, size_t row, double radius)
{
    const double *ends = csv_table_row(trace, row) + 1;
    dpt_segment segment;
    memcpy(segment.a, ends, sizeof segment.a);
    memcpy(segment.b, ends + 3, sizeof segment.b);
    segment.radius = radius;
    return segment;
}

/* From end a to end b of a row. */
static vec3 reach_of(const struct csv_table *trace, size_t row)
{
    const double *ends = csv_table_row(trace, row) + 1;
    return sub(vec3_of(ends + 3), vec3_of(ends));
}

int replay_tool_open(struct replay_tool *tool, const char *path, const struct csv_table *trace)
{
    const double first = length(reach_of(trace, 0));
    tool->length = first;
    for (size_t row = 0; tool->tips.count && row < trace->rows; row++) {
        const double size = length(reach_of(trace, row));
        if (!(fabs(size - first) <= LENGTH_ERROR * first))
            return complain("replay",
                            "%s: tick %.0f: --tip needs a tool of one length; it is %g m, and %g m in the first row",
                            path, csv_table_row(trace, row)[0], size, first);
    }
    for (uint32_t i = 0; i < tool->tips.count; i++) {
        const dpt_result result = tip_shape_make(&tool->tips.shape[i], &tool->blocks[i], &tool->hulls[i]);
        if (result != DPT_OK)
            return complain("replay", "tip %" PRIu32 ": %s", i + 1, dpt_result_text(result));
    }
    return 0;
}

void replay_tool_close(struct replay_tool *tool)
{
    for (uint32_t i = 0; i < tool->tips.count; i++)
        free(tool->blocks[i]);
}

dpt_segment replay_tool_segment(const struct replay_tool *tool, const struct csv_table *trace)
{
    const dpt_segment posed = { .b = { 0.0, 0.0, tool->length }, .radius = tool->radius };
    return tool->tips.count ? posed : segment_of(trace, 0, tool->radius);
}

dpt_result replay_tool_add_tips(struct replay_tool *tool, dpt_world *world, dpt_tool added, const dpt_mesh *mesh,
                                const struct force_options *force)
{
    dpt_tip tips[TIP_SHAPES_MAX];
    if (force->law != DPT_LAW_PROXY) {
        tool->curved.bodies[0] = (dpt_convex_body){ .mesh = mesh };
        tool->curved.body_count = 1;
        return curved_tips_attach(&tool->curved, &tool->tips, world, added, force);
    }
    for (uint32_t i = 0; i < tool->tips.count; i++)
        tips[i] = (dpt_tip){ .size = sizeof tips[i], .hull = tool->hulls[i] };
    return dpt_tool_set_tips(world, added, tips, tool->tips.count);
}

double replay_tool_error(const struct replay_tool *tool)
{
    return tool->curved.count ? tool->curved.error : tip_shapes_error(&tool->tips);
}

/* Turned as little as can be from `turn`, or after a jump from not being turned, so that z leads along `reach`. */
static struct quaternion turned_along(struct quaternion turn, vec3 reach)
{
    const vec3 z = { 0.0, 0.0, 1.0 };
    const double size = length(reach);
    if (!(size > 0.0))
        return turn;
    const vec3 along = scaled(reach, 1.0 / size);
    const struct quaternion by = quaternion_of_turn(unit_of(quaternion_turn(turn, z)), along);
    return quaternion_unit(quaternion_product(by, turn));
}

dpt_result replay_tool_place(struct replay_tool *tool, const struct csv_table *trace, size_t row, dpt_world *world,
                             dpt_tool added)
{
    static const dpt_pose identity = DPT_POSE_IDENTITY;
    const dpt_segment segment = segment_of(trace, row, tool->radius);
    const int is_jump = trace_is_jump(trace, row);
    curved_tips_begin_tick(&tool->curved);
    if (!tool->tips.count) {
        const dpt_result result = is_jump ? dpt_tool_teleport(world, added, &identity) : DPT_OK;
        return result == DPT_OK ? dpt_tool_set_segments(world, added, &segment, 1) : result;
    }
    if (is_jump)
        tool->pose = identity;
    const struct quaternion before = quaternion_of(tool->pose.orientation);
    quaternion_store(turned_along(before, reach_of(trace, row)), tool->pose.orientation);
    memcpy(tool->pose.position, segment.a, sizeof segment.a);
    return is_jump ? dpt_tool_teleport(world, added, &tool->pose) : dpt_tool_set_pose(world, added, &tool->pose);
}
