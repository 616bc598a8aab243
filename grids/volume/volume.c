/* volume: reads volumes: finds the format from the content and the name, calls its reader, and makes the
 * checks that all formats share. */
#include "grids/volume/volume.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/decimal_point.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "base/text.h"
#include "grids/brick_index.h"
#include "grids/volume/dicom/dicom.h"
#include "grids/volume/format.h"
#include "grids/volume/mapping.h"
#include "grids/volume/module.h"
#include "grids/volume/rectilinear.h"
#include "grids/volume/slice_files.h"
#include "grids/volume/tiled.h"

/* ---- finding the format ---- */

/* Formats whose readers are modules, because loading their libraries takes tens of milliseconds and
 * megabytes. */
const iso_format iso_format_vti = {.name = "vti", .library = "VTK", .module = "vti"};
const iso_format iso_format_vdb = {.name = "vdb", .library = "OpenVDB", .module = "vdb"};
const iso_format iso_format_tiff = {.name = "tiff", .library = "libtiff", .module = "tiff"};
const iso_format iso_format_hdf5 = {.name = "hdf5", .library = "libhdf5", .module = "hdf5"};
static const iso_format format_zarr = {.name = "zarr", .library = "Zarr", .module = "zarr"};

/* The format that reads the volumes of a type of files; NULL: none does. */
static const iso_format *format_of_type(iso_file_type type) {
    switch (type) {
#define VOLUME(reader) return &iso_format_##reader;
#include "base/file_types.inc"
    default:
        break;
    }
    return NULL;
}

static const iso_format *format_of_name(const char *path) {
    return format_of_type(iso_file_type_of_name(path, ISO_HOLDS_VOLUME));
}

/* The beginning of a file, unpacked if gzip compressed it. */
typedef struct head {
    char bytes[ISO_FILE_HEAD];
    size_t count;
    bool gzip;
} head;

static void unpack(head *h) {
    char bytes[sizeof h->bytes];
    const size_t count = iso_gzip_head(h->bytes, h->count, bytes, sizeof bytes);
    h->gzip = count > 0;
    if (!count) return;
    memcpy(h->bytes, bytes, count);
    h->count = count;
}

/* MetaImage has no magic number: a text of "Key = value" lines, one of which must be NDims. */
static bool is_metaimage(const head *h) {
    char text[sizeof h->bytes + 1];
    memcpy(text, h->bytes, h->count);
    text[h->count] = 0;
    if (strlen(text) < h->count && !strstr(text, "ElementDataFile")) return false;
    if (strncmp(text, "ObjectType", 10) == 0) return strchr(text, '=') != NULL;
    for (const char *at = text; (at = strstr(at, "NDims")); at += 5)
        if ((at == text || at[-1] == '\n') && at[5 + strspn(at + 5, " \t")] == '=') return true;
    return false;
}

/* The format by the content, which takes precedence over the name. */
static const iso_format *format_of_content(const head *h) {
    const iso_format *format = format_of_type(iso_file_type_of_head(h->bytes, h->count, ISO_HOLDS_VOLUME));
    return !format && is_metaimage(h) ? &iso_format_metaimage : format;
}

const char *iso_volume_format(const void *bytes, size_t count) {
    head h = {.count = count < sizeof h.bytes ? count : sizeof h.bytes};
    memcpy(h.bytes, bytes, h.count);
    unpack(&h);
    const iso_format *format = format_of_content(&h);
    if (!format && h.gzip) format = &iso_format_nifti;
    return format ? format->name : NULL;
}

static iso_status read_head(const char *path, head *h, iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, NULL, error));
    h->count = fread(h->bytes, 1, sizeof h->bytes, file);
    int failed = ferror(file), code = errno;
    fclose(file);
    if (failed) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(code));
    if (h->count == 0) return iso_fail(error, ISO_ERR_IO, "%s: the file is empty", path);
    unpack(h);
    return ISO_OK;
}

/* The caller's options, and the layout of a raw file that its name gives when the options do not. */
typedef struct request {
    iso_volume_opts opts;
    iso_format_place place; /* opts.place points here */
    iso_rectilinear axes;   /* opts.axes points here */
    bool resampled;         /* the axes are uneven */
    iso_volume_info stored; /* then: the voxels as they are in the file */
    bool mappable;
    iso_raw_layout guessed;
    bool is_guessed;
    const char *path;    /* of the file */
    char file[PATH_MAX]; /* the file's part of FILE:/array, or the copy of what a URL names */
} request;

