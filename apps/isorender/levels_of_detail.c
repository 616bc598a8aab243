/* Levels of detail of points (--lod): checks the option, makes the levels, reports what was drawn. */
#include <math.h>

#include "apps/isorender/isorender.h"

/* The value of --lod that is assumed. */
static const double DEFAULT_PIXELS = 1;

iso_status isorender_detail_check(isorender_settings *settings, iso_error *error) {
    const bool asked = settings->lod > 0; /* NaN: not given */
    if (!asked) return ISO_OK;
    if (settings->method == ISORENDER_METHOD_UNCHOSEN) settings->method = ISO_METHOD_DISCS;
    return isorender_method_require(settings, ISO_CAN_LEVELS, "levels of detail (--lod)", error);
}

double isorender_detail_pixels(const isorender_settings *settings) {
    return isnan(settings->lod) ? DEFAULT_PIXELS : settings->lod;
}

/* Whether the voxels of level 1 are so small in the middle of a surface that it would be drawn. */
static bool is_fine(const isorender_job *job, int surface, double pixels) {
    const iso_view view = iso_view_make(&job->camera, job->settings->width, job->settings->height);
    const iso_box *box = &job->surfaces[surface].bounds;
    const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(box->lo, box->hi), 0.5),
                   seen = iso_view_point(&view, middle);
    const double *side = iso_scene_surface_points(&job->surfaces[surface].scene).transform.spacing,
                 voxel = 2 * fmax(side[0], fmax(side[1], side[2])),
                 scale = view.orthographic ? view.focal : view.focal / fmax(seen.z, view.near),
                 samples = sqrt(job->samples);
    return voxel * ISO_LOD_FLAT_ERROR * scale * samples <= pixels;
}

/* How often a surface is drawn in all pictures together. */
static double drawings_of(const isorender_job *job) {
    const int pictures = job->settings->turntable > 1 ? job->settings->turntable : 1;
    return (double)pictures * (double)job->instances.placements.count;
}

static bool is_wanted(const isorender_job *job, int surface) {
    const isorender_settings *settings = job->settings;
    if (!(job->renderer->can & ISO_CAN_LEVELS) || settings->lod == 0 || settings->one_pyramid) return false;
    if (settings->lod > 0) return true;
    if (isorender_has_instances(job, surface)) return drawings_of(job) >= ISO_LOD_PAYING_DRAWINGS;
    if (job->backend->engine) return false; /* OpenGL gets them anew for every picture */
    return settings->turntable >= ISO_LOD_PAYING_DRAWINGS && is_fine(job, surface, DEFAULT_PIXELS);
}

iso_status isorender_detail_make(isorender_job *job, iso_error *error) {
    for (int i = 0; i < job->surface_count; i++) {
        iso_scene_surface *scene = &job->surfaces[i].scene;
        if (!is_wanted(job, i)) continue;
        const iso_status status = iso_scene_surface_make_levels(scene, error);
        if (status != ISO_OK && isnan(job->settings->lod)) continue; /* the picture needs no levels */
        ISO_TRY(status);
        isorender_log_verbose(job, "%d levels of detail: %zu points beside the %zu points themselves",
                              scene->lod.count, iso_lod_count(&scene->lod),
                              iso_point_view_count(&scene->lod.points));
    }
    return ISO_OK;
}

iso_selection_counts isorender_selection(const isorender_job *job) {
    if (job->backend->engine && job->settings->selection != (int)ISO_SELECTION_ALL)
        return iso_gl_engine_selection(job->backend->engine);
    const iso_point_workspace *workspaces[] = {job->point_workspace, job->instances.placed.drawing.workspace};
    iso_selection_counts all = {0};
    for (int i = 0; i < 2; i++) {
        if (!workspaces[i]) continue;
        const iso_selection_counts counts = iso_point_workspace_counts(workspaces[i]);
        all.points += counts.points;
        all.tested += counts.tested;
        all.drawn += counts.drawn;
    }
    return all;
}

void isorender_detail_note(const isorender_job *job, const iso_selection_counts *before,
                           isorender_frame *frame) {
    const iso_selection_counts after = isorender_selection(job);
    frame->selection = (iso_selection_counts){after.points - before->points, after.tested - before->tested,
                                              after.drawn - before->drawn};
    for (int i = 0; i < job->surface_count; i++) {
        const iso_lod_cut *cut = job->surfaces[i].scene.cut;
        for (int k = 0; cut && k < cut->levels; k++) frame->detail[k] += cut->points[k];
        if (cut && cut->levels > frame->detail_levels) frame->detail_levels = cut->levels;
    }
}

void isorender_detail_report(iso_json *json, const isorender_frame *frame) {
    if (frame->selection.points) {
        iso_json_begin_object(json, "selection");
        iso_json_integer(json, "points", frame->selection.points);
        iso_json_integer(json, "tested", frame->selection.tested);
        iso_json_integer(json, "drawn", frame->selection.drawn);
        iso_json_end_object(json);
    }
    if (!frame->detail_levels) return;
    iso_json_begin_array(json, "lod_points");
    for (int k = 0; k < frame->detail_levels; k++) iso_json_integer(json, NULL, frame->detail[k]);
    iso_json_end_array(json);
}
