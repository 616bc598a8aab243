/* label_meshes: the smooth surface of every label as a mesh, for --mesh. */
#ifndef ISO_APPS_ISORENDER_LABEL_MESHES_H
#define ISO_APPS_ISORENDER_LABEL_MESHES_H

#include "apps/isorender/isorender.h"

/* Writes --mesh: an object for each label that is drawn. ISO_ERR_USAGE: a format without objects for several
 * labels; ISO_ERR_WRITE. */
iso_status isorender_label_meshes_write(isorender_job *job, const char *comment, iso_error *error);

#endif
