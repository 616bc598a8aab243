/* spline_ray: where a straight line crosses the isosurface of a spline in one cell. Internal to grids/ray. */
#ifndef ISO_GRIDS_RAY_SPLINE_RAY_H
#define ISO_GRIDS_RAY_SPLINE_RAY_H

#include <stdbool.h>

#include "grids/ray/ray_tracer.h"

enum { ISO_SPLINE_ROOTS = 9 };

/* The line in a cell, from s = 0 at `from` to s = 1 at `to`, in the cell's coordinates [0, 1]. */
typedef struct iso_spline_crossings {
    double root[ISO_SPLINE_ROOTS]; /* the s of the changes of state, in ascending order */
    int count;
    bool first, last; /* whether the field is at or above the isovalue at s = 0 and at s = 1 */
} iso_spline_crossings;

/* Turns the coefficients of a cell, minus the isovalue, into those of Bernstein polynomials, in place. False:
 * all are on one side of 0, and so is the field in the cell. */
bool iso_spline_bernstein(double c[ISO_SPLINE_COEFFICIENTS], double isovalue);

/* Finds the crossings, from the coefficients that iso_spline_bernstein made. A pair of crossings that are
 * nearer to each other than 1e-9 of the line may be missed. */
void iso_spline_cross(const double b[ISO_SPLINE_COEFFICIENTS], const double from[3], const double to[3],
                      iso_spline_crossings *crossings);

/* What a ray tracer asks a field that is not trilinear: functions, so that ray_tracer.c can be linked without
 * them (pages draw trilinear surfaces only). */
typedef struct iso_ray_field {
    bool (*may_cross_brick)(const iso_spline *spline, const int brick[3], double isovalue);
    bool (*may_cross_cells)(const iso_spline *spline, const int cell[3], int side, double isovalue);
    /* The crossings in a cell; false: the surface does not cross it, or it is empty. shell: or NULL. */
    bool (*cross)(const iso_spline *spline, const iso_hgrid *shell, double isovalue, const int cell[3],
                  const double from[3], const double to[3], iso_spline_crossings *crossings);
    bool (*is_above)(const iso_spline *spline, double isovalue, const int cell[3], const double local[3]);
    iso_vec3 (*gradient)(const iso_spline *spline, const int cell[3], const double local[3]);
} iso_ray_field;

/* As iso_ray_tracer_create, of a spline's field. */
iso_status iso_ray_tracer_create_field(const iso_grid *grid, const iso_ray_field *field,
                                       const iso_spline *spline, double isovalue, const iso_hgrid *shell,
                                       iso_pool *pool, iso_ray_tracer **tracer, iso_error *error);

#endif
