/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Opening devices by OpenHaptics: the loader, and each way in which a device does not open, with what is said of it. The
 * library is a stand-in (tests/drivers/hd); first the loader's failures, as a process loads one for good.
 */
#include "drivers/hd/host.h"

#include "drivers/dynamics_checks.h"

#include <sys/wait.h>

static const char *program;

static void refused_by(const char *name, dpt_result code, const char *word, const char *cure)
{
    device = (dpt_device *)&error;
    const dpt_result result = dpt_device_open(name, &device, &error);
    CHECK(result == code && error.code == code && !device, "%s: %d: %s", name, result, error.text);
    CHECK(strstr(error.text, word) && strstr(error.text, cure), "%s: '%s' lacks '%s' or '%s'", name, error.text, word,
          cure);
    CHECK(strlen(error.text) < sizeof error.text - 1, "cut off: %s", error.text);
}

static const char *all_absent(const char *name)
{
    static char text[128];
    snprintf(text, sizeof text, "%s: cannot open shared object file: No such file or directory", name);
    return text;
}

static const char *third_needs_another(const char *name)
{
    return strcmp(name, "libHD.so.3.0") ? all_absent(name)
                                        : "libncurses.so.5: cannot open shared object file: No such file or directory";
}

static const char *second_is_broken(const char *name)
{
    return !strcmp(name, "libHD.so.3.4") ? "libHD.so.3.4: invalid ELF header" : all_absent(name);
}

static const char *of_another_version(const char *name)
{
    return strcmp(name, "libHD.so") ? all_absent(name) : "/usr/lib/libHD.so: undefined symbol: _ZN4phio4openEv";
}

static const char *driver_is_absent(const char *name)
{
    (void)name;
    return "libPhantomIOLib42.so: cannot open shared object file: No such file or directory";
}

static const char *something_is_absent(const char *name)
{
    (void)name;
    return "libsomething.so.1: cannot open shared object file: No such file or directory";
}

static void without_a_library_it_says_what_to_install(void)
{
    const struct {
        const char *(*refuse)(const char *name);
        const char *word, *cure, *tried;
    } cases[] = {
        { all_absent, "not installed", "developer edition", "libHD.so libHD.so.3.4 libHD.so.3.0 " },
        { third_needs_another, "libHD.so.3.0 is here, but not libncurses.so.5", "libncurses5",
          "libHD.so libHD.so.3.4 libHD.so.3.0 " },
        { second_is_broken, "libHD.so.3.4 cannot be loaded: libHD.so.3.4: invalid ELF header", "",
          "libHD.so libHD.so.3.4 libHD.so.3.0 " },
        { of_another_version, "not of one version", "install two that belong together",
          "libHD.so libHD.so.3.4 libHD.so.3.0 " },
        { driver_is_absent, "libHD.so is here, but not libPhantomIOLib42.so", "install the device driver",
          "libHD.so libHD.so.3.4 libHD.so.3.0 " },
        { something_is_absent, "libsomething.so.1", "the package that has it", "libHD.so libHD.so.3.4 libHD.so.3.0 " },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        host.refuse = cases[i].refuse;
        host.tried[0] = '\0';
        refused_by("openhaptics", DPT_E_UNSUPPORTED, cases[i].word, cases[i].cure);
        CHECK(!strcmp(host.tried, cases[i].tried), "tried %s", host.tried);
        CHECK(host.flags == (RTLD_NOW | RTLD_GLOBAL), "flags %x", host.flags);
    }
    /* One that is named is the only one: by a setting, else by the environment. */
    host.refuse = all_absent;
    host.tried[0] = '\0';
    host.library = "/opt/a/libHD.so";
    refused_by("openhaptics", DPT_E_UNSUPPORTED, "there is no library /opt/a/libHD.so", "DPT_HD_LIBRARY");
    refused_by("openhaptics:?library=/opt/b.so", DPT_E_UNSUPPORTED, "/opt/b.so", "library=");
    host.library = "";
    refused_by("openhaptics", DPT_E_UNSUPPORTED, "not installed", "3D Systems");
    CHECK(!strcmp(host.tried, "/opt/a/libHD.so /opt/b.so libHD.so libHD.so.3.4 libHD.so.3.0 "), "tried %s", host.tried);
    host.library = NULL;
    host.refuse = NULL;
}

