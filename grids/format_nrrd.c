/* format_nrrd: NRRD through teem, which knows every encoding, detached data, space directions and handedness.
 *
 * NRRD names its world by `space`. LPS is ours; RAS and LAS differ by the signs of x and y. 3D-left-handed
 * names no body axis, it says only that z points the other way from x cross y. Read as a right-handed world
 * the volume would come out mirrored, so one axis has to be negated, and any of the three gives the right
 * shape. z it is: x and y are then still those of the slices as they are shown, and stacks that say so (the
 * headsq data of VTK) number their slices downwards, so that the head also stands upright.
 *
 * biff, teem's error log, is global: one thread at a time is inside teem. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <teem/nrrd.h>

#include "grids/format.h"

static pthread_mutex_t teem_lock = PTHREAD_MUTEX_INITIALIZER;

/* Which axes of the array are what. Components are interleaved (before the axes of space), planar (after
 * them) or both. */
typedef struct layout {
    int space[3], space_count; /* axis numbers */
    int interleaved, planar;   /* products of sizes */
} layout;

/* ---- teem ---- */

static iso_status fail_teem(const char *path, iso_error *error) {
    char *text = biffGetDone(NRRD);
    char line[384] = "";
    size_t length = 0;
    /* biff's lines "[nrrd] function: reason" end with the one that knows most */
    char *last = NULL;
    for (char *part = text ? strtok(text, "\n") : NULL; part; part = strtok(NULL, "\n")) last = part;
    char *reason = last ? strstr(last, ": ") : NULL;
    for (const char *c = reason ? reason + 2 : "not a readable NRRD file"; *c && length + 1 < sizeof line;
         c++)
        line[length++] = (unsigned char)*c < ' ' ? ' ' : *c;
    line[length] = 0;
    free(text);
    return iso_fail(error, ISO_ERR_IO, "%s: %s", path, line);
}

