/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/complete.h"

#include <string.h>

#include "dynpoint/driver.h"
#include "scene/scene_list.h"

/* `before` is printed before the word, and is not compared. */
static void offer(const char *before, const char *text, const char *word)
{
    if (!strncmp(word, text, strlen(text)))
        printf("%s%s\n", before, word);
}

void complete_words(const char *text, const char *const *words)
{
    for (; *words; words++)
        offer("", text, *words);
}

/* What a device's name has to begin with, and what is printed before it. */
struct device_text {
    const char *before, *text;
};

static void offer_found(void *user, const dpt_driver *driver, const char *where, const char *about)
{
    const struct device_text *wanted = user;
    char name[256];
    (void)about;
    snprintf(name, sizeof name, "%s:%s", driver->name, where);
    offer(wanted->before, wanted->text, name);
}

/* Drivers by name; behind a colon the devices that they find. */
static void complete_device(const char *before, const char *text)
{
    const dpt_driver *driver;
    const size_t length = strcspn(text, ":");
    struct device_text wanted = { before, text };
    for (uint32_t i = 0; (driver = dpt_driver_get(i)); i++) {
        if (!text[length])
            offer(before, text, driver->name);
        else if (driver->find && strlen(driver->name) == length && !strncmp(driver->name, text, length))
            driver->find(driver, offer_found, &wanted);
    }
}

static void complete_value(const char *before, const char *text, enum value_kind kind, const char *const *words)
{
    const char *name;
    for (const char *const *word = words; word && *word; word++)
        offer(before, text, *word);
    for (uint32_t i = 0; kind == VALUE_SCENE && (name = scene_listed_name(i)); i++)
        offer(before, text, name);
    if (kind == VALUE_DEVICE)
        complete_device(before, text);
    if (kind == VALUE_SCENE || kind == VALUE_FILE)
        puts(":files");
}

static const struct option_def *option_of(const char *name, size_t length, const struct command_syntax *syntax)
{
    for (size_t i = 0; i < syntax->option_count; i++)
        if (strlen(syntax->options[i].name) == length && !memcmp(syntax->options[i].name, name, length))
            return &syntax->options[i];
    return NULL;
}

void complete_argument(int argc, char **argv, const struct command_syntax *syntax)
{
    static const char *const common[] = { "--help", "--version", NULL };
    const char *text = argc > 0 ? argv[argc - 1] : "";
    const struct option_def *taking = NULL; /* the option whose value comes next */
    size_t operands = 0;
    for (int i = 0; i + 1 < argc; i++) {
        const struct option_def *option = taking ? NULL : option_of(argv[i], strlen(argv[i]), syntax);
        if (!taking && !option && argv[i][0] != '-')
            operands++;
        taking = option && !option->flag ? option : NULL;
    }
    const char *equals = strchr(text, '=');
    if (taking) {
        complete_value("", text, taking->kind, taking->words);
    } else if (text[0] == '-' && equals) {
        const struct option_def *option = option_of(text, (size_t)(equals - text), syntax);
        char before[64];
        snprintf(before, sizeof before, "%.*s=", (int)(equals - text), text);
        if (option && !option->flag)
            complete_value(before, equals + 1, option->kind, option->words);
    } else if (text[0] == '-') {
        for (size_t i = 0; i < syntax->option_count; i++)
            offer("", text, syntax->options[i].name);
        complete_words(text, common);
    } else {
        if (syntax->repeats && operands >= syntax->operand_count)
            operands = syntax->operand_count - 1;
        if (operands < syntax->operand_count)
            complete_value("", text, syntax->operands[operands].kind, syntax->operands[operands].words);
    }
}