/* Real files that the real loader refuses, or that are something else. */
static void libraries_that_do_not_load(void)
{
    const struct {
        const char *file, *word, *cure;
    } cases[] = { { "libHD-empty.so", "has no hdInitDevice", "older than 3.0" },
                  { "libHD-lonely.so", "but not libPHANToMIO.so.4", "install the device driver" },
                  { "libHD-mismatched.so", "phantom_driver_of_another_version", "belong together" },
                  { "libHD-none.so", "there is no library", "leave library=" },
                  { "drivers/test_openhaptics_open.o", "cannot be loaded", "test_openhaptics_open.o" } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char name[512];
        snprintf(name, sizeof name, "openhaptics:?library=%s", beside(program, cases[i].file));
        refused_by(name, DPT_E_UNSUPPORTED, cases[i].word, cases[i].cure);
    }
}

static void no_function_may_lack(void)
{
    static const char *const names[] = {
#define REQUIRED(result, name, arguments) #name,
#define OPTIONAL(result, name, arguments)
        HD_FUNCTIONS(REQUIRED, OPTIONAL)
#undef REQUIRED
#undef OPTIONAL
    };
    char name[512];
    snprintf(name, sizeof name, "openhaptics:?library=%s", library_path);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        host.lacks = names[i];
        refused_by(name, DPT_E_UNSUPPORTED, names[i], "not OpenHaptics, or older than 3.0");
    }
    host.lacks = NULL;
    CHECK(sizeof names / sizeof *names >= 21, "%d functions", (int)(sizeof names / sizeof *names));
}

/* In a process of its own, where nothing is loaded yet: by the environment, and without what 3.0 has not. */
static void an_older_library_will_do(void)
{
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        static char path[256];
        take_stand_in(program, "libHD-3.0.so");
        snprintf(path, sizeof path, "%s", library_path);
        host.library = path;
        host.tried[0] = '\0';
        renew();
        lib->unsupported[0] = HD_CALIBRATION_STYLE;
        const dpt_result result = dpt_device_open("openhaptics", &device, &error);
        CHECK(result == DPT_OK && strstr(host.tried, path), "%s", error.text);
        if (result == DPT_OK) {
            CHECK(dpt_device_read(device, &state) == DPT_OK && state.status == DPT_DEVICE_STATUS_READY, "%s",
                  dpt_device_status_name(state.status));
            dpt_device_close(device);
        }
        CHECK(lib->violations == 0, "%s", lib->violation);
        fflush(stdout);
        _exit(check_bad != 0 || result != DPT_OK);
    }
    int status = 1;
    CHECK(waitpid(child, &status, 0) == child && status == 0, "status %d", status);
}

/* Open, where it cannot be; the stand-in's next fault is set before. */
static void refused(const char *name, const char *settings, dpt_result code, const char *word, const char *cure)
{
    char text[512];
    snprintf(text, sizeof text, "openhaptics:%s?library=%s%s", name, library_path, settings);
    refused_by(text, code, word, cure);
    CHECK(!there->is_open && !left->is_open && lib->violations == 0, "%s: open, or %s", word, lib->violation);
    renew();
}

