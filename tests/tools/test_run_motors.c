/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The whole way of an arm of three motors, of each kind: docs/samples/arm.urdf compiled, its motors simulated on a bus in memory,
 * and the scene of its desk felt by `dynpoint run`, 10,000 ticks of simulated time. The tool goes down to the desk and comes up,
 * is held off it, and two runs give the same bits: of the recording, and of all torques and joints.
 */
#include "drivers/can_fixture.h"

#include <pthread.h>

#include "cli/commands.h"

enum { TICKS = 10000 };

int __wrap_clock_nanosleep(clockid_t clock, int flags, const struct timespec *until, struct timespec *left);
int __wrap_nanosleep(const struct timespec *time, struct timespec *left);
int __real_nanosleep(const struct timespec *time, struct timespec *left);

static pthread_t loop_thread;

/* Milliseconds pass until the clock is there; it stops where the caller wanted, between two of them too. */
int __wrap_clock_nanosleep(clockid_t clock, int flags, const struct timespec *until, struct timespec *left)
{
    static uint64_t next_ms;
    const uint64_t deadline = (uint64_t)until->tv_sec * 1000000000u + (uint64_t)until->tv_nsec;
    (void)clock, (void)flags, (void)left;
    if (next_ms <= can_clock_ns || next_ms > can_clock_ns + 1000000u)
        next_ms = can_clock_ns + 1000000u;
    while (next_ms <= deadline) {
        can_clock_ns = next_ms - 1000000u;
        can_tick();
        next_ms += 1000000u;
    }
    can_clock_ns = deadline > can_clock_ns ? deadline : can_clock_ns;
    return 0;
}

/* The recording's own thread waits by the real clock. */
int __wrap_nanosleep(const struct timespec *time, struct timespec *left)
{
    if (!pthread_equal(pthread_self(), loop_thread))
        return __real_nanosleep(time, left);
    can_tick();
    return 0;
}

static const struct {
    const char *name, *settings;
} kinds[] = {
    { "odrive", "gear=8,-8,10&firmware=0.6" },
    { "damiao", "drive=damiao" },
    { "robstride", "drive=robstride&model=rs-02" },
    { "cybergear", "drive=cybergear" },
    { "moteus", "drive=moteus" },
    { "mixed", "drive=odrive,damiao,robstride&model=rs-01&nodes=1,2,3&gear=8,1,1&firmware=0.6" },
};

static char folder[] = "/tmp/dynpoint-motors-XXXXXX", arm_path[64];
static uint64_t hash;

static void mix(const void *bytes, size_t size)
{
    const uint8_t *at = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ at[i]) * 1099511628211u;
}

static void each_ms_hashed(void)
{
    simulate_can_tick(&simulated);
    for (uint32_t i = 0; i < simulated.arm.joints; i++)
        mix(&simulated.node[i].torque, sizeof simulated.node[i].torque);
    mix(simulated.joint, sizeof simulated.joint);
}

/* Run a command with its standard output and errors in files. */
static int quietly(int (*command)(int, char **), int argc, const char *const *words)
{
    char output[80], *argv[24];
    for (int i = 0; i < argc; i++)
        argv[i] = (char *)(uintptr_t)words[i];
    snprintf(output, sizeof output, "%s/output", folder);
    fflush(stdout);
    const int standard = dup(1);
    FILE *file = fopen(output, "w");
    dup2(fileno(file), 1);
    const int status = command(argc, argv);
    fflush(stdout);
    dup2(standard, 1);
    close(standard);
    fclose(file);
    return status;
}

/* A number of the report of the last run; -1 if it is not there. */
static double number_of_report(const char *key)
{
    char path[80], text[16384], word[64];
    snprintf(path, sizeof path, "%s/output", folder);
    FILE *file = fopen(path, "r");
    const size_t size = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file)
        fclose(file);
    text[size] = '\0';
    snprintf(word, sizeof word, "\"%s\":", key);
    const char *at = strstr(text, word);
    return at ? atof(at + strlen(word)) : -1.0;
}

static uint64_t run_once(const char *settings, const char *name)
{
    static uint64_t began_ns;
    char where[300], device_name[360];
    can_clock_ns = began_ns += 1000000000000u;
    snprintf(where, sizeof where, "can0?arm=%s&%s&watchdog=0.02", arm_path, settings);
    /* Where the device's own frame lies does not matter: the arm's joints tell where its tool is. */
    snprintf(device_name, sizeof device_name, "can:%s&centre=1,2,3&axes=+x+y+z&mass=0.3&damping=2", where);
    const dpt_result result = simulate_can_start(&simulated, where, &error);
    CHECK(result == DPT_OK, "%s: %s", name, error.text);
    if (result != DPT_OK)
        return 0;
    simulated.swing = 0.02;
    hash = 14695981039346656037u;
    can_each_ms = each_ms_hashed;
    const char *const run[] = { "run", arm_path, "--device", device_name, "--ticks", "10000", "--json" };
    const int status = quietly(command_run, sizeof run / sizeof *run, run);
    CHECK(status == 0, "%s: exit %d", name, status);
    CHECK(number_of_report("ticks") == (double)TICKS, "%s: %g ticks", name, number_of_report("ticks"));
    const double contacts = number_of_report("contacts"), deepest = number_of_report("deepest");
    CHECK(contacts > 500.0 && contacts < 9500.0, "%s: %g ticks in contact", name, contacts);
    CHECK(deepest > 0.0005 && deepest < 0.005, "%s: %g m deep", name, deepest);
    CHECK(number_of_report("lost") == 0.0 && number_of_report("losses") == 0.0, "%s: %g lost", name,
          number_of_report("lost"));
    can_each_ms = NULL;
    simulate_can_end(&simulated);
    return hash;
}

static void each_kind_feels_the_desk(void)
{
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        const uint64_t first = run_once(kinds[k].settings, kinds[k].name);
        printf("    %-10s %4.0f of %d ticks in contact, %.2f mm deep, %.2f N, coupled by %.0f N/m\n", kinds[k].name,
               number_of_report("contacts"), TICKS, 1e3 * number_of_report("deepest"), number_of_report("strongest"),
               number_of_report("stiffness"));
        CHECK(run_once(kinds[k].settings, kinds[k].name) == first, "%s: other torques or joints", kinds[k].name);
    }
}

int main(void)
{
    error.size = sizeof error;
    loop_thread = pthread_self();
    if (!mkdtemp(folder))
        return 2;
    snprintf(arm_path, sizeof arm_path, "%s/arm.dpa", folder);
    const char *const compile[] = { "compile", "docs/samples/arm.urdf", "-o", arm_path };
    if (quietly(command_compile, 4, compile))
        SKIP("an arm from its URDF", "this build has no urdfdom");
    else
        TEST(each_kind_feels_the_desk);
    char command[80];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command) ? 2 : check_report();
}
