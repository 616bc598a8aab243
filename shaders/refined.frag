/* Where a pixel's ray meets a disc, and what the disc has there.
 *
 * ADDING 0: how near that is, of discs that face the eye and of those that were turned: the least of all. 1: what it
 * adds to the pixel, where it is at the front or joins it: sums. */
#ifndef ADDING
#define ADDING 0
#endif

in disc_block { DISC_FIELDS; };

#if ADDING
layout(binding = ISO_GL_FRONTS) uniform sampler2D fronts;
layout(location = 0) out vec4 sums_a; /* weight, normal */
layout(location = 1) out vec4 sums_b; /* shape operator: xx, xy, xz, yy */
layout(location = 2) out vec4 sums_c; /* yz, zz; the square of its norm; depth */
layout(location = 3) out vec4 sums_d; /* from the disc's centre, mm */
#else
layout(location = 0) out vec4 nearest; /* depth of those that face the eye, of others; and what the first would join */
#endif

/* From the disc's centre: the nearer root of n.q + q.Sq / 2 = 0 on the ray. False: there is none within its radius. */
bool meet(mat3 s, out vec3 q) {
    float pixel = orthographic ? 1.0 / axis.w : centre.z * sizes.x, radius = centre.w;
    vec2 off = gl_FragCoord.xy - centre.xy;
    vec3 e = vec3(off * pixel, 0.0), ray = ray_to(gl_FragCoord.xy);
    float a = along.w, b = along.x + dot(along.yz, e.xy);
    if (more.w != 0.0) {
        vec3 shape_operator_of = s * ray;
        a = dot(ray, shape_operator_of);
        b = dot(facing.xyz, ray) + dot(e, shape_operator_of);
        if (any(greaterThan(abs(off), vec2(low.w, high.w)))) return false;
    }
    float c = dot(e, 2.0 * facing.xyz + s * e), square = b * b - a * c;
    if (!(square >= 0.0)) return false;
    float depth = clamp(c / (sqrt(square) - b), -radius, radius);
    q = e + depth * ray;
    return true;
}

/* Whether voxels from the disc's centre are in its box. */
bool is_inside(vec3 at) {
    return all(greaterThanEqual(at, low.xyz)) && all(lessThanEqual(at, high.xyz));
}

void main() {
    mat3 s = shape_operator(hessian, more);
    vec3 q;
    if (!meet(s, q)) discard;
    vec3 at = q.x * normal_x.xyz + q.y * normal_y.xyz + q.z * normal_z.xyz;
    float inverse = 1.0 / (centre.w * centre.w), far = dot(q, q) * inverse;
    if (!(far < 1.0) || !is_inside(at)) discard;
    if (sizes.z > 0.0) { /* balls are measured in voxels where these are not cubes */
        far = dot(at, at) * (sizes.z * sizes.z * inverse);
        if (!(far < 1.0)) discard;
    }
    float depth = centre.z + q.z, thickness = ISO_REFINED_THICKNESS * centre.w;
    bool faces = facing.w > 0.0;
#if ADDING
    vec4 front = texelFetch(fronts, ivec2(gl_FragCoord.xy), 0);
    bool faces_wanted = front.z <= front.y;
    if (faces != faces_wanted || depth > (faces ? front.x : front.y) + thickness) discard;
    float weight = 1.0 + far * (ISO_REFINED_GAUSS_1 + far * (ISO_REFINED_GAUSS_2 + far * ISO_REFINED_GAUSS_3));
    sums_a = weight * vec4(1.0, lit);
    sums_b = weight * hessian;
    sums_c = weight * vec4(more.xyz, depth);
    sums_d = weight * vec4(q, 0.0);
#else
    nearest = vec4(ISO_GL_NOWHERE);
    if (faces)
        nearest.xz = vec2(depth, depth - thickness);
    else
        nearest.y = depth;
#endif
}