static iso_status has_magic(const char *path, iso_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    char magic[4] = "";
    size_t count = fread(magic, 1, sizeof magic, file);
    fclose(file);
    if (count == sizeof magic && memcmp(magic, "NRRD", 4) == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not an NRRD file", path);
}

/* teem would also read tables of text, images and more under this name: only NRRD is wanted. */
static iso_status load(const char *path, bool header_only, Nrrd **nrrd, iso_error *error) {
    ISO_TRY(has_magic(path, error));
    Nrrd *loaded = nrrdNew();
    NrrdIoState *state = nrrdIoStateNew();
    if (!loaded || !state) {
        if (loaded) nrrdNuke(loaded);
        if (state) nrrdIoStateNix(state);
        return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
    }
    state->skipData = header_only;
    iso_status status = nrrdLoad(loaded, path, state) ? fail_teem(path, error) : ISO_OK;
    nrrdIoStateNix(state);
    if (status == ISO_OK)
        *nrrd = loaded;
    else
        nrrdNuke(loaded);
    return status;
}

static bool scalar_of(int type, iso_scalar *scalar) {
    static const struct {
        int type;
        iso_scalar scalar;
    } map[] = {{nrrdTypeUChar, ISO_SCALAR_UINT8},   {nrrdTypeChar, ISO_SCALAR_INT8},
               {nrrdTypeUShort, ISO_SCALAR_UINT16}, {nrrdTypeShort, ISO_SCALAR_INT16},
               {nrrdTypeUInt, ISO_SCALAR_UINT32},   {nrrdTypeInt, ISO_SCALAR_INT32},
               {nrrdTypeULLong, ISO_SCALAR_UINT64}, {nrrdTypeLLong, ISO_SCALAR_INT64},
               {nrrdTypeFloat, ISO_SCALAR_FLOAT},   {nrrdTypeDouble, ISO_SCALAR_DOUBLE}};
    for (size_t i = 0; i < sizeof map / sizeof *map; i++) {
        if (map[i].type != type) continue;
        *scalar = map[i].scalar;
        return true;
    }
    return false;
}

/* ---- axes ---- */

static bool finite(double value) {
    return value - value == 0;
}

/* A direction that points somewhere in the first three axes of the world (the fourth of a ...-time space is
 * time). */
static bool has_direction(const Nrrd *nrrd, unsigned axis) {
    const double *d = nrrd->axis[axis].spaceDirection;
    if (nrrd->spaceDim == 0 || !finite(d[0])) return false;
    if (nrrd->spaceDim < 4) return true;
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

/* Not an axis of space by its kind: a list, a vector, colours, time. */
static bool is_other_kind(const Nrrd *nrrd, unsigned axis) {
    int kind = nrrd->axis[axis].kind;
    return kind != nrrdKindUnknown && kind != nrrdKindDomain && kind != nrrdKindSpace;
}

/* An array of four axes that says nothing about them: the one without a spacing, else the smaller of the
 * first and the last, holds components. */
static unsigned guess_component_axis(const Nrrd *nrrd) {
    unsigned last = nrrd->dim - 1;
    bool first_spaced = finite(nrrd->axis[0].spacing), last_spaced = finite(nrrd->axis[last].spacing);
    if (first_spaced != last_spaced) return first_spaced ? last : 0;
    return nrrd->axis[0].size < nrrd->axis[last].size ? 0 : last;
}

static void mark_space(const Nrrd *nrrd, bool space[NRRD_DIM_MAX]) {
    unsigned directed = 0, spatial = 0;
    for (unsigned i = 0; i < nrrd->dim; i++) directed += has_direction(nrrd, i);
    for (unsigned i = 0; i < nrrd->dim; i++) {
        space[i] = directed ? has_direction(nrrd, i) : !is_other_kind(nrrd, i);
        spatial += space[i];
    }
    if (spatial == 4 && nrrd->dim == 4 && !directed) space[guess_component_axis(nrrd)] = false;
}

static bool multiply(int *product, size_t size) {
    return size >= 1 && size <= INT32_MAX && !__builtin_mul_overflow(*product, (int)size, product);
}

static iso_status find_layout(const char *path, const Nrrd *nrrd, layout *found, iso_error *error) {
    bool space[NRRD_DIM_MAX] = {false};
    mark_space(nrrd, space);
    *found = (layout){.interleaved = 1, .planar = 1};
    bool after = false;
    for (unsigned i = 0; i < nrrd->dim; i++) {
        size_t size = nrrd->axis[i].size;
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
                return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot have %zu components", path, size);
        }
    }
    if (found->space_count == 0) return iso_fail(error, ISO_ERR_FORMAT, "%s: has no axis of space", path);
    return ISO_OK;
}

/* ---- world ---- */

/* Signs that take the file's world to LPS. */
static void world_signs(int space, double sign[3], bool *anatomical) {
    sign[0] = sign[1] = sign[2] = 1;
    *anatomical = true;
    switch (space) {
    case nrrdSpaceRightAnteriorSuperior:
    case nrrdSpaceRightAnteriorSuperiorTime:
        sign[0] = sign[1] = -1;
        break;
    case nrrdSpaceLeftAnteriorSuperior:
    case nrrdSpaceLeftAnteriorSuperiorTime:
        sign[1] = -1;
        break;
    case nrrdSpaceLeftPosteriorSuperior:
    case nrrdSpaceLeftPosteriorSuperiorTime:
        break;
    case nrrdSpace3DLeftHanded:
    case nrrdSpace3DLeftHandedTime:
        sign[2] = -1;
        *anatomical = false;
        break;
    default:
        *anatomical = false;
    }
}

/* Millimetres per unit; a unit that is not a length counts as mm. */
static double unit_mm(const char *unit) {
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"m", 1000},       {"cm", 10},           {"um", 0.001},
                 {"micron", 0.001}, {"\xc2\xb5m", 0.001}, {"nm", 1e-6}};
    for (size_t i = 0; unit && i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].name) == 0) return units[i].mm;
    return 1;
}

