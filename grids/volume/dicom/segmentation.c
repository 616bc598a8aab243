/* segmentation: labels of DICOM segmentations (PS3.3, A.51, C.8.20 and C.8.31).
 *
 * Each frame is a slice of one segment (BINARY, FRACTIONAL) or of all (LABELMAP), placed by its functional
 * groups. Slices without anything of a segment may be left out, so the volume reaches from the first to the
 * last slice that is there. */
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "grids/volume/dicom/pixels.h"
#include "grids/volume/format.h"

/* Frames nearer than this, in mm, are of one slice; slices may be off their places by a share of their
 * distance, and by a share of a pixel to the side. */
static const double SAME_PLACE = 1e-3, OFF_STEP = 0.1, OFF_PIXEL = 0.5;

enum { MOST_SLICES = 65536, MOST_LABEL = 65535 };

static iso_vec3 position_of(const iso_dicom_frame *frame) {
    return iso_vec3_make(frame->position[0], frame->position[1], frame->position[2]);
}

static iso_vec3 normal_of(const iso_dicom_frame *frame) {
    const double *o = frame->orientation;
    return iso_vec3_unit(iso_vec3_cross(iso_vec3_make(o[0], o[1], o[2]), iso_vec3_make(o[3], o[4], o[5])));
}

static bool is_label_map(const iso_dicom_file *file) {
    return strcmp(file->segmentation, "LABELMAP") == 0;
}

static bool is_fractional(const iso_dicom_file *file) {
    return strcmp(file->segmentation, "FRACTIONAL") == 0;
}

static bool near(const double *a, const double *b, int count, double tolerance) {
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= tolerance)) return false;
    return true;
}

/* Whether all that is needed is stated, and can be a volume. */
static iso_status check(const char *path, iso_dicom_file *file, iso_error *error) {
    if (!is_label_map(file) && !is_fractional(file) && strcmp(file->segmentation, "BINARY") != 0)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: a segmentation of type '%s': BINARY, FRACTIONAL and LABELMAP are read", path,
                        file->segmentation);
    if (file->samples != 1 || file->bits_allocated > (is_fractional(file) ? 8 : 16) || file->is_signed)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a %s segmentation with %d values of %d bits a pixel",
                        path, file->segmentation, file->samples, file->bits_allocated);
    if (is_fractional(file) && file->whole_fraction < 1) file->whole_fraction = 255;
    const iso_dicom_frame *first = &file->frames[0];
    for (int i = 0; i < file->frame_count; i++) {
        iso_dicom_frame *frame = &file->frames[i];
        if (!frame->segment && file->segment_count == 1) frame->segment = file->segments[0].number;
        if (!frame->segment && !is_label_map(file))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: frame %d states no segment", path, i + 1);
        if (!frame->has_position || !(iso_vec3_length(position_of(frame)) <= 1e12))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: frame %d states no position in space (segmentations of slides are not read)",
                            path, i + 1);
        if (!near(frame->orientation, first->orientation, 6, 1e-3) ||
            !near(frame->pixel, first->pixel, 2, 1e-4 * first->pixel[0]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: frame %d has another direction or size than frame 1",
                            path, i + 1);
    }
    return ISO_OK;
}

static int compare_positions(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    if (a->at != b->at) return (a->at > b->at) - (a->at < b->at);
    return (a->index > b->index) - (a->index < b->index);
}

static int compare_segments(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    if (a->place != b->place) return (a->place > b->place) - (a->place < b->place);
    if (a->segment != b->segment) return (a->segment > b->segment) - (a->segment < b->segment);
    return (a->index > b->index) - (a->index < b->index);
}

/* Numbers the slices of frames that are sorted by position, with slices about `step` apart. Returns how many
 * there are, with those between; 0: that is not their distance. */
