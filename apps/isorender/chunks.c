/* Volumes that are drawn chunk by chunk (exact/chunks.h): those larger than memory, and the parts of a
 * picture that several processes draw (--part). The picture is that of the whole volume, byte for byte. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/isorender/annotations.h"
#include "apps/isorender/chunks.h"
#include "apps/isorender/cuts.h"
#include "apps/isorender/mpi_ranks.h"
#include "apps/isorender/picture_record.h"
#include "base/file_identity.h"
#include "base/memory.h"
#include "io/chunk_export.h"
#include "io/key_file.h"
#include "scene/bounds.h"
#include "scene/cap_chunks.h"
#include "scene/keys_picture.h"

/* ---- when */

static bool is_exact(const isorender_job *job) {
    return job->method == ISO_METHOD_EXACT;
}

static bool exports(const isorender_job *job) {
    return job->plan->points || job->plan->mesh;
}

/* Whether the surface is not drawn, but slices of its volume. */
static bool shows_slices_alone(const isorender_settings *settings) {
    return settings->slice_count && settings->opacity_count == 1 && settings->opacities[0] == 0;
}

enum { OBSTACLE_TEXT = ISO_METHODS_TEXT + 80 };

/* Finds the first option that chunks do not allow, and refuses it. */
static iso_status check_obstacles(const isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    char keyed[OBSTACLE_TEXT], who[ISO_METHODS_TEXT], method[64];
    snprintf(method, sizeof method, "--method %s", job->renderer->name);
    snprintf(keyed, sizeof keyed, "only %s decides pixels by an order that is known beforehand",
             iso_methods_that_can(ISO_CAN_CHUNKS, who));
    const struct {
        bool given;
        const char *option, *reason;
    } obstacles[] = {
        {settings->instances != NULL, "--instances", "an instance shows the whole surface"},
        {!(job->renderer->can & ISO_CAN_CHUNKS), method, keyed},
        {settings->primitive != ISO_PRIMITIVE_AUTO && settings->primitive != ISO_PRIMITIVE_EDGE,
         "--primitive", "only edge points are made chunk by chunk"},
        {isorender_is_translucent(settings) && !shows_slices_alone(settings), "--opacity",
         "the layers of a pixel are blended in order"},
        {settings->filter != ISO_FILTER_LINEAR, "--reconstruction-filter", "it samples the whole surface"},
        {settings->ior > 0, "--ior", "rays pass through the whole solid"},
        {settings->isovalue_count > 1, "--isovalue", "one surface is drawn at a time"},
        {settings->volume_options.count > 0, "--volume", "one surface is drawn at a time"},
        {job->segmentation != NULL, "labels", "one surface is drawn at a time"},
        {settings->channel_count > 1, "several channels (--channel)", "one surface is drawn at a time"},
        {settings->object_options.count > 0, "--lines, --glyphs or --surface",
         "one surface is drawn at a time"},
        {settings->aov != NULL, "--aov", "a pixel's key is its colour"},
        {isorender_light_option(settings) != NULL, isorender_light_option(settings),
         "it needs depths and normals of the whole picture"},
        {exports(job) && (settings->parts || settings->ranks.mpi), "--points or --mesh",
         "they are written by one process"},
        {job->plan->mesh && !iso_mesh_file_takes(job->plan->mesh), "--mesh",
         "a mesh of chunks is written as .ply"},
        {settings->closed != 0, "--closed", "it needs a copy of the volume"},
        {iso_input_drops_parts(&settings->common.input), "--largest and --min-size",
         "connected parts extend over all chunks"},
        {job->loader.volume.info.sparse, "a sparse volume", "only dense ones have chunks"},
    };
    for (size_t i = 0; i < sizeof obstacles / sizeof *obstacles; i++)
        if (obstacles[i].given)
            return iso_fail(error, ISO_ERR_USAGE,
                            "%s cannot be drawn in chunks (--part, --chunk-size, mpirun): %s",
                            obstacles[i].option, obstacles[i].reason);
    return ISO_OK;
}