const char *iso_volume_array_of(const char *path) {
    struct stat status;
    char file[PATH_MAX];
    if (stat(path, &status) == 0) return NULL;
    for (const char *colon = path; (colon = strstr(colon, ":/")); colon++) {
        if ((size_t)(colon - path) >= sizeof file) return NULL;
        snprintf(file, sizeof file, "%.*s", (int)(colon - path), path);
        if (stat(file, &status) == 0 && S_ISREG(status.st_mode)) return colon + 1;
    }
    return NULL;
}

/* Divides FILE:/array. --grid may name the same array. */
static iso_status divide_path(const char *path, request *r, iso_error *error) {
    const char *array = iso_volume_array_of(path);
    r->path = path;
    if (!array) return ISO_OK;
    if (r->opts.grid && strcmp(r->opts.grid, array) != 0)
        return iso_fail(error, ISO_ERR_USAGE, "%s: names an array, and --grid another one", path);
    snprintf(r->file, sizeof r->file, "%.*s", (int)(array - path) - 1, path);
    r->path = r->file;
    r->opts.grid = array;
    return ISO_OK;
}

static const iso_format *format_of_file(const char *path, const head *h) {
    const iso_format *format = format_of_content(h);
    if (!format) format = format_of_name(path);
    return !format && h->gzip ? &iso_format_nifti : format;
}

/* Whether a format is also read where gzip has compressed a whole file. */
static bool reads_gzip(const iso_format *format) {
    return format == &iso_format_nifti || format == &iso_format_mrc || format == &iso_format_mgh ||
           format == &iso_format_mif || format == &iso_format_afni;
}

/* If no reader knows the file or it is called .raw, looks for a layout in its name; the file's size must
 * agree. */
static iso_status guess_raw(const char *path, uint64_t bytes, request *r, const iso_format **format,
                            iso_error *error) {
    if (*format && iso_file_type_of_name(path, ISO_HOLDS_RAW) == ISO_FILE_UNKNOWN) return ISO_OK;
    if (!iso_raw_layout_of_name(path, &r->guessed)) return ISO_OK;
    uint64_t wanted = iso_raw_layout_bytes(&r->guessed);
    r->is_guessed = bytes == wanted;
    if (r->is_guessed) {
        r->opts.raw = &r->guessed;
        *format = &iso_format_raw;
    }
    if (*format) return ISO_OK;
    const int *dims = r->guessed.dims;
    return iso_fail(
        error, ISO_ERR_FORMAT,
        "%s: has %llu bytes, but %dx%dx%d %s, as its name says, are %llu: give its layout (--raw)", path,
        (unsigned long long)bytes, dims[0], dims[1], dims[2], iso_raw_layout_type_name(&r->guessed),
        (unsigned long long)wanted);
}

/* Whether a folder is a stack of such slices, PNG or JPEG. One that has DICOM images, also in its subfolders,
 * is none: such folders often have pictures beside the images. */
static bool is_image_stack(const char *path, iso_slice_kind kind) {
    iso_dicom_folder folder = {0};
    if (!iso_slice_files_exist(path, kind)) return false;
    if (iso_dicom_folder_read(path, true, &folder, NULL) != ISO_OK) return true;
    const bool has_images = folder.count > 0;
    iso_dicom_folder_free(&folder);
    return !has_images;
}

/* The files with the metadata of an array or group of Zarr or N5. */
static const char *const metadata_names[] = {"zarr.json", ".zarray", ".zgroup", ".zattrs", "attributes.json"};

/* Whether a folder has metadata of Zarr or N5. */
static bool has_zarr(const char *path) {
    char name[PATH_MAX];
    for (size_t i = 0; i < sizeof metadata_names / sizeof *metadata_names; i++)
        if (snprintf(name, sizeof name, "%s/%s", path, metadata_names[i]) < (int)sizeof name &&
            access(name, F_OK) == 0)
            return true;
    return false;
}

