/* SPDX-License-Identifier: BSD-3-Clause */
/* Prints what the toy answers. */
#include <stdio.h>

#include "dynpoint.h"
#ifdef TOY_APART
#include "dynpoint/extra.h"
#endif

int main(void)
{
    for (int x = -1; x < 30; x += 3)
        printf("%d %d %d %d %d\n", dpt_one(x), dpt_two(x), dpt_three(x), dpt_shared(x), dpt_extra(x));
    printf("%s\n%s\n", dpt_words(0), dpt_words(1));
    return 0;
}
