/* isopoint_parts: the chapter of isopoint.h about pictures that are drawn in parts, by several processes or
 * of volumes that are larger than memory. isopoint.h includes it; what that file says of units, errors,
 * ownership and threads holds here too. */
#ifndef ISOPOINT_PARTS_H
#define ISOPOINT_PARTS_H

#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The picture of an opaque surface that is drawn in parts, in any order, by any number of processes: a pixel
 * is a key of 64 bits, of which the smallest stays. With all parts it has the bytes of iso_render. */
typedef struct iso_keys iso_keys;

/* The picture, the same for all parts. */
typedef struct iso_keys_opts {
    int dims[3];                    /* of the whole volume, voxels */
    const iso_transform *transform; /* of the whole; NULL: spacing 1, origin 0 */
    double isovalue;
    iso_method method;                 /* EXACT, PULLPUSH or PULLPUSH_BOX */
    int width, height;                 /* pixels; 0 means 1024 */
    int samples;                       /* as of iso_render_opts */
    const iso_camera *camera;          /* not NULL */
    const iso_rgb *color, *background; /* NULL: the palette's first; white */
    bool transparent;
    int threads; /* as of iso_open_opts */
} iso_keys_opts;

/* Creates a picture without parts (ISO_ERR_USAGE: an option is out of range); frees it (NULL is fine). */
ISO_API iso_status iso_keys_create(const iso_keys_opts *opts, iso_keys **keys, iso_error *error);
ISO_API void iso_keys_destroy(iso_keys *keys);

/* The voxels first .. end - 1 of the whole, with the cells that begin there. A part begins at a multiple of
 * 16 and ends at one or with the whole (`end` 0). Its volume, which is dense, has the voxel before it and
 * the two after it on each axis, as far as the whole has them. */
typedef struct iso_keys_part {
    iso_volume *volume;
    int origin[3]; /* the voxel of the whole that is voxel (0, 0, 0) of the volume */
    int first[3], end[3];
} iso_keys_part;

/* Pull-push must know the extent of the whole: survey all parts before the first is drawn. Processes reduce
 * the ISO_KEYS_SURVEY numbers that iso_keys_surveyed returns by the minimum (MPI_MIN). */
enum { ISO_KEYS_SURVEY = 9 };
ISO_API iso_status iso_keys_survey(iso_keys *keys, const iso_keys_part *part, iso_error *error);
ISO_API double *iso_keys_surveyed(iso_keys *keys);
/* Draws a part; an empty one is fine. ISO_ERR_USAGE: the volume lacks voxels of the part, or pull-push meets
 * voxels that are not finite; ISO_ERR_EMPTY: the survey found no surface. */
ISO_API iso_status iso_keys_draw(iso_keys *keys, const iso_keys_part *part, iso_error *error);
/* Gives access to the pixels, which processes reduce by the minimum of uint64. Errors as iso_keys_draw. */
ISO_API iso_status iso_keys_pixels(iso_keys *keys, uint64_t **pixels, size_t *count, iso_error *error);
/* Adds what `other` shows. ISO_ERR_MISMATCH: it is another picture. */
ISO_API iso_status iso_keys_merge(iso_keys *keys, const iso_keys *other, iso_error *error);
/* Makes the picture; `image` as of iso_render. ISO_ERR_EMPTY: nothing is in view. */
ISO_API iso_status iso_keys_show(const iso_keys *keys, iso_image *image, iso_error *error);
/* Write a file of part `part` (from 1) of `parts`, for isorender merge; read and merge the files of all
 * parts (max_memory, threads: as of iso_open_opts). ISO_ERR_FORMAT: a part is missing, there twice, or of
 * another picture; ISO_ERR_IO, ISO_ERR_WRITE, ISO_ERR_LIMIT. */
ISO_API iso_status iso_keys_write(const iso_keys *keys, int part, int parts, const char *path,
                                  iso_error *error);
ISO_API iso_status iso_keys_read(const char *const *paths, int count, uint64_t max_memory, int threads,
                                 iso_keys **keys, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