/* Whether a file is the metadata of an array or group of Zarr or N5. */
static bool is_metadata(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    for (size_t i = 0; i < sizeof metadata_names / sizeof *metadata_names; i++)
        if (strcmp(name, metadata_names[i]) == 0) return true;
    return false;
}

#define EXODUS ".exo .ex2 .e"

/* Files that are often taken for a volume, by how they begin, and what to do with them. */
static const struct {
    const char *begins, *advice;
} confused[] = {
    {"\x89PNG\r\n\x1a\n", "is one picture: a volume in PNG is a folder with a file for each slice"},
    {"\xff\xd8\xff", "is one picture: a volume in JPEG is a folder with a file for each slice"},
    {"CDF\1", "is NetCDF of version 3: nccopy -k netCDF-4 makes a file of it that is read"},
    {"CDF\2", "is NetCDF of version 3: nccopy -k netCDF-4 makes a file of it that is read"},
    {"CDF\5", "is NetCDF of version 3: nccopy -k netCDF-4 makes a file of it that is read"},
    {"PK\3\4", "is a .zip archive: unpack it, and name the file or folder in it"}};

/* Whether a path ends in one of the extensions, which blanks separate. */
static bool ends_in(const char *path, const char *extensions) {
    const char *dot = strrchr(path, '.');
    for (const char *at = extensions; dot && *at; at += strspn(at, " ")) {
        const size_t length = strcspn(at, " ");
        if (strlen(dot) == length && strncasecmp(dot, at, length) == 0) return true;
        at += length;
    }
    return false;
}

/* What to do with a file that is no volume; NULL: nothing is known of it. */
static const char *near_miss(const char *path, const head *h) {
    for (size_t i = 0; i < sizeof confused / sizeof *confused; i++) {
        const size_t length = strlen(confused[i].begins);
        if (h->count >= length && memcmp(h->bytes, confused[i].begins, length) == 0)
            return confused[i].advice;
    }
    if (iso_file_type_of_name(path, ISO_HOLDS_RAW) != ISO_FILE_UNKNOWN)
        return "raw data needs a layout (--raw WxHxD:TYPE)";
    if (is_metadata(path)) return "is the metadata of an array: name the folder that it is in";
    return NULL;
}

/* Says which files are volumes, and which files of other kinds are read. */
static iso_status fail_unknown(const char *path, const head *h, iso_error *error) {
    char volumes[256], others[256];
    const char *reason = near_miss(path, h);
    if (ends_in(path, EXODUS)) return iso_format_not_image(path, "grid of Exodus", error);
    if (h->count >= 11 && memcmp(h->bytes, "$MeshFormat", 11) == 0)
        return iso_format_not_image(path, "grid of Gmsh", error);
    if (reason) return iso_fail(error, ISO_ERR_FORMAT, "%s: %s", path, reason);
    iso_file_type_extensions(ISO_HOLDS_VOLUME, 0, "", volumes, sizeof volumes);
    iso_file_type_extensions(ISO_HOLDS_MESH | ISO_HOLDS_LINES | ISO_HOLDS_GLYPHS, ISO_HOLDS_VOLUME, "and",
                             others, sizeof others);
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: not a volume that can be read: it reads %s, folders of PNG or JPEG slices, Zarr and "
                    "DICOM folders, and raw data with --raw; points and shapes are %s",
                    path, volumes, others);
}

static iso_status load_remote(const char *url, const iso_module **module, iso_error *error) {
    return iso_module_load(url, "remote", "URL", module, error);
}

/* Whether a URL names a file, by how its name ends; else it is a folder's, of Zarr or N5, which is not
 * copied. */
static bool is_remote_file(const char *url) {
    return iso_file_type_of_name(url, ~0u) != ISO_FILE_UNKNOWN;
}

static iso_status fetch_file(const char *url, char path[PATH_MAX], iso_error *error) {
    const iso_module *module;
    ISO_TRY(load_remote(url, &module, error));
    return module->remote->fetch(url, iso_memory_limit(0), path, error);
}

/* Copies what is opened as a file (iso_file_fetcher). */
static iso_status fetch_opened(const char *url, char path[PATH_MAX], iso_error *error) {
    if (is_remote_file(url)) return fetch_file(url, path, error);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its name is not that of a file that is read", url);
}

