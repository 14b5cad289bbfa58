/* SPDX-License-Identifier: BSD-3-Clause */
#include "view/page_bytes.h"

#include "built_with.h"

#ifdef DPT_HAS_VIEW_PAGE
/* The assembler reads the files, as long as they are: a compiler would take minutes for an array of these numbers. */
__asm__(".pushsection .rodata\n"
        ".local view_page_html, view_page_html_end, view_page_csp\n"
        "view_page_html:\n .incbin \"build/view/page.html\"\n"
        "view_page_html_end:\n .byte 0\n"
        "view_page_csp:\n .incbin \"build/view/page.csp.line\"\n .byte 0\n"
        ".popsection\n");
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
