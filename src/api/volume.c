/* The functions of isopoint.h for volumes: files and lent arrays, each with its thread pool. */
#include <stdint.h>
#include <string.h>

#include "api/internal.h"
#include "base/memory.h"
#include "extract/isovalue/isovalue.h"
#include "grids/brick_index.h"
#include "grids/level_set.h"

#define ISO_TEXT_OF(number) #number
#define ISO_TEXT(number) ISO_TEXT_OF(number)

const char *iso_version(void) {
    return ISO_TEXT(ISO_VERSION_MAJOR) "." ISO_TEXT(ISO_VERSION_MINOR) "." ISO_TEXT(ISO_VERSION_PATCH);
}

iso_status iso_api_pool(int threads, iso_pool **pool, iso_error *error) {
    return iso_pool_create(threads, pool, error);
}

/* ---- opening ---- */

static iso_status check_opts(const iso_open_opts *opts, iso_error *error) {
    if (opts->level >= 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_USAGE, "level %d: levels are counted from 0", opts->level);
}

static iso_volume_opts reading_of(const iso_open_opts *opts, iso_pool *pool) {
    iso_volume_opts reading = {.grid = opts->grid,
                               .series = opts->series,
                               .component = opts->component,
                               .level = opts->level,
                               .raw = opts->raw,
                               .max_memory = opts->max_memory,
                               .pool = pool,
                               .progress = opts->progress,
                               .progress_context = opts->progress_context};
    memcpy(reading.spacing, opts->spacing, sizeof reading.spacing);
    return reading;
}

iso_status iso_api_check_path(const char *path, iso_error *error) {
    iso_volume_use_servers();
    return path ? ISO_OK : iso_fail(error, ISO_ERR_USAGE, "no file is named");
}

static iso_status create(int threads, iso_api_volume **volume, iso_error *error) {
    iso_api_volume *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a volume");
    iso_status status = iso_api_pool(threads, &made->pool, error);
    if (status == ISO_OK)
        *volume = made;
    else
        iso_free(made);
    return status;
}

iso_status iso_volume_open(const char *path, const iso_open_opts *opts, iso_volume **volume,
                           iso_error *error) {
    static const iso_open_opts defaults;
    iso_api_volume *made = NULL;
    if (!opts) opts = &defaults;
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(check_opts(opts, error));
    ISO_TRY(create(opts->threads, &made, error));
    const iso_volume_opts reading = reading_of(opts, made->pool);
    iso_status status = iso_volume_read(path, &reading, &made->volume, error);
    if (status == ISO_OK) {
        *volume = &made->volume;
        return ISO_OK;
    }
    iso_pool_destroy(made->pool);
    iso_free(made);
    return status;
}

iso_status iso_volume_inspect(const char *path, const iso_open_opts *opts, iso_volume_info *info,
                              iso_error *error) {
    static const iso_open_opts defaults;
    if (!opts) opts = &defaults;
    ISO_TRY(iso_api_check_path(path, error));
    ISO_TRY(check_opts(opts, error));
    const iso_volume_opts reading = reading_of(opts, NULL);
    return iso_volume_read_info(path, &reading, info, error);
}

static void describe_lent(const iso_rgrid *grid, iso_volume_info *info) {
    strcpy(info->format, "lent");
    memcpy(info->dims, grid->dims, sizeof info->dims);
    info->type = grid->type;
    strcpy(info->file_type, iso_type_name(grid->type));
    info->components = 1;
    info->transform = grid->transform;
    info->scale = grid->scale;
    info->offset = grid->offset;
    info->level_set = grid->level_set != 0;
    info->bytes = iso_type_size(grid->type) * (uint64_t)grid->dims[0] * (uint64_t)grid->dims[1] *
                  (uint64_t)grid->dims[2];
}

/* Whether the voxels of a lent array lie apart from each other. Strides that are 0 are set to those of dense
 * voxels. */
static bool complete_strides(const iso_lend_opts *opts, ptrdiff_t *y, ptrdiff_t *z) {
    const int *dims = opts->dims;
    *y = opts->stride_y ? opts->stride_y : dims[0];
    *z = opts->stride_z;
    if (dims[0] < 1 || dims[1] < 1 || dims[2] < 1) return true; /* which iso_rgrid_create refuses */
    if (*y < dims[0] || *y > PTRDIFF_MAX / dims[1]) return false;
    const ptrdiff_t plane = *y * dims[1];
    if (!opts->stride_z) *z = plane;
    return *z >= plane && *z <= PTRDIFF_MAX / (ptrdiff_t)sizeof(float) / dims[2];
}

/* Creates the grid of a lent array, which it releases from then on. The voxels are read when something asks
 * for the grid's index: parts of a picture (isopoint_parts.h) do without. */
static iso_status lend(const iso_rgrid_desc *desc, ptrdiff_t y, ptrdiff_t z, iso_api_volume *volume,
                       iso_error *error) {
    iso_rgrid **grid = &volume->volume.grid.rgrid;
    ISO_TRY(iso_rgrid_create(desc, grid, error));
    (*grid)->stride_y = y;
    (*grid)->stride_z = z;
    describe_lent(*grid, &volume->volume.info);
    return ISO_OK;
}

