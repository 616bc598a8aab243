/* layers: lists the crossings of translucent surfaces band by band, traces doubtful samples again, and
 * composites the band. */
#include "exact/layers.h"

#include <math.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "exact/frame.h"
#include "grids/ray/ray_tracer.h"
#include "render/layers/recolor.h"
#include "render/shading/phong_vectors.h"

enum {
    BAND_ROWS = 32, /* rows of samples in a band, about; more if a pixel has several rows of samples */
    BAND_CHUNKS = ISO_EXACT_LAYERS_BYTES / sizeof(iso_layer_chunk) /* a band with more is cut in two */
};

/* Crossings in the same direction that are closer than this share of a cell's extent in depth are one
 * crossing. */
static const double SAME_CROSSING = 1e-3;

/* One of the surfaces in the picture. */
typedef struct layer {
    const iso_exact_layer *input;
    iso_target target; /* with its clip */
    iso_exact_frame frame;
    iso_exact_paint paint;
    iso_exact_fragments fragments;
    iso_layer_pass pass;
    iso_ray_tracer *tracer;
} layer;

/* The working memory of a worker. */
typedef struct worker {
    iso_layer_lists lists;
    iso_layer_composer composer;
    iso_layer_rays rays; /* NULL if no solid absorbs light */
    iso_exact_layers_totals totals;
} worker;

typedef struct layers_draw {
    const iso_exact_layers *input;
    iso_target target;
    iso_gbuffer size; /* the size of the strip's gbuffer */
    float *slopes;    /* slopes of the rays: u by column, v by row */
    layer *layers;
    iso_layer_medium media[ISO_EXACT_LAYERS_MAX];
    double middle; /* depths count from this one, also those of surfaces of other volumes */
    const iso_surface_colors *colors[ISO_EXACT_LAYERS_MAX]; /* by surface; NULL: its layer's one colour */
    bool recolors;                                          /* some surface has colours */
    bool absorbs, needs_rays; /* rays are needed for absorption and for readers */
    int band_rows;
    iso_exact_scratch *scratch; /* by worker */
    worker *workers;
} layers_draw;

/* ---- setting up */

static bool wants_normals(const iso_exact_layers *input) {
    return input->reader && !input->reader->shaded;
}

static void set_base(iso_rgb color, float base[3]) {
    base[0] = (float)color.r / 255;
    base[1] = (float)color.g / 255;
    base[2] = (float)color.b / 255;
}

/* Makes the ray tracer of a surface. The bricks that the surface crosses are those with spans, so no voxel is
 * read to find them. */
