/* video: pictures that follow each other, as one file: .mp4 (H.264), .webm (VP9), .gif and .apng, which loop.
 * The program ffmpeg encodes them while they are made: each goes to it through a socket, none to a file. The
 * file appears whole or not at all (base/file.h). A version of ffmpeg makes the same bytes of the same
 * pictures, for it always gets the same number of threads. One thread at a time. */
#ifndef ISO_IMAGE_VIDEO_H
#define ISO_IMAGE_VIDEO_H

#include "image/image.h"

typedef struct iso_video iso_video;

typedef struct iso_video_opts {
    int width, height;        /* of every picture, pixels */
    double frame_rate;        /* pictures a second */
    bool transparent;         /* pictures are not opaque */
    const char *title, *text; /* stored in the file, but for .gif and .apng; NULL: not */
} iso_video_opts;

/* Whether a video is written to a file of this name. */
bool iso_video_is_name(const char *path);

/* Checks what can be known before the first picture. ISO_ERR_USAGE: an .mp4 or .webm whose sides are odd, a
 * transparent .mp4 or .gif; ISO_ERR_BACKEND: ffmpeg is not there. */
iso_status iso_video_check(const char *path, const iso_video_opts *opts, iso_error *error);

/* Starts ffmpeg. End with iso_video_commit or iso_video_abort. Errors as iso_video_check; ISO_ERR_WRITE,
 * ISO_ERR_NOMEM. */
iso_status iso_video_open(const char *path, const iso_video_opts *opts, iso_video **video, iso_error *error);
/* Adds a picture. ISO_ERR_WRITE: ffmpeg has ended; the message has what it said. */
iso_status iso_video_add(iso_video *video, const iso_image *image, iso_error *error);
/* Waits for ffmpeg, and gives the file its name. The video is freed, also after a failure, after which no
 * file is left. ISO_ERR_WRITE; ISO_ERR_BACKEND: this ffmpeg has no such encoder. */
iso_status iso_video_commit(iso_video *video, iso_error *error);
/* Frees the video, and leaves no file; NULL is ignored. */
void iso_video_abort(iso_video *video);

#endif
