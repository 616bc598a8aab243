/* Resolves strokes and their edits into the list of strokes that the field is made of. */
#include "sculpt/session/stroke_list.h"

#include <stdlib.h>
#include <string.h>

struct iso_stroke_entry {
    iso_event_kind kind;
    bool step;
    unsigned number, last, before; /* of a stroke: its number; of an edit: the first of the range */
    iso_brush brush;               /* BEGIN, EDIT */
    char *group;                   /* GROUP: the name; else, if number == 0, of whose strokes; owned */
    iso_stamp *stamp;              /* owned */
    iso_buffer samples;            /* iso_sample; of a stroke, or of a path */
    size_t path;                   /* iso_stroke.path of strokes that have these samples */
    size_t sample_count;
};

static iso_stroke_entry *entry_at(const iso_stroke_log *log, size_t index) {
    return (iso_stroke_entry *)log->entries.data + index;
}

static void free_entry(iso_stroke_entry *entry) {
    iso_stamp_free(entry->stamp);
    iso_free(entry->group);
    iso_buffer_free(&entry->samples);
}

void iso_stroke_log_free(iso_stroke_log *log) {
    for (size_t i = 0; i < log->count; i++) free_entry(entry_at(log, i));
    iso_buffer_free(&log->entries);
    *log = (iso_stroke_log){.numbers = 0};
}

static iso_status add_sample(iso_stroke_entry *entry, const iso_sample *sample, iso_error *error) {
    const size_t bytes = entry->sample_count * sizeof *sample;
    ISO_TRY(iso_buffer_reserve(&entry->samples, bytes + sizeof *sample, bytes, error));
    ((iso_sample *)entry->samples.data)[entry->sample_count++] = *sample;
    return ISO_OK;
}

static iso_status copy_group(iso_stroke_entry *entry, const char *name, iso_error *error) {
    const size_t size = strlen(name) + 1;
    entry->group = iso_alloc(size);
    if (!entry->group) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a group of strokes");
    memcpy(entry->group, name, size);
    return ISO_OK;
}

static void discard_undone(iso_stroke_log *log) {
    while (log->count > log->position) free_entry(entry_at(log, --log->count));
}

iso_status iso_stroke_log_add(iso_stroke_log *log, const iso_event *event, iso_stamp *stamp, bool step,
                              iso_error *error) {
    const size_t bytes = log->count * sizeof(iso_stroke_entry);
    const bool stroke = event->kind == ISO_EVENT_BEGIN;
    iso_stroke_entry made = {.kind = event->kind,
                             .number = stroke ? log->numbers + 1 : event->first,
                             .last = event->last,
                             .before = event->before,
                             .brush = event->brush};
    iso_status status = iso_buffer_reserve(&log->entries, bytes + sizeof(iso_stroke_entry), bytes, error);
    if (status == ISO_OK && stroke) status = add_sample(&made, &event->sample, error);
    for (size_t i = 0; iso_event_has_path(event->kind) && i < event->path_count && status == ISO_OK; i++)
        status = add_sample(&made, &event->path[i], error);
    if (status == ISO_OK && !stroke && (event->kind == ISO_EVENT_GROUP || !event->first))
        status = copy_group(&made, event->text, error);
    if (status != ISO_OK) {
        free_entry(&made);
        return status;
    }
    made.stamp = iso_stamp_share(stamp);
    log->numbers += stroke;
    made.path = ++log->changes;
    /* before what is undone, which can be redone until a step follows */
    memmove(entry_at(log, log->position + 1), entry_at(log, log->position),
            (log->count - log->position) * sizeof made);
    *entry_at(log, log->position++) = made;
    log->count++;
    if (step) iso_stroke_log_end(log, true);
    return ISO_OK;
}

iso_status iso_stroke_log_sample(iso_stroke_log *log, const iso_sample *sample, iso_error *error) {
    log->changes++;
    return add_sample(entry_at(log, log->position - 1), sample, error);
}

const iso_sample *iso_stroke_log_samples(const iso_stroke_log *log, size_t *count) {
    const iso_stroke_entry *entry = entry_at(log, log->position - 1);
    *count = entry->sample_count;
    return entry->samples.data;
}

