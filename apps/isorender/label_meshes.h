/* label_meshes: the smooth surface of every label as a mesh, for --mesh and --table. */
#ifndef ISO_APPS_ISORENDER_LABEL_MESHES_H
#define ISO_APPS_ISORENDER_LABEL_MESHES_H

#include "apps/isorender/isorender.h"

/* Is given the mesh of label `label`, a place in the list of labels; it may keep it, and set *weld to zeros.
 */
typedef iso_status isorender_label_mesh_fn(void *context, int label, iso_weld *weld,
                                           const iso_transform *transform, iso_error *error);

/* Makes the meshes of all labels, or of those that are drawn, and calls `take` with each of them. Where two
 * labels meet, their meshes have the same vertices. ISO_ERR_NOMEM, and the errors of `take`. */
iso_status isorender_label_meshes_each(isorender_job *job, bool drawn, isorender_label_mesh_fn *take,
                                       void *context, iso_error *error);

/* Writes --mesh: an object for each label that is drawn. ISO_ERR_USAGE: a format without objects for several
 * labels; ISO_ERR_WRITE. */
iso_status isorender_label_meshes_write(isorender_job *job, const char *comment, iso_error *error);

#endif
