/* bids: the T1-weighted images of a folder of BIDS (Brain Imaging Data Structure), with their masks. */
#ifndef ISO_APPS_ISORENDER_BIDS_H
#define ISO_APPS_ISORENDER_BIDS_H

#include <stdbool.h>

#include "base/status.h"

/* Zero-initialise; isorender_bids_free when done. */
typedef struct isorender_bids {
    const char *folder;     /* borrowed */
    char **images, **masks; /* paths, in the order of their names; masks[i]: of images[i], or NULL */
    int count;
} isorender_bids;

/* Whether it is such a folder: it has a dataset_description.json. */
bool isorender_bids_is(const char *folder);

/* Finds the images, ..._T1w.nii and ..._T1w.nii.gz in anat of subjects or their sessions, and of each a mask:
 * a file in the same place of the folder or of one of its derivatives, whose name has the same entities (all
 * before _desc- and the suffix) and ends in _desc-brain_mask or, if there is none, in mask. ISO_ERR_EMPTY:
 * there is no image; ISO_ERR_NOMEM. */
iso_status isorender_bids_find(const char *folder, isorender_bids *bids, iso_error *error);
void isorender_bids_free(isorender_bids *bids);

#endif
