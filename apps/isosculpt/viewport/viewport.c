/* A viewport: its camera, picking, and measured times. Drawing is in picture.c. */
#include "apps/isosculpt/viewport/viewport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isosculpt/viewport/async_surface.h"
#include "apps/isosculpt/viewport/color_by.h"
#include "apps/isosculpt/viewport/reference.h"
#include "base/memory.h"
#include "base/numbers.h"
#include "scene/bounds.h"

static const double DEGREES_A_PIXEL = 0.4;

const iso_method isosculpt_methods[ISOSCULPT_METHODS] = {ISO_METHOD_EXACT,    ISO_METHOD_DISCS,
                                                         ISO_METHOD_PULLPUSH, ISO_METHOD_PULLPUSH_BOX,
                                                         ISO_METHOD_POINTS,   ISO_METHOD_MESH};

iso_reconstruction isosculpt_reconstruction(iso_method method) {
    return method == ISO_METHOD_PULLPUSH       ? ISO_RECONSTRUCTION_GAUSSIAN
           : method == ISO_METHOD_PULLPUSH_BOX ? ISO_RECONSTRUCTION_BOX
                                               : ISO_RECONSTRUCTION_CURVED;
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

/* ---- creating and freeing */

iso_status isosculpt_viewport_init(isosculpt_viewport *viewport, iso_hgrid *grid, iso_pool *pool,
                                   iso_error *error) {
    const iso_grid any = {.hgrid = grid};
    return isosculpt_viewport_init_grid(viewport, &any, 0, pool, error);
}

static iso_status create_lod(isosculpt_viewport *viewport, iso_error *error) {
    viewport->failed_isovalues[0] = viewport->failed_isovalues[1] = NAN;
    ISO_TRY(iso_pool_create(iso_pool_threads(viewport->pool), &viewport->async_surface_pool, error));
    return isosculpt_lod_create(viewport->grid.rgrid, viewport->isovalue, viewport->pool, &viewport->lod,
                                error);
}

iso_status isosculpt_viewport_init_grid(isosculpt_viewport *viewport, const iso_grid *grid, double isovalue,
                                        iso_pool *pool, iso_error *error) {
    const iso_rgb bone = {238, 230, 208}, dusk = {46, 50, 56}, ice = {130, 190, 240};
    *viewport =
        (isosculpt_viewport){.mode = {.material = {.color = ISOSCULPT_SURFACE_COLOR, .background = dusk}},
                             .see_through = {.opacity = 1, .second_opacity = 1, .second_color = bone},
                             .reference_mode = {.opacity = 0.35, .color = ice},
                             .cut = {.plane = -1,
                                     .cap = {.kind = ISO_CAP_SURFACE, .map = ISO_COLORMAP_GRAY},
                                     .window = {NAN, NAN}},
                             .moving_factor = 1,
                             .pool = pool};
    viewport->grid = *grid;
    viewport->isovalue = viewport->drawn_isovalue = isovalue;
    viewport->camera.view_angle = 30;
    iso_status status = grid->rgrid ? create_lod(viewport, error) : ISO_OK;
    if (status == ISO_OK) status = iso_point_workspace_create(&viewport->workspace, error);
    viewport->surface = viewport->second =
        (iso_scene_surface){.grid = viewport->grid,
                            .pool = viewport->lod ? viewport->async_surface_pool : pool,
                            .primitive = iso_primitive_auto(grid, isovalue),
                            .flat = true,
                            .workspace = viewport->workspace};
    if (status == ISO_OK) status = isosculpt_async_surface_update(viewport, ISO_PART_POINTS, error);
    if (status == ISO_OK)
        isosculpt_viewport_set_direction(viewport, ISO_FRONT);
    else
        isosculpt_viewport_free(viewport);
    return status;
}

void isosculpt_viewport_free(isosculpt_viewport *viewport) {
    isosculpt_async_surface_wait(viewport);
    isosculpt_gl_release_buffers(viewport->gl);
    isosculpt_lod_destroy(viewport->lod);
    iso_scene_surface_free(&viewport->surface);
    iso_scene_surface_free(&viewport->second);
    iso_point_workspace_destroy(viewport->workspace);
    if (viewport->occluders) iso_occluders_free(viewport->occluders);
    iso_free(viewport->occluders);
    iso_gbuffer_free(&viewport->drawn.gbuffer);
    iso_gbuffer_free(&viewport->pick_buffer.gbuffer);
    iso_gbuffer_free(&viewport->tile);
    iso_image_free(&viewport->image);
    iso_image_free(&viewport->tile_image);
    iso_image_free(&viewport->fine_image);
    isosculpt_color_by_free(viewport);
    isosculpt_reference_destroy(viewport->reference);
    iso_pool_destroy(viewport->async_surface_pool);
    *viewport = (isosculpt_viewport){0};
}

void isosculpt_viewport_set_isovalue(isosculpt_viewport *viewport, double isovalue) {
    viewport->isovalue = isovalue;
}

size_t isosculpt_viewport_point_count(const isosculpt_viewport *viewport) {
    return viewport->lod ? viewport->point_count : iso_point_set_stats(viewport->surface.points).points;
}

/* ---- picking */

/* View space normal and depth of the sample in a column and row of the buffer; false: no surface is there. */
static bool read_sample(const isosculpt_pick_buffer *buffer, int column, int row, float normal_depth[4]) {
    const iso_gbuffer *g = &buffer->gbuffer;
    size_t at = (size_t)row * (size_t)buffer->view.width + (size_t)column;
    if (buffer->canvas) return iso_gl_canvas_pick(buffer->canvas, column, row, normal_depth);
    for (int axis = 0; axis < 3; axis++) normal_depth[axis] = g->normal[axis][at];
    normal_depth[3] = g->depth[at];
    return g->surface[at] != ISO_SURFACE_NONE;
}

bool isosculpt_pick_buffer_pick(const isosculpt_pick_buffer *buffer, double x, double y,
                                isosculpt_pick *pick) {
    const iso_view *v = &buffer->view;
    float n[4];
    if (!(buffer->samples > 0) || !(x >= 0) || !(y >= 0)) return false;
    double column = floor(x * buffer->samples), row = floor(y * buffer->samples);
    if (column >= v->width || row >= v->height) return false;
    if (!read_sample(buffer, (int)column, (int)row, n)) return false;
    const double *r = v->rotation;
    pick->depth = (double)n[3];
    pick->position = isosculpt_pick_buffer_point(buffer, x, y, pick->depth);
    double world[3];
    for (int k = 0; k < 3; k++)
        world[k] = r[k] * (double)n[0] + r[3 + k] * (double)n[1] + r[6 + k] * (double)n[2];
    const bool lit = n[0] != 0 || n[1] != 0 || n[2] != 0; /* slices are not */
    pick->normal =
        lit ? iso_vec3_unit(iso_vec3_make(world[0], world[1], world[2])) : iso_vec3_make(-r[6], -r[7], -r[8]);
    return true;
}

iso_vec3 isosculpt_pick_buffer_point(const isosculpt_pick_buffer *buffer, double x, double y, double depth) {
    iso_vec3 origin, direction;
    iso_view_ray(&buffer->view, x * buffer->samples, y * buffer->samples, &origin, &direction);
    return iso_vec3_add(origin, iso_vec3_scale(direction, depth));
}

bool isosculpt_pick_buffer_pixel(const isosculpt_pick_buffer *buffer, iso_vec3 world, double *x, double *y) {
    const iso_view *v = &buffer->view;
    iso_vec3 p = iso_view_point(v, world);
    if (!(buffer->samples > 0) || !(p.z > v->near)) return false;
    double scale = v->orthographic ? v->focal : v->focal / p.z;
    *x = (v->cx + scale * p.x) / buffer->samples;
    *y = (v->cy + scale * p.y) / buffer->samples;
    return true;
}

/* Two buffers, for the threads that copy planes of samples. */
typedef struct buffer_copy {
    const isosculpt_pick_buffer *from;
    isosculpt_pick_buffer *to;
} buffer_copy;

static void copy_plane(void *context, size_t index, int worker) {
    (void)worker;
    const buffer_copy *p = context;
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

iso_status isosculpt_viewport_keep_pick_buffer(isosculpt_viewport *viewport, iso_error *error) {
    const isosculpt_pick_buffer *drawn = &viewport->drawn;
    isosculpt_pick_buffer *pick_buffer = &viewport->pick_buffer;
    iso_gbuffer larger;
    pick_buffer->view = drawn->view;
    pick_buffer->samples = 0;
    pick_buffer->canvas = NULL;
    if (drawn->canvas) {
        iso_gl_canvas *canvas;
        ISO_TRY(isosculpt_gl_keep_pick_buffer(viewport->gl, &canvas, error));
        pick_buffer->canvas = canvas;
        pick_buffer->samples = drawn->samples;
        return ISO_OK;
    }
    if (pick_buffer->gbuffer.samples < drawn->gbuffer.samples) {
        ISO_TRY(iso_gbuffer_create(drawn->gbuffer.width, drawn->gbuffer.height, &larger, error));
        iso_gbuffer_free(&pick_buffer->gbuffer);
        pick_buffer->gbuffer = larger;
    }
    pick_buffer->samples = drawn->samples;
    buffer_copy p = {drawn, pick_buffer};
    iso_parallel_for(viewport->pool, 5, copy_plane, &p);
    return ISO_OK;
}

/* ---- the camera */

void isosculpt_viewport_orbit(isosculpt_viewport *viewport, double dx, double dy) {
    iso_camera_orbit(&viewport->camera, -DEGREES_A_PIXEL * dx, DEGREES_A_PIXEL * dy);
}

static double focal_distance(const iso_camera *camera) {
    return iso_vec3_length(iso_vec3_sub(camera->focal_point, camera->position));
}

void isosculpt_viewport_pan(isosculpt_viewport *viewport, double dx, double dy) {
    iso_camera *camera = &viewport->camera;
    iso_view v = iso_view_make(camera, viewport->width > 0 ? viewport->width : 1,
                               viewport->height > 0 ? viewport->height : 1);
    double mm = (v.orthographic ? 1 : focal_distance(camera)) / v.focal;
    iso_vec3 right = {v.rotation[0], v.rotation[1], v.rotation[2]};
    iso_vec3 down = {v.rotation[3], v.rotation[4], v.rotation[5]};
    iso_vec3 move = iso_vec3_add(iso_vec3_scale(right, -mm * dx), iso_vec3_scale(down, -mm * dy));
    camera->position = iso_vec3_add(camera->position, move);
    camera->focal_point = iso_vec3_add(camera->focal_point, move);
}

void isosculpt_viewport_zoom(isosculpt_viewport *viewport, double factor) {
    iso_camera *camera = &viewport->camera;
    iso_vec3 back = iso_vec3_sub(camera->position, camera->focal_point);
    double length = iso_vec3_length(back) / factor, voxel = iso_grid_transform(&viewport->grid)->spacing[0];
    if (!(length > voxel) || !(length < 1e5 * voxel)) return;
    camera->position = iso_vec3_add(camera->focal_point, iso_vec3_scale(back, 1 / factor));
    camera->parallel_scale /= factor;
}

iso_box isosculpt_viewport_bounds(isosculpt_viewport *viewport) {
    /* Other methods do not update a field's points. Without memory for new points the old ones are used. */
    if (!viewport->lod) isosculpt_async_surface_update(viewport, ISO_PART_POINTS, NULL);
    iso_point_view points =
        iso_point_set_view(viewport->lod ? isosculpt_lod_points(viewport->lod) : viewport->surface.points);
    const iso_affine affine = iso_transform_affine(&points.transform);
    iso_box box = iso_point_view_bounds(&points);
    if (iso_box_is_empty(&box)) {
        const int *dims = points.dims;
        iso_box_add(&box, iso_vec3_make(0, 0, 0));
        iso_box_add(&box, iso_vec3_make(dims[0] - 1, dims[1] - 1, dims[2] - 1));
    }
    return iso_box_transform(&box, &affine);
}

static void show_whole(isosculpt_viewport *viewport) {
    iso_box box = isosculpt_viewport_bounds(viewport);
    double aspect = viewport->height > 0 ? (double)viewport->width / viewport->height : 1.6;
    iso_camera_fit(&viewport->camera, &box, aspect, 1);
    isosculpt_viewport_zoom(viewport, 0.8); /* leaves room beside the surface, where a drag orbits */
}

void isosculpt_viewport_set_size(isosculpt_viewport *viewport, int width, int height) {
    viewport->width = width;
    viewport->height = height;
    viewport->drawn.samples = 0; /* the last picture has another size */
    show_whole(viewport);
}

void isosculpt_viewport_set_direction(isosculpt_viewport *viewport, iso_direction direction) {
    iso_vec3 forward, up;
    iso_direction_vectors(direction, iso_vec3_make(0, 0, 1), &forward, &up);
    viewport->camera.position = iso_vec3_sub(viewport->camera.focal_point, forward);
    viewport->camera.view_up = up;
    show_whole(viewport);
}

void isosculpt_viewport_focus(isosculpt_viewport *viewport, const iso_vec3 *at) {
    iso_camera *camera = &viewport->camera;
    if (!at) {
        show_whole(viewport);
        return;
    }
    const iso_vec3 move = iso_vec3_sub(*at, camera->focal_point),
                   forward = iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position)),
                   inward = iso_vec3_scale(forward, iso_vec3_dot(move, forward));
    camera->position = iso_vec3_add(camera->position, iso_vec3_sub(move, inward));
    camera->focal_point = *at;
}

