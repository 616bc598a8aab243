/* dicom: the types and functions of the DICOM reader.
 *
 * header.c reads the header of a file, folder.c those of a folder, stack.c orders image planes into a volume,
 * pixels.c reads pixels, codestream.c checks compressed ones, decode.cc (a module) decodes them with GDCM,
 * segmentation.c makes labels of segmentations (SEG), and format_dicom.c is the reader. Headers are not
 * parsed by GDCM because it asserts on truncated or corrupt files, which would end the program. */
#ifndef ISO_GRIDS_VOLUME_DICOM_DICOM_H
#define ISO_GRIDS_VOLUME_DICOM_DICOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "grids/volume/volume.h"

ISO_C_BEGIN

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
    double at;     /* position along the normal; set by stack.c, as what follows */
    size_t place;  /* number of this position, from 0 */
    int segment;   /* of segmentations: the number of what the frame is a mask of; 0: not stated */
    size_t acquisition; /* which of several planes at its place, from 0 */
} iso_dicom_frame;

/* What a segmentation states of one of its segments. */
typedef struct iso_dicom_segment {
    int number;
    char name[65];
    bool colored;
    uint16_t lab[3]; /* CIELab, 0 .. 65535: L 0 .. 100, a and b -128 .. 127 */
} iso_dicom_segment;

typedef struct iso_dicom_file {
    char *path;
    char instance[65]; /* unique to an image: two files with the same are copies; "": not stated */
    char syntax[65], series[65], description[65], modality[17], photometric[17];
    long series_number;
    int rows, columns, samples, bits_allocated, bits_stored, high_bit;
    bool is_signed, big_endian, encapsulated, has_lookup_table;
    bool has_pixels;
    uint64_t pixel_offset, pixel_bytes; /* native: the values; encapsulated: the items, delimiter included */
    bool has_position;                  /* one that holds for the whole file */
    double position[3];                 /* the same; mm, LPS */
    int frame_count;
    iso_dicom_frame *frames;
    char segmentation[17]; /* BINARY, FRACTIONAL or LABELMAP; empty: it is no segmentation */
    int whole_fraction;    /* FRACTIONAL: the value of a pixel that is in the segment as a whole */
    int padding;           /* LABELMAP: the value of the background beside 0; -1: not stated */
    iso_dicom_segment *segments;
    size_t segment_count, segment_room;
} iso_dicom_file;

/* Whether a file is no DICOM file, one without an image, an image, or a DICOMDIR: the list of the files on a
 * CD. */
typedef enum iso_dicom_kind {
    ISO_DICOM_NOT,
    ISO_DICOM_NO_IMAGE,
    ISO_DICOM_IMAGE,
    ISO_DICOM_DIRECTORY
} iso_dicom_kind;

/* Reads the header of a file. *file holds what was read of it, also when reading fails; always free it with
 * iso_dicom_file_free. ISO_ERR_IO: a truncated or corrupt DICOM file; ISO_ERR_FORMAT: one that cannot be
 * read, as of an unknown transfer syntax; ISO_ERR_NOMEM. */
iso_status iso_dicom_file_read(const char *path, iso_dicom_file *file, iso_dicom_kind *kind,
                               iso_error *error);
void iso_dicom_file_free(iso_dicom_file *file);

/* The size of one frame in bytes, uncompressed; a byte a pixel where the file has a bit. */
uint64_t iso_dicom_frame_bytes(const iso_dicom_file *file);

/* A DICOM file that cannot be read. */
typedef struct iso_dicom_damaged {
    iso_dicom_file file; /* what was read of it, without frames */
    char *reason;        /* the message, which begins with its path */
} iso_dicom_damaged;

/* The DICOM files of a folder. Free with iso_dicom_folder_free. */
typedef struct iso_dicom_folder {
    iso_file_set *read; /* borrowed, set by the caller: all DICOM files that are opened are added, also those
                           without an image and damaged ones; NULL is fine */
    const char *path;   /* borrowed */
    iso_dicom_file *files; /* the images, by path */
    size_t count, room;
    iso_dicom_damaged *damaged;
    size_t damaged_count, damaged_room;
    size_t strays, imageless; /* files that are not DICOM; DICOM files without an image */
    char *first_left_out;     /* path and reason of the first of these; NULL: none */
    bool has_directory;       /* a DICOMDIR */
    bool descended;           /* the images are those of subfolders */
} iso_dicom_folder;

