/* format_nifti: NIfTI-1, NIfTI-2 and ANALYZE 7.5 with libnifti2.
 *
 * The library converts headers to transforms (also from quaternions), and its znz layer reads gzip. This file
 * takes the dimensions from the header itself, because the library multiplies them without checks, and reads
 * the voxels, because the library returns an image also when the file ends too early.
 *
 * NIfTI's world is RAS+ (x to the right, y to the front): its x and y are negated to get LPS. The sform is
 * preferred to the qform as most programs do; without either, pixdim alone spaces axes that are taken as RAS,
 * which is what the standard's method 1 comes to. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include <nifti2_io.h>

#include "base/file.h"
#include "base/text.h"
#include "grids/volume/format.h"

/* Header values as they are in the file: the library silently replaces those that are not finite or not
 * positive. */
typedef struct stated {
    double offset; /* of the voxels in their file */
    double pixdim[8], quatern[6], srow[12];
    double slope, intercept;
} stated;

typedef struct nifti_file {
    nifti_image *image; /* the header without its dimensions; owned */
    stated stated;
    int64_t dim[8];
    char *header, *data; /* file names, owned; the same for .nii */
    bool swap;
} nifti_file;

static void close_nifti(nifti_file *file) {
    if (file->image) nifti_image_free(file->image);
    free(file->header);
    free(file->data);
    *file = (nifti_file){0};
}

static void silence(void) {
    nifti_set_debug_level(0);
}

/* ---- header ---- */

static bool is_upper(char letter) {
    return letter >= 'A' && letter <= 'Z';
}

/* The other file of a .hdr/.img pair: `path` with another extension (in the same case), compressed or not;
 * NULL if it does not exist. The library's own search opens the file, which would wait for the writer of a
 * pipe. */
static char *find_half(const char *path, const char *suffix, const char *upper_suffix) {
    size_t length = strlen(path);
    if (iso_text_has_extension(path, ".gz")) length -= strlen(".gz");
    if (length < strlen(suffix)) return NULL;
    length -= strlen(suffix);
    bool upper = is_upper(path[length + 1]);
    char *found = malloc(length + sizeof ".hdr.gz");
    for (int packed = 0; found && packed < 2; packed++) {
        struct stat status;
        memcpy(found, path, length);
        strcpy(found + length, upper ? upper_suffix : suffix);
        if (packed) strcat(found, upper ? ".GZ" : ".gz");
        if (stat(found, &status) == 0) return found;
    }
    free(found);
    return NULL;
}

static iso_status find_header(const char *path, nifti_file *file, iso_error *error) {
    bool is_image = iso_text_has_extension(path, ".img") || iso_text_has_extension(path, ".img.gz");
    file->header = is_image ? find_half(path, ".hdr", ".HDR") : strdup(path);
    if (file->header) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: has no header file (.hdr) beside it", path);
}

static iso_status find_data(const char *path, nifti_file *file, iso_error *error) {
    int type = file->image->nifti_type;
    bool pair = type != NIFTI_FTYPE_NIFTI1_1 && type != NIFTI_FTYPE_NIFTI2_1;
    bool named =
        iso_text_has_extension(file->header, ".hdr") || iso_text_has_extension(file->header, ".hdr.gz");
    if (!pair) file->data = strdup(file->header);
    if (pair && named) file->data = find_half(file->header, ".img", ".IMG");
    if (file->data) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: has no image file (.img) beside it", path);
}

/* Opens a file with the library, after a check that it is a regular file: the library would wait for the
 * writer of a pipe. */
static iso_status open_packed(const char *path, znzFile *file, iso_error *error) {
    uint64_t bytes = 0;
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    errno = 0;
    *file = znzopen(path, "rb", 1);
    if (!znz_isnull(*file)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno ? errno : EIO));
}

/* Reads up to *count bytes from the beginning of a file, decompressed if needed. */
static iso_status read_bytes(const char *path, void *bytes, size_t *count, iso_error *error) {
    znzFile file;
    ISO_TRY(open_packed(path, &file, error));
    size_t got = znzread(bytes, 1, *count, file);
    znzclose(file);
    if (got > *count) return iso_fail(error, ISO_ERR_IO, "%s: damaged compressed data", path);
    *count = got;
    return ISO_OK;
}

