/* SPDX-License-Identifier: BSD-3-Clause */
/* The only object of the core with atomic operations; they are lock-free, and call nothing. */
#include "dynpoint/exchange.h"
#include "exchange/latest_value.h"

typedef char latest_is_the_same[sizeof(dpt_latest) == sizeof(struct latest_value) ? 1 : -1];

void dpt_latest_init(dpt_latest *latest)
{
    if (latest)
        latest_value_init((struct latest_value *)latest);
}

void dpt_latest_publish(dpt_latest *latest)
{
    if (latest)
        latest_value_publish((struct latest_value *)latest);
}

int dpt_latest_take(dpt_latest *latest)
{
    return latest && latest_value_take((struct latest_value *)latest);
}