static bool is_asked_for(const isorender_settings *settings) {
    return settings->parts || settings->chunk_size || settings->ranks.mpi;
}

/* The most by which deflate and its like compress. */
enum { MOST_COMPRESSED = 1100 };

/* Whether the volume's voxels can stay in its files. A header that claims more voxels than its files can hold
 * is left to the limit of memory. */
static bool can_stay(const isorender_job *job) {
    const iso_volume_info *info = &job->loader.volume.info;
    return job->has_volume && isnan(job->loader.scene_isovalue) && job->loader.mappable &&
           (iso_volume_may_be_sparse(info) ||
            info->bytes / MOST_COMPRESSED <= iso_file_set_read_bytes(job->plan->files));
}

/* Whether nearly all of a large volume is not stored (absent chunks of HDF5 and Zarr), judged by the size of
 * its files: in chunks its surface takes time for what is. */
static bool is_mostly_absent(const isorender_job *job) {
    static const uint64_t LARGE = 1 << 30, PART = 256;
    const uint64_t bytes = job->loader.volume.info.bytes;
    return can_stay(job) && iso_volume_may_be_sparse(&job->loader.volume.info) && bytes >= LARGE &&
           iso_file_set_read_bytes(job->plan->files) < bytes / PART;
}

/* Whether the volume is too large to be read, or its surface to be made beside it. */
static bool is_too_large(const isorender_job *job) {
    const uint64_t limit = iso_memory_limit(job->settings->common.input.max_memory);
    return can_stay(job) && (job->did_not_fit || job->loader.volume.info.read_bytes > limit);
}

/* The side of the chunks, voxels. When files are written, a cell takes the memory of its vertices and
 * triangles. */
static int choose_side(const isorender_job *job) {
    return job->settings->chunk_size ? job->settings->chunk_size
                                     : iso_loader_chunk_side(&job->loader, exports(job) ? 64 : 0);
}

iso_status isorender_chunks_choose(isorender_job *job, iso_error *error) {
    const isorender_settings *settings = job->settings;
    if (!is_asked_for(settings) && !is_too_large(job) && !is_mostly_absent(job)) return ISO_OK;
    if (!job->has_volume)
        return iso_fail(error, ISO_ERR_USAGE, "--part, --chunk-size and mpirun are for volumes");
    const iso_status fit = check_obstacles(job, error);
    if (fit != ISO_OK && is_asked_for(settings)) return fit;
    if (fit != ISO_OK || (!isorender_plan_draws(job->plan) && !exports(job)))
        return ISO_OK; /* the volume is refused when it is read, or its surface when it is made */
    job->chunks = calloc(1, sizeof *job->chunks);
    if (!job->chunks) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    job->chunks->cpu = isorender_backend_cpu();
    job->chunks->fits = !is_asked_for(settings) && (job->did_not_fit || !is_too_large(job));
    job->backend = &job->chunks->cpu;
    job->loader.mapped = true;
    job->loader.set_aside = isorender_plan_draws(job->plan) ? isorender_picture_bytes(job, job->samples) : 0;
    job->loader.chunk_side = choose_side(job);
    return ISO_OK;
}

/* The planes of key images (render/view/key_image.h). */
static int plane_count(const isorender_job *job) {
    return isorender_has_caps(job->settings) ? ISO_KEY_PLANES : 1;
}

uint64_t isorender_chunks_bytes(const isorender_job *job) {
    return job->chunks ? (uint64_t)job->settings->width * (uint64_t)job->settings->height *
                             (uint64_t)job->samples * (uint64_t)plane_count(job) * sizeof(uint64_t)
                       : 0;
}

/* ---- the surface */

static int report_progress(void *context, double fraction) {
    isorender_job *job = context;
    isorender_progress(job, job->chunks->stage, fraction);
    return 0;
}

/* ---- the index */

