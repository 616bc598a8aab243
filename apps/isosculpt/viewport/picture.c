/* The picture of a viewport: drawn as a whole, or only where an edit changed it; then refined with four
 * samples a pixel. */
#include <string.h>

#include "apps/isosculpt/viewport/async_surface.h"
#include "apps/isosculpt/viewport/color_by.h"
#include "apps/isosculpt/viewport/masked.h"
#include "apps/isosculpt/viewport/memory.h"
#include "apps/isosculpt/viewport/reference.h"
#include "apps/isosculpt/viewport/see_through.h"
#include "apps/isosculpt/viewport/shown.h"
#include "base/clock.h"
#include "render/shading/outline.h"

/* Seconds for a picture while the camera moves: above the first limit the next picture gets fewer samples,
 * below the second one more. */
static const double TOO_SLOW = 0.020, FAST = 0.006;
/* Seconds: if even a picture with the fewest samples takes longer, translucent surfaces are drawn without
 * some of their layers while the camera moves, until another isovalue is chosen. */
static const double MUCH_TOO_SLOW = 0.060;
/* A picture at rest is refined in tiles of so many pixels, so that events are handled between two tiles (with
 * layers, which take longer, of fewer); samples along a refined pixel. */
enum { TILE_PIXELS = 1 << 17, LAYERS_TILE_PIXELS = 1 << 15, TILE_FACTOR = 2 };

/* ---- extracting */

/* Updates a part of the surface. `quick`: for volumes the points of a level of detail instead. */
static iso_status extract_part(isosculpt_viewport *viewport, iso_part part, bool quick, iso_error *error) {
    double start = iso_clock_seconds();
    if (quick && viewport->lod)
        ISO_TRY(isosculpt_lod_update(viewport->lod, viewport->isovalue, error));
    else
        ISO_TRY(isosculpt_async_surface_update(viewport, part, error));
    if (!quick && isosculpt_viewport_has_second(viewport))
        ISO_TRY(isosculpt_async_surface_update(viewport, ISOSCULPT_PART_SECOND, error));
    if (iso_change_log_now(iso_grid_log(&viewport->grid)) != viewport->drawn_edit ||
        viewport->isovalue != viewport->drawn_isovalue)
        isosculpt_latency_add(&viewport->extract, iso_clock_seconds() - start);
    return ISO_OK;
}

/* ---- drawing */

/* Whether a picture gets the viewport's light; `hurried`: there is no time. */
static bool is_lit(const isosculpt_viewport *viewport, bool hurried) {
    return !hurried && isosculpt_viewport_has_light(viewport);
}

static isosculpt_rectangle whole_image(const isosculpt_viewport *viewport) {
    return (isosculpt_rectangle){0, 0, viewport->image.width, viewport->image.height};
}

/* Begins a whole picture; the layer of samples is empty until finish_whole. */
static void begin_whole(isosculpt_viewport *viewport, int factor) {
    isosculpt_pick_buffer *drawn = &viewport->drawn;
    drawn->samples = 0;
    drawn->canvas = NULL;
    drawn->view = iso_view_make(&viewport->camera, (viewport->width + factor - 1) / factor,
                                (viewport->height + factor - 1) / factor);
    viewport->drawn_exactly = viewport->drawn_lit = false;
}

/* Returns how the reference is drawn now; it is not shown if there is none. */
static isosculpt_reference_mode shown_reference(const isosculpt_viewport *viewport) {
    isosculpt_reference_mode mode = viewport->reference_mode;
    mode.shown = isosculpt_viewport_shows_reference(viewport);
    return mode;
}

static void finish_whole(isosculpt_viewport *viewport) {
    viewport->drawn.samples = (double)viewport->drawn.view.width / viewport->width;
    viewport->drawn_camera = viewport->camera;
    viewport->drawn_mode = viewport->mode;
    viewport->drawn_isovalue = viewport->isovalue;
    viewport->drawn_see_through = viewport->see_through;
    viewport->drawn_opaque = viewport->opaque;
    viewport->drawn_style = viewport->style;
    viewport->drawn_painted = isosculpt_viewport_is_painted(viewport);
    viewport->drawn_reference_mode = shown_reference(viewport);
}

