/* splats_resolve.comp: averages the front layer of the discs in a pixel's slots into a sample of the picture:
 * the same as render/groups/slots.c. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(std430, binding = ISO_GL_KEYS) readonly buffer key_buffer { uvec2 keys[]; }; /* number, depth */

/* The nearest hit of the slots from `first` on; its depth is ISO_GL_NOWHERE when they are empty. */
vec3 find_front(int first, vec2 at) {
    vec3 front = vec3(ISO_GL_NOWHERE);
    for (int k = 0; k < counts.y; k++) {
        uvec2 key = keys[first + k];
        if (key.y == ISO_GL_KEY_NONE) continue;
        vec3 hit = intersect(splats[key.x], at);
        if (hit.x < front.x) front = hit;
    }
    return front;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, picture.xy))) return;
    int first = (pixel.y * picture.x + pixel.x) * counts.y;
    vec2 at = centre_of(pixel);
    vec3 front = find_front(first, at), normal = vec3(0.0), color = vec3(0.0);
    if (!(front.x < ISO_GL_NOWHERE)) return;
    float weight = 0.0, depth = 0.0;
    for (int k = 0; k < counts.y; k++) {
        uvec2 key = keys[first + k];
        if (key.y == ISO_GL_KEY_NONE) continue;
        splat s = splats[key.x];
        vec3 hit = intersect(s, at);
        if (hit.z != front.z || hit.x > front.x + thickness_of(s)) continue;
        float w = weight_of(hit.y);
        weight += w;
        depth += w * hit.x;
        normal += w * vec3(s.normal_x, s.normal_y, s.normal_z);
        color += w * vec3(uvec3(s.paint >> 8, s.paint >> 16, s.paint >> 24) & 255u);
    }
    if (put_sample(pixel, depth / weight, normal) && counts.z != 0)
        put_color(pixel, uvec3(color / weight + 0.5));
}
