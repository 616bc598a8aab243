/* dicom: the types and functions of the DICOM reader.
 *
 * header.c reads the header of a file, stack.c orders image planes into a volume, codestream.c checks
 * compressed pixels, decode.cc (a module) decodes them with GDCM, and format_dicom.c is the reader. Headers
 * are not parsed by GDCM because it asserts on truncated or corrupt files, which would end the program. */
#ifndef ISO_GRIDS_VOLUME_DICOM_DICOM_H
#define ISO_GRIDS_VOLUME_DICOM_DICOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "grids/volume/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One image plane: a file, or one frame of a multi-frame file ("frame" is DICOM's word). Millimetres, LPS. */
typedef struct iso_dicom_frame {
    size_t file; /* index of its file */
    int index;   /* of the frame in the file */
    bool has_position, has_orientation, has_number;
    double position[3];        /* centre of the first pixel */
    double orientation[6];     /* direction of increasing column, then of increasing row; unit */
    double pixel[2];           /* between rows (y), then between columns (x), as in the file; 0: not stated */
    double between, thickness; /* of slices; 0: not stated */
    double slope, intercept;
    long number;   /* instance number, or the frame's */
    long phase[3]; /* temporal position, acquisition, echo: several planes at one place differ in these; -1 */
    double at;     /* position along the normal; set by iso_dicom_stack */
} iso_dicom_frame;

typedef struct iso_dicom_file {
    char *path;
    char syntax[65], series[65], description[65], modality[17], photometric[17];
    long series_number;
    int rows, columns, samples, bits_allocated, bits_stored, high_bit;
    bool is_signed, big_endian, encapsulated, has_lookup_table;
    bool has_pixels;
    uint64_t pixel_offset, pixel_bytes; /* native: the values; encapsulated: the items, delimiter included */
    int frame_count;
    iso_dicom_frame *frames;
} iso_dicom_file;

/* Whether a file is no DICOM file, one without an image, or an image. */
typedef enum iso_dicom_kind { ISO_DICOM_NOT, ISO_DICOM_NO_IMAGE, ISO_DICOM_IMAGE } iso_dicom_kind;

/* Reads the header of a file. For an image, *file is filled (free with iso_dicom_file_free; the path is
 * copied); otherwise it is unchanged. ISO_ERR_IO: a truncated or corrupt DICOM file; ISO_ERR_FORMAT: an
 * unknown transfer syntax; ISO_ERR_NOMEM. */
iso_status iso_dicom_file_read(const char *path, iso_dicom_file *file, iso_dicom_kind *kind,
                               iso_error *error);
void iso_dicom_file_free(iso_dicom_file *file);

/* The size of one frame in bytes, uncompressed. */
uint64_t iso_dicom_frame_bytes(const iso_dicom_file *file);

/* Sorts the planes, which have the same size and orientation, by their positions along the slice normal.
 * Drops those of later acquisitions at the same positions and reduces *count. Sets info's transform, dims[2],
 * anatomical and notes. ISO_ERR_FORMAT: a slice is missing, duplicate or out of line. */
iso_status iso_dicom_stack(const char *path, const iso_dicom_file *files, iso_dicom_frame *frames,
                           size_t *count, iso_volume_info *info, iso_error *error);

/* The encapsulated pixels of a file in memory: item i is length[i] bytes from bytes[offset[i]]; item 0 is the
 * offset table. */
typedef struct iso_dicom_items {
    const uint8_t *bytes;
    const size_t *offset, *length;
    size_t count;
} iso_dicom_items;

/* Whether the header of a frame's compressed data states the size and depth of the file. */
bool iso_dicom_codestream_fits(const iso_dicom_file *file, const uint8_t *bytes, size_t length);

/* Decodes one frame from its items into `pixels`, which has iso_dicom_frame_bytes, in native byte order. The
 * decoder is in a module (grids/volume/module.h). ISO_ERR_IO: GDCM cannot decode it. */
typedef iso_status iso_dicom_decoder(const iso_dicom_file *file, const iso_dicom_items *items, void *pixels,
                                     iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