/* Moves the dimensions to file->dim, where this file checks them, and sets the library's copy to 1, so that
 * the library allocates and reads nothing by itself. */
#define TAKE_DIMENSIONS(header)                                                                              \
    for (int i = 0; i < 8; i++) {                                                                            \
        file->dim[i] = (header).dim[i];                                                                      \
        (header).dim[i] = 1;                                                                                 \
    }

#define TAKE_STATED(header)                                                                                  \
    do {                                                                                                     \
        file->stated = (stated){.offset = (double)(header).vox_offset,                                       \
                                .quatern = {(header).quatern_b, (header).quatern_c, (header).quatern_d,      \
                                            (header).qoffset_x, (header).qoffset_y, (header).qoffset_z},     \
                                .slope = (header).scl_slope,                                                 \
                                .intercept = (header).scl_inter};                                            \
        for (int i = 0; i < 8; i++) file->stated.pixdim[i] = (header).pixdim[i];                             \
        for (int i = 0; i < 4; i++) {                                                                        \
            file->stated.srow[i] = (header).srow_x[i];                                                       \
            file->stated.srow[4 + i] = (header).srow_y[i];                                                   \
            file->stated.srow[8 + i] = (header).srow_z[i];                                                   \
        }                                                                                                    \
    } while (0)

union nifti_any {
    nifti_1_header one;
    nifti_2_header two;
    int32_t size;
};

/* Whether the library can convert a data type, whose values then have a size. For another type it would print
 * to stderr, at any debug level. */
static bool known_type(int type) {
    int bytes = 0, swapped = 0;
    nifti_datatype_sizes(type, &bytes, &swapped);
    return bytes > 0;
}

static iso_status convert_header(const char *path, union nifti_any *any, int version, nifti_file *file,
                                 iso_error *error) {
    file->swap = any->size != (version == 2 ? 540 : 348);
    if (file->swap) swap_nifti_header(any, version);
    int type = version == 2 ? any->two.datatype : any->one.datatype;
    if (!known_type(type))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: values of unknown NIfTI type %d", path, type);
    if (version == 2) {
        TAKE_DIMENSIONS(any->two)
        TAKE_STATED(any->two);
        file->image = nifti_convert_n2hdr2nim(any->two, NULL);
    } else {
        TAKE_DIMENSIONS(any->one)
        TAKE_STATED(any->one);
        if (!(fabs(file->stated.offset) < 1e9))
            any->one.vox_offset = 0; /* the library casts it to an integer; check_stated refuses it */
        file->image = nifti_convert_n1hdr2nim(any->one, NULL);
    }
    if (!file->image) return iso_fail(error, ISO_ERR_FORMAT, "%s: not a NIfTI header", path);
    return ISO_OK;
}

static iso_status open_nifti(const char *path, nifti_file *file, iso_error *error) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, silence);
    ISO_TRY(find_header(path, file, error));
    union nifti_any any;
    memset(&any, 0, sizeof any);
    size_t count = sizeof any;
    ISO_TRY(read_bytes(file->header, &any, &count, error));
    bool begins_well = any.size == 348 || any.size == 540 || any.size == 0x5c010000 || any.size == 0x1c020000;
    if (begins_well && count < sizeof any.one)
        return iso_format_truncated(file->header, count, sizeof any.one, error);
    int version = begins_well ? nifti_header_version((const char *)&any, count) : -1;
    if (version < 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a NIfTI file%s", file->header,
                        nifti_is_gzfile(file->header)
                            ? ", and other files are read when gzip's compression is undone"
                            : "");
    if (version == 2 && count < sizeof any.two)
        return iso_format_truncated(file->header, count, sizeof any.two, error);
    ISO_TRY(convert_header(file->header, &any, version, file, error));
    return find_data(path, file, error);
}

/* ---- from header to volume ---- */

static bool scalar_of(int type, iso_scalar *scalar) {
    static const struct {
        int type;
        iso_scalar scalar;
    } map[] = {{DT_UINT8, ISO_SCALAR_UINT8},   {DT_INT8, ISO_SCALAR_INT8},     {DT_UINT16, ISO_SCALAR_UINT16},
               {DT_INT16, ISO_SCALAR_INT16},   {DT_UINT32, ISO_SCALAR_UINT32}, {DT_INT32, ISO_SCALAR_INT32},
               {DT_UINT64, ISO_SCALAR_UINT64}, {DT_INT64, ISO_SCALAR_INT64},   {DT_FLOAT32, ISO_SCALAR_FLOAT},
               {DT_FLOAT64, ISO_SCALAR_DOUBLE}};
    for (size_t i = 0; i < sizeof map / sizeof *map; i++) {
        if (map[i].type != type) continue;
        *scalar = map[i].scalar;
        return true;
    }
    return false;
}

