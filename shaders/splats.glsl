/* splats.glsl: discs of splats, and where the ray of a pixel meets one: the same as render/groups/banded_discs.h. */
layout(std140, binding = ISO_GL_SPLATTING) uniform splatting_block { ISO_GL_SPLATTING_FIELDS };

struct splat {
    float x, y, z, normal_x, normal_y, normal_z, radius;
    uint paint; /* the group, and the colour in the upper three bytes */
};
layout(std430, binding = ISO_GL_SPLATS) readonly buffer splat_buffer { splat splats[]; };

const float LOW_PASS = 0.70711; /* ISO_DISC_LOW_PASS */

/* Where the ray through (x, y), pixels from the optical axis, meets a disc: depth; e; 1 if the disc faces
 * away. The disc covers the pixel when e < 1. `precise`: all passes must compute the same bits. */
vec3 intersect(splat s, vec2 at) {
    precise vec2 off = at - vec2(s.x, s.y), slope = at * rays.x;
    precise float facing = s.normal_x * slope.x + s.normal_y * slope.y + s.normal_z;
    precise vec2 q = off * (rays.y + s.z * rays.x);
    precise float t = -(s.normal_x * q.x + s.normal_y * q.y) / facing;
    precise vec2 p = q + t * slope;
    precise float exact = (p.x * p.x + p.y * p.y + t * t) / (s.radius * s.radius);
    precise float low = (off.x * off.x + off.y * off.y) / (LOW_PASS * LOW_PASS);
    bool on_disc = exact < low && s.z + t >= rays.z;
    precise float depth = s.z + (on_disc || abs(t) <= s.radius ? t
                                 : t > s.radius                ? s.radius
                                 : t < -s.radius               ? -s.radius
                                                               : 0.0);
    return vec3(max(depth, rays.z), on_disc ? exact : low, facing > 0.0 ? 1.0 : 0.0);
}

/* How far behind its front a layer may still have the disc, mm. */
float thickness_of(splat s) {
    return s.radius * rays.w;
}

/* The centre of a pixel, in pixels from the optical axis. */
vec2 centre_of(ivec2 at) {
    return vec2(at) + 0.5 - axis.xy;
}

/* The weight of a hit, exp(-3 e). */
float weight_of(float e) {
    float y = 1.5 * e,
          root = 1.0 + y * (1.0 + y * (1.0 / 2.0 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y / 120.0))));
    return 1.0 / (root * root);
}
