/* pullpush_pull.comp: pull, which makes a level from the one below: of four pixels, the frontmost and
 * those less than its interval behind it are averaged; of them, if the ellipse of any contains the coarser
 * pixel's centre, only those whose ellipse does (Marroquim, Kraus and Cavalcanti 2008, section 3.2). The
 * same as render/pullpush/pull_push_simd.h.
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

#if KEYS == 0
/* The ellipse test of a child whose ellipse's centre is at offset -d, and its depth at the coarser pixel's
 * centre. */
bool contains_centre(pixel p, vec2 d, out float z) {
    float shrink = 1.0 / float(1 << level), size = p.radius * axis.w * shrink;
    if (!orthographic) size /= max(p.shade.w, 1e-12);
    vec3 n = p.shade.xyz;
    float flat_part = dot(n.xy, n.xy), square = max(flat_part + n.z * n.z, 1e-12), b = size * size;
    float a = b + disc.y * shrink * shrink + 0.25, e = a * square - b * flat_part, outward = dot(d, n.xy);
    float rise = p.radius * sqrt(b / (a * e)) * outward;
    z = p.range.x + (n.z < 0.0 ? rise : -rise);
    return dot(d, d) * e + b * outward * outward < a * e;
}
#endif

/* The average for pixel `at`. */
pixel pulled(ivec2 at) {
    pixel children[4], sum = no_pixel();
    float depths[4];
    bool contains[4], joins[4], any_contains = false;
    float least = ISO_GL_NOWHERE, limit = -ISO_GL_NOWHERE;
    vec3 front = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        children[k] = child(2 * at + ivec2(k & 1, k >> 1));
        depths[k] = children[k].range.x;
        contains[k] = false;
        if (depths[k] >= ISO_GL_NOWHERE) continue;
#if KEYS == 0
        vec2 d = 0.25 - 0.5 * (children[k].range.zw + vec2(k & 1, k >> 1));
        contains[k] = contains_centre(children[k], d, depths[k]);
#endif
        if (depths[k] < least) {
            least = depths[k];
            limit = least + children[k].range.y;
            front = children[k].shade.xyz;
        }
    }
    if (least >= ISO_GL_NOWHERE) return sum;
    for (int k = 0; k < 4; k++) {
        joins[k] = depths[k] <= limit && (!two_sided || dot(front, children[k].shade.xyz) >= 0.0);
        any_contains = any_contains || joins[k] && contains[k];
    }
    float count = 0.0;
    sum.range = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        pixel p = children[k];
        if (!joins[k] || any_contains && !contains[k]) continue;
        count += 1.0;
        sum.shade += p.shade;
        sum.radius += p.radius;
#if COLORS
        sum.tint += p.tint;
#endif
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
    sum.range = vec4(sum.shade.w, sum.radius, sum.range.zw * share);
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
