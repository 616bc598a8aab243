/* Darkening the masked parts of a shaded picture. */
#include "apps/isosculpt/viewport/masked.h"

#include <math.h>

/* What the threads that darken masked voxels read. */
typedef struct mask_pass {
    const isosculpt_viewport *viewport;
    const iso_strip *strip;
    const iso_image *image;
    iso_affine affine;
} mask_pass;

static bool is_masked(const mask_pass *m, size_t sample, double x, double y) {
    const int *dims = iso_grid_dims(&m->viewport->grid);
    iso_vec3 origin, direction;
    if (m->strip->gbuffer->surface[sample] == ISO_SURFACE_NONE) return false;
    iso_view_ray(m->strip->view, x, y, &origin, &direction);
    iso_vec3 world =
        iso_vec3_add(origin, iso_vec3_scale(direction, (double)m->strip->gbuffer->depth[sample]));
    iso_vec3 p = iso_affine_point_to_index(&m->affine, world);
    const double at[3] = {p.x, p.y, p.z};
    int voxel[3];
    for (int axis = 0; axis < 3; axis++)
        voxel[axis] = (int)fmin(fmax(floor(at[axis] + 0.5), 0), dims[axis] - 1);
    return m->viewport->mask.at(m->viewport->mask.context, voxel[0], voxel[1], voxel[2]);
}

static void darken_masked_row(void *context, size_t row, int worker) {
    (void)worker;
    const mask_pass *m = context;
    const size_t factor = (size_t)m->strip->factor, width = (size_t)m->image->width;
    for (size_t column = 0; column < width; column++) {
        size_t x = column * factor + factor / 2, y = row * factor + factor / 2;
        uint8_t *rgba = m->image->rgba + (row * width + column) * 4;
        if (!is_masked(m, y * width * factor + x, (double)x + 0.5, (double)y + 0.5)) continue;
        for (int k = 0; k < 3; k++) rgba[k] = (uint8_t)(rgba[k] * 3 / 5);
    }
}

void isosculpt_darken_masked(const isosculpt_viewport *viewport, const iso_strip *strip, iso_image *image) {
    mask_pass m = {viewport, strip, image, iso_transform_affine(iso_grid_transform(&viewport->grid))};
    iso_parallel_for(viewport->pool, (size_t)image->height, darken_masked_row, &m);
}
