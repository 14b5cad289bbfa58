/* SPDX-License-Identifier: BSD-3-Clause */
/* What the viewer's server sends, to clients that draw quickly, slowly or never; and how it ends. */
#include "view/server/view_server.h"

#include <pthread.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "lib/check.h"
#include "view/server/view_fixture.h"

enum { BIG = 1000000 };

/* A frame's fields as the client knows them. */
struct seen {
    uint64_t frames, first_number, ticks_before, ticks;
};

static void check_frame(struct seen *seen, const struct web_message *message, size_t snapshot)
{
    const unsigned char *frame = message->bytes;
    CHECK(message->size == VIEW_FRAME_HEADER_BYTES + snapshot + 40 * FIXTURE_TICKS, "%zu bytes", message->size);
    const uint64_t number = field_of(frame, 16, 8), ticks_through = field_of(frame, 80, 8);
    /* The beginning and the end are of the same frame. */
    CHECK(number == FIXTURE_NUMBERS * (field_of(frame, message->size - 8, 8) + 5), "a frame of pieces of two");
    if (seen->frames == 0) {
        seen->first_number = number;
        seen->ticks_before = ticks_through - FIXTURE_TICKS;
    }
    CHECK(field_of(frame, 24, 8) == number - seen->first_number - seen->frames, "%llu dropped at %llu after %llu",
          (unsigned long long)field_of(frame, 24, 8), (unsigned long long)number, (unsigned long long)seen->frames);
    seen->frames++;
    seen->ticks += FIXTURE_TICKS;
    const uint64_t missed = ticks_through - seen->ticks_before - seen->ticks;
    CHECK(field_of(frame, 32, 8) == FIXTURE_LOST + missed, "%llu ticks are lost, not %llu",
          (unsigned long long)field_of(frame, 32, 8), (unsigned long long)missed + FIXTURE_LOST);
}

static uint64_t asked_of(struct view_fixture *fixture)
{
    return __atomic_load_n(&fixture->asked, __ATOMIC_RELAXED);
}

/* Draws each frame at once for so long; returns the longest wait for one. */
static double draw(struct web_client *client, struct seen *seen, size_t snapshot, double seconds)
{
    double longest = 0.0, last = web_now();
    const double end = last + seconds;
    while (last < end) {
        const struct web_message message = web_receive(client, 1.0);
        const double now = web_now();
        if (now - last > longest)
            longest = now - last;
        last = now;
        CHECK(message.event == WEB_BINARY, "event %d", (int)message.event);
        if (message.event != WEB_BINARY)
            break;
        check_frame(seen, &message, snapshot);
        web_text(client, "drawn");
    }
    return longest;
}

static void sixty_frames_a_second(void)
{
    struct view_fixture fixture;
    struct web_client client;
    struct seen seen = { 0 };
    fixture_prepare(&fixture, 200000, 1000);
    fixture_open(&fixture);
    usleep(100000);
    CHECK(asked_of(&fixture) == 0, "frames are made for nobody");
    fixture_client(&fixture, &client);
    draw(&client, &seen, 1000, 1.0);
    CHECK(seen.frames >= 30 && seen.frames <= 62, "%llu frames in a second", (unsigned long long)seen.frames);
    CHECK(fixture_counts(&fixture).sent >= seen.frames, "counted %llu",
          (unsigned long long)fixture_counts(&fixture).sent);
    web_close(&client);
    usleep(100000);
    const uint64_t asked = asked_of(&fixture);
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    usleep(400000);
    getrusage(RUSAGE_SELF, &after);
    CHECK(asked_of(&fixture) == asked, "frames are made for who has left");
    CHECK(after.ru_nvcsw - before.ru_nvcsw < 12, "it woke %ld times for nobody", after.ru_nvcsw - before.ru_nvcsw);
    fixture_close(&fixture);
}

