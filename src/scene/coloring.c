/* coloring: the numbers at a surface's points, their colours, and the samples of a gbuffer. */
#include "scene/coloring.h"

#include <stdlib.h>

#include "base/memory.h"
#include "grids/grid_curvature.h"

enum { BLOCK = 8 }; /* samples */

void iso_coloring_set_grid(iso_coloring *coloring, const iso_grid *grid) {
    coloring->grid = *grid;
    coloring->affine = iso_transform_affine(iso_grid_transform(grid));
}

/* The volume's value; NaN outside. */
static double volume_at(const iso_coloring *c, iso_vec3 place) {
    const iso_vec3 index = iso_affine_point_to_index(&c->affine, place);
    const double p[3] = {index.x, index.y, index.z}, border = 0.5 + 1e-9;
    for (int axis = 0; axis < 3; axis++)
        if (!(p[axis] >= -border && p[axis] <= iso_grid_dims(&c->grid)[axis] - 1 + border)) return NAN;
    return iso_grid_physical(&c->grid, iso_grid_sample(&c->grid, index));
}

double iso_coloring_number(const iso_coloring *c, const iso_colored_point *point, iso_nearby *nearby) {
    iso_rgb color;
    switch (c->source) {
    case ISO_COLOR_BY_VOLUME:
        if (c->vertices) return iso_vertex_field_at(c->vertices, point->place, nearby, &color);
        return volume_at(c, point->place);
    case ISO_COLOR_BY_CURVATURE:
        return iso_grid_mean_curvature(&c->grid, &c->affine,
                                       iso_affine_point_to_index(&c->affine, point->place));
    case ISO_COLOR_BY_DISTANCE:
        return iso_distance_at(c->distance, point->place, nearby);
    case ISO_COLOR_BY_DEPTH:
        return point->depth;
    case ISO_COLOR_BY_NORMAL:
        return NAN;
    }
    return NAN;
}

static uint8_t component(double normal) {
    const double share = (normal + 1) * 127.5 + 0.5;
    return (uint8_t)(share < 0 ? 0 : share > 255 ? 255 : share);
}

/* iso_surface_colors.at. */
static iso_rgb color_at(const void *context, const iso_colored_point *point, iso_nearby *nearby) {
    const iso_coloring *c = context;
    if (c->given.at) return c->given.at(c->given.context, point, nearby);
    if (c->vertices) {
        iso_rgb color;
        const double number = iso_vertex_field_at(c->vertices, point->place, nearby, &color);
        const bool own = iso_vertex_field_has_colors(c->vertices) && !isnan(number);
        return own ? color : iso_color_bar_at(&c->bar, number);
    }
    if (c->source == ISO_COLOR_BY_NORMAL)
        return (iso_rgb){component(point->normal.x), component(point->normal.y), component(point->normal.z)};
    return iso_color_bar_at(&c->bar, iso_coloring_number(c, point, nearby));
}

iso_surface_colors iso_coloring_colors(const iso_coloring *coloring) {
    return (iso_surface_colors){color_at, coloring};
}

/* ---- the gbuffer */

typedef struct painting {
    const iso_coloring *const *colorings;
    int count;
    const iso_view *view;
    iso_gbuffer *gbuffer;
} painting;

static void paint_sample(const painting *p, int x, int y, iso_nearby nearby[ISO_SURFACE_MAX]) {
    iso_gbuffer *gbuffer = p->gbuffer;
    const size_t at = (size_t)y * (size_t)gbuffer->width + (size_t)x;
    const int surface = gbuffer->surface[at];
    if (surface >= p->count || !p->colorings[surface]) return;
    const iso_colored_point point =
        iso_colored_point_at(p->view, x, y, (double)gbuffer->depth[at], iso_gbuffer_normal(gbuffer, at));
    const iso_rgb c = color_at(p->colorings[surface], &point, &nearby[surface]);
    gbuffer->color[at] =
        (uint32_t)c.r | (uint32_t)c.g << 8 | (uint32_t)c.b << 16 | ((uint32_t)surface + 1) << 24;
}

/* Goes through a row of blocks, of which each is small, so that samples that follow each other are near to
 * each other. */
static void paint_blocks(void *context, size_t index, int worker) {
    (void)worker;
    const painting *p = context;
    const int top = (int)index * BLOCK, width = p->gbuffer->width, height = p->gbuffer->height;
    iso_nearby nearby[ISO_SURFACE_MAX] = {{0}};
    for (int left = 0; left < width; left += BLOCK)
        for (int y = top; y < top + BLOCK && y < height; y++)
            for (int x = left; x < left + BLOCK && x < width; x++) paint_sample(p, x, y, nearby);
    for (int i = 0; i < p->count; i++) iso_nearby_free(&nearby[i]);
}

