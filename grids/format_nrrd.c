/* format_nrrd: NRRD through teem, which knows every encoding, detached data, space directions and handedness.
 *
 * NRRD names its world by `space`. LPS is ours; RAS and LAS differ by the signs of x and y. 3D-left-handed
 * names no body axis, it says only that z points the other way from x cross y. Read as a right-handed world
 * the volume would come out mirrored, so one axis has to be negated, and any of the three gives the right
 * shape. z it is: x and y are then still those of the slices as they are shown, and stacks that say so (the
 * headsq data of VTK) number their slices downwards, so that the head also stands upright.
 *
 * Voxels in one file, raw or as gzip, are read here from where teem leaves the file: in chunks, with
 * progress, and because teem leaks its buffers when a gzip stream ends early. Other encodings and several
 * files are teem's.
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

/* What teem does not know as NRRD it would take for a table of text. */
static iso_status has_magic(const char *path, iso_error *error) {
    FILE *file = fopen(path, "rb");
    if (!file) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    char line[16] = "";
    bool read = fgets(line, sizeof line, file) != NULL;
    fclose(file);
    bool whole = strchr(line, '\n') != NULL;
    line[strcspn(line, "\r\n")] = 0;
    bool numbered = strlen(line) == 8 && memcmp(line, "NRRD000", 7) == 0 && line[7] >= '1' && line[7] <= '6';
    if (read && whole && (numbered || strcmp(line, "NRRD00.01") == 0)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not an NRRD file", path);
}

/* A header, and where its voxels begin when they can be streamed. */
typedef struct nrrd_file {
    const char *path;
    Nrrd *nrrd;
    NrrdIoState *state;
    FILE *data; /* NULL: teem has to read them */
    bool packed;
    iso_inflater *inflater;
    uint64_t at, end; /* unpacked bytes */
} nrrd_file;

static void close_nrrd(nrrd_file *file) {
    iso_inflater_destroy(file->inflater);
    if (file->state && file->state->dataFile) fclose(file->state->dataFile);
    if (file->state) nrrdIoStateNix(file->state);
    if (file->nrrd) nrrdNuke(file->nrrd);
    *file = (nrrd_file){0};
}

static iso_status load(const char *path, bool header_only, nrrd_file *file, iso_error *error) {
    ISO_TRY(has_magic(path, error));
    *file = (nrrd_file){.path = path, .nrrd = nrrdNew(), .state = nrrdIoStateNew()};
    iso_status status = ISO_OK;
    if (!file->nrrd || !file->state) {
        status = iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
    } else {
        file->state->skipData = file->state->keepNrrdDataFileOpen = header_only;
        pthread_mutex_lock(&teem_lock);
        if (nrrdLoad(file->nrrd, path, file->state)) status = fail_teem(path, error);
        pthread_mutex_unlock(&teem_lock);
    }
    if (status != ISO_OK) {
        if (file->state) file->state->dataFile = NULL; /* teem has closed it */
        close_nrrd(file);
        return status;
    }
    file->packed = file->state->encoding == nrrdEncodingGzip;
    bool streamed = file->state->encoding == nrrdEncodingRaw || (file->packed && file->state->byteSkip >= 0);
    if (header_only && streamed) file->data = file->state->dataFile;
    return ISO_OK;
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

static iso_format_stream stream_of(const nrrd_file *file, const layout *found, const iso_volume_info *info) {
    iso_format_stream stream = {.components = found->interleaved,
                                .component = info->component % found->interleaved,
                                .swap = file->state->endian != airEndianUnknown &&
                                        file->state->endian != airMyEndian()};
    scalar_of(file->nrrd->type, &stream.scalar);
    return stream;
}

static void take_bytes(const nrrd_file *file, const layout *found, iso_volume_info *info) {
    iso_format_stream stream = stream_of(file, found, info);
    if (file->data) {
        iso_format_stream_room(&stream, info);
        return;
    }
    uint64_t grid = iso_format_size(info->dims, iso_type_size(info->type));
    uint64_t all = iso_format_size(info->dims, iso_scalar_size(stream.scalar) * (uint64_t)info->components);
    if (is_lent(info, stream.scalar) || grid == UINT64_MAX)
        info->read_bytes = grid;
    else if (__builtin_add_overflow(grid, all, &info->read_bytes))
        info->read_bytes = UINT64_MAX;
}

static iso_status describe(const nrrd_file *file, const iso_volume_opts *opts, layout *found,
                           iso_volume_info *info, iso_error *error) {
    const Nrrd *nrrd = file->nrrd;
    iso_scalar scalar;
    if (!scalar_of(nrrd->type, &scalar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds blocks, not numbers", file->path);
    ISO_TRY(find_layout(file->path, nrrd, found, error));
    uint64_t dims[3] = {1, 1, 1};
    for (int i = 0; i < found->space_count; i++) dims[i] = nrrd->axis[found->space[i]].size;
    ISO_TRY(iso_format_dims(file->path, dims, info, error));
    int components = found->interleaved;
    if (!multiply(&components, (size_t)found->planar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many components", file->path);
    ISO_TRY(iso_format_component(file->path, opts, components, info, error));
    info->type = iso_scalar_stored_type(scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(scalar));
    take_transform(nrrd, found, info);
    take_bytes(file, found, info);
    return ISO_OK;
}

static iso_status nrrd_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    nrrd_file file;
    layout found;
    ISO_TRY(load(path, true, &file, error));
    iso_status status = describe(&file, opts, &found, info, error);
    close_nrrd(&file);
    return status;
}

/* ---- voxels, streamed ---- */

static iso_status fill(void *context, void *target, size_t bytes, iso_error *error) {
    nrrd_file *file = context;
    if (file->packed) {
        ISO_TRY(iso_inflater_fill(file->inflater, target, bytes, error));
    } else if (fread(target, 1, bytes, file->data) != bytes) {
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path,
                        ferror(file->data) ? strerror(errno) : "the file ends too early");
    }
    file->at += bytes;
    return ISO_OK;
}

static iso_status skip_to(nrrd_file *file, uint64_t position, iso_error *error) {
    if (!file->packed) {
        if (fseeko(file->data, (off_t)(position - file->at), SEEK_CUR) != 0)
            return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path, strerror(errno));
        file->at = position;
    }
    char scratch[1 << 14];
    while (file->at < position) {
        uint64_t left = position - file->at;
        ISO_TRY(fill(file, scratch, left < sizeof scratch ? (size_t)left : sizeof scratch, error));
    }
    return ISO_OK;
}

/* The unpacked bytes from teem's position on; raw ones must all be there. */
static iso_status begin_stream(nrrd_file *file, uint64_t bytes, iso_error *error) {
    if (file->packed) {
        uint64_t skipped = (uint64_t)file->state->byteSkip;
        if (__builtin_add_overflow(bytes, skipped, &file->end)) file->end = UINT64_MAX;
        ISO_TRY(iso_inflater_create(file->path, file->data, file->end, &file->inflater, error));
        return skip_to(file, skipped, error);
    }
    off_t start = ftello(file->data);
    uint64_t size = 0;
    if (start < 0 || fseeko(file->data, 0, SEEK_END) != 0 ||
        (size = (uint64_t)ftello(file->data)) > INT64_MAX || fseeko(file->data, start, SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: its data file cannot be read", file->path);
    if (size - (uint64_t)start < bytes || size < (uint64_t)start)
        return iso_format_truncated(file->path, size, (uint64_t)start + bytes, error);
    file->end = bytes;
    return ISO_OK;
}

static iso_status read_stream(nrrd_file *file, const iso_volume_opts *opts, const layout *found,
                              const iso_volume_info *info, iso_grid *grid, iso_error *error) {
    iso_format_stream stream = stream_of(file, found, info);
    stream.fill = fill;
    stream.context = file;
    uint64_t plane =
        iso_format_size(info->dims, iso_scalar_size(stream.scalar) * (uint64_t)found->interleaved);
    uint64_t bytes;
    if (__builtin_mul_overflow(plane, (uint64_t)found->planar, &bytes) || bytes > INT64_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many components", file->path);
    ISO_TRY(begin_stream(file, bytes, error));
    ISO_TRY(skip_to(file, file->at + plane * (uint64_t)(info->component / found->interleaved), error));
    ISO_TRY(iso_format_read_stream(file->path, opts, info, &stream, grid, error));
    iso_status status = ISO_OK;
    if (file->packed) status = skip_to(file, file->end, error);
    if (status == ISO_OK && file->packed) status = iso_inflater_finish(file->inflater, error);
    if (status != ISO_OK) iso_grid_destroy(grid);
    return status;
}

/* ---- voxels, through teem ---- */

static void nuke(void *owner) {
    nrrdNuke(owner);
}

static iso_status copy_component(const nrrd_file *file, const layout *found, const iso_volume_info *info,
                                 iso_grid *grid, iso_error *error) {
    ISO_TRY(iso_format_create(file->path, info, NULL, grid, error));
    size_t count = (size_t)info->dims[0] * (size_t)info->dims[1] * (size_t)info->dims[2];
    iso_scalar_source source = {.components = found->interleaved,
                                .component = info->component % found->interleaved};
    scalar_of(file->nrrd->type, &source.scalar);
    size_t plane = count * (size_t)found->interleaved * iso_scalar_size(source.scalar);
    source.data = (const char *)file->nrrd->data + (size_t)(info->component / found->interleaved) * plane;
    iso_scalar_convert(&source, count, info->type, grid->rgrid->data);
    return ISO_OK;
}

static iso_status read_through_teem(nrrd_file *file, const layout *found, const iso_volume_info *info,
                                    iso_grid *grid, iso_error *error) {
    iso_scalar scalar = ISO_SCALAR_UINT8;
    scalar_of(file->nrrd->type, &scalar);
    if (!is_lent(info, scalar)) return copy_component(file, found, info, grid, error);
    iso_format_data lent = {file->nrrd->data, nuke, file->nrrd};
    file->nrrd = NULL; /* the grid's now, also on failure */
    return iso_format_create(file->path, info, &lent, grid, error);
}

/* What was checked is the first reading of the header: the file may have changed since. */
static iso_status same_array(const nrrd_file *file, const iso_volume_opts *opts, layout *found,
                             const iso_volume_info *info, iso_error *error) {
    iso_volume_info now = {.transform = iso_transform_identity()};
    ISO_TRY(describe(file, opts, found, &now, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) == 0 && now.type == info->type &&
        now.components == info->components && now.read_bytes <= info->read_bytes)
        return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", file->path);
}

static iso_status nrrd_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    nrrd_file file;
    layout found;
    ISO_TRY(load(path, true, &file, error));
    iso_status status = same_array(&file, opts, &found, info, error);
    if (status == ISO_OK && file.data) {
        status = read_stream(&file, opts, &found, info, grid, error);
    } else if (status == ISO_OK) {
        close_nrrd(&file);
        ISO_TRY(load(path, false, &file, error));
        status = same_array(&file, opts, &found, info, error);
        if (status == ISO_OK) status = read_through_teem(&file, &found, info, grid, error);
    }
    close_nrrd(&file);
    return status;
}

const iso_format iso_format_nrrd = {"nrrd", "teem", NULL, nrrd_info, nrrd_read};
