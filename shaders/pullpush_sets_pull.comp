/* pullpush_sets_pull.comp: pull of several sets: of four pixels, those of the frontmost's set whose depth
 * intervals overlap its are averaged. The same as join_intervals, average_children and stretch_shapes of
 * render/pullpush/pull_push_simd.h. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

const float REACH = 2.0;

/* Makes the ellipse of a ribbon longer: stretch_shapes. */
void stretch(inout pixel p) {
    float square = dot(p.more.xy, p.more.xy), room = min(p.shape.w, REACH * float(1 << level));
    vec2 way = p.more.xy / sqrt(max(square, 1e-12));
    float now = 0.5 * (p.shape.x + p.shape.z + way.x * (p.shape.x - p.shape.z)) + way.y * p.shape.y,
          more = 0.5 * square * square * max(room * room - now, 0.0);
    p.shape.xyz += more * vec3(1.0 + way.x, way.y, 1.0 - way.x);
}

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (!is_inside(level, at)) return;
    pixel children[4], sum = no_pixel();
    int front = 0;
    for (int k = 0; k < 4; k++) {
        ivec2 fine = 2 * at + ivec2(k & 1, k >> 1);
        children[k] = level == 1 ? decoded(fine) : fetched(level - 1, fine);
        if (children[k].range.x < children[front].range.x) front = k;
    }
    pixel first = children[front];
    if (!is_there(first)) {
        store(level, at, sum, false);
        return;
    }
    float count = 0.0, high = first.range.x;
    bool hidden = false;
    vec2 centre = vec2(0.0);
    sum.range = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        pixel p = children[k];
        if (!is_there(p) || p.more.w != first.more.w) continue;
        float same = dot(first.shade.xyz, p.shade.xyz);
        bool joins = p.range.x <= first.range.y && (same >= 0.0 || is_ribbon(first.more.w)) &&
                     dot(first.more.xy, p.more.xy) >= 0.0;
        hidden = hidden || !joins || is_hidden(p);
        if (!joins) continue;
        count += 1.0;
        high = max(high, p.range.y);
        sum.shade += same < 0.0 ? vec4(-p.shade.xyz, p.shade.w) : p.shade;
        sum.shape += p.shape;
        sum.more += p.more;
        sum.tint += p.tint;
        centre += 0.5 * (p.range.zw + vec2(k & 1, k >> 1)) - 0.25;
    }
    float share = 1.0 / count;
    sum.shade *= share;
    sum.shape *= share;
    sum.tint *= share;
    sum.more = vec4(sum.more.xyz * share, first.more.w);
    sum.range = vec4(first.range.x, high, centre * share);
    stretch(sum);
    store(level, at, sum, hidden);
}