static iso_status make_tracer(layer *l, iso_error *error) {
    const iso_exact *exact = l->input->exact;
    const int *bricks = exact->set.bricks;
    const size_t count = (size_t)bricks[0] * (size_t)bricks[1] * (size_t)bricks[2];
    uint8_t *crossed = iso_alloc_zero(count, 1);
    if (!crossed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the map of %zu bricks", count);
    const uint32_t *order = exact->order.data;
    for (size_t i = 0; i < exact->set.span_count && exact->sorted; i++) {
        const int32_t *brick = iso_exact_spans(exact)[order[i]].brick;
        crossed[((size_t)brick[2] * (size_t)bricks[1] + (size_t)brick[1]) * (size_t)bricks[0] +
                (size_t)brick[0]] = 1;
    }
    return iso_ray_tracer_create_with(&exact->grid, exact->opts.isovalue, crossed, &l->tracer, error);
}

static void set_up_layer(layers_draw *draw, int number) {
    layer *l = &draw->layers[number];
    l->input = &draw->input->layers[number];
    const iso_translucency *translucency = &l->input->translucency;
    l->paint = (iso_exact_paint){.u = draw->slopes, .v = draw->slopes + draw->size.width + ISO_LANES_MAX};
    set_base(l->input->color, l->paint.base);
    draw->colors[number] = wants_normals(draw->input) ? NULL : l->input->colors;
    draw->recolors |= draw->colors[number] != NULL;
    l->target = draw->target;
    l->target.clip = l->input->clip;
    l->frame.projection = iso_exact_projection_make(&l->target, l->input->exact);
    if (number == 0) draw->middle = l->frame.projection.middle;
    l->frame.projection.middle = draw->middle;
    l->frame.projection.paint = &l->paint;
    l->frame.projection.fragments = &l->fragments;
    l->frame.kernel = ISO_KERNEL_UNIT(iso_exact_layers_kernel, iso_cpu_best());
    l->fragments = (iso_exact_fragments){.opacity = iso_layer_opacity_make(translucency),
                                         .normals = wants_normals(draw->input) || draw->colors[number],
                                         .surface = number,
                                         .fall_leaves = l->input->exact->surface.normal_sign < 0};
    l->pass = (iso_layer_pass){.surface = number,
                               .most_layers = translucency->most_layers,
                               .gap = translucency->gap,
                               .tolerance = (float)(SAME_CROSSING * 2 * l->frame.projection.half_depth)};
    if (translucency->absorption_length > 0) {
        draw->absorbs = draw->needs_rays = true;
        draw->media[number].per_mm = 1 / translucency->absorption_length;
        set_base(l->input->color, draw->media[number].color);
    }
}

static iso_status set_up_rays(worker *w, size_t samples, iso_error *error) {
    w->rays.begin = iso_alloc(3 * samples * sizeof(float));
    w->rays.inside = iso_alloc(samples * sizeof *w->rays.inside);
    if (!w->rays.begin || !w->rays.inside)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the rays of a band");
    w->rays.end = w->rays.begin + samples;
    w->rays.length = w->rays.end + samples;
    return ISO_OK;
}

static iso_status set_up_workers(layers_draw *draw, iso_error *error) {
    const iso_layer_picture *picture = &draw->input->picture;
    const size_t count = (size_t)iso_pool_threads(picture->pool);
    const int width = draw->size.width, factor = picture->strip->factor;
    draw->band_rows = iso_layer_band_rows(picture->strip, BAND_ROWS);
    draw->scratch = iso_exact_scratch_create(count, width, draw->band_rows);
    draw->workers = iso_alloc_zero(count, sizeof *draw->workers);
    if (!draw->scratch || !draw->workers)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
    for (size_t i = 0; i < count; i++) {
        worker *w = &draw->workers[i];
        ISO_TRY(iso_layer_lists_reserve(&w->lists, width, draw->band_rows, error));
        ISO_TRY(iso_layer_composer_reserve(&w->composer, width / factor, factor, error));
        if (draw->needs_rays) ISO_TRY(set_up_rays(w, (size_t)width * (size_t)draw->band_rows, error));
        w->lists.middle = (float)draw->middle;
        draw->scratch[i].lists = &w->lists;
    }
    return ISO_OK;
}

static iso_status set_up(layers_draw *draw, iso_error *error) {
    const iso_view *view = draw->target.view;
    const size_t width = (size_t)view->width, height = (size_t)view->height;
    draw->slopes = iso_alloc((width + ISO_LANES_MAX + height) * sizeof *draw->slopes);
    draw->layers = iso_alloc_zero((size_t)draw->input->count + 1, sizeof *draw->layers);
    if (!draw->slopes || !draw->layers)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing layers");
    float *v = draw->slopes + width + ISO_LANES_MAX;
    for (int x = 0; x < view->width + ISO_LANES_MAX; x++) draw->slopes[x] = iso_slope_of_column(view, x);
    for (int y = 0; y < view->height; y++) v[y] = iso_slope_of_row(view, y);
    draw->middle = draw->input->middle;
    for (int i = 0; i < draw->input->count; i++) {
        set_up_layer(draw, i);
        ISO_TRY(make_tracer(&draw->layers[i], error));
        ISO_TRY(iso_exact_frame_start(&draw->layers[i].frame, error));
    }
    return set_up_workers(draw, error);
}

static void free_draw(layers_draw *draw) {
    for (int i = 0; draw->layers && i < draw->input->count; i++) {
        iso_exact_frame_free(&draw->layers[i].frame);
        iso_ray_tracer_destroy(draw->layers[i].tracer);
    }
    for (int i = 0; draw->workers && i < iso_pool_threads(draw->target.pool); i++) {
        iso_layer_lists_free(&draw->workers[i].lists);
        iso_layer_composer_free(&draw->workers[i].composer);
        iso_free(draw->workers[i].rays.begin);
        iso_free(draw->workers[i].rays.inside);
    }
    iso_free(draw->workers);
    iso_free(draw->scratch);
    iso_free(draw->layers);
    iso_free(draw->slopes);
}

/* ---- rays in double precision */

static bool start_ray(const layers_draw *draw, const layer *l, int x, int y, iso_ray *ray) {
    const iso_view *view = draw->target.view;
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    return iso_ray_start(l->tracer, origin, direction, view->near, ray);
}

/* Makes a fragment from a traced crossing, as the kernel does (shade_fragments in hits_simd.h). */
static iso_fragment make_fragment(const layers_draw *draw, const layer *l, int x, int y, const iso_ray *ray,
                                  const iso_ray_hit *hit) {
    const iso_vec3 n = iso_view_vector(draw->target.view, iso_ray_hit_normal(l->tracer, ray, hit));
    const float normal[3] = {(float)n.x, (float)n.y, (float)n.z},
                to_eye[3] = {-l->paint.u[x], -l->paint.v[y], -1};
    iso_fragment fragment = {.depth = (float)(hit->t - l->frame.projection.middle),
                             .opacity = iso_layer_opacity_at(&l->fragments.opacity, normal, to_eye),
                             .surface = l->fragments.surface,
                             .leaves = hit->falls == l->fragments.fall_leaves};
    iso_shade_sample(normal, to_eye, l->input->color, fragment.color);
    for (int k = 0; k < 3 && l->fragments.normals; k++)
        fragment.color[k] = normal[k] * ISO_LAYER_NORMAL_SCALE + ISO_LAYER_NORMAL_SCALE;
    return fragment;
}

/* Whether a sample's ray is left at a hit of what is cut away. */
static bool shows(const layers_draw *draw, const layer *l, int x, int y, double t) {
    if (!l->input->clip) return true;
    iso_vec3 origin, direction;
    iso_view_ray(draw->target.view, x + 0.5, y + 0.5, &origin, &direction);
    return iso_clip_shows(l->input->clip, iso_vec3_add(origin, iso_vec3_scale(direction, t)));
}

/* Lists the fragments of a sample again, with the ray tracer. row: counted from the band's first row. */
static void retrace(const layers_draw *draw, const layer *l, iso_layer_lists *lists, int x, int row, int y) {
    iso_ray ray;
    iso_ray_hit hit;
    iso_layer_lists_restart(lists, x, row);
    if (!start_ray(draw, l, x, y, &ray)) return;
    bool done = false;
    while (!done && iso_ray_next(l->tracer, &ray, &hit)) {
        if (!shows(draw, l, x, y, hit.t)) continue;
        const iso_fragment fragment = make_fragment(draw, l, x, y, &ray, &hit);
        done = iso_layer_add(lists, x, row, &fragment, false);
    }
}

/* Traces the doubtful samples of a band again; returns their number. */
static size_t retrace_doubtful(const layers_draw *draw, const layer *l, iso_layer_lists *lists, int first) {
    size_t count = 0;
    lists->pass.tolerance = -1; /* the tracer finds each crossing only once */
    for (int row = 0; row < lists->rows; row++)
        for (int i = 0; i < lists->row_groups; i++) {
            uint64_t doubtful = lists->groups[row * lists->row_groups + i].doubtful;
            for (; doubtful; doubtful &= doubtful - 1, count++)
                retrace(draw, l, lists, i * ISO_LAYER_GROUP + __builtin_ctzll(doubtful), row, first + row);
        }
    return count;
}

/* Sets the part of a sample's ray that lies in the volume, and the solids in which it begins. */
static void set_ray(const layers_draw *draw, worker *w, int x, int y, ptrdiff_t at) {
    const layer *first = &draw->layers[0];
    const double middle = draw->middle;
    const float u = first->paint.u[x], v = first->paint.v[y];
    iso_ray ray;
    w->rays.inside[at] = 0;
    w->rays.begin[at] = w->rays.end[at] = 0;
    w->rays.length[at] = sqrtf(u * u + v * v + 1);
    for (int i = 0; i < draw->input->count; i++) {
        const layer *l = &draw->layers[i];
        if (!start_ray(draw, l, x, y, &ray)) continue;
        const bool above = iso_ray_starts_above(l->tracer, &ray), inside = above == l->fragments.fall_leaves;
        w->rays.inside[at] |= (uint64_t)inside << i;
        w->rays.begin[at] = (float)(ray.t - middle);
        w->rays.end[at] = (float)(iso_ray_end(l->tracer, &ray) - middle);
    }
}

static void set_rays(const layers_draw *draw, worker *w, iso_rows rows) {
    const int width = draw->size.width;
    for (int y = rows.first; y <= rows.last; y++)
        for (int x = 0; x < width; x++) set_ray(draw, w, x, y, (ptrdiff_t)(y - rows.first) * width + x);
}

/* ---- bands */

/* The callback iso_layer_bands.list: lists the fragments of all surfaces and of the further objects in the
 * picture. */
static bool list_rows(void *context, int number, size_t band, iso_rows rows, bool least) {
    (void)band;
    const layers_draw *draw = context;
    const iso_gbuffer *opaque = draw->input->picture.strip->gbuffer;
    worker *w = &draw->workers[number];
    iso_layer_lists *lists = &w->lists;
    size_t retraced = 0;
    lists->most_chunks = least ? 0 : BAND_CHUNKS;
    iso_layer_lists_clear(lists, rows.last - rows.first + 1);
    lists->limit = opaque->depth ? opaque->depth + (ptrdiff_t)rows.first * opaque->width : NULL;
    for (int i = 0; i < draw->input->count && !lists->full; i++) {
        iso_layer_lists_begin(lists, &draw->layers[i].pass);
        iso_exact_frame_draw(&draw->layers[i].frame, rows, &draw->scratch[number]);
        retraced += retrace_doubtful(draw, &draw->layers[i], lists, rows.first);
    }
    const iso_layer_source *source = draw->input->source;
    if (lists->full || (source && !source->list(source->context, number, lists, rows))) return false;
    if (source) source->count(source->context, number);
    w->totals.retraced += retraced;
    return true;
}

/* The callback iso_layer_bands.use: composites the listed fragments, or passes them to the reader. */
static void use_rows(void *context, int number, iso_rows rows) {
    const layers_draw *draw = context;
    const iso_exact_layers_reader *reader = draw->input->reader;
    worker *w = &draw->workers[number];
    const iso_layer_recolor recolor = {draw->target.view, draw->colors, draw->input->count};
    if (draw->needs_rays) set_rays(draw, w, rows);
    if (draw->recolors) iso_layer_lists_recolor(&w->lists, &recolor, rows.first);
    if (reader) {
        reader->read(reader->context, &w->lists, &w->rays, rows.first);
        return;
    }
    const iso_layer_media media = {draw->media, draw->input->count, &w->rays};
    iso_layers_compose(&draw->input->picture, &w->lists, draw->absorbs ? &media : NULL, rows.first,
                       &w->composer, &w->totals.layers);
}

static void sum_totals(const layers_draw *draw, iso_exact_layers_totals *totals) {
    for (int i = 0; i < iso_pool_threads(draw->target.pool); i++) {
        totals->retraced += draw->workers[i].totals.retraced;
        iso_layer_totals_add(&totals->layers, &draw->workers[i].totals.layers);
    }
}

iso_status iso_shade_exact_layers(const iso_exact_layers *input, iso_exact_layers_totals *totals,
                                  iso_error *error) {
    const iso_strip *strip = input->picture.strip;
    iso_pool *pool = input->picture.pool;
    layers_draw draw = {.input = input,
                        .size = {.width = strip->view->width, .height = strip->view->height},
                        .needs_rays = wants_normals(input)};
    draw.target = (iso_target){.view = strip->view, .gbuffer = &draw.size, .pool = pool};
    iso_status status = set_up(&draw, error);
    const iso_layer_bands bands = {strip, draw.band_rows, pool, list_rows, use_rows, &draw};
    if (status == ISO_OK) status = iso_layer_bands_draw(&bands, error);
    if (status == ISO_OK) sum_totals(&draw, totals);
    free_draw(&draw);
    return status;
}
