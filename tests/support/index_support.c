/* index_support: reads tables of test files. */
#include "index_support.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"

int check_index(const char *folder, const char *const *formats, void (*check)(const index_row *row)) {
    index_table *table = load_index(folder);
    int checked = 0;
    for (int i = 0; i < table->count; i++) {
        const index_row *row = &table->rows[i];
        bool wanted = false;
        for (int k = 0; formats[k]; k++)
            wanted = wanted || strncmp(row->format, formats[k], strlen(formats[k])) == 0;
        if (!wanted || strncmp(row->name, "bad/", 4) == 0) continue;
        check(row);
        checked++;
    }
    free(table);
    return checked;
}

const char *index_path(const char *folder, const char *name) {
    static char path[2 * INDEX_TEXT];
    snprintf(path, sizeof path, "%s/../%s/%s", ISO_TEST_VOLUMES, folder, name);
    return path;
}

static bool parse_box(const char *text, iso_box *box) {
    return sscanf(text, "%lf %lf %lf %lf %lf %lf", &box->lo.x, &box->hi.x, &box->lo.y, &box->hi.y, &box->lo.z,
                  &box->hi.z) == 6;
}

static void parse_row(const char *folder, char *line, index_row *row) {
    char *fields[4] = {0};
    for (int i = 0; i < 4; i++) fields[i] = strsep(&line, "\t");
    assert_non_null(fields[3]);
    snprintf(row->name, sizeof row->name, "%s", fields[0]);
    snprintf(row->path, sizeof row->path, "%s", index_path(folder, fields[0]));
    snprintf(row->format, sizeof row->format, "%s", fields[1]);
    snprintf(row->counts, sizeof row->counts, "%s", fields[2]);
    row->has_box = parse_box(fields[3], &row->box);
}

index_table *load_index(const char *folder) {
    FILE *file = fopen(index_path(folder, "INDEX.tsv"), "r");
    if (!file) {
        printf("%s is missing: skipped\n", index_path(folder, "INDEX.tsv"));
        skip();
    }
    index_table *table = calloc(1, sizeof *table);
    assert_non_null(table);
    char *line = NULL;
    size_t room = 0;
    for (int i = 0; getline(&line, &room, file) > 0; i++) {
        assert_true(table->count < INDEX_ROWS);
        if (i > 0) parse_row(folder, line, &table->rows[table->count++]);
    }
    free(line);
    fclose(file);
    assert_true(table->count > 0);
    return table;
}

long number_before(const char *text, const char *word) {
    const char *at = strstr(text, word);
    if (!at || at == text) return -1;
    at--;
    while (at > text && isdigit((unsigned char)at[-1])) at--;
    return isdigit((unsigned char)*at) ? strtol(at, NULL, 10) : -1;
}

static void check_number(const char *name, double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-5 * fabs(wanted) + 1e-6))
        fail_msg("%s: box: got %.9g, wanted %.9g", name, got, wanted);
}

void check_box(const char *name, const iso_box *got, const iso_box *wanted) {
    check_number(name, got->lo.x, wanted->lo.x);
    check_number(name, got->lo.y, wanted->lo.y);
    check_number(name, got->lo.z, wanted->lo.z);
    check_number(name, got->hi.x, wanted->hi.x);
    check_number(name, got->hi.y, wanted->hi.y);
    check_number(name, got->hi.z, wanted->hi.z);
}