static size_t number_slices(iso_dicom_file *file, double step) {
    iso_dicom_frame *frames = file->frames;
    size_t place = 0;
    for (int i = 0; i < file->frame_count; i++) {
        const double gap = i ? frames[i].at - frames[i - 1].at : 0;
        const double steps = gap < SAME_PLACE ? 0 : floor(gap / step + 0.5);
        if (gap >= SAME_PLACE && (steps < 1 || fabs(gap / step - steps) > OFF_STEP * steps)) return 0;
        if (steps > MOST_SLICES || (place += (size_t)steps) >= MOST_SLICES) return 0;
        frames[i].place = place;
    }
    const iso_dicom_frame *first = &frames[0], *last = &frames[file->frame_count - 1];
    const iso_vec3 origin = position_of(first), normal = normal_of(first);
    const iso_vec3 whole = iso_vec3_sub(position_of(last), origin);
    const double exact = place ? iso_vec3_dot(whole, normal) / (double)place : 1;
    for (int i = 0; i < file->frame_count; i++) {
        const double part = place ? (double)frames[i].place / (double)place : 0;
        const iso_vec3 off =
            iso_vec3_sub(iso_vec3_sub(position_of(&frames[i]), origin), iso_vec3_scale(whole, part));
        const double along = iso_vec3_dot(off, normal);
        const double aside = iso_vec3_length(iso_vec3_sub(off, iso_vec3_scale(normal, along)));
        const double pixel = fmin(first->pixel[0], first->pixel[1]);
        if (fabs(along) > OFF_STEP * exact || aside > OFF_PIXEL * (pixel > 0 ? pixel : 1)) return 0;
    }
    return place + 1;
}

/* The smallest distance of two slices; 0: there is one. */
static double smallest_gap(const iso_dicom_file *file) {
    double smallest = 0;
    for (int i = 1; i < file->frame_count; i++) {
        const double gap = file->frames[i].at - file->frames[i - 1].at;
        if (gap >= SAME_PLACE && (smallest == 0 || gap < smallest)) smallest = gap;
    }
    return smallest;
}

static iso_status place_frames(const char *path, iso_dicom_file *file, size_t *slices, iso_error *error) {
    const iso_vec3 normal = normal_of(&file->frames[0]);
    for (int i = 0; i < file->frame_count; i++)
        file->frames[i].at = iso_vec3_dot(position_of(&file->frames[i]), normal);
    qsort(file->frames, (size_t)file->frame_count, sizeof *file->frames, compare_positions);
    const double stated = fabs(file->frames[0].between), gap = smallest_gap(file);
    *slices = stated > 0 ? number_slices(file, stated) : 0;
    if (!*slices) *slices = number_slices(file, gap > 0 ? gap : 1);
    if (!*slices)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its slices are not evenly spaced in one line", path);
    return ISO_OK;
}

/* The transform of all slices, by the planes of a stack without gaps. */
static iso_status stack_slices(const char *path, const iso_dicom_file *file, size_t slices,
                               iso_volume_info *info, iso_error *error) {
    iso_dicom_frame *planes = iso_alloc(slices * sizeof *planes);
    if (!planes) return iso_fail_memory(error, path);
    const iso_dicom_frame *first = &file->frames[0], *last = &file->frames[file->frame_count - 1];
    for (size_t k = 0; k < slices; k++) {
        const double part = slices > 1 ? (double)k / (double)(slices - 1) : 0;
        planes[k] = *first;
        planes[k].file = 0;
        planes[k].index = (int)k;
        for (int i = 0; i < 3; i++) planes[k].position[i] += part * (last->position[i] - first->position[i]);
    }
    const iso_dicom_wanted wanted = {path, "", file, SIZE_MAX, 1, 0};
    const iso_status status = iso_dicom_stack(&wanted, planes, &slices, info, error);
    iso_free(planes);
    return status;
}

/* Numbers of segments up to 255 need a byte a voxel. */
static iso_scalar scalar_of(const iso_dicom_file *file) {
    int most = is_label_map(file) && file->bits_allocated == 16 ? MOST_LABEL : 0;
    for (int i = 0; i < file->frame_count && !is_label_map(file); i++)
        if (file->frames[i].segment > most) most = file->frames[i].segment;
    return most > 255 ? ISO_SCALAR_UINT16 : ISO_SCALAR_UINT8;
}

