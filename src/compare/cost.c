/* cost: times extraction and frames as Baerentzen and Christensen 2003, section 6. */
#include "compare/cost.h"

#include <math.h>

#include "base/clock.h"
#include "base/memory.h"
#include "grids/change_log.h"
#include "render/raster/triangle_strips.h"

const int ISO_COST_VIEWPORT[ISO_COST_VIEWPORTS] = {100, 200, 400, 800, 2048};

static const iso_method METHODS[ISO_COST_METHODS] = {ISO_METHOD_POINTS, ISO_METHOD_PULLPUSH, ISO_METHOD_MESH,
                                                     ISO_METHOD_EXACT};

enum { MOST_FRAMES = 200 };

const iso_renderer *iso_cost_method(int number) {
    return iso_renderer_get(METHODS[number]);
}

typedef struct measurement {
    iso_scene_surface surface; /* borrows the parts of the caller's, and draws `points` */
    iso_point_set *points;     /* what the paper draws: foot points of sparse level sets, else edge points */
    iso_point_view given;      /* of `points` */
    const iso_study_ball *ball;
    const iso_study_look *look;
    double run_seconds;
    int dirty;
    const iso_mesh_view *mesh; /* its spans name the bricks that the surface crosses */
    uint64_t seed;             /* of the pseudo-random numbers */
} measurement;

/* Returns the next pseudo-random number in [0, 1): a 64-bit linear congruential generator (Knuth, The Art
 * of Computer Programming 2, section 3.3.4). */
static double random_number(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Returns a direction, distributed evenly over the sphere. */
static iso_vec3 random_direction(uint64_t *seed) {
    double z = 2 * random_number(seed) - 1, sine, cosine;
    iso_sincos(2 * ISO_PI * random_number(seed), &sine, &cosine);
    double flat = sqrt(1 - z * z);
    return iso_vec3_make(flat * cosine, flat * sine, z);
}

/* ---- extraction ---- */

/* Returns the part that has the primitives of a method. */
static iso_part part_of(const iso_renderer *method) {
    for (int part = 0; part < ISO_PART_COUNT; part++)
        if (method->needs & 1u << part) return (iso_part)part;
    return ISO_PART_COUNT;
}

static iso_status create_points(const iso_scene_surface *surface, iso_point_set **points, iso_error *error) {
    const iso_points_opts opts = {
        .isovalue = surface->isovalue, .primitive = ISO_PRIMITIVE_AUTO, .pool = surface->pool};
    ISO_TRY(iso_point_set_create(&surface->grid, &opts, points, error));
    return iso_point_set_update(*points, error);
}

/* Extracts the primitives of a method from the beginning, and destroys them. */
static iso_status extract_once(const iso_scene_surface *surface, iso_part part, double *seconds,
                               iso_error *error) {
    iso_scene_surface fresh = {.grid = surface->grid, .isovalue = surface->isovalue, .pool = surface->pool};
    double start = iso_clock_seconds();
    iso_status status = part == ISO_PART_POINTS ? create_points(&fresh, &fresh.points, error)
                                                : iso_scene_surface_prepare(&fresh, part, error);
    *seconds = iso_clock_seconds() - start;
    iso_scene_surface_free(&fresh);
    return status;
}

static iso_status time_extraction(const iso_scene_surface *surface, iso_part part, double *seconds,
                                  iso_error *error) {
    double times[ISO_COST_RUNS];
    for (int run = 0; run < ISO_COST_RUNS; run++) ISO_TRY(extract_once(surface, part, &times[run], error));
    *seconds = iso_study_median(times, ISO_COST_RUNS);
    return ISO_OK;
}

/* Extracts what was edited. */
static iso_status update_part(measurement *m, iso_part part, iso_error *error) {
    if (part != ISO_PART_POINTS) return iso_scene_surface_update(&m->surface, part, error);
    ISO_TRY(iso_point_set_update(m->points, error));
    m->given = iso_point_set_view(m->points);
    return ISO_OK;
}

static iso_status measure_strips(const iso_mesh_view *mesh, double *share, iso_error *error) {
    iso_triangle_strips strips = {0};
    size_t indices = 0, triangles = 0;
    iso_status status = ISO_OK;
    for (size_t s = 0; s < mesh->span_count && status == ISO_OK; s++) {
        size_t count = 0;
        if (!mesh->spans[s].triangle_count) continue;
        status = iso_triangle_strips_make(&strips, mesh, &mesh->spans[s], &count, error);
        indices += count;
        triangles += mesh->spans[s].triangle_count;
    }
    iso_triangle_strips_free(&strips);
    *share = triangles ? (double)indices / (3 * (double)triangles) : NAN;
    return status;
}

/* ---- frames ---- */

/* Marks voxels in the middle of some bricks that the surface crosses as edited, so that just these bricks
 * are extracted again: voxels that neighbours read are not among them. */
static iso_status mark_bricks(measurement *m, iso_error *error) {
    iso_change_log *log = iso_grid_log(&m->surface.grid);
    const int *dims = iso_grid_dims(&m->surface.grid);
    iso_change_log_begin(log);
    for (int i = 0; i < m->dirty; i++) {
        size_t s = (size_t)(random_number(&m->seed) * (double)m->mesh->span_count);
        int lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            int first = m->mesh->spans[s].brick[axis] * ISO_BRICK, last = dims[axis] - 1;
            lo[axis] = first + 4 < last ? first + 4 : last;
            hi[axis] = first + 11 < last ? first + 11 : last;
        }
        ISO_TRY(iso_change_log_add(log, lo, hi, error));
    }
    return ISO_OK;
}

