/* xyz: two formats under one extension. A molecule: the number of atoms, a row of comment, and a row for each
 * atom: its element, or atomic number, and x y z in ångström. Or points: rows of numbers (point_rows.h). A
 * first row of one whole number tells them apart.
 *
 * Of several frames the first is read. Text after a molecule's coordinates is ignored. */
#include <ctype.h>

#include "io/glyphs/atoms.h"
#include "io/glyphs/elements.h"
#include "io/glyphs/point_rows.h"

static const char separators[] = ",;";

typedef struct xyz {
    iso_text_rows rows;
    iso_polydata *data;
} xyz;

/* ---- molecules */

/* Returns the element of the first word, such as "C", "6", or a label such as "C12"; 0: unknown. */
static int element_of(const char *word) {
    int letters = 0;
    double number = 0;
    char *rest = (char *)word;
    if (iso_row_number(&rest, "", &number)) return iso_element_of_number(number);
    while (isalpha((unsigned char)word[letters])) letters++;
    return iso_element_of(word, letters);
}

static iso_status take_atom(xyz *x, char *row, iso_atoms *atoms, iso_error *error) {
    double p[3];
    char *word = row ? iso_row_word(&row) : NULL;
    if (!row) return iso_fail(error, ISO_ERR_IO, "%s: truncated: atoms are missing", x->rows.reading->path);
    if (!word) return iso_text_rows_fail(&x->rows, "not an atom", error);
    for (int axis = 0; axis < 3; axis++)
        if (!iso_row_number(&row, separators, &p[axis]))
            return iso_text_rows_fail(&x->rows, "not an atom", error);
    iso_atoms_add(atoms, element_of(word), p);
    return ISO_OK;
}

static iso_status read_molecule(xyz *x, double promised, iso_error *error) {
    iso_atoms atoms;
    /* an atom takes at least eight bytes, "C 0 0 0" and the end of the row, which the last row may lack */
    if (promised > (double)(x->rows.end - x->rows.at + 1) / 8)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it promises %.0f atoms", x->rows.reading->path,
                        promised);
    iso_text_rows_next(&x->rows); /* skips the row of comment */
    ISO_TRY(iso_atoms_begin(x->data, (size_t)promised, &atoms, error));
    for (size_t i = 0; i < (size_t)promised; i++)
        ISO_TRY(take_atom(x, iso_text_rows_next(&x->rows), &atoms, error));
    iso_atoms_end(&atoms);
    if (iso_point_rows_next(&x->rows))
        iso_reading_note(x->data->reading, "further frames follow: only the first is read");
    return ISO_OK;
}

static iso_status read_xyz(xyz *x, iso_error *error) {
    double atoms;
    ISO_TRY(iso_text_rows_load(x->data->reading, &x->rows, error));
    char *first = iso_point_rows_next(&x->rows);
    if (!first) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", x->rows.reading->path);
    return iso_point_rows_is_count(first, &atoms) ? read_molecule(x, atoms, error)
                                                  : iso_point_rows_read(x->data, &x->rows, first, error);
}

iso_status iso_polydata_read_xyz(iso_polydata *data, iso_error *error) {
    xyz x = {.data = data};
    const iso_status status = read_xyz(&x, error);
    iso_text_rows_free(&x.rows);
    return status;
}