iso_status iso_dicom_segmentation_order(const char *path, iso_dicom_file *file, iso_volume_info *info,
                                        iso_error *error) {
    size_t slices;
    ISO_TRY(check(path, file, error));
    ISO_TRY(place_frames(path, file, &slices, error));
    ISO_TRY(stack_slices(path, file, slices, info, error));
    qsort(file->frames, (size_t)file->frame_count, sizeof *file->frames, compare_segments);
    info->dims[0] = file->columns;
    info->dims[1] = file->rows;
    const iso_scalar scalar = scalar_of(file);
    info->type = iso_scalar_stored_type(scalar);
    info->scale = 1;
    info->offset = 0;
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(scalar));
    snprintf(info->name, sizeof info->name, "%s", *file->description ? file->description : file->series);
    iso_volume_note(info, "a DICOM segmentation (%s) of %zu segment%s", file->segmentation,
                    file->segment_count, file->segment_count == 1 ? "" : "s");
    if (is_fractional(file)) iso_volume_note(info, "what is half or more of a segment is taken for it");
    const uint64_t work = iso_dicom_frame_bytes(file) + (file->encapsulated ? 2 * file->pixel_bytes : 0);
    info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (__builtin_add_overflow(info->bytes, work, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

/* ---- voxels */

/* The label of pixel i of a frame; 0: background. */
static int label_at(const iso_dicom_file *file, const iso_dicom_frame *frame, const void *pixels, size_t i) {
    if (file->bits_allocated == 1) return ((const uint8_t *)pixels)[i] ? frame->segment : 0;
    const int value = (int)iso_dicom_value(file, pixels, i);
    if (is_label_map(file)) return value == file->padding ? 0 : value;
    if (is_fractional(file)) return 2 * value >= file->whole_fraction ? frame->segment : 0;
    return value ? frame->segment : 0;
}

/* Puts a frame into its slice. several: of each of its pixels, whether it has been found in two segments;
 * returns in how many that is so for the first time. */
static size_t add_frame(const iso_dicom_file *file, const iso_dicom_frame *frame, const void *pixels,
                        iso_rgrid *grid, uint8_t *several) {
    const size_t count = (size_t)file->rows * (size_t)file->columns;
    const size_t start = frame->place * (size_t)grid->stride_z;
    uint8_t *bytes = grid->type == ISO_UINT8 ? (uint8_t *)grid->data + start : NULL;
    uint16_t *halves = bytes ? NULL : (uint16_t *)grid->data + start;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        const int label = label_at(file, frame, pixels, i), before = bytes ? bytes[i] : halves[i];
        if (!label) continue;
        if (before && before != label && !several[i]) several[i] = 1, found++;
        if (bytes)
            bytes[i] = (uint8_t)label;
        else
            halves[i] = (uint16_t)label;
    }
    return found;
}

static iso_status read_frames(const char *path, const iso_volume_opts *opts, const iso_dicom_pixels *open,
                              uint8_t *work, iso_rgrid *grid, size_t *overlaps, iso_error *error) {
    const iso_dicom_file *file = open->file;
    uint8_t *several = work + iso_dicom_frame_bytes(file);
    for (int i = 0; i < file->frame_count; i++) {
        const iso_dicom_frame *frame = &file->frames[i];
        char warning[ISO_DICOM_WARNING];
        ISO_TRY(iso_dicom_pixels_read(open, frame->index, work, warning, error));
        if (*warning)
            return iso_fail(error, ISO_ERR_IO, "%s: the pixels of frame %d are damaged: %s", path,
                            frame->index + 1, warning);
        if (i == 0 || frame->place != file->frames[i - 1].place)
            memset(several, 0, (size_t)file->rows * (size_t)file->columns);
        *overlaps += add_frame(file, frame, work, grid, several);
        ISO_TRY(iso_format_progress(path, opts, (double)(i + 1) / (double)file->frame_count, error));
    }
    return ISO_OK;
}

iso_status iso_dicom_segmentation_read(const char *path, const iso_volume_opts *opts,
                                       const iso_dicom_file *file, iso_volume_info *info, iso_rgrid *grid,
                                       iso_error *error) {
    const size_t pixels = (size_t)file->rows * (size_t)file->columns;
    iso_dicom_pixels open = {0};
    size_t overlaps = 0;
    memset(grid->data, 0, (size_t)info->dims[2] * (size_t)grid->stride_z * iso_type_size(grid->type));
    uint8_t *work = iso_alloc((size_t)iso_dicom_frame_bytes(file) + pixels);
    iso_status status = work ? iso_dicom_pixels_open(file, &open, error) : iso_fail_memory(error, path);
    if (status == ISO_OK) status = read_frames(path, opts, &open, work, grid, &overlaps, error);
    if (overlaps)
        iso_volume_note(info,
                        "%zu voxel%s to several segments: the one with the greatest number is drawn there",
                        overlaps, overlaps == 1 ? " belongs" : "s belong");
    iso_dicom_pixels_close(&open);
    iso_free(work);
    return status;
}
