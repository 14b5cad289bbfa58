/* SPDX-License-Identifier: BSD-3-Clause */
/* dynpoint record: what a recording holds, and its columns as CSV. */
#define _POSIX_C_SOURCE 200809L
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "base/vec3.h"
#include "cli/command_options.h"
#include "cli/commands.h"
#include "cli/json_text.h"
#include "dynpoint/device.h"
#include "record/recording_embed.h"
#include "record/recording_file.h"
#include "scene/tip_shape.h"

static const char help[] =
    "usage: dynpoint record info FILE.dpr [--json]\n"
    "       dynpoint record csv FILE.dpr -o OUT.csv\n"
    "\n"
    "What dynpoint run --record wrote.\n"
    "\n"
    "  info    the scene, and counts; exit status 1 if bytes are damaged, or parts of a file\n"
    "          that it carries are missing\n"
    "  csv     a row for each record, with every digit (docs/format.md names the columns); - is\n"
    "          standard output. What is damaged is left out and told; exit status 1 then\n"
    "  --json  info as one JSON object on standard output\n"
    "  -o FILE where csv writes to\n";

static const char *const verbs[] = { "info", "csv", NULL };

/* Of each: how it is called, the options that it takes, and what --help says of it. */
static const struct {
    const char *typed, *options, *help;
} verb_defs[] = {
    { "record info", "--json",
      "usage: dynpoint record info FILE.dpr [--json]\n"
      "\n"
      "The scene of a recording, and counts; exit status 1 if bytes are damaged, or parts of a file\n"
      "that it carries are missing.\n"
      "\n"
      "  --json  as one JSON object on standard output\n" },
    { "record csv", "-o",
      "usage: dynpoint record csv FILE.dpr -o OUT.csv\n"
      "\n"
      "A row for each record, with every digit (docs/format.md names the columns). What is damaged is\n"
      "left out and told; exit status 1 then.\n"
      "\n"
      "  -o FILE  where to; - is standard output\n" },
};

/* What is in a recording. */
struct record_counts {
    uint64_t records, felt, lost, contact, penetrating;
    uint64_t gaps, missing; /* in the running numbers */
    uint64_t damages, damaged_bytes, first_damage;
    int is_cut;
    uint64_t cut_byte;
    uint64_t first_ns, last_ns, late_max_ns, took_max_ns;
    double asked_max, sent_max; /* N */
    double depth_max;           /* m: of a needle */
    uint64_t ruptures;          /* ticks in which walls opened before a needle */
    uint32_t open_walls;        /* before it in the last tick */
    uint64_t next;              /* number of the next record */
    struct recording_embed embed;
};

