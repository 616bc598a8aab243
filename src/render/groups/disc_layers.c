/* disc_layers: lists the layers of translucent surfaces of points band by band, and composites the bands. */
#include "render/groups/disc_layers.h"

#include "render/groups/layer_lists.h"
#include "render/layers/bands.h"

enum { BAND_ROWS = 16 }; /* rows of samples in a band, about; more if a pixel has several rows of samples */

/* The working memory of a worker. */
typedef struct worker {
    iso_layer_lists lists;
    iso_layer_composer composer;
    iso_buffer memory, starts;
    iso_layer_totals totals;
} worker;

typedef struct layers_draw {
    const iso_splat_layers *input;
    iso_splat_surface *surfaces;
    int band_rows;
    worker *workers;
} layers_draw;

/* ---- fragments */

/* Something that is seen as one layer: a disc, or the mean of several. */
typedef struct seen_layer {
    float normal[3], depth;
    float share; /* of the surface's opacity */
    iso_rgb color;
} seen_layer;

/* Shades a layer that is seen at (x, y), in pixels from the optical axis. */
static iso_fragment shade(const iso_splat_surface *surface, const seen_layer *layer, float x, float y) {
    const float slope = surface->discs.view.slope, to_eye[3] = {-x * slope, -y * slope, -1};
    const iso_layer_opacity own = surface->input->points.opacities
                                      ? iso_layer_opacity_part(&surface->input->translucency, layer->share)
                                      : surface->opacity;
    iso_fragment fragment = {.depth = layer->depth,
                             .opacity = iso_layer_opacity_at(&own, layer->normal, to_eye),
                             .surface = surface->number};
    iso_shade_sample(layer->normal, to_eye, layer->color, fragment.color);
    return fragment;
}

iso_fragment iso_splat_fragment(const iso_splat_surface *surface, const iso_disc *disc) {
    const iso_point_view *points = &surface->input->points;
    const uint8_t *rgb = points->colors ? points->colors[disc->point] : NULL;
    const seen_layer layer = {.normal = {disc->normal[0], disc->normal[1], disc->normal[2]},
                              .depth = disc->z,
                              .share = points->opacities ? (float)points->opacities[disc->point] / 255 : 1,
                              .color = rgb ? (iso_rgb){rgb[0], rgb[1], rgb[2]} : surface->input->color};
    return shade(surface, &layer, disc->x, disc->y);
}

/* Returns a fragment that stores a layer's normal. */
static iso_fragment with_normal(const iso_splat_surface *surface, const seen_layer *layer, bool away) {
    iso_fragment fragment = {.depth = layer->depth, .surface = surface->number, .leaves = away};
    for (int k = 0; k < 3; k++) fragment.color[k] = (layer->normal[k] + 1) * ISO_LAYER_NORMAL_SCALE;
    return fragment;
}

iso_fragment iso_splat_mean_fragment(const iso_splat_surface *surface, const iso_splat_sums *sums, bool away,
                                     float x, float y) {
    seen_layer layer = {.depth = sums->depth / sums->weight,
                        .share = sums->opacity / sums->weight,
                        .color = surface->input->color};
    uint8_t rgb[3];
    iso_splat_normal(sums, layer.normal);
    if (surface->normals) return with_normal(surface, &layer, away);
    if (surface->input->points.colors) {
        iso_splat_color(sums, rgb);
        layer.color = (iso_rgb){rgb[0], rgb[1], rgb[2]};
    }
    return shade(surface, &layer, x, y);
}

/* ---- setting up */

/* Sets `radii` to the radii with which each group covers the surface: those of the points, enlarged by the
 * groups' factors; without factors by the square root of half the number of groups, or not if groups have
 * copies of points. */
static void widen(const iso_point_view *points, const iso_groups *groups, float *radii) {
    const float all = groups->copies ? 1 : groups->count > 2 ? sqrtf((float)groups->count / 2) : 1;
    for (size_t s = 0; s < points->span_count; s++)
        for (size_t i = points->spans[s].first; i < points->spans[s].first + points->spans[s].count; i++) {
            const float factor = groups->widening[groups->group[i]];
            radii[i] =
                (points->radii ? points->radii[i] : (float)points->radius) * (factor > 0 ? factor : all);
        }
}

