/* shapes.glsl: what the shaders of lines and glyphs share (render/shapes/shapes.h): uniforms, the values that
 * shapes.vert passes to shapes.frag, rays of pixels, and spheres. The names and formulas are those of the
 * cpu's kernel: render/shapes/chunk_simd.h and sphere_simd.h.
 *
 * KIND: ISO_GL_SPHERES, ISO_GL_TUBES, ISO_GL_RIBBONS or ISO_GL_SOLIDS; of solids GLYPH: ISO_GL_CONE, .. */
layout(std140, binding = ISO_GL_SHAPING) uniform shaping_block { ISO_GL_SHAPING_FIELDS };

#ifndef GLYPH
#define GLYPH 0
#endif
#if KIND == ISO_GL_SPHERES
#define FIELDS 1
#elif KIND == ISO_GL_TUBES
#define FIELDS 5
#else
#define FIELDS 3
#endif

/* The values of a shape: the pixel that its centre (of a segment, its first vertex) is projected to, and the
 * place in that pixel; the fields that its equations need; element, colours of both ends, flags. */
#define SHAPE_VALUES                                                                                         \
    flat vec4 place;                                                                                         \
    flat vec4 fields[FIELDS];                                                                                \
    flat uvec4 marks

bool parallel = set.z != 0;

/* The value of the depth buffer: 1 at the near plane, or in parallel views at the nearest depth. */
float buffer_depth(float depth) {
    return clamp(parallel ? (least.z - depth) * least.w : lens.w / depth, 0.0, 1.0);
}

/* The pixel at an offset from the projection of a shape's centre: its ray relative to the centre is
 * (k offset, 0) + s (ray, 1), s the depth less the centre's. */
struct pixel {
    vec2 offset, ray;
    float k, slope;
};

/* What a pixel sees of a shape. */
struct sight {
    float depth;
    vec3 normal;
    float along; /* how far along the segment, 0 to 1 */
};

/* r^2 |d|^2 - |o x d|^2, which has no terms that cancel; sets |d|^2. */
float sphere_discriminant(pixel p, float radius, out float dd) {
    float across = p.offset.x * p.ray.y - p.offset.y * p.ray.x;
    dd = dot(p.ray, p.ray) + 1.0;
    return radius * radius * dd - p.k * p.k * (dot(p.offset, p.offset) + across * across);
}

/* s of the first intersection. */
float sphere_root(pixel p, float discriminant, float dd) {
    return -(p.k * dot(p.offset, p.ray) + sqrt(max(discriminant, 0.0))) / dd;
}
