/* discs.vert: makes a second-order disc of each point (render/discs/discs.h), clipped to a ball
 * and a box, and draws it as a square that contains it. The same as render/discs/disc_simd.h.
 *
 * SURFELS 1: points are iso_surfel, else iso_point (8 bytes). QUADS 0: every disc is an OpenGL point;
 * those wider than the driver's largest point are left out. QUADS 1: only the latter are drawn, as
 * quads: an instance of four vertices per disc.
 *
 * SELECT 1 and 2: nothing is drawn, but the visible points of small discs are found
 * (render/gl/selection.h) in two passes. 1: each cell gets the least depth of the points that it
 * contains, or whose discs cover the centre of its pixel. 2: the points with these depths are marked.
 * SELECT 3: the points of larger discs are marked that the fronts found so far do not hide, and those that
 * may have made these fronts, or that would change them. */
#ifndef SURFELS
#define SURFELS 0
#endif
#ifndef QUADS
#define QUADS 0
#endif
#ifndef SELECT
#define SELECT 0
#endif

#if SURFELS
layout(location = ISO_GL_POSITION) in vec3 position;
layout(location = ISO_GL_NORMAL) in vec3 normal;
#else
layout(location = ISO_GL_PACKED) in uvec2 bits;
#endif
layout(location = ISO_GL_RADIUS) in float own_radius;
layout(location = ISO_GL_CURVATURE) in ivec4 curvature;
layout(location = ISO_GL_COLOR) in vec3 color;
layout(location = ISO_GL_ORIGIN) in vec3 origin;
layout(location = ISO_GL_PLACE) in vec4 place;

out disc_block { DISC_FIELDS; };

/* Whether a normal faces away so much that curvature does not make the disc visible. */
bool is_back_facing(vec3 n, vec3 ray) {
    float away = dot(n, ray);
    return away > 0.0 && away * away > ISO_DISCS_BACK_FACING * dot(ray, ray);
}

/* How far a disc reaches on both sides of its centre along both axes of the picture, in mm at its depth:
 * the projection of a flat disc plus that of the height by which a curved one departs from it. `square`:
 * squared norm of the shape operator. */
vec2 reach_of(vec3 n, vec2 ray, float radius, float square) {
    vec2 slant = n.xy - ray * n.z, whole = 1.0 + ray * ray;
    float cap = min(sqrt(square) * radius * 0.5, 1.0);
    vec2 disc = sqrt(max(whole - slant * slant / dot(n, n), 0.0));
    return radius * 1.03 * min(disc + abs(slant) * cap, sqrt(whole));
}

/* The product of two vectors as balls are measured: in voxels where these are not cubes. */
float measured(vec3 a, vec3 b) {
    if (sizes.z == 0.0) return dot(a, b);
    return sizes.z * sizes.z * dot(a.x * normal_x.xyz + a.y * normal_y.xyz + a.z * normal_z.xyz,
                                   b.x * normal_x.xyz + b.y * normal_y.xyz + b.z * normal_z.xyz);
}

/* The values `soft` of a flat disc (set_flat_values and convolve in render/discs/disc_simd.h). */
vec4 convolved(vec3 n, vec2 ray, float away, float size) {
    vec2 slope = n.xy / max(abs(away), 1e-6);
    vec3 u = vec3(1.0 + slope.x * ray.x, slope.x * ray.y, slope.x),
         v = vec3(slope.y * ray.x, 1.0 + slope.y * ray.y, slope.y);
    float xx = measured(u, u) * size, xy = 2.0 * measured(u, v) * size, yy = measured(v, v) * size;
    const float f = ISO_DISCS_LOW_PASS * ISO_DISCS_LOW_PASS;
    float area = size / max(abs(away), 1e-6), det = area * area;
    if (sizes.z > 0.0) det = max(xx * yy - 0.25 * xy * xy, det);
    det *= f;
    float part = 1.0 / (1.0 + (xx + yy + det) * f);
    return vec4((xx + det) * part, xy * part, (yy + det) * part, sqrt(part));
}

#if SELECT
/* The values of disc_block that the hits of flat discs depend on. */
struct flat_disc {
    vec4 centre, facing, along, low, high;
};
#endif

