/* pullpush_polygons.comp: the triangles of a hybrid surface, which fragment shaders have drawn into a texture
 * as large as level 0: render/pullpush/polygon_fragments.c.
 *
 * KIND 0: those at the seam go into the keys of the base level, as if they were points. KIND 1: all go into
 * the picture, over the points. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(std140, binding = ISO_GL_POLYGONS) uniform polygons_block { ISO_GL_POLYGONS_FIELDS };
layout(binding = ISO_GL_NORMAL_DEPTHS) uniform sampler2D normal_depths;

const float MOST_RADII = 4.0, SEAM = 0.5;

/* x and y of a pixel's ray: at depth 1, orthographic: at any depth, mm. */
vec2 ray_at(ivec2 at) {
    return (vec2(at.x, at.y + lattice.y) + 0.5 - ray.xy) / axis.w;
}

#if KIND == 0
bool is_large(ivec3 brick) {
    float nearest = dot(depth_row.xyz, (vec3(brick) + 0.5) * float(ISO_BRICK)) + depth_row.w - choice.z;
    if (orthographic) return choice.x > choice.y;
    return !(nearest > 0.0) || choice.x > choice.y * nearest;
}

/* Whether a place lies within SEAM of a brick that is drawn as points. */
bool is_at_seam(vec3 place) {
    vec3 index = vec3(dot(index_x.xyz, place) + index_x.w, dot(index_y.xyz, place) + index_y.w,
                      dot(index_z.xyz, place) + index_z.w);
    ivec3 low = ivec3(floor((index - SEAM) / float(ISO_BRICK)));
    ivec3 high = ivec3(floor((index + SEAM) / float(ISO_BRICK)));
    for (int z = low.z; z <= high.z; z++)
        for (int y = low.y; y <= high.y; y++)
            for (int x = low.x; x <= high.x; x++)
                if (!is_large(ivec3(x, y, z))) return true;
    return false;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(0, at)) return;
    vec4 made = texelFetch(normal_depths, at, 0);
    if (!(made.w < ISO_GL_NOWHERE)) return;
    vec3 place = vec3(ray_at(at) * (orthographic ? 1.0 : made.w), made.w);
    if (!is_at_seam(place)) return;
    vec3 n = vec3(dot(turn_x.xyz, made.xyz), dot(turn_y.xyz, made.xyz), dot(turn_z.xyz, made.xyz));
    float size = abs(n.x) + abs(n.y) + abs(n.z);
    uint payload = fold_normal(size > 0.0 ? n / size : vec3(0.0, 0.0, 1.0)) | 16u << 22 | 16u << 27;
    uvec2 key = uvec2(payload, ordered(made.w));
    int index = at.y * levels[0].x + at.x;
    uvec2 there = keys[index];
    if (key.y < there.y || key.y == there.y && key.x < there.x) keys[index] = key;
}
#else
/* Whether triangles at `depth` are drawn where points of the same surface have the depth `points`. */
bool is_in_front(ivec2 at, vec3 normal, float depth, float points) {
    if (depth <= points || depth > points + MOST_RADII * choice.w) return depth <= points;
    vec3 to = vec3(orthographic ? vec2(0.0) : ray_at(at), 1.0);
    float pixel = (orthographic ? 1.0 : depth) / axis.w;
    float rise = pixel * max(abs(normal.x), abs(normal.y)) / max(abs(dot(normal, to)), 1e-6);
    return depth <= points + min(max(choice.w, 2.0 * rise), MOST_RADII * choice.w);
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy), at = sample_at - lattice.zw;
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    vec4 made = texelFetch(normal_depths, at, 0);
    if (!(made.w < ISO_GL_NOWHERE)) return;
    int index = sample_at.y * picture.x + sample_at.x, plane = picture.x * picture.y;
    float there = uintBitsToFloat(samples[index]);
    bool same = samples[index + 4 * plane] == uint(picture.z);
    if (same ? !is_in_front(at, made.xyz, made.w, there) : !(made.w < there)) return;
    samples[index] = floatBitsToUint(ISO_GL_NOWHERE);
    put_sample(sample_at, made.w, made.xyz);
}
#endif
