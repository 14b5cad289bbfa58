/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/compile_list.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/command_options.h"
#include "cli/sha256.h"
#include "compile/foreign.h"
#include "compile/soup.h"
#include "platform/clock.h"
#include "platform/file.h"
#include "platform/thread.h"
#include "text/open_file.h"

enum { NOTE_ROOM = 256, THREADS_MAX = 256, SETTINGS_ROOM = 512, COLUMNS = 6 };

static const char header[] = "in\tout\tverdict\tsha256\tseconds\tnote\n";

struct job {
    const char *in, *out; /* of the manifest */
    int is_done;
    const char *verdict;
    char hash[SHA256_TEXT];
    double seconds;
    char note[NOTE_ROOM];
};

struct list {
    const dpt_compile_def *def;
    char settings[SETTINGS_ROOM]; /* the table's first line */
    char *text;                   /* the manifest's */
    struct job *jobs;
    struct job **sorted; /* by `out` */
    size_t count, next;
    FILE *table;
    pthread_mutex_t lock;
    int is_broken; /* the table cannot be written */
};

/* ---- What is told of a source ---- */

static void put_note(char *note, const char *text)
{
    snprintf(note, NOTE_ROOM, "%s", text);
    for (char *c = note; *c; c++)
        if (*c == '\t' || *c == '\n' || *c == '\r')
            *c = ' ';
}

static void put_diag(char *note, const dpt_diag *diag)
{
    char text[NOTE_ROOM];
    if (diag->line)
        snprintf(text, sizeof text, "line %" PRIu64 ": %s", diag->line, diag->text);
    else if (diag->byte)
        snprintf(text, sizeof text, "byte %" PRIu64 ": %s", diag->byte, diag->text);
    else
        snprintf(text, sizeof text, "%s", diag->text);
    put_note(note, text);
}

static void keep_first(void *user, const dpt_diag *diag)
{
    if (!*(char *)user)
        put_diag(user, diag);
}

/* ---- One job ---- */

/* A whole file, a zero behind it; NULL, and errno. One that is shorter than the system said is EIO. */
static void *read_whole(const char *path, size_t *size)
{
    struct file_status found;
    if (file_get_status(path, &found) != 0)
        return NULL;
    FILE *file = open_file(path, "rb");
    char *bytes = file ? file_memory((size_t)found.bytes + 64) : NULL;
    if (bytes) {
        *size = fread(bytes, 1, (size_t)found.bytes, file);
        memset(bytes + *size, 0, 64);
        if (ferror(file) || *size != found.bytes) {
            const int why = ferror(file) ? errno : EIO;
            free(bytes);
            bytes = NULL;
            errno = why;
        }
    }
    if (file)
        fclose(file);
    return bytes;
}

/* Under another name first: a file of that name is whole. Returns 0, or -1 and errno. */
static int write_whole(const char *path, const dpt_compiled *compiled)
{
    size_t room = strlen(path) + sizeof ".part";
    char *part = malloc(room);
    if (!part)
        return -1;
    snprintf(part, room, "%s.part", path);
    FILE *file = open_file(part, "wb");
    int status = file && fwrite(compiled->bytes, compiled->size, 1, file) == 1 ? 0 : -1;
    if (file && fclose(file) != 0)
        status = -1;
    if (status == 0)
        status = file_replace(part, path);
    if (status != 0 && file)
        file_remove(part);
    free(part);
    return status;
}

static void refuse(struct job *job, dpt_result result, const char *why)
{
    job->verdict = dpt_result_name(result);
    put_note(job->note, why);
}

