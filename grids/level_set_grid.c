/* Samples any grid as the start of a level set: cells that may contain part of the band get a brick, bricks
 * are sampled, and all values are scaled so that those beside the interface fit into the band. */
#include <math.h>

#include "base/memory.h"
#include "grids/level_set.h"

/* Cells within this many voxels of the interface get bricks: 3 for the band, and 1 for central differences.
 */
enum { BAND_CELLS_REACH = 4 };
/* Cells between two reports of progress. */
enum { PROGRESS_CELLS = 1024 };
/* Values are scaled so that nearly all at the interface are below this (voxels). Then their neighbours'
 * values, which determine the gradient there, are inside the band, too. */
static const double INTERFACE_MOST = 1.2;
/* The largest value, in voxels. It is inside the band, so that redistancing changes these voxels. */
static const double FAR_VALUE = 2.99;

typedef struct resampling {
    const iso_grid *from;
    iso_hgrid *to;
    double isovalue, sign; /* sign: 1 if inside is below the isovalue, -1 if it is at or above */
    double scale[3];       /* index of `from` = scale * index of `to` - offset */
    double offset[3];
    int from_bricks[3];
    uint8_t *crosses;      /* by brick of `from`: whether the surface may cross it */
    iso_progress progress; /* progress of sampling the bricks */
} resampling;

/* Returns the value at a voxel of `to`, relative to the isovalue and negative inside; INFINITY beyond the
 * grid and where a value is not finite. */
static double value_at(const resampling *r, const int voxel[3]) {
    double p[3];
    const int *dims = iso_grid_dims(r->from);
    for (int axis = 0; axis < 3; axis++) {
        p[axis] = r->scale[axis] * voxel[axis] - r->offset[axis];
        if (p[axis] < 0 || p[axis] > dims[axis] - 1) return INFINITY;
    }
    double value = iso_grid_sample(r->from, iso_vec3_make(p[0], p[1], p[2]));
    if (!isfinite(value)) return INFINITY;
    value = r->sign * (value - r->isovalue);
    return r->sign < 0 && value == 0 ? -0x1p-120 : value; /* a voxel at the isovalue is inside */
}

/* ---- cells that may contain part of the band */

static void find_crossing(void *context, size_t index, int worker) {
    (void)worker;
    resampling *r = context;
    const int *n = r->from_bricks;
    const int brick[3] = {(int)(index % (size_t)n[0]), (int)(index / (size_t)n[0] % (size_t)n[1]),
                          (int)(index / (size_t)n[0] / (size_t)n[1])};
    r->crosses[index] = (uint8_t)iso_grid_brick_may_cross(r->from, brick, (float)r->isovalue);
}

/* Computes the range of bricks of `from` that lie around a cell of `to`. Returns whether the cell or its
 * surroundings extend beyond the grid `from`. */
static bool brick_range(const resampling *r, const int at[3], int lo[3], int hi[3]) {
    const int *dims = iso_grid_dims(r->from);
    bool beyond = false;
    for (int axis = 0; axis < 3; axis++) {
        const double first = r->scale[axis] * (ISO_BRICK * at[axis] - BAND_CELLS_REACH) - r->offset[axis];
        const double last =
            r->scale[axis] * (ISO_BRICK * (at[axis] + 1) + BAND_CELLS_REACH) - r->offset[axis];
        beyond |= first < 0 || last > dims[axis] - 1;
        lo[axis] = (int)(fmin(fmax(first - 1, 0), dims[axis] - 1) / ISO_BRICK);
        hi[axis] = (int)(fmin(fmax(last + 1, 0), dims[axis] - 1) / ISO_BRICK);
    }
    return beyond;
}

static bool may_hold_band(const resampling *r, const int at[3]) {
    int lo[3], hi[3];
    if (brick_range(r, at, lo, hi)) return true; /* the solid may end at the grid's border */
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (r->crosses[((size_t)z * (size_t)r->from_bricks[1] + (size_t)y) *
                                   (size_t)r->from_bricks[0] +
                               (size_t)x])
                    return true;
    return false;
}

