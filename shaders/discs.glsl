/* discs.glsl: declarations shared by the shaders of the method discs
 * (render/discs/discs.h): uniforms, the values that discs.vert passes to discs.frag, and the shape
 * operator as a matrix. */
layout(std140, binding = ISO_GL_DISC_UNIFORMS) uniform disc_block { ISO_GL_DISCS_FIELDS };

bool orthographic = flags.x != 0u, culled = flags.y != 0u, colored = flags.z != 0u,
     widened = flags.w != 0u;

/* The values of a disc, in view space. */
#define DISC_FIELDS                                                                                          \
    flat vec4 centre;  /* column and row, pixels; z and the ball's radius, mm */                             \
    flat vec4 facing;  /* normal of the quadric, with its tilt; 1, or -1: it was flipped towards the eye */  \
    flat vec3 lit;     /* the point's unit normal, for shading */                                            \
    flat vec4 entries; /* of the shape operator, 1 / mm: xx, xy, xz, yy; or the point's colour */            \
    flat vec4 rest;    /* yz, zz; squared norm; 1: rays must not be taken as parallel */                     \
    flat vec4 along;   /* for a ray of direction d at offset q: n.d + q.Sd = x + dot(yz, q.xy), d.Sd = w */  \
    flat vec4 low;     /* box, voxels from the centre: low corner; columns on each side of the centre */   \
    flat vec4 high;    /* high corner; rows on each side of the centre */                                    \
    flat vec4 soft     /* filtered discs: SOFT_XX, XY, YY and SHARE of render/discs/kernel.h, else 0 */

/* The shape operator from its entries xx, xy, xz, yy and yz, zz. */
mat3 shape_operator(vec4 entries, vec4 rest) {
    return mat3(entries.xyz, entries.yw, rest.x, entries.z, rest.xy);
}

/* The squared Frobenius norm. */
float norm_of(mat3 s) {
    return dot(s[0], s[0]) + dot(s[1], s[1]) + dot(s[2], s[2]);
}

/* The direction of the ray through a pixel position. */
vec3 ray_to(vec2 pixel) {
    return vec3((pixel - axis.xy) * sizes.x, 1.0);
}
