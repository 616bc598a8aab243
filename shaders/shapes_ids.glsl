/* shapes_ids.glsl: the second output of the shaders of lines and glyphs: colour (three bytes) and surface
 * number + 1; element + 1, and in the highest bit whether a line was widened to the least width. */
uvec2 ids_of(uvec4 numbers, float along) {
    vec3 first = vec3(uvec3(numbers.y, numbers.y >> 8, numbers.y >> 16) & 255u),
         last = vec3(uvec3(numbers.z, numbers.z >> 8, numbers.z >> 16) & 255u);
    uvec3 color = uvec3(first + along * (last - first) + 0.5);
    uint widened = (numbers.w & ISO_GL_TUBE_WIDENED) != 0u ? 0x80000000u : 0u;
    return uvec2(color.x | color.y << 8 | color.z << 16 | uint(set.x + 1) << 24, (numbers.x + 1u) | widened);
}
