/* pullpush_project.comp: projects points to keys (render/pullpush/pyramid.h): each point goes into the
 * pixel of the base level that contains its centre, and the smallest key of a pixel is kept. The result
 * does not depend on the order of points.
 *
 * KIND 3: the whole key at once, with 64-bit atomic operations. Without them two passes: KIND 0: the least
 * depth of each pixel; KIND 1: of the points with this depth, the smallest payload. Afterwards, for points
 * with radii or colours: KIND 2: of the points with the pixel's key, the smallest radius and the smallest
 * colour. SURFELS 1: points are iso_surfel, else iso_point (8 bytes). */
#ifndef KIND
#define KIND 0
#endif
#ifndef SURFELS
#define SURFELS 0
#endif

layout(local_size_x = ISO_GL_GROUP) in;

struct block {
    ISO_GL_BLOCK_FIELDS
};

layout(std140, binding = ISO_GL_PULLPUSH) uniform pullpush_block { ISO_GL_PULLPUSH_FIELDS };
layout(std430, binding = ISO_GL_POINTS) readonly buffer point_buffer { uint points[]; };
layout(std430, binding = ISO_GL_RADII) readonly buffer radius_buffer { float radii[]; };
layout(std430, binding = ISO_GL_BLOCKS) readonly buffer block_buffer { block blocks[]; };
#if KIND == 3
layout(std430, binding = ISO_GL_KEYS) buffer key_buffer { uint64_t keys[]; };
#else
layout(std430, binding = ISO_GL_KEYS) buffer key_buffer { uint keys[]; }; /* payload, depth */
#endif
layout(std430, binding = ISO_GL_DISCS) buffer disc_buffer { uint discs[]; };
layout(std430, binding = ISO_GL_PAINTS) readonly buffer paint_buffer { uint paints[]; };
layout(location = ISO_GL_FIRST) uniform uvec2 range;

/* A row of the transform of positions. `precise`: all passes must compute the same bits. */
float transformed(vec4 row, vec3 at, float origin) {
    precise float sum = row.x * at.x + row.y * at.y + row.z * at.z + origin;
    return sum;
}

/* A pixel coordinate from the coordinate at depth 1, 1 / depth and the optical axis. */
float projected(float view, float shrink, float along) {
    precise float at = view * shrink + along;
    return clamp(at, -ISO_GL_FURTHEST, ISO_GL_FURTHEST);
}

/* The three bytes of a point's colour, red lowest. */
uint color_of(uint number) {
    uint bits = 24u * number, word = bits >> 5, shift = bits & 31u;
    uint color = paints[word] >> shift;
    if (shift > 8u) color |= paints[word + 1u] << 32u - shift;
    return color & 0xFFFFFFu;
}

/* Merges a projected point into pixel `at`. */
void merge(int at, uint depth, uint payload, uint number) {
#if KIND == 3
    uint64_t key = packUint2x32(uvec2(payload, depth));
    if (key < keys[at]) atomicMin(keys[at], key);
#elif KIND == 2
    if (keys[2 * at + 1] != depth || keys[2 * at] != payload) return;
    if (flags.z != 0u) atomicMin(discs[at], floatBitsToUint(max(radii[number], 0.0)));
    ivec2 size = levels[lattice.x].xy;
    if (flags.w != 0u) atomicMin(discs[size.x * size.y + at], color_of(number));
#elif KIND == 1
    if (keys[2 * at + 1] == depth && payload < keys[2 * at]) atomicMin(keys[2 * at], payload);
#else
    if (depth < keys[2 * at + 1]) atomicMin(keys[2 * at + 1], depth);
#endif
}

/* Projects point `number` of the bound points. Returns early for points that are not drawn. Conditions are
 * written so that they are false for NaN: such points are left out. */
void project(block b, uint number) {
#if SURFELS
    vec3 at, normal;
    for (int k = 0; k < 3; k++) {
        at[k] = uintBitsToFloat(points[6u * number + k]);
        normal[k] = uintBitsToFloat(points[6u * number + 3u + k]);
    }
    float size = abs(normal.x) + abs(normal.y) + abs(normal.z);
    if (!(size > 0.0 && size <= 3.4028235e38)) return;
    normal /= size;
    uint bits = fold_normal(normal);
#else
    uvec2 packed_point = uvec2(points[2u * number], points[2u * number + 1u]);
    vec3 at = unpack_steps(packed_point);
    uint bits = unpack_normal_bits(packed_point);
    vec3 normal = unfold_normal(bits);
#endif
    bool orthographic = flags.x != 0u;
    vec3 from_eye = orthographic ? b.eye.xyz : at - b.eye.xyz;
    if (b.part.z != 0u && !(dot(normal, from_eye) < 0.0)) return;
    float z = transformed(step_z, at, b.origin.z);
    if (!(z >= axis.z)) return;
    precise float shrink = orthographic ? 1.0 : 1.0 / z;
    vec2 pixel = vec2(projected(transformed(step_x, at, b.origin.x), shrink, axis.x),
                      projected(transformed(step_y, at, b.origin.y), shrink, axis.y));
    vec2 corner = floor(pixel);
    ivec2 whole = ivec2(corner) - ivec2(0, lattice.y >> lattice.x), size_of_level = levels[lattice.x].xy;
    if (!(corner.x >= 0.0 && whole.x < size_of_level.x && whole.y >= 0 && whole.y < size_of_level.y)) return;
    uvec2 part = uvec2((pixel - corner) * 32.0);
    merge(whole.y * size_of_level.x + whole.x, ordered(z), bits | part.x << 22 | part.y << 27, number);
}

void main() {
    uint number = range.x + gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (number >= range.y) return;
    block b = blocks[number];
    for (uint i = gl_LocalInvocationID.x; i < b.part.y; i += ISO_GL_GROUP) project(b, b.part.x + i);
}
