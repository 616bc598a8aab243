/* rewrite: passes a volume file from a reader to a writer, both of which may be compressed, and changes
 * voxels on the way. */
#include "grids/volume/rewrite.h"

#include <errno.h>
#include <string.h>

#include <zlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/dicom/rewrite_bits.h"
#include "grids/volume/module.h"

enum { BLOCK = 1 << 16 };

/* ---- what can be written again */

static bool is_dicom(const iso_volume_info *info) {
    return strcmp(info->format, iso_format_dicom.name) == 0;
}

static iso_status find_place(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                             iso_format_place *place, iso_error *error) {
    iso_volume_opts asked = *opts;
    asked.mappable = NULL;
    ISO_TRY(iso_volume_find_place(path, &asked, info, place, error));
    if (is_dicom(info)) return iso_dicom_rewrite_check(path, error);
    const bool scaled = info->scale != 1 || info->offset != 0 ||
                        (!place->known && iso_scalar_stored_type(place->scalar) != info->type);
    if ((place->known || place->told || place->by_module) && !place->text && !place->bits &&
        !place->file[0] && !scaled)
        return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE,
                    "%s: %s: voxels go back into .nii, .nii.gz, .nrrd, .mha, .mgh, .mgz, .mif and .npy that "
                    "have them as they are or (not .mha) compressed by gzip, into .tif, and into DICOM SEG",
                    path,
                    scaled           ? "its values are scaled (scl_slope, scl_inter)"
                    : place->file[0] ? "its voxels are in another file"
                                     : "its voxels cannot be written again");
}

iso_status iso_volume_rewrite_check(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                    iso_error *error) {
    iso_format_place place;
    return find_place(path, opts, info, &place, error);
}

/* ---- reading and writing */

typedef struct passing {
    const char *path;
    FILE *from, *to;
    iso_inflater *inflater; /* NULL: as it is */
    z_stream z;             /* with an inflater */
    unsigned char block[BLOCK], packed[BLOCK];
} passing;

/* Reads up to `bytes` bytes. */
static iso_status take(passing *p, void *target, size_t bytes, size_t *got, iso_error *error) {
    if (p->inflater) return iso_inflater_read(p->inflater, target, bytes, got, error);
    *got = fread(target, 1, bytes, p->from);
    return ferror(p->from) ? iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", p->path, strerror(errno))
                           : ISO_OK;
}

/* Writes bytes; `flush`: Z_FINISH at the end. */
static void give(passing *p, const void *bytes, size_t count, int flush) {
    if (!p->inflater) {
        fwrite(bytes, 1, count, p->to);
        return;
    }
    p->z.next_in = (unsigned char *)(uintptr_t)bytes; /* (zlib does not write there) */
    p->z.avail_in = (uInt)count;
    do {
        p->z.next_out = p->packed;
        p->z.avail_out = sizeof p->packed;
        deflate(&p->z, flush);
        fwrite(p->packed, 1, sizeof p->packed - p->z.avail_out, p->to);
    } while (p->z.avail_out == 0);
}

/* Copies bytes; UINT64_MAX: all that are left. */
static iso_status copy(passing *p, uint64_t bytes, iso_error *error) {
    for (uint64_t done = 0; done < bytes;) {
        const size_t part = bytes - done < BLOCK ? (size_t)(bytes - done) : BLOCK;
        size_t got;
        ISO_TRY(take(p, p->block, part, &got, error));
        give(p, p->block, got, Z_NO_FLUSH);
        done += got;
        if (got == part) continue;
        return bytes == UINT64_MAX ? ISO_OK : iso_format_truncated(p->path, done, bytes, error);
    }
    return ISO_OK;
}

/* ---- voxels */

typedef struct voxels {
    const iso_format_place *place;
    const iso_volume_info *info;
    size_t size, step, component; /* bytes of a value, of a voxel, and of the values before that of a voxel */
    char *bytes;                  /* of a row */
    float *values, *changed;      /* of a row */
    iso_rewrite_row *row;
    void *context; /* of `row` */
} voxels;

/* Writes a value in the file's type, which has it. */
static void put_value(const voxels *v, float value, char *target) {
    union {
        uint8_t u8;
        int8_t i8;
        uint16_t u16;
        int16_t i16;
        uint32_t u32;
        int32_t i32;
        uint64_t u64;
        int64_t i64;
        float real;
        double wide;
        char bytes[8];
    } as = {0};
    switch (v->place->scalar) {
    case ISO_SCALAR_UINT8:
        as.u8 = (uint8_t)value;
        break;
    case ISO_SCALAR_INT8:
        as.i8 = (int8_t)value;
        break;
    case ISO_SCALAR_UINT16:
        as.u16 = (uint16_t)value;
        break;
    case ISO_SCALAR_INT16:
        as.i16 = (int16_t)value;
        break;
    case ISO_SCALAR_UINT32:
        as.u32 = (uint32_t)value;
        break;
    case ISO_SCALAR_INT32:
        as.i32 = (int32_t)value;
        break;
    case ISO_SCALAR_UINT64:
        as.u64 = (uint64_t)value;
        break;
    case ISO_SCALAR_INT64:
        as.i64 = (int64_t)value;
        break;
    case ISO_SCALAR_FLOAT:
        as.real = value;
        break;
    case ISO_SCALAR_DOUBLE:
        as.wide = value;
        break;
    case ISO_SCALAR_HALF:
        return; /* (in no file that is written again) */
    }
    for (size_t i = 0; i < v->size; i++) target[i] = as.bytes[v->place->swap ? v->size - 1 - i : i];
}

