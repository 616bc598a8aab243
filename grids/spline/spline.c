/* spline: coefficients, values, and what is known of bricks. */
#include "grids/spline/spline.h"

#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "grids/brick_range.h"
#include "grids/spline/spline_kernel.h"

/* The range of the voxels, or kept coefficients, of a brick. */
typedef struct spline_range {
    float lo, hi; /* of the finite ones; lo > hi: there are none */
    bool finite;
} spline_range;

struct iso_spline {
    iso_grid grid;
    iso_rgrid *coefficients; /* INTERPOLATING; NULL: they are computed cell by cell */
    int bricks[3];
    spline_range *range; /* by brick: of its own voxels only */
    iso_spline_sample_fn *sample;
};

/* A sample is a sum of voxels whose weights along an axis have absolute values that sum to 352 / 288 = 11 / 9
 * at most, and in space to its cube w. It lies outside the voxels' range by up to (w - 1) / 2 of it. */
#define BEYOND (0.5 * (11 * 11 * 11 / (9.0 * 9 * 9) - 1))

static const iso_grid *source_of(const iso_spline *spline, iso_grid *kept) {
    *kept = (iso_grid){spline->coefficients, NULL};
    return spline->coefficients ? kept : &spline->grid;
}

const iso_grid *iso_spline_grid(const iso_spline *spline) {
    return &spline->grid;
}

bool iso_spline_has_smoothed_normals(const iso_spline *spline) {
    return spline->grid.rgrid && spline->grid.rgrid->type != ISO_FLOAT32;
}

/* ---- voxels */

static int mirrored(int i, int n) {
    const int period = 2 * (n - 1);
    if (i >= 0 && i < n) return i;
    if (n == 1) return 0;
    i = (i < 0 ? -i : i) % period;
    return i < n ? i : period - i;
}

/* Rows of voxels that are all inside the volume. */
#define READ_ROWS(type)                                                                                      \
    do {                                                                                                     \
        const type *row =                                                                                    \
            (const type *)grid->data + lo[0] + lo[1] * grid->stride_y + lo[2] * grid->stride_z;              \
        for (int z = 0; z < n[2]; z++, row += grid->stride_z - n[1] * grid->stride_y)                        \
            for (int y = 0; y < n[1]; y++, row += grid->stride_y, to += n[0])                                \
                for (int x = 0; x < n[0]; x++) to[x] = (float)row[x];                                        \
    } while (0)

static void read_rows(const iso_rgrid *grid, const int lo[3], const int n[3], float *to) {
    switch (grid->type) {
    case ISO_UINT8:
        READ_ROWS(uint8_t);
        break;
    case ISO_INT16:
        READ_ROWS(int16_t);
        break;
    case ISO_UINT16:
        READ_ROWS(uint16_t);
        break;
    default:
        READ_ROWS(float);
    }
}

#define READ_ROW(type)                                                                                       \
    for (int x = 0; x < n; x++) to[x] = (float)((const type *)grid->data)[row + at[x]]

static void read_row(const iso_rgrid *grid, ptrdiff_t row, const int *at, int n, float *to) {
    switch (grid->type) {
    case ISO_UINT8:
        READ_ROW(uint8_t);
        break;
    case ISO_INT16:
        READ_ROW(int16_t);
        break;
    case ISO_UINT16:
        READ_ROW(uint16_t);
        break;
    default:
        READ_ROW(float);
    }
}

void iso_spline_read(const iso_grid *grid, const int lo[3], const int n[3], float *to) {
    enum { MOST = 64 };
    const int *dims = iso_grid_dims(grid);
    int at[MOST];
    bool inside = grid->rgrid != NULL;
    for (int i = 0; i < 3; i++) inside &= lo[i] >= 0 && lo[i] + n[i] <= dims[i];
    if (inside) {
        read_rows(grid->rgrid, lo, n, to);
        return;
    }
    for (int x = 0; x < n[0]; x++) at[x] = mirrored(lo[0] + x, dims[0]);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++, to += n[0]) {
            const int row[2] = {mirrored(lo[1] + y, dims[1]), mirrored(lo[2] + z, dims[2])};
            if (grid->rgrid)
                read_row(grid->rgrid, row[0] * grid->rgrid->stride_y + row[1] * grid->rgrid->stride_z, at,
                         n[0], to);
            else
                for (int x = 0; x < n[0]; x++) to[x] = iso_hgrid_at(grid->hgrid, at[x], row[0], row[1]);
        }
}