/* The index describes the voxels that are used of the volume's own files, whatever else the run reads. */
static void identify(const isorender_job *job, iso_volume_identity *identity) {
    const iso_loader *loader = &job->loader;
    const iso_rgrid *grid = loader->volume.grid.rgrid;
    const iso_chunk_source source = iso_volume_source(grid);
    iso_file_set files = {0};
    int before[3];
    iso_chunk_source_blocks(&source, before);
    iso_file_set_read(&files, loader->path);
    iso_loader_list_files(loader->path, loader->options, &files);
    identity->files = iso_file_set_identity(&files);
    iso_file_set_free(&files);
    /* Arrays of one file differ by their names (Fowler, Noll and Vo's hash). */
    for (const char *name = loader->volume.info.name; *name; name++)
        identity->files = (identity->files ^ (unsigned char)*name) * 1099511628211u;
    for (int axis = 0; axis < 3; axis++) {
        identity->dims[axis] = grid->dims[axis];
        identity->first[axis] = loader->crop[2 * axis];
        identity->before[axis] = before[axis];
    }
    identity->type = (int32_t)grid->type;
    identity->component = loader->component;
    identity->scale = grid->scale;
    identity->offset = grid->offset;
    identity->transform = grid->transform;
}

/* Pictures of scenes and standard input, and those that are drawn in chunks although they fit, leave no
 * file. */
static bool keeps_index(const isorender_job *job) {
    const isorender_settings *settings = job->settings;
    return !settings->no_index && isnan(job->loader.scene_isovalue) && !job->loader.spool.path &&
           (settings->parts || is_too_large(job));
}

/* The index lies beside the file: FILE.isoindex, or FILE.path.to.array.isoindex. NULL: out of memory. */
static char *name_index(const char *path) {
    const char *array = iso_volume_array_of(path);
    char *name = NULL;
    if (asprintf(&name, "%s.isoindex", path) < 0) return NULL;
    if (!array) return name;
    const size_t first = (size_t)(array - path), end = strlen(path);
    for (size_t i = first; i < end; i++)
        if (name[i] == '/') name[i] = '.';
    memmove(name + first - 1, name + first, strlen(name + first) + 1); /* the colon */
    return name;
}

static iso_status read_index(isorender_job *job, iso_error *error) {
    isorender_chunks *chunks = job->chunks;
    iso_volume_identity identity = {0};
    identify(job, &identity);
    ISO_TRY(iso_volume_index_create(&identity, &chunks->index, error));
    if (!keeps_index(job)) return ISO_OK;
    chunks->index_path = name_index(job->loader.path);
    if (!chunks->index_path) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    if (!iso_volume_index_read(chunks->index_path, &chunks->index)) return ISO_OK;
    isorender_log_verbose(job, "%s: %zu of %zu blocks known", chunks->index_path,
                          chunks->index.ranges.count - chunks->index.ranges.unknown,
                          chunks->index.ranges.count);
    if (chunks->index.has_histogram) iso_loader_set_histogram(&job->loader, &chunks->index.histogram);
    return ISO_OK;
}

/* With several ranks: reads a part of the voxels for the histogram, from which the isovalue is chosen, and
 * gets the others' counts. A rank may know the histogram from its index. */
static iso_status count_together(isorender_job *job, iso_error *error) {
    const iso_ranks *ranks = &job->settings->ranks;
    iso_loader *loader = &job->loader;
    int32_t missing = !loader->has_histogram;
    if (!ranks->mpi) return ISO_OK;
    if (job->settings->isovalue_count)
        return job->settings->isovalue_sigmas[0] ? iso_loader_moments(loader, ranks, error) : ISO_OK;
    ISO_TRY(iso_ranks_most(ranks, &missing, 1, error));
    if (!missing) return ISO_OK;
    return iso_loader_histogram_together(loader, ranks, error);
}

iso_status isorender_chunks_begin(isorender_job *job, iso_error *error) {
    ISO_TRY(iso_ranks_agree(&job->settings->ranks, read_index(job, error), error));
    return count_together(job, error);
}

/* Writes what is new. A folder that cannot be written to is no failure: the next picture takes as long as
 * this one. */
