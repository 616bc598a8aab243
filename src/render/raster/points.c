/* points: attenuated points, Baerentzen and Christensen 2003, section 4.1. Discs parallel to the image
 * plane, sized by the depth z of eq. 3-4. (The paper's OpenGL point parameters could only use a bound on
 * z.)
 *
 * The picture is drawn in bands of rows that fit into cache. A band stores for each pixel the depth and
 * the packed normal or number of the nearest point; view space normals are computed once the nearest
 * points are known. */
#include <assert.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "render/raster/points_kernel.h"
#include "render/raster/raster.h"
#include "render/view/project.h"

/* ---- large discs, one at a time */

/* A projected disc: the pixel that contains its centre, the centre inside that pixel, the radius in
 * pixels. */
typedef struct disc {
    double column, row, fx, fy, radius;
    float depth;
    uint32_t source;
} disc;

/* Rounds pixels to 1/65536. */
static double snapped(double pixels) {
    return floor(pixels * 65536 + 0.5) / 65536;
}

/* Projects a point. Returns false if it is not drawn. */
static bool project_disc(const point_draw *draw, const block *b, size_t index, disc *out) {
    const iso_view *view = draw->projector.view;
    iso_surfel surfel = iso_point_view_get(draw->points, index);
    iso_vec3 p = iso_projector_point(&draw->projector, b->span->brick, surfel.position);
    if (!(p.z >= view->near)) return false;
    double scale = iso_projector_scale(&draw->projector, p.z);
    double x = snapped(p.x * scale) + view->cx, y = snapped(p.y * scale) + view->cy;
    if (!(fabs(x) < 1e15 && fabs(y) < 1e15)) return false; /* also when NaN */
    double column = floor(x), row = floor(y), radius = point_radius(draw->points, index) * scale;
    *out = (disc){column, row, x - column, y - row, radius, (float)p.z, source_of(draw, index)};
    return true;
}

/* Returns the pixels k whose centres k + 0.5 lie within `reach` of `at`, and with `keep` also pixel 0. The
 * result counts from k = -pixel and is clipped to `clip`. */
static iso_rows covered(double at, double reach, double pixel, iso_rows clip, bool keep) {
    double first = ceil(at - 0.5 - reach), last = floor(at - 0.5 + reach);
    if (keep && first > 0) first = 0;
    if (keep && last < 0) last = 0;
    first += pixel;
    last += pixel;
    if (!(first <= clip.last && last >= clip.first)) return (iso_rows){0, -1};
    return (iso_rows){first > clip.first ? (int)first : clip.first, last < clip.last ? (int)last : clip.last};
}

void iso_draw_large_point(const point_band *band, const block *b, size_t index) {
    disc d;
    if (!project_disc(band->draw, b, index, &d)) return;
    const iso_rows whole = {0, band->draw->projector.view->width - 1};
    iso_rows rows = covered(d.fy, d.radius, d.row, band->rows, true);
    for (int j = rows.first; j <= rows.last; j++) {
        double offset = (j - d.row) + (0.5 - d.fy);
        double square = d.radius * d.radius - offset * offset;
        bool center_row = j == d.row;
        if (square < 0 && !center_row) continue;
        iso_rows columns = covered(d.fx, square > 0 ? sqrt(square) : 0, d.column, whole, center_row);
        float *depth = band_pixel(band, 0, j);
        uint32_t *source = band->source + (depth - band->depth);
        for (int x = columns.first; x <= columns.last; x++)
            if (d.depth < depth[x]) {
                depth[x] = d.depth;
                source[x] = d.source;
            }
    }
}

/* ---- bands */

/* Fills a band with the depths of the gbuffer. */
static void load_band(const point_band *band) {
    const point_draw *draw = band->draw;
    const iso_gbuffer *g = draw->target->gbuffer;
    size_t width = (size_t)g->width;
    for (int y = band->rows.first; y <= band->rows.last; y++) {
        float *row = band_pixel(band, 0, y);
        for (int k = 0; k < MARGIN; k++) row[k - MARGIN] = row[width + (size_t)k] = -INFINITY;
        memcpy(row, g->depth + (size_t)y * width, width * sizeof *row);
        memset(band->source + (row - band->depth) - MARGIN, 0xff, draw->pitch * sizeof *band->source);
    }
}

/* Writes row y of the band into the gbuffer, with the normals of surfels. */
static void resolve_surfels(const point_band *band, int y) {
    const point_draw *draw = band->draw;
    const iso_gbuffer *g = draw->target->gbuffer;
    const float *depth = band_pixel(band, 0, y);
    const uint32_t *source = band->source + (depth - band->depth);
    for (int x = 0; x < g->width; x++) {
        if (source[x] == NO_POINT) continue;
        size_t at = (size_t)y * (size_t)g->width + (size_t)x;
        float normal[3];
        iso_projector_normal(&draw->projector, draw->points->surfels[source[x]].normal, normal);
        g->depth[at] = depth[x];
        g->surface[at] = draw->target->surface;
        for (int axis = 0; axis < 3; axis++) g->normal[axis][at] = normal[axis];
    }
}

