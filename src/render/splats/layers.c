/* layers: lists the layers of translucent surfaces of points band by band, and composites the bands. */
#include "render/splats/layers.h"

#include <string.h>

#include "base/exponential.h"
#include "render/splats/layer_lists.h"

enum { BAND_ROWS = 16 }; /* of samples, about; more when a pixel has several rows of them */

/* Cosines between rays and normals are taken as this when they are smaller. */
static const float LEAST_COSINE = 1e-6f;

/* The working memory of a worker. */
typedef struct worker {
    iso_layer_lists lists;
    iso_layer_composer composer;
    iso_buffer memory, starts;
    iso_layer_totals totals;
    bool failed; /* out of memory */
} worker;

typedef struct layers_draw {
    const iso_splat_layers *picture;
    iso_splat_surface *surfaces;
    int band_rows;
    worker *workers;
} layers_draw;

/* ---- fragments */

/* The opacity of a layer, given the cosine between ray and normal: iso_translucency. */
static float opacity_of(const iso_splat_surface *surface, float cosine) {
    if (surface->input->translucency.constant) return surface->input->translucency.opacity;
    return 1 - iso_exp2(surface->log_through / (cosine < LEAST_COSINE ? LEAST_COSINE : cosine));
}

iso_fragment iso_splat_fragment(const iso_splat_surface *surface, const float normal[3], float depth,
                                const uint8_t *rgb, float x, float y) {
    const float slope = surface->discs.view.slope, to_eye[3] = {-x * slope, -y * slope, -1},
                length = sqrtf(to_eye[0] * to_eye[0] + to_eye[1] * to_eye[1] + 1),
                cosine =
                    fabsf(normal[0] * to_eye[0] + normal[1] * to_eye[1] + normal[2] * to_eye[2]) / length;
    const iso_rgb color = rgb ? (iso_rgb){rgb[0], rgb[1], rgb[2]} : surface->input->color;
    iso_fragment fragment = {
        .depth = depth, .opacity = opacity_of(surface, cosine), .surface = surface->number};
    iso_shade_sample(normal, to_eye, color, fragment.color);
    return fragment;
}

iso_fragment iso_splat_mean_fragment(const iso_splat_surface *surface, const iso_splat_sums *sums, float x,
                                     float y) {
    const bool colored = surface->input->points.colors != NULL;
    float normal[3];
    uint8_t rgb[3];
    iso_splat_normal(sums, normal);
    if (colored) iso_splat_color(sums, rgb);
    return iso_splat_fragment(surface, normal, sums->depth / sums->weight, colored ? rgb : NULL, x, y);
}

/* ---- setting up */

/* By how much the discs of a group are enlarged so that they cover the surface (eq. 7 to 9): measured to be
 * the best. */
static float widening(const iso_groups *groups) {
    return groups->count > 2 ? sqrtf((float)groups->count / 2) : 1;
}

/* The width of bins: the thickness of a layer (eq. 6 with n = range / epsilon), for the points' mean
 * radius. */
static float bin_width(const iso_point_view *points) {
    double sum = points->radius;
    size_t count = 1;
    if (points->radii) sum = 0, count = 0;
    for (size_t s = 0; points->radii && s < points->span_count; s++)
        for (size_t i = points->spans[s].first; i < points->spans[s].first + points->spans[s].count; i++)
            if (points->radii[i] > 0 && isfinite(points->radii[i])) {
                sum += (double)points->radii[i];
                count++;
            }
    return (float)(count ? sum / (double)count : 1) * ISO_SPLATS_THICKNESS;
}

/* Projects the points as discs of `factor` times their radii, and assigns them to bands. */
static iso_status make_discs(const layers_draw *draw, const iso_point_view *points, float factor,
                             iso_disc_order order, iso_discs *discs, iso_error *error) {
    const iso_view *view = draw->picture->strip->view;
    ISO_TRY(iso_discs_project(discs, view, points, factor, draw->picture->pool, error));
    return iso_discs_assign(discs, view->height, draw->band_rows, order, error);
}

static iso_status set_up_surface(const layers_draw *draw, int number, iso_error *error) {
    iso_splat_surface *s = &draw->surfaces[number];
    s->input = &draw->picture->layers[number];
    s->number = number;
    s->log_through = (float)iso_log2(1 - (double)s->input->translucency.opacity);
    iso_point_view points = s->input->points;
    points.closed = false; /* both sides are seen */
    ISO_TRY(make_discs(draw, &points, ISO_SPLATS_DISC, ISO_DISCS_FRONT_TO_BACK, &s->discs, error));
    if (draw->picture->transparency == ISO_TRANSPARENCY_SORTED) return ISO_OK;
    s->bin = bin_width(&points);
    return make_discs(draw, &points, ISO_SPLATS_DISC * widening(s->input->groups), ISO_DISCS_BACK_TO_FRONT,
                      &s->wide, error);
}

