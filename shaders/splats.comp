/* splats.comp: draws discs into the slots of pixels (render/groups/groups.h). A slot keeps the smallest key,
 * so the result does not depend on the order of discs.
 *
 * KIND 2: the whole key at once, with 64-bit atomic operations. Without them two passes: KIND 0: the least
 * depth of each slot; KIND 1: of the discs with this depth, the smallest number. */
#ifndef KIND
#define KIND 0
#endif

layout(local_size_x = ISO_GL_GROUP) in;

#if KIND == 2
layout(std430, binding = ISO_GL_KEYS) buffer key_buffer { uint64_t keys[]; };
#else
layout(std430, binding = ISO_GL_KEYS) buffer key_buffer { uint keys[]; }; /* number, depth */
#endif

void merge(int at, uint depth, uint number) {
#if KIND == 2
    uint64_t key = packUint2x32(uvec2(number, depth));
    if (key < keys[at]) atomicMin(keys[at], key);
#elif KIND == 1
    if (keys[2 * at + 1] == depth && number < keys[2 * at]) atomicMin(keys[2 * at], number);
#else
    if (depth < keys[2 * at + 1]) atomicMin(keys[2 * at + 1], depth);
#endif
}

/* The first and last pixel along an axis that the disc may cover, given the centre in pixels from the optical
 * axis and the normal's component: the box around the disc, seen in perspective. */
ivec2 pixels_along(splat s, float centre, float n, float middle, int size) {
    float half_width = s.radius * sqrt(max(1.0 - n * n, 0.0)) * 1.0001;
    vec2 reach;
    if (rays.x > 0.0) {
        float deep = s.radius * sqrt(max(1.0 - s.normal_z * s.normal_z, 0.0)) * 1.0001;
        float near = max(s.z - deep, rays.z), far = s.z + deep;
        vec2 ends = centre * s.z * rays.x + vec2(-half_width, half_width);
        reach = ends / (vec2(ends.x < 0.0 ? near : far, ends.y > 0.0 ? near : far) * rays.x);
    } else {
        reach = centre + vec2(-half_width, half_width) / rays.y;
    }
    reach = vec2(min(reach.x, centre - LOW_PASS), max(reach.y, centre + LOW_PASS)) + middle - 0.5;
    reach = clamp(reach, -1.0, float(size));
    return clamp(ivec2(ceil(reach.x - 0.05), floor(reach.y + 0.05)), ivec2(0, -1), ivec2(size, size - 1));
}

/* What discs of a slot are compared by: slots.c. */
uint order_of(splat s, vec3 hit) {
    precise float depth = hit.x + thickness_of(s) * hit.y;
    if (layers.y == 0.0) return ordered(depth);
    float part = layers.w > 0.0 ? clamp((hit.x - layers.z) / layers.w, 0.0, 1.0) : 0.0;
    float bin = floor(part * layers.y), distance = sqrt(hit.y) * (1.0 - 1.0 / 4096.0);
    uint whole = uint(4294967295.0 / (layers.y + 2.0));
    return uint(bin) * whole + uint(distance * float(whole));
}

void main() {
    uint number = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * ISO_GL_GROUP +
                  gl_LocalInvocationID.x;
    if (number >= uint(counts.x)) return;
    splat s = splats[number];
    ivec2 columns = pixels_along(s, s.x, s.normal_x, axis.x, picture.x),
          rows = pixels_along(s, s.y, s.normal_y, axis.y, picture.y);
    int slot = int(s.paint & 255u);
    for (int y = rows.x; y <= rows.y; y++)
        for (int x = columns.x; x <= columns.y; x++) {
            vec3 hit = intersect(s, centre_of(ivec2(x, y)));
            if (hit.y < 1.0) merge((y * picture.x + x) * counts.y + slot, order_of(s, hit), number);
        }
}
