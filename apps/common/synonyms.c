#include "apps/common/synonyms.h"

#include <string.h>

#include "base/text.h"

/* words: separated by blanks. options: those that the words mean, the best one first, of which a program
 * names the ones that it has; NULL: no program has such an option. note: what is said instead of "did you
 * mean"; NULL: nothing. Of a row whose options a program does not have it says no more than "see --help". */
static const struct synonym {
    const char *words, *options, *note;
} synonyms[] = {
#include "apps/common/synonyms.inc"
};

/* Appends "--NAME or --NAME ..": those of the options that the program has, two at most; returns their
 * number. */
static int list_options(const iso_program *program, const char *options, char *text, size_t size) {
    int count = 0;
    while (options && *options && count < 2) {
        const size_t length = strcspn(options, " "), used = strlen(text);
        const iso_option *option = iso_options_find(program, options, length);
        if (option && !(option->flags & ISO_OPTION_HIDDEN))
            snprintf(text + used, size - used, "%s--%.*s", count++ ? " or " : "", (int)length, options);
        options += length + (options[length] == ' ');
    }
    return count;
}

bool iso_synonym_means(const char *name, const char *option) {
    for (size_t i = 0; i < sizeof synonyms / sizeof *synonyms; i++)
        if (iso_text_has_word(synonyms[i].words, name, strlen(name)))
            return synonyms[i].options && iso_text_has_word(synonyms[i].options, option, strlen(option));
    return false;
}

bool iso_synonym_explain(const iso_program *program, const char *name, char *text, size_t size) {
    for (size_t i = 0; i < sizeof synonyms / sizeof *synonyms; i++) {
        const struct synonym *row = &synonyms[i];
        char names[128] = "";
        if (!iso_text_has_word(row->words, name, strlen(name))) continue;
        if (row->options && !list_options(program, row->options, names, sizeof names))
            snprintf(text, size, "see --help");
        else
            snprintf(text, size, row->note ? "%s" : "did you mean %s?", row->note ? row->note : names);
        return true;
    }
    return false;
}
