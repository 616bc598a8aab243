/* ray_tracer: where rays cross an isosurface of a grid's trilinear field, or of its spline: every
 * crossing, in order, in double precision, to 1e-4 voxel.
 *
 * A crossing is a change between "at or above the isovalue" and "below" (grids/threshold.h). Cells with a
 * NaN or infinite corner are empty. The code is simple rather than fast: the ray caster, which judges
 * other renderers, is made of it, and renderers use it for the few pixels for which floats are not
 * precise enough. */
#ifndef ISO_GRIDS_RAY_RAY_TRACER_H
#define ISO_GRIDS_RAY_RAY_TRACER_H

#include "base/geometry.h"
#include "base/parallel.h"
#include "grids/grid.h"
#include "grids/spline/spline.h"

/* Knows which bricks of a grid the surface may cross, so that rays can skip the others. Borrows the grid. It
 * does not follow edits: after an edit, destroy it and create another one. Any number of threads may trace
 * rays with one tracer. */
typedef struct iso_ray_tracer iso_ray_tracer;

/* isovalue is physical (grids/grid.h). `pool` may be NULL. ISO_ERR_NOMEM; ISO_ERR_IO: the pool's watch
 * has cancelled. */
iso_status iso_ray_tracer_create(const iso_grid *grid, double isovalue, iso_pool *pool,
                                 iso_ray_tracer **tracer, iso_error *error);
/* The same with the index computed before: crossed[(z * bricks_y + y) * bricks_x + x] is 1 for the bricks
 * that the surface may cross, 0 for the others. Takes ownership of `crossed` (iso_alloc_zero), also when it
 * fails. */
iso_status iso_ray_tracer_create_with(const iso_grid *grid, double isovalue, uint8_t *crossed,
                                      iso_ray_tracer **tracer, iso_error *error);
/* The same for a spline, which is borrowed, with its grid: every crossing, but for pairs that are nearer to
 * each other than 1e-9 of a cell. shell: of the same isovalue (iso_spline_refine), with which rays pass cells
 * outside sooner; borrowed, or NULL. */
iso_status iso_ray_tracer_create_spline(const iso_spline *spline, double isovalue, const iso_hgrid *shell,
                                        iso_pool *pool, iso_ray_tracer **tracer, iso_error *error);
void iso_ray_tracer_destroy(iso_ray_tracer *tracer);

/* Looks at the voxels of the bricks that the surface may cross, so that rays skip parts of them too: worth it
 * for whole pictures. Rays find the same crossings. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_ray_tracer_refine(iso_ray_tracer *tracer, iso_pool *pool, iso_error *error);

/* The part of a ray that lies in one cell, from s = 0 at `from` to s = 1 at `to`, in the cell's coordinates
 * [0, 1]. */
typedef struct iso_ray_segment {
    double corner[8]; /* values minus isovalue (rounding does not change the sign of a difference) */
    double from[3], to[3];
} iso_ray_segment;

/* A ray and the position that tracing has reached. The members are the tracer's. */
typedef struct iso_ray {
    iso_vec3 along;                             /* direction in world space */
    double origin[3], direction[3], inverse[3]; /* in index coordinates */
    int cell[3];                                /* the next cell */
    double t;                                   /* parameter where the ray enters it */
    double local[3];                            /* position there in the cell's coordinates, [0, 1] */
    bool done;                                  /* there is no next cell */
    /* The cell whose crossings are being returned: the field along the ray is a cubic, monotone between the
     * parameters split[0 .. pieces]; `piece` is the next interval. */
    iso_ray_segment segment;
    double cubic[4], split[10], enter, leave; /* t where the ray enters and leaves the cell */
    int current[3], piece, pieces;
    bool state; /* the field is at or above the isovalue where `piece` begins */
    /* Of splines: `split` has the crossings themselves; `chained`: the cell before was crossed, too, so that
     * `state` is that of its end. */
    bool chained;
} iso_ray;

typedef struct iso_ray_hit {
    double t;        /* parameter of the ray */
    int cell[3];     /* the cell, by its first voxel */
    double local[3]; /* position in it, [0, 1] */
    bool falls;      /* along the ray the field falls below the isovalue; else it rises */
} iso_ray_hit;

/* Starts a ray origin + t * direction (world space, mm) at t = t0, or where it enters the volume; false: it
 * misses the volume, and must not be traced. */
bool iso_ray_start(const iso_ray_tracer *tracer, iso_vec3 origin, iso_vec3 direction, double t0,
                   iso_ray *ray);

/* Finds the next crossing; false: there are no more. */
bool iso_ray_next(const iso_ray_tracer *tracer, iso_ray *ray, iso_ray_hit *hit);

/* Whether the field is at or above the isovalue where a ray begins: right after iso_ray_start. False in a
 * cell with a NaN or infinite corner. */
bool iso_ray_starts_above(const iso_ray_tracer *tracer, const iso_ray *ray);

/* The parameter at which a ray that iso_ray_start has started leaves the volume. */
double iso_ray_end(const iso_ray_tracer *tracer, const iso_ray *ray);

/* The unit normal at a hit of the ray, in world space, pointing out of the solid: from the trilinear
 * interpolation of the gradients at the cell's corners (iso_grid_voxel_gradient); of a spline, from its
 * gradient or, of scans, that of the smoothed one (iso_spline_has_smoothed_normals). Where that vanishes, the
 * direction back along the ray. */
iso_vec3 iso_ray_hit_normal(const iso_ray_tracer *tracer, const iso_ray *ray, const iso_ray_hit *hit);

#endif
