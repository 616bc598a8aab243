/* stencil_simd: loads ISO_LANES voxels of a brick's row and their neighbours along the axes. For kernels. */
#ifndef ISO_SCULPT_FIELD_STENCIL_SIMD_H
#define ISO_SCULPT_FIELD_STENCIL_SIMD_H

#include "base/simd.h"
#include "sculpt/field/redistance.h"

/* ISO_LANES voxels of a row, beginning with voxel (x, y, z), whose offset in the brick is `at`. */
typedef struct row_site {
    const iso_stencil *stencil;
    int x, y, z, at;
} row_site;

typedef struct voxel_pair {
    vf low, high;
} voxel_pair;

ISO_INLINE row_site site_of(const iso_stencil *stencil, int row, int x) {
    row_site site = {stencil, x, row % ISO_BRICK, row / ISO_BRICK, row * ISO_BRICK + x};
    return site;
}

/* Loads the ISO_LANES voxels before and the ISO_LANES voxels after those of the site in its row, if need be
 * from the neighbouring bricks. */
ISO_INLINE voxel_pair load_along_x(const row_site *s) {
    const iso_stencil *n = s->stencil;
    const int row = s->at - s->x;
    voxel_pair pair;
    pair.low = v_load(s->x ? n->self + s->at - ISO_LANES : n->face[0] + row + ISO_BRICK - ISO_LANES);
    pair.high = v_load(s->x + ISO_LANES < ISO_BRICK ? n->self + s->at + ISO_LANES : n->face[1] + row);
    return pair;
}

/* Load the neighbours at a distance of 1 or 2 voxels along y or z. */
ISO_INLINE voxel_pair load_along_y(const row_site *s, int distance) {
    const iso_stencil *n = s->stencil;
    const int step = distance * ISO_BRICK, wrap = (ISO_BRICK - distance) * ISO_BRICK;
    voxel_pair pair;
    pair.low = v_load(s->y >= distance ? n->self + s->at - step : n->face[2] + s->at + wrap);
    pair.high = v_load(s->y < ISO_BRICK - distance ? n->self + s->at + step : n->face[3] + s->at - wrap);
    return pair;
}
ISO_INLINE voxel_pair load_along_z(const row_site *s, int distance) {
    const iso_stencil *n = s->stencil;
    const int step = distance * ISO_BRICK_ROWS, wrap = (ISO_BRICK - distance) * ISO_BRICK_ROWS;
    voxel_pair pair;
    pair.low = v_load(s->z >= distance ? n->self + s->at - step : n->face[4] + s->at + wrap);
    pair.high = v_load(s->z < ISO_BRICK - distance ? n->self + s->at + step : n->face[5] + s->at - wrap);
    return pair;
}

/* The values of ISO_LANES voxels and of their six face neighbours. */
typedef struct voxel_faces {
    vf self, low[3], high[3];
} voxel_faces;

ISO_INLINE voxel_faces faces_of(const row_site *s) {
    voxel_faces f;
    f.self = v_load(s->stencil->self + s->at);
    voxel_pair x = load_along_x(s), y = load_along_y(s, 1), z = load_along_z(s, 1);
    f.low[0] = v_last1(x.low, f.self);
    f.high[0] = v_next1(f.self, x.high);
    f.low[1] = y.low;
    f.high[1] = y.high;
    f.low[2] = z.low;
    f.high[2] = z.high;
    return f;
}

#endif
