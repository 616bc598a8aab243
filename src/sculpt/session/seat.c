/* Measures how far the surface has moved from under strokes, and moves them with it. */
#include "sculpt/session/seat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sculpt/brush/dab.h"

/* A stroke that is reseated. */
typedef struct part {
    unsigned number;
    size_t first, count; /* of its samples */
    size_t entries;      /* of the log, before the first edit after it got them; 0: there is none */
} part;

void iso_seat_free(iso_seat *seat) {
    iso_buffer_free(&seat->parts);
    iso_buffer_free(&seat->heights);
    *seat = (iso_seat){.samples = NULL};
}

static part *part_at(const iso_seat *seat, size_t index) {
    return (part *)seat->parts.data + index;
}

static int compare_parts(const void *a, const void *b) {
    const unsigned first = ((const part *)a)->number, second = ((const part *)b)->number;
    return (first > second) - (first < second);
}

/* Lists the strokes by number. */
static iso_status list_parts(const iso_stroke_list *list, unsigned first, unsigned last, iso_buffer *parts,
                             size_t *count, iso_error *error) {
    *count = 0;
    ISO_TRY(iso_buffer_reserve(parts, (list->count + 1) * sizeof(part), 0, error));
    part *made = parts->data;
    for (size_t i = 0; i < list->count; i++) {
        const iso_stroke *stroke = iso_stroke_at(list, i);
        if (stroke->number < first || stroke->number > last) continue;
        made[(*count)++] = (part){.number = stroke->number, .first = i, .count = stroke->count};
    }
    qsort(made, *count, sizeof *made, compare_parts);
    return ISO_OK;
}

iso_status iso_seat_collect(const iso_stroke_list *list, unsigned first, unsigned last, iso_buffer *path,
                            size_t *count, iso_error *error) {
    iso_buffer parts = {.data = NULL};
    size_t strokes, bytes = 0;
    iso_status status = list_parts(list, first, last, &parts, &strokes, error);
    const part *made = parts.data;
    for (size_t i = 0; i < strokes && status == ISO_OK; i++) {
        const size_t size = made[i].count * sizeof(iso_sample);
        status = iso_buffer_reserve(path, bytes + size, bytes, error);
        if (status == ISO_OK)
            memcpy((char *)path->data + bytes, iso_stroke_at(list, made[i].first)->samples, size);
        bytes += size;
    }
    *count = bytes / sizeof(iso_sample);
    iso_buffer_free(&parts);
    if (status == ISO_OK && !*count)
        return iso_fail(error, ISO_ERR_USAGE, "there are no strokes %u to %u", first, last);
    return status;
}

static part *find_part(const iso_seat *seat, unsigned number) {
    const part wanted = {.number = number};
    return bsearch(&wanted, seat->parts.data, seat->count, sizeof(part), compare_parts);
}

/* Whether the samples of a stroke lie on the surface. */
static bool is_seated(const iso_stroke *stroke) {
    return !iso_tool_is_trim(stroke->brush.tool) && !iso_tool_is_whole_mask(stroke->brush.tool);
}

/* The number of samples of a stroke that are moved by themselves. */
static size_t seated_samples(const iso_stroke *stroke) {
    return iso_tool_is_drag(stroke->brush.tool) ? 1 : stroke->count;
}

typedef struct measuring {
    iso_seat *seat;
    size_t entries; /* of the strokes that are measured */
} measuring;

/* iso_versions_visit */
static iso_status measure_stroke(void *context, iso_versions *versions, iso_stroke *stroke,
                                 iso_error *error) {
    const measuring *m = context;
    const part *p = find_part(m->seat, stroke->number);
    if (!p || p->entries != m->entries || !is_seated(stroke)) return ISO_OK;
    double *heights = (double *)m->seat->heights.data + p->first;
    for (size_t i = 0; i < seated_samples(stroke); i++)
        ISO_TRY(iso_versions_cast(versions, &m->seat->samples[p->first + i], &heights[i], error));
    return ISO_OK;
}

/* The smallest number of entries above `entries`; SIZE_MAX: there is none. */
static size_t next_entries(const iso_seat *seat, size_t entries) {
    size_t next = SIZE_MAX;
    for (size_t i = 0; i < seat->count; i++) {
        const size_t at = part_at(seat, i)->entries;
        if (at > entries && at < next) next = at;
    }
    return next;
}

/* Sets up the parts. */
static iso_status prepare(iso_seat *seat, iso_stroke_log *log, const iso_stroke_list *list,
                          iso_error *error) {
    size_t samples = 0;
    unsigned first, last;
    iso_stroke_log_edited(log, &first, &last);
    seat->samples = iso_stroke_log_path(log, &seat->path);
    ISO_TRY(list_parts(list, first, last, &seat->parts, &seat->count, error));
    for (size_t i = 0; i < seat->count; i++) {
        part *p = part_at(seat, i);
        p->entries = iso_stroke_log_before_edit(log, iso_stroke_at(list, p->first)->path);
        p->first = samples;
        samples += p->count;
    }
    ISO_TRY(iso_buffer_reserve(&seat->heights, (samples + 1) * sizeof(double), 0, error));
    for (size_t i = 0; i < samples; i++) ((double *)seat->heights.data)[i] = NAN;
    return ISO_OK;
}

iso_status iso_seat_measure(iso_seat *seat, iso_versions *versions, iso_stroke_log *log,
                            const iso_stroke_list *list, const iso_progress *progress, iso_error *error) {
    iso_stroke_list then = {.count = 0};
    measuring m = {.seat = seat};
    ISO_TRY(prepare(seat, log, list, error));
    iso_status status = ISO_OK;
    while (status == ISO_OK && (m.entries = next_entries(seat, m.entries)) != SIZE_MAX) {
        iso_stroke_log before = *log;
        before.position = m.entries;
        const iso_versions_visitor visitor = {measure_stroke, &m};
        status = iso_stroke_log_resolve(&before, &then, error);
        if (status == ISO_OK) status = iso_versions_update(versions, &then, &visitor, progress, error);
    }
    iso_stroke_list_free(&then);
    return status;
}

iso_status iso_seat_stroke(void *context, iso_versions *versions, iso_stroke *stroke, iso_error *error) {
    iso_seat *seat = context;
    const part *p = find_part(seat, stroke->number);
    if (!p || !p->entries || !is_seated(stroke)) return ISO_OK;
    iso_sample *samples = seat->samples + p->first;
    const double *heights = (const double *)seat->heights.data + p->first;
    const bool whole = seated_samples(stroke) == 1;
    double moved = 0;
    bool any = false;
    for (size_t i = 0; i < p->count; i++) {
        double height = NAN;
        if (!whole || i == 0) {
            ISO_TRY(iso_versions_cast(versions, &samples[i], &height, error));
            moved = isnan(height - heights[i]) ? 0 : height - heights[i];
        }
        if (moved == 0) continue;
        any = true;
        const iso_vec3 by = iso_vec3_scale(iso_vec3_unit(stroke->samples[whole ? 0 : i].normal), moved);
        samples[i].position = iso_vec3_add(samples[i].position, by);
    }
    if (!any) return ISO_OK;
    stroke->samples = samples;
    stroke->path = seat->path;
    return ISO_OK;
}