/* Lays the reference picture behind what was drawn. */
static void blend_backdrop(const isosculpt_viewport *viewport, const iso_view *samples,
                           const iso_gbuffer *gbuffer, int factor, iso_image *image) {
    const isosculpt_material material = isosculpt_viewport_material(viewport);
    isosculpt_backdrop_blend(viewport->backdrop, samples, gbuffer, factor, material.background, image,
                             viewport->pool);
}

/* Draws the samples to pick from of a picture with translucent surfaces: those of the front surface, drawn as
 * if all were opaque. */
static iso_status draw_picks(isosculpt_viewport *viewport, iso_error *error) {
    isosculpt_pick_buffer *drawn = &viewport->drawn;
    isosculpt_shown shown;
    ISO_TRY(isosculpt_shown_list(viewport, ISO_METHOD_EXACT, 1, false, &shown, error));
    iso_gbuffer_clear_bands(&drawn->gbuffer, viewport->pool);
    return iso_scene_draw(&shown.scene, &drawn->view, &drawn->gbuffer, viewport->pool, error);
}

/* Draws the whole picture with the cpu engine, one sample for factor x factor pixels. `hurried`: the
 * reference may have fewer samples. */
static iso_status draw_whole(isosculpt_viewport *viewport, iso_method method, int factor, bool hurried,
                             iso_error *error) {
    isosculpt_pick_buffer *drawn = &viewport->drawn;
    begin_whole(viewport, factor);
    const int width = drawn->view.width, height = drawn->view.height;
    ISO_TRY(isosculpt_reserve_samples(&drawn->gbuffer, width, height, error));
    ISO_TRY(isosculpt_reserve_pixels(&viewport->image, &viewport->image_room, width, height, error));
    const bool lit = is_lit(viewport, hurried),
               quick = isosculpt_viewport_is_see_through(viewport) && method != ISO_METHOD_EXACT;
    if (quick)
        ISO_TRY(isosculpt_see_through_draw_quick(viewport, error));
    else
        ISO_TRY(isosculpt_shown_render(viewport, method, &drawn->view, 1, lit, 1, &drawn->gbuffer,
                                       &viewport->image, error));
    if (!quick && isosculpt_viewport_is_translucent(viewport)) {
        if (factor == 1)
            ISO_TRY(draw_picks(viewport, error));
        else
            iso_gbuffer_clear_bands(&drawn->gbuffer, viewport->pool);
    }
    isosculpt_reference_blend_whole(viewport, hurried);
    blend_backdrop(viewport, &drawn->view, &drawn->gbuffer, 1, &viewport->image);
    finish_whole(viewport);
    viewport->drawn_lit = lit;
    viewport->drawn_exactly = method == ISO_METHOD_EXACT && factor == 1;
    viewport->redrawn = viewport->unrefined =
        (isosculpt_damage){.rectangle = {whole_image(viewport)}, .count = 1};
    return ISO_OK;
}

/* ---- drawing by OpenGL */

static bool is_by_gl(const isosculpt_viewport *viewport, bool moving) {
    const isosculpt_display_mode *mode = &viewport->mode;
    return viewport->gl && mode->engine == ISOSCULPT_ENGINE_GL && !viewport->mask.at &&
           !isosculpt_backdrop_is_shown(viewport->backdrop) && !isosculpt_viewport_is_see_through(viewport) &&
           !isosculpt_viewport_shows_reference(viewport) && !isosculpt_viewport_is_cut(viewport) &&
           !isosculpt_viewport_is_colored(viewport) && !isosculpt_viewport_is_painted(viewport) &&
           !is_lit(viewport, moving) && (mode->method != ISO_METHOD_EXACT || moving);
}

