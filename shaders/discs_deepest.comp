/* discs_deepest.comp: the deepest front of each square of ISO_GL_SQUARE x ISO_GL_SQUARE pixels: what lies
 * farther behind it is hidden (render/gl/selection.h). The front of a flipped disc counts as deeper by the
 * largest thickness: a front-facing disc that is drawn later, and lies behind it by less, can take its
 * place. The samples of surfaces that were drawn before hide discs, too; they count as deeper by as much,
 * because what is averaged with a front can lie before it. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(binding = ISO_GL_FRONTS) uniform sampler2D fronts;
layout(std430, binding = ISO_GL_PICTURE) readonly buffer picture_buffer { uint samples[]; };
layout(std430, binding = ISO_GL_DEEPEST) writeonly buffer deepest_buffer { float deepest[]; };

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), count = (tile.xy + ISO_GL_SQUARE - 1) / ISO_GL_SQUARE;
    if (any(greaterThanEqual(at, count))) return;
    ivec2 first = at * ISO_GL_SQUARE, end = min(first + ISO_GL_SQUARE, tile.xy);
    float most = -ISO_GL_NOWHERE;
    for (int y = first.y; y < end.y; y++)
        for (int x = first.x; x < end.x; x++) {
            vec4 front = texelFetch(fronts, ivec2(x, y), 0);
            ivec2 in_picture = ivec2(x, y) + tile.zw;
            float before = uintBitsToFloat(samples[in_picture.y * picture.x + in_picture.x]);
            most = max(most, min(front.z <= front.y ? front.x : front.y + sizes.w, before + sizes.w));
        }
    deepest[at.y * count.x + at.x] = most;
}
