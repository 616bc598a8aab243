/* geometry: vectors, boxes and the index-to-world transform, in double precision.
 *
 * World coordinates are millimetres, LPS (x to the patient's left, y to the back, z up), right-handed.
 * Index coordinates are voxels; voxel (i, j, k) has its centre at exactly (i, j, k).
 * The trigonometric functions here do not use libm, whose results differ between machines: pictures must be
 * the same on every machine. */
#ifndef ISO_BASE_GEOMETRY_H
#define ISO_BASE_GEOMETRY_H

#include <math.h>
#include <stdbool.h>

#include "base/c_linkage.h"
#include "base/status.h"
#include "isopoint.h"

ISO_C_BEGIN

static inline iso_vec3 iso_vec3_make(double x, double y, double z) {
    iso_vec3 v = {x, y, z};
    return v;
}
static inline iso_vec3 iso_vec3_add(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_make(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline iso_vec3 iso_vec3_sub(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_make(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline iso_vec3 iso_vec3_scale(iso_vec3 a, double s) {
    return iso_vec3_make(a.x * s, a.y * s, a.z * s);
}
static inline double iso_vec3_dot(iso_vec3 a, iso_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline iso_vec3 iso_vec3_cross(iso_vec3 a, iso_vec3 b) {
    return iso_vec3_make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double iso_vec3_length(iso_vec3 a) {
    return sqrt(iso_vec3_dot(a, a));
}
static inline bool iso_vec3_is_finite(iso_vec3 a) {
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
static inline void iso_vec3_store(iso_vec3 a, double to[3]) {
    to[0] = a.x;
    to[1] = a.y;
    to[2] = a.z;
}
/* a / |a|; the zero vector stays zero. */
static inline iso_vec3 iso_vec3_unit(iso_vec3 a) {
    double length = iso_vec3_length(a);
    return length > 0 ? iso_vec3_scale(a, 1 / length) : a;
}

iso_box iso_box_empty(void);
bool iso_box_is_empty(const iso_box *box);
void iso_box_add(iso_box *box, iso_vec3 point);
/* Corner 0 .. 7 of the box: bit 0 chooses hi.x, bit 1 hi.y, bit 2 hi.z. */
iso_vec3 iso_box_corner(const iso_box *box, int corner);

/* Origin 0, spacing 1, identity direction. */
iso_transform iso_transform_identity(void);

/* The transform with the same spacing, origin 0 and identity direction: the volume's local coordinates. */
iso_transform iso_transform_local(const iso_transform *transform);

/* The transform of a smaller grid, cut out of a grid with this transform, whose first voxel has the index
 * `at`. */
iso_transform iso_transform_shift(const iso_transform *transform, const int at[3]);

/* Sets `cropped` to the size of the box of voxels lo .. hi (both inclusive) of a grid. ISO_ERR_USAGE when the
 * box is empty or reaches beyond the grid. */
iso_status iso_crop_dims(const int dims[3], const int lo[3], const int hi[3], int cropped[3],
                         iso_error *error);

/* A transform as a matrix, world = origin + m * index, with the inverse of m. Row-major. */
typedef struct iso_affine {
    double m[9], inverse[9], origin[3];
    double determinant;
} iso_affine;

iso_affine iso_transform_affine(const iso_transform *transform);
iso_vec3 iso_affine_point(const iso_affine *affine, iso_vec3 index);
iso_vec3 iso_affine_vector(const iso_affine *affine, iso_vec3 index_vector);
iso_vec3 iso_affine_point_to_index(const iso_affine *affine, iso_vec3 world);
iso_vec3 iso_affine_vector_to_index(const iso_affine *affine, iso_vec3 world_vector);
/* Transforms a normal (covector) to world coordinates by the inverse transpose; unit length; a zero normal
 * stays zero. */
iso_vec3 iso_affine_normal(const iso_affine *affine, iso_vec3 index_normal);

/* Whether the 3x3 matrix has a non-finite entry, or a |determinant| below 1e-12 times the product of its
 * columns' lengths. */
bool iso_transform_is_singular(const iso_transform *transform);

/* The world box of `box`, which is in index coordinates: the box of its eight corners. */
iso_box iso_box_transform(const iso_box *box, const iso_affine *affine);

/* The rotation matrix of a quaternion w x y z, of any length but 0, row by row; the identity if it is 0 or
 * not finite. */
void iso_quaternion_matrix(const double quaternion[4], double m[9]);

#define ISO_PI 3.14159265358979323846

/* Sine and cosine of `angle` radians (|angle| up to 1e6), error below 1e-14, the same bits on every machine.
 */
void iso_sincos(double angle, double *sine, double *cosine);
/* Tangent of an angle in (-pi/2, pi/2). */
double iso_tan(double angle);
/* The angle of the vector (x, y) from the x axis, -pi .. pi; error below 1e-11; 0 for the zero vector. */
double iso_atan2(double y, double x);

ISO_C_END
#endif