static void a_device_that_is_not_there_has_a_cure(void)
{
    host.gtdd_home = "/home/someone/.3dsystems";
    there->is_plugged = 0;
    refused("", "", DPT_E_DEVICE, "no device answers", "has it power and cable");
    CHECK(!strstr(error.text, "GTDD_HOME"), "%s", error.text);
    host.gtdd_home = NULL;
    there->is_plugged = 0;
    refused("", "", DPT_E_DEVICE, "GTDD_HOME is not set", "log in again");
    refused("Default PHANToM", "", DPT_E_DEVICE, "no device of the name 'Default PHANToM'", "openhaptics alone");
    static const char *const ports[] = { "/dev/ttyACM0", "/dev/ttyACM15", "/dev/hidraw3" };
    for (int i = 0; i < 3; i++) {
        host.forbidden = ports[i];
        there->is_plugged = 0;
        refused(i ? "" : "Nobody", "", DPT_E_PERMISSION, ports[i], "usermod -aG dialout,plugdev");
    }
    host.forbidden = NULL;
    lib->fail_init = HD_DEVICE_ALREADY_INITIATED;
    refused("", "", DPT_E_DEVICE, "open already", "close it there");
    for (int i = 0; i < 2; i++) {
        lib->fail_init = i ? HD_COMM_CONFIG_ERROR : HD_COMM_ERROR;
        refused("", "", DPT_E_DEVICE, "the line to the device fails (0x30", "another port");
    }
    lib->fail_init = HD_INVALID_LICENSE;
    refused("", "", DPT_E_UNSUPPORTED, "no valid licence", "install");
    lib->fail_init = HD_BAD_HANDLE;
    refused("", "", DPT_E_DEVICE, "an error of the stand-in (0x104, -7)", "");

    /* After an open that failed the next may seem to work. */
    lib->goes_stale = 1;
    char text[512];
    snprintf(text, sizeof text, "openhaptics:Nobody?library=%s", library_path);
    refused_by(text, DPT_E_DEVICE, "no device of the name", "");
    refused("", "", DPT_E_DEVICE, "0x7f3a11c0, which is no device", "start it again");

    renew();
}

static void a_device_of_another_kind_has_a_cure(void)
{
    static const unsigned rates[] = { HD_INVALID_VALUE, HD_TIMER_ERROR, HD_INVALID_OPERATION };
    for (int i = 0; i < 3; i++) {
        lib->fail_rate = rates[i];
        refused("", "&rate=1000", DPT_E_SETTING, "refuses 1000 Hz", "without rate=");
    }
    refused("", "&rate=1234", DPT_E_SETTING, "refuses 1234 Hz", "500, 1000 or 2000");

    static const unsigned needed[] = { HD_INPUT_DOF, HD_OUTPUT_DOF, HD_NOMINAL_MAX_FORCE };
    for (int i = 0; i < 3; i++) {
        lib->unsupported[0] = needed[i];
        refused("", "", DPT_E_DEVICE, "does not say what it can do", "one version");
    }
    lib->unsupported[0] = HD_USABLE_WORKSPACE_DIMENSIONS;
    lib->unsupported[1] = HD_MAX_WORKSPACE_DIMENSIONS;
    refused("", "", DPT_E_DEVICE, "does not say what it can do", "one version");
    there->force_max = NAN;
    refused("", "", DPT_E_DEVICE, "does not say what it can do", "one version");
    there->inputs = 2;
    refused("", "", DPT_E_DEVICE, "does not say what it can do", "one version");
    there->workspace[3] = -90.0;
    refused("", "", DPT_E_DEVICE, "does not say what it can do", "one version");
    renew();
}

static void a_device_that_does_not_start_has_a_cure(void)
{
    there->styles = HD_CALIBRATION_ENCODER_RESET;
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    there->resists = 1;
    refused("", "", DPT_E_NOT_READY, "not calibrated", "reset position");

    lib->fail_schedule = HD_SCHEDULER_FULL;
    refused("", "", DPT_E_DEVICE, "the scheduler of OpenHaptics", "close other");
    static const unsigned starts[] = { HD_TIMER_ERROR, HD_COMM_ERROR, HD_INVALID_LICENSE };
    for (int i = 0; i < 3; i++) {
        lib->fail_start = starts[i];
        refused("", "", i == 2 ? DPT_E_UNSUPPORTED : DPT_E_DEVICE,
                i == 0   ? "the scheduler of OpenHaptics"
                : i == 1 ? "the line to the device fails"
                         : "no valid licence",
                "");
    }
    lib->raise = HD_COMM_ERROR;
    refused("", "", DPT_E_DEVICE, "the line to the device fails", "no hub");
    lib->raise = HD_INVALID_LICENSE;
    refused("", "", DPT_E_UNSUPPORTED, "no valid licence", "install");
    lib->drops_callbacks = 1;
    refused("", "", DPT_E_DEVICE, "no sample comes", "another program");
    lib->unsupported[0] = HD_CURRENT_GIMBAL_ANGLES;
    lib->unsupported_as = HD_COMM_ERROR;
    refused("", "", DPT_E_DEVICE, "the line to the device fails", "no hub");
    /* What a device gets over by itself is no refusal. */
    lib->fail_start = HD_EXCEEDED_MAX_VELOCITY;
    char name[512];
    snprintf(name, sizeof name, "openhaptics:?library=%s", library_path);
    CHECK(dpt_device_open(name, &device, &error) == DPT_E_DEVICE && strstr(error.text, "no sample comes"), "%s",
          error.text);
    renew();
}

