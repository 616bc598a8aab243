/* unpack.glsl: decodes an iso_point (base/primitives.h), a point in 8 bytes. Included by other shaders. */

/* The position in steps of ISO_POINT_STEP from ISO_POINT_LOW on. */
vec3 unpack_steps(uvec2 bits) {
    const uint mask = (1u << ISO_POINT_COORDINATE_BITS) - 1u;
    return vec3(uvec3(bits.x, bits.x >> ISO_POINT_COORDINATE_BITS,
                      bits.x >> 2 * ISO_POINT_COORDINATE_BITS | bits.y << 32 - 2 * ISO_POINT_COORDINATE_BITS) &
                mask);
}

/* The 22 bits of the octahedral normal. */
uint unpack_normal_bits(uvec2 bits) {
    return bits.y >> 3 * ISO_POINT_COORDINATE_BITS - 32;
}

/* A normal with |x| + |y| + |z| = 1 from its octahedral bits (Meyer et al. 2010). */
vec3 unfold_normal(uint bits) {
    uvec2 steps = uvec2(bits, bits >> ISO_POINT_NORMAL_BITS) & uint(ISO_POINT_NORMAL_STEPS);
    vec2 uv = vec2(steps) * (2.0 / ISO_POINT_NORMAL_STEPS) - 1.0;
    float w = 1.0 - abs(uv.x) - abs(uv.y);
    float fold = max(-w, 0.0);
    uv -= mix(vec2(fold), vec2(-fold), lessThan(uv, vec2(0.0)));
    return vec3(uv, w);
}

/* The octahedral bits of a normal with |x| + |y| + |z| = 1. */
uint fold_normal(vec3 n) {
    vec2 uv = n.z < 0.0 ? mix(1.0 - abs(n.yx), abs(n.yx) - 1.0, lessThan(n.xy, vec2(0.0))) : n.xy;
    uvec2 steps = uvec2(clamp(uv * (0.5 * ISO_POINT_NORMAL_STEPS) + 0.5 * (ISO_POINT_NORMAL_STEPS + 1), 0.0,
                              float(ISO_POINT_NORMAL_STEPS)));
    return steps.x | steps.y << ISO_POINT_NORMAL_BITS;
}
