/* film: a video of something that is made step by step and then turned: when a picture is due, and which side
 * it shows. */
#ifndef ISO_SCENE_FILM_H
#define ISO_SCENE_FILM_H

#include "image/camera.h"
#include "image/image.h"

typedef struct iso_film_opts {
    const char *path;    /* .mp4, .webm, .gif or .apng; borrowed for the call */
    int width, height;   /* pixels */
    double frame_rate;   /* pictures a second */
    double seconds;      /* of the steps; 0: there are none */
    double turn_seconds; /* of a full turn after them; 0: there is none */
    const char *title;   /* kept in the file; NULL: none */
} iso_film_opts;

typedef struct iso_film iso_film;

/* Checks what can be known before the first picture. ISO_ERR_USAGE: a name or size that is none of a video's,
 * a film of less than two pictures, or of more than a million; ISO_ERR_BACKEND: ffmpeg is not there. */
iso_status iso_film_check(const iso_film_opts *opts, iso_error *error);
/* Begins a film; end it with iso_film_end. Errors as iso_film_check; ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_film_create(const iso_film_opts *opts, iso_film **film, iso_error *error);
/* Adds a picture (iso_video_add). */
iso_status iso_film_add(iso_film *film, const iso_image *image, iso_error *error);
/* Whether a further picture is due when a part of all steps (0 to 1) is done: they are spread evenly. */
bool iso_film_is_due(const iso_film *film, double done);
/* After the steps: turns the camera of the film's last step to the side that the next picture shows; false:
 * the film is complete. */
bool iso_film_turn(const iso_film *film, const iso_camera *from, iso_camera *camera);
/* Ends the film: with `keep` the file appears whole; otherwise, and after a failure, there is none. NULL is
 * ignored. ISO_ERR_WRITE, ISO_ERR_BACKEND. */
iso_status iso_film_end(iso_film *film, bool keep, iso_error *error);

#endif
