/* pullpush_finish.comp: the last push, into the picture (Marroquim, Kraus and Cavalcanti 2008, section
 * 3.2). A sample is mixed from level 1, or it is the point projected to its pixel when level 0 is the
 * base. It is written where it is nearer than the sample there. The same as render/pullpush/finish.inc. */
layout(local_size_x = ISO_GL_TILE, local_size_y = ISO_GL_TILE) in;

/* Whether a pixel's centre lies outside its own point's disc on the side of the silhouette: the condition
 * that the ellipse's OUT stands for, of a single point; or where the disc is beyond the grid's border. */
bool is_beyond(ivec2 at, pixel own) {
    vec2 slope = slope_of(0, at), away = -own.range.zw;
    vec3 n = own.shade.xyz;
    float along = dot(n.xy, slope) + n.z, outward = dot(n.xy, away);
    float length_of_ray = dot(slope, slope) + 1.0, square = dot(n, n) * length_of_ray;
    float size = own.radius * axis.w;
    if (!orthographic) size /= own.shade.w;
    float reach = (size * size + disc.z) * along * along + disc.w * square;
    if (outward * along < 0.0 && reach < outward * outward * length_of_ray) return true;
    /* the disc's plane at the pixel's centre, no further than the disc reaches */
    float steep = abs(along) < 1e-6 ? 1e-6 : along, mm = (orthographic ? 1.0 : own.shade.w) / axis.w;
    return is_beyond_grid(0, at, own.shade.w + clamp(-outward * mm / steep, -own.radius, own.radius));
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    pixel own = no_pixel();
    if (lattice.x == 0) own = decoded(at);
    bool has_own = own.range.x < ISO_GL_NOWHERE;
    mixture m = mixed(1, at, own.range.x);
    if (!m.made && !has_own) return;
    if (has_own && !m.covered && !m.around && is_beyond(at, own)) return;
    vec4 shade = m.made ? mixed_shade(m) : own.shade;

    if (!put_sample(sample_at, shade.w, shade.xyz)) return;
#if COLORS
    put_color(sample_at, uvec3((m.made ? mixed_tint(m) : own.tint).xyz + 0.5));
#endif
}
