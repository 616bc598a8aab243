/* discs_resolve.comp: resolves the sums that discs.frag added up into samples of the picture, which
 * are written where they are nearer than the samples there. The same as render/discs/common_simd.h. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(binding = ISO_GL_FRONTS) uniform sampler2D fronts;
layout(binding = ISO_GL_SUMS) uniform sampler2D sums[4];

/* The normal (times the weight), given the sums a, b, c of discs.frag and q, the summed offset from the
 * discs' centres to the hits: the sum of the normals plus the mean shape operator times q. The second term
 * is reduced the more the shape operators differ and the larger they are, because such curvature is
 * probably noise. */
vec3 resolved_normal(vec4 a, vec4 b, vec4 c, vec3 q) {
    float noisy = ISO_DISCS_NOISY_CURVATURE * sizes.y;
    mat3 s = shape_operator(b, c) * (1.0 / a.x);
    float norm = norm_of(s);
    float alike = norm / max(c.z / a.x, 1e-30), small = 1.0 / (1.0 + norm / (noisy * noisy));
    return a.yzw + alike * small * (s * q);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, tile.xy))) return;
    vec4 front = texelFetch(fronts, at, 0);
    if (min(front.x, front.y) >= ISO_GL_NOWHERE) return;
    vec4 a = texelFetch(sums[0], at, 0), b = texelFetch(sums[1], at, 0), c = texelFetch(sums[2], at, 0);
    bool faces = front.z <= front.y;
    vec3 normal = colored ? a.yzw : resolved_normal(a, b, c, texelFetch(sums[3], at, 0).xyz);
    if (!put_sample(at + tile.zw, c.w / a.x, culled || faces ? normal : -normal)) return;
    if (colored)
        put_color(at + tile.zw, uvec3(b.xyz / a.x + 0.5));
    else if (picture.w != 0)
        put_color(at + tile.zw, uvec3(picture.w, picture.w >> 8, picture.w >> 16) & 255u);
}