void iso_stroke_log_edited(const iso_stroke_log *log, unsigned *first, unsigned *last) {
    const iso_stroke_entry *entry = entry_at(log, log->position - 1);
    *first = entry->number;
    *last = entry->last;
}

iso_sample *iso_stroke_log_path(iso_stroke_log *log, size_t *path) {
    const iso_stroke_entry *entry = entry_at(log, log->position - 1);
    *path = entry->path;
    return entry->samples.data;
}

size_t iso_stroke_log_before_edit(const iso_stroke_log *log, size_t path) {
    size_t i = 0;
    while (i < log->position && entry_at(log, i)->path != path) i++;
    for (i++; i + 1 < log->position; i++)
        if (entry_at(log, i)->kind != ISO_EVENT_BEGIN || entry_at(log, i)->before) return i;
    return 0;
}

void iso_stroke_log_end(iso_stroke_log *log, bool step) {
    log->changes++;
    entry_at(log, log->position - 1)->step = step;
    if (step) discard_undone(log);
}

void iso_stroke_log_remove(iso_stroke_log *log) {
    log->changes++;
    free_entry(entry_at(log, --log->position));
    memmove(entry_at(log, log->position), entry_at(log, log->position + 1),
            (--log->count - log->position) * sizeof(iso_stroke_entry));
}

void iso_stroke_log_undo(iso_stroke_log *log) {
    log->changes++;
    while (log->position && !entry_at(log, log->position - 1)->step) log->position--;
    log->position -= log->position > 0;
}

/* Strokes that changed nothing come back with the step before them. */
void iso_stroke_log_redo(iso_stroke_log *log) {
    log->changes++;
    while (log->position < log->count && !entry_at(log, log->position)->step) log->position++;
    log->position += log->position < log->count;
    while (log->position < log->count && !entry_at(log, log->position)->step) log->position++;
}

/* ---- the list */

void iso_stroke_list_free(iso_stroke_list *list) {
    iso_buffer_free(&list->strokes);
    list->count = 0;
}

static size_t find_index(const iso_stroke_list *list, unsigned number) {
    size_t i = 0;
    while (i < list->count && iso_stroke_at(list, i)->number != number) i++;
    return i;
}

iso_stroke *iso_stroke_find(const iso_stroke_list *list, unsigned number) {
    const size_t index = find_index(list, number);
    return index < list->count ? iso_stroke_at(list, index) : NULL;
}

static bool is_in(const iso_stroke *stroke, const iso_stroke_entry *range) {
    if (!range->number) return strcmp(stroke->group, range->group) == 0;
    return stroke->number >= range->number && stroke->number <= range->last;
}

/* Finds the place of the stroke `before` (0: the end). */
static iso_status find_place(const iso_stroke_list *list, unsigned before, size_t *place, iso_error *error) {
    *place = before ? find_index(list, before) : list->count;
    return before && *place == list->count
               ? iso_fail(error, ISO_ERR_USAGE, "there is no stroke %u to be placed before", before)
               : ISO_OK;
}

static iso_status insert_stroke(iso_stroke_list *list, const iso_stroke_entry *entry, iso_error *error) {
    size_t place;
    const size_t bytes = list->count * sizeof(iso_stroke);
    ISO_TRY(find_place(list, entry->before, &place, error));
    ISO_TRY(iso_buffer_reserve(&list->strokes, bytes + sizeof(iso_stroke), bytes, error));
    iso_stroke *at = iso_stroke_at(list, place);
    memmove(at + 1, at, (list->count++ - place) * sizeof *at);
    *at = (iso_stroke){.number = entry->number,
                       .brush = entry->brush,
                       .samples = entry->samples.data,
                       .count = entry->sample_count,
                       .path = entry->path,
                       .stamp = entry->stamp,
                       .group = ""};
    return ISO_OK;
}

/* Removes the strokes of a range, which are copied to `taken` (NULL: to nowhere). Returns how many. */
static size_t take_strokes(iso_stroke_list *list, const iso_stroke_entry *range, iso_stroke *taken) {
    size_t kept = 0, count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const iso_stroke stroke = *iso_stroke_at(list, i);
        if (!is_in(&stroke, range))
            *iso_stroke_at(list, kept++) = stroke;
        else if (taken)
            taken[count++] = stroke;
    }
    list->count = kept;
    return count;
}

