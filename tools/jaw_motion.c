/* SPDX-License-Identifier: BSD-3-Clause */
#include "jaw_motion.h"

#include <string.h>

#include "text/parse_number.h"

int jaw_motion_parse(struct jaw_motion *motion, const char *text, const char *end)
{
    double numbers[3] = { 0.0 };
    int count = 0;
    for (; text && count < 3; count++) {
        text = parse_double(text, end, &numbers[count]);
        if (!text || (text < end && *text != ':'))
            return 0;
        if (text == end)
            break;
        text++;
    }
    if (count != 0 && count != 2)
        return 0;
    *motion = (struct jaw_motion){
        .is_given = 1, .from = numbers[0], .to = numbers[count ? 1 : 0], .seconds = numbers[2]
    };
    return 1;
}

const char *jaw_motion_fault(const struct jaw_motion *motion)
{
    if (!(motion->from >= 0.0 && motion->from <= 1.0 && motion->to >= 0.0 && motion->to <= 1.0))
        return "its shares must be 0 to 1";
    return motion->seconds >= 0.0 && motion->seconds <= 1e6 ? NULL : "its time must be 0 to 1e6 s";
}

double jaw_motion_share(const struct jaw_motion *motion, double time)
{
    const double part = time < motion->seconds ? time / motion->seconds : 1.0;
    return motion->from + part * (motion->to - motion->from);
}