static bool all_finite(const double *numbers, int count) {
    for (int i = 0; i < count; i++)
        if (!isfinite(numbers[i])) return false;
    return true;
}

/* Checks the spacings of axes with more than one voxel, unless the sform or the caller give them. */
static iso_status check_spacings(const char *path, const iso_volume_opts *opts, const nifti_file *file,
                                 iso_error *error) {
    if (file->image->sform_code > 0) return ISO_OK;
    for (int i = 1; i <= 3 && i <= file->dim[0]; i++) {
        double spacing = file->stated.pixdim[i];
        bool usable = isfinite(spacing) && (file->image->qform_code > 0 ? spacing > 0 : spacing != 0);
        if (!usable && file->dim[i] > 1 && !(opts->spacing[i - 1] > 0))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a spacing of %g (pixdim[%d]) is not possible", path,
                            spacing, i);
    }
    return ISO_OK;
}

/* Checks the numbers that the library would replace by defaults. */
static iso_status check_stated(const char *path, const iso_volume_opts *opts, const nifti_file *file,
                               iso_volume_info *info, iso_error *error) {
    const stated *s = &file->stated;
    const nifti_image *image = file->image;
    if (!(s->offset >= 0 && s->offset < 1e9 && s->offset == floor(s->offset)))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: voxels cannot begin at byte %g (vox_offset)", path,
                        s->offset);
    if (image->sform_code > 0 && !all_finite(s->srow, 12))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its sform holds what is not a number", path);
    if (image->sform_code <= 0 && image->qform_code > 0 && !all_finite(s->quatern, 6))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: its qform holds what is not a number", path);
    /* some programs write NaN for "no slope" */
    if (isfinite(s->slope) && s->slope != 0 && (fabs(s->slope) > 1e30 || fabs(s->intercept) > 1e30) &&
        isfinite(s->intercept))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: values cannot be scaled by %g and shifted by %g", path,
                        s->slope, s->intercept);
    if (isinf(s->slope)) iso_volume_note(info, "slope %g is not used", s->slope);
    if (s->slope != 0 && isfinite(s->slope) && !isfinite(s->intercept))
        iso_volume_note(info, "intercept %g is not used", s->intercept);
    return check_spacings(path, opts, file, error);
}

/* Sets the dimensions. Like the library, counts a dimension of 0 within the first dim[0] ones as 1. */
static iso_status take_dims(const char *path, const iso_volume_opts *opts, const nifti_file *file,
                            iso_volume_info *info, iso_error *error) {
    const int64_t *dim = file->dim;
    if (dim[0] < 1 || dim[0] > 7 || dim[1] < 1)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a NIfTI header: %lld dimensions, the first of %lld",
                        path, (long long)dim[0], (long long)dim[1]);
    for (int i = 1; i <= dim[0]; i++)
        if (dim[i] < 0)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: cannot have %lld voxels on axis %d (dim[%d])", path,
                            (long long)dim[i], i - 1, i);
    uint64_t sizes[8] = {0};
    for (int i = 1; i <= 7; i++) sizes[i] = i <= dim[0] && dim[i] > 0 ? (uint64_t)dim[i] : 1;
    ISO_TRY(iso_format_dims(path, sizes + 1, info, error));
    uint64_t volumes = 1;
    for (int i = 4; i <= 7; i++)
        if (__builtin_mul_overflow(volumes, sizes[i], &volumes) || volumes > INT32_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: too many volumes in one file", path);
    return iso_format_component(path, opts, (int)volumes, info, error);
}

static double unit_mm(int units) {
    return units == NIFTI_UNITS_METER ? 1000 : units == NIFTI_UNITS_MICRON ? 0.001 : 1;
}

/* Whether the file has both an sform and a qform that differ by rounding only. The qform is then preferred:
 * it has exact spacings and perpendicular axes, while the sform is a matrix in single precision. */
