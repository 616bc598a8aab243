/* pullpush_finish.comp: the last push, into the picture (Marroquim, Kraus and Cavalcanti 2008, section
 * 3.2). A sample is mixed from level 1, or it is the point projected to its pixel when level 0 is the
 * base. It is written where it is nearer than the sample there. The same as render/pullpush/finish_simd.h. */
const float PP_SUPPORT_REACH = 16.0, PP_SUPPORT_RADIUS = 1.0, PP_SUPPORT_GROW = 1.1;
const float PP_RIM_PART = 0.7, PP_RIM_REACH = 6.0;

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

/* Whether the ellipse of the point in pixel `from` of the base level, of PP_SUPPORT_GROW times its disc,
 * contains pixel `at` of level 0. */
bool contains_sample(ivec2 at, ivec2 from) {
    pixel p = decoded(from);
    if (p.range.x >= ISO_GL_NOWHERE) return false;
    vec2 slope = slope_of(0, at);
    float ray_z = 1.0 / sqrt(dot(slope, slope) + 1.0);
    float along = (dot(p.shade.xy, slope) + p.shade.z) * ray_z;
    vec2 n = p.shade.xy - (along + p.shade.z) * ray_z / (1.0 + ray_z) * slope;
    float length = PP_SUPPORT_GROW * p.radius, radius = length * axis.w;
    if (!orthographic) radius /= p.shade.w;
    vec2 d = (vec2(from) + 0.5 + p.range.zw) * float(1 << lattice.x) - vec2(at) - 0.5;
    float flat_part = dot(n, n), square = max(flat_part + along * along, 1e-12), b = radius * radius;
    float a = b + disc.y, e = a * square - b * flat_part, outward = dot(d, n);
    float limit = flat_part * ((b + disc.z) * along * along + disc.w * flat_part);
    if (outward * along > 0.0 && limit < outward * outward * square) return false;
    if (!(dot(d, d) * e + b * outward * outward < a * e)) return false;
    float rise = length * sqrt(b / (a * e)) * outward;
    return !is_beyond_grid(0, at, p.shade.w + (along < 0.0 ? -rise : rise));
}

/* Whether a point supports pixel `at` of level 0, where discs have a radius, mm, at a depth: finish_simd.h. */
bool is_supported(ivec2 at, float radius, float depth) {
    float widest = radius * PP_SUPPORT_GROW * axis.w, size = float(1 << lattice.x);
    if (!orthographic) widest /= depth;
    if (widest < PP_SUPPORT_RADIUS) return true;
    float reach = min(sqrt(widest * widest + disc.y), PP_SUPPORT_REACH * size);
    ivec2 low = max(ivec2(floor((vec2(at) + 0.5 - reach) / size)), ivec2(0));
    ivec2 high = min(ivec2(floor((vec2(at) + 0.5 + reach) / size)), levels[lattice.x].xy - 1);
    for (int y = low.y; y <= high.y; y++)
        for (int x = low.x; x <= high.x; x++)
            if (contains_sample(at, ivec2(x, y))) return true;
    return false;
}

/* The same of a value in a gap. */
bool is_gap_supported(ivec2 at, mixture m) {
    float nearest = ISO_GL_NOWHERE, widest = 0.0;
    for (int k = 0; k < 4; k++) {
        nearest = min(nearest, ranges[m.at[k]].x);
        widest = max(widest, ellipses[m.at[k]].w);
    }
    return is_supported(at, widest, nearest);
}

/* The nearest point whose disc pixel `at` of level 0 meets, at the depth where it does; no_pixel if there is
 * none: rims of finish_simd.h. */
pixel rim(ivec2 at, mixture m) {
    float nearest = ISO_GL_NOWHERE, widest = 0.0, size = float(1 << lattice.x);
    for (int k = 0; k < 4; k++) {
        if (m.at[k] < 0 || ranges[m.at[k]].x >= ISO_GL_NOWHERE) continue;
        nearest = min(nearest, ranges[m.at[k]].x);
        widest = max(widest, ellipses[m.at[k]].w);
    }
    float radius = widest * axis.w;
    if (!orthographic) radius /= nearest;
    pixel found = no_pixel();
    found.shade.w = ISO_GL_NOWHERE;
    if (!(radius >= PP_SUPPORT_RADIUS)) return found;
    float reach = min(PP_RIM_PART * radius, PP_RIM_REACH * size);
    vec2 slope = slope_of(0, at);
    float ray_z = 1.0 / sqrt(dot(slope, slope) + 1.0);
    ivec2 low = max(ivec2(floor((vec2(at) + 0.5 - reach) / size)), ivec2(0));
    ivec2 high = min(ivec2(floor((vec2(at) + 0.5 + reach) / size)), levels[lattice.x].xy - 1);
    for (int y = low.y; y <= high.y; y++)
        for (int x = low.x; x <= high.x; x++) {
            pixel p = decoded(ivec2(x, y));
            if (p.range.x >= ISO_GL_NOWHERE) continue;
            float along = (dot(p.shade.xy, slope) + p.shade.z) * ray_z;
            vec2 n = p.shade.xy - (along + p.shade.z) * ray_z / (1.0 + ray_z) * slope;
            vec2 d = (vec2(x, y) + 0.5 + p.range.zw) * size - vec2(at) - 0.5;
            float mm = (orthographic ? 1.0 : p.shade.w) / axis.w, part = PP_RIM_PART * p.radius / mm;
            float steep = along * along, outward = dot(d, n), z = p.shade.w + mm * outward / along;
            if (!(dot(d, d) * steep + outward * outward < part * part * steep && z < found.shade.w)) continue;
            if (is_beyond_grid(0, at, z)) continue;
            found = p;
            found.shade.w = z;
        }
    return found;
}

void main() {
    ivec2 sample_at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(sample_at, picture.xy))) return;
    ivec2 at = sample_at - lattice.zw;
    pixel own = no_pixel();
    if (lattice.x == 0) own = decoded(at);
    bool has_own = own.range.x < ISO_GL_NOWHERE;
    mixture m = mixed(1, at, own.range.x);
    if (m.made && !m.covered && !is_gap_supported(at, m)) m.made = false;
    if (has_own && !m.covered && is_beyond(at, own) &&
        !(m.around && is_supported(at, own.radius, own.shade.w)))
        has_own = false;
    if (!m.made && !has_own) {
        own = rim(at, m);
        if (own.range.x >= ISO_GL_NOWHERE) return;
    }
    vec4 shade = m.made ? mixed_shade(m) : own.shade;

    if (!put_sample(sample_at, shade.w, shade.xyz)) return;
#if COLORS
    put_color(sample_at, uvec3((m.made ? mixed_tint(m) : own.tint).xyz + 0.5));
#endif
}
