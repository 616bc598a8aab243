/* Pictures by OpenGL: surfaces to the GPU, a gbuffer back from it. */
#include "apps/isorender/isorender.h"
#include "render/gl/groups.h"
#include "render/gl/pullpush.h"
#include "render/gl/shapes.h"

uint64_t isorender_gl_bytes(const isorender_job *job) {
    const isorender_backend *backend = job->backend;
    if (!backend->engine || iso_gl_context_info(backend->context).hardware) return 0;
    const int factor = iso_picture_factor(job->samples), width = job->settings->width * factor,
              height = job->settings->height * factor;
    const uint64_t shapes =
        job->settings->object_options.count ? iso_gl_shapes_bytes(backend->engine, width, height) : 0;
    const bool splats = job->settings->method == ISO_METHOD_SPLATS;
    if (splats && job->settings->reconstruction == ISORENDER_RECONSTRUCTION_GROUPS) {
        const int slots = job->settings->groups ? job->settings->groups : ISO_GROUPS_DEFAULT;
        return shapes + iso_gl_groups_bytes(backend->engine, slots, width, height);
    }
    if (!isorender_has_reconstructions(job->settings->method))
        return shapes + iso_gl_draw_bytes(backend->engine, width, height);
    const bool selects = job->settings->selection != (int)ISO_SELECTION_ALL;
    return shapes + (selects ? iso_gl_selection_bytes(width, height) : 0) +
           iso_gl_pullpush_bytes(backend->engine, (iso_reconstruction)job->settings->reconstruction, width,
                                 height);
}

/* Uploads lines, glyphs and meshes, but no lines of the image pyramid. */
static iso_status upload_objects(isorender_job *job, iso_error *error) {
    for (int i = 0; i < job->object_count; i++) {
        const isorender_object *object = &job->objects[i];
        if (object->settings->kind == ISORENDER_MESH) {
            const iso_mesh_view mesh = iso_triangle_spans_view(&object->spans);
            ISO_TRY(iso_gl_upload_mesh(job->backend->engine, &mesh, &job->gl_meshes[i], error));
        }
        if (!object->shapes || object->pyramid_lines) continue;
        ISO_TRY(iso_gl_upload_shapes(job->backend->engine, object->shapes, &job->gl_shapes[i], error));
    }
    return ISO_OK;
}

iso_status isorender_gl_upload(isorender_job *job, iso_error *error) {
    iso_gl_engine_reset_seconds(job->backend->engine);
    ISO_TRY(upload_objects(job, error));
    if (isorender_uses_groups(job)) return ISO_OK; /* uploaded for every picture */
    for (int i = 0; i < job->surface_count; i++) {
        iso_gl_surface **uploaded = &job->gl_surfaces[i];
        if (job->method == ISO_METHOD_MESH) {
            ISO_TRY(iso_mesh_set_bound(job->surfaces[i].scene.mesh, error));
            iso_mesh_view mesh = iso_mesh_set_view(job->surfaces[i].scene.mesh);
            if (job->settings->strips)
                ISO_TRY(iso_gl_upload_strips(job->backend->engine, &mesh, uploaded, error));
            else
                ISO_TRY(iso_gl_upload_mesh(job->backend->engine, &mesh, uploaded, error));
        } else {
            iso_point_view points = iso_scene_surface_points(&job->surfaces[i].scene);
            ISO_TRY(iso_gl_upload_points(job->backend->engine, &points, uploaded, error));
        }
    }
    return ISO_OK;
}

void isorender_gl_release(isorender_job *job) {
    for (int i = 0; i < job->surface_count; i++) {
        iso_gl_surface_destroy(job->gl_surfaces[i]);
        job->gl_surfaces[i] = NULL;
    }
    for (int i = 0; i < job->object_count; i++) {
        iso_gl_shapes_destroy(job->gl_shapes[i]);
        iso_gl_surface_destroy(job->gl_meshes[i]);
        job->gl_shapes[i] = NULL;
        job->gl_meshes[i] = NULL;
    }
}

