/* pullpush_push.comp: push, which fills a level, 1 or higher, from the one above: pixels without a point,
 * or with points behind the surface, are mixed from the coarser pixels around them (Marroquim, Kraus and
 * Cavalcanti 2008, section 3.2). The same as render/pullpush/pull_push_simd.h. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(location = ISO_GL_LEVEL) uniform int level;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level, at)) return;
    bool pulled = level >= lattice.x;
    float own = pulled ? ranges[place(level, at)].x : ISO_GL_NOWHERE;
    mixture m = mixed(level + 1, at, own);
    if (!m.made) { /* pixels made by pull are kept */
        if (!pulled) store(level, at, no_pixel());
        return;
    }
    pixel p = colorless(mixed_shade(m), vec4(0.0), 0.0, m.weak);
#if COLORS
    p.tint = mixed_tint(m);
#endif
    ivec2 fine = at & 1;
    for (int k = 0; k < 4; k++) {
        if (m.weights[k] == 0.0) continue;
        vec4 range = ranges[m.at[k]];
        /* offset from the finer pixel's centre to the ellipse's, in finer pixels */
        vec2 centre = 0.75 - 0.5 * vec2(fine) - vec2(k & 1, k >> 1);
        p.range.zw += m.weights[k] * 2.0 * (range.zw - centre);
        p.radius += m.weights[k] * ellipses[m.at[k]].w;
    }
    p.range.xy = vec2(p.shade.w, p.radius);
    store(level, at, p);
}
