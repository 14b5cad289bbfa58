/* SPDX-License-Identifier: BSD-3-Clause */
/* Device dynamics from a file: what is named is replaced, and what is wrong is named. */
#include "drivers/open_device.h"
#include "dynpoint/identify.h"
#include "lib/size_checks.h"

static dpt_result read_text(const char *text, dpt_device_info *info, dpt_device_error *error)
{
    const struct small_file file = file_with(text);
    const dpt_result result = dpt_device_dynamics_read(file.path, info, error);
    CHECK(result == DPT_OK || strstr(error->text, file.path), "'%s' names no file", error->text);
    unlink(file.path);
    return result;
}

static dpt_device_info some_info(void)
{
    return (
        dpt_device_info){ .size = sizeof(dpt_device_info), .rate = 1000.0, .mass = 7.0, .friction = 8.0, .delay = 9.0 };
}

static void what_is_named_is_replaced(void)
{
    dpt_device_info info = some_info();
    dpt_device_error error = { .size = sizeof error };
    CHECK(read_text("# a device\n\nmass=0.045\nmass_low=0.044\nmass_high=0.046\r\nfriction=0\n"
                    "inertia=1e-4\nspin_damping=2e-3 \ndamping=0.5\ndamping_high=0.6\n"
                    "spin_friction=0.001\nposition_step=5.5e-05\nangle_step=0.002",
                    &info, &error) == DPT_OK &&
              error.code == DPT_OK,
          "%s", error.text);
    CHECK(info.mass == 0.045 && info.friction == 0.0 && info.inertia == 1e-4 && info.spin_damping == 2e-3 &&
              info.damping == 0.5 && info.spin_friction == 0.001 && info.position_step == 5.5e-5 &&
              info.angle_step == 0.002,
          "%g kg, %g N", info.mass, info.friction);
    CHECK(info.delay == 9.0 && info.rate == 1000.0, "%g s: it was not named", info.delay);
}

static void what_is_wrong_is_named(void)
{
    static char long_line[700], long_comment[700];
    static const struct {
        const char *text, *reason;
    } cases[] = {
        { "mass=0.1\nweight=3\n", "line 2: 'weight' is no name" },
        { "mass\n", "line 1: 'mass' is not name=value" },
        { "\n\nmass=a lot\n", "line 3: 'a lot' is not a number" },
        { "mass=\n", "is not a number" },
        { "mass=nan\n", "is not a number" },
        { "mass=-1\n", "line 1: 'mass=-1' is out of range" },
        { "mass=101\n", "is out of range" },
        { "delay=2\n", "is out of range" },
        { "mass=1\n#\nmass=1\n", "line 3: 'mass' comes twice" },
        { "mass=1\nmass_low=2\n", "mass is not within its interval" },
        { "mass=1\nmass_high=0.5\n", "mass is not within its interval" },
        { "damping_low=1\n", "damping is not within its interval" },
        { "mass_lower=1\n", "is no name" },
        { "rate=1000\n", "is no name" },
        { " mass=1\n", "is no name" },
        { long_line, "is too long" },
    };
    memset(long_line, '1', sizeof long_line - 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        dpt_device_info info = some_info(), before = some_info();
        dpt_device_error error = { .size = sizeof error };
        CHECK(read_text(cases[i].text, &info, &error) == DPT_E_SYNTAX && error.code == DPT_E_SYNTAX &&
                  strstr(error.text, cases[i].reason),
              "case %d: %s", (int)i, error.text);
        CHECK(!memcmp(&info, &before, sizeof info), "case %d: the info changed", (int)i);
    }
    dpt_device_info info = some_info();
    dpt_device_error error = { .size = sizeof error };
    memset(long_comment, '#', sizeof long_comment - 1);
    CHECK(read_text(long_comment, &info, &error) == DPT_OK, "a long comment: %s", error.text);
}

static void files_that_are_none_are_refused(void)
{
    dpt_device_info info = some_info();
    dpt_device_error error = { .size = sizeof error };
    CHECK(dpt_device_dynamics_read("/nowhere/device.txt", &info, &error) == DPT_E_OPEN &&
              strstr(error.text, "/nowhere/device.txt: it cannot be opened"),
          "%s", error.text);
    CHECK(dpt_device_dynamics_read("/tmp", &info, &error) == DPT_E_OPEN, "a folder: %s", error.text);
    CHECK(dpt_device_dynamics_read(NULL, &info, &error) == DPT_E_ARGUMENT &&
              dpt_device_dynamics_read("/tmp", NULL, NULL) == DPT_E_ARGUMENT,
          "NULL");
    char *much = malloc(70001);
    for (int i = 0; i < 70000; i++)
        much[i] = i % 100 == 99 ? '\n' : '#';
    much[70000] = '\0';
    CHECK(read_text(much, &info, &error) == DPT_E_LIMIT, "%s", error.text);
    memset(much, '#', 70000);
    CHECK(read_text(much, &info, &error) == DPT_E_LIMIT, "one line: %s", error.text);
    free(much);
}

static struct small_file good_file;

static dpt_result info_of_any_size(void *info)
{
    return dpt_device_dynamics_read(good_file.path, info, NULL);
}

static dpt_result error_of_any_size(void *error)
{
    dpt_device_info info = some_info();
    return dpt_device_dynamics_read(good_file.path, &info, error);
}

static void structs_of_any_size(void)
{
    const dpt_device_info good = some_info();
    const struct sized of_info = { "dpt_device_info", sizeof good, sizeof good, info_of_any_size };
    const struct sized of_error = { "dpt_device_error", sizeof(dpt_device_error), sizeof(dpt_device_error),
                                    error_of_any_size };
    good_file = file_with("mass=1\n");
    check_input(&of_info, &good);
    check_output(&of_error);
    unlink(good_file.path);
}

int main(void)
{
    TEST(what_is_named_is_replaced);
    TEST(what_is_wrong_is_named);
    TEST(files_that_are_none_are_refused);
    TEST(structs_of_any_size);
    return check_report();
}
