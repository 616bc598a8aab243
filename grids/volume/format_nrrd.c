/* format_nrrd: reads NRRD (.nrrd, .nhdr); parser and decoders are in grids/volume/nrrd.h.
 *
 * The library teem reads the whole format, but is not used because it trusts the file. teem 1.12 (of 2016, as
 * in Debian) copies long header lines into fixed buffers, passes file names to printf, counts as far as a
 * header states, and takes quadratic time for key/value pairs. Checking all this before calling teem would be
 * as much work as parsing. Its decoders read whole arrays without progress reports, leak memory when a gzip
 * stream ends early, and overflow at a long number in text. The encodings need only zlib, libbz2 (the only
 * optional one) or a few lines. A header has at most ISO_NRRD_HEADER_BYTES.
 *
 * NRRD names its world by `space`. LPS is used as it is; RAS and LAS differ from it by the signs of x and y.
 * 3D-left-handed names no anatomical axes and only states that z is opposite to x cross y. Such a volume
 * would be mirrored in a right-handed world, so one axis must be negated, and any of the three would give the
 * right shape. z is negated: x and y then remain those of the displayed slices, and stacks of this kind
 * (VTK's headsq data) number their slices downwards, so the head is upright. */
#include <math.h>
#include <string.h>

#include "grids/volume/nrrd.h"

/* The roles of the array's axes. Axes of components come before the axes of space (interleaved components),
 * after them (planar components), or both. */
typedef struct layout {
    int space[3], space_count; /* numbers of the axes of space */
    int interleaved, planar;   /* numbers of components: products of the sizes of these axes */
} layout;

/* ---- axes ---- */

/* Whether an axis has a direction in the first three axes of the world (in a ...-time space the fourth is
 * time). */
static bool has_direction(const iso_nrrd_header *nrrd, unsigned axis) {
    const double *d = nrrd->axis[axis].direction;
    if (nrrd->space_dim == 0 || !isfinite(d[0])) return false;
    if (nrrd->space_dim < 4) return true;
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

/* The axis of components of a four-axis array whose header does not tell: the one without a spacing, or else
 * the smaller of the first and the last. */
static unsigned guess_component_axis(const iso_nrrd_header *nrrd) {
    unsigned last = nrrd->dim - 1;
    bool first_spaced = isfinite(nrrd->axis[0].spacing), last_spaced = isfinite(nrrd->axis[last].spacing);
    if (first_spaced != last_spaced) return first_spaced ? last : 0;
    return nrrd->axis[0].size < nrrd->axis[last].size ? 0 : last;
}

static void mark_space(const iso_nrrd_header *nrrd, bool space[ISO_NRRD_AXES]) {
    unsigned directed = 0, spatial = 0;
    for (unsigned i = 0; i < nrrd->dim; i++) directed += has_direction(nrrd, i);
    for (unsigned i = 0; i < nrrd->dim; i++) {
        space[i] = directed ? has_direction(nrrd, i) : !nrrd->axis[i].other;
        spatial += space[i];
    }
    if (spatial == 4 && nrrd->dim == 4 && !directed) space[guess_component_axis(nrrd)] = false;
}

static bool multiply(int *product, uint64_t size) {
    return size >= 1 && size <= INT32_MAX && !__builtin_mul_overflow(*product, (int)size, product);
}

static iso_status find_layout(const char *path, const iso_nrrd_header *nrrd, layout *found,
                              iso_error *error) {
    bool space[ISO_NRRD_AXES] = {false};
    mark_space(nrrd, space);
    *found = (layout){.interleaved = 1, .planar = 1};
    bool after = false;
    for (unsigned i = 0; i < nrrd->dim; i++) {
        uint64_t size = nrrd->axis[i].size;
        if (space[i]) {
            if (found->space_count == 3)
                return iso_fail(error, ISO_ERR_FORMAT, "%s: has more than three axes of space", path);
            if (after)
                return iso_fail(error, ISO_ERR_FORMAT, "%s: axis %u lies between the axes of space", path,
                                i - 1);
            found->space[found->space_count++] = (int)i;
        } else if (size != 1) {
            after = found->space_count > 0;
            if (!multiply(after ? &found->planar : &found->interleaved, size))
                return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot have %llu components", path,
                                (unsigned long long)size);
        }
    }
    if (found->space_count == 0) return iso_fail(error, ISO_ERR_FORMAT, "%s: has no axis of space", path);
    return ISO_OK;
}

/* ---- world ---- */

/* The step along an axis without a direction: from its spacing (negative: the axis runs in the opposite
 * direction), else its range, else its thickness, else 1. */
