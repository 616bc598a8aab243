/* pullpush_lines_push.comp: push of lines from `level` into the one below, which is 1 or higher: from the
 * fragments of the coarser pixels around, along their lines, to those nearest to the pixel's centre
 * (render/pullpush/line_levels.c). */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

/* Whether the ellipse of a fragment reaches within `margin` pixels of level 0 of the pixel's centre. */
bool reaches(sight s, float margin) {
    if (s.q <= 1.0 || length(s.away) * (1.0 - inversesqrt(s.q)) <= margin) return true;
    vec3 shape = fragments[s.from - 1u].shape.xyz + vec3(margin * margin, 0.0, margin * margin);
    vec2 d = s.away;
    return shape.z * d.x * d.x - 2.0 * shape.y * d.x * d.y + shape.x * d.y * d.y <=
           shape.x * shape.z - shape.y * shape.y;
}

/* Of the fragments that reach a pixel and lie behind `front` the frontmost, or one within its interval that
 * is nearer to the pixel's centre. */
uint choose_found(sight found[CANDIDATES], int count, float front, out float limit) {
    int chosen = -1;
    limit = INFINITE;
    for (int k = 0; k < count; k++) {
        float depth = depth_of(found[k].from);
        if (depth > front && (chosen < 0 || depth < depth_of(found[chosen].from))) chosen = k;
    }
    if (chosen < 0) return 0u;
    limit = depth_of(found[chosen].from) + interval_of(found[chosen].from);
    for (int k = 0; k < count; k++) {
        float depth = depth_of(found[k].from);
        if (depth > front && depth <= limit && found[k].q < found[chosen].q) chosen = k;
    }
    return found[chosen].from;
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level - 1, at)) return;
    bool over = level - 1 >= lattice.x;
    uint corner[CORNERS];
    int corners = read_corners(at, corner), count = 0, index = place(level - 1, at);
    if (corners == 0 && over) return;
    uvec2 own = over ? places[index] : uvec2(0u);
    float size = float(1 << level - 1), margin = MARGIN * size, limit, unused;
    vec2 centre = (vec2(at) + 0.5) * size;
    sight found[CANDIDATES];
    if (own.x != 0u) found[count++] = see(own.x, centre);
    if (own.y != 0u) found[count++] = see(own.y, centre);
    float last = count == 2 ? depth_of(own.y) : INFINITE; /* nothing is seen behind it */
    for (int k = 0; k < corners; k++) {
        sight s;
        if (depth_of(corner[k]) <= last && find_nearest(centre, margin, found, count, corner[k], s) &&
            reaches(s, margin))
            found[count++] = s;
    }
    uint front = choose_found(found, count, -INFINITE, limit);
    places[index] = uvec2(front, front != 0u ? choose_found(found, count, limit, unused) : 0u);
}
