/* segmentation: the labels of --labels or, with --smooth, of the input: which are drawn, with which names,
 * colours and opacities; their surfaces, table and legend. */
#ifndef ISO_APPS_ISORENDER_SEGMENTATION_H
#define ISO_APPS_ISORENDER_SEGMENTATION_H

#include "apps/isorender/isorender.h"
#include "scene/segmentation.h"

/* The path of the labels; NULL: there are none. */
const char *isorender_labels_path(const isorender_job *job);

/* Checks the options of labels. ISO_ERR_USAGE. */
iso_status isorender_segmentation_check(const isorender_settings *settings, iso_error *error);

/* As iso_loader_open and iso_loader_read. Messages name the file. */
iso_status isorender_segmentation_open(isorender_job *job, iso_error *error);
iso_status isorender_segmentation_read(isorender_job *job, iso_error *error);

/* Makes the fields of the labels, adds their surfaces to the job's, and writes the table. ISO_ERR_USAGE: a
 * label that is not there, too many translucent ones; ISO_ERR_EMPTY: no label is drawn; errors of
 * iso_labels_make and iso_label_fields_make. */
iso_status isorender_segmentation_add(isorender_job *job, iso_error *error);

/* The legend: the labels that are drawn, at most `room`; returns their number. *all: without that limit. */
int isorender_legend(const isorender_job *job, int room, iso_legend_entry *entries, int *all);

void isorender_report_labels(iso_json *json, const isorender_job *job); /* a member of --json's report */
void isorender_segmentation_free(isorender_job *job);

/* Logs a note if the input is a mask or labels, which --smooth draws better. */
void isorender_segmentation_note(const isorender_job *job);

#endif
