/* The picture of a view: as a whole, or the parts of it that an edit changed. */
#include <math.h>
#include <string.h>

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/view/async_surface.h"
#include "apps/isosculpt/view/view.h"
#include "base/clock.h"

/* Pictures while the camera moves: slower ones get coarser, and finer again when that would be fast enough.
 */
static const double TOO_SLOW = 0.020, FAST = 0.006;
/* Smoothing is done in parts of so many pixels, between which events are seen to. */
enum { PIECE_PIXELS = 1 << 17, PIECE_FACTOR = 2 };

/* ---- memory */

static iso_status room_for_samples(iso_gbuffer *gbuffer, int width, int height, iso_error *error) {
    iso_gbuffer more;
    if (gbuffer->samples < (size_t)width * (size_t)height) {
        ISO_TRY(iso_gbuffer_create(width, height, &more, error));
        iso_gbuffer_free(gbuffer);
        *gbuffer = more;
    }
    gbuffer->width = width;
    gbuffer->height = height;
    return ISO_OK;
}

static iso_status room_for_pixels(iso_image *image, size_t *room, int width, int height, iso_error *error) {
    iso_image more;
    size_t pixels = (size_t)width * (size_t)height;
    if (*room < pixels) {
        ISO_TRY(iso_image_create(width, height, &more, error));
        iso_image_free(image);
        *image = more;
        *room = pixels;
    }
    image->width = width;
    image->height = height;
    return ISO_OK;
}

/* ---- extracting */

/* `quick`: of volumes, the points of a coarser one, when that is what can be made in time. */
static iso_status extract(isosculpt_view *view, isosculpt_method method, bool quick, iso_error *error) {
    double start = iso_clock_seconds();
    if (quick && view->levels)
        ISO_TRY(isosculpt_lod_update(view->levels, view->isovalue, error));
    else
        ISO_TRY(isosculpt_async_surface_update(view, method, error));
    if (iso_change_log_now(iso_grid_log(&view->grid)) != view->seen || view->isovalue != view->drawn_isovalue)
        isosculpt_latency_add(&view->extract, iso_clock_seconds() - start);
    return ISO_OK;
}

/* ---- drawing */

static iso_status draw_surface(isosculpt_view *view, isosculpt_method method, const iso_target *target,
                               iso_error *error) {
    iso_gbuffer_clear_bands(target->gbuffer, view->pool);
    if (method == ISOSCULPT_EXACT) return iso_draw_exact(target, view->exact, error);
    if (method == ISOSCULPT_MESH) {
        ISO_TRY(iso_mesh_set_bound(view->mesh, error)); /* half of it is turned away and left out */
        iso_mesh_view mesh = iso_mesh_set_view(view->mesh);
        return iso_draw_mesh(target, &mesh, error);
    }
    iso_point_view points = iso_point_set_view(view->shown);
    iso_pullpush_opts opts = {.workspace = view->workspace};
    return method == ISOSCULPT_POINTS ? iso_draw_points(target, &points, error)
                                      : iso_draw_pullpush(target, &points, &opts, error);
}

typedef struct masking {
    const isosculpt_view *view;
    const iso_strip *strip;
    const iso_image *image;
    iso_affine affine;
} masking;

static bool is_masked(const masking *m, size_t sample, double x, double y) {
    const int *dims = iso_grid_dims(&m->view->grid);
    iso_vec3 origin, direction;
    if (m->strip->gbuffer->surface[sample] == ISO_SURFACE_NONE) return false;
    iso_view_ray(m->strip->view, x, y, &origin, &direction);
    iso_vec3 world =
        iso_vec3_add(origin, iso_vec3_scale(direction, (double)m->strip->gbuffer->depth[sample]));
    iso_vec3 p = iso_affine_point_to_index(&m->affine, world);
    const double at[3] = {p.x, p.y, p.z};
    int voxel[3];
    for (int axis = 0; axis < 3; axis++)
        voxel[axis] = (int)fmin(fmax(floor(at[axis] + 0.5), 0), dims[axis] - 1);
    return m->view->mask.at(m->view->mask.context, voxel[0], voxel[1], voxel[2]);
}

static void mask_row(void *context, size_t row, int worker) {
    (void)worker;
    const masking *m = context;
    const size_t factor = (size_t)m->strip->factor, width = (size_t)m->image->width;
    for (size_t column = 0; column < width; column++) {
        size_t x = column * factor + factor / 2, y = row * factor + factor / 2;
        uint8_t *rgba = m->image->rgba + (row * width + column) * 4;
        if (!is_masked(m, y * width * factor + x, (double)x + 0.5, (double)y + 0.5)) continue;
        for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)(rgba[k] * 3 / 5);
    }
}

