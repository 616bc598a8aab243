/* cell_patch: minimises the distance over the trilinear surface in a cell. A step goes along the tangents
 * of the surface, those of a face where the surface has been followed to it, to where the second-order
 * model of the distance on the surface is least; the point is then moved back onto the surface. */
#include "grids/distance/cell_patch.h"

enum { MOST_STEPS = 24, MOST_HALVINGS = 8, MOST_CORRECTIONS = 10 };

/* Of a voxel's size: the search ends where a step makes the distance less by no more than the first, and
 * points that are nearer to the surface than the second are on it. */
static const double CONVERGED = 1e-7, ON_SURFACE = 1e-6;

/* A search is given up where the distance would not be below the limit even if a step made its square less by
 * more than its model says: by so much of it, times the step's length in voxels. */
static const double MODEL_ERROR = 2;

iso_cell_metric iso_cell_metric_make(const double m[9]) {
    iso_cell_metric metric;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            metric.m[3 * a + b] = 0;
            for (int k = 0; k < 3; k++) metric.m[3 * a + b] += m[3 * k + a] * m[3 * k + b];
        }
    metric.voxel = sqrt(fmax(metric.m[0], fmax(metric.m[4], metric.m[8])));
    return metric;
}

iso_cell_patch iso_cell_patch_make(const double corners[8]) {
    iso_cell_patch patch;
    for (int i = 0; i < 8; i++) patch.c[i] = corners[i];
    for (int axis = 1; axis < 8; axis *= 2)
        for (int i = 0; i < 8; i++)
            if (i & axis) patch.c[i] -= patch.c[i - axis];
    return patch;
}

/* The field with its gradient and its second derivatives xy, xz, yz; the others are 0. */
typedef struct local_field {
    double value, g[3], xy, xz, yz;
} local_field;

static inline local_field field_at(const iso_cell_patch *patch, const double u[3]) {
    const double *c = patch->c, x = u[0], y = u[1], z = u[2];
    local_field f;
    f.xy = c[3] + c[7] * z;
    f.xz = c[5] + c[7] * y;
    f.yz = c[6] + c[7] * x;
    f.g[0] = c[1] + c[3] * y + c[5] * z + c[7] * y * z;
    f.g[1] = c[2] + c[3] * x + c[6] * z + c[7] * x * z;
    f.g[2] = c[4] + c[5] * x + c[6] * y + c[7] * x * y;
    f.value = c[0] + c[1] * x + c[2] * y + c[4] * z + f.xy * x * y + c[5] * x * z + c[6] * y * z;
    return f;
}

/* metric * t */
static inline void lower(const iso_cell_metric *metric, const double t[3], double out[3]) {
    const double *m = metric->m;
    for (int a = 0; a < 3; a++) out[a] = m[3 * a] * t[0] + m[3 * a + 1] * t[1] + m[3 * a + 2] * t[2];
}

static inline double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double within(double x) {
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static inline double squared_distance(const iso_cell_metric *metric, const double p[3], const double u[3]) {
    const double way[3] = {p[0] - u[0], p[1] - u[1], p[2] - u[2]};
    double lowered[3];
    lower(metric, way, lowered);
    return dot(way, lowered);
}

/* Moves a position onto the surface along the gradient, within the cell. fixed: axes that stay. False: it
 * does not get there. */
static bool correct(const iso_cell_patch *patch, const bool fixed[3], double u[3]) {
    const double near = 0.01 * ON_SURFACE;
    for (int i = 0; i < MOST_CORRECTIONS; i++) {
        const local_field f = field_at(patch, u);
        double g[3], square = 0;
        for (int k = 0; k < 3; k++) {
            const double step = -f.value * f.g[k];
            const bool outward = (u[k] <= 0 && step < 0) || (u[k] >= 1 && step > 0);
            g[k] = fixed[k] || outward ? 0 : f.g[k];
            square += g[k] * g[k];
        }
        if (f.value * f.value <= near * near * dot(f.g, f.g)) return true;
        if (!(square > 0)) return false;
        for (int k = 0; k < 3; k++) u[k] = within(u[k] - f.value * g[k] / square);
    }
    const local_field f = field_at(patch, u);
    return fabs(f.value) <= ON_SURFACE * sqrt(dot(f.g, f.g));
}

/* Tangents of the surface along the axes that are free; returns their number, 0 to 2. */
static int find_tangents(const double g[3], const bool fixed[3], double t[2][3]) {
    int greatest = -1, count = 0;
    for (int k = 0; k < 3; k++)
        if (!fixed[k] && (greatest < 0 || fabs(g[k]) > fabs(g[greatest]))) greatest = k;
    if (greatest < 0 || !(fabs(g[greatest]) > 0)) return 0;
    for (int k = 0; k < 3; k++) {
        if (fixed[k] || k == greatest) continue;
        t[count][0] = t[count][1] = t[count][2] = 0;
        t[count][k] = 1;
        t[count++][greatest] = -g[k] / g[greatest];
    }
    return count;
}

static double second(const local_field *f, const double a[3], const double b[3]) {
    return f->xy * (a[0] * b[1] + a[1] * b[0]) + f->xz * (a[0] * b[2] + a[2] * b[0]) +
           f->yz * (a[1] * b[2] + a[2] * b[1]);
}

/* Solves the 1 or 2 equations w s = r; w is symmetric. False: w is not positive definite. */
static bool solve(int count, const double w[3], const double r[2], double s[2]) {
    const double determinant = count == 2 ? w[0] * w[2] - w[1] * w[1] : w[0];
    if (!(w[0] > 0) || !(determinant > 1e-12 * w[0] * (count == 2 ? w[2] : 1))) return false;
    s[0] = count == 2 ? (r[0] * w[2] - r[1] * w[1]) / determinant : r[0] / w[0];
    s[1] = count == 2 ? (r[1] * w[0] - r[0] * w[1]) / determinant : 0;
    return true;
}

/* The step along the surface to where the distance is least by the second-order model. False: the model has
 * no least value, since the surface is bent towards the point more than a ball around it; the step then goes
 * downhill and is as long as the cell. */
static bool find_step(const iso_cell_metric *metric, const local_field *f, const double pull[3],
                      const bool fixed[3], double step[3]) {
    double t[2][3], lowered[2][3], bent[3] = {0}, plain[3] = {0}, r[2] = {0}, s[2] = {0}, square = 0,
                                   along = 0;
    const int count = find_tangents(f->g, fixed, t);
    step[0] = step[1] = step[2] = 0;
    if (!count) return true;
    for (int k = 0; k < 3; k++)
        if (!fixed[k]) {
            square += f->g[k] * f->g[k];
            along += f->g[k] * pull[k];
        }
    const double weight = along / square; /* the Lagrange multiplier */
    for (int i = 0; i < count; i++) {
        lower(metric, t[i], lowered[i]);
        r[i] = dot(t[i], pull);
    }
    for (int i = 0, n = 0; i < count; i++)
        for (int j = i; j < count; j++, n++) {
            const int at = i + j;
            plain[at] = dot(t[i], lowered[j]);
            bent[at] = plain[at] + weight * second(f, t[i], t[j]);
        }
    const bool least = solve(count, bent, r, s);
    if (!least && !solve(count, plain, r, s)) return true;
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < count; i++) step[k] += s[i] * t[i][k];
        longest = fmax(longest, fabs(step[k]));
    }
    for (int k = 0; k < 3 && !least && longest > 0; k++) step[k] /= longest;
    return least;
}