/* What does not say everything opens, with what it says. */
static void what_is_not_told_is_left_out(void)
{
    dpt_device_info info = { .size = sizeof info };
    static const unsigned kinds[] = { HD_NOMINAL_MAX_CONTINUOUS_FORCE, HD_NOMINAL_MAX_STIFFNESS, HD_DEVICE_MODEL_TYPE,
                                      HD_DEVICE_SERIAL_NUMBER };
    for (int i = 0; i < 4; i++)
        lib->unsupported[i] = kinds[i];
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.force_continuous == 0.0 && info.stiffness_max == 0.0 && !info.serial[0] &&
              !strcmp(info.name, "OpenHaptics device") && info.force_max == 3.3,
          "%s", info.name);
    finish();
    lib->unsupported[0] = HD_USABLE_WORKSPACE_DIMENSIONS;
    lib->unsupported[1] = HD_UPDATE_RATE;
    lib->unsupported[2] = HD_CURRENT_INKWELL_SWITCH;
    lib->unsupported[3] = HD_CALIBRATION_STYLE;
    there->in_inkwell = 1;
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.workspace_max[0] == 0.08 && info.rate == 1000.0 && state.status == DPT_DEVICE_STATUS_READY, "%g",
          info.workspace_max[0]);
    finish();
    lib->unsupported[0] = HD_CURRENT_GIMBAL_ANGLES;
    lib->unsupported[1] = HD_CURRENT_ANGULAR_VELOCITY;
    lib->unsupported[2] = HD_CURRENT_BUTTONS;
    there->buttons = 15;
    there->joints[0] = there->gimbal[0] = there->spin[0] = 1.0;
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.joints == 3 && info.buttons == 0 && info.pose_dofs == 6, "%u joints", info.joints);
    CHECK(state.status == DPT_DEVICE_STATUS_READY && state.joint[0] == 1.0 && state.joint[3] == 0.0 &&
              state.spin[0] == 0.0 && state.buttons == 0,
          "%s", dpt_device_status_name(state.status));
    finish();
    lib->unsupported[0] = HD_CURRENT_JOINT_ANGLES;
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.joints == 0 && state.status == DPT_DEVICE_STATUS_READY, "%u joints", info.joints);
    finish();
    /* An error from before is not of what is asked. */
    lib->raise = HD_INVALID_OPERATION;
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.buttons == 4 && info.joints == 6 && state.status == DPT_DEVICE_STATUS_FAULT, "%u buttons", info.buttons);
    finish();
    snprintf(there->model, sizeof there->model, "Touch \x81 X");
    start("");
    dpt_device_get_info(device, &info);
    CHECK(!strcmp(info.name, "Touch ? X"), "%s", info.name);
    finish();
}

