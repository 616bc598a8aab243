/* label: one label of a segmentation as the source of a session, and the sculpted label written back into a
 * copy of the segmentation. A voxel is changed only if its centre lies on different sides of the surface with
 * which the session began and of the sculpted one: inside now, it gets the label; outside now, it becomes
 * background if it had the label. All other voxels, and all other bytes of the file, stay as they are. */
#ifndef ISO_SOURCE_LABEL_H
#define ISO_SOURCE_LABEL_H

#include <stdio.h>

#include "grids/labels/labels.h"
#include "source/source.h"

/* Replaces input->label by the label's number, which is written to `number`: the number itself, or that of
 * the only name in input->label_table, else in the file (a .seg.nrrd, whose layer becomes input->component),
 * that it matches in either case, with * for anything. ISO_ERR_USAGE: no such name, or several; errors of
 * reading the table. */
iso_status iso_source_label_find(const char *path, iso_input *input, char number[16], iso_error *error);

/* Makes the level set of source->input->label, a number, of a volume; the caller owns *solid. ISO_ERR_USAGE:
 * there is no such label; errors of iso_labels_make and iso_label_fields_make. */
iso_status iso_source_label_solid(const iso_source *source, const iso_grid *grid, iso_grid *solid,
                                  iso_error *error);

/* The label that a session began with; 0: it did not begin with one. */
int iso_source_label(const iso_journal_start *start);

/* Checks whether a session's label can be written to `path`: its name ends as that of the segmentation,
 * which can be written again (iso_volume_rewrite_check). ISO_ERR_USAGE; errors of iso_source_find. */
iso_status iso_source_label_check(const char *strokes, const iso_journal_start *start, const char *path,
                                  iso_error *error);

/* What writing a label has changed, in voxels. */
typedef struct iso_label_changes {
    uint64_t added, removed;                 /* added: `taken` included */
    uint32_t taken[ISO_LABEL_VALUE_MAX + 1]; /* from each other label; [0]: from the background */
} iso_label_changes;

/* Writes a copy of the segmentation with the label as it is in `now`; `first` is the field that the session
 * began with. `strokes`: as for iso_source_find. Errors of the stream are the caller's to find
 * (iso_sink_commit); else those of iso_source_find and iso_volume_rewrite; ISO_ERR_NOMEM. */
iso_status iso_source_label_write(const char *strokes, const iso_journal_start *start, const iso_hgrid *first,
                                  const iso_hgrid *now, FILE *stream, const iso_progress *progress,
                                  iso_label_changes *changes, iso_error *error);

#endif
