/* label_parts: drops small connected parts of labels. A part is a connected component of the voxels of one
 * label, along the edges of the grid. Internal to grids/labels. */
#ifndef ISO_GRIDS_LABELS_LABEL_PARTS_H
#define ISO_GRIDS_LABELS_LABEL_PARTS_H

#include "grids/labels/labels.h"

/* Makes background of the voxels of parts that `keep` does not keep. labels->number holds any numbers, 0 is
 * the background; labels->label is not read. ISO_ERR_EMPTY: no part is as large as keep->min_volume;
 * ISO_ERR_LIMIT: more than 2^32 - 2 runs of voxels; ISO_ERR_NOMEM. */
iso_status iso_label_parts_drop(iso_labels *labels, const iso_label_parts *keep,
                                iso_components_totals *totals, iso_error *error);

#endif
