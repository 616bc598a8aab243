/* refined: the spline's samples at half the voxel spacing, near the surface. */
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "grids/spline/spline.h"
#include "grids/spline/spline_kernel.h"

/* A brick of the refined grid, as a slot of iso_parallel_ordered keeps it. */
typedef struct refined_brick {
    int brick[3];
    bool kept;
    int32_t state; /* of the cell, if it is not kept */
    float values[ISO_BRICK_VOXELS];
} refined_brick;

typedef struct refining {
    const iso_spline *spline;
    float isovalue;
    bool level_set;
    bool lowers; /* keep the shell; else the samples as they are */
    iso_spline_shell_fn *shell;
    uint32_t *bricks; /* the numbers of the refined grid's cells that the surface may cross */
    iso_hgrid *refined;
    refined_brick *slots;
    iso_status status;
    iso_error *error;
} refining;

/* iso_ordered.work. A brick is kept if the surface, or the border of what is finite, crosses cells whose
 * normals depend on it, or if its shell begins. */
static void sample_brick(void *context, size_t index, size_t slot, int worker) {
    (void)worker;
    refining *r = context;
    refined_brick *made = &r->slots[slot];
    iso_spline_samples samples;
    iso_hgrid_cell_position(r->refined, r->bricks[index], made->brick);
    iso_spline_sample(r->spline, made->brick, samples);
    iso_spline_shell s = {samples, r->isovalue, r->level_set, r->lowers ? made->values : NULL, 0, 0, 0};
    r->shell(&s);
    const int all = sizeof samples / sizeof *samples;
    made->kept = s.inside != all && s.outside != all && s.inside + s.outside > 0;
    made->kept |= s.lowered > 0 && s.outside == all;
    made->state = s.inside == all ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE;
    for (int row = 0; made->kept && !r->lowers && row < ISO_BRICK * ISO_BRICK; row++) {
        const int y = row % ISO_BRICK + 2, z = row / ISO_BRICK + 2;
        memcpy(made->values + row * ISO_BRICK,
               samples + (z * ISO_SPLINE_SAMPLES + y) * ISO_SPLINE_SAMPLES + 2, ISO_BRICK * sizeof *samples);
    }
}

/* iso_ordered.place */
static bool place_brick(void *context, size_t slot, bool alone) {
    (void)alone;
    refining *r = context;
    const refined_brick *made = &r->slots[slot];
    const size_t cell = iso_hgrid_cell_index(r->refined, made->brick[0], made->brick[1], made->brick[2]);
    r->refined->cell[cell] = made->state;
    if (!made->kept || r->status != ISO_OK) return true;
    r->status = iso_hgrid_split_unset(r->refined, made->brick[0], made->brick[1], made->brick[2], r->error);
    if (r->status == ISO_OK)
        memcpy(iso_hgrid_brick(r->refined, r->refined->cell[cell]), made->values, sizeof made->values);
    return true;
}

/* iso_ordered.finish */
static void finish_brick(void *context, size_t slot) {
    (void)context, (void)slot;
}

/* Lists the bricks that the surface may cross, and sets the state of the others. */
static size_t list_bricks(refining *r, double isovalue) {
    size_t count = 0;
    const size_t cells = iso_hgrid_cell_count(r->refined);
    for (size_t i = 0; i < cells; i++) {
        int at[3];
        bool above;
        iso_hgrid_cell_position(r->refined, i, at);
        for (int axis = 0; axis < 3; axis++) at[axis] /= 2;
        if (iso_spline_may_cross(r->spline, at, isovalue, &above))
            r->bricks[count++] = (uint32_t)i;
        else
            r->refined->cell[i] = above != r->level_set ? ISO_CELL_INSIDE : ISO_CELL_OUTSIDE;
    }
    return count;
}

static iso_status sample_bricks(refining *r, double isovalue, iso_pool *pool) {
    const iso_ordered steps = {sample_brick, place_brick, finish_brick, iso_ordered_slots(pool)};
    r->bricks = iso_alloc_zero(iso_hgrid_cell_count(r->refined), sizeof *r->bricks);
    r->slots = iso_alloc_zero(steps.slots, sizeof *r->slots);
    if (!r->bricks || !r->slots)
        return iso_fail(r->error, ISO_ERR_NOMEM, "out of memory for sampling a spline");
    iso_parallel_ordered(pool, list_bricks(r, isovalue), &steps, r);
    return r->status == ISO_OK ? iso_pool_check(pool, "the smooth surface", r->error) : r->status;
}

iso_status iso_spline_refine(const iso_spline *spline, double isovalue, bool shell, iso_pool *pool,
                             iso_hgrid **out, iso_error *error) {
    const iso_grid *grid = iso_spline_grid(spline);
    const int *dims = iso_grid_dims(grid);
    int fine[3];
    iso_transform transform = *iso_grid_transform(grid);
    for (int i = 0; i < 3; i++) {
        if (dims[i] > ISO_HGRID_MAX / 2)
            return iso_fail(
                error, ISO_ERR_LIMIT,
                "smooth surfaces are of volumes of up to %d voxels along an axis, and this one has "
                "%d; coarser levels of it and --crop have fewer",
                ISO_HGRID_MAX / 2, dims[i]);
        fine[i] = 2 * dims[i] - 1;
        transform.spacing[i] /= 2;
    }
    refining r = {.spline = spline,
                  .isovalue = (float)isovalue,
                  .level_set = iso_grid_is_level_set(grid) != 0,
                  .lowers = shell,
                  .shell = ISO_KERNEL_UNIT(iso_spline_shell_units, iso_cpu_best()),
                  .error = error};
    ISO_TRY(iso_hgrid_create(fine, 0, &transform, &r.refined, error));
    const iso_status status = sample_bricks(&r, isovalue, pool);
    iso_free(r.bricks);
    iso_free(r.slots);
    if (status == ISO_OK)
        *out = r.refined;
    else
        iso_hgrid_destroy(r.refined);
    return status;
}
