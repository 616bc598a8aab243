/* Films: counts the pictures of a video. */
#include "scene/film.h"

#include <math.h>

#include "base/memory.h"
#include "image/video.h"

struct iso_film {
    iso_video *video;
    int steps, turns, made; /* numbers of pictures: of the steps, of the turn, and those that were added */
};

static int pictures_of(double seconds, double rate) {
    return (int)fmin(fmax(round(seconds * rate), 0), 1e7);
}

static iso_video_opts video_of(const iso_film_opts *opts) {
    return (iso_video_opts){
        .width = opts->width, .height = opts->height, .frame_rate = opts->frame_rate, .title = opts->title};
}

iso_status iso_film_check(const iso_film_opts *opts, iso_error *error) {
    const iso_video_opts video = video_of(opts);
    const int count =
        pictures_of(opts->seconds, opts->frame_rate) + pictures_of(opts->turn_seconds, opts->frame_rate);
    if (!iso_video_is_name(opts->path))
        return iso_fail(error, ISO_ERR_USAGE, "%s: videos are .mp4, .webm, .gif or .apng", opts->path);
    if (count < 2 || count > 1000000)
        return iso_fail(error, ISO_ERR_USAGE, "%s: a film of %d pictures: from 2 to a million are possible",
                        opts->path, count);
    return iso_video_check(opts->path, &video, error);
}

iso_status iso_film_create(const iso_film_opts *opts, iso_film **out, iso_error *error) {
    const iso_video_opts video = video_of(opts);
    ISO_TRY(iso_film_check(opts, error));
    iso_film *film = iso_alloc_zero(1, sizeof *film);
    if (!film) return iso_fail_memory(error, opts->path);
    film->steps = pictures_of(opts->seconds, opts->frame_rate);
    film->turns = pictures_of(opts->turn_seconds, opts->frame_rate);
    const iso_status status = iso_video_open(opts->path, &video, &film->video, error);
    if (status == ISO_OK)
        *out = film;
    else
        iso_free(film);
    return status;
}

iso_status iso_film_add(iso_film *film, const iso_image *image, iso_error *error) {
    film->made++;
    return iso_video_add(film->video, image, error);
}

bool iso_film_is_due(const iso_film *film, double done) {
    if (film->steps == 1) return film->made < 1 && done >= 1;
    return film->made < film->steps && done * (film->steps - 1) >= film->made;
}

bool iso_film_turn(const iso_film *film, const iso_camera *from, iso_camera *camera) {
    const int turned = film->made - film->steps;
    if (turned >= film->turns) return false;
    *camera = *from;
    iso_camera_orbit(camera, 360.0 * turned / film->turns, 0);
    return true;
}

iso_status iso_film_end(iso_film *film, bool keep, iso_error *error) {
    iso_status status = ISO_OK;
    if (!film) return ISO_OK;
    if (keep)
        status = iso_video_commit(film->video, error);
    else
        iso_video_abort(film->video);
    iso_free(film);
    return status;
}