static void shade(isosculpt_view *view, const iso_strip *strip, iso_image *image) {
    isosculpt_material_strip(&view->mode.paint, &view->sphere, strip, image, view->pool);
    if (!view->mask.at) return;
    masking m = {view, strip, image, iso_transform_affine(iso_grid_transform(&view->grid))};
    iso_parallel_for(view->pool, (size_t)image->height, mask_row, &m);
}

static isosculpt_rectangle whole_image(const isosculpt_view *view) {
    return (isosculpt_rectangle){0, 0, view->image.width, view->image.height};
}

/* Nothing counts as drawn until it is. */
static void begin_whole(isosculpt_view *view, int factor) {
    isosculpt_layer *drawn = &view->drawn;
    drawn->samples = 0;
    drawn->canvas = NULL;
    drawn->view = iso_view_make(&view->camera, (view->width + factor - 1) / factor,
                                (view->height + factor - 1) / factor);
    view->exactly = false;
}

static void finish_whole(isosculpt_view *view) {
    view->drawn.samples = (double)view->drawn.view.width / view->width;
    view->drawn_camera = view->camera;
    view->drawn_mode = view->mode;
    view->drawn_isovalue = view->isovalue;
}

/* All of the picture, a sample for factor x factor pixels. */
static iso_status draw_whole(isosculpt_view *view, isosculpt_method method, int factor, iso_error *error) {
    isosculpt_layer *drawn = &view->drawn;
    begin_whole(view, factor);
    const int width = drawn->view.width, height = drawn->view.height;
    ISO_TRY(room_for_samples(&drawn->gbuffer, width, height, error));
    ISO_TRY(room_for_pixels(&view->image, &view->image_room, width, height, error));
    iso_target target = {.view = &drawn->view, .gbuffer = &drawn->gbuffer, .pool = view->pool};
    ISO_TRY(draw_surface(view, method, &target, error));
    iso_strip strip = {.view = &drawn->view, .gbuffer = &drawn->gbuffer, .factor = 1};
    shade(view, &strip, &view->image);
    finish_whole(view);
    view->exactly = method == ISOSCULPT_EXACT && factor == 1;
    view->fresh = view->rough = (isosculpt_damage){.rectangle = {whole_image(view)}, .count = 1};
    return ISO_OK;
}

/* ---- drawing by OpenGL */

static bool is_by_gl(const isosculpt_view *view, bool moving) {
    const isosculpt_display_mode *mode = &view->mode;
    return view->gl && mode->engine == ISOSCULPT_GL && !view->mask.at &&
           (mode->method != ISOSCULPT_EXACT || moving);
}

/* The picture of drawn.view, with fine x fine samples a pixel. */
static iso_status draw_canvas(isosculpt_view *view, isosculpt_method method, int fine, iso_error *error) {
    const isosculpt_material *mode = &view->mode.paint;
    const isosculpt_matcap *sphere = isosculpt_material_matcap(mode, &view->sphere);
    const iso_gl_paint paint = {.factor = fine,
                                .color = mode->color,
                                .background = mode->background,
                                .sphere = sphere ? sphere->rgb[0][0] : NULL,
                                .sphere_side = ISOSCULPT_SPHERE};
    const iso_view samples = iso_view_scaled(&view->drawn.view, fine);
    iso_gl_canvas *canvas;
    if (method == ISOSCULPT_MESH) {
        iso_mesh_view mesh = iso_mesh_set_view(view->mesh);
        ISO_TRY(isosculpt_gl_draw_mesh(view->gl, &mesh, &samples, &paint, &canvas, error));
    } else {
        iso_point_view points = iso_point_set_view(view->shown);
        ISO_TRY(isosculpt_gl_draw_points(view->gl, &points, method == ISOSCULPT_PULLPUSH, &samples, &paint,
                                         &canvas, error));
    }
    view->drawn.canvas = canvas;
    return ISO_OK;
}

/* The cpu engine goes on where the driver fails: nobody should lose a sculpture to it. */
static void give_up_gl(isosculpt_view *view, const iso_error *reason) {
    view->gl_error = *reason;
    view->mode.engine = ISOSCULPT_CPU;
    view->quality = ISOSCULPT_MOVING;
    view->drawn.samples = 0;
}

/* All of the picture. Whether that succeeded. */
static bool draw_whole_by_gl(isosculpt_view *view, isosculpt_method method, int factor) {
    iso_error reason = {ISO_OK, ""};
    begin_whole(view, factor);
    if (draw_canvas(view, method, 1, &reason) != ISO_OK) {
        give_up_gl(view, &reason);
        return false;
    }
    finish_whole(view);
    view->fresh = view->rough = (isosculpt_damage){.count = 0}; /* of the image, which has none of it */
    return true;
}