/* Draws the picture of drawn.view with factor x factor samples a pixel. */
static iso_status draw_canvas(isosculpt_viewport *viewport, iso_method method, int factor, iso_error *error) {
    const isosculpt_material material = isosculpt_viewport_material(viewport);
    const isosculpt_matcap *matcap = isosculpt_material_matcap(&material, &viewport->matcap);
    const iso_gl_paint paint = {.factor = factor,
                                .color = material.color,
                                .background = material.background,
                                .sphere = matcap ? matcap->rgb[0][0] : NULL,
                                .sphere_side = ISOSCULPT_MATCAP_SIDE};
    const iso_view samples = iso_view_scaled(&viewport->drawn.view, factor);
    iso_gl_canvas *canvas;
    if (method == ISO_METHOD_MESH) {
        iso_mesh_view mesh = iso_mesh_set_view(viewport->surface.mesh);
        ISO_TRY(isosculpt_gl_draw_mesh(viewport->gl, &mesh, &samples, &paint, &canvas, error));
    } else {
        iso_point_view points = iso_point_set_view(viewport->drawn_points);
        const iso_reconstruction reconstruction = isosculpt_reconstruction(method);
        ISO_TRY(isosculpt_gl_draw_points(viewport->gl, &points,
                                         method == ISO_METHOD_POINTS ? NULL : &reconstruction, &samples,
                                         &paint, &canvas, error));
    }
    viewport->drawn.canvas = canvas;
    return ISO_OK;
}

/* Switches to the cpu engine after an error of the driver, so that the user's work is not lost. */
static void fall_back_to_cpu(isosculpt_viewport *viewport, const iso_error *reason) {
    viewport->gl_error = *reason;
    viewport->mode.engine = ISOSCULPT_ENGINE_CPU;
    viewport->quality = ISOSCULPT_QUALITY_MOVING;
    viewport->drawn.samples = 0;
}

/* Draws the whole picture by OpenGL; false: it failed, and the cpu engine is chosen now. */
static bool draw_whole_by_gl(isosculpt_viewport *viewport, iso_method method, int factor) {
    iso_error reason = {ISO_OK, ""};
    begin_whole(viewport, factor);
    if (draw_canvas(viewport, method, 1, &reason) != ISO_OK) {
        fall_back_to_cpu(viewport, &reason);
        return false;
    }
    finish_whole(viewport);
    viewport->redrawn = viewport->unrefined =
        (isosculpt_damage){.count = 0}; /* no rectangle of the image shows this picture */
    return true;
}

iso_status isosculpt_viewport_read_back(isosculpt_viewport *viewport, iso_error *error) {
    const iso_view *v = &viewport->drawn.view;
    if (!viewport->drawn.canvas) return ISO_OK;
    ISO_TRY(isosculpt_reserve_pixels(&viewport->image, &viewport->image_room, v->width, v->height, error));
    return iso_gl_canvas_read(viewport->drawn.canvas, &viewport->image, error);
}

/* ---- tiles: parts of the picture */

/* The view of a part of a picture. */
static iso_view tile_view(const iso_view *picture, isosculpt_rectangle r) {
    iso_view tile = iso_view_rows(picture, r.y0, r.y1 - r.y0);
    tile.cx -= r.x0;
    tile.width = r.x1 - r.x0;
    return tile;
}

/* Copies part `r` of the picture from the tile of part `of`, which contains it. */
static void copy_tile_pixels(isosculpt_viewport *viewport, isosculpt_rectangle r, isosculpt_rectangle of) {
    const size_t bytes = (size_t)(r.x1 - r.x0) * 4, width = (size_t)(of.x1 - of.x0);
    for (int y = r.y0; y < r.y1; y++)
        memcpy(viewport->image.rgba + ((size_t)y * (size_t)viewport->image.width + (size_t)r.x0) * 4,
               viewport->tile_image.rgba + ((size_t)(y - of.y0) * width + (size_t)(r.x0 - of.x0)) * 4, bytes);
}

