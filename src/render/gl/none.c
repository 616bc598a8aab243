/* none: replaces render/gl in a build without glad. Creating a context fails with ISO_ERR_BACKEND; the other
 * functions exist for the linker. */
#include <stddef.h>

#include "render/gl/canvas.h"
#include "render/gl/groups.h"
#include "render/gl/hybrid.h"
#include "render/gl/instances.h"
#include "render/gl/lines.h"
#include "render/gl/sets.h"
#include "render/gl/shapes.h"

static iso_status refuse(iso_error *error) {
    return iso_fail(error, ISO_ERR_BACKEND, "this isopoint was built without glad (OpenGL)");
}

iso_status iso_gl_context_create(const iso_gl_context_opts *opts, iso_gl_context **context,
                                 iso_error *error) {
    (void)opts, (void)context;
    return refuse(error);
}

iso_status iso_gl_context_open_egl(bool hardware_only, iso_gl_context **context, iso_error *error) {
    (void)hardware_only, (void)context;
    return refuse(error);
}

iso_status iso_gl_devices(iso_gl_device *devices, int capacity, int *count, iso_error *error) {
    (void)devices, (void)capacity, (void)count;
    return refuse(error);
}

void iso_gl_context_destroy(iso_gl_context *context) {
    (void)context;
}

iso_gl_info iso_gl_context_info(const iso_gl_context *context) {
    (void)context;
    return (iso_gl_info){"", "", "", "", false};
}

iso_gl_messages iso_gl_context_messages(const iso_gl_context *context) {
    (void)context;
    return (iso_gl_messages){0, ""};
}

bool iso_gl_renderer_is_software(const char *renderer) {
    (void)renderer;
    return true;
}

iso_status iso_gl_engine_create(iso_gl_context *context, iso_gl_engine **engine, iso_error *error) {
    (void)context, (void)engine;
    return refuse(error);
}

void iso_gl_engine_destroy(iso_gl_engine *engine) {
    (void)engine;
}

uint64_t iso_gl_draw_bytes(const iso_gl_engine *engine, int width, int height) {
    (void)engine, (void)width, (void)height;
    return 0;
}

uint64_t iso_gl_pullpush_bytes(const iso_gl_engine *engine, iso_reconstruction reconstruction, int width,
                               int height) {
    (void)engine, (void)reconstruction, (void)width, (void)height;
    return 0;
}

iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_surface **surface,
                                iso_error *error) {
    (void)engine, (void)points, (void)surface;
    return refuse(error);
}

iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                              iso_error *error) {
    (void)engine, (void)mesh, (void)surface;
    return refuse(error);
}

iso_status iso_gl_upload_strips(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                                iso_error *error) {
    (void)engine, (void)mesh, (void)surface;
    return refuse(error);
}

iso_status iso_gl_update_points(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    (void)surface, (void)points;
    return refuse(error);
}

iso_status iso_gl_update_mesh(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error) {
    (void)surface, (void)mesh;
    return refuse(error);
}

iso_gl_surface_stats iso_gl_surface_measure(const iso_gl_surface *surface) {
    (void)surface;
    return (iso_gl_surface_stats){0};
}

void iso_gl_surface_destroy(iso_gl_surface *surface) {
    (void)surface;
}

iso_status iso_gl_draw(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_gbuffer *gbuffer,
                       iso_error *error) {
    (void)engine, (void)opts, (void)gbuffer;
    return refuse(error);
}

iso_status iso_gl_draw_pullpush(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, iso_gbuffer *gbuffer,
                                iso_error *error) {
    (void)engine, (void)opts, (void)gbuffer;
    return refuse(error);
}

iso_selection_counts iso_gl_engine_selection(const iso_gl_engine *engine) {
    (void)engine;
    return (iso_selection_counts){0};
}

uint64_t iso_gl_selection_bytes(int width, int height) {
    (void)width;
    (void)height;
    return 0;
}

const char *iso_gl_pass_name(iso_gl_pass pass) {
    (void)pass;
    return "";
}

void iso_gl_engine_seconds(const iso_gl_engine *engine, double seconds[ISO_GL_PASSES]) {
    (void)engine;
    for (int i = 0; i < ISO_GL_PASSES; i++) seconds[i] = 0;
}

void iso_gl_engine_reset_seconds(iso_gl_engine *engine) {
    (void)engine;
}

iso_status iso_gl_canvas_create(iso_gl_engine *engine, iso_gl_canvas **canvas, iso_error *error) {
    (void)engine, (void)canvas;
    return refuse(error);
}

