/* SPDX-License-Identifier: BSD-3-Clause */
/* For including more than once: KIND(name) and LIMIT are the includer's. */
#define PICK(a, b) ((a) < (b) ? (a) : (b))
static int KIND(helper)(int x)
{
    return PICK(x, LIMIT);
}

int KIND(least)(int x)
{
    return KIND(helper)(x);
}

int KIND(most)(int x)
{
    return x > LIMIT ? x : LIMIT;
}

const char *KIND(name)(void)
{
    return "KIND LIMIT helper";
}
