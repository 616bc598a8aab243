/* point_columns: decides from the values of unnamed columns which of them are normals and which colours. */
#include "io/glyphs/point_columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

iso_status iso_point_columns_add(iso_polydata *data, int count, iso_slot slots[ISO_POINT_COLUMNS_MOST],
                                 iso_error *error) {
    for (int i = 0; i < count; i++) {
        char name[24];
        slots[i] = (iso_slot){ISO_SLOT_POINT, i};
        if (i < 3) continue;
        snprintf(name, sizeof name, "column %d", i + 1);
        slots[i].component = 0;
        ISO_TRY(iso_polydata_add_column(data, name, 1, false, ISO_ROLE_NONE, &slots[i].column, error));
    }
    return ISO_OK;
}

/* Splits `text` at its commas, in place. Returns the number of names; -1: there are too many, or one is
 * empty. */
static int split_names(char *text, const char *names[ISO_POLYDATA_COLUMNS]) {
    int count = 0;
    for (char *at = text; at; count++) {
        char *end = strchr(at, ',');
        if (end) *end++ = 0;
        at += strspn(at, " ");
        if (!*at || count == ISO_POLYDATA_COLUMNS) return -1;
        names[count] = strcmp(at, "-") == 0 ? NULL : at;
        at = end;
    }
    return count;
}

iso_status iso_point_columns_given(iso_polydata *data, iso_slot slots[ISO_POLYDATA_COLUMNS], int *count,
                                   iso_error *error) {
    const char *given = data->reading->opts.columns;
    const char *names[ISO_POLYDATA_COLUMNS];
    const size_t bytes = strlen(given) + 1;
    char *copy = iso_alloc(bytes);
    if (!copy) return iso_fail_memory(error, data->reading->path);
    memcpy(copy, given, bytes);
    *count = split_names(copy, names);
    iso_status status = ISO_OK;
    if (*count < 0 || iso_polydata_name_columns(data, names, *count, slots, error) == ISO_ERR_FORMAT)
        status =
            iso_fail(error, ISO_ERR_USAGE, "'%s' are not names of columns, with x y z among them", given);
    iso_free(copy);
    return status;
}

/* ---- what three columns look like */

typedef struct triple {
    bool unit;     /* in most rows the three numbers are a unit vector */
    bool in_range; /* all numbers are from 0 to 255 */
    bool color;    /* in range, and one number is above 1 */
} triple;

static triple look_at(const iso_polydata *data, int first) {
    const float *x = iso_polydata_column(data, first)->values.data,
                *y = iso_polydata_column(data, first + 1)->values.data,
                *z = iso_polydata_column(data, first + 2)->values.data;
    size_t unit = 0;
    float least = 0, most = 0;
    bool finite = true;
    for (size_t i = 0; i < data->point_count; i++) {
        const float square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        unit += square > 0.9f && square < 1.1f;
        finite = finite && isfinite(square);
        least = fminf(least, fminf(x[i], fminf(y[i], z[i])));
        most = fmaxf(most, fmaxf(x[i], fmaxf(y[i], z[i])));
    }
    const bool in_range = finite && least >= 0 && most <= 255;
    return (triple){2 * unit > data->point_count, in_range, in_range && most > 1};
}

/* ---- the decision */

/* A decision: the first column of the normals and of the colours, or -1 if there are none; and how certain
 * it is. */
typedef struct guess {
    int normal, color, clear;
} guess;

/* Decides what the columns from `first` on are. They are three or six: one or two vectors. */
static guess make_guess(const iso_polydata *data, int first) {
    const int count = data->column_count, threes = (count - first) / 3 < 2 ? (count - first) / 3 : 2;
    guess made = {-1, -1, 0};
    triple looks[2];
    for (int k = 0; k < threes; k++) looks[k] = look_at(data, first + 3 * k);
    for (int k = 0; k < threes && made.normal < 0; k++)
        if (looks[k].unit) made.normal = first + 3 * k;
    for (int k = 0; k < threes && made.color < 0; k++)
        if (looks[k].color && made.normal != first + 3 * k) made.color = first + 3 * k;
    made.clear = 2 * (made.normal >= 0) + (made.color >= 0);
    if (count == 5) return made;
    for (int k = 0; k < threes; k++) {
        const int at = first + 3 * k;
        if (at == made.normal || at == made.color) continue;
        if (made.normal < 0)
            made.normal = at;
        else if (made.color < 0 && looks[k].in_range)
            made.color = at;
    }
    return made;
}

static guess best_guess(const iso_polydata *data, bool number_first) {
    const int count = data->column_count, further = count % 3, preferred = number_first && further == 1;
    guess best = make_guess(data, preferred);
    /* a number and colours, as the format has it, though all of these may be 0 */
    if (preferred && count == 4 && best.clear == 0 && look_at(data, 1).in_range) return (guess){-1, 1, 1};
    for (int first = 0; first <= further; first++) {
        const guess made = make_guess(data, first);
        if (made.clear > best.clear) best = made;
    }
    return best;
}

/* Adds a note for the user with the names of the columns, in the order of the file. */
static void note_columns(const iso_polydata *data) {
    char text[ISO_READ_TEXT] = "x y z";
    for (int i = 0; i < data->column_count; i++) {
        const size_t length = strlen(text);
        snprintf(text + length, sizeof text - length, ", %s", iso_polydata_column(data, i)->name);
    }
    iso_reading_note(data->reading, "its columns have no names, and are taken as %s (--columns)", text);
}

iso_status iso_point_columns_decide(iso_polydata *data, bool number_first, iso_error *error) {
    const int count = data->column_count;
    if (count == 0 || data->point_count == 0) return ISO_OK;
    guess made = {-1, -1, 0};
    if (count >= 3) made = best_guess(data, number_first);
    if (count == 1 || (count % 3 == 1 && (made.normal == 1 || made.color == 1)))
        strcpy(iso_polydata_column(data, 0)->name, "intensity");
    /* The last three columns are joined first, because joining changes the numbers of the columns behind. */
    const bool normal_last = made.normal > made.color;
    for (int k = 0; k < 2; k++) {
        const bool normal = normal_last == (k == 0);
        const int at = normal ? made.normal : made.color;
        if (at >= 0)
            ISO_TRY(iso_polydata_join_columns(data, at, normal ? "normals" : "colors",
                                              normal ? ISO_ROLE_NORMAL : ISO_ROLE_COLOR, error));
    }
    note_columns(data);
    return ISO_OK;
}
