/* shapes_ribbon.glsl: the ray of a pixel and a bilinear patch: render/shapes/ribbon_simd.h, where the
 * formulas are explained. Included by shapes.frag. */

/* Vectors have the components (x - u z, y - v z, z), u and v the slopes of the first vertex's ray. */
struct ribbon {
    float z;
    vec3 path, first, last; /* along the line; from the line to an edge, at both vertices */
};

/* The same projected along a pixel's ray. */
struct patch_at {
    vec2 b, path, first, last; /* b: the pixel from the first vertex, mm */
};

ribbon ribbon_of(vec4 f[3]) {
    return ribbon(f[0].x, f[0].yzw, f[1].xyz, f[2].xyz);
}

float cross2(vec2 a, vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/* Whether the patch is met at s; sets t and the depth less the first vertex's. width: of a pixel at the
 * depths of both vertices, mm. */
bool meets_at(ribbon r, patch_at q, float s, vec2 width, out float t, out float depth) {
    vec2 m = q.b - s * q.path, h = q.first + s * (q.last - q.first);
    float square = dot(h, h), beside = cross2(m, h), pixel_width = width.x + s * (width.y - width.x);
    t = dot(m, h) / square;
    depth = s * r.path.z + t * (r.first.z + s * (r.last.z - r.first.z));
    /* Seen from its edge, a ribbon has no width: rounding must not find it far from where it is. */
    bool close = beside * beside <= square * (pixel_width * pixel_width * 1e-3);
    return s >= -1e-5 && s <= 1.00001 && close && square > 0.0 && abs(t) <= 1.0;
}

/* The first intersection: s, t and the depth. */
bool meet_ribbon(pixel p, ribbon r, out vec3 found) {
    vec2 tilt = p.slope * p.offset;
    patch_at q = patch_at(p.k * p.offset, r.path.xy - r.path.z * tilt, r.first.xy - r.first.z * tilt,
                          r.last.xy - r.last.z * tilt);
    float c = cross2(q.first, q.b), last = cross2(q.last, q.b - q.path), a = cross2(q.path, q.last - q.first),
          b = last - c - a, discriminant = b * b - 4.0 * a * c;
    found = vec3(0.0);
    if (!(discriminant >= 0.0)) return false;
    float root = sqrt(discriminant), sum = -0.5 * (b + (b < 0.0 ? -root : root)), t, depth;
    vec2 width = vec2(p.k, p.k + r.path.z * p.slope);
    bool any = meets_at(r, q, c / sum, width, t, depth);
    if (any) found = vec3(c / sum, t, depth);
    if (meets_at(r, q, sum / a, width, t, depth) && !(any && depth >= found.z)) {
        found = vec3(sum / a, t, depth);
        any = true;
    }
    return any;
}

/* What a pixel sees of the ribbon, with the normal on that side; centre: the slopes of the first vertex's
 * ray. */
bool sees_ribbon(pixel p, vec2 centre, ribbon r, out sight s) {
    vec3 found;
    bool seen = meet_ribbon(p, r, found);
    s.depth = r.z + found.z;
    s.along = clamp(found.x, 0.0, 1.0);
    vec3 ds = r.path + found.y * (r.last - r.first), dt = r.first + s.along * (r.last - r.first);
    ds.xy += centre * ds.z;
    dt.xy += centre * dt.z;
    vec3 normal = cross(ds, dt);
    float size = inversesqrt(max(dot(normal, normal), 1e-36));
    s.normal = dot(normal, vec3(p.ray, 1.0)) > 0.0 ? -size * normal : size * normal;
    return seen;
}
