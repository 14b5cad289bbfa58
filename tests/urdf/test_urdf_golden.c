/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Robots' descriptions as they should not be, and what surrounds the call: tests/golden-urdf, each file with its reason
 * in expected.txt; mutations; locales; memory that runs out; other threads. The argument is how many mutations.
 */
#include <dirent.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynpoint.h"
#include "dynpoint/urdf.h"
#include "lib/check.h"
#include "urdf/surroundings.h"

#define FOLDER "tests/golden-urdf/"

static char scratch[64];
static int mutations = 20000;

/* What a call came to. */
struct outcome {
    dpt_result result;
    dpt_diag diag;
    dpt_compiled compiled;
    int notes;
    uint64_t line; /* of the last one */
    int heard;     /* notes with the words asked for */
    const char *words;
};

static void hear(void *user, uint64_t line, const char *text)
{
    struct outcome *o = user;
    CHECK(line >= o->line, "a note of line %lu after one of %lu", (unsigned long)line,
          (unsigned long)o->line);
    o->line = line;
    o->notes++;
    o->heard += o->words && strstr(text, o->words) != NULL;
    CHECK(line < 100000 && text[0] && !strchr(text, '\n'), "note of line %lu: %s",
          (unsigned long)line, text);
}

static struct outcome compile_with(const char *path, const char *tool, const char *words)
{
    struct outcome o = { .diag = { .size = sizeof o.diag }, .words = words };
    dpt_urdf_def def = { .size = sizeof def, .tool = tool, .note = hear, .user = &o };
    o.result = dpt_urdf_compile_file(path, &def, &o.compiled, &o.diag);
    return o;
}

static struct outcome compile(const char *path, const char *words)
{
    return compile_with(path, NULL, words);
}

/* What must hold of any outcome, whatever the file. */
static void check_sane(const char *name, struct outcome *o)
{
    if (o->result != DPT_OK) {
        CHECK(!o->compiled.bytes && !o->compiled.size && !o->notes,
              "%s: bytes or notes of a failure", name);
        CHECK(o->diag.code == o->result && o->diag.text[0] && !strchr(o->diag.text, '\n') &&
                  memchr(o->diag.text, 0, sizeof o->diag.text),
              "%s: %d, %s", name, o->diag.code, o->diag.text);
        return;
    }
    const dpt_arm *arm;
    dpt_mesh_fault fault = { .size = sizeof fault };
    CHECK(dpt_arm_verify(o->compiled.bytes, o->compiled.size, &fault) == DPT_OK, "%s: %s", name,
          dpt_result_name(fault.code));
    CHECK(dpt_arm_open(o->compiled.bytes, o->compiled.size, &arm) == DPT_OK, "%s", name);
    dpt_compiled_free(&o->compiled);
}

struct expected {
    char name[96], code[32], words[128];
    unsigned long number;
};

/* The next line of the list that names a file; 0 at its end. */
static int next_expected(FILE *list, struct expected *e)
{
    char line[512];
    while (fgets(line, sizeof line, list)) {
        if (line[0] == '#' || line[0] == '\n')
            continue;
        if (sscanf(line, "%95s %31s %lu %127[^\n]", e->name, e->code, &e->number, e->words) == 4)
            return 1;
        CHECK(0, "%s: %s", FOLDER "expected.txt", line);
    }
    return 0;
}

