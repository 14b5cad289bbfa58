/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/view_request.h"

#include <math.h>
#include <string.h>

#include "text/parse_number.h"

static int is_word(const char *text, size_t size, const char *word)
{
    return size == strlen(word) && memcmp(text, word, size) == 0;
}

static int parse_position(const char *text, const char *end, double position[3])
{
    for (int k = 0; k < 3; k++) {
        if (text == end || *text != ' ')
            return 0;
        text = parse_double(text + 1, end, &position[k]);
        /* Not "<= max" turned round: it must refuse what is not a number. */
        if (!text || !(fabs(position[k]) <= VIEW_REQUEST_HAND_MAX))
            return 0;
    }
    return text == end;
}

enum view_request_kind view_request_parse(const char *text, size_t size, struct view_request *request)
{
    double position[3];
    *request = (struct view_request){ .kind = VIEW_REQUEST_UNKNOWN };
    if (size > VIEW_REQUEST_BYTES_MAX)
        return request->kind;
    if (is_word(text, size, "ready")) {
        request->kind = VIEW_REQUEST_READY;
    } else if (is_word(text, size, "drawn")) {
        request->kind = VIEW_REQUEST_DRAWN;
    } else if (size > 4 && memcmp(text, "hand", 4) == 0 && parse_position(text + 4, text + size, position)) {
        request->kind = VIEW_REQUEST_HAND;
        memcpy(request->position, position, sizeof position);
    }
    return request->kind;
}