iso_status isosculpt_view_fetch(isosculpt_view *view, iso_error *error) {
    const iso_view *v = &view->drawn.view;
    if (!view->drawn.canvas) return ISO_OK;
    ISO_TRY(room_for_pixels(&view->image, &view->image_room, v->width, v->height, error));
    return iso_gl_canvas_read(view->drawn.canvas, &view->image, error);
}

/* ---- parts of the picture */

/* Part of the picture as a picture of its own. */
static iso_view window_of(const iso_view *view, isosculpt_rectangle r) {
    iso_view window = *view;
    window.cx -= r.x0;
    window.cy -= r.y0;
    window.width = r.x1 - r.x0;
    window.height = r.y1 - r.y0;
    return window;
}

static void put_pixels(isosculpt_view *view, isosculpt_rectangle r) {
    const size_t bytes = (size_t)(r.x1 - r.x0) * 4;
    for (int y = r.y0; y < r.y1; y++)
        memcpy(view->image.rgba + ((size_t)y * (size_t)view->image.width + (size_t)r.x0) * 4,
               view->piece_image.rgba + (size_t)(y - r.y0) * bytes, bytes);
}

static void put_samples(isosculpt_view *view, isosculpt_rectangle r) {
    const iso_gbuffer *from = &view->piece;
    iso_gbuffer *to = &view->drawn.gbuffer;
    const size_t count = (size_t)(r.x1 - r.x0);
    for (int y = r.y0; y < r.y1; y++) {
        size_t at = (size_t)(y - r.y0) * count, out = (size_t)y * (size_t)to->width + (size_t)r.x0;
        memcpy(to->depth + out, from->depth + at, count * sizeof *to->depth);
        memcpy(to->surface + out, from->surface + at, count * sizeof *to->surface);
        for (int axis = 0; axis < 3; axis++)
            memcpy(to->normal[axis] + out, from->normal[axis] + at, count * sizeof *to->normal[axis]);
    }
}

/* Part of the picture, factor x factor samples a pixel. */
static iso_status draw_piece(isosculpt_view *view, isosculpt_method method, isosculpt_rectangle r, int factor,
                             iso_error *error) {
    iso_view pixels = window_of(&view->drawn.view, r), samples = iso_view_scaled(&pixels, factor);
    ISO_TRY(room_for_samples(&view->piece, samples.width, samples.height, error));
    ISO_TRY(room_for_pixels(&view->piece_image, &view->piece_room, pixels.width, pixels.height, error));
    iso_target target = {.view = &samples, .gbuffer = &view->piece, .pool = view->pool};
    ISO_TRY(draw_surface(view, method, &target, error));
    iso_strip strip = {.view = &samples, .gbuffer = &view->piece, .factor = factor};
    shade(view, &strip, &view->piece_image);
    put_pixels(view, r);
    if (factor == 1) put_samples(view, r);
    return ISO_OK;
}

/* ---- what there is to draw */

