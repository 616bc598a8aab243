/* shapes_solid.glsl: the ray of a pixel and the unit solids of render/shapes/solid.h:
 * render/shapes/solid_simd.h, where the formulas are explained. Included by shapes.frag. */

/* What the inverse of a glyph's map makes of the picture's axes and of the centre's ray. */
struct solid {
    float z;
    vec3 x, y, ray;
};

/* The ray in the unit solid's coordinates, o + s d; crossed: o_x d_y - o_y d_x, o_x d_z - .., o_y d_z - .. */
struct unit_ray {
    vec3 o, d, crossed;
};

/* The part of a ray in a solid, and the normal where it enters. */
struct span {
    float first, last;
    vec3 normal;
    bool hit;
};

solid solid_of(vec4 f[3]) {
    return solid(f[0].x, f[0].yzw, f[1].xyz, f[2].xyz);
}

unit_ray unit_ray_of(pixel p, solid g) {
    vec3 m = p.offset.x * g.x + p.offset.y * g.y, d = g.ray + p.slope * m;
    d = mix(d, vec3(1e-20), lessThan(abs(d), vec3(1e-20))); /* so that it can be divided by */
    return unit_ray(p.k * m, d, p.k * (m.xxy * g.ray.yzz - m.yzz * g.ray.xxy));
}

/* low <= coordinate <= high. */
span meet_slab(unit_ray u, int axis, float low, float high) {
    float a = (low - u.o[axis]) / u.d[axis], b = (high - u.o[axis]) / u.d[axis];
    bool up = u.d[axis] > 0.0;
    vec3 normal = vec3(0.0);
    normal[axis] = up ? -1.0 : 1.0;
    return span(up ? a : b, up ? b : a, normal, true);
}

span common_part(span a, span b) {
    bool later = a.first < b.first;
    float first = later ? b.first : a.first, last = min(a.last, b.last);
    return span(first, last, later ? b.normal : a.normal, a.hit && b.hit && first <= last);
}

span meet_ellipsoid(unit_ray u) {
    float dd = dot(u.d, u.d), discriminant = dd - dot(u.crossed, u.crossed),
          root = sqrt(max(discriminant, 0.0)), along = dot(u.o, u.d), first = -(along + root) / dd;
    return span(first, (root - along) / dd, u.o + first * u.d, discriminant >= 0.0);
}

/* x^2 + y^2 <= radius^2. */
span meet_pipe(unit_ray u, float radius) {
    float a = dot(u.d.xy, u.d.xy), off = dot(u.o.xy, u.o.xy);
    if (a < 1e-30) /* the ray runs along the pipe */
        return span(-1e30, 1e30, vec3(u.o.xy, 0.0), off <= radius * radius);
    float discriminant = radius * radius * a - u.crossed.x * u.crossed.x, root = sqrt(max(discriminant, 0.0)),
          along = dot(u.o.xy, u.d.xy), first = -(along + root) / a;
    return span(first, (root - along) / a, vec3(u.o.xy + first * u.d.xy, 0.0), discriminant >= 0.0);
}

/* x^2 + y^2 <= w^2 and w >= 0, w = (1 - z) * widening. */
span meet_funnel(unit_ray u, float widening) {
    float w = (1.0 - u.o.z) * widening, dw = -u.d.z * widening;
    vec2 pq = widening * (u.d.xy + u.crossed.yz);
    float discriminant = dot(pq, pq) - u.crossed.x * u.crossed.x, root = sqrt(max(discriminant, 0.0));
    float a = dot(u.d.xy, u.d.xy) - dw * dw, b = dot(u.o.xy, u.d.xy) - w * dw, c = dot(u.o.xy, u.o.xy) - w * w;
    float first = b < 0.0 ? c / (root - b) : -(b + root) / a, last = b > 0.0 ? -c / (b + root) : (root - b) / a;
    /* a <= 0: the ray passes through the funnel's wide end, forwards or backwards */
    if (!(a > 0.0) && !(dw > 0.0)) first = -1e30;
    if (!(a > 0.0) && dw > 0.0) last = 1e30;
    return span(first, last, vec3(u.o.xy + first * u.d.xy, (w + first * dw) * widening), discriminant >= 0.0);
}

span meet_box(unit_ray u) {
    return common_part(common_part(meet_slab(u, 0, -1.0, 1.0), meet_slab(u, 1, -1.0, 1.0)),
                       meet_slab(u, 2, -1.0, 1.0));
}

span meet_cylinder_between(unit_ray u, float radius, float low, float high) {
    return common_part(meet_pipe(u, radius), meet_slab(u, 2, low, high));
}

/* From a base of radius 1 at z = base to the apex at z = 1. */
span meet_cone_from(unit_ray u, float base) {
    return common_part(meet_funnel(u, 1.0 / (1.0 - base)), meet_slab(u, 2, base, 1.0));
}

span meet_disc(unit_ray u) {
    span p = meet_slab(u, 2, 0.0, 0.0);
    vec2 at = u.o.xy + p.first * u.d.xy;
    p.hit = dot(at, at) <= 1.0;
    return p;
}

span meet_arrow(unit_ray u) {
    span shaft = meet_cylinder_between(u, ISO_GL_ARROW_SHAFT, -1.0, ISO_GL_ARROW_NECK),
         head = meet_cone_from(u, ISO_GL_ARROW_NECK);
    if (shaft.hit && (!head.hit || shaft.first < head.first)) return shaft;
    return head;
}

span meet_solid(int glyph, unit_ray u) {
    switch (glyph) {
    case ISO_GL_CONE:
        return meet_cone_from(u, -1.0);
    case ISO_GL_CYLINDER:
        return meet_cylinder_between(u, 1.0, -1.0, 1.0);
    case ISO_GL_ARROW:
        return meet_arrow(u);
    case ISO_GL_DISC:
        return meet_disc(u);
    case ISO_GL_BOX:
        return meet_box(u);
    default:
        return meet_ellipsoid(u);
    }
}

/* What a pixel sees of the solid. The normal comes back through the transpose of the map's inverse, whose
 * columns are x, y and what remains of the ray without them; centre: the slopes of the centre's ray. */
bool sees_solid(pixel p, vec2 centre, solid g, int glyph, out sight s) {
    span found = meet_solid(glyph, unit_ray_of(p, g));
    vec3 z = g.ray - centre.x * g.x - centre.y * g.y,
         normal = vec3(dot(found.normal, g.x), dot(found.normal, g.y), dot(found.normal, z));
    s = sight(g.z + found.first, normal * inversesqrt(max(dot(normal, normal), 1e-36)), 0.0);
    return found.hit;
}
