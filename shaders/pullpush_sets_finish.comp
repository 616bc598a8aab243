/* pullpush_sets_finish.comp: the last push of several sets, into the picture: complete_nearer of
 * render/pullpush/finish_simd.h. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

/* Whether a pixel's centre lies outside its own point's disc on the side of the silhouette. */
bool is_beyond_disc(ivec2 at, pixel own) {
    vec2 slope = slope_of(0, at), away = -own.range.zw;
    vec3 n = own.shade.xyz;
    float along = dot(n.xy, slope) + n.z, outward = dot(n.xy, away);
    float length_of_ray = dot(slope, slope) + 1.0, square = dot(n, n) * length_of_ray;
    float size = own.more.z * sight.w;
    if (!orthographic) size /= own.shade.w;
    float reach = (size * size + disc.y) * along * along + disc.z * square;
    return outward * along < 0.0 && reach < outward * outward * length_of_ray;
}

/* A sample's normal and depth; `covered`: an ellipse of its set covers it, so that nothing is cut off. */
vec4 completed(ivec2 at, pixel p, bool covered) {
    if (!is_there(p)) return vec4(vec3(0.0), ISO_GL_NOWHERE);
    if (!is_ribbon(p.more.w)) {
        if (!covered && is_beyond_disc(at, p)) return vec4(p.shade.xyz, ISO_GL_NOWHERE);
        return p.shade;
    }
    vec3 n = p.shade.xyz / sqrt(max(dot(p.shade.xyz, p.shade.xyz), 1e-30)), way = vec3(slope_of(0, at), 1.0);
    vec2 beside = -p.range.zw * (orthographic ? 1.0 : p.shade.w) / sight.w;
    float across = dot(way, n), steep = max(abs(across), 0.25 * sqrt(dot(way, way))), before = dot(beside, n.xy);
    return vec4(across > 0.0 ? -n : n, p.shade.w - (across > 0.0 ? before : -before) / steep);
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    pixel own = decoded(at);
    mixture m = mixed(1, at, own, true);
    pixel shown = own;
    vec4 shade;
    if (m.made) {
        shown = m.value;
        shade = completed(at, m.value, true);
    } else {
        shade = completed(at, own, m.covered);
    }
    if (m.foreign) {
        vec4 kept = completed(at, own, false);
        if (kept.w <= shade.w) {
            shown = own;
            shade = kept;
        }
    }
    int set = int(shown.more.w);
    if (!put_sample_of(set & 255, sample_at, shade.w, shade.xyz) || picture.w == 0) return;
    uvec3 color = uvec3(shown.tint.xyz + 0.5);
    put_color_of((set & COLORED) != 0 ? (set & 255) + 1 : 0, sample_at,
                 (set & COLORED) != 0 ? color : uvec3(0u));
}
