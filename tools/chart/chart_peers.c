/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart/chart_peers.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/csv_rows.h"
#include "platform/file.h"
#include "platform/program.h"
#include "text/open_file.h"

static const char prefix[] = "peer_";

enum { PATH_ROOM = 4200, REPORT_ROOM = 16384 };

/* Their files. */
struct exchange {
    char mesh[PATH_ROOM], trace[PATH_ROOM], answers[PATH_ROOM], report[PATH_ROOM];
};

/* What they know of bodies and tools. */
static int is_for_peers(const struct scene *scene)
{
    const dpt_pose upright = DPT_POSE_IDENTITY;
    const struct scene_body *body = &scene->bodies.body[0];
    return scene->bodies.count == 1 && scene->has_stylus && !scene_body_is_soft(body) &&
           !memcmp(&body->pose, &upright, sizeof upright);
}

static void put_word(FILE *file, uint32_t word)
{
    for (int i = 0; i < 4; i++)
        fputc((int)(word >> 8 * i & 0xFF), file);
}

static void write_mesh(FILE *file, const dpt_mesh *mesh)
{
    const float *xyz;
    const uint32_t *corners, *numbers;
    uint32_t vertices, triangles;
    dpt_mesh_get_vertices(mesh, &xyz, &vertices);
    dpt_mesh_get_triangles(mesh, &corners, &numbers, &triangles);
    put_word(file, vertices);
    put_word(file, triangles);
    for (size_t i = 0; i < (size_t)vertices * 3; i++) {
        uint32_t bits;
        memcpy(&bits, &xyz[i], sizeof bits);
        put_word(file, bits);
    }
    for (size_t i = 0; i < (size_t)triangles * 3; i++)
        put_word(file, corners[i]);
}

static void write_trace(FILE *file, const struct csv_table *trace)
{
    fputs("tick,ax,ay,az,bx,by,bz\n", file);
    for (size_t i = 0; i < trace->rows; i++) {
        const double *row = csv_table_row(trace, i);
        fprintf(file, "%" PRId64, (int64_t)row[0]);
        for (size_t k = 1; k < trace->columns; k++)
            fprintf(file, ",%.17g", row[k]);
        fputc('\n', file);
    }
}

static int write_inputs(const struct exchange *exchange, const struct scene *scene, const struct csv_table *trace)
{
    struct output output;
    int status = output_open(&output, scene->command, exchange->mesh);
    if (status)
        return status;
    write_mesh(output.file, scene->bodies.body[0].mesh);
    status = output_close(&output, scene->command);
    if (status == 0)
        status = output_open(&output, scene->command, exchange->trace);
    if (status)
        return status;
    write_trace(output.file, trace);
    return output_close(&output, scene->command);
}

/* 1 if the program ended well. */
static int run_program(const char *program, const struct exchange *exchange, uint32_t passes)
{
    char repeat[16];
    snprintf(repeat, sizeof repeat, "%u", (unsigned)passes);
    const char *const words[] = { program,  exchange->mesh, exchange->trace, "-o", exchange->answers,
                                  "--json", "--repeat",     repeat,          NULL };
    return program_run(words, exchange->report);
}

/* The number behind a key that stands in `at`; 0 if it is not there. */
static double number_after(const char *at, const char *key)
{
    const char *found = at ? strstr(at, key) : NULL;
    return found ? strtod(found + strlen(key), NULL) : 0.0;
}

static struct judgement_spread read_times(const char *text, const char *key)
{
    const char *at = strstr(text, key);
    return (struct judgement_spread){ .median = number_after(at, "\"median\":"),
                                      .p99 = number_after(at, "\"p99\":"),
                                      .p999 = number_after(at, "\"p999\":"),
                                      .max = number_after(at, "\"max\":") };
}

/* In the bins of ours; one that counts none has none. */
static void read_histogram(struct tick_histogram *histogram, const char *text)
{
    const char *at = strstr(text, "\"ns_histogram\":{");
    at = at ? strstr(at, "\"counts\":[") : NULL;
    at = at ? strchr(at, '[') : NULL;
    for (int i = 0; at && *at && *at != ']' && i <= TICK_HISTOGRAM_EDGES; i++) {
        char *end;
        histogram->bin[i] = (uint32_t)strtoul(at + 1, &end, 10);
        at = end;
    }
}

static int read_report(struct chart_row *row, const char *path)
{
    char text[REPORT_ROOM];
    FILE *file = open_file(path, "rb");
    const size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
    struct judgement *judged = &row->judged;
    if (file)
        fclose(file);
    text[size] = '\0';
    judged->ns = read_times(text, "\"ns\":{");
    judged->crossing_ns = read_times(text, "\"ns_crossing\":{");
    judged->other_ns = read_times(text, "\"ns_other\":{");
    judged->first_ns = number_after(text, "\"first_ns\":");
    judged->whole_ns = judged->ns;
    read_histogram(&judged->histogram[TICK_HISTOGRAM_NS], text);
    row->build_ns = number_after(text, "\"build_ns\":");
    return judged->ns.median > 0.0;
}

