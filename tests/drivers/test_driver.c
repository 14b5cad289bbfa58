/* SPDX-License-Identifier: BSD-3-Clause */
/* The registry, drivers from outside, wrong arguments, and that docs/faults.md leaves no reason out. */
#include <math.h>

#include "drivers/open_device.h"
#include "dynpoint/driver.h"

/* A driver that remembers how it was called. */
struct probe {
    dpt_device device;
    dpt_wrench written;
    int writes, closes;
    dpt_result answer;
    char where[32];
    int knows_where;
    uint32_t reasons;
};

static struct probe probe;

static dpt_result probe_open(const dpt_driver *driver, const char *where, dpt_device **device, dpt_device_error *error)
{
    (void)driver, (void)error;
    probe.knows_where = where != NULL;
    snprintf(probe.where, sizeof probe.where, "%s", where ? where : "");
    if (probe.answer == DPT_OK)
        *device = &probe.device;
    return probe.answer == DPT_E_DEVICE ? DPT_OK : probe.answer;
}

static void probe_info(const dpt_device *device, dpt_device_info *info)
{
    (void)device;
    CHECK(info->rate == 0.0, "info comes with old numbers");
    info->rate = 2000.0;
}

static dpt_result probe_read(dpt_device *device, dpt_device_state *state)
{
    (void)device;
    memset(state, 0, sizeof *state);
    state->fresh = 3;
    state->status = DPT_DEVICE_STATUS_READY;
    state->reasons = probe.reasons;
    return probe.answer;
}

static dpt_result probe_write(dpt_device *device, const dpt_wrench *wrench)
{
    (void)device;
    probe.written = *wrench;
    probe.writes++;
    return probe.answer;
}

static dpt_result probe_clear(dpt_device *device)
{
    (void)device;
    return probe.answer;
}

static void probe_counts(const dpt_device *device, dpt_device_counts *counts)
{
    (void)device;
    counts->resets = 9;
}

static void probe_close(dpt_device *device)
{
    (void)device;
    probe.closes++;
}

static const dpt_driver probe_driver = {
    .size = sizeof(dpt_driver),
    .version = DPT_DRIVER_VERSION,
    .name = "probe",
    .about = "a test's own",
    .open = probe_open,
    .info = probe_info,
    .read = probe_read,
    .write = probe_write,
    .clear = probe_clear,
    .counts = probe_counts,
    .close = probe_close,
};

static void a_driver_from_outside_is_used(void)
{
    dpt_device *device;
    dpt_device_info info = { .size = sizeof info, .rate = 5.0 };
    dpt_device_state state = { .size = sizeof state };
    dpt_device_counts counts = { .size = sizeof counts, .samples = 4 };
    dpt_wrench wrench = { { 1.0, 2.0, 3.0 }, { 0.1, 0.2, 0.3 } };
    memset(&probe, 0, sizeof probe);
    CHECK(dpt_device_open_with(&probe_driver, "here?x=1", &device, NULL) == DPT_OK && device == &probe.device, "open");
    CHECK(device->driver == &probe_driver && !strcmp(probe.where, "here?x=1"), "%s", probe.where);
    CHECK(dpt_device_get_info(device, &info) == DPT_OK && info.rate == 2000.0, "info");
    CHECK(dpt_device_get_counts(device, &counts) == DPT_OK && counts.samples == 0 && counts.resets == 9, "counts");
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.fresh == 3 && state.size == sizeof state, "read");
    CHECK(dpt_device_write(device, &wrench) == DPT_OK && !memcmp(&probe.written, &wrench, sizeof wrench), "write");
    wrench.torque[2] = NAN;
    CHECK(dpt_device_write(device, &wrench) == DPT_E_FINITE && probe.written.force[0] == 0.0 &&
              probe.written.torque[0] == 0.0 && probe.writes == 2,
          "NaN went through");
    static const dpt_result answers[] = { DPT_E_LOST, DPT_E_BUSY, DPT_E_NOT_READY, DPT_E_SYSTEM };
    for (int i = 0; i < 4; i++) {
        probe.answer = answers[i];
        wrench.torque[2] = 0.0;
        CHECK(dpt_device_read(device, &state) == answers[i] && state.fresh == 0, "fresh with %d", answers[i]);
        CHECK((state.status == DPT_DEVICE_STATUS_LOST) == (answers[i] == DPT_E_LOST), "status with %d", answers[i]);
        CHECK(dpt_device_write(device, &wrench) == answers[i] && dpt_device_clear(device) == answers[i], "%d",
              answers[i]);
    }
    dpt_device_close(device);
    dpt_device_close(NULL);
    CHECK(probe.closes == 1, "%d closes", probe.closes);
    probe.answer = DPT_OK;
    CHECK(dpt_device_open_with(&probe_driver, "", &device, NULL) == DPT_OK && !probe.knows_where, "an empty place");
}