void iso_volume_use_servers(void) {
    iso_file_set_fetcher(fetch_opened);
}

/* A path on a server: an array or image of Zarr, or N5. */
static iso_status find_remote(const char *path, request *r, const iso_format **format, iso_error *error) {
    const iso_module *module;
    ISO_TRY(load_remote(path, &module, error));
    r->opts.remote = module->remote;
    *format = &format_zarr;
    return ISO_OK;
}

static iso_status find_format(request *r, const iso_format **format, iso_error *error) {
    const char *path = r->path;
    struct stat status;
    if (iso_is_url(path) && !r->opts.raw && !is_remote_file(path)) return find_remote(path, r, format, error);
    if (iso_is_url(path)) {
        ISO_TRY(fetch_file(path, r->file, error));
        r->path = path = r->file;
    }
    if (stat(path, &status) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    if (S_ISDIR(status.st_mode)) {
        *format = has_zarr(path)                                 ? &format_zarr
                  : iso_slice_files_exist(path, ISO_SLICES_TIFF) ? &iso_format_tiff
                  : is_image_stack(path, ISO_SLICES_PNG)         ? &iso_format_png
                  : is_image_stack(path, ISO_SLICES_JPEG)        ? &iso_format_jpeg
                                                                 : &iso_format_dicom;
        if (r->opts.raw) return iso_fail(error, ISO_ERR_IO, "%s: is a folder, not a raw file", path);
        return ISO_OK;
    }
    if (!S_ISREG(status.st_mode)) return iso_fail(error, ISO_ERR_IO, "%s: not a file or a folder", path);
    head h;
    ISO_TRY(read_head(path, &h, error));
    *format = r->opts.raw ? &iso_format_raw : format_of_file(path, &h);
    if (!r->opts.raw) ISO_TRY(guess_raw(path, (uint64_t)status.st_size, r, format, error));
    /* (Exodus is also HDF5) */
    if (!*format || (*format == &iso_format_hdf5 && ends_in(path, EXODUS)))
        return fail_unknown(path, &h, error);
    if (!h.gzip || reads_gzip(*format) || *format == &iso_format_raw) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "%s: is a file of type %s that gzip has compressed: unpack it (gunzip)", path,
                    (*format)->name);
}

/* ---- header ---- */

static iso_status check_spacing(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_error *error) {
    double *spacing = info->transform.spacing;
    for (int i = 0; i < 3; i++) {
        if (opts->spacing[i] != 0 && !(opts->spacing[i] > 0 && opts->spacing[i] < HUGE_VAL))
            return iso_fail(error, ISO_ERR_USAGE, "%s: a spacing of %g is not possible", path,
                            opts->spacing[i]);
        if (opts->spacing[i] > 0) spacing[i] = opts->spacing[i];
    }
    if (opts->spacing[0] + opts->spacing[1] + opts->spacing[2] > 0 && info->sparse &&
        (spacing[0] != spacing[1] || spacing[0] != spacing[2]))
        return iso_fail(error, ISO_ERR_USAGE, "%s: a sparse level set needs the same spacing on every axis",
                        path);
    return ISO_OK;
}

/* Limits on the positions and sizes of voxels, mm. Doubles have 16 digits: with a ratio of at most 1e12
 * between the farthest corner and a voxel's size, thousands of steps are left within a voxel. Areas and
 * volumes of voxels must not underflow. A voxel whose sides differ by more than a factor of a million cannot
 * be seen in any picture. */
static const double farthest = 1e12, finest = 1e-12, smallest_voxel = 1e-15, thinnest = 1e-6;

/* The largest coordinate of the box of voxels, in mm. */
static double reach_of(const iso_volume_info *info) {
    const iso_transform *t = &info->transform;
    double reach = 0;
    for (int row = 0; row < 3; row++) {
        double lo = t->origin[row], hi = lo;
        for (int axis = 0; axis < 3; axis++) {
            double step = t->direction[3 * row + axis] * t->spacing[axis] * (info->dims[axis] - 1);
            *(step < 0 ? &lo : &hi) += step;
        }
        reach = fmax(reach, fmax(fabs(lo), fabs(hi)));
    }
    return reach;
}