static iso_status move_strokes(iso_stroke_list *list, const iso_stroke_entry *range, iso_error *error) {
    size_t place;
    const iso_stroke *before = range->before ? iso_stroke_find(list, range->before) : NULL;
    if (before && is_in(before, range))
        return iso_fail(error, ISO_ERR_USAGE, "stroke %u cannot be placed before itself", range->before);
    ISO_TRY(find_place(list, range->before, &place, error));
    iso_stroke *taken = iso_alloc(list->count * sizeof *taken);
    if (!taken) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu strokes", list->count);
    const size_t count = take_strokes(list, range, taken);
    iso_status status = find_place(list, range->before, &place, error);
    iso_stroke *at = iso_stroke_at(list, place);
    memmove(at + count, at, (list->count - place) * sizeof *at);
    memcpy(at, taken, count * sizeof *at);
    list->count += count;
    iso_free(taken);
    return status;
}

static int compare_numbers(const void *a, const void *b) {
    const unsigned first = (*(iso_stroke *const *)a)->number, second = (*(iso_stroke *const *)b)->number;
    return (first > second) - (first < second);
}

/* Gives strokes other samples, those that are the same excepted. */
static iso_status set_paths(iso_stroke_list *list, const iso_stroke_entry *edit, iso_error *error) {
    iso_stroke **strokes = iso_alloc(list->count * sizeof *strokes);
    const iso_sample *samples = edit->samples.data;
    size_t count = 0, used = 0;
    if (!strokes) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu strokes", list->count);
    for (size_t i = 0; i < list->count; i++) {
        strokes[count] = iso_stroke_at(list, i);
        if (!is_in(strokes[count], edit)) continue;
        used += strokes[count++]->count;
    }
    iso_status status =
        used == edit->sample_count
            ? ISO_OK
            : iso_fail(error, ISO_ERR_USAGE, "a path of %zu samples for strokes that have %zu",
                       edit->sample_count, used);
    qsort(strokes, count, sizeof *strokes, compare_numbers);
    for (size_t i = 0; i < count && status == ISO_OK; samples += strokes[i++]->count) {
        if (memcmp(samples, strokes[i]->samples, strokes[i]->count * sizeof *samples) == 0) continue;
        strokes[i]->samples = samples;
        strokes[i]->path = edit->path;
    }
    iso_free(strokes);
    return status;
}

static iso_status edit_strokes(iso_stroke_list *list, const iso_stroke_entry *edit, iso_error *error) {
    size_t found = 0;
    for (size_t i = 0; i < list->count; i++) {
        iso_stroke *stroke = iso_stroke_at(list, i);
        if (!is_in(stroke, edit)) continue;
        found++;
        if (edit->kind == ISO_EVENT_EDIT) stroke->brush = edit->brush;
        if (edit->kind == ISO_EVENT_GROUP) stroke->group = edit->group;
        if (edit->kind == ISO_EVENT_MUTE || edit->kind == ISO_EVENT_UNMUTE)
            stroke->muted = edit->kind == ISO_EVENT_MUTE;
    }
    if (!found && !edit->number)
        return iso_fail(error, ISO_ERR_USAGE, "there is no stroke in the group '%s'", edit->group);
    if (!found && edit->number == edit->last)
        return iso_fail(error, ISO_ERR_USAGE, "there is no stroke %u", edit->number);
    if (!found)
        return iso_fail(error, ISO_ERR_USAGE, "there are no strokes %u to %u", edit->number, edit->last);
    if (edit->kind == ISO_EVENT_DELETE) take_strokes(list, edit, NULL);
    if (iso_event_has_path(edit->kind)) return set_paths(list, edit, error);
    return edit->kind == ISO_EVENT_MOVE ? move_strokes(list, edit, error) : ISO_OK;
}

iso_status iso_stroke_log_resolve(const iso_stroke_log *log, iso_stroke_list *list, iso_error *error) {
    list->count = 0;
    for (size_t i = 0; i < log->position; i++) {
        const iso_stroke_entry *entry = entry_at(log, i);
        ISO_TRY(entry->kind == ISO_EVENT_BEGIN ? insert_stroke(list, entry, error)
                                               : edit_strokes(list, entry, error));
    }
    return ISO_OK;
}
