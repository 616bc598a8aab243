/* A piece of the refined reconstruction's shaders (render/refined/refined.h): what the vertices of a disc tell its pixels,
 * and its shape operator, a symmetric matrix. */
layout(std140, binding = ISO_GL_REFINED) uniform refined_block { ISO_GL_REFINED_FIELDS };

bool orthographic = flags.x != 0u, culled = flags.y != 0u;

/* In view space and pixels. */
#define DISC_FIELDS                                                                                          \
    flat vec4 centre; /* pixels, and z and the ball's radius in mm */                                        \
    flat vec4 facing; /* normal, with its tilt; 1, or -1: it was turned to the eye */                        \
    flat vec3 lit;    /* the point's own normal: what is shown */                                            \
    flat vec4 hessian;  /* shape operator, 1 / mm: xx, xy, xz, yy */                                           \
    flat vec4 more;   /* yz, zz; the square of its norm; 1: its rays are not nearly parallel */              \
    flat vec4 along;  /* along a ray with direction d: n.d + q.Sd = x + q.yz, d.Sd = w */                    \
    flat vec4 low;    /* its box, voxels from its centre along the index axes; then how far it reaches on */ \
    flat vec4 high    /* either side of its centre, pixels: across, and down */

mat3 shape_operator(vec4 hessian, vec4 more) {
    return mat3(hessian.xyz, hessian.yw, more.x, hessian.z, more.xy);
}

/* The square of its norm. */
float norm_of(mat3 s) {
    return dot(s[0], s[0]) + dot(s[1], s[1]) + dot(s[2], s[2]);
}

/* The direction of the ray through a pixel position. */
vec3 ray_to(vec2 pixel) {
    return vec3((pixel - axis.xy) * sizes.x, 1.0);
}