/* It is open, and there is something left for a person to do. */
static void a_note_says_what_is_left_to_do(void)
{
    there->in_inkwell = 1;
    start("");
    CHECK(error.code == DPT_OK && strstr(error.text, "take it out"), "%s", error.text);
    finish();
    there->styles = HD_CALIBRATION_AUTO;
    there->calibration = HD_CALIBRATION_NEEDS_MANUAL_INPUT;
    start("");
    CHECK(error.code == DPT_OK && strstr(error.text, "move it slowly"), "%s", error.text);
    finish();
    lib->raise = HD_WARM_MOTORS;
    lib->raise_more = 5;
    start("");
    CHECK(error.code == DPT_OK && strstr(error.text, "a fault, no force (0x200)"), "%s", error.text);
    CHECK(state.status == DPT_DEVICE_STATUS_FAULT, "%s", dpt_device_status_name(state.status));
    finish();
    start("");
    CHECK(error.code == DPT_OK && !error.text[0], "%s", error.text);
    finish();
}

static void settings_are_checked(void)
{
    refused("", "&rate=4", DPT_E_SETTING, "rate", "within 100 and");
    refused("", "&watchdog=0.0001", DPT_E_SETTING, "watchdog", "0.002");
    refused("", "&watchdog=2", DPT_E_SETTING, "watchdog", "");
    refused("", "&silent=0", DPT_E_SETTING, "silent", "");
    refused("", "&mass=101", DPT_E_SETTING, "mass is not within 0 and 100", "");
    refused("", "&force=1", DPT_E_SETTING, "no setting 'force'", "");
    char name[200];
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    refused(name, "", DPT_E_SETTING, "too long", "");
    refused_by("openhaptics:?library=/elsewhere/libHD.so", DPT_E_SETTING, "has loaded", "start another program");
    start("&rate=500&watchdog=0.02&" DYNAMICS);
    check_dynamics(device);
    dpt_device_info info = { .size = sizeof info };
    dpt_device_get_info(device, &info);
    CHECK(info.rate == 500.0 && info.watchdog == 0.02 && lib->rate == 500, "%g Hz", info.rate);
    dpt_device *other;
    left->is_plugged = 1;
    CHECK(open_at(&other, "Left Device", "&rate=1000") == DPT_E_SETTING && strstr(error.text, "runs at 500 Hz"), "%s",
          error.text);
    CHECK(open_at(&other, "Left Device", "") == DPT_OK, "%s", error.text);
    dpt_device_get_info(other, &info);
    CHECK(info.rate == 500.0, "%g Hz", info.rate);
    close_one(other);
    finish();
    /* The scheduler keeps the rate, also where nobody says so. */
    lib->rate = 500;
    lib->unsupported[0] = HD_UPDATE_RATE;
    start("");
    dpt_device_get_info(device, &info);
    CHECK(info.rate == 500.0, "%g Hz", info.rate);
    finish();
    start("&rate=1000");
    finish();
}

static void memory_may_run_out(void)
{
    host.fails_calloc = 1;
    refused("", "", DPT_E_MEMORY, "memory", "");
    host.fails_calloc = 0;
    CHECK(dpt_device_open("openhaptics:Nobody", &device, NULL) == DPT_E_DEVICE, "without words");
    renew();
}

/* Again and again, also after failures: nothing is used up. */
static void it_opens_as_often_as_wanted(void)
{
    for (int i = 0; i < 20; i++) {
        start("");
        finish();
        there->is_plugged = i % 2;
        if (!there->is_plugged)
            refused("", "", DPT_E_DEVICE, "no device answers", "");
    }
}

int main(int argc, char **argv)
{
    (void)argc;
    program = argv[0];
    TEST(without_a_library_it_says_what_to_install);
    TEST(libraries_that_do_not_load);
    TEST(an_older_library_will_do);
    take_stand_in(argv[0], "libHD-stand-in.so");
    renew();
    TEST(no_function_may_lack);
    TEST(a_device_that_is_not_there_has_a_cure);
    TEST(a_device_of_another_kind_has_a_cure);
    TEST(a_device_that_does_not_start_has_a_cure);
    TEST(what_is_not_told_is_left_out);
    TEST(a_note_says_what_is_left_to_do);
    TEST(settings_are_checked);
    TEST(memory_may_run_out);
    TEST(it_opens_as_often_as_wanted);
    return check_report();
}
