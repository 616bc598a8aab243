/* occlusion_truth: rays in steps of a quarter of a voxel. */
#include "occlusion_truth.h"

#include <math.h>

#include "grids/threshold.h"

static const double STEP = 0.25, START = 0.75; /* voxels */

/* 0 .. 1 (SplitMix64). */
static double random_number(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static bool is_solid(const iso_grid *grid, double isovalue, double sign, iso_vec3 at) {
    const int *dims = iso_grid_dims(grid);
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x > dims[0] - 1 || at.y > dims[1] - 1 || at.z > dims[2] - 1)
        return false;
    return (iso_grid_sample(grid, at) - isovalue) * sign < 0;
}

double iso_occlusion_truth(const iso_grid *grid, double isovalue, iso_vec3 position, iso_vec3 normal,
                           double range, int rays, uint64_t seed) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const double stored = iso_grid_stored(grid, isovalue),
                 sign = (double)iso_threshold_of(grid, isovalue).normal_sign;
    const iso_vec3 beside = iso_vec3_unit(iso_affine_vector_to_index(&affine, normal)),
                   start = iso_vec3_add(position, iso_vec3_scale(beside, START)),
                   other = fabs(normal.x) < 0.6 ? iso_vec3_make(1, 0, 0) : iso_vec3_make(0, 1, 0),
                   u = iso_vec3_unit(iso_vec3_cross(normal, other)), v = iso_vec3_cross(normal, u);
    int seen = 0;
    for (int i = 0; i < rays; i++) {
        const double angle = 2 * 3.14159265358979323846 * random_number(&seed), square = random_number(&seed),
                     radius = sqrt(square);
        const iso_vec3 world = iso_vec3_add(
            iso_vec3_scale(normal, sqrt(1 - square)),
            iso_vec3_add(iso_vec3_scale(u, radius * cos(angle)), iso_vec3_scale(v, radius * sin(angle))));
        const iso_vec3 index = iso_affine_vector_to_index(&affine, world);
        const double length = iso_vec3_length(index); /* voxels a millimetre */
        bool blocked = false;
        for (double t = 0; t <= range * length && !blocked; t += STEP)
            blocked = is_solid(grid, stored, sign, iso_vec3_add(start, iso_vec3_scale(index, t / length)));
        seen += !blocked;
    }
    return (double)seen / rays;
}
