/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * latest_value.h under a model of memory (memory_model.h): all interleavings of a writer and a reader, with every value
 * that a load may see. The code is the shipped one: its atomic operations are compiled as questions to the model,
 * together with their memory orders.
 *
 * A call runs until its first question without an answer, and leaves. When the scheduler has made that step, the call
 * runs again from its beginning, with one more answer. Each thread has a copy of the struct, in which the fields that
 * it must not touch are marked.
 */
#include <setjmp.h>

#include "exchange/memory_model.h"
#include "lib/check.h"

static uint32_t ask(const uint32_t *word, int is_load, uint32_t value, int order);

#define __atomic_exchange_n(word, value, order) ask(word, 0, value, order)
#define __atomic_load_n(word, order)            ask(word, 1, 0, order)
#include "exchange/latest_value.h"

enum { WRITER, READER };
enum { PUBLISHES = 3, TAKES = 3, WORDS = 2, ANSWERS = 4, MARK = 0x5eed, STEPS = 64 };

/* What is changed of the shipped code, and by whom it is executed. */
struct change {
    int thread, drops; /* this thread's exchange has these orders no more */
    int load_says_new; /* the reader does not look whether there is something new */
    int is_split;      /* an exchange is a load and a store */
};

struct question {
    int is_load, orders;
    uint32_t value;
};

/* A thread: of which call it is, how far, and what that call was answered. */
struct thread {
    struct latest_value latest;
    uint32_t calls, stage, known, answers[ANSWERS];
    uint32_t halfway; /* of an exchange that is split: 1 and what was loaded */
};

struct state {
    struct memory_model memory;
    struct thread threads[MEMORY_THREADS];
    uint32_t published, newest, seen[WORDS], last;
    int is_new;
    const char *fault;
    char trail[STEPS]; /* a letter a step */
    uint32_t steps;
};

static struct {
    jmp_buf leave;
    const struct thread *thread;
    const uint32_t *word;
    uint32_t used;
    int is_elsewhere;
    struct question question;
} run;

static struct {
    struct change change;
    uint64_t interleavings, faulty, races, nothing, passed_over, old_loads;
    const char *fault;
    char trail[STEPS];
} found;

static int orders_of(int order)
{
    switch (order) {
    case __ATOMIC_ACQUIRE:
        return MEMORY_ACQUIRES;
    case __ATOMIC_RELEASE:
        return MEMORY_RELEASES;
    case __ATOMIC_ACQ_REL:
    case __ATOMIC_SEQ_CST:
        return MEMORY_ACQUIRES | MEMORY_RELEASES;
    default:
        return MEMORY_RELAXED;
    }
}

static uint32_t ask(const uint32_t *word, int is_load, uint32_t value, int order)
{
    run.is_elsewhere |= word != run.word;
    if (run.used < run.thread->known)
        return run.thread->answers[run.used++];
    run.question = (struct question){ .is_load = is_load, .value = value };
    run.question.orders = orders_of(order);
    longjmp(run.leave, 1);
}

static void fail(struct state *state, const char *fault)
{
    if (!state->fault)
        state->fault = fault;
}

/* Run a thread's call with the answers so far: 1 if it has ended, with its result; 0 if run.question is open. */
static int call_ends(struct state *state, int which, int *result)
{
    static struct latest_value latest;
    struct thread *thread = &state->threads[which];
    latest = thread->latest;
    run.thread = thread;
    run.word = &latest.between;
    run.used = 0;
    run.is_elsewhere = 0;
    if (setjmp(run.leave)) {
        if (run.is_elsewhere)
            fail(state, "a step on another word");
        return 0;
    }
    *result = 1;
    if (which == WRITER)
        latest_value_publish(&latest);
    else
        *result = latest_value_take(&latest);
    if (run.is_elsewhere || latest.between != MARK || (which == WRITER ? latest.reading : latest.writing) != MARK)
        fail(state, "what is not the thread's was touched without a step");
    if ((which == WRITER ? latest.writing : latest.reading) >= LATEST_VALUE_PLACES)
        fail(state, "there is no such place");
    thread->latest = latest;
    return 1;
}