/* Changes a row of bytes; returns whether it has. */
static bool change_row(const voxels *v, char *bytes, int y, int z) {
    bool changed = false;
    const size_t count = (size_t)v->info->dims[0];
    for (size_t x = 0; x < count; x++) {
        const iso_scalar_source source = {.data = bytes + x * v->step + v->component,
                                          .scalar = v->place->scalar,
                                          .components = 1,
                                          .swap = v->place->swap};
        iso_scalar_convert(&source, 1, ISO_FLOAT32, &v->values[x]);
    }
    memcpy(v->changed, v->values, count * sizeof *v->values);
    v->row(v->context, y, z, v->changed);
    for (size_t x = 0; x < count; x++) {
        if (memcmp(&v->changed[x], &v->values[x], sizeof *v->values) == 0) continue;
        put_value(v, v->changed[x], bytes + x * v->step + v->component);
        changed = true;
    }
    return changed;
}

/* iso_row_changer */
static bool change_whole_row(void *context, int y, int z, char *bytes) {
    return change_row(context, bytes, y, z);
}

static iso_status pass_voxels(passing *p, const voxels *v, const iso_progress *progress, iso_error *error) {
    const int *dims = v->info->dims;
    const size_t wanted = (size_t)dims[0] * v->step;
    for (int z = 0; z < dims[2]; z++) {
        ISO_TRY(iso_progress_tell(progress, p->path, (double)z / dims[2], error));
        for (int y = 0; y < dims[1]; y++) {
            size_t got;
            ISO_TRY(take(p, v->bytes, wanted, &got, error));
            if (got < wanted) return iso_format_truncated(p->path, got, wanted, error);
            change_row(v, v->bytes, y, z);
            give(p, v->bytes, wanted, Z_NO_FLUSH);
        }
    }
    return ISO_OK;
}

static iso_status begin_packed(passing *p, uint64_t total, iso_error *error) {
    ISO_TRY(iso_inflater_create(p->path, p->from, total, &p->inflater, error));
    if (deflateInit2(&p->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK)
        return ISO_OK;
    iso_inflater_destroy(p->inflater);
    p->inflater = NULL;
    return iso_fail_memory(error, p->path);
}

static iso_status pass_all(passing *p, const voxels *v, const iso_progress *progress, iso_error *error) {
    const iso_format_place *place = v->place;
    const uint64_t volume = iso_format_size(v->info->dims, v->step);
    uint64_t start = place->separate ? volume * (uint64_t)v->info->component : 0;
    if (__builtin_add_overflow(start, place->position, &start))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: too many volumes in one file", p->path);
    ISO_TRY(copy(p, place->plain, error));
    if (place->gzip) ISO_TRY(begin_packed(p, start + volume, error));
    ISO_TRY(copy(p, start, error));
    ISO_TRY(pass_voxels(p, v, progress, error));
    ISO_TRY(copy(p, UINT64_MAX, error));
    if (p->inflater) ISO_TRY(iso_inflater_finish(p->inflater, NULL, error));
    give(p, p->block, 0, Z_FINISH);
    return ISO_OK;
}

static iso_status rewrite_file(const char *path, const voxels *v, FILE *stream, const iso_progress *progress,
                               iso_error *error) {
    passing *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, path);
    p->path = path;
    p->to = stream;
    iso_status status = iso_file_open(path, &p->from, NULL, error);
    if (status == ISO_OK) {
        status = pass_all(p, v, progress, error);
        if (p->inflater) deflateEnd(&p->z);
        iso_inflater_destroy(p->inflater);
        fclose(p->from);
    }
    iso_free(p);
    return status;
}

static iso_status rewrite_by_module(const char *path, const iso_volume_opts *opts, voxels *v, FILE *stream,
                                    const iso_progress *progress, iso_error *error) {
    const iso_module *module;
    ISO_TRY(iso_module_load(path, "tiff", "libtiff", &module, error));
    return module->rewrite(path, opts, change_whole_row, v, stream, progress, error);
}

iso_status iso_volume_rewrite(const char *path, const iso_volume_opts *opts, iso_rewrite_row *row,
                              void *context, FILE *stream, const iso_progress *progress, iso_error *error) {
    iso_volume_info info;
    iso_format_place place;
    ISO_TRY(find_place(path, opts, &info, &place, error));
    if (is_dicom(&info)) return iso_dicom_rewrite(path, row, context, stream, progress, error);
    const bool single = place.separate || place.by_module; /* a row holds no other components */
    const size_t size = iso_scalar_size(place.scalar), count = (size_t)info.dims[0],
                 step = size * (single ? 1 : (size_t)info.components);
    voxels v = {.place = &place,
                .info = &info,
                .size = size,
                .step = step,
                .component = single ? 0 : size * (size_t)info.component,
                .bytes = iso_alloc(count * step),
                .values = iso_alloc(count * sizeof *v.values),
                .changed = iso_alloc(count * sizeof *v.changed),
                .row = row,
                .context = context};
    iso_status status = v.bytes && v.values && v.changed ? ISO_OK : iso_fail_memory(error, path);
    if (status == ISO_OK)
        status = place.by_module ? rewrite_by_module(path, opts, &v, stream, progress, error)
                                 : rewrite_file(path, &v, stream, progress, error);
    iso_free(v.bytes);
    iso_free(v.values);
    iso_free(v.changed);
    return status;
}
