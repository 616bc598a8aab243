/* Opens and reads the inputs of the programs: volume files, procedural scenes, files of points, and any of
 * these files on standard input. */
#include "scene/loader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/memory.h"
#include "base/parse.h"
#include "grids/scenes/scenes.h"
#include "grids/volume/tiled.h"
#include "io/file_contents.h"
#include "io/glyphs/glyphs_read.h"
#include "source/strokes.h"

static const char SCENE_PREFIX[] = "scene:";

static uint64_t memory_limit(const iso_loader *loader) {
    return iso_memory_limit(loader->options->max_memory);
}

/* What chunks and tiles may take. */
static uint64_t chunk_limit(const iso_loader *loader) {
    const uint64_t limit = memory_limit(loader);
    return limit - (loader->set_aside < limit ? loader->set_aside : limit - 1);
}

/* ---- scenes ---- */

enum { SCENE_NAME = 32 };

bool iso_loader_is_scene(const char *input) {
    return strncmp(input, SCENE_PREFIX, strlen(SCENE_PREFIX)) == 0;
}

/* Parses "NAME" or "NAME:SIZE". */
static iso_status parse_scene(const char *text, char name[SCENE_NAME], int *size, iso_error *error) {
    size_t length = strcspn(text, ":");
    *size = 0;
    if (text[length] && (!iso_parse_int(text + length + 1, size) || *size < 16 || *size > ISO_HGRID_MAX))
        return iso_fail(error, ISO_ERR_USAGE, "the size of a scene is 16 to %d voxels a side", ISO_HGRID_MAX);
    snprintf(name, SCENE_NAME, "%.*s", length < SCENE_NAME ? (int)length : SCENE_NAME - 1, text);
    return ISO_OK;
}

/* Estimates the memory of a scene. Dense scenes take every voxel, sparse ones bricks along a surface: the
 * six faces of a cube, times two. */
static uint64_t scene_bytes(const char *name, int size) {
    uint64_t side = size ? (uint64_t)size : 128;
    if (strcmp(name, "ct") == 0) return side * side * side;
    if (strcmp(name, "gyroid") == 0) return 4 * side * side * side;
    return 12 * side * side * (ISO_BRICK_VOXELS * sizeof(float) / (ISO_BRICK * ISO_BRICK));
}

static iso_status check_memory(const iso_loader *loader, uint64_t needs, iso_error *error) {
    const uint64_t limit = memory_limit(loader);
    if (needs <= limit) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "needs about %.0f MB, limit is %.0f MB (--max-memory)",
                    (double)needs / 1e6, (double)limit / 1e6);
}

/* Fills `info` as the header of a file with this grid would. */
static void describe_scene(const iso_grid *grid, const char *name, iso_volume_info *info) {
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
}

/* A scene can be cropped; the other options choose what is read of a file, and how. */
static iso_status check_scene_options(const iso_loader *loader, iso_error *error) {
    iso_input given = *loader->options;
    if (given.level == ISO_LEVEL_AUTO) given.level = 0;
    given.cropped = given.cropped_mm = 0;
    const char *option = iso_input_volume_option(&given);
    if (!option || loader->is_further) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "is computed: %s is for volumes in files", option);
}

static iso_status make_scene(iso_loader *loader, iso_error *error) {
    char name[SCENE_NAME];
    iso_scene_opts opts = {.pool = loader->pool};
    ISO_TRY(check_scene_options(loader, error));
    ISO_TRY(parse_scene(loader->input + strlen(SCENE_PREFIX), name, &opts.size, error));
    ISO_TRY(check_memory(loader, scene_bytes(name, opts.size), error));
    ISO_TRY(iso_scene_create(name, &opts, &loader->volume.grid, &loader->scene_isovalue, error));
    describe_scene(&loader->volume.grid, name, &loader->volume.info);
    return ISO_OK;
}

/* ---- files ---- */