static iso_status copy_tile_samples(isosculpt_viewport *viewport, isosculpt_rectangle r, iso_error *error) {
    const iso_gbuffer *from = &viewport->tile;
    iso_gbuffer *to = &viewport->drawn.gbuffer;
    const size_t count = (size_t)(r.x1 - r.x0);
    if (from->color) ISO_TRY(iso_gbuffer_add_color(to, error));
    for (int y = r.y0; y < r.y1; y++) {
        size_t at = (size_t)(y - r.y0) * count, out = (size_t)y * (size_t)to->width + (size_t)r.x0;
        memcpy(to->depth + out, from->depth + at, count * sizeof *to->depth);
        memcpy(to->surface + out, from->surface + at, count * sizeof *to->surface);
        for (int axis = 0; axis < 3; axis++)
            memcpy(to->normal[axis] + out, from->normal[axis] + at, count * sizeof *to->normal[axis]);
        if (from->color) memcpy(to->color + out, from->color + at, count * sizeof *to->color);
    }
    return ISO_OK;
}

static void average_pixel(const iso_image *samples, int factor, size_t first, uint8_t rgba[4]) {
    const unsigned count = (unsigned)(factor * factor);
    for (size_t k = 0; k < 4; k++) {
        unsigned sum = 0;
        for (int i = 0; i < factor * factor; i++)
            sum += samples->rgba[4 * (first + (size_t)(i / factor * samples->width + i % factor)) + k];
        rgba[k] = (uint8_t)((sum + count / 2) / count);
    }
}

/* Draws and shades a tile with the reference: it is blended over every sample, then the samples of a pixel
 * are averaged. */
static iso_status draw_fine_tile(isosculpt_viewport *viewport, iso_method method, const iso_view *view,
                                 isosculpt_rectangle part, int factor, bool lit, iso_error *error) {
    iso_image *fine = &viewport->fine_image, *pixels = &viewport->tile_image;
    ISO_TRY(isosculpt_reserve_pixels(fine, &viewport->fine_room, view->width, view->height, error));
    ISO_TRY(isosculpt_shown_render(viewport, method, view, 1, lit, factor, &viewport->tile, fine, error));
    isosculpt_reference_blend_fine(viewport, part, factor, fine);
    for (int y = 0; y < pixels->height; y++)
        for (int x = 0; x < pixels->width; x++)
            average_pixel(fine, factor, (size_t)(y * factor) * (size_t)fine->width + (size_t)(x * factor),
                          pixels->rgba + 4 * ((size_t)y * (size_t)pixels->width + (size_t)x));
    return ISO_OK;
}

/* The part of the picture that a part's lines depend on. */
static isosculpt_rectangle with_surroundings(const isosculpt_viewport *viewport, isosculpt_rectangle r,
                                             bool lit) {
    const double outline = lit ? isosculpt_viewport_light(viewport).outline : 0;
    const int reach = outline > 0 ? iso_outline_reach(outline) : 0, width = viewport->image.width,
              height = viewport->image.height;
    return (isosculpt_rectangle){r.x0 > reach ? r.x0 - reach : 0, r.y0 > reach ? r.y0 - reach : 0,
                                 r.x1 < width - reach ? r.x1 + reach : width,
                                 r.y1 < height - reach ? r.y1 + reach : height};
}

/* Draws a part of the picture with factor x factor samples a pixel. Parts with one sample are those that
 * strokes change: not `lit`. */
static iso_status draw_tile(isosculpt_viewport *viewport, iso_method method, isosculpt_rectangle r,
                            int factor, bool lit, iso_error *error) {
    const isosculpt_rectangle drawn = with_surroundings(viewport, r, lit);
    iso_view pixels = tile_view(&viewport->drawn.view, drawn), samples = iso_view_scaled(&pixels, factor);
    ISO_TRY(isosculpt_reserve_samples(&viewport->tile, samples.width, samples.height, error));
    ISO_TRY(isosculpt_reserve_pixels(&viewport->tile_image, &viewport->tile_room, pixels.width, pixels.height,
                                     error));
    if (factor > 1 && isosculpt_viewport_shows_reference(viewport))
        ISO_TRY(draw_fine_tile(viewport, method, &samples, drawn, factor, lit, error));
    else
        ISO_TRY(isosculpt_shown_render(viewport, method, &pixels, factor, lit, 1, &viewport->tile,
                                       &viewport->tile_image, error));
    if (factor == 1) isosculpt_reference_blend_tile(viewport, r);
    blend_backdrop(viewport, &samples, &viewport->tile, factor, &viewport->tile_image);
    copy_tile_pixels(viewport, r, drawn);
    return factor == 1 ? copy_tile_samples(viewport, r, error) : ISO_OK;
}

