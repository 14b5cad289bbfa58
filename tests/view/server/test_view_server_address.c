/* SPDX-License-Identifier: BSD-3-Clause */
/* Where the viewer's server listens, what it does to the process, and what cannot be opened. */
#define _GNU_SOURCE
#include "view/server/view_server.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "lib/check.h"
#include "view/server/view_fixture.h"

/* An address of this machine that is not its own loop, or 0. */
static int outer_address(char text[INET_ADDRSTRLEN])
{
    struct ifaddrs *all = NULL;
    int found = 0;
    if (getifaddrs(&all))
        return 0;
    for (struct ifaddrs *one = all; one && !found; one = one->ifa_next) {
        if (!one->ifa_addr || one->ifa_addr->sa_family != AF_INET)
            continue;
        const struct sockaddr_in *four = (const void *)one->ifa_addr;
        found = ntohl(four->sin_addr.s_addr) >> 24 != 127 &&
                inet_ntop(AF_INET, &four->sin_addr, text, INET_ADDRSTRLEN) != NULL;
    }
    freeifaddrs(all);
    return found;
}

static int answers(const char *address, uint16_t port)
{
    struct web_client client;
    const int open = web_open(&client, address, port);
    web_close(&client);
    return open;
}

static int has_local_6(void)
{
    struct sockaddr_in6 six = { .sin6_family = AF_INET6, .sin6_addr = IN6ADDR_LOOPBACK_INIT };
    const int probe = socket(AF_INET6, SOCK_STREAM, 0);
    const int has = probe >= 0 && bind(probe, (const struct sockaddr *)&six, sizeof six) == 0;
    if (probe >= 0)
        close(probe);
    return has;
}

static void this_machine_alone(void)
{
    struct view_fixture fixture;
    char outer[INET_ADDRSTRLEN], warning[VIEW_WARNING_BYTES], url[VIEW_URL_BYTES];
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    CHECK(answers("127.0.0.1", fixture.port), "not at 127.0.0.1");
    CHECK(!answers("127.0.0.2", fixture.port), "at 127.0.0.2 too");
    if (has_local_6()) {
        struct web_client client;
        char host[40], origin[48];
        snprintf(host, sizeof host, "[::1]:%u", (unsigned)fixture.port);
        snprintf(origin, sizeof origin, "http://%s", host);
        CHECK(web_open(&client, "::1", fixture.port) && web_upgrade(&client, host, origin) == 101, "not at ::1");
        web_close(&client);
    } else {
        SKIP("::1", "this machine has no such address");
    }
    if (outer_address(outer))
        CHECK(!answers(outer, fixture.port), "at %s too", outer);
    else
        SKIP("an outer address", "this machine has none");
    view_server_warning(fixture.server, warning);
    CHECK(warning[0] == '\0', "%s", warning);
    view_server_url(fixture.server, url);
    CHECK(strncmp(url, fixture.origin, strlen(fixture.origin)) == 0 &&
              !strcmp(url + strlen(fixture.origin), "/#") == 0 && strlen(strchr(url, '#')) == 33,
          "the address is not %s/#TOKEN", fixture.origin);
    fixture_close(&fixture);
}

static void an_address_that_is_given(void)
{
    struct view_fixture fixture;
    char warning[VIEW_WARNING_BYTES];
    fixture_prepare(&fixture, 3000, 1000);
    fixture.def.address = "127.0.0.2";
    fixture_open(&fixture);
    CHECK(answers("127.0.0.2", fixture.port), "not where it was asked for");
    CHECK(!answers("127.0.0.1", fixture.port), "at 127.0.0.1 too");
    view_server_warning(fixture.server, warning);
    CHECK(warning[0] == '\0', "%s", warning);
    fixture_close(&fixture);

    fixture_prepare(&fixture, 3000, 1000);
    fixture.def.address = "0.0.0.0";
    fixture_open(&fixture);
    CHECK(answers("127.0.0.2", fixture.port) && answers("127.0.0.1", fixture.port), "not everywhere");
    view_server_warning(fixture.server, warning);
    char tunnel[64];
    snprintf(tunnel, sizeof tunnel, "ssh -N -L %u:127.0.0.1:%u ", (unsigned)fixture.port, (unsigned)fixture.port);
    CHECK(strstr(warning, "nothing is encrypted") && strstr(warning, tunnel) && strstr(warning, "0.0.0.0") &&
              strstr(warning, "dynpoint view liver.dpa"),
          "%s", warning);
    CHECK(!strstr(warning, fixture.token), "the token is in the warning");
    struct web_client client;
    CHECK(fixture_socket(&fixture, &client, 1) == 101 && web_receive(&client, 2.0).event == WEB_BINARY, "not served");
    web_close(&client);
    fixture_close(&fixture);
    if (!has_local_6())
        return;
    fixture_prepare(&fixture, 3000, 1000);
    fixture.def.address = "::1";
    fixture_open(&fixture);
    CHECK(answers("::1", fixture.port) && !answers("127.0.0.1", fixture.port), "not at ::1 alone");
    fixture_close(&fixture);
    fixture_prepare(&fixture, 3000, 1000);
    fixture.def.address = "::";
    fixture_open(&fixture);
    view_server_warning(fixture.server, warning);
    CHECK(answers("::1", fixture.port) && strstr(warning, "nothing is encrypted"), "%s", warning);
    fixture_close(&fixture);
}