static iso_status draw_splats(const isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                              iso_error *error) {
    iso_gl_grouped_points surfaces[ISORENDER_SURFACES];
    for (int i = 0; i < job->surface_count; i++)
        surfaces[i] = (iso_gl_grouped_points){iso_scene_surface_points(&job->surfaces[i].scene),
                                              &job->surfaces[i].scene.groups};
    const iso_gl_draw_groups_opts opts = {view, surfaces, job->surface_count, job->pool};
    return iso_gl_draw_groups(job->backend->engine, &opts, gbuffer, error);
}

/* Draws the isosurfaces. */
static iso_status draw_surfaces(const isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                                iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_gl_surface *const *surfaces = (const iso_gl_surface *const *)job->gl_surfaces;
    if (isorender_uses_groups(job)) return draw_splats(job, view, gbuffer, error);
    if (isorender_has_reconstructions(job->method)) {
        const iso_gl_pullpush_opts pullpush = {view, surfaces, job->surface_count,
                                               (iso_reconstruction)settings->reconstruction,
                                               (iso_point_selection)settings->selection};
        return iso_gl_draw_pullpush(job->backend->engine, &pullpush, gbuffer, error);
    }
    iso_gl_draw_opts opts = {.view = view,
                             .surfaces = surfaces,
                             .surface_count = job->surface_count,
                             .scaling = (iso_point_scaling)settings->scaling};
    /* The view may be a strip; the bound on depth is the whole picture's. */
    opts.tan_y = iso_tan(job->camera.view_angle * (ISO_PI / 360));
    opts.tan_x = opts.tan_y * settings->width / settings->height;
    return iso_gl_draw(job->backend->engine, &opts, gbuffer, error);
}

/* Draws lines or glyphs. Objects are drawn one after the other, so that their samples are counted as the
 * cpu's are: before later ones hide them. */
static iso_status draw_shapes(isorender_job *job, int object, const iso_view *view, iso_gbuffer *gbuffer,
                              iso_error *error) {
    const iso_gl_shapes *const sets[] = {job->gl_shapes[object]};
    const iso_gl_shapes_opts opts = {view, sets, 1, job->surface_count + object};
    return iso_gl_draw_shapes(job->backend->engine, &opts, gbuffer, &job->objects[object].drawn, error);
}

/* Draws a mesh of a file. */
static iso_status draw_mesh(const isorender_job *job, int object, const iso_view *view, iso_gbuffer *gbuffer,
                            iso_error *error) {
    const iso_gl_surface *const surface = job->gl_meshes[object];
    const iso_gl_draw_opts opts = {.view = view,
                                   .surfaces = &surface,
                                   .surface_count = 1,
                                   .first_surface = job->surface_count + object,
                                   .keep = true};
    return iso_gl_draw(job->backend->engine, &opts, gbuffer, error);
}

/* Draws an object. The cpu draws lines in the image pyramid, and meshes whose triangles are to be
 * numbered. */
static iso_status draw_object(isorender_job *job, int object, const iso_view *view, iso_gbuffer *gbuffer,
                              iso_error *error) {
    const iso_target target = {view, gbuffer, job->pool, (uint8_t)(job->surface_count + object)};
    if (job->gl_shapes[object]) return draw_shapes(job, object, view, gbuffer, error);
    if (job->gl_meshes[object] && !gbuffer->element) return draw_mesh(job, object, view, gbuffer, error);
    job->objects[object].by_cpu = true;
    return isorender_object_draw(&job->objects[object], &target,
                                 iso_point_workspace_pullpush(job->point_workspace), error);
}

iso_status isorender_gl_draw(isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                             iso_error *error) {
    if (job->surface_count) ISO_TRY(draw_surfaces(job, view, gbuffer, error));
    for (int i = 0; i < job->object_count; i++) ISO_TRY(draw_object(job, i, view, gbuffer, error));
    return ISO_OK;
}
