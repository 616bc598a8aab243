/* banded_discs: projects points to discs, bounds discs in the picture, and lists the discs of bands of rows.
 */
#include "render/groups/banded_discs.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/numbers.h"
#include "render/groups/disc_hits.h"

enum { TASK_POINTS = 4096 }; /* number of points that one task projects */

/* A part of a span, with the results of projecting it. */
typedef struct chunk {
    const iso_point_span *span;
    size_t first; /* in the view's arrays */
    size_t disc;  /* number of its first disc */
    uint32_t count;
    float depth[2];
    iso_box box; /* around the positions of the points (without radii), in index coordinates */
} chunk;

typedef struct projection {
    iso_banded_discs *discs;
    const iso_point_view *points;
    iso_projector projector;
    iso_disc_box picture;
    float factor;
    chunk *chunks;
    size_t chunk_count;
} projection;

iso_disc_view iso_disc_view_make(const iso_view *view) {
    const float pixel = (float)(1 / view->focal);
    return (iso_disc_view){.slope = view->orthographic ? 0 : pixel,
                           .scale = view->orthographic ? pixel : 0,
                           .near = view->near < -FLT_MAX ? -FLT_MAX : (float)view->near,
                           .axis_x = view->cx,
                           .axis_y = view->cy,
                           .above = view->above};
}

/* ---- bounds */

/* Returns the pixels of `within` whose centres lie between lo and hi, in pixels from `axis`. */
static iso_rows pixels_between(double lo, double hi, double axis, iso_rows within) {
    const double slack = 0.01, first = ceil(lo + axis - 0.5 - slack), last = floor(hi + axis - 0.5 + slack);
    if (!(first <= within.last && last >= within.first)) return (iso_rows){0, -1};
    return (iso_rows){first > within.first ? (int)first : within.first,
                      last < within.last ? (int)last : within.last};
}

/* Returns half the width of a disc along an axis, given its normal's component on the axis. */
static double half_width(const iso_disc *disc, int axis) {
    const double n = (double)disc->normal[axis], square = 1 - n * n;
    return (double)disc->radius * (square > 0 ? sqrt(square) : 0) * 1.00001;
}

/* Returns the pixels that a disc may cover along an axis: those of its bounding box in perspective. */
static iso_rows pixels_along(const iso_disc_view *view, const iso_disc *disc, int axis, double pixel,
                             iso_rows within) {
    const double center = (double)(axis ? disc->y : disc->x), half = half_width(disc, axis),
                 deep = half_width(disc, 2), z = (double)disc->z,
                 near = iso_max(z - deep, (double)view->near);
    const double low = (double)ISO_DISC_LOW_PASS;
    double lo, hi;
    if (view->slope > 0) {
        const double at = center * z * (double)view->slope;
        lo = (at - half) / ((at - half < 0 ? near : z + deep) * (double)view->slope);
        hi = (at + half) / ((at + half > 0 ? near : z + deep) * (double)view->slope);
    } else {
        lo = center - half / (double)view->scale;
        hi = center + half / (double)view->scale;
    }
    return pixels_between(iso_min(lo, center - low), iso_max(hi, center + low), pixel, within);
}

iso_disc_box iso_disc_bounds(const iso_disc_view *view, const iso_disc *disc, const iso_disc_box *within) {
    return (iso_disc_box){pixels_along(view, disc, 0, view->axis_x, within->columns),
                          pixels_along(view, disc, 1, view->axis_y, within->rows)};
}

/* ---- hits */

void iso_disc_visit_hits(const iso_banded_discs *discs, const iso_disc *disc, const iso_disc_box *within,
                         iso_disc_visit_fn *visit, void *context) {
    iso_disc_hits_fn *find = ISO_KERNEL_UNIT(iso_disc_find_hits, iso_cpu_best());
    const iso_disc_box all = iso_disc_bounds(&discs->view, disc, within);
    iso_disc_hits hits;
    for (int y = all.rows.first; y <= all.rows.last; y += ISO_DISC_ROWS)
        for (int x = all.columns.first; x <= all.columns.last; x += ISO_DISC_COLUMNS) {
            const iso_disc_box box = {{x, iso_min_int(x + ISO_DISC_COLUMNS - 1, all.columns.last)},
                                      {y, iso_min_int(y + ISO_DISC_ROWS - 1, all.rows.last)}};
            float rows[ISO_DISC_ROWS];
            for (int row = box.rows.first; row <= box.rows.last; row++)
                rows[row - y] = iso_disc_row(&discs->view, row);
            const int count = find(&discs->view, disc, &box, discs->columns.data, rows, &hits);
            if (count > 0) visit(context, &hits, count);
        }
}

/* ---- projection */