static void compile_job(const struct list *list, struct job *job)
{
    dpt_compile_def def = *list->def;
    dpt_diag diag = { .size = sizeof diag };
    dpt_compiled compiled;
    size_t size;
    job->note[0] = job->hash[0] = 0;
    unsigned char *bytes = read_whole(job->in, &size);
    if (!bytes) {
        refuse(job, DPT_E_SYSTEM, strerror(errno));
        return;
    }
    def.note = keep_first;
    def.note_user = job->note;
    def.threads = 1;
    def.format = source_format(job->in, bytes, size);
    const struct foreign_format *foreign = def.format == DPT_FORMAT_AUTO ? foreign_format_of(bytes, size) : NULL;
    if (foreign) {
        refuse(job, DPT_E_UNSUPPORTED, foreign->name);
    } else if (dpt_compile_bytes(bytes, size, &def, &compiled, &diag) != DPT_OK) {
        job->verdict = dpt_result_name(diag.code);
        put_diag(job->note, &diag);
    } else {
        job->verdict = dpt_result_name(DPT_OK);
        sha256_text(compiled.bytes, compiled.size, job->hash);
        if (write_whole(job->out, &compiled) != 0) {
            refuse(job, DPT_E_SYSTEM, strerror(errno));
            job->hash[0] = 0;
        }
        dpt_compiled_free(&compiled);
    }
    free(bytes);
}

static void write_row(FILE *file, const struct job *job)
{
    fprintf(file, "%s\t%s\t%s\t%s\t%.6f\t%s\n", job->in, job->out, job->verdict, job->hash, job->seconds, job->note);
}

static void *work(void *user)
{
    struct list *list = user;
    for (;;) {
        pthread_mutex_lock(&list->lock);
        while (list->next < list->count && list->jobs[list->next].is_done)
            list->next++;
        struct job *job = list->next < list->count && !list->is_broken ? &list->jobs[list->next++] : NULL;
        pthread_mutex_unlock(&list->lock);
        if (!job)
            return NULL;
        uint64_t began = clock_now();
        compile_job(list, job);
        job->seconds = (double)(clock_now() - began) * 1e-9;
        pthread_mutex_lock(&list->lock);
        job->is_done = 1;
        write_row(list->table, job);
        list->is_broken |= fflush(list->table) != 0;
        pthread_mutex_unlock(&list->lock);
    }
}

/* ---- The manifest ---- */

static int compare_outs(const void *a, const void *b)
{
    return strcmp((*(struct job *const *)a)->out, (*(struct job *const *)b)->out);
}

static int ends_in_dpa(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".dpa") == 0;
}

/* Where an output is: its folder, by whatever name, and its name in it. */
struct place {
    uint64_t volume, number;
    const char *name, *out;
};

/* A folder that is not there is known by its name alone. -1: memory ran out. */
static int find_place(const char *out, struct place *place)
{
    const char *slash = strrchr(out, '/'), *name = slash ? slash + 1 : out;
    const size_t length = (size_t)(name - out);
    struct file_status found;
    char *folder = malloc(length + sizeof "./");
    if (!folder)
        return -1;
    memcpy(folder, length ? out : "./", length ? length : 2);
    folder[length ? length : 2] = 0;
    const int is_there = file_get_status(folder, &found) == 0;
    free(folder);
    *place = (struct place){ .name = is_there ? name : out, .out = out };
    if (is_there)
        place->volume = found.volume, place->number = found.number;
    return 0;
}

static int compare_places(const void *a, const void *b)
{
    const struct place *one = a, *other = b;
    if (one->volume != other->volume)
        return one->volume < other->volume ? -1 : 1;
    if (one->number != other->number)
        return one->number < other->number ? -1 : 1;
    const int order = strcmp(one->name, other->name);
    return order ? order : strcmp(one->out, other->out);
}

/* Two outputs that are one file. Returns 0, or 2 after a message. */
static int refuse_twins(const struct list *list, const char *path)
{
    struct place *places = malloc(list->count * sizeof *places);
    int status = 0;
    for (size_t i = 0; places && i < list->count; i++)
        if (find_place(list->jobs[i].out, &places[i])) {
            free(places);
            places = NULL;
        }
    if (!places)
        return complain("compile", "%s: out of memory", path);
    qsort(places, list->count, sizeof *places, compare_places);
    for (size_t i = 1; !status && i < list->count; i++) {
        const struct place *one = &places[i - 1], *other = &places[i];
        if (one->volume == other->volume && one->number == other->number && strcmp(one->name, other->name) == 0)
            status = strcmp(one->out, other->out) == 0
                         ? complain("compile", "%s: '%s' is to be written twice", path, one->out)
                         : complain("compile", "%s: '%s' is to be written twice: it is '%s', too", path, one->out,
                                    other->out);
    }
    free(places);
    return status;
}

