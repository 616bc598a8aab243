/* placement: rotations, scales and positions of instances. */
#include "base/placement.h"

static const double FARTHEST = 1e12, LEAST_SCALE = 1e-9, MOST_SCALE = 1e9; /* mm; factors */

iso_status iso_placement_check(const iso_placement *placement, iso_error *error) {
    const iso_vec3 p = placement->position;
    const double *q = placement->rotation, scale = placement->scale;
    if (!(fabs(p.x) <= FARTHEST && fabs(p.y) <= FARTHEST && fabs(p.z) <= FARTHEST))
        return iso_fail(error, ISO_ERR_USAGE, "position %g %g %g is not finite, or too far away", p.x, p.y,
                        p.z);
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const bool none = q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0;
    if (!isfinite(square) || (!none && !(square > 0)))
        return iso_fail(error, ISO_ERR_USAGE, "quaternion %g %g %g %g is no rotation", q[0], q[1], q[2],
                        q[3]);
    if (scale != 0 && !(scale >= LEAST_SCALE && scale <= MOST_SCALE))
        return iso_fail(error, ISO_ERR_USAGE, "scale %g is not from %g to %g", scale, LEAST_SCALE,
                        MOST_SCALE);
    return ISO_OK;
}

bool iso_placement_is_turned(const iso_placement *placement) {
    const double *q = placement->rotation;
    return q[0] != 0 || q[1] != 0 || q[2] != 0;
}

/* Row `row` of a matrix times a vector. */
static double row_times(const double m[9], int row, const double *v, int stride) {
    return m[3 * row] * v[0] + m[3 * row + 1] * v[stride] + m[3 * row + 2] * v[2 * stride];
}

iso_transform iso_placement_transform(const iso_placement *placement, const iso_transform *own) {
    const double *q = placement->rotation, wxyz[4] = {q[3], q[0], q[1], q[2]};
    const double scale = placement->scale > 0 ? placement->scale : 1;
    const double position[3] = {placement->position.x, placement->position.y, placement->position.z};
    double m[9];
    iso_transform made = *own;
    iso_quaternion_matrix(wxyz, m);
    for (int row = 0; row < 3; row++) {
        made.spacing[row] = own->spacing[row] * scale;
        made.origin[row] = position[row] + scale * row_times(m, row, own->origin, 1);
        for (int column = 0; column < 3; column++)
            made.direction[3 * row + column] = row_times(m, row, own->direction + column, 3);
    }
    return made;
}

void iso_quaternion_of_angles(const double degrees[3], double quaternion[4]) {
    double s[3], c[3];
    for (int axis = 0; axis < 3; axis++)
        iso_sincos(fmod(degrees[axis], 720) * ISO_PI / 360, &s[axis], &c[axis]); /* of half the angle */
    quaternion[0] = s[0] * c[1] * c[2] - c[0] * s[1] * s[2];
    quaternion[1] = c[0] * s[1] * c[2] + s[0] * c[1] * s[2];
    quaternion[2] = c[0] * c[1] * s[2] - s[0] * s[1] * c[2];
    quaternion[3] = c[0] * c[1] * c[2] + s[0] * s[1] * s[2];
}