/* ---- coefficients that are kept */

/* The coefficients of a line of values in place: Unser, Aldroubi and Eden 1993, "B-spline signal processing",
 * with mirrored borders. */
static void interpolate_line(double *line, int n) {
    const double pole = sqrt(3) - 2;
    if (n < 2) return;
    double sum = 0, power = 1; /* of the mirrored line, whose period is 2 n - 2; beyond 60 it is < 1e-34 */
    for (int i = 0; i < 60; i++, power *= pole) sum += power * line[mirrored(i, n)];
    line[0] = sum;
    for (int i = 1; i < n; i++) line[i] += pole * line[i - 1];
    line[n - 1] = pole / (pole * pole - 1) * (line[n - 1] + pole * line[n - 2]);
    for (int i = n - 2; i >= 0; i--) line[i] = pole * (line[i + 1] - line[i]);
    for (int i = 0; i < n; i++) line[i] *= 6;
}

typedef struct interpolating {
    iso_rgrid *grid;
    int axis;
    double *lines; /* of each worker */
} interpolating;

static void interpolate_slice(void *context, size_t index, int worker) {
    const interpolating *all = context;
    const iso_rgrid *grid = all->grid;
    const ptrdiff_t strides[3] = {1, grid->stride_y, grid->stride_z};
    const int axis = all->axis, across = axis == 0 ? 1 : 0, slices = axis == 2 ? 1 : 2;
    const int n = grid->dims[axis];
    double *line = all->lines + (size_t)worker * (size_t)n;
    float *from = (float *)grid->data + (ptrdiff_t)index * strides[slices];
    for (int i = 0; i < grid->dims[across]; i++, from += strides[across]) {
        for (int k = 0; k < n; k++) line[k] = from[k * strides[axis]];
        interpolate_line(line, n);
        for (int k = 0; k < n; k++) from[k * strides[axis]] = (float)line[k];
    }
}

static iso_status keep_coefficients(iso_spline *spline, iso_pool *pool, iso_error *error) {
    const int *dims = iso_grid_dims(&spline->grid);
    if (iso_grid_count_nonfinite(&spline->grid, pool))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "the interpolating spline needs finite voxels, and some are not; the cubic one leaves "
            "out the cells around them");
    iso_rgrid_desc desc = {.dims = {dims[0], dims[1], dims[2]}, .type = ISO_FLOAT32};
    ISO_TRY(iso_rgrid_create(&desc, &spline->coefficients, error));
    iso_rgrid *to = spline->coefficients;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x += 64) {
                const int lo[3] = {x, y, z}, n[3] = {dims[0] - x < 64 ? dims[0] - x : 64, 1, 1};
                iso_spline_read(&spline->grid, lo, n,
                                (float *)to->data + x + y * to->stride_y + z * to->stride_z);
            }
    interpolating all = {.grid = to};
    for (int axis = 0; axis < 3; axis++) {
        all.axis = axis;
        all.lines = iso_alloc_zero((size_t)iso_pool_threads(pool) * (size_t)dims[axis], sizeof *all.lines);
        if (!all.lines) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a spline's coefficients");
        iso_parallel_until(pool, (size_t)dims[axis == 2 ? 1 : 2], interpolate_slice, &all);
        iso_free(all.lines);
    }
    return iso_pool_check(pool, "the spline's coefficients", error);
}

/* ---- ranges */

