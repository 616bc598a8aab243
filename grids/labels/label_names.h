/* label_names: names and colours of labels, from files beside segmentations and in them:
 *
 *   FreeSurfer's look-up tables     3 Left-Cerebral-Cortex 205 62 78 0
 *   3D Slicer's colour tables       7 kidney 185 102 83 255
 *   ITK-SNAP's label descriptions   2 0 255 0 1 1 1 "left lung"
 *   .seg.nrrd                       Segment0_LabelValue:=7, Segment0_Name:=kidney, Segment0_Color:=1 0 0
 *   DICOM SEG                       the sequence of segments: number, label, recommended CIELab colour
 *
 * Lines that begin with # are comments; in rows of a table, opacities are not used. */
#ifndef ISO_GRIDS_LABELS_LABEL_NAMES_H
#define ISO_GRIDS_LABELS_LABEL_NAMES_H

#include <stdbool.h>

#include "base/status.h"
#include "isopoint.h"

enum { ISO_LABEL_NAME = 64 };

typedef struct iso_label_name {
    int value;
    int layer;                 /* of .seg.nrrd: the component that has it, else 0 */
    char name[ISO_LABEL_NAME]; /* printable UTF-8; empty: none */
    bool colored;
    iso_rgb color;
} iso_label_name;

/* Zero-initialised it is empty; iso_label_names_free when done. */
typedef struct iso_label_names {
    iso_label_name *items; /* in the order of the file; of a value that it has twice the last one counts */
    int count;
} iso_label_names;

/* Reads a table of rows. ISO_ERR_IO; ISO_ERR_FORMAT names the line; ISO_ERR_NOMEM. */
iso_status iso_label_names_read(const char *path, iso_label_names *names, iso_error *error);
/* Reads the segments that the header of an .nrrd, .nhdr or DICOM file states; none in other files.
 * ISO_ERR_NOMEM, and for DICOM errors of iso_dicom_file_read. */
iso_status iso_label_names_of_file(const char *path, iso_label_names *names, iso_error *error);
void iso_label_names_free(iso_label_names *names);

/* The last entry of a value; NULL: there is none. */
const iso_label_name *iso_label_names_find(const iso_label_names *names, int layer, int value);

/* The colour of a label without one: the same for a value in every picture, and different for neighbouring
 * values. */
iso_rgb iso_label_usual_color(int value);

#endif