static iso_status make_cells(const resampling *r, const iso_progress *progress, iso_error *error) {
    const size_t count = iso_hgrid_cell_count(r->to);
    for (size_t cell = 0; cell < count; cell++) {
        if (cell % PROGRESS_CELLS == 0)
            ISO_TRY(iso_progress_tell(progress, "the volume", (double)cell / (double)count, error));
        int at[3];
        float *brick;
        iso_hgrid_cell_position(r->to, cell, at);
        const int first[3] = {ISO_BRICK * at[0], ISO_BRICK * at[1], ISO_BRICK * at[2]};
        if (may_hold_band(r, at))
            ISO_TRY(iso_hgrid_split(r->to, at[0], at[1], at[2], &brick, error));
        else
            r->to->cell[cell] = value_at(r, first) < 0 ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE;
    }
    return ISO_OK;
}

/* ---- values */

static void sample_cell(void *context, size_t index, int worker) {
    (void)worker;
    const resampling *r = context;
    if (r->to->cell[index] < 0) return;
    const double fraction = (double)index / (double)iso_hgrid_cell_count(r->to);
    if (iso_progress_tell(&r->progress, "", fraction, NULL) != ISO_OK)
        return; /* the caller reports that it was cancelled */
    int at[3];
    iso_hgrid_cell_position(r->to, index, at);
    float *brick = iso_hgrid_brick(r->to, r->to->cell[index]);
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int voxel[3] = {ISO_BRICK * at[0] + i % ISO_BRICK,
                              ISO_BRICK * at[1] + i / ISO_BRICK % ISO_BRICK,
                              ISO_BRICK * at[2] + i / ISO_BRICK / ISO_BRICK};
        brick[i] = (float)value_at(r, voxel);
    }
}

static bool is_interface(const iso_hgrid *grid, const int at[3], int i) {
    const int p[3] = {ISO_BRICK * at[0] + i % ISO_BRICK, ISO_BRICK * at[1] + i / ISO_BRICK % ISO_BRICK,
                      ISO_BRICK * at[2] + i / ISO_BRICK / ISO_BRICK};
    const bool inside = iso_hgrid_at(grid, p[0], p[1], p[2]) < 0;
    for (int face = 0; face < 6; face++) {
        int q[3] = {p[0], p[1], p[2]};
        q[face / 2] += face % 2 ? 1 : -1;
        if (q[face / 2] < 0 || q[face / 2] >= grid->dims[face / 2]) continue;
        if ((iso_hgrid_at(grid, q[0], q[1], q[2]) < 0) != inside) return true;
    }
    return false;
}

/* Calls `visit` for each voxel of a brick, with its value and whether it belongs to the interface. */
static void visit_voxels(const resampling *r, void (*visit)(void *, float *, bool), void *context) {
    for (size_t cell = 0; cell < iso_hgrid_cell_count(r->to); cell++) {
        if (r->to->cell[cell] < 0) continue;
        int at[3];
        iso_hgrid_cell_position(r->to, cell, at);
        float *brick = iso_hgrid_brick(r->to, r->to->cell[cell]);
        for (int i = 0; i < ISO_BRICK_VOXELS; i++) visit(context, &brick[i], is_interface(r->to, at, i));
    }
}

/* A histogram of the absolute values at the interface, by powers of two. */
typedef struct magnitudes {
    size_t count[512], all;
    float factor;
} magnitudes;

static void count_magnitude(void *context, float *value, bool interface) {
    magnitudes *m = context;
    int exponent;
    if (!interface || !isfinite(*value)) return;
    frexpf(fabsf(*value), &exponent);
    m->count[exponent + 256]++;
    m->all++;
}

/* Scales a value and keeps its sign, so that the result does not depend on the order of voxels. An interface
 * voxel beyond the grid gets 0.5: the surface is assumed to pass half-way. */
static void scale_value(void *context, float *value, bool interface) {
    const magnitudes *m = context;
    const float side = *value < 0 ? -1 : 1, scaled = fabsf(*value) * m->factor, most = (float)FAR_VALUE;
    if (interface && !isfinite(*value))
        *value = 0.5f;
    else
        *value = side * (scaled < 1e-4f ? 1e-4f : scaled < most ? scaled : most);
}

/* Scales all values by a power of two, chosen so that all but a thousandth of the interface values are below
 * INTERFACE_MOST. */
