/* Sources of sessions: computes checksums, converts meshes and volumes into fields, and repeats the
 * conversion from a journal's header. */
#include "source/source.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/file_types.h"
#include "base/memory.h"
#include "clouds/cloud.h"
#include "grids/level_set.h"
#include "grids/point_solid.h"
#include "grids/volume/format.h"
#include "grids/volume/grey_picture.h"
#include "grids/volume/volume.h"
#include "io/file_contents.h"
#include "io/glyphs/glyphs_read.h"
#include "io/lines/lines_read.h"
#include "io/mesh/mesh_read.h"
#include "sculpt/edit/field_from_grid.h"
#include "source/colors.h"
#include "source/label.h"

/* The longest side of a mesh or of lines in voxels, unless the voxel size is given. */
enum { LONGEST_VOXELS = 256 };

static const iso_input default_input;

/* Passes a note to the caller. Arguments may contain any bytes (base/text.h). */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
tell(const iso_source *source, const char *format, ...) {
    char text[1024];
    if (!source->note) return;
    const int begun = snprintf(text, sizeof text, "%s: note: ", source->path);
    if (begun < 0 || begun >= (int)sizeof text) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + begun, sizeof text - (size_t)begun, format, arguments);
    va_end(arguments);
    source->note(text);
}

/* ---- checksums */

/* CRC-32C of a file's bytes; 0 for a folder (of DICOM slices). */
static iso_status compute_checksum(const char *path, const iso_progress *progress, uint32_t *crc,
                                   iso_error *error) {
    struct stat about;
    *crc = 0;
    if (stat(path, &about) == 0 && S_ISDIR(about.st_mode)) return ISO_OK;
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    static const size_t SIZE = 1 << 20;
    unsigned char *bytes = iso_alloc(SIZE);
    iso_status status = ISO_OK;
    double done = 0;
    for (size_t got = 1; bytes && got && status == ISO_OK; *crc = iso_crc32c(*crc, bytes, got)) {
        status = iso_progress_tell(progress, path, done / (double)size, error);
        got = fread(bytes, 1, SIZE, file);
        done += (double)got;
    }
    const bool failed = ferror(file);
    fclose(file);
    iso_free(bytes);
    if (status != ISO_OK) return status;
    if (!bytes) return iso_fail_memory(error, path);
    return failed ? iso_fail(error, ISO_ERR_IO, "%s: cannot read", path) : ISO_OK;
}

/* ---- meshes */

/* Returns the grid for sampling the contents of a box. */
static iso_sampling sampling_of(const iso_source *source, const iso_box *box, const iso_progress *progress) {
    const double longest = fmax(box->hi.x - box->lo.x, fmax(box->hi.y - box->lo.y, box->hi.z - box->lo.z));
    return (iso_sampling){source->voxel > 0 ? source->voxel : longest / LONGEST_VOXELS, ISO_FIELD_MARGIN,
                          source->pool, progress};
}

/* Reads and closes the mesh. *colored: the mesh as it was read, if its colours are wanted and it has some,
 * else empty; NULL: they are not wanted. */
static iso_status read_mesh(const iso_source *source, const iso_progress *progress, iso_closed_mesh **closed,
                            iso_triangles *colored, iso_error *error) {
    const iso_progress reading = iso_progress_part(progress, 0, 0.6),
                       closing = iso_progress_part(progress, 0.6, 1);
    const iso_closing_opts opts = {.hole = source->close_holes, .progress = &closing};
    iso_triangles mesh;
    if (colored) *colored = (iso_triangles){.colors = NULL};
    ISO_TRY(iso_mesh_read(source->path, &reading, &mesh, error));
    iso_status status = iso_closed_mesh_create(source->path, &mesh, &opts, closed, error);
    if (status == ISO_OK && source->report) *source->report = *iso_closed_mesh_report(*closed);
    if (status == ISO_OK && colored && mesh.colors)
        *colored = mesh;
    else
        iso_triangles_free(&mesh);
    return status;
}

