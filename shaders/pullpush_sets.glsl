/* pullpush_sets.glsl: the pixels of an image pyramid of several sets (render/pullpush/sets.h): points,
 * triangles and ribbons. The cpu makes the fragments of the base level, which is level 0. Included by the
 * passes of sets. */
struct fragment {
    ISO_GL_SET_FRAGMENT_FIELDS
};

/* A pixel of a level above 0, as in render/pullpush/pyramid.h. */
struct pixel {
    vec4 shade;   /* normal, not unit; mean depth, mm */
    vec4 range;   /* LOW, ISO_GL_NOWHERE where there is nothing; HIGH; DX, DY */
    vec4 ellipse; /* WIDE, THIN_X, THIN_Y, OUT, whose lowest bit is HIDDEN */
    vec4 shape;   /* SHAPE_XX, SHAPE_XY, SHAPE_YY; ROOM */
    vec4 more;    /* TWICE_X, TWICE_Y; RADIUS; SET */
    vec4 tint;    /* colour, 0 .. 255 */
};

layout(std140, binding = ISO_GL_PULLPUSH) uniform sets_block { ISO_GL_SETS_FIELDS };
/* The number of each pixel's fragment in the base level, from 1 on; 0: none. */
layout(std430, binding = ISO_GL_SET_INDEX) readonly buffer index_buffer { uint index_of_base[]; };
layout(std430, binding = ISO_GL_SET_FRAGMENTS) readonly buffer fragment_buffer { fragment fragments[]; };
layout(std430, binding = ISO_GL_SET_PIXELS) buffer pixel_buffer { pixel pixels[]; };
layout(location = ISO_GL_LEVEL) uniform int level; /* that a pass makes */

const int RIBBON = 256, COLORED = 512;

bool orthographic = flags.x != 0u;

pixel no_pixel() {
    vec4 none = vec4(0.0);
    return pixel(none, vec4(ISO_GL_NOWHERE, ISO_GL_NOWHERE, 0.0, 0.0), none, none, none, none);
}

bool is_inside(int number, ivec2 at) {
    return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, levels[number].xy));
}

int place(int number, ivec2 at) {
    return levels[number].z + at.y * levels[number].x + at.x;
}

bool is_there(pixel p) {
    return p.range.x < ISO_GL_NOWHERE;
}

bool is_ribbon(float set) {
    return (int(set) & RIBBON) != 0;
}

bool is_hidden(pixel p) {
    return (floatBitsToUint(p.ellipse.w) & 1u) != 0u;
}

/* A pixel of level 0. */
pixel decoded(ivec2 at) {
    uint number = is_inside(0, at) ? index_of_base[at.y * levels[0].x + at.x] : 0u;
    if (number == 0u) return no_pixel();
    fragment f = fragments[number - 1u];
    vec3 n = unfold_normal(f.key.x);
    float depth = uintBitsToFloat(f.key.y);
    /* the fragment is assumed in the middle of its 1/32 of the pixel */
    vec2 offset = vec2(f.key.x >> 22 & 31u, f.key.x >> 27) * (1.0 / 32.0) - 31.0 / 64.0;
    return pixel(vec4(dot(normal_x.xyz, n), dot(normal_y.xyz, n), dot(normal_z.xyz, n), depth),
                 vec4(depth, depth + f.more.w, offset), vec4(0.0), f.shape,
                 vec4(f.more.xyz, float(f.key.z)),
                 vec4(vec3(uvec3(f.key.w, f.key.w >> 8, f.key.w >> 16) & 255u), 0.0));
}

/* A pixel of level 1 or higher. */
pixel fetched(int number, ivec2 at) {
    return is_inside(number, at) ? pixels[place(number, at)] : no_pixel();
}

/* x / z and y / z of the ray through the centre of a pixel of a level. */
vec2 slope_of(int number, ivec2 at) {
    vec2 whole = vec2(at.x, at.y + (lattice.y >> number));
    return ((whole + 0.5) * float(1 << number) - sight.xy) * sight.z;
}

/* invert_shape and project_disc of render/pullpush/ellipses_simd.h, with HIDDEN. */
vec4 ellipse_of(int number, ivec2 at, pixel p, bool hidden) {
    float shrink = 1.0 / float(1 << number);
    vec3 added = disc.xyz * shrink * shrink; /* low-pass, facing, edge */
    vec4 made;
    if (is_ribbon(p.more.w)) {
        vec3 m = p.shape.xyz * shrink * shrink;
        float half_turn = 0.5 * (m.x - m.z), spread = sqrt(half_turn * half_turn + m.y * m.y),
              mean = 0.5 * (m.x + m.z);
        float wide = 1.0 / max(mean + spread, 1e-12), thin = max(1.0 / max(mean - spread, 1e-12) - wide, 0.0);
        float ratio = clamp(half_turn / max(spread, 1e-12), -1.0, 1.0);
        vec2 along = sqrt(0.5 * vec2(1.0 - ratio, 1.0 + ratio) * thin);
        made = vec4(wide, along.x, m.y > 0.0 ? -along.y : along.y, ISO_GL_NOWHERE);
    } else {
        float radius = p.more.z * sight.w * shrink;
        if (!orthographic) radius /= p.shade.w;
        vec2 slope = slope_of(number, at);
        float ray_z = 1.0 / sqrt(dot(slope, slope) + 1.0);
        float along = (dot(p.shade.xy, slope) + p.shade.z) * ray_z;
        vec2 n = p.shade.xy - (along + p.shade.z) * ray_z / (1.0 + ray_z) * slope;
        float flat_part = dot(n, n), square = max(flat_part + along * along, 1e-12);
        float b = radius * radius, a = b + added.x, e = a * square - b * flat_part, inverse = 1.0 / (a * e);
        float thin = sqrt(b * inverse), outer = hidden ? added.y : added.z;
        float reach = sqrt(flat_part * ((b + added.y) * along * along + outer * flat_part) / square);
        made = vec4(e * inverse, n * (along < 0.0 ? thin : -thin), reach * thin);
        if (radius < disc.w * shrink) made.x = ISO_GL_NOWHERE; /* none */
    }
    made.w = uintBitsToFloat((floatBitsToUint(made.w) & ~1u) | uint(hidden));
    return made;
}

/* Writes a pixel of level 1 or higher and its ellipse. */
void store(int number, ivec2 at, pixel p, bool hidden) {
    if (is_there(p)) p.ellipse = ellipse_of(number, at, p, hidden);
    pixels[place(number, at)] = p;
}
