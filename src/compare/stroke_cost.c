/* stroke_cost: plays a stroke file and times each sample. */
#include "compare/stroke_cost.h"

#include "base/clock.h"
#include "base/memory.h"

enum { MOST_FRAMES = 50 };

/* Times of one kind. */
typedef struct time_list {
    double *seconds;
    size_t count;
} time_list;

typedef struct player {
    iso_strokes strokes;
    iso_scene_surface surface; /* of the session's grid; draws `points` */
    iso_point_set *points;     /* what the paper draws, as in cost.c */
    iso_point_view given;
    const iso_study_ball *ball;
    const iso_study_look *look;
    int side;
    iso_study_frame frame;
    size_t samples, step; /* every `step`th sample is drawn */
    time_list edit, update[ISO_PART_COUNT], draw[ISO_COST_METHODS];
} player;

static bool is_sample(const iso_event *event) {
    return event->kind <= ISO_EVENT_SAMPLE;
}

/* Counts strokes and samples without playing them. */
static iso_status count_events(const char *path, iso_stroke_cost *cost, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    iso_event event;
    bool more = true;
    ISO_TRY(iso_journal_open(path, &start, &reader, error));
    iso_status status = ISO_OK;
    while (status == ISO_OK && more) {
        status = iso_journal_next(reader, &event, &more, error);
        cost->strokes += status == ISO_OK && more && event.kind == ISO_EVENT_BEGIN;
        cost->samples += status == ISO_OK && more && is_sample(&event);
    }
    iso_journal_reader_free(reader);
    return status;
}

static iso_status reserve(time_list *list, size_t count, iso_error *error) {
    list->seconds = iso_alloc(count * sizeof *list->seconds);
    return list->seconds ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

static void add_time(time_list *list, double start) {
    list->seconds[list->count++] = iso_clock_seconds() - start;
}

/* Whether a method that is measured draws from a part. */
static bool is_needed(int part) {
    for (int m = 0; m < ISO_COST_METHODS; m++)
        if (iso_cost_method(m)->needs & 1u << part) return true;
    return false;
}

static iso_status update_part(player *p, iso_part part, iso_error *error) {
    if (part != ISO_PART_POINTS) return iso_scene_surface_update(&p->surface, part, error);
    ISO_TRY(iso_point_set_update(p->points, error));
    p->given = iso_point_set_view(p->points);
    return ISO_OK;
}

/* Extracts what a sample changed, and draws it if it is its turn. */
static iso_status show_sample(player *p, bool draw, iso_error *error) {
    const iso_view view = iso_study_fit(p->ball, p->side, 0);
    for (int part = 0; part < ISO_PART_COUNT; part++) {
        if (!is_needed(part)) continue;
        const double start = iso_clock_seconds();
        ISO_TRY(update_part(p, (iso_part)part, error));
        add_time(&p->update[part], start);
    }
    for (int m = 0; draw && m < ISO_COST_METHODS; m++) {
        const double start = iso_clock_seconds();
        ISO_TRY(iso_study_draw(&p->surface, iso_cost_method(m), &view, p->look, &p->frame, error));
        add_time(&p->draw[m], start);
    }
    return ISO_OK;
}

static iso_status play(player *p, iso_error *error) {
    for (bool more = true; more;) {
        iso_event event;
        const double start = iso_clock_seconds();
        ISO_TRY(iso_strokes_next(&p->strokes, &event, &more, error));
        if (!more || !is_sample(&event)) continue;
        add_time(&p->edit, start);
        ISO_TRY(show_sample(p, p->samples++ % p->step == 0, error));
    }
    return ISO_OK;
}

static iso_status open_player(player *p, const char *path, const iso_source *how, size_t samples,
                              iso_grid *grid, iso_error *error) {
    ISO_TRY(reserve(&p->edit, samples, error));
    for (int part = 0; part < ISO_PART_COUNT; part++) ISO_TRY(reserve(&p->update[part], samples, error));
    for (int m = 0; m < ISO_COST_METHODS; m++) ISO_TRY(reserve(&p->draw[m], samples, error));
    ISO_TRY(iso_study_frame_create(p->side, false, &p->frame, error));
    ISO_TRY(iso_strokes_open(path, how, &p->strokes, error));
    grid->hgrid = iso_session_grid(p->strokes.session);
    p->surface.grid = *grid;
    p->surface.pool = how->pool;
    p->surface.given = &p->given;
    const iso_points_opts points = {.primitive = ISO_PRIMITIVE_AUTO, .pool = how->pool};
    ISO_TRY(iso_point_workspace_create(&p->surface.workspace, error));
    return iso_point_set_create(grid, &points, &p->points, error);
}

static void close_player(player *p) {
    iso_free(p->edit.seconds);
    for (int part = 0; part < ISO_PART_COUNT; part++) iso_free(p->update[part].seconds);
    for (int m = 0; m < ISO_COST_METHODS; m++) iso_free(p->draw[m].seconds);
    iso_study_frame_free(&p->frame);
    iso_point_set_destroy(p->points);
    iso_scene_surface_free(&p->surface);
    iso_strokes_close(&p->strokes);
}

iso_status iso_study_strokes(const char *path, const iso_source *how, const iso_study_ball *ball, int side,
                             const iso_study_look *look, iso_stroke_cost *cost, iso_error *error) {
    player p = {.ball = ball, .look = look, .side = side};
    iso_grid grid = {.hgrid = NULL};
    *cost = (iso_stroke_cost){.strokes = 0};
    ISO_TRY(count_events(path, cost, error));
    if (cost->samples == 0) return iso_fail(error, ISO_ERR_EMPTY, "the file has no strokes");
    p.step = (cost->samples - 1) / MOST_FRAMES + 1;
    iso_status status = open_player(&p, path, how, cost->samples, &grid, error);
    if (status == ISO_OK) status = play(&p, error);
    cost->frames = p.draw[0].count;
    cost->edit = iso_study_median(p.edit.seconds, p.edit.count);
    for (int m = 0; m < ISO_COST_METHODS; m++) {
        for (int part = 0; part < ISO_PART_COUNT; part++)
            if (iso_cost_method(m)->needs & 1u << part)
                cost->rows[m].update += iso_study_median(p.update[part].seconds, p.update[part].count);
        cost->rows[m].frame = iso_study_median(p.draw[m].seconds, p.draw[m].count);
    }
    close_player(&p);
    return status;
}
