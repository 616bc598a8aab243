/* pullpush_lines_pull.comp: pull of lines: of the frontmost fragments of a pixel's four children it shows the
 * one nearest to its centre, and likewise one that lies behind (render/pullpush/line_levels.c).
 *
 * KIND 0: puts the numbers of fragments into the pixels of the base level. KIND 1: the level above the base
 * or higher. KIND 2: the base level itself, which is 1 or higher. */
#if KIND == 0
layout(local_size_x = ISO_GL_GROUP) in;

void main() {
    uint number = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * ISO_GL_GROUP +
                  gl_LocalInvocationID.x;
    if (number >= flags.w) return;
    ivec2 at = pixel_of(number + 1u);
    index_of_base[at.y * levels[lattice.x].x + at.x] = number + 1u;
}
#else
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

/* Of some fragments those that lie behind `front`, and of those the ones within the interval behind the
 * frontmost: the one nearest to `at`. */
uint choose(uint children[8], vec2 at, float front, out float limit) {
    uint chosen = 0u;
    float low = INFINITE, least = INFINITE;
    limit = INFINITE;
    for (int k = 0; k < 8; k++) {
        if (children[k] == 0u) continue;
        float depth = depth_of(children[k]);
        if (depth >= low || depth <= front) continue;
        low = depth;
        limit = low + interval_of(children[k]);
    }
    for (int k = 0; k < 8 && low < INFINITE; k++) {
        if (children[k] == 0u) continue;
        float depth = depth_of(children[k]);
        if (depth > limit || depth <= front) continue;
        vec2 away = at - spot_of(children[k]);
        float square = dot(away, away);
        if (square >= least) continue;
        least = square;
        chosen = children[k];
    }
    return chosen;
}

uvec2 child(ivec2 at) {
    return level - 1 == lattice.x ? uvec2(base_number(at), 0u) : numbers_at(level - 1, at);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level, at)) return;
#if KIND == 2
    places[place(level, at)] = uvec2(base_number(at), 0u);
#else
    uint children[8];
    float limit, unused;
    for (int k = 0; k < 4; k++) {
        uvec2 numbers = child(2 * at + ivec2(k & 1, k >> 1));
        children[k] = numbers.x;
        children[k + 4] = numbers.y;
    }
    vec2 centre = (vec2(at) + 0.5) * float(1 << level);
    uint front = choose(children, centre, -INFINITE, limit);
    places[place(level, at)] = uvec2(front, choose(children, centre, limit, unused));
#endif
}
#endif