iso_status iso_colorings_paint(const iso_coloring *const *colorings, int count, const iso_view *view,
                               iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error) {
    painting p = {colorings, count < ISO_SURFACE_MAX ? count : ISO_SURFACE_MAX, view, gbuffer};
    bool any = false;
    for (int i = 0; i < p.count; i++) any |= colorings[i] != NULL;
    if (!any) return ISO_OK;
    ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    iso_parallel_for(pool, ((size_t)gbuffer->height + BLOCK - 1) / BLOCK, paint_blocks, &p);
    return ISO_OK;
}

/* ---- ranges */

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The range of signed numbers, which are sorted and become their absolute values: that of all but the 2 %
 * that are the largest, on both sides of 0 unless all but 2 % have one sign. */
static void set_signed_range(double *numbers, size_t count, iso_color_bar *bar) {
    const size_t few = (count - 1) / 50;
    const bool none_below = numbers[few] >= 0, none_above = numbers[count - 1 - few] <= 0;
    for (size_t i = 0; i < count; i++) numbers[i] = fabs(numbers[i]);
    qsort(numbers, count, sizeof *numbers, compare);
    const double most = numbers[count - 1 - few];
    bar->low = none_below ? 0 : -most;
    bar->high = none_above && !none_below ? 0 : most;
}

/* The middle of the numbers but for 2 % at each end. Returns how many numbers there are. */
static size_t set_range(double *numbers, size_t count, bool have_signs, iso_color_bar *bar) {
    size_t good = 0;
    for (size_t i = 0; i < count; i++)
        if (isfinite(numbers[i])) numbers[good++] = numbers[i];
    bar->low = 0;
    bar->high = 1;
    if (!good) return 0;
    qsort(numbers, good, sizeof *numbers, compare);
    const size_t low = (good - 1) / 50, high = good - 1 - low;
    bar->high = numbers[high];
    bar->low = numbers[low];
    if (have_signs) set_signed_range(numbers, good, bar);
    /* numbers that differ by rounding alone have one colour */
    if (bar->high - bar->low <= 1e-5 * fmax(fabs(bar->low), fabs(bar->high))) bar->low = bar->high;
    return good;
}

iso_colormap iso_coloring_usual_map(iso_color_source source, const iso_color_bar *bar) {
    const bool one_sided = bar->high > bar->low && (bar->low >= 0 || bar->high <= 0);
    return iso_color_source_is_signed(source) && !one_sided ? ISO_COLORMAP_COOLWARM : ISO_COLORMAP_VIRIDIS;
}

/* The numbers at every `step`-th vertex. */
typedef struct sampling {
    const iso_coloring *coloring;
    const iso_view *view;
    iso_affine affine;
    iso_vec3 *places; /* in index coordinates */
    double *numbers;
    size_t count;
} sampling;

enum { SAMPLES_PER_TASK = 256 };

static void sample_numbers(void *context, size_t index, int worker) {
    (void)worker;
    const sampling *s = context;
    const size_t first = index * SAMPLES_PER_TASK;
    iso_nearby nearby = {0};
    for (size_t i = first; i < first + SAMPLES_PER_TASK && i < s->count; i++) {
        const iso_vec3 place = iso_affine_point(&s->affine, s->places[i]);
        const iso_colored_point point = {.place = place,
                                         .depth = s->view ? iso_view_point(s->view, place).z : (double)NAN};
        s->numbers[i] = iso_coloring_number(s->coloring, &point, &nearby);
    }
    iso_nearby_free(&nearby);
}

/* Sets the places of every `step`-th vertex. */
static void take_places(const iso_mesh_view *mesh, size_t step, sampling *s) {
    size_t seen = 0;
    for (size_t i = 0; i < mesh->span_count; i++)
        for (size_t k = 0; k < mesh->spans[i].owned_count; k++, seen++)
            if (seen % step == 0)
                s->places[s->count++] = iso_brick_position(
                    mesh->spans[i].brick, mesh->vertices[mesh->spans[i].first_vertex + k].position);
}

iso_status iso_coloring_find_range(iso_coloring *coloring, const iso_mesh_view *mesh, const iso_view *view,
                                   iso_pool *pool, size_t *points, size_t *found, iso_error *error) {
    enum { MOST = 1 << 15 };
    const size_t vertices = iso_mesh_view_vertex_count(mesh), step = vertices / MOST + 1;
    sampling s = {.coloring = coloring, .view = view, .affine = iso_transform_affine(&mesh->transform)};
    if (coloring->source == ISO_COLOR_BY_NORMAL) return ISO_OK;
    s.places = iso_alloc((vertices / step + 1) * sizeof *s.places);
    s.numbers = iso_alloc((vertices / step + 1) * sizeof *s.numbers);
    iso_status status = ISO_OK;
    if (!s.places || !s.numbers)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for the range of colours");
    else {
        take_places(mesh, step, &s);
        iso_parallel_for(pool, (s.count + SAMPLES_PER_TASK - 1) / SAMPLES_PER_TASK, sample_numbers, &s);
        *points = s.count;
        *found = set_range(s.numbers, s.count, iso_color_source_is_signed(coloring->source), &coloring->bar);
    }
    iso_free(s.places);
    iso_free(s.numbers);
    return status;
}

