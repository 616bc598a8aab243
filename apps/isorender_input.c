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

#include "apps/isorender.h"
#include "base/memory.h"
#include "grids/scenes.h"

/* ---- stdin ---- */

/* libnifti goes by the name, everything else by the content. */
static const char *suffix_of(const unsigned char *head, size_t count) {
    if (count >= 2 && head[0] == 0x1f && head[1] == 0x8b) return ".nii.gz";
    bool nifti = count >= 4 && (memcmp(head, "\x5c\1\0\0", 4) == 0 || memcmp(head, "\0\0\1\x5c", 4) == 0 ||
                                memcmp(head, "\x1c\2\0\0", 4) == 0 || memcmp(head, "\0\0\2\x1c", 4) == 0);
    return nifti ? ".nii" : "";
}

static iso_status write_all(int file, const unsigned char *data, size_t count, const char *path,
                            iso_error *error) {
    while (count > 0) {
        ssize_t written = write(file, data, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0)
            return iso_fail(error, ISO_ERR_WRITE, "%s: cannot copy standard input here: %s", path,
                            strerror(errno));
        data += written;
        count -= (size_t)written;
    }
    return ISO_OK;
}

/* Reads until `room` bytes are there or the input ends. */
static iso_status read_block(unsigned char *data, size_t room, size_t *count, iso_error *error) {
    *count = 0;
    while (*count < room) {
        ssize_t got = read(STDIN_FILENO, data + *count, room - *count);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return iso_fail(error, ISO_ERR_IO, "standard input: cannot read: %s", strerror(errno));
        if (got == 0) break;
        *count += (size_t)got;
    }
    return ISO_OK;
}

/* Copies stdin into a new file, whose name goes to job->copy as soon as it exists. */
static iso_status copy_blocks(isorender_job *job, unsigned char *block, size_t room, iso_error *error) {
    size_t count;
    ISO_TRY(read_block(block, room, &count, error));
    if (count == 0) return iso_fail(error, ISO_ERR_IO, "standard input: is empty");
    const char *folder = getenv("TMPDIR"), *suffix = suffix_of(block, count);
    char *path = NULL;
    if (asprintf(&path, "%s/isorender-XXXXXX%s", folder && *folder ? folder : "/tmp", suffix) < 0)
        return iso_fail(error, ISO_ERR_NOMEM, "standard input: out of memory");
    int file = mkstemps(path, (int)strlen(suffix));
    if (file < 0) {
        iso_fail(error, ISO_ERR_WRITE, "%s: cannot copy standard input here: %s", path, strerror(errno));
        free(path);
        return ISO_ERR_WRITE;
    }
    job->copy = path;
    iso_status status = ISO_OK;
    while (status == ISO_OK && count > 0) {
        status = write_all(file, block, count, path, error);
        if (status == ISO_OK) status = read_block(block, room, &count, error);
    }
    close(file);
    return status;
}

static iso_status copy_stdin(isorender_job *job, iso_error *error) {
    enum { BLOCK = 1 << 20 };
    unsigned char *block = iso_alloc(BLOCK);
    if (!block) return iso_fail(error, ISO_ERR_NOMEM, "standard input: out of memory");
    iso_status status = copy_blocks(job, block, BLOCK, error);
    iso_free(block);
    return status;
}

/* ---- limits ---- */

static uint64_t memory_limit(const isorender_settings *settings) {
    if (settings->input.max_memory) return settings->input.max_memory;
    uint64_t free_bytes = iso_memory_available();
    return free_bytes == UINT64_MAX ? free_bytes : free_bytes / 5 * 4;
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
    if (strcmp(input, "-") == 0) {
        ISO_TRY(copy_stdin(job, error));
        job->path = job->copy;
    }
    job->from_points = !job->settings->input.has_raw && is_ply(job->path);
    if (job->from_points) {
        if (job->method == ISORENDER_EXACT) job->method = ISORENDER_POINTS; /* unless it is asked for */
        ISO_TRY(check_picture(job, error));
        return check_points_only(job->settings, error);
    }
    iso_volume_opts opts = volume_opts(job);
    ISO_TRY(iso_volume_read_info(job->path, &opts, &job->volume.info, error));
    /* A volume that is too large is what the user should hear of first: iso_volume_read says it. */
    if (job->volume.info.read_bytes <= memory_limit(job->settings)) ISO_TRY(check_picture(job, error));
    return find_crop(job, error);
}

static void print_notes(const isorender_job *job) {
    const iso_volume_info *info = &job->volume.info;
    for (int i = 0; i < info->note_count; i++) isorender_say(job, "note: %s", info->notes[i]);
    if (job->nonfinite)
        isorender_say(job, "note: %zu voxels are NaN or infinite: %s", job->nonfinite,
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
    if (job->copy) unlink(job->copy);
    free(job->copy);
    job->copy = NULL;
}
