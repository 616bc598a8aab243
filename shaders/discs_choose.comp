/* discs_choose.comp: lists the marked points of each block in the order of their numbers, and makes the
 * command that draws them. One invocation a block. Fresh points are those that had no mark before. */
layout(local_size_x = ISO_GL_GROUP) in;
layout(location = ISO_GL_DRAWS) uniform uvec3 draws;

struct points_command {
    uint count, instances, first, first_instance;
};
struct elements_command {
    uint count, instances, first;
    int base;
    uint first_instance;
};
layout(std430, binding = ISO_GL_COMMANDS) readonly buffer command_buffer { points_command commands[]; };
layout(std430, binding = ISO_GL_MARKED) readonly buffer marked_buffer { uint marked[]; };
layout(std430, binding = ISO_GL_MARKED_FRONTS) readonly buffer before_buffer { uint before[]; };
layout(std430, binding = ISO_GL_CHOSEN) writeonly buffer chosen_buffer { uint chosen[]; };
layout(std430, binding = ISO_GL_ELEMENTS) writeonly buffer element_buffer { elements_command elements[]; };
layout(std430, binding = ISO_GL_TOTAL) buffer total_buffer { uint total; };

void main() {
    uint number = gl_GlobalInvocationID.x + draws.x;
    if (number >= draws.y) return;
    points_command from = commands[number];
    uint end = from.first + from.count, to = from.first;
    for (uint word = from.first >> 5; word << 5 < end; word++) {
        uint bits = marked[word];
        if (draws.z != 0u) bits &= ~before[word];
        if (word << 5 < from.first) bits &= ~0u << (from.first & 31u);
        if ((word + 1u) << 5 > end) bits &= ~0u >> (32u - (end & 31u));
        for (; bits != 0u; bits &= bits - 1u) chosen[to++] = word << 5 | uint(findLSB(bits));
    }
    elements[number] = elements_command(to - from.first, 1u, from.first, 0, from.first_instance);
    atomicAdd(total, to - from.first);
}