/* ---- what has to be drawn */

static bool same_mode(const isosculpt_display_mode *a, const isosculpt_display_mode *b) {
    return a->method == b->method && a->engine == b->engine && a->material.shading == b->material.shading &&
           iso_rgb_equal(a->material.color, b->material.color) &&
           iso_rgb_equal(a->material.background, b->material.background);
}

static bool same_see_through(const isosculpt_see_through *a, const isosculpt_see_through *b) {
    if (a->opacity != b->opacity || a->has_second != b->has_second) return false;
    return !a->has_second ||
           (a->second_isovalue == b->second_isovalue && a->second_opacity == b->second_opacity &&
            iso_rgb_equal(a->second_color, b->second_color));
}

/* Whether nothing but edits has changed since the last picture. */
static bool is_still(const isosculpt_viewport *viewport, int width, int height) {
    return viewport->drawn.samples > 0 && viewport->width == width && viewport->height == height &&
           iso_camera_equal(&viewport->camera, &viewport->drawn_camera) &&
           same_mode(&viewport->mode, &viewport->drawn_mode) &&
           viewport->isovalue == viewport->drawn_isovalue &&
           same_see_through(&viewport->see_through, &viewport->drawn_see_through) &&
           viewport->style == viewport->drawn_style &&
           isosculpt_viewport_is_painted(viewport) == viewport->drawn_painted &&
           viewport->opaque == viewport->drawn_opaque;
}

static void adapt_moving_factor(isosculpt_viewport *viewport, bool layers, double seconds) {
    const int most = layers ? ISOSCULPT_LAYERS_FACTOR_MAX : ISOSCULPT_MOVING_FACTOR_MAX;
    if (layers && viewport->moving_factor == most && seconds > MUCH_TOO_SLOW) viewport->slow_layers = true;
    if (seconds > TOO_SLOW && viewport->moving_factor < most) viewport->moving_factor++;
    if (viewport->moving_factor > most) viewport->moving_factor = most;
    if (seconds < FAST && viewport->moving_factor > 1) viewport->moving_factor--;
}

/* Chooses the points to draw. OpenGL's buffers hold only one set of points. */
static void choose_points(isosculpt_viewport *viewport, bool quick) {
    const iso_point_set *points = quick ? isosculpt_lod_points(viewport->lod) : viewport->surface.points;
    if (points != viewport->drawn_points) isosculpt_gl_release_buffers(viewport->gl);
    viewport->drawn_points = points;
}

/* Returns whether the surfaces of a volume's picture are already extracted. */
static bool is_ready(const isosculpt_viewport *viewport, iso_method method) {
    return isosculpt_async_surface_has(viewport, isosculpt_method_part(method)) &&
           (!isosculpt_viewport_has_second(viewport) ||
            isosculpt_async_surface_has(viewport, ISOSCULPT_PART_SECOND));
}

/* Draws the whole picture again. `hurried`: speed matters more than the quality of the reference. */
static iso_status draw_again(isosculpt_viewport *viewport, bool moving, bool hurried, iso_error *error) {
    const bool gl = is_by_gl(viewport, moving);
    const iso_method chosen = isosculpt_viewport_method(viewport),
                     stand_in = gl ? ISO_METHOD_MESH : ISO_METHOD_EXACT,
                     best = chosen == ISO_METHOD_EXACT ? stand_in : chosen;
    const bool layers = isosculpt_viewport_is_see_through(viewport),
               quick = moving && viewport->lod &&
                       (viewport->sliding || (layers && viewport->slow_layers) || !is_ready(viewport, best));
    const iso_method method = quick ? ISO_METHOD_DISCS : best;
    const double extract_start = iso_clock_seconds();
    ISO_TRY(extract_part(viewport, isosculpt_method_part(method), quick, error));
    if (!quick) ISO_TRY(isosculpt_color_by_find_range(viewport, moving, error));
    choose_points(viewport, quick);
    double start = iso_clock_seconds();
    const int factor = moving ? viewport->moving_factor : 1;
    if (!gl)
        ISO_TRY(draw_whole(viewport, method, factor, hurried, error));
    else if (!draw_whole_by_gl(viewport, method, factor))
        return draw_again(viewport, moving, hurried, error);
    const bool lacks_light = isosculpt_viewport_has_light(viewport) && !viewport->drawn_lit;
    const bool coarse =
        factor > 1 || quick || method != chosen || lacks_light || isosculpt_reference_is_coarse(viewport);
    viewport->quality = coarse ? ISOSCULPT_QUALITY_MOVING : ISOSCULPT_QUALITY_REST;
    if (moving) adapt_moving_factor(viewport, layers && !quick, iso_clock_seconds() - start);
    if (moving) isosculpt_latency_add(&viewport->draw, iso_clock_seconds() - start);
    if (quick) isosculpt_lod_record_times(viewport->lod, start - extract_start, iso_clock_seconds() - start);
    return ISO_OK;
}