static iso_status convert_mesh(const iso_source *source, iso_hgrid **grid, iso_triangles *colored,
                               iso_error *error) {
    const iso_progress reading = iso_progress_part(source->progress, 0.05, 0.3),
                       converting = iso_progress_part(source->progress, 0.3, 1);
    iso_closed_mesh *mesh;
    ISO_TRY(read_mesh(source, &reading, &mesh, source->paint ? colored : NULL, error));
    const iso_box box = iso_closed_mesh_box(mesh);
    const iso_sampling frame = sampling_of(source, &box, &converting);
    iso_status status = iso_level_set_from_mesh(source->path, mesh, &frame, grid, error);
    iso_closed_mesh_destroy(mesh);
    return status;
}

/* Makes a stamp of the heights that a grey picture has, of 8 or 16 bits. */
static iso_status read_picture(const iso_source *source, iso_stamp **stamp, iso_error *error) {
    int width, height;
    uint16_t *values;
    ISO_TRY(iso_grey_picture_read(source->path, &width, &height, &values, error));
    const iso_status status = iso_stamp_from_picture(source->path, width, height, values, stamp, error);
    iso_free(values);
    return status;
}

iso_status iso_source_read_stamp(const iso_source *source, iso_stamp **stamp, iso_error *error) {
    if (iso_file_type_of_name(source->path, ~0u) == ISO_FILE_png) return read_picture(source, stamp, error);
    const iso_progress reading = iso_progress_part(source->progress, 0, 0.4),
                       converting = iso_progress_part(source->progress, 0.4, 1);
    iso_closed_mesh *mesh;
    ISO_TRY(read_mesh(source, &reading, &mesh, NULL, error));
    iso_status status = iso_stamp_from_mesh(source->path, mesh, source->pool, &converting, stamp, error);
    iso_closed_mesh_destroy(mesh);
    return status;
}

/* ---- parts of the solid */

static bool drops_parts(const iso_source *source) {
    const iso_source_volume *volume = source->volume;
    if (volume) return volume->largest > 0 || volume->min_size > 0;
    return source->input && iso_input_drops_parts(source->input);
}

/* Drops the parts that are not kept according to the source; *dropped: whether there were any. */
static iso_status drop_parts(const iso_source *source, double isovalue, iso_grid *grid, bool *dropped,
                             iso_error *error) {
    *dropped = false;
    if (!drops_parts(source)) return ISO_OK;
    const int largest = source->volume ? source->volume->largest : source->input->largest;
    const iso_components_opts opts = {.isovalue = isovalue,
                                      .largest = (size_t)largest,
                                      .min_volume =
                                          source->volume ? source->volume->min_size : source->input->min_size,
                                      .pool = source->pool};
    iso_components_totals totals = {0};
    iso_error reason = {0};
    iso_status status = iso_components_filter(grid, &opts, &totals, &reason);
    if (status != ISO_OK) return iso_fail(error, status, "%s: %s", source->path, reason.text);
    *dropped = totals.dropped > 0;
    if (source->parts) *source->parts = totals;
    return ISO_OK;
}

/* ---- volumes */

/* Checks the isovalue and converts it to stored units, voxels for an hgrid. */
static iso_status convert_isovalue(const iso_source *source, const iso_grid *from, double *stored,
                                   iso_error *error) {
    *stored = 0;
    if (isnan(source->isovalue))
        return iso_grid_is_level_set(from)
                   ? ISO_OK
                   : iso_fail(error, ISO_ERR_USAGE, "%s: holds no level set, and needs --isovalue",
                              source->path);
    const bool voxels = source->voxel_isovalue && from->hgrid;
    const double isovalue = voxels ? iso_grid_physical(from, source->isovalue) : source->isovalue;
    ISO_TRY(iso_isovalue_check(from, isovalue, error));
    *stored = voxels ? source->isovalue : iso_grid_stored(from, isovalue);
    return ISO_OK;
}

/* An iso_progress_fn that calls an iso_progress. */
static int report_progress(void *context, double fraction) {
    return iso_progress_tell(context, "", fraction, NULL) != ISO_OK;
}

