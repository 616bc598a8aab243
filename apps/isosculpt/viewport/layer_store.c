/* Lists of layers in memory, and blending them (Porter and Duff 1984, "Compositing digital images": over).
 *
 * The layers are listed at a low opacity, at which no layer hides those behind it. The opacity by angle is
 * 1 - (1 - a)^(1 / cos) for a surface of opacity a (Kay and Greenberg 1979), so that the opacity at which a
 * layer was listed tells 1 / cos, and from it follows the opacity for any other a. */
#include "apps/isosculpt/viewport/layer_store.h"

#include <math.h>

#include "base/exponential.h"
#include "base/memory.h"
#include "exact/layers.h"
#include "render/layers/opacity.h"

/* The opacity at which layers are listed. */
static const double LISTED_OPACITY = 0.1;

/* ---- listing */

static bool has_room(isosculpt_layer_store *store, size_t bytes) {
    const size_t before = __atomic_fetch_add(&store->bytes, bytes, __ATOMIC_RELAXED);
    return before + bytes <= store->most_bytes;
}

static bool is_full(const isosculpt_layer_store *store) {
    return __atomic_load_n(&store->full, __ATOMIC_RELAXED);
}

/* Makes a layer. color: 0 .. 1; opacity: the one at which the layer was listed. */
static isosculpt_stored_layer make_layer(float depth, const float color[3], float opacity) {
    isosculpt_stored_layer layer = {.depth = depth,
                                    .slant = (uint16_t)(opacity * (ISOSCULPT_SLANTS - 1) + 0.5f)};
    for (int k = 0; k < 3; k++) layer.color[k] = (uint16_t)(color[k] * 65535 + 0.5f);
    return layer;
}

static isosculpt_stored_layer store_layer(const iso_packed_fragment *packed, float middle) {
    const iso_fragment fragment = iso_fragment_unpack(packed);
    return make_layer(fragment.depth + middle, fragment.color, fragment.opacity);
}

/* Copies the layers of sample x. `end`: number of layers stored in the row so far; returns the new number. */
static uint32_t store_sample(const iso_layer_lists *lists, int x, int row, uint32_t end,
                             isosculpt_stored_layer *layers) {
    const iso_layer_group *group = iso_layer_group_at(lists, x, row);
    const int column = x % ISO_LAYER_GROUP, count = group->list[column].count;
    for (int k = 0; k < count; k++)
        layers[end++] = store_layer(&iso_layer_at(group, k)[column], lists->middle);
    return end;
}

/* Allocates a row for so many layers; returns NULL, and sets store->full, if there is no memory. */
static isosculpt_layer_row *make_row(isosculpt_layer_store *store, int y, size_t count) {
    const size_t width = (size_t)store->width,
                 bytes = width * sizeof(uint32_t) + count * sizeof(isosculpt_stored_layer);
    isosculpt_layer_row *row = &store->rows[y];
    row->ends = has_room(store, bytes) ? iso_alloc(bytes) : NULL;
    if (row->ends)
        row->layers = (isosculpt_stored_layer *)(row->ends + width);
    else
        __atomic_store_n(&store->full, true, __ATOMIC_RELAXED);
    return row->ends ? row : NULL;
}

static void store_row(isosculpt_layer_store *store, const iso_layer_lists *lists, int row, int y) {
    size_t count = 0;
    for (int x = 0; x < lists->width; x++)
        count += (size_t)iso_layer_group_at(lists, x, row)->list[x % ISO_LAYER_GROUP].count;
    isosculpt_layer_row *to = make_row(store, y, count);
    if (!to) return;
    uint32_t end = 0;
    for (int x = 0; x < lists->width; x++) to->ends[x] = end = store_sample(lists, x, row, end, to->layers);
}

/* The callback iso_exact_layers_reader.read. */
static void store_band(void *context, const iso_layer_lists *lists, const iso_layer_rays *rays, int first) {
    isosculpt_layer_store *store = context;
    (void)rays;
    for (int row = 0; row < lists->rows && !is_full(store); row++) store_row(store, lists, row, first + row);
}

static void free_layers(isosculpt_layer_store *store) {
    for (int y = 0; y < store->height; y++) iso_free(store->rows[y].ends);
    store->width = store->height = 0;
    store->bytes = 0;
    store->full = false;
}

static iso_status reserve_rows(isosculpt_layer_store *store, int height, iso_error *error) {
    if (store->row_room < height) {
        iso_free(store->rows);
        store->row_room = 0;
        store->rows = iso_alloc((size_t)height * sizeof *store->rows);
        if (!store->rows) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for layers");
        store->row_room = height;
    }
    for (int y = 0; y < height; y++) store->rows[y] = (isosculpt_layer_row){.ends = NULL};
    return ISO_OK;
}