static iso_status scale_values(const resampling *r, const char *path, iso_error *error) {
    magnitudes *m = iso_alloc_zero(1, sizeof *m);
    if (!m) return iso_fail_memory(error, path);
    visit_voxels(r, count_magnitude, m);
    size_t above = 0;
    int bin = 511;
    while (bin > 0 && above + m->count[bin] <= m->all / 1000) above += m->count[bin--];
    m->factor = (float)ldexp(INTERFACE_MOST, 256 - bin);
    const bool any = m->all > 0;
    if (any) visit_voxels(r, scale_value, m);
    iso_free(m);
    if (!any)
        return iso_fail(error, ISO_ERR_EMPTY, "%s: nothing is inside at isovalue %g", path, r->isovalue);
    return ISO_OK;
}

/* ---- the grid */

static iso_status make_grid(const char *path, const iso_resampling *how, resampling *r, iso_error *error) {
    iso_transform transform = *iso_grid_transform(r->from);
    const iso_affine affine = iso_transform_affine(&transform);
    const int *dims = iso_grid_dims(r->from);
    double voxel = how->voxel > 0 ? how->voxel : INFINITY;
    for (int axis = 0; axis < 3 && !(how->voxel > 0); axis++) voxel = fmin(voxel, transform.spacing[axis]);
    int size[3];
    for (int axis = 0; axis < 3; axis++) {
        const double voxels =
            ceil((dims[axis] - 1) * transform.spacing[axis] / voxel) + 1 + 2.0 * how->margin;
        const double whole = ceil(voxels / ISO_BRICK) * ISO_BRICK;
        if (!(whole <= ISO_HGRID_MAX))
            return iso_fail(error, ISO_ERR_LIMIT, "%s: %g voxels of %g mm along %c, at most %d", path, whole,
                            voxel, "xyz"[axis], ISO_HGRID_MAX);
        size[axis] = (int)whole;
        r->scale[axis] = voxel / transform.spacing[axis];
        r->offset[axis] = r->scale[axis] * floor((whole - (voxels - 2 * how->margin)) / 2);
    }
    const iso_vec3 origin =
        iso_affine_point(&affine, iso_vec3_make(-r->offset[0], -r->offset[1], -r->offset[2]));
    const double at[3] = {origin.x, origin.y, origin.z};
    for (int axis = 0; axis < 3; axis++) {
        transform.origin[axis] = at[axis];
        transform.spacing[axis] = voxel;
    }
    return iso_hgrid_create(size, 0, &transform, &r->to, error);
}

static iso_status resample(const char *path, const iso_resampling *how, resampling *r, iso_error *error) {
    iso_grid_bricks(r->from, r->from_bricks);
    const size_t bricks = (size_t)r->from_bricks[0] * (size_t)r->from_bricks[1] * (size_t)r->from_bricks[2];
    r->crosses = iso_alloc(bricks);
    if (!r->crosses) return iso_fail_memory(error, path);
    ISO_TRY(make_grid(path, how, r, error));
    const iso_progress making = iso_progress_part(how->progress, 0.1, 0.2),
                       scaling = iso_progress_part(how->progress, 0.8, 1);
    r->progress = iso_progress_part(how->progress, 0.2, 0.8);
    iso_parallel_for(how->pool, bricks, find_crossing, r);
    ISO_TRY(make_cells(r, &making, error));
    iso_parallel_for(how->pool, iso_hgrid_cell_count(r->to), sample_cell, r);
    ISO_TRY(iso_progress_tell(&r->progress, path, 1, error));
    ISO_TRY(scale_values(r, path, error));
    return iso_progress_tell(&scaling, path, 1, error);
}

iso_status iso_level_set_from_grid(const char *path, const iso_grid *from, const iso_resampling *how,
                                   iso_hgrid **grid, iso_error *error) {
    resampling r = {.from = from, .isovalue = how->isovalue, .sign = iso_grid_is_level_set(from) ? 1 : -1};
    iso_status status = resample(path, how, &r, error);
    iso_free(r.crosses);
    if (status == ISO_OK)
        *grid = r.to;
    else
        iso_hgrid_destroy(r.to);
    return status;
}
