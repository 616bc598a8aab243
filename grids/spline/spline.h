/* spline: the tricubic B-spline of a volume, a smooth field instead of the trilinear one.
 *
 * Its coefficients are the voxels filtered by (-1/6, 4/3, -1/6) along each axis (ISO_FILTER_CUBIC:
 * nothing is interpolated, but the error is of fourth order in the voxel size, the noise that of the
 * trilinear field, and a cell depends on 6^3 voxels only), or those with which the spline passes through
 * the voxels (ISO_FILTER_INTERPOLATING, for clean fields of simulations: they are computed for the whole
 * volume and kept as floats). Beyond the border the voxels are mirrored. A cell is empty if one of the
 * voxels that it depends on is not finite.
 *
 * Sources: Blu and Unser 1999, "Quantitative Fourier analysis of approximation techniques", for the
 * prefilter as a quasi-interpolant; Thevenaz and Unser 2003, "Precision isosurface rendering of 3-D image
 * data"; Csebfalvi 2008, "An evaluation of prefiltered reconstruction schemes for volume rendering". */
#ifndef ISO_GRIDS_SPLINE_SPLINE_H
#define ISO_GRIDS_SPLINE_SPLINE_H

#include "base/parallel.h"
#include "grids/grid.h"

typedef struct iso_spline iso_spline;

/* Creates the spline of a grid, which is borrowed until iso_spline_destroy. It does not follow edits. The
 * values of a spline are stored ones (grids/grid.h). `pool` may be NULL. ISO_ERR_USAGE: `filter` is
 * ISO_FILTER_LINEAR, or INTERPOLATING and a voxel is not finite; ISO_ERR_NOMEM; ISO_ERR_IO: the pool's watch
 * has cancelled. */
iso_status iso_spline_create(const iso_grid *grid, iso_filter filter, iso_pool *pool, iso_spline **spline,
                             iso_error *error);
void iso_spline_destroy(iso_spline *spline);

const iso_grid *iso_spline_grid(const iso_spline *spline);

/* Whether normals are those of the spline that has the voxels themselves as coefficients: of volumes of
 * integers, scans, whose noise the drawn spline's gradient amplifies twice as much. */
bool iso_spline_has_smoothed_normals(const iso_spline *spline);

/* Whether the surface at a stored isovalue may cross the cells of a brick. Never false if it does. `side`
 * (may be NULL): if it does not, whether the field is at or above the isovalue there. */
bool iso_spline_may_cross(const iso_spline *spline, const int brick[3], double isovalue, bool *side);

/* The same of the `side`^3 (up to 16) cells from a cell on, from their voxels: slower, and tighter. */
bool iso_spline_may_cross_cells(const iso_spline *spline, const int cell[3], int side, double isovalue);

/* Reads voxels lo .. lo + n - 1 of a grid as floats, x fastest; beyond the border they are mirrored. */
void iso_spline_read(const iso_grid *grid, const int lo[3], const int n[3], float *to);

/* The number of coefficients of a cell: [z][y][x], those of the voxels cell - 1 .. cell + 2. */
enum { ISO_SPLINE_TAPS = 4, ISO_SPLINE_COEFFICIENTS = 64 };

/* Computes the coefficients of a cell, of the drawn spline and, with `smoothed`, of the one whose
 * coefficients are the voxels. False: the cell is empty. */
bool iso_spline_cell(const iso_spline *spline, const int cell[3], bool smoothed,
                     double c[ISO_SPLINE_COEFFICIENTS]);

/* Reads what the coefficients of a cell are computed from: its 6^3 voxels (true), or the coefficients
 * (false). smoothed (may be NULL): the 4^3 voxels around it, the smoothed spline's coefficients. */
enum { ISO_SPLINE_VOXELS = 216 };
bool iso_spline_cell_values(const iso_spline *spline, const int cell[3], float values[ISO_SPLINE_VOXELS],
                            float smoothed[ISO_SPLINE_COEFFICIENTS]);

/* The value and gradient, in stored values per voxel, at `local` (0 .. 1) of a cell with these
 * coefficients. */
double iso_spline_value(const double c[ISO_SPLINE_COEFFICIENTS], const double local[3], double gradient[3]);

/* Moves a position (index coordinates) along the gradient onto the isosurface, by Newton's method.
 * Returns the gradient there (iso_spline_has_smoothed_normals), stored values per voxel. Where the method
 * does not arrive within 3/4 voxel, or the cell is empty, the position stays as it is; in an empty cell
 * the gradient is 0. */
iso_vec3 iso_spline_project(const iso_spline *spline, double isovalue, double p[3]);

/* The samples of the spline at half the voxel spacing around a block of 8^3 cells: 20^3 from 1 voxel before
 * the block's first voxel on, x fastest. */
enum { ISO_SPLINE_BLOCK = 8, ISO_SPLINE_SAMPLES = 20 };
typedef float iso_spline_samples[ISO_SPLINE_SAMPLES * ISO_SPLINE_SAMPLES * ISO_SPLINE_SAMPLES];
void iso_spline_sample(const iso_spline *spline, const int block[3], iso_spline_samples samples);

/* Makes a sparse grid of the spline's samples at half the voxel spacing, of the bricks near the surface: a
 * level set whose zero is the surface, and whose trilinear surface is within a quarter of the trilinear
 * surface's error of the spline's. Its values are stored ones minus the isovalue, negative inside, and not
 * distances. `shell`: values are lowered by bounds of that error, so that the trilinear surface encloses the
 * spline's: a ray that meets the spline's solid has met the shell before, or begins in it. ISO_ERR_LIMIT:
 * more than 1024 voxels along an axis; ISO_ERR_NOMEM; ISO_ERR_IO as above. */
iso_status iso_spline_refine(const iso_spline *spline, double isovalue, bool shell, iso_pool *pool,
                             iso_hgrid **refined, iso_error *error);

#endif
