/* pullpush_pull.comp: pull, which makes a level from the one below: of four pixels, the frontmost and
 * those whose depth intervals overlap its interval are averaged (Marroquim, Kraus and Cavalcanti 2008,
 * section 3.1). The same as render/pullpush/levels.inc.
 *
 * KEYS 0: the level below is in the buffers of levels. KEYS 1: the level below is level 0, decoded from
 * keys. KEYS 2: no averaging: the level is the base level, decoded from keys. */
#ifndef KEYS
#define KEYS 0
#endif

layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;
layout(location = ISO_GL_LEVEL) uniform int level;

#if KEYS != 2
/* A pixel of the level below. */
pixel child(ivec2 at) {
#if KEYS == 1
    return decoded(at);
#else
    return fetched(level - 1, at);
#endif
}

/* The average for pixel `at`. */
pixel pulled(ivec2 at) {
    pixel children[4], sum = no_pixel();
    vec2 limit = sum.range.xy;
    vec3 front = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        children[k] = child(2 * at + ivec2(k & 1, k >> 1));
        if (children[k].range.x < limit.x) {
            limit = children[k].range.xy;
            front = children[k].shade.xyz;
        }
    }
    if (limit.x >= ISO_GL_NOWHERE) return sum;
    float count = 0.0;
    sum.range = vec4(limit, 0.0, 0.0);
    for (int k = 0; k < 4; k++) {
        pixel p = children[k];
        bool joins = p.range.x <= limit.y && p.range.x < ISO_GL_NOWHERE;
        if (two_sided) joins = joins && dot(front, p.shade.xyz) >= 0.0;
        if (!joins) {
            sum.hides = sum.hides || p.range.x < ISO_GL_NOWHERE;
            continue;
        }
        sum.hides = sum.hides || p.hides;
        count += 1.0;
        sum.shade += p.shade;
        sum.radius += p.radius;
#if COLORS
        sum.tint += p.tint;
#endif
        sum.range.y = max(sum.range.y, p.range.y);
        /* a child's centre lies a quarter of a coarser pixel from the coarser pixel's centre, along each
         * axis */
        sum.range.zw += 0.5 * (p.range.zw + vec2(k & 1, k >> 1)) - 0.25;
    }
    float share = 1.0 / count;
    sum.shade *= share;
    sum.radius *= share;
#if COLORS
    sum.tint *= share;
#endif
    sum.range.zw *= share;
    return sum;
}
#endif

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level, at)) return;
#if KEYS == 2
    pixel p = decoded(at);
#else
    pixel p = pulled(at);
#endif
    store(level, at, p);
}