static iso_status check_reach(const char *path, const iso_volume_info *info, iso_error *error) {
    const double *s = info->transform.spacing;
    const double small = fmin(s[0], fmin(s[1], s[2])), large = fmax(s[0], fmax(s[1], s[2]));
    const double reach = reach_of(info);
    if (!(reach <= farthest && large <= farthest))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: its voxels lie up to %g mm from the origin, more than %g is not possible", path,
                        fmax(reach, large), farthest);
    if (!(small >= smallest_voxel))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: a spacing of %g mm is too small, at least %g is needed",
                        path, small, smallest_voxel);
    if (!(small >= thinnest * large))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: its spacings, %g and %g mm, differ by more than a million times", path, small,
                        large);
    if (!(small >= finest * reach))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: voxels of %g mm that lie up to %g mm from the origin cannot be told apart", path,
                        small, reach);
    return ISO_OK;
}

static iso_status check_geometry(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                 iso_error *error) {
    iso_transform *t = &info->transform;
    ISO_TRY(check_spacing(path, opts, info, error));
    for (int i = 0; i < 9; i++) {
        t->direction[i] += 0.0; /* turns -0 into 0 */
        if (!isfinite(t->direction[i]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: the directions of its axes are not numbers", path);
    }
    for (int i = 0; i < 3; i++) {
        double *d = t->direction + i, length = sqrt(d[0] * d[0] + d[3] * d[3] + d[6] * d[6]);
        if (!(length >= thinnest && length <= 1 / thinnest))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a direction of length %g is not possible", path,
                            length);
        t->origin[i] += 0.0;
        if (!isfinite(t->origin[i]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: an origin of %g is not possible", path, t->origin[i]);
        if (!(t->spacing[i] > 0 && isfinite(t->spacing[i])))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: a spacing of %g is not possible", path,
                            t->spacing[i]);
    }
    ISO_TRY(check_reach(path, info, error));
    if (iso_transform_is_singular(t))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the axes' directions do not span space", path);
    return ISO_OK;
}

/* Checks scale and offset: scaled integers must fit into floats, and different integers must stay different.
 */
static iso_status check_scale(const char *path, const iso_volume_info *info, iso_error *error) {
    const double most = 1e30, span = info->type == ISO_FLOAT32 ? HUGE_VAL : info->scale * 65536;
    if (!(info->scale >= 1 / most && info->scale <= most && fabs(info->offset) <= most))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: values cannot be scaled by %g and shifted by %g", path,
                        info->scale, info->offset);
    if (!(fabs(info->offset) <= span / finest))
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: values that are scaled by %g and shifted by %g cannot be told apart", path,
                        info->scale, info->offset);
    return ISO_OK;
}

/* Counts the memory of the brick index, which is made after the reader has released what it needs beside the
 * grid. */
static void count_index(iso_volume_info *info) {
    uint64_t bytes = info->bytes;
    if (!info->sparse && __builtin_add_overflow(bytes, iso_brick_index_estimate(info->dims), &bytes))
        bytes = UINT64_MAX;
    if (info->read_bytes < bytes) info->read_bytes = bytes;
}

static iso_status check_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_error *error) {
    uint64_t dims[3];
    for (int i = 0; i < 3; i++) dims[i] = info->dims[i] < 0 ? 0 : (uint64_t)info->dims[i];
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(check_geometry(path, opts, info, error));
    ISO_TRY(check_scale(path, info, error));
    if (info->bytes == 0) info->bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (info->bytes == UINT64_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %d x %d x %d voxels are more than any machine can hold",
                        path, info->dims[0], info->dims[1], info->dims[2]);
    count_index(info);
    return ISO_OK;
}

/* Makes a message begin with the path that the caller gave: a reader's message may begin with the name of the
 * file that is a part of that path, or of a data file. */
static iso_status name_path(const char *given, const request *r, iso_status status, const iso_error *detail,
                            iso_error *error) {
    if (status == ISO_OK) return ISO_OK;
    size_t length =
        iso_text_begins(detail->text, r->path); /* "head.img: ..." does not name the file "head" */
    bool names_it = length && (r->path[strlen(r->path) - 1] == '/' || strchr(":/, ", detail->text[length]));
    if (r->path != given && names_it) return iso_fail(error, status, "%s%s", given, detail->text + length);
    return iso_fail(error, status, "%s%s%s", names_it ? "" : given, names_it ? "" : ": ", detail->text);
}

