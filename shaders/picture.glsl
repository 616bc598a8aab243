/* picture.glsl: writes samples of the picture with a depth test. Included by shaders that have declared
 * the uniform `picture`: width, height and the number of the surface that is drawn. The buffer has one
 * plane each for depth, normal x, y, z, surface number and, if points have colours, colour. */
layout(std430, binding = ISO_GL_PICTURE) buffer picture_buffer { uint samples[]; };

/* Writes a sample of a surface if it is nearer than the one there; returns whether it was. The normal need not
 * be unit. */
bool put_sample_of(int surface, ivec2 at, float depth, vec3 normal) {
    int index = at.y * picture.x + at.x, plane = picture.x * picture.y;
    if (!(depth < uintBitsToFloat(samples[index]) && depth < ISO_GL_NOWHERE)) return false;
    float square = dot(normal, normal);
    vec3 unit = square <= 1e-20 ? vec3(0.0, 0.0, -1.0) : normal / sqrt(square);
    samples[index] = floatBitsToUint(depth);
    for (int k = 0; k < 3; k++) samples[index + (k + 1) * plane] = floatBitsToUint(unit[k]);
    samples[index + 4 * plane] = uint(surface);
    return true;
}

/* Writes the colour (0 .. 255) of a sample for which that returned true. `mark`: 1 + the surface number. */
void put_color_of(int mark, ivec2 at, uvec3 color) {
    int index = at.y * picture.x + at.x, plane = picture.x * picture.y;
    samples[index + 5 * plane] = color.x | color.y << 8 | color.z << 16 | uint(mark) << 24;
}

/* The same of the surface that is drawn. */
bool put_sample(ivec2 at, float depth, vec3 normal) {
    return put_sample_of(picture.z, at, depth, normal);
}

void put_color(ivec2 at, uvec3 color) {
    put_color_of(picture.z + 1, at, color);
}
