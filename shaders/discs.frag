/* discs.frag: intersects a pixel's ray with a disc (render/discs/discs.h), in two passes (Botsch,
 * Hornung, Zwicker and Kobbelt 2005).
 *
 * ADDING 0: writes the depth of the hit; blending keeps the least, separately of front-facing and of
 * flipped back-facing discs. ADDING 1: writes the weighted values of the disc if the hit is near the
 * front; blending adds them up. Filtered discs are added wherever the convolved disc is hit, but have a
 * front only where they are hit themselves, or with `widened` (EWA splatting) wherever they are added. */
#ifndef ADDING
#define ADDING 0
#endif

in disc_block { DISC_FIELDS; };

#if ADDING
layout(binding = ISO_GL_FRONTS) uniform sampler2D fronts;
layout(location = 0) out vec4 sums_a; /* weight, normal */
layout(location = 1) out vec4 sums_b; /* shape operator: xx, xy, xz, yy; or the colour */
layout(location = 2) out vec4 sums_c; /* yz, zz; squared norm of the shape operator; depth */
layout(location = 3) out vec4 sums_d; /* offset of the hit from the disc's centre, mm */
#else
/* Depth of a front-facing disc; depth of a flipped one; depth of a front-facing one minus its thickness: a
 * flipped disc wins where it is nearer than that. ISO_GL_NOWHERE for the other kind of disc. */
layout(location = 0) out vec4 nearest;
#endif

/* Sets q to the hit relative to the disc's centre: the nearer root of n.q + q.Sq / 2 = 0 on the ray (see
 * meet in render/discs/disc_simd.h). False: there is none. */
bool meet(mat3 s, out vec3 q) {
    float pixel = orthographic ? 1.0 / axis.w : centre.z * sizes.x, radius = centre.w;
    vec2 off = gl_FragCoord.xy - centre.xy;
    vec3 e = vec3(off * pixel, 0.0), ray = ray_to(gl_FragCoord.xy);
    float a = along.w, b = along.x + dot(along.yz, e.xy);
    if (rest.w != 0.0) {
        vec3 sd = s * ray;
        a = dot(ray, sd);
        b = dot(facing.xyz, ray) + dot(e, sd);
        if (any(greaterThan(abs(off), vec2(low.w, high.w)))) return false;
    }
    float c = dot(e, 2.0 * facing.xyz + s * e), square = b * b - a * c;
    if (!(square >= 0.0)) return false;
    if (soft.w > 0.0) radius += ISO_DISCS_LOW_PASS_DEPTH * pixel;
    float depth = clamp(c / (sqrt(square) - b), -radius, radius);
    q = e + depth * ray;
    return true;
}

/* Whether a position, in voxels from the disc's centre along the index axes, is in the disc's box. */
bool is_inside(vec3 at) {
    return all(greaterThanEqual(at, low.xyz)) && all(lessThanEqual(at, high.xyz));
}

void main() {
    mat3 s = colored ? mat3(0.0) : shape_operator(entries, rest);
    vec3 q;
    if (!meet(s, q)) discard;
    vec3 at = q.x * normal_x.xyz + q.y * normal_y.xyz + q.z * normal_z.xyz;
    float inverse = 1.0 / (centre.w * centre.w), far = dot(q, q) * inverse;
    bool covers = far < 1.0 && is_inside(at);
    if (sizes.z > 0.0) { /* voxels are not cubes: the ball is measured in voxels */
        far = dot(at, at) * (sizes.z * sizes.z * inverse);
        covers = covers && far < 1.0;
    }
    if (soft.w > 0.0 && (bool(ADDING) || widened)) {
        vec2 off = gl_FragCoord.xy - centre.xy;
        far = dot(soft.xyz, vec3(off.x * off.x, off.x * off.y, off.y * off.y));
        if (!(far < 1.0)) discard;
        covers = covers || widened;
    } else if (!covers) {
        discard;
    }
    float depth = centre.z + q.z, thickness = ISO_DISCS_THICKNESS * centre.w;
    bool faces = facing.w > 0.0;
#if ADDING
    vec4 front = texelFetch(fronts, ivec2(gl_FragCoord.xy), 0);
    bool faces_wanted = front.z <= front.y;
    float before = depth - (faces ? front.x : front.y);
    if (faces != faces_wanted || before > thickness || !covers && before < -thickness) discard;
    float weight =
        1.0 + far * (ISO_DISCS_GAUSS_1 + far * (ISO_DISCS_GAUSS_2 + far * ISO_DISCS_GAUSS_3));
    if (soft.w > 0.0) weight *= soft.w;
    sums_a = weight * vec4(1.0, lit);
    sums_b = weight * entries;
    sums_c = weight * vec4(rest.xyz, depth);
    sums_d = weight * vec4(q, 0.0);
#else
    nearest = vec4(ISO_GL_NOWHERE);
    if (faces)
        nearest.xz = vec2(depth, depth - thickness);
    else
        nearest.y = depth;
#endif
}
