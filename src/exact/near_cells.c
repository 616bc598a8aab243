/* near_cells: projects the cells of octants next to the eye. */
#include "exact/kernel.h"

/* Cells are taken to reach this far beyond [-1, 1], as ISO_EXACT_WIDER (kernel_simd.h): next to the eye
 * the rounding errors of rays are larger. */
#define ISO_EXACT_WIDER_NEAR 4e-5f

void iso_exact_project_near_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const double half[3] = {0.5, 0.5, 0.5};
    for (int i = 0; i < scratch->octant->cells; i++) {
        const int local[3] = {scratch->position[i] & 7, scratch->position[i] >> 3 & 7,
                              scratch->position[i] >> 6};
        iso_exact_cell *record = &scratch->record[i];
        double centre[3];
        for (int axis = 0; axis < 3; axis++) {
            centre[axis] = (double)ISO_BRICK * scratch->span->brick[axis] + scratch->octant->origin[axis] +
                           local[axis] + 0.5;
            record->eye[axis] = (float)(2 * (projection->eye[axis] - centre[axis]));
            record->half[axis] = 1 + ISO_EXACT_WIDER_NEAR;
            record->shift[axis] = 0;
        }
        record->place[0] = record->place[1] = record->scale = 0;
        record->depth = (float)-projection->middle;
        record->behind = (float)-projection->target->view->near;
        int pixels[4] = {0, -1, 0, -1};
        iso_exact_pixel_box(projection, centre, half, scratch->clip, pixels);
        for (int k = 0; k < 4; k++) scratch->box[k][i] = pixels[k];
    }
}