/* Before "ready" the scene alone; two frames, then nothing until one is drawn. */
static void two_on_their_way(void)
{
    struct view_fixture fixture;
    struct web_client client;
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    CHECK(fixture_socket(&fixture, &client, 1) == 101, "no web socket");
    CHECK(web_receive(&client, 3.0).size == 3000, "no scene");
    CHECK(web_receive(&client, 0.2).event == WEB_NOTHING, "a frame before it was ready");
    web_text(&client, "ready");
    CHECK(web_receive(&client, 1.0).event == WEB_BINARY, "no first frame");
    CHECK(web_receive(&client, 1.0).event == WEB_BINARY, "no second frame");
    CHECK(web_receive(&client, 0.3).event == WEB_NOTHING, "a third that was not asked for");
    const uint64_t asked = asked_of(&fixture);
    CHECK(asked <= 3, "%llu are made meanwhile", (unsigned long long)asked);
    web_text(&client, "drawn");
    CHECK(web_receive(&client, 1.0).event == WEB_BINARY, "no third");
    CHECK(web_receive(&client, 0.2).event == WEB_NOTHING, "a fourth");
    web_close(&client);
    fixture_close(&fixture);
}

/* Two that never read and one that reads bytes now and then delay nobody, and hold little. */
static void who_does_not_read_delays_nobody(void)
{
    struct view_fixture fixture;
    struct web_client stopped[2], slow, client;
    struct seen seen = { 0 };
    fixture_prepare(&fixture, 4 * BIG, BIG);
    fixture_open(&fixture);
    for (int i = 0; i < 2; i++) {
        CHECK(fixture_socket(&fixture, &stopped[i], 1) == 101, "no web socket");
        web_text(&stopped[i], "ready");
    }
    fixture_client(&fixture, &slow);
    fixture_client(&fixture, &client);
    const double longest = draw(&client, &seen, BIG, 1.5);
    CHECK(seen.frames >= 20, "%llu frames beside stopped clients", (unsigned long long)seen.frames);
    CHECK(longest < 0.5, "one waited %g s", longest);
    const struct view_server_counts counts = fixture_counts(&fixture);
    CHECK(counts.clients == 4, "%llu clients", (unsigned long long)counts.clients);
    CHECK(counts.sent <= seen.frames + 2 + 2, "%llu sent, %llu of them to the quick one",
          (unsigned long long)counts.sent, (unsigned long long)seen.frames);
    CHECK(web_receive(&slow, 1.0).event == WEB_BINARY && web_receive(&slow, 1.0).event == WEB_BINARY,
          "the slow one's two frames");
    web_text(&slow, "drawn");
    const struct web_message late = web_receive(&slow, 1.0);
    CHECK(late.event == WEB_BINARY && field_of(late.bytes, 24, 8) > 20, "%llu dropped for it",
          (unsigned long long)(late.bytes ? field_of(late.bytes, 24, 8) : 0));
    /* Of what it missed its own ticks are counted. */
    CHECK(late.event == WEB_BINARY && field_of(late.bytes, 32, 8) >= 20 * FIXTURE_TICKS, "ticks");
    CHECK(fixture_counts(&fixture).dropped > counts.dropped, "none of it is counted");
    for (int i = 0; i < 2; i++)
        web_close(&stopped[i]);
    web_close(&slow);
    web_close(&client);
    fixture_close(&fixture);
}

/* Stopped and idle clients take no time of the processor. */
static void waiting_takes_no_time(void)
{
    struct view_fixture fixture;
    struct web_client stopped, waits, unknown;
    struct timespec before, after;
    fixture_prepare(&fixture, 4 * BIG, BIG);
    fixture_open(&fixture);
    CHECK(fixture_socket(&fixture, &stopped, 1) == 101, "no web socket");
    CHECK(fixture_socket(&fixture, &unknown, 0) == 101, "no web socket");
    fixture_client(&fixture, &waits);
    usleep(300000);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &before);
    usleep(700000);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &after);
    const double took = (double)(after.tv_sec - before.tv_sec) + 1e-9 * (double)(after.tv_nsec - before.tv_nsec);
    CHECK(took < 0.1, "%g s in 0.7", took);
    web_close(&stopped);
    web_close(&waits);
    web_close(&unknown);
    fixture_close(&fixture);
}