static bool forms_agree(const nifti_image *image) {
    if (image->sform_code <= 0 || image->qform_code <= 0) return false;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++) {
            double s = image->sto_xyz.m[row][column], q = image->qto_xyz.m[row][column];
            double step = column < 3 ? image->pixdim[column + 1] : fabs(q);
            if (!(fabs(s - q) <= 1e-6 * (1e-3 + step))) return false;
        }
    return true;
}

/* The matrix from index coordinates to RAS. */
static nifti_dmat44 world_matrix(const nifti_file *file, iso_volume_info *info) {
    const nifti_image *image = file->image;
    if (image->sform_code > 0) return forms_agree(image) ? image->qto_xyz : image->sto_xyz;
    if (image->qform_code > 0) return image->qto_xyz;
    iso_volume_note(info, "no orientation in the header: axes taken as right, front, up");
    nifti_dmat44 matrix = {{{0}}};
    for (int i = 0; i < 3; i++) {
        double step = image->pixdim[i + 1] < 0 ? -image->pixdim[i + 1] : image->pixdim[i + 1];
        matrix.m[i][i] = step > 0 ? step : 1;
    }
    return matrix;
}

static void take_transform(const nifti_file *file, iso_volume_info *info) {
    nifti_dmat44 matrix = world_matrix(file, info);
    iso_vec3 steps[4]; /* and the origin */
    for (int axis = 0; axis < 4; axis++)
        steps[axis] = (iso_vec3){-matrix.m[0][axis], -matrix.m[1][axis], matrix.m[2][axis]};
    iso_format_transform(steps, &steps[3], unit_mm(file->image->xyz_units), info);
    info->anatomical = true;
}

/* The format does not say which axes vectors have; those of the world, RAS, are usual. */
static void take_component_axes(const nifti_image *image, iso_component_axes *axes) {
    *axes = (iso_component_axes){.to_world = {-1, 0, 0, 0, -1, 0, 0, 0, 1},
                                 .lower = image->intent_code == NIFTI_INTENT_SYMMATRIX};
}

/* Whether the slope is negative (0 means no slope). As a grid's scale must be positive, the values are then
 * scaled and stored as floats. */
static bool negative_slope(const nifti_image *image) {
    return image->scl_slope < 0 && image->scl_slope > -HUGE_VAL;
}

static void take_scale(const nifti_image *image, iso_volume_info *info) {
    if (negative_slope(image)) {
        info->type = ISO_FLOAT32;
        iso_volume_note(info, "negative slope %g: values are scaled while reading", image->scl_slope);
    } else if (image->scl_slope > 0 && image->scl_slope < HUGE_VAL) {
        info->scale = image->scl_slope;
        if (image->scl_inter - image->scl_inter == 0) info->offset = image->scl_inter;
    }
}

static iso_format_stream stream_of(const nifti_file *file) {
    iso_format_stream stream = {.components = 1, .swap = file->swap};
    scalar_of(file->image->datatype, &stream.scalar);
    return stream;
}

static iso_status describe(const char *path, const iso_volume_opts *opts, const nifti_file *file,
                           iso_volume_info *info, iso_error *error) {
    iso_scalar scalar;
    if (!scalar_of(file->image->datatype, &scalar))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds %s values, which are not scalars", path,
                        nifti_datatype_to_string(file->image->datatype) + 3);
    ISO_TRY(take_dims(path, opts, file, info, error));
    ISO_TRY(check_stated(path, opts, file, info, error));
    info->type = iso_scalar_stored_type(scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(scalar));
    take_transform(file, info);
    if (opts->component_axes) take_component_axes(file->image, opts->component_axes);
    take_scale(file->image, info);
    iso_format_stream stream = stream_of(file);
    iso_format_stream_room(&stream, info);
    unsigned char magic[2];
    *opts->place = (iso_format_place){
        .told = true,
        .swap = file->swap,
        .separate = true,
        .gzip = iso_file_head(file->data, magic, 2) == 2 && magic[0] == 0x1f && magic[1] == 0x8b,
        .scalar = scalar,
        .position = file->image->iname_offset > 0 ? (uint64_t)file->image->iname_offset : 0};
    if (strcmp(file->data, path)) snprintf(opts->place->file, sizeof opts->place->file, "%s", file->data);
    return ISO_OK;
}