/* Returns 0, or 2 after a message. */
static int read_manifest(struct list *list, const char *path)
{
    size_t size, lines = 1;
    uint64_t line = 0;
    list->text = load_file("compile", path, &size);
    if (!list->text)
        return 2;
    for (size_t i = 0; i < size; i++)
        lines += list->text[i] == '\n';
    list->jobs = calloc(lines, sizeof *list->jobs);
    list->sorted = malloc(lines * sizeof *list->sorted);
    if (!list->jobs || !list->sorted)
        return complain("compile", "%s: out of memory", path);
    for (char *at = list->text, *end = at + size; at < end;) {
        char *next = memchr(at, '\n', (size_t)(end - at));
        line++;
        if (!next)
            next = end;
        *next = 0;
        if (next > at && next[-1] == '\r')
            next[-1] = 0;
        char *tab = strchr(at, '\t');
        if (*at && *at != '#') {
            if (!tab || tab == at || !tab[1] || strchr(tab + 1, '\t'))
                return complain("compile", "%s:%" PRIu64 ": a line is IN, a tab, OUT", path, line);
            *tab = 0;
            if (!ends_in_dpa(tab + 1))
                return complain("compile", "%s:%" PRIu64 ": '%s' does not end in .dpa", path, line, tab + 1);
            if (ends_in_dpa(at))
                return complain("compile", "%s:%" PRIu64 ": '%s' is compiled already", path, line, at);
            list->jobs[list->count] = (struct job){ .in = at, .out = tab + 1 };
            list->sorted[list->count] = &list->jobs[list->count];
            list->count++;
        }
        at = next + 1;
    }
    if (list->count)
        qsort(list->sorted, list->count, sizeof *list->sorted, compare_outs);
    return list->count ? refuse_twins(list, path) : complain("compile", "%s: it lists nothing", path);
}

/* ---- The table of results ---- */

/* The settings that files depend on, as the table's first line. Returns 0, or -1. */
static int name_settings(struct list *list)
{
    const dpt_compile_def *def = list->def;
    static const dpt_spring_net_def none;
    const dpt_spring_net_def *net = def->springs ? def->springs : &none;
    const double numbers[] = { def->scale,   def->crease,  def->recentre,    net->kind,      net->young,
                               net->density, net->drag,    net->viscosity,   net->thickness, net->bending,
                               net->spacing, net->poisson, net->region_count };
    const size_t regions = net->region_count * sizeof *net->regions, fixed = net->fixed_count * sizeof *net->fixed;
    char *bytes = malloc(sizeof numbers + regions + fixed), hash[SHA256_TEXT];
    if (!bytes)
        return -1;
    memcpy(bytes, numbers, sizeof numbers);
    if (regions)
        memcpy(bytes + sizeof numbers, net->regions, regions);
    if (fixed)
        memcpy(bytes + sizeof numbers + regions, net->fixed, fixed);
    sha256_text(bytes, sizeof numbers + regions + fixed, hash);
    free(bytes);
    snprintf(list->settings, sizeof list->settings, "# dynpoint %s, settings %.16s\n", dpt_version(), hash);
    return 0;
}

/* 1: the file is there, as its row says. */
static int is_there(const struct job *job)
{
    size_t size;
    char hash[SHA256_TEXT];
    void *bytes = read_whole(job->out, &size);
    if (!bytes)
        return 0;
    sha256_text(bytes, size, hash);
    free(bytes);
    return strcmp(hash, job->hash) == 0;
}

/* 1: the job was refused for what it is, and not for what the machine lacked then. */
static int is_refused(const struct job *job)
{
    return strcmp(job->verdict, dpt_result_name(DPT_OK)) != 0 &&
           strcmp(job->verdict, dpt_result_name(DPT_E_SYSTEM)) != 0 &&
           strcmp(job->verdict, dpt_result_name(DPT_E_MEMORY)) != 0;
}

