/* tensor: computes eigenvectors by Jacobi rotations (Golub and Van Loan, "Matrix Computations", section
 * 8.5.2, with Rutishauser's choice of the smaller angle). The closed form of the eigenvalues is not used: it
 * needs an arccosine, whose last bits differ between machines, and it loses digits where two eigenvalues are
 * close. Rotations need only square roots and keep all digits. */
#include "base/tensor.h"

#include <math.h>
#include <string.h>

/* Sweeps over the three entries above the diagonal. Convergence is quadratic, so about five are needed. */
enum { SWEEPS = 12 };

/* Rotates rows and columns p and q of `a` so that the entry at (p, q) becomes 0, and rotates the rows of `v`
 * in the same way. */
static void rotate(double a[3][3], double v[3][3], int p, int q) {
    if (a[p][q] == 0) return;
    const int r = 3 - p - q;
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    const double shift = t * a[p][q], rp = a[r][p], rq = a[r][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = a[q][p] = 0;
    a[r][p] = a[p][r] = c * rp - s * rq;
    a[r][q] = a[q][r] = s * rp + c * rq;
    for (int k = 0; k < 3; k++) {
        const double vp = v[p][k], vq = v[q][k];
        v[p][k] = c * vp - s * vq;
        v[q][k] = s * vp + c * vq;
    }
}

static void swap_if_less(iso_eigen *eigen, int i) {
    if (eigen->values[i] >= eigen->values[i + 1]) return;
    const double value = eigen->values[i];
    double vector[3];
    memcpy(vector, eigen->vectors[i], sizeof vector);
    eigen->values[i] = eigen->values[i + 1];
    memcpy(eigen->vectors[i], eigen->vectors[i + 1], sizeof vector);
    eigen->values[i + 1] = value;
    memcpy(eigen->vectors[i + 1], vector, sizeof vector);
}

iso_eigen iso_tensor_eigen(const float t[6]) {
    double a[3][3] = {{(double)t[0], (double)t[1], (double)t[2]},
                      {(double)t[1], (double)t[3], (double)t[4]},
                      {(double)t[2], (double)t[4], (double)t[5]}};
    iso_eigen eigen = {.vectors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int sweep = 0; sweep < SWEEPS && (a[0][1] != 0 || a[0][2] != 0 || a[1][2] != 0); sweep++) {
        rotate(a, eigen.vectors, 0, 1);
        rotate(a, eigen.vectors, 0, 2);
        rotate(a, eigen.vectors, 1, 2);
    }
    for (int i = 0; i < 3; i++) eigen.values[i] = a[i][i];
    swap_if_less(&eigen, 0);
    swap_if_less(&eigen, 1);
    swap_if_less(&eigen, 0);
    return eigen;
}

double iso_eigen_anisotropy(const iso_eigen *eigen) {
    const double *l = eigen->values, mean = (l[0] + l[1] + l[2]) / 3;
    const double square = l[0] * l[0] + l[1] * l[1] + l[2] * l[2], spread = (l[0] - mean) * (l[0] - mean) +
                                                                            (l[1] - mean) * (l[1] - mean) +
                                                                            (l[2] - mean) * (l[2] - mean);
    return square > 0 ? sqrt(1.5 * spread / square) : 0;
}
