/* planes: which image of a TIFF stack is which slice, by the metadata of ImageJ or OME. */
#include <limits.h>
#include <stdlib.h>

#include "grids/volume/tiff/tiff.h"

/* More planes than any microscope writes into one set of files. */
enum { MOST_PLANES = 1 << 20 };

/* ---- sizes of the axes ---- */

/* Sizes of the axes, and how many planes lie from one channel, slice, time or position to the next. */
typedef struct axes {
    uint64_t size[ISO_TIFF_AXES], step[ISO_TIFF_AXES];
    uint64_t position_step, positions;
} axes;

/* False: more planes than 64 bits can count. */
static bool find_axes(const iso_tiff_stack *stack, axes *a) {
    const iso_tiff_metadata *m = &stack->metadata;
    uint64_t planes = 1;
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++) a->size[axis] = m->sizes[axis] ? m->sizes[axis] : 1;
    if (stack->layout.samples > 1)
        a->size[ISO_TIFF_CHANNEL] = 1; /* OME counts the samples of a pixel as channels */
    for (int i = 0; i < ISO_TIFF_AXES; i++) {
        a->step[m->order[i]] = planes;
        if (__builtin_mul_overflow(planes, a->size[m->order[i]], &planes)) return false;
    }
    a->position_step = planes;
    a->positions = m->positions;
    return !__builtin_mul_overflow(planes, a->positions, &planes);
}

static uint64_t plane_count(const axes *a) {
    return a->position_step * a->positions;
}

/* ---- images in the order of their planes ---- */

/* The number of the first image of each file; count + 1 numbers. NULL: no memory. */
static size_t *first_images(const iso_tiff_stack *stack) {
    size_t *first = calloc((size_t)stack->files.count + 1, sizeof *first);
    for (size_t i = 0; first && i < stack->count; i++) first[stack->images[i].file + 1]++;
    for (uint32_t file = 0; first && file < stack->files.count; file++) first[file + 1] += first[file];
    return first;
}

/* Sets the planes of a run; those whose images are not there are left as they are. `room`: how many may be
 * set; false: the metadata name images several times. */
static bool place_run(const iso_tiff_stack *stack, const axes *a, const size_t *first,
                      const iso_tiff_run *run, iso_tiff_image *planes, uint64_t *room) {
    uint64_t plane = 0;
    for (int axis = 0; axis < ISO_TIFF_AXES; axis++) {
        const bool is_sample = axis == ISO_TIFF_CHANNEL && stack->layout.samples > 1;
        if (!is_sample && run->first[axis] >= a->size[axis]) return true;
        plane += is_sample ? 0 : run->first[axis] * a->step[axis];
    }
    for (uint64_t i = 0; i < run->count && plane < a->position_step; i++, plane++) {
        const uint64_t image = first[run->file] + run->page + i;
        if (image >= first[run->file + 1]) break;
        if ((*room)-- == 0) return false;
        if (!stack->images[image].differs)
            planes[run->position * a->position_step + plane] = stack->images[image];
    }
    return true;
}

/* Whether all planes of a time are there: headers of images do not begin at byte 0. */
static bool has_time(const axes *a, const iso_tiff_image *planes, uint64_t time) {
    for (uint64_t slice = 0; slice < a->size[ISO_TIFF_SLICE]; slice++)
        for (uint64_t channel = 0; channel < a->size[ISO_TIFF_CHANNEL]; channel++)
            if (!planes[time * a->step[ISO_TIFF_TIME] + slice * a->step[ISO_TIFF_SLICE] +
                        channel * a->step[ISO_TIFF_CHANNEL]]
                     .header)
                return false;
    return true;
}

static uint64_t count_times(const axes *a, const iso_tiff_image *planes) {
    uint64_t times = 0;
    while (times < a->size[ISO_TIFF_TIME] && has_time(a, planes, times)) times++;
    return times;
}

/* Moves the planes of complete positions together, of as many times as the first of these has. An acquisition
 * may have been stopped before the last time, and other positions may be in other files. */
