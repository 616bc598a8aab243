/* shapes_near.frag: where the ray of a pixel meets a shape, in double precision: render/shapes/near.c,
 * where the formulas are explained. The piece of the ray inside the shape lies between the first and the
 * last intersection with any of the surfaces that bound it. A shape that the near plane cuts is seen from
 * inside. */
flat in int number;
layout(depth_less) out float gl_FragDepth;
layout(location = ISO_GL_NORMAL_DEPTH) out vec4 out_normal_depth;
layout(location = ISO_GL_IDS) out uvec2 out_ids;

ray ray_of(vec2 at) {
    dvec2 slope = (dvec2(at) - camera.xy) / camera.z;
    return parallel ? ray(dvec3(slope, 0.0), dvec3(0.0, 0.0, 1.0)) : ray(dvec3(0.0), dvec3(slope, 1.0));
}

void meet_sphere(ray r, dvec3 centre, double radius, double along, inout piece p) {
    double dd = dot(r.direction, r.direction);
    dvec3 to = centre - r.origin;
    double middle = dot(to, r.direction) / dd;
    dvec3 off = middle * r.direction - to; /* from the centre to the ray: its square does not cancel */
    double rest = radius * radius - dot(off, off);
    if (!(radius > 0.0 && rest >= 0.0)) return;
    double half_length = sqrt(rest / dd);
    extend(p, middle - half_length, (off - half_length * r.direction) / radius, along);
    extend(p, middle + half_length, (off + half_length * r.direction) / radius, along);
}

/* The part of the cone that touches both spheres of a tube, between the circles where it does. */
void meet_cone(ray r, dvec3 first, double radius0, dvec3 axis, double size, double sine, inout piece p) {
    double g = (1.0 - sine) * (1.0 + sine), dd = dot(r.direction, r.direction);
    dvec3 to = first - r.origin;
    double shift = dot(to, r.direction) / dd; /* the ray is taken from the point nearest to the end */
    dvec3 o = shift * r.direction - to;
    double da = dot(r.direction, axis), oa = dot(o, axis), radius = radius0 + sine * oa, widening = sine * da;
    double a = g * (dd - da * da) - widening * widening,
           b = g * (dot(o, r.direction) - oa * da) - radius * widening,
           c = g * (dot(o, o) - oa * oa) - radius * radius, discriminant = b * b - a * c;
    if (!(discriminant >= 0.0)) return;
    double root = sqrt(discriminant), q = -(b + (b < 0.0 ? -root : root));
    for (int i = 0; i < 2; i++) {
        double s = i == 0 ? q / a : c / q, along = (oa + s * da + radius0 * sine) / g;
        if (!(along >= 0.0 && along <= size)) continue;
        dvec3 normal = (o + s * r.direction - along * axis) / (radius0 + sine * along);
        extend(p, shift + s, normal, along / size);
    }
}

/* Cuts the piece at the plane through an end of a tube; false when nothing is left. */
bool cut(ray r, dvec3 at, dvec3 axis, bool last, inout piece p) {
    double ahead = dot(r.direction, axis), t = dot(at - r.origin, axis) / ahead;
    int end = (last ? ahead : -ahead) > 0.0 ? 1 : 0; /* the ray leaves or enters through the plane */
    if (end == 1 ? !(t < p.t[1]) : !(t > p.t[0])) return true;
    p.t[end] = t;
    p.along[end] = last ? 1.0 : 0.0;
    p.normal[end] = last ? axis : -axis;
    return p.t[0] <= p.t[1];
}

bool meet_tube(ray r, near_shape s, inout piece p) {
    for (int end = 0; end < 2; end++) meet_sphere(r, s.ends[end].xyz, s.ends[end].w, double(end), p);
    dvec3 path = s.ends[1].xyz - s.ends[0].xyz;
    double taper = s.ends[1].w - s.ends[0].w, size = sqrt(dot(path, path));
    if (!(size > abs(taper))) return p.t[0] <= p.t[1];
    dvec3 axis = path / size;
    meet_cone(r, s.ends[0].xyz, s.ends[0].w, axis, size, taper / size, p);
    if ((s.numbers.w & ISO_GL_TUBE_CUT_FIRST) != 0u && !cut(r, s.ends[0].xyz, axis, false, p)) return false;
    if ((s.numbers.w & ISO_GL_TUBE_CUT_LAST) != 0u && !cut(r, s.ends[1].xyz, axis, true, p)) return false;
    return p.t[0] <= p.t[1];
}

/* Extends the piece to where the ray meets the patch at s, if it does. */
void extend_ribbon(ray r, near_shape shape, double s, inout piece p) {
    if (!(s >= -1e-9LF && s <= 1.000000001LF)) return;
    dvec3 first = shape.ends[0].w * shape.across[0].xyz, turn = shape.ends[1].w * shape.across[1].xyz - first,
          path = shape.ends[1].xyz - shape.ends[0].xyz,
          m = r.origin - shape.ends[0].xyz - s * path, /* from the line to the ray */
          h = first + s * turn, flat_m = cross(m, r.direction), flat_h = cross(h, r.direction);
    double t = dot(flat_m, flat_h) / dot(flat_h, flat_h);
    if (!(abs(t) <= 1.0)) return;
    double depth = dot(t * h - m, r.direction) / dot(r.direction, r.direction);
    dvec3 normal = cross(path + t * turn, h);
    double size = sqrt(dot(normal, normal));
    extend(p, depth, (dot(normal, r.direction) > 0.0 ? -normal : normal) / size, s);
}

/* A ray meets a patch up to twice: these are the ends of the piece. */
void meet_ribbon(ray r, near_shape shape, inout piece p) {
    dvec3 path = shape.ends[1].xyz - shape.ends[0].xyz, first = shape.ends[0].w * shape.across[0].xyz,
          last = shape.ends[1].w * shape.across[1].xyz, from = r.origin - shape.ends[0].xyz;
    double c = dot(cross(first, from), r.direction), end = dot(cross(last, from - path), r.direction),
           a = dot(cross(path, last - first), r.direction), b = end - c - a, discriminant = b * b - 4.0 * a * c;
    if (!(discriminant >= 0.0)) return;
    double root = sqrt(discriminant), sum = -0.5 * (b + (b < 0.0 ? -root : root));
    extend_ribbon(r, shape, c / sum, p);
    extend_ribbon(r, shape, sum / a, p);
}

piece meet(ray r, near_shape s) {
    piece p = piece(double[2](FAR_AWAY, -FAR_AWAY), dvec3[2](dvec3(0.0), dvec3(0.0)), double[2](0.0, 0.0));
    switch (KIND) {
    case ISO_GL_SPHERES:
        meet_sphere(r, s.ends[0].xyz, s.ends[0].w, 0.0, p);
        break;
    case ISO_GL_TUBES:
        if (!meet_tube(r, s, p)) p.t[1] = -FAR_AWAY;
        break;
    case ISO_GL_RIBBONS:
        meet_ribbon(r, s, p);
        break;
    default:
        p = meet_solid(r, s);
    }
    return p;
}

void main() {
    near_shape s = near_shapes[number];
    piece p = meet(ray_of(gl_FragCoord.xy), s);
    int end = p.t[0] >= camera.w ? 0 : 1; /* the first at or behind the near plane */
    if (!(p.t[0] <= p.t[1] && p.t[end] >= camera.w)) discard;
    float depth = float(p.t[end]);
    gl_FragDepth = min(buffer_depth(depth), gl_FragCoord.z);
    out_normal_depth = vec4(vec3(p.normal[end]), depth);
    out_ids = ids_of(s.numbers, float(p.along[end]));
}
