/* index_support: the files of ../shared that INDEX.tsv lists, with their counts and boxes. They may be
 * missing: tests then skip, and say so. */
#ifndef ISO_TESTS_INDEX_SUPPORT_H
#define ISO_TESTS_INDEX_SUPPORT_H

#include <stdbool.h>

#include "base/geometry.h"

enum { INDEX_ROWS = 256, INDEX_TEXT = 512 };

typedef struct index_row {
    char path[2 * INDEX_TEXT]; /* of the file */
    char name[INDEX_TEXT];     /* the same, relative to the folder of INDEX.tsv */
    char format[64], counts[INDEX_TEXT];
    bool has_box;
    iso_box box; /* in the file's own coordinates */
} index_row;

typedef struct index_table {
    index_row rows[INDEX_ROWS];
    int count;
} index_table;

/* Reads ../shared/FOLDER/INDEX.tsv ("lines", "points"), to be released with free(); skips the test if it is
 * missing. */
index_table *load_index(const char *folder);

/* Calls `check` for each row of a table, except damaged files (bad/), whose format begins with one of
 * `formats`, a list that ends with NULL. Returns the number of these rows; skips the test as load_index does.
 */
int check_index(const char *folder, const char *const *formats, void (*check)(const index_row *row));

/* The path of a file in ../shared/FOLDER, in a static buffer. */
const char *index_path(const char *folder, const char *name);

/* The number before `word` in a text such as "3 streamlines, 8 points"; -1 if there is none. */
long number_before(const char *text, const char *word);

/* Fails the test unless the boxes agree to the six digits that the table has. */
void check_box(const char *name, const iso_box *got, const iso_box *wanted);

#endif