static int report_reading(void *context, double fraction) {
    const iso_loader *loader = context;
    if (loader->progress) loader->progress(loader->progress_context, fraction);
    return 0;
}

static iso_volume_opts volume_opts(iso_loader *loader) {
    iso_volume_opts opts = iso_input_volume_opts(loader->options);
    opts.component = loader->component;
    opts.files = loader->files;
    opts.mappable = &loader->mappable;
    opts.channels = &loader->channels;
    opts.pool = loader->pool;
    opts.count_values = loader->wants_histogram;
    opts.progress = report_reading;
    opts.progress_context = loader;
    return opts;
}

bool iso_loader_reads_points(const char *path, const char *columns) {
    return iso_file_contents(path) & (columns ? ISO_HOLDS_POINTS | ISO_HOLDS_ROWS : ISO_HOLDS_POINTS);
}

void iso_loader_list_files(const char *input, const iso_input *options, iso_file_set *files) {
    iso_volume_info info;
    iso_volume_opts opts = iso_input_volume_opts(options);
    opts.files = files;
    if (iso_loader_is_scene(input) || iso_spool_is_stream(input)) return;
    if (options->has_raw || !iso_loader_reads_points(input, NULL))
        iso_volume_read_info(input, &opts, &info, NULL);
}

/* ---- stroke files ---- */

static iso_source source_of_strokes(const iso_loader *loader) {
    return (iso_source){.input = loader->options, .pool = loader->pool, .files = loader->files};
}

/* Fills `info` from the header of a stroke file. The size of the level set is known when it has been
 * played: until then that of a surface as large as the grid's box is assumed. */
static iso_status describe_strokes(iso_loader *loader, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader = NULL;
    iso_volume_info *info = &loader->volume.info;
    ISO_TRY(iso_journal_open(loader->path, &start, &reader, error));
    iso_journal_reader_free(reader);
    *info = (iso_volume_info){
        .type = ISO_FLOAT32, .components = 1, .scale = 1, .level_set = true, .sparse = true};
    snprintf(info->format, sizeof info->format, "strokes");
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_type_name(ISO_FLOAT32));
    memcpy(info->dims, start.dims, sizeof info->dims);
    info->transform = iso_transform_identity();
    for (int i = 0; i < 3; i++) info->transform.spacing[i] = start.voxel_size;
    iso_vec3_store(start.origin, info->transform.origin);
    info->bytes = info->read_bytes = scene_bytes("strokes", start.dims[0]);
    return check_memory(loader, info->read_bytes, error);
}

static iso_status play_strokes(iso_loader *loader, iso_error *error) {
    const iso_source how = source_of_strokes(loader);
    iso_grid *grid = &loader->volume.grid;
    ISO_TRY(iso_strokes_play(loader->path, &how, &grid->hgrid, &loader->paint, error));
    loader->painted = iso_painted_make(&loader->paint, grid->hgrid, (iso_rgb){0});
    loader->volume.info.bytes = loader->volume.info.read_bytes = iso_hgrid_bytes(grid->hgrid);
    memcpy(loader->volume.info.dims, iso_grid_dims(grid), sizeof loader->volume.info.dims);
    loader->volume.info.transform = *iso_grid_transform(grid);
    return ISO_OK;
}

/* ---- opening and reading ---- */

static iso_status check_files(const iso_loader *loader, iso_error *error) {
    return loader->files ? iso_file_set_check(loader->files, error) : ISO_OK;
}

static iso_status find_crop(iso_loader *loader, iso_error *error) {
    const iso_volume_info *info = &loader->volume.info;
    return iso_input_box(loader->options, info->dims, &info->transform, loader->crop, error);
}

/* Sets `component` to that of options->channel, among `components` of the file. */
static iso_status choose_channel(iso_loader *loader, int components, iso_error *error) {
    iso_error reason = {0};
    const iso_status status = iso_channels_find(&loader->channels, components, loader->options->channel,
                                                &loader->component, &reason);
    if (status == ISO_OK) return ISO_OK;
    return iso_fail(error, status, "%s: %s", iso_spool_name(loader->input), reason.text);
}

