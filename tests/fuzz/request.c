/* SPDX-License-Identifier: BSD-3-Clause */
/* What a viewer's page says: one of the words, or a hand whose numbers are finite and in their range. */
#include "view/view_request.h"

#include <math.h>
#include <string.h>

#include "fuzz/target.h"

FUZZ_TARGET(request)
{
    struct view_request request;
    const char *text = (const char *)bytes;
    const enum view_request_kind kind = view_request_parse(text, size, &request);
    MUST(kind == request.kind && kind <= VIEW_REQUEST_HAND);
    if (kind == VIEW_REQUEST_READY || kind == VIEW_REQUEST_DRAWN)
        MUST(size == 5 && !memcmp(text, kind == VIEW_REQUEST_READY ? "ready" : "drawn", 5));
    if (kind == VIEW_REQUEST_HAND) {
        int spaces = 0;
        MUST(size >= 10 && !memcmp(text, "hand ", 5));
        for (size_t i = 0; i < size; i++) {
            spaces += text[i] == ' ';
            MUST(i < 5 || strchr(" +-.0123456789eE", text[i]));
            MUST(text[i] != '\0');
        }
        MUST(spaces == 3 && text[size - 1] != ' ');
    }
    for (int k = 0; k < 3; k++) {
        MUST(fabs(request.position[k]) <= VIEW_REQUEST_HAND_MAX);
        MUST(kind == VIEW_REQUEST_HAND || request.position[k] == 0.0);
    }
    fuzz_accepted += kind != VIEW_REQUEST_UNKNOWN;
    return 0;
}