static void find_range(void *context, size_t index, int worker) {
    (void)worker;
    iso_spline *spline = context;
    iso_grid kept;
    const iso_grid *grid = source_of(spline, &kept);
    const int *dims = iso_grid_dims(grid), nx = spline->bricks[0], ny = spline->bricks[1];
    float values[ISO_BRICK_VOXELS];
    for (int x = 0; x < nx; x++) {
        const int lo[3] = {x * ISO_BRICK, (int)(index % (size_t)ny) * ISO_BRICK,
                           (int)(index / (size_t)ny) * ISO_BRICK};
        int n[3], count = 1;
        for (int i = 0; i < 3; i++) {
            n[i] = dims[i] - lo[i] < ISO_BRICK ? dims[i] - lo[i] : ISO_BRICK;
            count *= n[i];
        }
        spline_range range = {INFINITY, -INFINITY, true};
        iso_spline_read(grid, lo, n, values);
        for (int i = 0; i < count; i++) {
            const bool finite = isfinite(values[i]);
            range.finite &= finite;
            range.lo = finite && values[i] < range.lo ? values[i] : range.lo;
            range.hi = finite && values[i] > range.hi ? values[i] : range.hi;
        }
        spline->range[index * (size_t)nx + (size_t)x] = range;
    }
}

iso_status iso_spline_create(const iso_grid *grid, iso_filter filter, iso_pool *pool, iso_spline **out,
                             iso_error *error) {
    if (filter != ISO_FILTER_CUBIC && filter != ISO_FILTER_INTERPOLATING)
        return iso_fail(error, ISO_ERR_USAGE, "the filter of a spline is cubic or interpolating");
    iso_spline *spline = iso_alloc_zero(1, sizeof *spline);
    if (!spline) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a spline");
    spline->grid = *grid;
    spline->sample = ISO_KERNEL_UNIT(iso_spline_sample_units, iso_cpu_best());
    iso_grid_bricks(grid, spline->bricks);
    const size_t rows = (size_t)spline->bricks[1] * (size_t)spline->bricks[2];
    spline->range = iso_alloc_zero(rows * (size_t)spline->bricks[0], sizeof *spline->range);
    iso_status status = spline->range ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for a spline");
    if (status == ISO_OK && filter == ISO_FILTER_INTERPOLATING)
        status = keep_coefficients(spline, pool, error);
    if (status == ISO_OK) {
        iso_parallel_until(pool, rows, find_range, spline);
        status = iso_pool_check(pool, "the spline's index", error);
    }
    if (status == ISO_OK)
        *out = spline;
    else
        iso_spline_destroy(spline);
    return status;
}

void iso_spline_destroy(iso_spline *spline) {
    if (!spline) return;
    iso_rgrid_destroy(spline->coefficients);
    iso_free(spline->range);
    iso_free(spline);
}

/* Whether a spline may have an isovalue where its voxels, or kept coefficients, have this range. */
static bool may_reach(const iso_spline *spline, double lo, double hi, double isovalue) {
    const double beyond = spline->coefficients ? 0 : BEYOND * (hi - lo), slack = 1e-5 * (fabs(lo) + fabs(hi));
    return lo - beyond - slack <= isovalue && hi + beyond + slack >= isovalue;
}

bool iso_spline_may_cross(const iso_spline *spline, const int brick[3], double isovalue, bool *side) {
    double lo = INFINITY, hi = -INFINITY;
    bool finite = true;
    for (int z = brick[2] - 1; z <= brick[2] + 1; z++)
        for (int y = brick[1] - 1; y <= brick[1] + 1; y++)
            for (int x = brick[0] - 1; x <= brick[0] + 1; x++) {
                if (x < 0 || y < 0 || z < 0 || x >= spline->bricks[0] || y >= spline->bricks[1] ||
                    z >= spline->bricks[2])
                    continue;
                const spline_range *range =
                    &spline->range[((size_t)z * (size_t)spline->bricks[1] + (size_t)y) *
                                       (size_t)spline->bricks[0] +
                                   (size_t)x];
                lo = fmin(lo, range->lo);
                hi = fmax(hi, range->hi);
                finite &= range->finite;
            }
    if (side) *side = finite && lo >= isovalue;
    return !finite || may_reach(spline, lo, hi, isovalue);
}

