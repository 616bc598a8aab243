/* xyz: two formats under one extension. A molecule: the number of atoms, a row of comment, and a row for each
 * atom: its element, or atomic number, and x y z in ångström. Or points: rows of numbers (point_rows.h). A
 * first row of one whole number tells them apart.
 *
 * Of several frames the first is read. Text after a molecule's coordinates is ignored. */
#include <ctype.h>
#include <string.h>

#include "io/glyphs/elements.h"
#include "io/glyphs/glyphs_format.h"
#include "io/glyphs/point_rows.h"
#include "io/polydata/polydata.h"

static const char separators[] = ",;";

typedef struct xyz {
    iso_rows rows;
    iso_polydata data;
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

static iso_status take_atom(xyz *x, char *row, float *radius, float color[3], uint64_t *unknown,
                            iso_error *error) {
    double p[3];
    uint8_t bytes[3];
    char *word = row ? iso_row_word(&row) : NULL;
    if (!row) return iso_fail(error, ISO_ERR_IO, "%s: truncated: atoms are missing", x->rows.reading->path);
    if (!word) return iso_rows_fail(&x->rows, "not an atom", error);
    for (int axis = 0; axis < 3; axis++)
        if (!iso_row_number(&row, separators, &p[axis])) return iso_rows_fail(&x->rows, "not an atom", error);
    const int element = element_of(word);
    *unknown += element == 0;
    *radius = iso_element_radius(element);
    iso_element_color(element, bytes);
    for (int k = 0; k < 3; k++) color[k] = bytes[k];
    iso_polydata_add_point(&x->data, p);
    return ISO_OK;
}

static iso_status read_molecule(xyz *x, double atoms, iso_error *error) {
    int radius, colors;
    uint64_t unknown = 0;
    /* an atom takes at least eight bytes, "C 0 0 0" and the end of the row, which the last row may lack */
    if (atoms > (double)(x->rows.end - x->rows.at + 1) / 8)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it promises %.0f atoms", x->rows.reading->path,
                        atoms);
    const size_t count = (size_t)atoms;
    iso_rows_next(&x->rows); /* skips the row of comment */
    ISO_TRY(iso_polydata_add_column(&x->data, "radius", 1, false, ISO_ROLE_RADIUS, &radius, error));
    ISO_TRY(iso_polydata_add_column(&x->data, "colors", 3, false, ISO_ROLE_COLOR, &colors, error));
    ISO_TRY(iso_polydata_reserve(&x->data, count, error));
    float *radii = iso_polydata_column(&x->data, radius)->values.data,
          *rgb = iso_polydata_column(&x->data, colors)->values.data;
    for (size_t i = 0; i < count; i++)
        ISO_TRY(take_atom(x, iso_rows_next(&x->rows), &radii[i], &rgb[3 * i], &unknown, error));
    if (unknown)
        iso_reading_note(x->data.reading, "%llu atoms are of unknown elements", (unsigned long long)unknown);
    if (iso_point_rows_next(&x->rows))
        iso_reading_note(x->data.reading, "further frames follow: only the first is read");
    x->data.reading->opts.every = 1;
    x->data.reading->report->unit = ISO_WORLD_UNIT_ANGSTROM;
    return ISO_OK;
}

static iso_status read_xyz(xyz *x, iso_glyphs *glyphs, iso_error *error) {
    double atoms;
    ISO_TRY(iso_rows_load(x->data.reading, &x->rows, error));
    char *first = iso_point_rows_next(&x->rows);
    if (!first) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", x->rows.reading->path);
    ISO_TRY(iso_point_rows_is_count(first, &atoms) ? read_molecule(x, atoms, error)
                                                   : iso_point_rows_read(&x->data, &x->rows, first, error));
    return iso_polydata_to_glyphs(&x->data, glyphs, error);
}

iso_status iso_glyphs_read_xyz(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    xyz x = {.data = {.reading = reading}};
    iso_status status = read_xyz(&x, glyphs, error);
    iso_rows_free(&x.rows);
    iso_polydata_free(&x.data);
    return status;
}
