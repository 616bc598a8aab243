/* pullpush_sets_mix.glsl: how a pixel of several sets is mixed from the four coarser pixels around it.
 * Included after pullpush_sets.glsl. */
struct mixture {
    bool covered, made, foreign, hidden;
    float low, high; /* the depth interval that holds those of the coarser pixels */
    pixel value;     /* mixed, if made; range.zw: offset of the ellipse's centre */
};

float weigh(float q) {
    return max(weight.x + q * (weight.y + q * (weight.z + q * weight.w)), 1e-5);
}

/* Mixes pixel `at` of the level below `number`, whose own value is `own`. `last`: in the last push: weigh_corners
 * and choose_foreign of render/pullpush/pull_push_simd.h. */
mixture mixed(int number, ivec2 at, pixel own, bool last) {
    mixture m = mixture(false, false, false, false, ISO_GL_NOWHERE, -ISO_GL_NOWHERE, no_pixel());
    ivec2 fine = at & 1, corner = (at >> 1) + fine - 1;
    pixel corners[4];
    vec2 centres[4];
    vec4 weights = vec4(0.0);
    int front = -1;
    for (int k = 0; k < 4; k++) {
        ivec2 side = ivec2(k & 1, k >> 1);
        corners[k] = fetched(number, corner + side);
        if (!is_there(corners[k])) continue;
        vec4 e = corners[k].ellipse;
        centres[k] = 0.75 - 0.5 * vec2(fine) - vec2(side);
        vec2 d = centres[k] - corners[k].range.zw;
        float thin = dot(d, e.yz), q = dot(d, d) * e.x + thin * thin;
        if (!(e.x < ISO_GL_NOWHERE && q < 1.0 && thin <= e.w)) continue;
        weights[k] = weigh(q);
        if (front < 0 || corners[k].range.x < corners[front].range.x) front = k;
    }
    m.covered = front >= 0;
    if (!m.covered) return m;
    pixel first = corners[front];
    m.foreign = is_there(own) && own.more.w != first.more.w;
    m.made = m.foreign ? last || first.shade.w < own.range.x : !(own.range.x <= first.range.y);
    if (!m.made) return m;
    float sum = 0.0;
    m.value.range = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        pixel p = corners[k];
        if (weights[k] == 0.0 || p.range.x > first.range.y || p.more.w != first.more.w) continue;
        float same = dot(first.shade.xyz, p.shade.xyz);
        if (same < 0.0 && !is_ribbon(first.more.w) || dot(first.more.xy, p.more.xy) < 0.0) continue;
        sum += weights[k];
        m.value.shade += weights[k] * (same < 0.0 ? vec4(-p.shade.xyz, p.shade.w) : p.shade);
        m.value.range.zw += weights[k] * 2.0 * (p.range.zw - centres[k]);
        m.value.shape += weights[k] * p.shape;
        m.value.more += weights[k] * p.more;
        m.value.tint += weights[k] * p.tint;
        m.low = min(m.low, p.range.x);
        m.high = max(m.high, p.range.y);
        m.hidden = m.hidden || is_hidden(p);
    }
    float inverse = 1.0 / sum;
    m.value.shade *= inverse;
    m.value.shape *= inverse;
    m.value.tint *= inverse;
    m.value.range = vec4(m.low, m.high, m.value.range.zw * inverse);
    m.value.more = vec4(m.value.more.xyz * inverse, first.more.w);
    return m;
}