/* Without a distance a peer says that they do not meet. */
static void judge_answer(struct judgement *judged, const struct csv_cell *cell, double truth, double tolerance)
{
    const int is_told = cell->end > cell->begin;
    const double distance = is_told ? strtod(cell->begin, NULL) : NAN;
    const double error = fabs(distance - truth);
    const int is_wrong = is_told ? !(error <= tolerance) : truth == 0.0;
    judged->wrong += (size_t)is_wrong;
    judged->missed_crossings += is_wrong && truth == 0.0;
    if (!(judged->distance_error >= error))
        judged->distance_error = error;
    judged->ticks++;
}

static int read_answers(struct chart_row *row, const struct chart_truth *truth, const char *path)
{
    struct csv_rows *answers = calloc(1, sizeof *answers);
    struct judgement *judged = &row->judged;
    int more = 0, is_unknown = 0;
    if (!answers)
        return complain("chart", "memory ran out");
    int status = csv_rows_open(answers, "chart", path);
    if (status == 0)
        more = csv_rows_next(answers); /* the header */
    while (status == 0 && more > 0 && (more = csv_rows_next(answers)) > 0) {
        if (answers->cells < 2 || judged->ticks == truth->ticks)
            break;
        is_unknown |= answers->cell[1].end == answers->cell[1].begin;
        judge_answer(judged, &answers->cell[1], truth->distance[judged->ticks], truth->check.tolerance);
    }
    csv_rows_close(answers);
    free(answers);
    if (is_unknown)
        judged->distance_error = NAN;
    return status || more < 0 ? 2 : 0;
}

/* Behind those of its part. */
static void insert_row(struct chart_rows *rows, const struct chart_row *row)
{
    int at = 0;
    while (at < rows->count && rows->row[at].part <= row->part)
        at++;
    memmove(&rows->row[at + 1], &rows->row[at], (size_t)(rows->count - at) * sizeof *row);
    rows->row[at] = *row;
    rows->count++;
}

/* Add its row; one that fails is left out. */
static void add_peer(struct chart_rows *rows, const char *folder, const char *name, const struct exchange *exchange,
                     uint32_t passes)
{
    char program[PATH_ROOM];
    struct chart_row row = { .part = CHART_PAIR, .is_peer = 1 };
    snprintf(program, sizeof program, "%s/%s", folder, name);
    snprintf(row.name, sizeof row.name, "%s", name + strlen(prefix));
    if (rows->count < CHART_ROWS_MAX && run_program(program, exchange, passes) && read_report(&row, exchange->report) &&
        !read_answers(&row, &rows->truth, exchange->answers) && row.judged.ticks == rows->truth.ticks)
        insert_row(rows, &row);
    else
        complain("chart", "%s: it failed, and is left out", program);
    file_remove(exchange->report);
    file_remove(exchange->answers);
}

static int is_peer_name(const char *name)
{
    return !strncmp(name, prefix, strlen(prefix)) && !strchr(name, '.') && !strchr(name, ',');
}

int chart_peers_check(const struct scene *scene, const char *folder)
{
    char **names;
    if (!is_for_peers(scene))
        return complain("chart", "--peers: they know a single rigid mesh and a stylus alone");
    const int count = file_list(folder, is_peer_name, &names);
    if (count < 0)
        return complain("chart", "%s: cannot be read: %s", folder, strerror(errno));
    file_list_free(names, count);
    return count ? 0 : complain("chart", "%s: there is no program peer_NAME", folder);
}

int chart_peers_measure(struct chart_rows *rows, const struct scene *scene, const struct csv_table *trace,
                        const char *folder, const char *beside, uint32_t passes)
{
    char **names = NULL;
    struct exchange exchange;
    snprintf(exchange.mesh, sizeof exchange.mesh, "%s.peer.tri", beside);
    snprintf(exchange.trace, sizeof exchange.trace, "%s.peer.trace", beside);
    snprintf(exchange.answers, sizeof exchange.answers, "%s.peer.answers", beside);
    snprintf(exchange.report, sizeof exchange.report, "%s.peer.report", beside);
    const int status = write_inputs(&exchange, scene, trace);
    const int count = status ? 0 : file_list(folder, is_peer_name, &names);
    for (int i = 0; i < count; i++)
        add_peer(rows, folder, names[i], &exchange, passes);
    file_list_free(names, count);
    file_remove(exchange.mesh);
    file_remove(exchange.trace);
    return status;
}
