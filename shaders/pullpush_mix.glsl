/* A piece of pull-push's shaders, after pullpush.glsl: what the up to four coarser ellipses around a pixel make of
 * it (Marroquim, Kraus and Cavalcanti 2008, section 3.2). */
struct mixture {
    bool covered; /* where any ellipse is */
    bool made;    /* where the pixel gets a new value */
    vec4 weights; /* they add up to 1, or (not made) are 0 */
    ivec4 at;     /* the coarser pixels; -1: beyond the level's sides */
};

/* The four around finer pixel `at`: first to the left and right above, then below. `own` is the least depth of
 * what that has: it is replaced when it lies beyond the interval of the frontmost ellipse around it. */
mixture mixed(int level, ivec2 at, float own) {
    mixture m = mixture(false, false, vec4(0.0), ivec4(-1));
    ivec2 fine = at & 1, corner = (at >> 1) + fine - 1;
    vec4 low = vec4(ISO_GL_NOWHERE);
    float least = ISO_GL_NOWHERE, limit = -ISO_GL_NOWHERE;
    vec3 front = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        ivec2 side = ivec2(k & 1, k >> 1), coarse = corner + side;
        if (!is_inside(level, coarse)) continue;
        m.at[k] = place(level, coarse);
        vec4 range = ranges[m.at[k]];
        low[k] = range.x;
        if (range.x >= ISO_GL_NOWHERE) continue;
        vec3 shape = ellipses[m.at[k]].xyz;
        vec2 d = 0.75 - 0.5 * vec2(fine) - vec2(side) - range.zw;
        float thin = dot(d, shape.yz), q = dot(d, d) * shape.x + thin * thin;
        if (!(q < 1.0 && thin <= uintBitsToFloat(reaches[m.at[k]]))) continue;
        m.weights[k] = weight.x + q * (weight.y + q * (weight.z + q * weight.w));
        if (range.x < least) {
            least = range.x;
            limit = range.y;
            if (two_sided) front = shades[m.at[k]].xyz;
        }
    }
    m.covered = least < ISO_GL_NOWHERE;
    m.made = m.covered && !(own <= limit);
    if (!m.made) return mixture(m.covered, false, vec4(0.0), m.at);
    for (int k = 0; k < 4; k++) {
        bool joins = low[k] <= limit && m.weights[k] != 0.0;
        if (joins && two_sided) joins = dot(front, shades[m.at[k]].xyz) >= 0.0;
        if (!joins) m.weights[k] = 0.0;
    }
    m.weights /= m.weights.x + m.weights.y + (m.weights.z + m.weights.w);
    return m;
}

#if COLORS
vec4 mixed_tint(mixture m) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++)
        if (m.weights[k] != 0.0) sum += m.weights[k] * tints[m.at[k]];
    return sum;
}
#endif

/* Normal and depth. */
vec4 mixed_shade(mixture m) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++)
        if (m.weights[k] != 0.0) sum += m.weights[k] * shades[m.at[k]];
    return sum;
}
