/* painted: the paint of a field (sculpt/field/paint.h), drawn over the colour of its surface. */
#ifndef ISO_SCENE_PAINTED_H
#define ISO_SCENE_PAINTED_H

#include "base/c_linkage.h"
#include "grids/change_log.h"
#include "grids/level_set.h"
#include "scene/coloring.h"
#include "sculpt/field/paint.h"

ISO_C_BEGIN

/* Zero: a field without paint. */
typedef struct iso_painted {
    iso_paint_view view;       /* its items are borrowed; NULL: there are none */
    iso_affine affine;         /* of the field */
    iso_rgb own;               /* the colour where nothing is painted */
    const iso_change_log *log; /* borrowed; NULL: the paint does not change */
} iso_painted;

/* Paint of a field, which is borrowed. */
iso_painted iso_painted_make(const iso_cell_items *paint, const iso_hgrid *field, iso_rgb own);

static inline bool iso_painted_any(const iso_painted *painted) {
    return painted->view.paint && painted->view.paint->used > 0;
}

/* The colour of the surface at a place in the world. Thread-safe while nothing is painted. */
iso_rgb iso_painted_color(const iso_painted *painted, iso_vec3 place);

/* How a surface is coloured by paint; borrows `painted`. */
iso_coloring iso_painted_coloring(const iso_painted *painted);

/* Writes a level set as .vdb, with its paint if there is any: to a stream, whose errors are the caller's to
 * find (iso_sink_commit). Errors of iso_level_set_put_vdb. */
iso_status iso_painted_put_vdb(FILE *stream, const char *name, const iso_hgrid *field,
                               const iso_painted *painted, const iso_progress *progress, iso_error *error);

struct iso_volume_opts;
/* Reads the colours of a .vdb file, its grid "Cd", as paint; `own` is the colour of voxels that have none.
 * *paint is overwritten, for iso_cell_items_free, and borrowed by *painted. Where the file has no colours
 * both are empty. Errors: those of iso_level_set_read_colors. */
iso_status iso_painted_read(const char *path, const struct iso_volume_opts *opts, iso_cell_items *paint,
                            iso_painted *painted, iso_error *error);

ISO_C_END
#endif