/* Redraws the parts of an exact picture that edits have changed; all of it when they are more than half. */
static iso_status draw_damage(isosculpt_viewport *viewport, bool moving, iso_error *error) {
    const isosculpt_damage *redrawn = &viewport->redrawn;
    if (2 * isosculpt_damage_area(redrawn) > isosculpt_rectangle_area(whole_image(viewport)))
        return draw_whole(viewport, ISO_METHOD_EXACT, 1, moving, error);
    for (int i = 0; i < redrawn->count; i++) {
        ISO_TRY(draw_tile(viewport, ISO_METHOD_EXACT, redrawn->rectangle[i], 1, false, error));
        isosculpt_damage_add(&viewport->unrefined, redrawn->rectangle[i]);
    }
    return ISO_OK;
}

/* Returns whether the reference must look different from how it looks in the picture. */
static bool has_other_reference(const isosculpt_viewport *viewport, bool moving) {
    const isosculpt_reference_mode now = shown_reference(viewport), *drawn = &viewport->drawn_reference_mode;
    if (!moving && isosculpt_reference_is_coarse(viewport)) return true;
    if (!now.shown && !drawn->shown) return false;
    return now.shown != drawn->shown || now.over != drawn->over || now.labels != drawn->labels ||
           now.opacity != drawn->opacity || !iso_rgb_equal(now.color, drawn->color);
}

/* Shades the samples of an exact picture again, and blends the reference over it. */
static void shade_again(isosculpt_viewport *viewport, bool moving) {
    const iso_strip strip = {.view = &viewport->drawn.view, .gbuffer = &viewport->drawn.gbuffer, .factor = 1};
    const isosculpt_material material = isosculpt_viewport_material(viewport);
    isosculpt_material_strip(&material, &viewport->matcap, &strip, &viewport->image, viewport->pool);
    if (viewport->mask.at) isosculpt_darken_masked(viewport, &strip, &viewport->image);
    isosculpt_reference_blend_whole(viewport, moving);
    blend_backdrop(viewport, strip.view, strip.gbuffer, 1, &viewport->image);
    viewport->drawn_reference_mode = shown_reference(viewport);
    viewport->redrawn = viewport->unrefined =
        (isosculpt_damage){.rectangle = {whole_image(viewport)}, .count = 1};
}

/* Brings an exact picture up to date after edits, or after a change of the reference. */
static iso_status draw_changes(isosculpt_viewport *viewport, bool moving, iso_error *error) {
    ISO_TRY(extract_part(viewport, ISO_PART_CELLS, false, error));
    const double start = iso_clock_seconds();
    const bool other_reference = has_other_reference(viewport, moving);
    viewport->redrawn = (isosculpt_damage){.count = 0};
    if (viewport->grid.hgrid) { /* other grids are not edited */
        const iso_hgrid *grid = viewport->grid.hgrid;
        const iso_view *view = &viewport->drawn.view;
        isosculpt_damage_add_edits(&viewport->redrawn, view, grid, grid->log, viewport->drawn_edit);
        if (viewport->painted.log)
            isosculpt_damage_add_edits(&viewport->redrawn, view, grid, viewport->painted.log,
                                       viewport->drawn_paint);
    }
    if (viewport->mask_changed) isosculpt_damage_add(&viewport->redrawn, whole_image(viewport));
    if (!viewport->redrawn.count && !other_reference) return ISO_OK;
    ISO_TRY(draw_damage(viewport, moving, error));
    if (other_reference) shade_again(viewport, moving);
    viewport->quality = isosculpt_reference_is_coarse(viewport) || isosculpt_viewport_has_light(viewport)
                            ? ISOSCULPT_QUALITY_MOVING
                            : ISOSCULPT_QUALITY_REST;
    isosculpt_latency_add(&viewport->draw, iso_clock_seconds() - start);
    return ISO_OK;
}

