/* mesh_file: the surface of a sculpted field as a mesh in a file. Where the border of the grid cuts the
 * solid, the surface is open, unless it is capped there. */
#ifndef ISO_APPS_ISOSCULPT_MESH_FILE_H
#define ISO_APPS_ISOSCULPT_MESH_FILE_H

#include <stdio.h>

#include "base/parallel.h"
#include "base/progress.h"
#include "extract/mesh/mesh_measure.h"
#include "grids/hgrid.h"
#include "scene/painted.h"

typedef struct isosculpt_mesh_opts {
    bool closed;                  /* cap the solid at the border of the grid (grids/parts/closed.h) */
    iso_pool *pool;               /* borrowed for the call; NULL: the calling thread */
    const iso_progress *progress; /* or NULL */
    const iso_painted *painted;   /* colours of the vertices, if there is paint; borrowed; NULL: none */
    FILE *stream;                 /* where the mesh is written to; NULL: to the file `path` */
} isosculpt_mesh_opts;

/* Writes the Marching Cubes mesh of the field as .stl, .ply or .obj, and measures it. The field is only read.
 * ISO_ERR_EMPTY: it has no surface; errors of iso_grid_close, iso_mesh_write_weld and iso_weld_measure. */
iso_status isosculpt_mesh_write(const char *path, iso_hgrid *field, const isosculpt_mesh_opts *opts,
                                iso_mesh_measures *measures, iso_error *error);

/* One line that says how many edges of the written mesh are open, why, and that --closed caps them. */
void isosculpt_mesh_open_note(size_t open_edges, char *text, size_t size);

#endif