static iso_status nifti_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_error *error) {
    nifti_file file = {0};
    iso_status status = open_nifti(path, &file, error);
    if (file.header) iso_file_set_read(opts->files, file.header);
    if (file.data) iso_file_set_read(opts->files, file.data);
    if (status == ISO_OK) status = describe(path, opts, &file, info, error);
    close_nifti(&file);
    return status;
}

/* ---- voxels ---- */

typedef struct data_file {
    const char *path;
    znzFile file;
    uint64_t at, end; /* present position; end of the last volume */
} data_file;

static iso_status read_voxels(void *context, void *target, size_t bytes, iso_error *error) {
    data_file *data = context;
    size_t got = znzread(target, 1, bytes, data->file);
    if (got > bytes) return iso_fail(error, ISO_ERR_IO, "%s: damaged compressed data", data->path);
    data->at += got;
    return got == bytes ? ISO_OK : iso_format_truncated(data->path, data->at, data->end, error);
}

static FILE *plain_file(void *context, uint64_t bytes) {
    data_file *data = context;
    if (data->file->withz) return NULL;
    data->at += bytes;
    return data->file->nzfptr;
}

/* Checks that the file also has the volumes after the chosen one, and that its compressed data is intact to
 * the end. */
static iso_status check_end(data_file *data, iso_error *error) {
    char byte;
    if (data->at < data->end) {
        if (znzseek(data->file, (znz_off_t)(data->end - 1), SEEK_SET) < 0 ||
            znzread(&byte, 1, 1, data->file) != 1)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: fewer than %llu bytes", data->path,
                            (unsigned long long)data->end);
    }
    if (znzread(&byte, 1, 1, data->file) > 1)
        return iso_fail(error, ISO_ERR_IO, "%s: damaged compressed data", data->path);
    return ISO_OK;
}

static void scale_values(const nifti_image *image, iso_rgrid *grid) {
    float *value = grid->data;
    size_t count = (size_t)grid->dims[0] * (size_t)grid->dims[1] * (size_t)grid->dims[2];
    double offset = image->scl_inter - image->scl_inter == 0 ? image->scl_inter : 0;
    for (size_t i = 0; i < count; i++) value[i] = (float)(value[i] * image->scl_slope + offset);
}

static iso_status read_data(const char *path, const iso_volume_opts *opts, const nifti_file *file,
                            iso_volume_info *info, iso_grid *grid, iso_error *error) {
    iso_format_stream stream = stream_of(file);
    uint64_t offset = file->image->iname_offset > 0 ? (uint64_t)file->image->iname_offset : 0;
    uint64_t volume = iso_format_size(info->dims, iso_scalar_size(stream.scalar)), all;
    if (__builtin_mul_overflow(volume, (uint64_t)info->components, &all) || all > INT64_MAX - offset)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many volumes in one file", path);
    data_file data = {file->data, NULL, 0, offset + all};
    ISO_TRY(open_packed(file->data, &data.file, error));
    data.at = offset + (uint64_t)info->component * volume;
    iso_status status = ISO_OK;
    if (znzseek(data.file, (znz_off_t)data.at, SEEK_SET) < 0)
        status = iso_fail(error, ISO_ERR_IO, "%s: truncated: fewer than %llu bytes", file->data,
                          (unsigned long long)data.at);
    stream.fill = read_voxels;
    stream.context = &data;
    if (!negative_slope(file->image)) stream.plain = plain_file; /* else the values are changed in place */
    if (status == ISO_OK) status = iso_format_read_stream(path, opts, info, &stream, grid, error);
    if (status == ISO_OK && (status = check_end(&data, error)) != ISO_OK) iso_grid_destroy(grid);
    znzclose(data.file);
    return status;
}

static iso_status nifti_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_grid *grid, iso_error *error) {
    nifti_file file = {0};
    iso_grid result = {0};
    iso_status status = open_nifti(path, &file, error);
    if (status == ISO_OK) status = read_data(path, opts, &file, info, &result, error);
    if (status == ISO_OK && negative_slope(file.image)) scale_values(file.image, result.rgrid);
    close_nifti(&file);
    if (status == ISO_OK) *grid = result;
    return status;
}

const iso_format iso_format_nifti = {"nifti", "libnifti2", NULL, nifti_info, nifti_read, NULL};
