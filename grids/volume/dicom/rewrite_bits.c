/* Changes bits of the frames of a binary segmentation, whose other bytes are copied. */
#include "grids/volume/dicom/rewrite_bits.h"

#include <errno.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/dicom/dicom.h"

static iso_status check(const char *path, const iso_dicom_file *file, iso_dicom_kind kind, iso_error *error) {
    const bool segmentation = kind == ISO_DICOM_IMAGE && *file->segmentation;
    const char *reason = !segmentation                               ? "it is no segmentation"
                         : strcmp(file->segmentation, "BINARY") != 0 ? "its type is not BINARY"
                         : file->encapsulated                        ? "its pixels are compressed"
                         : file->bits_allocated != 1                 ? "its pixels are no bits"
                                                                     : NULL;
    return reason
               ? iso_fail(
                     error, ISO_ERR_USAGE,
                     "%s: voxels go back into DICOM segmentations of type BINARY that are not compressed: %s",
                     path, reason)
               : ISO_OK;
}

/* Reads the header, and where the frames lie; *file is to be freed also after an error. */
static iso_status read_header(const char *path, iso_dicom_file *file, iso_volume_info *info,
                              iso_error *error) {
    iso_dicom_kind kind = ISO_DICOM_NOT;
    ISO_TRY(iso_dicom_file_read(path, file, &kind, error));
    ISO_TRY(check(path, file, kind, error));
    return iso_dicom_segmentation_order(path, file, info, error);
}

iso_status iso_dicom_rewrite_check(const char *path, iso_error *error) {
    iso_dicom_file file = {.path = NULL};
    iso_volume_info *info = iso_alloc_zero(1, sizeof *info);
    const iso_status status = info ? read_header(path, &file, info, error) : iso_fail_memory(error, path);
    iso_dicom_file_free(&file);
    iso_free(info);
    return status;
}

typedef struct changing {
    const iso_dicom_file *file;
    uint8_t *bits;         /* of all frames, the lowest of a byte first */
    float *before, *after; /* labels of a row */
} changing;

static uint64_t bit_of(const iso_dicom_file *file, const iso_dicom_frame *frame, int x, int y) {
    return ((uint64_t)frame->index * (uint64_t)file->rows + (uint64_t)y) * (uint64_t)file->columns +
           (uint64_t)x;
}

static bool is_set(const changing *c, uint64_t bit) {
    return c->bits[bit / 8] >> bit % 8 & 1;
}

/* Gives a voxel the label `now` instead of `was`; 0: none. frames .. end: those of its slice. False: there is
 * no frame of it. */
static bool change_voxel(const changing *c, const iso_dicom_frame *frame, const iso_dicom_frame *end, int was,
                         int now, int x, int y) {
    bool done = !now;
    for (; frame < end; frame++) {
        const uint64_t bit = bit_of(c->file, frame, x, y);
        const uint8_t mark = (uint8_t)(1u << bit % 8);
        if (now && frame->segment == now) {
            c->bits[bit / 8] |= mark;
            done = true;
        } else if (frame->segment == was || (now && frame->segment > now))
            c->bits[bit / 8] &= (uint8_t)~mark;
    }
    return done;
}

/* Frames are sorted by slice, and in each by segment. */
static iso_status change_slice(const changing *c, const iso_dicom_frame *frame, const iso_dicom_frame *end,
                               int z, iso_rewrite_row *row, void *context, iso_error *error) {
    const int columns = c->file->columns;
    for (int y = 0; y < c->file->rows; y++) {
        memset(c->before, 0, (size_t)columns * sizeof *c->before);
        for (const iso_dicom_frame *f = frame; f < end; f++)
            for (int x = 0; x < columns; x++)
                if (is_set(c, bit_of(c->file, f, x, y))) c->before[x] = (float)f->segment;
        memcpy(c->after, c->before, (size_t)columns * sizeof *c->after);
        row(context, y, z, c->after);
        for (int x = 0; x < columns; x++) {
            const int was = (int)c->before[x], now = (int)c->after[x];
            if (was != now && !change_voxel(c, frame, end, was, now, x, y))
                return iso_fail(
                    error, ISO_ERR_USAGE,
                    "%s: segment %d has no frame in slice %d, where it gets voxels: no frames are "
                    "added to a DICOM segmentation",
                    c->file->path, now, z);
        }
    }
    return ISO_OK;
}

static iso_status change_bits(const changing *c, int slices, iso_rewrite_row *row, void *context,
                              const iso_progress *progress, iso_error *error) {
    const iso_dicom_frame *frame = c->file->frames, *last = frame + c->file->frame_count;
    for (int z = 0; z < slices; z++) {
        const iso_dicom_frame *end = frame;
        while (end < last && end->place == (size_t)z) end++;
        ISO_TRY(iso_progress_tell(progress, c->file->path, (double)z / slices, error));
        ISO_TRY(change_slice(c, frame, end, z, row, context, error));
        frame = end;
    }
    return ISO_OK;
}

/* Copies bytes; UINT64_MAX: all that are left. */
static iso_status copy(const char *path, FILE *from, FILE *to, uint64_t bytes, iso_error *error) {
    unsigned char block[1 << 14];
    while (bytes) {
        const size_t part = bytes < sizeof block ? (size_t)bytes : sizeof block,
                     got = fread(block, 1, part, from);
        fwrite(block, 1, got, to);
        if (got < part) break;
        if (bytes != UINT64_MAX) bytes -= got;
    }
    return ferror(from) ? iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno)) : ISO_OK;
}

static iso_status write_file(const changing *c, int slices, FILE *from, iso_rewrite_row *row, void *context,
                             FILE *stream, const iso_progress *progress, iso_error *error) {
    const iso_dicom_file *file = c->file;
    const uint64_t bytes = file->pixel_bytes;
    ISO_TRY(copy(file->path, from, stream, file->pixel_offset, error));
    if (fread(c->bits, 1, (size_t)bytes, from) != bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: the file ends too early", file->path);
    ISO_TRY(change_bits(c, slices, row, context, progress, error));
    fwrite(c->bits, 1, (size_t)bytes, stream);
    return copy(file->path, from, stream, UINT64_MAX, error);
}

iso_status iso_dicom_rewrite(const char *path, iso_rewrite_row *row, void *context, FILE *stream,
                             const iso_progress *progress, iso_error *error) {
    iso_dicom_file file = {.path = NULL};
    iso_volume_info *info = iso_alloc_zero(1, sizeof *info);
    changing c = {.file = &file};
    FILE *from = NULL;
    iso_status status = info ? read_header(path, &file, info, error) : iso_fail_memory(error, path);
    if (status == ISO_OK) {
        c.bits = iso_alloc((size_t)file.pixel_bytes);
        c.before = iso_alloc((size_t)file.columns * sizeof *c.before);
        c.after = iso_alloc((size_t)file.columns * sizeof *c.after);
        status = c.bits && c.before && c.after ? iso_file_open(path, &from, NULL, error)
                                               : iso_fail_memory(error, path);
    }
    if (status == ISO_OK) status = write_file(&c, info->dims[2], from, row, context, stream, progress, error);
    if (from) fclose(from);
    iso_free(c.bits);
    iso_free(c.before);
    iso_free(c.after);
    iso_dicom_file_free(&file);
    iso_free(info);
    return status;
}
