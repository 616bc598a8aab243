/* shapes_near.glsl: shapes whose rays are traced in double precision (render/shapes/near.h), as the cpu
 * uploads them, and rays. Included after shapes.glsl. */
struct near_shape { ISO_GL_NEAR_FIELDS };
layout(std430, binding = ISO_GL_NEAR_SHAPES) readonly buffer near_buffer { near_shape near_shapes[]; };

const double FAR_AWAY = 1e300LF;

/* origin + t * direction, t the depth. */
struct ray {
    dvec3 origin, direction;
};

/* Where a ray enters and leaves a shape, with the normals there, and how far along a segment that is. */
struct piece {
    double t[2];
    dvec3 normal[2];
    double along[2];
};

/* Extends the piece to an intersection at t. */
void extend(inout piece p, double t, dvec3 normal, double along) {
    if (t < p.t[0]) {
        p.t[0] = t;
        p.normal[0] = normal;
        p.along[0] = along;
    }
    if (t > p.t[1]) {
        p.t[1] = t;
        p.normal[1] = normal;
        p.along[1] = along;
    }
}