/* Computes a disc except its number; returns false if the point is not drawn. */
static bool make_disc(const projection *p, const chunk *c, size_t index, iso_disc *disc) {
    const iso_view *view = p->projector.view;
    const iso_surfel surfel = iso_point_view_get(p->points, index);
    const iso_vec3 at = iso_projector_point(&p->projector, c->span->brick, surfel.position);
    const double radius = p->points->radii ? (double)p->points->radii[index] : p->points->radius,
                 scale = iso_projector_scale(&p->projector, at.z), x = at.x * scale, y = at.y * scale;
    if (!(at.z >= view->near && fabs(x) < 1e15 && fabs(y) < 1e15 && fabs(at.z) < 1e15)) return false;
    if (!(radius > 0 && radius < 1e15)) return false;
    *disc = (iso_disc){.x = (float)x,
                       .y = (float)y,
                       .z = (float)at.z,
                       .radius = (float)radius * p->factor,
                       .point = (uint32_t)index};
    iso_projector_normal(&p->projector, surfel.normal, disc->normal);
    return true;
}

static void project_point(projection *p, chunk *c, uint32_t i) {
    iso_disc *disc = (iso_disc *)p->discs->disc.data + c->disc + i;
    iso_rows *rows = (iso_rows *)p->discs->rows.data + c->disc + i;
    *rows = (iso_rows){0, -1};
    if (!make_disc(p, c, c->first + i, disc)) return;
    const float near = disc->z - disc->radius, far = disc->z + disc->radius;
    c->depth[0] = near < c->depth[0] ? near : c->depth[0];
    c->depth[1] = far > c->depth[1] ? far : c->depth[1];
    const iso_disc_box box = iso_disc_bounds(&p->discs->view, disc, &p->picture);
    if (box.columns.first <= box.columns.last) *rows = box.rows;
}

static void project_chunk(void *context, size_t index, int worker) {
    (void)worker;
    projection *p = context;
    chunk *c = &p->chunks[index];
    c->depth[0] = INFINITY;
    c->depth[1] = -INFINITY;
    c->box = iso_box_empty();
    for (uint32_t i = 0; i < c->count; i++) {
        const iso_surfel surfel = iso_point_view_get(p->points, c->first + i);
        const iso_vec3 at = iso_brick_position(c->span->brick, surfel.position);
        if (iso_vec3_is_finite(at)) iso_box_add(&c->box, at);
        project_point(p, c, i);
    }
}

/* Removes the discs of a chunk that face away from the eye. */
static void cull_chunk(void *context, size_t index, int worker) {
    (void)worker;
    const projection *p = context;
    const chunk *c = &p->chunks[index];
    const float slope = p->discs->view.slope;
    const iso_disc *disc = (const iso_disc *)p->discs->disc.data + c->disc;
    iso_rows *rows = (iso_rows *)p->discs->rows.data + c->disc;
    for (uint32_t i = 0; i < c->count; i++) {
        if (rows[i].first > rows[i].last) continue;
        const float *n = disc[i].normal;
        if (n[0] * disc[i].x * slope + n[1] * disc[i].y * slope + n[2] > 0) rows[i] = (iso_rows){0, -1};
    }
}

static iso_status make_chunks(projection *p, iso_error *error) {
    size_t count = 0, disc = 0;
    for (size_t s = 0; s < p->points->span_count; s++) {
        const iso_point_span *span = &p->points->spans[s];
        if (span->first + span->count >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "2^32 - 1 points or more");
        count += ((size_t)span->count + TASK_POINTS - 1) / TASK_POINTS;
    }
    p->chunks = iso_alloc_zero(count, sizeof *p->chunks);
    if (!p->chunks) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu parts of points", count);
    for (size_t s = 0; s < p->points->span_count; s++)
        for (uint32_t done = 0; done < p->points->spans[s].count; done += TASK_POINTS) {
            const iso_point_span *span = &p->points->spans[s];
            const uint32_t left = span->count - done, taken = left < TASK_POINTS ? left : TASK_POINTS;
            p->chunks[p->chunk_count++] =
                (chunk){.span = span, .first = span->first + done, .disc = disc, .count = taken};
            disc += taken;
        }
    p->discs->count = disc;
    return ISO_OK;
}

/* Combines the results of the chunks; returns whether the eye lies in the box around all points. */
static bool join_chunks(projection *p) {
    double eye[3];
    iso_box all = iso_box_empty();
    p->discs->depth[0] = INFINITY;
    p->discs->depth[1] = -INFINITY;
    for (size_t i = 0; i < p->chunk_count; i++) {
        const chunk *c = &p->chunks[i];
        p->discs->depth[0] = fminf(p->discs->depth[0], c->depth[0]);
        p->discs->depth[1] = fmaxf(p->discs->depth[1], c->depth[1]);
        if (iso_box_is_empty(&c->box)) continue;
        iso_box_add(&all, c->box.lo);
        iso_box_add(&all, c->box.hi);
    }
    if (p->projector.view->orthographic) return false;
    iso_projector_eye(&p->projector, &p->points->transform, eye);
    return eye[0] > all.lo.x && eye[1] > all.lo.y && eye[2] > all.lo.z && eye[0] < all.hi.x &&
           eye[1] < all.hi.y && eye[2] < all.hi.z;
}