/* Replaces the entry of a format whose reader is in a module by the module's. */
static iso_status load_format(const char *path, const iso_format **format, iso_error *error) {
    if ((*format)->module) {
        const iso_module *module = NULL;
        ISO_TRY(iso_module_load(path, (*format)->module, (*format)->library, &module, error));
        *format = module->format;
    }
    if ((*format)->info) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without %s, which reads this format", path,
                    (*format)->library);
}

/* Whether a word is in a list of words, each between blanks. */
static bool is_one_of(const char *word, const char *list) {
    const size_t length = strlen(word);
    for (const char *at = list; (at = strstr(at, word)); at++)
        if (at[-1] == ' ' && at[length] == ' ') return true;
    return false;
}

/* Notes options that were given but have no effect on files of this format. */
static void note_unused(const iso_volume_opts *opts, iso_volume_info *info) {
    if (opts->grid && !is_one_of(info->format, " vdb vti vtk hdf5 npz vtr pvti pvd vtm xdmf amira "))
        iso_volume_note(info, "grid \"%.80s\" is not looked for: a %s file has no grids with names (--grid)",
                        opts->grid, info->format);
    if (opts->series && strcmp(info->format, "dicom") != 0)
        iso_volume_note(info, "series \"%.80s\" is not looked for: a %s file has no series (--series)",
                        opts->series, info->format);
    if (opts->level > 0 && strcmp(info->format, format_zarr.name) != 0 &&
        strcmp(info->format, iso_format_hdf5.name) != 0)
        iso_volume_note(info, "level %d is not looked for: a %s file has one level (--level)", opts->level,
                        info->format);
}

/* Whether the voxels of all files of a format can stay in them. */
static bool is_mappable(const iso_format *format) {
    const iso_format *const formats[] = {&iso_format_nrrd, &iso_format_metaimage, &iso_format_nifti,
                                         &iso_format_vtk, &iso_format_npy};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (format == formats[i]) return true;
    return format->open_tiled != NULL;
}

static void note_guess(const iso_raw_layout *raw, iso_volume_info *info) {
    iso_volume_note(info, "layout taken from the file's name: %dx%dx%d:%s:%s (--raw)", raw->dims[0],
                    raw->dims[1], raw->dims[2], iso_raw_layout_type_name(raw),
                    raw->big_endian ? "big" : "little");
}

/* Whether lengths are not in mm: in angstrom, or in a unit that the format never states; of other formats the
 * reader says of a file that it does not. A spacing that is given is in the file's unit, or else in mm. */
static bool is_unitless(const iso_volume_opts *opts, const iso_volume_info *info) {
    if (info->angstrom) return true;
    if (opts->spacing[0] > 0 && opts->spacing[1] > 0 && opts->spacing[2] > 0) return false;
    return info->unitless || is_one_of(info->format, " raw vtk vti vdb npy npz vtr pvti pvd vtm xdmf ");
}

