/* pullpush_mix.glsl: the weights with which a pixel is mixed from the four coarser pixels around it
 * (Marroquim, Kraus and Cavalcanti 2008, section 3.2). Included after pullpush.glsl. */
struct mixture {
    bool covered; /* the pixel's centre is inside an ellipse */
    bool made;    /* the pixel gets a new value */
    vec4 weights; /* sum 1 if made, else 0 */
    ivec4 at;     /* indices of the coarser pixels; -1: outside the level */
};

/* Mixes pixel `at` of the level below `level` from the four pixels of `level` around it, in the order
 * upper left, upper right, lower left, lower right. `own`: the least depth of the pixel's own value,
 * ISO_GL_NOWHERE if it has none; it is replaced when it lies behind the depth interval of the frontmost
 * ellipse that contains the pixel's centre. */
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
        vec3 wide_thin = ellipses[m.at[k]].xyz; /* WIDE, THIN_X, THIN_Y */
        vec2 d = 0.75 - 0.5 * vec2(fine) - vec2(side) - range.zw;
        float thin = dot(d, wide_thin.yz), q = dot(d, d) * wide_thin.x + thin * thin;
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
/* The mixed colour, 0 .. 255. */
vec4 mixed_tint(mixture m) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++)
        if (m.weights[k] != 0.0) sum += m.weights[k] * tints[m.at[k]];
    return sum;
}
#endif

/* The mixed normal (not unit) and depth. */
vec4 mixed_shade(mixture m) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++)
        if (m.weights[k] != 0.0) sum += m.weights[k] * shades[m.at[k]];
    return sum;
}