static iso_status set_up(layers_draw *draw, iso_error *error) {
    const iso_splat_layers *picture = draw->picture;
    const int factor = picture->strip->factor;
    draw->band_rows = (BAND_ROWS + factor - 1) / factor * factor;
    draw->surfaces = iso_alloc_zero((size_t)picture->count, sizeof *draw->surfaces);
    draw->workers = iso_alloc_zero((size_t)iso_pool_threads(picture->pool), sizeof *draw->workers);
    if (!draw->surfaces || !draw->workers)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
    for (int i = 0; i < picture->count; i++) ISO_TRY(set_up_surface(draw, i, error));
    for (int i = 0; i < iso_pool_threads(picture->pool); i++) {
        worker *w = &draw->workers[i];
        ISO_TRY(iso_layer_lists_reserve(&w->lists, picture->strip->view->width, draw->band_rows, error));
        ISO_TRY(iso_layer_composer_reserve(&w->composer, picture->image->width, factor, error));
    }
    return ISO_OK;
}

static void free_draw(layers_draw *draw) {
    for (int i = 0; draw->surfaces && i < draw->picture->count; i++) {
        iso_discs_free(&draw->surfaces[i].discs);
        iso_discs_free(&draw->surfaces[i].wide);
    }
    for (int i = 0; draw->workers && i < iso_pool_threads(draw->picture->pool); i++) {
        iso_layer_lists_free(&draw->workers[i].lists);
        iso_layer_composer_free(&draw->workers[i].composer);
        iso_buffer_free(&draw->workers[i].memory);
        iso_buffer_free(&draw->workers[i].starts);
    }
    iso_free(draw->surfaces);
    iso_free(draw->workers);
}

/* ---- bands */

static bool list_surface(const layers_draw *draw, int number, const iso_splat_band *band) {
    const iso_splat_surface *surface = &draw->surfaces[number];
    const iso_transparency transparency = draw->picture->transparency;
    const bool sorted = transparency == ISO_TRANSPARENCY_SORTED;
    const iso_layer_pass pass = {.surface = number,
                                 .most_layers = sorted ? surface->input->translucency.most_layers : 0,
                                 .tolerance = -1};
    iso_layer_lists_begin(band->lists, &pass);
    if (sorted) return iso_splats_list_sorted(surface, band);
    if (surface->input->groups->count == 0) return true;
    return iso_splats_list_images(surface, band, transparency == ISO_TRANSPARENCY_NEAREST);
}

/* Lists all surfaces in the rows of a band; false: they do not fit into memory. */
static bool list_rows(const layers_draw *draw, worker *w, size_t number, iso_rows rows) {
    const iso_gbuffer *opaque = draw->picture->strip->gbuffer;
    const iso_splat_band band = {number,
                                 rows,
                                 opaque->width,
                                 &w->lists,
                                 &w->memory,
                                 &w->starts,
                                 rows.last - rows.first < draw->picture->strip->factor};
    iso_layer_lists_clear(&w->lists, rows.last - rows.first + 1);
    w->lists.limit = opaque->depth ? opaque->depth + (ptrdiff_t)rows.first * opaque->width : NULL;
    for (int i = 0; i < draw->picture->count; i++)
        if (!list_surface(draw, i, &band)) return false;
    return true;
}

/* Draws rows of a band, in two halves if their discs are too many. */
static void draw_rows(const layers_draw *draw, worker *w, size_t number, iso_rows rows) {
    const int factor = draw->picture->strip->factor, pixels = (rows.last - rows.first + 1) / factor;
    if (list_rows(draw, w, number, rows)) {
        const iso_layer_picture picture = {.strip = draw->picture->strip,
                                           .shading = draw->picture->shading,
                                           .image = draw->picture->image,
                                           .layers = draw->picture->layer_counts,
                                           .coverage = draw->picture->coverage};
        iso_layers_compose(&picture, &w->lists, NULL, rows.first, &w->composer, &w->totals);
    } else if (pixels > 1) {
        const int half = rows.first + pixels / 2 * factor;
        draw_rows(draw, w, number, (iso_rows){rows.first, half - 1});
        draw_rows(draw, w, number, (iso_rows){half, rows.last});
    } else {
        w->failed = true;
    }
}

static void draw_band(void *context, size_t index, int worker_index) {
    const layers_draw *draw = context;
    const int first = (int)index * draw->band_rows, end = first + draw->band_rows,
              height = draw->picture->strip->view->height;
    draw_rows(draw, &draw->workers[worker_index], index,
              (iso_rows){first, (end < height ? end : height) - 1});
}

/* Adds up what the workers counted. */
static iso_status sum_totals(const layers_draw *draw, iso_layer_totals *totals, iso_error *error) {
    for (int i = 0; i < iso_pool_threads(draw->picture->pool); i++) {
        const worker *w = &draw->workers[i];
        if (w->failed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the layers of a picture");
        totals->covered += w->totals.covered;
        totals->layers += w->totals.layers;
        if (w->totals.most > totals->most) totals->most = w->totals.most;
    }
    return ISO_OK;
}

iso_groups_opts iso_splat_layers_grouping(iso_pool *pool) {
    iso_groups_opts opts = iso_splats_grouping(pool);
    opts.limit = ISO_SPLAT_LAYERS_GROUPS;
    opts.by_number = true;
    return opts;
}

iso_status iso_shade_splat_layers(const iso_splat_layers *picture, iso_layer_totals *totals,
                                  iso_error *error) {
    layers_draw draw = {.picture = picture};
    iso_status status = set_up(&draw, error);
    if (status == ISO_OK) {
        const int height = picture->strip->view->height;
        iso_parallel_for(picture->pool, (size_t)((height + draw.band_rows - 1) / draw.band_rows), draw_band,
                         &draw);
        status = sum_totals(&draw, totals, error);
    }
    free_draw(&draw);
    return status;
}