static void drop_incomplete(const axes *a, iso_tiff_image *planes, uint64_t *positions, uint64_t *times) {
    uint64_t kept = 0;
    *positions = *times = 0;
    for (uint64_t position = 0; position < a->positions; position++) {
        const iso_tiff_image *from = planes + position * a->position_step;
        const uint64_t own = count_times(a, from);
        if (*positions == 0) *times = own;
        if (own == 0 || own < *times) continue;
        for (uint64_t plane = 0; plane < a->position_step; plane++)
            if (plane / a->step[ISO_TIFF_TIME] % a->size[ISO_TIFF_TIME] < *times)
                planes[kept++] = from[plane];
        ++*positions;
    }
}

/* Puts the images into the order of the planes if the metadata say which image is which plane, and they are
 * there; else nothing is changed. */
static iso_status order_images(const char *path, const axes *a, iso_tiff_stack *stack, iso_volume_info *info,
                               iso_error *error) {
    iso_tiff_metadata *m = &stack->metadata;
    uint64_t room = plane_count(a), positions, times;
    if (!m->run_count || stack->overviews || room > MOST_PLANES) return ISO_OK;
    size_t *first = first_images(stack);
    iso_tiff_image *planes = calloc(room, sizeof *planes);
    bool good = first && planes;
    for (size_t i = 0; good && i < m->run_count; i++)
        good = place_run(stack, a, first, &m->runs[i], planes, &room);
    if (good) drop_incomplete(a, planes, &positions, &times);
    const iso_status status = first && planes ? ISO_OK : iso_fail_memory(error, path);
    free(first);
    if (!good || positions == 0) {
        free(planes);
        return status;
    }
    const size_t kept = a->position_step / a->size[ISO_TIFF_TIME] * times * positions;
    if (kept < stack->count)
        iso_volume_note(info, "%zu images that are no slices by the metadata of OME are left out",
                        stack->count - kept);
    free(stack->images);
    stack->images = planes;
    stack->count = kept;
    stack->different = (iso_error){0};
    if (times < a->size[ISO_TIFF_TIME])
        iso_volume_note(info, "only %llu of %llu times are complete", (unsigned long long)times,
                        (unsigned long long)a->size[ISO_TIFF_TIME]);
    if (positions < a->positions)
        iso_volume_note(info, "only %llu of %llu positions are complete", (unsigned long long)positions,
                        (unsigned long long)a->positions);
    m->sizes[ISO_TIFF_TIME] = (uint32_t)times;
    m->positions = (uint32_t)positions;
    return ISO_OK;
}

/* ---- the planes of a component ---- */

/* Names what is read of the times or positions, and how to read the others. */
static void note_choice(iso_volume_info *info, const char *what, uint64_t chosen, uint64_t count,
                        uint64_t components) {
    if (count == 1) return;
    if (chosen == 0)
        iso_volume_note(
            info, "the first of %llu %ss is read; the next one is %llu component%s on (--component)",
            (unsigned long long)count, what, (unsigned long long)components, components == 1 ? "" : "s");
    else
        iso_volume_note(info, "%s %llu of %llu is read, counted from 0 (--component)", what,
                        (unsigned long long)chosen, (unsigned long long)count);
}

static uint64_t image_count(const iso_tiff_stack *stack) {
    return stack->contiguous ? stack->metadata.images : stack->count;
}

/* Every image is a slice. */
static iso_status take_all_images(const iso_tiff_stack *stack, axes *a, iso_volume_info *info,
                                  iso_error *error) {
    const iso_tiff_metadata *m = &stack->metadata;
    const uint64_t images = image_count(stack);
    *a = (axes){.size = {1, images, 1}, .step = {0, 1, 0}, .positions = 1};
    if (stack->different.text[0]) return iso_fail(error, ISO_ERR_FORMAT, "%s", stack->different.text);
    if (m->writer && m->sizes[ISO_TIFF_SLICE] > 1 && images != m->sizes[ISO_TIFF_SLICE])
        iso_volume_note(info,
                        "its metadata state %u slices, but there are %llu images: each is taken as a slice",
                        m->sizes[ISO_TIFF_SLICE], (unsigned long long)images);
    return ISO_OK;
}

