/* The steps of the work on one input, and the removal of its outputs when a step fails. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/chunks.h"
#include "apps/isorender/colorings.h"
#include "apps/isorender/engines.h"
#include "apps/isorender/isorender.h"
#include "apps/isorender/keyframes.h"
#include "apps/isorender/mpi_ranks.h"
#include "apps/isorender/scene_file.h"
#include "apps/isorender/segmentation.h"
#include "apps/isorender/series.h"
#include "apps/isorender/sheet.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

/* A volume without finite voxels has no histogram. */
static iso_status make_histogram(iso_loader *loader, iso_error *error) {
    const iso_status status = iso_loader_histogram(loader, error);
    return status == ISO_ERR_EMPTY ? ISO_OK : status;
}

static iso_status print_info(isorender_job *job, iso_error *error) {
    bool text = !job->settings->common.json;
    double start = iso_clock_seconds();
    if (text) isorender_info_header(job);
    ISO_TRY(isorender_read(job, error));
    job->seconds.load += iso_clock_seconds() - start;
    if (job->has_volume) ISO_TRY(make_histogram(&job->loader, error));
    for (int i = 0; i < job->volume_count; i++) ISO_TRY(make_histogram(&job->volumes[i], error));
    if (text) isorender_info_values(job);
    return ISO_OK;
}

/* Says of --decimate and --smooth-mesh what may be taken for something else. */
static void note_edits(const isorender_job *job) {
    const iso_mesh_edits *edits = &job->settings->mesh_edits;
    const double mm = edits->deviation;
    if (mm > 0 && mm < 1)
        isorender_log(job, "note: --decimate %g is a distance, %g mm; %g%% is a share of the triangles", mm,
                      mm, 100 * mm);
    if (job->plan->image && job->method == ISO_METHOD_MESH && (edits->smooth || mm > 0 || edits->keep > 0))
        isorender_log(job,
                      "note: the picture shows the mesh before %s; the file is drawn by itself: isorender %s",
                      edits->smooth ? "--smooth-mesh" : "--decimate", job->plan->mesh);
}

/* One line for each export. Open edges of a mesh are said: it cannot be printed. */
static void log_exports(const isorender_job *job) {
    const iso_mesh_measures *mesh = &job->surfaces[0].measures;
    if (job->plan->mesh) note_edits(job);
    if (job->plan->table)
        isorender_log(job, "wrote %s: %d labels", job->plan->table, job->segmentation->labels.count - 1);
    if (job->plan->points)
        isorender_log(job, "wrote %s: %" PRIu64 " points", job->plan->points, job->point_count);
    if (job->plan->mesh && job->chunks) /* its edges are not known: they are never in memory together */
        isorender_log(job, "wrote %s: %" PRIu64 " triangles", job->plan->mesh, job->triangle_count);
    else if (job->plan->mesh && job->segmentation && !job->input_surface_count)
        isorender_log(job, "wrote %s: %" PRIu64 " triangles", job->plan->mesh, job->triangle_count);
    else if (job->plan->mesh && !mesh->open_edges)
        isorender_log(job, "wrote %s: %zu triangles, closed", job->plan->mesh, mesh->triangles);
    else if (job->plan->mesh)
        isorender_log(
            job,
            "wrote %s: %zu triangles, %zu open edges where the volume's border or voxels that are no "
            "numbers cut the solid: --closed caps it there",
            job->plan->mesh, mesh->triangles, mesh->open_edges);
}

/* Logs the name of a picture, of a video, or the names of the first and last of several pictures. */
static void log_pictures(const isorender_job *job, const char *name) {
    const int count = job->settings->pictures;
    char *first = NULL, *last = NULL;
    const iso_status status = isorender_plan_frame(job->plan, name, 0, &first, NULL);
    const bool video = job->plan->video && name == job->plan->image;
    if (video && job->frames_written) /* by the last step of a series */
        isorender_log(job, "wrote %s: %d pictures", first, job->settings->film->count);
    else if (!video && status == ISO_OK && count <= 1)
        isorender_log(job, "wrote %s", first);
    else if (!video && first && isorender_plan_frame(job->plan, name, count - 1, &last, NULL) == ISO_OK)
        isorender_log(job, "wrote %s to %s", first, last);
    free(first);
    free(last);
}

static void log_outputs(const isorender_job *job) {
    isorender_log_verbose(job, "load %.3f s, extract %.3f s, render %.3f s, write %.3f s", job->seconds.load,
                          job->seconds.extract, job->seconds.render, job->seconds.write);
    log_exports(job);
    if (job->plan->image && strcmp(job->plan->image, "-") != 0) log_pictures(job, job->plan->image);
    if (job->plan->aov) log_pictures(job, job->plan->aov);
}