static void incomplete_drivers_are_refused(void)
{
    dpt_device *device;
    dpt_device_error error = { .size = sizeof error };
    memset(&probe, 0, sizeof probe);
    for (int i = 0; i < 10; i++) {
        dpt_driver driver = probe_driver;
        if (i == 0)
            driver.size = offsetof(dpt_driver, steer) - 1;
        if (i == 1)
            driver.version++;
        if (i == 2)
            driver.name = NULL;
        if (i == 3)
            driver.open = NULL;
        if (i == 4)
            driver.info = NULL;
        if (i == 5)
            driver.read = NULL;
        if (i == 6)
            driver.write = NULL;
        if (i == 7)
            driver.clear = NULL;
        if (i == 8)
            driver.counts = NULL;
        if (i == 9)
            driver.close = NULL;
        device = &probe.device;
        CHECK(dpt_device_open_with(&driver, NULL, &device, &error) == DPT_E_UNSUPPORTED && !device, "case %d", i);
        CHECK(error.code == DPT_E_UNSUPPORTED && error.text[0], "case %d: %s", i, error.text);
    }
    probe.answer = DPT_E_DEVICE;
    CHECK(dpt_device_open_with(&probe_driver, NULL, &device, &error) == DPT_E_DEVICE && !device,
          "success without a device: %s", error.text);
    probe.answer = DPT_E_PERMISSION;
    CHECK(dpt_device_open_with(&probe_driver, NULL, &device, &error) == DPT_E_PERMISSION &&
              !strcmp(error.text, dpt_result_text(DPT_E_PERMISSION)) && error.code == DPT_E_PERMISSION,
          "a driver without words: %s", error.text);
}

static void names_choose_a_driver(void)
{
    dpt_device *device;
    dpt_device_error error = { .size = sizeof error };
    uint32_t count = 0;
    for (const dpt_driver *driver; (driver = dpt_driver_get(count)) != NULL; count++) {
        CHECK(dpt_driver_find(driver->name) == driver && driver->about[0], "%s", driver->name);
        CHECK(!strchr(driver->name, ':') && !strchr(driver->about, '\n'), "%s", driver->name);
    }
    CHECK(count >= 2 && !dpt_driver_get(count + 1) && !dpt_driver_get(UINT32_MAX), "%u drivers", count);
    CHECK(!dpt_driver_find("si") && !dpt_driver_find("sim:") && !dpt_driver_find("") && !dpt_driver_find(NULL),
          "no such driver");
    static const char *const wrong[] = { "", ":", "si", "simm", "nonesuch:/dev/x", "SIM" };
    for (int i = 0; i < 6; i++) {
        CHECK(dpt_device_open(wrong[i], &device, &error) == DPT_E_UNSUPPORTED && !device, "'%s'", wrong[i]);
        CHECK(strstr(error.text, "no driver"), "'%s': %s", wrong[i], error.text);
    }
    CHECK(dpt_device_open(NULL, &device, &error) == DPT_E_ARGUMENT, "NULL");
    CHECK(dpt_device_open("sim", NULL, &error) == DPT_E_ARGUMENT, "no place for it");
    CHECK(dpt_device_open_with(NULL, NULL, &device, &error) == DPT_E_ARGUMENT, "no driver");
    error.size = 4;
    CHECK(dpt_device_open("sim", &device, &error) == DPT_E_SIZE, "an error of another size");
    CHECK(dpt_device_open_with(&probe_driver, NULL, &device, &error) == DPT_E_SIZE, "an error of another size");
}

