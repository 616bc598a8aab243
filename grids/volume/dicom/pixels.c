/* pixels: reads frames, uncompressed or by the module's decoder. */
#include "grids/volume/dicom/pixels.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/module.h"

void iso_dicom_pixels_close(iso_dicom_pixels *f) {
    if (f->stream) fclose(f->stream);
    iso_free(f->bytes);
    free(f->offset);
    free(f->length);
    *f = (iso_dicom_pixels){0};
}

static uint32_t little32(const uint8_t *b) {
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* Finds the items, or only counts them when f->offset is NULL. header.c has checked them already: false only
 * if the file has changed since. */
static bool find_items(iso_dicom_pixels *f) {
    size_t at = 0, end = (size_t)f->file->pixel_bytes;
    for (f->items = 0; end - at >= 8; f->items++) {
        uint32_t tag = little32(f->bytes + at), length = little32(f->bytes + at + 4);
        if (tag == 0xe0ddfffe) return f->items > 0;
        if (tag != 0xe000fffe || length > end - at - 8) return false;
        if (f->offset) {
            f->offset[f->items] = at + 8;
            f->length[f->items] = length;
        }
        at += 8 + (size_t)length;
    }
    return false;
}

static iso_status load_items(iso_dicom_pixels *f, iso_error *error) {
    const iso_dicom_file *file = f->file;
    f->bytes = iso_alloc((size_t)file->pixel_bytes);
    if (!f->bytes) return iso_fail_memory(error, file->path);
    if (fread(f->bytes, 1, (size_t)file->pixel_bytes, f->stream) != file->pixel_bytes || !find_items(f))
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", file->path);
    f->offset = malloc(f->items * sizeof *f->offset);
    f->length = malloc(f->items * sizeof *f->length);
    if (!f->offset || !f->length) return iso_fail_memory(error, file->path);
    find_items(f);
    return ISO_OK;
}

iso_status iso_dicom_pixels_open(const iso_dicom_file *file, iso_dicom_pixels *f, iso_error *error) {
    iso_dicom_pixels_close(f);
    f->file = file;
    ISO_TRY(iso_file_open(file->path, &f->stream, NULL, error));
    if (fseeko(f->stream, (off_t)file->pixel_offset, SEEK_SET) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path, strerror(errno));
    return file->encapsulated ? load_items(f, error) : ISO_OK;
}

/* Finds the items of a frame: all when there is one frame, one for each when there are as many as frames,
 * else by the offset table, which is item 0 (PS3.5, A.4). */
static bool items_of(const iso_dicom_pixels *f, int frame, size_t *first, size_t *count) {
    size_t fragments = f->items - 1, frames = (size_t)f->file->frame_count;
    *first = 1;
    *count = fragments;
    if (frames == 1) return fragments > 0;
    *first = 1 + (size_t)frame;
    *count = 1;
    if (fragments == frames) return true;
    if (f->length[0] != 4 * frames) return false;
    const uint8_t *table = f->bytes + f->offset[0];
    size_t base = f->offset[0] + f->length[0], begin = base + little32(table + 4 * (size_t)frame), end = 0;
    end = (size_t)frame + 1 < frames ? base + little32(table + 4 * ((size_t)frame + 1)) : SIZE_MAX;
    *first = *count = 0;
    for (size_t i = 1; i < f->items; i++) {
        size_t tag_at = f->offset[i] - 8;
        if (tag_at < begin || tag_at >= end) continue;
        if (*count == 0) *first = i;
        ++*count;
    }
    return *count > 0;
}

static iso_status read_encapsulated(const iso_dicom_pixels *f, int frame, void *pixels,
                                    char warning[ISO_DICOM_WARNING], iso_error *error) {
    size_t first, count;
    if (!items_of(f, frame, &first, &count))
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: the pixels of frame %d cannot be found",
                        f->file->path, frame + 1);
    /* GDCM gets the items of the frame, without the offset table */
    const iso_dicom_items items = {f->bytes, f->offset + first, f->length + first, count};
    const iso_module *gdcm = NULL; /* once it is loaded, this takes microseconds */
    ISO_TRY(iso_module_load(f->file->path, "dicom", "GDCM", &gdcm, error));
    return gdcm->dicom_decode(f->file, &items, pixels, warning, error);
}

/* Reads a frame of bits, of which the lowest of a byte comes first; frames follow each other without gaps. */
static iso_status read_bits(const iso_dicom_pixels *f, int frame, uint8_t *pixels, iso_error *error) {
    const uint64_t count = iso_dicom_frame_bytes(f->file), first = count * (uint64_t)frame;
    int byte = 0;
    if (fseeko(f->stream, (off_t)(f->file->pixel_offset + first / 8), SEEK_SET) != 0) byte = EOF;
    for (uint64_t i = 0; i < count && byte != EOF; i++) {
        const uint64_t bit = first + i;
        if (i == 0 || bit % 8 == 0) byte = getc_unlocked(f->stream);
        pixels[i] = (uint8_t)(byte >> bit % 8 & 1);
    }
    return byte == EOF
               ? iso_fail(error, ISO_ERR_IO, "%s: cannot read: the file ends too early", f->file->path)
               : ISO_OK;
}

static iso_status read_native(const iso_dicom_pixels *f, int frame, void *pixels, iso_error *error) {
    if (f->file->bits_allocated == 1) return read_bits(f, frame, pixels, error);
    uint64_t bytes = iso_dicom_frame_bytes(f->file);
    off_t at = (off_t)(f->file->pixel_offset + bytes * (uint64_t)frame);
    if (fseeko(f->stream, at, SEEK_SET) != 0 || fread(pixels, 1, (size_t)bytes, f->stream) != bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: the file ends too early", f->file->path);
    return ISO_OK;
}

iso_status iso_dicom_pixels_read(const iso_dicom_pixels *f, int frame, void *pixels,
                                 char warning[ISO_DICOM_WARNING], iso_error *error) {
    *warning = 0;
    return f->file->encapsulated ? read_encapsulated(f, frame, pixels, warning, error)
                                 : read_native(f, frame, pixels, error);
}