#if SELECT >= 2
layout(std430, binding = ISO_GL_MARKED) buffer marked_buffer { uint marked[]; };

void mark() {
    atomicOr(marked[gl_VertexID >> 5], 1u << (gl_VertexID & 31));
}
#endif

#if SELECT == 3
layout(std430, binding = ISO_GL_DEEPEST) readonly buffer deepest_buffer { float deepest[]; };
layout(std430, binding = ISO_GL_MARKED_FRONTS) buffer front_buffer { uint marked_fronts[]; };
layout(binding = ISO_GL_FRONTS) uniform sampler2D fronts;

/* Squares of pixels along an axis; wider discs are not tested. */
const int SQUARES_MOST = 8;

/* Whether a disc lies behind the fronts of all pixels that it can reach, so that neither pass needs it.
 * `reach`: pixels around its centre; `nearest`: the least depth, mm, that it has anywhere, less its
 * thickness. */
bool is_behind(vec2 at, float reach, float nearest) {
    ivec2 count = (tile.xy + ISO_GL_SQUARE - 1) / ISO_GL_SQUARE;
    ivec2 first = clamp(ivec2(floor((at - reach) / ISO_GL_SQUARE)), ivec2(0), count - 1),
          last = clamp(ivec2(floor((at + reach) / ISO_GL_SQUARE)), ivec2(0), count - 1);
    if (any(greaterThanEqual(last - first, ivec2(SQUARES_MOST)))) return false;
    float most = -ISO_GL_NOWHERE;
    for (int y = first.y; y <= last.y; y++)
        for (int x = first.x; x <= last.x; x++) most = max(most, deepest[y * count.x + x]);
    return most < nearest;
}

/* Whether the fronts hide a disc: its centre in view space is `at`, in the picture `column_row`. */
bool is_hidden(vec3 at, vec2 column_row, float scale, float radius, bool filtered) {
    vec2 ray = ray_to(column_row).xy;
    float pixel = orthographic ? 1.0 / axis.w : at.z * sizes.x;
    float reach = 1.03 * radius * scale * sqrt(1.0 + dot(ray, ray)) + ISO_GL_POINT_MARGIN,
          behind = (1.0 + ISO_DISCS_THICKNESS) * radius;
    if (filtered) {
        reach += ISO_DISCS_LOW_PASS;
        behind += ISO_DISCS_LOW_PASS_DEPTH * pixel;
    }
    return at.z >= axis.z && is_behind(column_row, reach, at.z - 1.001 * behind - 1e-6 * abs(at.z));
}

/* Whether a flat disc covers a pixel no farther than its fronts (discs.frag), within what rounding and the
 * disc's box may change. */
bool is_front_at(flat_disc d, ivec2 pixel) {
    vec2 at = vec2(pixel) + 0.5;
    float mm = orthographic ? 1.0 / axis.w : d.centre.z * sizes.x, radius = d.centre.w;
    vec3 e = vec3((at - d.centre.xy) * mm, 0.0);
    float facing_eye = -(d.along.x + dot(d.along.yz, e.xy));
    if (!(facing_eye > 0.01)) return true; /* hardly exact */
    vec3 q = e + dot(d.facing.xyz, e) / facing_eye * ray_to(at);
    if (measured(q, q) > 1.002 * radius * radius) return false;
    float depth = d.centre.z + q.z - 1e-6 * abs(d.centre.z) - 2e-4 * radius;
    vec4 front = texelFetch(fronts, pixel, 0);
    if (!(d.facing.w > 0.0)) return depth <= front.y;
    return depth <= front.x || depth - ISO_DISCS_THICKNESS * radius <= front.z;
}

/* Pixels: the largest reach of discs whose pixels are looked at one by one. */
const float REACH_MOST = 2.5;

/* Whether a disc may have made a front, or would change one. */
bool is_front(flat_disc d) {
    vec2 reach = vec2(d.low.w, d.high.w) + 0.01;
    if (max(reach.x, reach.y) > REACH_MOST) return true;
    ivec2 from = max(ivec2(ceil(d.centre.xy - reach - 0.5)), ivec2(0)),
          to = min(ivec2(floor(d.centre.xy + reach - 0.5)), tile.xy - 1);
    for (int y = from.y; y <= to.y; y++)
        for (int x = from.x; x <= to.x; x++)
            if (is_front_at(d, ivec2(x, y))) return true;
    return false;
}
#endif