static iso_status draw_frame(measurement *m, const iso_renderer *method, int side, bool edit,
                             iso_study_frame *frame, double *seconds, iso_error *error) {
    const iso_view view = iso_study_fit_from(m->ball, side, random_direction(&m->seed));
    if (edit) ISO_TRY(mark_bricks(m, error));
    double start = iso_clock_seconds();
    if (edit) ISO_TRY(update_part(m, part_of(method), error));
    ISO_TRY(iso_study_draw(&m->surface, method, &view, m->look, frame, error));
    *seconds = iso_clock_seconds() - start;
    return ISO_OK;
}

static iso_status draw_runs(measurement *m, const iso_renderer *method, int side, bool edit,
                            iso_study_frame *frame, double *times, iso_cost_frame *cost, iso_error *error) {
    double unused;
    cost->best = INFINITY;
    cost->frames = 0;
    m->seed = 2003; /* every method is drawn from the same directions */
    ISO_TRY(draw_frame(m, method, side, edit, frame, &unused, error)); /* memory is touched the first time */
    for (int run = 0; run < ISO_COST_RUNS; run++) {
        double sum = 0;
        int count = 0;
        for (; count < 2 || (count < MOST_FRAMES && sum < m->run_seconds); count++) {
            double *time = &times[cost->frames++];
            ISO_TRY(draw_frame(m, method, side, edit, frame, time, error));
            sum += *time;
        }
        cost->best = fmin(cost->best, sum / count);
    }
    cost->median = iso_study_median(times, (size_t)cost->frames);
    return ISO_OK;
}

static iso_status allocate_and_draw(measurement *m, const iso_renderer *method, int side, bool edit,
                                    iso_cost_frame *cost, iso_error *error) {
    iso_study_frame frame = {0};
    double *times = iso_alloc(ISO_COST_RUNS * MOST_FRAMES * sizeof *times);
    iso_status status = times ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    /* A workspace of its own, which does not keep the memory of the largest pictures. */
    if (status == ISO_OK) status = iso_point_workspace_create(&m->surface.workspace, error);
    if (status == ISO_OK) status = iso_study_frame_create(side, false, &frame, error);
    if (status == ISO_OK) status = draw_runs(m, method, side, edit, &frame, times, cost, error);
    iso_point_workspace_destroy(m->surface.workspace);
    m->surface.workspace = NULL;
    iso_study_frame_free(&frame);
    iso_free(times);
    return status;
}

