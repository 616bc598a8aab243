/* Pictures by OpenGL: surfaces to the GPU, a gbuffer back from it. */
#include "apps/isorender/isorender.h"
#include "render/gl/pullpush.h"
#include "render/gl/splats.h"

uint64_t isorender_gl_bytes(const isorender_job *job) {
    const isorender_backend *backend = job->backend;
    if (!backend->engine || iso_gl_context_info(backend->context).hardware) return 0;
    int factor = 1;
    while (factor * factor < job->settings->samples) factor++;
    const int width = job->settings->width * factor, height = job->settings->height * factor;
    if (job->settings->method == ISO_METHOD_SPLATS) {
        const int slots = job->settings->groups ? job->settings->groups : ISO_SPLATS_GROUPS;
        return iso_gl_splats_bytes(backend->engine, slots, width, height);
    }
    if (job->settings->method != ISO_METHOD_PULLPUSH)
        return iso_gl_draw_bytes(backend->engine, width, height);
    return iso_gl_pullpush_bytes(backend->engine, (iso_reconstruction)job->settings->reconstruction, width,
                                 height);
}

iso_status isorender_gl_upload(isorender_job *job, iso_error *error) {
    iso_gl_engine_reset_seconds(job->backend->engine);
    if (job->method == ISO_METHOD_SPLATS) return ISO_OK; /* splats are uploaded for every picture */
    for (int i = 0; i < job->surface_count; i++) {
        iso_gl_surface **uploaded = &job->gl_surfaces[i];
        if (job->method == ISO_METHOD_MESH) {
            ISO_TRY(iso_mesh_set_bound(job->surfaces[i].mesh, error));
            iso_mesh_view mesh = iso_mesh_set_view(job->surfaces[i].mesh);
            if (job->settings->strips)
                ISO_TRY(iso_gl_upload_strips(job->backend->engine, &mesh, uploaded, error));
            else
                ISO_TRY(iso_gl_upload_mesh(job->backend->engine, &mesh, uploaded, error));
        } else {
            iso_point_view points = isorender_points_view(job, i);
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
}

static iso_status draw_splats(const isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                              iso_error *error) {
    iso_gl_splats surfaces[ISORENDER_SURFACES];
    for (int i = 0; i < job->surface_count; i++)
        surfaces[i] = (iso_gl_splats){isorender_points_view(job, i), &job->surfaces[i].groups};
    const iso_gl_splats_opts opts = {view, surfaces, job->surface_count, job->pool};
    return iso_gl_draw_splats(job->backend->engine, &opts, gbuffer, error);
}

iso_status isorender_gl_draw(const isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                             iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_gl_surface *const *surfaces = (const iso_gl_surface *const *)job->gl_surfaces;
    if (job->method == ISO_METHOD_SPLATS) return draw_splats(job, view, gbuffer, error);
    if (job->method == ISO_METHOD_PULLPUSH) {
        const iso_gl_pullpush_opts pullpush = {view, surfaces, job->surface_count,
                                               (iso_reconstruction)settings->reconstruction};
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
