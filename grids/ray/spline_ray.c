/* spline_ray: along a line a tricubic field is a polynomial of degree nine. Its Bernstein coefficients
 * are computed from those of the cell by the products of its three cubics (all numbers added have the
 * signs of their coefficients, so nothing cancels), and its roots are isolated by halving while the
 * coefficients change sign more than once: Lane and Riesenfeld 1981, "Bounds on a polynomial". */
#include "grids/ray/spline_ray.h"

#include <math.h>
#include <string.h>

enum { DEGREE = 9, TERMS = DEGREE + 1 };

/* Four B-spline coefficients, `step` apart, to Bernstein coefficients. */
static void to_bernstein(double *c, int step) {
    const double c0 = c[0], c1 = c[step], c2 = c[2 * step], c3 = c[3 * step];
    c[0] = (c0 + 4 * c1 + c2) / 6;
    c[step] = (4 * c1 + 2 * c2) / 6;
    c[2 * step] = (2 * c1 + 4 * c2) / 6;
    c[3 * step] = (c1 + 4 * c2 + c3) / 6;
}

bool iso_spline_bernstein(double c[ISO_SPLINE_COEFFICIENTS], double isovalue) {
    for (int i = 0; i < ISO_SPLINE_COEFFICIENTS; i++) c[i] -= isovalue;
    for (int i = 0; i < 16; i++) to_bernstein(c + 4 * i, 1);
    for (int i = 0; i < 16; i++) to_bernstein(c + (i / 4 * 16 + i % 4), 4);
    for (int i = 0; i < 16; i++) to_bernstein(c + i, 16);
    double lo = INFINITY, hi = -INFINITY;
    for (int i = 0; i < ISO_SPLINE_COEFFICIENTS; i++) {
        lo = c[i] < lo ? c[i] : lo;
        hi = c[i] > hi ? c[i] : hi;
    }
    /* two cells at a face agree on its side */
    const double slack = 1e-12 * (fmax(fabs(lo), fabs(hi)) + fabs(isovalue));
    return lo <= slack && hi >= -slack;
}

/* The cubic Bernstein polynomials of an axis, as polynomials along the line: the blossom of each.
 * power[i][k]: of polynomial i the coefficient of s^k (1 - s)^(3 - k). */
static void along(double from, double to, double power[4][4]) {
    static const double choose[4] = {1, 3, 3, 1};
    for (int k = 0; k < 4; k++) {
        double w[4] = {1, 0, 0, 0};
        for (int j = 0; j < 3; j++) {
            const double a = j < 3 - k ? from : to;
            for (int i = 3; i > 0; i--) w[i] = w[i] * (1 - a) + w[i - 1] * a;
            w[0] *= 1 - a;
        }
        for (int i = 0; i < 4; i++) power[i][k] = w[i] * choose[k];
    }
}

/* Adds the product of two polynomials; `by` has degree 3. */
static void add_product(const double *a, int degree, const double by[4], double *sum) {
    for (int i = 0; i <= degree; i++)
        for (int k = 0; k < 4; k++) sum[i + k] += a[i] * by[k];
}

static void along_line(const double b[ISO_SPLINE_COEFFICIENTS], const double from[3], const double to[3],
                       double p[TERMS]) {
    static const double choose[TERMS] = {1, 9, 36, 84, 126, 126, 84, 36, 9, 1};
    double x[4][4], y[4][4], z[4][4];
    along(from[0], to[0], x);
    along(from[1], to[1], y);
    along(from[2], to[2], z);
    memset(p, 0, TERMS * sizeof *p);
    for (int k = 0; k < 4; k++) {
        double slice[7] = {0};
        for (int j = 0; j < 4; j++) {
            double row[4] = {0};
            for (int i = 0; i < 4; i++)
                for (int s = 0; s < 4; s++) row[s] += b[(k * 4 + j) * 4 + i] * x[i][s];
            add_product(row, 3, y[j], slice);
        }
        add_product(slice, 6, z[k], p);
    }
    for (int i = 0; i < TERMS; i++) p[i] /= choose[i];
}

/* Splits the polynomial at s by de Casteljau's algorithm: `p` becomes the lower part. */
static void split(double p[TERMS], double s, double upper[TERMS]) {
    for (int level = 0; level < TERMS; level++) {
        upper[DEGREE - level] = p[DEGREE];
        for (int i = DEGREE; i > level; i--) p[i] = p[i - 1] * (1 - s) + p[i] * s;
    }
}

static double value(const double p[TERMS], double s, double *slope) {
    double q[TERMS];
    memcpy(q, p, sizeof q);
    for (int level = 0; level < DEGREE - 1; level++)
        for (int i = 0; i < DEGREE - level; i++) q[i] = q[i] * (1 - s) + q[i + 1] * s;
    *slope = DEGREE * (q[1] - q[0]);
    return q[0] * (1 - s) + q[1] * s;
}