/* What the test sets up as a recording: all messages are there from the start. */
static void recordings_are_sent_in_order(void)
{
    enum { FRAMES = 3 };
    struct view_fixture fixture;
    struct web_client client;
    static unsigned char frames[FRAMES][200], end[16] = { VIEW_MESSAGE_END, 0, 0, 0, 3, 0, 0, 0, 'e', 'n', 'd' };
    struct view_message first[FRAMES + 2];
    fixture_prepare(&fixture, 3000, 1000);
    first[0] = fixture.first[0];
    for (unsigned char i = 0; i < FRAMES; i++) {
        frames[i][0] = VIEW_MESSAGE_FRAME;
        frames[i][24] = 99;
        frames[i][199] = i;
        first[1 + i] = (struct view_message){ frames[i], sizeof frames[i] };
    }
    first[FRAMES + 1] = (struct view_message){ end, 11 };
    fixture.def.first = first;
    fixture.def.first_count = FRAMES + 2;
    fixture.def.next = NULL;
    fixture.def.control = 0;
    fixture.def.heard_hand = NULL;
    fixture_open(&fixture);
    CHECK(fixture_socket(&fixture, &client, 1) == 101, "no web socket");
    CHECK(web_receive(&client, 3.0).size == 3000, "no scene");
    CHECK(web_receive(&client, 0.2).event == WEB_NOTHING, "a frame before it was ready");
    web_text(&client, "ready");
    for (int i = 0; i < FRAMES; i++) {
        const struct web_message frame = web_receive(&client, 1.0);
        CHECK(frame.size == 200 && frame.bytes[199] == i && frame.bytes[24] == 99, "frame %d", i);
        if (i == 1)
            CHECK(web_receive(&client, 0.2).event == WEB_NOTHING, "a third on its way");
        if (i > 0)
            web_text(&client, "drawn");
    }
    const struct web_message message = web_receive(&client, 1.0);
    CHECK(message.size == 11 && message.bytes[0] == VIEW_MESSAGE_END, "%zu bytes, not the end", message.size);
    web_text(&client, "hand 1 2 3");
    fixture_expect_close(&fixture, &client, 1008, "a hand, where nothing is steered");
    fixture_close(&fixture);
}

/* The newest frame, then the text; also for who comes later. */
static void the_end_comes_last(void)
{
    static const char text[] = "the run ended: 1000 ticks";
    struct view_fixture fixture;
    struct web_client clients[2];
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    fixture_client(&fixture, &clients[0]);
    CHECK(web_receive(&clients[0], 1.0).event == WEB_BINARY, "no frame");
    web_text(&clients[0], "drawn");
    view_server_end_message(fixture.server, text);
    for (int k = 0; k < 2; k++) {
        uint64_t last = 0;
        struct web_message message;
        if (k == 1)
            fixture_client(&fixture, &clients[k]);
        for (;;) {
            message = web_receive(&clients[k], 1.0);
            if (message.event != WEB_BINARY || field_of(message.bytes, 0, 4) != VIEW_MESSAGE_FRAME)
                break;
            last = field_of(message.bytes, 16, 8);
            web_text(&clients[k], "drawn");
        }
        CHECK(message.event == WEB_BINARY && message.size == 8 + sizeof text - 1 &&
                  field_of(message.bytes, 0, 4) == VIEW_MESSAGE_END &&
                  field_of(message.bytes, 4, 4) == sizeof text - 1 && !memcmp(message.bytes + 8, text, sizeof text - 1),
              "event %d, %zu bytes", (int)message.event, message.size);
        CHECK(last == FIXTURE_NUMBERS * (asked_of(&fixture) + 4), "the newest is not the last: %llu",
              (unsigned long long)last);
        view_server_end_message(fixture.server, "another");
        CHECK(web_receive(&clients[k], 0.1).event == WEB_NOTHING, "something after the end");
    }
    for (int k = 0; k < 2; k++)
        web_close(&clients[k]);
    fixture_close(&fixture);
}

