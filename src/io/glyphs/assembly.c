/* assembly: remarks 350 of .pdb files (wwPDB, "Atomic Coordinate Entry Format Version 3.3", remark 350):
 *
 *     REMARK 350 BIOMOLECULE: 1
 *     REMARK 350 APPLY THE FOLLOWING TO CHAINS: A, B,
 *     REMARK 350                    AND CHAINS: C
 *     REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
 *     REMARK 350   BIOMT2   1  .. */
#include "io/glyphs/assembly.h"

#include <string.h>

bool iso_pdb_number(const char *row, int from, int to, double *number) {
    char field[32];
    const size_t length = strlen(row);
    size_t count = 0;
    for (size_t i = (size_t)from; i < (size_t)to && i < length && count + 1 < sizeof field; i++)
        field[count++] = row[i];
    field[count] = 0;
    char *at = field;
    return iso_row_number(&at, "", number) && *at == 0;
}

/* Marks the chains in a list such as "A, B". A chain without a name is listed as "NULL", and has a blank in
 * the rows of its atoms. */
static void take_chains(iso_assembly *assembly, const char *names) {
    for (; *names; names++) {
        const char *end = names + strcspn(names, ", ");
        const size_t length = (size_t)(end - names);
        if (length == 1) assembly->chains[(unsigned char)names[0]] = true;
        if (length == 4 && memcmp(names, "NULL", 4) == 0) assembly->chains[' '] = true;
        if (!*end) break;
        names = end;
    }
    assembly->has_chains = true;
}

static iso_status begin_copy(iso_assembly *assembly, const iso_text_rows *rows, iso_error *error) {
    const size_t count = assembly->count;
    if (assembly->next_row != 0) return iso_text_rows_fail(rows, "a BIOMT matrix is not complete", error);
    ISO_TRY(iso_reading_reserve(rows->reading, &assembly->buffer, count + 1, sizeof *assembly->copies, count,
                                error));
    assembly->copies = assembly->buffer.data;
    iso_assembly_copy *copy = &assembly->copies[assembly->count++];
    memcpy(copy->chains, assembly->chains, sizeof copy->chains);
    if (!assembly->has_chains) memset(copy->chains, true, sizeof copy->chains);
    return ISO_OK;
}

/* Returns the column after the number of the copy. The columns behind it are shifted when the number has more
 * than three digits. */
static int end_of_number(const char *row) {
    int at = 19;
    while (row[at] == ' ') at++;
    while (row[at] >= '0' && row[at] <= '9') at++;
    return at;
}

/* Reads a row such as "BIOMT2 1 m m m t". The numbers have fixed columns, and may follow each other without a
 * blank. */
static iso_status take_matrix_row(iso_assembly *assembly, const iso_text_rows *rows, const char *row,
                                  iso_error *error) {
    static const int columns[5] = {0, 10, 20, 30, 45};
    const int index = row[18] - '1', begin = end_of_number(row);
    if (index < 0 || index > 2) return iso_text_rows_fail(rows, "not a BIOMT row", error);
    if (index == 0) ISO_TRY(begin_copy(assembly, rows, error));
    if (index != assembly->next_row || assembly->count == 0)
        return iso_text_rows_fail(rows, "a BIOMT matrix is not complete", error);
    for (int k = 0; k < 4; k++) {
        double *to = &assembly->copies[assembly->count - 1].matrix[4 * index + k];
        if (!iso_pdb_number(row, begin + columns[k], begin + columns[k + 1], to) ||
            !(*to >= -1e9 && *to <= 1e9))
            return iso_text_rows_fail(rows, "a number of a BIOMT matrix is missing", error);
    }
    assembly->next_row = (index + 1) % 3;
    return ISO_OK;
}

iso_status iso_assembly_take(iso_assembly *assembly, const iso_text_rows *rows, const char *row,
                             iso_error *error) {
    const char *chains = strstr(row, "CHAINS:");
    const bool matrix = strlen(row) > 18 && memcmp(row + 13, "BIOMT", 5) == 0;
    if (strstr(row, "BIOMOLECULE:")) {
        assembly->current++;
        assembly->has_chains = assembly->named_before = false;
        memset(assembly->chains, 0, sizeof assembly->chains);
    }
    if (matrix && assembly->current == 0) assembly->current = 1; /* old files do not number assemblies */
    if (assembly->current != assembly->wanted) return ISO_OK;
    if (chains) {
        if (!assembly->named_before) memset(assembly->chains, 0, sizeof assembly->chains);
        take_chains(assembly, chains + 7 + strspn(chains + 7, " "));
    }
    assembly->named_before = chains != NULL;
    return matrix ? take_matrix_row(assembly, rows, row, error) : ISO_OK;
}

void iso_assembly_free(iso_assembly *assembly, iso_reading *reading) {
    iso_reading_free(reading, &assembly->buffer);
}
