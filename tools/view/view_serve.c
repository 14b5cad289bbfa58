/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_serve.h"

#include <stdio.h>
#include <stdlib.h>

#include "built_with.h"
#include "cli/command_options.h"
#include "platform/incbin.h"
#include "view/open_browser.h"
#include "view/view_request.h"

#ifdef DPT_HAS_VIEW_PAGE
/* The assembler reads the files, as long as they are: a compiler would take minutes for an array of these numbers. */
__asm__(EMBED_SECTION EMBED_NAME("view_page_html") ":\n .incbin \"build/view/page.html\"\n" EMBED_NAME(
    "view_page_html_end") ":\n .byte 0\n" EMBED_NAME("view_page_csp") ":\n .incbin \"build/view/page.csp.line\"\n .byte 0\n .text\n");
extern const char view_page_html[], view_page_html_end[], view_page_csp[];

struct view_page view_page_bytes(void)
{
    return (struct view_page){ .html = view_page_html,
                               .size = (size_t)(view_page_html_end - view_page_html),
                               .csp = view_page_csp };
}
#else
struct view_page view_page_bytes(void)
{
    return (struct view_page){ .html = NULL };
}
#endif

#ifdef DPT_HAS_LWS

struct view_serving {
    struct view_server *server;
    struct opened_browser browser;
};

static void open_browser(struct view_serving *serving, const char *command, const char *url)
{
    const char *fault = view_open_browser(url, &serving->browser);
    if (fault)
        complain(command, "--open: %s", fault);
}

int view_serve(const char *command, const struct run_view_options *options, const struct view_source *source,
               struct view_serving **made)
{
    const struct view_page page = view_page_bytes();
    char url[VIEW_URL_BYTES], warning[VIEW_WARNING_BYTES];
    *made = NULL;
    if (!page.html)
        return complain(command, "this build has no viewer's page, which needs node and three.js: "
                                 "make deps view, then make");
    struct view_serving *serving = calloc(1, sizeof *serving);
    if (!serving)
        return complain(command, "memory ran out");
    struct view_token token;
    const int is_kept = options->port && view_token_keep((uint16_t)options->port, &token);
    const struct view_server_def def = { .command = command,
                                         .page = page.html,
                                         .page_size = page.size,
                                         .csp = page.csp,
                                         .address = options->address,
                                         .port = (uint16_t)options->port,
                                         .token = is_kept ? &token : NULL,
                                         .control = source->heard_hand != NULL,
                                         .first = source->first,
                                         .first_count = source->first_count,
                                         .next = source->next,
                                         .heard_hand = source->heard_hand,
                                         .user = source->user };
    const char *fault = view_server_open(&def, &serving->server);
    if (fault) {
        free(serving);
        return complain(command, "the viewer: %s", fault);
    }
    view_server_url(serving->server, url);
    view_server_warning(serving->server, warning);
    fputs(warning, stderr);
    if (options->open)
        open_browser(serving, command, url);
    printf(options->json ? "{\"viewer\":\"%s\"}\n" : "the viewer: %s\n", url);
    fflush(stdout);
    *made = serving;
    return 0;
}

struct view_served view_serve_end(struct view_serving *serving, const char *why)
{
    struct view_server_counts counts;
    if (!serving)
        return (struct view_served){ .sent = 0 };
    view_server_end_message(serving->server, why);
    view_server_counts(serving->server, &counts);
    view_server_close(serving->server);
    view_close_browser(&serving->browser);
    free(serving);
    return (struct view_served){ .sent = counts.sent, .refused = counts.refused };
}

#else

int view_serve(const char *command, const struct run_view_options *options, const struct view_source *source,
               struct view_serving **made)
{
    (void)options, (void)source;
    *made = NULL;
    return complain(command, "this build cannot serve a page, which needs libwebsockets: make deps view, then make");
}

struct view_served view_serve_end(struct view_serving *serving, const char *why)
{
    (void)serving, (void)why;
    return (struct view_served){ .sent = 0 };
}

#endif
