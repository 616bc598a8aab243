/* Time lapses: the strokes are drawn once more, with pictures in between. */
#include "apps/isosculpt/time_lapse.h"

#include "apps/isosculpt/viewport/viewport.h"

typedef struct lapse {
    const isosculpt_time_lapse *job;
    iso_session *session;
    isosculpt_viewport viewport;
    iso_film *film;
    size_t samples, drawn; /* of all strokes */
} lapse;

static iso_status add_picture(lapse *l, iso_error *error) {
    isosculpt_viewport *viewport = &l->viewport;
    ISO_TRY(isosculpt_viewport_draw(viewport, l->job->film.width, l->job->film.height, false, error));
    while (viewport->quality != ISOSCULPT_QUALITY_FINE) ISO_TRY(isosculpt_viewport_refine(viewport, error));
    return iso_film_add(l->film, &viewport->image, error);
}

static iso_status add_due(lapse *l, iso_error *error) {
    const double done = l->samples ? (double)l->drawn / (double)l->samples : 1;
    while (iso_film_is_due(l->film, done)) ISO_TRY(add_picture(l, error));
    return ISO_OK;
}

/* A stroke; a picture that is due at its last sample shows it ended. */
static iso_status draw_stroke(lapse *l, const iso_stroke *stroke, iso_error *error) {
    if (stroke->stamp && stroke->stamp != iso_session_stamp(l->session))
        ISO_TRY(iso_session_set_stamp(l->session, iso_stamp_share(stroke->stamp), error));
    ISO_TRY(iso_session_begin(l->session, &stroke->brush, &stroke->samples[0], NULL, error));
    l->drawn++;
    for (size_t i = 1; i < stroke->count; i++) {
        ISO_TRY(add_due(l, error));
        ISO_TRY(iso_session_sample(l->session, &stroke->samples[i], NULL, error));
        l->drawn++;
    }
    ISO_TRY(iso_session_end(l->session, error));
    return add_due(l, error);
}

static iso_status draw_strokes(lapse *l, iso_error *error) {
    const iso_stroke_list *strokes = l->job->strokes;
    for (size_t i = 0; i < strokes->count; i++)
        if (!iso_stroke_at(strokes, i)->muted) l->samples += iso_stroke_at(strokes, i)->count;
    ISO_TRY(add_due(l, error));
    for (size_t i = 0; i < strokes->count; i++)
        if (!iso_stroke_at(strokes, i)->muted) ISO_TRY(draw_stroke(l, iso_stroke_at(strokes, i), error));
    return ISO_OK;
}

static iso_status turn(lapse *l, iso_error *error) {
    const iso_camera from = l->viewport.camera;
    while (iso_film_turn(l->film, &from, &l->viewport.camera)) ISO_TRY(add_picture(l, error));
    return ISO_OK;
}

/* A camera that has room for the sculpture, from all sides if it turns. */
static iso_status place_camera(lapse *l, iso_error *error) {
    const isosculpt_time_lapse *job = l->job;
    isosculpt_viewport viewport = {0};
    iso_box box = isosculpt_viewport_bounds(&l->viewport);
    iso_status status = isosculpt_viewport_init(&viewport, job->result, job->pool, error);
    if (status == ISO_OK) {
        const iso_box made = isosculpt_viewport_bounds(&viewport);
        iso_box_add(&box, made.lo);
        iso_box_add(&box, made.hi);
        iso_camera_fit(&l->viewport.camera, &box, (double)job->film.width / job->film.height,
                       job->film.turn_seconds > 0 ? 36 : 1);
    }
    isosculpt_viewport_free(&viewport);
    return status;
}

static iso_status make(lapse *l, iso_error *error) {
    iso_hgrid *grid = iso_session_grid(l->session);
    ISO_TRY(isosculpt_viewport_init(&l->viewport, grid, l->job->pool, error));
    l->viewport.painted = iso_painted_make(iso_session_paint(l->session), grid, ISOSCULPT_SURFACE_COLOR);
    l->viewport.painted.log = iso_session_paint_log(l->session);
    ISO_TRY(place_camera(l, error));
    ISO_TRY(iso_film_create(&l->job->film, &l->film, error));
    ISO_TRY(draw_strokes(l, error));
    return turn(l, error);
}

iso_status isosculpt_time_lapse_write(const isosculpt_time_lapse *job, iso_error *error) {
    const iso_session_opts opts = {.pool = job->pool, .undo_memory = 1 << 20, .paint = job->paint};
    lapse l = {.job = job};
    ISO_TRY(iso_session_create(job->first, job->start, &opts, &l.session, error));
    iso_status status = make(&l, error);
    const iso_status ended = iso_film_end(l.film, status == ISO_OK, status == ISO_OK ? error : NULL);
    isosculpt_viewport_free(&l.viewport);
    iso_session_destroy(l.session);
    return status == ISO_OK ? ended : status;
}
