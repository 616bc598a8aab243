/* discs_curvature.glsl: decodes an iso_curvature (base/primitives.h): shape operator, tilt, extents and
 * the reduction of the radius. Included by discs.vert after discs.glsl. */

/* Normals and tangents from index to view space. */
vec3 to_view(vec3 v) {
    return vec3(dot(normal_x.xyz, v), dot(normal_y.xyz, v), dot(normal_z.xyz, v));
}

/* Two tangents of a unit normal, the same as iso_curvature_frame. */
void make_frame(vec3 n, out vec3 u, out vec3 v) {
    float side = floatBitsToInt(n.z) < 0 ? -1.0 : 1.0;
    float a = -1.0 / (side + n.z), b = n.x * n.y * a;
    u = vec3(1.0 + side * (n.x * n.x * a), side * b, -(side * n.x));
    v = vec3(b, side + n.y * n.y * a, -n.y);
}

/* The shape operator in view space, not yet scaled: its entries in the tangents u and v, plus a curvature
 * along the unit normal: the largest principal curvature if that is convex (render/discs/discs.h). u
 * and v are in view space. */
mat3 unpack_shape_operator(ivec4 curvature, vec3 u, vec3 v, vec3 view_normal) {
    const float each = ISO_CURVATURE_STEP * float(1 << ISO_CURVATURE_LOW_BITS);
    vec3 entry = vec3(curvature.xyz >> ISO_CURVATURE_LOW_BITS) * each;
    mat3 s = outerProduct(u, entry.x * u + entry.y * v) + outerProduct(v, entry.y * u + entry.z * v);
    float trace = s[0].x + s[1].y + s[2].z, apart = sqrt(max(2.0 * norm_of(s) - trace * trace, 0.0));
    return s + outerProduct(view_normal, max(trace + apart, 0.0) * 0.5 * view_normal);
}

/* The tilt of the surface against the normal, along u and v. */
vec2 tilt(ivec4 curvature) {
    ivec3 low = curvature.xyz & (1 << ISO_CURVATURE_LOW_BITS) - 1;
    int bits = low.x | low.y << ISO_CURVATURE_LOW_BITS | low.z << 2 * ISO_CURVATURE_LOW_BITS;
    vec2 steps = vec2(bitfieldExtract(bits, 0, ISO_CURVATURE_TILT_BITS),
                      bitfieldExtract(bits, ISO_CURVATURE_TILT_BITS, ISO_CURVATURE_TILT_BITS));
    return steps * abs(steps) *
           (ISO_CURVATURE_TILT_MOST / (ISO_CURVATURE_TILT_STEPS * ISO_CURVATURE_TILT_STEPS));
}

/* The factor by which the radius of the disc's ball is reduced. */
float disc_scale(ivec4 curvature) {
    return 1.0 - 0.25 * float((curvature.w & 0xFFFF) >> ISO_CURVATURE_SHRINK_BIT);
}

/* Narrows the box of an edge point at `at` (index coordinates) to its extents, if they are known: along
 * the edge as far as the edge reaches, along the other axes as far as the surface continues in the cells
 * beside the edge. At a voxel, rounding of packed points may have moved the point to the edge on the other
 * side. */
void apply_extents(ivec4 curvature, vec3 at, inout vec3 lowest, inout vec3 highest) {
    int extents = curvature.w & 0xFFFF;
    int edge = (extents >> ISO_CURVATURE_AXIS_BIT & ISO_CURVATURE_AXIS_MASK) - 1;
    if (extents == 0) return;
    const float each = 1.0 / ISO_CURVATURE_EXTENT_STEPS;
    int next = 0;
    for (int k = 0; k < 3; k++) {
        float below = at[k] - floor(at[k]), above = 1.0 - below;
        if (below < ISO_DISCS_AT_VOXEL) below = 1.0;
        if (above < ISO_DISCS_AT_VOXEL) above = 1.0;
        if (k != edge) {
            below = float(extents >> next & ISO_CURVATURE_EXTENT_STEPS) * each;
            above = float(extents >> next + ISO_CURVATURE_EXTENT_BITS & ISO_CURVATURE_EXTENT_STEPS) * each;
            next += 2 * ISO_CURVATURE_EXTENT_BITS;
        }
        lowest[k] = -(below + ISO_DISCS_BEYOND_END);
        highest[k] = above + ISO_DISCS_BEYOND_END;
    }
}