/* Makes the steps even, by coordinates that the reader has set. */
static iso_status take_axes(const char *path, request *r, iso_volume_info *info, iso_error *error) {
    bool even = true;
    r->stored = *info;
    ISO_TRY(iso_rectilinear_describe(path, &r->axes, info, &even, error));
    r->resampled = !even;
    if (even) return ISO_OK;
    const uint64_t voxels = iso_format_size(r->stored.dims, iso_type_size(r->stored.type)),
                   read = r->stored.read_bytes > voxels ? r->stored.read_bytes : voxels,
                   bytes = iso_format_size(info->dims, sizeof(float));
    if (__builtin_add_overflow(read, bytes, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status describe_file(const char *path, request *r, const iso_format **format,
                                iso_volume_info *info, iso_error *error) {
    *info = (iso_volume_info){.components = 1, .scale = 1, .transform = iso_transform_identity()};
    if (r->opts.channels) *r->opts.channels = (iso_channels){0};
    if (r->opts.component_axes)
        *r->opts.component_axes = (iso_component_axes){.to_world = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    iso_error detail = {0};
    ISO_TRY(divide_path(path, r, error));
    ISO_TRY(name_path(path, r, find_format(r, format, &detail), &detail, error));
    if (r->opts.level < 0)
        return iso_fail(
            error, ISO_ERR_USAGE,
            "%s: a level is chosen automatically only for the input of a picture: give its number", path);
    ISO_TRY(load_format(path, format, error));
    snprintf(info->format, sizeof info->format, "%s", (*format)->name);
    if (r->is_guessed) note_guess(&r->guessed, info);
    r->opts.place = &r->place;
    r->opts.axes = &r->axes;
    iso_file_set_read(r->opts.files, r->path);
    ISO_TRY(name_path(path, r, (*format)->info(r->path, &r->opts, info, &detail), &detail, error));
    ISO_TRY(take_axes(path, r, info, error));
    note_unused(&r->opts, info);
    info->unitless = is_unitless(&r->opts, info);
    r->mappable = !r->resampled && (r->place.known || is_mappable(*format));
    if (r->opts.mappable) *r->opts.mappable = r->mappable;
    return check_info(path, &r->opts, info, error);
}

/* Numbers in files have a decimal point, whatever locale the program has set. */
static iso_status read_header(const char *path, request *r, const iso_format **format, iso_volume_info *info,
                              iso_error *error) {
    void *numbers = iso_decimal_point_begin();
    const iso_status status = describe_file(path, r, format, info, error);
    iso_decimal_point_end(numbers);
    if (status != ISO_OK) iso_rectilinear_free(&r->axes);
    return status;
}

/* Makes the texts from the file printable. Readers need them unchanged until here, to find them in the file.
 */
static void clean_texts(const iso_volume_opts *opts, iso_volume_info *info) {
    for (int i = 0; opts->channels && i < ISO_CHANNELS; i++)
        iso_text_clean_in_place(opts->channels->items[i].name, ISO_CHANNEL_NAME);
    iso_text_clean_in_place(info->name, sizeof info->name);
    iso_text_clean_in_place(info->file_type, sizeof info->file_type);
    for (int i = 0; i < info->item_count; i++) iso_text_clean_in_place(info->items[i], sizeof info->items[i]);
}

iso_status iso_volume_read_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_error *error) {
    return iso_volume_find_place(path, opts, info, NULL, error);
}

iso_status iso_volume_find_place(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                 iso_format_place *place, iso_error *error) {
    request r = {.opts = opts ? *opts : (iso_volume_opts){0}};
    const iso_format *format = NULL;
    iso_volume_info found;
    ISO_TRY(read_header(path, &r, &format, &found, error));
    clean_texts(&r.opts, &found);
    *info = found;
    if (place) *place = r.resampled ? (iso_format_place){0} : r.place;
    iso_rectilinear_free(&r.axes);
    return ISO_OK;
}

/* ---- reading ---- */

iso_status iso_volume_check_memory(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                   iso_error *error) {
    char what[80];
    snprintf(what, sizeof what, "%d x %d x %d %s", info->dims[0], info->dims[1], info->dims[2],
             info->file_type);
    return iso_format_check_memory(path, opts, info->read_bytes, what, error);
}

bool iso_volume_may_be_sparse(const iso_volume_info *info) {
    return strcmp(info->format, format_zarr.name) == 0 || strcmp(info->format, iso_format_hdf5.name) == 0;
}

iso_chunk_source iso_volume_source(const iso_rgrid *grid) {
    return iso_tiled_is(grid) ? iso_tiled_source(grid) : iso_mapping_source(grid);
}

/* Whether the grid has the size and type of the header, which were checked against the memory limit. */
static bool agrees(const iso_volume_info *info, const iso_grid *grid) {
    if (!grid->rgrid) return grid->hgrid != NULL;
    const int *dims = grid->rgrid->dims;
    return grid->rgrid->type == info->type && dims[0] == info->dims[0] && dims[1] == info->dims[1] &&
           dims[2] == info->dims[2];
}

static iso_status make_index(const char *path, const iso_volume_opts *opts, iso_rgrid *grid,
                             iso_error *error) {
    iso_error detail = {0};
    iso_status status = opts->count_values ? iso_brick_index_with_counts(grid, opts->pool, &detail)
                                           : iso_brick_index_of(grid, opts->pool, NULL, &detail);
    return status == ISO_OK ? ISO_OK : iso_fail(error, status, "%s: %s", path, detail.text);
}

/* Whether tiles are as the header says, so that they fit into its grid. */
static bool tiles_agree(const iso_volume_info *info, const iso_tiled *tiled) {
    for (int axis = 0; axis < 3; axis++)
        if (tiled->dims[axis] != info->dims[axis] || tiled->tile[axis] < 1) return false;
    return tiled->type == info->type &&
           iso_format_size(tiled->tile, iso_type_size(tiled->type)) != UINT64_MAX;
}

static iso_status read_tiled(const iso_format *format, const char *path, const iso_volume_opts *opts,
                             iso_volume *volume, iso_error *error) {
    iso_tiled tiled = {0};
    ISO_TRY(format->open_tiled(path, opts, &volume->info, &tiled, error));
    iso_status status;
    if (!tiles_agree(&volume->info, &tiled))
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    else if (opts->mapped && iso_tiled_suits_chunks(&tiled, opts))
        status = iso_tiled_make_grid(path, opts, &tiled, &volume->info, &volume->grid, error);
    else
        status = iso_tiled_read_grid(path, opts, &tiled, &volume->info, &volume->grid, error);
    iso_tiled_close(&tiled);
    return status;
}

/* Reads the voxels as they are in the file. */
static iso_status read_stored(const iso_format *format, const request *r, iso_volume *volume,
                              iso_error *error) {
    if (r->place.known)
        return iso_format_read_place(r->path, &r->opts, &volume->info, &r->place, &volume->grid, error);
    return format->open_tiled ? read_tiled(format, r->path, &r->opts, volume, error)
                              : format->read(r->path, &r->opts, &volume->info, &volume->grid, error);
}

static iso_status read_resampled(const iso_format *format, const request *r, iso_volume *volume,
                                 iso_error *error) {
    iso_volume stored = {.info = r->stored};
    ISO_TRY(read_stored(format, r, &stored, error));
    for (int i = r->stored.note_count; i < stored.info.note_count; i++)
        iso_volume_note(&volume->info, "%s", stored.info.notes[i]);
    const iso_status status = agrees(&r->stored, &stored.grid)
                                  ? iso_rectilinear_resample(r->path, &r->axes, &stored.grid, &volume->info,
                                                             r->opts.pool, &volume->grid, error)
                                  : iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", r->path);
    iso_grid_destroy(&stored.grid);
    return status;
}

static iso_status read_voxels(const iso_format *format, request *r, iso_volume *volume, iso_error *error) {
    void *numbers = iso_decimal_point_begin();
    const iso_status status =
        r->resampled ? read_resampled(format, r, volume, error) : read_stored(format, r, volume, error);
    iso_decimal_point_end(numbers);
    iso_rectilinear_free(&r->axes);
    return status;
}

iso_status iso_volume_read(const char *path, const iso_volume_opts *opts, iso_volume *volume,
                           iso_error *error) {
    request r = {.opts = opts ? *opts : (iso_volume_opts){0}};
    opts = &r.opts;
    const iso_format *format = NULL;
    iso_volume result = {0};
    ISO_TRY(read_header(path, &r, &format, &result.info, error));
    r.opts.mapped = r.opts.mapped && r.mappable;
    iso_status status = opts->mapped ? ISO_OK : iso_volume_check_memory(path, opts, &result.info, error);
    if (status == ISO_OK) status = iso_format_progress(path, opts, 0, error);
    if (status != ISO_OK) {
        iso_rectilinear_free(&r.axes);
        return status;
    }
    iso_error detail = {0};
    status = read_voxels(format, &r, &result, &detail);
    ISO_TRY(name_path(path, &r, status, &detail, error));
    if (!agrees(&result.info, &result.grid))
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    if (status == ISO_OK && result.grid.rgrid && !opts->mapped)
        status = make_index(path, opts, result.grid.rgrid, error);
    if (status == ISO_OK) status = iso_format_progress(path, opts, 1, error);
    if (status != ISO_OK) {
        iso_volume_free(&result);
        return status;
    }
    clean_texts(&r.opts, &result.info);
    *volume = result;
    return ISO_OK;
}

void iso_volume_free(iso_volume *volume) {
    iso_grid_destroy(&volume->grid);
    *volume = (iso_volume){0};
}