/* The only root in [0, 1], by Newton's method within a bracket. */
static double only_root(const double p[TERMS]) {
    double lo = 0, hi = 1, s = 0.5;
    const bool low = p[0] >= 0;
    for (int step = 0; step < 100 && hi - lo > 1e-13; step++) {
        double slope;
        const double at = value(p, s, &slope);
        if ((at >= 0) == low)
            lo = s;
        else
            hi = s;
        const double next = s - at / slope;
        const bool fits = next >= lo && next <= hi;
        if (fits && fabs(next - s) < 1e-13) return next;
        s = fits && step % 4 != 3 ? next : 0.5 * (lo + hi);
    }
    return 0.5 * (lo + hi);
}

/* Adds the changes of state in [lo, hi], where the polynomial has the coefficients p. */
static void isolate(const double p[TERMS], double lo, double hi, iso_spline_crossings *to) {
    int changes = 0;
    for (int i = 1; i < TERMS; i++) changes += (p[i] >= 0) != (p[i - 1] >= 0);
    if (!changes || to->count == ISO_SPLINE_ROOTS) return;
    if (changes == 1 || hi - lo < 1e-9) {
        if ((p[0] >= 0) != (p[DEGREE] >= 0)) to->root[to->count++] = lo + (hi - lo) * only_root(p);
        return;
    }
    double lower[TERMS], upper[TERMS];
    memcpy(lower, p, sizeof lower);
    split(lower, 0.5, upper);
    isolate(lower, lo, 0.5 * (lo + hi), to);
    isolate(upper, 0.5 * (lo + hi), hi, to);
}

void iso_spline_cross(const double b[ISO_SPLINE_COEFFICIENTS], const double from[3], const double to[3],
                      iso_spline_crossings *crossings) {
    double p[TERMS];
    along_line(b, from, to, p);
    crossings->count = 0;
    crossings->first = p[0] >= 0;
    crossings->last = p[DEGREE] >= 0;
    isolate(p, 0, 1, crossings);
}

/* ---- the field of a spline */

static bool may_cross_brick(const iso_spline *spline, const int brick[3], double isovalue) {
    return iso_spline_may_cross(spline, brick, isovalue, NULL);
}

/* Whether the samples of the shell in a cell are outside. */
static bool outside_shell(const iso_hgrid *shell, const int cell[3]) {
    const int first[3] = {2 * cell[0], 2 * cell[1], 2 * cell[2]};
    int within[3];
    for (int i = 0; i < 3; i++) within[i] = first[i] % ISO_BRICK;
    if (within[0] < ISO_BRICK - 2 && within[1] < ISO_BRICK - 2 && within[2] < ISO_BRICK - 2) {
        const int32_t brick = shell->cell[iso_hgrid_cell_index(shell, first[0] / ISO_BRICK,
                                                               first[1] / ISO_BRICK, first[2] / ISO_BRICK)];
        if (brick < 0) return brick == ISO_CELL_OUTSIDE;
        const float *from =
            iso_hgrid_brick(shell, brick) + (within[2] * ISO_BRICK + within[1]) * ISO_BRICK + within[0];
        for (int row = 0; row < 9; row++) {
            const float *f = from + (row / 3 * ISO_BRICK + row % 3) * ISO_BRICK;
            if (!(f[0] >= 0 && f[1] >= 0 && f[2] >= 0)) return false;
        }
        return true;
    }
    for (int i = 0; i < 27; i++)
        if (!(iso_hgrid_at(shell, first[0] + i % 3, first[1] + i / 3 % 3, first[2] + i / 9) >= 0))
            return false;
    return true;
}

static bool cross(const iso_spline *spline, const iso_hgrid *shell, double isovalue, const int cell[3],
                  const double from[3], const double to[3], iso_spline_crossings *crossings) {
    double c[ISO_SPLINE_COEFFICIENTS];
    if (shell ? outside_shell(shell, cell) : !iso_spline_may_cross_cells(spline, cell, 1, isovalue))
        return false;
    if (!iso_spline_cell(spline, cell, false, c) || !iso_spline_bernstein(c, isovalue)) return false;
    iso_spline_cross(c, from, to, crossings);
    return true;
}

static bool is_above(const iso_spline *spline, double isovalue, const int cell[3], const double local[3]) {
    double c[ISO_SPLINE_COEFFICIENTS], gradient[3];
    return iso_spline_cell(spline, cell, false, c) && iso_spline_value(c, local, gradient) >= isovalue;
}

static iso_vec3 gradient_at(const iso_spline *spline, const int cell[3], const double local[3]) {
    double c[ISO_SPLINE_COEFFICIENTS], gradient[3] = {0, 0, 0};
    if (iso_spline_cell(spline, cell, iso_spline_has_smoothed_normals(spline), c))
        iso_spline_value(c, local, gradient);
    return (iso_vec3){gradient[0], gradient[1], gradient[2]};
}

iso_status iso_ray_tracer_create_spline(const iso_spline *spline, double isovalue, const iso_hgrid *shell,
                                        iso_pool *pool, iso_ray_tracer **tracer, iso_error *error) {
    static const iso_ray_field field = {may_cross_brick, iso_spline_may_cross_cells, cross, is_above,
                                        gradient_at};
    return iso_ray_tracer_create_field(iso_spline_grid(spline), &field, spline, isovalue, shell, pool, tracer,
                                       error);
}