static int is_calling(const struct thread *thread, int which)
{
    return which == WRITER ? thread->stage == WORDS : thread->stage == 0;
}

/* How many ways there are to make the thread's next step; 0 if it has ended. */
static uint32_t ways_of(struct state *state, int which)
{
    struct thread *thread = &state->threads[which];
    int result;
    if (thread->calls == (which == WRITER ? PUBLISHES : TAKES))
        return 0;
    if (!is_calling(thread, which))
        return 1;
    if (call_ends(state, which, &result)) {
        fail(state, "a call without a step");
        return 0;
    }
    return run.question.is_load ? memory_loads(&state->memory, which) : 1;
}

/* An exchange that is split: the first half loads, and leaves the question open. */
static int is_first_half(struct state *state, int which)
{
    struct thread *thread = &state->threads[which];
    if (!found.change.is_split || run.question.is_load || thread->halfway)
        return 0;
    thread->halfway = 1 + memory_load(&state->memory, which, 0, run.question.orders);
    state->trail[state->steps - 1] = 'h';
    return 1;
}

static void answer_question(struct state *state, int which, uint32_t age)
{
    struct thread *thread = &state->threads[which];
    uint32_t answer;
    if (run.question.is_load) {
        answer = memory_load(&state->memory, which, age, run.question.orders);
        found.old_loads += age > 0;
        if (found.change.load_says_new)
            answer |= LATEST_VALUE_NEW;
    } else {
        const int drops = which == found.change.thread ? found.change.drops : 0;
        answer = memory_exchange(&state->memory, which, run.question.value, run.question.orders & ~drops);
        if (thread->halfway)
            answer = thread->halfway - 1;
        thread->halfway = 0;
        if (which == WRITER)
            state->published++;
        else
            state->newest = state->published;
    }
    thread->answers[thread->known++] = answer;
    state->trail[state->steps - 1] = run.question.is_load ? 'l' : which == WRITER ? 'P' : 'T';
}

/* The reader has read its place: a new value after a take of one, else the last one once more. */
static void look_at_value(struct state *state)
{
    if (state->seen[0] != state->seen[1])
        fail(state, "a torn value");
    if (state->seen[0] != state->newest)
        fail(state, "not the newest value");
    if (state->is_new ? state->seen[0] <= state->last : state->seen[0] != state->last)
        fail(state, "an older value, or a change that take did not tell");
    found.nothing += !state->is_new;
    found.passed_over += state->seen[0] > state->last + 1;
    state->last = state->seen[0];
}

static void make_step(struct state *state, int which, uint32_t way)
{
    struct thread *thread = &state->threads[which];
    int result = 0;
    state->steps++;
    if (is_calling(thread, which)) {
        if (!call_ends(state, which, &result) && is_first_half(state, which))
            return;
        answer_question(state, which, way);
        if (!call_ends(state, which, &result)) {
            /* Neither thread waits: one step to publish, two to take. */
            if (thread->known >= (which == WRITER ? 1 : 2))
                fail(state, "a call of too many steps");
            return;
        }
        thread->known = 0;
        if (which == WRITER) {
            thread->stage = 0;
            thread->calls++;
        } else {
            thread->stage = 1;
            state->is_new = result;
        }
    } else if (which == WRITER) {
        memory_write(&state->memory, WRITER, thread->latest.writing * WORDS + thread->stage, state->published + 1);
        state->trail[state->steps - 1] = 'w';
        thread->stage++;
    } else {
        state->seen[thread->stage - 1] =
            memory_read(&state->memory, READER, thread->latest.reading * WORDS + thread->stage - 1);
        state->trail[state->steps - 1] = 'r';
        if (thread->stage++ == WORDS) {
            look_at_value(state);
            thread->stage = 0;
            thread->calls++;
        }
    }
    if (state->memory.races)
        state->fault = "a race";
}

