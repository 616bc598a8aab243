/* picture_file: finished pictures in files: with what stands over them and what the files tell of them,
 * alone or as those of a video, and their depths, normals and ids as EXR. */
#ifndef ISO_SCENE_PICTURE_FILE_H
#define ISO_SCENE_PICTURE_FILE_H

#include "image/annotate.h"
#include "image/exr.h"
#include "image/image_file.h"
#include "image/video.h"

/* What a file tells of its picture. Strings are borrowed; NULL, or 0: it does not. */
typedef struct iso_picture_facts {
    const char *software, *title, *command, *description;
    const char *scene; /* as JSON */
    double pixels_per_metre;
    bool sized;     /* pixels_per_metre is the size that was asked for, of SVG and PDF, too */
    iso_pool *pool; /* for compression; NULL: the calling thread */
} iso_picture_facts;

/* Whether this build can write files of these names; NULL: none. ISO_ERR_BACKEND, ISO_ERR_UNSUPPORTED. */
iso_status iso_picture_file_check(const char *image, const char *aov, iso_error *error);

/* Writes a picture with a drawing over it (NULL: none), as iso_image_file_write_drawing. */
iso_status iso_picture_file_write(const char *path, iso_image *image, const iso_drawing *over,
                                  const iso_picture_facts *facts, iso_error *error);

/* Adds a picture to a video, which the first one begins (*video is NULL then) and the `last` one ends.
 * frame_rate: pictures a second. Errors of iso_video_open, iso_video_add and iso_video_commit. */
iso_status iso_picture_file_add(const char *path, const iso_image *image, double frame_rate, bool transparent,
                                const iso_picture_facts *facts, bool last, iso_video **video,
                                iso_error *error);

/* Writes depths, normals and ids, seen by the camera. Errors of iso_exr_write. */
iso_status iso_picture_file_write_aov(const char *path, const iso_aov *aov, const iso_camera *camera,
                                      const iso_picture_facts *facts, iso_error *error);

#endif