/* Frees the layers, and allocates the rows for another view. */
static iso_status begin_list(isosculpt_layer_store *store, const iso_view *view, iso_error *error) {
    free_layers(store);
    ISO_TRY(reserve_rows(store, view->height, error));
    store->width = view->width;
    store->height = view->height;
    return ISO_OK;
}

static iso_status end_list(isosculpt_layer_store *store, iso_status status, iso_error *error) {
    if (status == ISO_OK && store->full)
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for layers: %.3g MB are needed, or more",
                          1e-6 * (double)store->bytes);
    if (status != ISO_OK) free_layers(store);
    return status;
}

iso_status isosculpt_layer_store_list(isosculpt_layer_store *store, const isosculpt_layer_surface *surface,
                                      const iso_view *view, iso_pool *pool, iso_error *error) {
    const iso_gbuffer size = {.width = view->width, .height = view->height};
    const iso_strip strip = {.view = view, .gbuffer = &size, .factor = 1};
    const iso_surface_colors colors =
        surface->labels ? iso_label_painter_colors(surface->labels) : (iso_surface_colors){.at = NULL};
    const iso_exact_layer layer = {
        surface->exact, surface->color, {.opacity = (float)LISTED_OPACITY}, NULL, colors.at ? &colors : NULL};
    const iso_exact_layers_reader reader = {.shaded = true, .read = store_band, .context = store};
    const iso_exact_layers layers = {
        .layers = &layer, .count = 1, .picture = {.strip = &strip, .pool = pool}, .reader = &reader};
    iso_exact_layers_totals totals = {.retraced = 0};
    ISO_TRY(begin_list(store, view, error));
    return end_list(store, iso_shade_exact_layers(&layers, &totals, error), error);
}

/* ---- listing the front layer, and solids */

/* The state shared by the threads that store rows of samples. */
typedef struct front_pass {
    isosculpt_layer_store *store;
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    iso_layer_opacity opacity;
    iso_rgb color;
    bool solid; /* lines and glyphs */
} front_pass;

/* Returns the unshaded colour of a sample. */
static iso_rgb base_color(const front_pass *pass, size_t at) {
    const uint32_t own = pass->gbuffer->color ? pass->gbuffer->color[at] : 0;
    if (own >> 24 != pass->gbuffer->surface[at] + 1u) return pass->color;
    return (iso_rgb){(uint8_t)own, (uint8_t)(own >> 8), (uint8_t)(own >> 16)};
}

static isosculpt_stored_layer shade_front(const front_pass *pass, size_t at, const float to_eye[3]) {
    const iso_gbuffer *g = pass->gbuffer;
    const float normal[3] = {g->normal[0][at], g->normal[1][at], g->normal[2][at]};
    float rgb[3];
    iso_shade_sample(normal, to_eye, base_color(pass, at), rgb);
    for (int k = 0; k < 3; k++) rgb[k] = fminf(rgb[k], 1);
    isosculpt_stored_layer layer =
        make_layer(g->depth[at], rgb, iso_layer_opacity_at(&pass->opacity, normal, to_eye));
    if (pass->solid) layer.slant = ISOSCULPT_SOLID;
    return layer;
}

static void store_front_row(void *context, size_t y, int worker) {
    (void)worker;
    const front_pass *pass = context;
    const iso_view *view = pass->view;
    const size_t width = (size_t)view->width;
    isosculpt_layer_row *row = make_row(pass->store, (int)y, width);
    if (!row) return;
    const float v = view->orthographic ? 0 : (float)(((double)y + 0.5 - view->cy) / view->focal);
    uint32_t end = 0;
    for (size_t x = 0; x < width; x++) {
        const float u = view->orthographic ? 0 : (float)(((double)x + 0.5 - view->cx) / view->focal);
        const float to_eye[3] = {-u, -v, -1};
        if (pass->gbuffer->surface[y * width + x] != ISO_SURFACE_NONE)
            row->layers[end++] = shade_front(pass, y * width + x, to_eye);
        row->ends[x] = end;
    }
}

/* The surface or the sets of shapes to list. */
typedef struct front_subject {
    const isosculpt_layer_surface *surface; /* NULL: shapes */
    const iso_shapes *const *sets;
    int count;
    iso_rgb color; /* of shapes */
} front_subject;

static iso_status draw_front(const front_subject *subject, iso_target *target, iso_error *error) {
    const isosculpt_layer_surface *surface = subject->surface;
    if (surface) ISO_TRY(iso_draw_exact(target, surface->exact, error));
    if (surface && surface->labels)
        return iso_label_colors_paint(surface->labels->colors, 0, target->view, target->gbuffer, target->pool,
                                      error);
    for (int i = 0; i < subject->count; i++) {
        target->surface = (uint8_t)i;
        ISO_TRY(iso_draw_shapes(target, subject->sets[i], NULL, error));
    }
    return ISO_OK;
}

