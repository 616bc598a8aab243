/* dab_kernel: edits of a brick (dab.h): the parts that are the same for every instruction set; dab_body.inc
 * has the others. A unit for each instruction set (base/kernel_units.h). */
#include <math.h>

#include "base/simd.h"
#include "grids/grid.h"
#include "sculpt/brush/dab.h"

/* A dab in floats, with the centre relative to a brick's first voxel. `segment` goes from the centre to
 * `from`. */
typedef struct iso_local_dab {
    float centre[3], segment[3], axis[3][3];
} iso_local_dab;

static void make_local_dabs(const iso_dabs *dabs, const int brick[3], iso_local_dab local[ISO_DAB_MAX]) {
    for (int i = 0; i < dabs->count; i++)
        for (int k = 0; k < 3; k++) {
            const iso_dab *dab = &dabs->dab[i];
            local[i].centre[k] = (float)(dab->centre[k] - ISO_BRICK * (double)brick[k]);
            local[i].segment[k] = (float)(dab->from[k] - dab->centre[k]);
            for (int a = 0; a < 3; a++) local[i].axis[a][k] = (float)dab->axis[a][k];
        }
}

/* Returns the signed distance from a voxel to one stamp, in voxels of the field. Where the stamp stores no
 * distance it returns INFINITY (outside) or -INFINITY (inside). */
static float stamp_distance(const iso_dabs *dabs, const iso_local_dab *dab, const float voxel[3]) {
    const iso_grid stamp = {.hgrid = (iso_hgrid *)dabs->stamp}; /* only read */
    const iso_transform *transform = &dabs->stamp->transform;
    const double scale = transform->spacing[0] * (double)dabs->radius_voxels;
    const double far = (double)dabs->stamp->band * 0.999;
    double p[3];
    for (int a = 0; a < 3; a++) {
        p[a] = -transform->origin[a] / transform->spacing[a];
        for (int k = 0; k < 3; k++) p[a] += (double)(dab->axis[a][k] * (voxel[k] - dab->centre[k])) / scale;
        if (!(p[a] >= 0 && p[a] <= dabs->stamp->dims[a] - 1)) return INFINITY; /* outside the stamp's grid */
    }
    const double d = iso_grid_sample(&stamp, iso_vec3_make(p[0], p[1], p[2]));
    return (float)(d >= far ? INFINITY : d <= -far ? -INFINITY : d * scale);
}

/* Computes for all voxels of a brick the signed distance to the nearest of the mirrored stamps. */
static void stamp_distances(const iso_dabs *dabs, const iso_local_dab *local, float *out) {
    for (int at = 0; at < ISO_BRICK_VOXELS; at++) {
        const float voxel[3] = {(float)(at % ISO_BRICK), (float)(at / ISO_BRICK % ISO_BRICK),
                                (float)(at / ISO_BRICK_ROWS)};
        out[at] = INFINITY;
        for (int i = 0; i < dabs->count; i++) {
            const float distance = stamp_distance(dabs, &local[i], voxel);
            if (distance < out[at]) out[at] = distance;
        }
    }
}

#define ISO_KERNEL_BODY "sculpt/brush/dab_body.inc"
#include "base/kernel_levels.inc"
