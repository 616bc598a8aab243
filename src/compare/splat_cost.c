/* splat_cost: divides points into groups and times frames of them (Zhang and Pajarola 2006, tables 1 and
 * 2). */
#include "compare/splat_cost.h"

#include <math.h>

#include "base/clock.h"

const double ISO_SPLAT_COST_OVERLAP[ISO_SPLAT_COST_OVERLAPS] = {1.0, 0.8, 0.6, 0.4};

static iso_status draw_frames(const iso_scene_surface *surface, iso_method method, const iso_view *view,
                              const iso_study_look *look, iso_study_frame *frame, double *seconds,
                              iso_error *error) {
    enum { FRAMES = 3 };
    const iso_renderer *renderer = iso_renderer_get(method);
    double times[FRAMES];
    ISO_TRY(iso_study_draw(surface, renderer, view, look, frame, error)); /* touches memory the first time */
    for (int i = 0; i < FRAMES; i++) {
        const double start = iso_clock_seconds();
        ISO_TRY(iso_study_draw(surface, renderer, view, look, frame, error));
        times[i] = iso_clock_seconds() - start;
    }
    *seconds = iso_study_median(times, FRAMES);
    return ISO_OK;
}

/* Times frames; the time is NaN when the memory limit leaves no room for the slots. */
static iso_status time_frames(const iso_scene_surface *surface, iso_method method, const iso_view *view,
                              const iso_study_look *look, iso_study_frame *frame, double *seconds,
                              iso_error *error) {
    iso_error detail = {0};
    *seconds = NAN;
    const iso_status status = draw_frames(surface, method, view, look, frame, seconds, &detail);
    if (status == ISO_OK || status == ISO_ERR_NOMEM || status == ISO_ERR_LIMIT) return ISO_OK;
    return iso_fail(error, status, "%s", detail.text);
}

static iso_status make_groups(const iso_scene_surface *surface, double overlap, iso_groups *groups,
                              iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(surface);
    const iso_groups_opts opts = {.disc = ISO_GROUPS_DISC, .overlap = overlap, .pool = surface->pool};
    return iso_groups_make(&points, &opts, groups, error);
}

static iso_status measure_overlap(const iso_scene_surface *surface, int row, const iso_view *view,
                                  const iso_study_look *look, iso_study_frame *frame, iso_splat_cost *cost,
                                  iso_error *error) {
    const iso_point_view points = iso_scene_surface_points(surface);
    const size_t count = iso_point_view_count(&points);
    iso_scene_surface grouped = *surface;
    grouped.groups = (iso_groups){0};
    const double start = iso_clock_seconds();
    iso_status status = make_groups(surface, ISO_SPLAT_COST_OVERLAP[row], &grouped.groups, error);
    cost->rows[row].grouping = iso_clock_seconds() - start;
    cost->rows[row].groups = grouped.groups.count;
    cost->rows[row].mean_degree = count ? 2 * (double)grouped.groups.joined / (double)count : 0;
    if (status == ISO_OK)
        status = time_frames(&grouped, ISO_METHOD_SPLATS, view, look, frame, &cost->rows[row].frame, error);
    iso_groups_free(&grouped.groups);
    return status;
}

iso_status iso_study_splats(const iso_scene_surface *surface, const iso_view *view,
                            const iso_study_look *look, iso_splat_cost *cost, iso_error *error) {
    iso_study_look single = *look;
    iso_study_frame frame = {0};
    single.samples = 1;
    *cost = (iso_splat_cost){.ungrouped = 0};
    ISO_TRY(iso_study_frame_create(view->width, false, &frame, error));
    iso_status status =
        time_frames(surface, ISO_METHOD_SPLATS_FLAT, view, &single, &frame, &cost->ungrouped, error);
    for (int row = 0; row < ISO_SPLAT_COST_OVERLAPS && status == ISO_OK; row++)
        status = measure_overlap(surface, row, view, &single, &frame, cost, error);
    iso_study_frame_free(&frame);
    return status;
}