static double axis_step(const iso_nrrd_header *nrrd, int axis, iso_volume_info *info) {
    const iso_nrrd_axis *a = &nrrd->axis[axis];
    double step = 1;
    if (isfinite(a->spacing) && a->spacing != 0) {
        step = a->spacing;
    } else if (isfinite(a->min) && isfinite(a->max) && a->min != a->max) {
        double intervals = (double)a->size - a->node_centered;
        step = intervals > 0 ? (a->max - a->min) / intervals : 1;
    } else if (isfinite(a->thickness) && a->thickness > 0) {
        step = a->thickness;
        iso_volume_note(info, "axis %d has no spacing: its thickness %g is used", axis, step);
    }
    return step * a->unit_mm;
}

/* The position of the first sample on an axis without a direction. */
static double axis_origin(const iso_nrrd_header *nrrd, int axis, double step) {
    const iso_nrrd_axis *a = &nrrd->axis[axis];
    if (!isfinite(a->min)) return 0;
    return a->min * a->unit_mm + (a->node_centered ? 0 : step / 2);
}

static void set_axis(iso_transform *transform, int axis, iso_vec3 step) {
    iso_vec3 unit = iso_vec3_unit(step);
    transform->spacing[axis] = iso_vec3_length(step);
    transform->direction[axis] = unit.x;
    transform->direction[3 + axis] = unit.y;
    transform->direction[6 + axis] = unit.z;
}

static void take_directions(const iso_nrrd_header *nrrd, const layout *found, iso_transform *transform) {
    int dim = nrrd->space_dim < 3 ? (int)nrrd->space_dim : 3;
    double unit[3] = {1, 1, 1};
    for (int i = 0; i < dim; i++) {
        unit[i] = nrrd->space_unit_mm[i];
        transform->origin[i] = isfinite(nrrd->space_origin[i]) ? nrrd->space_origin[i] * unit[i] : 0;
    }
    for (int axis = 0; axis < found->space_count; axis++) {
        double d[3] = {0, 0, 0};
        for (int i = 0; i < dim; i++) d[i] = nrrd->axis[found->space[axis]].direction[i] * unit[i];
        set_axis(transform, axis, iso_vec3_make(d[0], d[1], d[2]));
    }
    if (found->space_count == 2) { /* one slice: the third axis is perpendicular to it */
        const double *m = transform->direction;
        set_axis(
            transform, 2,
            iso_vec3_unit(iso_vec3_cross(iso_vec3_make(m[0], m[3], m[6]), iso_vec3_make(m[1], m[4], m[7]))));
    }
}

static void take_transform(const iso_nrrd_header *nrrd, const layout *found, iso_volume_info *info) {
    iso_transform *transform = &info->transform;
    if (has_direction(nrrd, (unsigned)found->space[0])) {
        take_directions(nrrd, found, transform);
    } else {
        for (int axis = 0; axis < found->space_count; axis++) {
            double step = axis_step(nrrd, found->space[axis], info);
            transform->spacing[axis] = step < 0 ? -step : step;
            transform->direction[4 * axis] = step < 0 ? -1 : 1;
            transform->origin[axis] = axis_origin(nrrd, found->space[axis], step);
        }
    }
    info->anatomical = nrrd->anatomical;
    info->unitless = !nrrd->anatomical && !nrrd->has_space_unit && !nrrd->axis[found->space[0]].has_unit;
    for (int i = 0; i < 9; i++) transform->direction[i] *= nrrd->space_sign[i / 3];
    for (int i = 0; i < 3; i++) transform->origin[i] *= nrrd->space_sign[i];
}

/* Vectors and matrices are given in the measurement frame, whose axes are the columns of a matrix, or else in
 * the space. */
static void take_component_axes(const iso_nrrd_header *nrrd, iso_component_axes *axes) {
    const bool framed =
        nrrd->space_dim >= 3 && isfinite(nrrd->frame[0][0] + nrrd->frame[1][0] + nrrd->frame[2][0]);
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            axes->to_world[3 * row + axis] =
                nrrd->space_sign[row] * (framed ? nrrd->frame[axis][row] : row == axis);
    axes->stated = framed || nrrd->anatomical;
}

/* ---- header ---- */

static iso_format_stream stream_of(const iso_nrrd_header *nrrd, const layout *found,
                                   const iso_volume_info *info) {
    return (iso_format_stream){.scalar = nrrd->scalar,
                               .components = found->interleaved,
                               .component = info->component % found->interleaved,
                               .swap = nrrd->swap};
}