/* Take a row of a table of ours; one that is no such row, or is cut, is done again. */
static void take_row(struct list *list, char *line)
{
    char *cell[COLUMNS];
    int cells = 0;
    for (char *at = line; at && cells < COLUMNS; cells++) {
        cell[cells] = at;
        at = strchr(at, '\t');
        if (at)
            *at++ = 0;
    }
    if (cells != COLUMNS)
        return;
    struct job wanted = { .out = cell[1] }, *key = &wanted;
    struct job **found = bsearch(&key, list->sorted, list->count, sizeof *list->sorted, compare_outs);
    struct job *job = found ? *found : NULL;
    if (!job || job->is_done || strcmp(job->in, cell[0]) != 0 || strlen(cell[3]) >= SHA256_TEXT)
        return;
    snprintf(job->hash, sizeof job->hash, "%s", cell[3]);
    job->verdict = cell[2];
    job->seconds = strtod(cell[4], NULL);
    put_note(job->note, cell[5]);
    job->is_done = is_refused(job) || (strcmp(job->verdict, dpt_result_name(DPT_OK)) == 0 && is_there(job));
}

/* What an earlier call has done, if the table is there. *text is to be freed. Returns 0, or 2 after a message. */
static int take_table(struct list *list, const char *path, char **text)
{
    struct file_status found;
    size_t size, length = strlen(list->settings);
    if (file_get_status(path, &found) != 0)
        return 0;
    *text = read_whole(path, &size);
    if (!*text)
        return complain("compile", "%s: %s", path, strerror(errno));
    if (size && strncmp(*text, list->settings, length) != 0)
        return complain("compile", "%s: it is no table of these settings and this version: name another one", path);
    for (char *at = *text + (size ? length : 0), *next; (next = strchr(at, '\n')) != NULL; at = next + 1) {
        *next = 0;
        take_row(list, at);
    }
    return 0;
}

/* The table of what is done, in the manifest's order. Returns 0, or 2 after a message. */
static int write_table(const struct list *list, const char *path)
{
    struct output output;
    if (output_open(&output, "compile", path))
        return 2;
    fputs(list->settings, output.file);
    fputs(header, output.file);
    for (size_t i = 0; i < list->count; i++)
        if (list->jobs[i].is_done)
            write_row(output.file, &list->jobs[i]);
    return output_close(&output, "compile");
}

static int run(struct list *list, const char *results)
{
    pthread_t thread[THREADS_MAX];
    uint32_t started = 0, wanted = list->def->threads < THREADS_MAX ? list->def->threads : THREADS_MAX;
    list->table = open_file(results, "ab");
    if (!list->table)
        return complain("compile", "%s: %s", results, strerror(errno));
    while (started + 1 < wanted && started + 1 < list->count && thread_start(&thread[started], work, list) == 0)
        started++;
    work(list);
    while (started > 0)
        pthread_join(thread[--started], NULL);
    if (fclose(list->table) != 0 || list->is_broken)
        return complain("compile", "%s: it cannot be written", results);
    return 0;
}

static int compile_alone(const char *manifest, const char *results, const dpt_compile_def *def)
{
    struct list list = { .def = def, .lock = PTHREAD_MUTEX_INITIALIZER };
    char *text = NULL;
    size_t kept = 0, refused = 0;
    int status = name_settings(&list) == 0 ? 0 : complain("compile", "out of memory");
    if (status == 0)
        status = read_manifest(&list, manifest);
    if (status == 0)
        status = take_table(&list, results, &text);
    for (size_t i = 0; i < list.count; i++)
        kept += (size_t)list.jobs[i].is_done;
    /* Rows that were cut are gone before any is added. */
    if (status == 0)
        status = write_table(&list, results);
    if (status == 0)
        status = run(&list, results);
    if (status == 0)
        status = write_table(&list, results);
    if (status == 0) {
        for (size_t i = 0; i < list.count; i++)
            refused += strcmp(list.jobs[i].verdict, dpt_result_name(DPT_OK)) != 0;
        printf("%s: %zu compiled, %zu refused", results, list.count - refused, refused);
        printf(kept ? "; %zu of these were there\n" : "\n", kept);
        status = refused > 0;
    }
    free(text);
    free(list.text);
    free(list.jobs);
    free(list.sorted);
    return status;
}

int compile_list(const char *manifest, const char *results, const dpt_compile_def *def)
{
    int held;
    const int status = file_lock(manifest, &held)
                           ? complain("compile", "%s: another dynpoint works on this list", manifest)
                           : compile_alone(manifest, results, def);
    if (held >= 0)
        close(held);
    return status;
}