/* What became of the faces of an input that could be drawn as points. */
static void log_faces(const isorender_job *job) {
    if (job->settings->faces == ISORENDER_FACES_DRAWN)
        isorender_log(job, "note: drawn as the mesh of its faces (--method splats: its vertices as points)");
    if (job->settings->faces == ISORENDER_FACES_LEFT_OUT)
        isorender_log(job, "note: drawn as points: its faces are not drawn (--surface draws them)");
}

static iso_status make_at_once(isorender_job *job, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(iso_ranks_agree(&job->settings->ranks, isorender_read(job, error), error));
    ISO_TRY(isorender_ranks_check_volume(job, error));
    double read = iso_clock_seconds();
    job->seconds.load += read - start;
    ISO_TRY(isorender_extract(job, error));
    ISO_TRY(isorender_colorings_make(job, error));
    if (job->settings->film->measuring) isorender_series_measure(job);
    if (job->settings->film->measuring) return ISO_OK;
    log_faces(job);
    double extracted = iso_clock_seconds();
    job->seconds.extract = extracted - read;
    ISO_TRY(isorender_export(job, error));
    job->seconds.write = iso_clock_seconds() - extracted;
    if (isorender_plan_draws(job->plan)) ISO_TRY(isorender_render(job, error));
    return ISO_OK;
}

static void free_surfaces(isorender_job *job) {
    iso_gl_scene_free(&job->gl);
    for (int i = 0; i < job->surface_count; i++) {
        iso_scene_surface_free(&job->surfaces[i].scene);
        iso_grid_destroy(&job->surfaces[i].own_grid);
    }
    iso_cloud_free(&job->cloud.discs);
    isorender_instances_free(job);
    for (int i = 0; i < job->object_count; i++) isorender_object_free(&job->objects[i]);
    free(job->frames);
    free(job->clips);
}

/* Frees what an attempt has made of the volume; what is known of its values is kept. */
static void forget_surfaces(isorender_job *job) {
    const iso_volume_info info = job->loader.volume.info;
    free_surfaces(job);
    iso_point_workspace_destroy(job->point_workspace);
    iso_occluders_free(&job->occluders);
    iso_volume_free(&job->loader.volume);
    job->loader.volume.info = info;
    job->point_workspace = NULL;
    job->frames = NULL;
    job->clips = NULL;
    memset(job->surfaces, 0, sizeof job->surfaces);
    job->surface_count = job->input_surface_count = 0;
    job->point_count = job->rejected = job->vertex_count = job->triangle_count = job->cell_count = 0;
}

/* A volume that fits into memory, but not together with its surface, is drawn in chunks if that is possible.
 */
static iso_status make_outputs(isorender_job *job, iso_error *error) {
    const iso_status status = make_at_once(job, error);
    const bool is_step = job->settings->series_of && !job->settings->film->measuring;
    if (status == ISO_ERR_EMPTY && is_step && !job->frames && isorender_plan_draws(job->plan))
        return isorender_render_nothing(job, error);
    if (status != ISO_ERR_NOMEM || job->chunks) return status;
    const iso_error first = *error;
    job->did_not_fit = true;
    ISO_TRY(isorender_chunks_choose(job, error));
    if (!job->chunks) return iso_fail(error, status, "%s", first.text);
    isorender_log_verbose(job, "does not fit into memory as a whole (%s): in chunks", first.text);
    forget_surfaces(job);
    return make_at_once(job, error);
}

static iso_status open_and_check(isorender_job *job, iso_error *error) {
    const double start = iso_clock_seconds();
    ISO_TRY(isorender_open(job, error));
    job->seconds.load = iso_clock_seconds() - start;
    return job->settings->ranks.rank ? ISO_OK : isorender_plan_check_writable(job->plan, error);
}

static void log_old_discs(const isorender_job *job) {
    const char *name = isorender_reconstruction_name(job->settings, false);
    if (job->settings->old_discs)
        isorender_log(job,
                      "note: --method pullpush --reconstruction %s is an older name of --method discs "
                      "--reconstruction %s, which is drawn",
                      name, name);
}