#if SELECT == 1 || SELECT == 2
layout(std430, binding = ISO_GL_CELLS) buffer cell_buffer { uint cells[]; };

/* Takes part in the minimum of a cell, or marks the point if it has the cell's depth. */
void enter_cell(int at, float depth) {
    uint key = ordered(depth);
#if SELECT == 1
    if (key < cells[at]) atomicMin(cells[at], key);
#else
    if (key == cells[at]) mark();
#endif
}

/* The first cell of a pixel; -1: it is too far outside the tile to have any. */
int cells_of(ivec2 pixel) {
    ivec2 at = pixel + ISO_GL_GUARD, size = tile.xy + 2 * ISO_GL_GUARD;
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) return -1;
    return (at.y * size.x + at.x) * ISO_GL_PIXEL_CELLS;
}

/* Whether the disc covers a position in the picture, and the depth of the hit: the same as discs.frag.
 * `precise`: both passes must compute the same bits. */
bool covers(flat_disc d, vec2 pixel, out float depth) {
    precise float mm = orthographic ? 1.0 / axis.w : d.centre.z * sizes.x;
    precise vec3 e = vec3((pixel - d.centre.xy) * mm, 0.0);
    precise float t = dot(d.facing.xyz, e) / -(d.along.x + dot(d.along.yz, e.xy));
    precise vec3 q = e + clamp(t, -d.centre.w, d.centre.w) * ray_to(pixel);
    vec3 at = q.x * normal_x.xyz + q.y * normal_y.xyz + q.z * normal_z.xyz;
    precise float hit = d.centre.z + q.z, square = d.centre.w * d.centre.w;
    depth = hit;
    return dot(q, q) < square && (sizes.z == 0.0 || dot(at, at) * sizes.z * sizes.z < square) &&
           all(greaterThanEqual(at, d.low.xyz)) && all(lessThanEqual(at, d.high.xyz));
}

/* Enters the point into the cell of its centre, and into those of the pixels that its disc covers. */
void enter_cells(flat_disc d) {
    ivec2 quarter = ivec2(floor(2.0 * d.centre.xy));
    int first = cells_of(quarter >> 1);
    if (first < 0) return;
    enter_cell(first + (quarter.x & 1) + 2 * (quarter.y & 1), d.centre.z);
    vec2 reach = vec2(d.low.w, d.high.w) - 0.5;
    ivec2 from = ivec2(ceil(d.centre.xy - reach - 1.0)), to = ivec2(floor(d.centre.xy + reach));
    for (int y = from.y; y <= to.y; y++)
        for (int x = from.x; x <= to.x; x++) {
            float depth;
            first = cells_of(ivec2(x, y));
            if (first >= 0 && covers(d, vec2(x, y) + 0.5, depth))
                enter_cell(first + (d.facing.w > 0.0 ? 4 : 5), depth);
        }
}
#endif

/* Moves the disc out of the viewport. */
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
    precise vec3 at = vec3(dot(step_x.xyz, p), dot(step_y.xyz, p), dot(step_z.xyz, p)) + origin;
    float length_of_n = dot(n, n);
    n *= inversesqrt(length_of_n);
    float scale = orthographic ? axis.w : axis.w / at.z;
    centre.xy = clamp(at.xy * scale + axis.xy, -ISO_GL_FURTHEST, ISO_GL_FURTHEST);
    float mm = max(own_radius * step_x.w, 0.0);
    bool curved = place.w > 0.0;
    float wide = (mm * scale - ISO_DISCS_GROW_FROM) *
                 (1.0 / (curved ? ISO_DISCS_GROW_OVER : ISO_DISCS_FLAT_GROW_OVER));
    float more = curved ? ISO_DISCS_BALL_MORE : ISO_DISCS_FLAT_MORE;
    float radius = mm * (ISO_DISCS_BALL + clamp(wide, 0.0, 1.0) * more);
    if (place.w > 0.0) radius *= disc_scale(curvature);
    centre.zw = vec2(at.z, radius);
