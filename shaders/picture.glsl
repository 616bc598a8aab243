/* A piece of other shaders, after the uniform `picture`: width, height and the number of what is drawn. Its samples lie
 * in planes: depth, normal x, y, z, surface, and colours where there are any. */
layout(std430, binding = ISO_GL_PICTURE) buffer picture_buffer { uint samples[]; };

/* Where it is nearer than what is there; whether it was. Normals have any length. */
bool put_sample(ivec2 at, float depth, vec3 normal) {
    int index = at.y * picture.x + at.x, plane = picture.x * picture.y;
    if (!(depth < uintBitsToFloat(samples[index]) && depth < ISO_GL_NOWHERE)) return false;
    float square = dot(normal, normal);
    vec3 unit = square <= 1e-20 ? vec3(0.0, 0.0, -1.0) : normal / sqrt(square);
    samples[index] = floatBitsToUint(depth);
    for (int k = 0; k < 3; k++) samples[index + (k + 1) * plane] = floatBitsToUint(unit[k]);
    samples[index + 4 * plane] = uint(picture.z);
    return true;
}

/* Of a sample that was put: bytes 0 .. 255. */
void put_color(ivec2 at, uvec3 color) {
    int index = at.y * picture.x + at.x, plane = picture.x * picture.y;
    samples[index + 5 * plane] = color.x | color.y << 8 | color.z << 16 | uint(picture.z + 1) << 24;
}
