/* The picture's samples from level 1 and, where that is the base, from their own points: drawn where they are
 * nearer than what is there. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(std430, binding = ISO_GL_PICTURE) buffer picture_buffer { uint samples[]; };

/* Whether the pixel's centre lies farther out than its point's disc reaches, on the side where the surface ends:
 * as `ellipse` has it, of a point alone. */
bool is_beyond(ivec2 at, pixel own) {
    vec2 slope = slope_of(0, at), away = -own.range.zw;
    vec3 n = own.shade.xyz;
    float along = dot(n.xy, slope) + n.z, outward = dot(n.xy, away);
    float length_of_ray = dot(slope, slope) + 1.0, square = dot(n, n) * length_of_ray;
    float size = own.radius * axis.w;
    if (!orthographic) size /= own.shade.w;
    float reach = (size * size + disc.z) * along * along + disc.w * square;
    return outward * along < 0.0 && reach < outward * outward * length_of_ray;
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    pixel own = no_pixel();
    if (lattice.x == 0) own = decoded(at);
    bool has_own = own.range.x < ISO_GL_NOWHERE;
    mixture m = mixed(1, at, own.range.x);
    if (!m.made && !has_own) return;
    if (has_own && !m.covered && is_beyond(at, own)) return;
    vec4 shade = m.made ? mixed_shade(m) : own.shade;

    int index = sample_at.y * picture.x + sample_at.x, plane = picture.x * picture.y;
    if (!(shade.w < uintBitsToFloat(samples[index]) && shade.w < ISO_GL_NOWHERE)) return;
    float square = dot(shade.xyz, shade.xyz);
    vec3 normal = square <= 1e-20 ? vec3(0.0, 0.0, -1.0) : shade.xyz / sqrt(square);
    samples[index] = floatBitsToUint(shade.w);
    for (int k = 0; k < 3; k++) samples[index + (k + 1) * plane] = floatBitsToUint(normal[k]);
    samples[index + 4 * plane] = uint(picture.z);
#if COLORS
    uvec3 color = uvec3((m.made ? mixed_tint(m) : own.tint).xyz + 0.5);
    samples[index + 5 * plane] = color.x | color.y << 8 | color.z << 16 | uint(picture.z + 1) << 24;
#endif
}
