/* The reference in a viewport's pictures: decides when its layers are listed, and how they are blended. */
#include "apps/isosculpt/viewport/reference.h"

#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/viewport/layer_store.h"
#include "base/clock.h"
#include "base/memory.h"

/* FACTOR: width of a sample in pixels while the camera moves. It is adapted to the time that listing takes:
 * fewer samples above the first limit (seconds), more samples below the second one. If even the fewest
 * samples take longer than the third limit, only the front layers are listed, and finally none. */
enum { FACTOR_LEAST = 2, FACTOR_MOST = 6 };
static const double TOO_SLOW = 0.020, FAST = 0.006, MUCH_TOO_SLOW = 0.060;

/* The layers of a fine picture are listed for about this many samples at a time, to limit memory. */
enum { FINE_SAMPLES = 1 << 18 };

/* How many voxels nearer than the sculpture a layer must be to lie in front of it. Without this tolerance,
 * places where both are equal would flicker, because the surface of an edited brick moves by rounding. */
static const double IN_FRONT = 0.1;

/* What is listed while the camera moves. */
typedef enum listing { LIST_ALL, LIST_FRONT, LIST_NOTHING } listing;

struct isosculpt_reference {
    /* A surface: */
    iso_hgrid *grid;                    /* owned, but by `labels` if there are some */
    isosculpt_reference_labels *labels; /* owned; NULL: the surface has the colour of the mode */
    iso_label_painter painter;          /* of them */
    iso_pool *pool;                     /* the pool that extracted the surface */
    iso_exact *exact;
    /* Lines and glyphs; set_count 0: the reference is a surface. */
    isosculpt_reference_shapes sets[ISOSCULPT_REFERENCE_SHAPES];
    int set_count;
    isosculpt_slant_opacities opacities;
    isosculpt_layer_store kept, fine;
    /* The picture that `kept` was listed for: */
    iso_camera camera;
    int width, height, factor; /* of the picture; pixels to a sample and axis */
    iso_rgb color;
    int moving_factor;
    listing moving_listing;
};

/* ---- creating and destroying */

static iso_status extract(isosculpt_reference *reference, int threads, iso_error *error) {
    const iso_grid grid = {.hgrid = reference->grid};
    ISO_TRY(iso_pool_create(threads, &reference->pool, error));
    const iso_exact_opts opts = {.pool = reference->pool};
    ISO_TRY(iso_exact_create(&grid, &opts, &reference->exact, error));
    return iso_exact_update(reference->exact, error);
}

/* Allocates a reference; returns NULL and sets *error if there is no memory. */
static isosculpt_reference *make_reference(iso_error *error) {
    isosculpt_reference *reference = iso_alloc_zero(1, sizeof *reference);
    if (!reference) {
        iso_fail(error, ISO_ERR_NOMEM, "out of memory for the reference");
        return NULL;
    }
    reference->moving_factor = FACTOR_LEAST;
    reference->kept.most_bytes = reference->fine.most_bytes = ISOSCULPT_REFERENCE_BYTES;
    return reference;
}

iso_status isosculpt_reference_create(iso_hgrid *grid, int threads, isosculpt_reference **out,
                                      iso_error *error) {
    isosculpt_reference *reference = make_reference(error);
    if (!reference) {
        iso_hgrid_destroy(grid);
        return ISO_ERR_NOMEM;
    }
    reference->grid = grid;
    iso_status status = extract(reference, threads, error);
    if (status == ISO_OK)
        *out = reference;
    else
        isosculpt_reference_destroy(reference);
    return status;
}

void isosculpt_reference_labels_free(isosculpt_reference_labels *labels) {
    if (!labels) return;
    iso_segmentation_free(&labels->segmentation);
    iso_pool_destroy(labels->pool);
    free(labels);
}

iso_status isosculpt_reference_create_labels(isosculpt_reference_labels *labels, int threads,
                                             isosculpt_reference **out, iso_error *error) {
    isosculpt_reference *reference = make_reference(error);
    if (!reference) {
        isosculpt_reference_labels_free(labels);
        return ISO_ERR_NOMEM;
    }
    reference->labels = labels;
    reference->grid = iso_label_fields_grid(labels->segmentation.fields, 1);
    reference->painter = iso_label_painter_make(&labels->segmentation.shared);
    const iso_status status = extract(reference, threads, error);
    if (status == ISO_OK)
        *out = reference;
    else
        isosculpt_reference_destroy(reference);
    return status;
}

void isosculpt_reference_shapes_free(isosculpt_reference_shapes *shapes) {
    iso_shapes_destroy(shapes->shapes);
    iso_object_file_free(&shapes->file);
    *shapes = (isosculpt_reference_shapes){.shapes = NULL};
}