/* Returns the width of the bins of depth: the thickness of a layer (eq. 6 with n = range / epsilon) for the
 * points' mean radius. */
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
    return (float)(count ? sum / (double)count : 1) * ISO_GROUPS_THICKNESS;
}

/* Makes the discs of the modes groups and nearest. */
static iso_status make_wide_discs(iso_splat_surface *s, const iso_view *view, iso_point_view points,
                                  int band_rows, iso_pool *pool, iso_error *error) {
    float *radii = iso_alloc(iso_groups_length(&points) * sizeof *radii);
    if (!radii) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
    widen(&points, s->input->groups, radii);
    points.radii = radii;
    iso_status status = iso_banded_discs_project(&s->wide, view, &points, ISO_GROUPS_DISC, pool, error);
    if (status == ISO_OK)
        status =
            iso_banded_discs_assign(&s->wide, view->height, band_rows, ISO_DISC_ORDER_BACK_TO_FRONT, error);
    iso_free(radii);
    return status;
}

iso_status iso_groups_start_surface(const iso_splat_layer *input, const iso_view *view, bool sorted,
                                    int band_rows, iso_pool *pool, iso_splat_surface *surface,
                                    iso_error *error) {
    surface->input = input;
    surface->opacity = iso_layer_opacity_make(&input->translucency);
    iso_point_view points = input->points;
    points.closed = false; /* both sides of the surface are visible */
    ISO_TRY(iso_banded_discs_project(&surface->discs, view, &points, ISO_GROUPS_DISC, pool, error));
    ISO_TRY(iso_banded_discs_assign(&surface->discs, view->height, band_rows, ISO_DISC_ORDER_FRONT_TO_BACK,
                                    error));
    if (sorted) return ISO_OK;
    surface->bin = bin_width(&points);
    return make_wide_discs(surface, view, points, band_rows, pool, error);
}

void iso_groups_end_surface(iso_splat_surface *surface) {
    iso_banded_discs_free(&surface->discs);
    iso_banded_discs_free(&surface->wide);
}

static iso_status set_up_surface(const layers_draw *draw, int number, iso_error *error) {
    const iso_splat_layers *input = draw->input;
    iso_splat_surface *s = &draw->surfaces[number];
    s->number = number;
    s->input = &input->layers[number];
    s->normals = input->crossings != NULL;
    if (s->input->lists) return ISO_OK;
    return iso_groups_start_surface(s->input, input->picture.strip->view,
                                    input->transparency == ISO_TRANSPARENCY_SORTED, draw->band_rows,
                                    input->picture.pool, s, error);
}

static iso_status set_up(layers_draw *draw, iso_error *error) {
    const iso_layer_picture *picture = &draw->input->picture;
    const int factor = picture->strip->factor;
    draw->band_rows = iso_layer_band_rows(picture->strip, BAND_ROWS);
    draw->surfaces = iso_alloc_zero((size_t)draw->input->count, sizeof *draw->surfaces);
    draw->workers = iso_alloc_zero((size_t)iso_pool_threads(picture->pool), sizeof *draw->workers);
    if (!draw->surfaces || !draw->workers)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
    for (int i = 0; i < draw->input->count; i++) ISO_TRY(set_up_surface(draw, i, error));
    for (int i = 0; i < iso_pool_threads(picture->pool); i++) {
        worker *w = &draw->workers[i];
        ISO_TRY(iso_layer_lists_reserve(&w->lists, picture->strip->view->width, draw->band_rows, error));
        if (draw->input->crossings) continue;
        ISO_TRY(iso_layer_composer_reserve(&w->composer, picture->image->width, factor, error));
    }
    return ISO_OK;
}

static void free_draw(layers_draw *draw) {
    for (int i = 0; draw->surfaces && i < draw->input->count; i++) iso_groups_end_surface(&draw->surfaces[i]);
    for (int i = 0; draw->workers && i < iso_pool_threads(draw->input->picture.pool); i++) {
        iso_layer_lists_free(&draw->workers[i].lists);
        iso_layer_composer_free(&draw->workers[i].composer);
        iso_buffer_free(&draw->workers[i].memory);
        iso_buffer_free(&draw->workers[i].starts);
    }
    iso_free(draw->surfaces);
    iso_free(draw->workers);
}

/* ---- bands */