static iso_status list_front(isosculpt_layer_store *store, const front_subject *subject, const iso_view *view,
                             iso_pool *pool, iso_error *error) {
    const iso_translucency translucency = {.opacity = (float)LISTED_OPACITY};
    iso_gbuffer gbuffer;
    front_pass pass = {store,
                       view,
                       &gbuffer,
                       iso_layer_opacity_make(&translucency),
                       subject->surface ? subject->surface->color : subject->color,
                       !subject->surface};
    ISO_TRY(begin_list(store, view, error));
    iso_status status = iso_gbuffer_create(view->width, view->height, &gbuffer, error);
    if (status != ISO_OK) return end_list(store, status, error);
    iso_target target = {.view = view, .gbuffer = &gbuffer, .pool = pool};
    iso_gbuffer_clear(&gbuffer);
    status = draw_front(subject, &target, error);
    if (status == ISO_OK) iso_parallel_for(pool, (size_t)view->height, store_front_row, &pass);
    iso_gbuffer_free(&gbuffer);
    return end_list(store, status, error);
}

iso_status isosculpt_layer_store_list_front(isosculpt_layer_store *store,
                                            const isosculpt_layer_surface *surface, const iso_view *view,
                                            iso_pool *pool, iso_error *error) {
    const front_subject subject = {.surface = surface};
    return list_front(store, &subject, view, pool, error);
}

iso_status isosculpt_layer_store_list_shapes(isosculpt_layer_store *store, const iso_shapes *const *sets,
                                             int count, iso_rgb color, const iso_view *view, iso_pool *pool,
                                             iso_error *error) {
    const front_subject subject = {.sets = sets, .count = count, .color = color};
    return list_front(store, &subject, view, pool, error);
}

void isosculpt_layer_store_free(isosculpt_layer_store *store) {
    free_layers(store);
    iso_free(store->rows);
    store->rows = NULL;
    store->row_room = 0;
}

/* ---- blending */

void isosculpt_slant_opacities_set(isosculpt_slant_opacities *opacities, double face_on) {
    if (opacities->face_on == (float)face_on) return;
    opacities->face_on = (float)face_on;
    const double listed = iso_log2(1 - LISTED_OPACITY);
    for (int i = 0; i < ISOSCULPT_SLANTS; i++) {
        const double stopped = fmin((double)i / (ISOSCULPT_SLANTS - 1), 1 - 0.5 / ISOSCULPT_SLANTS);
        const double thickness = iso_log2(1 - stopped) / listed; /* 1 / cos */
        opacities->opacity[i] = face_on < 1 ? 1 - iso_exp2((float)(thickness * iso_log2(1 - face_on))) : 1;
    }
}

static float opacity_of(const isosculpt_layer_blend *b, const isosculpt_stored_layer *layer, float surface) {
    if (layer->slant != ISOSCULPT_SOLID) return b->opacities->opacity[layer->slant];
    return layer->depth < surface ? 1 : b->opacities->face_on;
}

/* Blends the layers of a sample over the colour. `surface`: depth of the surface at the sample. */
static void blend_sample(const isosculpt_layer_blend *b, const isosculpt_layer_row *row, int x, float surface,
                         uint8_t rgba[4]) {
    const isosculpt_stored_layer *layer = row->layers + (x ? row->ends[x - 1] : 0),
                                 *end = row->layers + row->ends[x];
    const float limit = b->through ? INFINITY : surface;
    if (layer == end || !(layer->depth < limit)) return;
    float through = 1, rgb[3] = {0, 0, 0};
    for (; layer < end && layer->depth < limit && through >= ISO_LAYER_CUT; layer++) {
        const float stopped = through * opacity_of(b, layer, surface);
        for (int k = 0; k < 3; k++) rgb[k] += stopped * layer->color[k];
        through -= stopped;
    }
    for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)(rgb[k] * (255 / 65535.0f) + through * rgba[k] + 0.5f);
}

/* Returns the sample of the store at the middle of pixel `at`, for a store of `samples` and a picture of
 * `pixels` along an axis. */
static int find_sample(int at, int pixels, int samples) {
    return pixels == samples ? at : (int)((2 * (int64_t)at + 1) * samples / (2 * (int64_t)pixels));
}

static void blend_row(void *context, size_t index, int worker) {
    (void)worker;
    const isosculpt_layer_blend *b = context;
    const isosculpt_layer_store *store = b->store;
    const isosculpt_layer_row *row = &store->rows[find_sample(b->y0 + (int)index, b->height, store->height)];
    const size_t first = index * (size_t)b->image->width;
    for (int x = 0; x < b->image->width; x++) {
        const size_t at = first + (size_t)x;
        blend_sample(b, row, find_sample(b->x0 + x, b->width, store->width),
                     b->surface->depth[at] - b->behind, b->image->rgba + 4 * at);
    }
}

void isosculpt_layer_store_blend(const isosculpt_layer_blend *blend) {
    iso_parallel_for(blend->pool, (size_t)blend->image->height, blend_row, (void *)blend);
}