/* Reads the header. That of the first component tells which components and channels there are. */
static iso_status read_header(iso_loader *loader, iso_error *error) {
    iso_volume_info *info = &loader->volume.info;
    iso_volume_opts opts = volume_opts(loader);
    ISO_TRY(loader->has_strokes ? describe_strokes(loader, error)
                                : iso_volume_read_info(loader->path, &opts, info, error));
    if (!loader->options->channel) return ISO_OK;
    ISO_TRY(choose_channel(loader, info->components, error));
    if (loader->component == opts.component) return ISO_OK;
    opts.component = loader->component;
    return iso_volume_read_info(loader->path, &opts, info, error);
}

iso_status iso_loader_open(iso_loader *loader, iso_error *error) {
    loader->scene_isovalue = NAN;
    loader->path = loader->input;
    loader->component = loader->options->component;
    if (iso_loader_is_scene(loader->input)) {
        ISO_TRY(make_scene(loader, error));
        if (loader->options->channel) ISO_TRY(choose_channel(loader, 1, error));
        return find_crop(loader, error);
    }
    iso_volume_opts opts = volume_opts(loader);
    const bool fifo_is_refused = loader->is_further && strcmp(loader->input, "-") != 0;
    if (iso_spool_is_stream(loader->input) && !fifo_is_refused) {
        iso_spool_opts spooling = {.volume = &opts, .points = true};
        ISO_TRY(iso_spool_open(loader->input, &spooling, &loader->spool, error));
        loader->path = loader->spool.path;
    }
    iso_file_set_read_as(loader->files, loader->path, iso_spool_name(loader->input));
    loader->has_points = !loader->options->has_raw && iso_loader_reads_points(loader->path, loader->columns);
    if (loader->has_points) {
        loader->has_gaussians = iso_glyphs_are_gaussians(loader->path);
        iso_memory_use_files();
        return check_files(loader, error);
    }
    loader->has_strokes = !loader->options->has_raw && iso_strokes_are_in(loader->path);
    ISO_TRY(read_header(loader, error));
    ISO_TRY(check_files(loader, error));
    return find_crop(loader, error);
}

/* The most memory that points may take while they are read. Those that may lie in temporary files are limited
 * by the size of their own file, so that a damaged one does not fill the disk: the shortest point, six
 * characters of text, takes 12 bytes, in a buffer that grows by copying; 64 leaves room for columns. */
static uint64_t points_limit(const iso_loader *loader) {
    const uint64_t limit = memory_limit(loader);
    struct stat info;
    if (!iso_memory_uses_files() || stat(loader->path, &info) != 0) return limit;
    const uint64_t most = 64 * (uint64_t)info.st_size;
    return most > limit ? most : limit;
}

static iso_read_opts read_opts(iso_loader *loader) {
    const uint64_t limit = points_limit(loader);
    return (iso_read_opts){.max_memory = limit == UINT64_MAX ? 0 : limit,
                           .space = loader->space,
                           .every = loader->every,
                           .columns = loader->columns,
                           .normals_from_faces = true,
                           .pool = loader->pool,
                           .files = loader->files,
                           .report = &loader->report};
}

bool iso_loader_map_points(iso_loader *loader, iso_mapped_points *points) {
    const iso_read_opts opts = read_opts(loader);
    return iso_mapped_points_open(loader->path, &opts, loader->pool, points);
}

static iso_status read_points(iso_loader *loader, iso_error *error) {
    const iso_read_opts opts = read_opts(loader);
    return iso_glyphs_read(loader->path, &opts, &loader->points, error);
}

/* ---- the shelf */

void iso_loader_shelf_free(iso_loader_shelf *shelf) {
    iso_volume_free(&shelf->volume);
    free(shelf->path);
    *shelf = (iso_loader_shelf){.path = NULL};
}

