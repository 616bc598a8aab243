#include "apps/isosculpt_view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt_desk.h"
#include "base/memory.h"

static const double DEGREES_A_PIXEL = 0.4;
/* Pictures while the hand moves: slower ones get coarser, and finer again when that would be fast enough. */
static const double TOO_SLOW = 0.020, FAST = 0.006;

const char *isosculpt_method_name(isosculpt_method method) {
#define METHOD_TEXT(name, text) text,
    static const char *const names[] = {ISOSCULPT_METHODS(METHOD_TEXT)};
#undef METHOD_TEXT
    return names[method];
}

/* ---- latencies */

void isosculpt_latency_add(isosculpt_latency *latency, double seconds) {
    latency->seconds[latency->count++ % ISOSCULPT_LATENCIES] = seconds;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double isosculpt_latency_quantile(const isosculpt_latency *latency, double quantile) {
    double sorted[ISOSCULPT_LATENCIES];
    size_t count = latency->count < ISOSCULPT_LATENCIES ? latency->count : ISOSCULPT_LATENCIES;
    if (!count) return 0;
    memcpy(sorted, latency->seconds, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare);
    size_t at = (size_t)(quantile * (double)count);
    return sorted[at < count ? at : count - 1];
}

/* ---- life */

iso_status isosculpt_view_init(isosculpt_view *view, iso_hgrid *grid, iso_pool *pool, iso_error *error) {
    const iso_rgb clay = {206, 142, 112}, dusk = {46, 50, 56};
    *view = (isosculpt_view){.color = clay, .background = dusk, .factor = 1, .pool = pool};
    view->grid.hgrid = grid;
    view->camera.view_angle = 30;
    iso_points_opts points = {.pool = pool};
    iso_status status = iso_point_set_create(&view->grid, &points, &view->points, error);
    if (status == ISO_OK) status = iso_point_set_update(view->points, error);
    if (status == ISO_OK) status = iso_pullpush_create(&view->workspace, error);
    if (status == ISO_OK)
        isosculpt_view_look(view, ISO_FRONT);
    else
        isosculpt_view_free(view);
    return status;
}

void isosculpt_view_free(isosculpt_view *view) {
    iso_point_set_destroy(view->points);
    iso_mesh_set_destroy(view->mesh);
    iso_exact_destroy(view->exact);
    iso_pullpush_destroy(view->workspace);
    iso_gbuffer_free(&view->drawn.gbuffer);
    iso_gbuffer_free(&view->held.gbuffer);
    iso_image_free(&view->image);
    *view = (isosculpt_view){0};
}

size_t isosculpt_view_points(const isosculpt_view *view) {
    return iso_point_set_stats(view->points).points;
}

/* ---- memory for pictures */

static iso_status make_room(isosculpt_view *view, const iso_view *samples, iso_error *error) {
    iso_gbuffer *gbuffer = &view->drawn.gbuffer, more;
    iso_image image;
    size_t pixels = (size_t)view->width * (size_t)view->height;
    size_t needed = (size_t)samples->width * (size_t)samples->height;
    if ((size_t)gbuffer->width * (size_t)gbuffer->height < needed) {
        ISO_TRY(iso_gbuffer_create(samples->width, samples->height, &more, error));
        iso_gbuffer_free(gbuffer);
        *gbuffer = more;
    }
    if (view->image_room >= pixels) return ISO_OK;
    ISO_TRY(iso_image_create(view->width, view->height, &image, error));
    iso_image_free(&view->image);
    view->image = image;
    view->image_room = pixels;
    return ISO_OK;
}

/* The part of a layer's memory that its picture uses. */
static iso_gbuffer used(const isosculpt_layer *layer) {
    iso_gbuffer part = layer->gbuffer;
    part.width = layer->view.width;
    part.height = layer->view.height;
    return part;
}

/* ---- drawing */

static isosculpt_method method_now(const isosculpt_view *view, bool moving) {
    if (view->method != ISOSCULPT_AUTO) return view->method;
    return moving ? ISOSCULPT_PULLPUSH : ISOSCULPT_EXACT;
}

static iso_status make_extractor(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    iso_mesh_opts mesh = {.pool = view->pool};
    iso_exact_opts exact = {.pool = view->pool};
    if (method == ISOSCULPT_MESH && !view->mesh)
        return iso_mesh_set_create(&view->grid, &mesh, &view->mesh, error);
    if (method == ISOSCULPT_EXACT && !view->exact)
        return iso_exact_create(&view->grid, &exact, &view->exact, error);
    return ISO_OK;
}

static iso_status extract(isosculpt_view *view, isosculpt_method method, iso_error *error) {
    ISO_TRY(make_extractor(view, method, error));
    double start = isosculpt_now();
    if (method == ISOSCULPT_MESH)
        ISO_TRY(iso_mesh_set_update(view->mesh, error));
    else if (method == ISOSCULPT_EXACT)
        ISO_TRY(iso_exact_update(view->exact, error));
    else
        ISO_TRY(iso_point_set_update(view->points, error));
    isosculpt_latency_add(&view->extract, isosculpt_now() - start);
    return ISO_OK;
}

static iso_status draw_surface(isosculpt_view *view, isosculpt_method method, const iso_target *target,
                               iso_error *error) {
    if (method == ISOSCULPT_EXACT) return iso_draw_exact(target, view->exact, error);
    if (method == ISOSCULPT_MESH) {
        iso_mesh_view mesh = iso_mesh_set_view(view->mesh);
        return iso_draw_mesh(target, &mesh, error);
    }
    iso_point_view points = iso_point_set_view(view->points);
    iso_pullpush_opts opts = {.workspace = view->workspace};
    return method == ISOSCULPT_POINTS ? iso_draw_points(target, &points, error)
                                      : iso_draw_pullpush(target, &points, &opts, error);
}

static void shade(isosculpt_view *view, iso_gbuffer *gbuffer, int factor) {
    iso_shading shading = {.colors = &view->color, .color_count = 1, .background = view->background};
    iso_strip strip = {.view = &view->drawn.view, .gbuffer = gbuffer, .factor = factor};
    view->image.width = gbuffer->width / factor;
    view->image.height = gbuffer->height / factor;
    view->covered = iso_shade(&shading, &strip, &view->image, view->pool);
}

static void adapt(isosculpt_view *view, double seconds) {
    if (seconds > TOO_SLOW && view->factor < ISOSCULPT_FACTOR_MAX) view->factor++;
    if (seconds < FAST && view->factor > 1) view->factor--;
}

static iso_status draw(isosculpt_view *view, isosculpt_method method, const iso_view *samples, int factor,
                       iso_error *error) {
    ISO_TRY(make_room(view, samples, error));
    view->drawn.view = *samples;
    view->drawn.samples = (double)samples->width / view->width;
    iso_gbuffer gbuffer = used(&view->drawn);
    iso_gbuffer_clear_bands(&gbuffer, view->pool);
    iso_target target = {.view = &view->drawn.view, .gbuffer = &gbuffer, .pool = view->pool};
    ISO_TRY(draw_surface(view, method, &target, error));
    shade(view, &gbuffer, factor);
    return ISO_OK;
}

iso_status isosculpt_view_draw(isosculpt_view *view, int width, int height, isosculpt_quality quality,
                               iso_error *error) {
    const bool moving = quality == ISOSCULPT_MOVING;
    const isosculpt_method method = method_now(view, moving);
    const int coarse = moving ? view->factor : 1, fine = quality == ISOSCULPT_FINE ? 2 : 1;
    ISO_TRY(extract(view, method, error));
    double start = isosculpt_now();
    view->width = width;
    view->height = height;
    iso_view samples =
        iso_view_make(&view->camera, (width + coarse - 1) / coarse, (height + coarse - 1) / coarse);
    if (fine > 1) samples = iso_view_scaled(&samples, fine);
    ISO_TRY(draw(view, method, &samples, fine, error));
    double seconds = isosculpt_now() - start;
    if (moving) isosculpt_latency_add(&view->draw, seconds);
    if (moving) adapt(view, seconds);
    return ISO_OK;
}

/* ---- picking */

bool isosculpt_layer_pick(const isosculpt_layer *layer, double x, double y, isosculpt_pick *pick) {
    const iso_view *v = &layer->view;
    if (!(layer->samples > 0) || !(x >= 0) || !(y >= 0)) return false;
    double column = floor(x * layer->samples), row = floor(y * layer->samples);
    if (column >= v->width || row >= v->height) return false;
    size_t at = (size_t)row * (size_t)v->width + (size_t)column;
    if (layer->gbuffer.surface[at] == ISO_SURFACE_NONE) return false;
    const iso_vec3 n = iso_gbuffer_normal(&layer->gbuffer, at);
    const double *r = v->rotation;
    pick->depth = (double)layer->gbuffer.depth[at];
    pick->position = isosculpt_layer_point(layer, x, y, pick->depth);
    pick->normal = iso_vec3_unit(iso_vec3_make(r[0] * n.x + r[3] * n.y + r[6] * n.z,
                                               r[1] * n.x + r[4] * n.y + r[7] * n.z,
                                               r[2] * n.x + r[5] * n.y + r[8] * n.z));
    return true;
}

iso_vec3 isosculpt_layer_point(const isosculpt_layer *layer, double x, double y, double depth) {
    iso_vec3 origin, direction;
    iso_view_ray(&layer->view, x * layer->samples, y * layer->samples, &origin, &direction);
    return iso_vec3_add(origin, iso_vec3_scale(direction, depth));
}

bool isosculpt_layer_pixel(const isosculpt_layer *layer, iso_vec3 world, double *x, double *y) {
    const iso_view *v = &layer->view;
    iso_vec3 p = iso_view_point(v, world);
    if (!(layer->samples > 0) || !(p.z > v->near)) return false;
    double scale = v->orthographic ? v->focal : v->focal / p.z;
    *x = (v->cx + scale * p.x) / layer->samples;
    *y = (v->cy + scale * p.y) / layer->samples;
    return true;
}

void isosculpt_view_hold(isosculpt_view *view) {
    isosculpt_layer last = view->drawn;
    view->drawn = view->held;
    view->held = last;
}

/* ---- the camera */

void isosculpt_view_orbit(isosculpt_view *view, double dx, double dy) {
    iso_camera_orbit(&view->camera, -DEGREES_A_PIXEL * dx, DEGREES_A_PIXEL * dy);
}

static double arm(const iso_camera *camera) {
    return iso_vec3_length(iso_vec3_sub(camera->focal_point, camera->position));
}

void isosculpt_view_pan(isosculpt_view *view, double dx, double dy) {
    iso_camera *camera = &view->camera;
    iso_view v =
        iso_view_make(camera, view->width > 0 ? view->width : 1, view->height > 0 ? view->height : 1);
    double mm = (v.orthographic ? 1 : arm(camera)) / v.focal;
    iso_vec3 right = {v.rotation[0], v.rotation[1], v.rotation[2]};
    iso_vec3 down = {v.rotation[3], v.rotation[4], v.rotation[5]};
    iso_vec3 move = iso_vec3_add(iso_vec3_scale(right, -mm * dx), iso_vec3_scale(down, -mm * dy));
    camera->position = iso_vec3_add(camera->position, move);
    camera->focal_point = iso_vec3_add(camera->focal_point, move);
}

void isosculpt_view_zoom(isosculpt_view *view, double factor) {
    iso_camera *camera = &view->camera;
    iso_vec3 back = iso_vec3_sub(camera->position, camera->focal_point);
    double length = iso_vec3_length(back) / factor, voxel = view->grid.hgrid->transform.spacing[0];
    if (!(length > voxel) || !(length < 1e5 * voxel)) return;
    camera->position = iso_vec3_add(camera->focal_point, iso_vec3_scale(back, 1 / factor));
    camera->parallel_scale /= factor;
}

static iso_box bounds(const isosculpt_view *view) {
    iso_affine affine = iso_transform_affine(&view->grid.hgrid->transform);
    iso_point_view points = iso_point_set_view(view->points);
    iso_box box = iso_point_view_bounds(&points);
    if (iso_box_is_empty(&box)) {
        const int *dims = view->grid.hgrid->dims;
        iso_box_add(&box, iso_vec3_make(0, 0, 0));
        iso_box_add(&box, iso_vec3_make(dims[0] - 1, dims[1] - 1, dims[2] - 1));
    }
    return iso_box_transform(&box, &affine);
}

static void fit(isosculpt_view *view) {
    iso_box box = bounds(view);
    double aspect = view->height > 0 ? (double)view->width / view->height : 1.6;
    iso_camera_fit(&view->camera, &box, aspect, 1);
    isosculpt_view_zoom(view, 0.8); /* room beside it, to orbit from */
}

void isosculpt_view_look(isosculpt_view *view, iso_direction direction) {
    iso_vec3 forward, up;
    iso_direction_vectors(direction, iso_vec3_make(0, 0, 1), &forward, &up);
    view->camera.position = iso_vec3_sub(view->camera.focal_point, forward);
    view->camera.view_up = up;
    fit(view);
}

void isosculpt_view_focus(isosculpt_view *view, const iso_vec3 *at) {
    iso_camera *camera = &view->camera;
    if (!at) {
        fit(view);
        return;
    }
    iso_vec3 move = iso_vec3_sub(*at, camera->focal_point);
    camera->position = iso_vec3_add(camera->position, move);
    camera->focal_point = *at;
}