/* Both threads have ended, and the reader knows: a last take gives what it has not taken. */
static void end(struct state *state)
{
    const uint32_t last = state->last;
    memory_join(&state->memory, READER);
    state->threads[READER].calls--;
    while (!state->fault && ways_of(state, READER) > 0)
        make_step(state, READER, 0);
    if (last > PUBLISHES || state->last != PUBLISHES)
        fail(state, "the last value was missed");
}

static void count_interleaving(const struct state *state)
{
    found.interleavings++;
    found.races += state->memory.races > 0;
    if (state->fault && found.faulty++ == 0) {
        found.fault = state->fault;
        memcpy(found.trail, state->trail, sizeof found.trail);
    }
}

static void explore(const struct state *begin)
{
    struct state state = *begin;
    const uint32_t ways[MEMORY_THREADS] = { ways_of(&state, WRITER), ways_of(&state, READER) };
    if (!state.fault && ways[WRITER] + ways[READER] == 0)
        end(&state);
    if (state.fault || ways[WRITER] + ways[READER] == 0) {
        count_interleaving(&state);
        return;
    }
    for (int which = 0; which < MEMORY_THREADS; which++)
        for (uint32_t way = 0; way < ways[which]; way++) {
            state = *begin;
            make_step(&state, which, way);
            explore(&state);
        }
}

static void explore_all(struct change change)
{
    static struct state begin;
    struct latest_value latest;
    memset(&begin, 0, sizeof begin);
    memset(&found, 0, sizeof found);
    memset(&run, 0, sizeof run);
    found.change = change;
    latest_value_init(&latest);
    memory_init(&begin.memory, latest.between);
    begin.threads[WRITER].latest = (struct latest_value){ latest.writing, MARK, MARK };
    begin.threads[READER].latest = (struct latest_value){ MARK, MARK, latest.reading };
    explore(&begin);
    printf("    %llu interleavings, %llu of them faulty", (unsigned long long)found.interleavings,
           (unsigned long long)found.faulty);
    if (found.fault)
        printf("; the first: %s after %s", found.fault, found.trail);
    printf("\n");
}

static void the_shipped_orders_hold_in_all_interleavings(void)
{
    explore_all((struct change){ .drops = 0 });
    CHECK(!found.faulty, "%s after %s", found.fault, found.trail);
    CHECK(found.interleavings == 346983, "%d, and not as docs/algorithms/exchange.md says", (int)found.interleavings);
    CHECK(found.nothing && found.passed_over && found.old_loads,
          "%d takes of nothing, %d with a value passed over, %d loads of an old value", (int)found.nothing,
          (int)found.passed_over, (int)found.old_loads);
}

static void races_without(int thread, int drops)
{
    explore_all((struct change){ .thread = thread, .drops = drops });
    CHECK(found.races, "no race in %d interleavings", (int)found.interleavings);
    CHECK(found.races == found.faulty, "%s", found.fault);
}

static void publish_must_release(void)
{
    races_without(WRITER, MEMORY_RELEASES);
}

static void publish_must_acquire(void)
{
    races_without(WRITER, MEMORY_ACQUIRES);
}

static void take_must_release(void)
{
    races_without(READER, MEMORY_RELEASES);
}

static void take_must_acquire(void)
{
    races_without(READER, MEMORY_ACQUIRES);
}

static void an_exchange_must_be_one_step(void)
{
    explore_all((struct change){ .is_split = 1 });
    CHECK(found.faulty, "no fault in %d interleavings", (int)found.interleavings);
}

static void take_must_look_for_something_new(void)
{
    explore_all((struct change){ .load_says_new = 1 });
    CHECK(found.faulty && !found.races, "%d faulty, %d races", (int)found.faulty, (int)found.races);
}

int main(void)
{
    TEST(the_shipped_orders_hold_in_all_interleavings);
    TEST(publish_must_release);
    TEST(publish_must_acquire);
    TEST(take_must_release);
    TEST(take_must_acquire);
    TEST(an_exchange_must_be_one_step);
    TEST(take_must_look_for_something_new);
    return check_report();
}
