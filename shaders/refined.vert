/* Points to discs: second-order ones, within balls, that end where the surface turns away or its grid ends.
 *
 * SURFELS 1: points in floats, else packed in 8 bytes.
 * QUADS 1: one instance a point, four vertices: those that are wider than the driver's points can be.
 * Without it: all others, as points. */
#ifndef SURFELS
#define SURFELS 0
#endif
#ifndef QUADS
#define QUADS 0
#endif

#if SURFELS
layout(location = ISO_GL_POSITION) in vec3 position;
layout(location = ISO_GL_NORMAL) in vec3 normal;
#else
layout(location = ISO_GL_PACKED) in uvec2 bits;
#endif
layout(location = ISO_GL_RADIUS) in float own_radius;
layout(location = ISO_GL_BEND) in ivec4 bend;
layout(location = ISO_GL_ORIGIN) in vec3 origin;
layout(location = ISO_GL_PLACE) in vec4 place;

out disc_block { DISC_FIELDS; };

vec3 turned(vec3 covector) {
    return vec3(dot(normal_x.xyz, covector), dot(normal_y.xyz, covector), dot(normal_z.xyz, covector));
}

/* As iso_shape_frame. */
void make_frame(vec3 n, out vec3 u, out vec3 v) {
    float side = floatBitsToInt(n.z) < 0 ? -1.0 : 1.0;
    float a = -1.0 / (side + n.z), b = n.x * n.y * a;
    u = vec3(1.0 + side * (n.x * n.x * a), side * b, -(side * n.x));
    v = vec3(b, side + n.y * n.y * a, -n.y);
}

/* With a curvature along the normal too: the largest principal one where that is convex. `n` is the normal in index
 * space. */
mat3 bent(vec3 n, vec3 view_normal, float per_length) {
    if (place.w == 0.0) return mat3(0.0);
    vec3 u, v, entry = vec3(bend.xyz) * (per_length * ISO_GL_SHAPE_STEP);
    make_frame(n, u, v);
    u = turned(u);
    v = turned(v);
    mat3 s = outerProduct(u, entry.x * u + entry.y * v) + outerProduct(v, entry.y * u + entry.z * v);
    float trace = s[0].x + s[1].y + s[2].z, apart = sqrt(max(2.0 * norm_of(s) - trace * trace, 0.0));
    return s + outerProduct(view_normal, max(trace + apart, 0.0) * 0.5 * view_normal);
}

/* The box as far as it is known where the surface turns away from an edge point; `at` is in index coordinates. */
void take_ends(vec3 at, float square, inout vec3 lowest, inout vec3 highest) {
    int ends = bend.w & 0xFFFF, edge = (ends >> ISO_GL_SHAPE_AXIS_BIT) - 1;
    float turning = ISO_REFINED_TURNING_BEND * sizes.y;
    if (place.w == 0.0 || ends == 0 || !(square > turning * turning)) return;
    const float each = 1.0 / ISO_GL_SHAPE_END_STEPS;
    int next = 0;
    for (int k = 0; k < 3; k++) {
        float below = at[k] - floor(at[k]), above = 1.0 - below;
        if (below < ISO_REFINED_AT_VOXEL) below = 1.0;
        if (above < ISO_REFINED_AT_VOXEL) above = 1.0;
        if (k != edge) {
            below = float(ends >> next & ISO_GL_SHAPE_END_STEPS) * each;
            above = float(ends >> next + ISO_GL_SHAPE_END_BITS & ISO_GL_SHAPE_END_STEPS) * each;
            next += 2 * ISO_GL_SHAPE_END_BITS;
        }
        lowest[k] = -(below + each);
        highest[k] = above + each;
    }
}

/* How far the disc reaches on either side of its centre, in mm of pixels at its depth: the shadow of a flat disc, and
 * of the cap that a bent one stays below. */
vec2 reach_of(vec3 n, vec2 ray, float radius, float square) {
    vec2 slant = n.xy - ray * n.z, whole = 1.0 + ray * ray;
    float cap = min(sqrt(square) * radius * 0.5, 1.0);
    return radius * 1.03 * min(sqrt(max(whole - slant * slant, 0.0)) + abs(slant) * cap, sqrt(whole));
}

void leave_out() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
}

void main() {
#if SURFELS
    vec3 p = position, n = normal;
#else
    vec3 p = unpack_steps(bits), n = unfold_normal(unpack_normal_bits(bits));
#endif
    vec3 at = vec3(dot(step_x.xyz, p), dot(step_y.xyz, p), dot(step_z.xyz, p)) + origin;
    float length_of_n = dot(n, n);
    n *= inversesqrt(length_of_n);
    float scale = orthographic ? axis.w : axis.w / at.z;
    centre.xy = clamp(at.xy * scale + axis.xy, -ISO_GL_FURTHEST, ISO_GL_FURTHEST);
    float mm = max(own_radius, 0.0);
    float wide = (mm * scale - ISO_REFINED_GROW_FROM) * (1.0 / ISO_REFINED_GROW_OVER);
    float radius = mm * (ISO_REFINED_BALL + clamp(wide, 0.0, 1.0) * ISO_REFINED_BALL_MORE);
    centre.zw = vec2(at.z, radius);

    vec3 view_normal = turned(n), ray = ray_to(centre.xy);
    float per_length = inversesqrt(dot(view_normal, view_normal));
    view_normal *= per_length;
    mat3 s = bent(n, view_normal, per_length);
    float facing_away = dot(view_normal, ray), curve = dot(ray, s * ray);
    /* a little beyond a silhouette, what curves away from it is still in sight */
    bool far_averted = facing_away * facing_away > ISO_REFINED_AVERTED * dot(ray, ray);
    bool averted = facing_away > 0.0 && (far_averted || !(curve > 0.0));
    float side = averted ? -1.0 : 1.0;
    view_normal *= side;
    s *= side;
    float square = norm_of(s);

    vec3 lowest = vec3(-radius * sizes.y), highest = -lowest;
#if SURFELS
    vec3 index = p + place.xyz;
#else
    vec3 index = p * ISO_GL_COORDINATE_STEP + place.xyz;
#endif
    take_ends(index, square, lowest, highest);
    if (border.w != 0.0) {
        lowest = max(lowest, -index);
        highest = min(highest, border.xyz - index);
    }
    vec2 reach = reach_of(view_normal, ray.xy, radius, square) * scale;
    bool near = !orthographic && radius > at.z * ISO_REFINED_EXACT;
    facing = vec4(view_normal, side);
    bends = vec4(s[0], s[1].y);
    more = vec4(s[1].z, s[2].z, square, float(near));
    along = vec4(facing_away * side, view_normal.xy * (orthographic ? 0.0 : 1.0 / at.z) + (s * ray).xy, curve * side);
    low = vec4(lowest, reach.x);
    high = vec4(highest, reach.y);

    float width = 2.0 * max(reach.x, reach.y) + ISO_GL_POINT_MARGIN;
    /* written so that what is not a number is left out */
    bool seen = at.z >= axis.z && length_of_n > 1e-20 && length_of_n < 1e20 && !(culled && averted) &&
                (width > screen.w) == bool(QUADS);
    if (!seen) {
        leave_out();
        return;
    }
    vec2 corner = centre.xy;
#if QUADS
    corner += width * (vec2(gl_VertexID & 1, gl_VertexID >> 1) - 0.5);
#endif
    gl_Position = vec4(2.0 * (corner + screen.z) / screen.xy - 1.0, 0.5, 1.0);
    gl_PointSize = width;
}
