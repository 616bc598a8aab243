/* shapes_near_solid.glsl: rays and unit solids in double precision: the second part of render/shapes/near.c.
 * Included by shapes_near.frag after shapes_near.glsl. */

/* Keeps the part of the piece where low <= coordinate <= high. */
void keep_slab(ray r, int axis, double low, double high, inout piece p) {
    double d = r.direction[axis], o = r.origin[axis];
    if (d == 0.0) {
        if (o < low || o > high) p.t[1] = -FAR_AWAY;
        return;
    }
    double enter = ((d < 0.0 ? high : low) - o) / d, leave = ((d > 0.0 ? high : low) - o) / d;
    /* (NVIDIA's compiler has no assignment to a component of a dvec3 whose number is a variable) */
    dvec3 normal = (d > 0.0 ? 1.0LF : -1.0LF) * dvec3(double(axis == 0), double(axis == 1), double(axis == 2));
    if (enter > p.t[0]) {
        p.t[0] = enter;
        p.normal[0] = -normal;
    }
    if (leave < p.t[1]) {
        p.t[1] = leave;
        p.normal[1] = normal;
    }
}

/* Keeps the part of the piece where x^2 + y^2 + round z^2 <= (radius + slant z)^2 and the right side's
 * root is not negative. */
void keep_quadric(ray r, double roundness, double radius, double slant, inout piece p) {
    dvec3 o = r.origin, d = r.direction;
    double w = radius + slant * o.z, dw = slant * d.z,
           a = dot(d.xy, d.xy) + roundness * d.z * d.z - dw * dw,
           b = dot(o.xy, d.xy) + roundness * o.z * d.z - w * dw,
           c = dot(o.xy, o.xy) + roundness * o.z * o.z - w * w, discriminant = b * b - a * c;
    if (a == 0.0 && b == 0.0 && c <= 0.0) return; /* along a cylinder */
    if (!(discriminant >= 0.0)) {
        p.t[1] = -FAR_AWAY;
        return;
    }
    double root = sqrt(discriminant), q = -(b + (b < 0.0 ? -root : root)), x = q / a, y = c / q;
    double roots[2] = double[2](x < y ? x : y, x < y ? y : x);
    if (a < 0.0) { /* the ray passes through the cone's wide end */
        double near_root = roots[0], far_root = roots[1];
        roots[0] = dw > 0.0 ? far_root : -FAR_AWAY;
        roots[1] = dw > 0.0 ? FAR_AWAY : near_root;
    }
    for (int end = 0; end < 2; end++) {
        if (end == 1 ? !(roots[1] < p.t[1]) : !(roots[0] > p.t[0])) continue;
        double t = roots[end], z = o.z + t * d.z;
        p.t[end] = t;
        p.normal[end] = dvec3(o.xy + t * d.xy, roundness * z - slant * (radius + slant * z));
    }
}

piece whole_ray() {
    return piece(double[2](-FAR_AWAY, FAR_AWAY), dvec3[2](dvec3(0.0), dvec3(0.0)), double[2](0.0, 0.0));
}

piece cone_from(ray r, double base) {
    piece p = whole_ray();
    keep_quadric(r, 0.0, 1.0 / (1.0 - base), -1.0 / (1.0 - base), p);
    keep_slab(r, 2, base, 1.0, p);
    return p;
}

piece cylinder(ray r, double radius, double low, double high) {
    piece p = whole_ray();
    keep_quadric(r, 0.0, radius, 0.0, p);
    keep_slab(r, 2, low, high, p);
    return p;
}

/* The first piece behind the near plane of an arrow: head and shaft touch, so that a piece may continue in
 * the other. */
piece arrow(ray r, double near_plane) {
    piece shaft = cylinder(r, ISO_GL_ARROW_SHAFT, -1.0, ISO_GL_ARROW_NECK), head = cone_from(r, ISO_GL_ARROW_NECK);
    if (!(shaft.t[0] <= shaft.t[1])) return head;
    if (!(head.t[0] <= head.t[1])) return shaft;
    bool swapped = head.t[0] < shaft.t[0];
    piece a = shaft, b = head;
    if (swapped) {
        a = head;
        b = shaft;
    }
    if (a.t[1] < b.t[0] - 1e-9 * abs(b.t[0])) {
        if (a.t[1] >= near_plane) return a;
        return b;
    }
    if (b.t[1] > a.t[1]) {
        a.t[1] = b.t[1];
        a.normal[1] = b.normal[1];
    }
    return a;
}

piece meet_unit(int glyph, ray r, double near_plane) {
    piece p = whole_ray();
    switch (glyph) {
    case ISO_GL_CONE:
        return cone_from(r, -1.0);
    case ISO_GL_CYLINDER:
        return cylinder(r, 1.0, -1.0, 1.0);
    case ISO_GL_ARROW:
        return arrow(r, near_plane);
    case ISO_GL_DISC:
        return cylinder(r, 1.0, 0.0, 0.0);
    case ISO_GL_BOX:
        for (int axis = 0; axis < 3; axis++) keep_slab(r, axis, -1.0, 1.0, p);
        return p;
    default:
        keep_quadric(r, 1.0, 1.0, 0.0, p);
        return p;
    }
}

/* The ray is taken from the point nearest to the solid's centre. */
piece meet_solid(ray r, near_shape s) {
    dvec3 to = s.ends[0].xyz - r.origin;
    double shift = dot(to, r.direction) / dot(r.direction, r.direction);
    dvec3 from = shift * r.direction - to;
    dvec3 x = s.inverse[0].xyz, y = s.inverse[1].xyz, z = s.inverse[2].xyz;
    ray unit = ray(dvec3(dot(x, from), dot(y, from), dot(z, from)),
                   dvec3(dot(x, r.direction), dot(y, r.direction), dot(z, r.direction)));
    piece p = meet_unit(GLYPH, unit, camera.w - shift);
    for (int end = 0; end < 2; end++) {
        dvec3 n = p.normal[end].x * x + p.normal[end].y * y + p.normal[end].z * z;
        p.t[end] += shift;
        p.normal[end] = n / sqrt(dot(n, n));
    }
    return p;
}
