/* pullpush.glsl: reads and writes pixels of the image pyramid of pull-push (render/pullpush/pyramid.h).
 * Levels are stored one after the other in buffers; pixels outside a level count as empty. Included by the
 * passes of pull-push.
 *
 * COLORS 1: points have colours of their own. */
#ifndef COLORS
#define COLORS 0
#endif

layout(std140, binding = ISO_GL_PULLPUSH) uniform pullpush_block { ISO_GL_PULLPUSH_FIELDS };
layout(std430, binding = ISO_GL_KEYS) buffer key_buffer { uvec2 keys[]; };
layout(std430, binding = ISO_GL_DISCS) buffer disc_buffer { uint discs[]; };
layout(std430, binding = ISO_GL_SHADES) buffer shade_buffer { vec4 shades[]; };
layout(std430, binding = ISO_GL_RANGES) buffer range_buffer { vec4 ranges[]; };
layout(std430, binding = ISO_GL_ELLIPSES) buffer ellipse_buffer { vec4 ellipses[]; };
layout(std430, binding = ISO_GL_REACHES) buffer reach_buffer { uint reaches[]; };
#if COLORS
layout(std430, binding = ISO_GL_TINTS) buffer tint_buffer { vec4 tints[]; };
#endif

bool orthographic = flags.x != 0u, two_sided = flags.y != 0u;

struct pixel {
    vec4 shade;   /* mean normal, not unit; mean depth, mm */
    vec4 range;   /* depth, mm, ISO_GL_NOWHERE without a point; interval, mm; offset of the ellipse's centre
                     from the pixel's, pixels */
    float radius; /* mean radius of discs, mm */
    bool weak;    /* made by push where an ellipse meets the pixel though not its centre (mixed) */
#if COLORS
    vec4 tint; /* colour, 0 .. 255 */
#endif
};

pixel colorless(vec4 shade, vec4 range, float radius, bool weak) {
#if COLORS
    return pixel(shade, range, radius, weak, vec4(0.0));
#else
    return pixel(shade, range, radius, weak);
#endif
}

pixel no_pixel() {
    return colorless(vec4(0.0), vec4(ISO_GL_NOWHERE, 0.0, 0.0, 0.0), 0.0, false);
}

bool is_inside(int level, ivec2 at) {
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, levels[level].xy));
}

/* Index of a pixel in the buffers; level 1 or higher. */
int place(int level, ivec2 at) {
    return levels[level].z + at.y * levels[level].x + at.x;
}

/* The depth of a key: the inverse of `ordered` in shared.h. */
float depth_of(uvec2 key) {
    return uintBitsToFloat(key.y >> 31 != 0u ? key.y ^ 0x80000000u : ~key.y);
}

/* The view space normal of a key, not unit. */
vec3 normal_of(uvec2 key) {
    vec3 n = unfold_normal(key.x);
    return vec3(dot(normal_x.xyz, n), dot(normal_y.xyz, n), dot(normal_z.xyz, n));
}

/* A pixel of the base level, decoded from its key. */
pixel decoded(ivec2 at) {
    if (!is_inside(lattice.x, at)) return no_pixel();
    int index = at.y * levels[lattice.x].x + at.x;
    uvec2 key = keys[index];
    if (key.y == ISO_GL_KEY_NONE) return no_pixel();
    float depth = depth_of(key);
    float radius = flags.z != 0u ? ISO_GL_DISC_RADII * uintBitsToFloat(discs[index]) : disc.x;
    /* the point is assumed in the middle of its 1/32 of the pixel */
    vec2 offset = vec2(key.x >> 22 & 31u, key.x >> 27) * (1.0 / 32.0) - 31.0 / 64.0;
    pixel p = colorless(vec4(normal_of(key), depth), vec4(depth, radius, offset), radius, false);
#if COLORS
    uint color = discs[levels[lattice.x].x * levels[lattice.x].y + index];
    p.tint.xyz = vec3(uvec3(color, color >> 8, color >> 16) & 255u);
#endif
    return p;
}

