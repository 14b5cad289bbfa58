/* SPDX-License-Identifier: BSD-3-Clause */
/* Which Host and which Origin is this server. */
#include "view/view_request.h"

#include "lib/check.h"

static void expect(const struct view_host *host, const char *const *texts, int own)
{
    for (; *texts; texts++)
        CHECK(view_host_is_own(host, *texts) == own, "'%s' at %s:%u is %s", *texts,
              host->address ? host->address : "this machine", (unsigned)host->port, own ? "refused" : "taken");
}

static void of_this_machine(void)
{
    const struct view_host host = { NULL, 8123 };
    expect(&host, (const char *const[]){ "127.0.0.1:8123", "localhost:8123", "[::1]:8123", NULL }, 1);
    expect(&host,
           (const char *const[]){ "",
                                  "127.0.0.1",
                                  "localhost",
                                  "127.0.0.1:8124",
                                  "127.0.0.1:81234",
                                  "127.0.0.1:8123x",
                                  "x127.0.0.1:8123",
                                  "127.0.0.2:8123",
                                  "::1:8123",
                                  "[localhost]:8123",
                                  "[127.0.0.1]:8123",
                                  "evil.example:8123",
                                  "localhost.evil.example:8123",
                                  "192.0.2.1:8123",
                                  "0.0.0.0:8123",
                                  ":8123",
                                  "[]:8123",
                                  "127.0.0.1:8123,localhost:8123",
                                  "a-name-that-is-longer-than-any-address-in-numbers.example:8123",
                                  NULL },
           0);
}

static void at_an_address(void)
{
    const struct view_host four = { "192.0.2.1", 8123 }, six = { "2001:db8:0:0::1", 8123 };
    expect(&four, (const char *const[]){ "192.0.2.1:8123", "localhost:8123", NULL }, 1);
    expect(&four, (const char *const[]){ "192.0.2.2:8123", "[192.0.2.1]:8123", "192.0.2.1", NULL }, 0);
    expect(&six, (const char *const[]){ "[2001:db8::1]:8123", NULL }, 1);
    expect(&six, (const char *const[]){ "2001:db8::1:8123", "[2001:db8::2]:8123", NULL }, 0);
}

static void at_every_address(void)
{
    const struct view_host every = { "0.0.0.0", 8123 };
    expect(&every, (const char *const[]){ "192.0.2.7:8123", "[2001:db8::1]:8123", NULL }, 1);
    expect(&every, (const char *const[]){ "evil.example:8123", "192.0.2.7:1", NULL }, 0);
}

static void at_the_port_of_http(void)
{
    const struct view_host host = { NULL, 80 };
    expect(&host, (const char *const[]){ "localhost", "127.0.0.1:80", "[::1]", NULL }, 1);
    expect(&host, (const char *const[]){ "localhost:8080", "::1", "evil.example", NULL }, 0);
}

static void origins(void)
{
    const struct view_host host = { NULL, 8123 }, every = { "0.0.0.0", 8123 };
    CHECK(view_origin_is_own(&host, "127.0.0.1:8123", "http://127.0.0.1:8123"), "its own");
    CHECK(view_origin_is_own(&host, "[::1]:8123", "http://[::1]:8123"), "its own");
    static const char *const others[] = { "null",
                                          "",
                                          "http://evil.example",
                                          "https://127.0.0.1:8123",
                                          "http://127.0.0.1:9999",
                                          "http://127.0.0.1:8123/",
                                          "http://127.0.0.1:8123.evil.example",
                                          "file://",
                                          "127.0.0.1:8123",
                                          "http://localhost:8123" };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        CHECK(!view_origin_is_own(&host, "127.0.0.1:8123", others[i]), "%s is taken", others[i]);
    CHECK(!view_origin_is_own(&host, "evil.example:8123", "http://evil.example:8123"),
          "another's Host and Origin that agree");
    CHECK(!view_origin_is_own(&every, "192.0.2.7:8123", "http://192.0.2.8:8123"), "another machine's page");
}

static void addresses(void)
{
    CHECK(view_address_kind("127.0.0.1") == VIEW_ADDRESS_4, "version 4");
    CHECK(view_address_kind("::") == VIEW_ADDRESS_6, "version 6");
    CHECK(view_address_kind("localhost") == VIEW_ADDRESS_INVALID, "a name");
    CHECK(view_address_kind("[::1]") == VIEW_ADDRESS_INVALID, "brackets");
    CHECK(view_address_is_local("127.3.2.1") && view_address_is_local("::1"), "local");
    CHECK(!view_address_is_local("0.0.0.0") && !view_address_is_local("::") && !view_address_is_local("192.0.2.1"),
          "not local");
    CHECK(view_address_is_every("0.0.0.0") && view_address_is_every("::"), "every");
    CHECK(!view_address_is_every("127.0.0.1") && !view_address_is_every("::1"), "not every");
}

int main(void)
{
    TEST(of_this_machine);
    TEST(at_an_address);
    TEST(at_every_address);
    TEST(at_the_port_of_http);
    TEST(origins);
    TEST(addresses);
    return check_report();
}
