/* key_file: key images in files (.isokeys): the pictures of the parts of a surface, which are merged into
 * the picture of the whole.
 *
 * The bytes, little-endian: "ISOKEYS\n", the version (uint32: 6), the number of bytes of the header
 * (uint32), the header, the keys, and the CRC-32C of everything before (uint32). The keys are runs of
 * pixels from the top left, row by row: the number of empty pixels (uint32), the number of pixels with a
 * key after them (uint32), and their keys (uint64). */
#ifndef ISO_IO_KEY_FILE_H
#define ISO_IO_KEY_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/geometry.h"
#include "image/image.h"
#include "isopoint.h"
#include "render/key_style.h"
#include "render/view/key_image.h"

enum { ISO_KEY_PARTS = 1000000 }; /* the most parts of a picture */

/* The texts of the picture's file: iso_png_text. */
enum { ISO_KEY_SOFTWARE, ISO_KEY_TITLE, ISO_KEY_COMMENT, ISO_KEY_DESCRIPTION, ISO_KEY_SCENE, ISO_KEY_TEXTS };

/* The surface that a part belongs to: equal in all parts of a picture, as the picture's style
 * (render/key_style.h). Zero-initialised: it is compared byte by byte. */
typedef struct iso_key_surface {
    int32_t dims[3]; /* of the volume, voxels */
    int32_t type;    /* iso_type */
    double scale, offset;
    iso_transform transform;
    double isovalue;
    uint64_t primitives; /* crossed cells, or points, of the whole surface */
    iso_box bounds;      /* of the whole surface in the world, mm */
} iso_key_surface;

typedef struct iso_key_file {
    int part, parts; /* part 1 .. parts */
    iso_key_surface surface;
    iso_key_style style;
    char *texts[ISO_KEY_TEXTS]; /* owned; NULL: none. Equal in all parts, too */
    iso_key_image keys;         /* owned; of the picture's size, with caps in planes, or of the base's */
} iso_key_file;

void iso_key_file_free(iso_key_file *file);

/* Writes a file that appears whole or not at all (base/file.h). ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_key_file_write(const char *path, const iso_key_file *file, iso_error *error);

/* Reads a file; messages begin with the path. max_memory: bytes that the key image may take, 0: no limit.
 * ISO_ERR_IO (missing, truncated, damaged), ISO_ERR_FORMAT (not such a file), ISO_ERR_UNSUPPORTED (another
 * version), ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_key_file_read(const char *path, uint64_t max_memory, iso_key_file *file, iso_error *error);

/* Reads all parts of a picture, in any order, and merges them into `merged`, whose `part` is that of the
 * first file, and whose caps have been joined (iso_key_image_join_caps). ISO_ERR_FORMAT: a part is missing or
 * there twice, or is a part of another surface or picture; the message names the file. Other errors as
 * iso_key_file_read. `pool` may be NULL. */
iso_status iso_key_files_merge(const char *const *paths, int count, uint64_t max_memory, iso_pool *pool,
                               iso_key_file *merged, iso_error *error);

#endif