/* Every file of the list; what follows a '#' in its name is the tool. How many there were. */
static int check_list(const char *list_name, const char *folder)
{
    FILE *list = fopen(list_name, "r");
    CHECK(list != NULL, "no %s", list_name);
    struct expected e;
    int count = 0;
    while (list && next_expected(list, &e)) {
        char path[1024], *tool;
        snprintf(path, sizeof path, "%s/%s", folder, e.name);
        if ((tool = strchr(path, '#')))
            *tool++ = 0;
        struct outcome o = compile_with(path, tool, e.words);
        CHECK(strcmp(dpt_result_name(o.result), e.code) == 0, "%s: %s, not %s: %s", e.name,
              dpt_result_name(o.result), e.code, o.diag.text);
        if (o.result != DPT_OK) {
            CHECK(strstr(o.diag.text, e.words) != NULL, "%s: no '%s' in '%s'", e.name, e.words,
                  o.diag.text);
            CHECK(o.diag.line == e.number, "%s: line %lu, not %lu", e.name,
                  (unsigned long)o.diag.line, e.number);
        } else {
            CHECK((unsigned long)o.notes == e.number, "%s: %d notes, not %lu", e.name, o.notes,
                  e.number);
            CHECK((o.heard > 0) == (strcmp(e.words, "-") != 0), "%s: %d notes with '%s'", e.name,
                  o.heard, e.words);
        }
        check_sane(e.name, &o);
        count++;
    }
    if (list)
        fclose(list);
    return count;
}

static void each_file_comes_to_what_is_expected(void)
{
    int count = check_list(FOLDER "expected.txt", FOLDER);
    CHECK(count > 120, "%d files", count);
}

static void robots_of_others(void)
{
    char folder[1000];
    snprintf(folder, sizeof folder, "%s/urdf", getenv("DPT_DATA"));
    int count = check_list(FOLDER "data.txt", folder);
    CHECK(count > 30, "%d robots", count);
}

static void each_file_is_listed(void)
{
    DIR *folder = opendir(FOLDER);
    CHECK(folder != NULL, "no %s", FOLDER);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        int found = !strstr(entry->d_name, ".urdf");
        FILE *list = fopen(FOLDER "expected.txt", "r");
        struct expected e;
        while (!found && list && next_expected(list, &e))
            found = strcmp(e.name, entry->d_name) == 0;
        if (list)
            fclose(list);
        CHECK(found, "%s is not in the list", entry->d_name);
    }
    if (folder)
        closedir(folder);
}

/* Whatever urdfdom is here: the order is told where it is likely to be the other one, or refused. */
static void quaternions_say_their_order(void)
{
    static const struct {
        const char *value;
        int notes;
    } cases[] = {
        { "0 0 0 1", 0 },   { "0 0 0 -1", 0 },   { "0.5 0.5 0.5 0.5", 0 },    { "0 1 0 0", 0 },
        { "0 0 1 0", 0 },   { "1 0 0 0", 1 },    { " -1.0  0 -0.0 0e3 ", 1 }, { "", -1 },
        { "1 0 0", -1 },    { "1 0 0 0 0", -1 }, { "1 0 0 x", -1 },           { "1,0,0,0", -1 },
        { "1 0 0 nan", -1 }
    };
    char text[512];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int notes = notes_on_quaternion(cases[i].value, text, sizeof text);
        CHECK(notes == cases[i].notes, "'%s': %d, %s", cases[i].value, notes, text);
        CHECK(!notes || (strstr(text, "joint 'j': quat_xyzw '") && strstr(text, "x y z w")), "%s",
              text);
    }
}

static void compile_all(void)
{
    FILE *list = fopen(FOLDER "expected.txt", "r");
    struct expected e;
    while (list && next_expected(list, &e)) {
        char path[128];
        snprintf(path, sizeof path, FOLDER "%s", e.name);
        struct outcome o = compile(path, NULL);
        dpt_compiled_free(&o.compiled);
    }
    if (list)
        fclose(list);
}

static void nothing_is_printed(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/printed", scratch);
    fflush(stdout);
    FILE *file = fopen(path, "w");
    int out = dup(1), err = dup(2);
    dup2(fileno(file), 1);
    dup2(fileno(file), 2);
    compile_all();
    fflush(stdout);
    fflush(stderr);
    dup2(out, 1);
    dup2(err, 2);
    close(out);
    close(err);
    long size = lseek(fileno(file), 0, SEEK_END);
    fclose(file);
    CHECK(size == 0, "%ld bytes in %s", size, path);
}

static void a_programs_log_is_left_alone(void)
{
    log_begin();
    compile_all();
    CHECK(log_is_ours(), "handler or level is another");
    CHECK(log_count() == 0, "%d messages reached it", log_count());
    CHECK(log_end(), "the handler before is another");
}

