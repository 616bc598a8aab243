/* shapes_box.glsl: boxes of shapes in the picture, in pixels: the same as render/shapes/sphere_block_simd.h,
 * line_block_simd.h and solid.c. */

/* The interval of pixels that a sphere covers along both axes, relative to its centre's: low x, y, high x, y;
 * u: the slopes of its centre's ray. */
vec4 sphere_reach(vec2 u, float z, float radius) {
    if (rays.y == 0.0) {
        float high = radius * (parallel ? lens.z : lens.z / z);
        return vec4(-high, -high, high, high);
    }
    float away = (z - radius) * (z + radius), scale = lens.z / away;
    vec2 x = u * z, across = radius * sqrt(x * x + away), shift = u * (radius * radius);
    return vec4(shift - across, shift + across) * scale;
}

/* A depth that no visible sample of a sphere is nearer than, rounding included. */
float sphere_nearest(float z, float radius) {
    return z - radius * 1.00001 - abs(z) * 1e-6;
}

/* A point in the picture: a sphere's centre or a vertex. */
struct end {
    float z, radius;
    vec2 at, u; /* pixels relative to the origin's pixel; slopes of its ray */
    bool widened;
    vec4 reach; /* box of its sphere, relative to the origin's pixel */
};

/* The point at an offset, in view space, from the origin. */
end end_of(vec4 origin_pixel, vec4 origin_ray, vec3 offset, float radius) {
    end e;
    e.z = origin_ray.x + (offset.z + origin_ray.y);
    float scale = parallel ? lens.z : lens.z / e.z, thinnest = e.z * least.x + least.y;
    e.widened = radius < thinnest;
    e.radius = max(radius, thinnest);
    e.at = origin_pixel.zw + (offset.xy - origin_ray.zw * offset.z) * scale;
    e.u = origin_ray.zw + (e.at - origin_pixel.zw) * rays.x;
    e.reach = e.at.xyxy + sphere_reach(e.u, e.z, e.radius);
    return e;
}

/* The box of two boxes. */
vec4 both(vec4 a, vec4 b) {
    return vec4(min(a.xy, b.xy), max(a.zw, b.zw));
}

/* The position of a corner of a box of pixels, with a margin for rounding, at the given depth. Boxes are
 * clamped so that the driver's own rounding of positions does not grow. */
vec4 corner_of(vec4 box, int corner, float nearest) {
    vec2 margin = vec2(ISO_GL_SHAPE_MARGIN) + 4e-6 * (box.zw - box.xy);
    vec4 clamped = clamp(box + vec4(-margin, margin), vec4(-1.0), screen.xyxy + 1.0);
    vec2 at = vec2((corner & 1) != 0 ? clamped.z : clamped.x, (corner & 2) != 0 ? clamped.w : clamped.y);
    return vec4(2.0 * at / screen.xy - 1.0, buffer_depth(nearest), 1.0);
}

#if KIND == ISO_GL_SOLIDS
/* A solid in view space: slopes and depth of its centre, and the images of the unit vectors. Its box counts
 * from the projection of its centre. */
struct solid_box {
    vec4 pixels;
    float front;
};

/* Adds an ellipsoid, a disc or a point at `shift` from the centre. The tangent planes through the eye, x =
 * k z, touch it where a quadratic in k is 0. */
void add_ellipsoid(inout solid_box box, vec3 centre, vec3 shift, mat3 axes) {
    vec3 deep = vec3(axes[0].z, axes[1].z, axes[2].z);
    float depth = dot(deep, deep), z = centre.z + shift.z;
    vec2 wide = axes[0].xy * axes[0].xy + axes[1].xy * axes[1].xy + axes[2].xy * axes[2].xy,
         mixed = axes[0].xy * deep.x + axes[1].xy * deep.y + axes[2].xy * deep.z;
    vec2 middle = shift.xy, across = sqrt(wide);
    if (rays.y != 0.0) {
        vec2 beside = (shift.xy - centre.xy * shift.z) / z, k = centre.xy + beside;
        float scale = z * z - depth;
        vec2 p = mixed - k * depth, q = wide - 2.0 * k * mixed + k * k * depth;
        across = sqrt(max(p * p + q * scale, 0.0)) / scale;
        middle = beside - p / scale;
    }
    box.pixels = both(box.pixels, vec4(middle - across, middle + across));
    box.front = min(box.front, z - sqrt(depth));
}

/* Adds the image of a circle around the local z axis; radius 0: a point. */
void add_circle(inout solid_box box, vec3 centre, mat3 axes, float z, float radius) {
    add_ellipsoid(box, centre, z * axes[2], mat3(radius * axes[0], radius * axes[1], vec3(0.0)));
}

solid_box solid_box_of(int glyph, vec3 centre, mat3 axes) {
    solid_box box = solid_box(vec4(1e30, 1e30, -1e30, -1e30), 1e30);
    for (int k = 0; k < 8 && glyph == ISO_GL_BOX; k++)
        add_ellipsoid(box, centre,
                      axes * vec3((k & 1) != 0 ? 1.0 : -1.0, (k & 2) != 0 ? 1.0 : -1.0, (k & 4) != 0 ? 1.0 : -1.0),
                      mat3(0.0));
    if (glyph == ISO_GL_ELLIPSOID) add_ellipsoid(box, centre, vec3(0.0), axes);
    if (glyph == ISO_GL_DISC) add_circle(box, centre, axes, 0.0, 1.0);
    if (glyph == ISO_GL_CYLINDER) add_circle(box, centre, axes, 1.0, 1.0);
    if (glyph == ISO_GL_CYLINDER || glyph == ISO_GL_CONE) add_circle(box, centre, axes, -1.0, 1.0);
    if (glyph == ISO_GL_CONE || glyph == ISO_GL_ARROW) add_circle(box, centre, axes, 1.0, 0.0);
    if (glyph == ISO_GL_ARROW) add_circle(box, centre, axes, -1.0, ISO_GL_ARROW_SHAFT);
    if (glyph == ISO_GL_ARROW) add_circle(box, centre, axes, ISO_GL_ARROW_NECK, 1.0);
    /* a billboard is a parallel projection, scaled by the depth of the centre */
    float scale = rays.y == 0.0 && !parallel ? lens.z / centre.z : lens.z;
    box.pixels *= scale;
    return box;
}
#endif