bool iso_spline_may_cross_cells(const iso_spline *spline, const int cell[3], int side, double isovalue) {
    enum { MOST = ISO_BRICK + 5 };
    const int edge = side + 5, n[3] = {edge, edge, edge}, lo[3] = {cell[0] - 2, cell[1] - 2, cell[2] - 2};
    float values[MOST * MOST * MOST], least = INFINITY, most = -INFINITY;
    iso_grid kept;
    iso_spline_read(source_of(spline, &kept), lo, n, values);
    for (int i = 0; i < edge * edge * edge; i++) { /* NaN: the comparisons are false */
        least = values[i] < least ? values[i] : least;
        most = values[i] > most ? values[i] : most;
    }
    return may_reach(spline, least, most, isovalue);
}

/* ---- one cell */

bool iso_spline_cell_values(const iso_spline *spline, const int cell[3], float values[ISO_SPLINE_VOXELS],
                            float smoothed[ISO_SPLINE_COEFFICIENTS]) {
    const int before = spline->coefficients ? 1 : 2, edge = spline->coefficients ? ISO_SPLINE_TAPS : 6;
    const int lo[3] = {cell[0] - before, cell[1] - before, cell[2] - before}, n[3] = {edge, edge, edge};
    iso_grid kept;
    iso_spline_read(source_of(spline, &kept), lo, n, values);
    if (smoothed && spline->coefficients) {
        const int first[3] = {cell[0] - 1, cell[1] - 1, cell[2] - 1};
        iso_spline_read(&spline->grid, first, n, smoothed);
    } else if (smoothed) {
        for (int i = 0; i < ISO_SPLINE_COEFFICIENTS; i++)
            smoothed[i] = values[((i >> 4) + 1) * 36 + ((i >> 2 & 3) + 1) * 6 + (i & 3) + 1];
    }
    return !spline->coefficients;
}

/* Filters 6 items, `step` apart, to 4. */
static void prefilter(const double *in, double *out, int step) {
    for (int i = 0; i < ISO_SPLINE_TAPS; i++)
        out[i * step] = (8 * in[(i + 1) * step] - (in[i * step] + in[(i + 2) * step])) / 6;
}

bool iso_spline_cell(const iso_spline *spline, const int cell[3], bool smoothed,
                     double c[ISO_SPLINE_COEFFICIENTS]) {
    enum { W = 6 };
    const bool plain = smoothed || spline->coefficients;
    const int edge = plain ? ISO_SPLINE_TAPS : W, before = plain ? 1 : 2;
    const int lo[3] = {cell[0] - before, cell[1] - before, cell[2] - before}, n[3] = {edge, edge, edge};
    float read[W * W * W];
    double v[W * W * W];
    iso_grid kept;
    iso_spline_read(smoothed ? &spline->grid : source_of(spline, &kept), lo, n, read);
    for (int i = 0; i < edge * edge * edge; i++) {
        if (!isfinite(read[i])) return false;
        v[i] = read[i];
    }
    if (plain) {
        memcpy(c, v, ISO_SPLINE_COEFFICIENTS * sizeof *c);
        return true;
    }
    for (int i = 0; i < W * W; i++)
        prefilter(v + i, v + i, W * W); /* in place: what is read is not yet set */
    for (int z = 0; z < ISO_SPLINE_TAPS; z++)
        for (int x = 0; x < W; x++) prefilter(v + z * W * W + x, v + z * W * W + x, W);
    for (int z = 0; z < ISO_SPLINE_TAPS; z++)
        for (int y = 0; y < ISO_SPLINE_TAPS; y++)
            prefilter(v + (z * W + y) * W, c + (z * ISO_SPLINE_TAPS + y) * ISO_SPLINE_TAPS, 1);
    return true;
}

/* The weights of a B-spline's four coefficients, and of its derivative. */
static void weigh(double u, double w[4], double d[4]) {
    const double m = 1 - u;
    w[0] = m * m * m / 6;
    w[1] = (4 - 6 * u * u + 3 * u * u * u) / 6;
    w[2] = (4 - 6 * m * m + 3 * m * m * m) / 6;
    w[3] = u * u * u / 6;
    d[0] = -m * m / 2;
    d[1] = (3 * u - 4) * u / 2;
    d[2] = -(3 * m - 4) * m / 2;
    d[3] = u * u / 2;
}