static void paths_that_are_no_files(void)
{
    const struct {
        const char *path;
        dpt_result result;
        const char *words;
    } cases[] = {
        { FOLDER, DPT_E_OPEN, "it cannot be read" },
        { FOLDER "nonesuch.urdf", DPT_E_OPEN, "it cannot be opened" },
        { "/dev/null", DPT_E_FORMAT, "the file is empty" },
        { "/dev/zero", DPT_E_LIMIT, "64 MiB" },
        { NULL, DPT_E_ARGUMENT, "no name" },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct outcome o = compile(cases[i].path, NULL);
        CHECK(o.result == cases[i].result && strstr(o.diag.text, cases[i].words), "%s: %s",
              cases[i].path ? cases[i].path : "NULL", o.diag.text);
        check_sane("path", &o);
    }
}

/* Compiled before and after; the same bytes are asked for. */
static void check_same(const char *path, const dpt_compiled *before, const char *when)
{
    struct outcome o = compile(path, NULL);
    CHECK(o.result == DPT_OK && o.compiled.size == before->size &&
              !memcmp(o.compiled.bytes, before->bytes, before->size),
          "%s, %s: %s", path, when, o.result ? o.diag.text : "other bytes");
    dpt_compiled_free(&o.compiled);
}

static void bytes_do_not_depend_on_the_locale(void)
{
    const char *path = "docs/samples/arm.urdf";
    struct outcome before = compile(path, NULL);
    CHECK(before.result == DPT_OK, "%s", before.diag.text);
    check_same(path, &before.compiled, "again");
    comma_in_cpp(1);
    check_same(path, &before.compiled, "with commas in C++");
    each_file_comes_to_what_is_expected();
    comma_in_cpp(0);

    char command[256], folder[128];
    snprintf(folder, sizeof folder, "%s/locale", scratch);
    mkdir(folder, 0777);
    snprintf(command, sizeof command,
             "localedef -i de_DE -f UTF-8 '%s/de_DE.UTF-8' >/dev/null 2>&1", folder);
    int made = system(command);
    setenv("LOCPATH", folder, 1);
    if (!setlocale(LC_ALL, "de_DE.UTF-8")) {
        SKIP("C's locale with commas", made ? "localedef could not make it" : "it is not taken");
    } else {
        char half[8];
        snprintf(half, sizeof half, "%.1f", 0.5);
        CHECK(strcmp(half, "0,5") == 0, "%s", half);
        check_same(path, &before.compiled, "with commas in C");
        each_file_comes_to_what_is_expected();
    }
    unsetenv("LOCPATH");
    setlocale(LC_ALL, "C");
    dpt_compiled_free(&before.compiled);
}

static char *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    char *bytes = malloc(1 << 16);
    CHECK(file != NULL, "%s", path);
    *size = file ? fread(bytes, 1, (1 << 16) - 1, file) : 0;
    if (file)
        fclose(file);
    return bytes;
}

/* A new file: some file systems write one to the disk at once that is cut and filled again. */
static void store(const char *path, const char *bytes, size_t size)
{
    unlink(path);
    FILE *file = fopen(path, "wb");
    fwrite(bytes, 1, size, file);
    fclose(file);
}