iso_status iso_volume_lend(const iso_lend_opts *opts, iso_volume **volume, iso_error *error) {
    iso_api_volume *made = NULL;
    iso_status status = ISO_OK;
    ptrdiff_t y = 0, z = 0;
    if (!opts || !opts->data || opts->type < ISO_UINT8 || opts->type > ISO_FLOAT32)
        status = iso_fail(error, ISO_ERR_USAGE, "no array is lent, or one of an unknown type");
    else if (!complete_strides(opts, &y, &z))
        status =
            iso_fail(error, ISO_ERR_USAGE, "voxels of the lent array overlap: strides %td and %td", y, z);
    if (status == ISO_OK) status = create(opts->threads, &made, error);
    if (status != ISO_OK) {
        if (opts && opts->release) opts->release(opts->owner);
        return status;
    }
    iso_rgrid_desc desc = {.type = opts->type,
                           .data = (void *)(uintptr_t)opts->data, /* which is only read */
                           .release = opts->release,
                           .owner = opts->owner,
                           .scale = opts->scale,
                           .offset = opts->offset,
                           .transform = opts->transform,
                           .level_set = opts->level_set};
    memcpy(desc.dims, opts->dims, sizeof desc.dims);
    status = lend(&desc, y, z, made, error);
    if (status == ISO_OK)
        *volume = &made->volume;
    else
        iso_volume_destroy(&made->volume);
    return status;
}

void iso_volume_destroy(iso_volume *volume) {
    if (!volume) return;
    iso_api_volume *own = iso_api_volume_of(volume);
    if (own->borrowed) return;
    iso_volume_free(volume);
    iso_pool_destroy(own->pool);
    iso_free(own);
}

/* ---- properties ---- */

const iso_volume_info *iso_volume_describe(const iso_volume *volume) {
    return &volume->info;
}

double iso_volume_value(const iso_volume *volume, int x, int y, int z) {
    return iso_grid_physical(&volume->grid, iso_grid_at(&volume->grid, x, y, z));
}

void iso_volume_set_progress(iso_volume *volume, iso_progress_fn *progress, void *context) {
    iso_api_volume *own = iso_api_volume_of(volume);
    own->watch.tell = progress;
    own->watch.context = context;
}

iso_status iso_volume_voxels(const iso_volume *volume, iso_voxels *voxels, iso_error *error) {
    const iso_rgrid *grid = volume->grid.rgrid;
    if (!grid) return iso_fail(error, ISO_ERR_UNSUPPORTED, "a sparse level set is no array of voxels");
    *voxels = (iso_voxels){.data = grid->data,
                           .type = grid->type,
                           .dims = {grid->dims[0], grid->dims[1], grid->dims[2]},
                           .stride_y = grid->stride_y,
                           .stride_z = grid->stride_z};
    return ISO_OK;
}

iso_status iso_volume_histogram(iso_volume *volume, iso_histogram *histogram, iso_error *error) {
    iso_api_volume *own = iso_api_volume_of(volume);
    iso_rgrid *dense = volume->grid.rgrid;
    iso_api_watch_begin(own->pool, &own->watch);
    iso_status status = dense ? iso_brick_index_with_counts(dense, own->pool, error) : ISO_OK;
    if (status == ISO_OK) status = iso_histogram_compute(&volume->grid, own->pool, histogram, error);
    iso_api_watch_end(own->pool);
    return status;
}

iso_status iso_volume_suggest(iso_volume *volume, double *isovalue, iso_error *error) {
    iso_histogram histogram = {0};
    double candidates[ISO_ISOVALUE_CANDIDATES];
    if (!iso_grid_is_level_set(&volume->grid)) ISO_TRY(iso_volume_histogram(volume, &histogram, error));
    if (iso_isovalue_suggest(&volume->grid, &histogram, candidates) == 0)
        return iso_fail(error, ISO_ERR_EMPTY, "the volume is constant: every voxel is %g", histogram.minimum);
    *isovalue = candidates[0];
    return ISO_OK;
}

/* ---- changes ---- */

iso_status iso_volume_crop(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error) {
    iso_api_volume *own = iso_api_volume_of(volume);
    if (own->borrowed || own->surfaces > 0)
        return iso_fail(error, ISO_ERR_USAGE, "a volume that is sculpted or has surfaces cannot be cropped");
    iso_grid *grid = &volume->grid;
    if (grid->hgrid) {
        iso_hgrid *cropped;
        ISO_TRY(iso_hgrid_crop(grid->hgrid, lo, hi, &cropped, error));
        iso_hgrid_destroy(grid->hgrid);
        grid->hgrid = cropped;
    } else {
        ISO_TRY(iso_rgrid_crop(grid->rgrid, lo, hi, error));
    }
    memcpy(volume->info.dims, iso_grid_dims(grid), sizeof volume->info.dims);
    volume->info.transform = *iso_grid_transform(grid);
    return ISO_OK;
}

iso_status iso_volume_changed(iso_volume *volume, const int lo[3], const int hi[3], iso_error *error) {
    if (volume->grid.hgrid)
        return iso_fail(error, ISO_ERR_USAGE, "a sparse level set is changed by sculpting only");
    return iso_rgrid_mark_changed(volume->grid.rgrid, lo, hi, error);
}

/* ---- files ---- */

iso_status iso_volume_write_vdb(const iso_volume *volume, const char *path, const char *name,
                                iso_error *error) {
    ISO_TRY(iso_api_check_path(path, error));
    if (!volume->grid.hgrid)
        return iso_fail(error, ISO_ERR_USAGE, "%s: only sparse level sets are written as .vdb", path);
    return iso_level_set_write_vdb(path, volume->grid.hgrid, name ? name : "surface", NULL, error);
}