static void write_index(const isorender_job *job) {
    isorender_chunks *chunks = job->chunks;
    iso_volume_index *index = &chunks->index;
    iso_error error = {0};
    if (job->loader.has_histogram && !index->has_histogram) {
        index->histogram = job->loader.histogram;
        index->has_histogram = index->changed = 1;
    }
    if (!chunks->index_path || !index->changed || job->settings->ranks.rank) return;
    if (iso_volume_index_write(chunks->index_path, index, &error) != ISO_OK)
        isorender_log_verbose(job, "no index: %s", error.text);
}

/* ---- cells */

static iso_status create_walk(isorender_job *job, const isorender_surface *surface, iso_error *error) {
    isorender_chunks *chunks = job->chunks;
    chunks->source = iso_volume_source(surface->scene.grid.rgrid);
    const iso_chunk_walk_opts opts = {.source = &chunks->source,
                                      .isovalue = surface->scene.isovalue,
                                      .side = choose_side(job),
                                      .ranges = &chunks->index.ranges,
                                      .pool = job->pool,
                                      .progress = report_progress,
                                      .progress_context = job};
    return iso_chunk_walk_create(&opts, &chunks->walk, error);
}

static void put_box(const iso_box *box, double numbers[6]) {
    const double all[] = {box->lo.x, box->lo.y, box->lo.z, box->hi.x, box->hi.y, box->hi.z};
    memcpy(numbers, all, sizeof all);
}

