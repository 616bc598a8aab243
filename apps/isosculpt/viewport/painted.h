/* painted: the paint of a field (sculpt/field/paint.h), drawn over the colour of its surface. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_PAINTED_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_PAINTED_H

#include "grids/level_set.h"
#include "scene/coloring.h"
#include "sculpt/session/session.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero: a field without paint. */
typedef struct isosculpt_painted {
    iso_paint_view view;       /* its items are borrowed; NULL: there are none */
    iso_affine affine;         /* of the field */
    iso_rgb own;               /* the colour where nothing is painted */
    const iso_change_log *log; /* borrowed; NULL: the paint does not change */
} isosculpt_painted;

/* The paint of items of a field. */
isosculpt_painted isosculpt_painted_make(const iso_field_items *items, const iso_hgrid *field, iso_rgb own);

static inline bool isosculpt_painted_any(const isosculpt_painted *painted) {
    return painted->view.paint && painted->view.paint->used > 0;
}

/* The colour of the surface at a place in the world. Thread-safe while nothing is painted. */
iso_rgb isosculpt_painted_color(const isosculpt_painted *painted, iso_vec3 place);

/* How a surface is coloured by paint; borrows `painted`. */
iso_coloring isosculpt_painted_coloring(const isosculpt_painted *painted);

/* The same for .vdb files; borrows the items of `painted`. */
iso_level_set_colors isosculpt_painted_voxels(const isosculpt_painted *painted);

#ifdef __cplusplus
}
#endif
#endif