static void mutated_files(void)
{
    static const char *const seeds[] = { "docs/samples/arm.urdf",    FOLDER "two.urdf",
                                         FOLDER "mimic_limits.urdf", FOLDER "extensions.urdf",
                                         FOLDER "shapes_left.urdf",  FOLDER "names_escaped.urdf" };
    static const char *const pieces[] = { "<joint",
                                          "<link",
                                          "/>",
                                          ">",
                                          "<",
                                          "\"",
                                          "'",
                                          "&amp;",
                                          "%s%n",
                                          "<!--",
                                          "-->",
                                          "<![CDATA[",
                                          "?>",
                                          "</robot>",
                                          "1e308",
                                          "-1",
                                          "0",
                                          " ",
                                          "\n",
                                          "name=\"tip\"",
                                          "<mimic joint=\"elbow\"/>",
                                          "type=\"fixed\"",
                                          "type=\"continuous\"",
                                          "\xff",
                                          "" };
    char path[128];
    uint64_t state = 8;
    int taken = 0;
    snprintf(path, sizeof path, "%s/mutated.urdf", scratch);
    for (int i = 0; i < mutations; i++) {
        size_t size;
        char *bytes = load(seeds[random_bits(&state) % (sizeof seeds / sizeof *seeds)], &size);
        for (uint64_t changes = 1 + random_bits(&state) % 3; changes; changes--) {
            size_t at = random_bits(&state) % size,
                   cut = random_bits(&state) % 4
                             ? 0
                             : random_bits(&state) % (size - at < 30 ? size - at : 30);
            const char *piece = pieces[random_bits(&state) % (sizeof pieces / sizeof *pieces)];
            if (random_bits(&state) % 3 == 0) {
                bytes[at] = (char)(32 + random_bits(&state) % 96);
                continue;
            }
            size_t length = strlen(piece);
            memmove(bytes + at + length, bytes + at + cut, size - at - cut);
            memcpy(bytes + at, piece, length);
            size = size + length - cut;
        }
        store(path, bytes, size);
        free(bytes);
        struct outcome o = compile(path, NULL);
        taken += o.result == DPT_OK;
        check_sane("a mutation", &o);
    }
    CHECK(taken > mutations / 20 && taken < mutations - mutations / 20, "%d of %d are taken", taken,
          mutations);
}

static void cut_files(void)
{
    char path[128];
    size_t size;
    char *bytes = load(FOLDER "two.urdf", &size);
    const char *end = strstr(bytes, "</robot>");
    snprintf(path, sizeof path, "%s/cut.urdf", scratch);
    for (size_t length = 0; length < size; length++) {
        store(path, bytes, length);
        struct outcome o = compile(path, NULL);
        CHECK((o.result == DPT_OK) == (length >= (size_t)(end - bytes) + 8), "cut at %zu: %s",
              length, o.result ? o.diag.text : "taken");
        check_sane("a part", &o);
    }
    free(bytes);
}

/* Large in each way that an XML file can be; time and stack stay within reason. */
static void large_files(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/large.urdf", scratch);
    const struct {
        const char *begin, *part, *end, *words;
        int count;
    } cases[] = {
        { "<robot name=\"r\">", "<a>", "", "more than 64 deep", 1000000 },
        { "<robot name=\"r\">", "<a/>", "</robot>", "more than 200000 elements", 1000000 },
        { "<robot name=\"r\" ", "", "/>", "the robot has no link", 1000000 },
        { "<robot name=\"r\"><link name=\"base\"/><gazebo>", "text &amp; ", "</gazebo></robot>",
          "no joint between it and the root", 1000000 },
        { "<robot name=\"r\">", "<link name=\"%d\"/>", "</robot>", "more than 4000 links", 10000 },
        { "<robot name=\"r\"><link name=\"base\" ", "a%d=\"\" ", "/></robot>",
          "more than 1000 attributes", 10000 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        FILE *file = fopen(path, "w");
        fputs(cases[i].begin, file);
        for (int k = 0; k < cases[i].count; k++)
            fprintf(file, *cases[i].part ? cases[i].part : "\n", k);
        fputs(cases[i].end, file);
        fclose(file);
        struct outcome o = compile(path, NULL);
        CHECK(o.result != DPT_OK && strstr(o.diag.text, cases[i].words), "%s: %s", cases[i].part,
              o.diag.text);
        check_sane("a large file", &o);
    }
    FILE *file = fopen(path, "w");
    fputs("<robot name=\"chain\"><link name=\"3999\"/>", file);
    for (int k = 0; k < 3999; k++)
        fprintf(file,
                "<link name=\"%d\"/><joint name=\"%d\" type=\"%s\"><parent link=\"%d\"/>"
                "<child link=\"%d\"/></joint>",
                k, k, k == 7 ? "continuous" : "fixed", k + 1, k);
    fputs("</robot>", file);
    fclose(file);
    struct outcome o = compile(path, NULL);
    CHECK(o.result == DPT_OK, "a chain of 4000 links: %s", o.diag.text);
    check_sane("a chain", &o);
}

/* Each allocation in turn fails. */
static void memory_runs_out(void)
{
    const char *paths[] = { "docs/samples/arm.urdf", FOLDER "mimic_limits.urdf",
                            FOLDER "length_word.urdf" };
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct outcome whole = compile(paths[i], NULL);
        int ended = 0, starved = 0;
        for (long grants = 0; !ended && grants < 100000; grants++) {
            dpt_diag diag = { .size = sizeof diag };
            dpt_compiled compiled;
            long blocks = blocks_in_c;
            allocations_left = grants;
            dpt_result result = dpt_urdf_compile_file(paths[i], NULL, &compiled, &diag);
            ended = allocations_left > 0;
            allocations_left = -1;
            starved += result == DPT_E_MEMORY;
            if (result == DPT_OK)
                CHECK(compiled.size == whole.compiled.size &&
                          !memcmp(compiled.bytes, whole.compiled.bytes, compiled.size),
                      "%s: other bytes after %ld allocations", paths[i], grants);
            else
                CHECK(!compiled.bytes && diag.code == result && diag.text[0],
                      "%s: %ld allocations: %s", paths[i], grants, diag.text);
            dpt_compiled_free(&compiled);
            CHECK(blocks_in_c == blocks, "%s: %ld allocations: %ld blocks are left", paths[i],
                  grants, blocks_in_c - blocks);
        }
        CHECK(ended && starved > 100, "%s: starved %d times", paths[i], starved);
        dpt_compiled_free(&whole.compiled);
    }
}

