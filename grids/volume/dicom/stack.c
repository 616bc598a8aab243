/* stack: sorts image planes into the slices of a volume (PS3.3, C.7.6.2).
 *
 * The location of a slice is its position along the normal of the image plane; thickness, file names and
 * instance numbers are not reliable. A missing slice is an error, because a viewer could not see that a part
 * of the body is missing or interpolated. */
#include "base/numbers.h"
#include "grids/volume/dicom/dicom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Planes nearer to each other than this, in mm, have the same position; scanners write positions to 1/1000 mm
 * or better. */
static const double SAME_PLACE = 1e-3;

/* Allowed differences of steps between slices from the usual step. QUIET_STEP (a fraction of it) plus
 * ROUNDING (mm, for positions rounded to 1/100 mm): no note, as a surface moves by a hundredth of a voxel. Up
 * to NOTED_STEP (a fraction): a note. Above that it is a gap: a missing slice doubles the step. */
static const double QUIET_STEP = 0.01, ROUNDING = 0.01, NOTED_STEP = 0.1;

typedef struct stack {
    const char *path;
    const iso_dicom_file *files;
    iso_dicom_frame *frames;
    size_t count;
    bool by_position; /* else by number */
    iso_volume_info *info;
    iso_error *error;
} stack;

static const char *name_of(const stack *s, size_t i) {
    const char *path = s->files[s->frames[i].file].path, *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static iso_vec3 position_of(const iso_dicom_frame *frame) {
    return iso_vec3_make(frame->position[0], frame->position[1], frame->position[2]);
}

static iso_vec3 normal_of(const iso_dicom_frame *frame) {
    const double *o = frame->orientation;
    return iso_vec3_unit(iso_vec3_cross(iso_vec3_make(o[0], o[1], o[2]), iso_vec3_make(o[3], o[4], o[5])));
}

/* ---- sorting ---- */

static int compare_longs(long a, long b) {
    return (a > b) - (a < b);
}

static int compare_phases(const iso_dicom_frame *a, const iso_dicom_frame *b) {
    for (int i = 0; i < 3; i++)
        if (a->phase[i] != b->phase[i]) return compare_longs(a->phase[i], b->phase[i]);
    return 0;
}

/* Sorts by position. Ties are decided by `file` and `index`, which do not depend on the machine: files are
 * listed by name. */
static int compare_places(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    if (a->at != b->at) return (a->at > b->at) - (a->at < b->at);
    int phases = compare_phases(a, b);
    if (phases) return phases;
    if (a->file != b->file) return a->file < b->file ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

static iso_status choose_order(stack *s) {
    bool positions = true, numbers = true;
    for (size_t i = 0; i < s->count; i++) {
        positions &= s->frames[i].has_position;
        numbers &= s->frames[i].has_number;
    }
    s->by_position = positions || s->count == 1;
    if (!s->by_position && !numbers)
        return iso_fail(s->error, ISO_ERR_FORMAT,
                        "%s: slices cannot be ordered: neither positions nor instance numbers are stated",
                        s->path);
    if (!s->by_position)
        iso_volume_note(s->info, "positions are missing: slices are in the order of their instance numbers");
    iso_vec3 normal = normal_of(&s->frames[0]);
    for (size_t i = 0; i < s->count; i++) {
        iso_dicom_frame *frame = &s->frames[i];
        double far = iso_vec3_length(position_of(frame));
        if (s->by_position &&
            !(far <= 1e12)) /* the limit of grids/volume/volume.c; beyond it slices would coincide */
            return iso_fail(s->error, ISO_ERR_FORMAT, "%s: a position of %g mm (in %s) is not possible",
                            s->path, far, name_of(s, i));
        frame->at = s->by_position ? iso_vec3_dot(position_of(frame), normal) : (double)frame->number;
    }
    qsort(s->frames, s->count, sizeof *s->frames, compare_places);
    return ISO_OK;
}

/* ---- several planes at the same position ---- */

static bool same_place(const stack *s, size_t i) {
    return s->frames[i + 1].at - s->frames[i].at < SAME_PLACE;
}

static size_t first_doubled(const stack *s) {
    for (size_t i = 0; i + 1 < s->count; i++)
        if (same_place(s, i)) return i;
    return s->count;
}

/* Where planes share a position, keeps those of the acquisition with the lowest phase. */
static void keep_first_phase(stack *s, size_t doubled) {
    const iso_dicom_frame *first = &s->frames[doubled];
    for (size_t i = doubled; i + 1 < s->count; i++)
        if (same_place(s, i) && compare_phases(&s->frames[i], first) < 0) first = &s->frames[i];
    const iso_dicom_frame kept = *first;
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        if (compare_phases(&s->frames[i], &kept) == 0) s->frames[count++] = s->frames[i];
    iso_volume_note(s->info, "several acquisitions at the same places: %zu images of later ones are left out",
                    s->count - count);
    s->count = count;
}

static iso_status resolve_doubles(stack *s) {
    size_t i = first_doubled(s);
    if (i < s->count && compare_phases(&s->frames[i], &s->frames[i + 1]) != 0) {
        keep_first_phase(s, i);
        i = first_doubled(s);
    }
    if (i == s->count) return ISO_OK;
    if (!s->by_position)
        return iso_fail(s->error, ISO_ERR_FORMAT, "%s: %s and %s have the same instance number %ld", s->path,
                        name_of(s, i), name_of(s, i + 1), s->frames[i].number);
    if (s->frames[i].file == s->frames[i + 1].file)
        return iso_fail(s->error, ISO_ERR_FORMAT,
                        "%s: frames %d and %d of %s lie at the same place (%.6g mm)", s->path,
                        s->frames[i].index + 1, s->frames[i + 1].index + 1, name_of(s, i), s->frames[i].at);
    return iso_fail(s->error, ISO_ERR_FORMAT, "%s: %s and %s lie at the same place (%.6g mm)", s->path,
                    name_of(s, i), name_of(s, i + 1), s->frames[i].at);
}

/* ---- gaps ---- */

/* Sets *step to the lower median of the steps between slices, which is right also if every other slice is
 * missing at one end. */
static iso_status usual_step(const stack *s, double *step) {
    size_t steps = s->count - 1;
    double *sorted = iso_alloc(steps * sizeof *sorted);
    if (!sorted) return iso_fail_memory(s->error, s->path);
    for (size_t i = 0; i < steps; i++) sorted[i] = s->frames[i + 1].at - s->frames[i].at;
    qsort(sorted, steps, sizeof *sorted, iso_compare_doubles);
    *step = sorted[(steps - 1) / 2];
    iso_free(sorted);
    return ISO_OK;
}

static iso_status fail_gap(const stack *s, size_t i, double usual) {
    double from = s->frames[i].at, to = s->frames[i + 1].at, ratio = (to - from) / usual;
    double whole = floor(ratio + 0.5);
    const char *unit = s->by_position ? " mm" : "";
    if (whole < 2 || fabs(ratio - whole) > NOTED_STEP * whole)
        return iso_fail(s->error, ISO_ERR_FORMAT,
                        "%s: slices are not evenly spaced: %.6g%s between %s (at %.6g) and %s (at %.6g), "
                        "elsewhere %.6g",
                        s->path, to - from, unit, name_of(s, i), from, name_of(s, i + 1), to, usual);
    return iso_fail(s->error, ISO_ERR_FORMAT,
                    "%s: %.0f slice%s missing: a gap of %.6g%s between %s (at %.6g) and %s (at %.6g), "
                    "elsewhere %.6g",
                    s->path, whole - 1, whole > 2 ? "s are" : " is", to - from, unit, name_of(s, i), from,
                    name_of(s, i + 1), to, usual);
}

/* Refuses a stack with missing slices: one in which a step between slices differs from the usual step by more
 * than NOTED_STEP of it (and more than rounding). Smaller differences, from QUIET_STEP on, become a note. */
static iso_status check_gaps(const stack *s) {
    double usual = 0, worst = 0;
    if (s->count < 2) return ISO_OK;
    ISO_TRY(usual_step(s, &usual));
    for (size_t i = 0; i + 1 < s->count; i++) {
        double off = fabs(s->frames[i + 1].at - s->frames[i].at - usual);
        if (off > NOTED_STEP * usual && off > fmin(ROUNDING, 0.5 * usual)) return fail_gap(s, i, usual);
        worst = fmax(worst, off);
    }
    if (worst > QUIET_STEP * usual && worst > ROUNDING)
        iso_volume_note(s->info, "the distance between slices varies by %.3g mm about %.6g mm", worst, usual);
    return ISO_OK;
}

/* ---- geometry ---- */

static double first_positive(double a, double b) {
    return a > 0 ? a : b;
}

static void in_plane(const stack *s, iso_transform *transform) {
    const iso_dicom_frame *frame = &s->frames[0];
    for (int i = 0; i < 3; i++) {
        transform->origin[i] = frame->position[i];
        transform->direction[3 * i] = frame->orientation[i];
        transform->direction[3 * i + 1] = frame->orientation[3 + i];
    }
    transform->spacing[0] = transform->spacing[1] = 1;
    if (frame->pixel[0] > 0 && frame->pixel[1] > 0) {
        transform->spacing[0] = frame->pixel[1];
        transform->spacing[1] = frame->pixel[0];
    } else {
        iso_volume_note(s->info, "pixel spacing is missing or not positive: taken to be 1 mm");
    }
    if (!frame->has_orientation)
        iso_volume_note(s->info, "orientation is missing: rows and columns are taken for x and y");
}

static void set_slice_axis(iso_transform *transform, iso_vec3 axis, double spacing) {
    transform->direction[2] = axis.x;
    transform->direction[5] = axis.y;
    transform->direction[8] = axis.z;
    transform->spacing[2] = spacing;
}

/* The slice axis when there are no positions: by the stated distance between slices, else by their thickness.
 */
static void unmeasured_axis(const stack *s, iso_transform *transform) {
    const iso_dicom_frame *frame = &s->frames[0];
    double spacing = first_positive(fabs(frame->between), frame->thickness);
    if (!(spacing > 0)) {
        spacing = 1;
        iso_volume_note(s->info, "the distance between slices is not stated: taken to be 1 mm");
    } else if (s->count > 1) {
        iso_volume_note(s->info, "the distance between slices, %.6g mm, is taken from the slice %s", spacing,
                        fabs(frame->between) > 0 ? "spacing" : "thickness");
    }
    set_slice_axis(transform, normal_of(frame), spacing);
}

/* The slice axis from the position of the first slice to that of the last. With a tilted gantry it is not the
 * normal, and the grid is sheared. */
static iso_status measured_axis(const stack *s, iso_transform *transform) {
    const iso_dicom_frame *first = &s->frames[0];
    iso_vec3 origin = position_of(first), normal = normal_of(first);
    iso_vec3 whole = iso_vec3_sub(position_of(&s->frames[s->count - 1]), origin);
    double steps = (double)(s->count - 1);
    iso_vec3 step = iso_vec3_scale(whole, 1 / steps);
    iso_vec3 aside = iso_vec3_sub(step, iso_vec3_scale(normal, iso_vec3_dot(step, normal)));
    double pixel = fmin(transform->spacing[0], transform->spacing[1]);
    for (size_t i = 0; i < s->count; i++) {
        iso_vec3 off = iso_vec3_sub(position_of(&s->frames[i]), origin);
        double along = iso_vec3_dot(off, normal) / iso_vec3_dot(step, normal);
        if (!(iso_vec3_length(iso_vec3_sub(off, iso_vec3_scale(step, along))) <= 0.5 * pixel))
            return iso_fail(s->error, ISO_ERR_FORMAT,
                            "%s: slices are not in line: %s lies aside of the others", s->path,
                            name_of(s, i));
    }
    if (iso_vec3_length(aside) * steps > 0.1 * pixel)
        iso_volume_note(s->info, "tilted gantry: each slice lies %.3g mm aside of the one before",
                        iso_vec3_length(aside));
    else
        step = iso_vec3_scale(normal, iso_vec3_dot(step, normal));
    set_slice_axis(transform, iso_vec3_unit(step), iso_vec3_length(step));
    return ISO_OK;
}

iso_status iso_dicom_stack(const char *path, const iso_dicom_file *files, iso_dicom_frame *frames,
                           size_t *count, iso_volume_info *info, iso_error *error) {
    stack s = {path, files, frames, *count, false, info, error};
    ISO_TRY(choose_order(&s));
    ISO_TRY(resolve_doubles(&s));
    ISO_TRY(check_gaps(&s));
    iso_transform transform = iso_transform_identity();
    in_plane(&s, &transform);
    if (s.by_position && s.count > 1)
        ISO_TRY(measured_axis(&s, &transform));
    else
        unmeasured_axis(&s, &transform);
    info->transform = transform;
    info->dims[2] = (int)s.count;
    info->anatomical = s.frames[0].has_orientation;
    *count = s.count;
    return ISO_OK;
}
