/* setup: bounds for the method discs. */
#include "render/discs/setup.h"

#include <math.h>

#include "render/discs/discs_numbers.h"

float iso_discs_slant(const iso_view *view, double beyond) {
    if (view->orthographic) return 1.04f;
    const double top = view->cy + view->above, bottom = view->height + view->below - view->cy;
    const double x = (fmax(fabs(view->cx), fabs(view->width - view->cx)) + beyond) / view->focal,
                 y = (fmax(fabs(top), fabs(bottom)) + beyond) / view->focal;
    return (float)(1.04 * sqrt(1 + x * x + y * y));
}

float iso_discs_largest_radius(const iso_point_block *block) {
    const float radius = block->radius[1] * 1.001f / ISO_DISC_RADII, /* of a point, widened for rounding */
        wide = (radius - ISO_DISCS_GROW_FROM) / ISO_DISCS_GROW_OVER;
    return radius * (ISO_DISCS_BALL + fminf(fmaxf(wide, 0), 1) * ISO_DISCS_BALL_MORE);
}

bool iso_discs_is_filtered(const iso_point_block *block) {
    return block->radius[0] * (ISO_DISCS_BALL / ISO_DISC_RADII) < ISO_DISCS_LOW_PASS_RADIUS;
}

float iso_discs_voxels_per_mm(const float normal[9]) {
    const float *m = normal;
    float most = 0;
    for (int k = 0; k < 3; k++)
        most = fmaxf(most, sqrtf(m[k] * m[k] + m[3 + k] * m[3 + k] + m[6 + k] * m[6 + k]));
    return most;
}
