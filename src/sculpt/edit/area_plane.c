#include "sculpt/edit/area_plane.h"

#include <math.h>

#include "grids/grid.h"

/* The places: those of a square lattice, from -PLACES to PLACES, that lie within a disc. */
enum { PLACES = 3, LEAST_FOUND = 8 };
/* Radius of the disc and largest height of the surface, in radii of the brush: no place is beyond the
 * radius. */
static const double REACH = 0.7;

/* Rounds, so that mirrored fields, whose sums differ in their last bits, have mirrored planes. */
static double snap(double value) {
    return rint(value * 4096) / 4096;
}

static double field_at(const iso_grid *grid, const iso_dab *dab, const double p[3]) {
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = dab->centre[k] + p[0] * dab->axis[0][k] + p[1] * dab->axis[1][k] + p[2] * dab->axis[2][k];
    return iso_grid_sample(grid, iso_vec3_make(at[0], at[1], at[2]));
}

/* Finds the height of the surface above (below: negative) the place p[0], p[1] of the tangent plane, by
 * steps as long as the distance to the surface. Returns whether there is one within `most` voxels. */
static bool find_height(const iso_grid *grid, const iso_dab *dab, double most, double p[3]) {
    double value = field_at(grid, dab, p);
    const double way = value > 0 ? -1 : 1; /* from outside the surface is below, from inside above */
    while (fabs(p[2]) < most) {
        const double before = value, step = fmax(fabs(value), 0.25);
        p[2] += way * step;
        value = field_at(grid, dab, p);
        if ((value > 0) == (before > 0)) continue;
        p[2] -= way * step * value / (value - before); /* where a line through both values is 0 */
        return fabs(p[2]) <= most;
    }
    return false;
}

/* Sums of products of the places found: 1, x and y with 1, x, y and height. */
typedef struct moments {
    double n, x, y, xx, xy, yy, z, xz, yz;
} moments;

/* Solves for the plane height = plane[0] + x plane[1] + y plane[2], by Cramer's rule. Returns whether the
 * places determine it. */
static bool fit_plane(const moments *m, double plane[3]) {
    const double a = m->xx * m->yy - m->xy * m->xy, b = m->xy * m->y - m->x * m->yy,
                 c = m->x * m->xy - m->xx * m->y;
    const double determinant = m->n * a + m->x * b + m->y * c;
    if (!(determinant > 1e-6 * m->n * m->xx * m->yy)) return false;
    plane[0] = (m->z * a + m->xz * b + m->yz * c) / determinant;
    plane[1] = (m->z * b + m->xz * (m->n * m->yy - m->y * m->y) + m->yz * (m->x * m->y - m->n * m->xy)) /
               determinant;
    plane[2] = (m->z * c + m->xz * (m->x * m->y - m->n * m->xy) + m->yz * (m->n * m->xx - m->x * m->x)) /
               determinant;
    return true;
}

static void set_plane(iso_dab *dab, const double plane[3]) {
    const double length = sqrt(1 + plane[1] * plane[1] + plane[2] * plane[2]);
    dab->plane = snap(plane[0] / length);
    for (int k = 0; k < 3; k++)
        dab->axis[2][k] =
            snap((dab->axis[2][k] - plane[1] * dab->axis[0][k] - plane[2] * dab->axis[1][k]) / length);
}

void iso_area_planes(const iso_hgrid *hgrid, iso_dabs *dabs) {
    const iso_grid grid = {.hgrid = (iso_hgrid *)hgrid}; /* only read */
    const double reach = REACH * (double)dabs->radius_voxels;
    for (int i = 0; i < dabs->count; i++) {
        iso_dab *dab = &dabs->dab[i];
        moments m = {0};
        double plane[3];
        for (int u = -PLACES; u <= PLACES; u++)
            for (int v = -PLACES; v <= PLACES; v++) {
                double p[3] = {u * reach / PLACES, v * reach / PLACES, 0};
                if (u * u + v * v > PLACES * PLACES || !find_height(&grid, dab, reach, p)) continue;
                m.n++, m.x += p[0], m.y += p[1], m.z += p[2];
                m.xx += p[0] * p[0], m.xy += p[0] * p[1], m.yy += p[1] * p[1];
                m.xz += p[0] * p[2], m.yz += p[1] * p[2];
            }
        if (m.n >= LEAST_FOUND && fit_plane(&m, plane)) set_plane(dab, plane);
    }
}
