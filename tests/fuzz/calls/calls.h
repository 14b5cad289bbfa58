/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Random calls of everything public, each held against a model that is obvious and slow (README.md in tests/fuzz).
 * A run is made of games: some 2,000 calls that begin with nothing and leave nothing. Seed and number name a game,
 * so what fails in one fails again in that one alone.
 *
 * A move is a function of this folder that draws arguments, says which codes they may earn, calls, and checks.
 * Moves never look into the library; what they know is what the headers promise.
 */
#ifndef DPT_TESTS_CALLS_H
#define DPT_TESTS_CALLS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dynpoint.h"
#include "lib/random.h"

/* ---- calls: counted by name, the last ones are remembered ---- */

struct site {
    const char *name;
    struct site *next;
    int is_listed, has_result;
    uint64_t calls, done, refused;
};

void call_begins(struct site *site);
void call_ends(struct site *site, dpt_result result);

/*
 * What the next call is given, for the trace of a failure: at most four numbers and a format of %llx or %llu for
 * them.
 */
void call_with(const char *format, uint64_t a, uint64_t b, uint64_t c, uint64_t d);

/* A call of something public. */
#define CALL(function, ...)                                                                                            \
    ({                                                                                                                 \
        static struct site call_site = { .name = #function };                                                          \
        call_begins(&call_site);                                                                                       \
        function(__VA_ARGS__);                                                                                         \
    })

/* And one that answers a dpt_result. */
#define RESULT(function, ...)                                                                                          \
    ({                                                                                                                 \
        static struct site call_site = { .name = #function, .has_result = 1 };                                         \
        call_begins(&call_site);                                                                                       \
        const dpt_result call_result = function(__VA_ARGS__);                                                          \
        call_ends(&call_site, call_result);                                                                            \
        call_result;                                                                                                   \
    })

/* What the model demands: what does not hold ends the run, with the trace and how to play the game again. */
#define HOLDS(condition, ...)                                                                                          \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            call_fails(__FILE__, __LINE__, #condition, __VA_ARGS__);                                                   \
    } while (0)

void call_fails(const char *file, int line, const char *condition, const char *format, ...)
    __attribute__((format(printf, 4, 5), noreturn));

/* ---- which codes are allowed ---- */

enum { CODES_MAX = 16 };

/* Each thing that is wrong with a call's arguments adds its code, once. None: the call must succeed. */
struct codes {
    dpt_result code[CODES_MAX];
    int count;
    int or_done; /* the headers leave it free whether it is refused */
};

static inline void may_fail(struct codes *codes, int is_wrong, dpt_result code)
{
    for (int i = 0; i < codes->count; i++)
        if (codes->code[i] == code)
            return;
    if (is_wrong && codes->count < CODES_MAX)
        codes->code[codes->count++] = code;
}

/* The result is one that they allow. */
#define expect(result, codes) expect_at(__FILE__, __LINE__, result, codes)
void expect_at(const char *file, int line, dpt_result result, const struct codes *codes);

/* ---- random draws, all from the game's number ---- */

uint32_t draw_below(uint32_t count);
int draw_one_in(uint32_t count);
double draw_in(double low, double high);
uint64_t draw_bits(void);

/* NaN, infinities, zeros, what is tiny or huge: not always wrong. */
double draw_odd_number(void);

/*
 * A pose near the origin, or a step away from `near`; rarely one that cannot be used; NULL is the caller's to
 * draw.
 */
dpt_pose draw_pose(const dpt_pose *near);
void pose_codes(const dpt_pose *pose, struct codes *codes);

dpt_segment draw_segment(void);
void segment_codes(const dpt_segment *segment, struct codes *codes);

/* Mostly `today`; else sizes that a newer or older caller has, and such that none has. */
uint32_t draw_size(size_t first, size_t today);

/* base.h's table. `stride`: it is the first of an array. */
void size_codes_of_output(uint32_t size, size_t first, int stride, struct codes *codes);

/* The same for an input, which is brought into a block of its size, whose bytes behind today's are zero or not. */
const void *draw_input(int slot, const void *good, uint32_t size, size_t first, size_t today, struct codes *codes);

/* ---- outputs, with guards about them ---- */

/* Outputs come in pairs: 2 k of a world, 2 k + 1 of its twin. */
enum { OUTPUTS = 8, OUTPUT_ROOM = 1 << 16 };

/* `size` bytes that may be written, and not one more. */
void *output_of(int slot, size_t size);

/* What was taken last there. */
void *output_at(int slot);

/* Of a struct whose size is `size`: as many bytes as that may be. */
void *output_sized(int slot, uint32_t size);

/* Nothing was written about so many of them. */
void outputs_are_guarded(int first, int count);

/* The first so many pairs are alike. */
void outputs_agree(int pairs);

/* No byte of it was written from there on. */
int output_is_untouched(int slot, size_t from);

/*
 * A struct of that first and today's size, after the call: its size stays, what is behind today's is zero, numbers
 * from the byte `doubles` on are finite. It is copied to `copy` as far as it goes, the rest being zero. 1 if it is
 * whole.
 */
int output_read(int slot, uint32_t size, size_t today, size_t doubles, void *copy);

/*
 * What a def's _defaults function left of that size in a slot: those of `whole`, of today's size, and zeros behind;
 * nothing for a size that is none, or a def that is NULL.
 */
void defaults_must_hold(int slot, uint32_t size, int is_null, const void *whole, size_t today);

/* Room for it. */
void *output_of_defaults(int slot, uint32_t size);

/* The numbers are finite. */
void numbers_are_finite(const double *numbers, size_t count, const char *what);

/* What was answered is part of the game's digest: a game that is played again must have the same. */
void game_digest(const void *bytes, size_t size);

/* ---- subjects, made once ---- */

enum { MESHES = 7, ARMS = 3, TRIANGLES_MOST = 256, VERTICES_MOST = 256 };

struct subject {
    const char *name;
    const dpt_mesh *mesh;
    const void *bytes;
    size_t size;
    uint32_t source_triangles;
    uint32_t triangles;
    int is_solid; /* one closed part that does not cut itself */
    uint32_t vertices;
    const float *positions;         /* of the vertices */
    const uint32_t *corners;        /* of the triangles that were not dropped, in the file's order */
    uint32_t place[TRIANGLES_MOST]; /* in that order, by source number; DPT_NONE: dropped */
};

extern struct subject subjects[MESHES + 1];

/* That of all games or, where there is one, what this game compiled. */
const struct subject *draw_subject(void);

struct arm_subject {
    const dpt_arm *arm;
    const void *bytes;
    size_t size;
    uint32_t joints, links, segments, bodies, jaws, jaw_links, tips;
};

extern struct arm_subject arm_subjects[ARMS];

/* A trace of 40 rows for replayed devices, and a small OBJ. */
extern char trace_path[64], obj_path[64];

int subjects_open(void);
void subjects_close(void);

/* A mesh that this game compiled becomes a subject until its end; it is given back then. */
void subject_adopt(const dpt_mesh *mesh, void *bytes, size_t size);
int subject_is_adopted(void);

/* ---- the nouns: what a game begins and ends with, and their moves ---- */

struct move {
    const char *name;
    void (*make)(void);
    uint32_t weight;
};

struct noun {
    const char *name;
    void (*begin)(void);
    void (*end)(void);
    const struct move *moves;
};

extern const struct noun world_noun, body_noun, tool_noun, step_noun, result_noun, strip_noun, query_noun, mesh_noun,
    arm_noun, compile_noun, guard_noun, device_noun, loop_noun, name_noun, trial_noun, selftest_noun, proxy_noun,
    coupling_noun, passivity_noun, record_noun, identify_noun, deform_noun, node_noun, spring_noun, exchange_noun,
    snapshot_noun, hull_noun, yield_noun, needle_noun;

/* ---- what a run must have met, or it tests little ---- */

/* clang-format off */
#define MET(X)                                                                                     \
    X(EXACT, "an exact pair")            X(BOUNDED, "a bounded pair")  X(LOCAL, "a pair of the paper's") \
    X(STALE, "a stale answer")           X(CROSSING, "an axis that crosses")                       \
    X(TOUCHING, "a touch")               X(UNKNOWN, "a contact that is unknown")                    \
    X(PENETRATING, "a depth")            X(CONTACT, "a contact")       X(SIDED, "a contact with a side") \
    X(SWEEP_HIT, "a swept hit")          X(UNFINISHED, "an unfinished sweep")                      \
    X(OVERLAP, "an overlap")             X(PUSH, "a wrench")           X(FADE, "a wrench that fades")           X(CONTACTS_FULL, "too many contacts") \
    X(TRUE, "a pair that was held against all triangles")             X(TWIN, "a twin's answer")   \
    X(INSIDE, "a depth of an axis inside")                                                         \
    X(TRIED_FREE, "a trial that met nothing")                         X(TRIED_HIT, "a trial that met something") \
    X(TRIED_START, "a trial that touched at once")                    X(TRIED_NONE, "a trial of which nobody knows") \
    X(TRIED_AXIS, "a trial of an axis") \
    X(HELD, "a proxy that is held")      X(HELD_FREE, "that of a free tool")                        \
    X(BEGAN_INSIDE, "a tool with a proxy that began inside")          X(FOLD, "a fold")             \
    X(SHAPED, "a wrench that a function of its own was given")                                                    \
    X(SQUEEZED, "a proxy that was squeezed")                          X(REPLACED, "a proxy that was placed anew") \
    X(BEHIND, "a proxy that a budget made wait")                      \
    X(STARTING, "a guard that starts")   X(RUNNING, "a guard that runs") X(STOPPING, "a guard that stops") \
    X(CLAMPED, "a command that was clamped")                          X(SLEWED, "a wrench that was slewed") \
    X(SENT, "a tick that is told what acted")                         X(DROPPED, "a command that was dropped") \
    X(LIMITED, "a stiffness that was limited")                        X(WITHHELD, "a wrench that was taken away") \
    X(TESTED, "a self-test that came to its end")                     X(RECORDED, "a record in a file") \
    X(DEFORMED, "a body that deforms")   X(ON_ITS_WAY, "vertices on their way") X(LOADS, "loads")         \
    X(BALANCED, "loads that balance a wrench")                        X(DISPLACED, "a displaced triangle") \
    X(TRUE_DEFORMED, "a pair that was held against moved triangles")                               \
    X(REUSED, "an id that came round")   X(ANEW, "a world in a block in use")
/* clang-format on */
#define MET_ENUM(name, text) MET_##name,
enum { MET(MET_ENUM) MET_COUNT };

extern uint64_t met[MET_COUNT];

/* ---- the run ---- */

struct run {
    uint64_t seed, game, random, digest;
    uint64_t calls, game_calls;
    int is_told; /* every call is printed */
};

extern struct run run;

/* Live blocks of this program's own code; libc's are not among them. */
extern int64_t blocks_alive;

/* Every symbol of the lists in tests/abi but the exceptions was called, succeeded and was refused. */
void coverage_is_checked(int (*check)(int holds, const char *what));
void all_is_met(int (*check)(int holds, const char *what));
void coverage_is_printed(void);

#endif