static void *compile_often(void *unused)
{
    int wrong = 0;
    for (int i = 0; i < 200; i++) {
        dpt_diag diag = { .size = sizeof diag };
        dpt_compiled compiled;
        if (i % 2)
            wrong += dpt_urdf_compile_file(FOLDER "two.urdf", NULL, &compiled, &diag) != DPT_OK;
        else
            wrong +=
                dpt_urdf_compile_file(FOLDER "cone.urdf", NULL, &compiled, &diag) != DPT_E_SYNTAX ||
                !strstr(diag.text, "'cone'");
        log_something();
        dpt_compiled_free(&compiled);
    }
    (void)unused;
    return wrong ? scratch : NULL;
}

static void threads_do_not_mix(void)
{
    pthread_t threads[4];
    log_begin();
    for (int i = 0; i < 4; i++)
        pthread_create(&threads[i], NULL, compile_often, NULL);
    for (int i = 0; i < 4; i++) {
        void *wrong;
        pthread_join(threads[i], &wrong);
        CHECK(!wrong, "thread %d had another's answer", i);
    }
    CHECK(log_is_ours() && log_count() == 0, "%d messages at level none", log_count());
    CHECK(log_end(), "the handler before is another");
}

int main(int argc, char **argv)
{
    if (argc > 1)
        mutations = atoi(argv[1]);
    snprintf(scratch, sizeof scratch, "build/tests/urdf.%ld", (long)getpid());
    mkdir("build", 0777);
    mkdir("build/tests", 0777);
    if (mkdir(scratch, 0777) != 0) {
        printf("  FAIL %s cannot be made\n", scratch);
        return 1;
    }
    TEST(each_file_comes_to_what_is_expected);
    TEST(each_file_is_listed);
    TEST(quaternions_say_their_order);
    if (getenv("DPT_DATA"))
        TEST(robots_of_others);
    else
        SKIP("robots of others", "no DPT_DATA");
    TEST(nothing_is_printed);
    TEST(a_programs_log_is_left_alone);
    TEST(paths_that_are_no_files);
    TEST(bytes_do_not_depend_on_the_locale);
    TEST(cut_files);
    TEST(mutated_files);
    TEST(large_files);
    TEST(memory_runs_out);
    TEST(threads_do_not_mix);
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", scratch);
    if (system(command) != 0)
        printf("  %s is left\n", scratch);
    return check_report();
}
