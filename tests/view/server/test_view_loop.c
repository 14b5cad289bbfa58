/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A haptic loop's own part of a tick, from the sample to the wrench, with the viewer's server running and a client that
 * draws: it makes no call of the system and allocates nothing, with physics in the tick and with a thread for it. A
 * child's haptic thread runs where the kernel kills the process that calls it (seccomp, for that thread alone), while the
 * server and a client run in others. That a call or an allocation would be seen, other children show by making one.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/command_options.h"
#include "lib/check.h"
#include "view/run_view.h"
#include "view/server/web_client.h"
#include "view/view_serve.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED
#endif
#if defined(__linux__) && !defined(SANITIZED)
#define CAN_FORBID_CALLS
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

enum { WARM_UP = 500, TICKS = 20000, OFFENCE_AT = TICKS / 2, REFUSED = 77 };
enum offence { NONE, A_CALL, AN_ALLOCATION };

static __thread int in_tick;
static uint64_t allocations;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);
void __wrap_free(void *block);

void *__wrap_malloc(size_t size)
{
    allocations += (uint64_t)in_tick;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    allocations += (uint64_t)in_tick;
    return __real_calloc(count, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    allocations += (uint64_t)in_tick;
    return __real_realloc(block, size);
}

void __wrap_free(void *block)
{
    allocations += (uint64_t)in_tick;
    __real_free(block);
}

#ifdef CAN_FORBID_CALLS

struct report {
    uint64_t ticks, frames, vertices, touches, allocations, steps;
};

/* What the child's threads share. */
static struct {
    struct scene scene;
    struct run_view *view;
    dpt_device *device;
    dpt_device_info info;
    enum offence offence;
    double physics; /* Hz, in a thread; 0: in the tick */
    uint16_t port;
    char token[40];
    uint64_t frames, vertices, touches; /* atomic */
    int is_done;                        /* atomic */
} lab;

/* For this thread, from now on. */
static int forbid_calls(void)
{
    struct sock_filter rules[] = { BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS) };
    struct sock_fprog filter = { sizeof rules / sizeof *rules, rules };
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

static void offend(void)
{
    if (lab.offence == A_CALL)
        syscall(SYS_getpid);
    if (lab.offence == AN_ALLOCATION) {
        void *volatile block = malloc(16);
        free(block);
    }
}

/* As the loop does: read the device, feel, hand to the viewers. */
static void tick(uint64_t i)
{
    dpt_device_state state = { .size = sizeof state };
    dpt_wrench wrench = { { 0.0 }, { 0.0 } };
    dpt_hit hit = DPT_HIT_INIT;
    in_tick = 1;
    dpt_device_read(lab.device, &state);
    const dpt_loop_sample sample = { .size = sizeof sample, .state = &state, .info = &lab.info, .dt = 0.001 };
    run_view_begin(lab.view);
    if (scene_feel(&lab.scene, &sample, &wrench) == DPT_OK)
        run_view_tick(lab.view, &sample, DPT_OK);
    dpt_device_write(lab.device, &wrench);
    dpt_tool_get_hit(lab.scene.stage.world, lab.scene.stage.tool, &hit);
    __atomic_fetch_add(&lab.touches, hit.contact == DPT_CONTACT_PENETRATING, __ATOMIC_RELAXED);
    if (i == OFFENCE_AT)
        offend();
    in_tick = 0;
}

static void *be_the_loop(void *of)
{
    (void)of;
    void *volatile block = malloc(16); /* a thread's first one asks the system for its heap */
    free(block);
    for (uint64_t i = 0; i < WARM_UP; i++)
        tick(0);
    if (!forbid_calls())
        _exit(REFUSED);
    for (uint64_t i = 0; i < TICKS; i++)
        tick(i);
    __atomic_store_n(&lab.is_done, 1, __ATOMIC_RELEASE);
    for (;;) /* to end a thread is a call */
        ;
    return NULL;
}

static uint32_t word(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

static void *draw(void *of)
{
    struct web_client *client = of;
    for (;;) {
        const struct web_message message = web_receive(client, 10.0);
        dpt_snapshot_info info = { .size = sizeof info };
        if (message.event != WEB_BINARY)
            return NULL;
        if (message.size < 80 || word(message.bytes) != 2)
            continue;
        if (dpt_snapshot_get_info(message.bytes + 80, word(message.bytes + 4), &info) == DPT_OK) {
            __atomic_fetch_add(&lab.frames, 1, __ATOMIC_RELAXED);
            __atomic_fetch_add(&lab.vertices, info.vertices > 0, __ATOMIC_RELAXED);
        }
        web_text(client, "drawn");
    }
}

/* The scene membrane, pressed by a simulated hand; its page's address comes by this process's standard output. */
static int open_lab(void)
{
    static struct scene_def def = { .command = "test",
                                    .path = "membrane",
                                    .zoom = 1.0,
                                    .force_scale = 1.0,
                                    .clutch = -1,
                                    .length = 0.1,
                                    .radius = 0.002,
                                    .force = { .law = DPT_LAW_PROXY, .stiffness = 300.0 } };
    const struct run_view_options options = { .is_on = 1 };
    char text[256] = "";
    int ends[2];
    unsigned port = 0;
    dpt_host_error error = { .size = sizeof error };
    lab.info.size = sizeof lab.info;
    def.physics = lab.physics;
    if (dpt_device_open("sim:?hand=press&cycle=2", &lab.device, NULL) != DPT_OK || pipe(ends) != 0)
        return 0;
    dpt_device_get_info(lab.device, &lab.info);
    if (scene_open(&lab.scene, &def, &error) != DPT_OK ||
        scene_make_world(&lab.scene, &lab.info, 0, &error) != DPT_OK ||
        (lab.physics > 0.0 && scene_physics_start(lab.scene.stage.physics, 1000.0) != DPT_OK))
        return 0;
    dup2(ends[1], STDOUT_FILENO);
    const struct scene_hand hand = { lab.device, "sim", 1000.0, 5.0 };
    if (run_view_open(&lab.view, &options, &lab.scene, "a test", &hand))
        return 0;
    if (read(ends[0], text, sizeof text - 1) <= 0 ||
        sscanf(text, "the viewer: http://127.0.0.1:%u/#%32[0-9a-f]", &port, lab.token) != 2)
        return 0;
    lab.port = (uint16_t)port;
    return 1;
}

static int open_client(struct web_client *client)
{
    char host[40], origin[48];
    snprintf(host, sizeof host, "127.0.0.1:%u", (unsigned)lab.port);
    snprintf(origin, sizeof origin, "http://%s", host);
    return web_open(client, "127.0.0.1", lab.port) && web_upgrade(client, host, origin) == 101 &&
           web_text(client, lab.token) && web_receive(client, 5.0).event == WEB_BINARY && web_text(client, "ready");
}

static void be_the_child(enum offence offence, int report_to)
{
    static struct web_client client;
    pthread_t thread;
    lab.offence = offence;
    if (!open_lab() || !open_client(&client) || pthread_create(&thread, NULL, draw, &client) ||
        pthread_create(&thread, NULL, be_the_loop, NULL))
        _exit(1);
    const double begin = web_now();
    while (!__atomic_load_n(&lab.is_done, __ATOMIC_ACQUIRE) && web_now() < begin + 120.0)
        usleep(1000);
    const struct report report = { .ticks = lab.is_done ? TICKS : 0,
                                   .frames = __atomic_load_n(&lab.frames, __ATOMIC_RELAXED),
                                   .vertices = __atomic_load_n(&lab.vertices, __ATOMIC_RELAXED),
                                   .touches = __atomic_load_n(&lab.touches, __ATOMIC_RELAXED),
                                   .allocations = allocations,
                                   .steps = scene_soft_steps(&lab.scene) };
    _exit(write(report_to, &report, sizeof report) == sizeof report ? 0 : 1);
}

static int run_child(enum offence offence, struct report *report)
{
    int ends[2], status = -1;
    memset(report, 0, sizeof *report);
    fflush(stdout);
    const pid_t child = pipe(ends) == 0 ? fork() : -1;
    CHECK(child >= 0, "no child: %s", strerror(errno));
    if (child < 0)
        return -1;
    if (child == 0)
        be_the_child(offence, ends[1]);
    close(ends[1]);
    const ssize_t got = read(ends[0], report, sizeof *report);
    close(ends[0]);
    waitpid(child, &status, 0);
    CHECK(got == 0 || got == sizeof *report, "%zd bytes of a report", got);
    return status;
}

static struct report quiet;
static int quiet_status;

static void a_tick_calls_nothing(void)
{
    CHECK(WIFEXITED(quiet_status) && WEXITSTATUS(quiet_status) == 0, "status %x", quiet_status);
    CHECK(quiet.ticks == TICKS && quiet.touches > TICKS / 10, "%llu ticks, %llu in contact",
          (unsigned long long)quiet.ticks, (unsigned long long)quiet.touches);
    CHECK(quiet.frames >= 10 && quiet.vertices >= 5, "%llu frames drawn, %llu with vertices",
          (unsigned long long)quiet.frames, (unsigned long long)quiet.vertices);
}

static void nor_beside_physics(void)
{
    struct report report;
    lab.physics = 500.0;
    const int status = run_child(NONE, &report);
    lab.physics = 0.0;
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0, "status %x", status);
    CHECK(report.ticks == TICKS && report.touches > TICKS / 10 && report.steps > 5 && report.steps < TICKS / 2,
          "%llu ticks, %llu in contact, %llu steps", (unsigned long long)report.ticks,
          (unsigned long long)report.touches, (unsigned long long)report.steps);
    CHECK(report.allocations == 0, "%llu allocations", (unsigned long long)report.allocations);
}

static void a_tick_allocates_nothing(void)
{
    struct report offence;
    CHECK(quiet.allocations == 0, "%llu allocations", (unsigned long long)quiet.allocations);
    run_child(AN_ALLOCATION, &offence);
    CHECK(offence.allocations == 2, "of a malloc and a free %llu are counted", (unsigned long long)offence.allocations);
}

static void a_call_would_be_seen(void)
{
    struct report offence;
    const int status = run_child(A_CALL, &offence);
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS && offence.ticks == 0, "status %x", status);
}

#endif

int main(void)
{
#ifdef CAN_FORBID_CALLS
    if (!view_page_bytes().html) {
        SKIP("the loop beside a viewer", "this build has no viewer's page");
        return check_report();
    }
    quiet_status = run_child(NONE, &quiet);
    if (WIFEXITED(quiet_status) && WEXITSTATUS(quiet_status) == REFUSED) {
        SKIP("the loop beside a viewer", "the system has no filter of calls");
        return check_report();
    }
    TEST(a_tick_calls_nothing);
    TEST(a_tick_allocates_nothing);
    TEST(nor_beside_physics);
    TEST(a_call_would_be_seen);
#else
    SKIP("the loop beside a viewer", "not on this system, or under a sanitizer");
#endif
    return check_report();
}
