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

/* Whether a fragment is of the line of `front` (0: none) and within its interval. */
bool is_of_front(uint number, uint front) {
    return front != 0u && line_of(number) == line_of(front) &&
           depth_of(number) <= depth_of(front) + interval_of(front);
}

/* Of some fragments, but for those of `front`, the line of the frontmost: of its fragments within the interval
 * behind it, the one nearest to `at`. */
uint choose(uint children[8], vec2 at, uint front) {
    uint chosen = 0u, first = 0u;
    float least = INFINITE;
    for (int k = 0; k < 8; k++)
        if (children[k] != 0u && !is_of_front(children[k], front) &&
            (first == 0u || depth_of(children[k]) < depth_of(first)))
            first = children[k];
    for (int k = 0; k < 8; k++) {
        if (children[k] == 0u || is_of_front(children[k], front) || !is_of_front(children[k], first)) continue;
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
    for (int k = 0; k < 4; k++) {
        uvec2 numbers = child(2 * at + ivec2(k & 1, k >> 1));
        children[k] = numbers.x;
        children[k + 4] = numbers.y;
    }
    vec2 centre = (vec2(at) + 0.5) * float(1 << level);
    uint front = choose(children, centre, 0u);
    places[place(level, at)] = uvec2(front, front != 0u ? choose(children, centre, front) : 0u);
#endif
}
#endif