static iso_status find_isovalues(iso_source_volume *volume, iso_pool *pool, iso_error *error) {
    const iso_grid *grid = &volume->volume.grid;
    volume->has_isovalues = grid->rgrid && !iso_grid_is_level_set(grid);
    if (!volume->has_isovalues) return ISO_OK;
    ISO_TRY(iso_histogram_compute(grid, pool, &volume->histogram, error));
    volume->candidate_count = iso_isovalue_suggest(grid, &volume->histogram, volume->candidates);
    volume->suggested = volume->candidate_count
                            ? volume->candidates[0]
                            : volume->histogram.low; /* a constant volume has no surface */
    return ISO_OK;
}

static iso_status read_volume(iso_source_volume *volume, const iso_input *input, iso_pool *pool,
                              const iso_progress *progress, iso_error *error) {
    const iso_progress summing = iso_progress_part(progress, 0, 0.2);
    iso_progress reading = iso_progress_part(progress, 0.2, 0.9);
    const iso_volume_opts opts = {
        .pool = pool, .count_values = true, .progress = report_progress, .progress_context = &reading};
    volume->largest = input->largest;
    volume->min_size = input->min_size;
    ISO_TRY(iso_input_write(input, volume->reading, sizeof volume->reading, error));
    ISO_TRY(compute_checksum(volume->path, &summing, &volume->crc, error));
    ISO_TRY(iso_input_read(volume->path, input, &opts, &volume->volume, error));
    return find_isovalues(volume, pool, error);
}

iso_status iso_source_volume_read(const char *path, const iso_input *input, iso_pool *pool,
                                  const iso_progress *progress, iso_source_volume **out, iso_error *error) {
    iso_source_volume *volume = iso_alloc_zero(1, sizeof *volume);
    if (!volume) return iso_fail_memory(error, path);
    iso_status status = ISO_OK;
    if (snprintf(volume->path, sizeof volume->path, "%s", path) >= (int)sizeof volume->path)
        status = iso_fail(error, ISO_ERR_IO, "%.400s: the name is too long", path);
    if (status == ISO_OK) status = read_volume(volume, input ? input : &default_input, pool, progress, error);
    if (status == ISO_OK)
        *out = volume;
    else
        iso_source_volume_free(volume);
    return status;
}

void iso_source_volume_free(iso_source_volume *volume) {
    if (!volume) return;
    iso_volume_free(&volume->volume);
    iso_free(volume);
}

/* Returns the physical isovalue; 0 when none is given, which only level sets allow. */
static double physical_isovalue(const iso_source *source, const iso_grid *grid) {
    if (isnan(source->isovalue)) return 0;
    const bool voxels = source->voxel_isovalue && grid->hgrid;
    return voxels ? iso_grid_physical(grid, source->isovalue) : source->isovalue;
}

/* Converts a grid into a field; parts are dropped from `from` in place. */
static iso_status convert_grid(const iso_source *source, iso_grid *from, iso_hgrid **grid, iso_error *error) {
    const iso_progress progress = iso_progress_part(source->progress, 0.4, 1);
    iso_field_opts how = {
        .resampling = {.voxel = source->voxel, .pool = source->pool, .progress = &progress}};
    if (!isnan(source->isovalue) || iso_grid_is_level_set(from))
        ISO_TRY(drop_parts(source, physical_isovalue(source, from), from, &how.damaged, error));
    how.damaged |= source->input && source->input->label; /* (values that are no distances yet) */
    ISO_TRY(convert_isovalue(source, from, &how.resampling.isovalue, error));
    return iso_field_from_grid(source->path, from, &how, grid, error);
}

/* Converts a grid that is shared with other threads: parts are dropped from a copy. */
static iso_status convert_shared_grid(const iso_source *source, const iso_grid *from, iso_hgrid **grid,
                                      iso_error *error) {
    iso_grid borrowed = *from, copy;
    if (!drops_parts(source)) return convert_grid(source, &borrowed, grid, error);
    ISO_TRY(iso_grid_copy(from, source->pool, &copy, error));
    iso_status status = convert_grid(source, &copy, grid, error);
    iso_grid_destroy(&copy);
    return status;
}

