/* keys_picture: the picture that keys (render/view/key_image.h) make when all parts have been drawn and
 * merged. */
#ifndef ISO_SCENE_KEYS_PICTURE_H
#define ISO_SCENE_KEYS_PICTURE_H

#include "render/key_style.h"
#include "render/picture.h"

/* The keys of a whole picture. */
typedef struct iso_merged_keys {
    iso_method method;       /* exact, or pullpush by the box or the Gaussian reconstruction */
    iso_pullpush_base base;  /* of pullpush */
    iso_transform transform; /* of the volume */
    int32_t dims[3];         /* of the volume, voxels */
    iso_key_image *image;    /* borrowed */
} iso_merged_keys;

/* Makes the picture of opts->camera and opts->shading; the keys are those of its samples. opts->draw is not
 * used. Errors as iso_picture_render. */
iso_status iso_render_merged_keys(const iso_merged_keys *keys, const iso_picture_opts *opts, iso_image *image,
                                  size_t *covered, iso_error *error);

/* Makes the picture that a style describes, with its annotations. `transform`, `dims`: of the volume.
 * ISO_ERR_USAGE: the camera; ISO_ERR_EMPTY: no pixel has a key; errors as iso_picture_render. */
iso_status iso_render_key_style(const iso_key_style *style, const iso_transform *transform,
                                const int32_t dims[3], iso_key_image *image, iso_pool *pool,
                                iso_image *picture, iso_error *error);

/* Merges the parts of a picture in files (iso_key_files_merge) and writes the picture, with the texts that
 * they have of it. max_memory: bytes that the keys may take, 0: no limit. Errors as iso_key_files_merge,
 * iso_render_key_style and iso_picture_file_write. */
iso_status iso_keys_picture_write(const char *path, const char *const *parts, int count, uint64_t max_memory,
                                  iso_pool *pool, iso_error *error);

#endif
