/* other_labels: the labels beside the one that a session sculpts, as its reference: one surface of them all,
 * each in its colour. */
#ifndef ISO_APPS_ISOSCULPT_OTHER_LABELS_H
#define ISO_APPS_ISOSCULPT_OTHER_LABELS_H

#include "apps/isosculpt/reference_file.h"
#include "base/progress.h"
#include "source/label.h"

/* Reads the segmentation that the session began with, again, and makes the reference. journal: the stroke
 * file; max_memory: bytes, 0: no limit; threads: 0: one for each processor; sculpted: how the sculpted one is
 * drawn, also after the later errors. ISO_ERR_EMPTY: it has no other label; errors of iso_source_find,
 * iso_segmentation_read and iso_segmentation_make_fields. May be called in any thread. */
iso_status isosculpt_other_labels_make(const iso_journal_start *start, const char *journal,
                                       uint64_t max_memory, int threads, const iso_progress *progress,
                                       isosculpt_sculpted_label *sculpted, isosculpt_reference **reference,
                                       iso_error *error);

#endif
