/* shade.comp: shades a part of a picture into the textures of a canvas: colours, by the Phong model of
 * render/shading/shading.h or by a matcap, and with one sample a pixel also the samples, for picking.
 *
 * BUFFER 1: reads the samples from the picture buffer of pull-push. BUFFER 0: from the texture that
 * fragment shaders wrote. */
#ifndef BUFFER
#define BUFFER 0
#endif

layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(std140, binding = ISO_GL_SHADE) uniform shade_block { ISO_GL_SHADE_FIELDS };
layout(binding = ISO_GL_SPHERE) uniform sampler2D sphere;
layout(rgba8, binding = ISO_GL_COLORS) writeonly uniform image2D colors;
layout(rgba32f, binding = ISO_GL_SAMPLES) writeonly uniform image2D kept;
#if BUFFER
layout(std430, binding = ISO_GL_PICTURE) readonly buffer picture_buffer { uint samples[]; };
#else
layout(binding = ISO_GL_NORMAL_DEPTHS) uniform sampler2D normal_depths;
#endif

/* Normal and depth of a sample; the depth is infinite where there is no surface. */
vec4 fetched(ivec2 at) {
#if BUFFER
    int width = part.x * how.x, plane = width * part.y * how.x, index = at.y * width + at.x;
    return uintBitsToFloat(uvec4(samples[index + plane], samples[index + 2 * plane], samples[index + 3 * plane],
                                 samples[index]));
#else
    return texelFetch(normal_depths, at, 0);
#endif
}

/* Colour by Phong's model, with the arithmetic of render/shading/phong_simd.h. */
vec3 phong(vec3 n, vec3 to_eye) {
    const vec3 light = vec3(ISO_PHONG_LIGHT_X, ISO_PHONG_LIGHT_Y, ISO_PHONG_LIGHT_Z);
    float facing = dot(n, to_eye), side = facing < 0.0 ? -1.0 : 1.0;
    float key = max(side * dot(n, light), 0.0), fill = max(-side * n.z, 0.0);
    float mirror = key > 0.0 ? max(2.0 * key * abs(facing) - dot(light, to_eye), 0.0) : 0.0;
    float lobe = max(mirror * mirror / dot(to_eye, to_eye), 0.01);
    for (int i = 0; i < 4; i++) lobe *= lobe;
    float diffuse = ISO_PHONG_AMBIENT + ISO_PHONG_KEY * key + ISO_PHONG_FILL * fill;
    return min(color.xyz * diffuse + ISO_PHONG_SPECULAR * lobe, 1.0);
}

/* Colour by the matcap, looked up by the normal's x and y. Back-facing normals are flipped. */
vec3 looked_up(vec3 n) {
    int side = textureSize(sphere, 0).x;
    ivec2 at = ivec2((n.xy * (n.z > 0.0 ? -0.5 : 0.5) + 0.5) * float(side));
    return texelFetch(sphere, clamp(at, ivec2(0), ivec2(side - 1)), 0).xyz;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, part.xy))) return;
    vec3 sum = vec3(0.0);
    float covered = 0.0;
    for (int k = 0; k < how.x * how.x; k++) {
        ivec2 at = pixel * how.x + ivec2(k % how.x, k / how.x);
        vec4 normal_depth = fetched(at);
        if (how.y != 0) imageStore(kept, pixel + part.zw, normal_depth);
        if (isinf(normal_depth.w)) continue;
        vec2 slope = (vec2(at) + 0.5 - ray.xy) * ray.z;
        sum += how.z != 0 ? looked_up(normal_depth.xyz) : phong(normal_depth.xyz, vec3(-slope, -1.0));
        covered += 1.0;
    }
    vec3 mean = mix(background.xyz, sum / max(covered, 1.0), covered / float(how.x * how.x));
    imageStore(colors, pixel + part.zw, vec4(mean, 1.0));
}
