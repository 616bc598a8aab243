/* solid: what is done to the solid of an isosurface before its surface is made (small parts dropped, closed
 * at the border, hollow), and its surface in files: as a mesh, or as points. */
#ifndef ISO_SCENE_SOLID_H
#define ISO_SCENE_SOLID_H

#include "base/progress.h"
#include "extract/mesh/mesh_edit.h"
#include "grids/parts/closed.h"
#include "grids/parts/components.h"
#include "io/mesh/mesh_write.h"
#include "scene/coloring.h"
#include "scene/hollow.h"

/* All zero: the solid stays as it is. */
typedef struct iso_solid_opts {
    size_t largest;    /* parts to keep, and */
    double min_volume; /* the least volume of one, mm3; 0: all (iso_components_opts) */
    bool copied;       /* parts are dropped from a copy, because other surfaces need the grid */
    bool closed;       /* capped at the border of the grid */
    double hollow;     /* of what is closed: the thickness of the wall that is left, mm; 0: it is solid */
    const iso_hollow_opts *how; /* with `hollow`: the rest of it, but for `wall` and `pool`; borrowed */
    iso_pool *pool;
} iso_solid_opts;

/* Whether parts may be dropped. */
static inline bool iso_solid_drops_parts(const iso_solid_opts *opts) {
    return opts->largest || opts->min_volume > 0;
}

/* Changes the solid at *isovalue (physical). *own: zero, or a grid of the caller's (iso_grid_destroy), which
 * the surface is made of instead of `grid`; *isovalue follows. parts: of what was dropped; zero if nothing
 * can be. Errors of iso_components_filter, iso_grid_close and iso_grid_hollow. */
iso_status iso_solid_make(iso_grid *grid, const iso_solid_opts *opts, double *isovalue, iso_grid *own,
                          iso_components_totals *parts, iso_error *error);

/* How a mesh is made for a file. All zero, or NULL: as it is. */
typedef struct iso_solid_mesh_opts {
    bool closed; /* the grid was closed: vertices at its caps are separate */
    const iso_mesh_edits *edits;
    const iso_coloring *coloring; /* of the vertices; not BY_DEPTH */
    iso_mesh_measures *measures;  /* where the mesh's are put */
    iso_pool *pool;
} iso_solid_mesh_opts;

/* Welds a mesh; iso_weld_free when done. Errors of iso_mesh_weld, iso_weld_edit, iso_weld_measure and
 * iso_coloring_weld. */
iso_status iso_solid_weld(const iso_mesh_view *mesh, const iso_solid_mesh_opts *opts, iso_weld *weld,
                          iso_error *error);

/* Area, volume .. of an isosurface (physical isovalue). Errors of iso_isosurface_mesh and iso_weld_measure.
 */
iso_status iso_solid_measure(const iso_grid *grid, double isovalue, iso_pool *pool,
                             iso_mesh_measures *measures, iso_error *error);

/* Writes the mesh of a level set, which is only read, closed if opts->closed. stream: where it is written
 * to, in the format that `path` names; NULL: to the file. ISO_ERR_EMPTY: it has no surface; errors of
 * iso_grid_close, iso_solid_weld and iso_mesh_write_weld. */
iso_status iso_solid_write(const char *path, iso_hgrid *field, const iso_solid_mesh_opts *opts,
                           const char *comment, FILE *stream, const iso_progress *progress, iso_error *error);

/* Writes points as .ply. coloring: their colours, not BY_DEPTH; NULL: those of the view. Errors of
 * iso_points_write_ply and iso_coloring_points. */
iso_status iso_solid_write_points(const char *path, const iso_point_view *points,
                                  const iso_coloring *coloring, iso_pool *pool, const char *comment,
                                  iso_error *error);

#endif
