/* other_labels: all labels of a segmentation but the sculpted one, read by the scene's own code. */
#include "apps/isosculpt/other_labels.h"

#include <stdlib.h>
#include <string.h>

/* Reads the voxels, names and colours. */
static iso_status read_labels(isosculpt_reference_labels *labels, iso_error *error) {
    iso_segmentation *s = &labels->segmentation;
    int missing, first;
    ISO_TRY(iso_loader_open(&s->loader, error));
    ISO_TRY(iso_segmentation_read(s, error));
    return iso_segmentation_name(s, NULL, &missing, &first, error);
}

/* Makes the level set of all labels but one. */
static iso_status make_solid(isosculpt_reference_labels *labels, int sculpted, iso_error *error) {
    iso_segmentation *s = &labels->segmentation;
    for (int i = 0; i < s->labels.count; i++)
        if (s->labels.label[i].value == sculpted) s->items[i].opacity = 0;
    iso_segmentation_divide(s);
    if (!s->groups)
        return iso_fail(error, ISO_ERR_EMPTY, "%.400s: there is no label beside %d", labels->path, sculpted);
    return iso_segmentation_make_fields(s, ISO_LABELS_DRAWN + ISO_LABELS_APART, error);
}

static void find_sculpted(const iso_segmentation *s, int value, isosculpt_sculpted_label *sculpted) {
    for (int i = 0; i < s->labels.count; i++)
        if (s->labels.label[i].value == value)
            *sculpted = (isosculpt_sculpted_label){.known = true, .color = s->items[i].color};
}

static iso_status make(isosculpt_reference_labels *labels, const iso_journal_start *start,
                       const char *journal, uint64_t max_memory, int threads, const iso_progress *progress,
                       isosculpt_sculpted_label *sculpted, iso_error *error) {
    iso_segmentation *s = &labels->segmentation;
    const iso_progress finding = iso_progress_part(progress, 0, 0.1);
    ISO_TRY(iso_source_find(journal, start, &finding, labels->path, error));
    memcpy(labels->reading, start->reading, sizeof labels->reading);
    ISO_TRY(iso_input_parse(labels->reading, &s->input, error));
    ISO_TRY(iso_pool_create(threads, &labels->pool, error));
    s->input.label = NULL; /* all of them, with all their parts */
    s->input.largest = 0;
    s->input.min_size = 0;
    s->input.max_memory = max_memory;
    s->loader =
        (iso_loader){.input = labels->path, .options = &s->input, .pool = labels->pool, .is_further = true};
    ISO_TRY(read_labels(labels, error));
    find_sculpted(s, iso_source_label(start), sculpted);
    ISO_TRY(iso_progress_tell(progress, labels->path, 0.4, error));
    return make_solid(labels, iso_source_label(start), error);
}

iso_status isosculpt_other_labels_make(const iso_journal_start *start, const char *journal,
                                       uint64_t max_memory, int threads, const iso_progress *progress,
                                       isosculpt_sculpted_label *sculpted, isosculpt_reference **reference,
                                       iso_error *error) {
    isosculpt_reference_labels *labels = calloc(1, sizeof *labels);
    if (!labels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for labels");
    const iso_status status = make(labels, start, journal, max_memory, threads, progress, sculpted, error);
    if (status == ISO_OK) return isosculpt_reference_create_labels(labels, threads, reference, error);
    isosculpt_reference_labels_free(labels);
    return status;
}
