/* Inputs: volume files, procedural scenes, points that isorender wrote, and any of the files on stdin. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/isorender/isorender.h"
#include "base/memory.h"
#include "grids/scenes/scenes.h"

/* ---- limits ---- */

static uint64_t memory_limit(const isorender_settings *settings) {
    return iso_memory_limit(settings->input.max_memory);
}

static iso_status check_picture(const isorender_job *job, iso_error *error) {
    if (!isorender_plan_draws(job->plan)) return ISO_OK;
    uint64_t needs = isorender_picture_bytes(job);
    uint64_t limit = memory_limit(job->settings);
    if (needs <= limit) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "a picture of %dx%d needs %.0f MB, limit is %.0f MB (--max-memory)",
                    job->settings->width, job->settings->height, (double)needs / 1e6, (double)limit / 1e6);
}

/* ---- scenes ---- */

enum { SCENE_NAME = 32 };

/* "NAME" or "NAME:SIZE". */
static iso_status split_scene(const char *text, char name[SCENE_NAME], int *size, iso_error *error) {
    size_t length = strcspn(text, ":");
    *size = 0;
    if (text[length] && (!iso_parse_int(text + length + 1, size) || *size < 16 || *size > ISO_HGRID_MAX))
        return iso_fail(error, ISO_ERR_USAGE, "the size of a scene is 16 to %d voxels a side", ISO_HGRID_MAX);
    snprintf(name, SCENE_NAME, "%.*s", length < SCENE_NAME ? (int)length : SCENE_NAME - 1, text);
    return ISO_OK;
}

/* Dense scenes take every voxel, sparse ones bricks along a surface: six faces of a cube and as much again.
 */
static uint64_t scene_bytes(const char *name, int size) {
    uint64_t side = size ? (uint64_t)size : 128;
    if (strcmp(name, "ct") == 0) return side * side * side;
    if (strcmp(name, "gyroid") == 0) return 4 * side * side * side;
    return 12 * side * side * (ISO_BRICK_VOXELS * sizeof(float) / (ISO_BRICK * ISO_BRICK));
}

static iso_status make_scene(isorender_job *job, iso_error *error) {
    char name[SCENE_NAME];
    iso_scene_opts opts = {.pool = job->pool};
    ISO_TRY(split_scene(job->plan->input + strlen("scene:"), name, &opts.size, error));
    uint64_t needs = scene_bytes(name, opts.size), limit = memory_limit(job->settings);
    if (needs > limit)
        return iso_fail(error, ISO_ERR_LIMIT, "needs about %.0f MB, limit is %.0f MB (--max-memory)",
                        (double)needs / 1e6, (double)limit / 1e6);
    ISO_TRY(iso_scene_create(name, &opts, &job->volume.grid, &job->scene_isovalue, error));
    const iso_grid *grid = &job->volume.grid;
    iso_volume_info *info = &job->volume.info;
    snprintf(info->format, sizeof info->format, "scene");
    snprintf(info->name, sizeof info->name, "%s", name);
    memcpy(info->dims, iso_grid_dims(grid), sizeof info->dims);
    info->type = grid->rgrid ? grid->rgrid->type : ISO_FLOAT32;
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_type_name(info->type));
    info->components = 1;
    info->transform = *iso_grid_transform(grid);
    info->scale = grid->rgrid ? grid->rgrid->scale : 1;
    info->offset = grid->rgrid ? grid->rgrid->offset : 0;
    info->level_set = iso_grid_is_level_set(grid) != 0;
    info->sparse = grid->hgrid != NULL;
    info->bytes = info->read_bytes = grid->hgrid ? iso_hgrid_bytes(grid->hgrid)
                                                 : (uint64_t)info->dims[0] * (uint64_t)info->dims[1] *
                                                       (uint64_t)info->dims[2] * iso_type_size(info->type);
    return ISO_OK;
}

/* ---- files ---- */

static int report_reading(void *context, double fraction) {
    isorender_progress(context, "reading", fraction);
    return 0;
}

static iso_volume_opts volume_opts(isorender_job *job) {
    iso_volume_opts opts = iso_input_volume_opts(&job->settings->input);
    opts.files = job->plan->files;
    opts.pool = job->pool;
    opts.progress = report_reading;
    opts.progress_context = job;
    return opts;
}

static bool is_ply(const char *path) {
    unsigned char head[4] = {0};
    int file = open(path, O_RDONLY | O_CLOEXEC);
    ssize_t count = file < 0 ? -1 : read(file, head, sizeof head);
    if (file >= 0) close(file);
    size_t length = strlen(path);
    bool named = length > 4 && strcasecmp(path + length - 4, ".ply") == 0;
    return named || (count == 4 && memcmp(head, "ply", 3) == 0 && (head[3] == '\n' || head[3] == '\r'));
}

/* What makes no sense without a volume. */
static iso_status check_points_only(const isorender_settings *settings, iso_error *error) {
    const isorender_method method = (isorender_method)settings->method;
    if (method == ISORENDER_EXACT || method == ISORENDER_MESH || method == ISORENDER_RAYCAST)
        return iso_fail(error, ISO_ERR_USAGE, "holds points, not a volume: --method %s needs a volume",
                        isorender_method_name(method));
    const char *option = settings->isovalue_count       ? "--isovalue"
                         : settings->mesh               ? "--mesh"
                         : settings->input.cropped      ? "--crop"
                         : settings->input.cropped_mm   ? "--crop-mm"
                         : settings->primitive          ? "--primitive"
                         : settings->input.largest      ? "--largest"
                         : settings->input.min_size > 0 ? "--min-size"
                         : settings->closed             ? "--closed"
                         : settings->input.grid         ? "--grid"
                         : settings->input.series       ? "--series"
                                                        : NULL;
    if (!option) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "holds points, not a volume: %s needs a volume", option);
}