static double mass_of(const char *where, const char *path)
{
    dpt_device_info info = { .size = sizeof info };
    dpt_device *device = device_named(where, path);
    CHECK(dpt_device_get_info(device, &info) == DPT_OK, "no info");
    dpt_device_close(device);
    return info.mass;
}

/* One file for all that was measured of a device, and calibrated. */
static void settings_come_from_a_file(void)
{
    const struct small_file file = file_with("# measured\nmass=0.25\nmass_low=0.2\nmass_high=0.3\n\ndamping=2\r\n");
    CHECK(mass_of("sim:?settings=%s", file.path) == 0.25, "%g kg", mass_of("sim:?settings=%s", file.path));
    CHECK(mass_of("sim:?settings=%s&mass=0.5", file.path) == 0.5, "what comes later counts");
    CHECK(mass_of("sim:?mass=0.5&settings=%s", file.path) == 0.25, "what comes later counts");
    unlink(file.path);
    const struct {
        const char *text, *reason;
        dpt_result code;
    } wrong[] = {
        { "mass=0.2\nweight=1\n", ": line 2: no setting 'weight'", DPT_E_SETTING },
        { "mass=heavy\n", ": line 1: mass: 'heavy' is not a number", DPT_E_SETTING },
        { "mass=1000\n", ": line 1: mass is not within", DPT_E_SETTING },
        { "settings=other\n", ": line 1: no setting 'settings'", DPT_E_SETTING },
        { "mass\n", ": line 1: the setting 'mass' needs a value", DPT_E_SETTING },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const struct small_file bad = file_with(wrong[i].text);
        char name[128];
        dpt_device *device;
        dpt_device_error error = { .size = sizeof error };
        snprintf(name, sizeof name, "sim:?settings=%s", bad.path);
        CHECK(dpt_device_open(name, &device, &error) == wrong[i].code && strstr(error.text, wrong[i].reason) &&
                  strstr(error.text, bad.path),
              "case %zu: %s", i, error.text);
        unlink(bad.path);
        CHECK(dpt_device_open(name, &device, &error) == DPT_E_OPEN && strstr(error.text, "it cannot be opened"),
              "no file: %s", error.text);
    }
}

static void wrong_arguments_are_codes(void)
{
    dpt_device *device = device_named("sim:");
    dpt_device_info info = { .size = 4 };
    dpt_device_state state = { .size = 4 };
    dpt_device_counts counts = { .size = 4 };
    dpt_wrench wrench = { { 0.0 }, { 0.0 } };
    CHECK(dpt_device_get_info(device, &info) == DPT_E_SIZE && dpt_device_read(device, &state) == DPT_E_SIZE &&
              dpt_device_get_counts(device, &counts) == DPT_E_SIZE,
          "sizes");
    CHECK(dpt_device_get_info(device, NULL) == DPT_E_ARGUMENT && dpt_device_get_info(NULL, &info) == DPT_E_ARGUMENT,
          "info");
    CHECK(dpt_device_read(device, NULL) == DPT_E_ARGUMENT && dpt_device_read(NULL, &state) == DPT_E_ARGUMENT, "read");
    CHECK(dpt_device_write(device, NULL) == DPT_E_ARGUMENT && dpt_device_write(NULL, &wrench) == DPT_E_ARGUMENT,
          "write");
    CHECK(dpt_device_get_counts(device, NULL) == DPT_E_ARGUMENT &&
              dpt_device_get_counts(NULL, &counts) == DPT_E_ARGUMENT && dpt_device_clear(NULL) == DPT_E_ARGUMENT,
          "counts, clear");
    dpt_device_close(device);
    CHECK(!strcmp(dpt_device_status_name(DPT_DEVICE_STATUS_READY), "ready") &&
              !strcmp(dpt_device_status_name(DPT_DEVICE_STATUS_LOST), "lost") &&
              !strcmp(dpt_device_status_name(4), "?"),
          "names of statuses");
    CHECK(!dpt_device_reason_name(0) && !dpt_device_reason_name(1u << 31), "names of no reason");
    CHECK(!strcmp(dpt_device_reason_name(DPT_REASON_ESTOP | DPT_REASON_DEVICE), "estop"), "the lowest bit");
}

struct finding {
    int count;
};