/* Takes the volume from the shelf if it is the loader's, and else empties the shelf. */
static bool take_from_shelf(iso_loader *loader) {
    iso_loader_shelf *shelf = loader->shelf;
    if (!shelf) return false;
    const bool same = shelf->path && strcmp(shelf->path, loader->path) == 0 &&
                      memcmp(&shelf->options, loader->options, sizeof shelf->options) == 0 &&
                      shelf->component == loader->component &&
                      memcmp(shelf->crop, loader->crop, sizeof shelf->crop) == 0;
    if (same) {
        iso_volume_free(&loader->volume);
        loader->volume = shelf->volume;
        loader->nonfinite = shelf->nonfinite;
        shelf->volume = (iso_volume){.grid = {NULL, NULL}};
    }
    iso_loader_shelf_free(shelf);
    return same;
}

/* Notes that the volume, which has been read, goes to the shelf in the end. */
static void note_shelf(iso_loader *loader) {
    const iso_rgrid *grid = loader->volume.grid.rgrid;
    loader->shelved = loader->shelf && grid && isnan(loader->scene_isovalue) && !loader->has_strokes &&
                      !loader->mapped && !iso_loader_has_tiles(loader);
    if (loader->shelved) loader->edit = iso_change_log_now(grid->log);
}

static void put_on_shelf(iso_loader *loader) {
    iso_loader_shelf *shelf = loader->shelf;
    const iso_rgrid *grid = loader->volume.grid.rgrid;
    if (!loader->shelved || !grid || iso_change_log_now(grid->log) != loader->edit) return;
    iso_loader_shelf_free(shelf);
    *shelf = (iso_loader_shelf){.path = strdup(loader->path),
                                .options = *loader->options,
                                .component = loader->component,
                                .nonfinite = loader->nonfinite};
    if (!shelf->path) return;
    memcpy(shelf->crop, loader->crop, sizeof shelf->crop);
    shelf->volume = loader->volume;
    loader->volume = (iso_volume){.grid = {NULL, NULL}};
}

static void free_paint(iso_loader *loader) {
    iso_cell_items_free(&loader->paint);
    loader->painted = (iso_painted){.log = NULL};
}

/* Not with another spacing, which is not that of the colours. */
static iso_status read_colors(iso_loader *loader, const iso_volume_opts *opts, iso_error *error) {
    if (strcmp(loader->volume.info.format, "vdb") != 0 || opts->spacing[0] > 0) return ISO_OK;
    return iso_painted_read(loader->path, opts, &loader->paint, &loader->painted, error);
}

static iso_status read_volume(iso_loader *loader, iso_error *error) {
    free_paint(loader);
    if (loader->has_strokes) {
        ISO_TRY(play_strokes(loader, error));
    } else if (isnan(loader->scene_isovalue)) {
        iso_volume_opts opts = volume_opts(loader);
        opts.mapped = loader->mapped;
        if (loader->mapped) opts.max_memory = chunk_limit(loader);
        opts.chunk_side = loader->chunk_side ? loader->chunk_side : iso_loader_chunk_side(loader, 0);
        ISO_TRY(iso_volume_read(loader->path, &opts, &loader->volume, error));
        if (iso_grid_is_level_set(&loader->volume.grid)) ISO_TRY(read_colors(loader, &opts, error));
        report_reading(loader, 1);
    }
    ISO_TRY(iso_input_crop(loader->options, loader->crop, &loader->volume.grid, error));
    return loader->mapped ? ISO_OK : iso_loader_count_nonfinite(loader, error);
}

iso_status iso_loader_read(iso_loader *loader, iso_error *error) {
    if (loader->has_points) return read_points(loader, error);
    if (!take_from_shelf(loader)) ISO_TRY(read_volume(loader, error));
    note_shelf(loader);
    return ISO_OK;
}

bool iso_loader_has_tiles(const iso_loader *loader) {
    const iso_rgrid *grid = loader->volume.grid.rgrid;
    return grid && iso_tiled_is(grid);
}

