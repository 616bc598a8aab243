#include "apps/isosculpt/view/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/document.h"
#include "apps/isosculpt/view/async_surface.h"
#include "base/memory.h"
#include "base/numbers.h"

static const double DEGREES_A_PIXEL = 0.4;

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

double isosculpt_latency_quantile(const isosculpt_latency *latency, double quantile) {
    double sorted[ISOSCULPT_LATENCIES];
    size_t count = latency->count < ISOSCULPT_LATENCIES ? latency->count : ISOSCULPT_LATENCIES;
    if (!count) return 0;
    memcpy(sorted, latency->seconds, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, iso_compare_doubles);
    size_t at = (size_t)(quantile * (double)count);
    return sorted[at < count ? at : count - 1];
}

/* ---- life */

iso_status isosculpt_view_init(isosculpt_view *view, iso_hgrid *grid, iso_pool *pool, iso_error *error) {
    const iso_grid any = {.hgrid = grid};
    return isosculpt_view_init_grid(view, &any, 0, pool, error);
}

static iso_status make_levels(isosculpt_view *view, iso_error *error) {
    for (int i = 0; i < ISOSCULPT_METHOD_COUNT; i++) view->surface_isovalue[i] = NAN;
    view->failed_isovalue = NAN;
    ISO_TRY(iso_pool_create(iso_pool_threads(view->pool), &view->async_surface_pool, error));
    return isosculpt_lod_create(view->grid.rgrid, view->isovalue, view->pool, &view->levels, error);
}

iso_status isosculpt_view_init_grid(isosculpt_view *view, const iso_grid *grid, double isovalue,
                                    iso_pool *pool, iso_error *error) {
    const iso_rgb clay = {206, 142, 112}, dusk = {46, 50, 56};
    *view =
        (isosculpt_view){.mode = {.paint = {.color = clay, .background = dusk}}, .factor = 1, .pool = pool};
    view->grid = *grid;
    view->isovalue = view->drawn_isovalue = isovalue;
    view->camera.view_angle = 30;
    iso_status status = grid->rgrid ? make_levels(view, error) : ISO_OK;
    if (status == ISO_OK) status = isosculpt_async_surface_update(view, ISOSCULPT_POINTS, error);
    if (status == ISO_OK) status = iso_pullpush_create(&view->workspace, error);
    if (status == ISO_OK)
        isosculpt_view_set_direction(view, ISO_FRONT);
    else
        isosculpt_view_free(view);
    return status;
}

void isosculpt_view_free(isosculpt_view *view) {
    isosculpt_async_surface_wait(view);
    isosculpt_gl_release_buffers(view->gl);
    isosculpt_lod_destroy(view->levels);
    iso_point_set_destroy(view->points);
    iso_mesh_set_destroy(view->mesh);
    iso_exact_destroy(view->exact);
    iso_pullpush_destroy(view->workspace);
    iso_gbuffer_free(&view->drawn.gbuffer);
    iso_gbuffer_free(&view->pick_layer.gbuffer);
    iso_gbuffer_free(&view->piece);
    iso_image_free(&view->image);
    iso_image_free(&view->piece_image);
    iso_pool_destroy(view->async_surface_pool);
    *view = (isosculpt_view){0};
}

void isosculpt_view_set_isovalue(isosculpt_view *view, double isovalue) {
    view->isovalue = isovalue;
}

size_t isosculpt_view_points(const isosculpt_view *view) {
    return view->levels ? view->point_count : iso_point_set_stats(view->points).points;
}

/* ---- picking */

/* View space normal and depth at a pixel of the layer's; false: nothing is there. */
static bool sample_of(const isosculpt_layer *layer, int column, int row, float normal_depth[4]) {
    const iso_gbuffer *g = &layer->gbuffer;
    size_t at = (size_t)row * (size_t)layer->view.width + (size_t)column;
    if (layer->canvas) return iso_gl_canvas_pick(layer->canvas, column, row, normal_depth);
    for (int axis = 0; axis < 3; axis++) normal_depth[axis] = g->normal[axis][at];
    normal_depth[3] = g->depth[at];
    return g->surface[at] != ISO_SURFACE_NONE;
}

