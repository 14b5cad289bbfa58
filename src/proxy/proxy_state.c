/* SPDX-License-Identifier: BSD-3-Clause */
#include "proxy/proxy_state.h"

#include "proxy/proxy_constraints.h"

enum { BYTES_PROXY = 1280 };
typedef char proxy_fits[sizeof(struct proxy) <= BYTES_PROXY ? 1 : -1];

uint64_t dpti_proxy_bytes(const dpt_world_def *def)
{
    return def->until == DPT_UNTIL_RESPOND ? BYTES_PROXY * (uint64_t)def->max_tools : 0;
}

char *dpti_proxy_place(struct dpt_world *world, char *at)
{
    world->proxies = (void *)at;
    return at + dpti_proxy_bytes(&world->def);
}

int dpti_proxy_is_of(const struct dpt_world *world, uint32_t law)
{
    return law == DPT_LAW_PROXY && world->def.until == DPT_UNTIL_RESPOND && world->def.method != DPT_METHOD_PAPER;
}

int dpti_proxy_is_used(const struct dpt_world *world, const struct tool *tool)
{
    return dpti_proxy_is_of(world, tool->law);
}

void dpti_proxy_forget(struct dpt_world *world, struct tool *tool)
{
    if (world->def.until != DPT_UNTIL_RESPOND)
        return;
    struct proxy *proxy = &world->proxies[tool - world->tools];
    *proxy = (struct proxy){ .length = proxy->length, .radius = proxy->radius };
}

void dpti_proxy_forget_body(struct dpt_world *world, uint32_t body)
{
    for (uint32_t t = 0; world->def.until == DPT_UNTIL_RESPOND && t < world->tool_slot_end; t++)
        dpti_proxy_forget_contacts(&world->proxies[t], body);
}
