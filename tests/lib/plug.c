/* SPDX-License-Identifier: BSD-3-Clause */
#include "lib/plug.h"

#include <signal.h>

#include "lib/check.h"

void plug_signal(const struct plug *plug, const struct plug_kind *kind)
{
    kill(plug->host.process, kind->goes_on ? SIGSTOP : kind->status == 128 + SIGKILL ? SIGKILL : SIGINT);
}

void plug_give_up(struct plug *plug)
{
    struct child *host = &plug->host;
    kill(host->process, SIGINT);
    child_end(host, plug->patience);
    CHECK(host->status == 0 || (host->status == 2 && host->text[0]), "it ends before the plug is pulled: %d, %s",
          host->status, host->text);
}

void plug_check_end(struct plug *plug, const struct plug_kind *kind, int was_running)
{
    struct child *host = &plug->host;
    kill(host->process, SIGCONT);
    if (kind->goes_on || !was_running) {
        /* It finds a fault that stays, on a busy machine a while later, and no force comes back. */
        plug->wait_for(was_running ? 1.0 : 2.0, plug->has_ended);
        CHECK(!was_running || !plug->is_pushing(), "the force comes back");
        kill(host->process, SIGINT);
    }
    const int ended = plug->wait_for(plug->patience, plug->has_ended);
    child_end(host, 1.0);
    CHECK(ended, "%s: it does not end", kind->name);
    /* On a busy machine samples may be late besides. */
    const int is_lost = host->status == 2 && strstr(host->text, "the device is gone");
    CHECK(!was_running || (host->status == kind->status && strstr(host->text, kind->says)) ||
              (kind->goes_on && is_lost),
          "%s: status %d, '%s'", kind->name, host->status, host->text);
}

void plug_note(struct plug_kind *kind, int was_running, int was_pushing, unsigned ms, unsigned guarded)
{
    kind->pulls++;
    kind->running += (unsigned)was_running;
    kind->pushing += (unsigned)was_pushing;
    kind->longest = ms > kind->longest ? ms : kind->longest;
    kind->guarded = guarded > kind->guarded ? guarded : kind->guarded;
}

static void print_seen(const struct plug_kind *kind)
{
    printf("    %s: %u pulls, %u of them as it ran, %u with a force", kind->name, kind->pulls, kind->running,
           kind->pushing);
    if (kind->longest)
        printf(": gone within %u ms", kind->longest);
    if (kind->guarded)
        printf(", after %u commands", kind->guarded);
    putchar('\n');
}

void plug_pull_all(struct plug *plug, unsigned long pulls, int (*run)(int must_push), void (*pull)(int kind))
{
    const unsigned long count = (unsigned long)plug->kind_count;
    unsigned long done = 0;
    unsigned pushing = 0;
    for (unsigned long i = 0; done < pulls && i < 3 * pulls && !check_bad; i++)
        if (run((done % count + done / count) % 2 == 0))
            pull((int)(done++ % count));
    for (int k = 0; k < plug->kind_count; k++) {
        print_seen(&plug->kinds[k]);
        pushing += plug->kinds[k].pushing;
    }
    CHECK(check_bad || 4 * pushing >= done, "only %u of %lu pulls were with a force", pushing, done);
    if (done < pulls)
        SKIP("some pulls of the plug", plug->busy);
}