static uint64_t later_of(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static void count_record(struct record_counts *counts, const dpt_record *record)
{
    const int is_felt = (record->flags & DPT_RECORD_FLAG_FELT) != 0;
    if (record->number != counts->next) {
        counts->gaps++;
        counts->missing += record->number - counts->next;
    }
    counts->next = record->number + 1;
    if (counts->records++ == 0)
        counts->first_ns = record->time_ns;
    counts->last_ns = record->time_ns;
    counts->felt += (uint64_t)is_felt;
    counts->lost += record->status == DPT_DEVICE_STATUS_LOST;
    counts->contact += is_felt && record->contact != DPT_CONTACT_SEPARATED;
    counts->penetrating += record->contact == DPT_CONTACT_PENETRATING;
    counts->late_max_ns = later_of(counts->late_max_ns, record->late_ns);
    counts->took_max_ns = later_of(counts->took_max_ns, record->took_ns);
    counts->asked_max = fmax(counts->asked_max, vec3_length(record->asked.force));
    counts->sent_max = fmax(counts->sent_max, vec3_length(record->sent.force));
    counts->depth_max = fmax(counts->depth_max, record->depth);
    counts->ruptures += record->ruptures > counts->open_walls && (record->force_flags & DPT_FORCE_FLAG_RUPTURE);
    counts->open_walls = record->ruptures;
}

/* Count a record, or what is there instead of one. Returns 0 at the end. */
static int count_item(struct record_counts *counts, const struct recording_file *recording, enum recording_item item,
                      const dpt_record *record)
{
    if (item == RECORDING_RECORD)
        count_record(counts, record);
    if (item == RECORDING_DAMAGED) {
        if (counts->damages++ == 0)
            counts->first_damage = recording->byte;
        counts->damaged_bytes += recording->damaged;
    }
    if (item == RECORDING_CUT) {
        counts->is_cut = 1;
        counts->cut_byte = recording->byte;
    }
    recording_embed_take(&counts->embed, recording, item);
    return item != RECORDING_END && item != RECORDING_CUT;
}

static void print_embedded(const struct recording_embed *embed)
{
    for (int i = 0; i < EMBED_FILES; i++) {
        const struct embedded_file *file = &embed->file[i];
        if (file->fault[0])
            printf("  the %s that it carries is not whole: %s\n", embedded_names[i], file->fault);
        else if (file->pieces)
            printf("  it carries its %s: %" PRIu64 " bytes, CRC-32 %08" PRIx32 "\n", embedded_names[i], file->total,
                   file->crc32);
    }
}

/* Of the line of a curved tip: how much larger the hull is that a proxy feels. */
static void print_tip_error(const char *line, const char *end)
{
    struct tip_shape tip;
    const int is_tip = end - line > 4 && !memcmp(line, "tip=", 4) && tip_shape_read(&tip, line + 4, end);
    const double error = is_tip ? tip_shape_error(&tip) : 0.0;
    if (error > 0.0)
        printf("    as a hull, which a proxy feels, it is up to %.3g mm larger\n", 1e3 * error);
}

static void print_text(const char *path, const dpt_record_header *header, const struct record_counts *c)
{
    const time_t began = (time_t)(header->began_ns / 1000000000u);
    struct tm utc;
    char date[32] = "";
    if (header->began_ns && gmtime_r(&began, &utc))
        strftime(date, sizeof date, ", %Y-%m-%d %H:%M:%S UTC", &utc);
    printf("%s: %" PRIu64 " records, %.3f s at %g Hz%s\n", path, c->records, 1e-9 * (double)(c->last_ns - c->first_ns),
           header->rate, date);
    printf("  %" PRIu64 " felt, %" PRIu64 " of them in contact; %" PRIu64 " while the device was lost\n", c->felt,
           c->contact, c->lost);
    printf("  strongest asked %.3f N, sent %.3f N; latest tick %.1f us, longest step %.1f us\n", c->asked_max,
           c->sent_max, 1e-3 * (double)c->late_max_ns, 1e-3 * (double)c->took_max_ns);
    if (c->depth_max > 0.0)
        printf("  a needle was %.2f mm in; walls opened in %" PRIu64 " ticks\n", 1e3 * c->depth_max, c->ruptures);
    if (c->missing)
        printf("  %" PRIu64 " records are missing, in %" PRIu64 " gaps\n", c->missing, c->gaps);
    if (c->damages)
        printf("  damaged in %" PRIu64 " places, first at byte %" PRIu64 ": %" PRIu64 " bytes are no records\n",
               c->damages, c->first_damage, c->damaged_bytes);
    if (c->is_cut)
        printf("  cut off within a record, at byte %" PRIu64 "\n", c->cut_byte);
    print_embedded(&c->embed);
    for (const char *line = header->text; *line;) {
        const size_t length = strcspn(line, "\n");
        printf("  %.*s\n", (int)length, line);
        print_tip_error(line, line + length);
        line += length + (line[length] != '\0');
    }
}

static void print_json_embedded(const struct recording_embed *embed)
{
    fputs(",\"embedded\":[", stdout);
    for (int i = 0, printed = 0; i < EMBED_FILES; i++) {
        const struct embedded_file *file = &embed->file[i];
        if (!file->pieces)
            continue;
        printf("%s{\"file\":\"%s\",\"bytes\":%" PRIu64 ",\"held\":%" PRIu64 ",\"pieces\":%" PRIu32 ",\"crc32\":%" PRIu32
               ",\"fault\":",
               printed++ ? "," : "", embedded_names[i], file->total, file->held, file->pieces, file->crc32);
        if (file->fault[0])
            json_write_text(stdout, file->fault);
        else
            fputs("null", stdout);
        putchar('}');
    }
    putchar(']');
}

static void print_json(const char *path, const dpt_record_header *header, const struct record_counts *c)
{
    const struct {
        const char *name;
        uint64_t value;
    } numbers[] = { { "records", c->records },
                    { "felt", c->felt },
                    { "lost", c->lost },
                    { "contact", c->contact },
                    { "penetrating", c->penetrating },
                    { "gaps", c->gaps },
                    { "missing", c->missing },
                    { "damages", c->damages },
                    { "damaged_bytes", c->damaged_bytes },
                    { "first_damage", c->first_damage },
                    { "cut_byte", c->cut_byte },
                    { "ruptures", c->ruptures },
                    { "began_ns", header->began_ns },
                    { "first_ns", c->first_ns },
                    { "last_ns", c->last_ns },
                    { "late_max_ns", c->late_max_ns },
                    { "took_max_ns", c->took_max_ns } };
    fputs("{\"path\":", stdout);
    json_write_text(stdout, path);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        printf(",\"%s\":%" PRIu64, numbers[i].name, numbers[i].value);
    printf(",\"cut\":%s,\"rate\":%.17g", c->is_cut ? "true" : "false", header->rate);
    const struct {
        const char *name;
        double value;
    } forces[] = { { "asked_max", c->asked_max }, { "sent_max", c->sent_max }, { "needle_depth", c->depth_max } };
    for (size_t i = 0; i < 3; i++) {
        if (isfinite(forces[i].value))
            printf(",\"%s\":%.17g", forces[i].name, forces[i].value);
        else
            printf(",\"%s\":null", forces[i].name);
    }
    print_json_embedded(&c->embed);
    fputs(",\"scene\":[", stdout);
    for (const char *line = header->text; *line;) {
        const size_t length = strcspn(line, "\n");
        fputs(line == header->text ? "" : ",", stdout);
        json_write_part(stdout, line, length);
        line += length + (line[length] != '\0');
    }
    puts("]}");
}

static int info(struct recording_file *recording, const char *path, int json)
{
    struct record_counts counts = { .records = 0 };
    dpt_record record;
    enum recording_item item;
    recording_embed_begin(&counts.embed, recording);
    do
        item = recording_next(recording, &record);
    while (count_item(&counts, recording, item, &record));
    (json ? print_json : print_text)(path, &recording->header, &counts);
    const int is_whole = !counts.embed.file[EMBED_SCENE].fault[0] && !counts.embed.file[EMBED_TOOL].fault[0];
    return counts.damages || !is_whole;
}

static int write_csv(struct recording_file *recording, const char *path, const char *out)
{
    struct output output;
    struct record_counts counts = { .records = 0 };
    dpt_record record;
    enum recording_item item;
    int status = output_open(&output, "record", out);
    if (status)
        return status;
    for (size_t i = 0; i < record_field_count; i++)
        fprintf(output.file, "%s%s", i ? "," : "", record_fields[i].name);
    fputc('\n', output.file);
    do {
        item = recording_next(recording, &record);
        for (size_t i = 0; item == RECORDING_RECORD && i < record_field_count; i++) {
            if (i)
                fputc(',', output.file);
            record_field_print(output.file, &record_fields[i], &record, 0);
        }
        if (item == RECORDING_RECORD)
            fputc('\n', output.file);
    } while (count_item(&counts, recording, item, &record));
    status = output_close(&output, "record");
    if (status || !counts.damages)
        return status;
    complain("record", "%s: byte %" PRIu64 ": damaged; %" PRIu64 " bytes were left out", path, counts.first_damage,
             counts.damaged_bytes);
    return 1;
}

int command_record(int argc, char **argv)
{
    const char *operand[2], *out = NULL;
    int json = 0;
    size_t operands;
    const struct option_def options[] = { { .name = "-o", .text = &out, .kind = VALUE_FILE },
                                          { .name = "--json", .flag = &json } };
    static const struct operand_def taken[] = { { .words = verbs }, { .kind = VALUE_FILE } };
    enum { OPTIONS = sizeof options / sizeof *options };
    struct option_def own[OPTIONS];
    const int first = find_word(argc, argv, verbs);
    struct command_syntax syntax = *COMMAND_SYNTAX(options, first < 0 ? help : verb_defs[first].help, taken);
    if (first >= 0) {
        syntax.options = own;
        syntax.option_count = choose_options(options, OPTIONS, verb_defs[first].options, own);
        complain_as("record", verb_defs[first].typed);
    }
    int status = parse_options(argc, argv, &syntax, operand, 2, &operands);
    if (status >= 0)
        return status;
    const int verb = operands == 2 ? word_index(operand[0], verbs) : -1;
    if (operands && word_index(operand[0], verbs) < 0)
        return complain_of_word("record", "what to do", operand[0], verbs);
    if (verb < 0 && !operands)
        return complain("record", "info FILE.dpr, or csv FILE.dpr -o OUT.csv is needed (see --help)");
    if (verb < 0 || (verb == 1) != (out != NULL))
        return complain("record", "FILE.dpr%s is needed (see --help)", first == 1 ? ", and -o OUT.csv," : "");
    if (out && (output_check("record", out, (const char *const[]){ operand[1], NULL }) ||
                output_check_name("record", out, ".csv .txt", "a table of comma-separated values")))
        return 2;
    struct recording_file recording;
    status = recording_open(&recording, "record", operand[1]);
    if (status == 0)
        status = verb == 0 ? info(&recording, operand[1], json) : write_csv(&recording, operand[1], out);
    recording_close(&recording);
    return status;
}