/* Several times of a single slice are a volume: programs that do not know whether their images are slices
 * call them times, or frames. */
static void take_times_as_slices(axes *a, iso_volume_info *info) {
    if (a->size[ISO_TIFF_SLICE] > 1 || a->size[ISO_TIFF_TIME] == 1) return;
    iso_volume_note(info, "%llu times of a single slice: they are taken as slices",
                    (unsigned long long)a->size[ISO_TIFF_TIME]);
    a->size[ISO_TIFF_SLICE] = a->size[ISO_TIFF_TIME];
    a->step[ISO_TIFF_SLICE] = a->step[ISO_TIFF_TIME];
    a->size[ISO_TIFF_TIME] = 1;
}

/* Of several times or positions the vectors of the first one are read. */
static int count_components(const axes *a, const iso_tiff_stack *stack, const iso_volume_opts *opts) {
    const uint64_t all = opts->component_axes ? 1 : a->size[ISO_TIFF_TIME] * a->positions;
    uint64_t count;
    if (__builtin_mul_overflow(all * a->size[ISO_TIFF_CHANNEL], stack->layout.samples, &count) ||
        count > INT_MAX)
        return -1;
    return (int)count;
}

/* The samples of a pixel, such as red, green and blue, are of one channel. */
static void name_channels(const iso_tiff_stack *stack, const axes *a, iso_channels *channels) {
    const iso_channels *stated = &stack->metadata.channels;
    if (!channels || stack->layout.samples > 1 || !stated->count) return;
    if ((uint64_t)stated->count > a->size[ISO_TIFF_CHANNEL]) return;
    *channels = *stated;
    channels->count = (int)a->size[ISO_TIFF_CHANNEL];
}

static iso_status choose_component(const char *path, const iso_volume_opts *opts, const iso_tiff_stack *stack,
                                   const axes *a, iso_tiff_planes *planes, iso_volume_info *info,
                                   iso_error *error) {
    const int components = count_components(a, stack, opts);
    if (components < 0) return iso_fail(error, ISO_ERR_FORMAT, "%s: has too many channels", path);
    ISO_TRY(iso_format_component(path, opts, components, info, error));
    const uint64_t samples = stack->layout.samples, channels = a->size[ISO_TIFF_CHANNEL],
                   times = a->size[ISO_TIFF_TIME];
    const uint64_t plane = (uint64_t)info->component / samples, time = plane / channels % times,
                   position = plane / channels / times;
    *planes = (iso_tiff_planes){.slices = a->size[ISO_TIFF_SLICE],
                                .sample = (int)((uint64_t)info->component % samples),
                                .first = plane % channels * a->step[ISO_TIFF_CHANNEL] +
                                         time * a->step[ISO_TIFF_TIME] + position * a->position_step,
                                .step = a->step[ISO_TIFF_SLICE]};
    name_channels(stack, a, opts->channels);
    note_choice(info, "time", time, times, samples * channels);
    note_choice(info, "position", position, a->positions, samples * channels * times);
    return ISO_OK;
}

iso_status iso_tiff_planes_find(const char *path, const iso_volume_opts *opts, iso_tiff_stack *stack,
                                iso_tiff_planes *planes, iso_volume_info *info, iso_error *error) {
    axes a;
    const bool stated = stack->metadata.writer && find_axes(stack, &a);
    if (stated) {
        ISO_TRY(order_images(path, &a, stack, info, error));
        find_axes(stack, &a); /* again: with the planes that are there */
    }
    if (stated && plane_count(&a) == image_count(stack) && !stack->different.text[0])
        take_times_as_slices(&a, info);
    else
        ISO_TRY(take_all_images(stack, &a, info, error));
    const uint64_t dims[3] = {stack->layout.width, stack->layout.height, a.size[ISO_TIFF_SLICE]};
    ISO_TRY(iso_format_dims(path, dims, info, error));
    return choose_component(path, opts, stack, &a, planes, info, error);
}
