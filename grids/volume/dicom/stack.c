/* stack: sorts image planes into the slices of a volume (PS3.3, C.7.6.2).
 *
 * The location of a slice is its position along the normal of the image plane; thickness, file names and
 * instance numbers are not reliable. A missing slice is an error, because a viewer could not see that a part
 * of the body is missing or interpolated. Where several planes lie at the same place, as those of several
 * times or echoes do, one of these acquisitions becomes the volume. */
#include "base/numbers.h"
#include "grids/volume/dicom/dicom.h"

#include <math.h>
#include <stdio.h>
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
    const iso_dicom_wanted *wanted;
    iso_dicom_frame *frames;
    size_t count;
    size_t places, acquisitions;
    size_t largest, largest_planes; /* the acquisition with most planes; how many */
    size_t *scratch;                /* of `count` elements */
    bool by_position;               /* else by number */
    iso_volume_info *info;
    iso_error *error;
} stack;

static const char *name_of(const stack *s, size_t i) {
    return iso_dicom_folder_name(s->wanted->folder, s->wanted->files[s->frames[i].file].path);
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

static int compare_sizes(size_t a, size_t b) {
    return (a > b) - (a < b);
}

static int compare_phases(const iso_dicom_frame *a, const iso_dicom_frame *b) {
    for (int i = 0; i < 3; i++)
        if (a->phase[i] != b->phase[i]) return compare_longs(a->phase[i], b->phase[i]);
    return 0;
}

/* Decides ties by `file` and `index`, which do not depend on the machine: files are listed by name. */
static int compare_files(const iso_dicom_frame *a, const iso_dicom_frame *b) {
    return a->file != b->file ? compare_sizes(a->file, b->file)
                              : (a->index > b->index) - (a->index < b->index);
}

static int compare_positions(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    if (a->at != b->at) return (a->at > b->at) - (a->at < b->at);
    return compare_files(a, b);
}

/* Within a place by phase and then by instance number: in the order in which planes were acquired. */
static int compare_places(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    if (a->place != b->place) return compare_sizes(a->place, b->place);
    int phases = compare_phases(a, b);
    if (phases) return phases;
    if (a->number != b->number) return compare_longs(a->number, b->number);
    return compare_files(a, b);
}

static int compare_phase_first(const void *left, const void *right) {
    int phases = compare_phases(left, right);
    return phases ? phases : compare_places(left, right);
}

static int compare_number_first(const void *left, const void *right) {
    const iso_dicom_frame *a = left, *b = right;
    return a->number != b->number ? compare_longs(a->number, b->number) : compare_places(left, right);
}

static void sort(stack *s, int (*compare)(const void *, const void *)) {
    qsort(s->frames, s->count, sizeof *s->frames, compare);
}

static bool are_copies(const stack *s, const iso_dicom_frame *a, const iso_dicom_frame *b) {
    const char *one = s->wanted->files[a->file].instance, *other = s->wanted->files[b->file].instance;
    return a->file != b->file && a->index == b->index && a->number == b->number &&
           compare_phases(a, b) == 0 && *one && strcmp(one, other) == 0;
}

/* Of copies of an image, which lie at the same position, keeps the named file, or else the first by name. */
static void leave_out_copies(stack *s) {
    size_t count = 0, copied = 0;
    for (size_t i = 0; i < s->count; i++) {
        const iso_dicom_frame *frame = &s->frames[i];
        size_t same = count;
        while (same > 0 && s->frames[same - 1].at == frame->at && !are_copies(s, &s->frames[same - 1], frame))
            same--;
        if (same == 0 || s->frames[same - 1].at != frame->at) {
            s->frames[count++] = *frame;
            continue;
        }
        if (frame->file == s->wanted->named) s->frames[same - 1] = *frame;
        copied = same - 1;
    }
    const size_t copies = s->count - count;
    if (copies == 1) iso_volume_note(s->info, "a copy of %s is left out", name_of(s, copied));
    if (copies > 1) iso_volume_note(s->info, "%zu copies of images are left out", copies);
    s->count = count;
}

static void number_places(stack *s) {
    s->places = s->count > 0;
    for (size_t i = 0; i < s->count; i++) {
        if (i && s->frames[i].at - s->frames[i - 1].at >= SAME_PLACE) s->places++;
        s->frames[i].place = s->places - 1;
    }
    sort(s, compare_places);
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
                        s->wanted->path);
    if (!s->by_position)
        iso_volume_note(s->info, "positions are missing: slices are in the order of their instance numbers");
    iso_vec3 normal = normal_of(&s->frames[0]);
    for (size_t i = 0; i < s->count; i++) {
        iso_dicom_frame *frame = &s->frames[i];
        double far = iso_vec3_length(position_of(frame));
        if (s->by_position &&
            !(far <= 1e12)) /* the limit of grids/volume/volume.c; beyond it slices would coincide */
            return iso_fail(s->error, ISO_ERR_FORMAT, "%s: a position of %g mm (in %s) is not possible",
                            s->wanted->path, far, name_of(s, i));
        frame->at = s->by_position ? iso_vec3_dot(position_of(frame), normal) : (double)frame->number;
    }
    sort(s, compare_positions);
    leave_out_copies(s);
    number_places(s);
    return ISO_OK;
}

