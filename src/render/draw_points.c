/* Attenuated points: Baerentzen and Christensen 2003, section 4.1. Discs that face the picture, sized by the
 * depth z of eq. 3-4 itself, for which OpenGL's point parameters had to be content with a bound on it. */
#include <assert.h>

#include "base/memory.h"
#include "render/draw.h"
#include "render/project.h"

/* Points that are culled together: a span, or a part of a long one. */
enum { BLOCK_POINTS = 4096 };

typedef struct block {
    const iso_point_span *span;
    size_t first; /* in the arrays of points */
    uint32_t count;
    iso_rows rows;
} block;

typedef struct point_draw {
    const iso_target *target;
    const iso_point_view *points;
    iso_projector projector;
    block *blocks;
    size_t block_count;
    int band_count;
} point_draw;

/* A point on its way into the gbuffer. Its centre is snapped to 1/65536 pixel, relative to the optical axis,
 * so that strips of a picture cover the same pixels as the whole. */
typedef struct disc {
    double column, row; /* pixel that contains the centre */
    double fx, fy;      /* centre inside it, 0 .. 1 */
    double radius;      /* pixels */
    float depth;
} disc;

static double snapped(double pixels) {
    return floor(pixels * 65536 + 0.5) / 65536;
}

static double point_radius(const iso_point_view *points, size_t index) {
    double radius = points->radii ? points->radii[index] : points->radius;
    return radius > 0 ? radius : 0;
}

static bool project_disc(const point_draw *draw, const block *b, size_t index, const float position[3],
                         disc *out) {
    const iso_view *view = draw->projector.view;
    iso_vec3 p = iso_projector_point(&draw->projector, b->span->brick, position);
    if (!(p.z >= view->near)) return false;
    double scale = iso_projector_scale(&draw->projector, p.z);
    double x = snapped(p.x * scale) + view->cx, y = snapped(p.y * scale) + view->cy;
    if (!(fabs(x) < 1e15 && fabs(y) < 1e15)) return false; /* also what is not a number */
    double column = floor(x), row = floor(y);
    *out = (disc){column, row, x - column, y - row, point_radius(draw->points, index) * scale, (float)p.z};
    return true;
}

/* Whole pixels k with centres k + 0.5 within `reach` of `at`, counted from `pixel` and clipped to [lo, hi];
 * pixel 0 always belongs when keep is set. */
static iso_rows covered(double at, double reach, double pixel, iso_rows clip, bool keep) {
    double first = ceil(at - 0.5 - reach), last = floor(at - 0.5 + reach);
    if (keep && first > 0) first = 0;
    if (keep && last < 0) last = 0;
    first += pixel;
    last += pixel;
    if (!(first <= clip.last && last >= clip.first)) return (iso_rows){0, -1};
    return (iso_rows){first > clip.first ? (int)first : clip.first, last < clip.last ? (int)last : clip.last};
}

static void fill_row(const point_draw *draw, const disc *d, const float normal[3], size_t start, int count) {
    const iso_gbuffer *g = draw->target->gbuffer;
    for (size_t i = start; i < start + (size_t)count; i++) {
        if (!(d->depth < g->depth[i])) continue;
        g->depth[i] = d->depth;
        g->surface[i] = draw->target->surface;
        for (int axis = 0; axis < 3; axis++) g->normal[axis][i] = normal[axis];
    }
}

static void draw_disc(const point_draw *draw, const disc *d, const float index_normal[3], iso_rows band) {
    const int width = draw->projector.view->width;
    iso_rows rows = covered(d->fy, d->radius, d->row, band, true);
    if (rows.first > rows.last) return;
    float normal[3];
    iso_projector_normal(&draw->projector, index_normal, normal);
    for (int j = rows.first; j <= rows.last; j++) {
        double offset = (j - d->row) + (0.5 - d->fy);
        double square = d->radius * d->radius - offset * offset;
        bool center_row = j == d->row;
        if (square < 0 && !center_row) continue;
        double reach = square > 0 ? sqrt(square) : 0;
        iso_rows columns = covered(d->fx, reach, d->column, (iso_rows){0, width - 1}, center_row);
        fill_row(draw, d, normal, (size_t)j * (size_t)width + (size_t)columns.first,
                 columns.last - columns.first + 1);
    }
}

static void draw_band(void *context, size_t index, int worker) {
    (void)worker;
    const point_draw *draw = context;
    iso_rows band = iso_band_rows(draw->projector.view->height, draw->band_count, index);
    for (size_t k = 0; k < draw->block_count; k++) {
        const block *b = &draw->blocks[k];
        if (!iso_rows_meet(b->rows, band)) continue;
        for (size_t i = b->first; i < b->first + b->count; i++) {
            iso_surfel surfel = iso_point_view_get(draw->points, i);
            disc d;
            if (project_disc(draw, b, i, surfel.position, &d)) draw_disc(draw, &d, surfel.normal, band);
        }
    }
}

/* Packed points cannot leave [-2, 18); floats can, and are looked at. */
static iso_box block_box(const point_draw *draw, const block *b) {
    const int32_t *brick = b->span->brick;
    if (draw->points->surfels) return iso_surfel_bounds(draw->points->surfels + b->first, b->count, brick);
    const iso_surfel corners[2] = {{.position = {-2, -2, -2}}, {.position = {18, 18, 18}}};
    return iso_surfel_bounds(corners, 2, brick);
}

static void place_block(void *context, size_t index, int worker) {
    (void)worker;
    point_draw *draw = context;
    block *b = &draw->blocks[index];
    double radius = 0;
    if (!draw->points->radii) radius = point_radius(draw->points, 0);
    for (size_t i = b->first; draw->points->radii && i < b->first + b->count; i++)
        radius = fmax(radius, point_radius(draw->points, i));
    iso_box box = block_box(draw, b);
    b->rows = iso_projector_rows(&draw->projector, &box, radius);
}

static iso_status make_blocks(point_draw *draw, iso_error *error) {
    const iso_point_view *points = draw->points;
    size_t count = 0;
    for (size_t s = 0; s < points->span_count; s++)
        count += ((size_t)points->spans[s].count + BLOCK_POINTS - 1) / BLOCK_POINTS;
    draw->blocks = iso_alloc_zero(count, sizeof(block));
    if (!draw->blocks) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu spans of points", count);
    for (size_t s = 0; s < points->span_count; s++) {
        const iso_point_span *span = &points->spans[s];
        for (uint32_t done = 0; done < span->count;) {
            uint32_t left = span->count - done, taken = left < BLOCK_POINTS ? left : BLOCK_POINTS;
            draw->blocks[draw->block_count++] =
                (block){.span = span, .first = span->first + done, .count = taken};
            done += taken;
        }
    }
    return ISO_OK;
}

iso_status iso_draw_points(const iso_target *target, const iso_point_view *points, iso_error *error) {
    const iso_view *view = target->view;
    assert(view->width == target->gbuffer->width && view->height == target->gbuffer->height);
    point_draw draw = {.target = target,
                       .points = points,
                       .projector = iso_projector_make(view, &points->transform),
                       .band_count = iso_band_count(target->pool, view->height)};
    ISO_TRY(make_blocks(&draw, error));
    iso_parallel_for(target->pool, draw.block_count, place_block, &draw);
    iso_parallel_for(target->pool, (size_t)draw.band_count, draw_band, &draw);
    iso_free(draw.blocks);
    return ISO_OK;
}
