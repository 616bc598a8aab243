/* dicom: what the parts of the DICOM reader share.
 *
 * header.c reads a file's header, stack.c orders image planes into a volume, decode.cc
 * hands compressed pixels to GDCM (it is a module), format_dicom.c puts them together. The header is not left
 * to GDCM because that library asserts where a file is cut off or corrupt, which would end the program. */
#ifndef ISO_GRIDS_VOLUME_DICOM_DICOM_H
#define ISO_GRIDS_VOLUME_DICOM_DICOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "grids/volume/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One image plane: a file, or a frame of a multi-frame file. Millimetres, LPS. */
typedef struct iso_dicom_frame {
    size_t file; /* which of the files it is in */
    int index;   /* which frame of the file */
    bool has_position, has_orientation, has_number;
    double position[3];        /* centre of the first pixel */
    double orientation[6];     /* direction of increasing column, then of increasing row; unit */
    double pixel[2];           /* between rows (y), then between columns (x), as in the file; 0: not stated */
    double between, thickness; /* of slices; 0: not stated */
    double slope, intercept;
    long number;   /* instance number, or the frame's */
    long phase[3]; /* temporal position, acquisition, echo: several planes at one place differ in these; -1 */
    double at;     /* position along the normal, filled by iso_dicom_stack */
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

/* What a file turned out to be. */
typedef enum iso_dicom_kind { ISO_DICOM_NOT, ISO_DICOM_NO_IMAGE, ISO_DICOM_IMAGE } iso_dicom_kind;

/* Reads the header of `path`. For images *file is filled (iso_dicom_file_free), otherwise untouched. A DICOM
 * file that is cut off or corrupt is ISO_ERR_IO, one with a transfer syntax that is not known
 * ISO_ERR_FORMAT; `path` is copied. */
iso_status iso_dicom_file_read(const char *path, iso_dicom_file *file, iso_dicom_kind *kind,
                               iso_error *error);
void iso_dicom_file_free(iso_dicom_file *file);

/* Bytes of one frame, uncompressed. */
uint64_t iso_dicom_frame_bytes(const iso_dicom_file *file);

/* Sorts the planes by their position along the slice normal, drops those of later acquisitions at the same
 * places (then *count shrinks), and fills info's transform, dims[2], anatomical and notes. All have one size
 * and orientation. `files` names them. ISO_ERR_FORMAT when a slice is missing, doubled or out of line: no
 * volume is made up. */
iso_status iso_dicom_stack(const char *path, const iso_dicom_file *files, iso_dicom_frame *frames,
                           size_t *count, iso_volume_info *info, iso_error *error);

/* The encapsulated pixels of a file, in memory: item i is bytes[offset[i]] .. + length[i]; item 0 is the
 * offset table. */
typedef struct iso_dicom_items {
    const uint8_t *bytes;
    const size_t *offset, *length;
    size_t count;
} iso_dicom_items;

/* Whether a frame's compressed bytes announce an image of the file's size and depth. */
bool iso_dicom_codestream_fits(const iso_dicom_file *file, const uint8_t *bytes, size_t length);

/* Decodes one frame from `items` (those of this frame only) into `pixels`, iso_dicom_frame_bytes of it in
 * native byte order. ISO_ERR_IO when GDCM cannot. The decoder is a module's (grids/volume/module.h). */
typedef iso_status iso_dicom_decoder(const iso_dicom_file *file, const iso_dicom_items *items, void *pixels,
                                     iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