static iso_status convert_volume(const iso_source *source, iso_hgrid **grid, iso_error *error) {
    if (source->volume) return convert_shared_grid(source, &source->volume->volume.grid, grid, error);
    iso_progress reading = iso_progress_part(source->progress, 0.05, 0.4);
    const iso_volume_opts opts = {.files = source->files,
                                  .pool = source->pool,
                                  .progress = report_progress,
                                  .progress_context = &reading};
    iso_volume volume;
    ISO_TRY(
        iso_input_read(source->path, source->input ? source->input : &default_input, &opts, &volume, error));
    for (int i = 0; i < volume.info.note_count; i++) tell(source, "%s", volume.info.notes[i]);
    iso_status status = ISO_OK;
    if (source->input && source->input->label) {
        iso_grid label = {NULL, NULL};
        status = iso_source_label_solid(source, &volume.grid, &label, error);
        iso_grid_destroy(&volume.grid);
        volume.grid = label;
    }
    if (status == ISO_OK) status = convert_grid(source, &volume.grid, grid, error);
    const bool has_own_spacing = source->input && source->input->spacing[0] > 0, /* not that of the colours */
        may_have_colors = source->paint && !has_own_spacing && strcmp(volume.info.format, "vdb") == 0;
    iso_volume_free(&volume);
    if (status != ISO_OK || !may_have_colors) return status;
    status = iso_source_paint_of_vdb(source->path, *grid, source->pool, source->paint, error);
    if (status != ISO_OK) iso_hgrid_destroy(*grid);
    return status;
}

/* Drops parts of a mesh's field, and paints what is left. */
static iso_status finish_mesh(const iso_source *source, const iso_triangles *colored, iso_hgrid *field,
                              iso_error *error) {
    const iso_progress progress = iso_progress_part(source->progress, 0.7, 1);
    bool dropped;
    iso_grid whole = {.hgrid = field};
    ISO_TRY(drop_parts(source, 0, &whole, &dropped, error));
    if (dropped) ISO_TRY(iso_field_redistance(field, source->pool, &progress, error));
    return colored->colors ? iso_source_paint_of_mesh(colored, field, source->pool, source->paint, error)
                           : ISO_OK;
}

static iso_status convert_mesh_parts(const iso_source *source, iso_hgrid **grid, iso_error *error) {
    iso_triangles colored = {.colors = NULL};
    iso_status status = convert_mesh(source, grid, &colored, error);
    if (status == ISO_OK) {
        status = finish_mesh(source, &colored, *grid, error);
        if (status != ISO_OK) iso_hgrid_destroy(*grid);
    }
    iso_triangles_free(&colored);
    return status;
}

/* ---- lines */

/* Samples the tubes around lines. Where tubes overlap, distances inside them are not yet correct. */
static iso_status sample_lines(const iso_source *source, const iso_lines *lines, iso_hgrid **grid,
                               iso_error *error) {
    const iso_progress sampling = iso_progress_part(source->progress, 0.2, 0.6);
    const iso_box box = iso_lines_bounds(lines);
    const iso_sampling frame = sampling_of(source, &box, &sampling);
    size_t widened;
    ISO_TRY(iso_level_set_from_lines(source->path, lines, iso_lines_usual_radius(lines), &frame, grid,
                                     &widened, error));
    if (widened)
        tell(source, "tubes at %zu of %zu vertices are widened to the voxel size, %.4g mm", widened,
             lines->vertex_count, frame.voxel);
    return ISO_OK;
}