/* A pixel of level 1 or higher. */
pixel fetched(int level, ivec2 at) {
    if (!is_inside(level, at)) return no_pixel();
    int index = place(level, at);
    pixel p = colorless(shades[index], ranges[index], ellipses[index].w, (reaches[index] & 1u) != 0u);
#if COLORS
    p.tint = tints[index];
#endif
    return p;
}

/* x / z and y / z of the ray through the centre of a pixel of a level. */
vec2 slope_of(int level, ivec2 at) {
    vec2 whole = vec2(at.x, at.y + (lattice.y >> level));
    return ((whole + 0.5) * float(1 << level) - ray.xy) * ray.z;
}

/* The ellipse of a pixel as in render/pullpush/pyramid.h: WIDE, THIN_X, THIN_Y, OUT; WIDE is 0 where there
 * is no point. It is the projection of the pixel's disc along the pixel's ray, low-pass filtered (Zwicker
 * et al. 2001). See ellipses in render/pullpush/pull_push_simd.h for the derivation. */
vec4 ellipse(int level, ivec2 at, pixel p) {
    if (p.range.x >= ISO_GL_NOWHERE) return vec4(0.0);
    float shrink = 1.0 / float(1 << level);
    vec3 added = disc.yzw * shrink * shrink; /* low-pass, facing, edge */
    float radius = p.radius * axis.w * shrink;
    if (!orthographic) radius /= p.shade.w;
    vec2 slope = slope_of(level, at);
    float ray_z = 1.0 / sqrt(dot(slope, slope) + 1.0);
    float along = (dot(p.shade.xy, slope) + p.shade.z) * ray_z;
    /* rotate the normal as the ray must be rotated to lie on the optical axis */
    vec2 n = p.shade.xy - (along + p.shade.z) * ray_z / (1.0 + ray_z) * slope;
    float flat_part = dot(n, n), square = max(flat_part + along * along, 1e-12);
    float b = radius * radius, a = b + added.x, e = a * square - b * flat_part, inverse = 1.0 / (a * e);
    float thin = sqrt(b * inverse);
    float reach = sqrt(flat_part * ((b + added.y) * along * along + added.z * flat_part) / square);
    return vec4(e * inverse, n * (along < 0.0 ? thin : -thin), reach * thin);
}

/* Whether the ray of a pixel, at depth z, is beyond the border of the points' grid by more than points on the
 * border are rounded: 0.005 voxels and 0.02 pixels (render/pullpush/gaps_simd.h). */
bool is_beyond_grid(int level, ivec2 at, float z) {
    if (border.w == 0.0) return false;
    vec2 whole = vec2(at.x, at.y + (lattice.y >> level));
    vec2 view = ((whole + 0.5) * float(1 << level) - ray.xy) / axis.w;
    if (!orthographic) view *= z;
    vec3 index = eye.xyz + normal_x.xyz * view.x + normal_y.xyz * view.y + normal_z.xyz * z;
    float mm = 0.02 * (orthographic ? 1.0 : z) / axis.w;
    vec3 x = normal_x.xyz, y = normal_y.xyz, dir = normal_z.xyz;
    vec3 rounded = 0.005 + mm * sqrt(x * x + y * y + dir * dir);
    return any(lessThan(index, -rounded)) || any(greaterThan(index, border.xyz + rounded));
}

/* Writes a pixel of level 1 or higher and its ellipse. */
void store(int level, ivec2 at, pixel p) {
    int index = place(level, at);
    vec4 e = ellipse(level, at, p);
    shades[index] = p.shade;
    ranges[index] = p.range;
    ellipses[index] = vec4(e.xyz, p.radius);
    reaches[index] = (floatBitsToUint(e.w) & ~1u) | uint(p.weak);
#if COLORS
    tints[index] = p.tint;
#endif
}