/* The step of a position, which leaves no face of the cell: axes along which it would are fixed. Returns what
 * find_step does. */
static bool find_step_inside(const iso_cell_metric *metric, const local_field *f, const double u[3],
                             const double pull[3], bool fixed[3], double step[3]) {
    fixed[0] = fixed[1] = fixed[2] = false;
    for (int round = 0; round < 3; round++) {
        bool leaves = false;
        const bool least = find_step(metric, f, pull, fixed, step);
        for (int k = 0; k < 3; k++)
            if (!fixed[k] && ((u[k] <= 0 && step[k] < 0) || (u[k] >= 1 && step[k] > 0)))
                leaves = fixed[k] = true;
        if (!leaves) return least;
    }
    return find_step(metric, f, pull, fixed, step);
}

/* Goes `share` of a step, as far as the cell reaches, and back onto the surface. */
static bool go(const iso_cell_patch *patch, const double u[3], const double step[3], double share,
               const bool fixed[3], double to[3]) {
    int end = -1;
    for (int k = 0; k < 3; k++) {
        const double room = step[k] > 0 ? (1 - u[k]) / step[k] : step[k] < 0 ? -u[k] / step[k] : INFINITY;
        if (room < share) {
            share = room;
            end = k;
        }
    }
    for (int k = 0; k < 3; k++) to[k] = within(u[k] + share * step[k]);
    if (end < 0) return correct(patch, fixed, to);
    bool all[3] = {fixed[0], fixed[1], fixed[2]};
    to[end] = step[end] > 0 ? 1 : 0;
    all[end] = true; /* the surface is met in the face, if it can be */
    return correct(patch, all, to) || correct(patch, fixed, to);
}

double iso_cell_patch_nearest(const iso_cell_patch *patch, const iso_cell_metric *metric, const double p[3],
                              double limit, double at[3]) {
    static const bool none[3] = {false, false, false};
    const double little = CONVERGED * metric->voxel;
    for (int k = 0; k < 3; k++) at[k] = within(at[k]);
    if (!correct(patch, none, at)) return INFINITY;
    double best = squared_distance(metric, p, at);
    for (int i = 0; i < MOST_STEPS; i++) {
        const local_field f = field_at(patch, at);
        const double way[3] = {p[0] - at[0], p[1] - at[1], p[2] - at[2]};
        double pull[3], step[3], to[3];
        bool fixed[3], nearer = false;
        lower(metric, way, pull);
        const bool least = find_step_inside(metric, &f, at, pull, fixed, step);
        const double gain = dot(pull, step); /* by the model */
        if (!(gain > little * (2 * sqrt(best) + little))) break;
        const double length = fmax(fabs(step[0]), fmax(fabs(step[1]), fabs(step[2])));
        if (least && best - (1 + MODEL_ERROR * length) * gain >= limit * limit) return INFINITY;
        double share = 1, found = best;
        for (int k = 0; k < MOST_HALVINGS && !nearer; k++, share /= 2) {
            if (!go(patch, at, step, share, fixed, to)) continue;
            found = squared_distance(metric, p, to);
            nearer = found < best;
        }
        if (!nearer) break;
        best = found;
        for (int k = 0; k < 3; k++) at[k] = to[k];
    }
    return sqrt(best);
}

double iso_cell_patch_offset(const iso_cell_patch *patch, const iso_cell_metric *metric, const double at[3]) {
    const local_field f = field_at(patch, at);
    /* the gradient per mm is at least that per voxel over the largest spacing */
    const double slope = sqrt(dot(f.g, f.g));
    return slope > 0 ? fmin(fabs(f.value) / slope, 0.5) * metric->voxel : 0.5 * metric->voxel;
}