static iso_box get_box(const double numbers[6]) {
    return (iso_box){{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
}

/* The share of this process: of --part when it draws, of mpirun always. */
static iso_chunk_share share_of(const isorender_settings *settings, bool draws) {
    if (settings->ranks.mpi) return (iso_chunk_share){settings->ranks.rank + 1, settings->ranks.size};
    if (settings->parts && draws) return (iso_chunk_share){settings->part, settings->parts};
    return (iso_chunk_share){1, 1};
}

/* Finds the boxes of the whole surface. */
static iso_status find_boxes(const isorender_job *job, iso_chunk_bounds *bounds, iso_error *error) {
    const iso_ranks *ranks = &job->settings->ranks;
    bounds->share = share_of(job->settings, false);
    const iso_status status = is_exact(job) ? iso_exact_chunks_bounds(job->chunks->walk, bounds, error)
                                            : iso_point_chunks_bounds(job->chunks->walk, bounds, error);
    ISO_TRY(iso_ranks_agree(ranks, status, error));
    return isorender_ranks_bounds(ranks, bounds, error);
}

/* With several ranks: reads a part of the blocks' ranges, and gets the others. */
static iso_status exchange_ranges(isorender_job *job, iso_error *error) {
    const iso_ranks *ranks = &job->settings->ranks;
    if (!ranks->mpi) return ISO_OK;
    const iso_chunk_share turns = {ranks->rank + 1, ranks->size};
    const iso_status status = iso_chunk_walk_read_ranges(job->chunks->walk, turns, error);
    ISO_TRY(iso_ranks_agree(ranks, status, error));
    return isorender_ranks_ranges(ranks, &job->chunks->index.ranges, error);
}

/* Whether a surface is in the index of every rank. */
static iso_status is_indexed(const isorender_job *job, double isovalue, bool *indexed, iso_error *error) {
    const iso_volume_index *index = &job->chunks->index;
    int32_t missing =
        !iso_volume_index_find(index, isovalue, (uint64_t)is_exact(job)) || index->ranges.unknown;
    ISO_TRY(iso_ranks_most(&job->settings->ranks, &missing, 1, error));
    *indexed = !missing;
    return ISO_OK;
}

/* Extracts all chunks, for the number of primitives and the bounds, and enters these into the index. */
static iso_status measure_surface(isorender_job *job, double isovalue, iso_error *error) {
    const iso_transform *transform = iso_grid_transform(&job->surfaces[0].scene.grid);
    const iso_affine affine = iso_transform_affine(transform);
    const iso_affine *const affines[] = {NULL, &affine};
    const bool oblique = iso_bounds_is_oblique(transform);
    iso_box boxes[2];
    iso_chunk_bounds bounds = {{1, 1}, affines, oblique ? 2 : 1, boxes, 0};
    ISO_TRY(exchange_ranges(job, error));
    ISO_TRY(find_boxes(job, &bounds, error));
    if (!oblique) boxes[1] = iso_box_transform(&boxes[0], &affine);
    iso_indexed_surface found = {
        .isovalue = isovalue, .kind = (uint64_t)is_exact(job), .primitives = bounds.primitives};
    put_box(&boxes[0], found.index);
    put_box(&boxes[1], found.world);
    iso_volume_index_add(&job->chunks->index, &found);
    const iso_chunk_totals totals = iso_chunk_walk_stats(job->chunks->walk);
    isorender_log_verbose(job, "isovalue %g: %llu %s in %zu of %zu chunks", isovalue,
                          (unsigned long long)found.primitives, is_exact(job) ? "cells" : "points",
                          totals.crossed, totals.chunks);
    return ISO_OK;
}

/* Voxels of mapped volumes were not counted when they were read. */
static iso_status count_nonfinite(isorender_job *job, iso_error *error) {
    if (!iso_chunk_walk_stats(job->chunks->walk).nonfinite_blocks) return ISO_OK;
    if (!job->loader.nonfinite) {
        ISO_TRY(iso_loader_count_nonfinite(&job->loader, error));
        isorender_log_nonfinite(job);
    }
    if (is_exact(job)) return ISO_OK;
    return iso_fail(
        error, ISO_ERR_USAGE,
        "points of a volume with voxels that are NaN or infinite are not drawn in chunks: exact is");
}

iso_status isorender_chunks_extract(isorender_job *job, iso_box *index, iso_error *error) {
    isorender_surface *surface = &job->surfaces[0];
    surface->scene.grid = surface->loader->volume.grid;
    job->chunks->stage = "extracting";
    ISO_TRY(create_walk(job, surface, error));
    const iso_volume_index *known = &job->chunks->index;
    const uint64_t kind = is_exact(job);
    bool indexed;
    ISO_TRY(is_indexed(job, surface->scene.isovalue, &indexed, error));
    if (!indexed) ISO_TRY(measure_surface(job, surface->scene.isovalue, error));
    const iso_indexed_surface *found = iso_volume_index_find(known, surface->scene.isovalue, kind);
    *(is_exact(job) ? &job->cell_count : &job->point_count) = found->primitives;
    *index = get_box(found->index);
    surface->bounds = get_box(found->world);
    ISO_TRY(isorender_ranks_check_surface(job, index, error));
    ISO_TRY(count_nonfinite(job, error));
    write_index(job);
    return ISO_OK;
}

iso_box isorender_chunks_bounds(const isorender_job *job, const iso_affine *affine) {
    isorender_chunks *chunks = job->chunks;
    iso_box box = iso_box_empty();
    iso_chunk_bounds bounds = {{1, 1}, &affine, 1, &box, 0};
    if (chunks->status == ISO_OK) chunks->status = find_boxes(job, &bounds, &chunks->error);
    return box;
}

iso_status isorender_chunks_check(const isorender_job *job, iso_error *error) {
    if (!job->chunks || job->chunks->status == ISO_OK) return ISO_OK;
    return iso_fail(error, job->chunks->status, "%s", job->chunks->error.text);
}

void isorender_chunks_free(isorender_job *job) {
    if (!job->chunks) return;
    iso_chunk_walk_destroy(job->chunks->walk);
    iso_volume_index_free(&job->chunks->index);
    free(job->chunks->index_path);
    free(job->chunks);
}

/* ---- pictures */

static iso_status draw_cells(isorender_job *job, const iso_view *view, iso_key_image *keys,
                             iso_error *error) {
    const iso_exact_key_picture picture = {view, job->surfaces[0].color, keys, job->pool,
                                           job->surfaces[0].scene.clip};
    const iso_chunk_share share = share_of(job->settings, true);
    ISO_TRY(iso_key_image_allocate(view->width, view->height * plane_count(job), keys, error));
    if (!shows_slices_alone(job->settings))
        ISO_TRY(iso_exact_chunks_draw(job->chunks->walk, share, &picture, error));
    if (!isorender_has_caps(job->settings)) return ISO_OK;
    iso_capped solids[ISORENDER_SURFACES];
    const iso_cut_caps caps = isorender_caps(job, solids);
    return iso_cap_chunks_draw(job->chunks->walk, share, &caps, view, keys, error);
}

static iso_status draw_points(isorender_job *job, const iso_view *view, iso_pullpush_base *base,
                              iso_key_image *keys, iso_error *error) {
    iso_chunk_walk *walk = job->chunks->walk;
    iso_pullpush_survey survey;
    const iso_ranks *ranks = &job->settings->ranks;
    const iso_status status =
        iso_point_chunks_survey(walk, share_of(job->settings, false), view, &survey, error);
    ISO_TRY(iso_ranks_agree(ranks, status, error));
    ISO_TRY(isorender_ranks_survey(ranks, &survey, error));
    *base = iso_pullpush_base_of(&survey, view);
    const iso_pullpush_keys picture = {view, *base, keys, job->pool};
    ISO_TRY(iso_key_image_allocate(base->width, base->height, keys, error));
    return iso_point_chunks_draw(walk, share_of(job->settings, true), &picture, &survey, error);
}

/* Draws the share of --part, or everything. Sets `base` for pull-push. */
static iso_status draw_keys(isorender_job *job, const iso_camera *camera, iso_pullpush_base *base,
                            iso_key_image *keys, iso_error *error) {
    const iso_view pixels = iso_view_make(camera, job->settings->width, job->settings->height),
                   view = iso_view_scaled(&pixels, iso_picture_factor(job->samples));
    const iso_ranks *ranks = &job->settings->ranks;
    job->chunks->stage = "rendering";
    const iso_status status =
        is_exact(job) ? draw_cells(job, &view, keys, error) : draw_points(job, &view, base, keys, error);
    ISO_TRY(iso_ranks_agree(ranks, status, error));
    return iso_ranks_least_keys(ranks, keys->keys, (size_t)keys->width * (size_t)keys->height, error);
}

iso_status isorender_chunks_draw(isorender_job *job, const iso_picture_opts *opts, iso_image *image,
                                 size_t *covered, iso_error *error) {
    iso_key_image drawn = {0};
    iso_merged_keys keys = {.method = job->renderer->method,
                            .transform = job->surfaces[0].scene.grid.rgrid->transform,
                            .image = &drawn};
    for (int k = 0; k < 3; k++) keys.dims[k] = job->surfaces[0].scene.grid.rgrid->dims[k];
    iso_status status = draw_keys(job, opts->camera, &keys.base, &drawn, error);
    if (status == ISO_OK && isorender_has_caps(job->settings)) iso_key_image_join_caps(&drawn, job->pool);
    *covered = 1; /* (of ranks that have no picture) */
    if (status == ISO_OK && !job->settings->ranks.rank)
        status = iso_render_merged_keys(&keys, opts, image, covered, error);
    iso_key_image_free(&drawn);
    return status;
}

/* ---- files */

iso_status isorender_chunks_export(isorender_job *job, const char *comment, iso_error *error) {
    iso_chunk_exported exported;
    job->chunks->stage = "writing";
    if (job->plan->points) {
        ISO_TRY(iso_chunk_export_points(job->chunks->walk, job->plan->points, comment, &exported, error));
        job->points_written = true;
        job->point_count = exported.points;
    }
    if (job->plan->mesh) {
        ISO_TRY(iso_chunk_export_mesh(job->chunks->walk, job->plan->mesh, comment, &exported, error));
        job->mesh_written = true;
        job->vertex_count = exported.points;
        job->triangle_count = exported.triangles;
    }
    return ISO_OK;
}

void isorender_report_chunks(iso_json *json, const isorender_job *job) {
    if (!job->chunks || !job->chunks->walk) return;
    const iso_chunk_totals totals = iso_chunk_walk_stats(job->chunks->walk);
    iso_json_begin_object(json, "chunks");
    iso_json_integer(json, "count", totals.chunks);
    iso_json_integer(json, "side", (uint64_t)choose_side(job));
    iso_json_integer(json, "bytes_read", totals.bytes_read);
    iso_json_integer(json, "bytes_crossed", totals.bytes_crossed);
    if (job->chunks->source.decoded) iso_json_integer(json, "bytes_decoded", totals.bytes_decoded);
    iso_json_end_object(json);
}

/* ---- parts */

static void describe_surface(const isorender_job *job, iso_key_surface *surface) {
    const iso_rgrid *grid = job->surfaces[0].scene.grid.rgrid;
    for (int axis = 0; axis < 3; axis++) surface->dims[axis] = grid->dims[axis];
    surface->type = (int32_t)grid->type;
    surface->scale = grid->scale;
    surface->offset = grid->offset;
    surface->transform = grid->transform;
    surface->isovalue = job->surfaces[0].scene.isovalue;
    surface->primitives = is_exact(job) ? job->cell_count : job->point_count;
    surface->bounds = job->surfaces[0].bounds;
}

/* The bar of what slices show: the parts have no other. */
static iso_status describe_bar(const isorender_job *job, iso_key_style *style, iso_error *error) {
    iso_color_bar bars[ISORENDER_BARS];
    int count;
    ISO_TRY(isorender_titled_bars(job, bars, &count, error));
    if (!count) return ISO_OK;
    style->color_bar = 1;
    style->colormap = (int32_t)bars[0].map;
    style->bar_low = bars[0].low;
    style->bar_high = bars[0].high;
    memcpy(style->bar_title, bars[0].title, strlen(bars[0].title));
    return ISO_OK;
}

static void describe_style(const isorender_job *job, iso_key_style *style) {
    const isorender_settings *settings = job->settings;
    const iso_rgb color = job->surfaces[0].color, background = settings->background;
    style->width = settings->width;
    style->height = settings->height;
    style->samples = job->samples;
    style->position = job->camera.position;
    style->focal_point = job->camera.focal_point;
    style->view_up = job->camera.view_up;
    style->view_angle = job->camera.view_angle;
    style->parallel_scale = job->camera.parallel_scale;
    style->pixels_per_metre = isorender_pixels_per_metre(job);
    style->method = (int32_t)job->renderer->method;
    style->orthographic = job->camera.orthographic;
    style->transparent = settings->transparent != 0;
    style->scale_bar = settings->scale_bar != 0;
    style->unit = (int32_t)settings->unit;
    style->world_unit = (int32_t)isorender_unit(job);
    style->caps = isorender_has_caps(settings);
    style->orientation_marker = settings->orientation_marker != 0;
    style->font_size = isorender_font_pixels(settings);
    style->anatomical = job->loader.volume.info.anatomical != 0;
    memcpy(style->background, (const uint8_t[4]){background.r, background.g, background.b}, 4);
    memcpy(style->color, (const uint8_t[4]){color.r, color.g, color.b}, 4);
}

iso_status isorender_chunks_write_part(isorender_job *job, iso_error *error) {
    isorender_picture_record record;
    iso_key_file file = {.part = job->settings->part, .parts = job->settings->parts};
    ISO_TRY(describe_bar(job, &file.style, error));
    ISO_TRY(isorender_picture_record_make(job, &record, error));
    describe_surface(job, &file.surface);
    describe_style(job, &file.style);
    file.texts[ISO_KEY_SOFTWARE] = record.software;
    file.texts[ISO_KEY_TITLE] = job->plan->model;
    file.texts[ISO_KEY_COMMENT] = record.command;
    file.texts[ISO_KEY_DESCRIPTION] = record.isovalues[0] ? record.isovalues : NULL;
    file.texts[ISO_KEY_SCENE] = record.scene;
    iso_status status = draw_keys(job, &job->camera, &file.style.base, &file.keys, error);
    if (status == ISO_OK) status = iso_key_file_write(job->plan->image, &file, error);
    iso_key_image_free(&file.keys);
    isorender_picture_record_free(&record);
    if (status == ISO_OK) job->frames_written = 1;
    return status;
}
