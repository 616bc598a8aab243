/* point_columns: tables of points whose columns have no names: 3 to 10 numbers for each point, the first of
 * which are x y z. What the others are is decided from their values. Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_POINT_COLUMNS_H
#define ISO_IO_GLYPHS_POINT_COLUMNS_H

#include "io/polydata/polydata.h"

enum { ISO_POINT_COLUMNS_LEAST = 3, ISO_POINT_COLUMNS_MOST = 10 };

/* Adds a column for each number of a point but x y z, and stores where the numbers go. The polydata must not
 * have columns. Errors as iso_polydata_add_column. */
iso_status iso_point_columns_add(iso_polydata *data, int count, iso_slot slots[ISO_POINT_COLUMNS_MOST],
                                 iso_error *error);

/* Adds the columns that the reading's options name (iso_read_opts.columns), and stores where the numbers of a
 * row go and how many there are. ISO_ERR_USAGE: a coordinate or a name is missing, or there are too many. */
iso_status iso_point_columns_given(iso_polydata *data, iso_slot slots[ISO_POLYDATA_COLUMNS], int *count,
                                   iso_error *error);

/* Decides what the columns are, when all points have been read, and says so in a note.
 *
 *   4 columns    x y z, intensity
 *   6            x y z, then a normal if the three numbers are a unit vector in most rows; else red green
 *                blue if all are 0 .. 255 and one is above 1; else a normal
 *   7            as 6, with one number more, behind the three or before them; `number_first` says which if
 *                the values do not
 *   9, 10        x y z, a normal, and red green blue, in either order; as 7 with one number more
 *   8            a normal or red green blue if the values say so clearly
 *
 * All others become attributes called "column 4" .. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_point_columns_decide(iso_polydata *data, bool number_first, iso_error *error);

#endif