static iso_status describe(const char *path, const iso_nrrd_header *nrrd, const iso_volume_opts *opts,
                           layout *found, iso_volume_info *info, iso_error *error) {
    ISO_TRY(find_layout(path, nrrd, found, error));
    uint64_t dims[3] = {1, 1, 1};
    for (int i = 0; i < found->space_count; i++) dims[i] = nrrd->axis[found->space[i]].size;
    ISO_TRY(iso_format_dims(path, dims, info, error));
    int components = found->interleaved;
    if (!multiply(&components, (uint64_t)found->planar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many components", path);
    ISO_TRY(iso_format_component(path, opts, components, info, error));
    info->type = iso_scalar_stored_type(nrrd->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(nrrd->scalar));
    take_transform(nrrd, found, info);
    if (opts->component_axes) take_component_axes(nrrd, opts->component_axes);
    iso_format_stream stream = stream_of(nrrd, found, info);
    iso_format_stream_room(&stream, info);
    return ISO_OK;
}

/* Where the array is, for rewriting: if it is all behind the header, as it is or compressed by gzip. */
static void tell_place(const iso_nrrd_header *nrrd, const layout *found, iso_format_place *place) {
    const bool gzip = nrrd->encoding == ISO_NRRD_GZIP, split = found->interleaved > 1 && found->planar > 1;
    if (nrrd->place != ISO_NRRD_ATTACHED || nrrd->byte_skip || nrrd->line_skip || split ||
        (!gzip && nrrd->encoding != ISO_NRRD_RAW))
        return;
    *place = (iso_format_place){.told = true,
                                .swap = nrrd->swap,
                                .separate = found->interleaved == 1,
                                .gzip = gzip,
                                .scalar = nrrd->scalar,
                                .position = gzip ? 0 : nrrd->after,
                                .plain = gzip ? nrrd->after : 0};
}

static iso_status nrrd_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_nrrd_header nrrd;
    layout found;
    ISO_TRY(iso_nrrd_header_read(path, &nrrd, error));
    iso_nrrd_data_list(path, &nrrd, opts->files);
    ISO_TRY(describe(path, &nrrd, opts, &found, info, error));
    tell_place(&nrrd, &found, opts->place);
    return ISO_OK;
}

/* ---- voxels ---- */

static iso_status read_data(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                            const iso_format_stream *stream, iso_grid *grid, iso_error *error) {
    uint64_t plane =
        iso_format_size(info->dims, iso_scalar_size(stream->scalar) * (uint64_t)stream->components);
    uint64_t before = (uint64_t)(info->component / stream->components);
    uint64_t behind = (uint64_t)(info->components / stream->components) - before - 1;
    ISO_TRY(iso_nrrd_data_skip(stream->context, plane * before, error));
    ISO_TRY(iso_format_read_stream(path, opts, info, stream, grid, error));
    iso_status status = iso_nrrd_data_skip(stream->context, plane * behind, error);
    if (status != ISO_OK) iso_grid_destroy(grid);
    return status;
}

/* Checks that the header still describes the array that `info` was made from: the file may have changed
 * since. */
static iso_status same_array(const char *path, const iso_nrrd_header *nrrd, const iso_volume_opts *opts,
                             const iso_volume_info *info, layout *found, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    ISO_TRY(describe(path, nrrd, opts, found, &now, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) == 0 && now.type == info->type &&
        now.components == info->components && now.read_bytes <= info->read_bytes)
        return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
}

static iso_status nrrd_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    iso_nrrd_header nrrd;
    layout found;
    iso_nrrd_data *data = NULL;
    ISO_TRY(iso_nrrd_header_read(path, &nrrd, error));
    ISO_TRY(same_array(path, &nrrd, opts, info, &found, error));
    ISO_TRY(iso_nrrd_data_open(path, &nrrd, &data, error));
    iso_format_stream stream = stream_of(&nrrd, &found, info);
    stream.fill = iso_nrrd_data_fill;
    stream.context = data;
    stream.plain = iso_nrrd_data_plain;
    iso_status status = read_data(path, opts, info, &stream, grid, error);
    const char *longer = iso_nrrd_data_longer(data);
    if (status == ISO_OK && longer)
        iso_volume_note(
            info,
            "%s goes on behind the array, which is right only if it begins where the header says: a "
            "'byte skip' may be missing",
            longer);
    iso_nrrd_data_close(data);
    return status;
}

const iso_format iso_format_nrrd = {"nrrd", "isopoint", NULL, nrrd_info, nrrd_read, NULL};