static iso_status convert_lines(const iso_source *source, iso_hgrid **grid, iso_error *error) {
    const iso_progress finishing = iso_progress_part(source->progress, 0.6, 1);
    const iso_read_opts opts = {.max_memory = source->input ? source->input->max_memory : 0};
    iso_lines lines = {.line_count = 0};
    bool dropped;
    ISO_TRY(iso_lines_read(source->path, &opts, &lines, error));
    iso_status status = sample_lines(source, &lines, grid, error);
    iso_lines_free(&lines);
    ISO_TRY(status);
    iso_grid whole = {.hgrid = *grid};
    status = drop_parts(source, 0, &whole, &dropped, error);
    if (status == ISO_OK) status = iso_field_redistance(*grid, source->pool, &finishing, error);
    if (status != ISO_OK) iso_hgrid_destroy(*grid);
    return status;
}

/* ---- points */

/* Voxels around the points, so that the solid ends inside the volume. */
enum { POINT_MARGIN = 4 };

static iso_status read_points(const iso_source *source, iso_cloud *cloud, iso_error *error) {
    const iso_read_opts opts = {.max_memory = source->input ? source->input->max_memory : 0,
                                .pool = source->pool};
    const iso_cloud_opts making = {.pool = source->pool};
    iso_glyphs glyphs;
    ISO_TRY(iso_glyphs_read(source->path, &opts, &glyphs, error));
    iso_status status = glyphs.count ? iso_cloud_make(&glyphs, &making, cloud, error)
                                     : iso_fail(error, ISO_ERR_EMPTY, "%s: holds no points", source->path);
    iso_glyphs_free(&glyphs);
    return status;
}

static iso_status sample_points(const iso_source *source, const iso_cloud *cloud, iso_grid *grid,
                                iso_error *error) {
    const iso_progress sampling = iso_progress_part(source->progress, 0.2, 0.6);
    if (cloud->estimated_normals)
        tell(source, "normals of %zu of %zu points are estimated from their neighbours",
             cloud->estimated_normals, cloud->count);
    const iso_point_view view = iso_cloud_view(cloud);
    const iso_affine affine = iso_transform_affine(&cloud->transform);
    const iso_box index = iso_point_view_bounds(&view), box = iso_box_transform(&index, &affine);
    iso_sampling frame = sampling_of(source, &box, &sampling);
    frame.margin = POINT_MARGIN;
    return iso_grid_from_points(source->path, &view, &frame, source->input ? source->input->max_memory : 0,
                                grid, error);
}

/* Converts a cloud: its solid as a volume, then as any other volume. */
static iso_status convert_cloud(const iso_source *source, const iso_cloud *cloud, iso_hgrid **grid,
                                iso_error *error) {
    const iso_progress progress = iso_progress_part(source->progress, 0.6, 1);
    const iso_field_opts how = {.resampling = {.pool = source->pool, .progress = &progress}};
    iso_grid volume;
    bool dropped;
    ISO_TRY(sample_points(source, cloud, &volume, error));
    iso_status status = drop_parts(source, 0, &volume, &dropped, error);
    if (status == ISO_OK) status = iso_field_from_grid(source->path, &volume, &how, grid, error);
    iso_grid_destroy(&volume);
    if (status != ISO_OK || !source->paint || !cloud->colors) return status;
    status = iso_source_paint_of_points(cloud, *grid, source->pool, source->paint, error);
    if (status != ISO_OK) iso_hgrid_destroy(*grid);
    return status;
}

static iso_status convert_points(const iso_source *source, iso_hgrid **grid, iso_error *error) {
    iso_cloud cloud = {.count = 0};
    ISO_TRY(read_points(source, &cloud, error));
    const iso_status status = convert_cloud(source, &cloud, grid, error);
    iso_cloud_free(&cloud);
    return status;
}

/* ---- opening */

unsigned iso_source_kind(const char *path) {
    static const unsigned order[] = {ISO_HOLDS_MESH, ISO_HOLDS_POINTS, ISO_HOLDS_LINES};
    const unsigned holds = iso_file_contents(path);
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        if (holds & order[i]) return order[i];
    return ISO_HOLDS_VOLUME;
}

