/* candidates: the stadiums of shapes, and the test for each instruction set. */
#include "render/shapes/candidates.h"

#include "base/kernel_units.h"

iso_shapes_candidates_fn *iso_shapes_candidates_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_shapes_find_candidates, level);
}

/* In perspective a point that is `r` from the centre is at most f r sqrt(1 + u^2 + v^2) / (z - r) pixels from
 * it, with (u, v, 1) the centre's ray. */
iso_shapes_disc iso_shapes_disc_of(const iso_shapes_frame *frame, const double centre[3], double radius) {
    const double w = frame->parallel ? 1 : centre[2], u = centre[0] / w, v = centre[1] / w;
    iso_shapes_disc disc = {frame->cx + frame->focal * u, frame->cy + frame->focal * v,
                            frame->focal * radius};
    if (!frame->parallel) disc.radius *= (1 + (u * u + v * v) / 2) / (centre[2] - radius);
    return disc;
}

/* A coordinate that a sample has, at most. */
static int clamp(double value, int low, int high) {
    return value > low ? value < high ? (int)value : high : low;
}

bool iso_shapes_stadium_of(const iso_shapes_disc *a, const iso_shapes_disc *b, const iso_shapes_rect *all,
                           iso_shapes_stadium *o, iso_shapes_rect *box) {
    const double ax = a->x - all->x0, ay = a->y - all->y0, dx = b->x - a->x, dy = b->y - a->y;
    const double far = fabs(ax) + fabs(ay) + fabs(dx) + fabs(dy); /* floats lose a millionth of it */
    const double radius = (a->radius > b->radius ? a->radius : b->radius) * 1.00001 + far * 1e-5 + 0.02;
    const double low_x = (dx < 0 ? ax + dx : ax) - radius, low_y = (dy < 0 ? ay + dy : ay) - radius,
                 high_x = (dx > 0 ? ax + dx : ax) + radius, high_y = (dy > 0 ? ay + dy : ay) + radius;
    const int last_x = all->x1 - all->x0, last_y = all->y1 - all->y0;
    if (!(high_x >= 0 && high_y >= 0 && low_x <= last_x + 1 && low_y <= last_y + 1)) return false;
    *o = (iso_shapes_stadium){(float)ax, (float)ay, (float)dx, (float)dy, (float)radius};
    *box = (iso_shapes_rect){clamp(low_x, 0, last_x), clamp(low_y, 0, last_y), clamp(high_x, 0, last_x),
                             clamp(high_y, 0, last_y)};
    return true;
}