/* ---- several planes at the same place ---- */

/* Whether plane i and the next one lie at the same place. */
static bool same_place(const stack *s, size_t i) {
    return i + 1 < s->count && s->frames[i].place == s->frames[i + 1].place;
}

static size_t first_doubled(const stack *s) {
    size_t i = 0;
    while (i < s->count && !same_place(s, i)) i++;
    return i;
}

/* Whether all planes at the same place differ in phase or in instance number. Copies of a file do not. */
static bool are_told_apart(const stack *s) {
    for (size_t i = 0; i < s->count; i++)
        if (same_place(s, i) && compare_phases(&s->frames[i], &s->frames[i + 1]) == 0 &&
            s->frames[i].number == s->frames[i + 1].number)
            return false;
    return true;
}

/* Where there are equally many planes at all places: the first of each place are one acquisition, the second
 * another one, and so on. */
static bool divide_by_rank(stack *s) {
    const size_t each = s->count / s->places;
    for (size_t i = 0; i < s->count; i++) {
        if (s->frames[i].place != i / each) return false;
        s->frames[i].acquisition = i % each;
    }
    s->acquisitions = each;
    return true;
}

/* Planes of one phase are an acquisition. */
static bool divide_by_phase(stack *s) {
    sort(s, compare_phase_first);
    s->acquisitions = 0;
    for (size_t i = 0; i < s->count; i++) {
        const bool begins = i == 0 || compare_phases(&s->frames[i - 1], &s->frames[i]) != 0;
        if (!begins && s->frames[i - 1].place == s->frames[i].place) return false;
        s->acquisitions += begins;
        s->frames[i].acquisition = s->acquisitions - 1;
    }
    return true;
}

/* In the order of instance numbers, an acquisition begins where a place comes for the second time. */
static void divide_by_number(stack *s) {
    size_t *latest = s->scratch; /* of each place, from 1 */
    sort(s, compare_number_first);
    memset(latest, 0, s->count * sizeof *latest);
    s->acquisitions = 1;
    for (size_t i = 0; i < s->count; i++) {
        iso_dicom_frame *frame = &s->frames[i];
        s->acquisitions += latest[frame->place] == s->acquisitions;
        latest[frame->place] = s->acquisitions;
        frame->acquisition = s->acquisitions - 1;
    }
}

/* Finds the acquisition with most planes, the first of several. */
static void find_largest(stack *s) {
    size_t *sizes = s->scratch, best = 0;
    memset(sizes, 0, s->count * sizeof *sizes);
    for (size_t i = 0; i < s->count; i++) sizes[s->frames[i].acquisition]++;
    for (size_t i = 1; i < s->acquisitions; i++)
        if (sizes[i] > sizes[best]) best = i;
    s->largest = best;
    s->largest_planes = sizes[best];
}

/* Divides planes into acquisitions, none of which has two planes at one place. The largest must cover most
 * places, or all if only instance numbers tell planes apart: otherwise these tell something else. Returns
 * false if that is not possible. */
static bool divide(stack *s) {
    if (!are_told_apart(s)) return false;
    bool divided = divide_by_rank(s) || divide_by_phase(s);
    if (divided) find_largest(s);
    if (!divided || s->largest_planes <= s->places / 2) {
        divide_by_number(s);
        find_largest(s);
        divided = s->largest_planes == s->places;
    }
    sort(s, compare_places);
    return divided;
}