static bool same_vec(iso_vec3 a, iso_vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_camera(const iso_camera *a, const iso_camera *b) {
    return same_vec(a->position, b->position) && same_vec(a->focal_point, b->focal_point) &&
           same_vec(a->view_up, b->view_up) && a->view_angle == b->view_angle &&
           a->orthographic == b->orthographic && a->parallel_scale == b->parallel_scale;
}

static bool same_look(const isosculpt_display_mode *a, const isosculpt_display_mode *b) {
    return a->method == b->method && a->engine == b->engine && a->paint.light == b->paint.light &&
           iso_rgb_equal(a->paint.color, b->paint.color) &&
           iso_rgb_equal(a->paint.background, b->paint.background);
}

/* The picture differs from what is to be shown by edits alone. */
static bool is_still(const isosculpt_view *view, int width, int height) {
    return view->drawn.samples > 0 && view->width == width && view->height == height &&
           same_camera(&view->camera, &view->drawn_camera) && same_look(&view->mode, &view->drawn_mode) &&
           view->isovalue == view->drawn_isovalue;
}

static void adapt(isosculpt_view *view, double seconds) {
    if (seconds > TOO_SLOW && view->factor < ISOSCULPT_FACTOR_MAX) view->factor++;
    if (seconds < FAST && view->factor > 1) view->factor--;
}

/* OpenGL knows the points of one set. */
static void show_points(isosculpt_view *view, bool quick) {
    const iso_point_set *points = quick ? isosculpt_lod_points(view->levels) : view->points;
    if (points != view->shown) isosculpt_gl_release_buffers(view->gl);
    view->shown = points;
}

static iso_status redraw(isosculpt_view *view, bool moving, iso_error *error) {
    const bool gl = is_by_gl(view, moving);
    const isosculpt_method wanted = view->mode.method, stand_in = gl ? ISOSCULPT_MESH : ISOSCULPT_EXACT,
                           best = wanted == ISOSCULPT_EXACT ? stand_in : wanted;
    const bool quick = moving && view->levels && (view->sliding || !isosculpt_async_surface_has(view, best));
    const isosculpt_method method = quick ? ISOSCULPT_PULLPUSH : best;
    const double begun = iso_clock_seconds();
    ISO_TRY(extract(view, method, quick, error));
    show_points(view, quick);
    double start = iso_clock_seconds();
    const int factor = moving ? view->factor : 1;
    if (!gl)
        ISO_TRY(draw_whole(view, method, factor, error));
    else if (!draw_whole_by_gl(view, method, factor))
        return redraw(view, moving, error);
    view->quality = factor > 1 || quick || method != wanted ? ISOSCULPT_MOVING : ISOSCULPT_REST;
    if (moving) adapt(view, iso_clock_seconds() - start);
    if (moving) isosculpt_latency_add(&view->draw, iso_clock_seconds() - start);
    if (quick) isosculpt_lod_record_times(view->levels, start - begun, iso_clock_seconds() - start);
    return ISO_OK;
}

/* What edits changed in an exact picture; all of it when that is most of it. */
static iso_status patch(isosculpt_view *view, iso_error *error) {
    ISO_TRY(extract(view, ISOSCULPT_EXACT, false, error));
    double start = iso_clock_seconds();
    view->fresh = (isosculpt_damage){.count = 0};
    if (view->grid.hgrid) /* (no one writes to others) */
        isosculpt_damage_add_edits(&view->fresh, &view->drawn.view, view->grid.hgrid, view->seen);
    if (view->repaint) isosculpt_damage_add(&view->fresh, whole_image(view));
    if (!view->fresh.count) return ISO_OK;
    view->quality = ISOSCULPT_REST;
    if (2 * isosculpt_damage_area(&view->fresh) > isosculpt_rectangle_area(whole_image(view)))
        ISO_TRY(draw_whole(view, ISOSCULPT_EXACT, 1, error));
    else
        for (int i = 0; i < view->fresh.count; i++) {
            ISO_TRY(draw_piece(view, ISOSCULPT_EXACT, view->fresh.rectangle[i], 1, error));
            isosculpt_damage_add(&view->rough, view->fresh.rectangle[i]);
        }
    isosculpt_latency_add(&view->draw, iso_clock_seconds() - start);
    return ISO_OK;
}

iso_status isosculpt_view_draw(isosculpt_view *view, int width, int height, bool moving, iso_error *error) {
    const uint64_t now = iso_change_log_now(iso_grid_log(&view->grid));
    const bool still = is_still(view, width, height);
    const bool exact = view->mode.method == ISOSCULPT_EXACT,
               at_once = !view->levels || isosculpt_async_surface_has(view, ISOSCULPT_EXACT);
    view->width = width;
    view->height = height;
    if (still && exact && view->exactly)
        ISO_TRY(patch(view, error));
    else
        ISO_TRY(redraw(view, moving && !(still && exact && at_once), error));
    view->seen = now;
    view->repaint = false;
    return ISO_OK;
}

/* ---- smoothing */

/* Takes some rows off what is rough. Methods that look beyond a pixel draw all at once. */
static isosculpt_rectangle take_piece(isosculpt_damage *rough, bool all) {
    isosculpt_rectangle *last = &rough->rectangle[rough->count - 1], piece = *last;
    int rows = PIECE_PIXELS / (piece.x1 - piece.x0) + 1;
    if (all || piece.y1 - piece.y0 <= rows)
        rough->count--;
    else
        piece.y1 = last->y0 = piece.y0 + rows;
    return piece;
}

iso_status isosculpt_view_refine(isosculpt_view *view, iso_error *error) {
    const isosculpt_method method = view->mode.method;
    iso_error reason = {ISO_OK, ""};
    if (view->quality != ISOSCULPT_REST) return ISO_OK;
    view->fresh = (isosculpt_damage){.count = 0};
    if (view->drawn.canvas) {
        if (draw_canvas(view, method, PIECE_FACTOR, &reason) != ISO_OK) {
            give_up_gl(view, &reason);
            return isosculpt_view_draw(view, view->width, view->height, false, error);
        }
    } else if (view->rough.count) {
        isosculpt_rectangle piece = take_piece(&view->rough, method != ISOSCULPT_EXACT);
        ISO_TRY(draw_piece(view, method, piece, PIECE_FACTOR, error));
        isosculpt_damage_add(&view->fresh, piece);
    }
    if (view->rough.count) return ISO_OK;
    view->quality = ISOSCULPT_FINE;
    return extract(view, ISOSCULPT_POINTS, false, error); /* they are counted */
}
