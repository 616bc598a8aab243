/* synonyms: what users of other programs call an option, and what to say about features that the programs
 * do not have. Thread-safe. */
#ifndef ISO_APPS_COMMON_SYNONYMS_H
#define ISO_APPS_COMMON_SYNONYMS_H

#include <stdbool.h>

#include "apps/common/options.h"

/* Writes what to say to someone who typed the option `name` (no dashes, lower case, words joined by '-'),
 * which the program does not have: "did you mean --isovalue?", that there is nothing like it, or "see
 * --help". False, and `text` untouched: the name is not a known word. */
bool iso_synonym_explain(const iso_program *program, const char *name, char *text, size_t size);

/* Whether someone who types `name`, in the same form, means this option of the program. */
bool iso_synonym_means(const char *name, const char *option);

#endif