static iso_status fail_doubled(const stack *s, size_t i) {
    const iso_dicom_frame *one = &s->frames[i], *other = &s->frames[i + 1];
    const char *path = s->wanted->path;
    if (!s->by_position)
        return iso_fail(s->error, ISO_ERR_FORMAT, "%s: %s and %s have the same instance number %ld", path,
                        name_of(s, i), name_of(s, i + 1), one->number);
    if (one->file == other->file)
        return iso_fail(s->error, ISO_ERR_FORMAT,
                        "%s: frames %d and %d of %s lie at the same place (%.6g mm)", path, one->index + 1,
                        other->index + 1, name_of(s, i), one->at);
    return iso_fail(s->error, ISO_ERR_FORMAT, "%s: %s and %s lie at the same place (%.6g mm)", path,
                    name_of(s, i), name_of(s, i + 1), one->at);
}

/* The plane of the named file; s->count: no file is named. */
static size_t named_plane(const stack *s) {
    size_t i = 0;
    while (i < s->count && s->frames[i].file != s->wanted->named) i++;
    return i;
}

/* Planes that cannot be told apart from the named one are left out. */
static void keep_named(stack *s) {
    const size_t named = named_plane(s);
    if (named == s->count) return;
    const iso_dicom_frame chosen = s->frames[named];
    const char *name = name_of(s, named);
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->frames[i].place != chosen.place || s->frames[i].file == chosen.file)
            s->frames[count++] = s->frames[i];
    if (count < s->count)
        iso_volume_note(s->info, "%zu image%s at the place of %s %s left out", s->count - count,
                        s->count - count == 1 ? "" : "s", name, s->count - count == 1 ? "is" : "are");
    s->count = count;
}

static void keep_acquisition(stack *s, size_t chosen) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->frames[i].acquisition == chosen) s->frames[count++] = s->frames[i];
    iso_volume_note(
        s->info,
        "%zu acquisitions at the same places: using number %zu, %zu images of others are left out "
        "(--series %zu:%zu)",
        s->acquisitions, chosen + 1, s->count - count, s->wanted->series, chosen ? 1 : s->acquisitions);
    s->count = count;
}

/* Chooses one of several planes at the same place. */
static iso_status resolve_doubles(stack *s) {
    const size_t wanted = s->wanted->acquisition, doubled = first_doubled(s);
    s->acquisitions = 1;
    if (doubled < s->count && !divide(s)) {
        keep_named(s);
        if (first_doubled(s) < s->count) return fail_doubled(s, first_doubled(s));
        s->acquisitions = 1;
    }
    if (wanted > s->acquisitions)
        return iso_fail(s->error, ISO_ERR_USAGE, "%s: series %zu has no acquisition %zu, there %s %zu",
                        s->wanted->path, s->wanted->series, wanted, s->acquisitions == 1 ? "is" : "are",
                        s->acquisitions);
    if (s->acquisitions == 1) return ISO_OK;
    const size_t named = named_plane(s);
    keep_acquisition(s, wanted ? wanted - 1 : named < s->count ? s->frames[named].acquisition : s->largest);
    return ISO_OK;
}

/* ---- gaps ---- */

/* The unit of positions, for messages. */
static const char *unit_of(const stack *s) {
    return s->by_position ? " mm" : "";
}

/* Sets *step to the lower median of the steps between slices, which is right also if every other slice is
 * missing at one end. */
static iso_status usual_step(const stack *s, double *step) {
    size_t steps = s->count - 1;
    double *sorted = iso_alloc(steps * sizeof *sorted);
    if (!sorted) return iso_fail_memory(s->error, s->wanted->path);
    for (size_t i = 0; i < steps; i++) sorted[i] = s->frames[i + 1].at - s->frames[i].at;
    qsort(sorted, steps, sizeof *sorted, iso_compare_doubles);
    *step = sorted[(steps - 1) / 2];
    iso_free(sorted);
    return ISO_OK;
}

/* How many usual steps lie between slice i and the next one; 0: not a whole number. */
static double steps_between(const stack *s, size_t i, double usual) {
    const double ratio = (s->frames[i + 1].at - s->frames[i].at) / usual, whole = floor(ratio + 0.5);
    return whole >= 1 && fabs(ratio - whole) <= NOTED_STEP * whole ? whole : 0;
}

