/* geometry: boxes, transforms and their matrices, and sine and cosine by series. */
#include "base/geometry.h"

#include <float.h>
#include <string.h>

iso_box iso_box_empty(void) {
    return (iso_box){{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
}

bool iso_box_is_empty(const iso_box *box) {
    return !(box->lo.x <= box->hi.x && box->lo.y <= box->hi.y && box->lo.z <= box->hi.z);
}

void iso_box_add(iso_box *box, iso_vec3 p) {
    box->lo = iso_vec3_make(p.x < box->lo.x ? p.x : box->lo.x, p.y < box->lo.y ? p.y : box->lo.y,
                            p.z < box->lo.z ? p.z : box->lo.z);
    box->hi = iso_vec3_make(p.x > box->hi.x ? p.x : box->hi.x, p.y > box->hi.y ? p.y : box->hi.y,
                            p.z > box->hi.z ? p.z : box->hi.z);
}

iso_vec3 iso_box_corner(const iso_box *box, int corner) {
    return iso_vec3_make(corner & 1 ? box->hi.x : box->lo.x, corner & 2 ? box->hi.y : box->lo.y,
                         corner & 4 ? box->hi.z : box->lo.z);
}

iso_transform iso_transform_identity(void) {
    return (iso_transform){.spacing = {1, 1, 1}, .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

iso_transform iso_transform_local(const iso_transform *transform) {
    iso_transform local = iso_transform_identity();
    for (int axis = 0; axis < 3; axis++) local.spacing[axis] = transform->spacing[axis];
    return local;
}

iso_status iso_crop_dims(const int dims[3], const int lo[3], const int hi[3], int cropped[3],
                         iso_error *error) {
    for (int axis = 0; axis < 3; axis++) {
        if (lo[axis] < 0 || hi[axis] >= dims[axis] || lo[axis] > hi[axis])
            return iso_fail(error, ISO_ERR_USAGE, "crop %d..%d along %c is not in 0..%d", lo[axis], hi[axis],
                            "xyz"[axis], dims[axis] - 1);
        cropped[axis] = hi[axis] - lo[axis] + 1;
    }
    return ISO_OK;
}

static iso_vec3 multiply(const double m[9], iso_vec3 v) {
    return iso_vec3_make(m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
                         m[6] * v.x + m[7] * v.y + m[8] * v.z);
}

static iso_vec3 multiply_transposed(const double m[9], iso_vec3 v) {
    return iso_vec3_make(m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
                         m[2] * v.x + m[5] * v.y + m[8] * v.z);
}

static iso_vec3 column(const double m[9], int axis) {
    return iso_vec3_make(m[axis], m[3 + axis], m[6 + axis]);
}

iso_affine iso_transform_affine(const iso_transform *transform) {
    iso_affine affine;
    for (int i = 0; i < 9; i++) affine.m[i] = transform->direction[i] * transform->spacing[i % 3];
    for (int i = 0; i < 3; i++) affine.origin[i] = transform->origin[i];
    iso_vec3 x = column(affine.m, 0), y = column(affine.m, 1), z = column(affine.m, 2);
    iso_vec3 yz = iso_vec3_cross(y, z), zx = iso_vec3_cross(z, x), xy = iso_vec3_cross(x, y);
    affine.determinant = iso_vec3_dot(x, yz);
    const iso_vec3 rows[3] = {yz, zx, xy};
    for (int row = 0; row < 3; row++) {
        affine.inverse[3 * row] = rows[row].x / affine.determinant;
        affine.inverse[3 * row + 1] = rows[row].y / affine.determinant;
        affine.inverse[3 * row + 2] = rows[row].z / affine.determinant;
    }
    return affine;
}

iso_vec3 iso_affine_point(const iso_affine *affine, iso_vec3 index) {
    iso_vec3 v = multiply(affine->m, index);
    return iso_vec3_make(v.x + affine->origin[0], v.y + affine->origin[1], v.z + affine->origin[2]);
}

iso_transform iso_transform_shift(const iso_transform *transform, const int at[3]) {
    const iso_affine affine = iso_transform_affine(transform);
    const iso_vec3 origin = iso_affine_point(&affine, iso_vec3_make(at[0], at[1], at[2]));
    iso_transform shifted = *transform;
    shifted.origin[0] = origin.x;
    shifted.origin[1] = origin.y;
    shifted.origin[2] = origin.z;
    return shifted;
}

iso_vec3 iso_affine_vector(const iso_affine *affine, iso_vec3 index_vector) {
    return multiply(affine->m, index_vector);
}

iso_vec3 iso_affine_point_to_index(const iso_affine *affine, iso_vec3 world) {
    return multiply(affine->inverse, iso_vec3_make(world.x - affine->origin[0], world.y - affine->origin[1],
                                                   world.z - affine->origin[2]));
}

iso_vec3 iso_affine_vector_to_index(const iso_affine *affine, iso_vec3 world_vector) {
    return multiply(affine->inverse, world_vector);
}

iso_vec3 iso_affine_normal(const iso_affine *affine, iso_vec3 index_normal) {
    return iso_vec3_unit(multiply_transposed(affine->inverse, index_normal));
}

bool iso_transform_is_singular(const iso_transform *transform) {
    double lengths = 1;
    for (int axis = 0; axis < 3; axis++) {
        lengths *= iso_vec3_length(column(transform->direction, axis)) * transform->spacing[axis];
        if (!isfinite(transform->origin[axis]) || !(transform->spacing[axis] > 0)) return true;
    }
    double determinant = iso_transform_affine(transform).determinant;
    return !isfinite(determinant) || !isfinite(lengths) || !(fabs(determinant) > 1e-12 * lengths);
}

iso_box iso_box_transform(const iso_box *box, const iso_affine *affine) {
    iso_box out = iso_box_empty();
    if (iso_box_is_empty(box)) return out;
    for (int corner = 0; corner < 8; corner++)
        iso_box_add(&out, iso_affine_point(affine, iso_box_corner(box, corner)));
    return out;
}

/* Taylor series on |x| <= pi/4 after a two-part reduction by multiples of pi/2 (Cody and Waite 1980). */
void iso_sincos(double angle, double *sine, double *cosine) {
    const double half_pi_high = 1.57079632673412561417e+00, half_pi_low = 6.07710050650619224932e-11;
    double quadrant = floor(angle * (2 / ISO_PI) + 0.5);
    double x = (angle - quadrant * half_pi_high) - quadrant * half_pi_low;
    double square = x * x, s = 0, c = 0;
    for (int k = 19; k >= 3; k -= 2) s = (1 + s) * -square / (k * (k - 1));
    for (int k = 20; k >= 2; k -= 2) c = (1 + c) * -square / (k * (k - 1));
    s = x * (1 + s);
    c = 1 + c;
    int turn = (int)(quadrant - 4 * floor(quadrant / 4));
    *sine = turn == 0 ? s : turn == 1 ? c : turn == 2 ? -s : -c;
    *cosine = turn == 0 ? c : turn == 1 ? -s : turn == 2 ? -c : s;
}

double iso_tan(double angle) {
    double sine, cosine;
    iso_sincos(angle, &sine, &cosine);
    return sine / cosine;
}

/* The quotient of the smaller and the larger coordinate, 0 .. 1, is brought below tan(pi / 8) by the addition
 * theorem; the power series of the arctangent then loses less than 0.4143^27 / 27 = 2e-12. */
double iso_atan2(double y, double x) {
    const double a = fabs(x), b = fabs(y), larger = a > b ? a : b;
    if (!(larger > 0)) return 0;
    double t = (a > b ? b : a) / larger, angle = 0, series = 0;
    if (t > 0.41421356237309503) {
        t = (t - 1) / (t + 1);
        angle = ISO_PI / 4;
    }
    for (int power = 25; power >= 1; power -= 2) series = 1.0 / power - t * t * series;
    angle += t * series;
    if (b > a) angle = ISO_PI / 2 - angle;
    if (x < 0) angle = ISO_PI - angle;
    return y < 0 ? -angle : angle;
}

void iso_quaternion_matrix(const double quaternion[4], double m[9]) {
    double w = quaternion[0], x = quaternion[1], y = quaternion[2], z = quaternion[3];
    const double square = w * w + x * x + y * y + z * z;
    if (!(square > 0 && isfinite(square))) {
        w = 1;
        x = y = z = 0;
    } else {
        const double scale = 1 / sqrt(square);
        w *= scale, x *= scale, y *= scale, z *= scale;
    }
    const double rows[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                            2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                            2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(m, rows, sizeof rows);
}