/* Converts the file at source->path. With --raw it is a volume, whatever its name. */
static iso_status convert_file(const iso_source *source, iso_hgrid **grid, iso_error *error) {
    const iso_input *input = source->input ? source->input : &default_input;
    const unsigned kind = input->has_raw ? ISO_HOLDS_VOLUME : iso_source_kind(source->path);
    if (kind == ISO_HOLDS_VOLUME) return convert_volume(source, grid, error);
    const char *option = iso_input_volume_option(input);
    if (option)
        return iso_fail(error, ISO_ERR_USAGE, "%s: is a %s: %s needs a volume", source->path,
                        kind == ISO_HOLDS_MESH     ? "mesh"
                        : kind == ISO_HOLDS_POINTS ? "file of points"
                                                   : "file of lines",
                        option);
    if (kind == ISO_HOLDS_POINTS) return convert_points(source, grid, error);
    return kind == ISO_HOLDS_MESH ? convert_mesh_parts(source, grid, error)
                                  : convert_lines(source, grid, error);
}

/* Copies the grid's geometry into the journal's header. */
static void describe_grid(const iso_source *source, const iso_hgrid *grid, iso_journal_start *start) {
    const double *origin = grid->transform.origin;
    start->voxel_size = grid->transform.spacing[0];
    start->origin = iso_vec3_make(origin[0], origin[1], origin[2]);
    start->isovalue = isnan(source->isovalue) ? 0 : source->isovalue;
    for (int axis = 0; axis < 3; axis++) start->dims[axis] = grid->dims[axis];
}

static iso_status open_source(const iso_source *source, iso_journal_start *start, iso_hgrid **grid,
                              iso_error *error) {
    memset(start, 0, sizeof *start);
    if (source->paint) *source->paint = (iso_cell_items){.cell = NULL};
    char *path = iso_is_url(source->path) ? strdup(source->path) : realpath(source->path, NULL);
    if (!path) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", source->path, strerror(errno));
    const int length = snprintf(start->source, sizeof start->source, "%s", path);
    free(path);
    if (length >= (int)sizeof start->source)
        return iso_fail(error, ISO_ERR_IO, "%s: the name is too long", source->path);
    iso_file_set_read(source->files, source->path);
    const iso_progress summing = iso_progress_part(source->progress, 0, 0.05);
    if (source->volume) {
        start->source_crc = source->volume->crc;
        memcpy(start->reading, source->volume->reading, sizeof start->reading);
    } else {
        ISO_TRY(iso_input_write(source->input ? source->input : &default_input, start->reading,
                                sizeof start->reading, error));
        ISO_TRY(compute_checksum(source->path, &summing, &start->source_crc, error));
    }
    ISO_TRY(convert_file(source, grid, error));
    describe_grid(source, *grid, start);
    start->has_colors = source->paint && source->paint->used > 0;
    return ISO_OK;
}

iso_status iso_source_open(const iso_source *source, iso_journal_start *start, iso_hgrid **grid,
                           iso_error *error) {
    if (!source->path) {
        if (source->paint) *source->paint = (iso_cell_items){.cell = NULL};
        ISO_TRY(iso_start_with_solid(source->solid, source->voxel, start, error));
        return iso_session_solid(start, grid, error);
    }
    if (!source->input || !source->input->label) return open_source(source, start, grid, error);
    char number[16];
    iso_input input = *source->input;
    iso_source with_number = *source;
    with_number.input = &input;
    ISO_TRY(iso_source_label_find(source->path, &input, number, error));
    return open_source(&with_number, start, grid, error);
}

/* Finds the file: at the path in the journal, or with the same name beside the stroke file. */
static iso_status find_file(const char *path, const char *strokes, char found[ISO_SOURCE_PATH],
                            iso_error *error) {
    const char *slash = strrchr(strokes, '/'), *name = strrchr(path, '/');
    snprintf(found, ISO_SOURCE_PATH, "%s", path);
    if (access(found, R_OK) == 0) return ISO_OK;
    const int missing = errno;
    snprintf(found, ISO_SOURCE_PATH, "%.*s%s", slash ? (int)(slash + 1 - strokes) : 0, strokes,
             name ? name + 1 : path);
    if (access(found, R_OK) == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "'%s' cannot be read (%s) and is not beside it", path,
                    strerror(missing));
}