/* Step along an axis that has no direction: its spacing (negative: it runs the other way), else its range,
 * else its thickness, else 1. */
static double axis_step(const Nrrd *nrrd, int axis, iso_volume_info *info) {
    const NrrdAxisInfo *a = &nrrd->axis[axis];
    double step = 1;
    if (finite(a->spacing) && a->spacing != 0) {
        step = a->spacing;
    } else if (finite(a->min) && finite(a->max) && a->min != a->max) {
        double intervals = (double)a->size - (a->center == nrrdCenterNode);
        step = intervals > 0 ? (a->max - a->min) / intervals : 1;
    } else if (finite(a->thickness) && a->thickness > 0) {
        step = a->thickness;
        iso_volume_note(info, "axis %d has no spacing: its thickness %g is used", axis, step);
    }
    return step * unit_mm(a->units);
}

/* Position of the first sample on an axis without a direction. */
static double axis_origin(const Nrrd *nrrd, int axis, double step) {
    const NrrdAxisInfo *a = &nrrd->axis[axis];
    if (!finite(a->min)) return 0;
    return a->min * unit_mm(a->units) + (a->center == nrrdCenterNode ? 0 : step / 2);
}

static void set_axis(iso_transform *transform, int axis, iso_vec3 step) {
    iso_vec3 unit = iso_vec3_unit(step);
    transform->spacing[axis] = iso_vec3_length(step);
    transform->direction[axis] = unit.x;
    transform->direction[3 + axis] = unit.y;
    transform->direction[6 + axis] = unit.z;
}

static void take_directions(const Nrrd *nrrd, const layout *found, iso_transform *transform) {
    int dim = nrrd->spaceDim < 3 ? (int)nrrd->spaceDim : 3;
    double unit[3] = {1, 1, 1};
    for (int i = 0; i < dim; i++) {
        unit[i] = unit_mm(nrrd->spaceUnits[i]);
        transform->origin[i] = finite(nrrd->spaceOrigin[i]) ? nrrd->spaceOrigin[i] * unit[i] : 0;
    }
    for (int axis = 0; axis < found->space_count; axis++) {
        double d[3] = {0, 0, 0};
        for (int i = 0; i < dim; i++) d[i] = nrrd->axis[found->space[axis]].spaceDirection[i] * unit[i];
        set_axis(transform, axis, iso_vec3_make(d[0], d[1], d[2]));
    }
    if (found->space_count == 2) { /* one slice: any third axis will do */
        const double *m = transform->direction;
        set_axis(
            transform, 2,
            iso_vec3_unit(iso_vec3_cross(iso_vec3_make(m[0], m[3], m[6]), iso_vec3_make(m[1], m[4], m[7]))));
    }
}

static void take_transform(const Nrrd *nrrd, const layout *found, iso_volume_info *info) {
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
    double sign[3];
    world_signs(nrrd->space, sign, &info->anatomical);
    for (int i = 0; i < 9; i++) transform->direction[i] *= sign[i / 3];
    for (int i = 0; i < 3; i++) transform->origin[i] *= sign[i];
}

/* ---- header ---- */

/* teem reads the whole array; one of stored type and one component is kept as it is. */
static bool is_lent(const iso_volume_info *info, iso_scalar scalar) {
    return info->components == 1 && iso_scalar_is_stored(scalar);
}

static void take_bytes(iso_scalar scalar, iso_volume_info *info) {
    uint64_t grid = iso_format_size(info->dims, iso_type_size(info->type));
    uint64_t all = iso_format_size(info->dims, iso_scalar_size(scalar) * (uint64_t)info->components);
    if (is_lent(info, scalar) || grid == UINT64_MAX)
        info->read_bytes = grid;
    else if (__builtin_add_overflow(grid, all, &info->read_bytes))
        info->read_bytes = UINT64_MAX;
}