static void draw_block(const point_band *band, const block *b) {
    const point_draw *draw = band->draw;
    point_chunk chunk;
    for (uint32_t done = 0; done < b->count; done += CHUNK) {
        int count = b->count - done < CHUNK ? (int)(b->count - done) : CHUNK;
        draw->kernels->project_chunk(draw, b, b->first + done, count, &chunk);
        draw->kernels->splat_chunk(band, b, &chunk, b->first + done, count);
    }
}

static void draw_band(void *context, size_t index, int worker) {
    const point_draw *draw = context;
    size_t pixels = (size_t)draw->band_rows * draw->pitch * (size_t)worker;
    int height = draw->projector.view->height, first = (int)index * draw->band_rows;
    int last = height - first < draw->band_rows ? height - 1 : first + draw->band_rows - 1;
    point_band band = {draw, {first, last}, draw->depth + pixels, draw->source + pixels};
    load_band(&band);
    for (size_t k = 0; k < draw->block_count; k++)
        if (iso_rows_meet(draw->blocks[k].rows, band.rows)) draw_block(&band, &draw->blocks[k]);
    for (int y = first; y <= last; y++)
        if (draw->points->surfels)
            resolve_surfels(&band, y);
        else
            draw->kernels->resolve_row(&band, y);
}

/* Returns a box that contains a block's points, in index coordinates: exact for surfels, for packed points
 * the range of their positions. */
static iso_box block_box(const point_draw *draw, const block *b) {
    const int32_t *brick = b->span->brick;
    if (draw->points->surfels) return iso_surfel_bounds(draw->points->surfels + b->first, b->count, brick);
    const float low = ISO_POINT_LOW, high = ISO_POINT_LOW + ISO_POINT_RANGE;
    const iso_surfel corners[2] = {{.position = {low, low, low}}, {.position = {high, high, high}}};
    return iso_surfel_bounds(corners, 2, brick);
}

static void place_block(void *context, size_t index, int worker) {
    (void)worker;
    point_draw *draw = context;
    block *b = &draw->blocks[index];
    double radius = 0;
    if (!draw->points->radii) radius = point_radius(draw->points, 0);
    for (size_t i = b->first; draw->points->radii && i < b->first + b->count; i++) {
        double own = point_radius(draw->points, i);
        if (own > radius) radius = own; /* (fmax is an internal error of gcc 12 for ARM) */
    }
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

/* Returns the number of rows of a band: as many as fit into the cache, but few enough for all threads to get
 * bands. */
static int band_rows(const point_draw *draw) {
    int height = draw->projector.view->height, threads = iso_pool_threads(draw->target->pool);
    size_t fit = BAND_BYTES / (draw->pitch * (sizeof *draw->depth + sizeof *draw->source));
    int rows = fit < MOST_ROWS ? (int)fit : MOST_ROWS;
    int share = (height + 4 * threads - 1) / (4 * threads);
    if (threads > 1 && rows > share) rows = share;
    return rows < LEAST_ROWS ? LEAST_ROWS : rows;
}

static iso_status draw_blocks(point_draw *draw, iso_error *error) {
    int height = draw->projector.view->height;
    size_t pixels = (size_t)draw->band_rows * draw->pitch * (size_t)iso_pool_threads(draw->target->pool);
    draw->depth = iso_alloc(pixels * sizeof *draw->depth);
    draw->source = iso_alloc(pixels * sizeof *draw->source);
    iso_status status = ISO_OK;
    if (draw->depth && draw->source)
        iso_parallel_for(draw->target->pool, (size_t)((height + draw->band_rows - 1) / draw->band_rows),
                         draw_band, draw);
    else
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for bands of %zu pixels", pixels);
    iso_free(draw->depth);
    iso_free(draw->source);
    return status;
}

/* Returns whether the numbers of surfels are too large for point_band.source. */
static bool has_too_many(const iso_point_view *points) {
    for (size_t s = 0; points->surfels && s < points->span_count; s++)
        if (points->spans[s].first + points->spans[s].count > NO_POINT) return true;
    return false;
}

iso_status iso_draw_points(const iso_target *target, const iso_point_view *points, iso_error *error) {
    const iso_view *view = target->view;
    assert(view->width == target->gbuffer->width && view->height == target->gbuffer->height);
    if (has_too_many(points)) return iso_fail(error, ISO_ERR_LIMIT, "more than 2^32 - 1 points in floats");
    point_draw draw = {.target = target,
                       .points = points,
                       .projector = iso_projector_make(view, &points->transform),
                       .pitch = (size_t)view->width + 2 * MARGIN,
                       .kernels = ISO_KERNEL_UNIT(iso_point_kernels, iso_cpu_best())};
    draw.band_rows = band_rows(&draw);
    ISO_TRY(make_blocks(&draw, error));
    iso_parallel_for(target->pool, draw.block_count, place_block, &draw);
    iso_status status = draw_blocks(&draw, error);
    iso_free(draw.blocks);
    return status;
}