/* Times frames; pictures for which the memory limit leaves no room have no times. */
static iso_status time_frames(measurement *m, const iso_renderer *method, int side, bool edit,
                              iso_cost_frame *cost, iso_error *error) {
    iso_error detail = {0};
    iso_status status = allocate_and_draw(m, method, side, edit, cost, &detail);
    if (status == ISO_OK) return ISO_OK;
    if (status != ISO_ERR_NOMEM && status != ISO_ERR_LIMIT) return iso_fail(error, status, "%s", detail.text);
    *cost = (iso_cost_frame){.median = NAN, .best = NAN};
    return ISO_OK;
}

/* ---- all of it ---- */

static iso_status measure_method(measurement *m, int number, int side, iso_cost_row *row, iso_error *error) {
    const iso_renderer *method = iso_cost_method(number);
    const iso_part part = part_of(method);
    ISO_TRY(time_extraction(&m->surface, part, &row->generation, error));
    row->primitives = part == ISO_PART_POINTS ? iso_point_view_count(&m->given)
                                              : iso_scene_surface_size(&m->surface, part).primitives;
    ISO_TRY(time_frames(m, method, side, false, &row->still, error));
    for (int i = 0; i < ISO_COST_VIEWPORTS; i++)
        ISO_TRY(time_frames(m, method, ISO_COST_VIEWPORT[i], false, &row->viewport[i], error));
    return time_frames(m, method, side, true, &row->edited, error);
}

/* Copies the spans' bricks: the spans of the surface's mesh move when the mesh is updated. */
static iso_status copy_spans(const iso_mesh_view *from, iso_mesh_view *mesh, iso_mesh_span **copy,
                             iso_error *error) {
    *mesh = *from;
    *copy = iso_alloc(from->span_count * sizeof **copy);
    if (!*copy) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (size_t s = 0; s < from->span_count; s++) (*copy)[s] = from->spans[s];
    mesh->spans = *copy;
    return ISO_OK;
}

static iso_status measure_methods(measurement *m, iso_cost_study *study, iso_error *error) {
    ISO_TRY(create_points(&m->surface, &m->points, error));
    m->given = iso_point_set_view(m->points);
    m->surface.given = &m->given;
    for (int i = 0; i < ISO_COST_METHODS; i++)
        ISO_TRY(measure_method(m, i, study->side, &study->rows[i], error));
    return ISO_OK;
}

iso_status iso_study_cost(const iso_scene_surface *surface, const iso_study_ball *ball,
                          const iso_study_look *look, const iso_cost_opts *opts, iso_cost_study *study,
                          iso_error *error) {
    const iso_mesh_view now = iso_mesh_set_view(surface->mesh);
    iso_study_look single = *look;
    iso_mesh_view mesh;
    iso_mesh_span *spans = NULL;
    int bricks[3];
    iso_grid_bricks(&surface->grid, bricks);
    *study = (iso_cost_study){.side = opts->side ? opts->side : 800,
                              .dirty = opts->dirty ? opts->dirty : 4,
                              .bricks = (size_t)bricks[0] * (size_t)bricks[1] * (size_t)bricks[2],
                              .crossed = now.span_count};
    if (now.span_count == 0) return iso_fail(error, ISO_ERR_EMPTY, "the surface is empty");
    single.samples = 1;
    ISO_TRY(measure_strips(&now, &study->strips, error));
    ISO_TRY(copy_spans(&now, &mesh, &spans, error));
    measurement m = {.surface = *surface,
                     .ball = ball,
                     .look = &single,
                     .run_seconds = opts->seconds > 0 ? opts->seconds : 0.2,
                     .dirty = study->dirty,
                     .mesh = &mesh};
    m.surface.workspace = NULL;
    iso_status status = measure_methods(&m, study, error);
    iso_point_set_destroy(m.points);
    iso_free(spans);
    return status;
}
