/* points.vert: attenuated points, Baerentzen and Christensen 2003, section 4.1: discs parallel to the
 * image plane, drawn as squares of which points.frag keeps the disc.
 *
 * SURFELS 1: points are iso_surfel, else iso_point (8 bytes). QUADS 0: every point is an OpenGL point;
 * those wider than the driver's largest point are left out. QUADS 1: only the latter are drawn, as quads:
 * an instance of four vertices per point. */
#ifndef SURFELS
#define SURFELS 0
#endif
#ifndef QUADS
#define QUADS 0
#endif

layout(std140, binding = ISO_GL_DRAW) uniform draw_block { ISO_GL_DRAW_FIELDS };

#if SURFELS
layout(location = ISO_GL_POSITION) in vec3 position;
layout(location = ISO_GL_NORMAL) in vec3 normal;
#else
layout(location = ISO_GL_PACKED) in uvec2 bits;
#endif
layout(location = ISO_GL_RADIUS) in float radius;
layout(location = ISO_GL_ORIGIN) in vec3 origin;

flat out vec4 normal_depth;
flat out vec3 disc; /* centre and radius, pixels */

vec3 view_normal(vec3 n) {
    vec3 v = vec3(dot(normal_x.xyz, n), dot(normal_y.xyz, n), dot(normal_z.xyz, n));
    float size = length(v);
    return size > 0.0 ? v / size : vec3(0.0, 0.0, -1.0);
}

/* The radius in pixels of a disc of `mm`. Exact (eq. 3-4): by depth. Attenuated (eq. 5-8): by the distance
 * to the eye, with a bound on the depth that holds in the whole picture. */
float pixels_of(float mm, vec3 at) {
    float focal = float(pixels.x);
    if (flags.y != 0u) return mm * focal;
    if (flags.z != 0u) return mm * focal * points.y / length(at);
    return mm * focal / at.z;
}

/* Moves the point out of the viewport. */
void leave_out() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
}

void main() {
#if SURFELS
    vec3 p = position, n = normal;
#else
    vec3 p = ISO_POINT_LOW + ISO_POINT_STEP * unpack_steps(bits);
    vec3 n = normalize(unfold_normal(unpack_normal_bits(bits)));
#endif
    vec3 at = vec3(dot(turn_x.xyz, p), dot(turn_y.xyz, p), dot(turn_z.xyz, p)) + origin;
    bool orthographic = flags.y != 0u;
    float near = float(pixels.w), scale = orthographic ? float(pixels.x) : float(pixels.x) / at.z;
    vec2 center = at.xy * scale + vec2(pixels.yz);
    disc = vec3(center, pixels_of(max(radius, 0.0), at));
    normal_depth = vec4(view_normal(n), at.z);
    float side = 2.0 * max(disc.z, 0.5) + ISO_GL_POINT_MARGIN;
    /* NaN makes these comparisons false: such points are left out */
    bool seen = at.z >= near && abs(center.x) < 1e15 && abs(center.y) < 1e15 &&
                (side > points.x) == bool(QUADS);
    if (!seen) {
        leave_out();
        return;
    }
#if QUADS
    center += side * (vec2(gl_VertexID & 1, gl_VertexID >> 1) - 0.5);
#endif
    float depth = orthographic ? (depths.x - at.z) * depths.y : near / at.z;
    gl_Position = vec4(2.0 * (center + screen.z) / screen.xy - 1.0, depth, 1.0);
    gl_PointSize = side;
}