iso_status isosculpt_reference_create_shapes(isosculpt_reference_shapes *sets, int count,
                                             isosculpt_reference **out, iso_error *error) {
    isosculpt_reference *reference = make_reference(error);
    for (int i = 0; i < count && !reference; i++) isosculpt_reference_shapes_free(&sets[i]);
    if (!reference) return ISO_ERR_NOMEM;
    memcpy(reference->sets, sets, (size_t)count * sizeof *sets);
    reference->set_count = count;
    *out = reference;
    return ISO_OK;
}

void isosculpt_reference_destroy(isosculpt_reference *reference) {
    if (!reference) return;
    for (int i = 0; i < reference->set_count; i++) isosculpt_reference_shapes_free(&reference->sets[i]);
    isosculpt_layer_store_free(&reference->kept);
    isosculpt_layer_store_free(&reference->fine);
    iso_exact_destroy(reference->exact);
    iso_pool_destroy(reference->pool);
    if (!reference->labels) iso_hgrid_destroy(reference->grid);
    isosculpt_reference_labels_free(reference->labels);
    iso_free(reference);
}

void isosculpt_viewport_set_reference(isosculpt_viewport *viewport, isosculpt_reference *reference) {
    isosculpt_reference_destroy(viewport->reference);
    viewport->reference = reference;
}

bool isosculpt_viewport_shows_reference(const isosculpt_viewport *viewport) {
    return viewport->reference && viewport->reference_mode.shown && !viewport->lod;
}

/* ---- listing */

/* Hides the reference after a failure, and frees its layers. */
static void hide(isosculpt_viewport *viewport, const iso_error *reason) {
    viewport->reference_error = *reason;
    viewport->reference_mode.shown = false;
    viewport->quality = ISOSCULPT_QUALITY_MOVING; /* the picture is soon drawn again, without the reference */
    isosculpt_layer_store_free(&viewport->reference->kept);
    isosculpt_layer_store_free(&viewport->reference->fine);
}

/* Returns whether the kept layers are those of the viewport's camera, for any number of samples. */
static bool has_layers(const isosculpt_viewport *viewport) {
    const isosculpt_reference *r = viewport->reference;
    return r->kept.width && r->width == viewport->width && r->height == viewport->height &&
           iso_camera_equal(&r->camera, &viewport->camera) &&
           iso_rgb_equal(r->color, viewport->reference_mode.color);
}

bool isosculpt_reference_is_coarse(const isosculpt_viewport *viewport) {
    return isosculpt_viewport_shows_reference(viewport) &&
           (!has_layers(viewport) || viewport->reference->factor > 1);
}

/* Lists the layers or shapes of the reference in a view. */
static iso_status list_in(const isosculpt_viewport *viewport, isosculpt_layer_store *store, listing what,
                          const iso_view *view, iso_error *error) {
    const isosculpt_reference *r = viewport->reference;
    const iso_rgb color = viewport->reference_mode.color;
    const iso_shapes *sets[ISOSCULPT_REFERENCE_SHAPES];
    for (int i = 0; i < r->set_count; i++) sets[i] = r->sets[i].shapes;
    if (r->set_count)
        return isosculpt_layer_store_list_shapes(store, sets, r->set_count, color, view, viewport->pool,
                                                 error);
    const isosculpt_layer_surface surface = {r->exact, color, r->labels ? &r->painter : NULL};
    return (what == LIST_ALL ? isosculpt_layer_store_list : isosculpt_layer_store_list_front)(
        store, &surface, view, viewport->pool, error);
}

static iso_status list_kept(isosculpt_viewport *viewport, int factor, listing what, iso_error *error) {
    isosculpt_reference *r = viewport->reference;
    const iso_view view = iso_view_make(&viewport->camera, (viewport->width + factor - 1) / factor,
                                        (viewport->height + factor - 1) / factor);
    r->camera = viewport->camera;
    r->width = viewport->width;
    r->height = viewport->height;
    r->factor = factor;
    r->color = viewport->reference_mode.color;
    return list_in(viewport, &r->kept, what, &view, error);
}

static void adapt_moving(isosculpt_reference *r, double seconds) {
    const bool fewest = r->moving_factor == FACTOR_MOST, most = r->moving_factor == FACTOR_LEAST;
    if (fewest && seconds > MUCH_TOO_SLOW && r->moving_listing != LIST_NOTHING) r->moving_listing++;
    if (most && seconds < FAST && r->moving_listing != LIST_ALL) r->moving_listing--;
    if (!fewest && seconds > TOO_SLOW) r->moving_factor++;
    if (!most && seconds < FAST) r->moving_factor--;
}