/* Reads the headers of all files in a folder. *folder is zero but for `read`. Files that are not DICOM or
 * damaged are only counted. `subfolders`: where the folder has no image itself, or a DICOMDIR as a CD has,
 * those in its subfolders are read, too. ISO_ERR_IO: the folder cannot be read; ISO_ERR_FORMAT: too many
 * files in subfolders; ISO_ERR_NOMEM. */
iso_status iso_dicom_folder_read(const char *path, bool subfolders, iso_dicom_folder *folder,
                                 iso_error *error);

/* Adds one file, in the same way. */
iso_status iso_dicom_folder_add(iso_dicom_folder *folder, const char *path, iso_error *error);
void iso_dicom_folder_free(iso_dicom_folder *folder);

/* The path of a file relative to the folder; `path` itself where it is not in the folder. */
const char *iso_dicom_folder_name(const char *folder, const char *path);

/* Says how many files are left out, and why the first one is: a damaged one if there is any. Returns false
 * if there is none. */
bool iso_dicom_folder_left_out(const iso_dicom_folder *folder, char text[ISO_VOLUME_TEXT]);

/* Which planes become the volume. */
typedef struct iso_dicom_wanted {
    const char *path, *folder; /* for messages: of the input, and of the folder */
    const iso_dicom_file *files;
    size_t named;       /* number of the file whose acquisition is wanted; SIZE_MAX: none was named */
    size_t series;      /* the number of the series, from 1, for messages */
    size_t acquisition; /* which of several, from 1; 0: the default */
} iso_dicom_wanted;

/* Sorts the planes, which have the same size and orientation, by their positions along the slice normal.
 * Leaves out copies of images. Where several lie at the same place, divides them into acquisitions, keeps one
 * of these and reduces *count. Sets info's transform, dims[2], anatomical and notes. ISO_ERR_FORMAT: a slice
 * is missing, duplicate or out of line; ISO_ERR_USAGE: no such acquisition. */
iso_status iso_dicom_stack(const iso_dicom_wanted *wanted, iso_dicom_frame *frames, size_t *count,
                           iso_volume_info *info, iso_error *error);

/* Finds the places of the frames of a segmentation, which may leave out slices in which there is nothing of a
 * segment, and sorts the frames by place and segment. Sets info's dims, transform, type, sizes and notes.
 * ISO_ERR_FORMAT: a frame states no place or no segment, or places are not evenly spaced. */
iso_status iso_dicom_segmentation_order(const char *path, iso_dicom_file *file, iso_volume_info *info,
                                        iso_error *error);
/* Makes a volume of its segments' numbers, 0: background; where segments overlap, of the greatest one. */
iso_status iso_dicom_segmentation_read(const char *path, const iso_volume_opts *opts,
                                       const iso_dicom_file *file, iso_volume_info *info, iso_rgrid *grid,
                                       iso_error *error);

/* How many acquisitions lie at the same places; *slices: how many planes the largest has. 1: one, or they
 * cannot be told apart. Reorders the planes. */
size_t iso_dicom_count_acquisitions(const iso_dicom_wanted *wanted, iso_dicom_frame *frames, size_t count,
                                    size_t *slices);

/* The encapsulated pixels of a file in memory: item i is length[i] bytes from bytes[offset[i]]; item 0 is the
 * offset table. */
typedef struct iso_dicom_items {
    const uint8_t *bytes;
    const size_t *offset, *length;
    size_t count;
} iso_dicom_items;

/* Whether the header of a frame's compressed data states the size and depth of the file. */
bool iso_dicom_codestream_fits(const iso_dicom_file *file, const uint8_t *bytes, size_t length);

enum { ISO_DICOM_WARNING = 128 };

/* Decodes one frame from its items into `pixels`, which has iso_dicom_frame_bytes, in native byte order.
 * `warning` becomes what the codec complains of, although it decodes the frame; or empty. The decoder is in a
 * module (grids/volume/module.h). ISO_ERR_IO: GDCM cannot decode it. */
typedef iso_status iso_dicom_decoder(const iso_dicom_file *file, const iso_dicom_items *items, void *pixels,
                                     char warning[ISO_DICOM_WARNING], iso_error *error);

ISO_C_END
#endif