/* Grids that surfaces have of their own, from what the header says. */
static iso_status check_solid(const isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    const iso_volume_info *info = &job->volume.info;
    int dims[3];
    for (int axis = 0; axis < 3; axis++) dims[axis] = job->crop[2 * axis + 1] - job->crop[2 * axis] + 1;
    const uint64_t more = isorender_solid_bytes(job, dims, info->bytes), limit = memory_limit(settings);
    if (more == 0 || settings->info || (info->bytes <= limit && more <= limit - info->bytes)) return ISO_OK;
    return iso_fail(
        error, ISO_ERR_LIMIT,
        "grids of %.0f MB for --closed or several surfaces' parts, beside the volume's %.0f MB, are "
        "over the limit of %.0f MB (--max-memory)",
        (double)more / 1e6, (double)info->bytes / 1e6, (double)limit / 1e6);
}

static iso_status find_crop(isorender_job *job, iso_error *error) {
    const iso_volume_info *info = &job->volume.info;
    ISO_TRY(iso_input_box(&job->settings->input, info->dims, &info->transform, job->crop, error));
    return check_solid(job, error);
}

void isorender_look(const isorender_settings *settings, const isorender_plan *plan) {
    iso_volume_info info;
    iso_volume_opts opts = iso_input_volume_opts(&settings->input);
    opts.files = plan->files;
    bool file = strncmp(plan->input, "scene:", 6) != 0 && !iso_spool_needed(plan->input);
    if (file && (settings->input.has_raw || !is_ply(plan->input)))
        iso_volume_read_info(plan->input, &opts, &info, NULL); /* errors are told when its turn comes */
}

static iso_status check_files(const isorender_job *job, iso_error *error) {
    return job->plan->files ? iso_file_set_check(job->plan->files, error) : ISO_OK;
}

iso_status isorender_open(isorender_job *job, iso_error *error) {
    const char *input = job->plan->input;
    job->scene_isovalue = NAN;
    job->path = input;
    job->method = job->settings->method == ISORENDER_UNCHOSEN ? ISORENDER_EXACT
                                                              : (isorender_method)job->settings->method;
    if (strncmp(input, "scene:", 6) == 0) {
        ISO_TRY(make_scene(job, error));
        ISO_TRY(check_picture(job, error));
        return find_crop(job, error);
    }
    iso_volume_opts opts = volume_opts(job);
    if (iso_spool_needed(input)) {
        iso_spool_opts spooling = {.volume = &opts, .points = true};
        ISO_TRY(iso_spool_open(input, &spooling, &job->spool, error));
        job->path = job->spool.path;
    }
    iso_file_set_read_as(job->plan->files, job->path, isorender_input_name(job));
    job->from_points = !job->settings->input.has_raw && is_ply(job->path);
    if (job->from_points) {
        if (job->method == ISORENDER_EXACT) job->method = ISORENDER_POINTS; /* unless it is asked for */
        ISO_TRY(check_files(job, error));
        ISO_TRY(check_picture(job, error));
        return check_points_only(job->settings, error);
    }
    ISO_TRY(iso_volume_read_info(job->path, &opts, &job->volume.info, error));
    ISO_TRY(check_files(job, error));
    /* A volume that is too large is what the user should hear of first: iso_volume_read says it. */
    if (job->volume.info.read_bytes <= memory_limit(job->settings)) ISO_TRY(check_picture(job, error));
    return find_crop(job, error);
}

static void print_notes(const isorender_job *job) {
    const iso_volume_info *info = &job->volume.info;
    for (int i = 0; i < info->note_count; i++) isorender_log(job, "note: %s", info->notes[i]);
    if (job->nonfinite)
        isorender_log(job, "note: %zu voxels are NaN or infinite, as floats: %s", job->nonfinite,
                      job->settings->closed ? "outside the solid" : "no surface is made next to them");
}

iso_status isorender_read(isorender_job *job, iso_error *error) {
    if (job->from_points) {
        uint64_t limit = memory_limit(job->settings);
        return iso_points_read_ply(job->path, limit == UINT64_MAX ? 0 : limit, &job->points, error);
    }
    if (isnan(job->scene_isovalue)) {
        iso_volume_opts opts = volume_opts(job);
        ISO_TRY(iso_volume_read(job->path, &opts, &job->volume, error));
        isorender_progress(job, "reading", 1);
    }
    ISO_TRY(iso_input_crop(&job->settings->input, job->crop, &job->volume.grid, error));
    job->nonfinite = iso_grid_count_nonfinite(&job->volume.grid, job->pool);
    print_notes(job);
    return ISO_OK;
}

void isorender_close(isorender_job *job) {
    iso_pullpush_destroy(job->pullpush);
    iso_points_free(&job->points);
    iso_volume_free(&job->volume);
    iso_spool_close(&job->spool);
}