static iso_status make_columns(iso_banded_discs *discs, int width, iso_error *error) {
    const size_t count = (size_t)width + ISO_LANES_MAX;
    ISO_TRY(iso_buffer_reserve(&discs->columns, count * sizeof(float), 0, error));
    float *columns = discs->columns.data;
    for (size_t x = 0; x < count; x++) columns[x] = iso_disc_column(&discs->view, (int)x);
    return ISO_OK;
}

iso_status iso_banded_discs_project(iso_banded_discs *discs, const iso_view *view,
                                    const iso_point_view *points, float factor, iso_pool *pool,
                                    iso_error *error) {
    projection p = {.discs = discs,
                    .points = points,
                    .projector = iso_projector_make(view, &points->transform),
                    .picture = {{0, view->width - 1}, {0, view->height - 1}},
                    .factor = factor};
    discs->view = iso_disc_view_make(view);
    ISO_TRY(make_columns(discs, view->width, error));
    ISO_TRY(make_chunks(&p, error));
    iso_status status = iso_buffer_reserve(&discs->disc, discs->count * sizeof(iso_disc), 0, error);
    if (status == ISO_OK)
        status = iso_buffer_reserve(&discs->rows, discs->count * sizeof(iso_rows), 0, error);
    if (status == ISO_OK) {
        iso_parallel_for(pool, p.chunk_count, project_chunk, &p);
        const bool around_eye = join_chunks(&p);
        if (points->closed && !around_eye) iso_parallel_for(pool, p.chunk_count, cull_chunk, &p);
    }
    iso_free(p.chunks);
    return status;
}

/* ---- bands */

/* A disc to be sorted. */
typedef struct sorted {
    float depth;
    uint32_t disc;
} sorted;

static int compare_near(const void *left, const void *right) {
    const sorted *a = left, *b = right;
    if (a->depth != b->depth) return a->depth < b->depth ? -1 : 1;
    return a->disc < b->disc ? -1 : 1;
}

static int compare_far(const void *left, const void *right) {
    return compare_near(right, left);
}

/* Lists the discs that are drawn; returns their number. */
static size_t list_discs(const iso_banded_discs *discs, sorted *list) {
    const iso_disc *disc = discs->disc.data;
    const iso_rows *rows = discs->rows.data;
    size_t count = 0;
    for (size_t i = 0; i < discs->count; i++)
        if (rows[i].first <= rows[i].last) list[count++] = (sorted){disc[i].z, (uint32_t)i};
    return count;
}

/* Distributes the numbers of discs to bands, keeping their order in each band. */
static iso_status fill_bands(iso_banded_discs *discs, const sorted *list, size_t count, iso_error *error) {
    const iso_rows *rows = discs->rows.data;
    size_t *start = discs->start.data;
    memset(start, 0, ((size_t)discs->bands + 2) * sizeof *start);
    for (size_t i = 0; i < count; i++)
        for (int b = rows[list[i].disc].first / discs->band_rows;
             b <= rows[list[i].disc].last / discs->band_rows; b++)
            start[b + 2]++;
    for (int b = 2; b < discs->bands + 2; b++) start[b] += start[b - 1];
    ISO_TRY(iso_buffer_reserve(&discs->order, start[discs->bands + 1] * sizeof(uint32_t), 0, error));
    uint32_t *order = discs->order.data;
    for (size_t i = 0; i < count; i++)
        for (int b = rows[list[i].disc].first / discs->band_rows;
             b <= rows[list[i].disc].last / discs->band_rows; b++)
            order[start[b + 1]++] = list[i].disc;
    return ISO_OK;
}

iso_status iso_banded_discs_assign(iso_banded_discs *discs, int height, int band_rows, iso_disc_order order,
                                   iso_error *error) {
    discs->height = height;
    discs->band_rows = band_rows;
    discs->bands = (height + band_rows - 1) / band_rows;
    ISO_TRY(iso_buffer_reserve(&discs->start, ((size_t)discs->bands + 2) * sizeof(size_t), 0, error));
    sorted *list = iso_alloc(discs->count * sizeof *list);
    if (!list) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu discs", discs->count);
    const size_t count = list_discs(discs, list);
    if (order != ISO_DISC_ORDER_GIVEN)
        qsort(list, count, sizeof *list, order == ISO_DISC_ORDER_BACK_TO_FRONT ? compare_far : compare_near);
    const iso_status status = fill_bands(discs, list, count, error);
    iso_free(list);
    return status;
}

iso_rows iso_banded_discs_band(const iso_banded_discs *discs, size_t band) {
    const int first = (int)band * discs->band_rows, end = first + discs->band_rows;
    return (iso_rows){first, (end < discs->height ? end : discs->height) - 1};
}

void iso_banded_discs_free(iso_banded_discs *discs) {
    iso_buffer_free(&discs->disc);
    iso_buffer_free(&discs->rows);
    iso_buffer_free(&discs->columns);
    iso_buffer_free(&discs->order);
    iso_buffer_free(&discs->start);
    *discs = (iso_banded_discs){0};
}
