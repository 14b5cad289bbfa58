/* SPDX-License-Identifier: BSD-3-Clause */
/* What a page may say, and the token that it says first. */
#include "view/view_request.h"

#include "lib/check.h"

/* In a block of its length: a read beyond it is seen by the sanitizer. */
static enum view_request_kind parse_bytes(const char *text, size_t size, struct view_request *request)
{
    char *block = malloc(size ? size : 1);
    memcpy(block, text, size);
    const enum view_request_kind kind = view_request_parse(block, size, request);
    CHECK(kind == request->kind, "%d is returned, %d is there", kind, request->kind);
    free(block);
    return kind;
}

static enum view_request_kind parse(const char *text)
{
    struct view_request request;
    return parse_bytes(text, strlen(text), &request);
}

static void words(void)
{
    CHECK(parse("ready") == VIEW_REQUEST_READY, "ready");
    CHECK(parse("drawn") == VIEW_REQUEST_DRAWN, "drawn");
    static const char *const unknown[] = { "",       "Ready",   "ready ",  " ready", "read",
                                           "readyx", "drawn\n", "drawn 1", "hand",   "quit" };
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++)
        CHECK(parse(unknown[i]) == VIEW_REQUEST_UNKNOWN, "'%s' is known", unknown[i]);
    struct view_request request;
    CHECK(parse_bytes("ready\0", 6, &request) == VIEW_REQUEST_UNKNOWN, "a zero after it");
}

static void hands(void)
{
    struct view_request request;
    static const char text[] = "hand 0.25 -1e-3 1000000";
    CHECK(parse_bytes(text, sizeof text - 1, &request) == VIEW_REQUEST_HAND, "a hand is refused");
    CHECK(request.position[0] == 0.25 && request.position[1] == -1e-3 && request.position[2] == 1e6, "%g %g %g",
          request.position[0], request.position[1], request.position[2]);
    CHECK(parse("hand -1e6 0 0") == VIEW_REQUEST_HAND, "the limit itself");
    static const char *const unknown[] = {
        "hand 1 2",       "hand 1 2 3 4",   "hand 1 2 3 ",  "hand  1 2 3",       "hand 1  2 3",
        "hand 1\t2 3",    "hand 1,2,3",     "hand nan 0 0", "hand 0 inf 0",      "hand 0 0 -inf",
        "hand 0x1p3 0 0", "hand 1e999 0 0", "hand 1e7 0 0", "hand 0 -1000001 0", "hand 0 0 1000000.1",
        "hand1 2 3",      "Hand 1 2 3",     "hand 1 2 3x",  "hand - 0 0",        "hand 1 2 ",
    };
    for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++)
        CHECK(parse(unknown[i]) == VIEW_REQUEST_UNKNOWN, "'%s' is known", unknown[i]);
}

static void long_ones(void)
{
    char text[VIEW_REQUEST_BYTES_MAX + 1];
    struct view_request request;
    memset(text, '0', sizeof text);
    memcpy(text, "hand 0 0 0.", 11);
    CHECK(parse_bytes(text, VIEW_REQUEST_BYTES_MAX, &request) == VIEW_REQUEST_HAND, "the longest");
    CHECK(parse_bytes(text, sizeof text, &request) == VIEW_REQUEST_UNKNOWN, "one byte more");
}

static void tokens(void)
{
    struct view_token token, other;
    CHECK(view_token_make(&token) == 0 && view_token_make(&other) == 0, "no random bits");
    CHECK(strlen(token.digits) == 32 && strspn(token.digits, "0123456789abcdef") == 32, "%s", token.digits);
    CHECK(strcmp(token.digits, other.digits) != 0, "two are the same");
    CHECK(view_token_is(&token, token.digits, 32), "the token is refused");
    CHECK(!view_token_is(&token, other.digits, 32), "another is taken");
    CHECK(!view_token_is(&token, token.digits, 31) && !view_token_is(&token, token.digits, 33) &&
              !view_token_is(&token, "", 0),
          "of another length");
    for (size_t i = 0; i < 32; i++) {
        memcpy(&other, &token, sizeof token);
        other.digits[i] ^= 1;
        CHECK(!view_token_is(&token, other.digits, 32), "digit %zu is not looked at", i);
    }
}

/* Of 2000 tokens each bit is set in about half. */
static void all_bits_are_random(void)
{
    enum { TOKENS = 2000 };
    static int set[128];
    for (int n = 0; n < TOKENS; n++) {
        struct view_token token;
        CHECK(view_token_make(&token) == 0, "no random bits");
        for (int i = 0; i < 128; i++) {
            const char digit = token.digits[i / 4];
            const int value = digit <= '9' ? digit - '0' : digit - 'a' + 10;
            set[i] += value >> i % 4 & 1;
        }
    }
    /* Seven standard deviations. */
    for (int i = 0; i < 128; i++)
        CHECK(abs(set[i] - TOKENS / 2) < 157, "bit %d is set in %d of %d", i, set[i], TOKENS);
}

int main(void)
{
    TEST(words);
    TEST(hands);
    TEST(long_ones);
    TEST(tokens);
    TEST(all_bits_are_random);
    return check_report();
}