static iso_status run_steps(isorender_job *job, iso_error *error) {
    double start = iso_clock_seconds();
    ISO_TRY(iso_ranks_agree(&job->settings->ranks, open_and_check(job, error), error));
    const iso_ranks *ranks = &job->settings->ranks;
    log_old_discs(job);
    const iso_status made = job->settings->info ? print_info(job, error) : make_outputs(job, error);
    ISO_TRY(iso_ranks_agree(ranks, made, error));
    if (job->settings->film->measuring) return ISO_OK;
    ISO_TRY(isorender_ranks_memory(ranks, job->rank_bytes, error));
    job->seconds.total = iso_clock_seconds() - start;
    if (job->settings->common.json && !job->settings->ranks.rank) ISO_TRY(isorender_report_json(job, error));
    if (job->settings->sheet.tile) ISO_TRY(isorender_tile_measure(job, error));
    if (job->settings->panel || job->settings->sheet.tile) return ISO_OK;
    if (!job->settings->ranks.rank) ISO_TRY(isorender_scene_save(job, error));
    if (!job->settings->info) isorender_engines_log(job);
    if (!job->settings->info) log_outputs(job);
    return ISO_OK;
}

static void remove_frames(const isorender_plan *plan, const char *name, int count) {
    for (int frame = 0; frame < count; frame++) {
        char *path = NULL;
        if (isorender_plan_frame(plan, name, frame, &path, NULL) != ISO_OK) continue;
        iso_file_remove(path);
        free(path);
    }
}

/* After an error, outputs written before it are removed: they would pass for a complete result. */
static void remove_outputs(const isorender_job *job) {
    if (job->points_written) iso_file_remove(job->plan->points);
    if (job->mesh_written) iso_file_remove(job->plan->mesh);
    if (job->table_written) iso_file_remove(job->plan->table);
    iso_video_abort(job->settings->film->video);
    job->settings->film->video = NULL;
    remove_frames(job->plan, job->plan->image, job->frames_written);
    remove_frames(job->plan, job->plan->aov, job->aovs_written);
}

/* Puts the input's name before a message, unless the message begins with it or names an output. */
static void name_input(const isorender_job *job, iso_error *error) {
    const char *name = isorender_input_name(job), *text = error->text;
    if (error->status == ISO_ERR_WRITE || iso_text_begins(text, name)) return;
    size_t length = job->loader.path ? iso_text_begins(text, job->loader.path) : 0;
    if (text[length] != ':' && text[length] != '/') length = 0;
    if (length && !job->loader.spool.path) return;
    iso_fail(error, error->status, "%s: %s", name,
             length ? text + length + strspn(text + length, ":/ ") : text);
}

/* Agrees with the other ranks on how the work on an input has ended, before that on the next one. */
static iso_status end_together(const isorender_settings *settings, iso_status status, iso_error *error) {
    status = iso_ranks_agree(&settings->ranks, status, error);
    iso_ranks_go_on(&settings->ranks);
    return status;
}

iso_status isorender_run(const isorender_settings *settings, const isorender_plan *plan, iso_pool *pool,
                         const isorender_backend *backend, const iso_environment *environment,
                         iso_error *error) {
    isorender_job *job = calloc(1, sizeof *job);
    if (!job) return end_together(settings, iso_fail_memory(error, plan->input), error);
    job->given = settings;
    job->settings = isorender_keyframes_at(settings, settings->film->first);
    job->plan = plan;
    job->pool = pool;
    job->backend = backend;
    job->environment = environment;
    iso_status status = run_steps(job, error);
    iso_pool_watch(pool, NULL, NULL); /* by this job */
    status = end_together(settings, status, error);
    if (status != ISO_OK && !settings->ranks.rank) remove_outputs(job);
    if (status != ISO_OK && error->text[0]) name_input(job, error);
    free_surfaces(job);
    isorender_segmentation_free(job);
    isorender_chunks_free(job);
    iso_point_workspace_destroy(job->point_workspace);
    iso_occluders_free(&job->occluders);
    isorender_colorings_free(job);
    iso_loader_close(&job->loader);
    for (int i = 0; i < job->volume_count; i++) iso_loader_close(&job->volumes[i]);
    free(job);
    return status;
}

iso_status isorender_environment_open(const isorender_settings *settings, iso_pool *pool,
                                      iso_environment **environment, iso_error *error) {
    int size[2];
    if (!(settings->ior > 0)) return ISO_OK;
    if (settings->environment)
        ISO_TRY(iso_environment_read(settings->environment,
                                     iso_memory_limit(settings->common.input.max_memory), pool, environment,
                                     error));
    else
        ISO_TRY(iso_environment_studio(environment, error));
    iso_environment_set_up(*environment, settings->up);
    iso_environment_size(*environment, size);
    if (size[0] != 2 * size[1] && !settings->common.quiet)
        fprintf(stderr,
                "%s: note: %s: %dx%d pixels, not twice as wide as high: stretched over all directions\n",
                isorender_program()->name, settings->environment, size[0], size[1]);
    return ISO_OK;
}