static iso_status fail_uneven(const stack *s, size_t i, double usual) {
    const double from = s->frames[i].at, to = s->frames[i + 1].at;
    return iso_fail(s->error, ISO_ERR_FORMAT,
                    "%s: slices are not evenly spaced: %.6g%s between %s (at %.6g) and %s (at %.6g), "
                    "elsewhere %.6g",
                    s->wanted->path, to - from, unit_of(s), name_of(s, i), from, name_of(s, i + 1), to,
                    usual);
}

/* Says how many slices are missing, and where. Slice i is where the step first differs from the usual one.
 * Where most slices are missing, the usual step is too long: then it is the smallest. */
static iso_status fail_gap(const stack *s, size_t i, double usual) {
    enum { NAMED_GAPS = 6 };
    double smallest = usual, missing = 0;
    size_t gaps = 0;
    char places[256] = "";
    for (size_t k = 0; k + 1 < s->count; k++)
        smallest = fmin(smallest, s->frames[k + 1].at - s->frames[k].at);
    if (smallest < (1 - NOTED_STEP) * usual && steps_between(s, i, smallest) > 0) {
        usual = smallest;
        for (i = 0; i + 2 < s->count && steps_between(s, i, usual) < 2;) i++;
    }
    for (size_t k = 0, used = 0; k + 1 < s->count; k++) {
        const double steps = steps_between(s, k, usual);
        if (!(steps > 0)) return fail_uneven(s, k, usual);
        if (steps < 2) continue;
        missing += steps - 1;
        if (gaps++ < NAMED_GAPS)
            used += (size_t)snprintf(places + used, sizeof places - used, "%s%.6g .. %.6g",
                                     gaps > 1 ? ", " : "", s->frames[k].at, s->frames[k + 1].at);
    }
    if (gaps == 1)
        return iso_fail(s->error, ISO_ERR_FORMAT,
                        "%s: %.0f slice%s missing: a gap of %.6g%s between %s (at %.6g) and %s (at %.6g), "
                        "elsewhere %.6g",
                        s->wanted->path, missing, missing > 1 ? "s are" : " is",
                        s->frames[i + 1].at - s->frames[i].at, unit_of(s), name_of(s, i), s->frames[i].at,
                        name_of(s, i + 1), s->frames[i + 1].at, usual);
    return iso_fail(s->error, ISO_ERR_FORMAT,
                    "%s: %.0f slices are missing in %zu gaps, at %s%s%s, elsewhere slices are %.6g%s apart",
                    s->wanted->path, missing, gaps, places, unit_of(s), gaps > NAMED_GAPS ? " and so on" : "",
                    usual, unit_of(s));
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
                            "%s: slices are not in line: %s lies aside of the others", s->wanted->path,
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

static iso_status make_slices(stack *s) {
    ISO_TRY(choose_order(s));
    ISO_TRY(resolve_doubles(s));
    ISO_TRY(check_gaps(s));
    iso_transform transform = iso_transform_identity();
    in_plane(s, &transform);
    if (s->by_position && s->count > 1)
        ISO_TRY(measured_axis(s, &transform));
    else
        unmeasured_axis(s, &transform);
    s->info->transform = transform;
    s->info->dims[2] = (int)s->count;
    s->info->anatomical = s->frames[0].has_orientation;
    return ISO_OK;
}

iso_status iso_dicom_stack(const iso_dicom_wanted *wanted, iso_dicom_frame *frames, size_t *count,
                           iso_volume_info *info, iso_error *error) {
    stack s = {.wanted = wanted, .frames = frames, .count = *count, .info = info, .error = error};
    s.scratch = malloc(s.count * sizeof *s.scratch);
    if (!s.scratch) return iso_fail_memory(error, wanted->path);
    const iso_status status = make_slices(&s);
    free(s.scratch);
    *count = s.count;
    return status;
}

size_t iso_dicom_count_acquisitions(const iso_dicom_wanted *wanted, iso_dicom_frame *frames, size_t count,
                                    size_t *slices) {
    iso_volume_info ignored = {0};
    stack s = {.wanted = wanted, .frames = frames, .count = count, .info = &ignored};
    *slices = count;
    s.scratch = malloc(count * sizeof *s.scratch);
    const bool several = s.scratch && choose_order(&s) == ISO_OK && first_doubled(&s) < s.count && divide(&s);
    if (several) *slices = s.largest_planes;
    free(s.scratch);
    return several ? s.acquisitions : 1;
}