double iso_spline_value(const double c[ISO_SPLINE_COEFFICIENTS], const double local[3], double gradient[3]) {
    double w[3][4], d[3][4], value = 0;
    gradient[0] = gradient[1] = gradient[2] = 0;
    for (int i = 0; i < 3; i++) weigh(local[i], w[i], d[i]);
    for (int i = 0; i < ISO_SPLINE_COEFFICIENTS; i++) {
        const int x = i & 3, y = i >> 2 & 3, z = i >> 4;
        value += c[i] * w[0][x] * w[1][y] * w[2][z];
        gradient[0] += c[i] * d[0][x] * w[1][y] * w[2][z];
        gradient[1] += c[i] * w[0][x] * d[1][y] * w[2][z];
        gradient[2] += c[i] * w[0][x] * w[1][y] * d[2][z];
    }
    return value;
}

/* The cell of a position, and the position in it. */
static void locate(const iso_spline *spline, const double p[3], int cell[3], double local[3]) {
    const int *dims = iso_grid_dims(&spline->grid);
    for (int i = 0; i < 3; i++) {
        cell[i] = (int)fmin(fmax(floor(p[i]), 0), dims[i] > 1 ? dims[i] - 2 : 0);
        local[i] = p[i] - cell[i];
    }
}

iso_vec3 iso_spline_project(const iso_spline *spline, double isovalue, double p[3]) {
    double q[3] = {p[0], p[1], p[2]}, c[ISO_SPLINE_COEFFICIENTS], local[3], g[3] = {0, 0, 0}, moved = 0;
    int cell[3];
    for (int step = 0; step < 10; step++) {
        locate(spline, q, cell, local);
        if (!iso_spline_cell(spline, cell, false, c)) break;
        const double off = iso_spline_value(c, local, g) - isovalue,
                     square = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        if (!(square > 0)) break;
        moved = 0;
        for (int i = 0; i < 3; i++) {
            q[i] -= off / square * g[i];
            moved += (q[i] - p[i]) * (q[i] - p[i]);
        }
        if (moved > 0.75 * 0.75) break;
        if (off * off < 1e-14 * square) {
            memcpy(p, q, sizeof q);
            break;
        }
    }
    locate(spline, p, cell, local);
    if (!iso_spline_cell(spline, cell, iso_spline_has_smoothed_normals(spline), c))
        return (iso_vec3){0, 0, 0};
    iso_spline_value(c, local, g);
    return (iso_vec3){g[0], g[1], g[2]};
}

/* ---- blocks */

void iso_spline_sample(const iso_spline *spline, const int block[3], iso_spline_samples samples) {
    static const iso_spline_weights from_voxels = {
        {-1 / 36.f, 4 / 36.f, 30 / 36.f, 4 / 36.f, -1 / 36.f},
        {-1 / 288.f, -15 / 288.f, 160 / 288.f, 160 / 288.f, -15 / 288.f, -1 / 288.f}};
    static const iso_spline_weights from_coefficients = {{0, 1 / 6.f, 4 / 6.f, 1 / 6.f, 0},
                                                         {0, 1 / 48.f, 23 / 48.f, 23 / 48.f, 1 / 48.f, 0}};
    int lo[3];
    const int n[3] = {ISO_SPLINE_INPUT, ISO_SPLINE_INPUT, ISO_SPLINE_INPUT};
    float read[ISO_SPLINE_INPUT * ISO_SPLINE_INPUT * ISO_SPLINE_INPUT];
    iso_spline_input input;
    iso_grid kept;
    for (int i = 0; i < 3; i++) lo[i] = block[i] * ISO_SPLINE_BLOCK - 3;
    iso_spline_read(source_of(spline, &kept), lo, n, read);
    for (int row = 0; row < ISO_SPLINE_INPUT * ISO_SPLINE_INPUT; row++) {
        memcpy(input + row * ISO_SPLINE_ROW, read + row * ISO_SPLINE_INPUT, ISO_SPLINE_INPUT * sizeof *read);
        input[row * ISO_SPLINE_ROW + ISO_SPLINE_INPUT] = 0;
    }
    spline->sample(input, spline->coefficients ? &from_coefficients : &from_voxels, samples);
}
