/* Creates, crops and destroys dense grids. */
#include "grids/rgrid.h"

#include "base/memory.h"
#include "base/primitives.h"

const char *iso_type_name(iso_type type) {
    static const char *const names[] = {"uint8", "int16", "uint16", "float32"};
    return names[type];
}

static iso_status check_dims(const int dims[3], iso_type type, size_t *bytes, iso_error *error) {
    size_t total = iso_type_size(type), cells = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (dims[axis] < 1)
            return iso_fail(error, ISO_ERR_FORMAT, "a volume of %d x %d x %d voxels has none", dims[0],
                            dims[1], dims[2]);
        if (!iso_size_multiply(total, (size_t)dims[axis], &total) || total > PTRDIFF_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "a volume of %d x %d x %d voxels is too large", dims[0],
                            dims[1], dims[2]);
        /* The product cannot overflow, because there are fewer cells than bytes. */
        cells *= (size_t)(dims[axis] - 1) / ISO_BRICK + 1;
    }
    if (cells > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "a volume of %d x %d x %d voxels has over 2^32 bricks", dims[0],
                        dims[1], dims[2]);
    *bytes = total;
    return ISO_OK;
}

static iso_status check_desc(const iso_rgrid_desc *desc, size_t *bytes, iso_error *error) {
    ISO_TRY(check_dims(desc->dims, desc->type, bytes, error));
    if (!(desc->scale >= 0) || !isfinite(desc->scale) || !isfinite(desc->offset))
        return iso_fail(error, ISO_ERR_FORMAT, "value scale %g and offset %g are not usable", desc->scale,
                        desc->offset);
    if (desc->transform && iso_transform_is_singular(desc->transform))
        return iso_fail(error, ISO_ERR_FORMAT, "spacing and direction do not span the space");
    return ISO_OK;
}

static iso_status create_log(const int dims[3], iso_change_log **log, iso_error *error) {
    int cells[3];
    for (int axis = 0; axis < 3; axis++) cells[axis] = (dims[axis] - 1) / ISO_BRICK + 1;
    return iso_change_log_create(cells, log, error);
}

/* Creates a grid that does not own lent data yet, so that iso_rgrid_create can release the data in one place
 * if this fails. */
static iso_status create_without_owner(const iso_rgrid_desc *desc, iso_rgrid **out, iso_error *error) {
    size_t bytes = 0;
    ISO_TRY(check_desc(desc, &bytes, error));
    iso_rgrid *grid = iso_alloc_zero(1, sizeof *grid);
    if (!grid) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a grid");
    *grid = (iso_rgrid){.dims = {desc->dims[0], desc->dims[1], desc->dims[2]},
                        .type = desc->type,
                        .data = desc->data,
                        .stride_y = desc->dims[0],
                        .stride_z = (ptrdiff_t)desc->dims[0] * desc->dims[1],
                        .scale = desc->scale == 0 ? 1 : desc->scale,
                        .offset = desc->offset,
                        .transform = desc->transform ? *desc->transform : iso_transform_identity(),
                        .level_set = desc->level_set};
    iso_status status = create_log(grid->dims, &grid->log, error);
    if (status == ISO_OK && !grid->data) {
        grid->data = grid->owner = iso_alloc(bytes);
        grid->release = iso_free;
        if (!grid->data)
            status =
                iso_fail(error, ISO_ERR_NOMEM, "out of memory: %zu bytes refused for %d x %d x %d voxels",
                         bytes, grid->dims[0], grid->dims[1], grid->dims[2]);
    }
    if (status != ISO_OK) {
        iso_change_log_destroy(grid->log);
        iso_free(grid);
        return status;
    }
    *out = grid;
    return ISO_OK;
}

iso_status iso_rgrid_create(const iso_rgrid_desc *desc, iso_rgrid **out, iso_error *error) {
    iso_rgrid *grid = NULL;
    iso_status status = create_without_owner(desc, &grid, error);
    if (status != ISO_OK) {
        if (desc->data && desc->release) desc->release(desc->owner);
        return status;
    }
    if (desc->data) {
        grid->release = desc->release;
        grid->owner = desc->owner;
    }
    *out = grid;
    return ISO_OK;
}

static void drop_index(iso_rgrid *grid) {
    if (grid->index) grid->destroy_index(grid->index);
    grid->index = NULL;
}

void iso_rgrid_destroy(iso_rgrid *grid) {
    if (!grid) return;
    drop_index(grid);
    if (grid->release) grid->release(grid->owner);
    iso_change_log_destroy(grid->log);
    iso_free(grid);
}

iso_status iso_rgrid_crop(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error) {
    int dims[3];
    ISO_TRY(iso_crop_dims(grid->dims, lo, hi, dims, error));
    iso_change_log *log = NULL;
    ISO_TRY(create_log(dims, &log, error));
    drop_index(grid);
    iso_change_log_destroy(grid->log);
    grid->log = log;
    grid->transform = iso_transform_shift(&grid->transform, lo);
    ptrdiff_t shift = lo[0] + lo[1] * grid->stride_y + lo[2] * grid->stride_z;
    grid->data = (char *)grid->data + shift * (ptrdiff_t)iso_type_size(grid->type);
    for (int axis = 0; axis < 3; axis++) grid->dims[axis] = dims[axis];
    return ISO_OK;
}

iso_status iso_rgrid_mark_changed(iso_rgrid *grid, const int lo[3], const int hi[3], iso_error *error) {
    int last[3];
    for (int axis = 0; axis < 3; axis++)
        last[axis] = hi[axis] < grid->dims[axis] ? hi[axis] : grid->dims[axis] - 1;
    iso_change_log_begin(grid->log);
    return iso_change_log_add(grid->log, lo, last, error);
}
