/* The picture's samples from level 1 and, where that is the base, from their own points: drawn where they are
 * nearer than what is there. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(std430, binding = ISO_GL_PICTURE) buffer picture_buffer { uint samples[]; };

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    uvec2 key = uvec2(ISO_GL_KEY_NONE);
    if (lattice.x == 0) key = keys[at.y * levels[0].x + at.x];
    bool has_own = key.y != ISO_GL_KEY_NONE;
    mixture m = mixed(1, at, has_own ? depth_of(key) : ISO_GL_NOWHERE);
    if (!m.made && !has_own) return;
    vec4 shade = m.made ? mixed_shade(m) : vec4(normal_of(key), depth_of(key));

    int index = sample_at.y * picture.x + sample_at.x, plane = picture.x * picture.y;
    if (!(shade.w < uintBitsToFloat(samples[index]) && shade.w < ISO_GL_NOWHERE)) return;
    float square = dot(shade.xyz, shade.xyz);
    vec3 normal = square <= 1e-20 ? vec3(0.0, 0.0, -1.0) : shade.xyz / sqrt(square);
    samples[index] = floatBitsToUint(shade.w);
    for (int k = 0; k < 3; k++) samples[index + (k + 1) * plane] = floatBitsToUint(normal[k]);
    samples[index + 4 * plane] = uint(picture.z);
}