static void what_cannot_be_opened(void)
{
    struct view_fixture fixture;
    struct view_server *server;
    fixture_prepare(&fixture, 3000, 1000);
    fixture_open(&fixture);
    fixture.def.port = fixture.port;
    const char *fault = view_server_open(&fixture.def, &server);
    CHECK(fault && strstr(fault, "port") && !server, "a port that is taken: %s", fault);
    fixture.def.port = 0;
    fixture.def.address = "localhost";
    fault = view_server_open(&fixture.def, &server);
    CHECK(fault && strstr(fault, "address") && !server, "a name: %s", fault);
    fixture.def.address = "192.0.2.1";
    fault = view_server_open(&fixture.def, &server);
    CHECK(fault && !server, "another machine's address");
    view_server_close(NULL);
    fixture_close(&fixture);
}

static volatile int on_usr1;
static volatile pthread_t heard_by;
static void note(int number)
{
    on_usr1 += number == SIGUSR1;
    heard_by = pthread_self();
}

static int files_open(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    while (folder && readdir(folder))
        count++;
    if (folder)
        closedir(folder);
    return count;
}

/* Signals stay as they are, and go to the program's threads; no stream is written to; files are closed. */
static void leaves_the_process_alone(void)
{
    struct view_fixture fixture;
    struct web_client client;
    struct sigaction pipe = { .sa_handler = note }, after, usr1 = { .sa_handler = note };
    int streams[2], saved[2];
    char text[256];
    const int files = files_open();
    sigaction(SIGPIPE, &pipe, NULL);
    sigaction(SIGUSR1, &usr1, NULL);
    CHECK(pipe2(streams, O_NONBLOCK) == 0, "no pipe");
    fflush(stdout);
    for (int i = 0; i < 2; i++) {
        saved[i] = dup(1 + i);
        dup2(streams[1], 1 + i);
    }
    fixture_prepare(&fixture, 4000000, 1000);
    fixture_open(&fixture);
    sigset_t only, before;
    sigemptyset(&only);
    sigaddset(&only, SIGUSR1);
    pthread_sigmask(SIG_BLOCK, &only, &before);
    kill(getpid(), SIGUSR1);
    usleep(50000);
    const int taken_by_server = on_usr1;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    /* Who leaves in the middle of the scene would raise SIGPIPE. */
    for (int i = 0; i < 20; i++) {
        fixture_socket(&fixture, &client, 1);
        web_text(&client, "ready");
        web_close(&client);
    }
    web_open(&client, "127.0.0.1", fixture.port);
    web_say(&client, "nonsense\r\n\r\n");
    web_ends(&client, 3.0);
    web_close(&client);
    fixture_close(&fixture);
    for (int i = 0; i < 2; i++) {
        dup2(saved[i], 1 + i);
        close(saved[i]);
    }
    const ssize_t written = read(streams[0], text, sizeof text - 1);
    close(streams[0]);
    close(streams[1]);
    CHECK(written <= 0, "it writes: %.*s", written > 0 ? (int)written : 0, text);
    sigaction(SIGPIPE, NULL, &after);
    CHECK(after.sa_handler == note, "SIGPIPE is the server's now");
    CHECK(taken_by_server == 0 && on_usr1 == 1, "the server's thread takes signals: %d", taken_by_server);
    CHECK(pthread_equal(heard_by, pthread_self()), "by another thread");
    CHECK(files_open() == files, "%d files are open, before %d", files_open(), files);
}

int main(void)
{
    TEST(this_machine_alone);
    TEST(an_address_that_is_given);
    TEST(what_cannot_be_opened);
    TEST(leaves_the_process_alone);
    return check_report();
}