/* Lists the layers that another engine has found. */
static bool list_given(const iso_splat_lists *given, const iso_splat_band *band) {
    for (int y = band->rows.first; y <= band->rows.last; y++)
        for (int x = 0; x < band->width; x++) {
            const size_t at = (size_t)y * (size_t)band->width + (size_t)x;
            bool done = false;
            for (size_t i = given->start[at]; i < given->start[at + 1] && !done; i++)
                done = iso_packed_opacity(&given->layers[i]) > 0 &&
                       iso_layer_add_packed(band->lists, x, y - band->rows.first, &given->layers[i], false);
        }
    return !band->lists->full;
}

static bool list_surface(const layers_draw *draw, int number, const iso_splat_band *band) {
    const iso_splat_surface *surface = &draw->surfaces[number];
    const iso_transparency transparency = draw->input->transparency;
    const bool sorted = transparency == ISO_TRANSPARENCY_SORTED;
    const iso_layer_pass pass = {.surface = number,
                                 .most_layers = sorted ? surface->input->translucency.most_layers : 0,
                                 .tolerance = -1};
    iso_layer_lists_begin(band->lists, &pass);
    if (surface->input->lists) return list_given(surface->input->lists, band);
    if (sorted) return iso_groups_list_sorted(surface, band);
    if (surface->input->groups->count == 0) return true;
    return iso_groups_list_images(surface, band, transparency == ISO_TRANSPARENCY_NEAREST);
}

/* The callback iso_layer_bands.list. */
static bool list_rows(void *context, int number, size_t band_number, iso_rows rows, bool least) {
    const layers_draw *draw = context;
    const iso_gbuffer *opaque = draw->input->picture.strip->gbuffer;
    worker *w = &draw->workers[number];
    const iso_splat_band band = {band_number, rows, opaque->width, &w->lists, &w->memory, &w->starts, least};
    iso_layer_lists_clear(&w->lists, rows.last - rows.first + 1);
    w->lists.limit = opaque->depth ? opaque->depth + (ptrdiff_t)rows.first * opaque->width : NULL;
    for (int i = 0; i < draw->input->count; i++)
        if (!list_surface(draw, i, &band)) return false;
    return true;
}

/* The callback iso_layer_bands.use. */
static void compose_rows(void *context, int number, iso_rows rows) {
    const layers_draw *draw = context;
    worker *w = &draw->workers[number];
    if (draw->input->crossings)
        iso_groups_read_crossings(&w->lists, rows.first, draw->input->crossings);
    else
        iso_layers_compose(&draw->input->picture, &w->lists, NULL, rows.first, &w->composer, &w->totals);
}

iso_groups_opts iso_splat_layers_grouping(iso_pool *pool) {
    iso_groups_opts opts = iso_groups_default_opts(pool);
    opts.limit = ISO_SPLAT_LAYERS_GROUPS;
    opts.by_number = true;
    return opts;
}

iso_status iso_groups_map_glass(const iso_point_view *points, const iso_groups *groups,
                                iso_transparency transparency, const iso_glass_map *map, iso_pool *pool,
                                iso_error *error) {
    const iso_gbuffer size = {.width = map->view->width, .height = map->view->height};
    const iso_strip strip = {.view = map->view, .gbuffer = &size, .factor = 1};
    const iso_splat_layer layer = {
        .points = *points, .groups = groups, .translucency = {.opacity = 0, .constant = true}};
    const iso_splat_layers layers = {.transparency = transparency,
                                     .layers = &layer,
                                     .count = 1,
                                     .picture = {.strip = &strip, .pool = pool},
                                     .crossings = map};
    iso_layer_totals totals = {.covered = 0};
    return iso_shade_splat_layers(&layers, &totals, error);
}

iso_status iso_shade_splat_layers(const iso_splat_layers *input, iso_layer_totals *totals, iso_error *error) {
    const iso_layer_picture *picture = &input->picture;
    layers_draw draw = {.input = input};
    iso_status status = set_up(&draw, error);
    const iso_layer_bands bands = {picture->strip, draw.band_rows, picture->pool,
                                   list_rows,      compose_rows,   &draw};
    if (status == ISO_OK) status = iso_layer_bands_draw(&bands, error);
    for (int i = 0; status == ISO_OK && i < iso_pool_threads(picture->pool); i++)
        iso_layer_totals_add(totals, &draw.workers[i].totals);
    free_draw(&draw);
    return status;
}