iso_status isosculpt_viewport_draw(isosculpt_viewport *viewport, int width, int height, bool moving,
                                   iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(&viewport->grid));
    const bool still = is_still(viewport, width, height);
    const bool exact = isosculpt_viewport_method(viewport) == ISO_METHOD_EXACT,
               at_once = !viewport->lod || is_ready(viewport, ISO_METHOD_EXACT);
    if (viewport->isovalue != viewport->drawn_isovalue ||
        viewport->see_through.second_isovalue != viewport->drawn_see_through.second_isovalue)
        viewport->slow_layers = false;
    viewport->width = width;
    viewport->height = height;
    if (still && exact && viewport->drawn_exactly && !viewport->drawn_lit && !is_lit(viewport, moving))
        ISO_TRY(draw_changes(viewport, moving, error));
    else
        ISO_TRY(draw_again(viewport, moving && !(still && exact && at_once), moving, error));
    viewport->drawn_edit = now;
    if (viewport->painted.log) viewport->drawn_paint = iso_change_log_now(viewport->painted.log);
    viewport->mask_changed = false;
    return ISO_OK;
}

/* ---- refining */

/* Removes the next tile from viewport->unrefined. For methods that fill pixels from their neighbours this is
 * a whole rectangle, because tiles would have visible seams. */
static isosculpt_rectangle take_tile(isosculpt_viewport *viewport, iso_method method) {
    isosculpt_damage *unrefined = &viewport->unrefined;
    isosculpt_rectangle *last = &unrefined->rectangle[unrefined->count - 1], tile = *last;
    const bool layers =
        isosculpt_viewport_is_see_through(viewport) || isosculpt_viewport_shows_reference(viewport);
    const int rows = (layers ? LAYERS_TILE_PIXELS : TILE_PIXELS) / (tile.x1 - tile.x0) + 1;
    if (method != ISO_METHOD_EXACT || tile.y1 - tile.y0 <= rows)
        unrefined->count--;
    else
        tile.y1 = last->y0 = tile.y0 + rows;
    return tile;
}

iso_status isosculpt_viewport_refine(isosculpt_viewport *viewport, iso_error *error) {
    const iso_method method = isosculpt_viewport_method(viewport);
    iso_error reason = {ISO_OK, ""};
    if (viewport->quality != ISOSCULPT_QUALITY_REST) return ISO_OK;
    viewport->redrawn = (isosculpt_damage){.count = 0};
    if (viewport->drawn.canvas) {
        if (draw_canvas(viewport, method, TILE_FACTOR, &reason) != ISO_OK) {
            fall_back_to_cpu(viewport, &reason);
            return isosculpt_viewport_draw(viewport, viewport->width, viewport->height, false, error);
        }
    } else if (viewport->unrefined.count) {
        isosculpt_rectangle tile = take_tile(viewport, method);
        ISO_TRY(draw_tile(viewport, method, tile, TILE_FACTOR, viewport->drawn_lit, error));
        isosculpt_damage_add(&viewport->redrawn, tile);
    }
    if (viewport->unrefined.count || viewport->quality != ISOSCULPT_QUALITY_REST) return ISO_OK;
    viewport->quality = ISOSCULPT_QUALITY_FINE;
    return extract_part(viewport, ISO_PART_POINTS, false, error); /* for isosculpt_viewport_point_count */
}