bool isosculpt_layer_pick(const isosculpt_layer *layer, double x, double y, isosculpt_pick *pick) {
    const iso_view *v = &layer->view;
    float n[4];
    if (!(layer->samples > 0) || !(x >= 0) || !(y >= 0)) return false;
    double column = floor(x * layer->samples), row = floor(y * layer->samples);
    if (column >= v->width || row >= v->height) return false;
    if (!sample_of(layer, (int)column, (int)row, n)) return false;
    const double *r = v->rotation;
    pick->depth = (double)n[3];
    pick->position = isosculpt_layer_point(layer, x, y, pick->depth);
    double world[3];
    for (int k = 0; k < 3; k++)
        world[k] = r[k] * (double)n[0] + r[3 + k] * (double)n[1] + r[6 + k] * (double)n[2];
    pick->normal = iso_vec3_unit(iso_vec3_make(world[0], world[1], world[2]));
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

typedef struct planes {
    const isosculpt_layer *from;
    isosculpt_layer *to;
} planes;

static void copy_plane(void *context, size_t index, int worker) {
    (void)worker;
    const planes *p = context;
    const iso_gbuffer *from = &p->from->gbuffer;
    iso_gbuffer *to = &p->to->gbuffer;
    size_t samples = (size_t)p->from->view.width * (size_t)p->from->view.height;
    if (index < 3)
        memcpy(to->normal[index], from->normal[index], samples * sizeof *from->normal[index]);
    else if (index == 3)
        memcpy(to->depth, from->depth, samples * sizeof *from->depth);
    else
        memcpy(to->surface, from->surface, samples * sizeof *from->surface);
}

iso_status isosculpt_view_keep_pick_layer(isosculpt_view *view, iso_error *error) {
    const isosculpt_layer *drawn = &view->drawn;
    isosculpt_layer *pick_layer = &view->pick_layer;
    iso_gbuffer more;
    pick_layer->view = drawn->view;
    pick_layer->samples = 0;
    pick_layer->canvas = NULL;
    if (drawn->canvas) {
        iso_gl_canvas *canvas;
        ISO_TRY(isosculpt_gl_keep_pick_layer(view->gl, &canvas, error));
        pick_layer->canvas = canvas;
        pick_layer->samples = drawn->samples;
        return ISO_OK;
    }
    if (pick_layer->gbuffer.samples < drawn->gbuffer.samples) {
        ISO_TRY(iso_gbuffer_create(drawn->gbuffer.width, drawn->gbuffer.height, &more, error));
        iso_gbuffer_free(&pick_layer->gbuffer);
        pick_layer->gbuffer = more;
    }
    pick_layer->samples = drawn->samples;
    planes p = {drawn, pick_layer};
    iso_parallel_for(view->pool, 5, copy_plane, &p);
    return ISO_OK;
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
    double length = iso_vec3_length(back) / factor, voxel = iso_grid_transform(&view->grid)->spacing[0];
    if (!(length > voxel) || !(length < 1e5 * voxel)) return;
    camera->position = iso_vec3_add(camera->focal_point, iso_vec3_scale(back, 1 / factor));
    camera->parallel_scale /= factor;
}

iso_box isosculpt_view_bounds(isosculpt_view *view) {
    /* (Other methods leave a field's points as they were. Without memory for new ones the old ones do.) */
    if (!view->levels) isosculpt_async_surface_update(view, ISOSCULPT_POINTS, NULL);
    iso_point_view points =
        iso_point_set_view(view->levels ? isosculpt_lod_points(view->levels) : view->points);
    const iso_affine affine = iso_transform_affine(&points.transform);
    iso_box box = iso_point_view_bounds(&points);
    if (iso_box_is_empty(&box)) {
        const int *dims = points.dims;
        iso_box_add(&box, iso_vec3_make(0, 0, 0));
        iso_box_add(&box, iso_vec3_make(dims[0] - 1, dims[1] - 1, dims[2] - 1));
    }
    return iso_box_transform(&box, &affine);
}

static void fit(isosculpt_view *view) {
    iso_box box = isosculpt_view_bounds(view);
    double aspect = view->height > 0 ? (double)view->width / view->height : 1.6;
    iso_camera_fit(&view->camera, &box, aspect, 1);
    isosculpt_view_zoom(view, 0.8); /* room beside it, to orbit from */
}

void isosculpt_view_set_direction(isosculpt_view *view, iso_direction direction) {
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
    const iso_vec3 move = iso_vec3_sub(*at, camera->focal_point),
                   forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position)),
                   inward = iso_vec3_scale(forward, iso_vec3_dot(move, forward));
    camera->position = iso_vec3_add(camera->position, iso_vec3_sub(move, inward));
    camera->focal_point = *at;
}
