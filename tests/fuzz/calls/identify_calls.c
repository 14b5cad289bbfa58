/* SPDX-License-Identifier: BSD-3-Clause */
/* Identification of devices with a time of their own, and files of device dynamics. */
#include "dynpoint/identify.h"

#include <unistd.h>

#include "fuzz/calls/devices.h"
#include "fuzz/calls/witness.h"

struct listener {
    uint32_t calls, stops_at;
};

static int listen(void *user, const dpt_identify_progress *progress)
{
    struct listener *listener = user;
    HOLDS(progress && progress->size == sizeof *progress && progress->stage <= DPT_IDENTIFY_STAGE_TURN &&
              progress->axis < 3 && progress->done >= 0.0 && progress->done <= 1.0,
          "progress %u", listener->calls);
    return ++listener->calls == listener->stops_at;
}

enum { DEF_SLOT = 2 };

static const void *draw_def(struct listener *listener, struct codes *codes)
{
    dpt_identify_def def;
    CALL(dpt_identify_def_defaults, &def, sizeof def);
    def.seconds = draw_in(0.1, 0.15);
    def.may_move = draw_one_in(40) ? 1u : 0u;
    def.blocks = 4;
    def.seed = draw_below(1000);
    def.report = listen;
    def.user = listener;
    if (draw_one_in(6))
        def.button = draw_below(34);
    if (draw_one_in(10))
        def.blocks = draw_below(40);
    if (draw_one_in(10))
        def.seconds = draw_one_in(2) ? NAN : -1.0;
    if (draw_one_in(30))
        def.may_move = 2;
    may_fail(codes,
             def.may_move > 1 || (def.button > 31 && def.button != DPT_IDENTIFY_NO_BUTTON) || def.blocks < 4 ||
                 def.blocks > 32 || !(def.seconds >= 0.1 && def.seconds <= 60.0),
             DPT_E_ARGUMENT);
    return draw_input(DEF_SLOT, &def, draw_size(sizeof def, sizeof def), sizeof def, sizeof def, codes);
}

static int is_ordered(const dpt_identified *value)
{
    return isfinite(value->value) && value->low <= value->value && value->value <= value->high;
}

static void identify(void)
{
    struct listener listener = { .stops_at = draw_one_in(3) ? 1 + draw_below(20) : 0 };
    struct codes codes = { .count = 0 };
    const int no_device = draw_one_in(20), no_result = draw_one_in(20);
    const char *name = draw_device_name();
    dpt_identify_result now;
    dpt_device *device = NULL;
    const void *def = draw_def(&listener, &codes);
    const uint32_t size = draw_size(sizeof now, sizeof now);
    void *out = output_sized(0, size);
    if (!no_result)
        size_codes_of_output(size, sizeof now, 0, &codes);
    may_fail(&codes, no_device || no_result, DPT_E_ARGUMENT);
    if (!no_device)
        HOLDS(dpt_device_open(name, &device, NULL) == DPT_OK, "%s", name);
    const int is_refused = codes.count > 0;
    call_with("stops at %llu", listener.stops_at, 0, 0, 0);
    expect(RESULT(dpt_device_identify, device, def, no_result ? NULL : out), &codes);
    outputs_are_guarded(0, 1);
    HOLDS(listener.calls <= listener.stops_at || !listener.stops_at, "it went on");
    CALL(dpt_device_close, device);
    if (is_refused)
        return;
    output_read(0, size, sizeof now, sizeof now, &now);
    const dpt_identified *const values[] = { &now.mass,         &now.damping,       &now.friction, &now.inertia,
                                             &now.spin_damping, &now.spin_friction, &now.delay };
    for (int i = 0; i < 7; i++)
        HOLDS(is_ordered(values[i]), "value %d: %g", i, values[i]->value);
    HOLDS(now.end <= DPT_IDENTIFY_END_NO_WATCHDOG && CALL(dpt_identify_end_text, now.end)[0], "end %u", now.end);
}

/* A text of words and of noise. */
static void read_dynamics(void)
{
    static const char *const words[] = { "mass=0.1\n", "mass_low=0.05\n", "delay=1e-3\n", "# mass\n",
                                         "\n",         "friction=-1\n",   "mass",         "=",
                                         "0.3",        "spin_damping=1",  "\r\n",         "\xff" };
    char path[] = "/tmp/dynpoint-calls-XXXXXX";
    dpt_device_info info = { .size = sizeof info, .mass = -1.0 };
    dpt_device_error error = { .size = sizeof error };
    const int file = mkstemp(path), no_error = draw_one_in(4);
    HOLDS(file >= 0, "no file");
    for (uint32_t left = draw_below(8); left > 0; left--) {
        const char *word = words[draw_below(sizeof words / sizeof *words)];
        HOLDS(write(file, word, strlen(word)) == (ssize_t)strlen(word), "no room");
    }
    close(file);
    const dpt_result result = RESULT(dpt_device_dynamics_read, path, &info, no_error ? NULL : &error);
    unlink(path);
    HOLDS(result == DPT_OK || result == DPT_E_SYNTAX, "%s", dpt_result_name(result));
    HOLDS(no_error || (error.code == result && (result == DPT_OK) == !error.text[0]), "'%s'", error.text);
    HOLDS(info.mass == -1.0 || (result == DPT_OK && info.mass >= 0.0), "%g kg", info.mass);
}

static void defaults(void)
{
    dpt_identify_def whole;
    const uint32_t size = draw_size(sizeof whole, sizeof whole);
    const int is_null = draw_one_in(20);
    void *out = output_of_defaults(0, size);
    CALL(dpt_identify_def_defaults, is_null ? NULL : out, size);
    CALL(dpt_identify_def_defaults, &whole, sizeof whole);
    defaults_must_hold(0, size, is_null, &whole, sizeof whole);
}

static const struct move moves[] = {
    { "identify", identify, 1 }, { "read dynamics", read_dynamics, 1 }, { "defaults", defaults, 1 }, { NULL, NULL, 0 }
};

const struct noun identify_noun = { "identification", NULL, NULL, moves };