iso_status iso_source_find(const char *strokes, const iso_journal_start *start, const iso_progress *progress,
                           char found[ISO_SOURCE_PATH], iso_error *error) {
    uint32_t crc;
    ISO_TRY(find_file(start->source, strokes, found, error));
    ISO_TRY(compute_checksum(found, progress, &crc, error));
    if (crc == start->source_crc) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT,
                    "'%s' is not what it was when the session began (checksum %08x, then %08x)", found, crc,
                    start->source_crc);
}

/* Makes the solid of a header. With another voxel size the grid keeps its size in mm, rounded up to whole
 * bricks. */
static iso_status reopen_solid(const iso_source *how, iso_journal_start *start, iso_hgrid **grid,
                               iso_error *error) {
    const double voxel = how->voxel;
    if (how->paint) *how->paint = (iso_cell_items){.cell = NULL};
    for (int axis = 0; voxel > 0 && axis < 3; axis++) {
        const double voxels = ceil(start->dims[axis] * start->voxel_size / voxel / ISO_BRICK) * ISO_BRICK;
        if (voxels > ISO_HGRID_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "voxels of %g mm: %g of them along %c, at most %d", voxel,
                            voxels, "xyz"[axis], ISO_HGRID_MAX);
        start->dims[axis] = (int)voxels;
    }
    if (voxel > 0) start->voxel_size = voxel;
    return iso_session_solid(start, grid, error);
}

static iso_status reopen(const char *strokes, const iso_source *how, iso_journal_start *start,
                         iso_hgrid **grid, iso_error *error) {
    char found[ISO_SOURCE_PATH];
    const iso_progress summing = iso_progress_part(how->progress, 0, 0.05);
    ISO_TRY(iso_source_find(strokes, start, &summing, found, error));
    iso_file_set_read(how->files, found);
    if (how->paint) *how->paint = (iso_cell_items){.cell = NULL};
    char reading[ISO_JOURNAL_TEXT];
    iso_input input;
    iso_error reason = {0};
    memcpy(reading, start->reading, sizeof reading);
    if (iso_input_parse(reading, &input, &reason) != ISO_OK)
        return iso_fail(error, ISO_ERR_FORMAT, "%s", reason.text);
    if (how->input) input.max_memory = how->input->max_memory;
    const iso_source source = {.path = found,
                               .input = &input,
                               .parts = how->parts,
                               .voxel_isovalue = start->voxel_isovalue,
                               .isovalue = start->isovalue,
                               .voxel = how->voxel > 0 ? how->voxel : start->voxel_size,
                               .pool = how->pool,
                               .files = how->files,
                               .progress = how->progress,
                               .paint = start->has_colors ? how->paint : NULL,
                               .close_holes = INFINITY};
    const iso_journal_start recorded = *start;
    ISO_TRY(convert_file(&source, grid, error));
    describe_grid(&source, *grid, start);
    if (how->voxel > 0 || memcmp(recorded.dims, start->dims, sizeof recorded.dims) == 0) return ISO_OK;
    iso_hgrid_destroy(*grid);
    if (how->paint) iso_cell_items_free(how->paint);
    return iso_fail(error, ISO_ERR_FORMAT, "'%s' makes a grid of another size than the session's", found);
}

/* Adds the name of the stroke file to errors. A usage error becomes a format error, because the settings come
 * from the file's header. */
iso_status iso_source_reopen(const char *strokes, const iso_source *how, iso_journal_start *start,
                             iso_hgrid **grid, iso_error *error) {
    if (iso_start_has_solid(start)) return reopen_solid(how, start, grid, error);
    iso_status status = reopen(strokes, how, start, grid, error);
    if (status == ISO_OK || !error || iso_progress_cancelled(how->progress)) return status;
    const iso_error reason = *error;
    return iso_fail(error, status == ISO_ERR_USAGE ? ISO_ERR_FORMAT : status, "%s: %s", strokes, reason.text);
}