static iso_status describe(const char *path, const iso_volume_opts *opts, const Nrrd *nrrd,
                           iso_volume_info *info, iso_error *error) {
    iso_scalar scalar;
    if (!scalar_of(nrrd->type, &scalar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds blocks, not numbers", path);
    layout found;
    ISO_TRY(find_layout(path, nrrd, &found, error));
    uint64_t dims[3] = {1, 1, 1};
    for (int i = 0; i < found.space_count; i++) dims[i] = nrrd->axis[found.space[i]].size;
    ISO_TRY(iso_format_dims(path, dims, info, error));
    int components = found.interleaved;
    if (!multiply(&components, (size_t)found.planar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many components", path);
    ISO_TRY(iso_format_component(path, opts, components, info, error));
    info->type = iso_scalar_stored_type(scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(scalar));
    take_transform(nrrd, &found, info);
    take_bytes(scalar, info);
    return ISO_OK;
}

static iso_status nrrd_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    Nrrd *nrrd = NULL;
    pthread_mutex_lock(&teem_lock);
    iso_status status = load(path, true, &nrrd, error);
    pthread_mutex_unlock(&teem_lock);
    ISO_TRY(status);
    status = describe(path, opts, nrrd, info, error);
    nrrdNuke(nrrd);
    return status;
}

/* ---- voxels ---- */

static void nuke(void *owner) {
    nrrdNuke(owner);
}

static iso_status copy_component(const char *path, const Nrrd *nrrd, const layout *found,
                                 const iso_volume_info *info, iso_grid *grid, iso_error *error) {
    ISO_TRY(iso_format_create(path, info, NULL, grid, error));
    size_t count = (size_t)info->dims[0] * (size_t)info->dims[1] * (size_t)info->dims[2];
    iso_scalar_source source = {.components = found->interleaved,
                                .component = info->component % found->interleaved};
    scalar_of(nrrd->type, &source.scalar);
    size_t plane = count * (size_t)found->interleaved * iso_scalar_size(source.scalar);
    source.data = (const char *)nrrd->data + (size_t)(info->component / found->interleaved) * plane;
    iso_scalar_convert(&source, count, info->type, grid->rgrid->data);
    return ISO_OK;
}

/* The header was read a second time: the file may have changed in between. */
static bool same_array(const Nrrd *nrrd, const layout *found, const iso_volume_info *info) {
    iso_scalar scalar;
    if (!scalar_of(nrrd->type, &scalar) || iso_scalar_stored_type(scalar) != info->type) return false;
    if (found->interleaved * (int64_t)found->planar != info->components) return false;
    for (int i = 0; i < 3; i++) {
        size_t size = i < found->space_count ? nrrd->axis[found->space[i]].size : 1;
        if (size != (size_t)info->dims[i]) return false;
    }
    return true;
}

static iso_status nrrd_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    (void)opts;
    Nrrd *nrrd = NULL;
    pthread_mutex_lock(&teem_lock);
    iso_status status = load(path, false, &nrrd, error);
    pthread_mutex_unlock(&teem_lock);
    ISO_TRY(status);
    layout found;
    status = find_layout(path, nrrd, &found, error);
    if (status == ISO_OK && !same_array(nrrd, &found, info))
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    iso_scalar scalar;
    if (status == ISO_OK && scalar_of(nrrd->type, &scalar) && is_lent(info, scalar)) {
        iso_format_data lent = {nrrd->data, nuke, nrrd};
        return iso_format_create(path, info, &lent, grid, error);
    }
    if (status == ISO_OK) status = copy_component(path, nrrd, &found, info, grid, error);
    nrrdNuke(nrrd);
    return status;
}

const iso_format iso_format_nrrd = {"nrrd", "teem", nrrd_info, nrrd_read};
