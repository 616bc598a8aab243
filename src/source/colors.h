/* colors: the colours that the file of a session has, as the paint (sculpt/field/paint.h) of the field that
 * was made of it. Internal to source. */
#ifndef ISO_SOURCE_COLORS_H
#define ISO_SOURCE_COLORS_H

#include "base/parallel.h"
#include "base/primitives.h"
#include "clouds/cloud.h"
#include "grids/hgrid.h"
#include "sculpt/field/paint.h"

/* All voxels near the surface get the colour of the nearest place of the mesh, which has colours. *paint is
 * overwritten, for iso_cell_items_free. The pool may be NULL. ISO_ERR_NOMEM. The same bytes for every number
 * of threads, and on every machine. */
iso_status iso_source_paint_of_mesh(const iso_triangles *mesh, iso_hgrid *field, iso_pool *pool,
                                    iso_cell_items *paint, iso_error *error);

/* The same of points with colours: means of the points that are nearest. */
iso_status iso_source_paint_of_points(const iso_cloud *cloud, iso_hgrid *field, iso_pool *pool,
                                      iso_cell_items *paint, iso_error *error);

/* The same of a .vdb file, of the colours at the voxels' places; *paint is empty if it has none. Also the
 * errors of iso_paint_read. */
iso_status iso_source_paint_of_vdb(const char *path, iso_hgrid *field, iso_pool *pool, iso_cell_items *paint,
                                   iso_error *error);

#endif