void iso_gl_canvas_destroy(iso_gl_canvas *canvas) {
    (void)canvas;
}

iso_status iso_gl_canvas_draw(iso_gl_canvas *canvas, const iso_gl_draw_opts *opts, const iso_gl_paint *paint,
                              iso_error *error) {
    (void)canvas, (void)opts, (void)paint;
    return refuse(error);
}

iso_status iso_gl_canvas_draw_pullpush(iso_gl_canvas *canvas, const iso_gl_pullpush_opts *opts,
                                       const iso_gl_paint *paint, iso_error *error) {
    (void)canvas, (void)opts, (void)paint;
    return refuse(error);
}

unsigned iso_gl_canvas_texture(const iso_gl_canvas *canvas) {
    (void)canvas;
    return 0;
}

bool iso_gl_canvas_pick(const iso_gl_canvas *canvas, int x, int y, float normal_depth[4]) {
    (void)canvas, (void)x, (void)y, (void)normal_depth;
    return false;
}

iso_status iso_gl_canvas_copy(iso_gl_canvas *to, const iso_gl_canvas *from, iso_error *error) {
    (void)to, (void)from;
    return refuse(error);
}

iso_status iso_gl_canvas_read(const iso_gl_canvas *canvas, iso_image *image, iso_error *error) {
    (void)canvas, (void)image;
    return refuse(error);
}

iso_status iso_gl_draw_hybrid(iso_gl_engine *engine, const iso_target *target, const iso_point_view *points,
                              const iso_mesh_view *mesh, iso_error *error) {
    (void)engine, (void)target, (void)points, (void)mesh;
    return refuse(error);
}

iso_status iso_gl_draw_pullpush_over(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, int first,
                                     const iso_gl_triangles *triangles, iso_gbuffer *gbuffer,
                                     iso_error *error) {
    (void)engine, (void)opts, (void)first, (void)triangles, (void)gbuffer;
    return refuse(error);
}

iso_status iso_gl_draw_instances(iso_gl_engine *engine, iso_instance_drawing *drawing,
                                 const iso_target *target, const iso_instances *instances,
                                 iso_instance_counts *counts, iso_error *error) {
    (void)engine, (void)drawing, (void)target, (void)instances, (void)counts;
    return refuse(error);
}

iso_status iso_gl_draw_pyramid_lines(iso_gl_engine *engine, const iso_target *target,
                                     const iso_pyramid_lines *lines, iso_pullpush *workspace,
                                     iso_error *error) {
    (void)engine, (void)target, (void)lines, (void)workspace;
    return refuse(error);
}

iso_status iso_gl_draw_pyramid_sets(iso_gl_engine *engine, const iso_target *target,
                                    const iso_pyramid_set *sets, size_t count, const iso_pullpush_opts *opts,
                                    iso_error *error) {
    (void)engine, (void)target, (void)sets, (void)count, (void)opts;
    return refuse(error);
}

iso_status iso_gl_draw_groups(iso_gl_engine *engine, const iso_gl_draw_groups_opts *opts,
                              iso_gbuffer *gbuffer, iso_error *error) {
    (void)engine, (void)opts, (void)gbuffer;
    return refuse(error);
}

iso_status iso_gl_shade_splat_layers(iso_gl_engine *engine, const iso_splat_layers *input,
                                     iso_layer_totals *totals, iso_error *error) {
    (void)engine, (void)input, (void)totals;
    return refuse(error);
}

uint64_t iso_gl_groups_bytes(const iso_gl_engine *engine, int slots, int width, int height) {
    (void)engine, (void)slots, (void)width, (void)height;
    return 0;
}

iso_status iso_gl_upload_shapes(iso_gl_engine *engine, const iso_shapes *shapes, iso_gl_shapes **uploaded,
                                iso_error *error) {
    (void)engine, (void)shapes, (void)uploaded;
    return refuse(error);
}

void iso_gl_shapes_destroy(iso_gl_shapes *shapes) {
    (void)shapes;
}

iso_status iso_gl_draw_shapes(iso_gl_engine *engine, const iso_gl_shapes_opts *opts, iso_gbuffer *gbuffer,
                              iso_shapes_drawn *drawn, iso_error *error) {
    (void)engine, (void)opts, (void)gbuffer, (void)drawn;
    return refuse(error);
}

uint64_t iso_gl_shapes_bytes(const iso_gl_engine *engine, int width, int height) {
    (void)engine, (void)width, (void)height;
    return 0;
}