/* Of firmware that is newer, say: the header's way to print all of them must not meet a name that is not there. */
static void reasons_without_a_name_are_the_devices_own(void)
{
    dpt_device *device;
    dpt_device_state state = { .size = sizeof state };
    probe.answer = DPT_OK;
    CHECK(dpt_device_open_with(&probe_driver, NULL, &device, NULL) == DPT_OK, "open");
    probe.reasons = DPT_REASON_ESTOP | DPT_REASON_DOCKED;
    CHECK(dpt_device_read(device, &state) == DPT_OK && state.reasons == probe.reasons, "%x", state.reasons);
    for (uint32_t bit = 2u * DPT_REASON_DOCKED; bit; bit <<= 1) {
        probe.reasons = DPT_REASON_ESTOP | bit;
        CHECK(dpt_device_read(device, &state) == DPT_OK && state.reasons == (DPT_REASON_ESTOP | DPT_REASON_DEVICE),
              "%x of %x", state.reasons, probe.reasons);
        for (uint32_t left = state.reasons; left; left &= left - 1)
            CHECK(dpt_device_reason_name(left) != NULL, "%x has no name", left);
    }
    probe.reasons = 0;
    dpt_device_close(device);
}

static void found_one(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    struct finding *finding = user;
    dpt_device *device;
    CHECK(where && about && about[0], "%s: found without words", driver->name);
    CHECK(dpt_device_open_with(driver, where, &device, NULL) == DPT_OK, "%s:%s does not open", driver->name, where);
    dpt_device_close(device);
    finding->count++;
}

static void what_sim_finds_opens(void)
{
    struct finding finding = { 0 };
    const dpt_driver *sim = dpt_driver_find("sim");
    sim->find(sim, found_one, &finding);
    CHECK(finding.count == 1, "%d found", finding.count);
}

static char *whole_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL, "no %s: run from the repository's root", path);
    if (!file)
        return NULL;
    char *text = calloc(1, 1 << 20);
    size_t size = fread(text, 1, (1 << 20) - 1, file);
    CHECK(size > 0, "%s is empty", path);
    fclose(file);
    return text;
}

/* 1 when `text` has a row "| `name` | ..." that names a test which is there. */
static int has_row(char *text, const char *name)
{
    char start[96];
    snprintf(start, sizeof start, "\n| `%s` |", name);
    char *row = strstr(text, start);
    if (!row)
        return 0;
    char *end = strchr(row + 1, '\n'), *test = strstr(row, "`test_");
    if (!test || !end || test > end)
        return 0;
    char program[58] = "", file[96], function[64] = "";
    if (sscanf(test, "`%57[a-z_]: %63[a-z_]`", program, function) != 2)
        return 0;
    snprintf(file, sizeof file, "tests/drivers/%s.c", program);
    char *source = whole_file(file);
    snprintf(start, sizeof start, "TEST(%s)", function);
    int found = source && strstr(source, start) != NULL;
    free(source);
    return found;
}

/* The header's names, not a list of them here: a new bit without a row fails. */
static void the_fault_table_has_every_reason(void)
{
    char *header = whole_file("include/dynpoint/device.h"), *page = whole_file("docs/faults.md");
    int count = 0;
    for (char *at = header; at && page && (at = strstr(at, "    DPT_REASON_")) != NULL; at++) {
        char name[64] = "";
        uint32_t bit = 0;
        if (sscanf(at, " %63[A-Z_] = %u", name, &bit) != 2)
            continue;
        count++;
        CHECK(has_row(page, name), "%s has no row in docs/faults.md that names a test", name);
        CHECK(dpt_device_reason_name(bit) != NULL, "%s has no name", name);
    }
    CHECK(count >= 10 && !dpt_device_reason_name(1u << count), "%d reasons", count);
    free(header);
    free(page);
}

int main(void)
{
    TEST(a_driver_from_outside_is_used);
    TEST(incomplete_drivers_are_refused);
    TEST(names_choose_a_driver);
    TEST(settings_come_from_a_file);
    TEST(wrong_arguments_are_codes);
    TEST(reasons_without_a_name_are_the_devices_own);
    TEST(what_sim_finds_opens);
    TEST(the_fault_table_has_every_reason);
    return check_report();
}