/* ---- what is cut away */

static iso_vec3 forward_of(const iso_camera *camera) {
    return iso_vec3_unit(iso_vec3_sub(camera->focal_point, camera->position));
}

void isosculpt_viewport_toggle_plane(isosculpt_viewport *viewport) {
    isosculpt_cut *cut = &viewport->cut;
    const iso_vec3 forward = forward_of(&viewport->camera);
    const double f[3] = {forward.x, forward.y, forward.z};
    double to_eye[3] = {0, 0, 0};
    int axis = 0;
    viewport->style++;
    if (cut->plane >= 0) {
        isosculpt_cut_remove_plane(cut);
        return;
    }
    for (int i = 1; i < 3; i++)
        if (fabs(f[i]) > fabs(f[axis])) axis = i;
    to_eye[axis] = f[axis] > 0 ? -1 : 1;
    const iso_box box = isosculpt_viewport_bounds(viewport);
    isosculpt_cut_place(cut, iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5),
                        iso_vec3_make(to_eye[0], to_eye[1], to_eye[2]));
}

/* The least distance along the view, from the world's origin, of a point of the surface. */
static double front_of(const isosculpt_viewport *viewport, iso_vec3 forward) {
    const iso_point_view points =
        iso_point_set_view(viewport->lod ? isosculpt_lod_points(viewport->lod) : viewport->surface.points);
    iso_affine along = iso_transform_affine(&points.transform);
    const double *m = along.m, f[3] = {forward.x, forward.y, forward.z};
    double row[3];
    for (int k = 0; k < 3; k++) row[k] = f[0] * m[k] + f[1] * m[3 + k] + f[2] * m[6 + k];
    memcpy(along.m + 6, row, sizeof row);
    along.origin[2] = iso_vec3_dot(forward, iso_vec3_make(along.origin[0], along.origin[1], along.origin[2]));
    return iso_bounds_of_each_point(&points, &along).lo.z;
}

iso_status isosculpt_viewport_add_cut(isosculpt_viewport *viewport, const char *text, iso_error *error) {
    isosculpt_cut *cut = &viewport->cut;
    const iso_box box = isosculpt_viewport_bounds(viewport);
    iso_cut parsed;
    ISO_TRY(iso_cut_parse(text, &parsed, error));
    const iso_vec3 middle =
        parsed.by_middle ? iso_cut_middle(iso_grid_transform(&viewport->grid), iso_grid_dims(&viewport->grid))
                         : iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5);
    viewport->style++;
    if (!parsed.by_depth) return isosculpt_cut_add(cut, text, middle, error);
    const iso_vec3 forward = forward_of(&viewport->camera);
    char plane[ISOSCULPT_CUT_TEXT];
    const char *at = strchr(text, '@');
    const double offset = front_of(viewport, forward) + parsed.depth, side = parsed.body.keeps ? 1 : -1;
    snprintf(plane, sizeof plane, "%.9g,%.9g,%.9g:%.9g,%.9g,%.9g%.60s", offset * forward.x,
             offset * forward.y, offset * forward.z, side * forward.x, side * forward.y, side * forward.z,
             at ? at : "");
    return isosculpt_cut_add(cut, plane, middle, error);
}