#if SELECT == 3
    if (is_hidden(at, centre.xy, scale, radius, place.w < 0.0)) {
        leave_out();
        return;
    }
#endif

    vec3 view_normal = to_view(n), ray = ray_to(centre.xy);
    float per_length = inversesqrt(dot(view_normal, view_normal));
    view_normal *= per_length;
    bool hidden = culled && is_back_facing(view_normal, ray);
    lit = view_normal;
    mat3 s = mat3(0.0);
    if (place.w > 0.0) {
        vec3 u, v;
        make_frame(n, u, v);
        u = to_view(u);
        v = to_view(v);
        s = per_length * unpack_shape_operator(curvature, u, v, view_normal);
        view_normal += mat2x3(u, v) * (tilt(curvature) * per_length);
    }
    float facing_away = dot(view_normal, ray), curve = dot(ray, s * ray);
    /* just beyond a silhouette, a surface that curves towards the eye can still be seen */
    bool back_facing = facing_away > 0.0 && (is_back_facing(view_normal, ray) || !(curve > 0.0));
    float side = back_facing ? -1.0 : 1.0;
    view_normal *= side;
    lit *= side;
    s *= side;
    float square = norm_of(s);

    vec3 lowest = vec3(-radius * sizes.y), highest = -lowest;
#if SURFELS
    vec3 index = p + place.xyz;
#else
    vec3 index = p * ISO_POINT_STEP + place.xyz;
#endif
    float turning = ISO_DISCS_TURNING_CURVATURE * sizes.y;
    if (place.w > 0.0 && square > turning * turning) apply_extents(curvature, index, lowest, highest);
    if (border.w != 0.0) {
        lowest = max(lowest, -index);
        highest = min(highest, border.xyz - index);
    }
    bool near = !orthographic && radius > at.z * ISO_DISCS_EXACT;
    vec2 reach = reach_of(view_normal, ray.xy, radius, square) * scale;
    /* near the eye the part of a disc in front of its centre is magnified more: flat ones are as wide as
     * balls at the picture's corner (bound_discs in render/discs/common_simd.h) */
    if (near && !curved) reach = vec2(radius * scale * step_y.w);
    soft = vec4(0.0);
    if (place.w < 0.0) {
        soft = convolved(view_normal, orthographic ? vec2(0.0) : ray.xy, facing_away,
                         1.0 / (scale * scale * radius * radius));
        reach = sqrt(reach * reach + ISO_DISCS_LOW_PASS * ISO_DISCS_LOW_PASS);
    }
    facing = vec4(view_normal, side);
    entries = colored ? vec4(color, 0.0) : vec4(s[0], s[1].y);
    rest = vec4(s[1].z, s[2].z, square, float(near));
    along = vec4(facing_away * side, view_normal.xy * (orthographic ? 0.0 : 1.0 / at.z) + (s * ray).xy,
                 curve * side);
    low = vec4(lowest, reach.x);
    high = vec4(highest, reach.y);

    float width = 2.0 * max(reach.x, reach.y) + ISO_GL_POINT_MARGIN;
    /* NaN makes these comparisons false: such points are left out */
    bool seen = at.z >= axis.z && length_of_n > 1e-20 && length_of_n < 1e20 &&
                !(hidden || culled && back_facing) && (width > screen.w) == bool(QUADS);
    if (!seen) {
        leave_out();
        return;
    }
#if SELECT
    flat_disc d = flat_disc(centre, facing, along, low, high);
#if SELECT == 3
    mark();
    if (near || place.w > 0.0 || place.w < 0.0 && widened || is_front(d))
        atomicOr(marked_fronts[gl_VertexID >> 5], 1u << (gl_VertexID & 31));
#else
    enter_cells(d);
#endif
    leave_out();
    return;
#endif
    vec2 corner = centre.xy;
#if QUADS
    corner += width * (vec2(gl_VertexID & 1, gl_VertexID >> 1) - 0.5);
#endif
    gl_Position = vec4(2.0 * (corner + screen.z) / screen.xy - 1.0, 0.5, 1.0);
    gl_PointSize = width;
}