/* The end message is not lost when the server closes right after it, though one client never reads. */
static void closes_with_clients(void)
{
    struct view_fixture fixture;
    struct web_client stopped, client, unknown, plain;
    fixture_prepare(&fixture, 8 * BIG, BIG);
    fixture_open(&fixture);
    CHECK(fixture_socket(&fixture, &stopped, 1) == 101, "no web socket");
    CHECK(fixture_socket(&fixture, &unknown, 0) == 101, "no web socket");
    CHECK(web_open(&plain, "127.0.0.1", fixture.port), "no connection");
    web_say(&plain, "GET / HT");
    fixture_client(&fixture, &client);
    CHECK(web_receive(&client, 2.0).event == WEB_BINARY, "no frame");
    web_text(&client, "drawn");
    const double begin = web_now();
    view_server_end_message(fixture.server, "over");
    fixture_close(&fixture);
    const double took = web_now() - begin;
    CHECK(took < 1.5, "it takes %g s to close", took);
    web_close(&stopped);
    web_close(&unknown);
    web_close(&plain);
    web_close(&client);
    /* Only with a client that answers: the end arrives, and then the close. */
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    __atomic_store_n(&fixture.paused, 1, __ATOMIC_RELAXED);
    fixture_client(&fixture, &client);
    for (int i = 0; i < 200 && fixture_counts(&fixture).messages == 0; i++)
        usleep(10000);
    view_server_end_message(fixture.server, "over");
    fixture_close(&fixture);
    struct web_message message = web_receive(&client, 1.0);
    CHECK(message.event == WEB_BINARY && field_of(message.bytes, 0, 4) == VIEW_MESSAGE_END, "event %d",
          (int)message.event);
    message = web_receive(&client, 1.0);
    CHECK(message.event == WEB_CLOSE && message.code == 1001, "event %d, code %u", (int)message.event, message.code);
    web_close(&client);
}

struct slow_reader {
    struct web_client client;
    int frames, ends;
    unsigned code; /* of the close */
};

/* A tenth of a second for each frame. */
static void *read_slowly(void *user)
{
    struct slow_reader *reader = user;
    struct web_message message;
    while ((message = web_receive(&reader->client, 2.0)).event == WEB_BINARY) {
        const int is_frame = field_of(message.bytes, 0, 4) == VIEW_MESSAGE_FRAME;
        reader->frames += is_frame;
        reader->ends += !is_frame;
        usleep(100000);
        if (is_frame)
            web_text(&reader->client, "drawn");
    }
    reader->code = message.code;
    return NULL;
}

/* Two frames are on their way when the run ends: the newest waits for one of them, and the close for that. */
static void closes_after_the_newest_was_sent(void)
{
    struct view_fixture fixture;
    struct slow_reader reader = { .frames = 0 };
    pthread_t thread;
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    fixture_client(&fixture, &reader.client);
    for (int i = 0; i < 200 && fixture_counts(&fixture).sent < 2; i++)
        usleep(10000);
    CHECK(pthread_create(&thread, NULL, read_slowly, &reader) == 0, "no thread");
    view_server_end_message(fixture.server, "over");
    fixture_close(&fixture);
    pthread_join(thread, NULL);
    CHECK(reader.frames == 3 && reader.ends == 1 && reader.code == 1001, "%d frames, %d ends, %u", reader.frames,
          reader.ends, reader.code);
    web_close(&reader.client);
}

/* Clients that come, take a part and go at any moment. */
static void clients_come_and_go(void)
{
    struct view_fixture fixture;
    uint64_t random = 1;
    fixture_prepare(&fixture, BIG / 4, BIG / 4);
    fixture_open(&fixture);
    for (int i = 0; i < 150; i++) {
        struct web_client client;
        const int with_token = random_bits(&random) % 8 != 0;
        if (fixture_socket(&fixture, &client, with_token) == 101 && with_token) {
            web_text(&client, "ready");
            web_text(&client, random_bits(&random) % 4 ? "hand 1 2 3" : "nonsense");
            for (uint64_t n = random_bits(&random) % 4; n > 0; n--) {
                if (web_receive(&client, 0.05).event != WEB_BINARY)
                    break;
                web_text(&client, "drawn");
            }
        }
        web_close(&client);
    }
    for (int i = 0; i < 200 && fixture_counts(&fixture).clients; i++)
        usleep(10000);
    CHECK(fixture_counts(&fixture).clients == 0, "%llu are left", (unsigned long long)fixture_counts(&fixture).clients);
    struct web_client client;
    struct seen seen = { 0 };
    fixture_client(&fixture, &client);
    draw(&client, &seen, BIG / 4, 0.3);
    CHECK(seen.frames > 3, "%llu frames afterwards", (unsigned long long)seen.frames);
    web_close(&client);
    fixture_close(&fixture);
}

int main(void)
{
    TEST(sixty_frames_a_second);
    TEST(two_on_their_way);
    TEST(who_does_not_read_delays_nobody);
    TEST(waiting_takes_no_time);
    TEST(recordings_are_sent_in_order);
    TEST(the_end_comes_last);
    TEST(closes_with_clients);
    TEST(closes_after_the_newest_was_sent);
    TEST(clients_come_and_go);
    return check_report();
}
