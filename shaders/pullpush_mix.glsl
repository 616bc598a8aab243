/* pullpush_mix.glsl: the weights with which a pixel is mixed from the four coarser pixels around it
 * (Marroquim, Kraus and Cavalcanti 2008, section 3.2). Included after pullpush.glsl. */
struct mixture {
    bool covered; /* the pixel's centre is inside an ellipse */
    bool around;  /* all coarser pixels around it have values that are not weak */
    bool made;    /* the pixel gets a new value */
    bool weak;    /* which is weak */
    vec4 weights; /* sum 1 if made, else 0 */
    ivec4 at;     /* indices of the coarser pixels; -1: outside the level */
};

float weigh(float q) {
    return max(weight.x + q * (weight.y + q * (weight.z + q * weight.w)), 1e-5);
}

/* Mixes pixel `at` of the level below `level` from the four pixels of `level` around it, in the order
 * upper left, upper right, lower left, lower right. `own`: the depth of the pixel's own value, ISO_GL_NOWHERE
 * if it has none; it is replaced when it lies behind the frontmost ellipse that contains the pixel's centre,
 * by more than its interval. Pixels in gaps between ellipses get values, too: render/pullpush/gaps_simd.h says
 * which. */
mixture mixed(int level, ivec2 at, float own) {
    const float grow = 1.4, round = 0.05;
    mixture m = mixture(false, true, false, false, vec4(0.0), ivec4(-1));
    ivec2 fine = at & 1, corner = (at >> 1) + fine - 1;
    vec2 offsets[4];
    vec4 depths = vec4(ISO_GL_NOWHERE); /* of the coarser pixels' discs at this pixel */
    int front = -1;
    for (int k = 0; k < 4; k++) {
        ivec2 side = ivec2(k & 1, k >> 1), coarse = corner + side;
        bool there = is_inside(level, coarse);
        if (there) {
            m.at[k] = place(level, coarse);
            there = ranges[m.at[k]].x < ISO_GL_NOWHERE;
        }
        m.around = m.around && there && (reaches[m.at[k]] & 1u) == 0u;
        if (!there) continue;
        vec4 range = ranges[m.at[k]];
        vec3 wide_thin = ellipses[m.at[k]].xyz; /* WIDE, THIN_X, THIN_Y */
        vec2 d = 0.75 - 0.5 * vec2(fine) - vec2(side) - range.zw;
        float thin = dot(d, wide_thin.yz), q = dot(d, d) * wide_thin.x + thin * thin;
        offsets[k] = d;
        depths[k] = range.x + ellipses[m.at[k]].w * thin;
        if (!(q < 1.0 && thin <= uintBitsToFloat(reaches[m.at[k]]))) continue;
        if (is_beyond_grid(level - 1, at, depths[k])) continue;
        m.weights[k] = weigh(q);
        if (front < 0 || depths[k] < depths[front]) front = k;
    }
    m.covered = front >= 0;
    bool gap = !m.covered && own >= ISO_GL_NOWHERE && (m.around || level > 1), farthest = gap && m.around;
    for (int k = 0; k < 4 && gap; k++) {
        if (depths[k] >= ISO_GL_NOWHERE) continue;
        /* the ellipse, half a coarser pixel wider */
        vec3 wide_thin = ellipses[m.at[k]].xyz;
        float square = max(dot(wide_thin.yz, wide_thin.yz), 1e-12), thin = dot(offsets[k], wide_thin.yz);
        float t = thin * thin / square, across = 1.0 / (1.0 / wide_thin.x + 0.25);
        float minor = 1.0 / (wide_thin.x + square) + 0.25 + (m.around ? round / wide_thin.x : 0.0);
        float q = across * (dot(offsets[k], offsets[k]) - t) + t / minor;
        if (m.around) q /= grow * grow;
        if (!(q < 1.0) || level == 1 && is_beyond_grid(level - 1, at, depths[k])) continue;
        m.weights[k] = weigh(q);
        if (front < 0 || (farthest ? depths[k] > depths[front] : depths[k] < depths[front])) front = k;
    }
    if (front < 0) return m;
    float interval = ranges[m.at[front]].y, limit = depths[front] + (farthest ? -interval : interval);
    m.made = gap || !(own <= limit);
    if (!m.made) m.weights = vec4(0.0);
    if (!m.made) return m;
    m.weak = gap && !m.around;
    for (int k = 0; k < 4; k++) {
        if (m.weights[k] == 0.0) continue;
        bool joins = farthest ? depths[k] >= limit : depths[k] <= limit;
        if (two_sided) joins = joins && dot(shades[m.at[front]].xyz, shades[m.at[k]].xyz) >= 0.0;
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
