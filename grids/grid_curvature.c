/* grid_curvature: gradient and second derivatives by a cubic B-spline, and the curvature from them. */
#include "grids/grid_curvature.h"

enum { TAPS = 4 };

/* The weights of four voxels in a row for the value, its first and its second derivative; `part`: how far the
 * position is behind the second voxel, 0 .. 1. */
static void set_weights(double part, double weights[3][TAPS]) {
    const double t = part, s = 1 - t;
    const double value[TAPS] = {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6,
                                (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6};
    const double first[TAPS] = {-s * s / 2, (-4 * t + 3 * t * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2};
    const double second[TAPS] = {s, -2 + 3 * t, -2 + 3 * s, t};
    for (int i = 0; i < TAPS; i++) {
        weights[0][i] = value[i];
        weights[1][i] = first[i];
        weights[2][i] = second[i];
    }
}

/* Beyond the border values go on as a line through the two outermost voxels: the weights of voxels that
 * are not there go to these. first: the place of the first of four voxels; last: of the grid's last voxel. */
static void fold_weights(int first, int last, double weights[3][TAPS]) {
    for (int order = 0; order < 3 && last > 0; order++) {
        double *w = weights[order];
        if (first < 0) {
            w[1] += 2 * w[0];
            w[2] -= w[0];
            w[0] = 0;
        }
        if (first + 3 > last) {
            w[2] += 2 * w[3];
            w[1] -= w[3];
            w[3] = 0;
        }
    }
}

/* Derivatives in index coordinates. */
typedef struct derivatives {
    double g[3], h[3][3];
} derivatives;

/* Sums of a row of voxels along x: value, first and second derivative. */
static void sum_row(const iso_grid *grid, const int first[3], const double weights[3][TAPS], int j, int k,
                    double sums[3]) {
    sums[0] = sums[1] = sums[2] = 0;
    for (int i = 0; i < TAPS; i++) {
        const double value = (double)iso_grid_at(grid, first[0] + i, first[1] + j, first[2] + k);
        for (int order = 0; order < 3; order++) sums[order] += weights[order][i] * value;
    }
}

static derivatives find_derivatives(const iso_grid *grid, iso_vec3 index) {
    const double p[3] = {index.x, index.y, index.z};
    double w[3][3][TAPS]; /* by axis and order */
    int first[3];
    derivatives d = {{0}, {{0}}};
    for (int axis = 0; axis < 3; axis++) {
        const double last = iso_grid_dims(grid)[axis] - 1, at = p[axis] < 0      ? 0
                                                                : p[axis] > last ? last
                                                                                 : p[axis];
        const double cell = at < last ? floor(at) : fmax(last - 1, 0);
        first[axis] = (int)cell - 1;
        set_weights(at - cell, w[axis]);
        fold_weights(first[axis], (int)last, w[axis]);
    }
    for (int k = 0; k < TAPS; k++)
        for (int j = 0; j < TAPS; j++) {
            double row[3];
            sum_row(grid, first, w[0], j, k, row);
            const double(*y)[TAPS] = w[1], (*z)[TAPS] = w[2];
            d.g[0] += row[1] * y[0][j] * z[0][k];
            d.g[1] += row[0] * y[1][j] * z[0][k];
            d.g[2] += row[0] * y[0][j] * z[1][k];
            d.h[0][0] += row[2] * y[0][j] * z[0][k];
            d.h[1][1] += row[0] * y[2][j] * z[0][k];
            d.h[2][2] += row[0] * y[0][j] * z[2][k];
            d.h[0][1] += row[1] * y[1][j] * z[0][k];
            d.h[0][2] += row[1] * y[0][j] * z[1][k];
            d.h[1][2] += row[0] * y[1][j] * z[1][k];
        }
    d.h[1][0] = d.h[0][1];
    d.h[2][0] = d.h[0][2];
    d.h[2][1] = d.h[1][2];
    return d;
}

/* The derivatives in the world: inverse^T g, inverse^T h inverse. */
static derivatives to_world(const derivatives *d, const double m[9]) {
    derivatives world = {{0}, {{0}}};
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++) {
            world.g[a] += m[3 * i + a] * d->g[i];
            for (int b = 0; b < 3; b++)
                for (int j = 0; j < 3; j++) world.h[a][b] += m[3 * i + a] * d->h[i][j] * m[3 * j + b];
        }
    return world;
}

double iso_grid_mean_curvature(const iso_grid *grid, const iso_affine *affine, iso_vec3 index) {
    const derivatives local = find_derivatives(grid, index), d = to_world(&local, affine->inverse);
    double square = 0, along = 0, trace = 0;
    for (int a = 0; a < 3; a++) {
        square += d.g[a] * d.g[a];
        trace += d.h[a][a];
        for (int b = 0; b < 3; b++) along += d.g[a] * d.h[a][b] * d.g[b];
    }
    if (!(square > 0)) return NAN;
    const double curvature = (trace - along / square) / sqrt(square) / 2;
    return iso_grid_is_level_set(grid) ? curvature : -curvature;
}
