/* quadric: weighted least squares by normal equations of six unknowns. */
#include "clouds/quadric.h"

#include <math.h>
#include <string.h>

enum { TERMS = 6, PLANE_TERMS = 3 }; /* 1, u, v; u^2, u v, v^2 */

/* By what factor the mean of the function's squared residuals must be smaller than the plane's. */
static const double BETTER = 1.5;
/* The largest slope of the function at the origin. */
static const double STEEPEST = 1;

/* A least squares problem: points with their terms, heights and weights. */
typedef struct problem {
    double terms[ISO_QUADRIC_POINTS + 1][TERMS], height[ISO_QUADRIC_POINTS + 1],
        weight[ISO_QUADRIC_POINTS + 1];
    int count;
} problem;

/* Solves a symmetric positive definite system by Cholesky's method; false if it is not definite. */
static bool solve(double matrix[TERMS][TERMS], double right[TERMS], int size) {
    for (int i = 0; i < size; i++) {
        const double whole = matrix[i][i];
        for (int k = 0; k < i; k++) matrix[i][i] -= matrix[i][k] * matrix[i][k];
        if (!(matrix[i][i] > 1e-9 * whole)) return false;
        matrix[i][i] = sqrt(matrix[i][i]);
        for (int j = i + 1; j < size; j++) {
            for (int k = 0; k < i; k++) matrix[j][i] -= matrix[j][k] * matrix[i][k];
            matrix[j][i] /= matrix[i][i];
        }
    }
    for (int i = 0; i < size; i++) {
        for (int k = 0; k < i; k++) right[i] -= matrix[i][k] * right[k];
        right[i] /= matrix[i][i];
    }
    for (int i = size - 1; i >= 0; i--) {
        for (int k = i + 1; k < size; k++) right[i] -= matrix[k][i] * right[k];
        right[i] /= matrix[i][i];
    }
    return true;
}

/* Fits the first `size` terms; returns the weighted sum of squared residuals for each point that is more than
 * there are terms, or INFINITY. */
static double fit(const problem *p, int size, double solution[TERMS]) {
    double matrix[TERMS][TERMS] = {{0}}, sum = 0;
    memset(solution, 0, TERMS * sizeof *solution);
    if (p->count <= size) return INFINITY;
    for (int i = 0; i < p->count; i++)
        for (int a = 0; a < size; a++) {
            solution[a] += p->weight[i] * p->terms[i][a] * p->height[i];
            /* the lower triangle */
            for (int b = 0; b <= a; b++) matrix[a][b] += p->weight[i] * p->terms[i][a] * p->terms[i][b];
        }
    if (!solve(matrix, solution, size)) return INFINITY;
    for (int i = 0; i < p->count; i++) {
        double residual = -p->height[i];
        for (int a = 0; a < size; a++) residual += solution[a] * p->terms[i][a];
        sum += p->weight[i] * residual * residual;
    }
    return sum / (p->count - size);
}

static void add_point(problem *p, double u, double v, double height, double weight) {
    const double terms[TERMS] = {1, u, v, u * u, u * v, v * v};
    memcpy(p->terms[p->count], terms, sizeof terms);
    p->height[p->count] = height;
    p->weight[p->count++] = weight;
}

bool iso_quadric_normal(const iso_vec3 *offsets, int count, iso_vec3 *normal) {
    problem p = {.count = 0};
    double plane[TERMS], function[TERMS], farthest = 0;
    const iso_vec3 n = *normal, side = fabs(n.x) < 0.6 ? iso_vec3_make(1, 0, 0) : iso_vec3_make(0, 1, 0),
                   u = iso_vec3_unit(iso_vec3_cross(n, side)), v = iso_vec3_cross(n, u);
    for (int i = 0; i < count; i++) farthest = fmax(farthest, iso_vec3_dot(offsets[i], offsets[i]));
    if (!(farthest > 0)) return false;
    const double scale = 1 / sqrt(farthest);
    add_point(&p, 0, 0, 0, 1);
    for (int i = 0; i < count; i++) {
        const iso_vec3 at = iso_vec3_scale(offsets[i], scale);
        const double near = 1 - iso_vec3_dot(at, at) / 1.5;
        add_point(&p, iso_vec3_dot(at, u), iso_vec3_dot(at, v), iso_vec3_dot(at, n), near * near);
    }
    const double flat = fit(&p, PLANE_TERMS, plane), curved = fit(&p, TERMS, function);
    if (!(curved * BETTER < flat)) return false;
    if (!(function[1] * function[1] + function[2] * function[2] < STEEPEST * STEEPEST)) return false;
    *normal = iso_vec3_unit(
        iso_vec3_sub(n, iso_vec3_add(iso_vec3_scale(u, function[1]), iso_vec3_scale(v, function[2]))));
    return true;
}
