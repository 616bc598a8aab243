/* shapes_tube.glsl: the ray of a pixel and a rounded cone: render/shapes/tube_simd.h, where the formulas are
 * explained. Included by shapes.frag. */
struct tube {
    float z, radius, z1, radius1;
    vec2 last; /* pixels from the first vertex to the second */
    vec2 e1, e2, a;
    float ray_e2, ray_a, size, sine, cosine2, cone;
};

tube tube_of(vec4 f[5]) {
    return tube(f[0].x, f[0].y, f[0].z, f[0].w, f[1].xy, f[1].zw, f[2].xy, f[2].zw, f[3].x, f[3].y, f[3].z,
                f[3].w, f[4].x, f[4].y);
}

struct meeting {
    bool body;   /* on the cone, else on the sphere of an end */
    bool last;   /* the end is the second vertex's */
    bool capped; /* on a flat cap */
    float depth, s;
    float along; /* on the body: where the normal meets the axis, mm from the first vertex */
    float place; /* along the axis, mm from the first vertex */
    pixel end;   /* the pixel relative to the end's vertex */
    float end_radius;
};

/* The pixel relative to a vertex. */
pixel pixel_at_end(pixel p, tube t, bool last) {
    if (!last) return p;
    return pixel(p.offset - t.last, p.ray, p.k + (t.z1 - t.z) * p.slope, p.slope);
}

/* The sphere of the end `last` or, where that is missed, of the other: rounding may have chosen the wrong
 * one. */
bool meet_ends(pixel p, tube t, bool last, vec3 d, inout meeting m) {
    for (int k = 0; k < 2; k++) {
        float dd;
        m.last = last != (k == 1);
        m.end = pixel_at_end(p, t, m.last);
        m.end_radius = m.last ? t.radius1 : t.radius;
        float discriminant = sphere_discriminant(m.end, m.end_radius, dd);
        if (!(discriminant >= 0.0)) continue;
        m.s = sphere_root(m.end, discriminant, dd);
        m.depth = (m.last ? t.z1 : t.z) + m.s;
        m.place = (m.end.k * dot(t.a, m.end.offset) + m.s * d.z) + (m.last ? t.size : 0.0);
        return true;
    }
    return false;
}

/* The ray relative to the first vertex in the tube's frame: offset w and direction d. */
void ray_in_frame(pixel p, tube t, out vec3 w, out vec3 d) {
    w = vec3(dot(t.e1, p.offset), dot(t.e2, p.offset), dot(t.a, p.offset));
    d = p.slope * w + vec3(0.0, t.ray_e2, t.ray_a);
}

/* The first intersection with a rounded cone, without regard to flat caps. */
bool meet_tube(pixel p, tube t, out meeting m) {
    vec3 w, d;
    ray_in_frame(p, t, w, d);
    float side = p.k * t.ray_e2 * w.x, g = t.cosine2;
    float radius = t.radius + t.sine * (p.k * w.z), widening = t.sine * d.z;
    vec2 pq = t.cone * w.xy + vec2(0.0, t.ray_e2 * radius);
    float discriminant = dot(pq, pq) - g * (side * side);
    m = meeting(false, false, false, 0.0, 0.0, 0.0, 0.0, p, t.radius);
    if (!(discriminant >= 0.0)) return false; /* who misses the cone misses the spheres */
    float root = sqrt(max(g * discriminant, 0.0)), a = g * dot(d.xy, d.xy) - widening * widening,
          b = g * (p.k * dot(w.xy, d.xy)) - radius * widening,
          c = g * (p.k * p.k * dot(w.xy, w.xy)) - radius * radius;
    m.s = b < 0.0 ? c / (root - b) : -(b + root) / a; /* the one that does not cancel */
    m.place = p.k * w.z + m.s * d.z;
    float y = m.place + t.radius * t.sine;
    m.along = y / g;
    if (a < 0.0 && widening < 0.0) y = t.sine > 0.0 ? 1e30 : -1e30; /* from inside the wide end */
    m.body = y > 0.0 && y < t.size * g;
    m.depth = t.z + m.s;
    return m.body || meet_ends(p, t, y > 0.0, d, m);
}

/* Cuts off what lies beyond the vertices with flat caps. */
bool cut_tube(pixel p, tube t, uint flags, inout meeting m) {
    bool before = (flags & ISO_GL_TUBE_CUT_FIRST) != 0u && m.place < 0.0,
         beyond = (flags & ISO_GL_TUBE_CUT_LAST) != 0u && m.place > t.size;
    if (!before && !beyond) return true;
    vec3 w, d;
    ray_in_frame(p, t, w, d);
    float s = ((beyond ? t.size : 0.0) - p.k * w.z) / d.z, r = beyond ? t.radius1 : t.radius;
    vec2 at = p.k * w.xy + s * d.xy;
    bool on_cone = (beyond ? -t.sine : t.sine) > 0.0; /* the plane cuts the cone, not the sphere */
    if (!(dot(at, at) <= (on_cone ? r * r / t.cosine2 : r * r) && (beyond ? -d.z : d.z) > 0.0)) return false;
    m.capped = true;
    m.last = beyond;
    m.depth = t.z + s;
    m.place = beyond ? t.size : 0.0;
    return true;
}

/* What a pixel sees of the tube; centre: the slopes of the first vertex's ray. */
bool sees_tube(pixel p, vec2 centre, tube t, uint flags, out sight s) {
    meeting m;
    s = sight(0.0, vec3(0.0), 0.0);
    if (!meet_tube(p, t, m) || !cut_tube(p, t, flags, m)) return false;
    vec3 axis = vec3(t.a, t.ray_a - dot(centre, t.a));
    float l = m.body ? m.along : 0.0, radius = m.body ? t.radius + l * t.sine : m.end_radius;
    s.depth = m.depth;
    if (m.capped)
        s.normal = m.last ? axis : -axis;
    else
        s.normal = (vec3(m.end.k * m.end.offset + m.s * p.ray, m.s) - l * axis) / radius;
    s.along = m.body && !m.capped ? clamp(m.along / t.size, 0.0, 1.0) : m.last ? 1.0 : 0.0;
    if ((flags & ISO_GL_TUBE_SECOND_ONLY) != 0u) s.along = 1.0;
    return true;
}
