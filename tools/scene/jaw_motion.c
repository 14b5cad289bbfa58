/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/jaw_motion.h"

#include <math.h>

#include "text/parse_number.h"

int jaw_motion_parse(struct jaw_motion *motion, const char *text, const char *end)
{
    double numbers[4] = { 0.0, 0.0, 0.0, -1.0 };
    int count = 0;
    for (; text && count < 4; count++) {
        text = parse_double(text, end, &numbers[count]);
        if (!text || (text < end && *text != ':'))
            return 0;
        if (text == end)
            break;
        text++;
    }
    if (count != 0 && count != 2 && count != 3)
        return 0;
    *motion = (struct jaw_motion){
        .is_given = 1, .from = numbers[0], .to = numbers[count ? 1 : 0], .seconds = numbers[2], .button = numbers[3]
    };
    return 1;
}

const char *jaw_motion_fault(const struct jaw_motion *motion)
{
    if (!(motion->from >= 0.0 && motion->from <= 1.0 && motion->to >= 0.0 && motion->to <= 1.0))
        return "its shares must be 0 to 1";
    if (!(motion->seconds >= 0.0 && motion->seconds <= 1e6))
        return "its time must be 0 to 1e6 s";
    if (motion->button == -1.0)
        return NULL;
    if (!(motion->button >= 0.0 && motion->button <= 31.0 && motion->button == floor(motion->button)))
        return "its button must be 0 to 31";
    return motion->seconds > 0.0 ? NULL : "with a button its time must be above 0";
}

double jaw_motion_time(const struct jaw_motion *motion, double time, double dt, uint32_t buttons)
{
    if (motion->button < 0.0)
        return time + dt;
    const int is_down = (int)(buttons >> (uint32_t)motion->button & 1);
    return fmax(0.0, fmin(motion->seconds, is_down ? time + dt : time - dt));
}

double jaw_motion_share(const struct jaw_motion *motion, double time)
{
    const double part = time < motion->seconds ? time / motion->seconds : 1.0;
    return motion->from + part * (motion->to - motion->from);
}