/* Lists the layers for the viewport's camera unless they exist; returns false if there are none. */
static bool prepare(isosculpt_viewport *viewport, bool moving) {
    isosculpt_reference *r = viewport->reference;
    iso_error reason = {ISO_OK, ""};
    const bool listed = has_layers(viewport);
    if (listed && (moving || r->factor == 1)) return true;
    if (moving && r->moving_listing == LIST_NOTHING) return false;
    const double start = iso_clock_seconds();
    if (list_kept(viewport, moving ? r->moving_factor : 1, moving ? r->moving_listing : LIST_ALL, &reason) !=
        ISO_OK) {
        hide(viewport, &reason);
        return false;
    }
    if (moving)
        adapt_moving(r, iso_clock_seconds() - start);
    else if (r->moving_listing == LIST_NOTHING)
        r->moving_listing = LIST_FRONT; /* tried again with the same camera */
    return true;
}

/* ---- blending */

/* Returns how a store is blended over an image with the samples of `gbuffer`, which covers the whole
 * picture. */
static isosculpt_layer_blend make_blend(const isosculpt_viewport *viewport,
                                        const isosculpt_layer_store *store, const iso_gbuffer *gbuffer,
                                        iso_image *image) {
    isosculpt_reference *r = viewport->reference;
    const isosculpt_reference_mode *mode = &viewport->reference_mode;
    isosculpt_slant_opacities_set(&r->opacities, mode->opacity);
    return (isosculpt_layer_blend){.store = store,
                                   .opacities = &r->opacities,
                                   .width = image->width,
                                   .height = image->height,
                                   .surface = gbuffer,
                                   .behind = r->grid ? (float)(IN_FRONT * r->grid->transform.spacing[0]) : 0,
                                   .through = mode->over,
                                   .image = image,
                                   .pool = viewport->pool};
}

void isosculpt_reference_blend_whole(isosculpt_viewport *viewport, bool moving) {
    if (!isosculpt_viewport_shows_reference(viewport) || !prepare(viewport, moving)) return;
    const isosculpt_layer_blend blend =
        make_blend(viewport, &viewport->reference->kept, &viewport->drawn.gbuffer, &viewport->image);
    isosculpt_layer_store_blend(&blend);
}

void isosculpt_reference_blend_tile(isosculpt_viewport *viewport, isosculpt_rectangle part) {
    if (!isosculpt_viewport_shows_reference(viewport) || !has_layers(viewport)) return;
    isosculpt_layer_blend blend =
        make_blend(viewport, &viewport->reference->kept, &viewport->tile, &viewport->tile_image);
    blend.width = viewport->image.width;
    blend.height = viewport->image.height;
    blend.x0 = part.x0;
    blend.y0 = part.y0;
    isosculpt_layer_store_blend(&blend);
}

/* Returns the rows `first` .. first + rows - 1 of a gbuffer. */
static iso_gbuffer gbuffer_rows(const iso_gbuffer *gbuffer, int first, int rows) {
    const size_t at = (size_t)first * (size_t)gbuffer->width;
    return (iso_gbuffer){.width = gbuffer->width, .height = rows, .depth = gbuffer->depth + at};
}

/* Blends the reference over `rows` rows of the image of a tile, from row `first` on. `part`: the samples of
 * the tile in `whole`. */
static iso_status blend_rows(isosculpt_viewport *viewport, const iso_view *whole, iso_image *image,
                             const isosculpt_rectangle *part, int first, int rows, iso_error *error) {
    isosculpt_reference *r = viewport->reference;
    iso_view view = iso_view_rows(whole, part->y0 + first, rows);
    iso_image pixels = {.width = image->width,
                        .height = rows,
                        .rgba = image->rgba + 4 * (size_t)first * (size_t)image->width};
    const iso_gbuffer surface = gbuffer_rows(&viewport->tile, first, rows);
    if (!r->set_count) { /* shapes have the same samples only in whole rows */
        view.cx -= part->x0;
        view.width = image->width;
    }
    ISO_TRY(list_in(viewport, &r->fine, LIST_ALL, &view, error));
    isosculpt_layer_blend blend = make_blend(viewport, &r->fine, &surface, &pixels);
    blend.width = view.width;
    blend.x0 = r->set_count ? part->x0 : 0;
    isosculpt_layer_store_blend(&blend);
    return ISO_OK;
}

void isosculpt_reference_blend_fine(isosculpt_viewport *viewport, isosculpt_rectangle part, int factor,
                                    iso_image *image) {
    const iso_view whole = iso_view_scaled(&viewport->drawn.view, factor);
    const isosculpt_rectangle samples = {part.x0 * factor, part.y0 * factor, part.x1 * factor,
                                         part.y1 * factor};
    const int most = FINE_SAMPLES / (viewport->reference->set_count ? whole.width : image->width) + 1;
    iso_error reason = {ISO_OK, ""};
    for (int first = 0; first < image->height && isosculpt_viewport_shows_reference(viewport);
         first += most) {
        const int rows = image->height - first < most ? image->height - first : most;
        if (blend_rows(viewport, &whole, image, &samples, first, rows, &reason) != ISO_OK)
            hide(viewport, &reason);
    }
}