iso_status iso_coloring_find_surface_range(iso_coloring *coloring, const iso_scene_surface *surface,
                                           const iso_view *view, size_t *points, size_t *found,
                                           iso_error *error) {
    const iso_mesh_opts opts = {.isovalue = surface->isovalue, .pool = surface->pool, .chunk = NULL};
    iso_mesh_set *made = NULL;
    if (!surface->mesh) ISO_TRY(iso_mesh_set_create(&surface->grid, &opts, &made, error));
    iso_status status = made ? iso_mesh_set_update(made, error) : ISO_OK;
    if (status == ISO_OK) {
        const iso_mesh_view mesh = iso_mesh_set_view(made ? made : surface->mesh);
        status = iso_coloring_find_range(coloring, &mesh, view, surface->pool, points, found, error);
    }
    iso_mesh_set_destroy(made);
    return status;
}

/* ---- meshes and points */

static void store_color(iso_rgb color, uint8_t to[3]) {
    to[0] = color.r, to[1] = color.g, to[2] = color.b;
}

typedef struct weld_coloring {
    const iso_coloring *coloring;
    iso_affine affine;
    iso_weld *weld;
} weld_coloring;

static void color_vertices(void *context, size_t index, int worker) {
    (void)worker;
    const weld_coloring *w = context;
    const size_t first = index * SAMPLES_PER_TASK;
    iso_nearby nearby = {0};
    for (size_t i = first; i < first + SAMPLES_PER_TASK && i < w->weld->vertex_count; i++) {
        const float *p = w->weld->vertices[i].position, *n = w->weld->vertices[i].normal;
        const iso_colored_point point = {
            .place = iso_affine_point(&w->affine, iso_vec3_make((double)p[0], (double)p[1], (double)p[2])),
            .normal = iso_affine_normal(&w->affine, iso_vec3_make((double)n[0], (double)n[1], (double)n[2])),
            .depth = (double)NAN};
        store_color(color_at(w->coloring, &point, &nearby), w->weld->colors[i]);
    }
    iso_nearby_free(&nearby);
}

iso_status iso_coloring_weld(const iso_coloring *coloring, const iso_transform *transform, iso_pool *pool,
                             iso_weld *weld, iso_error *error) {
    weld_coloring w = {coloring, iso_transform_affine(transform), weld};
    weld->colors = iso_alloc((weld->vertex_count + 1) * sizeof *weld->colors);
    if (!weld->colors)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu colours", weld->vertex_count);
    iso_parallel_for(pool, (weld->vertex_count + SAMPLES_PER_TASK - 1) / SAMPLES_PER_TASK, color_vertices,
                     &w);
    return ISO_OK;
}

typedef struct point_coloring {
    const iso_coloring *coloring;
    const iso_point_view *points;
    iso_affine affine;
    uint8_t (*colors)[3];
} point_coloring;

static void color_span(void *context, size_t index, int worker) {
    (void)worker;
    const point_coloring *c = context;
    const iso_point_span *span = &c->points->spans[index];
    iso_nearby nearby = {0};
    for (size_t i = span->first; i < span->first + span->count; i++) {
        const iso_surfel surfel = iso_point_view_get(c->points, i);
        const float *n = surfel.normal;
        const iso_colored_point point = {
            .place = iso_affine_point(&c->affine, iso_brick_position(span->brick, surfel.position)),
            .normal = iso_affine_normal(&c->affine, iso_vec3_make((double)n[0], (double)n[1], (double)n[2])),
            .depth = (double)NAN};
        store_color(color_at(c->coloring, &point, &nearby), c->colors[i]);
    }
    iso_nearby_free(&nearby);
}

iso_status iso_coloring_points(const iso_coloring *coloring, const iso_point_view *points, iso_pool *pool,
                               uint8_t (**colors)[3], iso_error *error) {
    point_coloring c = {coloring, points, iso_transform_affine(&points->transform), NULL};
    size_t end = 0;
    for (size_t s = 0; s < points->span_count; s++) {
        const size_t last = points->spans[s].first + points->spans[s].count;
        end = last > end ? last : end;
    }
    c.colors = iso_alloc((end + 1) * sizeof *c.colors);
    if (!c.colors) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu colours", end);
    iso_parallel_for(pool, points->span_count, color_span, &c);
    *colors = c.colors;
    return ISO_OK;
}