int iso_loader_chunk_side(const iso_loader *loader, uint64_t cell_bytes) {
    const uint64_t limit = chunk_limit(loader), voxel = iso_type_size(loader->volume.info.type);
    uint64_t side = 128;
    if (!cell_bytes) cell_bytes = 4 * voxel;
    while (side > 32 && side * side * side * cell_bytes > limit / 2) side /= 2;
    return (int)side;
}

iso_status iso_loader_count_nonfinite(iso_loader *loader, iso_error *error) {
    const iso_grid *grid = &loader->volume.grid;
    if (!iso_loader_has_tiles(loader)) {
        loader->nonfinite = iso_grid_count_nonfinite(grid, loader->pool);
        return ISO_OK;
    }
    const iso_chunk_source source = iso_volume_source(grid->rgrid);
    return iso_chunk_source_count_nonfinite(&source, iso_loader_chunk_side(loader, 0), loader->pool,
                                            &loader->nonfinite, error);
}

void iso_loader_set_histogram(iso_loader *loader, const iso_histogram *histogram) {
    loader->histogram = *histogram;
    loader->candidate_count = iso_isovalue_suggest(&loader->volume.grid, histogram, loader->candidates);
    loader->has_histogram = true;
}

iso_status iso_loader_histogram_together(iso_loader *loader, const iso_ranks *ranks, iso_error *error) {
    const iso_grid *grid = &loader->volume.grid;
    iso_histogram histogram;
    if (!iso_loader_has_tiles(loader)) {
        ISO_TRY(iso_histogram_compute_together(grid, ranks, loader->pool, &histogram, error));
    } else {
        const iso_chunk_source source = iso_volume_source(grid->rgrid);
        ISO_TRY(iso_histogram_of_source(&source, iso_loader_chunk_side(loader, 0), ranks, loader->pool,
                                        &histogram, error));
    }
    iso_loader_set_histogram(loader, &histogram);
    return ISO_OK;
}

iso_status iso_loader_histogram(iso_loader *loader, iso_error *error) {
    const iso_ranks alone = {.size = 1};
    return loader->has_histogram ? ISO_OK : iso_loader_histogram_together(loader, &alone, error);
}

iso_status iso_loader_isovalue(iso_loader *loader, double given, double *isovalue, bool *chosen,
                               iso_error *error) {
    *chosen = false;
    *isovalue = isnan(given) ? loader->scene_isovalue : given;
    if (!isnan(given)) return iso_isovalue_check(&loader->volume.grid, given, error);
    if (!isnan(*isovalue)) return ISO_OK;
    ISO_TRY(iso_loader_histogram(loader, error));
    if (!loader->candidate_count)
        return iso_fail(error, ISO_ERR_EMPTY, "the volume is constant: every voxel is %g",
                        loader->histogram.minimum);
    *isovalue = loader->candidates[0];
    *chosen = true;
    return ISO_OK;
}

iso_status iso_loader_moments(iso_loader *loader, const iso_ranks *ranks, iso_error *error) {
    const iso_ranks alone = {.size = 1};
    const iso_grid *grid = &loader->volume.grid;
    const bool tiles = iso_loader_has_tiles(loader);
    const iso_chunk_source source = tiles ? iso_volume_source(grid->rgrid) : (iso_chunk_source){0};
    if (loader->has_moments) return ISO_OK;
    ISO_TRY(iso_moments_compute(grid, tiles ? &source : NULL, tiles ? iso_loader_chunk_side(loader, 0) : 0,
                                ranks ? ranks : &alone, loader->pool, &loader->moments, error));
    loader->has_moments = true;
    return ISO_OK;
}

void iso_loader_close(iso_loader *loader) {
    put_on_shelf(loader);
    iso_glyphs_free(&loader->points);
    free_paint(loader);
    iso_volume_free(&loader->volume);
    iso_spool_close(&loader->spool);
}
